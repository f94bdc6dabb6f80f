"""The travel of the axes: no move may lead one beyond its limits.

Compared are positions of the machine's axes, the tool's offset included: ends of moves,
and the bulges of arcs. Lengths mm, angles degrees. To spare time, boxes of what is allowed
are kept ready, one in the program's frame and one in space; `State.fence` makes them.

Sources: decisions AMB-COD-13, AMB-XF-16.
"""

from __future__ import annotations

from array import array
from math import hypot
from typing import TYPE_CHECKING, Any

from aircut.diagnostics import faults as F
from aircut.geometry.arcs import PLANE_AXES, reaches
from aircut.interpreter.table import AXES
from aircut.kernels import bounds

if TYPE_CHECKING:
    from aircut.interpreter.path import Place
    from aircut.interpreter.state import State
    from aircut.machine import Machine

FAR = 1e9  # mm, degrees: no machine reaches that far
SLACK = 1e-6  # mm, degrees by which sums of offsets may miss a limit
STILL = 1e-9  # mm, degrees: a smaller step is none
INCH = 25.4  # mm

Box = tuple[float, ...]  # lowest and highest X, then Y, Z, A, B, C


def travel_of(machine: Machine) -> Box:
    """The limits of a machine's axes; axes that it lacks have none."""
    box: list[float] = []
    for letter in AXES:
        axis = machine.axes.get(letter)
        box += (-FAR, FAR) if axis is None else (axis.min, axis.max)
    return tuple(box)


def shifted(box: Box, offset: Place, slack: float = SLACK) -> Box:
    """The box of places that an offset takes into this one, a little larger."""
    return tuple(limit - offset[i // 2] + (slack if i % 2 else -slack) for i, limit in enumerate(box))


def check_line(m: State, end: Place) -> None:
    """Tell of a straight move in space that ends beyond a limit. Raises Refusal."""
    lx, hx, ly, hy, lz, hz, la, ha, lb, hb, lc, hc = m.space_box
    if not (
        lx <= end[0] <= hx and ly <= end[1] <= hy and lz <= end[2] <= hz
        and la <= end[3] <= ha and lb <= end[4] <= hb and lc <= end[5] <= hc
    ):  # fmt: skip
        tell(m, end, end, end)


def check_arc(m: State, end: Place, center: tuple[float, float], turns: int) -> None:
    """Tell of an arc in space that leads beyond a limit. Raises Refusal."""
    u, v, _ = PLANE_AXES[m.plane]
    box = m.space_box
    radius = hypot(end[u] - center[0], end[v] - center[1])
    if (
        box[2 * u] <= center[0] - radius and center[0] + radius <= box[2 * u + 1]
        and box[2 * v] <= center[1] - radius and center[1] + radius <= box[2 * v + 1]
    ):  # fmt: skip
        check_line(m, end)
        return
    start = m.out.end()
    low, high = reaches((start[u], start[v]), (end[u], end[v]), center, turns)
    least, most = list(end), list(end)
    least[u], least[v] = low
    most[u], most[v] = high
    tell(m, end, least, most)


def check_rows(m: State, rows: Any, first: int, last: int) -> None:
    """Tell of rows of the toolpath that lead beyond a limit. rows: their doubles, kernels.bounds.STRIDE each."""
    box = array("d", m.space_box)
    at = bounds.outside(rows, first, last, box)
    if at == last:
        return
    ends = [[rows[row * bounds.STRIDE + i] for i in range(6)] for row in range(at, last)]
    columns = list(zip(*ends, strict=True))
    tell(m, ends[-1], [min(column) for column in columns], [max(column) for column in columns])


def tell(m: State, end: Place, least: Place, most: Place) -> None:
    """Tell of each axis that a move leads beyond its travel, but not of those that stand there or come back.

    least, most: how far it leads, in space.
    """
    before = m.out.end()
    for i, axis in enumerate(AXES):
        shift = m.tool_offset[i]
        low, high = m.travel[2 * i] - shift, m.travel[2 * i + 1] - shift
        if low - least[i] > most[i] - high:
            value, limit, name, beyond = least[i], low, "min", low - least[i]
            back = end[i] >= low and least[i] >= before[i] - STILL
        else:
            value, limit, name, beyond = most[i], high, "max", most[i] - high
            back = end[i] <= high and most[i] <= before[i] + STILL
        stands = abs(least[i] - before[i]) < STILL and abs(most[i] - before[i]) < STILL
        if beyond <= SLACK or back or stands:
            continue
        unit, text = (m.unit, "in" if m.unit == INCH else "mm") if i < 3 else (1.0, "degrees")
        m.warn(
            F.TRAVEL_IN_CHANGE if m.changing else F.TRAVEL,
            axis,
            axis=axis.upper(),
            value=round((value + shift) / unit, 6),
            beyond=beyond / unit,
            limit=round((limit + shift) / unit, 6),
            name=name,
            unit=text,
        )
