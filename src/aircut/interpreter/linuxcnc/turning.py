"""Rotary axes that an INI file lets wrap or locks, and moves made exactly to their end.

A wrapped axis reads a word below 360 degrees in absolute moves: its sign, that of -0 too, is
the way to turn. A locked one (an indexer) moves alone, by traverses only.
Learnt by running LinuxCNC's stand-alone interpreter.
"""

from __future__ import annotations

from math import copysign, floor
from typing import TYPE_CHECKING

from aircut.canon import EXACT_PATH
from aircut.diagnostics import Refusal
from aircut.diagnostics import faults as F
from aircut.interpreter.linuxcnc.state import NINE, State

if TYPE_CHECKING:
    from aircut.interpreter.table import Words

TURN = 360.0  # degrees


def check_turns(m: State, w: Words) -> None:
    """Raises Refusal where the word of a wrapped axis is a turn or more."""
    for i in m.ini.wrapped:
        letter = NINE[i]
        if letter in w and abs(w[letter]) >= TURN:
            wanted = "below 360 degrees either way: the axis wraps"
            raise Refusal(F.BAD_VALUE, letter, word=letter.upper(), value=w[letter], wanted=wanted)


def unwound(here: float, angle: float, way: float) -> float:
    """Where an axis at `here` ends that turns to an angle, in the direction of the sign of `way`. Degrees."""
    angle = abs(angle)
    if copysign(1.0, way) > 0.0:
        return angle + TURN * -floor((angle - here) / TURN)
    return angle + TURN * floor((here - angle) / TURN)


def wrap(m: State, w: Words, place: list[float]) -> None:
    """Put wrapped axes named in an absolute move where they turn to. Raises Refusal."""
    check_turns(m, w)
    for i in m.ini.wrapped:
        letter = NINE[i]
        if letter in w:
            place[i] = unwound(m.position[i], w[letter], w[letter])


def wrap_machine(m: State, i: int, here: float, angle: float) -> float:
    """Where a wrapped axis at `here` ends, in the program's frame, that turns to an angle of the machine."""
    return unwound(here, angle - m.origin[i] - m.shift[i] - m.tool_offset[i], angle)


def bar_indexers(m: State, w: Words) -> None:
    """Raises Refusal where a locked axis is named in another move than G0."""
    for i in m.ini.indexers:
        if NINE[i] in w:
            raise Refusal(F.INDEXER, NINE[i], axis=NINE[i].upper(), how="by G0")


def indexed(m: State, w: Words) -> bool:
    """Whether a traverse turns a locked axis. Raises Refusal where another axis moves with it."""
    named = [i for i in m.ini.indexers if NINE[i] in w]
    if named and sum(letter in w for letter in (*NINE, "@", "^")) > 1:
        axis = NINE[named[0]]
        raise Refusal(F.INDEXER, axis, axis=axis.upper(), how="alone")
    return bool(named)


def begin_exact(m: State) -> int:
    """Moves end exactly from here on; what `end_exact` wants."""
    if m.path_mode != 61:
        m.out.event("SET_MOTION_CONTROL_MODE", "EXACT_PATH")
    flags, m.flags = m.flags, EXACT_PATH
    return flags


def end_exact(m: State, flags: int) -> None:
    """The path mode is what it was."""
    m.flags = flags
    if m.path_mode == 611:
        m.out.event("SET_MOTION_CONTROL_MODE", "EXACT_STOP")
        m.out.event("SET_NAIVECAM_TOLERANCE", m.thinning)
    elif m.path_mode == 64:
        tell_blending(m)


def tell_blending(m: State) -> None:
    """The tolerances of G64."""
    m.out.event("SET_MOTION_CONTROL_BLEND", m.blend)
    m.out.event("SET_NAIVECAM_TOLERANCE", m.thinning)
