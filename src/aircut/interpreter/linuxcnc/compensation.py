"""Cutter radius compensation of LinuxCNC's language.

Source: the canonical listing, section 12.
"""

from __future__ import annotations

from aircut.interpreter.linuxcnc.modes import said
from aircut.interpreter.linuxcnc.state import State
from aircut.interpreter.table import Code, Group, Order, Words


def off(m: State, w: Words) -> None:
    """G40."""
    m.arc_refused = m.cutter != 0
    m.cutter = 0
    said(m, "cutter radius compensation off")


CODES = (Code("G40", "Compensation off", off, Group.CUTTER, Order.CUTTER),)
