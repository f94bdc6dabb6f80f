"""M98 and M99: calls in the manner of Fanuc's controls.

Source: the canonical listing, section 9.
"""

from __future__ import annotations

from functools import partial

from aircut.interpreter.linuxcnc.arranging import whole
from aircut.interpreter.linuxcnc.state import State
from aircut.interpreter.table import Code, Group, Order, Words


def call(m: State, w: Words) -> None:
    """M98: call a bare O number. Raises Refusal."""
    name = str(whole("p", w["p"]))
    m.transfer = lambda run: run.flow.m98(name, int(w.get("l", 1.0)))


def back(m: State, w: Words) -> None:
    """M99: back to where M98 stood; in the main program, the end. Raises Refusal."""

    def follow(run: object) -> None:
        if not run.flow.m99():  # type: ignore[attr-defined]
            m.finished = True

    m.transfer = follow


alone = partial(Code, group=Group.STOP, order=Order.RETURN, sole=True)

CODES = (
    alone("M98", "Call", call, takes="pl", needs="p"),
    Code("M99", "Return", back, Group.STOP, Order.RETURN),
)
