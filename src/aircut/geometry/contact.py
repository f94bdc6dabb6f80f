"""First contact: where a ball that moves along a straight line touches a body, and where it leaves it.

The ball is a probe's tip; a radius of 0 makes it a point. Bodies are solid. A ball touches a body
when the gap between them is at most `SKIN`, tangent balls and balls inside included. A way to
a body ends at the gap 0, and a way from it at the gap `CLEAR`, more than the skin, so that
rounding cannot undo the answer: the ball touches at the position that `touch` returns, and does not
at the one that `clear` returns. Both are within 1e-9 mm of the body grown by the ball.

The distance to a convex body is a convex function of the way. So Newton's steps from the start
come up to the first contact and never pass it; see `approach`. It needs a body's excess alone:
the vector from the body's nearest point to the ball's center.

Vectors: x, y, z in mm. Errors: 1e-11 mm between ball and body for moves up to 1e4 mm, rims of
cylinders included; along the way, that over the cosine between the move and the contact's normal.
"""

from __future__ import annotations

from array import array
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import dist, hypot, isfinite
from typing import Any, Protocol, TypeAlias

from aircut.kernels import mesh as kernel

Vector: TypeAlias = tuple[float, float, float]
Numbers: TypeAlias = Sequence[float]
Excess: TypeAlias = Callable[[Vector], Vector]

SKIN = 4e-10  # mm: a smaller gap is contact
CLEAR = 6e-10  # mm: the gap after leaving a body
INNER_SKIN = 0.875 * SKIN  # mm: a ball that comes this near on its way is sure to be found
LAST_STEP = 1e-13  # mm: a shorter step is noise
SLIDE = 1e-3  # mm: how far a ball may move on in the skin to meet the body itself
TRIES = 200  # Newton's steps; 70 suffice but for noise
ORTHONORMAL = 1e-9  # a rotation matrix may be this much off in each product of its rows
ROOM = 1024  # spans of a sweep before it asks for more


class Shape(Protocol):
    """A body that balls can touch."""

    def touches(self, point: Numbers, radius: float) -> bool:
        """Whether a ball of this radius (mm) at this point (mm) touches the body or is inside."""

    def touch(self, start: Numbers, end: Numbers, radius: float) -> float | None:
        """Part of the way, 0 to 1, at the first contact; 0.0 if the ball touches at the start.

        start, end: mm, of the ball's center; they may be equal. radius: mm, from 0.
        Returns None without contact.
        """

    def clear(self, start: Numbers, end: Numbers, radius: float) -> float | None:
        """Part of the way, 0 to 1, at the first position without contact; 0.0 if that is the start.

        start, end: mm, of the ball's center; they may be equal. radius: mm, from 0.
        Returns None where contact persists to the end.
        """


def vector(values: Numbers) -> Vector:
    """Three finite numbers, of a tuple, list or array. Raises ValueError."""
    x, y, z = (float(value) for value in values)
    if not (isfinite(x) and isfinite(y) and isfinite(z)):
        raise ValueError(f"not finite: {values}")
    return x, y, z


def along(start: Vector, move: Vector, part: float) -> Vector:
    """The point after this part of a move, mm."""
    return start[0] + part * move[0], start[1] + part * move[1], start[2] + part * move[2]


def between(start: Vector, end: Vector) -> Vector:
    """The move from start to end, mm."""
    return end[0] - start[0], end[1] - start[1], end[2] - start[2]


def approach(excess: Excess, start: Vector, move: Vector, radius: float) -> float | None:
    """Part of a move at which a convex body comes within a radius; None if it never does.

    excess: the vector from the body's nearest point to a point, mm; zero inside.
    The gap is a convex function of the way, so a tangent to its graph lies below it: a step to the
    tangent's zero cannot pass the gap's own. Every step shrinks gap times slope at least fourfold,
    so the steps end, first in the skin (aimed at INNER_SKIN, or they would creep up to it by last
    bits) and then where the gap is 0. A ball that comes into the skin and no nearer grazes the
    body, where the gap stops falling. But a ball that slides on in the skin for more than SLIDE
    before that is in contact from where it came in.
    """
    length = hypot(*move)
    part = 0.0
    entered = falling = None
    for _ in range(TRIES):
        away = excess(along(start, move, part))
        distance = hypot(*away)
        gap = distance - radius
        if gap <= 0.0 or (part == 0.0 and gap <= SKIN):
            break
        if gap <= SKIN and entered is None:
            entered = part
        # Divided before it is looked at: the smallest of slopes becomes 0 by it.
        slope = (away[0] * move[0] + away[1] * move[1] + away[2] * move[2]) / distance
        if slope >= 0.0:
            if entered is None:
                return None
            if falling is not None:
                part = bottom(excess, start, move, radius, falling, part)
            break
        if part == 1.0:
            break
        if entered is not None:
            falling = part
        aim = INNER_SKIN if gap > SKIN else 0.0
        following = min(part - (gap - aim) / slope, 1.0)
        if (following - part) * length < LAST_STEP:
            break
        part = following
    if entered is None and gap > SKIN:
        return None
    if entered is not None and (part - entered) * length > SLIDE:
        return entered
    return part


def bottom(excess: Excess, start: Vector, move: Vector, radius: float, falling: float, rising: float) -> float:
    """Part of a move, between these two, from which a convex body comes no nearer, or is within the radius."""
    while True:
        part = (falling + rising) / 2
        if not falling < part < rising:
            return rising
        away = excess(along(start, move, part))
        if hypot(*away) <= radius or away[0] * move[0] + away[1] * move[1] + away[2] * move[2] >= 0.0:
            rising = part
        else:
            falling = part


class Convex:
    """The three questions, for a body that knows its excess."""

    def excess(self, point: Vector) -> Vector:
        """The vector from the body's nearest point to this one, mm; zero inside."""
        raise NotImplementedError

    def touches(self, point: Numbers, radius: float) -> bool:
        """See Shape."""
        return hypot(*self.excess(vector(point))) - radius <= SKIN

    def touch(self, start: Numbers, end: Numbers, radius: float) -> float | None:
        """See Shape."""
        first, last = vector(start), vector(end)
        return approach(self.excess, first, between(first, last), radius)

    def clear(self, start: Numbers, end: Numbers, radius: float) -> float | None:
        """See Shape. All contact is one stretch of the way, so it ends where the way back meets it."""
        first, last = vector(start), vector(end)
        if not self.touches(first, radius):
            return 0.0
        if self.touches(last, radius):
            return None
        back = approach(self.excess, last, between(last, first), radius + CLEAR)
        return 1.0 if back is None else 1.0 - back


@dataclass(frozen=True)
class Box(Convex):
    """A box along the axes, from its low to its high corner, mm. Raises ValueError if low is above high."""

    low: Numbers
    high: Numbers

    def __post_init__(self) -> None:
        object.__setattr__(self, "low", vector(self.low))
        object.__setattr__(self, "high", vector(self.high))
        if any(low > high for low, high in zip(self.low, self.high, strict=True)):
            raise ValueError(f"a box from {self.low} to {self.high} is inside out")

    def excess(self, point: Vector) -> Vector:
        """See Convex."""
        (x, y, z), (lx, ly, lz), (hx, hy, hz) = point, self.low, self.high
        return x - min(max(x, lx), hx), y - min(max(y, ly), hy), z - min(max(z, lz), hz)


@dataclass(frozen=True)
class Sphere(Convex):
    """A solid sphere. center, radius: mm. Raises ValueError for a negative radius."""

    center: Numbers
    radius: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "center", vector(self.center))
        if not 0.0 <= self.radius < float("inf"):
            raise ValueError(f"a sphere's radius cannot be {self.radius}")

    def excess(self, point: Vector) -> Vector:
        """See Convex."""
        x, y, z = point[0] - self.center[0], point[1] - self.center[1], point[2] - self.center[2]
        distance = hypot(x, y, z)
        if distance <= self.radius:
            return 0.0, 0.0, 0.0
        part = (distance - self.radius) / distance
        return part * x, part * y, part * z


@dataclass(frozen=True)
class Cylinder(Convex):
    """A solid cylinder with flat caps.

    base: mm, the center of the first cap. axis: from there to the other cap, of any length but 0.
    radius, height: mm. Raises ValueError for what makes no cylinder.
    """

    base: Numbers
    axis: Numbers
    radius: float
    height: float

    def __post_init__(self) -> None:
        x, y, z = vector(self.axis)
        length = hypot(x, y, z)
        if length == 0.0:
            raise ValueError("a cylinder's axis has no direction")
        if not (0.0 <= self.radius < float("inf") and 0.0 <= self.height < float("inf")):
            raise ValueError(f"a cylinder cannot have radius {self.radius} and height {self.height}")
        object.__setattr__(self, "base", vector(self.base))
        object.__setattr__(self, "axis", (x / length, y / length, z / length))

    def excess(self, point: Vector) -> Vector:
        """See Convex. The nearest point is clamped along the axis and, apart from that, across it."""
        ax, ay, az = self.axis
        x, y, z = point[0] - self.base[0], point[1] - self.base[1], point[2] - self.base[2]
        up = x * ax + y * ay + z * az
        x, y, z = x - up * ax, y - up * ay, z - up * az
        out = hypot(x, y, z)
        beyond = up - min(max(up, 0.0), self.height)
        part = (out - self.radius) / out if out > self.radius else 0.0
        return part * x + beyond * ax, part * y + beyond * ay, part * z + beyond * az


class Mesh:
    """A body of triangles.

    triangles: (n, 3, 3) mm, corners by x, y, z, in any order and sense. Raises ValueError.
    closed: whether every edge belongs to an even number of triangles, by coordinates equal to the last
    bit. A closed mesh is solid. An open one is a sheet: only its surface touches.
    """

    def __init__(self, triangles: Any) -> None:
        import numpy as np

        corners = np.array(triangles, dtype=np.float64) + 0.0  # -0.0 is 0.0
        if corners.ndim != 3 or corners.shape[1:] != (3, 3) or not len(corners):
            raise ValueError(f"triangles of shape (n, 3, 3) make a mesh, not of {corners.shape}")
        if not np.isfinite(corners).all():
            raise ValueError("a mesh's corners must be finite")
        count = len(corners)
        order = array("i", range(count))
        bounds = array("d", bytes(8 * 12 * count))
        right, first, last = (array("i", bytes(4 * 2 * count)) for _ in range(3))
        flat = array("d", corners.tobytes())
        boxes = kernel.build(flat, order, bounds, right, first, last, scratch())
        flat = array("d", corners[np.frombuffer(order, dtype=np.intc)].tobytes())
        self._tree = flat, bounds[: 6 * boxes], right[:boxes], first[:boxes], last[:boxes]
        self.closed = is_closed(corners)

    def __len__(self) -> int:
        """The number of triangles."""
        return len(self._tree[0]) // 9

    def touches(self, point: Numbers, radius: float) -> bool:
        """See Shape."""
        return self.touch(point, point, radius) is not None

    def touch(self, start: Numbers, end: Numbers, radius: float) -> float | None:
        """See Shape."""
        first, last = vector(start), vector(end)
        part = kernel.sweep(*self._tree, path(first, last), radius, SKIN, SLIDE, array("d"), scratch())
        if part > 0.0 and self.inside(first):
            return 0.0
        return part if part <= 1.0 else None

    def clear(self, start: Numbers, end: Numbers, radius: float) -> float | None:
        """See Shape. Contact may end and begin again: the first end that is not inside the body counts."""
        first, last = vector(start), vector(end)
        if not self.touches(first, radius):
            return 0.0
        move = between(first, last)
        at = 0.0
        for low, high in [*self._spans(first, last, radius + CLEAR), (1.0, 1.0)]:
            middle = along(first, move, (at + low) / 2)
            apart = low > at and dist(middle, along(first, move, at)) > SKIN
            if apart and not self.inside(middle):
                return at
            at = max(at, high)
        return None if self.touches(last, radius) else 1.0

    def inside(self, point: Numbers) -> bool:
        """Whether a point (mm) is inside a closed mesh; points on its surface may be either."""
        if not self.closed:
            return False
        at, stack = array("d", vector(point)), scratch()
        # Two rays of three outvote one that runs along a triangle.
        x, y = (kernel.crossings(*self._tree, at, axis, stack) % 2 for axis in (0, 1))
        return bool(x if x == y else kernel.crossings(*self._tree, at, 2, stack) % 2)

    def _spans(self, start: Vector, end: Vector, radius: float) -> list[tuple[float, float]]:
        """First and last contact with each triangle that is touched on the way, sorted."""
        room = ROOM
        while True:
            spans = array("d", bytes(16 * room))
            count = int(kernel.sweep(*self._tree, path(start, end), radius, SKIN, SLIDE, spans, scratch()))
            if count <= room:
                return sorted(zip(spans[: 2 * count : 2], spans[1 : 2 * count : 2], strict=True))
            room = count


def scratch() -> array[int]:
    """Working memory of a kernel's call."""
    return array("i", bytes(4 * kernel.STACK))


def path(start: Vector, end: Vector) -> array[float]:
    """A straight way as the kernel reads it."""
    return array("d", (*start, *between(start, end)))


def is_closed(corners: Any) -> bool:
    """Whether every edge of the triangles (n, 3, 3) belongs to an even number of them."""
    import numpy as np

    points = np.ascontiguousarray(corners.reshape(-1, 3)).view("V24").ravel()
    _, name = np.unique(points, return_inverse=True)
    names = name.reshape(-1, 3)
    edges = np.concatenate([names[:, [0, 1]], names[:, [1, 2]], names[:, [2, 0]]])
    edges = edges[edges[:, 0] != edges[:, 1]]
    edges.sort(axis=1)
    _, shared = np.unique(edges[:, 0] * len(points) + edges[:, 1], return_counts=True)
    return bool((shared % 2 == 0).all())


@dataclass(frozen=True)
class Union:
    """Several bodies as one; none touches nothing."""

    shapes: Sequence[Shape]

    def touches(self, point: Numbers, radius: float) -> bool:
        """See Shape."""
        return any(shape.touches(point, radius) for shape in self.shapes)

    def touch(self, start: Numbers, end: Numbers, radius: float) -> float | None:
        """See Shape."""
        parts = (shape.touch(start, end, radius) for shape in self.shapes)
        return min((part for part in parts if part is not None), default=None)

    def clear(self, start: Numbers, end: Numbers, radius: float) -> float | None:
        """See Shape. Each body that still touches moves the ball on, until none does."""
        first, last = vector(start), vector(end)
        move = between(first, last)
        part = 0.0
        while True:
            here = along(first, move, part)
            holds = next((shape for shape in self.shapes if shape.touches(here, radius)), None)
            if holds is None:
                return part
            further = holds.clear(here, last, radius)
            if further is None:
                return None
            following = part + further * (1.0 - part)
            if following <= part:
                return None
            part = following


class Placed:
    """A body turned about its own origin, then moved.

    translation: mm. rotation: (3, 3), columns are the body's axes as the machine sees them; a mirror is
    accepted. Raises ValueError where its rows are not orthonormal to 1e-9; what they are off
    scales the machine's coordinates.
    """

    def __init__(self, shape: Shape, translation: Numbers, rotation: Sequence[Numbers] | None = None) -> None:
        self.shape = shape
        self.translation = vector(translation)
        rows = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)) if rotation is None else rotation
        self.rotation = vector(rows[0]), vector(rows[1]), vector(rows[2])
        for i, row in enumerate(self.rotation):
            for j, other in enumerate(self.rotation):
                product = sum(a * b for a, b in zip(row, other, strict=True))
                if abs(product - (i == j)) > ORTHONORMAL:
                    raise ValueError(f"not a rotation: {rotation}")

    def local(self, point: Numbers) -> Vector:
        """A point of the machine (mm) as the body sees it: the inverse placement."""
        x, y, z = between(self.translation, vector(point))
        (ax, bx, cx), (ay, by, cy), (az, bz, cz) = self.rotation
        return ax * x + ay * y + az * z, bx * x + by * y + bz * z, cx * x + cy * y + cz * z

    def touches(self, point: Numbers, radius: float) -> bool:
        """See Shape."""
        return self.shape.touches(self.local(point), radius)

    def touch(self, start: Numbers, end: Numbers, radius: float) -> float | None:
        """See Shape."""
        return self.shape.touch(self.local(start), self.local(end), radius)

    def clear(self, start: Numbers, end: Numbers, radius: float) -> float | None:
        """See Shape."""
        return self.shape.clear(self.local(start), self.local(end), radius)
