"""Rules that watch the motion: spindle, rapids, units.

Before the first cut, with the spindle still, a rapid below Z0 is positioning beside the work.

They read the packed rows of a whole chunk at a time: slices of bytes and of doubles, and
searches in them; Python runs for stretches of moves, not for moves. Heights are mm in
machine coordinates. The rules look at the program's own file: a macro is checked when
it is the file.
"""

from __future__ import annotations

import re
from itertools import compress
from typing import Any

from aircut.canon import ROW, Chunk, Kind
from aircut.canon.commands import COMMANDS
from aircut.canon.toolpath import COLUMNS
from aircut.diagnostics import Diagnostic, Fault, Span
from aircut.diagnostics import faults as F
from aircut.interpreter.running import Run

NUMBERS = {name: number for number, name in enumerate(COMMANDS)}
UNITS, SYSTEM, SHIFT, SPEED, RIGHT, LEFT, STOP = (
    NUMBERS[name]
    for name in (
        "USE_LENGTH_UNITS", "SET_G5X_OFFSET", "SET_G92_OFFSET", "SET_SPINDLE_SPEED",
        "START_SPINDLE_CLOCKWISE", "START_SPINDLE_COUNTERCLOCKWISE", "STOP_SPINDLE_TURNING",
    )
)  # fmt: skip
HEARD = re.compile(b"[" + re.escape(bytes((UNITS, SYSTEM, SHIFT, SPEED, RIGHT, LEFT, STOP))) + b"]")
DOUBLES = ROW.size // 8
NAMES = [column.name for column in COLUMNS]
KIND = sum(column.code in "dihHB" and {"d": 8, "i": 4, "h": 2, "H": 2, "B": 1}[column.code]
           for column in COLUMNS[: NAMES.index("kind")])  # fmt: skip
X, Y, Z, LINE, FILE = (NAMES.index(name) for name in ("x", "y", "z", "line", "file"))
RAPID = bytes((Kind.TRAVERSE,))
IS_RAPID = bytes(kind == Kind.TRAVERSE for kind in range(256))
RUNS = re.compile(rb"\x00+|[^\x00]+", re.DOTALL)  # rapids; all others
CUTS = re.compile(bytes((91, Kind.FEED, Kind.ARC, 93)))
NEAR = 1e-6  # mm
LENGTHS = re.compile(rb"(?i)[xyzijkr][ \t]*[-+.\d#\[]")
#: Moves that do not go to a height of the program's own; and codes under which Z is not the tool's direction.
ELSEWHERE = re.compile(rb"(?i)g[ \t]*0*(?:53|28|30)(?![\d.])")
TILTED = re.compile(rb"g[ \t]*(?:68[ \t]*\.[ \t]*2|43[ \t]*\.[ \t]*[47])")


class Watch:
    """Feed it the chunks of a run; `found` is what it has to tell."""

    def __init__(self, run: Run) -> None:
        self.run = run
        self.found: list[Diagnostic] = []
        self.speeds: dict[int, float] = {}  # of the spindles
        self.turning: set[int] = set()
        self.cuts = False  # one of them turns, and its speed is not 0
        self.told = False  # that it is not turning, since it last turned
        self.units = False  # said by the program, or missed already
        self.system_z = 0.0
        self.shift_z = 0.0
        self.depth = float("inf")  # lowest place of the last cut
        self.cutting = False
        self.place = (0.0, 0.0, 0.0)
        source = run.units[run.files[0]].source
        self.tilted = any(TILTED.search(text.lower()) for _, text in source.foreign())

    def add(self, chunk: Chunk) -> None:
        """Look at one chunk."""
        rows = chunk.rows
        kinds = bytes(rows[KIND :: ROW.size])
        heights: list[Any] = memoryview(rows).cast("d")[Z::DOUBLES].tolist()
        at = 0
        events = chunk.events
        for match in HEARD.finditer(events.name.tobytes()):
            event = events[match.start()]
            if event.at - chunk.first > at:
                self.stretch(rows, kinds, heights, at, event.at - chunk.first)
                at = event.at - chunk.first
            self.hear(NUMBERS[event.name], event.values, event.line)
        self.stretch(rows, kinds, heights, at, len(kinds))
        if kinds:
            self.place = ROW.unpack_from(rows, len(rows) - ROW.size)[X : Z + 1]

    def hear(self, name: int, values: tuple[float, ...], line: int) -> None:
        if name == UNITS:
            self.units = self.units or line > 0
        elif name == SYSTEM:
            self.system_z = values[3]
        elif name == SHIFT:
            self.shift_z = values[2]
        elif name == SPEED:
            self.speeds[int(values[0])] = values[1]
        elif name == STOP:
            self.turning.discard(int(values[0]))
        else:
            self.turning.add(int(values[0]))
        self.cuts = any(self.speeds.get(spindle, 0.0) > 0.0 for spindle in self.turning)
        if self.cuts:
            self.told = False

    def stretch(self, rows: bytes | memoryview, kinds: bytes, heights: list[Any], start: int, end: int) -> None:
        """Moves between two events that matter."""
        if start == end:
            return
        if not self.units:
            self.find_lengths(rows, start, end)
        if not self.told and not self.cuts:
            self.find_cut(rows, kinds, start, end)
        zero = self.system_z + self.shift_z
        rapids = compress(heights[start:end], kinds[start:end].translate(IS_RAPID))
        if self.tilted or min(rapids, default=zero) >= zero - NEAR:
            self.pass_over(kinds, heights, start, end)
            return
        for match in RUNS.finditer(kinds, start, end):
            first, last = match.span()
            lowest = min(heights[first:last])
            if kinds[first]:
                self.depth = min(self.depth, lowest) if self.cutting else lowest
                self.cutting = True
            else:
                self.cutting = False
                limit = min(zero, self.depth) - NEAR
                if lowest < limit and (self.turning or self.depth < float("inf")):
                    self.find_plunge(rows, heights, range(first, last), limit)

    def pass_over(self, kinds: bytes, heights: list[Any], start: int, end: int) -> None:
        """Moves without a rapid below zero: what matters is where the last cut among them went."""
        last = start + len(kinds[start:end].rstrip(RAPID))
        if last > start:
            first = max(kinds.rfind(RAPID, start, last) + 1, start)
            lowest = min(heights[first:last])
            self.depth = min(self.depth, lowest) if self.cutting and first == start else lowest
        self.cutting = last == end and (last > start or self.cutting)

    def find_lengths(self, rows: bytes | memoryview, start: int, end: int) -> None:
        """The first move to a length, with the units not said."""
        for at in range(start, end):
            if LENGTHS.search(self.text(rows, at)):
                self.units = True
                self.tell(F.NO_UNITS, rows, at)
                return

    def find_cut(self, rows: bytes | memoryview, kinds: bytes, start: int, end: int) -> None:
        """The first feed move that does not just leave the work."""
        for match in CUTS.finditer(kinds, start, end):
            at = match.start()
            before = ROW.unpack_from(rows, (at - 1) * ROW.size)[X : Z + 1] if at else self.place
            after = ROW.unpack_from(rows, at * ROW.size)[X : Z + 1]
            if before[:2] != after[:2] or after[2] < before[2] - NEAR:
                if self.tell(F.SPINDLE_OFF, rows, at, why="S is 0" if self.turning else "it is off"):
                    self.told = True
                    return

    def find_plunge(self, rows: bytes | memoryview, heights: list[Any], moves: range, limit: float) -> None:
        """Rapids that go down, below all that has been cut there."""
        zero = self.system_z + self.shift_z
        for at in moves:
            before = heights[at - 1] if at else self.place[2]
            if heights[at] < limit and heights[at] < before - NEAR and not ELSEWHERE.search(self.text(rows, at)):
                depth = "nothing has been cut yet"
                if self.depth < float("inf"):
                    depth = f"the last cut was at Z{self.depth - zero:.4g} mm"
                self.tell(F.RAPID_BELOW_CUT, rows, at, height=heights[at] - zero, depth=depth)

    def text(self, rows: bytes | memoryview, at: int) -> bytes:
        """The line of a move."""
        row = ROW.unpack_from(rows, at * ROW.size)
        source = self.run.units[self.run.files[row[FILE]]].source
        return bytes(source.raw(row[LINE] - 1)) if row[LINE] else b""

    def tell(self, fault: Fault, rows: bytes | memoryview, at: int, **values: Any) -> bool:
        """Note the fault of a move; False where it stands in another file."""
        row = ROW.unpack_from(rows, at * ROW.size)
        if row[FILE] or not row[LINE]:
            return False
        name = self.run.files[0]
        text = self.run.units[name].source.text(row[LINE] - 1)
        start = len(text) - len(text.lstrip())
        span = Span(row[LINE], start + 1, max(len(text.rstrip()), start + 1) + 1)
        self.found.append(fault.at(name, span, **values))
        return True
