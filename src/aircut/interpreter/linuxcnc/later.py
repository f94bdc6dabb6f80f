"""Codes of LinuxCNC's language that cannot be run yet: programs that use them are refused."""

from __future__ import annotations

from functools import partial

from aircut.diagnostics import Refusal
from aircut.diagnostics import faults as F
from aircut.interpreter.linuxcnc.state import State
from aircut.interpreter.table import Code, Group, Order, Words

NAMES = {
    "G70": "Turning, finishing",
    "G71": "Turning, roughing along Z",
    "G71.1": "Turning, roughing along Z, pockets",
    "G71.2": "Turning, roughing along Z, pockets",
    "G72": "Turning, roughing along X",
    "G72.1": "Turning, roughing along X, pockets",
    "G72.2": "Turning, roughing along X, pockets",
}


def refuse(name: str, m: State, w: Words) -> None:
    """Raises Refusal."""
    raise Refusal(F.NOT_SUPPORTED_YET, "g", code=name, title=NAMES[name])


CODES = tuple(
    Code(name, title, partial(refuse, name), Group.MOTION, Order.MOTION, takes="qdirpe", axes=True)
    for name, title in NAMES.items()
)
