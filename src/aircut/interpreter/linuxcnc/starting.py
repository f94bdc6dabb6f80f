"""How a run of LinuxCNC's language starts and ends.

Source: the canonical listing, section 3.
"""

from __future__ import annotations

from aircut.interpreter.linuxcnc.offsets import tell_rotation, tell_shift, tell_system
from aircut.interpreter.linuxcnc.state import G92, ORIGINS, STEP, SYSTEM, State

SYSTEMS = 9
#: Parameters that outlive every run. Source: the canonical listing, section 8.
PERSISTENT = (
    *range(5161, 5170),
    *range(5181, 5190),
    *range(5210, 5221),
    *(ORIGINS + STEP * system + i for system in range(SYSTEMS) for i in range(10)),
)


def begin(m: State) -> None:
    """Take systems and offsets from the parameters, and tell them."""
    number = m.numbered[SYSTEM]
    m.system = int(number) - 1 if 1 <= number < SYSTEMS + 1 else 0
    m.numbered[SYSTEM] = m.system + 1.0
    m.load_system()
    if m.numbered[G92] != 0.0:
        m.set_shift(m.stored(G92 + 1))
    m.position = m.to_program([0.0] * 9)
    m.told = m.position[:]
    m.out.event("USE_LENGTH_UNITS", "MM")
    tell_system(m)
    tell_shift(m)
    tell_rotation(m)
    m.out.event("SET_FEED_REFERENCE", "XYZ")


def finish(m: State) -> None:
    """M2, M30: the modes go back to their start."""
    out = m.out
    m.system = 0
    m.numbered[SYSTEM] = 1.0
    m.load_system()
    tell_system(m)
    tell_rotation(m)
    if m.plane_code != 170:
        m.plane, m.plane_code = 0, 170
        out.event("SELECT_PLANE", "XY")
    out.event("SET_FEED_MODE", 0, 0)
    out.event("SET_FEED_RATE", 0.0)
    if not m.feed_override:
        out.event("ENABLE_FEED_OVERRIDE")
    out.event("STOP_SPINDLE_TURNING", 0)
    out.event("SET_SPINDLE_MODE", 0, 0.0)
    if m.mist:
        out.event("MIST_OFF")
    if m.flood:
        out.event("FLOOD_OFF")
    m.mist = m.flood = False
    m.spindle = 5
    m.feed = m.gave_feed = 0.0
    if m.stop_code == 30.0:
        out.event("PALLET_SHUTTLE")
    out.event("PROGRAM_END")
