"""The RosettaCNC language as tables.

Sources: 000 and 004 sections 1 and 2; decisions sections 2 to 4 and 19.
"""

from __future__ import annotations

from aircut.interpreter import (
    auxiliary,
    calls,
    cutter,
    drilling,
    inputs,
    messages,
    modes,
    motion,
    offsets,
    probing,
    rtcp,
    tooling,
    transforming,
)
from aircut.interpreter.arranging import code_name
from aircut.interpreter.interpreter import Interpreter
from aircut.interpreter.named import NAMED
from aircut.interpreter.system import SYSTEM
from aircut.interpreter.table import Code, CutterRules, Dialect, Range

CODES = (
    *motion.CODES,
    *drilling.CODES,
    *modes.CODES,
    *cutter.CODES,
    *offsets.CODES,
    *tooling.CODES,
    *rtcp.CODES,
    *auxiliary.CODES,
    *inputs.CODES,
    *messages.CODES,
    *probing.CODES,
    *calls.CODES,
    *transforming.CODES,
)

#: Named in the documents, or known from relatives of the language, but not in it (AMB-COD-2, AMB-CYC-3).
UNSUPPORTED = frozenset(
    [
        "g5",
        "g5.1",
        "g5.2",
        "g5.3",
        "g7",
        "g8",
        "g17.1",
        "g18.1",
        "g19.1",
        "g33",
        "g33.1",
        "g70",
        "g71",
        "g72",
        "g74",
        "g76",
        "g84",
        "g87",
        "g95",
        "g96",
        "g97",
        "m19",
        "m52",
        "m53",
        "m64",
        "m65",
        "m70",
        "m71",
        "m72",
        "m73",
    ]
)

RANGES = (
    Range(100, 499, "Input variables: a run changes its own copy", "table"),
    Range(500, 3999, "Program variables", "null"),
    Range(4000, 4999, "Shared variables: written back after the run", "table", kept=True),
    Range(6000, 6999, "Protected variables: programs only read them", "table", writable=False),
)

#: AMB-CMP-6. The plane codes, cycles and probing look for themselves.
CUTTER = CutterRules(
    forbids=frozenset(["G28", "G30", "G41", "G41.1", "G42", "G42.1", "G43.4", "G43.7", "G53", "G68.2", "M6"]),
    flushes=frozenset(["M66", "M67"]),
)

SETTINGS = {**offsets.SETTINGS, **tooling.SETTINGS, **messages.SETTINGS}


def key(row: Code) -> str:
    """Normalized name of a code."""
    return code_name(row.name[0].lower(), row.number) if row.name[1:2].isdigit() else row.name.lower()


ROSETTA = Dialect(
    name="rosetta",
    title="RosettaCNC",
    interpreter=Interpreter,
    codes={key(row): rtcp.guarded(row) for row in CODES},
    items={row.name.lower(): row for row in (*modes.ITEMS, *auxiliary.ITEMS)},
    unsupported=UNSUPPORTED,
    ranges=RANGES,
    system=SYSTEM,
    named={row.name: row for row in NAMED},
    start=(
        "g15",
        "g17",
        "g21",
        "g40",
        "g49",
        "g50",
        "g54",
        "g64",
        "g69",
        "g80",
        "g90",
        "g91.1",
        "g94",
        "g98",
    ),
    local_underscore=True,
    settings=SETTINGS,
    no_variable="variables are #0 to #33, #100 to #4999, #5000 to #5999 (system) and #6000 to #6999",
    cutter=CUTTER,
)
