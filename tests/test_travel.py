"""Limits of the axes: what they cost, what they let pass, and that a run stops at them."""

from __future__ import annotations

from math import cos, hypot, pi, sin

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import aircut
from aircut.geometry import arcs
from aircut.kernels import bounds, twin
from aircut.machine import built_in

patient = settings(deadline=None, suppress_health_check=[HealthCheck.too_slow])


def test_a_run_stops_before_the_line(tmp_path) -> None:
    program = aircut.loads("G0 X5\nG0 X10001\nG0 X7\nM2\n")
    result = program.run()
    assert [d.code for d in result.diagnostics] == ["travel-limit"]
    assert result.diagnostics[0].span.line == 2
    assert result.toolpath.x.tolist() == [5.0]


def test_a_fault_in_a_subroutine_has_its_place() -> None:
    found = aircut.loads("M98 P1\nM2\nO1\nG0 X0\nG1 F9 X-10001\nM99\n").check()
    told = next(d for d in found if d.code == "travel-limit")
    assert (told.span.line, told.span.column, told.stack[0].line) == (5, 7, 1)


def test_a_tool_offset_moves_the_box() -> None:
    """The tip may go lower by the tool's length: the axis counts."""
    tool = "G10 L1 P1 Z50\nG43 H1\nG0 Z{}\nM2\n"
    machine = built_in("XYZ")
    low = machine.axes["z"].min
    assert not [d for d in aircut.loads(tool.format(low - 50)).check(machine) if d.code == "travel-limit"]
    assert [d for d in aircut.loads(tool.format(low - 50.001)).check(machine) if d.code == "travel-limit"]
    assert [d for d in aircut.loads(tool.format(9950.001)).check(machine) if d.code == "travel-limit"]


def test_lines_of_the_linuxcnc_dialect_stop_too() -> None:
    program = aircut.loads("G21 G90 G0 X10001\nM2\n", "linuxcnc")
    result = program.run(built_in("XYZ"))
    assert [d.code for d in result.diagnostics] == ["travel-limit"]
    assert not len(result.toolpath)
    assert program.run().ok  # LinuxCNC's interpreter alone has no limits


@patient
@given(
    st.floats(-100, 100), st.floats(-100, 100), st.floats(0.01, 50), st.floats(-pi, pi), st.floats(-pi, pi),
    st.sampled_from([1, -1, 2, -2, 5]),
)  # fmt: skip
def test_reaches_of_an_arc_are_those_of_its_points(
    u: float, v: float, radius: float, first: float, last: float, turns: int
) -> None:
    start = u + radius * cos(first), v + radius * sin(first)
    end = u + radius * cos(last), v + radius * sin(last)
    low, high = arcs.reaches(start, end, (u, v), turns)
    swept = arcs.sweep(start, end, (u, v), turns)
    angles = first + np.linspace(0.0, swept, 2001)
    points = np.column_stack([u + radius * np.cos(angles), v + radius * np.sin(angles)])
    slack = radius * (abs(swept) / 2000) ** 2
    assert (points.min(axis=0) >= np.array(low) - 1e-9).all() and (points.max(axis=0) <= np.array(high) + 1e-9).all()
    assert (points.min(axis=0) <= np.array(low) + slack + 1e-9).all()
    assert (points.max(axis=0) >= np.array(high) - slack - 1e-9).all()


def test_reaches_agree_with_the_bounds_of_arrays() -> None:
    generator = np.random.default_rng(5)
    for _ in range(200):
        start, center = generator.uniform(-10, 10, (2, 2))
        radius, angle = hypot(*(start - center)), generator.uniform(0, 2 * pi)
        end = center + radius * np.array([cos(angle), sin(angle)])
        turns = int(generator.choice([1, -1, 3, -3]))
        low, high = arcs.bounds(start[None], end[None], center[None], np.array([turns]))
        made = arcs.reaches(tuple(start), tuple(end), tuple(center), turns)
        assert made[0] == pytest.approx(low[0]) and made[1] == pytest.approx(high[0])


def test_the_kernel_and_its_twin() -> None:
    python = twin("bounds", "bounds_twin")
    generator = np.random.default_rng(7)
    box = np.array([-1.0, 1.0] * 6)
    for _ in range(50):
        rows = generator.uniform(-1.01, 1.01, (20, bounds.STRIDE))
        outside = (np.abs(rows[:, :6]) > 1.0).any(axis=1)
        outside[:3] = False
        wanted = int(np.argmax(outside)) if outside.any() else 20
        for kernel in (bounds, python):
            assert kernel.outside(rows.ravel(), 3, 20, box) == wanted
