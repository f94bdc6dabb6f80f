"""The examples run: aircut's own, and those of the documents where they are at hand."""

import shutil
from pathlib import Path

import numpy as np
import pytest

import aircut
from aircut.api import Result
from aircut.machine import built_in

ROOT = Path(__file__).parent.parent
DOCUMENTS = ROOT.parent / "shared" / "spec" / "examples"
here = pytest.mark.skipif(not DOCUMENTS.exists(), reason="the documents' examples are not at hand")


@pytest.mark.parametrize("path", sorted((ROOT / "examples").glob("*.ngc")), ids=lambda p: p.stem)
def test_own_examples_have_no_fault(path: Path) -> None:
    assert aircut.load(path).check() == []


def run(name: str, folder: Path) -> Result:
    """A document's example, with its helper macros in a folder."""
    for helper in ("O101.ngc", "named_sub.ngc", "O1001.ngc"):
        shutil.copy(DOCUMENTS / helper, folder)
    machine = built_in("XYZABC")
    machine.macros = (folder,)
    result = aircut.load(DOCUMENTS / name).run(machine)
    assert result.ok, result.diagnostics
    return result


@here
def test_full_circles_and_helices(tmp_path: Path) -> None:
    """Three full circles of radius 25, three two-turn helices of height 100."""
    toolpath = run("full_circles_and_helices.ngc", tmp_path).toolpath
    arcs = toolpath.kind == 2
    circle = 2 * 3.141592653589793 * 25
    helix = ((2 * circle) ** 2 + 100**2) ** 0.5
    assert toolpath.lengths()[arcs] == pytest.approx([circle] * 3 + [helix] * 3)


@here
def test_g28_example(tmp_path: Path) -> None:
    result = run("g28_example.ngc", tmp_path)
    assert result.toolpath.ends()[-1, :3].tolist() == [20.0, 40.0, 20.0]
    assert {d.code for d in result.diagnostics} == {"no-feed"}


@here
def test_if_goto_and_while(tmp_path: Path) -> None:
    result = run("if_goto_and_while.ngc", tmp_path)
    assert result.toolpath.ends()[:, :2].tolist() == [
        [0, 0], [20, 0], [20, 50], [30, 50], [40, 50], [50, 50], [60, 50],
    ]  # fmt: skip
    assert result.state["tool"] == 3 and result.variables[3] == 4.0


@here
@pytest.mark.parametrize(
    ("name", "values"),
    [
        ("goto.ngc", {500: 2.0}),
        ("if_goto.ngc", {500: 0.0}),
        ("if_then_else.ngc", {500: 1.0, 501: None, 502: 1.0, 503: None}),
        ("if_elif.ngc", {500: 4.0}),
        ("while_nested.ngc", {500: 6.0}),
        ("while_break.ngc", {500: 5.0}),
        ("mixed_feed_usage.ngc", {101: 110.023}),
    ],
)
def test_values(name: str, values: dict[int, float | None], tmp_path: Path) -> None:
    variables = run(name, tmp_path).variables
    for number, value in values.items():
        assert variables.get(number) == (value if value is None else pytest.approx(value, abs=0.001)), number


@here
def test_wcs_update(tmp_path: Path) -> None:
    result = run("wcs_update.ngc", tmp_path)
    assert [result.system(number) for number in (5221, 5222, 5223)] == [10.0, 20.0, 30.0]


@here
def test_subroutines(tmp_path: Path) -> None:
    """O1 twice: Z up to 50 and back, two times."""
    result = run("subroutines.ngc", tmp_path)
    z = result.toolpath.z.tolist()
    assert z.count(50.0) >= 2


@here
def test_macro_call_g65(tmp_path: Path) -> None:
    result = run("macro_call_g65.ngc", tmp_path)
    assert result.toolpath.ends()[-1, :3].tolist() == [0.0, 35.0, 0.01]
    assert result.state["tool"] == 5


@here
@pytest.mark.parametrize(
    "name", ["feed_spindle_tool_words", "g28_lines", "g9_exact_stop", "null_assignment", "path_smoothing"]
)
def test_without_fault(name: str, tmp_path: Path) -> None:
    run(f"{name}.ngc", tmp_path)


@here
def test_g73_peck_drilling(tmp_path: Path) -> None:
    """Three holes of ten bites from R2 to Z-8, each left to Z2."""
    path = run("g73_peck_drilling.ngc", tmp_path).toolpath
    for x in (10, 20, 30):
        hole = (path.x == x) & (path.y == 10)
        depths = path.z[hole & (path.kind == 1)]
        assert depths.tolist() == pytest.approx([1 - i for i in range(10)])
        assert path.z[hole & (path.kind == 0)][-2 if x < 30 else -1] == 2


@here
def test_polar_standard(tmp_path: Path) -> None:
    """A square of circumradius 50 stood on a corner, and a spiral of radii 10 to 50, a quarter turn each."""
    path = run("polar_standard.ngc", tmp_path).toolpath
    ends = path.ends()[path.kind == 1][:, :2]
    square = [(0, 50), (-50, 0), (0, -50), (50, 0), (0, 50)]
    assert ends[:5] == pytest.approx(np.array(square, float), abs=1e-9)
    spiral = [(0, 10), (-20, 0), (0, -30), (40, 0), (0, 50)]
    assert ends[5:] == pytest.approx(np.array(spiral, float), abs=1e-9)


@here
def test_polar_complete(tmp_path: Path) -> None:
    """Squares and spirals in three planes, by @ and ^ and, 100 mm to the right, by the planes' own words."""
    path = run("polar_complete.ngc", tmp_path).toolpath
    ends = path.ends()[path.kind == 1][:, :3]
    for x in (0, 100):
        for first, second in ((0, 1), (0, 2), (1, 2)):
            for radius, angle in ((50, 90), (50, 180), (50, 270), (50, 0), (10, 90), (20, 180), (30, 270), (40, 0)):
                wanted = np.array([x, 0.0, 0.0])
                wanted[first] += radius * np.cos(np.radians(angle))
                wanted[second] += radius * np.sin(np.radians(angle))
                assert np.abs(ends - wanted).max(axis=1).min() < 1e-9
    assert np.hypot(np.hypot(ends[:, 1], ends[:, 2]), ends[:, 0] - 100 * (ends[:, 0] > 50)).max() <= 50 + 1e-9
