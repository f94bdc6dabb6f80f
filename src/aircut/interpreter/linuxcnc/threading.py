"""Moves that follow the spindle, in LinuxCNC's language: G33, G33.1, and the threading cycle G76.

Source: the canonical listing, section 13.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from functools import partial
from math import hypot, radians, tan

from aircut.canon import TOLD
from aircut.diagnostics import Refusal
from aircut.diagnostics import faults as F
from aircut.interpreter.cutter import SLOT
from aircut.interpreter.linuxcnc.arranging import given
from aircut.interpreter.linuxcnc.compensation import threaded
from aircut.interpreter.linuxcnc.motion import FEED, TRAVERSE, go, goal, steady_speed, wrong
from aircut.interpreter.linuxcnc.spindles import STANDING, choose
from aircut.interpreter.linuxcnc.state import State
from aircut.interpreter.table import Code, Group, Order, Words

ENTRY, EXIT = 1, 2  # bits of G76's L


def follows(m: State, w: Words, what: str) -> None:
    """Choose the spindle that they follow; it must turn. Raises Refusal."""
    if "$" in w:
        choose(m, w)
    if m.spindles[m.chosen].direction == STANDING:
        raise wrong(f"{what} needs a turning spindle", "program S and M3")


def beside(m: State, w: Words) -> bool:
    """Beside a contour G33, G33.1 and G76 are straight moves like others: no spindle is asked for. Raises Refusal."""
    stage = m.stages.get(SLOT)
    if stage is None or not m.cutter:  # behind G40 there still is one, for the first move
        return False
    with threaded(stage):
        go(m, FEED, goal(m, w), steady_speed(m))
    return True


def start(m: State, pitch: float) -> None:
    m.out.event("START_SPEED_FEED_SYNC", pitch, 0, m.chosen)


def stop(m: State) -> None:
    m.out.event("STOP_SPEED_FEED_SYNCH")


def check_synchronized(m: State, w: Words) -> None:
    """Raises Refusal."""
    if "f" in w:
        raise Refusal(F.UNUSED_WORD, "f", word="F")


def synchronized(m: State, w: Words) -> None:
    """G33: K is the way for a turn of the spindle. Raises Refusal."""
    if beside(m, w):
        return
    follows(m, w, "G33")
    pitch = m.length(w, "k")
    place = goal(m, w)
    start(m, pitch)
    go(m, FEED, place, abs(pitch) * m.spindles[m.chosen].speed)
    stop(m)


def rigid_tap(m: State, w: Words) -> None:
    """G33.1: down and back, the spindle turning the other way; the position stays. Raises Refusal."""
    if beside(m, w):
        return
    follows(m, w, "G33.1")
    place = goal(m, w)
    pitch = m.length(w, "k")
    here, told = m.position, m.told
    start(m, pitch)
    m.out.event("RIGID_TAP", *place[:3])
    go(m, FEED, [*place[:3], *here[3:]], abs(pitch) * m.spindles[m.chosen].speed, m.flags | TOLD)
    go(m, FEED, here, abs(pitch) * m.spindles[m.chosen].speed, m.flags | TOLD)
    m.position = [*here[:3], *place[3:]]  # for LinuxCNC the rotary axes have moved
    m.told = told
    stop(m)


def thread(m: State, w: Words) -> None:
    """G76: passes along Z, each deeper than the one before. Raises Refusal."""
    if beside(m, w):
        return
    follows(m, w, "G76")
    half = 2.0 if m.diameter else 1.0
    pitch = m.length(w, "p")
    peak, first, full = (m.length(w, letter) / half for letter in "ijk")
    degression, springs = max(w.get("r", 1.0), 1.0), int(w.get("h", 0.0))
    slant = tan(radians(w["q"])) if given(w, "q") else 0.0
    taper = m.length(w, "e")
    ends = int(w.get("l", 0.0)) & (ENTRY | EXIT) if taper > 0.0 else 0
    check_thread(m, w, first, full)
    peak = abs(peak)
    finish = goal(m, w)
    end = finish[2]
    pass_ = Pass(m, m.position[:], end, pitch, 1.0 if w["i"] > 0.0 else -1.0, peak, full, taper, ends)
    depths = [depth * m.unit for depth in depths_of(abs(w["i"]) / half, w["j"] / half, w["k"] / half, degression)]
    depths += [peak + full] * (1 + springs)
    for depth in depths:
        pass_.cut(depth, (depth - peak) * slant, full * slant)
    go(m, TRAVERSE, finish)


def depths_of(peak: float, first: float, full: float, degression: float) -> Iterator[float]:
    """Depths of the passes before the full one, below the drive line, in the program's unit: there a depth may be
    the full one or less by a rounding error, which is a pass more.
    """
    for count in itertools.count(1):
        depth = peak + first * count ** (1.0 / degression)
        if depth >= peak + full:
            return
        yield depth


def check_thread(m: State, w: Words, first: float, full: float) -> None:
    """Raises Refusal."""
    for letter in "abc":
        if letter in w and goal(m, w)["abc".index(letter) + 3] != m.position["abc".index(letter) + 3]:
            raise Refusal(F.CYCLE_ROTARY, letter, code="G76", axis=letter.upper())
    if w["i"] == 0.0:
        raise Refusal(F.BAD_VALUE, "i", word="I", value=0.0, wanted="the way to the thread's peak is not 0")
    if first <= 0.0 or full <= 0.0 or first >= full:
        raise Refusal(F.BAD_VALUE, "k", word="K", value=w["k"], wanted="the full depth, above J, which is above 0")


class Pass:
    """One pass of a thread and what all have in common; lengths mm."""

    def __init__(
        self, m: State, start: list[float], end: float, pitch: float, side: float, peak: float, full: float,
        taper: float, ends: int,
    ) -> None:  # fmt: skip
        self.m = m
        self.start = start
        self.end = end
        self.pitch = pitch
        self.side = side
        self.peak = peak
        self.full = full
        self.taper = taper
        self.ends = ends

    def to(self, kind: int, depth: float, z: float) -> None:
        """Go to a depth below the drive line, at Z."""
        m = self.m
        place = m.position[:]
        place[0], place[2] = self.start[0] + self.side * depth, z
        go(m, kind, place, self.pitch * m.spindles[m.chosen].speed if kind == FEED else 0.0)

    def cut(self, depth: float, shift: float, whole_shift: float) -> None:
        """A pass at a depth, shifted along Z so that the tool cuts on one side."""
        m = self.m
        forward = -1.0 if self.end < self.start[2] else 1.0
        z = self.start[2] + forward * shift
        end = self.end - forward * (whole_shift - shift)
        slope = self.pitch * hypot(self.taper, self.full) / self.taper if self.ends else self.pitch
        advance = forward * self.taper
        self.to(TRAVERSE, depth - self.peak - self.full, z)
        if not self.ends & ENTRY:
            self.to(TRAVERSE, depth, z)
        m.follow_feed(False)
        if self.ends & ENTRY:
            start(m, slope)
            self.to(FEED, depth - self.full, z)
            self.to(FEED, depth, z + advance)
        start(m, self.pitch)
        if self.ends & EXIT:
            self.to(FEED, depth, end - advance)
            start(m, slope)
            self.to(FEED, depth - self.full, end)
        else:
            self.to(FEED, depth, end)
        stop(m)
        self.to(TRAVERSE, depth - self.peak - self.full, end)
        m.follow_feed(True)


follow = partial(Code, group=Group.MOTION, order=Order.MOTION, axes=True, modal=True)

CODES = (
    follow(
        "G33",
        "Synchronized with the spindle",
        synchronized,
        takes="ke$",
        needs="k",
        needs_axes=True,
        check=check_synchronized,
    ),
    follow("G33.1", "Rigid tapping", rigid_tap, takes="kie$", needs="k", needs_axes=True, check=check_synchronized),
    follow("G76", "Threading cycle", thread, takes="pijkrqhel$", needs="pijk", needs_axes=True),
)
