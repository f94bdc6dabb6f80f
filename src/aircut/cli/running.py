"""`aircut run`."""

from __future__ import annotations

import sys
from collections.abc import Iterable
from pathlib import Path
from typing import IO, Any

import click

from aircut.canon import Recording
from aircut.cli import common
from aircut.diagnostics import Diagnostic
from aircut.interpreter.interpreter import Interpreter


def run(file: Path, style: str, output: Path | None, options: dict[str, Any]) -> int:
    """Run a program and report in the wanted style; returns the exit status."""
    machine = common.machine(options)
    made = common.interpreter(file, options, machine, keep_going=False, keeps_moves=style != "canon")
    if isinstance(made, Diagnostic):
        common.show([made], lambda *_: "", sys.stderr)
        return 1
    if output is None:
        report(made, style, sys.stdout, options)
    else:
        from aircut.export.files import replacing

        try:
            with replacing(output) as out:
                report(made, style, out, options)
        except OSError as error:
            raise click.ClickException(f"cannot write {output}: {error.strerror}") from None
    if style != "json" or output is not None:
        common.show(made.diagnostics, common.lines_of(made), sys.stderr)
    common.remember(options, machine, made)
    return int(made.failed)


def report(made: Interpreter, style: str, out: IO[str], options: dict[str, Any]) -> None:
    if style == "canon":
        out.writelines(listing(made))
        return
    result = collect(made)
    if style == "json":
        from aircut.export.report import to_json

        out.write(to_json(result, made.files[0], options["dialect"]))
        return
    from aircut.cli.summary import summary

    summary(result, out)


def listing(made: Interpreter) -> Iterable[str]:
    """The canonical listing, written as the run goes."""
    from aircut.export.listing import Listing

    text = Listing(lambda file, line: made.units[made.files[file]].source.raw(line - 1))
    with common.progress(f"running {Path(made.files[0]).name}") as advance:
        for chunk in made.run():
            yield from text.write(chunk)
            advance(made.line, len(made.unit.source))


def collect(made: Interpreter) -> Any:
    """The Result of a run."""
    from aircut.api import Result

    recording = Recording()
    with common.progress(f"running {Path(made.files[0]).name}") as advance:
        for chunk in made.run():
            recording.add(chunk)
            advance(made.line, len(made.unit.source))
    recording.files = made.files
    return Result(recording, made)
