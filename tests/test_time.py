"""`aircut time` and the curves of `aircut plot`: what they tell, as people and machines read it."""

from __future__ import annotations

import csv
import io
import json
from pathlib import Path

import pytest
from click.testing import CliRunner

from aircut.cli.main import cli

PROGRAM = """G21 G90 G61.1
T1 M6
S6000 M3
G0 X100
G1 X150 F3000
G4 P2
T2 M6
G1 X100
M5
M2
"""
MACHINE = """[axes.X]
velocity = 6000.0
acceleration = 500.0
[axes.Y]
[axes.Z]
[durations]
tool_change = 4.0
[spindle]
acceleration = 3000.0
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "machine.toml").write_text(MACHINE)
    (tmp_path / "part.ngc").write_text(PROGRAM)
    return tmp_path


def told(folder: Path, *more: str, status: int = 0) -> str:
    made = CliRunner().invoke(cli, ["time", str(folder / "part.ngc"), "--machine", str(folder), *more])
    assert made.exit_code == status, made.output
    return made.stdout


def test_every_part_of_the_time_is_told_apart(folder):
    report = json.loads(told(folder, "--format", "json"))
    # 100 mm at 100 mm/s; twice 50 mm at 50 mm/s; acceleration 500 mm/s².
    rapid, feed = 1.0 + 0.2, 2 * (1.0 + 0.1)
    seconds = {"rapid": rapid, "feed": feed, "probing": 0, "dwell": 2, "spindle": 4, "tool_change": 8,
               "pallet": 0, "operator": 0, "input": 0, "index": 0, "orient": 0}  # fmt: skip
    assert report["seconds"] == pytest.approx(seconds)
    assert report["total"] == pytest.approx(sum(seconds.values()))
    assert report["counts"]["tool_change"] == 2 and report["counts"]["dwell"] == 1
    by_tool = {row["tool"]: row["total"] for row in report["tools"]}
    # T2's change stops the spindle first: that counts to the tool whose moves follow.
    assert by_tool[1] + by_tool[2] == pytest.approx(report["total"])
    assert by_tool[2] >= 4 + feed / 2
    assert report["distance"] == pytest.approx({"rapid": 100, "feed": 100, "rotation": 0})
    assert report["speed"]["peak"] == pytest.approx(3000)
    assert report["speed"]["mean"] == pytest.approx(60 * 100 / feed)
    assert report["speed"]["reached"] == pytest.approx(2.0 / feed)
    assert [row["line"] for row in report["lines"][:2]] in ([7, 2], [2, 7])
    assert report["lines"][0]["text"].endswith("M6")


def test_the_table_and_csv_say_the_same(folder):
    total = json.loads(told(folder, "--format", "json"))["total"]
    assert f"({total:.3f} s, trapezoidal profile)" in told(folder)
    (row,) = csv.DictReader(io.StringIO(told(folder, "--format", "csv")))
    assert float(row["total"]) == pytest.approx(total) and float(row["tool_change"]) == 8
    told(folder, "--format", "csv", "-o", str(folder / "time.csv"))
    assert (folder / "time.csv").read_text().startswith("program,total,")


def test_overrides_and_their_bounds(folder):
    half = json.loads(told(folder, "--format", "json", "--override-feed", "50"))
    assert half["seconds"]["feed"] == pytest.approx(2 * (2.0 + 0.05))
    assert half["seconds"]["rapid"] == pytest.approx(1.2)
    fast = json.loads(told(folder, "--format", "json", "--override-spindle", "50"))
    assert fast["seconds"]["spindle"] == pytest.approx(2.0)
    made = CliRunner().invoke(cli, ["time", str(folder / "part.ngc"), "--override-feed", "0"])
    assert made.exit_code == 1 and "feed override of 0 %" in made.output


def test_a_jerk_in_the_machine_makes_the_profile_jerk_limited(folder):
    (folder / "machine.toml").write_text(MACHINE.replace("500.0", "500.0\njerk = 5000.0"))
    limited = json.loads(told(folder, "--format", "json"))
    assert limited["profile"] == "jerk-limited"
    assert limited["seconds"]["rapid"] == pytest.approx(1.2 + 0.1)  # and acceleration / jerk
    plain = json.loads(told(folder, "--format", "json", "--profile", "trapezoidal"))
    assert plain["seconds"]["rapid"] == pytest.approx(1.2)
    (folder / "machine.toml").write_text(MACHINE)
    made = CliRunner().invoke(
        cli, ["time", str(folder / "part.ngc"), "--machine", str(folder), "--profile", "jerk-limited"]
    )
    assert made.exit_code == 1 and "needs a jerk" in made.output


def test_a_program_with_an_error_is_timed_up_to_it(folder):
    (folder / "part.ngc").write_text("G21\nG1 X50 F3000\nG1 X[1/0]\nM2\n")
    assert "of the programmed" in told(folder, status=1)
    (folder / "part.ngc").write_text("M2\n")
    assert json.loads(told(folder, "--format", "json"))["total"] == 0


@pytest.mark.parametrize("what", ["speed", "acceleration", "jerk", "axis", "path"])
@pytest.mark.parametrize("suffix", ["png", "svg"])
def test_curves_are_pictures(folder, what, suffix):
    (folder / "part.ngc").write_text("G21 G90 G64 P1\nG1 X20 F3000\nY20\nG2 X40 I10\nM2\n")
    out = folder / f"curve.{suffix}"
    made = CliRunner().invoke(
        cli, ["plot", str(folder / "part.ngc"), "--machine", str(folder), "--what", what, "-o", str(out)]
    )
    assert made.exit_code == 0, made.output
    assert out.read_bytes()[:4] in (b"\x89PNG", b"<?xm")


def test_a_curve_is_no_page(folder):
    made = CliRunner().invoke(cli, ["plot", str(folder / "part.ngc"), "--what", "speed", "-o", "x.html"])
    assert made.exit_code == 2 and "drawn as .png or .svg" in made.output


def test_the_page_shows_blended_corners_beside_the_programmed_path(folder):
    from aircut.api import loads
    from aircut.export import page

    result = loads("G21 G90 G64 P1\nG1 X20 F3000\nY20\nG2 X40 I10\nM2\n").run()
    plain, blended = (page.html(result.recording, {}, "part", plan) for plan in (None, result.plan()))
    assert plain.count('id="column-contour-') == blended.count('id="column-contour-') == 4
    assert len(blended) > len(plain)
