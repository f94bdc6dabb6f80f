"""A toolpath as pictures show it: its points, and on five-axis machines how the tool stands.

Where the run told the machine's kinematics (G43.4, G43.7), all is as the part sees it; else in machine
coordinates. Lengths mm.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

from aircut.canon import Kind, Recording, Toolpath
from aircut.canon.tips import kinematics, on_part
from aircut.geometry.polylines import polyline

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

TOOL_LENGTH = 0.12  # of a line along the tool: part of the size of the cut
FURTHEST = 1e9  # mm: nothing is drawn farther out


class Seen(NamedTuple):
    """What is to be drawn."""

    points: NDArray[np.float64]  # (m, 3)
    move: NDArray[np.int64]  # (m,) that each point ends or lies on; -1 for the start
    tools: NDArray[np.float64]  # (k, 2, 3) lines along the tool, from its tip; none without kinematics
    part: bool  # as the part sees it


def finite(values: Any) -> NDArray[np.float64]:
    """The values with FURTHEST for what lies beyond it and 0 for what is no number."""
    import numpy as np

    return np.clip(np.nan_to_num(values, nan=0.0), -FURTHEST, FURTHEST)


def seen(toolpath: Toolpath, spare: int, tools: int) -> Seen:
    """A toolpath as points. spare: points that arcs may add. tools: lines along the tool."""
    import numpy as np

    points, move = polyline(toolpath, max_points=len(toolpath) + spare)
    if not len(toolpath) or kinematics(toolpath) is None:
        return Seen(finite(points), move, np.empty((0, 2, 3)), False)
    points, directions = (finite(each) for each in on_part(toolpath, points, move))
    cut = toolpath.kind[np.maximum(move, 0)] != Kind.TRAVERSE
    return Seen(points, move, standing(points, directions, cut, tools), True)


def standing(
    points: NDArray[np.float64], directions: NDArray[np.float64], cut: NDArray[np.bool_], count: int
) -> NDArray[np.float64]:
    """Lines along the tool at places spread evenly over the segments that cut, (k, 2, 3).

    Where the tool turns about its tip, a quarter turn counts as a tenth of the size of the cut.
    """
    import numpy as np

    which = np.flatnonzero(cut[1:]) + 1
    if not len(which):
        return np.empty((0, 2, 3))
    size = float(np.linalg.norm(np.ptp(points[which], axis=0))) or 1.0
    steps = np.linalg.norm(points[which] - points[which - 1], axis=1)
    steps += 0.07 * size * np.linalg.norm(directions[which] - directions[which - 1], axis=1)
    way = np.cumsum(steps)
    at = np.linspace(0.0, way[-1], count + 1)[1:]
    k = np.minimum(np.searchsorted(way, at), len(which) - 1)
    back = ((way[k] - at) / np.maximum(steps[k], 1e-12))[:, None]
    end, start = which[k], which[k] - 1
    tip = points[end] + back * (points[start] - points[end])
    lean = directions[end] + back * (directions[start] - directions[end])
    lean /= np.maximum(np.linalg.norm(lean, axis=1), 1e-9)[:, None]
    return np.stack([tip, tip + TOOL_LENGTH * size * lean], axis=1)


def box(toolpath: Toolpath, shown: Seen, rapid: bool | None) -> list[list[float]] | None:
    """Lowest and highest X, Y, Z of the moves, exact where machine coordinates are shown; None without such moves."""
    import numpy as np

    if not shown.part:
        extents = toolpath.extents(rapid)
        return extents and finite([extents.low[:3], extents.high[:3]]).tolist()
    wanted = np.ones(len(toolpath) + 1, bool)
    if rapid is not None:
        wanted[1:] = (toolpath.kind == Kind.TRAVERSE) == rapid
        wanted[0] = False
    ends = np.flatnonzero(wanted[shown.move + 1])
    if not len(ends):
        return None
    places = shown.points[np.concatenate([ends, np.maximum(ends - 1, 0)])]
    places = np.vstack([places, shown.tools.reshape(-1, 3)])
    return [places.min(axis=0).tolist(), places.max(axis=0).tolist()]


def programmed(recording: Recording, spare: int) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """The contours beside which compensation led the tool: points (m, 3), and which end a segment to be drawn.

    spare: points that arcs may add.
    """
    import numpy as np

    contour = recording.contour
    if not len(contour):
        return np.empty((0, 3)), np.empty(0, bool)
    points, move = polyline(contour, max_points=len(contour) + spare)
    return finite(points), (move >= 0) & (contour.kind[np.maximum(move, 0)] != Kind.TRAVERSE)
