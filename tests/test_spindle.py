"""Times of what hangs on the spindle, in LinuxCNC's language, by closed forms.

100 mm/s and 500 mm/s² on each axis; the spindle gains 1200 revolutions a minute in a second.
"""

import math

import pytest

import aircut
from aircut.machine.config import Durations, Spindle
from aircut.planner import Overrides, plan
from planning import machine

A = 500.0  # mm/s²
GAIN = 1200.0  # rpm a second


def plan_of(text, most=60_000.0, orient=0.75, **overrides):
    on = machine(spindle=Spindle(most, GAIN), durations=Durations(orient=orient))
    result = aircut.loads(f"G21 G90 G61.1\n{text}\nM2\n", dialect="linuxcnc").run(on)
    assert result.ok, result.diagnostics
    return plan(result.recording, on, overrides=Overrides(**overrides))


def move(length, speed):
    """Rest to rest, mm/s."""
    return length / speed + speed / A


def pauses(made):
    """Kind and seconds of each, without the spindle's stop at the program's end."""
    return [(p.kind, pytest.approx(p.seconds)) for p in made.pauses if p.seconds and p.at < len(made.toolpath)]


UP = 600 / GAIN  # to S600


@pytest.mark.parametrize(("feed", "spindle", "ratio"), [(1, 1, 1), (0.5, 1, 0.5), (1, 1.5, 1.5), (0.5, 1.5, 0.75)])
def test_a_feed_per_revolution_goes_with_both_overrides(feed, spindle, ratio):
    made = plan_of("S600 M3\nG95 F0.5\nG1 X30", feed=feed, spindle=spindle)
    assert made.times[-1] == pytest.approx(UP * spindle + move(30, 0.5 * 10 * ratio), rel=1e-9)


def test_a_feed_per_minute_does_not_hang_on_the_spindle():
    made = plan_of("S600 M3\nG95 F0.5\nG94 F300\nG1 X30", spindle=1.5)
    assert made.times[-1] == pytest.approx(UP * 1.5 + move(30, 5), rel=1e-9)


def test_a_feed_per_revolution_knows_how_fast_the_spindle_can_be():
    made = plan_of("S600 M3\nG95 F0.5\nG1 X30", most=300.0)
    assert made.times[-1] == pytest.approx(300 / GAIN + move(30, 0.5 * 5), rel=1e-9)


def test_a_feed_per_revolution_follows_s():
    made = plan_of("S600 M3\nG95 F0.5\nG1 X30\nS1200\nG1 X0")
    assert made.times[-1] == pytest.approx(2 * UP + move(30, 5) + move(30, 10), rel=1e-9)


@pytest.mark.parametrize(("most", "turns"), [("", 60_000 / math.tau / 10), ("D300", 300)])
def test_at_constant_surface_speed_the_revolutions_hang_on_x(most, turns):
    """60 m/min at X10, or as many revolutions as D allows."""
    made = plan_of(f"G0 X10\nG96 {most} S60 M3\nG95 F0.1\nG1 Z-5")
    assert made.times[-1] == pytest.approx(2 * math.sqrt(10 / A) + move(5, 0.1 * turns / 60), rel=1e-9)


def test_at_constant_surface_speed_the_middle_of_a_move_counts():
    made = plan_of("G0 X10\nG96 S60 M3\nG95 F0.1\nG1 X30\nG91 G1 X-10")
    speeds = [0.1 * 1000 / math.tau / radius for radius in (20, 25)]
    assert made.times[-1] == pytest.approx(2 * math.sqrt(10 / A) + move(20, speeds[0]) + move(10, speeds[1]), rel=1e-9)


@pytest.mark.parametrize("feed", [0.5, 1, 2])
@pytest.mark.parametrize("spindle", [0.5, 1])
def test_a_thread_waits_for_the_index_and_goes_with_the_spindle_alone(feed, spindle):
    made = plan_of("S600 M3\nG33 Z-20 K2", feed=feed, spindle=spindle)
    assert pauses(made) == [("spindle", UP * spindle), ("index", 0.5 / (10 * spindle))]
    assert made.moving == pytest.approx(move(20, 20 * spindle), rel=1e-9)


def test_threads_in_a_row_wait_once():
    made = plan_of("S600 M3\nG33 Z-20 K2\nG33 X5 Z-30 K2\nG0 X10\nG33 Z-40 K2")
    assert [kind for kind, _ in pauses(made)] == ["spindle", "index", "index"]


def test_after_a_thread_the_feed_is_overridden_again():
    made = plan_of("S600 M3\nG33 Z-20 K2\nG94 F300\nG1 X30", feed=0.5)
    assert made.seconds[-1] == pytest.approx(move(30, 2.5), rel=1e-9)


def test_rigid_tapping_turns_the_spindle_round_twice():
    made = plan_of("S600 M3\nG33.1 Z-20 K1.5\nG0 X10")
    assert pauses(made) == [("spindle", UP), ("index", 0.05), ("spindle", 2 * UP), ("spindle", 2 * UP)]
    assert made.seconds[:2] == pytest.approx(move(20, 15), rel=1e-9)
    assert made.times[:2] == pytest.approx([UP + 0.05 + move(20, 15), 3 * UP + 0.05 + 2 * move(20, 15)])


def test_a_threading_cycle_waits_for_the_index_in_each_pass():
    made = plan_of("S600 M3\nG0 X20 Z5\nG76 P1.5 Z-20 I-1 J0.4 K1 R1 H1 Q0")
    passes = sum(kind == "index" for kind, _ in pauses(made))
    assert passes == 4  # 0.4, 0.8, 1, and 1 once more


def test_tapping_stops_and_reverses_the_spindle_and_nobody_overrides():
    made = plan_of("S600 M3\nF900\nG84 X0 Y0 Z-20 R0\nG80 G0 X10", feed=0.5, spindle=0.5)
    assert [seconds for _, seconds in pauses(made)] == [UP / 2, UP / 2, UP, UP, UP, UP, UP / 2]
    assert made.seconds[:3] == pytest.approx([0, move(20, 15), move(20, 15)], rel=1e-9)


@pytest.mark.parametrize(("words", "seconds"), [("R90 Q9", UP + 0.75), ("R90 Q0.5", 0.5), ("R90", 0), ("Q9", 0)])
def test_orienting_takes_the_stop_and_the_turn_where_it_is_waited_for(words, seconds):
    made = plan_of(f"S600 M3\nM19 {words}\nG0 X10")
    assert [p.seconds for p in made.pauses if p.kind == "orient" and p.seconds] == ([seconds] if seconds else [])
    assert made.times[-1] == pytest.approx(UP + seconds + 2 * math.sqrt(10 / A), rel=1e-9)


def test_after_orienting_the_spindle_starts_from_rest():
    made = plan_of("S600 M3\nM19 R90 Q9\nM3\nG0 X10")
    assert pauses(made) == [("spindle", UP), ("orient", UP + 0.75), ("spindle", UP)]
