"""Turning cycles of LinuxCNC's language: G70 finishes a contour, G71 and G72 rough it along Z and X.

The contour is the way of a subroutine, which is run without moving; what it sets but parameters is put back.
Behavior was learnt by asking: the canonical listing, section 13, and docs/explanation/linuxcnc.md.
"""

from __future__ import annotations

from collections.abc import Iterable
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple

from aircut.diagnostics import Refusal
from aircut.diagnostics import faults as F
from aircut.geometry import roughing
from aircut.geometry.offsetting import Element, Point
from aircut.geometry.roughing import Cut, Pockets, Turning
from aircut.interpreter.linuxcnc.arranging import whole
from aircut.interpreter.linuxcnc.motion import (
    FEED,
    TRAVERSE,
    center_in_space,
    check_feed,
    feed_flags,
    go,
    goal,
    speed_of,
    wrong,
)
from aircut.interpreter.linuxcnc.state import State
from aircut.interpreter.table import Code, Group, Order, Words

if TYPE_CHECKING:
    from aircut.interpreter.linuxcnc.interpreter import Interpreter

X, Z = 0, 2
XZ = 180
RETRACT = 0.5  # program units, without R
TRACED = ("g0", "g1", "g2", "g3")  # moves that make the contour


class Silent:
    """Stands in for the recorder while a contour is traced."""

    def __init__(self) -> None:
        self.line = 0
        self.file = 0
        self.moves = 0
        self.marks = ()

    def event(self, name: str, *values: Any) -> None:
        """What the subroutine says is not told."""


class Tracer:
    """Takes the moves of a contour, in the program's frame."""

    def __init__(self, start: Point) -> None:
        self.here = start
        self.moves: list[Element] = []
        self.corners: dict[int, tuple[float, bool]] = {}  # behind a move: radius, and whether it is an arc

    def take(self, m: State, end: list[float], center: Point | None = None, turns: int = 0) -> None:
        place = m.to_program(end)
        there = (place[Z], place[X])
        if m.motion_name in TRACED and (center is not None or roughing.is_move(self.here, there)):
            self.moves.append(Element((m.position[Z], m.position[X]), there, center, turns))
            if "a" in m.words and "c" in m.words:
                raise wrong("a corner of a contour has A or C, not both")
            for letter in "ac":
                if letter in m.words:
                    self.corners[len(self.moves) - 1] = (abs(m.length(m.words, letter)), letter == "a")
        self.here = there

    def line(self, m: State, kind: int, end: list[float], speed: float, flags: int) -> None:
        self.take(m, end)

    def arc(self, m: State, end: list[float], center: Point, turns: int, speed: float, flags: int) -> None:
        origin = m.to_space([0.0] * 9)
        self.take(m, end, (center[0] - origin[Z], center[1] - origin[X]), turns)


class Frame(NamedTuple):
    """From (Z, X) to (along, height) by mirrors, and for G72 with the axes exchanged; mm."""

    exchanged: bool
    along: float  # +1 or -1
    height: float

    def place(self, point: Point) -> Point:
        z, x = reversed(point) if self.exchanged else point
        return self.along * z, self.height * x

    def back(self, point: Point) -> Point:
        z, x = self.along * point[0], self.height * point[1]
        return (x, z) if self.exchanged else (z, x)

    @property
    def turning(self) -> int:
        """-1 where the frame is a mirror image."""
        return int(self.along * self.height) * (-1 if self.exchanged else 1)

    def element(self, element: Element) -> Element:
        center = None if element.center is None else self.place(element.center)
        return Element(self.place(element.start), self.place(element.end), center, element.turns * self.turning)


def frame_of(contour: list[Element], facing: bool) -> Frame:
    """The frame in which the contour climbs and leads to smaller `along`."""
    dz = contour[-1].end[0] - contour[0].start[0]
    dx = contour[-1].end[1] - contour[0].start[1]
    if facing:
        return Frame(True, -1.0 if dx > 0.0 else 1.0, 1.0 if dz > 0.0 else -1.0)
    return Frame(False, -1.0 if dz > 0.0 else 1.0, -1.0 if dx < 0.0 else 1.0)


def framed(
    contour: list[Element], corners: dict[int, tuple[float, bool]], facing: bool, either: bool
) -> tuple[Frame, list[Element]]:
    """The contour, with its corners, in its frame; in either direction, along Z if it may. Raises Turning."""
    if either:
        try:
            if contour[0].end[0] == contour[-1].end[0] > contour[0].start[0]:
                raise Turning("its end along Z is that of its first move")  # then LinuxCNC does not turn Z around
            return framed(contour, corners, False, False)
        except Turning:
            return framed(contour, corners, True, False)
    frame = frame_of(contour, facing)
    elements = roughing.rounded([frame.element(element) for element in contour], corners)
    roughing.check_monotonic(elements)
    return frame, elements


def turn(facing: bool, pockets: Pockets | None, m: State, w: Words) -> None:
    """G70 (pockets is None), G71, G72. Raises Refusal."""
    name = m.codes[-1].name if m.codes else "G71"
    if "q" not in w:
        raise Refusal(F.MISSING_WORD, code=name, word="Q", meaning="the subroutine with the contour")
    if m.plane_code != XZ:
        raise wrong(f"{name} needs the XZ plane", "program G18")
    start = goal(m, w)
    m.absolute, absolute = True, m.absolute
    go(m, TRAVERSE, goal(m, {k: v for k, v in w.items() if k in "xz"}))  # G91 or not
    m.absolute = absolute
    m.position = [*m.position]
    m.position[X], m.position[Z] = start[X], start[Z]
    label = str(whole("q", w["q"]))
    m.transfer = partial(carry_out, facing, pockets, label, dict(w))


def carry_out(facing: bool, pockets: Pockets | None, label: str, w: Words, run: Interpreter) -> None:
    """Trace the contour, then cut it. Raises Refusal."""
    m = run.state
    start = (m.position[Z], m.position[X])
    tracer = trace(run, label)
    if pockets is not None and w.get("i", 1.0) <= 0.0:
        raise Refusal(F.BAD_VALUE, "i", word="I", value=w["i"], wanted="the depth of a pass is above zero")
    corners = {number - 1: corner for number, corner in tracer.corners.items()}
    contour = tracer.moves[1:]  # the first is the approach
    if not contour:
        return
    try:
        frame, elements = framed(contour, corners, facing, either=pockets is None)
        begin = frame.place(start)
        begin = (max(begin[0], elements[0].start[0]), begin[1])  # the approach does not go back
        side = roughing.side_of(begin, elements)
        if pockets is None:
            count = int(w.get("p", 1.0))
            first, last = m.length(w, "d"), m.length(w, "e")
            for number in range(1, count + 1):
                allowance = first + (last - first) * number / count
                path = roughing.joined(begin, roughing.beside(elements, side * allowance))
                emit(run, frame, [Cut(True, begin)])
                emit(run, frame, roughing.finishing(path))
        else:
            path = roughing.joined(begin, roughing.beside(elements, side * m.length(w, "d")))
            depth = m.length(w, "i", m.unit)
            retract = m.length(w, "r", RETRACT * m.unit)
            cutting = roughing.Roughing(begin, roughing.escaped(begin, path), depth, retract, pockets)
            emit(run, frame, [Cut(True, begin)])
            emit(run, frame, cutting.cuts())
    except Turning as fault:
        raise wrong(f"the contour of O{label}: {fault}") from None


def trace(run: Interpreter, label: str) -> Tracer:
    """The moves of a subroutine; the state is put back but for parameters. Raises Refusal."""
    m, flow = run.state, run.flow
    kept = {name: value[:] if isinstance(value, list) else value for name, value in m.__dict__.items()}
    modal, out = run.modal, m.out
    depth = len(flow.stack)
    tracer = Tracer((m.position[Z], m.position[X]))
    m.out, m.way = Silent(), tracer  # type: ignore[assignment]
    try:
        flow.enter(label, (), 1)
        while len(flow.stack) > depth:
            run.line = run.next_line
            if run.line >= len(run.unit.source):
                run.run_off()
            run.next_line = run.line + 1
            m.line = run.line + 1
            run.step()
    finally:
        line = m.line
        kept |= {name: getattr(m, name) for name in ("numbered", "names", "scope", "calls", "value", "value_returned")}
        m.__dict__.update(kept)
        run.modal, m.out = modal, out
        m.line = m.out.line = line
    return tracer


def emit(run: Interpreter, frame: Frame, cuts: Iterable[Cut]) -> None:
    """Write the moves. Raises Refusal."""
    m = run.state
    for cut in cuts:
        place = m.position[:]
        place[Z], place[X] = frame.back(cut.end)
        name = "g0" if cut.rapid else "g1"
        if cut.center is None:
            if not cut.rapid:
                check_feed(m, {})
            go(
                m,
                TRAVERSE if cut.rapid else FEED,
                place,
                0.0 if cut.rapid else speed_of(m, {}, "G1", 0.0),
                feed_flags(m),
            )
        else:
            turns = cut.turns * frame.turning
            name = "g3" if turns > 0 else "g2"
            center = center_in_space(m, Z, X, frame.back(cut.center))
            m.way.arc(m, m.to_space(place)[:6], center, turns, speed_of(m, {}, "G2", 0.0), feed_flags(m))
            m.position, m.told = place, place[:]
        run.modal = run.dialect.codes[name]
        m.motion_name = name


row = partial(Code, group=Group.MOTION, order=Order.MOTION, axes=True)
rough = partial(row, takes="qdir")

CODES = (
    row("G70", "Turning, finishing", partial(turn, False, None), takes="qdep"),
    rough("G71", "Turning, roughing along Z", partial(turn, False, Pockets.ALL)),
    rough("G71.1", "Turning, roughing along Z, without pockets", partial(turn, False, Pockets.NONE)),
    rough("G71.2", "Turning, roughing along Z, pockets alone", partial(turn, False, Pockets.ONLY)),
    rough("G72", "Turning, roughing along X", partial(turn, True, Pockets.ALL)),
    rough("G72.1", "Turning, roughing along X, without pockets", partial(turn, True, Pockets.NONE)),
    rough("G72.2", "Turning, roughing along X, pockets alone", partial(turn, True, Pockets.ONLY)),
)
