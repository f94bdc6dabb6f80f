"""Saved modes: M70 to M73.

Restoring runs blocks of codes like any other: units first, then what differs, in order, with the first
of the M codes; then the other M codes one by one. Source: the canonical listing, section 14.
"""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, NamedTuple

from aircut.interpreter.linuxcnc.motion import wrong
from aircut.interpreter.linuxcnc.state import G92, State
from aircut.interpreter.table import Code, Group, Order, Words

if TYPE_CHECKING:
    from aircut.interpreter.linuxcnc.interpreter import Interpreter

SYSTEM_CODES = ("g54", "g55", "g56", "g57", "g58", "g59", "g59.1", "g59.2", "g59.3")


class Saved(NamedTuple):
    """The modes of a moment, as the codes that bring them back."""

    units: str
    modes: dict[str, str]
    blending: tuple[float, float]  # P and Q of G64, program units
    feed: float
    speed: float
    on: dict[str, bool]
    returning: bool = False  # it comes back by itself when the subroutine returns


#: Switches, and the code that brings each back where it was on.
SWITCHES = {"mist": "m7", "flood": "m8", "adaptive": "m52", "hold": "m53"}


def snapshot(m: State, returning: bool = False) -> Saved:
    """The modes now."""
    modes = {
        "spindle": f"m{m.spindle}",
        "plane": f"g{m.plane_code // 10}" + (".1" if m.plane_code % 10 else ""),
        "cutter": f"g{m.cutter or 40}",
        "distance": "g90" if m.absolute else "g91",
        "feed mode": f"g{m.feed_mode}",
        "spindle mode": "g96" if m.spindles[0].css else "g97",
        "system": SYSTEM_CODES[m.system],
        "length": "g43" if any(m.tool_offset) else "g49",
        "retract": f"g{m.retract}",
        "arc distance": "g90.1" if m.arc_absolute else "g91.1",
        "diameter": "g7" if m.diameter else "g8",
        "shift": "g92.3" if m.numbered[G92] else "g92.2",
        "path": {61: "g61", 611: "g61.1", 64: "g64"}[m.path_mode],
    }
    on = {"mist": m.mist, "flood": m.flood, "adaptive": m.adaptive, "hold": m.hold, "override": bool(m.feed_override)}
    blending = (m.blend / m.unit, m.thinning / m.unit)
    return Saved("g21" if m.unit == 1.0 else "g20", modes, blending, m.gave_feed, m.speed, on, returning)


def save(returning: bool, m: State, w: Words) -> None:
    """M70, M73 (which restores when its subroutine returns)."""
    m.saved = snapshot(m, returning)


def forget(m: State, w: Words) -> None:
    """M71."""
    m.saved = None


def restore(m: State, w: Words) -> None:
    """M72. Raises Refusal."""
    if m.saved is None:
        raise wrong("there is nothing saved here to restore")
    saved = m.saved
    m.transfer = lambda run: bring_back(run, saved)


def restore_call(run: Interpreter) -> None:
    """On return from a subroutine: what its M73 saved comes back."""
    saved = run.state.saved
    if saved is not None and saved.returning:
        bring_back(run, saved)


def bring_back(run: Interpreter, saved: Saved) -> bool:
    """Put back what differs. Returns whether anything did: then that stands in place of the rest of the block."""
    m = run.state
    line, m.out.line = m.out.line, 0
    now = snapshot(m)
    differs = now.units != saved.units
    if differs:
        run.carry_out([saved.units], {})
        now = snapshot(m)
    names = [saved.modes[mode] for mode in saved.modes if saved.modes[mode] != now.modes[mode]]
    words: dict[str, float] = {}
    if now.feed != saved.feed:
        words["f"] = round(saved.feed, 1)
    if now.speed != saved.speed:
        words["s"] = float(round(saved.speed))
    if saved.modes["path"] == "g64" and ("g64" in names or now.blending != saved.blending):
        names = [*dict.fromkeys((*names, "g64"))]
        words["p"], words["q"] = saved.blending
    names += switches(saved, now)
    others = [name for name in names if name.startswith("m")][1:]
    if names or words:
        run.carry_out([name for name in names if name not in others], words)
    for name in others:
        run.carry_out([name], {})
    m.out.line = line
    return bool(differs or names or words)


def switches(saved: Saved, now: Saved) -> list[str]:
    """What was on comes on again; what was off stays as it is, but for coolants of which both were off.

    The overrides follow the feed's alone, as LinuxCNC does it: M51 where it was off.
    """
    names = [code for switch, code in SWITCHES.items() if saved.on[switch] and not now.on[switch]]
    if not (saved.on["mist"] or saved.on["flood"]) and (now.on["mist"] or now.on["flood"]):
        names.insert(0, "m9")
    if saved.on["override"] != now.on["override"]:
        names.insert(sum(name in ("m7", "m8", "m9") for name in names), "m48" if saved.on["override"] else "m51")
    return names


saving = partial(Code, group=Group.SPINDLE, order=Order.SPINDLE)

CODES = (
    saving("M70", "Save the modes", partial(save, False)),
    saving("M71", "Forget the saved modes", forget),
    saving("M72", "Restore the saved modes", restore),
    saving("M73", "Save the modes, restore on return", partial(save, True)),
)
