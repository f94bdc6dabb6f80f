"""`aircut plot`."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import click

from aircut.cli import common
from aircut.cli.running import collect
from aircut.diagnostics import Diagnostic
from aircut.files import replacing


def plot(file: Path, output: Path, options: dict[str, Any]) -> int:
    """Draw a program's toolpath; returns the exit status."""
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
                out.write(page.html(result.recording, sources, title))
        else:
            from aircut.export import still

            with replacing(output, binary=True) as out:
                still.draw(result.recording, out, "svg" if output.suffix.lower() == ".svg" else "png", title)
    except OSError as error:
        raise click.ClickException(f"cannot write {output}: {error.strerror}") from None
    return int(made.failed)
