"""Offsetting contours of lines and arcs: what radius compensation needs of plane geometry.

Everything speaks the plane's own axes u and v, mm, counterclockwise from u to v.
Offsets are to the left where positive, seen along the way. `turns` is that of
`arcs`: positive counterclockwise, 0 for straight lines. kernels.beside has the same formulas, to the last bit.
"""

from __future__ import annotations

from math import atan2, pi, sqrt
from typing import NamedTuple

from aircut.geometry.arcs import sweep

Point = tuple[float, float]
Vector = tuple[float, float]

PARALLEL = 1e-12  # sine of the angle below which lines do not meet
TOUCH = 1e-9  # part of the radius by which curves may miss each other and still touch
STRAIGHT_BACK = 1e-9  # radians from a half turn
TINY = 1e-7  # mm by which a crossing may lie beyond the ends of what crosses


class Element(NamedTuple):
    """A straight line or an arc."""

    start: Point
    end: Point
    center: Point | None = None
    turns: int = 0

    @property
    def sign(self) -> int:
        """+1 for arcs counterclockwise, -1 clockwise, 0 for lines."""
        return (self.turns > 0) - (self.turns < 0)

    @property
    def radius(self) -> float:
        """Of an arc, at its start (a line's is 0)."""
        return 0.0 if self.center is None else distance(self.start, self.center)


def distance(a: Point, b: Point) -> float:
    return reach(b[0] - a[0], b[1] - a[1])


def reach(u: float, v: float) -> float:
    """Length of a vector."""
    return sqrt(u * u + v * v)


def heading(element: Element, point: Point) -> Vector:
    """Direction of travel at a point of the element, of length 1."""
    if element.center is None:
        du, dv = element.end[0] - element.start[0], element.end[1] - element.start[1]
    else:
        sign = element.sign
        du, dv = sign * (element.center[1] - point[1]), sign * (point[0] - element.center[0])
    length = reach(du, dv)
    return du / length, dv / length


def beside(point: Point, direction: Vector, left: float) -> Point:
    """The point at a distance to the left of another."""
    return point[0] - left * direction[1], point[1] + left * direction[0]


def turn(before: Vector, after: Vector) -> float:
    """Change of direction, radians, from -pi to pi; positive to the left."""
    cross = before[0] * after[1] - before[1] * after[0]
    return atan2(cross, before[0] * after[0] + before[1] * after[1])


def corner(first: Element, second: Element, side: int) -> float:
    """Change of direction between two elements, radians, as seen from the tool: positive for inside corners.

    side: +1 with the tool on the left, -1 on the right. Where the way goes straight
    back the corner is an outside one, unless the second element bends to the tool's
    side of the first.
    """
    angle = side * turn(heading(first, first.end), heading(second, second.start))
    if abs(angle) > pi - STRAIGHT_BACK:
        bent = first.sign / (first.radius or 1.0) + second.sign / (second.radius or 1.0)
        return pi if side * bent < 0.0 else -pi
    return angle


def offset(element: Element, left: float) -> Element | None:
    """The parallel element to the left; None for an arc whose radius is not larger than it."""
    if element.center is None:
        direction = heading(element, element.end)
        return Element(beside(element.start, direction, left), beside(element.end, direction, left))
    if element.radius - element.sign * left <= 0.0:
        return None
    start = beside(element.start, heading(element, element.start), left)
    end = beside(element.end, heading(element, element.end), left)
    return element._replace(start=start, end=end)


def square_end(element: Element, left: float) -> Point:
    """The point beside the end."""
    return beside(element.end, heading(element, element.end), left)


def crossings(first: Element, second: Element) -> list[Point]:
    """Where the whole lines and circles of two elements meet: none, one or two points.

    Arcs have the radius of their end. That of their start differs by what the program rounds: the line before
    an arc is led to it by so much, across the arc's start (as the oracle has it).
    """
    if first.center is None and second.center is None:
        return line_line(first, second)
    if first.center is None:
        assert second.center is not None
        center, start = second.center, second.start
        from_start, radius = distance(start, center), distance(second.end, center)
        share = (radius - from_start) / from_start
        shift = (start[0] - center[0]) * share, (start[1] - center[1]) * share
        return line_circle(first, center, radius, shift)
    if second.center is None:
        return line_circle(second, first.center, distance(first.end, first.center))
    radii = distance(first.end, first.center), distance(second.end, second.center)
    return circle_circle(first.center, radii[0], second.center, radii[1])


def line_line(first: Element, second: Element) -> list[Point]:
    a, b = heading(first, first.end), heading(second, second.end)
    sine = a[0] * b[1] - a[1] * b[0]
    if abs(sine) < PARALLEL:
        return []
    du, dv = second.start[0] - first.end[0], second.start[1] - first.end[1]
    along = (du * b[1] - dv * b[0]) / sine
    return [(first.end[0] + along * a[0], first.end[1] + along * a[1])]


def line_circle(line: Element, center: Point, radius: float, shift: Vector = (0.0, 0.0)) -> list[Point]:
    d = heading(line, line.end)
    start = line.start[0] + shift[0], line.start[1] + shift[1]
    du, dv = center[0] - start[0], center[1] - start[1]
    along, across = du * d[0] + dv * d[1], dv * d[0] - du * d[1]
    return pair(start, d, along, radius * radius - across * across, radius)


def circle_circle(a: Point, radius: float, b: Point, other: float) -> list[Point]:
    du, dv = b[0] - a[0], b[1] - a[1]
    apart = reach(du, dv)
    if apart < TOUCH * radius:
        return []
    along = (apart * apart + radius * radius - other * other) / (2.0 * apart)
    foot = (a[0] + along * du / apart, a[1] + along * dv / apart)
    return pair(foot, (-dv / apart, du / apart), 0.0, radius * radius - along * along, radius)


def pair(origin: Point, direction: Vector, along: float, square: float, radius: float) -> list[Point]:
    """The points at along ± √square from an origin; one where the square is a rounding error below zero."""
    if square < -TOUCH * (radius * radius):
        return []
    half = sqrt(max(square, 0.0))
    return [(origin[0] + t * direction[0], origin[1] + t * direction[1]) for t in (along - half, along + half)]


def along(element: Element, point: Point) -> float:
    """How far along the element a point of its line or circle lies, mm; below zero before its start.

    On an arc the place is the first after the start; one less than TOUCH before it counts as the start.
    """
    if element.center is None:
        d = heading(element, element.end)
        return (point[0] - element.start[0]) * d[0] + (point[1] - element.start[1]) * d[1]
    if distance(element.start, point) < TOUCH * element.radius:
        return 0.0
    return element.radius * abs(sweep(element.start, point, element.center, element.sign))


def length(element: Element) -> float:
    if element.center is None:
        return distance(element.start, element.end)
    return element.radius * abs(sweep(element.start, element.end, element.center, element.turns))


def meetings(first: Element, second: Element) -> list[Point]:
    """Where two elements themselves meet, the last along the first one first."""
    found = [
        (along(first, point), point)
        for point in crossings(first, second)
        if all(-TINY < along(one, point) < length(one) + TINY for one in (first, second))
    ]
    return [point for _, point in sorted(found, reverse=True)]


def away(element: Element, point: Point) -> float:
    """Distance of a point from the element."""
    ends = min(distance(point, element.start), distance(point, element.end))
    if element.center is None:
        at = along(element, point)
        if not 0.0 < at < length(element):
            return ends
        d = heading(element, element.end)
        return abs(d[0] * (point[1] - element.start[1]) - d[1] * (point[0] - element.start[0]))
    radius = distance(point, element.center)
    if radius == 0.0:
        return element.radius
    foot = tuple(c + (p - c) * element.radius / radius for c, p in zip(element.center, point, strict=True))
    if along(element, (foot[0], foot[1])) > length(element):
        return ends
    return abs(radius - element.radius)


def nearest(points: list[Point], place: Point) -> Point | None:
    """The point nearest to a place."""
    return min(points, key=lambda point: distance(point, place), default=None)


def center_between(start: Point, end: Point, center: Point) -> Point | None:
    """The center of an arc whose end has been moved away from, or towards, its center.

    It lies on the line through the end and the old center, equally far from start
    and end; None where there is no such point.
    """
    au, av = center[0] - end[0], center[1] - end[1]
    length = reach(au, av)
    if length == 0.0:
        return None
    au, av = au / length, av / length
    bu, bv = start[0] - end[0], start[1] - end[1]
    across = bu * au + bv * av
    if abs(across) < PARALLEL:
        return None
    along = (bu * bu + bv * bv) / (2.0 * across)
    return end[0] + along * au, end[1] + along * av
