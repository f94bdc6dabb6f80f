"""The canonical listing: one canonical command a line, as LinuxCNC's stand-alone interpreter prints.

Positions are in the program's units and relative to the offsets in force, which
are themselves commands of the listing; scaling, rotation and tilt (G51, G68, G68.2)
are not, and the positions are those that they lead to. Under tool center point control they are
those of the tip: a straight move has one line, an arc one for each chord.
"""

from __future__ import annotations

import re
from array import array
from collections.abc import Callable, Iterator, Mapping
from math import cos, radians, sin
from typing import TYPE_CHECKING

from aircut.canon import BY_HAND, COMMANDS, PART, ROW, TIP, TOLD, Chunk, Event, Kind
from aircut.canon.commands import WRITTEN
from aircut.canon.record import NUMBERS, Events
from aircut.geometry.arcs import PLANE_AXES
from aircut.geometry.kinematics import Setup, forward
from aircut.kernels import printing

if TYPE_CHECKING:
    from aircut.source import Source

INCH = 25.4  # mm
OTHERS = re.compile(b"[^" + re.escape(bytes((NUMBERS["SET_FEED_RATE"],))) + b"]", re.DOTALL)  # than feeds
WIDTH = ROW.size // 8
BUFFER = 1 << 20  # bytes of text that are made at a time
NO_NUMBER = "N..... "
LABEL = re.compile(rb"^[ \t/]*[nN](\d*)")
STRAIGHT = {
    Kind.TRAVERSE: "STRAIGHT_TRAVERSE",
    Kind.FEED: "STRAIGHT_FEED",
    Kind.PROBE: "STRAIGHT_PROBE",
}
SIX = "(%.4f, %.4f, %.4f, %.4f, %.4f, %.4f)"
ARC = "ARC_FEED(%.4f, %.4f, %.4f, %.4f, %d, %.4f, %.4f, %.4f, %.4f)"


def label(raw: bytes) -> str:
    """The N column of a line of text."""
    match = LABEL.match(raw)
    return ("N" + match[1].decode().ljust(6)) if match else NO_NUMBER


class Listing:
    """Writes chunks of a run as text. text: file index -> its Source."""

    def __init__(self, text: Callable[[int], Source]) -> None:
        self.text = text
        self.buffer = bytearray(BUFFER)
        self.count = 0
        self.unit = 1.0  # mm a program unit
        self.setup = Setup(0)
        self.work = [0.0] * 6
        self.shift = [0.0] * 6
        self.rotation = 0.0  # radians
        self.auxiliary: list[float] | None = None  # U, V and W of a machine that has one of them
        self.auxiliary_offsets = {"SET_G5X_OFFSET": [0.0] * 3, "SET_G92_OFFSET": [0.0] * 3}
        self.next_offsets = [0.0] * 3
        self.labels: dict[tuple[int, int], str] = {}
        self.track: Mapping[str, Callable[[Event], None]] = {
            "USE_LENGTH_UNITS": self.set_units,
            "SET_G5X_OFFSET": self.set_work,
            "SET_G92_OFFSET": self.set_shift,
            "TOOL_CENTER_POINT": self.set_setup,
            "AUXILIARY_AXES": self.set_auxiliary,
            "AUXILIARY_OFFSETS": self.set_auxiliary_offsets,
            "SET_XY_ROTATION": self.set_rotation,
        }

    def set_units(self, event: Event) -> None:
        self.unit = INCH if event.values[0] == "INCHES" else 1.0

    def set_work(self, event: Event) -> None:
        self.work = list(event.values[1:])

    def set_shift(self, event: Event) -> None:
        self.shift = list(event.values)

    def set_setup(self, event: Event) -> None:
        self.setup = Setup(*event.values)

    def set_auxiliary(self, event: Event) -> None:
        self.auxiliary = list(event.values)

    def set_auxiliary_offsets(self, event: Event) -> None:
        self.next_offsets = list(event.values)

    def tip(self, row: tuple[float, ...]) -> tuple[float, ...]:
        """A row under tool center point control with the tip, as programmed, in place of the axes."""
        axes = (row[0] + self.setup.tool_x, row[1] + self.setup.tool_y, row[2] + self.setup.tool_z)
        return (*forward(self.setup, axes, row[3:6]), *row[3:])

    def set_rotation(self, event: Event) -> None:
        self.rotation = radians(event.values[0])

    def turned(self, u: float, v: float) -> tuple[float, float]:
        """Back from the rotation of the work system about its origin."""
        u, v = u - self.work[0], v - self.work[1]
        c, s = cos(self.rotation), sin(self.rotation)
        return u * c + v * s + self.work[0], v * c - u * s + self.work[1]

    def write(self, chunk: Chunk) -> Iterator[str]:
        """The text of a chunk, in pieces that end with a line."""
        rows, events = memoryview(chunk.rows), chunk.events
        at = done = 0
        for other in OTHERS.finditer(events.name.tobytes()):
            index = other.start()
            place = events.at[index] - chunk.first
            yield from self.moves(rows, at, place, chunk.first, events, done, index)
            at, done = max(at, place), index + 1
            yield from self.event(events[index])
        yield from self.moves(rows, at, len(rows) // ROW.size, chunk.first, events, done, len(events))

    def moves(
        self, rows: memoryview, first: int, last: int, before: int, events: Events, told: int, tellable: int
    ) -> Iterator[str]:
        """The text of the rows from `first` to before `last`, and of the events from `told` to before `tellable`.

        These are all feeds. before: index in the run of the first of all rows.
        """
        if self.auxiliary is not None:
            for event in (events[index] for index in range(told, tellable)):
                yield from self.simply(rows, first, event.at - before)
                first = max(first, event.at - before)
                yield from self.event(event)
            yield from self.simply(rows, first, last)
            return
        reals = array("d", [w + s for w, s in zip(self.work, self.shift, strict=True)])
        turned = float(self.rotation != 0.0)
        reals.extend((self.unit, self.work[0], self.work[1], cos(self.rotation), sin(self.rotation), turned))
        doubles, marks = rows.cast("d"), rows.cast("q")
        at, lines, files = events.at[told:tellable], events.line[told:tellable], events.file[told:tellable]
        feeds = array("d", [values[0] for values in events.values[told:tellable]])
        told = 0
        while first < last or told < len(feeds):
            telling = told < len(feeds) and (at[told] - before <= first or first >= last)
            file = files[told] if telling else marks[first * WIDTH + 10] >> 16 & 0xFFFF
            source = self.text(file)
            numbers = array("q", (first, 0, self.count, file, last, told, before))
            data = source.data if source.numbered else b""
            printing.moves(
                doubles, marks, data, source.counts, numbers, reals, at, lines, files, feeds, self.buffer,
                printing.HEADS, printing.PAIRS,
            )  # fmt: skip
            self.count = numbers[printing.COUNT]
            if numbers[printing.USED]:
                yield self.buffer[: numbers[printing.USED]].decode("ascii")
            stays = numbers[printing.ROW] == first and numbers[printing.TOLD] == told
            first, told = numbers[printing.ROW], numbers[printing.TOLD]
            if stays and telling:
                text = "SET_FEED_RATE(%.4f)" % (feeds[told] / self.unit)
                yield self.line(file, lines[told], text)
                told += 1
            elif stays:
                yield self.row(ROW.unpack_from(rows, first * ROW.size))
                first += 1

    def simply(self, rows: memoryview, first: int, last: int) -> Iterator[str]:
        """The text of rows, without the kernel."""
        return filter(None, map(self.row, ROW.iter_unpack(rows[first * ROW.size : max(first, last) * ROW.size])))

    def row(self, row: tuple[float, ...]) -> str:
        """The line of one row; empty where it has none."""
        flags = int(row[15])
        if flags & (BY_HAND | PART | TOLD):
            return ""
        return self.move(self.tip(row) if flags & TIP else row)

    def unrotated(self, row: tuple[float, ...]) -> tuple[float, ...]:
        values = list(row)
        values[0], values[1] = self.turned(row[0], row[1])
        if row[13] == Kind.ARC:
            u, v, _ = PLANE_AXES[int(row[14])]
            if (u, v) == (0, 1):
                values[6], values[7] = self.turned(row[6], row[7])
        return tuple(values)

    def line(self, file: int, line: int, text: str) -> str:
        self.count += 1
        known = self.labels.get((file, line))
        if known is None:
            known = label(self.text(file).raw(line - 1)) if line else NO_NUMBER
            if len(self.labels) < 100_000:
                self.labels[file, line] = known
        return "%5d %s%s\n" % (self.count, known, text)

    def event(self, event: Event) -> Iterator[str]:
        track = self.track.get(event.name)
        if track is not None:
            track(event)
        row = COMMANDS[event.name]
        if not row.listed:
            return
        values = row.scale(event.values, self.unit) if row.scale else event.values
        if row.bare:
            yield row.form % values + "\n"
            return
        form = row.form % values
        if self.auxiliary is not None and event.name in self.auxiliary_offsets:
            self.auxiliary_offsets[event.name] = self.next_offsets
            form += ", %.4f, %.4f, %.4f" % tuple(value / self.unit for value in self.next_offsets)
        text = f"{WRITTEN.get(event.name, event.name).format(*event.values)}({form})"
        yield self.line(event.file, event.line, text)

    def move(self, row: tuple[float, ...]) -> str:
        unit = self.unit
        if self.rotation:
            row = self.unrotated(row)
        offset = [w + s for w, s in zip(self.work, self.shift, strict=True)]
        place = [(row[i] - offset[i]) / unit for i in range(3)] + [row[i] - offset[i] for i in (3, 4, 5)]
        kind, plane = int(row[13]), int(row[14])
        if kind == Kind.ARC:
            u, v, w = PLANE_AXES[plane]
            center = ((row[6] - offset[u]) / unit, (row[7] - offset[v]) / unit)
            text = ARC % (place[u], place[v], *center, row[11], place[w], *place[3:])
        else:
            text = STRAIGHT[Kind(kind)] + SIX % tuple(place)
        if self.auxiliary is not None:
            offsets = zip(*self.auxiliary_offsets.values(), strict=True)
            more = [(place - sum(offset)) / unit for place, offset in zip(self.auxiliary, offsets, strict=True)]
            text = text[:-1] + ", %.4f, %.4f, %.4f)" % tuple(more)
        return self.line(int(row[12]), int(row[9]), text)
