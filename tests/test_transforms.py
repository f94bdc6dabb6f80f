"""Scaling, rotation and tilt: matrices composed independently, arcs by their points."""

from __future__ import annotations

from math import atan2, cos, hypot, pi, radians, sin

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from aircut.geometry import transforms
from aircut.geometry.arcs import sweep
from aircut.geometry.transforms import Arc, Transform, scaled_arc

patient = settings(deadline=None, suppress_health_check=[HealthCheck.too_slow])
numbers = st.floats(-1000.0, 1000.0)
angles = st.floats(-720.0, 720.0)
factors = st.floats(0.01, 100.0) | st.floats(-100.0, -0.01)
vectors = st.tuples(numbers, numbers, numbers)


def rotation(axis: int, degrees: float) -> np.ndarray:
    """By Rodrigues's formula."""
    k = np.zeros((3, 3))
    n = np.eye(3)[axis]
    k[0, 1], k[0, 2], k[1, 0], k[1, 2], k[2, 0], k[2, 1] = -n[2], n[1], n[2], -n[0], -n[1], n[0]
    a = radians(degrees)
    return np.eye(3) + sin(a) * k + (1.0 - cos(a)) * (k @ k)


@patient
@given(st.integers(0, 2), angles)
def test_turning(axis: int, angle: float) -> None:
    np.testing.assert_allclose(transforms.turning(axis, angle), rotation(axis, angle), atol=1e-12)


def test_quarter_turns_are_exact() -> None:
    assert Transform(transforms.turning(2, 90.0), (0.0, 0.0, 0.0))(3.0, 4.0, 5.0) == (-4.0, 3.0, 5.0)
    assert transforms.turning(1, -360.0) == transforms.IDENTITY.matrix


@patient
@given(st.tuples(angles, angles, angles), vectors, vectors)
def test_tilting_turns_about_x_then_y_then_z(turns: tuple[float, float, float], center: tuple, place: tuple) -> None:
    made = transforms.about(transforms.tilting(turns), center)(*place)
    moved = np.array(place) - center
    for axis in range(3):
        moved = rotation(axis, turns[axis]) @ moved
    np.testing.assert_allclose(made, moved + center, atol=1e-9)


@patient
@given(st.tuples(factors, factors, factors), vectors, vectors)
def test_scaling_about_a_center(scale: tuple, center: tuple, place: tuple) -> None:
    made = transforms.scaling(scale, center)(*place)
    wanted = [c + s * (p - c) for c, s, p in zip(center, scale, place, strict=True)]
    assert made == pytest.approx(wanted, abs=1e-9 * 1e5)


@patient
@given(st.tuples(factors, factors, factors), vectors, st.tuples(angles, angles, angles), vectors, vectors)
def test_a_chain_and_the_chain_of_inverses(scale: tuple, a: tuple, turns: tuple, b: tuple, place: tuple) -> None:
    matrix = transforms.tilting(turns)
    forth = transforms.then(transforms.scaling(scale, a), transforms.about(matrix, b))
    inverse = tuple(1.0 / factor for factor in scale)
    back = transforms.then(transforms.about(transforms.transposed(matrix), b), transforms.scaling(inverse, a))
    assert back(*forth(*place)) == pytest.approx(place, abs=1e-6)
    direct = transforms.about(matrix, b)(*transforms.scaling(scale, a)(*place))
    assert forth(*place) == pytest.approx(direct, abs=1e-6)


def points(arc: Arc, count: int = 24) -> list[tuple[float, float]]:
    """Along an arc."""
    swept = sweep(arc.start, arc.end, arc.center, arc.turns)
    radius = hypot(arc.start[0] - arc.center[0], arc.start[1] - arc.center[1])
    first = atan2(arc.start[1] - arc.center[1], arc.start[0] - arc.center[0])
    steps = [first + swept * i / count for i in range(count + 1)]
    return [(arc.center[0] + radius * cos(a), arc.center[1] + radius * sin(a)) for a in steps]


def arc_of(center: tuple, radius: float, first: float, swept: float) -> Arc:
    start = center[0] + radius * cos(first), center[1] + radius * sin(first)
    end = center[0] + radius * cos(first + swept), center[1] + radius * sin(first + swept)
    return Arc(start, end, center, 1 if swept > 0 else -1)


sweeps = st.floats(0.01, 2 * pi - 0.01) | st.floats(0.01 - 2 * pi, -0.01)
planar = st.tuples(numbers, numbers)


@patient
@given(planar, st.floats(0.1, 100.0), st.floats(-pi, pi), sweeps, st.floats(0.1, 10.0),
       st.sampled_from([1, -1]), st.sampled_from([1, -1]), planar)  # fmt: skip
def test_an_arc_scaled_evenly_is_the_image_of_its_points(
    center: tuple, radius: float, first: float, swept: float, scale: float, sign_u: int, sign_v: int, middle: tuple
) -> None:
    arc = arc_of(center, radius, first, swept)
    fu, fv = scale * sign_u, scale * sign_v
    made, rest = scaled_arc(arc, (fu, fv), middle, None)
    assert rest is None
    image = [(middle[0] + fu * (u - middle[0]), middle[1] + fv * (v - middle[1])) for u, v in points(arc)]
    np.testing.assert_allclose(points(made), image, atol=1e-6)


@patient
@given(planar, st.floats(0.1, 100.0), st.floats(-pi, pi), sweeps, factors, factors, planar)
def test_an_arc_scaled_unevenly_ends_in_the_direction_of_the_scaled_end(
    center: tuple, radius: float, first: float, swept: float, fu: float, fv: float, middle: tuple
) -> None:
    made, rest = scaled_arc(arc_of(center, radius, first, swept), (fu, fv), middle, None)
    end = rest or made.end
    to_end = np.array(end) - made.center
    to_last = np.array(made.end) - made.center
    across = to_end[0] * to_last[1] - to_end[1] * to_last[0]
    assert across == pytest.approx(0.0, abs=1e-6 * np.linalg.norm(to_end) * np.linalg.norm(to_last))
    assert to_end @ to_last > 0.0
    start = np.array(made.start) - made.center
    if rest is not None:
        assert np.hypot(*start) == pytest.approx(np.hypot(*to_last))
        assert np.hypot(*(to_end - to_last)) > 0.5e-4
    else:
        assert np.hypot(*start) == pytest.approx(np.hypot(*to_last), abs=1.1e-4)


@patient
@given(planar, st.floats(1.0, 100.0), st.floats(-pi, pi), sweeps, factors, factors, planar)
def test_an_arc_by_radius_has_the_larger_factor_of_its_radius(
    center: tuple, radius: float, first: float, swept: float, fu: float, fv: float, middle: tuple
) -> None:
    arc = arc_of(center, radius, first, swept)
    word = radius if abs(swept) <= pi else -radius
    made, rest = scaled_arc(arc, (fu, fv), middle, word)
    assert rest is None
    larger = max(abs(fu), abs(fv))
    half = hypot(made.end[0] - made.start[0], made.end[1] - made.start[1]) / 2
    wanted = max(radius * larger, half)
    for end in (made.start, made.end):
        reach = hypot(end[0] - made.center[0], end[1] - made.center[1])
        assert reach == pytest.approx(wanted, rel=1e-6, abs=1e-6)
    if abs(abs(swept) - pi) > 0.1 and half < 0.999 * wanted:
        assert (abs(sweep(*made)) > pi) == (abs(swept) > pi)


@pytest.mark.parametrize(("gap", "line"), [(0.9e-4, False), (1.1e-4, True)])
def test_a_gap_of_a_tenth_of_a_micrometer_is_none(gap: float, line: bool) -> None:
    """A quarter circle of radius 10, its second axis stretched until its ends differ by the gap."""
    arc = Arc((10.0, 0.0), (0.0, 10.0), (0.0, 0.0), 1)
    made, rest = scaled_arc(arc, (1.0, 1.0 + gap / 10.0), (0.0, 0.0), None)
    assert (rest is not None) == line
    assert made.end == pytest.approx((0.0, 10.0) if line else (0.0, 10.0 + gap))
