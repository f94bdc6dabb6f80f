"""How a run starts and ends: the modes in force, the variables filled, the reset.

Sources: decisions AMB-COD-1, AMB-VAR-3, AMB-VAR-20, AMB-IO-10; the order of the
closing commands is that of the canonical listing.
"""

from __future__ import annotations

from aircut.interpreter import path, rotary
from aircut.interpreter.auxiliary import End
from aircut.interpreter.inputs import all_off
from aircut.interpreter.offsets import tell_rotation, tell_shift, tell_system
from aircut.interpreter.state import PLANES, WORK_SYSTEMS, State
from aircut.interpreter.table import Group

FIRST_ORIGIN = 5221  # #5221-#5226 is the first work system, the next begins 20 later
ORIGIN_STEP = 20


def begin(m: State) -> None:
    """Put the state at the start of a run, and tell the listing of it."""
    load(m)
    m.indexers = rotary.indexers(m)
    for name in m.dialect.start:
        row = m.dialect.codes[name]
        m.modal[row.group] = row
        if row.group is Group.MOTION:
            m.motion = row
    m.add_offsets()
    m.position = [-offset for offset in m.offset]  # the machine stands at its origin
    m.out.event("USE_LENGTH_UNITS", "MM")
    tell_system(m)
    tell_shift(m)
    tell_rotation(m)
    m.out.event("SET_FEED_REFERENCE", "XYZ")
    m.out.event("ON_RESET")


def load(m: State) -> None:
    """Fill variables and offsets from what the machine remembers."""
    known = m.machine.variables
    for row in m.dialect.ranges:
        if row.initial == "table":
            m.numbered[row.first : row.last + 1] = map(known.get, range(row.first, row.last + 1))
    for i in range(6):
        m.home[i] = known.get(5161 + i, 0.0)
        m.second_home[i] = known.get(5181 + i, 0.0)
        m.shift[i] = known.get(5211 + i, 0.0)
        for system in range(WORK_SYSTEMS):
            m.origins[system][i] = known.get(FIRST_ORIGIN + ORIGIN_STEP * system + i, 0.0)
    m.shifted = known.get(5210, 0.0) != 0.0


def remembered(m: State) -> dict[int, float]:
    """The numbered variables that outlive the run, as the machine stores them: mm, degrees."""
    kept = dict(m.machine.variables)
    for row in m.dialect.ranges:
        if row.kept:
            for number in range(row.first, row.last + 1):
                value = m.numbered[number]
                if value is None or value != value:  # null, or the constant that counts as null
                    kept.pop(number, None)
                else:
                    kept[number] = value
    for i in range(6):
        kept[5161 + i] = m.home[i]
        kept[5181 + i] = m.second_home[i]
        kept[5211 + i] = m.shift[i]
        for system in range(WORK_SYSTEMS):
            kept[FIRST_ORIGIN + ORIGIN_STEP * system + i] = m.origins[system][i]
    kept[5210] = float(m.shifted)
    return kept


def finish(m: State, end: End) -> None:
    """The end of the program; with a reset (M2, M30) everything is off and back to its start."""
    out = m.out
    path.flush(m)
    if not end.reset:
        out.event("PROGRAM_END")
        return
    path.set_stage(m, "compensation", None)
    m.compensating = False
    m.system = 0
    local = any(m.local)
    m.local = [0.0] * 6
    m.set_frame(None)
    m.add_offsets()
    tell_system(m)
    if local:
        tell_shift(m)
    tell_rotation(m)
    if m.plane:
        m.plane = 0
        out.event("SELECT_PLANE", PLANES[0])
    m.inverse_time = False
    m.feed = m.feed_told = 0.0
    out.event("SET_FEED_MODE", 0, 0)
    out.event("SET_FEED_RATE", 0.0)
    if not m.feed_override:
        out.event("ENABLE_FEED_OVERRIDE")
    m.feed_override = m.speed_override = 1
    m.feed_override_code = m.speed_override_code = 48.0
    m.spindle = 5
    out.event("STOP_SPINDLE_TURNING", 0)
    out.event("SET_SPINDLE_MODE", 0, 0.0)
    if m.mist:
        out.event("MIST_OFF")
    if m.flood:
        out.event("FLOOD_OFF")
    m.mist = m.flood = False
    all_off(m)
    if m.stop_code == 30.0:
        out.event("PALLET_SHUTTLE")
    m.absolute = True
    m.arc_absolute = m.polar = False
    m.unit = 1.0
    m.flags = 0
    m.blend = m.thinning = 0.0
    for name in m.dialect.start:
        row = m.dialect.codes[name]
        m.modal[row.group] = row
    m.motion = m.modal[Group.MOTION]
    out.event("PROGRAM_END")
