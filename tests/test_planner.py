"""Times and motion of the planner: closed forms, bounds, faults."""

import math

import numpy as np
import pytest

import aircut
from aircut.machine import MachineError, load
from aircut.planner import Overrides, PlanError, Regime, limits, plan_moves
from planning import machine, planned, toolpath

A, V = 500.0, 100.0  # mm/s², mm/s


def trapezoid(length, v=V, a=A):
    """Rest to rest."""
    return length / v + v / a if length >= v * v / a else 2 * math.sqrt(length / a)


@pytest.mark.parametrize("length", [1e-6, 0.1, 19.999999, 20.0, 20.000001, 100.0, 12345.678])
def test_a_single_move_takes_what_the_closed_form_says(length):
    made = plan_moves(toolpath([(length, 0, 0)]), limits([V] * 3, [A] * 3))
    assert made.duration == pytest.approx(trapezoid(length), rel=1e-9)
    assert made.at(0) == (0,) * 6 and made.at(made.duration)[0] == pytest.approx(length, rel=1e-12)


def test_a_slanting_move_is_limited_by_its_slowest_axis():
    made = plan_moves(toolpath([(30, 40, 0)], feed=1e6), limits([100, 10, 100], [500, 400, 500]))
    assert made.duration == pytest.approx(trapezoid(50, 10 / 0.8, 500), rel=1e-9)


@pytest.mark.parametrize("mode", ["G61.1", "G61", "G64"])
def test_a_square_with_stops_is_four_single_moves(mode):
    made = planned(f"G21 G90 {mode}\nF6000\nG1 X40\nY40\nX0\nY0\nM2")
    assert made.duration == pytest.approx(4 * trapezoid(40), rel=1e-9)
    assert made.times == pytest.approx([trapezoid(40) * i for i in range(1, 5)], rel=1e-9)


def test_a_circle_has_half_of_the_acceleration_along_the_path():
    # Slow enough that the curvature asks for less than √3/2 of the axes' acceleration: v²/r = 200 mm/s².
    made = planned("G21 G90 G61\nF6000\nG2 X0 Y0 I50\nM2")
    assert made.duration == pytest.approx(trapezoid(math.tau * 50, V, A / 2), rel=1e-9)


def test_a_small_circle_is_limited_by_its_curvature():
    made = planned("G21 G90 G61\nF6000\nG3 X0 Y0 I2\nM2")
    speed = math.sqrt(math.sqrt(0.75) * A * 2)
    assert made.duration == pytest.approx(trapezoid(math.tau * 2, speed, A / 2), rel=1e-9)


def test_g93_takes_the_time_it_asks_for():
    made = planned("G21 G90 G61.1 G93\nG1 X10 F6\nM2")  # a sixth of a minute
    speed = 1.0
    assert made.duration == pytest.approx(10 / speed + speed / A, rel=1e-9)


def test_rotary_axes_alone_have_degrees_a_minute_and_follow_in_mixed_moves():
    assert planned("G21 G90\nG1 A360 F3600\nM2").duration == pytest.approx(trapezoid(360, 60), rel=1e-9)
    mixed = planned("G21 G90\nG1 X10 A100 F60\nM2")  # F is of X: 1 mm/s, A follows at 10 °/s
    assert mixed.duration == pytest.approx(10 / 1 + 10 / A, rel=1e-9)
    fast = planned("G21 G90\nG1 X1 A100 F6000\nM2")  # A at 100 °/s is what limits
    assert fast.duration == pytest.approx(trapezoid(100), rel=1e-9)


def test_rapids_are_limited_by_the_axes_and_by_g103():
    assert planned("G0 X50 Y50\nM2").duration == pytest.approx(trapezoid(50), rel=1e-9)
    assert planned("G103 V3000\nG0 X50\nM2").duration == pytest.approx(trapezoid(50, 50), rel=1e-9)
    assert planned("G103 V3000\nG103 V0\nG0 X50\nM2").duration == pytest.approx(trapezoid(50), rel=1e-9)


def test_g104_limits_acceleration_and_deceleration_apart():
    made = planned("G21 G90\nG104 A100 D50\nG1 X500 F6000\nM2")
    assert made.duration == pytest.approx(500 / V + V / 100 / 2 + V / 50 / 2, rel=1e-9)
    # Not of rapids, and not beyond the axes.
    assert planned("G104 A100 D50\nG0 X100\nM2").duration == pytest.approx(trapezoid(100), rel=1e-9)
    assert planned("G21\nG104 A1000 D0\nG1 X100 F6000\nM2").duration == pytest.approx(trapezoid(100), rel=1e-9)


def test_collinear_moves_are_one():
    made = planned("G21 G90 G61\nF6000\n" + "\n".join(f"G1 X{i}" for i in range(1, 101)) + "\nM2")
    assert made.duration == pytest.approx(trapezoid(100), rel=1e-9)


def test_overrides():
    assert planned("G21\nG1 X100 F6000\nM2", overrides=Overrides(feed=0.5)).duration == pytest.approx(
        trapezoid(100, 50), rel=1e-9
    )
    text = "G21\nM49\nG1 X100 F3000\nM48\nG1 X200\nM2"
    half = planned(text, overrides=Overrides(feed=0.5), on=machine())
    assert half.duration > planned(text).duration
    assert planned("G0 X100\nM2", overrides=Overrides(rapid=0.25)).duration == pytest.approx(
        trapezoid(100, 25), rel=1e-9
    )


def test_the_rest_of_the_clock():
    made = planned("G21\nG1 X100 F6000\nG4 P2.5\nG1 X200\nM2")
    assert made.duration == pytest.approx(2 * trapezoid(100) + 2.5, rel=1e-9)
    assert [(p.kind, p.seconds) for p in made.pauses] == [("dwell", 2.5)]
    one = trapezoid(100)
    assert made.at(one + 1.0)[0] == 100.0 and made.at(one + 2.5)[0] == 100.0
    assert made.at(one + 2.5 + one / 2)[0] == pytest.approx(150.0)
    made = planned("S6000 M3\nT1 M6\nT1 M6\nM2")
    assert [(p.kind, p.seconds) for p in made.pauses if p.seconds] == [
        ("spindle", 1.0), ("spindle", 1.0), ("tool_change", 6.0),
    ]  # fmt: skip


def test_exact_stop_is_of_one_block_or_of_all():
    text = "G21 G90 G64 P1\nF6000\nG1 X50\n{}X100 Y{}\nX150\nM2"
    flowing, once = planned(text.format("", 0)), planned(text.format("G9 ", 0))
    assert flowing.duration == pytest.approx(trapezoid(150), rel=1e-9)
    assert once.duration == pytest.approx(trapezoid(100) + trapezoid(50), rel=1e-9)


@pytest.mark.parametrize("tolerance", [0.001, 0.1, 2.0, 50.0])
@pytest.mark.parametrize("end", [(40, 20), (20, 40), (80, 1), (1, 1), (20, 40, 10), (30, 30, 0, 20)])
@pytest.mark.parametrize("jerk", [None, 5000.0])
def test_blends_keep_within_p_of_the_corner(tolerance, end, jerk):
    given = limits([V] * 6, [A] * 6, [jerk] * 6)
    made = plan_moves(toolpath([(40, 0), end]), given, [Regime(0, blend=tolerance)])
    assert len(made.path) == 3
    place = made.path.at(np.full(2001, 1), np.linspace(0, made.path.length[1], 2001))[0]
    away = np.sqrt(((place - [40, 0, 0, 0, 0, 0]) ** 2).sum(axis=1)).min()
    assert 0 < away <= tolerance * (1 + 1e-9)
    # As far as allowed, where the lines are long enough.
    if tolerance < 0.05:
        assert away == pytest.approx(tolerance, rel=1e-6)
    # The pieces join, with their directions.
    for k in (0, 1):
        here, there = made.path.at(np.array([k]), made.path.length[[k]]), made.path.at(np.array([k + 1]), np.zeros(1))
        assert here[0] == pytest.approx(there[0], abs=1e-9) and here[1] == pytest.approx(there[1], abs=1e-9)


def test_thinning_leaves_out_points_near_their_chord():
    points = [(x, 0.01 * (-1) ** x) for x in range(1, 100)] + [(100, 0)]
    wide = plan_moves(toolpath(points), limits([V] * 3, [A] * 3), [Regime(0, thinning=0.05)])
    assert len(wide.path) == 1 and wide.duration == pytest.approx(trapezoid(100), rel=1e-9)
    assert len(wide.times) == 100 and wide.times[-1] == wide.duration
    tight = plan_moves(toolpath(points), limits([V] * 3, [A] * 3), [Regime(0, thinning=0.001)])
    assert len(tight.path.toolpath) == 100


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (([0.0], [A]), "velocity of 0"),
        (([V], [0.0]), "acceleration of 0"),
        (([V], [math.nan]), "acceleration of nan"),
        (([math.inf], [A]), "must be finite"),
        (([V], [None]), "axis X has no acceleration: it must be given"),
        (([V], [None], [1000.0]), "a jerk needs an acceleration"),
        (([V], [A], [0.0]), "jerk of 0"),
        (([V], [A], [-5.0]), "jerk of -5"),
        (([V], [-A]), "acceleration of -500"),
        (([V], [A], None, math.nan), "cycle of nan"),
    ],
)
def test_bad_limits_are_refused(arguments, told):
    with pytest.raises(PlanError, match=told):
        limits(*arguments)


def test_moves_that_never_end_are_refused():
    with pytest.raises(PlanError, match="line 1: a feed move at a feed of 0 never ends"):
        plan_moves(toolpath([(1, 0, 0)], feed=0.0), limits([V] * 3, [A] * 3))
    with pytest.raises(PlanError, match="line 1: axis A moves"):
        plan_moves(toolpath([(1, 0, 0, 5)]), limits([V] * 3, [A] * 3))
    with pytest.raises(PlanError, match="not finite on axis Y"):
        plan_moves(toolpath([(1, math.nan, 0)]), limits([V] * 3, [A] * 3))
    with pytest.raises(PlanError, match="feed override of 0 %"):
        planned("G0 X1\nM2", overrides=Overrides(feed=0.0))


def test_machine_toml_with_a_jerk_and_no_acceleration_is_refused(tmp_path):
    (tmp_path / "machine.toml").write_text("[axes.X]\njerk = 1000.0\n")
    with pytest.raises(MachineError, match=r"axes\.X\.jerk needs an acceleration"):
        load(tmp_path)


def test_no_motion_takes_no_time():
    made = planned("M2")
    assert made.duration == 0.0 and made.at(0.0) == (0.0,) * 6 and len(made.sample(0.1).time) == 1
    assert planned("G4 P1\nM2").duration == 1.0


def test_a_plan_is_a_table():
    made = planned("G21 G64 P1\nG1 X10 F600\nY10\nM2")
    assert made.to_arrow().column_names == ["line", "file", "tool", "kind", "seconds", "end"]
    assert made.to_arrow(0.01).num_rows == len(made.sample(0.01).time)
    with pytest.raises(ValueError, match="above zero"):
        made.sample(0.0)


def test_a_plan_made_stretch_by_stretch_is_the_same(monkeypatch):
    """Cut where the axes stand, at whatever move that is; and not where they do not."""
    from aircut.planner import planning

    lines = ["G21 G90 G17 F3000", "G0 X1", "G61"]
    for i in range(40):
        lines += [f"G1 X{i} Y{i % 3} Z{i % 2 / 9}", f"X{i + 0.3} Y{i % 3 + 0.01}", f"X{i + 0.7}", "X0.5 Y0.5", "X0.5"]
        lines += {7: ["G64 P0.1"], 15: ["G4 P1", "M3 S100"], 22: ["G104 P100 R200 J50"], 30: ["G3 X5 Y5 R9"]}.get(i, [])
    recording = aircut.loads("\n".join([*lines, "M2", ""])).run().recording
    for jerk in (0.0, 5000.0):
        on = machine(9000, 500, jerk)
        whole = planning.plan(recording, on)
        for most in (1, 2, 7, 50):
            with monkeypatch.context() as patch:
                patch.setattr(planning, "MOVES", most)
                made = planning.plan(recording, on)
            assert made.duration == pytest.approx(whole.duration, abs=1e-9)
            assert made.until == pytest.approx(whole.until, abs=1e-9)
            assert made.path.length.tobytes() == whole.path.length.tobytes()
            assert made.path.move.tobytes() == whole.path.move.tobytes()
            for column, other in zip(made.profile, whole.profile, strict=True):
                assert column == pytest.approx(other, abs=1e-9, rel=1e-9)
