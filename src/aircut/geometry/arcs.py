"""Arcs and helices: sweep, length, bounds and points along them.

Everything speaks the arc plane's own axes: u and v across, counterclockwise
from u to v, w along the plane's normal. `turns` is the canonical commands'
count: +1 counterclockwise, -1 clockwise, further turns add full circles.
The functions on numbers serve the interpreter, those on arrays everyone else.
"""

from __future__ import annotations

from math import atan2, ceil, floor, hypot, sqrt, tau
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

Point = tuple[float, float]  # u and v
QUARTER = tau / 4
FULL_CIRCLE_FUZZ = 1e-6  # radians: an arc that sweeps less than this goes all the way round

#: Plane number (0 XY, 1 ZX, 2 YZ) -> indices of u, v and w among X, Y, Z.
PLANE_AXES = ((0, 1, 2), (2, 0, 1), (1, 2, 0))


def sweep(start: tuple[float, float], end: tuple[float, float], center: tuple[float, float], turns: int) -> float:
    """Signed angle swept, radians; start, end, center: (u, v) in mm; equal ends make a full circle."""
    angle = atan2(end[1] - center[1], end[0] - center[0]) - atan2(start[1] - center[1], start[0] - center[0])
    if turns > 0:
        angle %= tau
        if angle < FULL_CIRCLE_FUZZ:
            angle += tau
        return angle + tau * (turns - 1)
    angle = -(-angle % tau)
    if angle > -FULL_CIRCLE_FUZZ:
        angle -= tau
    return angle + tau * (turns + 1)


def reaches(start: Point, end: Point, center: Point, turns: int) -> tuple[Point, Point]:
    """Lowest and highest u and v of an arc, mm."""
    swept = sweep(start, end, center, turns)
    first = atan2(start[1] - center[1], start[0] - center[0])
    lower, upper = min(first, first + swept), max(first, first + swept)
    radius = max(hypot(start[0] - center[0], start[1] - center[1]), hypot(end[0] - center[0], end[1] - center[1]))
    low, high = [min(start[i], end[i]) for i in (0, 1)], [max(start[i], end[i]) for i in (0, 1)]
    for quarter in range(ceil(lower / QUARTER), floor(upper / QUARTER) + 1):
        axis = quarter % 2
        if quarter % 4 < 2:
            high[axis] = max(high[axis], center[axis] + radius)
        else:
            low[axis] = min(low[axis], center[axis] - radius)
        if quarter - lower / QUARTER > 4:
            break
    return (low[0], low[1]), (high[0], high[1])


def center_of_radius(
    start: tuple[float, float], end: tuple[float, float], radius: float, turn: int, slack: float
) -> tuple[float, float] | None:
    """Center (u, v) of the arc given by its radius (the R word), mm.

    radius: mm, negative for the arc longer than half a turn. turn: +1 or -1.
    slack: mm by which half the chord may exceed the radius; the center is then the chord's middle.
    Returns None where no such circle reaches both points.
    Source: NIST RS274/NGC 3.5.3.1.
    """
    way = (end[0] - start[0], end[1] - start[1])
    half = sqrt(way[0] * way[0] + way[1] * way[1]) / 2  # as kernels.plain, to the last bit
    if half - abs(radius) > slack:
        return None
    rise = sqrt(max(0.0, radius * radius - half * half))
    if (radius > 0) != (turn > 0):
        rise = -rise
    # The center lies on the left of the chord for a short counterclockwise arc.
    along = (way[0] / (2 * half), way[1] / (2 * half))
    return (start[0] + end[0]) / 2 - rise * along[1], (start[1] + end[1]) / 2 + rise * along[0]


def sweeps(start: Array, end: Array, center: Array, turns: NDArray[Any]) -> Array:
    """Signed angles swept, (n,) radians. start, end, center: (n, 2) mm; turns: (n,)."""
    import numpy as np

    to_start, to_end = start - center, end - center
    angle = np.arctan2(to_end[:, 1], to_end[:, 0]) - np.arctan2(to_start[:, 1], to_start[:, 0])
    sign = np.where(turns > 0, 1.0, -1.0)
    angle = np.mod(sign * angle, tau)
    angle = np.where(angle < FULL_CIRCLE_FUZZ, angle + tau, angle)
    swept: Array = sign * (angle + tau * (np.abs(turns) - 1))
    return swept


def lengths(start: Array, end: Array, rise: Array, center: Array, turns: NDArray[Any]) -> Array:
    """Path lengths, (n,) mm; the radius is the mean of both ends'. rise: (n,) mm along the normal."""
    import numpy as np

    radius = (np.hypot(*(start - center).T) + np.hypot(*(end - center).T)) / 2
    length: Array = np.hypot(radius * sweeps(start, end, center, turns), rise)
    return length


def bounds(start: Array, end: Array, center: Array, turns: NDArray[Any]) -> tuple[Array, Array]:
    """Lowest and highest u and v of each arc: two arrays (n, 2), mm."""
    import numpy as np

    low, high = np.minimum(start, end), np.maximum(start, end)
    angle = sweeps(start, end, center, turns)
    first = np.arctan2(*(start - center).T[::-1])
    lower, upper = np.minimum(first, first + angle), np.maximum(first, first + angle)
    radius = np.maximum(np.hypot(*(start - center).T), np.hypot(*(end - center).T))
    for quarter, axis, side in ((0, 0, 1), (1, 1, 1), (2, 0, -1), (3, 1, -1)):
        # Does the arc pass the axis direction quarter·90°, at any full turn?
        passes = np.floor((upper - quarter * tau / 4) / tau) >= np.ceil((lower - quarter * tau / 4) / tau)
        reach = center[:, axis] + side * radius
        if side > 0:
            high[:, axis] = np.where(passes, np.maximum(high[:, axis], reach), high[:, axis])
        else:
            low[:, axis] = np.where(passes, np.minimum(low[:, axis], reach), low[:, axis])
    return low, high
