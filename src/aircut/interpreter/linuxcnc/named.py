"""The predefined names of LinuxCNC's language.

Sources: 001 Predefined named parameters; the canonical listing, section 8.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from aircut.interpreter.linuxcnc.state import LINEAR, NINE, State
from aircut.interpreter.table import NamedParameter
from aircut.machine.tools import EMPTY

TENTHS = 10
SYSTEMS = (540, 550, 560, 570, 580, 590, 591, 592, 593)


def flag(name: str, title: str, read: Callable[[State], object]) -> NamedParameter:
    return NamedParameter(name, title, lambda m: 1.0 if read(m) else 0.0)


def value(name: str, title: str, read: Callable[[State], float]) -> NamedParameter:
    return NamedParameter(name, title, lambda m: float(read(m)))


def code(name: str) -> float:
    """A code's number times ten: 591 for g59.1."""
    return float(round(float(name[1:]) * TENTHS))


def machine(i: int, m: State) -> float:
    place = m.to_space(m.guided())[i] + m.tool_offset[i]
    return place / m.unit if i in LINEAR else place


def pocket(m: State, slot: int) -> int:
    """The pocket that the tool in a slot came from, -1 where there is none."""
    return -1 if slot < 0 or m.slots[slot] is EMPTY else m.slots[slot].slot


def shown(i: int, m: State) -> float:
    return m.beside(i)


NAMED = (
    value("_vmajor", "version", lambda m: 2.9),
    value("_vminor", "version", lambda m: 0.0),
    value("_metric_machine", "-1 in the stand-alone interpreter", lambda m: -1.0),
    value("_line", "line of the file", lambda m: m.line),
    value("_motion_mode", "motion mode, times ten", lambda m: code(m.motion_name)),
    value("_plane", "plane, times ten", lambda m: m.plane_code),
    value("_ccomp", "cutter compensation, times ten", lambda m: 10 * (m.cutter or 40)),
    flag("_metric", "G21", lambda m: m.unit == 1.0),
    flag("_imperial", "G20", lambda m: m.unit != 1.0),
    flag("_absolute", "G90", lambda m: m.absolute),
    flag("_incremental", "G91", lambda m: not m.absolute),
    flag("_inverse_time", "G93", lambda m: m.feed_mode == 93),
    flag("_units_per_minute", "G94", lambda m: m.feed_mode == 94),
    flag("_units_per_rev", "G95", lambda m: m.feed_mode == 95),
    value("_coord_system", "work system, times ten", lambda m: SYSTEMS[m.system]),
    flag("_tool_offset", "a tool length is in force", lambda m: any(m.tool_offset)),
    flag("_retract_r_plane", "G99", lambda m: m.retract == 99),
    flag("_retract_old_z", "G98", lambda m: m.retract == 98),
    flag("_spindle_rpm_mode", "G97", lambda m: not m.spindles[0].css),
    flag("_spindle_css_mode", "G96", lambda m: m.spindles[0].css),
    flag("_ijk_absolute_mode", "G90.1", lambda m: m.arc_absolute),
    flag("_lathe_diameter_mode", "G7", lambda m: m.diameter),
    flag("_lathe_radius_mode", "G8", lambda m: not m.diameter),
    flag("_spindle_on", "M3 or M4", lambda m: m.spindle != 5),
    flag("_spindle_cw", "M3", lambda m: m.spindle == 3),
    flag("_mist", "M7", lambda m: m.mist),
    flag("_flood", "M8", lambda m: m.flood),
    flag("_speed_override", "M51", lambda m: m.speed_override),
    flag("_feed_override", "M50", lambda m: m.feed_override),
    flag("_adaptive_feed", "M52", lambda m: m.adaptive),
    flag("_feed_hold", "M53", lambda m: m.hold),
    value("_feed", "F", lambda m: m.gave_feed),
    value("_rpm", "S", lambda m: m.speed),
    value("_current_tool", "tool in the spindle", lambda m: m.slots[0].id),
    value("_current_pocket", "its pocket", lambda m: pocket(m, m.slot)),
    value("_selected_tool", "tool of T", lambda m: m.selected_tool),
    value("_selected_pocket", "its pocket", lambda m: pocket(m, m.selected_slot)),
    *(NamedParameter(f"_{a}", f"position {a.upper()}", partial(shown, i)) for i, a in enumerate(NINE)),
    *(
        NamedParameter(f"_abs_{a}", f"machine position {a.upper()}", partial(machine, i))
        for i, a in enumerate(NINE[:6])
    ),
    NamedParameter("_value", "of the last return", lambda m: m.value),  # as it is, no number included
    flag("_value_returned", "the last return had a value", lambda m: m.value_returned),
    value("_task", "0 in the stand-alone interpreter", lambda m: 0.0),
    value("_call_level", "depth of calls", lambda m: m.calls),
    value("_remap_level", "depth of remaps", lambda m: len(m.remaps)),
)
