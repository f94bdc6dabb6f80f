"""How fast a feed move is.

A row of the toolpath holds mm/min along the linear axes, or degrees/min where only
rotary axes move; its length over that is its time. F means just that (AMB-FEED-4), the
moves a minute under G93, or, with Rotary Feed Handling, the speed of the tool over the
part that the rotary axes turn (AMB-FEED-5).

Sources: 000 sections 1.1, 1.3, 7.2; decisions AMB-FEED-1 to AMB-FEED-6.
"""

from __future__ import annotations

from math import hypot, radians, sqrt
from typing import TYPE_CHECKING

from aircut.diagnostics import Refusal
from aircut.diagnostics import faults as F
from aircut.interpreter.table import AXES, Words

if TYPE_CHECKING:
    from aircut.interpreter.path import Place
    from aircut.interpreter.state import State

SLOWEST = 0.1  # program units a minute: a lower inverse-time feed is told as this
TINY = 1e-7  # mm: shorter linear moves count as rotary ones (canonical listing, section 14)
ROTARY = (3, 4, 5)


def feed_speed(m: State, w: Words, length: float, rotary: bool = False) -> float:
    """Speed of a feed move of this length (mm; degrees if rotary), per minute. Raises Refusal."""
    if m.inverse_time:
        if w.get("f", 0.0) <= 0.0:
            raise Refusal(F.INVERSE_TIME_FEED, "f")
        unit = 1.0 if rotary else m.unit
        speed = max(SLOWEST * unit, m.feed * length)
        m.out.event("SET_FEED_RATE", speed / unit * m.unit)
        return speed
    if m.feed <= 0.0:
        speed = m.machine.options.default_feed
        if m.machine.options.missing_feed == "error":
            raise Refusal(F.MISSING_FEED)
        if m.feed_told != speed:
            m.feed_told = speed
            m.warn(F.NO_FEED, feed=speed)
            m.out.event("SET_FEED_RATE", speed)
        return speed
    return m.feed


def length_of(start: Place, end: Place) -> tuple[float, bool]:
    """Length of a straight move, and whether only rotary axes move: then in degrees."""
    dx, dy, dz = end[0] - start[0], end[1] - start[1], end[2] - start[2]
    linear = sqrt(dx * dx + dy * dy + dz * dz)
    if linear > TINY:
        return linear, False
    return sqrt(sum((end[i] - start[i]) ** 2 for i in ROTARY)), True


def line_speed(m: State, w: Words, goal: Place) -> float:
    """Speed of a straight feed move from the present position, as a row of the toolpath holds it. Raises Refusal."""
    start, end = m.position, goal
    if m.frame is not None or m.surface_feed:
        start, end = m.to_space(start), m.to_space(end)
    length, rotary = length_of(start, end)
    speed = feed_speed(m, w, length, rotary)
    if m.inverse_time or not length:
        return speed
    if m.surface_feed and (surface := surface_length(m, start, end, 0.0 if rotary else length)):
        return speed * length / surface
    return speed / m.unit if rotary else speed  # degrees are never scaled (AMB-FEED-6)


def arc_speed(m: State, w: Words, end: Place, length: float) -> float:
    """Speed of an arc or helix of this length (mm) from the present position. Raises Refusal."""
    speed = feed_speed(m, w, length)
    if m.surface_feed and not m.inverse_time:
        surface = surface_length(m, m.to_space(m.position), m.to_space(end), length)
        speed *= length / surface if surface else 1.0
    return speed


def surface_length(m: State, start: Place, end: Place, linear: float) -> float:
    """Way of the tool over the part, mm; 0.0 where no rotary axis moves, or all turn about the tool.

    start, end: in space. linear: mm, the way of the linear axes.
    """
    if "rtcp" in m.stages:  # there F is the speed of the tip in the part already
        return 0.0
    squares = 0.0
    for i in ROTARY:
        if end[i] != start[i]:
            arm = (distance(m, i, start) + distance(m, i, end)) / 2.0
            squares += (arm * radians(end[i] - start[i])) ** 2
    surface = sqrt(linear * linear + squares)
    return surface if squares and surface > TINY else 0.0


def distance(m: State, i: int, place: Place) -> float:
    """Distance of a place in space from the line of a rotary axis, mm.

    With G43 the place is the tool's tip: its offset counts.
    """
    axis = m.machine.axes[AXES[i]]
    mode = axis.origin_mode
    origin = (axis.origin_x, axis.origin_y, axis.origin_z) if mode == "custom" else m.origins[mode - 1]
    return hypot(*(place[k] - origin[k] for k in range(3) if "XYZ"[k] != axis.parallel_to))
