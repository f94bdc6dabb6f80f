"""Compile modes, and starting in the middle: from a line, or where a run was stopped.

Everything before the line is interpreted for its state, with nobody to ask and
without motion; then the machine is told the state and brought to the place.
Sources: 000 section 2.2.3; decisions AMB-EXE-2, AMB-NAM-8.
"""

from __future__ import annotations

from collections.abc import Generator
from typing import TYPE_CHECKING, Any, NoReturn

from aircut.canon.commands import MANY, SETS
from aircut.diagnostics import Refusal, Span
from aircut.diagnostics import faults as F
from aircut.interpreter import path
from aircut.interpreter.motion import FEED, TRAVERSE, apart
from aircut.interpreter.path import Place
from aircut.interpreter.running import Arrival, Run, Settings, Start, Stopped
from aircut.interpreter.state import State
from aircut.machine.stops import Stop

if TYPE_CHECKING:
    from aircut.canon import Chunk
    from aircut.interpreter.requests import Request
    from aircut.interpreter.table import Dialect
    from aircut.machine import Machine
    from aircut.source import Source

CUTTING = ("G1", "G2", "G3")


class Midway:
    """The way of one run to its start: what it did before is only watched."""

    def __init__(self, start: Start, standing: Place) -> None:
        self.start = start
        self.standing = list(start.stop.place) if start.stop else standing
        self.highest = self.standing[2]
        self.last: Place | None = None
        self.told: dict[tuple[Any, ...], tuple[str, tuple[Any, ...]]] = {}  # the last event of each thing set

    def drop(self, m: State) -> None:
        """Forget the motion so far, but for its height and its end; of the events, what they set stays known."""
        import numpy as np

        from aircut.canon.toolpath import Toolpath

        chunk = m.out.take()
        if chunk.rows:
            ends = Toolpath.of_rows([bytes(chunk.rows)]).ends()
            self.highest = max(self.highest, float(np.max(ends[:, 2])))
            self.last = ends[-1].tolist()
        for event in chunk.events:
            what = SETS.get(event.name)
            if what is not None:
                key = (what, event.values[0]) if what in MANY else (what,)
                self.told.pop(key, None)  # the last comes last
                self.told[key] = event.name, event.values
        m.out.give_back(chunk)

    def arrived(self, m: State, line: int) -> bool:
        return line >= self.start.line and m.out.moves >= self.start.moves

    def begin(self, m: State, line: int, modes: tuple[str, ...], compensation: str) -> Arrival:
        """Tell the state, and go to the place; modes: codes in force, and which of G40 to G42.1 is.

        Raises Refusal under radius compensation.
        """
        if compensation != "G40":
            raise Refusal(F.START_COMPENSATED, line=line, code=compensation)
        path.flush(m)
        self.drop(m)
        m.out.first = 0
        m.restarted = [*m.position]
        self.tell(m)
        goal = self.last if "rtcp" in m.stages and self.last is not None else m.to_space(m.position)[:6]
        top = max(self.highest, goal[2])
        above = [*goal[:2], top, *goal[3:]]
        feeding = m.motion is not None and m.motion.name in CUTTING and m.feed > 0.0 and goal[2] < top
        way = [
            ("G0", [*self.standing[:2], top, *self.standing[3:]]),
            ("G0", above),
            ("G1" if feeding else "G0", goal),
        ]
        approach: list[tuple[str, tuple[float, ...]]] = []
        here = self.standing
        for code, end in way:
            if apart(here, end):
                kind, speed = (FEED, m.feed) if code == "G1" else (TRAVERSE, 0.0)
                path.record_line(m, kind, end, speed, m.flags)
                approach.append((code, tuple(end)))
                here = end
        told = f"T{m.tool} F{m.feed / m.unit:g} S{m.speed:g}"
        return Arrival(line, tuple(m.position[:6]), modes, told, tuple(approach))

    def tell(self, m: State) -> None:
        """Write down what is in force; the tool is in the spindle already."""
        for name, values in self.told.values():
            m.out.event(name, *values)
        if m.tool:
            m.out.event("CHANGE_TOOL_NUMBER", m.tool)
        if m.selected_tool != m.tool:
            m.out.event("SELECT_TOOL", m.selected_tool)


class Marked(Run):
    """A run that can start from a line of the main program, and stop before one."""

    def __init__(self, source: Source, dialect: Dialect, machine: Machine, settings: Settings | None) -> None:
        super().__init__(source, dialect, machine, settings)
        self.midway: Midway | None = None  # on the way to the start, while motion is only watched
        self.mark = 0  # line of the main program at which `pass_mark` has something to do, from 1; 0 none

    scratch = ""  # a named variable of one command of MDI

    def begin(self) -> None:
        """Tell what is in force before the first command of MDI."""
        raise NotImplementedError

    def command(self, source: Source) -> Generator[Chunk | Request, Any, None]:
        """Run a command of MDI, with the modes and variables as they are."""
        raise NotImplementedError

    def standing(self) -> tuple[str, ...]:
        """The codes in force that people want to see."""
        return self.in_force()[0]

    def in_force(self) -> tuple[tuple[str, ...], str]:
        """The codes in force, and which of G40 to G42.1 is."""
        raise NotImplementedError

    def called_from(self) -> tuple[int, int] | None:
        """In a subroutine: the line of the main program that called, from 1, and the moves before it."""
        raise NotImplementedError

    def prepare(self) -> bool:
        """Set the compile mode, and the mark that the run starts or stops at; False if there is no such line."""
        m, settings, count = self.state, self.settings, len(self.unit.source)
        m.compile_mode = settings.mode
        self.mark = settings.stop_line
        if settings.start is not None:
            self.mark = m.compile_line = settings.start.line
            self.midway = Midway(settings.start, m.to_space(m.position)[:6])
            if settings.start.stop is not None:
                m.stopped = list(settings.start.stop.place)
        if 0 <= self.mark <= count:
            return True
        self.tell(F.START_OUTSIDE.at(self.unit.source.name, Span(), line=self.mark, count=count))
        return False

    def pass_mark(self, line: int) -> None:
        """Before a line of the routine with the mark: the start, or the stop. Raises Refusal, Stopped."""
        m = self.state
        if self.midway is not None:
            if not self.midway.arrived(m, line + 1):
                return
            self.line = line
            m.line = m.out.line = line + 1
            self.arrival = self.midway.begin(m, line + 1, *self.in_force())
            self.midway = None
            self.mark = self.settings.stop_line
        if self.midway is None and line + 1 == self.settings.stop_line:
            self.line = line
            path.flush(m)
            self.halt()

    def halt(self) -> NoReturn:
        """STOP: the run ends before its line, to be resumed; in a subroutine, before the call. Raises Stopped."""
        m = self.state
        line, moves = self.called_from() or (self.line + 1, m.out.moves)
        place = m.to_space(m.position)[:6]
        m.stopped = list(place)
        self.stop = Stop(self.files[0], line, moves, tuple(place))
        m.out.line = 0
        raise Stopped

    def not_arrived(self) -> None:
        """The program has ended on the way to its start."""
        if self.midway is not None:
            self.tell(F.START_NOT_REACHED.at(self.files[0], Span(), line=self.midway.start.line))
