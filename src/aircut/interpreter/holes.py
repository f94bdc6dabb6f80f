"""The fast lane of canned cycles: lines that name the next hole's place and nothing else.

The general lane drills a hole; where that leads from a height back to the same, its rows
and events are the pattern of those that follow.
"""

from __future__ import annotations

from array import array
from typing import TYPE_CHECKING, Any

from aircut.canon import BY_HAND, ROW, Kind
from aircut.geometry.arcs import PLANE_AXES
from aircut.kernels import holes, plain

if TYPE_CHECKING:
    from aircut.interpreter.lane import Lane
    from aircut.interpreter.state import State
    from aircut.source import Source

MOST = 4096  # holes at a time
ROWS = 64  # of a pattern, at most
AXES = 6
LINE, KIND, FLAGS = 9, 13, 15  # columns of a row


class Holes:
    """The pattern of the last hole, and where the program was when it was taken."""

    def __init__(self) -> None:
        self.line = -1  # that may go on with the pattern
        self.counts = (-1, -1)  # moves and events told, then
        self.start: tuple[float, ...] = ()
        self.pattern = b""
        self.events: list[tuple[int, int, tuple[Any, ...]]] = []  # of the pattern: move, name and values
        self.places = memoryview(bytearray(MOST * ROW.size))

    def run(self, lane: Lane, m: State, source: Source, line: int, end: int) -> int:
        """As Lane.run: a first line of holes alone is only watched."""
        out = m.out
        moves, told = counts = (out.moves, len(out.events))
        if line == self.line and not self.pattern:
            self.pattern = self.taken(m, moves - self.counts[0])
            self.events = out.events.since(self.counts[1], self.counts[0])
        elif line != self.line or moves != self.counts[0]:
            self.pattern = b""
        if not self.pattern:
            self.read(lane, m, source, line, line + 1)
            bare = lane.numbers[plain.ROWS] == 1
            self.line, self.counts, self.start = (line + 1 if bare else -1), counts, out.end()
            return line
        end = min(end, line + MOST)
        self.read(lane, m, source, line, end)
        first, second, _ = PLANE_AXES[m.plane]
        found, size = lane.numbers[plain.ROWS], len(self.pattern) // ROW.size
        space = out.space(found * size)
        pattern = memoryview(self.pattern)
        places, marks = self.places.cast("d"), self.places.cast("q")
        drilled = holes.repeat(
            places, marks, found, pattern.cast("d"), pattern.cast("q"), first, second, space.cast("d"), space.cast("q")
        )
        if drilled < found:  # up to there, once more, so that the position is that before it
            at = ROW.unpack_from(self.places, drilled * ROW.size)[LINE] - 1
            self.read(lane, m, source, line, at)
        after = lane.numbers[plain.LINE]
        if after > line:
            lane.drilled(m, after)
            out.fill(drilled * size, 0)
            lines = [ROW.unpack_from(self.places, hole * ROW.size)[LINE] for hole in range(drilled)]
            out.tell_pattern(self.events, moves, size, lines)
        self.line, self.counts = after, (out.moves, told)
        if drilled:
            last = ROW.unpack_from(self.places, (drilled - 1) * ROW.size)
            self.pattern = moved(self.pattern, first, last[first], second, last[second])
        return after

    def read(self, lane: Lane, m: State, source: Source, line: int, end: int) -> None:
        """Read places, as traverses of the plane's axes."""
        low, high = m.bounds()
        lane.prepare(m, line, array("d", low + high))
        first, second, _ = PLANE_AXES[m.plane]
        lane.numbers[plain.AXES] &= 1 << first | 1 << second
        lane.numbers[plain.BARE] = True
        lane.read(source, end, self.places)
        lane.numbers[plain.BARE] = False

    def taken(self, m: State, count: int) -> bytes:
        """The rows of the last hole, if they can be a pattern."""
        rows = m.out.rows
        if not 0 < count <= ROWS or len(rows) < count * ROW.size:
            return b""
        found = bytes(rows[len(rows) - count * ROW.size :])
        unpacked = list(ROW.iter_unpack(found))
        first, second, _ = PLANE_AXES[m.plane]
        at = unpacked[0]
        still = [i for i in range(AXES) if i not in (first, second)]
        if (
            at[KIND] == Kind.TRAVERSE
            and (at[first], at[second]) != (self.start[first], self.start[second])
            and all((row[first], row[second]) == (at[first], at[second]) for row in unpacked)
            and not any(row[KIND] == Kind.ARC or row[FLAGS] & BY_HAND for row in unpacked)
            and all(row[i] == self.start[i] for row in (at, unpacked[-1]) for i in still)
            and sum(row[:AXES] == at[:AXES] for row in unpacked[:2]) == 1
        ):
            return found
        return b""


def moved(pattern: bytes, first: int, u: float, second: int, v: float) -> bytes:
    """The pattern at another place."""
    rows = array("d", pattern)
    width = ROW.size // 8
    for at in range(0, len(rows), width):
        rows[at + first], rows[at + second] = u, v
    return rows.tobytes()
