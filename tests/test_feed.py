"""Feed: the time that a move takes, in all meanings of F."""

from math import hypot, pi
from pathlib import Path

import pytest

import aircut
from aircut.api import Result
from aircut.machine import Machine, MachineError
from aircut.machine.config import load, parse

EXAMPLES = Path(__file__).parent.parent.parent / "shared" / "spec" / "examples"
ORIGIN = {"origin_x": 0.0, "origin_y": 10.0, "origin_z": 20.0}


def mill(handling: bool = True, letters: str = "A", **more: object) -> Machine:
    """A mill whose rotary axes turn about Y10 Z20 and the like, with axes so fast that only F counts."""
    swift = {"velocity": 1e6, "acceleration": 1e9}
    axes = {letter: dict(swift) for letter in "XYZ"} | dict.fromkeys(letters, swift | ORIGIN | more)
    options = {"rotary_feed_handling": handling}
    return Machine(parse({"axes": axes, "options": options}), {}, own_tools=False)


def minutes(text: str, machine: Machine) -> list[float]:
    """Minutes of each feed move, from the rows of the toolpath."""
    path = run(text, machine).toolpath
    return (path.lengths()[path.kind > 0] / path.feed[path.kind > 0]).tolist()


def run(text: str, machine: Machine) -> Result:
    result = aircut.loads(text + "\nM102\n").run(machine)
    assert result.ok, result.diagnostics
    return result


def close(*values: float) -> object:
    return pytest.approx(list(values), rel=1e-9)


# --- without Rotary Feed Handling


def test_rotary_axes_alone_have_degrees_a_minute() -> None:
    assert minutes("F100 G1 A370\nA0\nG20\nF100 A90", mill(handling=False)) == close(3.7, 3.7, 0.9)


def test_f_is_the_speed_of_the_linear_axes_in_mixed_moves() -> None:
    """AMB-FEED-4. However far the rotary axes turn meanwhile."""
    assert minutes("F100 G1 X30 Y40 A1\nX0 Y0 A7200\nG91 G2 I5 A90", mill(handling=False)) == close(0.5, 0.5, pi / 10)


def test_inverse_time_is_the_time_of_any_move() -> None:
    text = "G93\nG1 X30 A5 F2\nA90 F4\nG2 I5 A0 F8\nG1 X31 F0.5"
    assert minutes(text, mill()) == close(0.5, 0.25, 0.125, 2.0)


def test_the_planner_takes_that_time() -> None:
    """With axes that are fast enough it is the time of the run."""
    for text, wanted in (("G1 A370 F1336.9", 370 / 1336.9), ("G1 X-60 A-720 F110", 60 / 110), ("G1 X1 F10", 0.1)):
        assert run(text, mill(handling=False)).plan().duration / 60 == pytest.approx(wanted, rel=1e-6)


@pytest.mark.skipif(not EXAMPLES.exists(), reason="the documents' examples are not at hand")
def test_the_manual_s_macro_makes_the_tool_pass_at_700() -> None:
    """Arc and total length over 700 mm/min; the macro's pi is 3.1416."""
    machine = mill(handling=False)
    machine.macros = (EXAMPLES,)
    program = aircut.load(EXAMPLES / "mixed_feed_usage.ngc")
    path = program.run(machine).toolpath
    feeds = path.kind > 0
    minutes = path.lengths()[feeds] / path.feed[feeds]
    around = 3.1416 * 60
    assert minutes.tolist() == close(5 / 700, around * 370 / 360 / 700, hypot(2 * around, 60) / 700)


# --- with it


def test_f_is_the_speed_over_the_part() -> None:
    """AMB-FEED-5. The tool stands 30 mm from the axis, at Y10 Z50."""
    text = "G0 Y10 Z50\nF700 G1 A370\nG91 X-60 A-720\nX5\nA0"
    around = 2 * pi * 30
    moves = minutes(text, mill())
    assert moves[:3] == close(around * 370 / 360 / 700, hypot(2 * around, 60) / 700, 5 / 700)


def test_it_does_what_the_manual_s_macro_does_by_hand() -> None:
    by_hand = minutes("G0 Y10 Z50\nG1 A370 F[370/[2*#<math.pi>*30*370/360/700]]", mill(handling=False))
    assert minutes("G0 Y10 Z50\nG1 A370 F700", mill()) == pytest.approx(by_hand, rel=1e-6)


def test_the_distance_is_the_mean_of_start_and_end() -> None:
    """From Z50 to Z30 at Y10: 30 and 10 mm from the axis; the way is 20 mm down and 20 mm · half a turn around."""
    assert minutes("G0 Y10 Z50\nF100 G1 Z30 A180", mill()) == close(hypot(20, 20 * pi) / 100)


def test_each_axis_adds_its_part() -> None:
    """A about X at (Y10, Z20), C about Z at (X0, Y10); the tool at X3 Y14 Z20."""
    text = "G0 X3 Y14 Z20\nF100 G1 A90 C-90"
    assert minutes(text, mill(letters="AC")) == close(hypot(4 * pi / 2, 5 * pi / 2) / 100)


def test_axis_parallel_to_another() -> None:
    text = "G0 X3 Y77 Z24\nF100 G1 A90"
    assert minutes(text, mill(parallel_to="Y")) == close(5 * pi / 2 / 100)


def test_on_the_axis_f_is_degrees_a_minute_again() -> None:
    """Nothing passes over the part there; neither by a linear move along the axis."""
    assert minutes("G0 Y10 Z20\nF100 G1 A90\nX10 A0\nG20\nF100 A90", mill()) == close(0.9, 0.1, 0.9)


def test_offsets_and_units_count() -> None:
    text = "G10 L2 P1 Y-10 Z-50\nG20 G0 Y[20/25.4] Z[100/25.4]\nF10 G1 A90"
    assert minutes(text, mill()) == close(30 * pi / 2 / 254)


def test_the_tool_offset_counts_with_g43() -> None:
    """The tip is 30 mm from the axis where the spindle is 130; without G43 the spindle's nose counts."""
    assert minutes("G43.1 Z100\nG53 G0 Y10 Z150\nF100 G1 A90", mill()) == close(30 * pi / 2 / 100)
    assert minutes("G53 G0 Y10 Z150\nF100 G1 A90", mill()) == close(130 * pi / 2 / 100)


def test_the_origin_may_be_a_work_system() -> None:
    text = "G10 L2 P2 Y5 Z6\nG0 Y5 Z10\nF100 G1 A90"
    assert minutes(text, mill(origin_mode=2)) == close(4 * pi / 2 / 100)


def test_arcs_too() -> None:
    """A full circle of radius 5 in XY while the part turns once under it; arms of 30 mm at both ends."""
    text = "G0 Y10 Z50\nF100 G2 I5 A360\nG2 I5"
    assert minutes(text, mill()) == close(hypot(10 * pi, 60 * pi) / 100, 10 * pi / 100)


def test_it_wants_an_origin(tmp_path: Path) -> None:
    """000 section 7.2: it can be enabled only where the origin of the axis has been specified."""
    toml = "[options]\nrotary_feed_handling = true\n[axes.X]\n[axes.A]\n{}\n[axes.B]\ntype = 'linear'\n"
    for given in ("origin_mode = 3", "origin_x = 0.0", "origin_y = 1", "origin_z = 0"):
        (tmp_path / "machine.toml").write_text(toml.format(given))
        assert load(tmp_path).options.rotary_feed_handling
    (tmp_path / "machine.toml").write_text(toml.format("velocity = 1000"))
    with pytest.raises(MachineError, match=r"rotary_feed_handling needs axes\.A\.origin_mode or"):
        load(tmp_path)
