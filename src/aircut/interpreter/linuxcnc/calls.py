"""M98 and M99: calls in the manner of Fanuc's controls.

Both are words of flow where they begin a line. What else stands in a line of M98 is read
and checked, and not carried out. Within a block M98 is unknown, and M99 ends the main program.
Source: the canonical listing, section 9, and the oracle.
"""

from __future__ import annotations

import re

from aircut.diagnostics import Refusal
from aircut.diagnostics import faults as F
from aircut.interpreter.linuxcnc.motion import wrong
from aircut.interpreter.linuxcnc.state import State
from aircut.interpreter.table import Code, Group, Order, Words

#: A line that begins with one of them.
START = re.compile(r"/?(?:n\d+\.?\d*)?m(98|99)(?!\d)")


def inside(m: State, w: Words) -> None:
    """M98 within a block. Raises Refusal."""
    raise Refusal(F.UNKNOWN_CODE, "m", code="M98", hint="")


def end(m: State, w: Words) -> None:
    """M99 of the main program. Raises Refusal in a subroutine."""
    if m.calls:
        raise wrong("M99 must be the first word of its line")
    m.finished = True


CODES = (
    Code("M98", "Call", inside, Group(0), Order.RETURN, takes="pl", needs="p", check=inside),
    Code("M99", "Return", end, Group.STOP, Order.RETURN),
)
