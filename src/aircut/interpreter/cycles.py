"""Canned cycles: for each, a row and a generator of steps along the tool's axis.

They know no modes and no dialect; `drilling` carries them out.

Sources: 000 section 6; canonical listing, section 13; decisions AMB-CYC-2, AMB-CYC-7.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from enum import Enum, auto
from typing import NamedTuple


class Do(Enum):
    """What a step of a cycle is."""

    RAPID = auto()  # to a height
    FEED = auto()  # to a height
    BY_HAND = auto()  # to a height: the operator moves there
    DWELL = auto()  # seconds
    STOP_SPINDLE = auto()
    START_SPINDLE = auto()
    PAUSE = auto()
    # LinuxCNC's own
    REVERSE_SPINDLE = auto()
    ORIENT = auto()
    ASIDE = auto()  # 1: beside the hole's axis, 0: back on it
    OVERRIDES_OFF = auto()
    OVERRIDES_ON = auto()


class Hole(NamedTuple):
    """One hole; heights and lengths along the tool's axis, program units."""

    clear: float  # where to leave it to
    top: float  # the R plane
    bottom: float
    dwell: float  # seconds
    bite: float
    gap: float  # way back to break a chip, and kept from what is left to cut
    middle: float = 0.0  # of back boring: up to where


Step = tuple[Do, float]
Steps = Callable[[Hole], Iterator[Step]]


class Cycle(NamedTuple):
    """One cycle."""

    name: str
    title: str
    steps: Steps
    takes: str = ""  # P, Q beside the words that all take
    turning: bool = False  # the spindle must turn, as it is stopped and started


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
