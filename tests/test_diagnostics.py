"""Errors that a machinist makes name their cause: what is told, where, and what to do."""

from pathlib import Path

import pytest
from click.testing import CliRunner

import aircut
from aircut.cli.main import cli
from aircut.diagnostics import Diagnostic, Severity
from aircut.machine import built_in

#: A program, and of each error: its line, its column, its code, and words of its message and hint.
MISTAKES = {
    "M3 K5": [(1, 4, "unused-word", "uses K")],
    "G0 X1 Q2": [(1, 7, "unused-word", "uses Q")],
    "G0 G1 X1": [(1, 4, "modal-conflict", "G0 and G1 are of one modal group: motion")],
    "G54 G55": [(1, 5, "modal-conflict", "G54 and G55")],
    "M3 M4": [(1, 4, "modal-conflict", "one modal group: spindle")],
    "G0 X1 X2": [(1, 7, "repeated-word", "two X words")],
    # blocks
    "IF [1 EQ 1] THEN 1\nELSE 1\nELIF [1 EQ 1] THEN 1\nEND 1": [(3, 1, "else-twice", "ELIF after ELSE1")],
    "IF [1 EQ 1] THEN 1\nELSE 1\nELSE 1\nEND 1": [(3, 1, "else-twice", "ELSE is the last branch")],
    "ELSE 1": [(1, 1, "unmatched-end", "ELSE1 without its IF")],
    "WHILE [1 EQ 0] DO1\nELSE1\nEND1": [(2, 1, "unmatched-end", "ELSE1 without its IF")],
    "END 1": [(1, 1, "unmatched-end", "END1 without its IF or WHILE")],
    "WHILE [1 EQ 0] DO 1": [(1, 1, "unclosed-block", "not closed by END1")],
    "IF [1 EQ 1] THEN 7": [(1, 1, "unclosed-block", "not closed by END7")],
    "WHILE [1 EQ 0] DO 1\nEND 2": [
        (1, 1, "unclosed-block", "END1"),
        (2, 1, "unmatched-end", "the block open here is WHILE … 1 of line 1"),
    ],
    "BREAK 1": [(1, 1, "not-a-loop", "no WHILE … DO1 is open here")],
    # one mistake, one error: what follows from a line that cannot be read is not told
    "WHILE [1 EQ 0] D01\nEND1": [(1, 16, "expected", "the letter O, not a zero")],
    "IF #1 EQ 2 THEN 1\nEND1": [(1, 4, "expected", "[condition] behind IF")],
    "IF [#100 = 2] THEN 1\nEND1": [(1, 10, "expected", "comparisons are EQ, NE, GT, GE, LT and LE")],
    "IF [1 EQ 1] THEN 1\nEND": [(2, 4, "expected", "a number behind END")],
    # null
    "G1 X#1 F100": [(1, 5, "null-value", "#1 is null (has no value): as the value of X")],
    "#2=[#500+1]": [(1, 5, "null-value", "#500 is null (has no value): as an operand of +")],
    "G1 X[#100*2] F10": [(1, 6, "null-value", "test it with IF [#100 NE #0]")],
    "#1=SQRT[#5]": [(1, 9, "null-value", "#5 is null (has no value): as the argument of SQRT")],
    "#[#1]=2": [(1, 3, "null-value", "as the number of a variable")],
    "G#1": [(1, 2, "null-value", "#1 is null (has no value): as the value of G")],
    "#3=[#<depth>+1]": [(1, 5, "undefined-name", "#<depth> has not been given a value")],
    # writing
    "#6000=1": [(1, 1, "read-only", "#6000 cannot be assigned: Protected variables")],
    "#[5999+1]=1": [(1, 1, "read-only", "#6000")],
    "#5001=3": [(1, 1, "read-only", "Position in the work system")],
    "#<cnc.x.type>=3": [(1, 1, "read-only", "#<cnc.x.type>")],
    "#0=1": [(1, 1, "read-only", "null by definition")],
    "#50=1": [(1, 1, "no-variable", "variables are #0 to #33, #100 to #4999")],
    # missing words
    "G65": [(1, 1, "missing-word", "P is the subroutine: its number, or its name in quotes")],
    "M98": [(1, 1, "missing-word", "M98 needs P")],
    "G10 L2 X5": [(1, 1, "missing-word", "1 for G54 to 9 for G59.3")],
    "G4": [(1, 1, "missing-word", "in seconds")],
    "G38.2 F100": [(1, 1, "missing-axes", "G38.2 needs at least one axis word")],
    "X5": [(1, 1, "no-motion-mode", "program G0, G1, G2 or G3")],
    # calls
    "M98 P200": [(1, 5, "no-subroutine", "searched: O200.ngc and O200.ngx in ")],
    "M98 P2\nM2\nO1\nM99\nO3\nM99": [(1, 5, "no-subroutine", "the file, which has 1, 3; O2.ngc")],
    "G212 X1": [(1, 1, "no-subroutine", "searched: g212.ngc and g212.ngx in ")],
    'CALL P"x.nc"': [(1, 6, "no-subroutine", "searched: x.nc in ")],
    "GOTO 5": [(1, 1, "no-target", "no block N5 in the main program")],
    # slips of the hand
    "G1 X 1O F100": [(1, 7, "illegal-character", "is the digit 0 meant?")],
    "GO X5": [(1, 2, "expected", "is the digit 0 meant?")],
    "G1 X1,5 F100": [(1, 6, "illegal-character", "decimals are written with a point")],
    "#1=1+2": [(1, 5, "expected", "operators stand in brackets")],
    "G01 XY5": [(1, 5, "missing-value", "X has no value")],
    "G0 X[1+2": [(1, 5, "unclosed-bracket", "[ without its ]")],
    "G999": [(1, 1, "unknown-code", "G999")],
}


def errors(text: str, machine=None) -> list[Diagnostic]:
    text += "\n" if "M2" in text else "\nM2\n"
    found = aircut.loads(text, name="part.ngc").check(machine or built_in("XYZ"))
    return [d for d in found if d.severity is Severity.ERROR]


@pytest.mark.parametrize("text", MISTAKES, ids=lambda text: text.replace("\n", "|"))
def test_mistakes(text: str) -> None:
    found = errors(text)
    wanted = MISTAKES[text]
    assert [(d.span.line, d.span.column, d.code) for d in found] == [one[:3] for one in wanted]
    for diagnostic, (_, _, _, words) in zip(found, wanted, strict=True):
        assert words in f"{diagnostic.message} | {diagnostic.hint}"


def macros(folder: Path) -> Path:
    (folder / "drill.ngc").write_text("(depth: Z)\nG65 P2 X#24\nG1 Z#26 F100\nM99\nO2\nG0 X#24 Y#25\nM99\n")
    path = folder / "part.ngc"
    path.write_text('G21 S1 M3\nM98 P1\nM2\nO1\nG65 P"drill" X5\nM99\n')
    return path


def test_an_argument_that_a_macro_is_not_given(tmp_path: Path) -> None:
    """Each is told with the calls that lead to its line, the innermost last, and the call that lacks it."""
    path = macros(tmp_path)
    machine = built_in("XYZ")
    machine.macros = (tmp_path,)
    inner, outer = sorted(
        (d for d in aircut.load(path).check(machine) if d.code == "null-value"), key=lambda d: -d.span.line
    )
    drill = str(tmp_path / "drill.ngc")
    assert (inner.file, inner.span.line) == (drill, 6) and "#25 is null" in inner.message
    assert [(f.name, f.file, f.line) for f in inner.stack] == [
        ("1", str(path), 2),
        ("drill", str(path), 5),
        ("2", drill, 2),
    ]
    assert inner.hint == f"#25 is the argument Y, which the call in line 2 of {drill} does not give"
    assert (outer.file, outer.span.line) == (drill, 3) and "as the value of Z" in outer.message
    assert outer.hint == f"#26 is the argument Z, which the call in line 5 of {path} does not give"


def test_a_local_variable_of_the_main_program_is_no_argument() -> None:
    (found,) = errors("G1 X#24 F100")
    assert "argument" not in found.hint
    (found,) = errors("M98 P1\nM2\nO1\nG1 X#24 F100\nM99")  # M98 shares its caller's
    assert "argument" not in found.hint


def test_the_calls_and_the_hint_are_told_in_files_and_pipes_too(tmp_path: Path) -> None:
    path = macros(tmp_path)
    done = CliRunner().invoke(cli, ["check", str(path), "--macros", str(tmp_path)])
    lines = done.output.splitlines()
    at = next(i for i, line in enumerate(lines) if "#25 is null" in line)
    drill = tmp_path / "drill.ngc"
    assert lines[at : at + 5] == [
        f"{drill}:6:10: error null-value: #25 is null (has no value): as the value of Y",
        f"        in 2, called from {drill}:2",
        f"        in drill, called from {path}:5",
        f"        in 1, called from {path}:2",
        f"        = #25 is the argument Y, which the call in line 2 of {drill} does not give",
    ]
    done = CliRunner().invoke(cli, ["run", str(path), "--macros", str(tmp_path)])
    assert "in drill, called from" in done.output


def test_places_searched_name_the_folders(tmp_path: Path) -> None:
    machine = built_in("XYZ")
    machine.macros = (tmp_path / "one", tmp_path / "two")
    (found,) = errors('M98 P"feeler"', machine)
    assert f"feeler.ngc and feeler.ngx in {tmp_path / 'one'}, {tmp_path / 'two'}, " in found.hint
