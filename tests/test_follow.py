"""The kernel of tool center point control: built and twin alike, and as geometry.kinematics has it."""

from array import array
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from aircut.canon import ROW
from aircut.geometry.kinematics import Setup, inverse, pieces, straight
from aircut.interpreter.rtcp import control_of
from aircut.kernels import follow, twin
from test_kinematics import ANGLES, POINT, SETUP

TWIN = twin("follow", "follow_uncompiled")
ENDS = st.tuples(POINT, ANGLES)


def rows(kernel: Any, setup: Setup, start: tuple[float, ...], end: tuple[float, ...], count: int) -> bytes:
    facts = control_of(setup).facts
    memory = memoryview(bytearray((count + 1) * ROW.size))
    words = (7 | 3 << 32, 1 << 16 | 5 << 48, 1 << 16 | 9 << 48)
    kernel.follow(facts, array("d", start), array("d", end), 500.0, count, *words, memory.cast("d"), memory.cast("q"))
    return bytes(memory[ROW.size :])


@given(SETUP, ENDS, ENDS, st.integers(1, 6))
def test_the_twin_writes_the_same_bits(setup: Setup, start: Any, end: Any, count: int) -> None:
    ends = (*start[0], *start[1]), (*end[0], *end[1])
    assert rows(follow, setup, *ends, count) == rows(TWIN, setup, *ends, count)
    facts = control_of(setup).facts
    counts = [kernel.pieces(facts, array("d", ends[0]), array("d", ends[1]), 0.01) for kernel in (follow, TWIN)]
    assert counts[0] == counts[1]
    exact = pieces(setup, straight(setup, start[0], end[0]), start[1], end[1], 0.01)
    assert abs(counts[0] - exact) <= (1 if exact > 1 else 0)  # a whole number may be just missed


@given(SETUP, ENDS, ENDS, st.integers(1, 6))
def test_rows_are_where_kinematics_says(setup: Setup, start: Any, end: Any, count: int) -> None:
    data = rows(follow, setup, (*start[0], *start[1]), (*end[0], *end[1]), count)
    before = None
    for nth, row in enumerate(ROW.iter_unpack(data), 1):
        part = nth / count
        tip, angles = (
            [a + part * (b - a) for a, b in zip(*ends, strict=True)] for ends in zip(start, end, strict=True)
        )
        axes = [p - t for p, t in zip(inverse(setup, tip, angles), setup.tool, strict=True)]
        assert row[:3] == pytest.approx(axes, abs=1e-8)
        assert row[3:6] == pytest.approx(angles, abs=1e-9)
        assert row[6:8] == (0.0, 0.0)
        assert row[9:] == (7, 3, 0, 1, 0, 0, 9 if nth == count else 5)
        before = row
    assert before is not None
