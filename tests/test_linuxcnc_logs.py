"""Log files and probe logs of LinuxCNC's language: what they hold, and where they may lie."""

from pathlib import Path

import pytest
from click.testing import CliRunner

import aircut
from aircut.cli.main import cli

LOGGING = """(LOG,before any file)
#1=1.5
(LOGOPEN,first.txt)
(LOG,one #1)
(LOGAPPEND, second.txt )
(LOG,two %d#1)
(LOGCLOSE)
(LOG,between)
(LOGAPPEND,first.txt)
(LOG,three)
(LOGOPEN,second.txt)
(LOG,four)
M2
"""
WORLD = '[[bodies]]\nshape = "box"\nat = [0, 0, -20]\nsize = [50, 50, 20]\n'
#: The tool of slot 1 is 0.511 inch long; without one in the spindle the point is the spindle's nose.
PROBING = """G21 G90 F200
G0 X10 Y10 Z5
(PROBEOPEN found.txt)
G38.2 Z-30
(PRINT,#5070 #5061 #5062 #5063 at #<_z>)
G0 Z5
X100
G38.3 Z-3
(PRINT,#5070 #5063 at #<_z>)
G0 Z5
X20 Y10
G92 X0
G20
G38.3 Z-1
(PRINT,#5070 #5061 #5063)
(PROBECLOSE)
G0 Z1
G38.2 Z-1
M2
"""


def run(text: str, folder: Path, *options: object, status: int = 0) -> str:
    program = folder / "program.ngc"
    program.write_text(text)
    done = CliRunner().invoke(cli, ["run", str(program), "--dialect", "linuxcnc", *map(str, options)])
    assert done.exit_code == status, done.output
    return done.output


def files(folder: Path) -> dict[str, str]:
    return {str(path.relative_to(folder)): path.read_text() for path in folder.rglob("*") if path.is_file()}


def test_logs_hold_what_was_said_while_they_were_open(tmp_path: Path) -> None:
    logs = tmp_path / "logs"
    logs.mkdir()
    (logs / "second.txt").write_text("from the run before\n")
    run(LOGGING, tmp_path, "--logs", logs)
    assert files(logs) == {"first.txt": "one 1.500000\nthree\n", "second.txt": "four\n"}


def test_appending_goes_on_with_what_is_there(tmp_path: Path) -> None:
    logs = tmp_path / "logs"
    logs.mkdir()
    for _ in range(2):
        run("(LOGAPPEND,sub/log)\n(LOG,again)\n(LOGOPEN,empty)\nM2\n", tmp_path, "--logs", logs)
    assert files(logs) == {"sub/log": "again\nagain\n", "empty": ""}


def test_nothing_is_written_unasked(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    run(LOGGING, tmp_path)
    assert list(files(tmp_path)) == ["program.ngc"]


@pytest.mark.parametrize(
    "name", ["../out.txt", "/tmp/aircut-out.txt", "a/../../out.txt", "link/out.txt", "", ".", "sub"]
)
def test_nothing_is_written_outside_the_folder(name: str, tmp_path: Path) -> None:
    logs = tmp_path / "logs"
    (logs / "sub").mkdir(parents=True)
    (logs / "link").symlink_to(tmp_path)
    output = run(f"(LOGOPEN,{name})\n(LOG,no)\nM2\n", tmp_path, "--logs", logs, status=1)
    assert f"“{name}” is no file below" in output
    assert set(files(tmp_path)) == {"program.ngc"}


def test_a_run_tells_its_logs() -> None:
    interpreter = aircut.loads(LOGGING, "linuxcnc").interpreter()
    list(interpreter.run())
    assert {name: (log.append, log.lines) for name, log in interpreter.logs().items()} == {
        "first.txt": (False, ["one 1.500000", "three"]),
        "second.txt": (False, ["four"]),
    }


def test_probe_logs_hold_the_successes_in_a_world(tmp_path: Path) -> None:
    """The box's top is Z0, so probes meet it at Z0, and beside it at nothing. Expected by hand, in program units."""
    world = tmp_path / "world.toml"
    world.write_text(WORLD)
    logs = tmp_path / "logs"
    logs.mkdir()
    output = run(PROBING, tmp_path, "--logs", logs, "--world", world, "--format", "canon")
    printed = [line for line in output.splitlines() if not line.startswith(" ")]
    assert printed == [
        "1.000000 10.000000 10.000000 0.000000 at 0.000000",
        "0.000000 -3.000000 at -3.000000",
        "1.000000 0.000000 0.000000",
    ]
    zeros = " ".join(["0.000000"] * 6)
    ten = 10 / 25.4
    assert files(logs)["found.txt"] == (f"10.000000 10.000000 0.000000 {zeros}\n0.000000 {ten:.6f} 0.000000 {zeros}\n")


def test_a_probe_that_finds_nothing_fails_under_g38_2(tmp_path: Path) -> None:
    world = tmp_path / "world.toml"
    world.write_text(WORLD)
    text = "F100\nG0 X100 Z5\nG38.{} Z-5\n(PRINT,#5070)\nM2\n"
    assert "probe" in run(text.format(2), tmp_path, "--world", world, status=1)
    run(text.format(3), tmp_path, "--world", world)


def test_nobody_to_ask_is_as_in_the_interpreter_by_itself() -> None:
    interpreter = aircut.loads(PROBING.replace("G92 X0\n", ""), "linuxcnc").interpreter()
    list(interpreter.run())
    assert interpreter.logs()["found.txt"].lines == [] and not interpreter.failed
