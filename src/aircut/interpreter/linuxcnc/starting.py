"""How a run of LinuxCNC's language starts and ends.

Source: the canonical listing, section 3.
"""

from __future__ import annotations

from aircut.interpreter import path
from aircut.interpreter.cutter import SLOT
from aircut.interpreter.linuxcnc.offsets import tell_rotation, tell_shift, tell_system
from aircut.interpreter.linuxcnc.spindles import STANDING
from aircut.interpreter.linuxcnc.state import G92, KEPT_LENGTHS, ORIGINS, PER_MM, POSITION, STEP, SYSTEM, State
from aircut.machine import memory

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
    if m.ini.forgets_shift:
        m.numbered[G92 : G92 + 10] = [0.0] * 10
    number = m.numbered[SYSTEM]
    m.system = int(number) - 1 if 1 <= number < SYSTEMS + 1 else 0
    m.numbered[SYSTEM] = m.system + 1.0
    m.load_system()
    if m.numbered[G92] != 0.0:
        m.set_shift(m.stored(G92 + 1))
    if m.ini.forgets_shift:
        m.rotation = 0.0  # LinuxCNC forgets it too, until a system is chosen
    # LinuxCNC starts at machine zero, but disregards the rotation in this, and the axes that it does not have.
    m.position = [0.0 - o - s for o, s in zip(m.origin, m.shift, strict=True)]
    if m.auxiliary:
        m.out.event("AUXILIARY_AXES", *m.led)
    else:
        m.position[6:] = [0.0] * 3
    m.told = m.position[:]
    m.out.event("USE_LENGTH_UNITS", "MM")
    tell_system(m)
    tell_shift(m)
    tell_rotation(m)
    m.out.event("SET_FEED_REFERENCE", "XYZ")


def remembered(m: State) -> dict[int, float]:
    """What outlives the run: for a parameter file as programs see it, for a machine's folder in mm."""
    machine = m.machine
    given = machine.variables if machine.parameters is None else machine.parameters
    kept = {number: m.numbered[number] for number in sorted({*given, *PERSISTENT})}
    kept |= {n: m.shown(n - POSITION) for n in kept if POSITION <= n < POSITION + 9}
    if machine.parameters is None:
        kept = {n: v / PER_MM if n in KEPT_LENGTHS else v for n, v in kept.items() if n in memory.PERSISTENT}
    return kept


def renew(m: State) -> None:
    """The modes that M2 and M30 leave behind, beside what `finish` tells, for the next command of MDI."""
    m.absolute = True
    m.inverse_time = False
    m.feed_mode = 94
    m.feed_override = m.speed_override = 1
    m.cutter = 0
    m.arc_refused = False
    path.set_stage(m, SLOT, None)
    m.motion_name = "g1"


def finish(m: State) -> None:
    """M2, M30: the modes go back to their start."""
    out = m.out
    if m.ini.forgets_shift:
        m.numbered[G92 : G92 + 10] = [0.0] * 10
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
        m.follow_feed(True)
    for number, spindle in enumerate(m.spindles):
        out.event("STOP_SPINDLE_TURNING", number)
        out.event("SET_SPINDLE_MODE", number, 0.0)
        spindle.direction = STANDING
    if m.mist:
        out.event("MIST_OFF")
    if m.flood:
        out.event("FLOOD_OFF")
    m.mist = m.flood = False
    m.feed = m.gave_feed = 0.0
    if m.stop_code == 30.0:
        out.event("PALLET_SHUTTLE")
    out.event("PROGRAM_END")
