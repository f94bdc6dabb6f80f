"""`aircut time`."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any

import click
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from aircut.cli import common
from aircut.cli.running import collect, simulated
from aircut.diagnostics import Diagnostic
from aircut.planner import KINDS, Overrides, Plan, PlanError, plan

if TYPE_CHECKING:
    from aircut.api import Result

MOTION = {"rapid": "rapid", "feed": "feed", "probing": "probing"}


def planned(file: Path, options: dict[str, Any]) -> tuple[Result, Plan] | None:
    """Run and plan a program; None, told on stderr, where there is no program. Raises click.ClickException."""
    machine = common.machine(options)
    made = common.interpreter(file, options, machine, keep_going=False, keeps_moves=True)
    if isinstance(made, Diagnostic):
        common.show([made], lambda *_: "", sys.stderr)
        return None
    result = collect(made, simulated(made, options))
    common.show(made.diagnostics, common.lines_of(made), sys.stderr)
    percents = (options["override_feed"], options["override_rapid"], options["override_spindle"])
    try:
        overrides = Overrides(*(percent / 100.0 for percent in percents))
        return result, plan(
            result.recording, machine, options["profile"], overrides, optional_stop=options["optional_stop"]
        )
    except PlanError as error:
        raise click.ClickException(f"{file.name}: {error}") from None


def time(file: Path, style: str, lines: int, output: Path | None, options: dict[str, Any]) -> int:
    """Tell how long a program takes; returns the exit status."""
    from aircut.export import times

    found = planned(file, options)
    if found is None:
        return 1
    result, made = found
    figures = times.figures(made, result, lines)
    name = str(file)
    text = {
        "json": lambda: times.to_json(figures, name, options["dialect"]),
        "csv": lambda: times.to_csv(figures, name),
    }

    def write(out: IO[str]) -> None:
        if style == "table":
            table(figures, out)
        else:
            out.write(text[style]())

    if output is None:
        write(sys.stdout)
    else:
        from aircut.files import replacing

        try:
            with replacing(output) as out:
                write(out)
        except OSError as error:
            raise click.ClickException(f"cannot write {output}: {error.strerror}") from None
    return int(not result.ok)


def clock(seconds: float) -> str:
    """“1:02:03.4” hours, minutes, seconds."""
    tenths = round(seconds * 10)
    minutes, tenths = divmod(tenths, 600)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02}:{tenths // 10:02}.{tenths % 10}"


def table(figures: dict[str, Any], out: IO[str]) -> None:
    """Write the figures for people."""
    console = Console(file=out, highlight=False, soft_wrap=not out.isatty(), width=None if out.isatty() else 100)
    total = figures["total"]
    console.print(f"[bold]{clock(total)}[/bold]  ({total:.3f} s, {figures['profile']} profile)")
    parts = Table()
    for title in ("", "time", "seconds", "share", "times"):
        parts.add_column(title, justify="left" if not title else "right")
    for name, title in {**MOTION, **KINDS}.items():
        seconds = figures["seconds"][name]
        if seconds:
            count = figures["counts"].get(name)
            share = f"{100 * seconds / total:.1f} %"
            parts.add_row(title, clock(seconds), f"{seconds:.3f}", share, f"{count:,}" if count else "")
    console.print(parts)
    if len(figures["tools"]) > 1:
        tools = Table()
        for title in ("tool", "total", "rapid", "feed", "probing", "pauses"):
            tools.add_column(title, justify="right")
        for row in figures["tools"]:
            tools.add_row(
                f"T{row['tool']}", *[f"{row[n]:.1f}" for n in ("total", "rapid", "feed", "probing", "pauses")]
            )
        console.print(tools)
    distance, speed = figures["distance"], figures["speed"]
    text = f"{distance['rapid']:.1f} mm rapid, {distance['feed']:.1f} mm feed"
    if distance["rotation"]:
        text += f", {distance['rotation']:.1f}° of rotary axes alone"
    console.print(f"distance  {text}")
    if speed["mean"] is not None:
        console.print(
            f"feed      {speed['mean']:.0f} mm/min mean, {speed['peak']:.0f} peak; "
            f"{100 * speed['reached']:.1f} % of the programmed {speed['programmed']:.0f} is reached"
        )
    if figures["lines"]:
        lines = Table(title="Lines that cost most", title_justify="left")
        lines.add_column("seconds", justify="right")
        lines.add_column("line")
        lines.add_column("")
        several = len({row["file"] for row in figures["lines"]}) > 1
        for row in figures["lines"]:
            place = f"{Path(row['file']).name}:{row['line']}" if several else str(row["line"])
            lines.add_row(f"{row['seconds']:.3f}", place, escape(row["text"][:60]))
        console.print(lines)
