"""What every interpreter of programs has: its files, what it has to tell, and how it is told to run.

Sources of the compile modes: 000 section 2.2.3; decisions AMB-EXE-2, AMB-NAM-8.
"""

from __future__ import annotations

from collections.abc import Generator, Iterator
from enum import IntEnum
from typing import TYPE_CHECKING, Any, NamedTuple

from aircut.canon import Chunk
from aircut.diagnostics import Diagnostic, Severity
from aircut.interpreter.requests import Request
from aircut.machine.stops import Stop

if TYPE_CHECKING:
    from aircut.interpreter.auxiliary import End
    from aircut.interpreter.state import State
    from aircut.interpreter.table import Dialect
    from aircut.machine import Machine
    from aircut.source import Source


class Limits(NamedTuple):
    """What stops runaway programs; all can be raised."""

    blocks: int = 100_000_000  # run again by loops, GOTO, calls, M47
    moves: int | None = None  # None: no limit; set where they are all kept
    line: int = 1 << 20  # characters
    diagnostics: int = 1000


class Mode(IntEnum):
    """What is being compiled; the numbers are those of `#<compile.mode_...>`."""

    MDI = 0
    MACRO = 1
    PROGRAM = 2
    FROM_LINE = 3
    RESUME = 4
    RESUME_FROM_LINE = 5
    ANALYSIS = 6


WHOLE = (Mode.PROGRAM, Mode.ANALYSIS)  # what should end as a program does


class Log(NamedTuple):
    """A text file that a program writes."""

    append: bool  # to one that is there already
    lines: list[str]


class Start(NamedTuple):
    """Where motion starts, in place of the first line."""

    line: int  # of the main program, from 1
    moves: int = 0  # to have been made before
    stop: Stop | None = None  # the machine stands there; None: at its origin


class Arrival(NamedTuple):
    """How the program started midway, for a report."""

    line: int
    place: tuple[float, ...]  # where the program continues: its own frame, mm and degrees
    modes: tuple[str, ...]  # codes in force
    told: str  # what else is in force, for people
    approach: tuple[tuple[str, tuple[float, ...]], ...]  # code and machine coordinates


class Settings(NamedTuple):
    """How to run."""

    block_delete: bool = False
    optional_stop: bool = False
    keep_going: bool = False  # after an error, go on with the next block
    restarts: int = 1  # runs that M47 asks for
    mode: Mode = Mode.PROGRAM
    start: Start | None = None  # None: at the first line
    stop_line: int = 0  # of the main program, from 1: stop before it, as on STOP
    limits: Limits = Limits()


class Stopped(Exception):
    """The run cannot go on."""


class Run:
    """A run of one program on one machine. Iterate `run()`; then read `state` and `diagnostics`.

    files: names of the texts met, in the order of their indices; units: by name,
    each with its `source`. unit: the one being run; line: in it, from 0.
    """

    state: State
    units: dict[str, Any]
    unit: Any

    def __init__(self, source: Source, dialect: Dialect, machine: Machine, settings: Settings | None) -> None:
        self.settings = settings or Settings()
        self.dialect = dialect
        self.machine = machine
        self.diagnostics: list[Diagnostic] = []
        self._told: set[tuple[Any, ...]] = set()
        self.files = [source.name]
        self.line = 0
        self.ended: End | None = None
        self.arrival: Arrival | None = None  # where the program was started, if not at its first line
        self.stop: Stop | None = None  # where the run was stopped

    def tell(self, diagnostic: Diagnostic) -> None:
        """Add a diagnostic, once."""
        key = (diagnostic.code, diagnostic.file, diagnostic.span)
        if key not in self._told and len(self.diagnostics) < self.settings.limits.diagnostics:
            self._told.add(key)
            self.diagnostics.append(diagnostic)

    @property
    def failed(self) -> bool:
        """Whether there was an error."""
        return any(d.severity is Severity.ERROR for d in self.diagnostics)

    def logs(self) -> dict[str, Log]:
        """Text files that the program has written, by the names that it gives them."""
        return {}

    def remembered(self) -> dict[int, float]:
        """The numbered variables that outlive the run, as the machine stores them."""
        from aircut.interpreter.starting import remembered

        return remembered(self.state)

    def run(self) -> Iterator[Chunk]:
        """Run the program with nobody to ask; yields its motion and events as they come."""
        for item in self.execute():
            if isinstance(item, Chunk):
                yield item

    def execute(self) -> Generator[Chunk | Request, Any, None]:
        """Run the program: yields motion and events, and requests, to be sent replies (None: not executed)."""
        raise NotImplementedError
