"""G40 to G42.1: cutter radius compensation on and off.

Sources: 000 sections 4.1 and 4.2; decisions AMB-CMP-1 to AMB-CMP-8.
"""

from __future__ import annotations

from functools import partial

from aircut.diagnostics import Refusal
from aircut.diagnostics import faults as F
from aircut.interpreter import path
from aircut.interpreter.compensation import Compensation, Easy, Nist
from aircut.interpreter.path import Onward, Place
from aircut.interpreter.state import State, out_of_range, whole
from aircut.interpreter.table import Code, Group, Order, Words
from aircut.interpreter.tooling import tool_of
from aircut.interpreter.transforming import mirrored
from aircut.interpreter.trimming import Normal

SLOT = "compensation"
XZ, YZ = 1, 2  # planes
ORIENTATIONS = 9  # the highest
#: By the machine's option (AMB-CMP-5).
ENTRIES: dict[str, type[Compensation]] = {"nist": Nist, "easy": Easy, "normal": Normal}
#: Control point of a lathe tool from its nose's center, in radii, Z and X; 0 and 9 are the center (AMB-CMP-4).
SHIFTS = ((0, 0), (1, -1), (-1, -1), (-1, 1), (1, 1), (1, 0), (0, -1), (-1, 0), (0, 1), (0, 0))


class Leaving:
    """After G40: the next move leads straight from beside the contour to its programmed end."""

    def line(self, m: State, kind: int, end: Place, speed: float, flags: int, *, onward: Onward) -> None:
        path.set_stage(m, SLOT, None)
        onward.line(m, kind, end, speed, flags)

    def arc(
        self, m: State, end: Place, center: tuple[float, float], turns: int, speed: float, flags: int, *, onward: Onward
    ) -> None:
        raise Refusal(F.EXIT_ARC)

    def flush(self, m: State, *, onward: Onward) -> None:
        """Nothing is held."""


def left_or_right(side: int, m: State, w: Words) -> None:
    """G41 (side +1) and G42 (-1): beside the contour by the radius of a tool of the table. Raises Refusal."""
    loaded = "d" in w and w["d"] == 0.0 and m.dialect.cutter.zero_is_loaded
    diameter = (m.tools[m.tool].diameter if m.tool in m.tools else 0.0) if loaded else tool_of(m, w, "d").diameter
    begin(m, side, diameter / 2.0 - w.get("i", 0.0) * m.unit, 0)


def dynamic(side: int, m: State, w: Words) -> None:
    """G41.1 and G42.1: by half the D word. Raises Refusal."""
    if m.plane == YZ:
        raise Refusal(F.COMPENSATION_YZ, "g", code="G41.1" if side > 0 else "G42.1")
    orientation = 0
    if "l" in w:
        if m.plane != XZ:
            raise Refusal(F.COMPENSATION_L, "l")
        orientation = whole(w, "l")
        if not 0 <= orientation <= ORIENTATIONS:
            raise out_of_range(w, "l", f"orientations are 0 to {ORIENTATIONS}")
    begin(m, side, w["d"] / 2.0 * m.unit, orientation)


def begin(m: State, side: int, radius: float, orientation: int) -> None:
    """Put the stage in force; a radius below zero changes sides."""
    if "rtcp" in m.stages:
        raise Refusal(F.COMPENSATION_TILTED, "g", mode="with tool center point control", off="G49")
    if m.modal[Group.ROTATION].name == "G68.2":
        raise Refusal(F.COMPENSATION_TILTED, "g", mode="in a tilted plane", off="G69")
    if m.frame is not None and m.frame.rotation is not None and m.frame.rotation.plane != m.plane:
        raise Refusal(F.COMPENSATION_TILTED, "g", mode="while G68 turns another plane", off="G69")
    if (radius < 0.0) != mirrored(m.frame, m.plane):
        side = -side
    radius = abs(radius)
    m.out.event("COMMENT", f"interpreter: cutter radius compensation on {'left' if side > 0 else 'right'}")
    m.out.at_once = m.dialect.cutter.at_once
    m.compensating = True
    shift = (SHIFTS[orientation][0] * radius, SHIFTS[orientation][1] * radius)
    stage = ENTRIES[m.machine.options.entry](m, radius, side, shift) if radius else None
    path.set_stage(m, SLOT, stage)


def end(m: State, w: Words) -> None:
    """G40. Raises Refusal."""
    path.flush(m)
    m.compensating = False
    stage = m.stages.get(SLOT)
    if stage is not None and getattr(stage, "entered", True):
        path.set_stage(m, SLOT, Leaving())
    else:
        path.set_stage(m, SLOT, None)
    m.out.event("COMMENT", "interpreter: cutter radius compensation off")


code = partial(Code, group=Group.CUTTER, order=Order.CUTTER, modal=True)

CODES = (
    code("G40", "Cutter compensation off", end),
    code("G41", "Cutter compensation left", partial(left_or_right, +1), takes="di"),
    code("G41.1", "Dynamic cutter compensation left", partial(dynamic, +1), takes="dl", needs="d"),
    code("G42", "Cutter compensation right", partial(left_or_right, -1), takes="di"),
    code("G42.1", "Dynamic cutter compensation right", partial(dynamic, -1), takes="dl", needs="d"),
)
