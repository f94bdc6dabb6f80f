"""The dialects by name."""

from __future__ import annotations

from importlib import import_module

from aircut.interpreter.table import Dialect

DIALECTS = {"rosetta": ("aircut.interpreter.rosetta", "ROSETTA")}


def load(name: str) -> Dialect:
    """The tables of a dialect. Raises ValueError."""
    try:
        module, attribute = DIALECTS[name]
    except KeyError:
        raise ValueError(f"no dialect {name!r}: there is {', '.join(DIALECTS)}") from None
    dialect: Dialect = getattr(import_module(module), attribute)
    return dialect
