"""The dialects by name."""

from __future__ import annotations

from importlib import import_module

from aircut.interpreter.table import Dialect

DIALECTS = {"rosetta": ("aircut.interpreter.rosetta", "ROSETTA")}
LATER = ("linuxcnc",)


def load(name: str) -> Dialect:
    """The tables of a dialect. Raises ValueError."""
    if name in LATER:
        raise ValueError(f"the dialect {name} is not supported yet: there is {', '.join(DIALECTS)}")
    try:
        module, attribute = DIALECTS[name]
    except KeyError:
        raise ValueError(f"no dialect {name!r}: there is {', '.join(DIALECTS)}") from None
    dialect: Dialect = getattr(import_module(module), attribute)
    return dialect
