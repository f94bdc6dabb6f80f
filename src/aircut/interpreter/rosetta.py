"""The RosettaCNC language as tables.

Sources: 000 and 004 sections 1 and 2; decisions sections 2 to 4 and 19.
"""

from __future__ import annotations

from functools import partial

from aircut.interpreter import auxiliary, calls, modes, motion, offsets
from aircut.interpreter.arranging import code_name
from aircut.interpreter.named import NAMED
from aircut.interpreter.state import State
from aircut.interpreter.system import SYSTEM
from aircut.interpreter.table import Code, Dialect, Group, Order, Range, Words


def unreachable(m: State, w: Words) -> None:
    raise AssertionError("a code that is not supported was run")


later = partial(Code, run=unreachable, supported=False)
cycle = partial(later, group=Group.MOTION, order=Order.MOTION, axes=True, takes="rlpq", modal=True)
probe = partial(later, group=Group.MOTION, order=Order.MOTION, axes=True, modal=True)
compensation = partial(later, group=Group.CUTTER, order=Order.CUTTER, takes="dil")
length = partial(later, group=Group.TOOL_LENGTH, order=Order.TOOL_LENGTH, takes="h")
group = partial(later, group=Group.NON_MODAL, order=Order.NON_MODAL)
io = partial(later, group=Group.IO, order=Order.IO)

#: Codes of the language that cannot be run yet: programs that use them are refused.
LATER = (
    later("G16", "Polar coordinates", group=Group.POLAR, order=Order.POLAR),
    probe("G38.2", "Probe toward contact, or fail"),
    probe("G38.3", "Probe toward contact"),
    probe("G38.4", "Probe away from contact, or fail"),
    probe("G38.5", "Probe away from contact"),
    compensation("G41", "Cutter compensation left"),
    compensation("G41.1", "Dynamic cutter compensation left"),
    compensation("G42", "Cutter compensation right"),
    compensation("G42.1", "Dynamic cutter compensation right"),
    length("G43", "Tool length compensation"),
    length("G43.1", "Dynamic tool length compensation", axes=True),
    length("G43.2", "Additional tool length compensation"),
    length("G43.4", "Tool center point control"),
    length("G43.7", "Tool center point control with own offsets", axes=True),
    later("G51", "Scaling", group=Group.SCALING, order=Order.SCALING, axes=True, takes="ijkp"),
    later("G66", "Modal macro call", group=Group.MACRO, order=Order.CALL, sole=True),
    later("G67", "Modal macro call off", group=Group.MACRO, order=Order.CALL),
    later("G68", "Rotation", group=Group.ROTATION, order=Order.ROTATION, axes=True, takes="r"),
    later("G68.2", "Tilted plane", group=Group.ROTATION, order=Order.ROTATION, axes=True, takes="ijk"),
    cycle("G73", "Drill, breaking chips"),
    cycle("G81", "Drill"),
    cycle("G82", "Drill and dwell"),
    cycle("G83", "Drill, clearing chips"),
    cycle("G85", "Bore, feed out"),
    cycle("G86", "Bore, spindle stop, rapid out"),
    cycle("G88", "Bore, spindle stop, manual out"),
    cycle("G89", "Bore, dwell, feed out"),
    group("G100", "Call a PLC function", sole=True),
    group("G101", "Axes to be interpolated", takes="p"),
    group("G102", "Home axes", takes="p"),
    group("G103", "Traverse rate", takes="v"),
    group("G104", "Dynamics", takes="adj"),
    *(group(f"G{number}", "User defined code", sole=True) for number in range(200, 500)),
    *(group(f"M{number}", "User defined code", sole=True) for number in range(200, 300)),
    later("M17", "Torch height control on", group=Group.TORCH, order=Order.COOLANT),
    later("M18", "Torch height control off", group=Group.TORCH, order=Order.COOLANT),
    later("M60", "Pallet shuttle", group=Group.STOP, order=Order.STOP),
    io("M62", "Output on", takes="p"),
    io("M63", "Output off", takes="p"),
    io("M66", "Wait for an input", takes="plq"),
    io("M67", "Read an analog input", takes="plq"),
    io("M68", "Set an analog output", takes="pq"),
    io("M166", "Read a group of inputs", takes="p"),
    io("M167", "Read a group of analog inputs", takes="p"),
    later("M106", "Internal tool change procedure", group=Group.TOOL, order=Order.TOOL_CHANGE),
    later("M107", "Tool change macro starts", group=Group.TOOL_MACRO, order=Order.MACRO_START),
    later("M108", "Tool change macro ends", group=Group.TOOL_MACRO, order=Order.MACRO_END),
    later("M109", "Message", group=Group.MESSAGE, order=Order.MESSAGE, takes="pqrd"),
    later("M120", "Media message", group=Group.MESSAGE, order=Order.MESSAGE, takes="pqrd"),
)

CODES = (*motion.CODES, *modes.CODES, *offsets.CODES, *auxiliary.CODES, *calls.CODES, *LATER)

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
    Range(4000, 4999, "Shared variables: written back after the run", "table"),
    Range(6000, 6999, "Protected variables: programs only read them", "table", writable=False),
)

SETTINGS = {
    **offsets.SETTINGS,
    1: group("G10 L1", "Tool table entry", takes="pdqijkv", axes=True),
    10: group("G10 L10", "Tool table entry, calculated", takes="pdqijkv", axes=True),
    100: group("G10 L100", "Special parameters", takes="pv"),
}


def key(row: Code) -> str:
    """Normalized name of a code."""
    return code_name(row.name[0].lower(), row.number) if row.name[1:2].isdigit() else row.name.lower()


ROSETTA = Dialect(
    name="rosetta",
    title="RosettaCNC",
    codes={key(row): row for row in CODES},
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
)
