"""Starting from a line, stopping and resuming: AMB-EXE-2, #5081-#5096, the compile modes."""

from __future__ import annotations

import json
import random
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import aircut
from aircut.interpreter.running import Mode, Start
from aircut.machine import built_in
from aircut.machine.stops import Stop

LOOP = """\
G21 G90 G17 G54
G10 L2 P1 X100 Y50 Z-20
T2
S8000 M3 F600
G0 Z10
#1 = 0
WHILE [#1 LT 3] DO1
G0 X[#1*10] Y0
G1 Z-2
X[#1*10+5]
G0 Z10
#1 = [#1+1]
END1
G0 Z50
#10 = #<cnc.compile.mode>
#11 = #<cnc.compile.line>
#12 = #5081 #13 = #5082 #14 = #5083
#15 = #5091 #16 = #5092 #17 = #5093
M30
"""


def moves(result: Any) -> list[tuple[float, ...]]:
    """Ends of the moves, machine coordinates, X Y Z."""
    return [tuple(row) for row in np.round(result.toolpath.ends()[:, :3], 9).tolist()]


def codes(result: Any) -> list[str]:
    return [diagnostic.code for diagnostic in result.diagnostics if diagnostic.severity.value == "error"]


def test_from_a_line_in_a_loop_the_first_pass_is_entered_in_its_middle() -> None:
    """Line 10 cuts from X0 Z-2 to X5: before it the modes are read, then the machine goes there."""
    result = aircut.loads(LOOP).run(from_line=10)
    assert codes(result) == []
    # From the machine's origin at its height (nothing before was higher), over the place, down at the feed.
    assert moves(result)[:4] == [(100, 50, 0), (100, 50, -22), (105, 50, -22), (105, 50, -10)]
    assert moves(result)[4] == (110, 50, -10)
    whole = moves(aircut.loads(LOOP).run())
    assert moves(result)[2:] == whole[3:]
    assert result.arrival is not None and result.arrival.line == 10
    assert result.arrival.place[:3] == (0.0, 0.0, -2.0)
    assert {"G1", "G17", "G21", "G54", "G90"} <= set(result.arrival.modes)
    assert [code for code, _ in result.arrival.approach] == ["G0", "G1"]


def test_the_state_before_the_line_is_told() -> None:
    names = [event.name for event in aircut.loads(LOOP).run(from_line=10).events]
    start = names.index("START_SPINDLE_CLOCKWISE")
    assert "SET_SPINDLE_SPEED" in names[:start] and "SET_G5X_OFFSET" in names[:start]
    assert "SELECT_TOOL" in names and "SET_FEED_RATE" in names


def test_what_is_in_force_at_the_line_is_told_once_and_nothing_else() -> None:
    """The planner and the pictures live on what is told: path mode, dynamics, outputs, the last of each."""
    text = (
        "G21 G90 F100\nG64 P1\nG61\nG64 P0.5\nG104 A20 D30\nM62 P3\nM62 P4\nM63 P3\nM8\nM9\nG4 P1\nG0 X1\nG0 X2\nM2\n"
    )
    result = aircut.loads(text).run(from_line=13)
    start = [(e.name, e.values) for e in result.events if e.line == 13]
    assert ("SET_MOTION_CONTROL_BLEND", (0.5,)) in start
    names = [name for name, _ in start]
    assert "SET_MOTION_CONTROL_MODE" not in names and "DWELL" not in names and "FLOOD_ON" not in names
    assert names.count("SET_DYNAMICS") == 1
    assert ("CLEAR_MOTION_OUTPUT_BIT", (3,)) in start and ("SET_MOTION_OUTPUT_BIT", (4,)) in start
    assert ("SET_MOTION_OUTPUT_BIT", (3,)) not in start


def test_modes_and_restart_position_read_as_numbered_variables() -> None:
    result = aircut.loads(LOOP).run(from_line=10)
    read = [result.variables.get(number) for number in range(10, 18)]
    # Work coordinates of the point from which line 10 runs; nothing was stopped before.
    assert read == [Mode.FROM_LINE, 10.0, 0.0, 0.0, -2.0, None, None, None]
    whole = aircut.loads(LOOP).run().variables
    assert [whole.get(number) for number in range(10, 18)] == [Mode.PROGRAM, 0.0, *[None] * 6]


def test_a_line_that_is_blank_or_jumped_over_starts_at_the_next_that_runs() -> None:
    text = "G21 G90\nGOTO 7\nN5 G0 X1\nN6 G0 X2\nN7 G0 X3\n\n(nothing)\nG0 X4\nM2\n"
    assert moves(aircut.loads(text).run(from_line=3)) == [(3, 0, 0), (4, 0, 0)]
    assert moves(aircut.loads(text).run(from_line=6)) == [(3, 0, 0), (4, 0, 0)]


@pytest.mark.parametrize(("line", "code"), [(0, None), (9, "start-not-reached"), (11, "start-outside")])
def test_lines_that_cannot_be_started_from(line: int, code: str | None) -> None:
    """Ten lines; the subroutine of lines 8 to 10 is never called."""
    text = "G21 G90\nG0 X1\nG0 X2\nG0 X3\nG0 X4\nM2\n\nO100\nG0 Z1\nM99\n"
    if code is None:
        assert moves(aircut.loads(text).run()) == [(1, 0, 0), (2, 0, 0), (3, 0, 0), (4, 0, 0)]
        return
    result = aircut.loads(text).run(from_line=line)
    assert codes(result) == [code]
    assert moves(result) == []


def test_a_line_of_a_subroutine_starts_in_its_first_call() -> None:
    text = "G21 G90 F100\nG0 X1\nM98 P100\nM98 P100\nM2\nO100\nG91 G0 Y1\nG0 Z1\nG90\nM99\n"
    result = aircut.loads(text).run(from_line=8)
    assert moves(result) == [(1, 1, 0), (1, 1, 1), (1, 2, 1), (1, 2, 2)]


def test_the_start_is_refused_under_radius_compensation() -> None:
    text = "G21 G90 F100\nG41 D1\nG1 X10\nG1 X20\nG1 Y10\nG40\nG0 X0\nM2\n"
    result = aircut.loads(text).run(built_in(), from_line=4)
    assert codes(result) == ["start-compensated"]
    assert moves(result) == []


def test_nobody_is_asked_before_the_line() -> None:
    """Messages, waits and the probe before the start are compiled only: their results are null."""
    text = 'G21 G90 F100\nM109 P"go?"\nM66 P1 L3 Q1\nG38.2 Z-5\n#1 = #5700\nG0 X1\nM2\n'
    program = aircut.loads(text)
    asked = [item for item in program.interpreter(from_line=6).execute() if type(item).__name__ != "Chunk"]
    assert asked == []
    assert program.run(from_line=6).variables.get(1) is None


def test_the_approach_clears_what_was_highest() -> None:
    """The program was at Z30 before; the machine stands at its origin."""
    text = "G21 G90 F100\nG0 Z30\nG0 X10 Y10\nG0 Z2\nG1 Z-1\nG1 X20\nM2\n"
    result = aircut.loads(text).run(from_line=6)
    assert moves(result) == [(0, 0, 30), (10, 10, 30), (10, 10, -1), (20, 10, -1)]
    assert [code for code, _ in result.arrival.approach] == ["G0", "G0", "G1"]


def test_stopping_before_a_line_and_resuming_there_moves_the_same() -> None:
    program = aircut.loads(LOOP)
    whole = moves(program.run())
    stopped = program.run(stop_line=11)
    assert moves(stopped) == whole[:4]
    assert stopped.stop == Stop("<text>", 11, 4, (105.0, 50.0, -22.0, 0.0, 0.0, 0.0))
    rest = program.run(start=Start(11, 4, stopped.stop), mode=Mode.RESUME)
    # The machine still stands where it stopped: up, and back down to the place, then on.
    top = max(z for _, _, z in [*whole[:4], (0, 0, 0)][:4])
    assert moves(rest) == [(105, 50, top), (105, 50, -22), *whole[4:]]
    read = [rest.variables.get(number) for number in range(10, 18)]
    assert read == [Mode.RESUME, 11.0, 5.0, 0.0, -2.0, 105.0, 50.0, -22.0]


def test_resuming_counts_the_passes_of_a_loop() -> None:
    """Stopped in the second pass: by the moves made, not by the line alone."""
    program = aircut.loads(LOOP)
    whole = moves(program.run())
    stop = Stop("<text>", 10, 7, (110.0, 50.0, -22.0, 0.0, 0.0, 0.0))
    rest = program.run(start=Start(10, 7, stop), mode=Mode.RESUME)
    assert moves(rest)[2:] == whole[7:]


def test_a_fault_is_a_stop_before_its_line() -> None:
    text = "G21 G90 F100\nG0 X5\nM98 P100\nM2\nO100\nG0 Y5\nG2 X9\nM99\n"
    result = aircut.loads(text).run()
    assert result.stop == Stop("<text>", 3, 1, (5.0, 5.0, 0.0, 0.0, 0.0, 0.0))


def aircut_run(*words: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, "-m", "aircut", *words], capture_output=True, text=True, timeout=60)


def test_the_command_line_stops_remembers_and_resumes(tmp_path: Path) -> None:
    folder = tmp_path / "mill"
    folder.mkdir()
    (folder / "machine.toml").write_text("")
    file = tmp_path / "part.ngc"
    file.write_text(LOOP)
    common = ("--machine", str(folder), "--format", "json")
    first = json.loads(aircut_run("run", str(file), *common, "--stop-line", "11").stdout)
    assert first["stop"]["line"] == 11 and first["stop"]["machine"]["z"] == -22.0
    rest = json.loads(aircut_run("run", str(file), *common, "--resume").stdout)
    assert rest["start"]["line"] == 11 and rest["stop"] is None
    again = aircut_run("run", str(file), *common, "--resume")
    assert again.returncode == 2 and "no stop" in again.stderr
    other = aircut_run("run", str(file), "--resume")
    assert other.returncode == 2 and "--machine" in other.stderr


def test_resume_from_a_line_of_ones_own(tmp_path: Path) -> None:
    folder = tmp_path / "mill"
    folder.mkdir()
    (folder / "machine.toml").write_text("")
    file = tmp_path / "part.ngc"
    file.write_text(LOOP.replace("G0 Z50\n", "G0 Z50\n(mode)\nIF [#<cnc.compile.mode> NE 5] THEN G0 Z999\n"))
    common = ("--machine", str(folder), "--format", "json")
    aircut_run("run", str(file), *common, "--stop-line", "11")
    rest = json.loads(aircut_run("run", str(file), *common, "--resume", "--from-line", "14").stdout)
    assert rest["start"]["line"] == 14
    assert rest["extents"]["all"]["z"][1] == 30.0


def test_a_macro_may_end_without_an_end(tmp_path: Path) -> None:
    file = tmp_path / "touch.ngc"
    file.write_text("G21 G0 X1\n#<_a> = #<cnc.compile.mode>\nG0 Y#<_a>\n")
    done = aircut_run("run", str(file), "--as-macro", "--format", "json")
    report = json.loads(done.stdout)
    assert report["diagnostics"] == []
    assert report["extents"]["all"]["y"] == [0.0, float(Mode.MACRO)]
    plain = json.loads(aircut_run("run", str(file), "--format", "json").stdout)
    assert [d["code"] for d in plain["diagnostics"]] == ["no-program-end"]


def test_checking_compiles_for_analysis() -> None:
    text = "G21\nIF [#<cnc.compile.mode> EQ #<compile.mode_program_for_analysis>] THEN G0 X[1/0]\nM2\n"
    assert [d.code for d in aircut.loads(text).check()] == ["division-by-zero"]
    assert codes(aircut.loads(text).run()) == []


def test_the_stop_s_rotary_axes_and_unit() -> None:
    """Rotary axes in degrees, lengths in the unit in force: 50.8 mm are 2 inches."""
    read = "#1 = #5091 #2 = #5094 #3 = #5095 #4 = #5096\n#5 = #5081 #6 = #5084\n"
    text = "G21 G90 F100\nG0 X50.8 A30 B-40 C50\nG20\n" + read + "M2\n"
    program = aircut.loads(text)
    stop = program.run(built_in("XYZABC"), stop_line=4).stop
    assert stop is not None and stop.place == (50.8, 0.0, 0.0, 30.0, -40.0, 50.0)
    known = program.run(built_in("XYZABC"), start=Start(4, stop.moves, stop), mode=Mode.RESUME).variables
    assert [known[number] for number in range(1, 7)] == pytest.approx([2.0, 30.0, -40.0, 50.0, 2.0, 30.0])


@pytest.mark.parametrize("seed", range(60))
def test_what_follows_the_start_moves_as_in_the_whole_program(seed: int) -> None:
    """From any line: after the approach the rest of the whole run, to the last bit."""
    rng = random.Random(seed)
    changes = (
        "G20",
        "G21",
        "G91",
        "G90",
        "G55",
        "G52 X1 Y2",
        "G92 X3",
        "G18",
        "F70",
        "#1=[#5001+1]",
        "G81 X2 Y-3 Z-1 R1",
        "G80",
    )
    lines = ["G21 G90 G94 F500 G1"]
    for _ in range(rng.randint(5, 60)):
        words = [f"{axis}{rng.uniform(-20, 20):.3f}" for axis in rng.sample("XYZ", rng.randint(1, 3))]
        lines.append(
            rng.choice(changes) if rng.random() < 0.25 else rng.choice(("G0 ", "G1 ", "G1 ")) + " ".join(words)
        )
    program = aircut.loads("\n".join([*lines, "M2", ""]))
    whole = program.run()
    assert whole.ok
    part = program.run(from_line=rng.randint(1, len(lines)))
    assert part.ok and part.arrival is not None
    rest = part.toolpath.ends()[len(part.arrival.approach) :]
    assert np.array_equal(rest, whole.toolpath.ends()[len(whole.toolpath) - len(rest) :])
