"""`aircut mdi`, and `aircut run --mdi`: commands typed by hand."""

from __future__ import annotations

import re
import sys
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from aircut import dialects
from aircut.cli import common, running
from aircut.export.listing import Listing
from aircut.interpreter.mdi import Session
from aircut.interpreter.table import AXES, Dialect
from aircut.language.arithmetic import FUNCTIONS
from aircut.source import Source

if TYPE_CHECKING:
    from aircut.controller import Simulation
    from aircut.interpreter.state import State

HELP = """\
A line of NC code runs at once; modes and variables stay until the end.
?EXPRESSION  its value, as in  ?#5001  or  ?[sqrt[2] * #<_r>]
?            where the machine stands, and the modes in force
help         this text
Ctrl-D       leave"""
TYPED = re.compile(r"[#<\w.]+")  # what completion completes


class Desk:
    """One session with its options: runs commands and writes what comes of them."""

    def __init__(self, options: dict[str, Any]) -> None:
        self.options = options
        self.machine = common.machine(options)
        dialect = dialects.load(options["dialect"])
        self.session = Session(dialect, self.machine, common.settings(options, False, False))
        self.simulation: Simulation | None = running.simulated(self.session.interpreter, options)
        self.listing = Listing(self.text)
        self.listing.count = "".join(self.listing.write(self.session.opening)).count("\n")

    @property
    def state(self) -> State:
        return self.session.interpreter.state

    def text(self, file: int) -> Source:
        """The text of a file, for the listing's labels."""
        running = self.session.interpreter
        source: Source = running.units[running.files[file]].source
        return source

    def run(self, command: str) -> bool:
        """Run a command and write the canonical commands that it makes; whether it was free of errors."""
        session, simulation = self.session, self.simulation
        self.listing.labels.clear()
        for chunk in simulation.run(session.execute(command)) if simulation else session.run(command):
            sys.stdout.writelines(self.listing.write(chunk))
        sys.stdout.flush()
        lines = command.split("\n")
        common.show(self.session.diagnostics, lambda file, line: lines[line - 1], sys.stderr)
        return not self.session.interpreter.failed

    def value(self, expression: str) -> str | None:
        """The value of an expression as text; None where it has a fault, which is told."""
        name = self.session.interpreter.scratch
        if not self.run(f"#<{name}> = [{expression}]"):
            return None
        found = self.state.scope[name]
        return "null" if found is None or found != found else f"{found:.9g}"

    def standing(self) -> str:
        """Position and modes, on one line."""
        m = self.state
        place = " ".join(
            f"{axis.upper()}{round(m.position[i] / (m.unit if i < 3 else 1.0), 4) + 0.0:.4f}"
            for i, axis in enumerate(AXES)
            if axis in m.axes
        )
        modes = " ".join(self.session.interpreter.standing())
        return f"{place}  {modes}  T{m.tool} F{m.feed / m.unit:g} S{m.speed:g}"

    def close(self) -> None:
        common.remember(self.options, self.machine, self.session.interpreter)


def commands(texts: Iterable[str], options: dict[str, Any]) -> int:
    """Run commands one after another, up to one with an error; returns the exit status."""
    desk = Desk(options)
    fine = all(desk.run(text) for text in texts)
    desk.close()
    return int(not fine)


def converse(options: dict[str, Any]) -> int:
    """Read commands until the end of the input; returns the exit status."""
    desk = Desk(options)
    fine = True
    try:
        for text in lines(desk):
            entry = text.strip()
            if entry.lower() == "help":
                click.echo(HELP)
            elif entry == "?":
                click.echo(desk.standing())
            elif entry.startswith("?"):
                value = desk.value(entry[1:])
                fine = fine and value is not None
                if value is not None:
                    click.echo(value)
            elif entry:
                fine = desk.run(entry) and fine
    finally:
        desk.close()
    return 0 if sys.stdin.isatty() else int(not fine)


def lines(desk: Desk) -> Iterator[str]:
    """What is typed; on a terminal with history and completion."""
    if not sys.stdin.isatty():
        yield from sys.stdin
        return
    from prompt_toolkit import PromptSession
    from prompt_toolkit.completion import WordCompleter
    from prompt_toolkit.history import FileHistory

    folder = Path(click.get_app_dir("aircut"))
    folder.mkdir(parents=True, exist_ok=True)
    known = words(desk.session.interpreter.dialect)
    completer = WordCompleter(list(known), ignore_case=True, meta_dict=known, pattern=TYPED)
    toolbar: Callable[[], str] = desk.standing
    prompt: PromptSession[str] = PromptSession(
        "mdi> ", history=FileHistory(str(folder / "mdi_history")), completer=completer, complete_while_typing=False,
        bottom_toolbar=toolbar,
    )  # fmt: skip
    click.echo("help tells what can be typed; Ctrl-D leaves")
    while True:
        try:
            yield prompt.prompt()
        except KeyboardInterrupt:
            continue
        except EOFError:
            return


def words(dialect: Dialect) -> dict[str, str]:
    """What completion offers, each with its title."""
    known = {row.name: row.title for row in dialect.codes.values()}
    known |= {row.name: row.title for row in FUNCTIONS}
    return known | {f"#<{name}>": row.title for name, row in dialect.named.items()}
