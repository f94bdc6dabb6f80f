"""Scaling, mirroring and rotation of space, and what scaling makes of an arc.

A Transform takes p to matrix·p + shift. Vectors are X, Y, Z in mm, angles degrees,
positive counterclockwise seen from the end of the axis (right-handed).
"""

from __future__ import annotations

from math import cos, hypot, inf, radians, sin
from typing import NamedTuple

from aircut.geometry.arcs import PLANE_AXES, center_of_radius

Vector = tuple[float, float, float]
Matrix = tuple[Vector, Vector, Vector]  # rows
Point = tuple[float, float]  # along u and v of a plane

GAP = 1e-4  # mm between the end of a scaled arc and the scaled end: less is none (AMB-XF-7)
ALIKE = 1e-12  # part by which factors may differ that count as equal
QUARTERS = ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))  # cosine and sine of 0°, 90°, 180°, 270°


class Transform(NamedTuple):
    """An affine map of space."""

    matrix: Matrix
    shift: Vector

    def __call__(self, x: float, y: float, z: float) -> Vector:
        (a, b, c), (d, e, f), (g, h, i) = self.matrix
        u, v, w = self.shift
        return a * x + b * y + c * z + u, d * x + e * y + f * z + v, g * x + h * y + i * z + w


IDENTITY = Transform(((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)), (0.0, 0.0, 0.0))


def about(matrix: Matrix, center: Vector) -> Transform:
    """The map with this matrix that leaves the center where it is."""
    x, y, z = Transform(matrix, (0.0, 0.0, 0.0))(*center)
    return Transform(matrix, (center[0] - x, center[1] - y, center[2] - z))


def scaling(factors: Vector, center: Vector) -> Transform:
    """Scaling of each axis about a center; a negative factor mirrors. The inverse is that of the factors' inverses."""
    x, y, z = factors
    return about(((x, 0.0, 0.0), (0.0, y, 0.0), (0.0, 0.0, z)), center)


def cosine_and_sine(degrees: float) -> tuple[float, float]:
    """Of an angle; exact for whole quarter turns."""
    quarter, rest = divmod(degrees, 90.0)
    if rest == 0.0:
        return QUARTERS[int(quarter) % 4]
    return cos(radians(degrees)), sin(radians(degrees))


def turning(axis: int, degrees: float) -> Matrix:
    """Rotation about X (0), Y (1) or Z (2)."""
    u, v = (axis + 1) % 3, (axis + 2) % 3
    c, s = cosine_and_sine(degrees)
    rows = [[float(i == j) for j in range(3)] for i in range(3)]
    rows[u][u], rows[u][v], rows[v][u], rows[v][v] = c, -s, s, c
    return as_matrix(rows)


def tilting(angles: Vector) -> Matrix:
    """Rotation about the fixed axes X, then Y, then Z: Rz·Ry·Rx."""
    x, y, z = (turning(axis, angle) for axis, angle in enumerate(angles))
    return times(z, times(y, x))


def transposed(matrix: Matrix) -> Matrix:
    """The inverse of a rotation."""
    return as_matrix([list(column) for column in zip(*matrix, strict=True)])


def times(left: Matrix, right: Matrix) -> Matrix:
    """The matrix product."""
    return as_matrix([[sum(left[i][k] * right[k][j] for k in range(3)) for j in range(3)] for i in range(3)])


def as_matrix(rows: list[list[float]]) -> Matrix:
    (a, b, c), (d, e, f), (g, h, i) = rows
    return (a, b, c), (d, e, f), (g, h, i)


def then(first: Transform, second: Transform) -> Transform:
    """One map that does both."""
    return Transform(times(second.matrix, first.matrix), second(*first.shift))


class Arc(NamedTuple):
    """An arc in its plane: u and v, mm; turns as in geometry.arcs."""

    start: Point
    end: Point
    center: Point
    turns: int


def scaled_arc(arc: Arc, factors: Point, middle: Point, radius: float | None) -> tuple[Arc, Point | None]:
    """What scaling about a middle makes of an arc: an arc, and where a line must lead after it, if anywhere.

    An ellipse is never made. radius: the R word in mm, negative for the longer arc, where that gave the
    center; it is scaled by the larger factor, or to half the chord where that is more. Else the arc runs
    around the scaled center from the scaled start to the direction of the scaled end.
    Source: 000 section 8.1.4; decision AMB-XF-7.
    """

    def scaled(point: Point) -> Point:
        return middle[0] + factors[0] * (point[0] - middle[0]), middle[1] + factors[1] * (point[1] - middle[1])

    start, end, center = scaled(arc.start), scaled(arc.end), scaled(arc.center)
    turns = -arc.turns if factors[0] * factors[1] < 0.0 else arc.turns
    larger = max(abs(factors[0]), abs(factors[1]))
    if abs(abs(factors[0]) - abs(factors[1])) <= ALIKE * larger:
        return Arc(start, end, center, turns), None
    if radius is not None:
        found = center_of_radius(start, end, radius * larger, 1 if turns > 0 else -1, inf)
        return Arc(start, end, found or center, turns), None
    reach, distance = hypot(start[0] - center[0], start[1] - center[1]), hypot(end[0] - center[0], end[1] - center[1])
    if abs(reach - distance) <= GAP:
        return Arc(start, end, center, turns), None
    part = reach / distance
    last = center[0] + part * (end[0] - center[0]), center[1] + part * (end[1] - center[1])
    return Arc(start, last, center, turns), end


def in_plane(plane: int, place: Vector) -> Point:
    """The coordinates u and v of a point."""
    u, v, _ = PLANE_AXES[plane]
    return place[u], place[v]
