"""What the commands share: the machine from the options, the program, progress, diagnostics on a terminal."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import IO, Any

import click
import msgspec

from aircut import dialects
from aircut.diagnostics import Diagnostic, Severity, Span
from aircut.diagnostics import faults as F
from aircut.interpreter.running import Limits, Mode, Run, Settings, Start
from aircut.interpreter.table import Dialect
from aircut.machine import Machine, MachineError, inifile, load, memory, store
from aircut.rules.policy import Policy, RulesError
from aircut.source import Source

PATIENCE = 1.0  # seconds of work before progress is shown
UNITS = {"mm": 1.0, "inch": 25.4}  # mm
COLORS = {Severity.ERROR: "red", Severity.WARNING: "yellow"}


def dialect(options: dict[str, Any]) -> Dialect:
    """The dialect that the options name. Raises click.UsageError."""
    try:
        return dialects.load(options["dialect"])
    except ValueError as error:
        raise click.UsageError(str(error)) from None


def machine(options: dict[str, Any]) -> Machine:
    """The machine that the options describe. Raises click.UsageError."""
    language = dialect(options)
    try:
        if options["folder"]:
            if options["axes"]:
                raise click.UsageError("--axes is for the built-in machine; a folder's machine.toml names its own")
            made = load(options["folder"])
        else:
            made = dialects.machine(language, options["axes"] or "")
        made.macros = (*options["macros"], *made.macros)
        made.key = options["key"]
        if options["entry"]:
            made.options = msgspec.structs.replace(made.options, entry=options["entry"])
        if options["tools"]:
            from aircut.machine.imports import read_library, read_slots

            unit = UNITS[options["tool_unit"]] if options["tool_unit"] else language.table_unit
            made.tools, warnings = read_library(options["tools"], unit)
            made.slots = read_slots(options["tools"], unit)
            for text in warnings:
                click.echo(f"{text} (warning)", err=True)
            made.own_tools = True
        if options["parameters"]:
            known = language.parameters or (*memory.PERSISTENT, *memory.GIVEN)
            given = memory.read_parameters(options["parameters"], known)
            if language.parameters:
                made.parameters = given
            else:
                made.variables |= given
        if options["ini"]:
            if not language.takes_ini:
                raise click.UsageError("--ini is for programs of the linuxcnc dialect")
            made.ini = inifile.load(options["ini"])
            made.macros = (*made.ini.folders, *made.macros)
    except MachineError as error:
        raise click.UsageError(str(error)) from None
    return made


def settings(
    options: dict[str, Any], keep_going: bool, keeps_moves: bool, mode: Mode = Mode.PROGRAM, start: Start | None = None
) -> Settings:
    """How to run."""
    moves = options["max_moves"]
    if moves is None and keeps_moves:
        from aircut.api import MOVES_KEPT

        moves = MOVES_KEPT
    limits = Limits(blocks=options["max_blocks"], moves=moves)
    stop_line = options.get("stop_line") or 0
    skip, optional = options["block_delete"], options["optional_stop"]
    return Settings(skip, optional, keep_going, limits=limits, mode=mode, start=start, stop_line=stop_line)


def interpreter(
    file: Path,
    options: dict[str, Any],
    made: Machine,
    keep_going: bool,
    keeps_moves: bool,
    mode: Mode = Mode.PROGRAM,
    start: Start | None = None,
) -> Run | Diagnostic:
    """An interpreter of the file, or why there is none. Raises click.UsageError for what the dialect does not take."""
    language = dialect(options)
    try:
        source = Source.load(file)
    except OSError as error:
        return F.CANNOT_READ.at(str(file), Span(), reason=error.strerror or str(error))
    chosen = settings(options, keep_going, keeps_moves, mode, start)
    try:
        return language.interpreter(source, language, made, chosen)
    except MachineError as error:
        raise click.UsageError(str(error)) from None


def policy(file: Path, options: dict[str, Any]) -> Policy:
    """What the project's file and the options say of rules. Raises click.UsageError."""
    try:
        return Policy.of(file, options.get("ignore", ()))
    except RulesError as error:
        raise click.UsageError(str(error)) from None


def remember(options: dict[str, Any], made: Machine, finished: Run) -> None:
    """Write back what outlives the run, where there is a place for it. Raises click.ClickException."""
    if not (options["parameters"] or made.folder):
        return
    kept = finished.remembered()
    try:
        if options["parameters"]:
            memory.write_parameters(options["parameters"], kept)
        elif made.folder:
            tools = finished.state.tools
            changed = {id: tool for id, tool in tools.items() if made.library.get(id) != tool}
            store.remember(made.folder, kept, changed, finished.stop)
    except (OSError, MachineError) as error:
        raise click.ClickException(f"cannot store the machine's variables: {error}") from None


@contextmanager
def progress(what: str) -> Iterator[Callable[[int, int], None]]:
    """A progress bar on the terminal for work that takes longer than PATIENCE: call it with (done, all)."""
    start = time.monotonic()
    bar: Any = None
    task: Any = None

    def advance(done: int, total: int) -> None:
        nonlocal bar, task
        if bar is None:
            if time.monotonic() - start < PATIENCE or not sys.stderr.isatty():
                return
            from rich.console import Console
            from rich.progress import Progress

            bar = Progress(console=Console(stderr=True), transient=True)
            task = bar.add_task(what, total=total)
            bar.start()
        bar.update(task, completed=min(done, total), total=total)

    try:
        yield advance
    finally:
        if bar is not None:
            bar.stop()


def show(diagnostics: Sequence[Diagnostic], source_line: Callable[[str, int], str], file: IO[str]) -> None:
    """Write diagnostics for people; on a terminal with color, and the line with the place marked under it."""
    terminal = file.isatty()
    for d in diagnostics:
        place = f"{d.file}:{d.span.line}:{max(d.span.column, 1)}" if d.span.line else d.file
        severity = d.severity.value
        if terminal:
            severity = click.style(severity, fg=COLORS[d.severity], bold=True)
        print(f"{place}: {severity} {d.code}: {d.message}", file=file)
        if terminal and d.span.line:
            text = source_line(d.file, d.span.line)
            start = max(d.span.column - 1, 0)
            width = max(min(d.span.end - 1, len(text)) - start, 1)
            gutter = f"{d.span.line:>5} | "
            shown = "".join(c if c.isprintable() or c == "\t" else "\N{REPLACEMENT CHARACTER}" for c in text)[:400]
            blank = "".join("\t" if c == "\t" else " " for c in shown[:start])
            mark = click.style("^" * min(width, 400), fg=COLORS[d.severity], bold=True)
            print(gutter + shown, file=file)
            print(" " * 5 + " | " + blank + mark, file=file)
        for frame in reversed(d.stack):
            print(f"        in {frame.name}, called from {frame.file}:{frame.line}", file=file)
        if d.hint:
            print(f"        = {d.hint}", file=file)


def totals(diagnostics: Sequence[Diagnostic]) -> str:
    """“2 errors, 1 warning”."""
    counts = [(sum(d.severity is s for d in diagnostics), s.value) for s in Severity]
    return ", ".join(f"{n} {word}{'s' * (n != 1)}" for n, word in counts if n)


def lines_of(*interpreters: Run) -> Callable[[str, int], str]:
    """Text of a line of a program, by file name and number from 1."""
    sources = {name: unit.source for i in interpreters for name, unit in i.units.items()}
    return lambda file, line: sources[file].text(line - 1) if file in sources else ""
