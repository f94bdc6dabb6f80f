"""Starting LinuxCNC's programs from a line, stopping before one and resuming, as RosettaCNC's do (AMB-EXE-2)."""

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
from aircut.machine.stops import Stop

LOOP = """\
G21 G90 G17 G54
G10 L2 P1 X100 Y50 Z-20
T2
S8000 M3 F600
G0 Z10
#1 = 0
O1 while [#1 LT 3]
G0 X[#1*10] Y0
G1 Z-2
X[#1*10+5]
G0 Z10
#1 = [#1+1]
O1 endwhile
G0 Z50
M30
"""
CALLS = """\
G21 G90 F100
O100 sub
G91 G0 Y1
G0 Z1
G90
O100 endsub
G0 X1
O100 call
O100 call
M2
"""
FANUC = "G21 G90 F100\nG0 X1\nM98 P100\nM98 P100\nM2\nO100\nG91 G0 Y1\nG0 Z1\nG90\nM99\n"


def moves(result: Any) -> list[tuple[float, ...]]:
    """Ends of the moves, machine coordinates, X Y Z."""
    return [tuple(row) for row in np.round(result.toolpath.ends()[:, :3], 9).tolist()]


def codes(result: Any) -> list[str]:
    return [diagnostic.code for diagnostic in result.diagnostics if diagnostic.severity.value == "error"]


def run(text: str, **settings: Any) -> Any:
    return aircut.loads(text, "linuxcnc").run(**settings)


def test_from_a_line_in_a_loop_the_first_pass_is_entered_in_its_middle() -> None:
    """Line 10 cuts from X0 Z-2 to X5: over the place at the height of before, down at the feed."""
    result = run(LOOP, from_line=10)
    assert codes(result) == []
    assert moves(result)[:4] == [(100, 50, 0), (100, 50, -22), (105, 50, -22), (105, 50, -10)]
    assert moves(result)[2:] == moves(run(LOOP))[3:]
    assert result.arrival.line == 10 and result.arrival.place[:3] == (0.0, 0.0, -2.0)
    assert {"G1", "G17", "G21", "G54", "G90"} <= set(result.arrival.modes)
    names = [event.name for event in result.events]
    start = names.index("START_SPINDLE_CLOCKWISE")
    assert {"SET_SPINDLE_SPEED", "SET_G5X_OFFSET", "SET_FEED_RATE"} <= set(names[:start]) and "SELECT_TOOL" in names


@pytest.mark.parametrize(("text", "line"), [(CALLS, 4), (FANUC, 8)])
def test_a_line_of_a_subroutine_starts_in_its_first_call(text: str, line: int) -> None:
    assert moves(run(text, from_line=line)) == [(1, 1, 0), (1, 1, 1), (1, 2, 1), (1, 2, 2)]


def test_a_line_behind_a_definition_is_one_of_the_main_program() -> None:
    assert moves(run(CALLS, from_line=8)) == [(1, 0, 0), (1, 1, 0), (1, 1, 1), (1, 2, 1), (1, 2, 2)]


@pytest.mark.parametrize(("line", "code"), [(9, "start-not-reached"), (12, "start-outside")])
def test_lines_that_cannot_be_started_from(line: int, code: str) -> None:
    result = run("G21 G90\nG0 X1\nG0 X2\nG0 X3\nG0 X4\nM2\n\nO100 sub\nG0 Z1\nO100 endsub\n", from_line=line)
    assert codes(result) == [code]
    assert moves(result) == []


def test_the_start_is_refused_under_radius_compensation() -> None:
    result = run("G21 G90 F100\nG41.1 D1\nG1 X10\nG1 X20\nG1 Y10\nG40\nG0 X0\nM2\n", from_line=4)
    assert codes(result) == ["start-compensated"]
    assert moves(result) == []


def test_nobody_is_asked_before_the_line_and_nothing_logged() -> None:
    text = "G21 G90 F100\n(logopen,a.txt)\n(log,one)\nM66 P1 L3 Q1\nG38.2 Z-5\nG0 X1\n(log,two)\nG0 X2\nM2\n"
    made = aircut.loads(text, "linuxcnc").interpreter(from_line=7)
    assert [item for item in made.execute() if type(item).__name__ != "Chunk"] == []
    assert made.logs()["a.txt"].lines == ["two"]


def test_stopped_before_a_line_and_resumed_the_moves_are_those_of_the_whole_program() -> None:
    whole = moves(run(LOOP))
    stopped = run(LOOP, stop_line=11)
    assert moves(stopped) == whole[:4]
    assert stopped.stop == Stop("<text>", 11, 4, (105.0, 50.0, -22.0, 0.0, 0.0, 0.0))
    rest = run(LOOP, start=Start(11, 4, stopped.stop), mode=Mode.RESUME)
    assert moves(rest)[2:] == whole[4:]


def test_a_fault_is_a_stop_before_its_line_or_the_call() -> None:
    text = "G21 G90 F100\nG0 X5\nM98 P100\nM2\nO100\nG0 Y5\nG2 X9\nM99\n"
    assert run(text).stop == Stop("<text>", 3, 1, (5.0, 5.0, 0.0, 0.0, 0.0, 0.0))


def test_a_fault_in_a_compiled_loop_counts_the_moves_before_its_call() -> None:
    """The fifth pass divides by zero in the subroutine; each pass moves twice, once in the call."""
    text = """G21 G90 F100
O5 sub
G0 X[1/#1]
O5 endsub
#1=5
O1 while [1]
#1=[#1-1]
G0 Y[#1]
O5 call [#1]
O1 endwhile
M2
"""
    result = run(text)
    assert not result.ok
    assert (result.stop.line, result.stop.moves) == (9, 9)


def test_the_command_line_stops_remembers_and_resumes(tmp_path: Path) -> None:
    folder = tmp_path / "mill"
    folder.mkdir()
    (folder / "machine.toml").write_text("")
    file = tmp_path / "part.ngc"
    file.write_text(LOOP.replace("T2", ""))
    common = (str(file), "--dialect", "linuxcnc", "--machine", str(folder), "--format", "json")

    def told(*words: str) -> Any:
        command = [sys.executable, "-m", "aircut", "run", *common, *words]
        return json.loads(subprocess.run(command, capture_output=True, text=True, timeout=60).stdout)

    first = told("--stop-line", "11")
    assert first["stop"]["line"] == 11 and first["stop"]["machine"]["z"] == -22.0
    rest = told("--resume")
    assert rest["start"]["line"] == 11 and rest["stop"] is None


@pytest.mark.parametrize("seed", range(60))
def test_what_follows_the_start_moves_as_in_the_whole_program(seed: int) -> None:
    """From any line: after the approach the rest of the whole run."""
    rng = random.Random(seed)
    changes = ("G20", "G21", "G91", "G90", "G55", "G52 X1 Y2", "G92 X3", "G18", "F70", "#1=[#5420+1]", "G7", "G8",
               "G10 L2 P2 R30 X1", "O1 call [3]", "T1 M6", "G43 H1", "G49", "G90 G81 X2 Y-3 Z-1 R1\nG80")  # fmt: skip
    lines = ["G21 G90 G94 F500 G1", "O1 sub", "G0 X#1", "O1 endsub", "G1"]
    for _ in range(rng.randint(5, 60)):
        words = [f"{axis}{rng.uniform(-20, 20):.3f}" for axis in rng.sample("XYZ", rng.randint(1, 3))]
        lines.append(
            rng.choice(changes) if rng.random() < 0.25 else rng.choice(("G0 ", "G1 ", "G1 ")) + " ".join(words)
        )
    text = "\n".join([*lines, "M2", ""])
    whole = run(text)
    assert whole.ok, whole.diagnostics
    part = run(text, from_line=rng.randint(5, text.count("\n") - 1))
    assert part.ok and part.arrival is not None
    rest = part.toolpath.ends()[len(part.arrival.approach) :]
    assert np.array_equal(rest, whole.toolpath.ends()[len(whole.toolpath) - len(rest) :])
