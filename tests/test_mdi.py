"""MDI: commands one by one, typed or piped."""

from __future__ import annotations

import os
import select
import subprocess
import sys
import time
from pathlib import Path

import pytest

from aircut import dialects
from aircut.interpreter.mdi import Session
from aircut.machine import built_in


def session() -> Session:
    return Session(dialects.load("rosetta"), built_in())


def run(desk: Session, command: str) -> list[str]:
    """The codes of the faults."""
    for _ in desk.run(command):
        pass
    return [diagnostic.code for diagnostic in desk.diagnostics]


def aircut(*words: str, typed: str = "") -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "aircut", *words], input=typed, capture_output=True, text=True, timeout=60
    )


def test_modes_positions_and_global_names_stay() -> None:
    desk = session()
    m = desk.interpreter.state
    for command in ("G20 G91 F10", "G1 X1", "X1", "#<depth> = 3", "#500 = 7", "G90 Y[#<depth> + #500]"):
        assert run(desk, command) == []
    assert m.position[:2] == pytest.approx([2 * 25.4, 10 * 25.4])
    assert m.modal[desk.interpreter.dialect.codes["g20"].group].name == "G20"


def test_local_names_and_local_numbers_are_each_command_s_own() -> None:
    """AMB-NAM-15."""
    desk = session()
    assert run(desk, "#<_a> = 1 #1 = 2") == []
    assert run(desk, "#2 = #<_a>") == ["undefined-name"]
    assert run(desk, "G0 X#1") == ["null-value"]


def test_the_compile_mode_is_mdi() -> None:
    desk = session()
    assert run(desk, "G0 X#<cnc.compile.mode> Y[#<cnc.compile.mode> EQ #<compile.mode_mdi>]") == []
    assert desk.interpreter.state.position[:2] == [0.0, 1.0]


def test_a_fault_stops_one_command_only() -> None:
    desk = session()
    assert run(desk, "G0 X5") == []
    assert run(desk, "G2 X9") == ["arc-no-center"]
    assert run(desk, "G0 Y5") == []
    assert desk.interpreter.state.position[:2] == [5.0, 5.0]


def test_a_fault_in_a_macro_leaves_no_call_open(tmp_path: Path) -> None:
    machine = built_in()
    (tmp_path / "inner.ngc").write_text("#1 = 4\nG0 X1\nG2 X9\nM99\n")
    machine.macros = (tmp_path,)
    desk = Session(dialects.load("rosetta"), machine)
    assert run(desk, 'G65 P"inner"') == ["arc-no-center"]
    assert desk.interpreter.state.calls == 0
    assert run(desk, "G0 X3") == []
    assert run(desk, "M99") == []
    assert desk.interpreter.state.position[0] == 3.0


def test_an_end_resets_the_modes() -> None:
    desk = session()
    assert run(desk, "G20 G91") == []
    assert run(desk, "M30") == []
    assert run(desk, "G0 X1") == []
    assert run(desk, "G0 X1") == []
    assert desk.interpreter.state.position[0] == 1.0


def test_commands_of_the_command_line_run_in_turn() -> None:
    done = aircut("run", "--mdi", "G91 G1 X5 F100", "--mdi", "X5")
    assert done.returncode == 0
    moves = [line.split(" ", 1)[1] for line in done.stdout.splitlines() if "STRAIGHT_FEED" in line]
    assert [move[move.index("(") :] for move in moves] == [
        "(5.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000)",
        "(10.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000)",
    ]


def test_one_with_an_error_ends_the_row() -> None:
    done = aircut("run", "--mdi", "G0 X5", "--mdi", "G2", "--mdi", "G2 X9", "--mdi", "G0 X7")
    assert done.returncode == 1
    assert "X7" not in done.stdout and "7.0000" not in done.stdout
    assert "mdi:1:1: error arc-no-center" in done.stderr


def test_a_file_and_commands_exclude_each_other() -> None:
    assert aircut("run").returncode == 2
    assert aircut("run", "part.ngc", "--mdi", "G0").returncode == 2
    assert aircut("run", "--mdi", "G0", "--format", "json").returncode == 2
    assert aircut("run", "--mdi", "G0", "--from-line", "2").returncode == 2
    assert aircut("run", "part.ngc", "--as-macro", "--from-line", "2").returncode == 2


def test_piped_commands_answer_questions() -> None:
    done = aircut("mdi", typed="#<r> = 2\n?sqrt[#<r>*2]\n?#<nope>\n?#5700\nG20\nG0 X1\n?#5001\n?\n")
    assert done.returncode == 1  # one question had a fault
    told = [line for line in done.stdout.splitlines() if "(" not in line]
    assert told[:3] == ["2", "null", "1"]
    assert told[3].startswith("X1.0000 Y0.0000 Z0.0000  ") and "G20" in told[3]
    assert "undefined-name" in done.stderr


def test_the_machine_remembers_what_was_typed(tmp_path: Path) -> None:
    (tmp_path / "machine.toml").write_text("")
    assert aircut("mdi", "--machine", str(tmp_path), typed="#4000 = 12.5\nG10 L2 P1 X7\n").returncode == 0
    done = aircut("mdi", "--machine", str(tmp_path), typed="?#4000\n?#5221\n")
    assert done.stdout.split() == ["12.5", "7"]


def test_a_probe_of_the_world_answers(tmp_path: Path) -> None:
    world = tmp_path / "world.toml"
    world.write_text("[[bodies]]\nshape = 'box'\nat = [-10, -10, -20]\nsize = [20, 20, 15]\n")
    done = aircut("mdi", "--world", str(world), typed="G38.2 Z-15 F100\n?#5063\n?#5700\n")
    assert done.stderr == "" and done.stdout.splitlines()[-1] == "1"


def test_on_a_terminal_with_history_and_completion(tmp_path: Path) -> None:
    import pty

    pid, terminal = pty.fork()
    if pid == 0:
        os.environ |= {"HOME": str(tmp_path), "XDG_CONFIG_HOME": str(tmp_path), "TERM": "xterm"}
        os.execv(sys.executable, [sys.executable, "-m", "aircut", "mdi"])
    shown = b""

    def wait_for(text: bytes) -> None:
        nonlocal shown
        limit = time.monotonic() + 20
        while text not in shown and time.monotonic() < limit:
            if select.select([terminal], [], [], 0.2)[0]:
                try:
                    shown += os.read(terminal, 65536)
                except OSError:
                    break
            if b"\x1b[6n" in shown:  # where is the cursor?
                os.write(terminal, b"\x1b[1;1R")
                shown = shown.replace(b"\x1b[6n", b"")
        assert text in shown, shown

    wait_for(b"mdi>")
    os.write(terminal, b"G0 X12.5\r")
    wait_for(b"12.5000")
    shown = b""
    os.write(terminal, b"\x1b[A")  # up: the command before
    wait_for(b"G0 X12.5")
    os.write(terminal, b"\r")
    wait_for(b"12.5000")
    os.write(terminal, b"\x04")
    _, status = os.waitpid(pid, 0)
    assert status == 0
    assert "G0 X12.5" in (tmp_path / "aircut" / "mdi_history").read_text()
