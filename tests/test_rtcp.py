"""Tool center point control, from the program to the axes."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

import aircut
from aircut.canon import TIP, Kind
from aircut.export.seen import box, seen
from aircut.geometry.kinematics import MODELS, Setup, array_of, direction, forward
from aircut.machine import Machine, Tool
from aircut.machine.config import File, Options, RotaryTable, TiltingSpindle, axis_of
from test_kinematics import composed

TOLERANCE = 0.01
LETTERS = {2: "ac", 3: "bc", 4: "ca", 5: "ab"}
TOOL = (0.5, -0.25, 60.0)
ARMS = (3.0, -7.0, -40.0, 2.0, 20.0, 150.0, -1.0, 5.0, -180.0)  # D, H, J


def machine(model: int, inverse: str = "", rtcp: bool = True) -> Machine:
    """A machine of a model, its arms of odd lengths."""
    settings = {letter: {"convention": "inverse"} if letter in inverse else {} for letter in "xyz" + LETTERS[model]}
    axes = {letter: axis_of(letter, given) for letter, given in settings.items()}
    table, head = RotaryTable(*ARMS[:3]), TiltingSpindle(*ARMS[3:])
    file = File(
        kinematics=MODELS[model].name,  # type: ignore[arg-type]
        axes=axes,
        rotary_table=table,
        tilting_spindle=head,
        options=Options(rtcp=rtcp),
    )
    return Machine(file, {1: Tool(1, x=TOOL[0], y=TOOL[1], z=TOOL[2])}, own_tools=True)


def setup(model: int, inverse: str = "") -> Setup:
    return Setup(model, *TOOL, *ARMS, *(-1.0 if letter in inverse else 1.0 for letter in "abc"))


def axes_of(result: aircut.Result) -> NDArray[np.float64]:
    """Positions of the axes at the ends of the rows, the tool's offset included, (n, 6)."""
    return result.toolpath.ends() + np.array([*TOOL, 0.0, 0.0, 0.0])


@pytest.mark.parametrize("inverse", ["", "abc"])
@pytest.mark.parametrize("model", MODELS)
def test_ends_are_those_of_the_matrices(model: int, inverse: str) -> None:
    first, second = LETTERS[model].upper()
    moves = [(10, 20, 30, 40, -50), (10, 20, 30, -400, 90), (-100, 5, -3, 0, 12.5), (7, 8, 9, 0, 0)]
    text = "".join(f"G1 X{x} Y{y} Z{z} {first}{o} {second}{i} F500\n" for x, y, z, o, i in moves)
    result = aircut.loads(f"G43.4 H1\n{text}M2\n").run(machine(model, inverse))
    assert result.ok
    lines, axes = result.toolpath.line, axes_of(result)
    for line, (x, y, z, o, i) in enumerate(moves, 2):
        last = axes[np.flatnonzero(lines == line)[-1]]
        angles = {"a": 0.0, "b": 0.0, "c": 0.0, first.lower(): float(o), second.lower(): float(i)}
        assert last[:3] == pytest.approx(composed(setup(model, inverse), np.array([x, y, z]), angles), abs=1e-9)
        assert last[3:].tolist() == [angles[letter] for letter in "abc"]


def tips_along(model: int, result: aircut.Result, parts: int = 9) -> list[NDArray[np.float64]]:
    """Where the tip is at some places of each row when all axes move straight, (n, 3) for each place."""
    ends = axes_of(result)
    starts = np.vstack([np.zeros(6), ends[:-1]])
    found = []
    for part in np.linspace(0.0, 1.0, parts):
        place = starts + part * (ends - starts)
        found.append(array_of(forward(setup(model), place[:, :3].T, place[:, 3:].T)))
    return found


@pytest.mark.parametrize("model", MODELS)
def test_turning_alone_leaves_the_tip(model: int) -> None:
    first, second = LETTERS[model].upper()
    program = f"G43.4 H1\nG1 X50 Y-30 Z20 F500\n{first}90\n{second}-200\n{first}0 {second}0\nM2\n"
    result = aircut.loads(program).run(machine(model))
    turning = result.toolpath.line > 2
    assert turning.sum() > 20
    for tips in tips_along(model, result):
        assert np.abs(np.linalg.norm(tips[turning] - [50, -30, 20], axis=1)).max() <= TOLERANCE


@given(
    st.sampled_from(sorted(MODELS)),
    st.lists(st.tuples(*[st.integers(-300, 300)] * 3, *[st.integers(-400, 400)] * 2), min_size=1, max_size=4),
    st.sampled_from(["G0", "G1"]),
)
def test_the_tip_keeps_to_its_lines(model: int, moves: list[tuple[int, ...]], code: str) -> None:
    first, second = LETTERS[model].upper()
    lines = "".join(f"{code} X{x} Y{y} Z{z} {first}{o} {second}{i} F500\n" for x, y, z, o, i in moves)
    result = aircut.loads(f"G43.4 H1\n{lines}M2\n").run(machine(model))
    start = forward(setup(model), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    points = np.array([start, *(move[:3] for move in moves)], float)
    which = result.toolpath.line - 2
    a, b = points[which], points[which + 1]
    for tips in tips_along(model, result):
        along = np.einsum("ij,ij->i", tips - a, b - a) / np.maximum(np.einsum("ij,ij->i", b - a, b - a), 1e-12)
        foot = a + np.clip(along, 0.0, 1.0)[:, None] * (b - a)
        assert np.linalg.norm(tips - foot, axis=1).max() <= TOLERANCE
    assert (result.toolpath.flags & TIP).all()


@given(st.sampled_from(sorted(MODELS)), st.sampled_from([17, 18, 19]), st.integers(-90, 90), st.integers(-200, 200))
def test_the_tip_keeps_to_its_arcs(model: int, plane: int, o: int, i: int) -> None:
    """Two turns of a helix of radius 10 about (50, 20), a quarter less."""
    first, second = LETTERS[model].upper()
    axes = {17: "XYZ", 18: "ZXY", 19: "YZX"}[plane]
    center = {17: "I-10 J0", 18: "K-10 I0", 19: "J-10 K0"}[plane]
    program = (
        f"G43.4 H1 G{plane}\nG1 {axes[0]}60 {axes[1]}20 {axes[2]}0 {first}0 {second}0 F500\n"
        f"G3 {axes[0]}50 {axes[1]}30 {axes[2]}5 {center} {first}{o} {second}{i} P2\nM2\n"
    )
    result = aircut.loads(program).run(machine(model))
    assert result.ok, result.diagnostics
    u, v, w = ("XYZ".index(axis) for axis in axes)
    arc = result.toolpath.line == 3
    count = arc.sum()
    assert (result.toolpath.kind[arc] == Kind.FEED).all()
    along = tips_along(model, result)
    assert along[-1][arc][-1][[u, v, w]] == pytest.approx([50, 30, 5], abs=1e-9)
    for place, tips in enumerate(along):
        radius = np.hypot(tips[arc][:, u] - 50, tips[arc][:, v] - 20)
        assert np.abs(radius - 10).max() <= TOLERANCE
        height = 5 * (np.arange(count) + place / (len(along) - 1)) / count
        assert np.abs(tips[arc][:, w] - height).max() <= TOLERANCE
    angle = np.unwrap(np.arctan2(along[-1][arc][:, v] - 20, along[-1][arc][:, u] - 50))
    assert angle[-1] - angle[0] == pytest.approx(2.5 * math.pi * (1 - 1 / count))


def test_not_without_the_feature() -> None:
    result = aircut.loads("G43.4 H1\nM2\n").run(machine(2, rtcp=False))
    assert [d.code for d in result.diagnostics if d.severity.value == "error"] == ["no-rtcp"]


@pytest.mark.parametrize("model", MODELS)
def test_a_toolpath_tells_where_the_tip_is_on_the_part(model: int) -> None:
    """Lines keep their ends, whatever the rotary axes do; the tool's axis is where the matrices put it."""
    first, second = LETTERS[model].upper()
    program = f"""G43.4 H1
G1 X10 Y20 Z30 F500
G1 X10 Y20 Z30 {first}40 {second}-70
G1 X-50 Y0 Z5 {first}-10
G49
G1 {first}30
M2
"""
    result = aircut.loads(program).run(machine(model))
    toolpath = result.toolpath
    starts, ends = toolpath.tips()
    axes = toolpath.tool_axes()
    last = {line: np.flatnonzero(toolpath.line == line)[-1] for line in range(2, 7) if line != 5}
    assert ends[last[2]] == pytest.approx([10, 20, 30], abs=1e-9)
    assert ends[last[3]] == pytest.approx([10, 20, 30], abs=1e-9)
    assert ends[last[4]] == pytest.approx([-50, 0, 5], abs=1e-9)
    under = toolpath.line < 6
    assert starts[1:][under[1:]] == pytest.approx(ends[:-1][under[1:]], abs=1e-9)
    made = setup(model)
    for line, o, i in ((2, 0.0, 0.0), (3, 40.0, -70.0), (4, -10.0, -70.0), (6, 30.0, -70.0)):
        angles = {"a": 0.0, "b": 0.0, "c": 0.0, first.lower(): o, second.lower(): i}
        # A tool longer by 1 mm asks for axes that differ by the tool's axis, seen from the machine; the part is turned.
        longer = made._replace(tool_z=made.tool_z + 1.0)
        pose = tuple(angles[letter] for letter in "abc")
        there = composed(made, np.zeros(3), angles)
        tip = np.array(forward(longer, there, pose))
        assert axes[last[line]] == pytest.approx(-tip, abs=1e-9)
    # After G49 the holder is followed: where the tip was, and the tool's length along its axis.
    begin = starts[last[6]]
    assert np.linalg.norm(begin - [-50, 0, 5]) == pytest.approx(np.linalg.norm(TOOL))
    _, machine_ends = toolpath.machine_axes()
    assert machine_ends[last[6]][:3] == pytest.approx(machine_ends[last[4]][:3])


def test_rows_take_as_long_as_the_tip() -> None:
    """F is the tip's speed on the part: time is its way over F, or degrees over F where it stands still."""
    program = "G43.4 H1\nG0 X100 Y0 Z0\nG1 X150 A30 C-100 F250\nG1 A0 F90\nG3 X-150 I-150 C0 F600\nM2\n"
    result = aircut.loads(program).run(machine(2))
    toolpath = result.toolpath
    minutes = toolpath.lengths() / np.where(toolpath.feed > 0, toolpath.feed, np.inf)
    for line, wanted in ((3, 50 / 250), (4, 30 / 90), (5, math.pi * 150 / 600)):
        assert minutes[toolpath.line == line].sum() == pytest.approx(wanted, rel=1e-4)


def test_pictures_show_the_part_and_the_tool() -> None:
    """A tilted cut: what is drawn is where the tip goes on the part, and lines of a length along the tool."""
    program = "G43.4 H1\nG0 X10 Y20 Z30 A40 C-70\nG1 X50 F500\nG3 Y40 J10\nM2\n"
    toolpath = aircut.loads(program).run(machine(2)).toolpath
    shown = seen(toolpath, 1000, 20)
    assert shown.part and len(shown.tools) == 20
    cut = toolpath.kind[np.maximum(shown.move, 0)] != Kind.TRAVERSE
    assert shown.points[cut][0][1:] == pytest.approx([20, 30], abs=1e-6)
    assert shown.points[cut][-1] == pytest.approx([50, 40, 30], abs=1e-6)
    lean = shown.tools[:, 1] - shown.tools[:, 0]
    lengths = np.linalg.norm(lean, axis=1)
    assert lengths == pytest.approx(np.full(20, lengths[0]))
    assert lean / lengths[:, None] == pytest.approx(np.tile(direction(setup(2), (40.0, 0.0, -70.0)), (20, 1)), abs=1e-6)
    low, high = box(toolpath, shown, False) or [[0.0], [0.0]]
    assert low[0] < 10 + 1e-6 and high[0] >= 59.9  # the half turn reaches X60
    flat = aircut.loads("G0 X1\nG1 X2 F9\nM2\n").run(machine(2)).toolpath
    assert not seen(flat, 10, 5).part and not len(seen(flat, 10, 5).tools)
