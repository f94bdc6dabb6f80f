"""Faults as the vendor's controller writes them (000 section 10.1, 003 section 2.2, AMB-EXE-4)."""

from pathlib import Path

import pytest
from click.testing import CliRunner

from aircut.cli.main import cli

CONVENTIONS = (Path(__file__).parent.parent / "conformance" / "macros" / "custom-conventions.case").read_text("utf-8")
MACRO = CONVENTIONS.split("file g260.ngc\n")[1].split("---\n")[0]


def check(text: str, folder: Path) -> list[str]:
    program = folder / "p.ngc"
    program.write_text(text)
    result = CliRunner().invoke(cli, ["check", str(program), "--macros", str(folder), "--format", "vendor"])
    return result.output.splitlines()


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ('G0 X1\nM109 P"user error message" Q-1\nM2\n', "[E0345] in line 2 - user error message"),
        ("M109 Q-1\nM2\n", "[E0345] in line 1 - generic user error with m109 q-1"),
        ("M120 Q-1\nM2\n", "[E0345] in line 1 - generic user error with m120 q-1"),
        ("G0 X1\n\nG38.3 A5 F1\nM2\n", "[axis-disabled] in line 3 - the machine has no A axis"),
        ("F10\nG38.3 Z0.1\nM2\n", "[E0162] in line 2 - start point too close to probe point"),
        ("G38.3 Z5\nM2\n", "[E0049] in line 1 - cannot probe with zero feed rate"),
        ("F1 G93\nG38.3 Z5\nM2\n", "[E0047] in line 2 - cannot probe in inverse time feed mode"),
    ],
)
def test_errors_of_the_program(text: str, line: str, tmp_path: Path) -> None:
    assert check(text, tmp_path) == [line]


def test_errors_of_a_macro_name_the_main_programs_line_and_the_macros(tmp_path: Path) -> None:
    (tmp_path / "g212.ngc").write_text('#1=1\nM109 P"bad #1" Q-1\nM99\n')
    (tmp_path / "outer.ngc").write_text("\n\nG212\nM99\n")
    assert check("G0 X1\nG212\nM2\n", tmp_path) == ["[E0345] in line 2 (G212, line 2) - bad 1"]
    assert check('G0 X1\n\nG65 P"outer"\nM2\n', tmp_path) == ["[E0345] in line 3 (G212, line 2) - bad 1"]


@pytest.mark.parametrize(
    ("words", "text"),
    [
        ("A1 E1 H0 K1", "x missing"),
        ("X3 E1 H0 K1", "a or b"),
        ("X3 A1 B1 E1 H0 K1", "a or b"),
        ("X3 A1 H0 K1", "e, f or both"),
        ("X3 A1 E1 K1", "h missing"),
        ("X3 A1 E1 H0 K3", "k is 1 or 2"),
        ("X3 A1 E1 H0 K1 V3", "v is 1 or 2"),
    ],
)
def test_words_that_do_not_fit_a_macros_conventions(words: str, text: str, tmp_path: Path) -> None:
    (tmp_path / "g260.ngc").write_text(MACRO)
    (told,) = check(f"G260 {words}\nM2\n", tmp_path)
    assert told.startswith("[E0345] in line 1 (G260, line ") and told.endswith(f") - {text}")


def test_warnings_are_not_told(tmp_path: Path) -> None:
    assert check("F1\nG1 X1\nS999999 M3\nM2\n", tmp_path) == []
