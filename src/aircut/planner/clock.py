"""The clock beside the axes: pauses with their durations, and where settings of the motion change.

A pause stands before a move; the machine is at rest there. Each command that takes time is a row.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple

from aircut.canon.record import NUMBERS

if TYPE_CHECKING:
    from aircut.canon.record import Event, Events
    from aircut.machine import Machine

IMMEDIATE = 4  # L of M66 that does not wait
HUD = 4  # Q of M109 that shows without a window


class Pause(NamedTuple):
    """Time in which the axes stand."""

    at: int  # index of the move it comes before
    kind: str  # of KINDS
    seconds: float
    line: int
    file: int
    tool: int  # in the spindle afterwards, -1 as before


#: Kinds of pauses, with what they are called.
KINDS = {
    "dwell": "dwell",
    "spindle": "spindle up and down",
    "index": "waiting for the spindle's index",
    "orient": "spindle orientation",
    "tool_change": "tool change",
    "pallet": "pallet",
    "operator": "operator",
    "input": "inputs",
}


class Regime(NamedTuple):
    """Settings of the motion from a move on."""

    at: int
    blend: float = 0.0  # mm, G64 P
    acceleration: float = 0.0  # mm/s², G104; 0 the axes' own
    deceleration: float = 0.0
    jerk: float = 1.0  # share of the axes' own, G104 J
    rapid: float = 0.0  # mm/s, G103; 0 the axes' own
    feed_factor: float = 1.0
    rapid_factor: float = 1.0
    thinning: float = 0.0  # mm, G64 Q

    @property
    def row(self) -> tuple[float, ...]:
        """What kernels.pieces.lay wants of it."""
        dynamics = (self.acceleration, self.deceleration, self.jerk)
        return (self.blend, *dynamics, self.rapid, self.feed_factor, self.rapid_factor)


class Overrides(NamedTuple):
    """Overrides of the operator, 1 as programmed."""

    feed: float = 1.0
    rapid: float = 1.0
    spindle: float = 1.0


class Spindle:
    """What is known of one spindle."""

    def __init__(self, factor: float) -> None:
        self.spinning = 0.0  # revolutions a minute, negative counterclockwise
        self.direction = 0
        self.speed = 0.0  # as programmed
        self.surface = False  # that is one of the tool over the part, G96
        self.factor = factor  # of the override, as the program allows
        self.orienting = 0.0  # seconds that it takes to orient


class Clock:
    """Reads the events of a run: fills `pauses` and `regimes`."""

    def __init__(self, machine: Machine, overrides: Overrides, optional_stop: bool) -> None:
        self.machine = machine
        self.durations = machine.durations
        self.overrides = overrides
        self.optional_stop = optional_stop
        self.pauses: list[Pause] = []
        self.halts: list[int] = []  # indices of moves before which the machine stands
        self.regimes = [Regime(0, feed_factor=overrides.feed, rapid_factor=overrides.rapid)]
        self.spindles: defaultdict[int, Spindle] = defaultdict(lambda: Spindle(overrides.spindle))
        self.followed = 0  # the spindle that feeds a revolution and threads go with
        self.feed_factor = overrides.feed
        self.per_revolution = False  # G95
        self.synchronized = False  # the axes follow the spindle
        self.let_go = -1  # before which move they last ceased to
        self.tool: int | None = None
        self.by_macro = False

    def read(self, events: Events) -> None:
        """Read all events. Only those that matter are looked at one by one."""
        import numpy as np

        names = np.frombuffer(events.name, np.uint8) if len(events) else np.empty(0, np.uint8)
        wanted = np.isin(names, [NUMBERS[name] for name in ACTIONS])
        for index in np.flatnonzero(wanted).tolist():
            event = events[index]
            ACTIONS[event.name](self, event)

    def pause(self, event: Event, kind: str, seconds: float, tool: int = -1) -> None:
        if event.line or seconds:
            self.halts.append(event.at)
        if seconds or tool >= 0:
            self.pauses.append(Pause(event.at, kind, seconds, event.line, event.file, tool))

    def change(self, event: Event, **settings: Any) -> None:
        self.regimes.append(self.regimes[-1]._replace(at=event.at, **settings))

    # --- pauses

    def dwell(self, event: Event) -> None:
        self.pause(event, "dwell", event.values[0])

    def spin(self, event: Event, direction: int) -> None:
        spindle = self.spindles[event.values[0]]
        spindle.direction = direction
        spindle.orienting = 0.0
        self.turn(event)

    def set_speed(self, event: Event) -> None:
        spindle = self.spindles[event.values[0]]
        spindle.speed = event.values[1]
        if spindle.direction:
            self.turn(event)
        else:
            self.set_feed(event)

    def turning(self, spindle: Spindle) -> float:
        """Revolutions a minute that a spindle can give of what is programmed."""
        return min(spindle.speed * spindle.factor, self.machine.spindle.max_speed)

    def turn(self, event: Event) -> None:
        """Bring the event's spindle to its speed. Under G96 it follows the tool, which takes no time of its own."""
        self.set_feed(event)
        spindle = self.spindles[event.values[0]]
        wanted = spindle.direction * self.turning(spindle)
        if spindle.surface and spindle.direction:
            return
        seconds = self.ramp(abs(wanted - spindle.spinning))
        if wanted != spindle.spinning:
            spindle.spinning = wanted
            self.pause(event, "spindle", seconds)

    def ramp(self, change: float) -> float:
        """Seconds of a change of a spindle's speed, revolutions a minute."""
        rate = self.machine.spindle.acceleration
        return change / rate if rate else 0.0

    def spindle_mode(self, event: Event) -> None:
        self.followed = event.values[0]
        self.spindles[self.followed].surface = event.values[1] > 0.0

    def spindle_override(self, event: Event, on: bool) -> None:
        spindle = self.spindles[event.values[0]]
        spindle.factor = self.overrides.spindle if on else 1.0
        if spindle.direction:
            self.turn(event)

    # --- moves that follow the spindle

    def set_feed(self, event: Event) -> None:
        """What becomes of feeds: those for each revolution are as much faster as the spindle is."""
        factor = 1.0 if self.synchronized else self.feed_factor
        spindle = self.spindles[self.followed]
        if (self.synchronized or self.per_revolution) and spindle.speed > 0.0:
            factor *= spindle.factor if spindle.surface else self.turning(spindle) / spindle.speed
        if factor != self.regimes[-1].feed_factor:
            self.change(event, feed_factor=factor)

    def feed_mode(self, event: Event) -> None:
        self.followed = event.values[0]
        self.per_revolution = event.values[1] == 1
        self.set_feed(event)

    def synchronize(self, event: Event) -> None:
        """The axes wait for the spindle's index: half a revolution on the average. Moves in a row wait once."""
        waits = not self.synchronized and self.let_go != event.at
        self.synchronized = True
        self.followed = event.values[2]
        self.set_feed(event)
        spinning = self.spindles[self.followed].spinning
        if waits and spinning:
            self.pause(event, "index", 30.0 / abs(spinning))

    def let_loose(self, event: Event) -> None:
        self.synchronized, self.let_go = False, event.at
        self.set_feed(event)

    def rigid_tap(self, event: Event) -> None:
        """At the bottom and again back at the top the spindle turns round, and the axis with it."""
        spinning = self.spindles[self.followed].spinning
        for move in (1, 2):
            self.pause(event._replace(at=event.at + move), "spindle", self.ramp(2.0 * abs(spinning)))

    def orient(self, event: Event) -> None:
        """The spindle stops, and turns to an angle; it does so by itself."""
        spindle = self.spindles[event.values[0]]
        spindle.orienting = self.ramp(abs(spindle.spinning)) + self.durations.orient
        spindle.spinning = 0.0

    def wait_orient(self, event: Event) -> None:
        spindle = self.spindles[event.values[0]]
        self.pause(event, "orient", min(spindle.orienting, event.values[1]))
        spindle.orienting = 0.0

    # --- pauses

    def change_tool(self, event: Event) -> None:
        tool = event.values[0]
        new = tool != self.tool and not self.by_macro
        self.tool = tool
        self.pause(event, "tool_change", self.durations.tool_change if new else 0.0, tool)

    def tool_macro(self, event: Event) -> None:
        self.by_macro = bool(event.values[0])

    def pallet(self, event: Event) -> None:
        self.pause(event, "pallet", self.durations.pallet)

    def operator(self, event: Event) -> None:
        self.pause(event, "operator", self.durations.operator)

    def optional(self, event: Event) -> None:
        if self.optional_stop:
            self.operator(event)

    def message(self, event: Event) -> None:
        if len(event.values) > 1 and event.values[1] != HUD:
            self.operator(event)

    def wait_input(self, event: Event) -> None:
        _, mode, timeout = event.values
        seconds = 0.0 if mode % 10 == IMMEDIATE else self.durations.input
        self.pause(event, "input", min(seconds, timeout) if timeout >= 0.0 else seconds)

    def stand(self, event: Event) -> None:
        """What takes no time of its own, but is done at rest."""
        self.halts.append(event.at)

    # --- settings

    def blend(self, event: Event) -> None:
        self.change(event, blend=event.values[0])

    def thinning(self, event: Event) -> None:
        self.change(event, thinning=event.values[0])

    def traverse_rate(self, event: Event) -> None:
        self.change(event, rapid=event.values[0] / 60.0)

    def dynamics(self, event: Event) -> None:
        acceleration, deceleration, jerk = event.values
        self.change(event, acceleration=acceleration, deceleration=deceleration, jerk=max(jerk / 100.0, SLOWEST))

    def feed_override(self, event: Event, on: bool) -> None:
        self.feed_factor = self.overrides.feed if on else 1.0
        self.set_feed(event)


SLOWEST = 0.05  # share of the jerk that is left at G104 J0

ACTIONS: dict[str, Callable[[Clock, Event], None]] = {
    "DWELL": Clock.dwell,
    "START_SPINDLE_CLOCKWISE": lambda clock, event: clock.spin(event, 1),
    "START_SPINDLE_COUNTERCLOCKWISE": lambda clock, event: clock.spin(event, -1),
    "STOP_SPINDLE_TURNING": lambda clock, event: clock.spin(event, 0),
    "SET_SPINDLE_SPEED": Clock.set_speed,
    "SET_SPINDLE_MODE": Clock.spindle_mode,
    "ENABLE_SPEED_OVERRIDE": lambda clock, event: clock.spindle_override(event, True),
    "DISABLE_SPEED_OVERRIDE": lambda clock, event: clock.spindle_override(event, False),
    "SET_FEED_MODE": Clock.feed_mode,
    "START_SPEED_FEED_SYNC": Clock.synchronize,
    "STOP_SPEED_FEED_SYNCH": Clock.let_loose,
    "RIGID_TAP": Clock.rigid_tap,
    "ORIENT_SPINDLE": Clock.orient,
    "WAIT_ORIENT_COMPLETE": Clock.wait_orient,
    "CHANGE_TOOL": Clock.change_tool,
    "TOOL_CHANGE_MACRO": Clock.tool_macro,
    "PALLET_SHUTTLE": Clock.pallet,
    "PROGRAM_STOP": Clock.operator,
    "OPTIONAL_PROGRAM_STOP": Clock.optional,
    "MESSAGE": Clock.message,
    "WAIT_INPUT": Clock.wait_input,
    "PLC_CALL": Clock.stand,
    "HOME_AXES": Clock.stand,
    "SET_MOTION_CONTROL_BLEND": Clock.blend,
    "SET_NAIVECAM_TOLERANCE": Clock.thinning,
    "SET_TRAVERSE_RATE": Clock.traverse_rate,
    "SET_DYNAMICS": Clock.dynamics,
    "ENABLE_FEED_OVERRIDE": lambda clock, event: clock.feed_override(event, True),
    "DISABLE_FEED_OVERRIDE": lambda clock, event: clock.feed_override(event, False),
}
