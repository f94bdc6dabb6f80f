"""Five-axis kinematics: from the tool's tip on the part to the machine's axes, and back.

Two rotary axes turn, one carried by the other: `outer` stands on the machine, `inner`
on it. On a table both turn the part, on a head both turn the tool. Matrices turn
right-handed; an axis of inverse convention has its angle negated.

    table   axes = D + Ro·(Ri·w - D) + L
    head    axes = w - Ro·(H + Ri·(J - L)) + (H + J)

w: the tip in the part's frame, which is the machine's with the rotary axes at 0.
L: the tool's offset. D, H, J: of the machine. All mm, angles degrees.

Every pose can be reached: programs say the angles, so there is no choice of branches
and no singularity. What can fail is the travel of an axis.

Functions take six numbers or six arrays, which may be mixed.

Source: 000 section 12.2, decisions AMB-RTCP-1, AMB-RTCP-4, AMB-RTCP-7.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, NamedTuple

if TYPE_CHECKING:
    from numpy.typing import NDArray

Numbers = Any  # a float, or an array of them
Point = tuple[Numbers, Numbers, Numbers]
Three = Any  # three of them: a sequence, or the rows of an array

X, Y, Z = range(3)
HALF_TURN = 180.0


class Model(NamedTuple):
    """A kind of machine: which axes turn, and what."""

    name: str
    head: bool  # the tool turns; else the part
    outer: int  # X, Y or Z: the line that the outer axis turns about; A is X, B is Y, C is Z
    inner: int

    @property
    def axes(self) -> tuple[int, int]:
        """Letters of the outer and the inner axis, as their places among A B C."""
        return self.outer, self.inner


#: By the number that programs read; 0 and 1 have no kinematics.
MODELS = {
    2: Model("rotary_table_ac", False, X, Z),
    3: Model("rotary_table_bc", False, Y, Z),
    4: Model("tilting_spindle_ca", True, Z, X),
    5: Model("tilting_spindle_ab", True, X, Y),
}


class Setup(NamedTuple):
    """A machine with a tool: all that the functions below need. Lengths mm."""

    model: int  # key of MODELS; 0: no tool center point control
    tool_x: float = 0.0  # L
    tool_y: float = 0.0
    tool_z: float = 0.0
    d_x: float = 0.0  # between the centers of rotation of a table
    d_y: float = 0.0
    d_z: float = 0.0
    h_x: float = 0.0  # between the centers of rotation of a head
    h_y: float = 0.0
    h_z: float = 0.0
    j_x: float = 0.0  # from the inner center of rotation to the tool holder
    j_y: float = 0.0
    j_z: float = 0.0
    sign_a: float = 1.0  # -1: the axis turns left-handed
    sign_b: float = 1.0
    sign_c: float = 1.0

    @property
    def tool(self) -> tuple[float, float, float]:
        return self[1:4]

    @property
    def d(self) -> tuple[float, float, float]:
        return self[4:7]

    @property
    def h(self) -> tuple[float, float, float]:
        return self[7:10]

    @property
    def j(self) -> tuple[float, float, float]:
        return self[10:13]

    @property
    def signs(self) -> tuple[float, float, float]:
        return self[13:16]


def turn(about: int, cosine: Numbers, sine: Numbers, point: Three) -> Point:
    """A point turned right-handed about X, Y or Z."""
    x, y, z = point
    if about == X:
        return x, cosine * y - sine * z, sine * y + cosine * z
    if about == Y:
        return sine * z + cosine * x, y, cosine * z - sine * x
    return cosine * x - sine * y, sine * x + cosine * y, z


def circular(setup: Setup, angles: Three) -> tuple[Numbers, Numbers, Numbers, Numbers]:
    """Cosine and sine of the outer angle, then of the inner one. angles: A, B, C, degrees."""
    found: list[Numbers] = []
    for axis in MODELS[setup.model].axes:
        angle = angles[axis] * (setup.signs[axis] * math.pi / HALF_TURN)
        if isinstance(angle, float):
            found += (math.cos(angle), math.sin(angle))
        else:
            import numpy as np

            found += (np.cos(angle), np.sin(angle))
    return found[0], found[1], found[2], found[3]


def plus(a: Three, b: Three) -> Point:
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


def minus(a: Three, b: Three) -> Point:
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


def inverse(setup: Setup, tip: Three, angles: Three) -> Point:
    """Positions of X, Y and Z, the tool's offset included, that put the tip there. angles: A, B, C."""
    model = MODELS[setup.model]
    co, so, ci, si = circular(setup, angles)
    if model.head:
        arm = turn(model.inner, ci, si, minus(setup.j, setup.tool))
        pivot = turn(model.outer, co, so, plus(setup.h, arm))
        return plus(minus(tip, pivot), plus(setup.h, setup.j))
    part = turn(model.inner, ci, si, tip)
    return plus(plus(turn(model.outer, co, so, minus(part, setup.d)), setup.d), setup.tool)


def forward(setup: Setup, axes: Three, angles: Three) -> Point:
    """Where the tip is on the part when X, Y and Z (tool's offset included) and A, B, C stand so."""
    model = MODELS[setup.model]
    co, so, ci, si = circular(setup, angles)
    if model.head:
        arm = turn(model.inner, ci, si, minus(setup.j, setup.tool))
        pivot = turn(model.outer, co, so, plus(setup.h, arm))
        return plus(minus(axes, plus(setup.h, setup.j)), pivot)
    table = minus(minus(axes, setup.tool), setup.d)
    return turn(model.inner, ci, -si, plus(turn(model.outer, co, -so, table), setup.d))


def direction(setup: Setup, angles: Three) -> Point:
    """The tool's axis in the part's frame, from the tip to the holder: a unit vector."""
    model = MODELS[setup.model]
    co, so, ci, si = circular(setup, angles)
    up = (0.0, 0.0, 1.0)
    if model.head:
        return turn(model.outer, co, so, turn(model.inner, ci, si, up))
    return turn(model.inner, ci, -si, turn(model.outer, co, -so, up))


class Sweep(NamedTuple):
    """What bounds the way of a tip: in s from 0 to 1 along the move, mm."""

    speed: float  # |w'| at most
    bend: float  # |w''| at most: 0 for lines
    radius: float  # distance from the Z axis at most
    height: float  # |z - d_z| at most


def straight(setup: Setup, start: Three, end: Three) -> Sweep:
    """Of a line."""
    return Sweep(
        math.hypot(end[0] - start[0], end[1] - start[1], end[2] - start[2]),
        0.0,
        max(math.hypot(start[0], start[1]), math.hypot(end[0], end[1])),
        max(abs(start[2] - setup.d_z), abs(end[2] - setup.d_z)),
    )


def pieces(setup: Setup, sweep: Sweep, first: Three, last: Three, tolerance: float) -> float:
    """Into how many equal pieces to cut a move so that straight motion of the axes keeps the tip on its way.

    first, last: A, B, C at its ends, degrees. tolerance: mm. Returns a whole number from 1.

    The angles are linear in s, q(s) are the exact positions of the axes. Between two of them
    the axes move straight, and forward kinematics at given angles keeps distances: so the
    tip errs by as much as the axes do. A chord errs by |q''|/8 at most, a piece of n by |q''|/8n².
    With the angles' spans o (outer) and i (inner), radians, both not negative:
    table: |q''| ≤ o²·|Ri·w - D| + 2o(i·r + |w'|) + i²·r + 2i·|w'| + |w''|, r the tip's distance from Z;
    head: |q''| ≤ o²(|H| + |K|) + 2oi·|K| + i²·|K| + |w''|, K = J - L, where H and K do not count
    along the outer and the inner axis: no turn about those moves what lies on them.
    """
    model = MODELS[setup.model]
    o, i = (abs(last[axis] - first[axis]) * (math.pi / HALF_TURN) for axis in model.axes)
    bend = sweep.bend
    if o or i:
        if model.head:
            arm = minus(setup.j, setup.tool)
            across = math.hypot(*(arm[axis] for axis in range(3) if axis != model.inner))
            reach = math.hypot(*(setup.h[axis] for axis in range(3) if axis != model.outer)) + math.hypot(*arm)
            bend += o * o * reach + 2.0 * o * i * across + i * i * across
        else:  # all tables have C within
            reach = math.hypot(sweep.radius + math.hypot(setup.d_x, setup.d_y), sweep.height)
            bend += o * o * reach + 2.0 * o * (i * sweep.radius + sweep.speed)
            bend += i * i * sweep.radius + 2.0 * i * sweep.speed
    return max(1.0, math.ceil(math.sqrt(bend / (8.0 * tolerance))))


def array_of(points: Three) -> NDArray[Any]:
    """Three columns as an array of points, (n, 3)."""
    import numpy as np

    return np.stack(np.broadcast_arrays(*points), axis=-1)
