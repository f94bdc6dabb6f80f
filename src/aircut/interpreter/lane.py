"""The fast lane: stretches of plain motion run in a kernel, from bytes to rows.

It may run where nothing stands between the words and the recorder; `kernels.plain`
stops before the first line that asks for more, and the general lane goes on there.
"""

from __future__ import annotations

from array import array
from typing import TYPE_CHECKING

from aircut.canon import CHUNK
from aircut.interpreter import leading, tipping
from aircut.interpreter.holes import Holes
from aircut.interpreter.leading import Leading
from aircut.interpreter.path import RECORDER
from aircut.interpreter.table import AXES
from aircut.interpreter.tipping import Tipping
from aircut.kernels import plain
from aircut.source import POWERS

if TYPE_CHECKING:
    from aircut.interpreter.state import State
    from aircut.source import Source

MOTIONS = ("G0", "G1", "G2", "G3")
FEW = 4096  # rows up to which they join those of the general lane
NO_SHIFT = array("d", [-0.0] * 6)  # what changes no number at all


class Lane:
    """Runs stretches of one state; `rows` are those that the last one left in the recorder's arena."""

    def __init__(self, m: State, kept: int) -> None:
        """kept: about how many rows will be kept in memory; 0 where chunks are not."""
        self.numbers = array("q", [0] * plain.NUMBERS)
        self.reals = array("d", [0.0] * plain.REALS)
        self.feeds = array("d", [0.0] * FEW)
        self.feed_places = array("q", [0] * (2 * FEW))
        self.motions = [m.dialect.codes[name.lower()] for name in MOTIONS]
        self.tipping = Tipping()
        self.leading = Leading()
        self.holes = Holes()
        m.out.room = kept

    def open(self, m: State) -> bool:
        """Whether plain motion means here what the kernel knows."""
        return (
            (m.way is RECORDER or tipping.alone(m) is not None or leading.alone(m) is not None)
            and m.frame is None
            and m.macro is None
            and not m.polar
            and not m.inverse_time
            and self.known(m)
        )

    def known(self, m: State) -> bool:
        """Whether the motion mode is one of the kernels'."""
        if m.motion is not None and m.motion.cycle:
            return m.cycle is not None and m.absolute and m.way is RECORDER and not m.compensating
        return m.motion in self.motions

    def letters(self, m: State) -> int:
        """Axes that may be named, by bits; rotary ones only where nothing is particular about them."""
        surface = m.surface_feed and m.way is RECORDER  # under tool center point control F is that already
        turning = m.rollover or m.indexers or surface or m.unit != 1.0
        return sum(1 << i for i, axis in enumerate(AXES) if axis in m.axes and (i < 3 or not turning))

    def run(self, m: State, source: Source, line: int, end: int) -> int:
        """Run lines from `line` up to `end` as far as they go; returns the one to go on with."""
        assert m.motion is not None
        if m.motion.cycle:
            return self.holes.run(self, m, source, line, end)
        control = tipping.alone(m)
        if control is not None:
            return self.tipping.run(self, m, control, source, line, end)
        stage = leading.alone(m)
        if stage is not None:
            return self.leading.run(self, m, stage, source, line, end)
        out = m.out
        low, high = m.bounds()
        self.prepare(m, line, array("d", low + high))
        self.read(source, end, out.space(min(end - line, CHUNK)))
        after = self.numbers[plain.LINE]
        if after > line:
            rows = self.numbers[plain.ROWS]
            self.settle(m, after)
            out.fill(rows, FEW)
            self.tell(m, out.moves - rows)
        return after

    def prepare(self, m: State, line: int, box: array[float]) -> None:
        """Tell the kernel where the state stands. box: lowest and highest places, six each."""
        numbers, reals = self.numbers, self.reals
        numbers[plain.LINE] = line
        numbers[plain.MOTION] = self.motions.index(m.motion) if m.motion in self.motions else 0
        numbers[plain.ABSOLUTE] = m.absolute
        numbers[plain.ARC_ABSOLUTE] = m.arc_absolute
        numbers[plain.PLANE] = m.plane
        numbers[plain.FLAGS] = m.flags
        numbers[plain.TOOL] = m.tool
        numbers[plain.FILE] = m.out.file
        numbers[plain.AXES] = self.letters(m)
        numbers[plain.RADIUS] = True
        numbers[plain.ALONE] = plain.SETS
        reals[plain.POSITION : plain.OFFSET] = array("d", m.position[:6])
        reals[plain.OFFSET : plain.LOW] = array("d", m.offset)
        reals[plain.LOW : plain.UNIT] = box
        reals[plain.UNIT] = m.unit
        reals[plain.FEED] = m.feed
        reals[plain.LEAST] = plain.SMALL
        reals[plain.ZERO] = -0.0
        reals[plain.SHIFT : plain.REALS] = NO_SHIFT

    def read(self, source: Source, end: int, space: memoryview) -> None:
        """Let the kernel read lines, up to `end` at most, and write rows into the space."""
        self.numbers[plain.PLACE] = source.start(self.numbers[plain.LINE])
        plain.run(
            source.data, min(end, source.ended), self.numbers, self.reals, space.cast("d"),
            space.cast("q"), self.feeds, self.feed_places, POWERS, plain.PLACES,
        )  # fmt: skip
        source.passed(self.numbers[plain.LINE], self.numbers[plain.PLACE])

    def settle(self, m: State, after: int) -> None:
        """Bring the state up to date; `after` is the line to go on with."""
        m.position = list(self.reals[plain.POSITION : plain.OFFSET])
        m.feed = self.reals[plain.FEED]
        m.line = m.out.line = after

    def drilled(self, m: State, after: int) -> None:
        """As settle, after holes of one cycle."""
        cycle = m.cycle
        self.settle(m, after)
        m.cycle = cycle

    def tell(self, m: State, first: int, firsts: array[int] | None = None) -> None:
        """Tell the feeds met. first: the first move of the stretch. firsts: where rows became many: theirs."""
        if told := self.numbers[plain.FEEDS]:
            m.feed_told = m.feed
            rows, lines = self.feed_places[: 2 * told : 2], self.feed_places[1 : 2 * told : 2]
            if firsts is not None:
                rows = array("q", [firsts[row] for row in rows])
            m.out.tell_feeds([first + row for row in rows], lines, self.feeds[:told])

    @property
    def motion(self) -> int:
        """Of MOTIONS, the one in force after the last stretch."""
        return self.numbers[plain.MOTION]
