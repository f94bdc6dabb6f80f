"""The Python API: load a program, check it, run it, look at what it does.

program = aircut.load("part.ngc")
for diagnostic in program.check():
    print(diagnostic)
result = program.run()
print(result.extents, len(result.toolpath))
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from io import StringIO
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from aircut import dialects
from aircut.canon import COMMANDS, Chunk, Kind, Recording, Toolpath
from aircut.canon.record import Events
from aircut.canon.toolpath import Extents
from aircut.diagnostics import Diagnostic, Severity
from aircut.interpreter.rotary import displayed
from aircut.interpreter.running import Limits, Mode, Run, Settings, Start
from aircut.machine import Machine, Tool
from aircut.machine import load as load_machine
from aircut.source import Source

if TYPE_CHECKING:
    from aircut.planner import Plan

__all__ = ["CanonicalCommand", "Limits", "Program", "Result", "load", "loads"]

MOVES_KEPT = 20_000_000  # moves that a Result holds at most, unless told otherwise


class CanonicalCommand(NamedTuple):
    """One canonical command.

    values: of motion, the row of the toolpath by column name (machine coordinates,
    mm and degrees); of all others, the values named in aircut.canon.COMMANDS.
    """

    name: str
    values: dict[str, Any]
    line: int  # from 1; 0 before the program starts
    file: str


class Message(NamedTuple):
    """A message to the operator."""

    text: str  # with the document's tags; aircut.markup renders it
    kind: int  # the Q word
    medium: str  # text, or media: then the text names a picture
    line: int
    file: str


class Result:
    """What a run did.

    toolpath: the motion, as columns.    events: all else, in order.
    diagnostics: what went wrong.    variables: numbered variables that have a value,
    and named ones.    state: the modes and positions at the end.
    arrival: how a run from a line came there (else None).    stop: where it was stopped, if it was.
    """

    def __init__(self, recording: Recording, interpreter: Run) -> None:
        self.recording = recording
        self.files = list(interpreter.files)
        self.diagnostics: list[Diagnostic] = list(interpreter.diagnostics)
        self.sources: dict[str, Source] = {name: interpreter.units[name].source for name in self.files}
        self.optional_stop = interpreter.settings.optional_stop
        self.arrival = interpreter.arrival
        self.stop = interpreter.stop
        self._interpreter = interpreter

    def __repr__(self) -> str:
        return f"<Result: {self.recording.moves} moves, {len(self.diagnostics)} diagnostics>"

    @property
    def ok(self) -> bool:
        """Whether there was no error."""
        return not any(d.severity is Severity.ERROR for d in self.diagnostics)

    @property
    def toolpath(self) -> Toolpath:
        """The motion, as columns."""
        return self.recording.toolpath

    @property
    def events(self) -> Events:
        """The commands that are not motion."""
        return self.recording.events

    @property
    def messages(self) -> list[Message]:
        """What the operator was told."""
        found = [(event.values, event.line, self.files[event.file]) for event in self.events if event.name == "MESSAGE"]
        return [Message(text, kind, medium, line, file) for (text, kind, medium), line, file in found]

    def tool(self, id: int) -> Tool | None:
        """A tool as the run left it in the table; None for one that is not in it."""
        return self._interpreter.state.tools.get(id)

    def plan(self, **options: Any) -> Plan:
        """The motion in time, on the machine that it ran on. Options as of aircut.planner.plan. Raises PlanError."""
        from aircut.planner import plan

        options.setdefault("optional_stop", self.optional_stop)
        return plan(self.recording, self._interpreter.machine, **options)

    @property
    def extents(self) -> Extents | None:
        """Box of all motion, machine coordinates, mm and degrees; None without motion."""
        return self.toolpath.extents()

    @property
    def variables(self) -> dict[int | str, float]:
        """Numbered (in mm, degrees) and named variables that are not null at the end."""
        m = self._interpreter.state
        known: dict[int | str, float] = {}
        for number, value in enumerate(m.locals):
            if value is not None:
                known[number] = value
        for number, value in enumerate(m.numbered):
            if value is not None:
                known[number] = value
        for names in (m.names, m.scope):
            known.update({name: value for name, value in names.items() if value is not None})
        return known

    @property
    def state(self) -> dict[str, Any]:
        """Modes in force at the end, by group, and the positions: mm, degrees, mm/min, rpm.

        position: in the work system. display: the same with the axes that wrap within one rotation.
        """
        m = self._interpreter.state
        return {
            "modes": {(group.name or "").lower(): row.name for group, row in m.modal.items()},
            "position": dict(zip("xyzabc", m.position[:6], strict=True)),
            "display": dict(zip("xyzabc", displayed(m)[:6], strict=True)),
            "machine": dict(zip("xyzabc", m.machine_position()[:6], strict=True)),
            "feed": m.feed,
            "speed": m.speed,
            "spindle": {3: "clockwise", 4: "counterclockwise"}.get(m.spindle, "off"),
            "mist": m.mist,
            "flood": m.flood,
            "tool": m.tool,
        }

    def system(self, number: int) -> float | None:
        """A numbered variable as the program would read it at the end."""
        return self._interpreter.state.read(float(number))

    def commands(self) -> Iterator[CanonicalCommand]:
        """All canonical commands in order."""
        names = {Kind.TRAVERSE: "STRAIGHT_TRAVERSE", Kind.FEED: "STRAIGHT_FEED", Kind.ARC: "ARC_FEED",
                 Kind.PROBE: "STRAIGHT_PROBE"}  # fmt: skip
        rows = self.toolpath.to_numpy()
        at = 0
        for event in self.events:
            while at < event.at:
                yield self._motion(names, rows[at])
                at += 1
            values = dict(zip(COMMANDS[event.name].fields, event.values, strict=True))
            yield CanonicalCommand(event.name, values, event.line, self.files[event.file])
        for row in rows[at:]:
            yield self._motion(names, row)

    __iter__ = commands

    def _motion(self, names: dict[Kind, str], row: Any) -> CanonicalCommand:
        values = dict(zip(row.dtype.names, row.tolist(), strict=True))
        return CanonicalCommand(names[Kind(values["kind"])], values, values["line"], self.files[values["file"]])

    def canon(self) -> Iterator[str]:
        """The canonical listing, line by line."""
        from aircut.export.listing import Listing

        listing = Listing(lambda file: self.sources[self.files[file]])
        for piece in listing.write(Chunk(0, self.toolpath.to_numpy().tobytes(), self.events)):
            yield from StringIO(piece, newline="\n")


class Program:
    """A program, ready to be checked or run any number of times."""

    def __init__(self, source: Source, dialect: str = "rosetta") -> None:
        """Raises ValueError for an unknown dialect."""
        self.source = source
        self.dialect = dialects.load(dialect)

    def __repr__(self) -> str:
        return f"<Program {self.source.name!r}: {len(self.source)} lines, {self.dialect.name}>"

    def interpreter(self, machine: Machine | str | Path | None = None, **settings: Any) -> Run:
        """An interpreter of this program.

        machine: a Machine, or the path of a machine's folder; None for the built-in one.
        settings: as in interpreter.running.Settings; from_line=N starts at that line.
        Raises MachineError for a folder that cannot be used.
        """
        if isinstance(machine, str | Path):
            machine = load_machine(Path(machine))
        if "from_line" in settings:
            settings |= {"start": Start(settings.pop("from_line")), "mode": Mode.FROM_LINE}
        made = machine or dialects.machine(self.dialect)
        return self.dialect.interpreter(self.source, self.dialect, made, Settings(**settings))

    def check(
        self, machine: Machine | str | Path | None = None, ignore: Iterable[str] = (), **settings: Any
    ) -> list[Diagnostic]:
        """All diagnostics, going on after errors; no motion is kept.

        ignore: codes of rules to leave out, beside those that comments and the project's
        aircut.toml switch off. Raises RulesError.
        """
        from aircut import rules

        policy = rules.Policy.of(Path(self.source.name), ignore)
        interpreter = self.interpreter(machine, **{"keep_going": True, "mode": Mode.ANALYSIS} | settings)
        for _ in rules.checked(interpreter, policy):
            pass
        return interpreter.diagnostics

    def run(self, machine: Machine | str | Path | None = None, **settings: Any) -> Result:
        """Run to the end, or to the first error (keep_going=True: past errors). Machine and settings as above."""
        limits = settings.setdefault("limits", Limits())
        if limits.moves is None:
            settings["limits"] = limits._replace(moves=MOVES_KEPT)
        interpreter = self.interpreter(machine, **settings)
        recording = Recording()
        for chunk in interpreter.run():
            recording.add(chunk)
        recording.files = interpreter.files
        return Result(recording, interpreter)

    def stream(self, machine: Machine | str | Path | None = None, **settings: Any) -> Iterator[Chunk]:
        """Run, yielding the motion in chunks as it comes."""
        return self.interpreter(machine, **settings).run()


def load(path: str | Path, dialect: str = "rosetta") -> Program:
    """A program from a file. Raises OSError, and ValueError for an unknown dialect."""
    return Program(Source.load(Path(path)), dialect)


def loads(text: str | bytes, dialect: str = "rosetta", name: str = "<text>") -> Program:
    """A program from text. Raises ValueError for an unknown dialect."""
    return Program(Source(name, text.encode() if isinstance(text, str) else text), dialect)
