"""Where the path is: positions and derivatives along its pieces, vectorised."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from aircut.canon.toolpath import AXES
from aircut.geometry import arcs
from aircut.kernels import pieces as kernel

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from aircut.canon import Toolpath

    Array = NDArray[np.float64]

LINE, ARC, FILLET, CURVE = kernel.LINE, kernel.ARC, kernel.FILLET, kernel.CURVE


class Path:
    """The pieces of path that a toolpath becomes: its moves, and the blends between them.

    length: (n,), of the path's parameter, the length in all axes, mm and degrees. move: index of the move;
    a blend counts to the move that it ends. shape: LINE, ARC, FILLET, CURVE. offset: where on its move the
    piece starts; of a blend, how much of each line it takes. ways: (n + 1,), the parameter at the joints.
    smooth: curves without jumps of curvature.
    """

    def __init__(
        self,
        toolpath: Toolpath,
        length: Array,
        move: NDArray[Any],
        shape: NDArray[np.uint8],
        offset: Array,
        smooth: bool,
    ) -> None:
        import numpy as np

        self.toolpath = toolpath
        self.length = length
        self.ways = np.empty(len(length) + 1)
        self.ways[0] = 0.0
        np.cumsum(length, out=self.ways[1:])
        self.move = move
        self.shape = shape
        self.offset = offset
        self.smooth = smooth

    def __len__(self) -> int:
        return len(self.length)

    def ends(self, rows: NDArray[Any]) -> Array:
        """End points of moves; of move -1 the start of the path. (m, 6)."""
        import numpy as np

        columns = self.toolpath.columns
        points = np.column_stack([columns[axis][np.maximum(rows, 0)] for axis in AXES])
        points[rows < 0] = self.toolpath.start
        return points

    def at(self, piece: NDArray[Any], way: Array) -> tuple[Array, Array, Array]:
        """Position and its first and second derivative by the path's parameter, each (m, 6).

        piece: (m,) indices. way: (m,) along the piece, from 0 to its length.
        """
        import numpy as np

        place, first, second = (np.zeros((len(piece), 6)) for _ in range(3))
        shape = self.shape[piece]
        for kind, function in ((LINE, self._line), (ARC, self._arc), (FILLET, self._fillet), (CURVE, self._curve)):
            which = np.flatnonzero(shape == kind)
            if len(which):
                place[which], first[which], second[which] = function(piece[which], way[which])
        return place, first, second

    def _line(self, piece: NDArray[Any], way: Array) -> tuple[Array, Array, Array]:
        import numpy as np

        row = self.move[piece]
        start, end = self.ends(row - 1), self.ends(row)
        whole = np.sqrt(((end - start) ** 2).sum(axis=1))
        along = self.offset[piece] + way
        part = (along / whole)[:, None]
        # From the nearer end, so that both are met exactly.
        place = np.where(part < 0.5, start + part * (end - start), end - (1.0 - part) * (end - start))
        return place, (end - start) / whole[:, None], np.zeros_like(place)

    def _arc(self, piece: NDArray[Any], way: Array) -> tuple[Array, Array, Array]:
        import numpy as np

        t = self.toolpath
        row = self.move[piece]
        start, end = self.ends(row - 1), self.ends(row)
        place, rate, second = np.empty_like(start), np.empty_like(start), np.zeros_like(start)
        for plane, (u, v, w) in enumerate(arcs.PLANE_AXES):
            which = np.flatnonzero(t.plane[row] == plane)
            if not len(which):
                continue
            r = row[which]
            center = np.column_stack([t.u[r], t.v[r]])
            first, last = start[which][:, [u, v]], end[which][:, [u, v]]
            turn = arcs.sweeps(first, last, center, t.turns[r])
            angle = np.arctan2(*(first - center).T[::-1])
            radii = np.hypot(*(first - center).T), np.hypot(*(last - center).T)
            straight = (end - start)[which][:, [w, 3, 4, 5]]
            around = (np.hypot(*(first - center).T) + np.hypot(*(last - center).T)) / 2 * turn
            length = np.sqrt(around**2 + (straight**2).sum(axis=1))
            f = (self.offset[piece[which]] + way[which]) / length
            place[which] = start[which] + f[:, None] * (end - start)[which]
            rate[which] = (end - start)[which] / length[:, None]
            theta, radius = angle + f * turn, radii[0] + f * (radii[1] - radii[0])
            swing, grow = turn / length, (radii[1] - radii[0]) / length
            c, s = np.cos(theta), np.sin(theta)
            at_u, at_v = center[:, 0] + radius * c, center[:, 1] + radius * s
            # The circle meets the ends to rounding only; the programmed ends are met exactly.
            for axis, value, at_start, at_end in (
                (u, at_u, center[:, 0] + radii[0] * np.cos(angle), center[:, 0] + radii[1] * np.cos(angle + turn)),
                (v, at_v, center[:, 1] + radii[0] * np.sin(angle), center[:, 1] + radii[1] * np.sin(angle + turn)),
            ):
                place[which, axis] = value + (1 - f) * (start[which, axis] - at_start) + f * (end[which, axis] - at_end)
            rate[which, u], rate[which, v] = grow * c - radius * swing * s, grow * s + radius * swing * c
            second[which, u] = -2 * grow * swing * s - radius * swing**2 * c
            second[which, v] = 2 * grow * swing * c - radius * swing**2 * s
        return place, rate, second

    def corner(self, piece: NDArray[Any]) -> tuple[Array, Array, Array]:
        """Of blends: the corner that they round, and the directions before and after, (m, 6) each."""
        import numpy as np

        row, after = self.move[piece], self.move[piece + 1]
        corner = self.ends(row)
        before = corner - self.ends(row - 1)
        onward = self.ends(after) - corner
        before /= np.sqrt((before**2).sum(axis=1))[:, None]
        onward /= np.sqrt((onward**2).sum(axis=1))[:, None]
        return corner, before, onward

    def _fillet(self, piece: NDArray[Any], way: Array) -> tuple[Array, Array, Array]:
        import numpy as np

        corner, before, after = self.corner(piece)
        total, turn = before + after, after - before
        s, c = np.sqrt((turn**2).sum(axis=1)) / 2, np.sqrt((total**2).sum(axis=1)) / 2
        take = self.offset[piece]
        radius = take * c / s
        along, inward = total / (2 * c)[:, None], turn / (2 * s)[:, None]
        center = corner + (take / s)[:, None] * inward
        angle = way / radius - np.arctan2(s, c)  # from the fillet's middle
        sine, cosine = np.sin(angle)[:, None], np.cos(angle)[:, None]
        place = center + radius[:, None] * (along * sine - inward * cosine)
        first = along * cosine + inward * sine
        second = (inward * cosine - along * sine) / radius[:, None]
        return place, first, second

    def _curve(self, piece: NDArray[Any], way: Array) -> tuple[Array, Array, Array]:
        corner, before, after = self.corner(piece)
        take = self.offset[piece][:, None]
        r = way[:, None] / (2 * take)
        if self.smooth:
            share, area, slope = r * r * (3 - 2 * r), r**3 - r**4 / 2, 6 * r * (1 - r)
        else:
            share, area, slope = r, r * r / 2, r * 0 + 1.0
        turn = after - before
        place = corner - take * before + 2 * take * (r * before + area * turn)
        return place, before + share * turn, slope * turn / (2 * take)
