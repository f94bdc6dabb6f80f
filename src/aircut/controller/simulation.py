"""Runs a program against a world: answers what the interpreter asks.

Time is that of feed moves at their speed, rapids at the slowest axis' velocity,
dwells and waits; acceleration is the planner's affair.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Generator, Iterator
from math import dist
from typing import Any, ClassVar, NamedTuple

from aircut.canon import ROW, Chunk, Kind
from aircut.canon.record import NUMBERS, Events
from aircut.controller.windows import HUD, STOP, Window, shown, window
from aircut.controller.world import Input, World
from aircut.interpreter.requests import (
    Answer,
    Ask,
    Inputs,
    Output,
    Overlay,
    Pause,
    Plc,
    Probe,
    Probed,
    Request,
    Wait,
    Waited,
)
from aircut.interpreter.running import Run
from aircut.machine.tools import EMPTY
from aircut.markup import Document

PLC_GROUP = "aircut.plc"  # entry points: a function (simulation, **arguments) under the P of G100
PROBE_TYPE = 4  # of tools: these touch with a ball, all others with the point at their end
THRESHOLD = 50.0  # percent from which an analog input counts as high (AMB-IO-3)
DWELL = NUMBERS["DWELL"]
STEP = 0.01  # seconds between two looks at an input scripted in sequence
PATIENCE = 3600.0  # seconds after which a wait without limit is given up


class Alarm(NamedTuple):
    """The run stopped on an alarm."""

    text: str


class Simulation:
    """One run of an interpreter in a world. Iterate `run()`; `outputs` and `shown` tell what it did."""

    def __init__(self, interpreter: Run, world: World) -> None:
        self.interpreter = interpreter
        self.world = world
        self.time = 0.0  # seconds
        self.outputs: dict[tuple[int, bool], float] = {}  # (number, analog) -> value
        self.shown: list[Window] = []
        self.hud = Document(())  # the text over the picture of the machine
        self.pauses = 0
        self.plc_calls: list[Plc] = []
        self.seen = 0  # moves of which the time has been counted
        self.heard = 0  # events of the present chunk of which the time has been counted
        self.place = (0.0, 0.0, 0.0)
        self.read: dict[tuple[int, bool], int] = {}  # readings of inputs scripted in sequence
        self.replies = iter(world.file.operator)

    def run(self, talk: Generator[Chunk | Request, Any, None] | None = None) -> Iterator[Chunk]:
        """Run to the end, or (with `talk`) one command of a session; yields motion and events as they come."""
        talk = talk or self.interpreter.execute()
        reply: Any = None
        while True:
            try:
                item = talk.send(reply)
            except StopIteration:
                return
            reply = None
            if isinstance(item, Chunk):
                self.count(item.rows, item.first, item.events)
                self.heard = 0
                yield item
            else:
                self.catch_up()
                reply = self.ANSWERS[type(item)](self, item)

    # --- time

    def catch_up(self) -> None:
        out = self.interpreter.state.out
        self.count(bytes(out.rows), out.first, out.events, out.marks[0] if out.marks else None)

    def count(self, rows: bytes | memoryview, first: int, events: Events, settled: int | None = None) -> None:
        """Add the time of the moves and dwells that have not been counted yet.

        settled: events from this one on may still change places.
        """
        rapid = min((axis.velocity for axis in self.interpreter.machine.axes.values()), default=1000.0)
        for row in ROW.iter_unpack(rows[max(self.seen - first, 0) * ROW.size :]):
            place = (row[0], row[1], row[2])
            speed = rapid if row[13] == Kind.TRAVERSE else row[8]
            if speed > 0.0:
                self.time += 60.0 * dist(place, self.place) / speed
            self.place = place
            self.seen += 1
        end = len(events) if settled is None else settled
        for i in range(self.heard, end):
            if events.name[i] == DWELL:
                self.time += events.values[i][0]
        self.heard = end

    # --- answers

    def probe(self, request: Probe) -> Probed:
        """Touch the bodies with the tool's ball."""
        tool = self.interpreter.state.tools.get(request.tool, EMPTY)
        true = self.world.tools.get(request.tool)
        diameter = true.diameter if true else tool.diameter
        length = true.length if true else tool.z
        radius = diameter / 2 if tool.type == PROBE_TYPE else 0.0
        offset = (tool.x, tool.y, length - radius)
        start = tuple(p - o for p, o in zip(request.start[:3], offset, strict=True))
        end = tuple(p - o for p, o in zip(request.target[:3], offset, strict=True))
        body = self.world.body
        touching = body is not None and body.touches(start, radius)
        if touching == request.toward:
            return Probed(-2, request.start)
        if body is None:
            return Probed(-1, request.target)
        part = (body.touch if request.toward else body.clear)(start, end, radius)
        if part is None:
            return Probed(-1, request.target)
        way = dist(start, end)
        part = min(1.0, part + self.world.file.overshoot / way) if way else part
        stop = tuple(a + part * (b - a) for a, b in zip(request.start, request.target, strict=True))
        return Probed(1, stop)

    def value(self, number: int, analog: bool) -> float:
        """An input now; one scripted in sequence moves on with each reading."""
        one = self.world.inputs.get((number, analog), Input(number, analog))
        if one.times:
            at = bisect_right([time for time, _ in one.times], self.time) - 1
            return one.times[at][1] if at >= 0 else one.value
        if one.sequence:
            at = self.read.get((number, analog), 0)
            self.read[number, analog] = at + 1
            return one.sequence[min(at, len(one.sequence) - 1)]
        return one.value

    def wait(self, request: Wait) -> Waited:
        """Wait in virtual time until the input is as wanted, or the time is over."""
        value = self.value(request.input, request.analog)
        if request.mode == 4:
            return Waited(value, True)
        limit = self.time + (PATIENCE if request.timeout is None else request.timeout)
        before = high(value, request.analog)
        while True:
            now = high(value, request.analog)
            wanted = (not now, now, before and not now, now and not before)[request.mode]
            if wanted:
                return Waited(value, True)
            before = now
            later = self.next_change(request, limit)
            if later > limit:
                self.time = limit
                return Waited(value, False)
            self.time = later
            value = self.value(request.input, request.analog)

    def next_change(self, request: Wait, limit: float) -> float:
        """When the input may read otherwise; beyond the limit if never."""
        one = self.world.inputs.get((request.input, request.analog))
        if one is None or (not one.times and not one.sequence):
            return limit + 1.0
        if one.times:
            return next((time for time, _ in one.times if time > self.time), limit + 1.0)
        if self.read.get((request.input, request.analog), 0) >= len(one.sequence):
            return limit + 1.0
        return self.time + STEP

    def inputs(self, request: Inputs) -> tuple[float, ...]:
        numbers = range(request.first, request.first + request.number)
        return tuple(self.value(number, request.analog) for number in numbers)

    def output(self, request: Output) -> None:
        self.outputs[request.output, request.analog] = request.value

    def ask(self, request: Ask) -> Answer:
        """The operator's scripted answer; without one Resume with the defaults, or Stop where that is all there is."""
        opened = window(request, self.interpreter.state.tools.get)
        self.shown.append(opened)
        reply = next(self.replies, None)
        if reply is None:
            return Answer(opened.buttons == (STOP,))
        if len(opened.buttons) == 1:
            return Answer(opened.buttons == (STOP,), tuple(reply.values))
        return Answer(reply.stop, tuple(reply.values))

    def overlay(self, request: Overlay) -> None:
        self.hud = shown(request.text, HUD, self.interpreter.state.tools.get)

    def pause(self, request: Pause) -> None:
        self.pauses += not request.optional or self.interpreter.settings.optional_stop

    def plc(self, request: Plc) -> None:
        """Call the function that an installed package registers under this name; without one it is only noted."""
        self.plc_calls.append(request)
        from importlib.metadata import entry_points

        for entry in entry_points(group=PLC_GROUP, name=request.function):
            entry.load()(self, **request.arguments)

    ANSWERS: ClassVar[dict[type, Callable[[Any, Any], Any]]] = {
        Probe: probe,
        Wait: wait,
        Inputs: inputs,
        Output: output,
        Ask: ask,
        Overlay: overlay,
        Pause: pause,
        Plc: plc,
    }


def high(value: float, analog: bool) -> bool:
    return value >= THRESHOLD if analog else value != 0.0
