"""Random programs on the planner: sampled motion keeps all limits; times are never below what is possible."""

from __future__ import annotations

import math
import random
from itertools import pairwise

import numpy as np
import pytest
import ruckig

from aircut.kernels import lookahead, pieces, scurve, thin
from aircut.planner import Regime, limits, plan_moves
from aircut.planner.joints import bent, raised, steady
from planning import derivatives, machine, planned, toolpath

V, A = 100.0, 500.0  # mm/s, mm/s²
DT = 0.001  # s, the machine's cycle
SETTINGS = ("G61", "G61.1", "G64 P0", "G64 P0.001", "G64 P0.1", "G64 P10", "G64 P0.05 Q0.02", "F60", "F9000",
            "G103 V2000", "G103 V0", "G104 A100 D300", "G104 A0 D0", "G104 J50", "G4 P0.1")  # fmt: skip


def program(seed: int) -> str:
    """Lines and arcs, tangent or not, tiny to huge, some with rotary axes, in all modes."""
    r = random.Random(seed)
    lines = [f"G21 G90 G17 G94 F{r.choice([300, 3000, 30000])}"]
    x = y = z = 0.0
    scale = r.choice([0.01, 0.3, 3, 30, 300])
    heading = r.uniform(0, math.tau)
    for _ in range(r.randint(5, 60)):
        what = r.random()
        if what < 0.12:
            lines.append(r.choice(SETTINGS))
        elif what < 0.3:
            radius, swept, sign = r.uniform(0.2, 2) * scale, r.uniform(0.1, 6.2), r.choice([1, -1])
            start = heading - sign * math.pi / 2 if r.random() < 0.5 else r.uniform(0, math.tau)
            u, v = x - radius * math.cos(start), y - radius * math.sin(start)
            end = start + sign * swept
            more = ""
            if r.random() < 0.3:
                z += r.uniform(-1, 1) * scale
                more = f" Z{z:.6f}"
            if r.random() < 0.2:
                more += f" A{r.uniform(-20, 20):.5f}"
            code = "G3" if sign > 0 else "G2"
            lines.append(
                f"{code} X{u + radius * math.cos(end):.6f} Y{v + radius * math.sin(end):.6f} "
                f"I{u - x:.6f} J{v - y:.6f}{more}"
            )
            x, y, heading = u + radius * math.cos(end), v + radius * math.sin(end), end + sign * math.pi / 2
        else:
            heading += r.choice([0, r.gauss(0, 0.003), r.gauss(0, 0.05), r.gauss(0, 1)])
            length = abs(r.gauss(0, 1)) * scale * r.choice([1, 1, 0.01, 10])
            x, y = x + length * math.cos(heading), y + length * math.sin(heading)
            z += r.uniform(-1, 1) * scale if r.random() < 0.1 else 0.0
            rotary = f" A{r.uniform(-90, 90):.5f}" if r.random() < 0.15 else ""
            code = r.choices(["G0", "G9", "G1"], [15, 10, 75])[0]
            lines.append(f"{code} X{x:.6f} Y{y:.6f} Z{z:.6f}{rotary}")
    return "\n".join([*lines, "M2", ""])


@pytest.mark.parametrize("jerk", [0.0, 500.0, 5000.0, 100_000.0])
def test_sampled_motion_keeps_the_limits(jerk):
    on = machine(60 * V, A, jerk)
    checked = 0
    for seed in range(60):
        try:
            made = planned(program(seed), on)
        except AssertionError:
            continue  # an arc whose radii differ: the interpreter refuses it
        if made.duration > 100.0:
            continue
        velocity, acceleration, hardest = derivatives(made, DT)
        assert (velocity <= V * 1.001).all(), (seed, velocity)
        assert (acceleration <= A * 1.001).all(), (seed, acceleration)
        if jerk:
            assert (hardest <= jerk * 1.001 + 1e-3).all(), (seed, hardest)  # 1e-12 mm of rounding is 1e-3 mm/s³
        assert np.all(np.diff(made.times) >= 0)
        checked += 1
    assert checked > 40


@pytest.mark.parametrize("jerk", [0.0, 500.0, 5000.0, 100_000.0])
def test_it_does_so_however_finely_it_is_sampled(jerk):
    """At gentle corners too, where the controller's cycle lets velocity jump."""
    on = machine(60 * V, A, jerk)
    checked = 0
    for seed in range(200, 230):
        try:
            made = planned(program(seed), on)
        except AssertionError:
            continue
        if made.duration > 20.0:
            continue
        velocity, acceleration, hardest = derivatives(made, DT / 10)
        assert (velocity <= V * 1.001).all(), (seed, velocity)
        assert (acceleration <= A * 1.001).all(), (seed, acceleration)
        if jerk:
            assert (hardest <= jerk * 1.001 + 10.0).all(), (seed, hardest)  # 1e-12 mm of rounding is 10 mm/s³
        checked += 1
    assert checked > 5


@pytest.mark.parametrize("jerk", [0.0, 5000.0])
def test_gentle_corners_are_rounded_over_a_cycle(jerk):
    """Sides of a polygon of 90: corners are passed as near as a cycle allows, and no farther off."""
    angles = [math.tau * i / 90 for i in range(1, 10)]
    text = "\n".join(f"G1 X{50 - 50 * math.cos(a):.6f} Y{50 * math.sin(a):.6f}" for a in angles)
    made = planned(f"G21 G90 G61 F6000\n{text}\nM2", machine(60 * V, A, jerk))
    away = np.abs(made.samples(made.times).position - made.toolpath.ends()).max()
    bound = jerk * DT**3 / 20 if jerk else A * DT**2 / 16
    assert bound / 3 < away < bound * 1.000001
    _, acceleration, _ = derivatives(made, DT / 20)
    assert (acceleration <= A * 1.001).all()
    s = made.samples(np.arange(0, made.duration, DT / 7))
    slope = np.gradient(s.position, s.time, axis=0, edge_order=2)
    assert slope == pytest.approx(s.velocity, abs=A * DT)
    assert np.abs(s.acceleration).max() <= A * 1.001


@pytest.mark.parametrize("since", [steady, bent, raised])
def test_spreading_a_jump_leaves_nothing_behind(since):
    """The functions of `since` are each other's derivatives, but for the jump itself; and end in zeros."""
    cycle, dt = 0.5, 1e-4
    time = (np.arange(-12_000, 12_000) + 0.5) * dt
    place, speed, slope = since(time, cycle)
    for values in (place, speed, slope):
        assert values[[0, -1]] == pytest.approx(0, abs=1e-12)
    jumped = np.where(time > 0, 1.0, 0.0)
    if since is raised:
        assert np.cumsum(slope) * dt == pytest.approx(speed, abs=2e-4)
        assert np.cumsum(speed) * dt == pytest.approx(place, abs=2e-4)
        assert np.abs(np.diff(slope + jumped)).max() / dt <= 0.86 / cycle
    else:
        assert np.cumsum(slope) * dt - jumped == pytest.approx(speed, abs=3e-4)
        assert np.cumsum(speed) * dt == pytest.approx(place, abs=3e-4)
        assert np.abs(slope).max() <= 1 / cycle


@pytest.mark.parametrize("jerk", [0.0, 5000.0])
def test_every_move_is_followed_exactly_where_nothing_is_blended(jerk):
    """G61: each programmed end is passed, and the points between lie on the programmed line or circle."""
    made = planned(
        "G21 G90 G61 F3000\nG1 X10 Y3\nX20 Y3.2\nG3 X30 Y13.2 J10\nG1 Y30 Z5 A40\nX0 Y0\nM2",
        machine(jerk=jerk, cycle=0.0),
    )
    ends = made.toolpath.ends()
    assert made.samples(made.times).position == pytest.approx(ends, abs=1e-9)
    s = made.sample(0.001)
    starts = made.toolpath.starts()
    for k in (0, 1, 3, 4):
        at = s.position[s.move == k]
        way = ends[k] - starts[k]
        part = ((at - starts[k]) @ way) / (way @ way)
        assert np.abs(at - starts[k] - part[:, None] * way).max() < 1e-9
    at = s.position[s.move == 2]
    assert np.hypot(at[:, 0] - 20, at[:, 1] - 13.2) == pytest.approx(10, abs=1e-9)


def minimum(start, end, jerk):
    """Ruckig's time from rest to rest, each axis for itself: nothing is faster."""
    otg = ruckig.Ruckig(3)
    given = ruckig.InputParameter(3)
    given.current_position, given.target_position = list(start), list(end)
    given.max_velocity, given.max_acceleration = [V] * 3, [A] * 3
    given.max_jerk = [jerk or math.inf] * 3
    trajectory = ruckig.Trajectory(3)
    assert otg.calculate(given, trajectory) in (ruckig.Result.Working, ruckig.Result.Finished)
    return trajectory.duration


@pytest.mark.parametrize("jerk", [0.0, 500.0, 5000.0, 1e6])
@pytest.mark.parametrize("length", [1e-6, 1e-3, 0.5, 9.9, 10.1, 29.9, 30.1, 1000.0])
def test_a_single_move_takes_no_more_and_no_less_than_the_least_time(length, jerk):
    made = plan_moves(toolpath([(length, length / 2, 0)], kind=0), limits([V] * 3, [A] * 3, [jerk or None] * 3))
    assert made.duration == pytest.approx(minimum((0, 0, 0), (length, length / 2, 0), jerk), rel=1e-9)


@pytest.mark.parametrize("jerk", [0.0, 3000.0])
def test_programs_are_never_faster_than_their_moves_can_be(jerk):
    r = random.Random(7)
    for _ in range(20):
        points = [tuple(r.uniform(-50, 50) for _ in range(3)) for _ in range(8)]
        lowest = minimum((0, 0, 0), points[-1], jerk)
        for blend in (0.0, 1.0):
            given = limits([V] * 3, [A] * 3, [jerk or None] * 3)
            made = plan_moves(toolpath(points, kind=0), given, [Regime(0, blend=blend)])
            assert made.duration >= lowest * (1 - 1e-12)
            if not blend:
                stops = [(0, 0, 0), *points]
                each = [minimum(a, b, jerk) for a, b in pairwise(stops)]
                assert made.duration >= sum(each) * (1 - 1e-9)


def test_short_moves_in_line_are_one_move_with_limited_jerk():
    given = limits([V] * 3, [A] * 3, [5000.0] * 3)
    made = plan_moves(toolpath([(0.25 * i, 0, 0) for i in range(1, 400)]), given)
    assert made.duration == pytest.approx(minimum((0, 0, 0), (0.25 * 399, 0, 0), 5000.0), rel=1e-9)


# --- the kernels and their twins


def test_kernels_and_twins_agree_bit_for_bit(monkeypatch):
    from aircut.kernels import twin

    for seed in (1, 2, 3, 5, 8, 13, 21):
        for jerk in (0.0, 5000.0):
            on = machine(60 * V, A, jerk)
            built = planned(program(seed), on)
            with monkeypatch.context() as patch:
                for module, name in ((lookahead, "lookahead"), (pieces, "pieces"), (scurve, "scurve"), (thin, "thin")):
                    other = twin(name, f"{name}_uncompiled")
                    for function in ("brake", "trapezoids", "lay", "spans", "thin"):
                        if hasattr(module, function):
                            patch.setattr(module, function, plain(getattr(other, function)))
                again = planned(program(seed), on)
            assert built.until.tobytes() == again.until.tobytes()
            assert built.path.length.tobytes() == again.path.length.tobytes()
            assert all(a.tobytes() == b.tobytes() for a, b in zip(built.profile, again.profile, strict=True))


def plain(function):
    """A kernel's twin, fed with memoryviews: their elements are Python's numbers."""
    return lambda *values: function(*[memoryview(v) if isinstance(v, np.ndarray) else v for v in values])
