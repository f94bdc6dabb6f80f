"""LinuxCNC's language as tables.

Sources: 001; the canonical listing.
"""

from __future__ import annotations

from aircut.interpreter.linuxcnc import (
    calls,
    compensation,
    cycles,
    lathe,
    modes,
    motion,
    offsets,
    outputs,
    saving,
    spindles,
    splines,
    threading,
    tooling,
)
from aircut.interpreter.linuxcnc.interpreter import Interpreter
from aircut.interpreter.linuxcnc.named import NAMED
from aircut.interpreter.linuxcnc.state import LAST, NINE, PER_MM
from aircut.interpreter.table import Code, CutterRules, Dialect
from aircut.machine.config import UNBOUNDED
from aircut.machine.tools import Tool

CODES = (
    *motion.CODES,
    *modes.CODES,
    *spindles.CODES,
    *offsets.CODES,
    *tooling.CODES,
    *outputs.CODES,
    *saving.CODES,
    *compensation.CODES,
    *calls.CODES,
    *cycles.CODES,
    *splines.CODES,
    *threading.CODES,
    *lathe.CODES,
)


def key(row: Code) -> str:
    return row.name.lower()


#: The tools that the stand-alone interpreter starts with, mm.
#: mm, as the interpreter converts its own tools: an entry exactly as long as their radius is long enough.
THEIR_INCH = 1 / PER_MM
TOOLS = (
    Tool(1, slot=1, z=0.511 * THEIR_INCH, diameter=0.125 * THEIR_INCH),
    Tool(2, slot=2, z=0.1 * THEIR_INCH, diameter=0.0625 * THEIR_INCH),
    Tool(3, slot=3, z=1.273 * THEIR_INCH, diameter=0.201 * THEIR_INCH),
    Tool(99999, slot=123, z=0.1 * THEIR_INCH),
)

LINUXCNC = Dialect(
    name="linuxcnc",
    title="LinuxCNC",
    interpreter=Interpreter,
    codes={key(row): row for row in CODES},
    items={row.name.lower(): row for row in (*modes.ITEMS, *spindles.ITEMS, *tooling.ITEMS)},
    unsupported=frozenset(),
    ranges=(),
    system=(),
    named={row.name: row for row in NAMED},
    start=(),
    local_underscore=False,
    settings=offsets.SETTINGS,
    no_variable="parameters are #1 to #5601",
    letters=NINE,
    axes="XYZABC",
    reach=UNBOUNDED,
    takes_ini=True,
    table_unit=THEIR_INCH,
    parameters=range(1, LAST + 1),
    cutter=CutterRules(straight=0.05, growth=(0.0254, 0.001), at_once=compensation.AT_ONCE, plunge_first=False),
    tools=TOOLS,
)
