"""What a run leaves behind: packed moves and, beside them, events.

The interpreter writes to a Recorder; a Recorder hands out full Chunks, so that
a run can be streamed; a Recording puts the chunks together again.
"""

from __future__ import annotations

from array import array
from collections.abc import Iterator
from typing import Any, NamedTuple

from aircut.canon.commands import COMMANDS
from aircut.canon.toolpath import ROW, Toolpath

CHUNK = 1 << 16  # moves a chunk
NAMES = tuple(COMMANDS)
NUMBERS = {name: number for number, name in enumerate(NAMES)}


class Event(NamedTuple):
    """A canonical command that is not motion."""

    at: int  # index of the move it comes before
    name: str
    values: tuple[Any, ...]
    line: int  # in its file, from 1; 0 before the program
    file: int  # index into Recording.files


class Chunk(NamedTuple):
    """Part of a run."""

    first: int  # index of its first move
    rows: bytes  # packed moves (canon.ROW)
    events: Events


class Events:
    """Events as columns; iterating makes Event values."""

    __slots__ = ("at", "file", "line", "name", "values")

    def __init__(self) -> None:
        self.at = array("q")
        self.line = array("i")
        self.file = array("H")
        self.name = array("B")
        self.values: list[tuple[Any, ...]] = []

    def __len__(self) -> int:
        return len(self.at)

    def __getitem__(self, index: int) -> Event:
        name = NAMES[self.name[index]]
        return Event(self.at[index], name, self.values[index], self.line[index], self.file[index])

    def __iter__(self) -> Iterator[Event]:
        return (self[index] for index in range(len(self)))

    def extend(self, other: Events) -> None:
        for name in self.__slots__:
            getattr(self, name).extend(getattr(other, name))


class Recorder:
    """Where the interpreter writes. `line` and `file` say where it stands."""

    __slots__ = ("events", "file", "first", "line", "rows")

    def __init__(self) -> None:
        self.first = 0
        self.rows = bytearray()
        self.events = Events()
        self.line = 0
        self.file = 0

    @property
    def moves(self) -> int:
        """Moves so far."""
        return self.first + len(self.rows) // ROW.size

    def event(self, name: str, *values: Any) -> None:
        """Write one command that is not motion. Lengths in mm."""
        events = self.events
        events.at.append(self.first + len(self.rows) // ROW.size)
        events.line.append(self.line)
        events.file.append(self.file)
        events.name.append(NUMBERS[name])
        events.values.append(values)

    def take(self) -> Chunk:
        """Hand out what has been written and start anew."""
        chunk = Chunk(self.first, bytes(self.rows), self.events)
        self.first += len(self.rows) // ROW.size
        self.rows = bytearray()
        self.events = Events()
        return chunk


class Recording:
    """A whole run: toolpath and events. `files` names what the file indices mean."""

    def __init__(self) -> None:
        self.chunks: list[bytes] = []
        self.moves = 0
        self.events = Events()
        self.files: list[str] = []
        self._toolpath: Toolpath | None = None

    def add(self, chunk: Chunk) -> None:
        if chunk.rows:
            self.chunks.append(chunk.rows)
            self.moves += len(chunk.rows) // ROW.size
        self.events.extend(chunk.events)

    @property
    def toolpath(self) -> Toolpath:
        """The moves as columns."""
        if self._toolpath is None:
            self._toolpath = Toolpath.of_rows(self.chunks)
        return self._toolpath
