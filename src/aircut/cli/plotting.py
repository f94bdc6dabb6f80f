"""`aircut plot`."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import click

from aircut.cli import common
from aircut.cli.running import collect
from aircut.diagnostics import Diagnostic
from aircut.files import replacing

if TYPE_CHECKING:
    from aircut.api import Result
    from aircut.planner import Plan


def plot(file: Path, output: Path, what: str, options: dict[str, Any]) -> int:
    """Draw a program's toolpath, or a curve of its motion over time; returns the exit status."""
    if what != "path":
        return curve(file, output, what, options)
    made = common.interpreter(file, options, common.machine(options), keep_going=False, keeps_moves=True)
    if isinstance(made, Diagnostic):
        common.show([made], lambda *_: "", sys.stderr)
        return 1
    result = collect(made)
    common.show(made.diagnostics, common.lines_of(made), sys.stderr)
    title = file.name if result.ok else f"{file.name} (up to the error)"
    try:
        if output.suffix.lower() == ".html":
            from aircut.export import page

            sources = {name: source.whole() for name, source in result.sources.items()}
            with replacing(output) as out:
                out.write(page.html(result.recording, sources, title, blended(result)))
        else:
            from aircut.export import still

            with replacing(output, binary=True) as out:
                still.draw(result.recording, out, style(output), title, plan=blended(result))
    except OSError as error:
        raise click.ClickException(f"cannot write {output}: {error.strerror}") from None
    return int(made.failed)


def style(output: Path) -> Literal["svg", "png"]:
    return "svg" if output.suffix.lower() == ".svg" else "png"


def blended(result: Result) -> Plan | None:
    """The plan of a run that blends corners; None where nothing is to be seen of it."""
    from aircut.planner import PlanError

    if not any(event.name == "SET_MOTION_CONTROL_BLEND" and event.values[0] for event in result.events):
        return None
    try:
        return result.plan()
    except PlanError:
        return None  # the path can be drawn all the same


def curve(file: Path, output: Path, what: str, options: dict[str, Any]) -> int:
    """Draw a curve over time; returns the exit status."""
    from aircut.cli.timing import planned
    from aircut.export import curves

    found = planned(file, options)
    if found is None:
        return 1
    result, made = found
    title = file.name if result.ok else f"{file.name} (up to the error)"
    try:
        with replacing(output, binary=True) as out:
            curves.draw(made, what, out, style(output), title)
    except OSError as error:
        raise click.ClickException(f"cannot write {output}: {error.strerror}") from None
    return int(not result.ok)
