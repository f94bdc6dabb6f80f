"""Program text: its bytes, its lines and their classes."""

from __future__ import annotations

from array import array
from pathlib import Path

from aircut.kernels import scan

BATCH = 4096  # lines scanned at a time
POWERS = array("d", scan.POWERS)
BOM = b"\xef\xbb\xbf"
END_OF_FILE = b"\x1a"  # left by DOS editors


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
    """A text and its line table.

    name: as shown to the user. data: the bytes; line ends LF or CR LF (CR alone
    where there is no LF at all), a byte order mark and a final Ctrl-Z are dropped.
    starts: byte at which each line starts. classes: scan.BLANK, PLAIN or OTHER each;
    a plain line with a fault in it becomes OTHER when its words are read.
    Lines are numbered from 0 here; people see them from 1.
    """

    def __init__(self, name: str, data: bytes) -> None:
        self.name = name
        if data.startswith(BOM):
            data = data[len(BOM) :]
        if b"\n" not in data and b"\r" in data:
            data = data.replace(b"\r", b"\n")
        if data.endswith(END_OF_FILE):
            data = data[: -len(END_OF_FILE)]
        self.data = data
        count = data.count(b"\n") + (not data.endswith(b"\n") and bool(data))
        self.starts = array("q", [0]) * count
        self.classes = bytearray(count)
        self._single = Batch(1)
        if count:
            scan.lines(data, self.starts, self.classes, scan.SORTS)

    @classmethod
    def load(cls, path: Path) -> Source:
        """Read a file. Raises OSError."""
        return cls(str(path), path.read_bytes())

    def __len__(self) -> int:
        return len(self.classes)

    @property
    def ended(self) -> int:
        """How many lines end with a line feed: all, or all but the last."""
        return len(self) - (not self.data.endswith(b"\n") and len(self) > 0)

    def _scan(self, batch: Batch, first: int, count: int, at: int) -> int:
        batch.first = first
        batch.count = count
        end: int = scan.scan(
            self.data,
            at,
            count,
            self.starts,
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
        self._scan(batch, first, count, self.starts[first])
        return batch

    def words(self, line: int) -> tuple[bytes, array[float]]:
        """Shape and values of one plain line."""
        self._scan(self._single, line, 1, self.starts[line])
        return self._single.words(line)

    def length(self, line: int) -> int:
        """Bytes of a line with its line end."""
        end = self.starts[line + 1] if line + 1 < len(self) else len(self.data)
        return end - self.starts[line]

    def raw(self, line: int) -> bytes:
        """The bytes of a line without its line end."""
        start = self.starts[line]
        return self.data[start : start + self.length(line)].rstrip(b"\r\n")

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
            return self.data.decode()
        except UnicodeDecodeError:
            return "\n".join(self.text(line) for line in range(len(self)))
