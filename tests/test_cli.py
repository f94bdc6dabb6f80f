"""The commands, run as a user runs them."""

import json
import os
import subprocess
import sys
from pathlib import Path

import click
import pytest
from click.testing import CliRunner

from aircut.cli.main import cli

GOOD = "G21 G90\nG0 X10 Y5\nG1 X20 F100\nM2\n"
BAD = "G0 X1\nG1 X2 K3 F100\n#1=[1/0]\nM2\n"


@pytest.fixture
def good(tmp_path: Path) -> Path:
    path = tmp_path / "good.ngc"
    path.write_text(GOOD)
    return path


@pytest.fixture
def bad(tmp_path: Path) -> Path:
    path = tmp_path / "bad.ngc"
    path.write_text(BAD)
    return path


def invoke(*args: object, status: int = 0) -> str:
    result = CliRunner().invoke(cli, [str(a) for a in args], catch_exceptions=False)
    assert result.exit_code == status, result.output
    return result.output


def command(*args: object) -> subprocess.CompletedProcess[str]:
    """The installed command in a process of its own."""
    return subprocess.run(
        [sys.executable, "-m", "aircut", *map(str, args)], capture_output=True, text=True, timeout=120
    )


def test_summary_tells_extents_and_lengths(good: Path) -> None:
    output = invoke("run", good)
    assert "X mm" in output and "20.000" in output
    assert "11.180 mm rapid, 10.000 mm feed" in output  # √(10² + 5²); 20 - 10


def test_canon_is_laid_out_as_the_oracle_prints(good: Path) -> None:
    lines = invoke("run", good, "--format", "canon").splitlines()
    assert lines[0] == "    1 N..... USE_LENGTH_UNITS(CANON_UNITS_MM)"
    assert lines[7] == "    8 N..... STRAIGHT_TRAVERSE(10.0000, 5.0000, 0.0000, 0.0000, 0.0000, 0.0000)"
    assert lines[-1].endswith("ON_RESET()")


def test_json_report(good: Path, tmp_path: Path) -> None:
    out = tmp_path / "report.json"
    assert invoke("run", good, "--format", "json", "-o", out) == ""
    report = json.loads(out.read_text())
    assert report["version"] == 1 and report["ok"]
    assert report["extents"]["feed"]["x"] == [10.0, 20.0]
    assert report["length"] == {"rapid": pytest.approx(125**0.5), "feed": 10.0}
    assert report["counts"]["moves"] == 2


def test_check_tells_all_faults_at_once(bad: Path) -> None:
    lines = invoke("check", "--ignore", "no-units", bad, status=1).splitlines()
    assert [line.removeprefix(str(bad)) for line in lines] == [
        ":2:7: error unused-word: nothing in this block uses K",
        ":3:5: error division-by-zero: division by zero",
    ]


def test_check_on_a_terminal_marks_the_place(bad: Path) -> None:
    import io

    from aircut.api import load
    from aircut.cli import common

    class Terminal(io.StringIO):
        def isatty(self) -> bool:
            return True

    out = Terminal()
    program = load(bad)
    common.show(program.check(ignore=["no-units"])[:1], lambda _file, line: program.source.text(line - 1), out)
    text, line, mark = click.unstyle(out.getvalue()).splitlines()[:3]
    assert "unused-word" in text
    assert line == "    2 | G1 X2 K3 F100"
    assert mark.index("^") == line.index("K3") and mark.count("^") == 2


def test_check_many_files(good: Path, bad: Path) -> None:
    assert invoke("check", "--ignore", "spindle-off", good) == ""
    assert "bad.ngc:2:7" in invoke("check", good, bad, status=1)


def test_check_formats(bad: Path) -> None:
    data = json.loads(invoke("check", bad, "--ignore", "no-units", "--format", "json", status=1))
    assert [d["code"] for d in data["diagnostics"]] == ["unused-word", "division-by-zero"]
    sarif = json.loads(invoke("check", bad, "--ignore", "no-units", "--format", "sarif", status=1))
    region = sarif["runs"][0]["results"][0]["locations"][0]["physicalLocation"]["region"]
    assert region == {"startLine": 2, "startColumn": 7, "endColumn": 9}
    assert invoke("check", bad, "--ignore", "no-units", "--format", "github", status=1).startswith("::error file=")


def test_run_stops_at_the_first_error(bad: Path) -> None:
    done = command("run", bad, "--format", "canon")
    assert done.returncode == 1
    assert "unused-word" in done.stderr and "division-by-zero" not in done.stderr
    assert done.stdout.splitlines()[-2:] == ["    8 N..... ON_RESET()", "    9 N..... ON_RESET()"]


@pytest.mark.parametrize(
    "args",
    [
        ("run",),
        ("run", "x.ngc", "--format", "pdf"),
        ("run", "x.ngc", "--axes", "XQ"),
        ("run", "x.ngc", "--machine", "nowhere"),
        ("plot", "x.ngc", "-o", "x.bmp"),
        ("nonsense",),
    ],
)
def test_wrong_usage_is_status_2(args: tuple[str, ...]) -> None:
    done = command(*args)
    assert done.returncode == 2 and "Traceback" not in done.stderr


def test_a_missing_file_is_an_error_of_the_program(tmp_path: Path) -> None:
    done = command("check", tmp_path / "none.ngc")
    assert done.returncode == 1
    assert "error cannot-read" in done.stdout


def test_an_output_that_cannot_be_written(good: Path, tmp_path: Path) -> None:
    done = command("run", good, "-o", tmp_path / "none" / "out.txt")
    assert done.returncode == 1 and "cannot write" in done.stderr and "Traceback" not in done.stderr


@pytest.mark.parametrize("kind", ["png", "svg", "html"])
def test_plot(good: Path, tmp_path: Path, kind: str) -> None:
    out = tmp_path / f"picture.{kind}"
    invoke("plot", good, "-o", out)
    head = out.read_bytes()[:200]
    assert {"png": b"\x89PNG", "svg": b"<?xml", "html": b"<!doctype html>"}[kind] in head.replace(
        b"DOCTYPE", b"doctype"
    )


def test_axes_of_the_built_in_machine(tmp_path: Path) -> None:
    program = tmp_path / "rotary.ngc"
    program.write_text("G0 A90\nM2\n")
    assert "no A axis" in invoke("check", program, status=1)
    assert invoke("check", program, "--axes", "XYZA") == ""


def test_parameters_are_read_and_written_back(tmp_path: Path) -> None:
    program, file = tmp_path / "p.ngc", tmp_path / "p.var"
    program.write_text("G0 X1\n#4001 = [#4000 + 1]\nG10 L2 P1 X7\nM2\n")
    file.write_text("4000\t41.0\n5221\t5.0\n")
    assert "STRAIGHT_TRAVERSE(1.0000" in invoke("run", program, "--parameters", file, "--format", "canon")
    values = dict(line.split() for line in file.read_text().splitlines())
    assert values["4001"] == "42.000000" and values["5221"] == "7.000000"
    assert (tmp_path / "p.var.bak").read_text() == "4000\t41.0\n5221\t5.0\n"


def test_parameters_out_of_order_are_refused_and_kept(tmp_path: Path, good: Path) -> None:
    file = tmp_path / "p.var"
    file.write_text("5221 1\n4000 2\n")
    done = command("run", good, "--parameters", file)
    assert done.returncode == 2 and "out of order" in done.stderr
    assert file.read_text() == "5221 1\n4000 2\n"


def test_a_machine_folder_remembers(tmp_path: Path) -> None:
    (tmp_path / "machine.toml").write_text('name = "mill"\n[axes.X]\n[axes.Y]\n[axes.Z]\n')
    program = tmp_path / "p.ngc"
    program.write_text("#4000 = 3\nG10 L2 P2 X5\nG28.1\nM2\n")
    invoke("run", program, "--machine", tmp_path)
    program.write_text("#500 = #4000\nG55\nG0 X1\n#501 = #5221\n#502 = #5241\nM2\n")
    from aircut.api import load
    from aircut.machine import load as load_machine

    result = load(program).run(load_machine(tmp_path))
    assert result.variables[500] == 3.0 and result.variables[502] == 5.0
    assert result.toolpath.x.tolist() == [6.0]


def test_machine_files_with_faults_are_told(tmp_path: Path, good: Path) -> None:
    (tmp_path / "machine.toml").write_text("name = 3\n")
    done = command("run", good, "--machine", tmp_path)
    assert done.returncode == 2 and "machine.toml" in done.stderr and "Traceback" not in done.stderr


def test_own_tools(tmp_path: Path) -> None:
    tools, program = tmp_path / "tools.toml", tmp_path / "p.ngc"
    tools.write_text("[[tools]]\nid = 7\nz = 50\n")
    program.write_text("T7 M6\nM2\n")
    invoke("check", program, "--tools", tools)
    program.write_text("T8 M6\nM2\n")
    assert "error unknown-tool" in invoke("check", program, "--tools", tools, status=1)
    assert "warning unknown-tool" in invoke("check", program)


def test_optional_stop(tmp_path: Path) -> None:
    program = tmp_path / "p.ngc"
    program.write_text("M0\nM1\nM1\nM2\n")
    assert json.loads(invoke("run", program, "--format", "json"))["counts"]["stops"] == 1
    assert json.loads(invoke("run", program, "--format", "json", "--optional-stop"))["counts"]["stops"] == 3
    assert "3, waiting for the operator" in invoke("run", program, "--optional-stop")


def test_block_delete(tmp_path: Path) -> None:
    program = tmp_path / "p.ngc"
    program.write_text("G0 X1\n/G0 X2\nM2\n")
    assert invoke("run", program, "--format", "canon").count("TRAVERSE") == 2
    assert invoke("run", program, "--format", "canon", "--block-delete").count("TRAVERSE") == 1


def test_interrupted_output_leaves_nothing_behind(tmp_path: Path) -> None:
    """Ctrl-C during a run: status 130, the old output untouched, no temporary file."""
    import signal
    import time

    program, out = tmp_path / "p.ngc", tmp_path / "out.txt"
    program.write_text("#1=0\nWHILE [#1 GE 0] DO1\n#1=[#1+1]\nG91 G0 X0.001\nG0 X-0.001\nEND1\nM2\n")
    out.write_text("old")
    process = subprocess.Popen(
        [sys.executable, "-m", "aircut", "run", str(program), "--format", "canon", "-o", str(out)],
        stderr=subprocess.PIPE, text=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),  # a shell's background jobs ignore it
    )  # fmt: skip
    time.sleep(2)
    process.send_signal(signal.SIGINT)
    _, errors = process.communicate(timeout=60)
    assert process.returncode == 130 and "Traceback" not in errors
    assert out.read_text() == "old"
    assert sorted(os.listdir(tmp_path)) == ["out.txt", "p.ngc"]


def test_help_and_check_load_nothing_heavy(good: Path) -> None:
    code = "import sys; from aircut.cli.main import cli; cli({!r}, standalone_mode=False); print(sorted(sys.modules))"
    for args in (["--help"], ["check", str(good)]):
        done = subprocess.run([sys.executable, "-c", code.format(args)], capture_output=True, text=True)
        for heavy in ("'numpy'", "'matplotlib'", "'rich'", "'sqlite3'"):
            assert heavy not in done.stdout, heavy


def test_a_machine_folder_remembers_changed_tools(tmp_path: Path) -> None:
    (tmp_path / "machine.toml").write_text('name = "mill"\n')
    (tmp_path / "tools.toml").write_text("[[tools]]\nid = 1\nz = 50\n\n[[tools]]\nid = 2\n")
    program = tmp_path / "p.ngc"
    program.write_text("G10 L1 P1 Z60 D6\nG10 L1 P3 Z30\nM2\n")
    invoke("run", program, "--machine", tmp_path)
    from aircut.machine import load

    tools = load(tmp_path).tools
    assert (tools[1].z, tools[1].diameter, tools[3].z) == (60.0, 6.0, 30.0)
    assert sorted(tools) == [1, 2, 3]


def test_encrypted_macros(tmp_path: Path) -> None:
    macro, program = tmp_path / "g212.ngc", tmp_path / "p.ngc"
    macro.write_text("G0 X[#24 * 2]\nM99\n")
    program.write_text("G212 X4\nM2\n")
    invoke("encrypt", macro, "-o", tmp_path / "g212.ngx", "--key", "secret")
    macro.unlink()
    listing = invoke("run", program, "--macros", tmp_path, "--key", "secret", "--format", "canon")
    assert "STRAIGHT_TRAVERSE(8.0000" in listing
    assert "encrypted-macro" in invoke("check", program, "--macros", tmp_path, "--key", "wrong", status=1)
    assert "no key is given" in invoke("check", program, "--macros", tmp_path, status=1)
