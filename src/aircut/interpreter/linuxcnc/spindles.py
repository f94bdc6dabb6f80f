"""Spindles: their speeds, ways, modes and overrides. A machine has one, or as many as its INI file says.

Most codes mean spindle 0 where no $ word stands. Cycles, threads and feeds a revolution go with the chosen one: that
of the last G93 to G97, or of a later thread or tapping cycle with a $.

Sources: 001 Spindle Control; the canonical listing, section 5; LinuxCNC's interpreter where they are silent.
"""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from aircut.diagnostics import Refusal
from aircut.diagnostics import faults as F
from aircut.interpreter.table import Code, Group, Order, Words

if TYPE_CHECKING:
    from aircut.interpreter.linuxcnc.state import State

STANDING = 5
COMMANDS = {3: "START_SPINDLE_CLOCKWISE", 4: "START_SPINDLE_COUNTERCLOCKWISE", STANDING: "STOP_SPINDLE_TURNING"}
UNLIMITED = 1e30  # rpm of G96 without D


class Spindle:
    """What is in force of one spindle."""

    __slots__ = ("css", "direction", "most", "speed")

    def __init__(self) -> None:
        self.direction = STANDING  # number of the M code
        self.speed = 0.0  # revolutions a minute; under G96 meters (G20: feet) a minute
        self.css = False  # G96
        self.most = 0.0  # revolutions a minute, its D


def spindle_of(m: State, w: Words) -> int:
    """The $ word, its whole part; 0 without one. Raises Refusal where the machine has no such spindle."""
    number = int(w.get("$", 0.0))
    if not 0 <= number < len(m.spindles):
        last = len(m.spindles) - 1
        wanted = f"the machine has the spindles 0 to {last}" if last else "the machine has one spindle, 0"
        raise Refusal(F.BAD_VALUE, "$", word="$", value=w["$"], wanted=wanted)
    return number


def spindles_of(m: State, w: Words) -> range:
    """The same, and for -1 all of them. Raises Refusal."""
    if int(w.get("$", 0.0)) == -1:
        return range(len(m.spindles))
    number = spindle_of(m, w)
    return range(number, number + 1)


def choose(m: State, w: Words) -> int:
    """Cycles, threads and feeds a revolution go with the spindle of this block. Raises Refusal."""
    m.chosen = spindle_of(m, w)
    return m.chosen


def speed_word(m: State, w: Words) -> None:
    """S. Raises Refusal."""
    for number in spindles_of(m, w):
        m.spindles[number].speed = w["s"]
        m.out.event("SET_SPINDLE_SPEED", number, w["s"])


def turn_spindle(direction: int, m: State, w: Words) -> None:
    """M3, M4, M5. Raises Refusal."""
    for number in spindles_of(m, w):
        m.spindles[number].direction = direction
        m.out.event(COMMANDS[direction], number)


def stop_all(m: State) -> None:
    """Before a tool change all spindles stop."""
    for number, spindle in enumerate(m.spindles):
        spindle.direction = STANDING
        m.out.event("STOP_SPINDLE_TURNING", number)


def constant_surface(m: State, w: Words) -> None:
    """G96: the S word is a surface speed, D the highest number of revolutions. Raises Refusal."""
    number = choose(m, w)
    spindle = m.spindles[number]
    spindle.css = True
    spindle.most = abs(w["d"]) if "d" in w else UNLIMITED
    m.out.event("SET_SPINDLE_MODE", number, spindle.most)


def constant_revolutions(m: State, w: Words) -> None:
    """G97. Raises Refusal."""
    number = choose(m, w)
    m.spindles[number].css = False
    m.out.event("SET_SPINDLE_MODE", number, 0.0)


def orient(m: State, w: Words) -> None:
    """M19: turn the spindle to R degrees, and wait for it with Q; LinuxCNC takes all for standing. Raises Refusal."""
    number = spindle_of(m, w)
    for spindle in m.spindles:
        spindle.direction = STANDING
    if "r" in w or "p" in w:
        m.out.event("ORIENT_SPINDLE", number, w.get("r", 0.0) + m.ini.orient, int(w.get("p", 0.0)))
    if "q" in w:
        if w["q"] <= 0.0:
            raise Refusal(F.BAD_VALUE, "q", word="Q", value=w["q"], wanted="seconds above zero")
        m.out.event("WAIT_ORIENT_COMPLETE", number, w["q"])


def check_orient(m: State, w: Words) -> None:
    """Raises Refusal."""
    if "r" in w and not 0.0 <= w["r"] <= 360.0:
        raise Refusal(F.BAD_VALUE, "r", word="R", value=w["r"], wanted="0 to 360 degrees")
    if "p" in w and round(w["p"]) not in (0, 1, 2):
        raise Refusal(F.BAD_VALUE, "p", word="P", value=w["p"], wanted="0, 1 or 2")


def overridden(m: State, w: Words) -> range:
    """The spindles of M51: all without a $, else one that is not the first. Raises Refusal."""
    if "$" not in w:
        return range(len(m.spindles))
    number = int(w["$"])
    if not 0 < number < len(m.spindles):
        wanted = "a later one than spindle 0: without $ M51 is for all spindles, and LinuxCNC refuses 0"
        raise Refusal(F.BAD_VALUE, "$", word="$", value=w["$"], wanted=wanted)
    return range(number, number + 1)


CODES = (
    Code("G96", "Constant surface speed", constant_surface, Group.SPINDLE_MODE, Order.SPINDLE_MODE,
         takes="d$", needs="s"),
    Code("G97", "Constant revolutions", constant_revolutions, Group.SPINDLE_MODE, Order.SPINDLE_MODE),
    *(Code(f"M{n}", "Spindle", partial(turn_spindle, n), Group.SPINDLE, Order.SPINDLE, takes="$") for n in (3, 4, 5)),
    Code("M19", "Orient the spindle", orient, Group.SPINDLE, Order.SPINDLE,
         takes="rpq$", counts="p", check=check_orient),
)  # fmt: skip

ITEMS = (Code("S", "Spindle speed", speed_word, Group(0), Order.SPEED, takes="$"),)
