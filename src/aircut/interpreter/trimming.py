"""The entry option Normal: what the tool cannot reach is left out.

The ways beside the moves wait in a queue, as many as LOOKAHEAD. At an inside
corner the new way is cut where it meets the latest of them that it does meet,
without coming nearer to the contour than the radius; the ways between are left
out. Until one meets the queue, new moves only lengthen the contour to be spared.

Sources: 000 section 4.3; decision AMB-CMP-5.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from aircut.geometry import offsetting
from aircut.geometry.offsetting import (
    Element,
    Point,
    beside,
    corner,
    distance,
    heading,
    length,
    meetings,
    offset,
    square_end,
)
from aircut.interpreter.compensation import TRAVERSE, Compensation, Move, entry
from aircut.interpreter.path import Onward, Place
from aircut.interpreter.state import State

LOOKAHEAD = 64  # moves that wait
CLEAR = 1e-6  # mm by which a corner may be nearer to the contour than the radius
SHORT = 1e-6  # mm: a shorter piece of an arc is written as a line, for it might be taken for a full circle


@dataclass(slots=True)
class Slot:
    """A move that waits: its way, and the one around the corner before it; None where they are left out."""

    move: Move
    before: Place  # where it starts, as programmed
    way: Element | None = None
    around: Element | None = None
    first: bool = False  # the entry, which nothing cuts


class Normal(Compensation):
    """Enters as Easy does, and cuts back what the tool cannot reach."""

    def __init__(self, m: State, radius: float, side: int, shift: tuple[float, float] = (0.0, 0.0)) -> None:
        super().__init__(m, radius, side, shift)
        self.queue: list[Slot] = []
        self.last: Element | None = None  # of the contour
        self.lost = False  # the contour has gone where the tool cannot follow

    def carry(self, m: State, move: Move, onward: Onward) -> None:
        if self.queue:
            self.wait(m, Slot(move, self.contour))
        else:
            self.write(m, move, self.tool, None, 0, onward)

    def enter(self, m: State, move: Move) -> None:
        assert move.element is not None
        square = square_end(move.element, self.side * self.radius)
        self.wait(m, Slot(move, self.contour, entry(move.element, square, self.tool), first=True))
        self.last = move.element

    def wait(self, m: State, slot: Slot) -> None:
        self.queue.append(slot)
        m.out.hold()

    def join(self, m: State, move: Move, onward: Onward) -> None:
        element, last = move.element, self.last
        assert element is not None and last is not None
        way = offset(element, self.side * self.radius)
        slot = Slot(move, self.contour)
        ways = [one for one in self.queue if one.way or one.around]
        if not ways:  # flushed: from where the tool is
            slot.way = way and way._replace(start=self.tool)
        elif ways[-1].first and not self.lost:
            first = ways[-1]
            if way is None or first.move.element is None:
                raise self.too_small(m, first.move, move)
            first.way = entry(first.move.element, way.start, self.tool)
            slot.way = way
        else:
            self.attach(m, slot, corner(last, element, self.side), way)
        self.wait(m, slot)
        self.last = element
        while len(self.queue) > LOOKAHEAD:
            if self.lost and not any(one.way or one.around for one in self.queue[1:]):
                raise self.gouging(m, self.queue[0].move, move)
            self.let_go(m, onward)

    def attach(self, m: State, slot: Slot, angle: float, way: Element | None) -> None:
        """Find the way of a move from those that wait: by the corner, or by cutting back."""
        straight, element = m.dialect.cutter.straight, slot.move.element
        assert element is not None and self.last is not None
        around = None
        if angle < -straight:
            start = square_end(self.last, self.side * self.radius)
            end = beside(element.start, heading(element, element.start), self.side * self.radius)
            around = Element(start, end)
            if slot.move.kind != TRAVERSE:
                around = Element(start, end, element.start, -self.side)
        elif not self.lost and way is not None and angle <= straight:
            way = way._replace(start=self.end())
        self.lost = self.lost or angle > straight
        for field, piece in (("around", around), ("way", way)):
            if piece is not None and self.lost:
                place = self.cut(slot, piece)
                if place is None:
                    continue
                piece = piece._replace(start=place)
                self.lost = False
            setattr(slot, field, piece)
        self.lost = self.lost or way is None

    def pieces(self) -> Iterator[tuple[int, str, Element]]:
        """The ways that wait, the latest first, but not the entry: index of the slot, field, element."""
        for index in range(len(self.queue) - 1, -1, -1):
            slot = self.queue[index]
            if slot.first:
                return
            for field in ("way", "around"):
                piece = getattr(slot, field)
                if piece is not None:
                    yield index, field, piece

    def cut(self, slot: Slot | None, piece: Element) -> Point | None:
        """Cut the queue where a new piece meets it and the tool spares all between; None where nowhere."""
        for index, field, waiting in self.pieces():
            between = [one.move.element for one in self.queue[index:] if one.move.element is not None]
            if slot is not None and slot.move.element is not None:
                between.append(slot.move.element)
            for place in meetings(waiting, piece):
                if all(self.spares(one, place) for one in between):
                    setattr(self.queue[index], field, waiting._replace(end=place))
                    if field == "around":
                        self.queue[index].way = None
                    for left in self.queue[index + 1 :]:
                        left.way = left.around = None
                    return place
        return None

    def spares(self, element: Element, place: Point) -> bool:
        """Whether the tool, standing at a place, cuts nothing of an element of the contour."""
        rounding = 0.0
        if element.center is not None:
            rounding = abs(distance(element.start, element.center) - distance(element.end, element.center))
        return offsetting.away(element, place) > self.radius - CLEAR - 2.0 * rounding

    def end(self) -> Point:
        """Where the queue ends."""
        for slot in reversed(self.queue):
            piece = slot.way or slot.around
            if piece is not None:
                return piece.end
        return self.tool

    def flush(self, m: State, *, onward: Onward) -> None:
        """Write all that waits. Where the contour ends out of reach, the tool comes as near as it may."""
        if self.lost and self.last is not None:
            end = self.last.end
            cap = Element((end[0] + self.radius, end[1]), (end[0] + self.radius, end[1]), end, 1)
            if self.cut(None, cap) is None:
                slot = self.queue[-1]
                refusal = self.gouging(m, self.queue[0].move, slot.move)
                self.give_up(m, slot.move)
                raise refusal
            self.lost = False
        while self.queue:
            self.let_go(m, onward)

    def let_go(self, m: State, onward: Onward) -> None:
        """Write the first of the queue."""
        m.out.free(lambda: self.put(m, self.queue.pop(0), onward))

    def put(self, m: State, slot: Slot, onward: Onward) -> None:
        if slot.move.element is None:
            self.write(m, slot.move, self.tool, None, 0, onward)
        if slot.around is not None:
            self.send(m, slot.move._replace(end=slot.before, flags=m.flags), slot.around, onward)
        if slot.way is not None:
            self.send(m, slot.move, slot.way, onward)

    def send(self, m: State, move: Move, piece: Element, onward: Onward) -> None:
        straight = piece.center is None or length(piece) < SHORT
        self.write(m, move, piece.end, None if straight else piece.center, piece.turns, onward)

    def give_up(self, m: State, move: Move) -> None:
        super().give_up(m, move)
        self.queue = []
        self.lost = False
        self.last = move.element or self.last
