"""The dialects by name."""

from __future__ import annotations

from importlib import import_module

from aircut.interpreter.table import Dialect
from aircut.machine import Machine, built_in

DIALECTS = {
    "rosetta": ("aircut.interpreter.rosetta", "ROSETTA"),
    "linuxcnc": ("aircut.interpreter.linuxcnc.language", "LINUXCNC"),
}


def load(name: str) -> Dialect:
    """The tables of a dialect. Raises ValueError."""
    try:
        module, attribute = DIALECTS[name]
    except KeyError:
        raise ValueError(f"no dialect {name!r}: there is {', '.join(DIALECTS)}") from None
    dialect: Dialect = getattr(import_module(module), attribute)
    return dialect


def machine(dialect: Dialect, axes: str = "") -> Machine:
    """The machine that serves when none is given. axes: its letters, if not the dialect's. Raises MachineError."""
    made = built_in(axes or dialect.axes, dialect.letters, dialect.reach)
    if dialect.tools:
        made.tools = {tool.id: tool for tool in dialect.tools}
    return made
