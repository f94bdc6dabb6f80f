"""Cutter radius compensation of LinuxCNC's language, on the house's stage.

Source: the canonical listing, section 12.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from math import pi
from typing import Any

from aircut.diagnostics import Refusal
from aircut.diagnostics import faults as F
from aircut.geometry.offsetting import Element, Point, crossings, heading, offset
from aircut.interpreter import path
from aircut.interpreter import state as house
from aircut.interpreter.compensation import Held, Move, Nist
from aircut.interpreter.cutter import SHIFTS, SLOT, Leaving
from aircut.interpreter.linuxcnc.arranging import whole
from aircut.interpreter.linuxcnc.modes import said
from aircut.interpreter.linuxcnc.motion import wrong
from aircut.interpreter.linuxcnc.state import State
from aircut.interpreter.path import Onward, Place
from aircut.interpreter.table import Code, Group, Order, Words
from aircut.language.arithmetic import EQUAL

BACK = 0.05  # radians from a half turn
#: Events that do not wait behind a move held back.
AT_ONCE = frozenset(
    ["MESSAGE", "LOG", "PRINT", "SELECT_TOOL", "SELECT_PLANE", "USE_LENGTH_UNITS", "STORE_TOOL", "CHANGE_TOOL_NUMBER"]
)


class Beside(Nist):
    """The stage; its moves carry the line of the block that released them, as the listing has them."""

    loose = True
    threads = False  # the move that comes is a G33 or G33.1
    flushed: Held | None = None  # the last move in the plane, where it was written without its corner

    def enter(self, m: house.State, move: Move) -> None:
        super().enter(m, move)
        self.check_thread()

    def carry(self, m: house.State, move: Move, onward: Onward) -> None:
        if self.entered:
            self.check_thread()
        if self.held is None and self.flushed is not None:  # the next corner moves its end too
            self.straighten(self.flushed)
            self.behind.append(move)
            m.out.hold()
        else:
            super().carry(m, move, onward)

    def around(self, m: house.State, move: Move, start: Point, onward: Onward) -> None:
        self.check_thread()
        super().around(m, move, start, onward)

    def joint(self, move: Move) -> Place:
        """Rotary axes turn on the way around the corner already."""
        return [*self.contour[:3], *move.end[3:]]

    def check_thread(self) -> None:
        """Raises Refusal where LinuxCNC takes no thread."""
        if self.threads:
            raise wrong("beside a contour a thread is no entry, goes around no outside corner and not out of the plane")

    def corner(self, first: Element, second: Element) -> float:
        """Where the way leads back, or almost, the bend of the later arc tells inside from outside."""
        angle = super().corner(first, second)
        if abs(angle) <= pi - BACK:
            return angle
        return pi if self.side * (second.sign or first.sign) < 0 else -pi

    def outside(self, m: house.State, move: Move, onward: Onward) -> None:
        """Before an arc, or where the way goes on all but straight, nobody looks whether the move leads backwards."""
        assert self.held is not None and self.held.move.element is not None and move.element is not None
        turn = self.corner(self.held.move.element, move.element)
        looks = move.element.center is None and turn < -m.dialect.cutter.straight
        self.release(m, self.held.path.end, onward, checked=looks)

    def cut_back(self, m: house.State, held: Held, move: Move, path: Element) -> Point:
        """The meeting that stays the corner's while the corner closes, near or not. Raises Refusal."""
        first = held.guide
        if first.center is path.center is None:
            return super().cut_back(m, held, move, path)
        found = crossings(first, path)
        if not found:
            raise self.gouging(m, held.move, move)
        if first.center is None or path.center is None:
            inside = (first.sign or path.sign) * self.side > 0
            later = inside == (first.center is None)  # along the line
        else:
            later = first.sign * path.sign * self.side > 0  # to the left of the way between the centers
        return found[-1 if later else 0]

    def check(self, m: house.State, held: Held, end: Point) -> None:
        """The entry may end anywhere."""
        if not held.first:
            super().check(m, held, end)

    def write(self, m: house.State, move: Move, end: Point, center: Point | None, turns: int, onward: Onward) -> None:
        super().write(m, move._replace(line=m.out.line, file=m.out.file), end, center, turns, onward)

    def flush(self, m: Any, *, onward: Onward) -> None:
        """What is held ends square to its end."""
        self.flushed = self.held or self.flushed
        super().flush(m, onward=onward)
        self.free_behind(m, self.tool, onward)

    def free_behind(self, m: house.State, end: Point, onward: Onward) -> None:
        """Write the moves out of the plane behind a flush."""
        for move in self.behind:
            m.out.free(lambda move=move: self.write(m, move, end, None, 0, onward))  # type: ignore[misc]
        self.behind = []

    def straighten(self, held: Held) -> None:
        """The corner is then that of a line which goes on as the move did."""
        element = held.move.element
        assert element is not None
        (u, v), (du, dv) = element.end, heading(element, element.end)
        line = Element((u - du, v - dv), (u, v))
        path = offset(line, self.side * self.radius)
        assert path is not None
        self.flushed = held._replace(move=held.move._replace(element=line), path=path, guide=path)

    def join(self, m: house.State, move: Move, onward: Onward) -> None:
        """Behind a flush LinuxCNC works out the corner as ever, though the move before it has been made.

        But an arc back along a line is always an outside corner, and behind an inside corner the next move may end
        anywhere, unless a move out of the plane is between.
        """
        held = self.flushed
        if self.held is not None or held is None or move.element is None:
            super().join(m, move, onward)
            return
        assert held.move.element is not None
        path = guide = self.beside(m, move)
        angle = self.corner(held.move.element, move.element)
        if angle == pi and held.path.center is not None and path.center is None:
            angle = -pi
        straight = m.dialect.cutter.straight
        unchecked = angle > straight and not self.behind
        if angle > straight:
            place = self.cut_back(m, held, move, path)
            path = path._replace(start=place)
            self.free_behind(m, place, onward)
        else:
            self.free_behind(m, self.tool, onward)
            if angle < -straight:
                self.around(m, move, path.start, onward)
            else:
                path = path._replace(start=held.path.end)
        self.hold(m, move, path, guide, held.move, unchecked)

    def led(self, m: State) -> list[float] | None:
        """Where the tool's center is led to, as far as that is known, in the program's frame; None before the entry."""
        if self.held is None and not (self.entered and self.written):
            return None
        place = self.back(m, m.to_space(m.position)[:6])
        place[self.u], place[self.v] = self.tool if self.held is None else self.held.path.end
        return m.to_program(self.home(m, place))

    def back(self, m: State, place: Place) -> Place:
        """From machine coordinates to where the tool is led."""
        return place

    def home(self, m: State, place: Place) -> Place:
        """The way back from there."""
        return place


class Turned(Beside):
    """In G18 the plane turns with the work system about Z: the tool is led in the system as it was before."""

    def __init__(self, m: State, radius: float, side: int, shift: tuple[float, float]) -> None:
        super().__init__(m, radius, side, shift)
        self.angle = m.rotation
        self.moved = m.turned(m.origin[0], m.origin[1], -self.angle)[0] - m.origin[0]  # the origin's X
        self.contour = self.back(m, self.contour)
        self.tool = self.flat(self.contour)

    def back(self, m: State, place: Place) -> Place:
        return [*m.turned(place[0], place[1], -self.angle), *place[2:]]

    def home(self, m: State, place: Place) -> Place:
        return [*m.turned(place[0], place[1], self.angle), *place[2:]]

    def shifted(self, center: Point, by: float) -> Point:
        """A center with its X moved."""
        return center[0] + by * (self.u == 0), center[1] + by * (self.v == 0)

    def wrapped(self, onward: Onward) -> Onward:
        def line(m: Any, kind: int, end: Place, speed: float, flags: int) -> None:
            onward.line(m, kind, self.home(m, end), speed, flags)

        def arc(m: Any, end: Place, center: Point, turns: int, speed: float, flags: int) -> None:
            onward.arc(m, self.home(m, end), self.shifted(center, -self.moved), turns, speed, flags)

        return Onward(line, arc)

    def line(self, m: Any, kind: int, end: Place, speed: float, flags: int, *, onward: Onward) -> None:
        super().line(m, kind, self.back(m, end), speed, flags, onward=self.wrapped(onward))

    def arc(self, m: Any, end: Place, center: Point, turns: int, speed: float, flags: int, *, onward: Onward) -> None:
        center = self.shifted(center, self.moved)
        super().arc(m, self.back(m, end), center, turns, speed, flags, onward=self.wrapped(onward))

    def flush(self, m: Any, *, onward: Onward) -> None:
        super().flush(m, onward=self.wrapped(onward))

    def give_up(self, m: Any, move: Move) -> None:
        super().give_up(m, move)
        m.position = m.to_program(self.home(m, move.end))

    def trace(self, m: Any, move: Move) -> None:
        element, contour = move.element, self.contour
        if element is not None and element.center is not None:
            element = element._replace(center=self.shifted(element.center, -self.moved))
        self.contour = self.home(m, contour)
        super().trace(m, move._replace(end=self.home(m, move.end), element=element))
        self.contour = contour


@contextmanager
def threaded(stage: Any) -> Iterator[None]:
    """The move meanwhile is a thread."""
    stage.threads = isinstance(stage, Beside)
    try:
        yield
    finally:
        stage.threads = False


def begin(m: State, side: int, radius: float, orientation: int) -> None:
    """Put the stage in force; a radius below zero changes sides. Raises Refusal."""
    if m.cutter:
        raise Refusal(F.UNDER_COMPENSATION, what="G41 or G42")
    if m.plane_code not in (170, 180):
        raise wrong("compensation needs G17 or G18")
    if radius < 0.0:
        side, radius = -side, -radius
    said(m, f"cutter radius compensation on {'left' if side > 0 else 'right'}")
    m.cutter = 41 if side > 0 else 42
    m.out.at_once = AT_ONCE
    if not 0 <= orientation < len(SHIFTS):
        m.warn(F.LOOSE_VALUE, word="orientation ", value=orientation, wanted="0 to 9: the tool counts as round")
        orientation = 0
    shift = (SHIFTS[orientation][0] * radius, SHIFTS[orientation][1] * radius)
    if radius:
        stage = (Turned if m.rotation and m.plane else Beside)(m, radius, side, shift)
        stage.contour = stage.contour[:6]
        path.set_stage(m, SLOT, stage)


def of_table(side: int, m: State, w: Words) -> None:
    """G41, G42: by the diameter of the tool D, or of that in the spindle. Raises Refusal."""
    slot = 0
    if "d" in w:
        number = round(w["d"])
        if abs(w["d"] - number) >= EQUAL or number < 0:
            raise Refusal(F.BAD_VALUE, "d", word="D", value=w["d"], wanted="a tool's number")
        slot = m.slot_of(number)
    tool = m.slots[slot]
    if tool.p3 not in (0.0, 9.0) and m.plane_code != 180:
        raise Refusal(F.COMPENSATION_L, "d")
    begin(m, side, tool.diameter / 2.0, int(tool.p3) if m.plane == 1 else 0)


def dynamic(side: int, m: State, w: Words) -> None:
    """G41.1, G42.1: by the diameter D; L is the orientation of a lathe tool. Raises Refusal."""
    if "d" not in w:
        raise Refusal(F.MISSING_WORD, code="G41.1", word="D", meaning="the diameter")
    orientation = whole("l", w.get("l", 0.0))
    if "l" in w and m.plane != 1:
        raise Refusal(F.COMPENSATION_L, "l")
    begin(m, side, m.length(w, "d") / 2.0, orientation)


def off(m: State, w: Words) -> None:
    """G40."""
    if m.cutter:
        stage = m.stages.get(SLOT)
        path.flush(m)
        m.arc_refused = getattr(stage, "entered", False)
        if isinstance(stage, Beside) and stage.entered and stage.written is not None:
            m.told = m.to_program(stage.home(m, stage.written))
        path.set_stage(m, SLOT, Leaving() if m.arc_refused else None)
    m.cutter = 0
    said(m, "cutter radius compensation off")


code = partial(Code, group=Group.CUTTER, order=Order.CUTTER)

CODES = (
    code("G40", "Compensation off", off),
    code("G41", "Compensation left", partial(of_table, +1), takes="dl"),
    code("G42", "Compensation right", partial(of_table, -1), takes="dl"),
    code("G41.1", "Compensation left by a diameter given", partial(dynamic, +1), takes="dlr"),
    code("G42.1", "Compensation right by a diameter given", partial(dynamic, -1), takes="dlr"),
)
