"""`aircut machine`: what a machine remembers, shown and set by hand."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import click

from aircut.machine import MachineError, load, store
from aircut.machine.memory import PROTECTED


@contextmanager
def refused() -> Iterator[None]:
    """Faults of the machine's folder as the user sees them."""
    try:
        yield
    except MachineError as error:
        raise click.ClickException(str(error)) from None


def show(folder: Path, numbers: Sequence[str]) -> None:
    """Print variables, one a line, as `set` takes them."""
    wanted: list[range] = []
    for text in numbers:
        match = re.fullmatch(r"#?(\d{1,9})(?:-#?(\d{1,9}))?", text)
        if match is None:
            raise click.UsageError(f"{text}: give a number, or two with a - between")
        wanted.append(range(int(match[1]), int(match[2] or match[1]) + 1))
    with refused():
        variables = load(folder).variables
    for number, value in sorted(variables.items()):
        if not wanted or any(number in part for part in wanted):
            click.echo(f"{number}={value!r}")


def set_variables(folder: Path, values: Sequence[str], password: str | None) -> None:
    """Set variables from NUMBER=VALUE words, all or none."""
    wanted: dict[int, float | None] = {}
    for text in values:
        number, _, value = text.lstrip("#").partition("=")
        try:
            wanted[int(number)] = None if value.strip().lower() == "null" else float(value)
        except ValueError:
            raise click.UsageError(f"{text}: give NUMBER=VALUE, or NUMBER=null") from None
    with refused():
        load(folder)  # it must be a machine
        stored = store.recall(folder)
        if any(number in PROTECTED for number in wanted) and stored.password is not None and password is None:
            password = click.prompt("Password", hide_input=True, err=True)
        store.change(folder, wanted, password or "")


def set_password(folder: Path, new: str | None, old: str | None) -> None:
    """Set the password; the one before is asked for where there is one."""
    with refused():
        load(folder)  # it must be a machine
        stored = store.recall(folder)
        if stored.password is not None and old is None:
            old = click.prompt("Old password", hide_input=True, err=True)
        if new is None:
            new = click.prompt("New password", hide_input=True, confirmation_prompt=True, err=True)
        store.set_password(folder, new, old or "")
