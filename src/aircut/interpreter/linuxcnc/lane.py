"""The fast lane in LinuxCNC's language: where it may run, and what is its own there.

Source: the canonical listing, sections 7, 10 and 11.
"""

from __future__ import annotations

from array import array

from aircut.interpreter import lane, leading
from aircut.interpreter import state as house
from aircut.interpreter.linuxcnc.state import FAULTS, State
from aircut.interpreter.linuxcnc.text import LONGEST
from aircut.interpreter.path import RECORDER
from aircut.interpreter.table import AXES
from aircut.kernels import plain

LEAST = 0.03  # mm: no arc of this radius whose radii differ by plain.MISMATCH has one that is too small


class Lane(lane.Lane):
    """Runs stretches of one state."""

    def open(self, m: house.State) -> bool:
        """Whether plain motion means here what the kernel knows."""
        assert isinstance(m, State)
        return (
            self.known(m)
            and (m.way is RECORDER or leading.alone(m) is not None)
            and m.feed_mode == 94
            and not m.stale
            and not m.arc_refused
            and not m.diameter
            and m.rotation == 0.0
            and m.ini.plain
            and not (m.auxiliary and m.to_space(m.position)[6:] != m.led)
            and m.plane_code % 10 == 0
            and not any(m.numbered[number] for number in FAULTS)
        )

    def letters(self, m: house.State) -> int:
        """Axes that may be named, by bits."""
        return sum(1 << i for i, axis in enumerate(AXES) if axis in m.axes)

    def prepare(self, m: house.State, line: int, box: array[float]) -> None:
        """Tell the kernel where the state stands. box: lowest and highest places, six each."""
        assert isinstance(m, State)
        m.offset = m.origin[:6]
        m.feed = m.gave_feed * m.unit
        super().prepare(m, line, box)
        self.numbers[plain.ALONE] = plain.STAYS
        self.numbers[plain.LONGEST] = LONGEST - len("\r\n")
        self.reals[plain.LEAST] = LEAST
        self.reals[plain.SAID] = m.gave_feed
        self.reals[plain.ZERO] = 0.0
        self.reals[plain.SHIFT : plain.REALS] = array("d", m.shift[:6])

    def settle(self, m: house.State, after: int) -> None:
        """Bring the state up to date; `after` is the line to go on with."""
        assert isinstance(m, State)
        m.position[:6] = self.reals[plain.POSITION : plain.OFFSET]
        m.gave_feed = self.reals[plain.SAID]
        m.feed = m.gave_feed * m.unit
        if self.numbers[plain.ROWS]:
            m.told = m.position[:]
            m.cycle = None
        m.line = m.out.line = after
