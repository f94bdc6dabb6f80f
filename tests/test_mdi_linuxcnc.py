"""MDI in LinuxCNC's language: commands one by one, with what the ones before left."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from aircut import dialects
from aircut.interpreter.mdi import Session


@pytest.fixture
def desk() -> Session:
    language = dialects.load("linuxcnc")
    return Session(language, dialects.machine(language))


def run(desk: Session, command: str) -> list[str]:
    """The codes of the faults."""
    for _ in desk.run(command):
        pass
    return [diagnostic.code for diagnostic in desk.diagnostics]


def position(desk: Session) -> list[float]:
    return desk.interpreter.state.position[:3]


def test_modes_positions_names_and_numbers_stay(desk: Session) -> None:
    for command in ("G20 G91 F10", "G1 X1", "X1", "#<depth> = 3", "#<_g> = 1", "#500 = 6 #3 = 1"):
        assert run(desk, command) == []
    assert run(desk, "G90 Y[#<depth> + #<_g> + #500 - #3]") == []
    assert position(desk) == pytest.approx([2 * 25.4, 9 * 25.4, 0])
    assert set(desk.interpreter.standing()) >= {"G1", "G20", "G90"}


def test_a_fault_stops_one_command_only(desk: Session) -> None:
    assert run(desk, "G0 X5 F100") == []
    assert run(desk, "G2 X9") == ["arc-no-center"]
    assert run(desk, "G0 Y5") == []
    assert position(desk)[:2] == [5.0, 5.0]


def test_a_fault_in_a_subroutine_leaves_no_call_open(desk: Session, tmp_path: Path) -> None:
    (tmp_path / "inner.ngc").write_text("o<inner> sub\n#1 = 4\nM73 G0 X1\nG91 G2 X9\no<inner> endsub\n")
    desk.interpreter.folders.append(tmp_path)
    assert run(desk, "#1 = 7 F100") == []
    assert run(desk, "o<inner> call [3]") == ["arc-no-center"]
    assert desk.interpreter.state.calls == 0
    assert run(desk, "G90 G0 X#1") == []
    assert position(desk)[0] == 7.0


def test_a_subroutine_of_a_file_gives_back_its_value(desk: Session, tmp_path: Path) -> None:
    (tmp_path / "twice.ngc").write_text("o<twice> sub\no<twice> endsub [2*#1]\n")
    desk.interpreter.folders.append(tmp_path)
    for _ in range(4):  # a compiled one, too
        assert run(desk, "o<twice> call [4]") == []
    assert run(desk, "G0 X#<_value>") == []
    assert position(desk)[0] == 8.0


def test_a_structure_over_several_lines_of_one_command(desk: Session) -> None:
    assert run(desk, "#1=0\no1 while [#1 lt 3]\nG91 G0 X1\n#1=[#1+1]\no1 endwhile\nG90") == []
    assert position(desk)[0] == 3.0
    assert run(desk, "o1 if [0]") == ["o-word"]
    assert run(desk, "G0 X1") == []


def test_an_end_resets_the_modes_and_commands_go_on(desk: Session) -> None:
    """As LinuxCNC's manual says of M2: G54, G17, G90, G94, G40, G1."""
    assert run(desk, "G91 G18 G55 G95 S10 F100") == []
    assert run(desk, "G41.1 D1") == []
    assert run(desk, "M2") == []
    modes, compensation = desk.interpreter.in_force()
    assert {"G1", "G17", "G54", "G90", "G94"} <= set(modes) and compensation == "G40"
    assert run(desk, "X1") == ["missing-feed"]
    assert run(desk, "X1 F10") == []
    assert position(desk)[0] == 1.0


def test_what_is_piped(tmp_path: Path) -> None:
    typed = "G0 X2 F9\n#3=4\n?#3*2\n?\nG2 X9\nG0 X3\n"
    done = subprocess.run(
        [sys.executable, "-m", "aircut", "mdi", "--dialect", "linuxcnc"],
        input=typed, capture_output=True, text=True, timeout=60, cwd=tmp_path,
    )  # fmt: skip
    lines = done.stdout.splitlines()
    assert lines[1].endswith("STRAIGHT_TRAVERSE(2.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000)")
    assert lines[2] == "8" and lines[3].startswith("X2.0000 Y0.0000") and "STRAIGHT_TRAVERSE(3.0000" in lines[4]
    assert done.returncode == 1 and "arc-no-center" in done.stderr


def test_a_contour_that_its_command_leaves_too_narrow_is_a_fault_of_it(desk: Session) -> None:
    """A tool of radius 2 in a left turn; the last move is 1 mm long."""
    assert run(desk, "F100 G41.1 D4\nG1 X0 Y5\nG1 X10\nG1 Y6") == ["gouging-corner"]
    assert run(desk, "G40") == []
    assert run(desk, "G0 X3") == []
