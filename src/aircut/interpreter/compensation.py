"""Cutter radius compensation: the stage that leads the tool beside the contour.

A move is held back until the next one shows where it ends: at an inside corner
it is cut back, around an outside one an arc of the tool's radius follows it.
Moves that do not move in the plane wait behind it and end where it ends.

Sources: 000 section 4; decisions AMB-CMP-*; the options NIST and Easy lead the
tool as LinuxCNC's interpreter does (canonical listing, section 12).
"""

from __future__ import annotations

from typing import NamedTuple

from aircut.canon import ROW, Kind
from aircut.diagnostics import Refusal
from aircut.diagnostics import faults as F
from aircut.geometry import arcs
from aircut.geometry.offsetting import (
    Element,
    Point,
    center_between,
    corner,
    crossings,
    distance,
    heading,
    nearest,
    offset,
    square_end,
)
from aircut.interpreter.path import Onward, Place, flush
from aircut.interpreter.state import INCH, State
from aircut.interpreter.table import Code

TRAVERSE, FEED, ARC = int(Kind.TRAVERSE), int(Kind.FEED), int(Kind.ARC)
STILL = 1e-9  # mm: shorter steps in the plane are none


class Move(NamedTuple):
    """A move as programmed, with what the recorder is to say of it. element: None without motion in the plane."""

    kind: int
    end: Place  # six axes, as programmed
    element: Element | None
    speed: float
    flags: int
    line: int
    file: int
    tool: int


class Held(NamedTuple):
    """A move that waits for the next one to show its end."""

    move: Move
    path: Element  # of the tool's center, as far as known
    guide: Element  # the line or circle on which it is cut back
    first: bool  # it is the entry
    before: Move | None  # the move before it in the plane


class Compensation:
    """The stage that is in force from G41 or G42 to G40. Which entry option it follows, subclasses say."""

    def __init__(self, m: State, radius: float, side: int, shift: tuple[float, float] = (0.0, 0.0)) -> None:
        """radius: mm. side: +1 left, -1 right. shift: from the tool's center to its control point, u and v, mm."""
        self.u, self.v, self.w = arcs.PLANE_AXES[m.plane]
        self.radius = radius
        self.side = side
        self.shift = shift
        self.contour = m.to_space(m.position)  # as programmed, up to here
        self.tool = self.flat(self.contour)  # in the plane, up to what has been written
        self.written: Place | None = None  # end of the last move written
        self.entered = False
        self.traced = False  # the contour as programmed has been begun
        self.held: Held | None = None
        self.behind: list[Move] = []  # moves out of the plane that wait behind the one held

    def flat(self, place: Place) -> Point:
        return place[self.u], place[self.v]

    # --- the stage

    def line(self, m: State, kind: int, end: Place, speed: float, flags: int, *, onward: Onward) -> None:
        here, there = self.flat(self.contour), self.flat(end)
        still = distance(here, there) < STILL
        self.meet(m, self.known(m, kind, end, None if still else Element(here, there), speed, flags), onward)

    def arc(
        self, m: State, end: Place, center: tuple[float, float], turns: int, speed: float, flags: int, *, onward: Onward
    ) -> None:
        element = Element(self.flat(self.contour), self.flat(end), center, turns)
        self.meet(m, self.known(m, ARC, end, element, speed, flags), onward)

    def flush(self, m: State, *, onward: Onward) -> None:
        """Write all that is held; the last move ends square to its programmed end."""
        held = self.held
        if held is not None:
            try:
                self.release(m, held.path.end, onward)
            except Refusal:
                self.give_up(m, held.move)
                raise

    def known(self, m: State, kind: int, end: Place, element: Element | None, speed: float, flags: int) -> Move:
        return Move(kind, end, element, speed, flags, m.out.line, m.out.file, m.tool)

    def meet(self, m: State, move: Move, onward: Onward) -> None:
        """Take a move as programmed. Raises Refusal."""
        try:
            if move.element is None:
                self.carry(m, move, onward)
            elif not self.entered:
                self.enter(m, move)
            else:
                self.join(m, move, onward)
        except Refusal:
            self.give_up(m, move)
            raise
        self.entered = self.entered or move.element is not None
        self.trace(m, move)
        self.contour = move.end

    def give_up(self, m: State, move: Move) -> None:
        """After a fault: forget what is held, and go on beside the end of the move, as if all were well."""
        m.out.drop()
        self.held = None
        self.behind = []
        self.entered = True
        self.contour = move.end
        self.tool = self.flat(move.end)
        if move.element is not None:
            self.tool = square_end(move.element, self.side * self.radius)
        m.position = m.to_program(move.end)

    def carry(self, m: State, move: Move, onward: Onward) -> None:
        """A move without motion in the plane: at once, or behind the one that waits."""
        if self.held is None:
            self.write(m, move, self.tool, None, 0, onward)
        else:
            self.behind.append(move)
            m.out.hold()

    def enter(self, m: State, move: Move) -> None:
        """The first move in the plane. Raises Refusal."""
        raise NotImplementedError

    # --- corners

    def join(self, m: State, move: Move, onward: Onward) -> None:
        """End the move that is held at its corner with the next one, and hold that. Raises Refusal."""
        path = guide = self.beside(m, move)
        held = self.held
        assert move.element is not None
        if held is None:  # flushed: from where the tool is
            self.hold(m, move, path._replace(start=self.tool), path)
            return
        assert held.move.element is not None
        angle = self.corner(held.move.element, move.element)
        rules = m.dialect.cutter
        if angle > rules.straight:
            place = self.cut_back(m, held, move, path)
            self.release(m, place, onward)
            path = path._replace(start=place)
        else:
            self.outside(m, move, onward)
            if angle < -rules.straight:
                self.around(m, move, path.start, onward)
            else:
                path = path._replace(start=self.tool)
        self.hold(m, move, path, guide, held.move)

    def corner(self, first: Element, second: Element) -> float:
        """Change of direction, radians, positive for inside corners."""
        return corner(first, second, self.side)

    def beside(self, m: State, move: Move) -> Element:
        """The way of the tool's center for a move. Raises Refusal for arcs that it does not fit into."""
        assert move.element is not None
        path = offset(move.element, self.side * self.radius)
        if path is None:
            raise self.too_small(m, self.held.move if self.held else None, move)
        return path

    def outside(self, m: State, move: Move, onward: Onward) -> None:
        """End the move that is held, where its corner with the next one does not cut it back. Raises Refusal."""
        assert self.held is not None
        self.release(m, self.held.path.end, onward)

    def cut_back(self, m: State, held: Held, move: Move, path: Element) -> Point:
        """Where the ways of two moves meet inside their corner. Raises Refusal."""
        place = nearest(crossings(held.guide, path), held.path.end)
        if place is None:
            raise self.gouging(m, held.move, move)
        return place

    def around(self, m: State, move: Move, start: Point, onward: Onward) -> None:
        """Lead the tool around an outside corner to where the next move begins."""
        assert move.element is not None
        joint = move._replace(end=self.joint(move), flags=m.flags)
        if move.kind == TRAVERSE:
            self.write(m, joint, start, None, 0, onward)
        else:
            self.write(m, joint, start, move.element.start, -self.side, onward)

    def joint(self, move: Move) -> Place:
        """Where the axes out of the plane are on the way around a corner."""
        return self.contour

    def hold(
        self, m: State, move: Move, path: Element, guide: Element, before: Move | None = None, first: bool = False
    ) -> None:
        self.held = Held(move, path, guide, first, before)
        m.out.hold()

    def release(self, m: State, end: Point, onward: Onward, checked: bool = True) -> None:
        """Write the move that is held, ending here, and what waits behind it. Raises Refusal."""
        held = self.held
        assert held is not None
        if checked:
            self.check(m, held, end)
        self.held = None
        path = held.path
        m.out.free(lambda: self.write(m, held.move, end, path.center, path.turns, onward))
        for move in self.behind:
            m.out.free(lambda move=move: self.write(m, move, end, None, 0, onward))  # type: ignore[misc]
        self.behind = []

    def check(self, m: State, held: Held, end: Point) -> None:
        """Refuse a move cut back beyond its own start: a line would go backwards, an arc be longer than before."""
        if backwards(held, end) if held.path.center is None else grows(held, end, growth(m)):
            raise self.gouging(m, held.before, held.move)

    def gouging(self, m: State, first: Move | None, second: Move) -> Refusal:
        return Refusal(
            F.GOUGING_CORNER, radius=self.radius / m.unit, first=place_of(m, first), second=place_of(m, second)
        )

    def too_small(self, m: State, before: Move | None, move: Move) -> Refusal:
        assert move.element is not None
        radius, arc = self.radius / m.unit, move.element.radius / m.unit
        return Refusal(F.GOUGING_ARC, radius=radius, arc=arc, first=place_of(m, before), second=place_of(m, move))

    # --- writing

    def write(self, m: State, move: Move, end: Point, center: Point | None, turns: int, onward: Onward) -> None:
        """Send a move on, as that of its own line, with its end in the plane put here."""
        out = m.out
        du, dv = self.shift
        goal = move.end[:]
        goal[self.u], goal[self.v] = end[0] + du, end[1] + dv
        line, file, tool = out.line, out.file, m.tool
        out.line, out.file, m.tool = move.line, move.file, move.tool
        if center is None:
            onward.line(m, FEED if move.kind == ARC else move.kind, goal, move.speed, move.flags)
        else:
            onward.arc(m, goal, (center[0] + du, center[1] + dv), turns, move.speed, move.flags)
        out.line, out.file, m.tool = line, file, tool
        self.tool = end
        self.written = goal

    def trace(self, m: State, move: Move) -> None:
        """Note the contour as programmed, for pictures."""
        element = move.element
        kind = move.kind if element is None or element.center is None else ARC
        center = (element and element.center) or (0.0, 0.0)
        turns = element.turns if element is not None else 0
        told = (move.line, move.tool)
        if not self.traced:
            self.traced = True
            m.out.contour += ROW.pack(*self.contour, 0.0, 0.0, 0.0, *told, 0, move.file, TRAVERSE, m.plane, 0)
        m.out.contour += ROW.pack(*move.end, *center, move.speed, *told, turns, move.file, kind, m.plane, move.flags)


class Nist(Compensation):
    """The entry ends beside the end of the first move, square to it."""

    loose = False  # LinuxCNC's rules for what follows the entry

    def enter(self, m: State, move: Move) -> None:
        path = self.beside(m, move)
        element = move.element
        assert element is not None
        length = distance(element.start, element.end)
        if length <= self.radius:
            raise Refusal(F.SHORT_ENTRY, radius=self.radius / m.unit, length=length / m.unit)
        way = entry(element, path.end, self.tool)
        self.hold(m, move, way, path if way.center is None else way, None, True)

    def carry(self, m: State, move: Move, onward: Onward) -> None:
        if not self.entered and not m.dialect.cutter.plunge_first:
            raise Refusal(F.SHORT_ENTRY, radius=self.radius / m.unit, length=0.0)
        super().carry(m, move, onward)


class Easy(Nist):
    """The entry waits for the second move, and ends beside the beginning of that."""

    def enter(self, m: State, move: Move) -> None:
        element = move.element
        assert element is not None
        way = entry(element, square_end(element, self.side * self.radius), self.tool)
        self.hold(m, move, way, way, None, True)

    def join(self, m: State, move: Move, onward: Onward) -> None:
        held = self.held
        if held is None or not held.first:
            super().join(m, move, onward)
            return
        path = self.beside(m, move)
        assert held.move.element is not None
        self.held = held._replace(path=entry(held.move.element, path.start, self.tool))
        self.release(m, path.start, onward)
        self.hold(m, move, path, path, held.move)

    def check(self, m: State, held: Held, end: Point) -> None:
        if not held.first:
            super().check(m, held, end)


def before(m: State, row: Code) -> None:
    """Before a code runs while compensation is on. Raises Refusal."""
    rules = m.dialect.cutter
    if row.name in rules.forbids:
        raise Refusal(F.COMPENSATING, row.name[0].lower(), code=row.name)
    if row.name in rules.flushes:
        flush(m)


def entry(element: Element, end: Point, start: Point) -> Element:
    """The way of the first move from where the tool is to a point beside its end."""
    if element.center is None:
        return Element(start, end)
    center = center_between(start, end, element.center)
    return Element(start, end) if center is None else Element(start, end, center, element.turns)


def backwards(held: Held, end: Point) -> bool:
    """Whether a line that ends here would run against its programmed direction."""
    start, element = held.path.start, held.move.element
    assert element is not None
    ahead = heading(element, element.end)
    return (end[0] - start[0]) * ahead[0] + (end[1] - start[1]) * ahead[1] < -STILL


def grows(held: Held, end: Point, most: float) -> bool:
    """Whether an arc that ends here would sweep more than it was meant to."""
    path, guide = held.path, held.guide
    assert path.center is not None and guide.center is not None
    meant = abs(arcs.sweep(guide.start, guide.end, guide.center, guide.turns))
    return abs(arcs.sweep(path.start, end, path.center, path.turns)) - meant > most


def growth(m: State) -> float:
    """Radians by which an arc may grow when it is cut back, as by rounded programs."""
    return m.dialect.cutter.growth[m.unit == INCH]


def place_of(m: State, move: Move | None) -> str:
    """How a message names a move."""
    if move is None:
        return "the entry"
    return f"line {move.line}" if move.file == m.out.file else f"line {move.line} of another file"
