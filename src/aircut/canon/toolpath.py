"""The toolpath: one row a move, kept as columns.

A row is packed while the program runs and taken apart into NumPy columns
afterwards, so that nothing in bulk is ever a Python object.
"""

from __future__ import annotations

import struct
from collections.abc import Iterable, Iterator, Sequence
from enum import IntEnum
from typing import TYPE_CHECKING, Any, NamedTuple

from aircut.canon import tips
from aircut.geometry import arcs
from aircut.geometry.kinematics import Setup

if TYPE_CHECKING:
    import numpy as np
    import pandas
    import pyarrow
    from numpy.typing import NDArray


class Kind(IntEnum):
    """What a row of the toolpath is."""

    TRAVERSE = 0
    FEED = 1
    ARC = 2
    PROBE = 3


#: Flags of a row.
EXACT_STOP = 1  # the move stops at its end (G61.1, G9)
EXACT_PATH = 2  # no blending with its neighbors (G61)
INVERSE_TIME = 4  # programmed under G93; `feed` is the resulting speed
BY_HAND = 8  # the operator moves the machine there (G88): not in the listing

TIP = 16  # under tool center point control: the program said where the tip goes, see tips()
PART = 32  # a part of a programmed move that others follow: the listing has the last one alone
TOLD = 64  # told by the command before it (a spline, tapping): not a line of the listing


class Column(NamedTuple):
    """One column of the toolpath."""

    name: str
    code: str  # of the packed row, as the struct module has it
    meaning: str


COLUMNS = (
    *(Column(axis, "d", f"end point {axis.upper()} in machine coordinates, mm") for axis in "xyz"),
    *(Column(axis, "d", f"end point {axis.upper()} in machine coordinates, degrees") for axis in "abc"),
    Column("u", "d", "arc center, first axis of the plane, mm (0 for lines)"),
    Column("v", "d", "arc center, second axis of the plane, mm (0 for lines)"),
    Column("feed", "d", "mm/min, or degrees/min when only rotary axes move; 0 for traverses"),
    Column("line", "i", "line in its file, from 1"),
    Column("tool", "i", "tool in the spindle"),
    Column("turns", "h", "arc turns: + counterclockwise, - clockwise; 0 for lines"),
    Column("file", "H", "index into Recording.files"),
    Column("kind", "B", "Kind: 0 traverse, 1 feed, 2 arc, 3 probe"),
    Column("plane", "B", "arc plane: 0 XY (u X, v Y), 1 ZX (u Z, v X), 2 YZ (u Y, v Z)"),
    Column("flags", "H", "EXACT_STOP 1, EXACT_PATH 2, INVERSE_TIME 4, BY_HAND 8, TIP 16, PART 32, TOLD 64"),
)
ROW = struct.Struct("<" + "".join(column.code for column in COLUMNS))
AXES = "xyzabc"


def row_type() -> np.dtype[Any]:
    """The packed row as a NumPy structured type."""
    import numpy as np

    codes = {"d": "<f8", "i": "<i4", "h": "<i2", "H": "<u2", "B": "u1"}
    return np.dtype([(column.name, codes[column.code]) for column in COLUMNS])


class Extents(NamedTuple):
    """Lowest and highest position on each of the axes X Y Z A B C, mm and degrees; None where nothing moved."""

    low: tuple[float, ...]
    high: tuple[float, ...]


def columns_of(rows: NDArray[Any]) -> dict[str, NDArray[Any]]:
    """Views of the packed rows' columns."""
    return {name: rows[name] for name in rows.dtype.names or ()}


def joined(chunks: list[bytes | memoryview]) -> NDArray[Any]:
    """Chunks of packed rows as one array; the list is emptied on the way to spare memory.

    Chunks that lie end to end in one memory are not copied.
    """
    import numpy as np

    kind = row_type()
    parts = [np.frombuffer(chunk, np.uint8) for chunk in chunks]
    chunks.clear()
    ends = [part.ctypes.data + len(part) for part in parts]
    if parts and all(part.ctypes.data == end for part, end in zip(parts[1:], ends, strict=False)):
        whole = np.lib.stride_tricks.as_strided(parts[0], (sum(map(len, parts)),), writeable=False)
        return whole.view(kind)
    rows = np.empty(sum(map(len, parts)) // kind.itemsize, kind)
    at = 0
    parts.reverse()
    while parts:
        part = parts.pop().view(kind)
        rows[at : at + len(part)] = part
        at += len(part)
    return rows


class Toolpath:
    """All moves of a run, as NumPy columns named as in COLUMNS: `toolpath.x`, `toolpath.line`, …

    Positions are those of the controlled point (the tool's tip when its length is
    compensated) in machine coordinates, millimeters and degrees. A move starts
    where the one before ended, the first one at `start`. Under tool center point
    control (flag TIP) they are the axes' less the tool's offset, and a programmed
    move is as many rows as keep the tip on its way (flag PART on all but the last).
    """

    x: NDArray[np.float64]
    y: NDArray[np.float64]
    z: NDArray[np.float64]
    a: NDArray[np.float64]
    b: NDArray[np.float64]
    c: NDArray[np.float64]
    u: NDArray[np.float64]
    v: NDArray[np.float64]
    feed: NDArray[np.float64]
    line: NDArray[np.int32]
    tool: NDArray[np.int32]
    turns: NDArray[np.int16]
    file: NDArray[np.uint16]
    kind: NDArray[np.uint8]
    plane: NDArray[np.uint8]
    flags: NDArray[np.uint16]

    def __init__(
        self,
        columns: dict[str, NDArray[Any]],
        start: Iterable[float] = (0.0,) * 6,
        setups: Sequence[tuple[int, Setup]] = (),
        auxiliary: Sequence[tuple[int, tuple[float, ...]]] = (),
    ) -> None:
        """columns: one array a column of COLUMNS, all of one length. start: six positions, mm and degrees.

        setups: tool offsets and, under tool center point control, kinematics: from which move on.
        auxiliary: U, V and W: from which move on.
        """
        self.start = tuple(start)
        self.told_auxiliary = auxiliary
        self.setups = setups
        self.columns = columns
        self.__dict__.update(columns)

    @classmethod
    def of_rows(
        cls,
        chunks: list[bytes | memoryview],
        start: Iterable[float] = (0.0,) * 6,
        setups: Sequence[tuple[int, Setup]] = (),
        auxiliary: Sequence[tuple[int, tuple[float, ...]]] = (),
    ) -> Toolpath:
        """From packed rows (ROW); the list is emptied on the way to spare memory."""

        return cls(columns_of(joined(chunks)), start, setups, auxiliary)

    def __len__(self) -> int:
        return len(self.kind)

    def __repr__(self) -> str:
        return f"<Toolpath: {len(self)} moves>"

    def ends(self) -> NDArray[np.float64]:
        """End points, (n, 6), mm and degrees."""
        import numpy as np

        return np.column_stack([self.columns[axis] for axis in AXES])

    def starts(self) -> NDArray[np.float64]:
        """Start points, (n, 6), mm and degrees."""
        import numpy as np

        return np.vstack([np.asarray(self.start)[None, :], self.ends()[:-1]])[: len(self)]

    def tips(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Starts and ends of the moves as the part sees them, (n, 3) mm: where the tool's tip is on it.

        That differs from machine coordinates where the run told five-axis kinematics (G43.4, G43.7).
        """
        return tips.tips(self)

    def tool_axes(self) -> NDArray[np.float64]:
        """The tool's axis at the ends of the moves as the part sees it, (n, 3): from the tip to the holder."""
        return tips.directions(self)

    def auxiliary(self) -> NDArray[np.float64]:
        """Machine coordinates U, V and W at the ends of the moves, (n, 3) mm; zeros where the machine has none.

        They are no columns, as few machines have these axes: the run tells where they change.
        """
        import numpy as np

        at = [index for index, _ in self.told_auxiliary]
        places = np.array([(0.0, 0.0, 0.0), *(place for _, place in self.told_auxiliary)])
        return places[np.searchsorted(np.array(at, np.int64), np.arange(len(self)), side="right")]

    def machine_axes(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Where the machine's axes stand at the starts and ends, the tool's offset included, (n, 6) mm and degrees."""
        return tips.axes(self)

    def arcs(self) -> Iterator[tuple[int, NDArray[np.intp], NDArray[Any], NDArray[Any], NDArray[Any]]]:
        """The arcs of each plane: plane, their indices (k,), start, end and center (k, 3) along u, v, w, mm."""
        import numpy as np

        for plane, axes in enumerate(arcs.PLANE_AXES):
            which = np.flatnonzero((self.kind == Kind.ARC) & (self.plane == plane))
            if len(which):
                end = np.column_stack([self.columns[AXES[axis]][which] for axis in axes])
                before = which - 1
                first = np.array([self.start[axis] for axis in axes])
                start = np.column_stack([self.columns[AXES[axis]][before] for axis in axes])
                start = np.where(before[:, None] < 0, first, start)
                center = np.column_stack([self.u[which], self.v[which], start[:, 2]])
                yield plane, which, start, end, center

    def lengths(self) -> NDArray[np.float64]:
        """Path length of each move, (n,): mm, or degrees where only rotary axes move."""
        import numpy as np

        step = self.ends() - self.starts()
        length: NDArray[np.float64] = np.sqrt((step[:, :3] ** 2).sum(axis=1))
        rotary = np.sqrt((step[:, 3:] ** 2).sum(axis=1))
        length = np.where(length > 1e-7, length, rotary)
        for _, which, start, end, center in self.arcs():
            rise = end[:, 2] - start[:, 2]
            length[which] = arcs.lengths(start[:, :2], end[:, :2], rise, center[:, :2], self.turns[which])
        return length

    def extents(self, rapid: bool | None = None) -> Extents | None:
        """Box of the moves, start points included; None without moves.

        rapid: True for traverses alone, False for all others, None for both.
        """
        import numpy as np

        wanted = np.ones(len(self), bool)
        if rapid is not None:
            wanted = (self.kind == Kind.TRAVERSE) == rapid
        if not wanted.any():
            return None
        ends, starts = self.ends()[wanted], self.starts()[wanted]
        low = np.minimum(ends.min(axis=0), starts.min(axis=0))
        high = np.maximum(ends.max(axis=0), starts.max(axis=0))
        for plane, which, start, end, center in self.arcs():
            if rapid is not True:
                least, most = arcs.bounds(start[:, :2], end[:, :2], center[:, :2], self.turns[which])
                axes = list(arcs.PLANE_AXES[plane][:2])
                low[axes] = np.minimum(low[axes], least.min(axis=0))
                high[axes] = np.maximum(high[axes], most.max(axis=0))
        return Extents(tuple(low.tolist()), tuple(high.tolist()))

    def to_numpy(self) -> NDArray[Any]:
        """One structured array, a field a column."""
        import numpy as np

        rows = np.empty(len(self), row_type())
        for name, column in self.columns.items():
            rows[name] = column
        return rows

    def to_arrow(self) -> pyarrow.Table:
        """A pyarrow Table sharing the columns' memory. Raises ImportError without pyarrow (aircut[arrow])."""
        import pyarrow

        meta = {column.name: column.meaning for column in COLUMNS}
        fields = [
            pyarrow.field(name, pyarrow.from_numpy_dtype(column.dtype), metadata={"meaning": meta[name]})
            for name, column in self.columns.items()
        ]
        return pyarrow.table(list(self.columns.values()), schema=pyarrow.schema(fields))

    def to_pandas(self) -> pandas.DataFrame:
        """A pandas DataFrame, a column a column. Raises ImportError without pandas (aircut[pandas])."""
        import pandas

        return pandas.DataFrame(self.columns)
