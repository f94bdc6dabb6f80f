"""Toolpaths as polylines: arcs and helices cut into chords short enough not to show.

A toolpath is one unbroken line, each move starting where the one before ended,
so its polyline is one array of points and, beside it, the move that each ends.
"""

from __future__ import annotations

from math import tau
from typing import TYPE_CHECKING, Any

from aircut.geometry import arcs

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

COARSEST = tau / 12  # radians: a tiny circle still looks round
FINEST = tau / 4096  # radians: bounds the points of a huge circle, see `polyline`


def chords(radius: NDArray[np.float64], swept: NDArray[np.float64], tolerance: float) -> NDArray[np.int64]:
    """Number of equal chords for each arc, at least 1.

    radius: mm. swept: radians, any sign. tolerance: mm between chord and arc.
    """
    import numpy as np

    cosine = 1.0 - tolerance / np.maximum(radius, tolerance / 2)  # from -1: the chord may be the whole circle
    angle = np.clip(2.0 * np.arccos(cosine), FINEST, COARSEST)
    return np.maximum(np.ceil(np.abs(swept) / angle - 1e-9), 1).astype(np.int64)


def polyline(
    toolpath: Any, tolerance_mm: float = 0.01, max_points: int | None = None
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Points along a toolpath: (m, 3) XYZ in machine mm, and (m,) the move that each point ends or lies on.

    toolpath: has `start`, the columns x, y, z and turns, and `arcs()`, as canon.Toolpath.
    tolerance_mm: an arc's chords stray no farther from it, up to radii of about 3e6·tolerance;
    beyond that a turn has 4096 chords. max_points: where there would be more points, chords grow
    until they fit or each arc has one; moves are never dropped, so a line is always one point.
    The first point is the start and belongs to move -1. The last point of a move is exactly its end.
    An arc whose ends have different radii is a spiral between them, its axis the programmed center.
    """
    import numpy as np

    count = len(toolpath.x)
    spans = []
    for plane, which, start, end, center in toolpath.arcs():
        keep = toolpath.turns[which] != 0  # no turns: drawn as a line
        which, start, end, center = which[keep], start[keep], end[keep], center[keep]
        swept = arcs.sweeps(start[:, :2], end[:, :2], center[:, :2], toolpath.turns[which])
        first, last = start[:, :2] - center[:, :2], end[:, :2] - center[:, :2]
        radii = np.column_stack([np.hypot(*first.T), np.hypot(*last.T)])
        spans.append((plane, which, start, end, center, swept, np.arctan2(first[:, 1], first[:, 0]), radii))

    def divide(tolerance: float, coarser: float = 1.0) -> NDArray[np.int64]:
        pieces = np.ones(count, np.int64)
        for _, which, _, _, _, swept, _, radii in spans:
            many = chords(radii.max(axis=1), swept, tolerance)
            pieces[which] = np.maximum(np.ceil(many / coarser), 1).astype(np.int64)
        return pieces

    pieces = divide(tolerance_mm)
    coarser = 1.0
    while max_points is not None and pieces.sum() + 1 > max_points and pieces.max(initial=1) > 1:
        coarser *= 2.0
        pieces = divide(tolerance_mm, coarser)

    final = np.cumsum(pieces)  # index of each move's last point
    points = np.empty((int(pieces.sum()) + 1, 3))
    points[0] = toolpath.start[:3]
    ends = np.column_stack([toolpath.x, toolpath.y, toolpath.z])
    points[final] = ends
    move = np.empty(len(points), np.int64)
    move[0] = -1
    move[1:] = np.repeat(np.arange(count), pieces)

    for plane, which, start, end, center, swept, angle, radii in spans:
        inner = pieces[which] - 1
        if not inner.sum():
            continue
        of = np.repeat(np.arange(len(which)), inner)  # the arc of each inner point
        step = np.arange(len(of)) - np.repeat(np.cumsum(inner) - inner, inner) + 1
        part = step / pieces[which][of]
        theta = angle[of] + part * swept[of]
        radius = radii[of, 0] + part * (radii[of, 1] - radii[of, 0])
        rows = final[which][of] - pieces[which][of] + step
        u, v, w = arcs.PLANE_AXES[plane]
        points[rows, u] = center[of, 0] + radius * np.cos(theta)
        points[rows, v] = center[of, 1] + radius * np.sin(theta)
        points[rows, w] = start[of, 2] + part * (end[of, 2] - start[of, 2])
    return points, move
