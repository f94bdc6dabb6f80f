"""Polylines lie on the arcs they stand for, and every move ends exactly where it ends."""

from math import cos, hypot, pi, sin, tau

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from aircut.canon import ROW, Kind, Toolpath
from aircut.geometry import arcs
from aircut.geometry.polylines import FINEST, polyline


def row(xyz, uv=(0.0, 0.0), turns=0, kind=Kind.FEED, plane=0, abc=(0.0, 0.0, 0.0)):
    return ROW.pack(*xyz, *abc, *uv, 100.0, 1, 1, turns, 0, kind, plane, 0)


def path(*rows, start=(0.0,) * 6):
    return Toolpath.of_rows([b"".join(rows)], start)


def helix(plane, center, radius, first, swept, turns, rise, low=0.0):
    """A path of one arc: `swept` radians from the angle `first`, in the plane's own axes."""
    u, v, w = arcs.PLANE_AXES[plane]
    start, end = [0.0] * 6, [0.0] * 3
    start[u], start[v] = center[0] + radius * cos(first), center[1] + radius * sin(first)
    end[u], end[v] = center[0] + radius * cos(first + swept), center[1] + radius * sin(first + swept)
    start[w], end[w] = low, low + rise
    return path(row(end, center, turns, Kind.ARC, plane), start=start)


def test_lines_give_one_point_each():
    points, move = polyline(path(row((1, 0, 0)), row((1, 2, 0), kind=Kind.TRAVERSE), row((1, 2, -3))))
    assert points.tolist() == [[0, 0, 0], [1, 0, 0], [1, 2, 0], [1, 2, -3]]
    assert move.tolist() == [-1, 0, 1, 2]


def test_no_moves_leave_the_start():
    points, move = polyline(path(start=(1, 2, 3, 0, 0, 0)))
    assert points.tolist() == [[1, 2, 3]]
    assert move.tolist() == [-1]


def test_rotary_moves_stay_in_place():
    points, move = polyline(path(row((1, 0, 0)), row((1, 0, 0), abc=(90, 0, 0))))
    assert points.tolist() == [[0, 0, 0], [1, 0, 0], [1, 0, 0]]
    assert move.tolist() == [-1, 0, 1]


@given(
    plane=st.sampled_from((0, 1, 2)),
    center=st.tuples(st.floats(-500, 500), st.floats(-500, 500)),
    radius=st.floats(0.001, 2000),
    first=st.floats(-pi, pi),
    swept=st.floats(0.01, tau),
    turns=st.sampled_from((1, -1, 2, -3)),
    rise=st.floats(-50, 50),
    tolerance=st.floats(0.001, 0.5),
)
def test_points_lie_on_the_helix(plane, center, radius, first, swept, turns, rise, tolerance):
    sign = 1 if turns > 0 else -1
    toolpath = helix(plane, center, radius, first, sign * swept, turns, rise)
    points, move = polyline(toolpath, tolerance)
    axes = list(arcs.PLANE_AXES[plane])
    local = points[:, axes]
    assert points[-1].tolist() == [toolpath.x[0], toolpath.y[0], toolpath.z[0]]
    assert (move[1:] == 0).all()

    ((_, _, start, end, middle),) = toolpath.arcs()
    total = arcs.sweeps(start[:, :2], end[:, :2], middle[:, :2], toolpath.turns)[0]
    away = np.hypot(local[:, 0] - center[0], local[:, 1] - center[1])
    assert np.allclose(away, radius, rtol=1e-9, atol=1e-9)
    # Angle and height go together, in equal steps.
    part = np.linspace(0, 1, len(points))
    assert np.allclose(local[:, 2], rise * part, atol=1e-9)
    angle = first + total * part
    assert np.allclose(local[:, 0], center[0] + radius * np.cos(angle), rtol=0, atol=1e-6 * max(radius, 1))
    assert np.allclose(local[:, 1], center[1] + radius * np.sin(angle), rtol=0, atol=1e-6 * max(radius, 1))
    # The middle of a chord is where it strays farthest.
    chord = abs(total) / (len(points) - 1)
    if chord > FINEST:
        assert radius * (1 - cos(min(chord, pi) / 2)) <= tolerance * (1 + 1e-6) + 1e-12
    assert len(points) <= 2 + abs(total) / tau * 4096


def test_full_circle_and_many_turns():
    points, _ = polyline(helix(0, (0, 0), 10, 0, tau, 1, 0))
    assert len(points) > 60
    assert sum(hypot(*step) for step in np.diff(points[:, :2], axis=0)) == pytest.approx(10 * tau, rel=1e-3)
    many, _ = polyline(helix(0, (0, 0), 10, 0, tau, 5, -5))
    assert len(many) == pytest.approx(5 * len(points), abs=10)


def test_spiral_between_two_radii():
    points, _ = polyline(path(row((-12, 0, 0), (-1, 0), 1, Kind.ARC), start=(9, 0, 0, 0, 0, 0)))
    away = np.hypot(points[:, 0] + 1, points[:, 1])
    assert (np.diff(away) > 0).all()
    assert points[-1].tolist() == [-12, 0, 0]


def test_arc_without_turns_or_radius_is_harmless():
    points, _ = polyline(path(row((5, 0, 0), (1, 0), 0, Kind.ARC), row((5, 0, 0), (5, 0), 1, Kind.ARC)))
    assert np.isfinite(points).all()
    assert points[-1].tolist() == [5, 0, 0]


def test_points_are_bounded_on_request():
    rows = [row((0, 0, 0), (100, 0), 1, Kind.ARC)] * 50
    free, _ = polyline(path(*rows))
    bound, move = polyline(path(*rows), max_points=1000)
    assert len(free) > 5000
    assert 500 < len(bound) <= 1000
    assert set(move.tolist()) == set(range(-1, 50))
    least, _ = polyline(path(*rows), max_points=3)
    assert len(least) == 51


def test_planes_turn_the_right_way():
    # G18 G3 turns from Z towards X, G19 G3 from Y towards Z.
    for plane in range(3):
        u, v, _ = arcs.PLANE_AXES[plane]
        points, _ = polyline(helix(plane, (0, 0), 1, 0, tau / 4, 1, 0))
        middle = points[len(points) // 2]
        assert middle[u] > 0 and middle[v] > 0
        assert hypot(middle[u], middle[v]) == pytest.approx(1)
        assert points[0][u] == pytest.approx(1) and points[-1][v] == pytest.approx(1)
