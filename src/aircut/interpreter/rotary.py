"""Rotary axes: roll-over, the display, indexers.

Degrees all. The machine's axis is never rolled: it counts its turns, and what a
program says is brought into one turn when its target is found and its position read.

Sources: 000 sections 7.1 and 9; decisions AMB-ROT-1 to AMB-ROT-7, AMB-FEED-7.
"""

from __future__ import annotations

from collections.abc import Callable
from math import copysign
from typing import TYPE_CHECKING

from aircut.canon import Kind
from aircut.diagnostics import Refusal
from aircut.diagnostics import faults as F
from aircut.interpreter.table import AXES

if TYPE_CHECKING:
    from aircut.interpreter.state import State
    from aircut.interpreter.table import Words

FIRST = 3  # index of A among the axes
ROTARY = AXES[FIRST:]
NEAR = 1e-9  # degrees by which sums of angles may miss a whole turn


def turned(angle: float, modulus: float) -> float:
    """An angle within one rotation, from 0 up to the modulus."""
    rest = angle % modulus
    return 0.0 if rest < NEAR or modulus - rest < NEAR else rest


def in_one_turn(value: float, here: float, modulus: float) -> float:
    """Mode 1: travel within one turn, never across its ends (AMB-ROT-1)."""
    return turned(value, modulus) - turned(here, modulus)


def nearest(value: float, here: float, modulus: float) -> float:
    """Mode 2: travel the shorter way, half a turn forward (AMB-ROT-3)."""
    forward = turned(value - here, modulus)
    return forward - modulus if forward > modulus / 2.0 + NEAR else forward


def by_sign(value: float, here: float, modulus: float) -> float:
    """Mode 3: the sign is the direction, that of a written -0 too (AMB-ROT-4)."""
    direction = copysign(1.0, value)
    return direction * turned(direction * (abs(value) - here), modulus)


#: Travel by rotary mode: of a programmed value, the position it starts from, and the modulus.
TRAVEL: dict[float, Callable[[float, float, float], float]] = {1.0: in_one_turn, 2.0: nearest, 3.0: by_sign}


def roll(m: State, w: Words, goal: list[float]) -> None:
    """Put the targets of axes that roll over into goal; for absolute words of the program's frame."""
    for i, (axis, mode) in enumerate(zip(ROTARY, m.rotary_modes, strict=True), FIRST):
        if mode and axis in w:
            goal[i] = m.position[i] + TRAVEL[mode](w[axis], m.position[i], m.rotary_modulus)


def position(m: State, i: int) -> float:
    """#5004 to #5006: the position of A, B or C, within one turn where it rolls over (AMB-ROT-2)."""
    here = m.position[FIRST + i]
    return turned(here, m.rotary_modulus) if m.rotary_modes[i] else here


def displayed(m: State) -> list[float]:
    """The position as a display shows it: axes with `wrapped_rotary` within one rotation (AMB-ROT-7)."""
    shown = m.position[:]
    for i, axis in enumerate(ROTARY, FIRST):
        if axis in m.machine.axes and m.machine.axes[axis].wrapped_rotary:
            shown[i] = turned(shown[i], m.rotary_modulus)
    return shown


def set_parameter(m: State, number: int, value: float) -> bool:
    """G10 L100 of #5801 to #5804; False for a value that it cannot have (AMB-ROT-6)."""
    if number == 5801:
        if value <= 0.0:
            return False
        m.rotary_modulus = value
    else:
        if value and value not in TRAVEL:
            return False
        m.rotary_modes[number - 5802] = value
        m.rollover = any(m.rotary_modes)
    return True


def indexers(m: State) -> tuple[int, ...]:
    """The axes that may move only alone, and only by G0."""
    axes = m.machine.axes
    return tuple(i for i, axis in enumerate(AXES) if axis in axes and axes[axis].motion_mode == "indexing")


def check_indexers(m: State, kind: int, goal: list[float]) -> None:
    """Refuse a move that turns an indexer otherwise than alone and by G0 (AMB-FEED-7). Raises Refusal."""
    moved = [i for i in range(6) if abs(goal[i] - m.position[i]) > NEAR]
    for i in m.indexers:
        if i in moved and (kind != Kind.TRAVERSE or len(moved) > 1):
            others = "".join(AXES[j] for j in moved if j != i).upper()
            how = f"together with {others}" if kind == Kind.TRAVERSE else "in a feed move"
            raise Refusal(F.INDEXER, AXES[i], axis=AXES[i].upper(), how=how)
