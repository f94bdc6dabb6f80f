"""Saved modes: M70 to M73.

Source: the canonical listing, section 14.
"""

from __future__ import annotations

from functools import partial
from typing import Any

from aircut.interpreter.linuxcnc.motion import wrong
from aircut.interpreter.linuxcnc.state import State
from aircut.interpreter.table import Code, Group, Order, Words


def save(returning: bool, m: State, w: Words) -> None:
    """M70, M73 (which restores when its subroutine returns)."""
    m.saved = snapshot(m)
    m.saved_return = returning


def forget(m: State, w: Words) -> None:
    """M71."""
    m.saved = None


def restore(m: State, w: Words) -> None:
    """M72. Raises Refusal."""
    if m.saved is None:
        raise wrong("there is nothing saved here to restore")
    bring_back(m, m.saved)


def restore_call(m: State) -> None:
    """On return from a subroutine: what its M73 saved comes back."""
    if m.saved is not None and m.saved.returning:
        bring_back(m, m.saved)


def snapshot(m: State) -> Any:
    return None


def bring_back(m: State, saved: Any) -> None:
    """Put back what differs."""


saving = partial(Code, group=Group.SPINDLE, order=Order.SPINDLE)

CODES = (
    saving("M70", "Save the modes", partial(save, False)),
    saving("M71", "Forget the saved modes", forget),
    saving("M72", "Restore the saved modes", restore),
    saving("M73", "Save the modes, restore on return", partial(save, True)),
)
