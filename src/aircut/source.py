"""Program text: its bytes, its lines and their classes."""

from __future__ import annotations

import mmap
from array import array
from bisect import bisect_left
from collections.abc import Iterator
from pathlib import Path

from aircut.kernels import scan
from aircut.memory import fresh

BATCH = 4096  # lines scanned at a time
POWERS = array("d", scan.POWERS)
BOM = b"\xef\xbb\xbf"
END_OF_FILE = b"\x1a"  # left by DOS editors
MAPPED = 1 << 27  # bytes from which a file is not read but mapped, and let go of behind the place that is run
LARGE = 1 << 22  # bytes from which it is read into memory of its own
WINDOW = 1 << 25  # bytes of a mapped file that are held at a time, a multiple of scan.BLOCK and of all page sizes
PIECE = 1 << 22  # bytes in a piece of text that is searched
NEAR = 8  # lines that are walked to from the one before


class Batch:
    """The words of a stretch of lines: shapes and values of the plain ones (see kernels.scan)."""

    __slots__ = ("count", "first", "shape_ends", "shapes", "value_ends", "values")

    def __init__(self, lines: int) -> None:
        self.first = 0
        self.count = 0
        self.shapes = bytearray(lines * scan.SHAPE)
        self.values = array("d", bytes(8 * lines * scan.WORDS))
        self.shape_ends = array("i", bytes(4 * lines))
        self.value_ends = array("i", bytes(4 * lines))

    def words(self, line: int) -> tuple[bytes, array[float]]:
        """Shape and values of a plain line of this batch, by its index in the file."""
        at = line - self.first
        if at == 0:
            return bytes(self.shapes[: self.shape_ends[0]]), self.values[: self.value_ends[0]]
        return (
            bytes(self.shapes[self.shape_ends[at - 1] : self.shape_ends[at]]),
            self.values[self.value_ends[at - 1] : self.value_ends[at]],
        )


class Source:
    """A text and where its lines are.

    name: as shown to the user. data: the bytes; line ends LF or CR LF (CR alone
    where there is no LF at all), a byte order mark and a final Ctrl-Z are dropped.
    classes: scan.BLANK, PLAIN or OTHER of each line; a plain line with a fault in it
    becomes OTHER when its words are read. counts: line feeds before each block of
    scan.BLOCK bytes, and in all. plain: by block, whether all is plain motion (see scan.survey).
    numbered: whether there is an N anywhere.
    Lines are numbered from 0 here; people see them from 1.
    """

    def __init__(self, name: str, data: bytes | mmap.mmap, mapped: bool = False) -> None:
        """mapped: the data are a file, which can be read again when they have been let go of."""
        self.name = name
        if data[:3] == BOM:
            data = data[len(BOM) :]
        if data.find(b"\n") < 0 and data.find(b"\r") >= 0:
            data = data[:].replace(b"\r", b"\n")
        if data[-1:] == END_OF_FILE:
            data = data[:-1]
        self.data = data
        self.mapped = mapped and isinstance(data, mmap.mmap)
        self._held = 0  # byte of a mapped file before which nothing is held
        blocks = -(-len(data) // scan.BLOCK)
        self.counts = array("q", bytes(8 * (blocks + 1)))
        self.plain = bytearray(blocks)
        self.numbered = False
        for first in range(0, blocks, WINDOW // scan.BLOCK):
            last = min(first + WINDOW // scan.BLOCK, blocks)
            self.numbered = bool(scan.survey(data, self.counts, self.plain, first, last)) or self.numbered
            self.let_go(last * scan.BLOCK)
        self.ended = self.counts[-1]  # lines that end with a line feed: all, or all but the last
        self.classes = bytearray(b"\x01") * (self.ended + (data[-1:] not in (b"\n", b"")))
        scan.classify(data, self.counts, self.plain, self.classes, scan.SORTS)
        self.let_go(len(data))
        self._held = 0
        self._near = (0, 0)  # a line and where it starts
        self._single = Batch(1)

    @classmethod
    def load(cls, path: Path) -> Source:
        """Read a file, or map a large one. Raises OSError."""
        with path.open("rb", buffering=0) as file:
            size = path.stat().st_size
            if size >= MAPPED:
                return cls(str(path), mmap.mmap(file.fileno(), size, access=mmap.ACCESS_READ), mapped=True)
            if size < LARGE:
                return cls(str(path), file.read())
            memory = fresh(size)
            read = file.readinto(memory)
            whole = read == size and not file.read(1)
        return cls(str(path), memory if whole else path.read_bytes())

    def __len__(self) -> int:
        return len(self.classes)

    def let_go(self, before: int) -> None:
        """Let go of the pages of a mapped file up to about this byte; they are read again when they are needed."""
        before -= before % WINDOW
        if self.mapped and before > self._held and isinstance(self.data, mmap.mmap) and hasattr(mmap, "MADV_DONTNEED"):
            self.data.madvise(mmap.MADV_DONTNEED, self._held, before - self._held)
            self._held = before

    def passed(self, line: int, start: int) -> None:
        """Lines have been run up to this one, which starts at this byte."""
        self._near = (line, start)
        if self.mapped:
            self.let_go(start)

    def start(self, line: int) -> int:
        """The byte at which a line starts."""
        near, at = self._near
        find = self.data.find
        if not 0 <= line - near <= NEAR:
            block = max(bisect_left(self.counts, line) - 1, 0)
            near, at = self.counts[block], block * scan.BLOCK
            if near == line:  # the first
                at = 0
        for _ in range(line - near):
            at = find(b"\n", at) + 1
        self._near = (line, at)
        return at

    def line_at(self, place: int) -> int:
        """The line in which a byte stands."""
        block = place // scan.BLOCK
        before: int = self.counts[block]
        return before + self.data[block * scan.BLOCK : place].count(b"\n")

    def foreign(self) -> Iterator[tuple[int, bytes]]:
        """All lines that may hold more than plain motion: pieces of the text, whole lines, each with its first byte."""
        size, block, done = len(self.data), 0, 0
        while (block := self.plain.find(0, block)) >= 0:
            first = self.data.rfind(b"\n", done, block * scan.BLOCK) + 1 or done
            block = self.plain.find(1, block)
            if block < 0:
                block = len(self.plain)
            last = min(block * scan.BLOCK, size)
            while first < last:
                done = self.data.find(b"\n", min(first + PIECE, last) - 1) + 1 or size
                yield first, self.data[first:done]
                self.let_go(done)
                first = done
        self._held = 0

    def lines_with(self, character: bytes) -> Iterator[int]:
        """The lines with a character that plain motion has not, in order; a line comes as often as it stands there."""
        for first, text in self.foreign():
            at = text.find(character)
            while at >= 0:
                yield self.line_at(first + at)
                at = text.find(character, at + 1)

    def _scan(self, batch: Batch, first: int, count: int, at: int) -> int:
        batch.first = first
        batch.count = count
        end: int = scan.scan(
            self.data,
            at,
            count,
            self.classes,
            first,
            batch.shapes,
            batch.shape_ends,
            batch.values,
            batch.value_ends,
            POWERS,
        )
        return end

    def batch(self, first: int, count: int, batch: Batch) -> Batch:
        """Fill a Batch with up to `count` lines from `first` on."""
        count = min(count, len(batch.shape_ends), len(self) - first)
        self._scan(batch, first, count, self.start(first))
        return batch

    def words(self, line: int) -> tuple[bytes, array[float]]:
        """Shape and values of one plain line."""
        self._scan(self._single, line, 1, self.start(line))
        return self._single.words(line)

    def length(self, line: int) -> int:
        """Bytes of a line with its line end."""
        start = self.start(line)
        return (self.data.find(b"\n", start) + 1 or len(self.data)) - start

    def raw(self, line: int) -> bytes:
        """The bytes of a line without its line end."""
        start = self.start(line)
        end = self.data.find(b"\n", start)
        return self.data[start : end if end >= 0 else len(self.data)].rstrip(b"\r")

    def text(self, line: int) -> str:
        """A line without its line end; what is not UTF-8 is read as Windows-1252."""
        raw = self.raw(line)
        try:
            return raw.decode()
        except UnicodeDecodeError:
            return raw.decode("cp1252", "replace")

    def whole(self) -> str:
        """The whole text; bytes that are not UTF-8 are read as Windows-1252."""
        try:
            return self.data[:].decode()
        except UnicodeDecodeError:
            return "\n".join(self.text(line) for line in range(len(self)))
