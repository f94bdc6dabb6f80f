"""`aircut run`."""

from __future__ import annotations

import sys
from collections.abc import Iterable
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any

import click

from aircut import rules
from aircut.canon import Recording
from aircut.cli import common
from aircut.diagnostics import Diagnostic
from aircut.interpreter.running import Mode, Run, Start
from aircut.machine import Machine, MachineError, store

if TYPE_CHECKING:
    from aircut.controller import Simulation


def run(file: Path, style: str, output: Path | None, options: dict[str, Any]) -> int:
    """Run a program and report in the wanted style; returns the exit status."""
    machine = common.machine(options)
    mode, start = beginning(options, machine, file)
    made = common.interpreter(file, options, machine, False, style != "canon", mode, start)
    if isinstance(made, Diagnostic):
        common.show([made], lambda *_: "", sys.stderr)
        return 1
    policy = common.policy(file, options)
    simulation = simulated(made, options)
    try:
        told(made, simulation, style, output, options, policy)
    finally:  # whatever ends the run, the machine remembers
        common.remember(options, machine, made)
        if options["logs"] is not None:
            write_logs(made, options["logs"])
    if style != "json" or output is not None:
        common.show(made.diagnostics, common.lines_of(made), sys.stderr)
    return int(made.failed)


def write_logs(made: Run, folder: Path) -> None:
    """Write the files of the program's own, below a folder and nowhere else. Raises click.ClickException."""
    from aircut.files import below, replacing

    for name, log in made.logs().items():
        try:
            path = below(folder, name)
            path.parent.mkdir(parents=True, exist_ok=True)
            before = path.read_text("utf-8") if log.append and path.exists() else ""
            with replacing(path) as file:
                file.write(before)
                file.writelines(f"{line}\n" for line in log.lines)
        except ValueError as error:
            raise click.ClickException(f"cannot write a log: {error}") from None
        except OSError as error:
            raise click.ClickException(f"cannot write {name}: {error.strerror}") from None


def beginning(options: dict[str, Any], machine: Machine, file: Path) -> tuple[Mode, Start | None]:
    """What to compile, and where motion starts. Raises click.UsageError."""
    line = options["from_line"]
    if not options["resume"]:
        if line is not None:
            return Mode.FROM_LINE, Start(line)
        return (Mode.MACRO if options["as_macro"] else Mode.PROGRAM), None
    if machine.folder is None:
        raise click.UsageError("--resume needs a machine's folder (--machine), where the stop is remembered")
    try:
        stop = store.recall(machine.folder).stop
    except MachineError as error:
        raise click.UsageError(str(error)) from None
    if stop is None or Path(stop.program).resolve() != file.resolve():
        what = f"{stop.program} was stopped there" if stop else "no program was stopped there"
        raise click.UsageError(f"there is no stop of {file} on {machine.folder} to resume from: {what}")
    if line is not None:
        return Mode.RESUME_FROM_LINE, Start(line, 0, stop)
    return Mode.RESUME, Start(stop.line, stop.moves, stop)


def told(
    made: Run,
    simulation: Simulation | None,
    style: str,
    output: Path | None,
    options: dict[str, Any],
    policy: rules.Policy,
) -> None:
    """Run, and report to the terminal or a file. Raises click.ClickException."""
    if output is None:
        report(made, simulation, style, sys.stdout, options, policy)
        return
    from aircut.files import replacing

    try:
        with replacing(output) as out:
            report(made, simulation, style, out, options, policy)
    except OSError as error:
        raise click.ClickException(f"cannot write {output}: {error.strerror}") from None


def simulated(made: Run, options: dict[str, Any]) -> Simulation | None:
    """The run in a world, where one is wanted. Raises click.UsageError."""
    if not (options["simulate"] or options["world"]):
        return None
    from aircut.controller import Simulation, World, WorldError, load

    path = options["world"]
    if path is None and options["folder"] and (options["folder"] / "world.toml").exists():
        path = options["folder"] / "world.toml"
    try:
        world = load(path) if path else World()
        for text in world.warnings:
            click.echo(f"{path}: warning: {text}", err=True)
        return Simulation(made, world)
    except WorldError as error:
        raise click.UsageError(str(error)) from None


def report(
    made: Run, simulation: Simulation | None, style: str, out: IO[str], options: dict[str, Any], policy: rules.Policy
) -> None:
    if style == "canon":
        out.writelines(listing(made, simulation))
        rules.settled(made, policy)
        return
    result = collect(made, simulation, policy)
    if style == "json":
        from aircut.export.report import to_json

        out.write(to_json(result, made.files[0], options["dialect"]))
        return
    from aircut.cli.summary import summary

    summary(result, out)


def listing(made: Run, simulation: Simulation | None) -> Iterable[str]:
    """The canonical listing, written as the run goes."""
    from aircut.export.listing import Listing

    text = Listing(lambda file: made.units[made.files[file]].source)
    with common.progress(f"running {Path(made.files[0]).name}") as advance:
        for chunk in (simulation or made).run():
            yield from text.write(chunk)
            made.state.out.give_back(chunk)
            advance(made.line, len(made.unit.source))


def collect(made: Run, simulation: Simulation | None = None, policy: rules.Policy | None = None) -> Any:
    """The Result of a run."""
    from aircut.api import Result

    recording = Recording()
    with common.progress(f"running {Path(made.files[0]).name}") as advance:
        for chunk in (simulation or made).run():
            recording.add(chunk)
            advance(made.line, len(made.unit.source))
    recording.files = made.files
    if policy is not None:
        rules.settled(made, policy)
    return Result(recording, made)
