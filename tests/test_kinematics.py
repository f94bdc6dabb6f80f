"""Five-axis kinematics against rotation matrices composed here, and against themselves."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from aircut.geometry.kinematics import MODELS, Setup, array_of, direction, forward, inverse, pieces, straight

LENGTH = st.floats(-2000.0, 2000.0)
SMALL = st.floats(-300.0, 300.0)
ANGLE = st.floats(-720.0, 720.0)
SIGN = st.sampled_from([1.0, -1.0])
POINT = st.tuples(LENGTH, LENGTH, LENGTH)
ANGLES = st.tuples(ANGLE, ANGLE, ANGLE)
SETUP = st.builds(Setup, st.sampled_from(sorted(MODELS)), *[SMALL] * 12, SIGN, SIGN, SIGN)
TOLERANCE = 0.01


def about(letter: str, angle: float) -> NDArray[np.float64]:
    """Rodrigues' matrix of a right-handed turn, degrees, about X (a), Y (b) or Z (c)."""
    k = np.eye(3)["abc".index(letter)]
    cross = np.array([[0, -k[2], k[1]], [k[2], 0, -k[0]], [-k[1], k[0], 0]])
    t = math.radians(angle)
    return np.eye(3) + math.sin(t) * cross + (1 - math.cos(t)) * (cross @ cross)


def composed(setup: Setup, tip: NDArray[np.float64], angles: dict[str, float]) -> NDArray[np.float64]:
    """The formulas of decision AMB-RTCP-1, letter by letter."""
    tool, d, h, j = (np.array(v) for v in (setup.tool, setup.d, setup.h, setup.j))
    a, b, c = (about(letter, sign * angles[letter]) for letter, sign in zip("abc", setup.signs, strict=True))
    if setup.model == 2:
        return d + a @ (c @ tip - d) + tool
    if setup.model == 3:
        return d + b @ (c @ tip - d) + tool
    if setup.model == 4:
        return tip - c @ (h + a @ (j - tool)) + (h + j)
    return tip - a @ (h + b @ (j - tool)) + (h + j)


@given(SETUP, POINT, ANGLES)
def test_forward_undoes_inverse(setup: Setup, tip: tuple[float, ...], angles: tuple[float, ...]) -> None:
    axes = inverse(setup, tip, angles)
    assert forward(setup, axes, angles) == pytest.approx(tip, abs=1e-9)
    assert inverse(setup, forward(setup, tip, angles), angles) == pytest.approx(tip, abs=1e-9)


@given(SETUP, POINT, ANGLES)
def test_agreement_with_matrices(setup: Setup, tip: tuple[float, ...], angles: tuple[float, ...]) -> None:
    axes = composed(setup, np.array(tip), dict(zip("abc", angles, strict=True)))
    assert inverse(setup, tip, angles) == pytest.approx(axes, abs=1e-9)


@given(SETUP, ANGLES)
def test_the_tools_axis_leads_from_the_tip_to_the_holder(setup: Setup, angles: tuple[float, ...]) -> None:
    """The axis is where the tip goes on the part when the tool is a millimeter shorter."""
    longer = setup._replace(tool_z=setup.tool_z + 1.0)
    axes = (10.0, 20.0, 30.0)
    tips = np.array([forward(s, axes, angles) for s in (setup, longer)])
    assert direction(setup, angles) == pytest.approx(tips[0] - tips[1], abs=1e-9)


def test_by_hand() -> None:
    """A table tilted by 90°: what was at +Y of its center is above it; C first, as it lies on A."""
    table = Setup(2, tool_z=50.0, d_z=-20.0)
    assert inverse(table, (0.0, 100.0, 0.0), (90.0, 0.0, 0.0)) == pytest.approx((0.0, -20.0, -20.0 + 100.0 + 50.0))
    assert inverse(table, (100.0, 0.0, 0.0), (90.0, 0.0, 90.0)) == pytest.approx((0.0, -20.0, 130.0))
    assert direction(table, (90.0, 0.0, 0.0)) == pytest.approx((0.0, 1.0, 0.0))
    """A head tilted by A90 points its tool to +Y: the holder goes to -Y of the tip by the tool's length
    beyond the pivot, and loses what it stood above."""
    head = Setup(4, tool_z=50.0, j_z=-100.0)  # the pivot 100 above the holder
    assert inverse(head, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)) == pytest.approx((0.0, 0.0, 50.0))
    assert inverse(head, (0.0, 0.0, 0.0), (90.0, 0.0, 0.0)) == pytest.approx((0.0, -150.0, -100.0))


@given(SETUP, st.integers(0, 2**32 - 1))
def test_arrays_and_numbers_agree(setup: Setup, seed: int) -> None:
    random = np.random.default_rng(seed)
    tips, angles = random.uniform(-500, 500, (20, 3)), random.uniform(-360, 360, (20, 3))
    axes = array_of(inverse(setup, tuple(tips.T), tuple(angles.T)))
    each = [inverse(setup, tip, pose) for tip, pose in zip(tips.tolist(), angles.tolist(), strict=True)]
    assert axes == pytest.approx(np.array(each))
    assert array_of(forward(setup, tuple(axes.T), tuple(angles.T))) == pytest.approx(tips, abs=1e-9)
    assert np.linalg.norm(array_of(direction(setup, tuple(angles.T))), axis=1) == pytest.approx(np.ones(20))


@given(SETUP, POINT, POINT, ANGLES, ANGLES)
def test_pieces_keep_the_tip_on_its_line(setup, start, end, first, last) -> None:  # type: ignore[no-untyped-def]
    """The bound is proven in `pieces`; here the worst of many points of each piece is looked at."""
    count = int(pieces(setup, straight(setup, start, end), first, last, TOLERANCE))
    at = np.linspace(0.0, 1.0, count + 1)
    which = np.unique(np.linspace(0, count - 1, 40).astype(int))
    for part in np.linspace(0.0, 1.0, 9):
        s = at[which] + part / count
        tip = np.array(start) + s[:, None] * (np.array(end) - start)
        angles = np.array(first) + s[:, None] * (np.array(last) - first)
        joints = [np.array(start) + u[:, None] * (np.array(end) - start) for u in (at[which], at[which + 1])]
        turns = [np.array(first) + u[:, None] * (np.array(last) - first) for u in (at[which], at[which + 1])]
        q = [array_of(inverse(setup, tuple(j.T), tuple(t.T))) for j, t in zip(joints, turns, strict=True)]
        given_tip = array_of(forward(setup, tuple((q[0] + part * (q[1] - q[0])).T), tuple(angles.T)))
        assert np.abs(np.linalg.norm(given_tip - tip, axis=1)).max() <= TOLERANCE * 1.0001


def test_pieces_are_not_wasted() -> None:
    """A table turning by 90° at radius 100: a chord's sagitta is r·δ²/8, so n = √(r·90°²/8t), rounded up."""
    table = Setup(2)
    still = straight(table, (100.0, 0.0, 0.0), (100.0, 0.0, 0.0))
    count = pieces(table, still, (0.0, 0.0, 0.0), (0.0, 0.0, 90.0), TOLERANCE)
    assert count == math.ceil(math.sqrt(100.0 * math.radians(90.0) ** 2 / 8 / TOLERANCE))
    moving = straight(table, (0.0, 0.0, 0.0), (900.0, 9.0, 9.0))
    assert pieces(table, moving, (9.0, 0.0, 9.0), (9.0, 0.0, 9.0), TOLERANCE) == 1
