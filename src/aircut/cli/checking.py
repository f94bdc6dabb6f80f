"""`aircut check`."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import click

from aircut import rules
from aircut.cli import common
from aircut.diagnostics import Diagnostic, Severity
from aircut.interpreter.running import Mode, Run


def check(files: Sequence[Path], style: str, output: Path | None, options: dict[str, Any]) -> int:
    """Check the files one by one; returns the exit status."""
    diagnostics: list[Diagnostic] = []
    interpreters: list[Run] = []
    for file in files:
        made = common.interpreter(file, options, common.machine(options), True, False, Mode.ANALYSIS)
        if isinstance(made, Diagnostic):
            diagnostics.append(made)
            continue
        with common.progress(f"checking {file.name}") as advance:
            for _ in rules.checked(made, common.policy(file, options)):
                advance(made.line, len(made.unit.source))
        diagnostics += made.diagnostics
        interpreters.append(made)
    write(diagnostics, style, output, interpreters)
    return int(any(d.severity is Severity.ERROR for d in diagnostics))


def write(diagnostics: Sequence[Diagnostic], style: str, output: Path | None, interpreters: Sequence[Run]) -> None:
    from aircut.files import replacing

    lines = common.lines_of(*interpreters)
    if style == "text":
        if output is None:
            common.show(diagnostics, lines, sys.stdout)
            if sys.stdout.isatty():
                print(common.totals(diagnostics) or "no faults found")
            return
        try:
            with replacing(output) as file:
                common.show(diagnostics, lines, file)
        except OSError as error:
            raise click.ClickException(f"cannot write {output}: {error.strerror}") from None
        return
    from aircut.export.diagnostics import FORMATS

    text = FORMATS[style](diagnostics)
    if output is None:
        click.echo(text, nl=False)
        return
    try:
        with replacing(output) as file:
            file.write(text)
    except OSError as error:
        raise click.ClickException(f"cannot write {output}: {error.strerror}") from None
