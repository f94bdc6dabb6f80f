"""The frame: what scaling and rotation make of points and arcs that have the offsets added.

Steps 4 and 5 of the way from the program to the machine. Lengths mm, angles degrees.
Sources: 000 section 8.1; decisions AMB-XF-5 to AMB-XF-10.
"""

from __future__ import annotations

from math import hypot
from typing import TYPE_CHECKING, NamedTuple

from aircut.geometry.arcs import PLANE_AXES, sweep
from aircut.geometry.transforms import (
    IDENTITY,
    Arc,
    Point,
    Transform,
    Vector,
    about,
    scaled_arc,
    scaling,
    then,
    tilting,
    transposed,
)

if TYPE_CHECKING:
    from aircut.interpreter.path import Place


class Scaling(NamedTuple):
    """G51."""

    factors: Vector
    center: Vector  # fixed, with the offsets of the time when it was given
    programmed: Vector  # the center, in the program's coordinates of that time

    def forth(self) -> Transform:
        return scaling(self.factors, self.center)

    def back(self) -> Transform:
        x, y, z = self.factors
        return scaling((1.0 / x, 1.0 / y, 1.0 / z), self.center)


class Rotation(NamedTuple):
    """G68 in a plane, or G68.2."""

    plane: int | None  # None: tilted
    angles: Vector  # about X, then Y, then Z
    center: Vector  # fixed in space
    programmed: Vector

    def forth(self) -> Transform:
        return about(tilting(self.angles), self.center)

    def back(self) -> Transform:
        return about(transposed(tilting(self.angles)), self.center)


class Bow(NamedTuple):
    """An arc in space, and the line after it."""

    end: Place
    center: Point  # along u and v
    turns: int
    rest: Place | None  # where the line leads, if there is one
    length: float  # mm of both


class Frame:
    """Scaling, then rotation; at least one of them."""

    def __init__(self, scaling: Scaling | None, rotation: Rotation | None) -> None:
        self.scaling = scaling
        self.rotation = rotation
        self.turn = IDENTITY if rotation is None else rotation.forth()
        self.forth = self.turn if scaling is None else then(scaling.forth(), self.turn)
        unturn = IDENTITY if rotation is None else rotation.back()
        self.back = unturn if scaling is None else then(unturn, scaling.back())

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Frame) and (self.scaling, self.rotation) == (other.scaling, other.rotation)

    @property
    def tilted(self) -> bool:
        return self.rotation is not None and self.rotation.plane is None

    def to_space(self, place: Place) -> Place:
        """Of a point with the offsets added."""
        return [*self.forth(*place[:3]), *place[3:]]

    def to_program(self, place: Place) -> Place:
        """Its inverse."""
        return [*self.back(*place[:3]), *place[3:]]

    def mirrors(self, plane: int) -> bool:
        """Whether left and right change sides in a plane."""
        u, v, _ = PLANE_AXES[plane]
        return self.scaling is not None and self.scaling.factors[u] * self.scaling.factors[v] < 0.0

    def bow(self, plane: int, start: Place, end: Place, center: Point, turns: int, radius: float | None) -> Bow:
        """What becomes of an arc that has the offsets added. radius: its R word, mm."""
        u, v, w = PLANE_AXES[plane]
        arc = Arc((start[u], start[v]), (end[u], end[v]), center, turns)
        rest: Point | None = None
        goal, rise = list(end), end[w] - start[w]
        if self.scaling is not None:
            factors, middle = self.scaling.factors, self.scaling.center
            arc, rest = scaled_arc(arc, (factors[u], factors[v]), (middle[u], middle[v]), radius)
            goal[w] = middle[w] + factors[w] * (goal[w] - middle[w])
            rise *= factors[w]
        reach = hypot(arc.start[0] - arc.center[0], arc.start[1] - arc.center[1])
        length = hypot(reach * sweep(*arc), rise)

        def turned(point: Point) -> Place:
            goal[u], goal[v] = point
            return [*self.turn(*goal[:3]), *goal[3:]]

        middle_turned = turned(arc.center)
        made = Bow(turned(arc.end), (middle_turned[u], middle_turned[v]), arc.turns, None, length)
        if rest is None:
            return made
        return made._replace(rest=turned(rest), length=length + hypot(rest[0] - arc.end[0], rest[1] - arc.end[1]))
