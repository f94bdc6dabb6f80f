"""The listing's kernel writes what Python's formatting writes, and its twin the same."""

from __future__ import annotations

import math
from array import array
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from aircut.canon import BY_HAND, COMMANDS, PART, ROW, TIP, TOLD, Chunk
from aircut.canon.record import NUMBERS, Events
from aircut.export.listing import Listing
from aircut.geometry.kinematics import Setup
from aircut.kernels import printing, twin
from aircut.source import Source

FIRST = 1000  # index of the first row in its run
NO_FEEDS = (array("q"), array("i"), array("H"), array("d"))
KERNELS = (printing, twin("printing", "printing_uncompiled"))
TEXT = Source("part", b"G0 X1\n  N10 G1\n/n7\nN\n\nN" + b"1" * 70 + b"\nN123456789X1\n")

#: Numbers at and beside halves of the last decimal, of all sizes; those that a program would have; any at all.
halves = st.builds(lambda n, bits: n / 2**bits, st.integers(-(2**53), 2**53), st.integers(0, 60))
beside = st.builds(
    lambda n, side: math.nextafter((n + 0.5) / 10000, side), st.integers(-(10**9), 10**9), st.sampled_from((-1e9, 1e9))
)
decimals = st.builds(lambda n, d: n / 10**d, st.integers(-(10**9), 10**9), st.integers(0, 6))
odd = st.sampled_from((0.0, -0.0, 5e-5, -5e-5, 4.9999999999e-5, 5e-324, 9999.99995, 1e15, -1e15, 1e15 - 0.125, 1e300))
numbers = st.one_of(halves, beside, decimals, odd, st.floats(allow_nan=False, allow_infinity=False))
flags = st.sampled_from((0, 0, 0, 0, 1, 7, BY_HAND, PART, TOLD, TIP))


@st.composite
def moves(draw: Any) -> bytes:
    """Packed rows of any kind."""
    packed = []
    for _ in range(draw(st.integers(1, 8))):
        kind = draw(st.sampled_from((0, 1, 2, 3)))
        packed.append(
            ROW.pack(
                *(draw(numbers) for _ in range(8)), 100.0, draw(st.integers(0, len(TEXT))),
                draw(st.sampled_from((0, 7, 2**31 - 1, -1))), draw(st.integers(-300, 300)), 0, kind,
                draw(st.integers(0, 2)), draw(flags),
            )
        )  # fmt: skip
    return b"".join(packed)


def listing(count: int) -> Listing:
    made = Listing(lambda file: TEXT)
    made.count = count
    return made


def told(feeds: list[tuple[int, int, float]], count: int, first: int) -> Events:
    """Feeds before some of the rows, each with its line; one in three is another event."""
    events = Events()
    for index, (at, line, feed) in enumerate(sorted(feeds)):
        events.at.append(first + min(at, count))
        events.line.append(line)
        events.file.append(0)
        events.name.append(NUMBERS["SET_FEED_RATE" if index % 3 < 2 else "SET_G92_OFFSET"])
        events.values.append((feed,) if index % 3 < 2 else (feed,) * len(COMMANDS["SET_G92_OFFSET"].fields))
    return events


def written(
    rows: bytes, made: Listing, kernel: Any, monkeypatch: pytest.MonkeyPatch, events: Events | None = None
) -> str:
    """What the kernel makes of rows, with the rows that it leaves out written by Python."""
    with monkeypatch.context() as patch:
        patch.setattr("aircut.export.listing.printing", kernel)
        return "".join(made.write(Chunk(FIRST, rows, events or Events())))


@settings(max_examples=150)
@given(
    moves(), st.sampled_from((0, 9, 99_998, 10**9)), st.sampled_from((1.0, 25.4)), st.lists(numbers, min_size=6,
    max_size=6), st.sampled_from((0.0, 0.3, math.pi / 2)),
    st.lists(st.tuples(st.integers(0, 9), st.integers(0, len(TEXT)), numbers), max_size=7),
)  # fmt: skip
def test_rows_are_written_as_python_does(
    rows: bytes, count: int, unit: float, work: list[float], rotation: float, feeds: list[tuple[int, int, float]]
) -> None:
    def fresh() -> Listing:
        made = listing(count)
        made.unit, made.work, made.rotation, made.setup = unit, work, rotation, Setup(2, tool_z=50.0)
        return made

    made = fresh()
    events = told(feeds, len(rows) // ROW.size, FIRST)
    waiting = list(events)
    lines = []
    for at, row in enumerate([*ROW.iter_unpack(rows), None], FIRST):
        while waiting and waiting[0].at <= at:
            lines += made.event(waiting.pop(0))
        lines.append(made.row(row) if row else "")
    for kernel in KERNELS:
        other = fresh()
        with pytest.MonkeyPatch.context() as patch:
            assert written(rows, other, kernel, patch, events) == "".join(lines)
        assert other.count == made.count


@settings(max_examples=400)
@given(st.lists(numbers, min_size=6, max_size=6))
def test_numbers_are_those_of_printf(values: list[float]) -> None:
    row = ROW.pack(*values, 0.0, 0.0, 0.0, 0, 0, 0, 0, 0, 0, 0)
    for kernel in KERNELS:
        with pytest.MonkeyPatch.context() as patch:
            text = written(row, listing(0), kernel, patch)
        # 0.0 is taken away as an offset: that makes no difference but to -0.0 - 0.0, which is -0.0.
        assert text == "    1 N..... STRAIGHT_TRAVERSE(" + ", ".join("%.4f" % value for value in values) + ")\n"


@pytest.mark.parametrize("kernel", KERNELS, ids=["built", "twin"])
@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf, 1e15, -1e15])
def test_what_the_kernel_does_not_know_stops_it(kernel: Any, value: float) -> None:
    good, bad = (ROW.pack(1.0, v, *(0.0,) * 7, 0, 0, 0, 0, 1, 0, 0) for v in (0.99995, value))
    rows = memoryview(good + bad + good)
    reals = array("d", [0.0] * 6 + [1.0, 0.0, 0.0, 1.0, 0.0, 0.0])
    places = array("q", (0, 0, 0, 0, 3, 0, 0))
    out = bytearray(2 * printing.LINE)
    kernel.moves(
        rows.cast("d"), rows.cast("q"), b"", array("q"), places, reals, *NO_FEEDS, out, printing.HEADS, printing.PAIRS
    )
    assert places.tolist() == [1, 75, 1, 0, 3, 0, 0]
    assert out[:75] == b"    1 N..... STRAIGHT_FEED(1.0000, 1.0000, 0.0000, 0.0000, 0.0000, 0.0000)\n"


def test_a_long_stretch_is_written_in_pieces(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("aircut.export.listing.BUFFER", 2000)
    row = ROW.pack(1.5, *(0.0,) * 8, 2, 0, 0, 0, 1, 0, 0)
    made = listing(0)
    pieces = list(made.write(Chunk(0, row * 100, Events())))
    assert len(pieces) > 3
    assert all(piece.endswith("\n") for piece in pieces)
    assert "".join(pieces).count("N10    STRAIGHT_FEED(1.5000, 0.0000") == 100
