"""Saved modes: M70 to M73.

Restoring runs blocks of codes like any other: units first, then what differs, in order, then
the M codes one by one. Source: the canonical listing, section 14.
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
    """The modes of a moment, each as the code that brings it back."""

    units: str
    modes: dict[str, str]
    feed: float
    speed: float
    switches: dict[str, tuple[str, float | None]]  # M codes, with P
    returning: bool = False  # it comes back by itself when the subroutine returns


def snapshot(m: State, returning: bool = False) -> Saved:
    """The modes now."""
    modes = {
        "plane": f"g{m.plane_code // 10}" + (".1" if m.plane_code % 10 else ""),
        "cutter": f"g{m.cutter or 40}",
        "distance": "g90" if m.absolute else "g91",
        "feed mode": f"g{m.feed_mode}",
        "system": SYSTEM_CODES[m.system],
        "length": "g43" if m.length_on else "g49",
        "retract": f"g{m.retract}",
        "arc distance": "g90.1" if m.arc_absolute else "g91.1",
        "diameter": "g7" if m.diameter else "g8",
        "shift": "g92.3" if m.numbered[G92] else "g92.2",
        "path": {61: "g61", 611: "g61.1", 64: "g64"}[m.path_mode],
    }
    switches: dict[str, tuple[str, float | None]] = {
        "spindle": (f"m{m.spindle}", None),
        "mist": ("m7" if m.mist else "", None),
        "flood": ("m8" if m.flood else "", None),
        "coolant": ("m9" if not (m.mist or m.flood) else "", None),
        "feed override": ("m50", float(m.feed_override)),
        "speed override": ("m51", float(m.speed_override)),
        "adaptive": ("m52", float(m.adaptive)),
        "hold": ("m53", float(m.hold)),
    }
    return Saved("g21" if m.unit == 1.0 else "g20", modes, m.gave_feed, m.speed, switches, returning)


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
    m.transfer = lambda run: bring_back(run, m.saved)


def restore_call(run: Interpreter) -> None:
    """On return from a subroutine: what its M73 saved comes back."""
    saved = run.state.saved
    if saved is not None and saved.returning:
        bring_back(run, saved)


def bring_back(run: Interpreter, saved: Saved) -> None:
    """Put back what differs."""
    m = run.state
    line, m.out.line = m.out.line, 0
    now = snapshot(m)
    if now.units != saved.units:
        run.carry_out([saved.units], {})
        now = snapshot(m)
    names = [saved.modes[mode] for mode in saved.modes if saved.modes[mode] != now.modes[mode]]
    words: dict[str, float] = {}
    if now.feed != saved.feed:
        words["f"] = round(saved.feed, 1)
    if now.speed != saved.speed:
        words["s"] = float(round(saved.speed))
    if names or words:
        run.carry_out(names, words)
    for switch, (name, p) in saved.switches.items():
        if name and now.switches[switch] != (name, p):
            run.carry_out([name], {} if p is None else {"p": p})
    m.out.line = line


saving = partial(Code, group=Group.SPINDLE, order=Order.SPINDLE)

CODES = (
    saving("M70", "Save the modes", partial(save, False)),
    saving("M71", "Forget the saved modes", forget),
    saving("M72", "Restore the saved modes", restore),
    saving("M73", "Save the modes, restore on return", partial(save, True)),
)
