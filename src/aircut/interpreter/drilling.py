"""Canned cycles carried out: what their words mean, where the holes are, and the way between them.

A cycle speaks the active plane's own axes, u and v across and w along the tool, so
G17, G18 and G19 share it. Its words are numbers of the program and stay so from one
block to the next, also through a change of units or of offsets (rs274 asked). Heights are
therefore program units here and become mm where a move is written.

Sources: 000 section 6; decisions AMB-CYC-1 to AMB-CYC-10, AMB-COD-12; what they leave
open is as rs274 does it.
"""

from __future__ import annotations

from collections.abc import Generator
from functools import partial
from typing import Any, NamedTuple

from aircut.canon import BY_HAND, EXACT_PATH
from aircut.diagnostics import Refusal
from aircut.diagnostics import faults as F
from aircut.geometry.arcs import PLANE_AXES
from aircut.interpreter.auxiliary import stop
from aircut.interpreter.cycles import CYCLES, Cycle, Do, Hole, Steps, bore_manual_out
from aircut.interpreter.feeding import feed_speed
from aircut.interpreter.motion import FEED, ROTARY_AXES, SAME, TRAVERSE, target, write
from aircut.interpreter.requests import Request
from aircut.interpreter.state import State, out_of_range, whole
from aircut.interpreter.table import AXES, Code, Group, Order, Words
from aircut.interpreter.travel import FAR

MOST = 1_000_000  # holes or bites of one block: beyond, a word is mistaken
LEAST_BITE = 1e-12  # of the height: floating-point numbers have no smaller steps
DEPTH = "w"  # key of the depth among the sticky words, whatever the tool's axis
STANDING = 5  # State.spindle after M5
STARTS = {3: "START_SPINDLE_CLOCKWISE", 4: "START_SPINDLE_COUNTERCLOCKWISE"}
MEANINGS = {
    "r": "R is the height from which feeding begins, as long as the cycle lasts",
    "q": "Q is the depth of one bite",
    DEPTH: "it is the bottom of the hole, as long as the cycle lasts",
}


class Sticky(NamedTuple):
    """What later blocks of a sequence of cycles have from those before."""

    name: str  # of the cycle: the next one needs words of its own
    level: float  # height at which the sequence began
    words: dict[str, float]  # R, P, Q and "w", the depth


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
    repeats = repeats_of(w)
    if hole.bite and repeats * (hole.top - hole.bottom) > MOST * hole.bite:
        raise out_of_range(sticky.words, "q", "so many bites are a mistake")
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
        if letter in w and abs(goal[i] - m.position[i]) > SAME:
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
    if "q" in cycle.takes:
        needed["q"] = MEANINGS["q"]
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
    for letter, key, height in (("r", "r", top), (AXES[normal], DEPTH, bottom)):
        if abs(height) * m.unit > FAR:
            value, wanted = words[key], "it leads beyond all machines"
            raise Refusal(F.BAD_VALUE, letter, word=letter.upper(), value=value, wanted=wanted)
    bite, dwell = words.get("q", 0.0), words.get("p", 0.0)
    if "q" in words and bite <= LEAST_BITE * max(abs(top), abs(bottom)):  # such a bite gets no deeper
        raise out_of_range(words, "q", "the depth of a bite is above zero")
    if dwell < 0.0:
        raise out_of_range(words, "p", "seconds, not negative")
    clear = top
    if m.modal[Group.RETRACT].name == "G98":
        clear = max(top, sticky.level)
    return Hole(clear, top, bottom, dwell, bite, m.machine.options.peck_retract / m.unit)


def repeats_of(w: Words) -> int:
    """The L word (AMB-CYC-5). Raises Refusal."""
    repeats = whole(w, "l") if "l" in w else 1
    if not 0 <= repeats <= MOST:
        raise out_of_range(w, "l", "how often, from 0")
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


def row(cycle: Cycle) -> Code:
    """The code of a cycle."""
    handler = conversation if cycle.steps is bore_manual_out else run
    return Code(
        cycle.name, cycle.title, partial(handler, cycle), Group.MOTION, Order.MOTION,
        takes="rl" + cycle.takes, axes=True, needs_axes=True, modal=True, cycle=True,
    )  # fmt: skip


CODES = tuple(row(cycle) for cycle in CYCLES)
