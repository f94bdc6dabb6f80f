"""Straight moves, arcs, probing and reference points of LinuxCNC's language.

Sources: 001; the canonical listing, sections 7, 10, 11 and 14.
"""

from __future__ import annotations

from collections.abc import Generator
from functools import partial
from math import atan2, cos, hypot, radians, sin, sqrt, tau
from typing import Any

from aircut.canon import EXACT_STOP, INVERSE_TIME, Kind
from aircut.diagnostics import Refusal
from aircut.diagnostics import faults as F
from aircut.geometry import arcs
from aircut.interpreter.linuxcnc.state import G28, G30, NINE, NUMBERED_NINE, PROBED, TRIPPED, State
from aircut.interpreter.linuxcnc.turning import (
    TURN,
    bar_indexers,
    begin_exact,
    check_turns,
    end_exact,
    indexed,
    wrap,
    wrap_machine,
)
from aircut.interpreter.probing import FAILURES, SUCCESS
from aircut.interpreter.requests import Probe as ProbeRequest
from aircut.interpreter.requests import Probed, Request
from aircut.interpreter.state import INCH, PLANES
from aircut.interpreter.table import Code, Group, Order, Words
from aircut.interpreter.travel import SLACK

TRAVERSE, FEED, PROBE = int(Kind.TRAVERSE), int(Kind.FEED), int(Kind.PROBE)
CENTER_WORDS = "ijk"
INDEX = {letter: i for i, letter in NUMBERED_NINE}
TURNING = (3, 4, 5)  # A B C
SMALLEST = 0.00127  # mm: a radius below, or a half chord beyond R by more, is refused
SPREAD_SHARE = 0.001  # part of the larger radius by which an arc's radii may differ, beyond the INI's tolerance
SPREAD_MOST = 100  # but never this many times
SLOWEST = 0.1  # program units a minute
TINY = 1e-7
METER, FOOT = 1000.0, 304.8  # mm
BACK_OFF = {1.0: 0.254, INCH: 0.01}  # program units from the probed point, back towards the start
STILL = 1e-9  # mm; a shorter way is a rounding error


def wrong(what: str, hint: str = "") -> Refusal:
    return Refusal(F.WRONG_STATE, what=what, hint=hint)


def goal(m: State, w: Words, rapid: bool = False, directed: bool = True) -> list[float]:
    """Where the axis words lead, in the program's frame. Raises Refusal.

    directed: a polar radius alone needs a direction to keep; where it does not, X is taken.
    """
    if m.ini.indexers and not rapid:
        bar_indexers(m, w)
    if m.machine_frame:
        return machine_goal(m, w)
    place = m.position[:]
    absolute, unit = m.absolute, m.unit
    for letter, value in w.items():
        i = INDEX.get(letter, -1)
        if i >= 0:
            if i not in TURNING:
                value *= unit
                if i == 0 and m.diameter:
                    value /= 2.0
            place[i] = value + (0.0 if absolute else place[i])
    if m.ini.wrapped and m.absolute:
        wrap(m, w, place)
    if "@" in w or "^" in w:
        polar(m, w, place, directed)
    return place


def machine_goal(m: State, w: Words) -> list[float]:
    """G53: axis words in machine coordinates; axes not named stay. Raises Refusal for polar words."""
    if "@" in w or "^" in w:
        raise Refusal(F.UNUSED_WORD, "@" if "@" in w else "^", word="@ or ^")
    space = m.to_space(m.position)
    for i, letter in NUMBERED_NINE:
        if letter in w:
            space[i] = m.axis(w, i) - (m.tool_offset[i] if i not in (3, 4, 5) else 0.0)
    place = m.to_program(space)
    check_turns(m, w)
    for i in m.ini.wrapped:
        if NINE[i] in w:
            place[i] = wrap_machine(m, i, m.position[i], w[NINE[i]])
    return [place[i] if i < 2 or letter in w else m.position[i] for i, letter in NUMBERED_NINE] if m.rotation else [
        place[i] if letter in w else m.position[i] for i, letter in NUMBERED_NINE
    ]  # fmt: skip


def polar(m: State, w: Words, place: list[float], directed: bool) -> None:
    """@ radius and ^ angle, about the origin of X and Y. Raises Refusal."""
    x, y = m.position[0], m.position[1]
    origin = x == 0.0 and y == 0.0
    radius, angle = hypot(x, y), atan2(y, x)
    if m.absolute:
        if "@" in w and "^" not in w and origin and directed:
            raise wrong("a polar radius alone needs a direction, and X0 Y0 has none")
        radius = m.length(w, "@", radius)
        angle = radians(w["^"]) if "^" in w else angle
    else:
        if origin:
            raise wrong("an incremental polar move cannot start at X0 Y0")
        radius += m.length(w, "@")
        angle += radians(w.get("^", 0.0))
    place[0], place[1] = radius * cos(angle), radius * sin(angle)


def go(m: State, kind: int, place: list[float], speed: float = 0.0, flags: int | None = None) -> None:
    """Move straight to a point of the program's frame."""
    space = m.to_space(place)
    if m.auxiliary:
        lead(m, space)
    m.way.line(m, kind, space[:6], speed, m.flags if flags is None else flags)
    m.position = place
    m.told = place[:]


def lead(m: State, space: list[float]) -> None:
    """Tell where the next move leads U, V and W. Raises Refusal where that is beyond their travel."""
    if space[6:] == m.led:
        return
    for i, letter, axis in m.auxiliary:
        value = space[i] + m.tool_offset[i]
        if axis is not None and not axis.min - SLACK <= value <= axis.max + SLACK:
            limit, name = (axis.min, "min") if value < axis.min else (axis.max, "max")
            beyond = abs(value - limit) / m.unit
            unit = "in" if m.unit == INCH else "mm"
            m.warn(F.TRAVEL, letter, axis=letter.upper(), value=value / m.unit, beyond=beyond,
                   limit=limit / m.unit, name=name, unit=unit)  # fmt: skip
    m.led = space[6:]
    m.out.event("AUXILIARY_AXES", *m.led)


def length_of(m: State, place: list[float]) -> float:
    """Length of a move for inverse time: program units, or degrees where nothing else moves."""
    steps = [b - a for a, b in zip(m.position, place, strict=True)]
    for axes in ((0, 1, 2), (6, 7, 8)):
        linear = sqrt(sum(steps[i] ** 2 for i in axes)) / m.unit
        if linear > TINY:
            return linear
    return sqrt(sum(steps[i] ** 2 for i in (3, 4, 5)))


def speed_of(m: State, w: Words, what: str, length: float) -> float:
    """Speed of a feed move, mm/min; tells the feed under G93. Raises Refusal."""
    if m.feed_mode == 93:
        if "f" not in w:
            raise Refusal(F.INVERSE_TIME_FEED, "f")
        rate = max(SLOWEST, length * w["f"])
        m.gave_feed = rate
        m.feed = rate * m.unit
        m.out.event("SET_FEED_RATE", m.feed)
        return rate * m.unit
    if m.gave_feed <= 0.0:
        raise Refusal(F.MISSING_FEED)
    if m.feed_mode == 95:
        if m.spindles[m.chosen].speed <= 0.0:
            raise wrong("G95 needs a spindle speed", "program S")
        return m.gave_feed * m.unit * revolutions(m, w)
    return m.gave_feed * m.unit


def steady_speed(m: State) -> float:
    """Speed of a feed move of which nothing is asked, mm/min."""
    return m.gave_feed * m.unit * (m.spindles[m.chosen].speed if m.feed_mode == 95 else 1.0)


def revolutions(m: State, w: Words) -> float:
    """Revolutions a minute in a move; under G96 those at its middle, where S is meters (G20: feet) a minute."""
    spindle = m.spindles[m.chosen]
    if not spindle.css:
        return spindle.speed
    most = min(spindle.most, m.machine.spindle.max_speed)
    here = m.position[0]
    end = m.axis(w, 0) + (0.0 if m.absolute else here) if "x" in w else here
    around = tau * abs(here + end) / 2.0
    return min(most, spindle.speed * (FOOT if m.unit == INCH else METER) / around) if around else most


def check_feed(m: State, w: Words) -> None:
    """Raises Refusal where a feed move has no feed."""
    if m.feed_mode == 93:
        if "f" not in w:
            raise Refusal(F.INVERSE_TIME_FEED, "f")
    elif m.gave_feed <= 0.0:
        raise Refusal(F.MISSING_FEED)
    elif m.feed_mode == 95 and m.spindles[m.chosen].speed <= 0.0:
        raise wrong("G95 needs a spindle speed", "program S")


def feed_flags(m: State) -> int:
    return m.flags | (INVERSE_TIME if m.feed_mode == 93 else 0)


def straight(kind: int, m: State, w: Words) -> None:
    """G0 and G1. Raises Refusal."""
    if m.cutter and m.plane_code % 10:
        raise wrong("compensation goes on in planes of X, Y and Z only")
    if kind == FEED:
        check_feed(m, w)
    place = goal(m, w, kind == TRAVERSE)
    speed = 0.0
    if kind == FEED:
        speed = speed_of(m, w, "G1", length_of(m, place) if m.feed_mode == 93 else 0.0)
    if kind == TRAVERSE and m.ini.indexers and indexed(m, w):
        flags = begin_exact(m)
        go(m, kind, place)
        end_exact(m, flags)
        m.indexed = True
    else:
        go(m, kind, place, speed, feed_flags(m))
    m.arc_refused = False


def arc(turn: int, m: State, w: Words) -> None:
    """G2 (turn -1) and G3 (turn +1). Raises Refusal."""
    if m.arc_refused:
        raise wrong("the move after G40 must be straight")
    if m.plane_code % 10:
        raise wrong("arcs need a plane of X, Y and Z")
    check_feed(m, w)
    axes = arcs.PLANE_AXES[m.plane]
    u, v, across = axes
    if CENTER_WORDS[across] in w:
        raise Refusal(
            F.ARC_WRONG_CENTER, CENTER_WORDS[across], word=CENTER_WORDS[across].upper(), plane=PLANES[m.plane]
        )
    centered = any(letter in w for letter in CENTER_WORDS)
    if "r" in w and centered:
        raise Refusal(F.ARC_CENTER_AND_RADIUS, "r")
    turns = round(w.get("p", 1.0))
    if not 1 <= turns <= 32767:
        raise Refusal(F.BAD_VALUE, "p", word="P", value=turns, wanted="the number of turns, from 1")
    if "r" not in w and not centered:
        raise Refusal(F.ARC_NO_CENTER, code="G2" if turn < 0 else "G3", words="I, J, K")
    end = goal(m, w)
    here = (m.position[u], m.position[v])
    there = (end[u], end[v])
    if "r" in w:
        named = any(letter in w for letter in (*("xyz"[i] for i in (u, v)), *("@^" if m.plane == 0 else "")))
        if not named:
            raise Refusal(F.ARC_NO_END, "r")
        center = by_radius(m, w, turn, here, there)
    else:
        center = by_center(m, w, (CENTER_WORDS[u], CENTER_WORDS[v]), here, there)
    radius = hypot(here[0] - center[0], here[1] - center[1])
    around = radius * arcs.sweep(here, there, center, turn * turns)
    length = hypot(around, end[across] - m.position[across]) / m.unit
    speed = speed_of(m, w, "G2", length)
    space = m.to_space(end)
    if m.auxiliary:
        lead(m, space)
    m.way.arc(m, space[:6], center_in_space(m, u, v, center), turn * turns, speed, feed_flags(m))
    m.position = end
    m.told = end[:]


def center_in_space(m: State, u: int, v: int, center: tuple[float, float]) -> tuple[float, float]:
    """The center in machine coordinates; only in the XY plane can an arc follow a rotation about Z."""
    shifted = (center[0] + m.shift[u], center[1] + m.shift[v])
    if (u, v) == (0, 1):
        shifted = m.turned(*shifted, m.rotation)
    return shifted[0] + m.origin[u], shifted[1] + m.origin[v]


def by_center(
    m: State, w: Words, letters: tuple[str, str], here: tuple[float, float], there: tuple[float, float]
) -> tuple[float, float]:
    """Center from two of I, J, K, mm. Raises Refusal."""
    if m.arc_absolute:
        for letter in letters:
            if letter not in w:
                raise Refusal(F.MISSING_WORD, code="under G90.1, an arc", word=letter.upper(), meaning="")
        center = (m.length(w, letters[0]), m.length(w, letters[1]))
    else:
        center = (here[0] + m.length(w, letters[0]), here[1] + m.length(w, letters[1]))
    first = hypot(here[0] - center[0], here[1] - center[1])
    last = hypot(there[0] - center[0], there[1] - center[1])
    if first < SMALLEST or last < SMALLEST:
        raise Refusal(F.ARC_ZERO_RADIUS)
    gap = abs(first - last)
    spread = m.ini.tolerance[m.unit]
    if gap > SPREAD_MOST * spread or (gap > spread and gap > SPREAD_SHARE * max(first, last)):
        raise Refusal(F.ARC_RADIUS_MISMATCH, start=first / m.unit, end=last / m.unit, difference=gap / m.unit,
                      unit="in" if m.unit == INCH else "mm")  # fmt: skip
    return center


def by_radius(
    m: State, w: Words, turn: int, here: tuple[float, float], there: tuple[float, float]
) -> tuple[float, float]:
    """Center from R, mm. Raises Refusal."""
    if here == there:
        raise Refusal(F.ARC_SAME_END, "r")
    radius = m.length(w, "r")
    half = hypot(there[0] - here[0], there[1] - here[1]) / 2.0
    if half - abs(radius) > SMALLEST:
        unit = "in" if m.unit == INCH else "mm"
        raise Refusal(F.ARC_RADIUS_TOO_SMALL, "r", radius=w["r"], half=half / m.unit, unit=unit)
    center = arcs.center_of_radius(here, there, radius, turn, 2.0 * SMALLEST + half)
    assert center is not None
    return center


def cancel(m: State, w: Words) -> None:
    """G80."""
    m.out.event("COMMENT", "interpreter: motion mode set to none")


def machine_frame(m: State, w: Words) -> None:
    """G53: the axis words of this block are machine coordinates. Raises Refusal."""
    if m.cutter and "compensation" in m.stages:  # a radius of 0 bars nothing
        raise Refusal(F.UNDER_COMPENSATION, what="G53")
    m.machine_frame = True


def probe(toward: bool, alarm: bool, m: State, w: Words) -> Generator[Request, Any, None]:
    """G38.2 to G38.5: where nobody answers, the probe trips at the target. Raises Refusal."""
    if m.cutter:
        raise Refusal(F.PROBE_COMPENSATION)
    if m.feed_mode == 95:
        raise wrong("G38 is not possible under G95")
    place = goal(m, w)
    if m.gave_feed <= 0.0:
        raise Refusal(F.PROBE_NO_FEED)
    speed = m.gave_feed * m.unit
    if m.motion_name in ("g38.2", "g38.4") and all(a == b for a, b in zip(place, m.position, strict=True)):
        raise Refusal(F.PROBE_TOO_CLOSE)
    start = m.told
    m.out.event("TURN_PROBE_ON")
    aim = [s + o for s, o in zip(m.to_space(place), m.tool_offset, strict=True)]
    reply: Probed | None = yield ProbeRequest(tuple(m.machine_position()), tuple(aim), toward, m.slots[0].id, speed)
    if reply is not None:
        place = m.to_program([p - o for p, o in zip(reply.position, m.tool_offset, strict=True)])
    go(m, PROBE, place, speed, m.flags | EXACT_STOP)
    m.out.event("TURN_PROBE_OFF")
    for i in range(9):
        m.numbered[PROBED + i] = m.shown(i)
    m.numbered[TRIPPED] = float(reply is not None and reply.state == SUCCESS)
    m.stale = True
    if reply is not None:
        if reply.state == SUCCESS:
            m.logs.probed([m.shown(i) for i in range(9)])
        elif alarm:
            raise Refusal(F.PROBE_FAILED, reason=FAILURES[reply.state])
        return
    steps = [start[i] / m.unit - place[i] / m.unit for i in (0, 1, 2)]
    span = sqrt(sum(step * step for step in steps))
    if span > 0.0:
        off = BACK_OFF[m.unit] / span
        m.told = [place[i] + steps[i] * off * m.unit if i < 3 else place[i] for i in range(9)]


def go_home(stored: int, m: State, w: Words) -> None:
    """G28, G30: to the point given, then to the stored point, in the named axes if any are. Raises Refusal."""
    if m.cutter:
        raise Refusal(F.UNDER_COMPENSATION, what="G28 or G30")
    place = goal(m, w, rapid=True)
    index_and_go(m, place)
    home = home_of(m, stored)
    every = not any(letter in w for _, letter in NUMBERED_NINE)
    index_and_go(m, [home[i] if every or letter in w else place[i] for i, letter in NUMBERED_NINE])


def home_of(m: State, stored: int) -> list[float]:
    """A stored point in the program's frame, as it is reached from the present position."""
    place = m.stored(stored)
    home = m.to_program([h - (m.tool_offset[i] if i not in (3, 4, 5) else 0.0) for i, h in enumerate(place)])
    for i in m.ini.wrapped:
        home[i] = wrap_machine(m, i, m.position[i], place[i])
    return home


def index_and_go(m: State, place: list[float]) -> None:
    """Traverse to a point: first the locked axes, each alone."""
    for i in sorted(m.ini.indexers):
        if place[i] != m.position[i]:
            flags = begin_exact(m)
            go(m, TRAVERSE, [*m.position[:i], place[i], *m.position[i + 1 :]])
            end_exact(m, flags)
    go(m, TRAVERSE, place)


def store_home(stored: int, m: State, w: Words) -> None:
    """G28.1, G30.1: remember where the machine is. Raises Refusal."""
    if m.cutter:
        raise Refusal(F.UNDER_COMPENSATION, what="G28.1")
    m.store(stored, [p % TURN if i in m.ini.wrapped else p for i, p in enumerate(m.machine_position())])


move = partial(Code, group=Group.MOTION, order=Order.MOTION, axes=True, modal=True)
arc_move = partial(move, takes="ijkrp", wakes="ijk", counts="p", least=1)
single = partial(Code, group=Group.NON_MODAL, order=Order.NON_MODAL)

CODES = (
    move("G0", "Straight traverse", partial(straight, TRAVERSE)),
    move("G1", "Straight feed", partial(straight, FEED)),
    arc_move("G2", "Clockwise arc feed", partial(arc, -1)),
    arc_move("G3", "Counterclockwise arc feed", partial(arc, +1)),
    *(move(f"G38.{n}", "Straight probe", partial(probe, n < 4, n % 2 == 0), needs_axes=True) for n in (2, 3, 4, 5)),
    Code(
        "G53",
        "Machine coordinates, for one block",
        machine_frame,
        Group.NON_MODAL,
        Order.NON_MODAL,
        fits=("G0", "G1", "G5.2"),
    ),
    Code("G80", "Cancel the motion mode", cancel, Group.MOTION, Order.MOTION, modal=True, weak=True),
    single("G28", "Go to the G28 position", partial(go_home, G28), axes=True),
    single("G30", "Go to the G30 position", partial(go_home, G30), axes=True),
    single("G28.1", "Store the G28 position", partial(store_home, G28)),
    single("G30.1", "Store the G30 position", partial(store_home, G30)),
)
