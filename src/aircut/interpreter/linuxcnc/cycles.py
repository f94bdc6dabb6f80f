"""Canned cycles of LinuxCNC's language: those of the house, tapping and back boring, and how they are led.

Words and heights are numbers of the program and stay so through a change of units.
Source: the canonical listing, section 13.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from typing import NamedTuple

from aircut.canon import BY_HAND
from aircut.diagnostics import Refusal
from aircut.diagnostics import faults as F
from aircut.geometry.arcs import PLANE_AXES
from aircut.interpreter.cycles import (
    Do,
    Hole,
    Step,
    Steps,
    bore,
    bore_and_dwell,
    bore_and_stop,
    bore_manual_out,
    break_chips,
    clear_chips,
    drill,
    drill_and_dwell,
)
from aircut.interpreter.drilling import DEPTH, Sticky
from aircut.interpreter.linuxcnc.arranging import given
from aircut.interpreter.linuxcnc.motion import CENTER_WORDS, FEED, TRAVERSE, go, goal, steady_speed, wrong
from aircut.interpreter.linuxcnc.spindles import COMMANDS, choose
from aircut.interpreter.linuxcnc.state import NINE, State
from aircut.interpreter.linuxcnc.turning import begin_exact, end_exact
from aircut.interpreter.state import INCH
from aircut.interpreter.table import Code, Group, Order, Words

CHIP_GAP = {1.0: 0.254, INCH: 0.01}  # program units
OTHER_WAY = {3: 4, 4: 3}
ORIENTATION = {3: 2, 4: 3}  # mode of ORIENT_SPINDLE by the way the spindle turned
MOST = 1_000_000  # bites of one block


class Cycle(NamedTuple):
    """One cycle."""

    name: str
    title: str
    steps: Steps
    needs: str = ""  # words beside R and the depth
    takes: str = "l"
    turning: tuple[int, ...] = ()  # ways in which the spindle must turn


def tap(hole: Hole) -> Iterator[Step]:
    """G74, G84: down, and up with the spindle turning the other way; nobody may override the feed."""
    yield Do.OVERRIDES_OFF, 0.0
    yield Do.FEED, hole.bottom
    yield Do.STOP_SPINDLE, 0.0
    yield Do.REVERSE_SPINDLE, 0.0
    yield Do.DWELL, hole.dwell
    yield Do.FEED, hole.clear
    yield Do.STOP_SPINDLE, 0.0
    yield Do.START_SPINDLE, 0.0
    yield Do.OVERRIDES_ON, 0.0


def bore_back(hole: Hole) -> Iterator[Step]:
    """G87: through the hole beside its axis, then up at feed, and back the same way."""
    yield Do.ASIDE, 1.0
    yield Do.STOP_SPINDLE, 0.0
    yield Do.ORIENT, 0.0
    yield Do.RAPID, hole.bottom
    yield Do.ASIDE, 0.0
    yield Do.START_SPINDLE, 0.0
    yield Do.FEED, hole.middle
    yield Do.FEED, hole.bottom
    yield Do.STOP_SPINDLE, 0.0
    yield Do.ORIENT, 0.0
    yield Do.ASIDE, 1.0
    yield Do.RAPID, hole.clear
    yield Do.ASIDE, 0.0
    yield Do.START_SPINDLE, 0.0


def run(cycle: Cycle, m: State, w: Words) -> None:
    """Run a cycle at each of its places. Raises Refusal before anything has moved."""
    normal = axes_of(m)[2]
    check(cycle, m, w)
    if m.plane_code != 170:  # another plane since the block began: polar words lead nowhere
        w = {letter: value for letter, value in w.items() if letter not in "@^"}
    sticky = remember(cycle, normal, m, w)
    again = m.cycle is not None and m.cycle.name == cycle.name
    hole = measure(sticky, normal, m)
    repeats = int(w.get("l", 1.0))
    if repeats < 1:
        raise Refusal(F.BAD_VALUE, "l", word="L", value=repeats, wanted="how often, from 1")
    if hole.bite > 0.0 and repeats * (hole.top - hole.bottom) > MOST * hole.bite:
        raise Refusal(F.BAD_VALUE, "q", word="Q", value=hole.bite, wanted="so many bites are a mistake")
    m.cycle = sticky
    drive(cycle, hole, sticky, repeats, again, m, w)


def check(cycle: Cycle, m: State, w: Words) -> None:
    """Refuse a cycle that the modes or words forbid."""
    for letter in NINE[:3] if m.plane_code % 10 else NINE[6:]:
        if letter in w:
            raise wrong(f"{letter.upper()} moves in {cycle.name}, whose plane is of the other axes")
    if m.feed_mode == 93:
        raise Refusal(F.CYCLE_INVERSE_TIME, code=cycle.name)
    if m.gave_feed <= 0.0:
        raise Refusal(F.MISSING_FEED)
    if m.cutter:
        raise Refusal(F.CYCLE_COMPENSATION, code=cycle.name)


def axes_of(m: State) -> tuple[int, int, int]:
    """The axes of the plane, and the tool's axis across it."""
    u, v, normal = PLANE_AXES[m.plane]
    return (u + 6, v + 6, normal + 6) if m.plane_code % 10 else (u, v, normal)


def check_words(cycle: Cycle, m: State, w: Words) -> None:
    """Raises Refusal."""
    for letter in "abc":
        if letter in w:
            raise Refusal(F.CYCLE_ROTARY, letter, code=cycle.name, axis=letter.upper())


def remember(cycle: Cycle, normal: int, m: State, w: Words) -> Sticky:
    """The words in force, those of this block included. Raises Refusal where R or the depth is missing."""
    axis = NINE[normal]
    before = m.cycle
    words = m.sticky
    again = before is not None and before.name == cycle.name
    words |= {letter: w[letter] for letter in "rpqijk" if given(w, letter)}
    if axis in w:
        words[DEPTH] = w[axis] / 2.0 if normal == 0 and m.diameter else w[axis]
    for letter in (axis, "r"):
        if not again and letter not in w:
            raise Refusal(F.MISSING_WORD, code=cycle.name, word=letter.upper(), meaning="")
    kept = None if before is None else before.level
    level = m.position[normal] / m.unit if kept is None else kept
    return Sticky(cycle.name, level, dict(words))


def measure(sticky: Sticky, normal: int, m: State) -> Hole:
    """The hole that the words in force mean. Raises Refusal."""
    words = sticky.words
    top, bottom = words["r"], words[DEPTH]
    middle = words.get(CENTER_WORDS[normal % 3], 0.0)
    if not m.absolute:
        top += sticky.level
        bottom += top
        middle += bottom
    if top < bottom:
        raise Refusal(F.CYCLE_BELOW, "r", code=sticky.name, r=top, bottom=bottom, axis=NINE[normal].upper())
    bite = words.get("q", 0.0)
    clear = max(top, sticky.level) if m.retract == 98 else top
    return Hole(clear, top, bottom, words.get("p", 0.0), bite, CHIP_GAP[m.unit], middle)


def drive(cycle: Cycle, hole: Hole, sticky: Sticky, repeats: int, again: bool, m: State, w: Words) -> None:
    """Move: to each place, down to R, and the steps there. Raises Refusal where P, Q, I, J or K is missing or wrong."""
    u, v, normal = axes_of(m)
    across = {letter: value for letter, value in w.items() if letter != NINE[normal]}
    height = m.position[normal] / m.unit
    if m.position[normal] == hole.top * m.unit:  # led there by the hole before: inches from mm may be a last bit off
        height = hole.top
    if sticky.level < hole.top:
        to_height(m, TRAVERSE, hole.top)
        height = hole.top
        hole = hole._replace(clear=hole.top)
    flags = begin_exact(m)
    if not again:
        for letter in cycle.needs:
            if not given(w, letter):
                raise Refusal(F.MISSING_WORD, code=cycle.name, word=letter.upper(), meaning="")
    if cycle.steps is tap and "$" in w:
        choose(m, w)
    number = m.chosen
    spindle = m.spindles[number]
    for at in range(repeats):
        if at or height <= hole.top:
            height = hole.clear
        if at == 0 or not m.absolute:
            target = goal(m, across, directed=False)
        place = target[:]
        place[normal] = height * m.unit
        go(m, TRAVERSE, place)
        if height > hole.top:
            to_height(m, TRAVERSE, hole.top)
        if "q" in cycle.needs and hole.bite <= 0.0:
            raise Refusal(F.BAD_VALUE, "q", word="Q", value=hole.bite, wanted="the depth of a bite is above zero")
        if cycle.turning and spindle.direction not in cycle.turning:
            raise Refusal(F.CYCLE_SPINDLE, code=cycle.name)
        center = m.position[u], m.position[v]
        aside = [sticky.words.get(CENTER_WORDS[i % 3], 0.0) * m.unit for i in (u, v)]
        overridden = tuple(m.followed)
        for do, value in cycle.steps(hole):
            match do:
                case Do.RAPID:
                    to_height(m, TRAVERSE, value)
                case Do.FEED if cycle.steps is tap:
                    tap_to_height(cycle, m, value)
                case Do.FEED:
                    to_height(m, FEED, value)
                case Do.BY_HAND:
                    by_hand(m, value)
                case Do.ASIDE:
                    place = m.position[:]
                    place[u], place[v] = center[0] + value * aside[0], center[1] + value * aside[1]
                    go(m, TRAVERSE, place)
                case Do.DWELL:
                    m.out.event("DWELL", value)
                case Do.STOP_SPINDLE:
                    m.out.event("STOP_SPINDLE_TURNING", number)
                case Do.START_SPINDLE:
                    m.out.event(COMMANDS[spindle.direction], number)
                case Do.REVERSE_SPINDLE:
                    m.out.event(COMMANDS[OTHER_WAY[spindle.direction]], number)
                case Do.ORIENT:
                    m.out.event("ORIENT_SPINDLE", number, 0.0, ORIENTATION[spindle.direction])
                case Do.PAUSE:
                    m.out.event("PROGRAM_STOP")
                case Do.OVERRIDES_OFF:
                    m.follow_feed(False)
                    m.follow_speed(False, number)
                case Do.OVERRIDES_ON:
                    if overridden[0]:
                        m.follow_feed(True)
                    if overridden[1]:
                        m.follow_speed(True, number)
    end_exact(m, flags)


def tap_to_height(cycle: Cycle, m: State, height: float) -> None:
    """A feed of a tap. LinuxCNC turns its axes into the plane once more: outside G17 the tool is led aside.

    It knows nothing of that: from the position that was meant it goes on. Raises Refusal in planes of U, V and W.
    """
    if m.plane_code % 10:
        raise wrong(f"{cycle.name} taps along X, Y and Z only")
    u, v, normal = axes_of(m)
    meant = m.position[:]
    meant[normal] = height * m.unit
    place = meant[:]
    place[u], place[v], place[normal] = meant[:3]
    if place != meant:
        m.warn(F.TAPPED_ASIDE, code=cycle.name)
    go(m, FEED, place, steady_speed(m))
    m.position = meant


def by_hand(m: State, height: float) -> None:
    """The operator leads the tool out: nothing is printed."""
    told = m.told
    m.flags |= BY_HAND
    to_height(m, TRAVERSE, height)
    m.flags &= ~BY_HAND
    m.told = told


def to_height(m: State, kind: int, height: float) -> None:
    """Move along the tool's axis to a height, program units."""
    place = m.position[:]
    place[axes_of(m)[2]] = height * m.unit
    go(m, kind, place, steady_speed(m) if kind == FEED else 0.0)


CYCLES = (
    Cycle("G73", "Drill, breaking chips", break_chips, "q"),
    Cycle("G74", "Tap left-handed", tap, "", "p", turning=(4,)),
    Cycle("G81", "Drill", drill),
    Cycle("G82", "Drill and dwell", drill_and_dwell, "p"),
    Cycle("G83", "Drill, clearing chips", clear_chips, "q"),
    Cycle("G84", "Tap right-handed", tap, "", "pl", turning=(3,)),
    Cycle("G85", "Bore, feed out", bore),
    Cycle("G86", "Bore, spindle stop, rapid out", bore_and_stop, "p", turning=(3, 4)),
    Cycle("G87", "Back bore", bore_back, "ijk", turning=(3, 4)),
    Cycle("G88", "Bore, spindle stop, manual out", bore_manual_out, "p", turning=(3, 4)),
    Cycle("G89", "Bore, dwell, feed out", bore_and_dwell, "p"),
)

CODES = tuple(
    Code(cycle.name, cycle.title, partial(run, cycle), Group.MOTION, Order.MOTION,
         takes="r" + cycle.needs + cycle.takes, axes=True, needs_axes=True, modal=True, cycle=True,
         check=partial(check_words, cycle))
    for cycle in CYCLES
)  # fmt: skip
