"""What a run leaves behind: packed moves and, beside them, events.

The interpreter writes to a Recorder; a Recorder hands out full Chunks, so that
a run can be streamed; a Recording puts the chunks together again.
"""

from __future__ import annotations

from array import array
from collections.abc import Callable, Iterable, Iterator
from struct import Struct
from typing import Any, NamedTuple

from aircut.canon.commands import COMMANDS
from aircut.canon.tips import setups_of
from aircut.canon.toolpath import ROW, Toolpath
from aircut.memory import fresh

PLACE = Struct("<6d")  # the beginning of a row
CHUNK = 1 << 16  # moves a chunk
LARGE = 1 << 22  # bytes from which memory of its own is the cheaper one
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
    rows: bytes | memoryview  # packed moves (canon.ROW)
    events: Events
    contour: bytes = b""  # packed moves as programmed, where compensation leads the tool beside them


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

    def named(self, *names: str) -> Iterator[Event]:
        """The events of these names, in order."""
        wanted = {NUMBERS[name] for name in names}
        return (self[index] for index, number in enumerate(self.name) if number in wanted)

    def since(self, index: int, first: int) -> list[tuple[int, int, tuple[Any, ...]]]:
        """The events from an index on: of each the move, counted from `first`, the name's number, and the values."""
        return [(self.at[i] - first, self.name[i], self.values[i]) for i in range(index, len(self))]

    def extend(self, other: Events) -> None:
        for name in self.__slots__:
            getattr(self, name).extend(getattr(other, name))

    def cut(self, index: int) -> Events:
        """Take out the events from an index on."""
        rest = Events()
        for name in self.__slots__:
            column = getattr(self, name)
            getattr(rest, name).extend(column[index:])
            del column[index:]
        return rest


class Recorder:
    """Where the interpreter writes. `line` and `file` say where it stands.

    Moves may be held back until those after them are known. The events told
    meanwhile wait behind them: `hold` when a move is held back, `free` when it is
    written, in the same order.
    """

    __slots__ = (
        "arena",
        "at_once",
        "contour",
        "events",
        "file",
        "first",
        "line",
        "marks",
        "place",
        "returned",
        "room",
        "rows",
        "stowed",
        "used",
    )

    def __init__(self) -> None:
        self.first = 0  # index of the first of `rows`
        self.place: tuple[float, ...] = (0.0,) * 6  # where the moves handed out have ended
        self.rows = bytearray()
        self.arena: memoryview | None = None  # where kernels write; it becomes chunks without being copied
        self.used = 0  # bytes of the arena
        self.stowed = 0  # of these, handed out
        self.returned = 0  # of these, given back
        self.room = 0  # rows of a new arena; 0: a chunk's
        self.contour = bytearray()
        self.events = Events()
        self.line = 0
        self.file = 0
        self.marks: list[int] = []  # of each move held back, the first event behind it
        self.at_once: frozenset[str] = frozenset()  # events that do not wait

    @property
    def moves(self) -> int:
        """Moves so far."""
        return self.first + len(self.rows) // ROW.size

    def end(self) -> tuple[float, ...]:
        """Where the last move ended: machine coordinates without the tool's offset, mm and degrees."""
        if self.rows:
            return PLACE.unpack_from(self.rows, len(self.rows) - ROW.size)
        if self.arena is not None and self.used > self.stowed:
            return PLACE.unpack_from(self.arena, self.used - ROW.size)
        return self.place

    def event(self, name: str, *values: Any) -> None:
        """Write one command that is not motion. Lengths in mm."""
        events = self.events
        events.at.append(self.first + len(self.rows) // ROW.size)
        events.line.append(self.line)
        events.file.append(self.file)
        events.name.append(NUMBERS[name])
        events.values.append(values)
        if self.marks and name in self.at_once:
            self.hurry()

    def hold(self) -> None:
        """A move is held back: events from here on come after it."""
        self.marks.append(len(self.events))

    def free(self, write: Callable[[], None]) -> None:
        """Write the first of the moves held back; the events behind it move on."""
        before = self.moves
        write()
        written, at = self.moves - before, self.events.at
        for index in range(self.marks.pop(0), len(at)):
            at[index] += written

    def drop(self) -> None:
        """Forget the moves held back, and what waits behind them."""
        if self.marks:
            self.events.cut(self.marks[0])
            self.marks.clear()

    def hurry(self) -> None:
        """The last event overtakes those that wait."""
        events = self.events
        for name in events.__slots__:
            column = getattr(events, name)
            column.insert(self.marks[0], column.pop())
        self.marks = [mark + 1 for mark in self.marks]

    def space(self, rows: int) -> memoryview:
        """Memory for this many rows, behind those written so far; `fill` tells how many of them are."""
        size = (rows * ROW.size) + len(self.rows)
        if self.arena is None or self.used + size > len(self.arena):
            if self.arena is None or not self.returned == self.stowed == self.used or size > len(self.arena):
                self.arena = memory(max(rows + CHUNK // 4, self.room) * ROW.size + len(self.rows))
            self.used = self.stowed = self.returned = 0
        start = self.used + len(self.rows)
        return self.arena[start : start + rows * ROW.size]

    def fill(self, count: int, few: int) -> None:
        """The first rows of the `space` are written. Where they are no more than a few, they join the others."""
        assert self.arena is not None
        start = self.used + len(self.rows)
        if count <= few:
            self.rows += self.arena[start : start + count * ROW.size]
        else:
            self.stow()
            self.used += count * ROW.size
            self.first += count

    def stow(self) -> None:
        """Move the rows into the arena."""
        size = len(self.rows)
        if self.arena is not None and size:
            self.arena[self.used : self.used + size] = self.rows
            self.used += size
            self.first += size // ROW.size
            self.rows = bytearray()

    def tell_feeds(self, at: Iterable[int], lines: Iterable[int], feeds: Iterable[float]) -> None:
        """SET_FEED_RATE for each of these moves and lines, mm/min."""
        events = self.events
        before = len(events)
        events.at.extend(at)
        for line in lines:
            events.line.append(line)
        events.values.extend((feed,) for feed in feeds)
        count = len(events) - before
        events.file.extend([self.file] * count)
        events.name.extend([NUMBERS["SET_FEED_RATE"]] * count)

    def tell_pattern(self, pattern: list[tuple[int, int, tuple[Any, ...]]], first: int, size: int, lines: Any) -> None:
        """The events of a pattern (see Events.since) at each of these lines, `size` moves apart, from move `first`."""
        events, count = self.events, len(pattern)
        if count:
            for nth, line in enumerate(lines):
                at = first + nth * size
                events.at.extend([at + place for place, _, _ in pattern])
                events.line.extend([line] * count)
            repeated = len(lines)
            events.file.extend([self.file] * (count * repeated))
            events.name.extend([name for _, name, _ in pattern] * repeated)
            events.values.extend([values for _, _, values in pattern] * repeated)

    def take(self) -> Chunk:
        """Hand out what has been written and start anew; what waits stays."""
        events = self.events
        done = self.marks[0] if self.marks else len(events)
        self.events = events.cut(done)
        self.marks = [mark - done for mark in self.marks]
        self.place = self.end()
        if self.arena is not None and self.used + len(self.rows) <= len(self.arena):
            self.stow()
        rows: bytes | memoryview
        if self.arena is not None and self.used > self.stowed:
            rows = self.arena[self.stowed : self.used]
            self.stowed = self.used
            if self.rows:
                self.returned += len(rows)
                rows = bytes(rows) + bytes(self.rows)
                self.first += len(self.rows) // ROW.size
        else:
            rows = bytes(self.rows)
            self.first += len(rows) // ROW.size
        chunk = Chunk(self.first - len(rows) // ROW.size, rows, events, bytes(self.contour))
        self.rows = bytearray()
        self.contour = bytearray()
        return chunk

    def give_back(self, chunk: Chunk) -> None:
        """Nobody looks at the rows of this chunk any more: their memory is used again."""
        rows = chunk.rows
        if isinstance(rows, memoryview) and self.arena is not None and rows.obj is self.arena.obj:
            self.returned += len(rows)


def memory(size: int) -> memoryview:
    """Memory not filled with anything where that is much cheaper."""
    return memoryview(bytearray(size) if size < LARGE else fresh(size))


class Recording:
    """A whole run: toolpath and events. `files` names what the file indices mean."""

    def __init__(self) -> None:
        self.chunks: list[bytes | memoryview] = []
        self.contours: list[bytes | memoryview] = []
        self.moves = 0
        self.events = Events()
        self.files: list[str] = []
        self._toolpath: Toolpath | None = None
        self._contour: Toolpath | None = None

    def add(self, chunk: Chunk) -> None:
        if chunk.rows:
            self.chunks.append(chunk.rows)
            self.moves += len(chunk.rows) // ROW.size
        if chunk.contour:
            self.contours.append(chunk.contour)
        self.events.extend(chunk.events)

    @property
    def toolpath(self) -> Toolpath:
        """The moves as columns."""
        if self._toolpath is None:
            auxiliary = [(event.at, event.values) for event in self.events.named("AUXILIARY_AXES")]
            self._toolpath = Toolpath.of_rows(self.chunks, setups=setups_of(self.events), auxiliary=auxiliary)
        return self._toolpath

    @property
    def contour(self) -> Toolpath:
        """The programmed contours beside which compensation led the tool; each begins with a traverse to its start."""
        if self._contour is None:
            self._contour = Toolpath.of_rows(self.contours)
        return self._contour
