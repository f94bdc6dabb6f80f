"""Motion control modes as they show in the planned motion: G9, G61, G61.1, G64 with P and Q.

Sources: 000 section 5; decisions AMB-MODE-1 to AMB-MODE-3.
"""

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

import aircut
from aircut.planner import Plan
from planning import planned

EXAMPLES = Path(__file__).parent.parent.parent / "shared" / "spec" / "examples"
INCH = 25.4
examples = pytest.mark.skipif(not EXAMPLES.exists(), reason="the documents' examples are not at hand")


def gaps(plan: Plan) -> np.ndarray:
    """How far the motion stays away from the end of each move, mm."""
    points = plan.polyline(turn=0.01)[0][:, :3]
    first, way = points[:-1], np.diff(points, axis=0)
    square = np.maximum((way**2).sum(axis=1), 1e-30)
    found = []
    for end in plan.toolpath.ends()[:, :3]:
        along = np.clip(((end - first) * way).sum(axis=1) / square, 0, 1)
        found.append(np.sqrt(((first + along[:, None] * way - end) ** 2).sum(axis=1)).min())
    return np.array(found)


def speeds(plan: Plan) -> np.ndarray:
    """Speed of the tool at the end of each move, mm/s."""
    return plan.samples(plan.times).tool_speed


CORNER = "G90 F6000\n{}\nG1 X100\nY100\nX200 Y200\nX300 Y300\nM2"


def test_exact_path_goes_through_the_corners_and_looks_ahead() -> None:
    """G61: no corner is cut, and where the path goes straight on it does not slow down."""
    made = planned(CORNER.format("G64 P5\nG61"))
    assert gaps(made) == pytest.approx(0, abs=1e-9)
    assert speeds(made)[2] == pytest.approx(100)


def test_exact_stop_stops_at_the_end_of_every_move() -> None:
    """G61.1."""
    made = planned(CORNER.format("G64 P5\nG61.1"))
    assert gaps(made) == pytest.approx(0, abs=1e-9)
    assert speeds(made) == pytest.approx(0, abs=1e-6)


def test_continuous_path_cuts_corners_by_p_and_no_more() -> None:
    """G64 P: the shorter the longer the tolerance; a later G64 without P keeps it (AMB-MODE-1)."""
    last = planned(CORNER.format("G64 P0")).duration
    for tolerance in (0.01, 0.5, 5):
        made = planned(CORNER.format(f"G64 P{tolerance}\nG61\nG64"))
        assert gaps(made)[:2].min() > 0 and gaps(made).max() <= tolerance * (1 + 1e-6)
        assert made.duration < last
        last = made.duration


def test_p0_leaves_the_path_as_it_is() -> None:
    made = planned(CORNER.format("G64 P5\nG64 P0"))
    assert gaps(made) == pytest.approx(0, abs=1e-9)


def test_tolerances_are_lengths_in_the_units_in_force() -> None:
    inch, mm = planned(CORNER.format("G20 G64 P0.1\nG21\nF6000")), planned(CORNER.format("G64 P2.54"))
    assert inch.duration == pytest.approx(mm.duration)


def test_q_thins_points_out() -> None:
    """G64 Q: points that lie within Q of the straight way are left out, others stay; Q0 leaves all."""
    wave = "\n".join(f"G1 X{x} Y{0.01 * (x % 2)}" for x in range(1, 51))
    for tolerance, left in ((0, 50), (0.004, 50), (0.011, 1)):
        made = planned(f"F6000 G64 P0 Q{tolerance}\n{wave}\nM2")
        assert len(made.path.toolpath) == left


@examples
def test_g9_stops_at_its_corner_alone() -> None:
    """The manual's example: stops at X40 Y0 and at X10 Y40; the other corners are blended."""
    text = (EXAMPLES / "g9_exact_stop.ngc").read_text()
    made = planned(text)
    away, speed = gaps(made), speeds(made)
    ends = [tuple(end) for end in made.toolpath.ends()[:6, :2].round(6).tolist()]
    assert ends == [(-10, -10), (0, 0), (40, 0), (40, 40), (10, 40), (10, 0)]
    assert away[[2, 4]] == pytest.approx(0, abs=1e-9) and speed[[2, 4]] == pytest.approx(0, abs=1e-6)
    assert 0 < away[3] <= 5 and speed[3] > 1


def test_g9_is_g61_1_and_g64_again() -> None:
    """The same path and the same times; the tolerance is kept (AMB-MODE-1)."""
    once = planned("G64 P5 F5000\nG1 X10 Y10\nG9 X40\nY40\nG9 X20\nY0\nM2")
    modes = planned("G64 P5 F5000\nG1 X10 Y10\nG61.1\nX40\nG64\nY40\nG61.1\nX20\nG64\nY0\nM2")
    assert gaps(once)[[0, 2]].min() > 1
    assert gaps(once) == pytest.approx(gaps(modes), abs=1e-9)
    assert once.seconds == pytest.approx(modes.seconds)


@examples
def test_the_wave_gets_smoother_with_p() -> None:
    """The manual's wave under P 0, 0.1, 0.2, 1 and 5 inches."""
    result = aircut.load(EXAMPLES / "path_smoothing.ngc").run()
    made = result.plan()
    away, tools = gaps(made), made.toolpath.tool
    feeds = made.toolpath.kind == 1
    smoothing = [away[feeds & (tools == tool)].sum() for tool in range(5)]
    assert smoothing[0] == pytest.approx(0, abs=1e-9)
    assert all(less < more for less, more in pairwise(smoothing[:4]))
    assert smoothing[4] >= smoothing[3] * (1 - 1e-9)
    for tool, tolerance in enumerate((0, 0.1, 0.2, 1, 5)):
        assert away[feeds & (tools == tool)].max() <= tolerance * INCH + 1e-6


def test_probing_moves_keep_to_acceleration_and_stop(tmp_path: Path) -> None:
    """At 10 mm/s and 100 mm/s²: 10 mm take 10/10 + 10/100 s, 5 mm take 5/10 + 10/100 s."""
    (tmp_path / "machine.toml").write_text("[axes.X]\n[axes.Y]\n[axes.Z]\nvelocity = 3000\nacceleration = 100\n")
    result = aircut.loads("G21 G90\nG38.2 Z-10 F600\nG38.3 Z-15\nM2\n").run(tmp_path)
    assert result.plan().times.tolist() == pytest.approx([1.1, 1.7], abs=1e-9)
