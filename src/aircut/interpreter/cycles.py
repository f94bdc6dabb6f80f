"""Canned cycles: for each, a row and a generator of steps along the tool's axis.

A cycle speaks the active plane's own axes, u and v across and w along the tool, so
G17, G18 and G19 share it. Its words are numbers of the program and stay so from one
block to the next, also through a change of units or of offsets (rs274 asked). Heights are
therefore program units here and become mm where a move is written.

Sources: 000 section 6; decisions AMB-CYC-1 to AMB-CYC-10, AMB-COD-12; what they leave
open is as rs274 does it.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterator
from enum import Enum, auto
from functools import partial
from typing import Any, NamedTuple

from aircut.canon import BY_HAND, EXACT_PATH
from aircut.diagnostics import Refusal
from aircut.diagnostics import faults as F
from aircut.geometry.arcs import PLANE_AXES
from aircut.interpreter.auxiliary import stop
from aircut.interpreter.feeding import feed_speed
from aircut.interpreter.motion import FEED, ROTARY_AXES, SAME, TRAVERSE, target, write
from aircut.interpreter.requests import Request
from aircut.interpreter.state import State, out_of_range, whole
from aircut.interpreter.table import AXES, Code, Group, Order, Words

MOST = 1_000_000  # holes or bites of one block: beyond, a word is mistaken
DEPTH = "w"  # key of the depth among the sticky words, whatever the tool's axis
STANDING = 5  # State.spindle after M5
STARTS = {3: "START_SPINDLE_CLOCKWISE", 4: "START_SPINDLE_COUNTERCLOCKWISE"}
MEANINGS = {
    "r": "R is the height from which feeding begins, as long as the cycle lasts",
    "q": "Q is the depth of one bite",
    "p": "P is the dwell in seconds",
    DEPTH: "it is the bottom of the hole, as long as the cycle lasts",
}


class Do(Enum):
    """What a step of a cycle is."""

    RAPID = auto()  # to a height
    FEED = auto()  # to a height
    BY_HAND = auto()  # to a height: the operator moves there
    DWELL = auto()  # seconds
    STOP_SPINDLE = auto()
    START_SPINDLE = auto()
    PAUSE = auto()


class Hole(NamedTuple):
    """One hole; heights and lengths along the tool's axis, program units."""

    clear: float  # where to leave it to
    top: float  # the R plane
    bottom: float
    dwell: float  # seconds
    bite: float
    gap: float  # way back to break a chip, and kept from what is left to cut


Step = tuple[Do, float]
Steps = Callable[[Hole], Iterator[Step]]


class Sticky(NamedTuple):
    """What later blocks of a sequence of cycles have from those before."""

    name: str  # of the cycle: the next one needs words of its own
    level: float  # height at which the sequence began
    words: dict[str, float]  # R, P, Q and "w", the depth


class Cycle(NamedTuple):
    """One cycle."""

    name: str
    title: str
    steps: Steps
    takes: str = ""  # P, Q beside the words that all take
    turning: bool = False  # the spindle must turn, as it is stopped and started


# --- the cycles


def drill(hole: Hole) -> Iterator[Step]:
    """G81: down, and out at rapid."""
    yield Do.FEED, hole.bottom
    yield Do.RAPID, hole.clear


def drill_and_dwell(hole: Hole) -> Iterator[Step]:
    """G82."""
    yield Do.FEED, hole.bottom
    yield Do.DWELL, hole.dwell
    yield Do.RAPID, hole.clear


def bites(hole: Hole) -> Iterator[float]:
    """The depths above the bottom at which a bite ends."""
    depth = hole.top - hole.bite
    while depth > hole.bottom:
        yield depth
        depth -= hole.bite


def break_chips(hole: Hole) -> Iterator[Step]:
    """G73: in bites, backing off a little after each to break the chip."""
    for depth in bites(hole):
        yield Do.FEED, depth
        yield Do.RAPID, depth + hole.gap
    yield from drill(hole)


def clear_chips(hole: Hole) -> Iterator[Step]:
    """G83: in bites, leaving the hole after each to clear the chips."""
    for depth in bites(hole):
        yield Do.FEED, depth
        yield Do.RAPID, hole.top
        yield Do.RAPID, depth + hole.gap
    yield from drill(hole)


def bore(hole: Hole) -> Iterator[Step]:
    """G85: down and up at feed."""
    yield Do.FEED, hole.bottom
    yield Do.FEED, hole.top
    yield Do.RAPID, hole.clear


def bore_and_stop(hole: Hole) -> Iterator[Step]:
    """G86: down, dwell, out at rapid with the spindle standing."""
    yield Do.FEED, hole.bottom
    yield Do.DWELL, hole.dwell
    yield Do.STOP_SPINDLE, 0.0
    yield Do.RAPID, hole.clear
    yield Do.START_SPINDLE, 0.0


def bore_manual_out(hole: Hole) -> Iterator[Step]:
    """G88: down, dwell, spindle off; the operator leads the tool out (AMB-CYC-2)."""
    yield Do.FEED, hole.bottom
    yield Do.DWELL, hole.dwell
    yield Do.STOP_SPINDLE, 0.0
    yield Do.PAUSE, 0.0
    yield Do.BY_HAND, hole.clear
    yield Do.START_SPINDLE, 0.0


def bore_and_dwell(hole: Hole) -> Iterator[Step]:
    """G89: down, dwell, out at feed."""
    yield Do.FEED, hole.bottom
    yield Do.DWELL, hole.dwell
    yield Do.FEED, hole.clear


# --- carrying them out


def run(cycle: Cycle, m: State, w: Words) -> None:
    """Run a cycle that has nothing to ask."""
    for _ in conversation(cycle, m, w):
        pass


def conversation(cycle: Cycle, m: State, w: Words) -> Generator[Request, Any, None]:
    """Run a cycle at each of its places. Raises Refusal before anything has moved."""
    normal = PLANE_AXES[m.plane][2]
    check(cycle, m, w)
    sticky = remember(cycle, normal, m, w)
    hole = measure(sticky, normal, m, w)
    repeats = repeats_of(m, w)
    if repeats * (hole.top - hole.bottom) > MOST * (hole.bite or 1e9):
        if hole.bite:
            raise out_of_range(sticky.words, "q", "so many bites are a mistake")
        raise out_of_range(sticky.words, "r", "it leads beyond all machines")
    m.cycle = sticky
    if repeats:
        yield from drive(cycle.steps, hole, sticky.level, repeats, m, w)


def check(cycle: Cycle, m: State, w: Words) -> None:
    """Refuse a cycle that the modes or the rotary words forbid (AMB-CYC-9)."""
    if m.inverse_time:
        raise Refusal(F.CYCLE_INVERSE_TIME, code=cycle.name)
    if m.modal[Group.CUTTER].name != "G40":
        raise Refusal(F.CYCLE_COMPENSATION, code=cycle.name)
    if cycle.turning and m.spindle == STANDING:
        raise Refusal(F.CYCLE_SPINDLE, code=cycle.name)
    goal = target(m, w) or m.position
    for i, letter in ROTARY_AXES:
        if letter in w and (not m.dialect.cycles.still or abs(goal[i] - m.position[i]) > SAME):
            raise Refusal(F.CYCLE_ROTARY, letter, code=cycle.name, axis=letter.upper())


def remember(cycle: Cycle, normal: int, m: State, w: Words) -> Sticky:
    """The words in force, those of this block included. Raises Refusal where one is missing (AMB-CYC-4)."""
    axis = AXES[normal]
    before = m.cycle
    words = dict(before.words) if before is not None and before.name == cycle.name else {}
    words |= {letter: w[letter] for letter in "rpq" if letter in w}
    if axis in w:
        words[DEPTH] = w[axis]
    needed = {"r": MEANINGS["r"], DEPTH: MEANINGS[DEPTH]}
    needed |= {letter: MEANINGS[letter] for letter in cycle.takes if letter == "q" or m.dialect.cycles.dwell}
    for letter, meaning in needed.items():
        if letter not in words:
            named = axis if letter == DEPTH else letter
            raise Refusal(F.MISSING_WORD, code=cycle.name, word=named.upper(), meaning=meaning)
    level = m.position[normal] / m.unit if before is None else before.level
    return Sticky(cycle.name, level, words)


def measure(sticky: Sticky, normal: int, m: State, w: Words) -> Hole:
    """The hole that the words in force mean. Raises Refusal."""
    words = sticky.words
    top, bottom = words["r"], words[DEPTH]
    if not m.absolute:
        top += sticky.level
        bottom += top
    if top < bottom:
        letter = "r" if "r" in w else AXES[normal]
        raise Refusal(F.CYCLE_BELOW, letter, code=sticky.name, r=top, bottom=bottom, axis=AXES[normal].upper())
    bite, dwell = words.get("q", 0.0), words.get("p", 0.0)
    if "q" in words and bite <= 0.0:
        raise out_of_range(words, "q", "the depth of a bite is above zero")
    if dwell < 0.0:
        raise out_of_range(words, "p", "seconds, not negative")
    clear = top
    if m.modal[Group.RETRACT].name == "G98":
        clear = max(top, sticky.level)
    return Hole(clear, top, bottom, dwell, bite, m.machine.options.peck_retract / m.unit)


def repeats_of(m: State, w: Words) -> int:
    """The L word (AMB-CYC-5). Raises Refusal."""
    repeats = whole(w, "l") if "l" in w else 1
    least = 0 if m.dialect.cycles.none else 1
    if not least <= repeats <= MOST:
        raise out_of_range(w, "l", f"how often, from {least}")
    return repeats


def drive(steps: Steps, hole: Hole, level: float, repeats: int, m: State, w: Words) -> Generator[Request, Any, None]:
    """Move: to each place, down to R, and the steps there.

    The first place is reached at the present height if that is above R, others at the height
    to which the last hole was left; from below R the tool is first drawn up (AMB-CYC-10).
    """
    normal = PLANE_AXES[m.plane][2]
    speed = feed_speed(m, w, 0.0)
    across = {letter: value for letter, value in w.items() if letter != AXES[normal]}
    flags = m.flags | EXACT_PATH
    height = m.position[normal] / m.unit
    if level < hole.top - SAME:
        height = hole.top
        hole = hole._replace(clear=height)
        go(m, TRAVERSE, None, height, 0.0, m.flags)
    if m.flags != EXACT_PATH:
        m.out.event("SET_MOTION_CONTROL_MODE", "EXACT_PATH")
    for at in range(repeats):
        if at or height <= hole.top + SAME:
            height = hole.clear
        go(m, TRAVERSE, target(m, across), height, 0.0, flags)
        if height > hole.top + SAME:
            go(m, TRAVERSE, None, hole.top, 0.0, flags)
        for do, value in steps(hole):
            match do:
                case Do.RAPID:
                    go(m, TRAVERSE, None, value, 0.0, flags)
                case Do.FEED:
                    go(m, FEED, None, value, speed, flags)
                case Do.BY_HAND:
                    go(m, TRAVERSE, None, value, 0.0, flags | BY_HAND)
                case Do.DWELL:
                    m.out.event("DWELL", value)
                case Do.STOP_SPINDLE:
                    m.out.event("STOP_SPINDLE_TURNING", 0)
                case Do.START_SPINDLE:
                    m.out.event(STARTS[m.spindle], 0)
                case Do.PAUSE:
                    yield from stop(0, "PROGRAM_STOP", m, w)
    if m.flags != EXACT_PATH:
        tell_path_mode(m)
        m.out.event("SET_NAIVECAM_TOLERANCE", m.thinning)


def go(m: State, kind: int, goal: list[float] | None, height: float, speed: float, flags: int) -> None:
    """Move to a height (program units) above a place, or above where the tool is."""
    place = m.position[:] if goal is None else goal
    place[PLANE_AXES[m.plane][2]] = height * m.unit
    write(m, kind, place, speed, flags)


def tell_path_mode(m: State) -> None:
    """The path mode in force, once more."""
    if m.flags:
        m.out.event("SET_MOTION_CONTROL_MODE", "EXACT_STOP")
    else:
        m.out.event("SET_MOTION_CONTROL_BLEND", m.blend)


CYCLES = (
    Cycle("G73", "Drill, breaking chips", break_chips, "q"),
    Cycle("G81", "Drill", drill),
    Cycle("G82", "Drill and dwell", drill_and_dwell, "p"),
    Cycle("G83", "Drill, clearing chips", clear_chips, "q"),
    Cycle("G85", "Bore, feed out", bore),
    Cycle("G86", "Bore, spindle stop, rapid out", bore_and_stop, "p", turning=True),
    Cycle("G88", "Bore, spindle stop, manual out", bore_manual_out, "p", turning=True),
    Cycle("G89", "Bore, dwell, feed out", bore_and_dwell, "p"),
)


def row(cycle: Cycle) -> Code:
    """The code of a cycle."""
    handler = conversation if cycle.steps is bore_manual_out else run
    return Code(
        cycle.name, cycle.title, partial(handler, cycle), Group.MOTION, Order.MOTION,
        takes="rl" + cycle.takes, axes=True, needs_axes=True, modal=True, cycle=True,
    )  # fmt: skip


CODES = tuple(row(cycle) for cycle in CYCLES)
