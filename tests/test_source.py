"""Texts: where their lines are and what they may hold, whatever stands at the edges of blocks."""

from __future__ import annotations

import random
import re
from array import array
from pathlib import Path
from typing import Any

import pytest

from aircut import source as source_module
from aircut.kernels import scan, twin
from aircut.source import Source

KERNELS = (scan, twin("scan", "scan_uncompiled_blocks"))
PLAIN = re.compile(rb"[-+.\d \rABCFGIJKNRXYZabcfgijknrxyz]*")
G = re.compile(rb"(?i)g(?!\d(?!\d)|0)")
ODD = (
    b"", b" ", b" X1", b"(c)", b"; c", b"M30", b"O1 CALL", b"%", b"#1=2", b"G43.4 X1", b"G 68", b"N7 G0 X1", b"1 X2",
    b"\r",    b"G68.2", b"G200", b"G01 X5", b"X1\xff", b"G", b"X" * 3000, b"\x00", b"`1", b"GOTO 5", b"N", b"{X1}",
    b"Z1;" + b"x" * 1500,
)  # fmt: skip


def text(seed: int) -> bytes:
    """Long stretches of plain motion, and other things among them."""
    rng = random.Random(seed)
    lines = []
    for _ in range(rng.randint(1, 12)):
        lines += [b"X%.3f Y%d" % (rng.uniform(-99, 99), rng.randint(0, 9)) for _ in range(rng.choice((0, 3, 90, 250)))]
        lines += rng.choices(ODD, k=rng.choice((0, 1, 1, 5)))
    feed = rng.choice((b"\n", b"\n", b"\r\n"))
    return feed.join(lines) + rng.choice((b"", b"\n", b"\r\n"))


def kind_of(line: bytes) -> int:
    """The class of a line by its characters."""
    code = line.split(b";")[0].translate(None, b" \t\r")
    if not code:
        return scan.BLANK
    return scan.PLAIN if re.fullmatch(rb"(?i)([a-np-z][-+.\d]+)+", code) else scan.OTHER


@pytest.mark.parametrize("seed", range(60))
def test_lines_and_their_classes(seed: int) -> None:
    data = text(seed)
    source = Source("x", data)
    pieces = data.split(b"\n")
    if not pieces[-1]:
        pieces.pop()
    assert len(source) == len(pieces)
    assert source.ended == data.count(b"\n")
    starts = [0, *(match.end() for match in re.finditer(b"\n", data))][: len(pieces)]
    rng = random.Random(seed)
    for line in [*range(len(source)), *rng.sample(range(len(source)), len(source))]:
        assert source.start(line) == starts[line]
        assert source.raw(line) == pieces[line].rstrip(b"\r")
        assert source.line_at(starts[line] + len(pieces[line])) == line
    assert source.numbered == (b"n" in data.lower())
    for line, kind in zip(pieces, source.classes, strict=True):
        # In a block of plain motion a line counts as plain; reading its words settles it.
        assert kind == kind_of(line) or (kind == scan.PLAIN and PLAIN.fullmatch(line))


@pytest.mark.parametrize("seed", range(60))
def test_all_but_plain_motion_is_found(seed: int) -> None:
    data = text(seed)
    found = list(Source("x", data).foreign())
    at = 0
    for first, piece in found:
        assert data[first : first + len(piece)] == piece
        assert first >= at
        assert first == 0 or data[first - 1] == 10
        at = first + len(piece)
        assert at == len(data) or data[at - 1] == 10
    odd = [match.start() for match in re.finditer(rb"[^-+.\d \r\nABCFGIJKNRXYZabcfgijknrxyz]", data)]
    odd += [match.start() for match in G.finditer(data)]
    assert all(any(first <= place < first + len(piece) for first, piece in found) for place in odd)


@pytest.mark.parametrize("seed", range(12))
def test_twins_on_blocks(seed: int) -> None:
    data = text(seed) or b"\n"
    told: list[Any] = []
    for kernel in KERNELS:
        blocks = -(-len(data) // scan.BLOCK)
        counts, plain = array("q", bytes(8 * (blocks + 1))), bytearray(blocks)
        middle = blocks // 2
        named = [bool(kernel.survey(data, counts, plain, *part)) for part in ((0, middle), (middle, blocks))]
        classes = bytearray(b"\1") * (data.count(b"\n") + 1)
        kernel.classify(data, counts, plain, classes, scan.SORTS)
        told.append((counts, plain, named, classes))
    assert told[0] == told[1]


@pytest.mark.parametrize("seed", range(8))
def test_files_read_and_mapped_are_the_same(seed: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    data = text(seed) * 20 or b"X1\n"
    path = tmp_path / "part.ngc"
    path.write_bytes(data)
    plain = Source(str(path), data)
    monkeypatch.setattr(source_module, "LARGE", 1)
    read = Source.load(path)
    monkeypatch.setattr(source_module, "MAPPED", 1)
    monkeypatch.setattr(source_module, "WINDOW", 1 << 16)
    mapped = Source.load(path)
    assert mapped.mapped
    for other in (read, mapped):
        other.let_go(len(data))
        assert other.data[:] == data
        assert other.classes == plain.classes
        assert other.whole() == plain.whole()
        assert list(other.foreign()) == list(plain.foreign())
        assert [other.text(line) for line in range(len(other))] == [plain.text(line) for line in range(len(plain))]


@pytest.mark.parametrize(
    ("data", "lines"),
    [(b"", []), (b"\n", [b""]), (b"X1", [b"X1"]), (b"X1\rX2", [b"X1", b"X2"]), (b"\xef\xbb\xbfX1\n", [b"X1"]),
     (b"X1\n\x1a", [b"X1"]), (b"X1\r\n\r\n", [b"X1", b""])],
)  # fmt: skip
def test_ends_of_texts(data: bytes, lines: list[bytes], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "part.ngc"
    path.write_bytes(data)
    for large in (source_module.LARGE, 1):
        monkeypatch.setattr(source_module, "LARGE", large)
        for source in (Source("x", data), Source.load(path)):
            assert [source.raw(line) for line in range(len(source))] == lines
