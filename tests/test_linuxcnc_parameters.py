"""Parameters that outlive a run of LinuxCNC's language: in a parameter file, and in a machine's folder.

Expected files by hand from 001, Appendix: numbered parameters persistence. That the interpreter
leaves the same files is held by test_linuxcnc_ini.
"""

from pathlib import Path

import pytest
from click.testing import CliRunner, Result

import aircut
from aircut.cli.main import cli
from aircut.machine import load, store

#: Every number that a parameter file has at least: homes, G92, and nine systems of nine axes and a rotation.
ALWAYS = [
    *range(5161, 5170), *range(5181, 5190), *range(5210, 5221),
    *(first + i for first in range(5221, 5382, 20) for i in range(10)),
]  # fmt: skip
MACHINE = 'type = "mill"\n[axes.X]\n[axes.Y]\n[axes.Z]\n[axes.A]\n'


def run(folder: Path, program: str, *options: str) -> Result:
    (folder / "part.ngc").write_text(program)
    arguments = ["run", str(folder / "part.ngc"), "--dialect", "linuxcnc", "--format", "canon", *options]
    return CliRunner().invoke(cli, arguments)


def with_file(folder: Path, text: str | None, program: str) -> tuple[Result, dict[int, str]]:
    """A run with a parameter file of this text (None: there is none), and what is in the file after it."""
    path = folder / "machine.var"
    if text is not None:
        path.write_text(text)
    done = run(folder, program, "--parameters", str(path))
    lines = path.read_text().splitlines() if path.exists() else []
    assert all(line.count("\t") == 1 for line in lines) or done.exit_code == 2
    return done, {int(n): v for n, _, v in (line.partition("\t") for line in lines)} if done.exit_code != 2 else {}


def test_missing_parameters_are_zero_and_written(tmp_path: Path) -> None:
    done, after = with_file(tmp_path, None, "(debug,#5221 #5389)\nM2\n")
    assert 'MESSAGE("0.000000 0.000000")' in done.stdout
    assert list(after) == ALWAYS
    assert {v for n, v in after.items() if n != 5220} == {"0.000000"}
    assert after[5220] == "1.000000"


def test_persistent_and_given_parameters_are_kept(tmp_path: Path) -> None:
    """In inches, whatever the program's unit. #31 is in the file and so kept, #32 is not."""
    text = "31\t7\n5161\t.5\n"
    program = "(debug,#31 #5161)\nG21 G10 L2 P1 X25.4\n#31=8.25 #32=9 #5389=-3\nM2\n"
    done, after = with_file(tmp_path, text, program)
    assert 'MESSAGE("7.000000 0.500000")' in done.stdout
    assert list(after) == [31, *ALWAYS]
    assert (after[31], after[5161], after[5221], after[5389]) == ("8.250000", "0.500000", "1.000000", "-3.000000")
    done, _ = with_file(tmp_path, None, "(debug,#31 #5221 #32)\nM2\n")
    assert 'MESSAGE("8.250000 1.000000 0.000000")' in done.stdout


def test_they_are_kept_after_an_error_too(tmp_path: Path) -> None:
    done, after = with_file(tmp_path, "", "#5221=2\nG1 X1\nM2\n")
    assert done.exit_code == 1
    assert after[5221] == "2.000000"


def test_lines_that_are_no_two_numbers_are_passed_over(tmp_path: Path) -> None:
    done, after = with_file(
        tmp_path, "; a comment\n\nname 5\n31\n32 x\n33 4\n34\t5.\n35 -.5\n", "(debug,%d#33 #34)\nM2\n"
    )
    assert 'MESSAGE("4 5")' in done.stdout
    assert list(after) == [33, 34, 35, *ALWAYS]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("31 1\n33 2\n32 3\n", ":3: variable 32 is out of order"),
        ("31 1\n31 2\n", ":2: variable 31 is out of order"),
        ("5601 1\n5602 1\n", ":2: variable 5602 cannot be set from a file"),
        ("0 1\n", ":1: variable 0 is out of order"),
    ],
)
def test_numbers_ascend_and_are_parameters(text: str, said: str, tmp_path: Path) -> None:
    done, _ = with_file(tmp_path, text, "M2\n")
    assert done.exit_code == 2
    assert said in done.stderr
    assert (tmp_path / "machine.var").read_text() == text
    assert not (tmp_path / "machine.var.bak").exists()


def test_the_file_of_before_stays_as_a_backup(tmp_path: Path) -> None:
    _, first = with_file(tmp_path, "31 1\n", "#31=2\nM2\n")
    assert (tmp_path / "machine.var.bak").read_text() == "31 1\n"
    kept = (tmp_path / "machine.var").read_text()
    with_file(tmp_path, None, "#31=3\nM2\n")
    assert (tmp_path / "machine.var.bak").read_text() == kept
    assert first[31] == "2.000000"


def test_a_file_that_cannot_be_written_is_told(tmp_path: Path) -> None:
    (tmp_path / "machine.var").mkdir()
    done = run(tmp_path, "M2\n", "--parameters", str(tmp_path / "machine.var"))
    assert done.exit_code != 0
    assert "machine.var" in done.stderr


def test_a_folder_keeps_mm_for_every_language(tmp_path: Path) -> None:
    """Set at 25.4 mm from rosetta, X of G54 is one inch to LinuxCNC's programs, and 25.4 mm again to rosetta's."""
    (tmp_path / "machine.toml").write_text(MACHINE)
    store.change(tmp_path, {5221: 25.4, 5224: 30.0, 5161: 50.8, 4000: 7.0})
    done = run(tmp_path, "(debug,#5221 #5224 #5161 #4000)\nG10 L2 P2 X10 A20\nG28.1\nM2\n", "--machine", str(tmp_path))
    assert 'MESSAGE("1.000000 30.000000 2.000000 7.000000")' in done.stdout
    assert "SET_G5X_OFFSET(1, 25.4000, 0.0000, 0.0000, 30.0000," in done.stdout
    kept = load(tmp_path).variables
    assert (kept[5221], kept[5224], kept[5241], kept[5244]) == pytest.approx((25.4, 30.0, 10.0, 20.0))
    assert kept[5161] == 0.0
    assert kept[4000] == 7.0
    result = aircut.loads("G55\nG0 X0\nM2\n").run(machine=load(tmp_path))
    assert result.toolpath.x.tolist() == pytest.approx([10.0])


def test_a_folder_and_a_file_together(tmp_path: Path) -> None:
    """The file goes before the folder, and is what is written."""
    (tmp_path / "machine.toml").write_text(MACHINE)
    store.change(tmp_path, {5221: 25.4, 5222: 25.4})
    (tmp_path / "machine.var").write_text("5221 3\n")
    options = ("--machine", str(tmp_path), "--parameters", str(tmp_path / "machine.var"))
    done = run(tmp_path, "(debug,%d#5221 #5222)\nM2\n", *options)
    assert 'MESSAGE("3 1")' in done.stdout
    assert load(tmp_path).variables[5221] == 25.4
