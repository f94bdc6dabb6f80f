"""The fast lane under tool center point control.

`kernels.plain` reads the lines as ever, but its rows, which hold the tip, go to a scratch
memory; `kernels.follow` makes of them what the stage of interpreter.rtcp would, to the last
bit. Where a move asks for more (an arc, a limit in the way, very many pieces), the lines up
to it are read once more, so that the state is that before it.
"""

from __future__ import annotations

from array import array
from bisect import bisect_right
from math import inf
from typing import TYPE_CHECKING, Any

from aircut.canon import CHUNK, EXACT_STOP, PART, ROW, TIP, Kind
from aircut.interpreter.rtcp import TOLERANCE, Control
from aircut.kernels import bounds, follow, plain

if TYPE_CHECKING:
    from aircut.interpreter.lane import Lane
    from aircut.interpreter.state import State
    from aircut.source import Source

LEAST, MOST = 64, 4096  # lines tried at a time: more after success
FLAGS = 48  # bits before the flags of a row
STRAIGHT = int(Kind.FEED)
NOWHERE = array("d", [-inf] * 6 + [inf] * 6)  # limits are those of the axes, not of the tip
FEW = 4096


def alone(m: State) -> Control | None:
    """The stage, where no other works on moves."""
    stage = m.stages.get("rtcp")
    return stage if isinstance(stage, Control) and len(m.stages) == 1 else None


class Tipping:
    """Scratch memory and the number of lines to try next."""

    def __init__(self) -> None:
        self.memory: Any = None
        self.firsts = array("q", [0] * (MOST + 1))
        self.before = array("d", [0.0] * 6)
        self.lines = LEAST

    def run(self, lane: Lane, m: State, control: Control, source: Source, line: int, end: int) -> int:
        """As Lane.run."""
        if self.memory is None:
            self.memory = memoryview(bytearray(MOST * ROW.size))
        tips, marks = self.memory.cast("d"), self.memory.cast("q")
        start = array("d", m.to_space(m.position))
        self.read(lane, m, source, line, min(end, line + self.lines))
        numbers = lane.numbers
        moves = numbers[plain.ROWS]
        facts, firsts, out = control.facts, self.firsts, m.out
        straight = follow.share(facts, start, tips, marks, moves, TOLERANCE, STRAIGHT, CHUNK, firsts)
        rows = firsts[straight]
        space = out.space(rows)
        doubles = space.cast("d")
        follow.stretch(
            facts, start, tips, marks, straight, firsts, TIP << FLAGS, PART << FLAGS, EXACT_STOP << FLAGS, self.before,
            doubles, space.cast("q"),
        )  # fmt: skip
        within = bounds.outside(doubles, 0, rows, array("d", m.space_box))
        if within < rows:
            straight = bisect_right(firsts, within, 0, straight) - 1
            rows = firsts[straight]
        if straight < moves:  # the number of the line is the row's first integer
            self.lines = LEAST
            stop = (marks[plain.WIDTH * straight + 9] & 0xFFFFFFFF) - 1
            self.read(lane, m, source, line, stop)
        else:
            self.lines = min(2 * self.lines, MOST)
        after = numbers[plain.LINE]
        if after > line:
            lane.settle(m, after)
            out.fill(rows, FEW)
            lane.tell(m, out.moves - rows, firsts)
        return after

    def read(self, lane: Lane, m: State, source: Source, line: int, end: int) -> None:
        """Read lines into the scratch memory."""
        lane.prepare(m, line, NOWHERE)
        lane.read(source, end, self.memory)
