"""The fast lane: stretches of plain motion run in a kernel, from bytes to rows.

It may run where nothing stands between the words and the recorder; `kernels.plain`
stops before the first line that asks for more, and the general lane goes on there.
"""

from __future__ import annotations

from array import array
from typing import TYPE_CHECKING

from aircut.canon import CHUNK
from aircut.interpreter.path import RECORDER
from aircut.interpreter.table import AXES
from aircut.kernels import plain
from aircut.source import POWERS

if TYPE_CHECKING:
    from aircut.interpreter.state import State
    from aircut.source import Source

MOTIONS = ("G0", "G1", "G2", "G3")
FEW = 4096  # rows up to which they join those of the general lane


class Lane:
    """Runs stretches of one state; `rows` are those that the last one left in the recorder's arena."""

    def __init__(self, m: State, kept: int) -> None:
        """kept: about how many rows will be kept in memory; 0 where chunks are not."""
        self.numbers = array("q", [0] * plain.NUMBERS)
        self.reals = array("d", [0.0] * plain.REALS)
        self.feeds = array("d", [0.0] * FEW)
        self.feed_places = array("q", [0] * (2 * FEW))
        self.motions = [m.dialect.codes[name.lower()] for name in MOTIONS]
        m.out.room = kept

    def open(self, m: State) -> bool:
        """Whether plain motion means here what the kernel knows."""
        return (
            m.way is RECORDER
            and m.frame is None
            and m.macro is None
            and not m.polar
            and not m.inverse_time
            and m.motion in self.motions
        )

    def letters(self, m: State) -> int:
        """Axes that may be named, by bits; rotary ones only where nothing is particular about them."""
        turning = m.rollover or m.indexers or m.surface_feed or m.unit != 1.0
        return sum(1 << i for i, axis in enumerate(AXES) if axis in m.axes and (i < 3 or not turning))

    def run(self, m: State, source: Source, line: int, end: int) -> int:
        """Run lines from `line` up to `end` as far as they go; returns the one to go on with."""
        out = m.out
        numbers, reals = self.numbers, self.reals
        numbers[plain.LINE] = line
        assert m.motion is not None
        numbers[plain.MOTION] = self.motions.index(m.motion)
        numbers[plain.ABSOLUTE] = m.absolute
        numbers[plain.ARC_ABSOLUTE] = m.arc_absolute
        numbers[plain.PLANE] = m.plane
        numbers[plain.FLAGS] = m.flags
        numbers[plain.TOOL] = m.tool
        numbers[plain.FILE] = out.file
        numbers[plain.AXES] = self.letters(m)
        numbers[plain.RADIUS] = numbers[plain.ALONE] = True
        reals[plain.POSITION : plain.OFFSET] = array("d", m.position)
        reals[plain.OFFSET : plain.LOW] = array("d", m.offset)
        low, high = m.bounds()
        reals[plain.LOW : plain.HIGH] = array("d", low)
        reals[plain.HIGH : plain.UNIT] = array("d", high)
        reals[plain.UNIT] = m.unit
        reals[plain.FEED] = m.feed
        space = out.space(min(end - line, CHUNK))
        plain.run(
            source.data, source.starts, min(end, source.ended), numbers, reals, space.cast("d"), space.cast("q"),
            self.feeds, self.feed_places, POWERS, plain.PLACES,
        )  # fmt: skip
        after = numbers[plain.LINE]
        if after > line:
            m.position = list(reals[plain.POSITION : plain.OFFSET])
            m.feed = reals[plain.FEED]
            out.fill(numbers[plain.ROWS], FEW)
            if told := numbers[plain.FEEDS]:
                m.feed_told = m.feed
                first = out.moves - numbers[plain.ROWS]
                rows, lines = self.feed_places[: 2 * told : 2], self.feed_places[1 : 2 * told : 2]
                out.tell_feeds([first + row for row in rows], lines, self.feeds[:told])
            m.line = out.line = after
        return after

    @property
    def motion(self) -> int:
        """Of MOTIONS, the one in force after the last stretch."""
        return self.numbers[plain.MOTION]
