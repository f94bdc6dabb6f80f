"""Diagnostics of LinuxCNC's language point at what is wrong, and a check tells all that it safely can."""

from pathlib import Path

import pytest

import aircut
from aircut.api import Limits

#: Lines, and under each the columns that its fault points at, and the fault's code.
POINTED = """
G1 X5 F100 X7
           ^^ repeated-word
n10  G 0 X 1 g2 0.5   Y2
             ^^^^^^ unknown-code
G0 (a [note]) X1 (another) K2 ; and more
                           ^^ unused-word
M3 G0 X1 M20
         ^^^ unknown-code
G17 X1 G18 G0
       ^^^ modal-conflict
M7 (mist) M8
          ^^ modal-conflict
X1 Y2
^^ no-motion-mode
G2 X1 F10
^^ arc-no-center
F10 G1 X1 G4
          ^^ missing-word
S-5
^^^ bad-value
T1.5
^^^^ not-integer
G10 L2 P33 X1
       ^^^ bad-value
G0 X[1 + [2 / 0] * 3] Y1
          ^^^^^ division-by-zero
G0 X1 Y[#<here> + 2]
        ^^^^^^^ undefined-name
#1=2 #2=[3 + sqrt[1 - #5000 - 2]]
             ^^^^^^^^^^^^^^^^^^^ domain-error
#5602 = 3
^^^^^ no-variable
#1 = 2 #< _x > = 3
       ^^^^^^^ read-only
#[5400 + 1] = 3
^^^^^^^^^^^ read-only
G0 X##7
    ^^^ no-variable
G0 X[1 + 2
    ^ unclosed-bracket
G0 X1 % 2
      ^ expected
G0 X1 (open
      ^ unclosed-comment
G0 X1 (a (b) c)
      ^ nested-comment
o1 if [1] (a comment) G0
          ^^^^^^^^^^^^^^ misplaced-words
o1 if [1] + 2
          ^^^ misplaced-words
o1 while [1 / #5000] (why not)
          ^^^^^^^^^ division-by-zero
o1 (before) while [1]
   ^^^^^^^^^^^^^^^^^^ misplaced-words
o1 if [1] (between) [2]
          ^^^^^^^^^^^^^ misplaced-words
o1 endif
^^^^^^^^ o-word
o100 fi [1]
     ^^^^^^ expected
o<nowhere> call [1]
^^^^^^^^^^^^^^^ no-subroutine
G0 X1 (ABORT, no more)
      ^^^^^^^^^^^^^^^^ aborted
"""


def faults(text: str, **settings: object) -> list[tuple[str, str, int, int, int]]:
    found = aircut.loads(text, "linuxcnc").run(**settings).diagnostics
    return [(d.severity.value, d.code, *d.span) for d in found]


ROWS = POINTED.strip("\n").split("\n")


@pytest.mark.parametrize(("line", "mark"), list(zip(ROWS[::2], ROWS[1::2], strict=True)), ids=ROWS[::2])
def test_a_fault_points_at_its_place(line: str, mark: str) -> None:
    first, after = mark.index("^") + 1, mark.rindex("^") + 2
    assert faults(f"{line}\nM2\n")[0] == ("error", mark.split()[-1], 1, first, after)


def test_calls_lead_to_a_fault(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("inner.ngc").write_text("o<inner> sub\n\n G1 X#1\no<inner> endsub\n")
    text = "o<outer> sub\no<inner> call [2]\no<outer> endsub\nG0 X1\no<outer> call\nM2\n"
    (found,) = aircut.loads(text, "linuxcnc", "main.ngc").run().diagnostics
    assert (found.file, found.code, found.span) == ("inner.ngc", "missing-feed", (3, 2, 4))
    assert found.stack == (("outer", "main.ngc", 5), ("inner", "main.ngc", 2))
    assert found.hint


def test_a_check_goes_on_after_a_block() -> None:
    text = "G0 X1 X2\nG1 Y2\nF100 G1 Y3\no<none> call\n#1=[1/0]\nG0 Z1 (open\no1 repeat [2]\nG99.5\no1 endrepeat\nM2\n"
    assert [(code, line) for _, code, line, *_ in faults(text, keep_going=True)] == [
        ("repeated-word", 1), ("missing-feed", 2), ("no-subroutine", 4), ("division-by-zero", 5),
        ("unclosed-comment", 6), ("unknown-code", 8),
    ]  # fmt: skip
    assert [code for _, code, *_ in faults(text)] == ["repeated-word"]


def test_behind_a_broken_o_word_the_form_of_lines_is_checked() -> None:
    """What runs is not known there: neither moves nor modes are told of, and the end of the program is the end."""
    text = "o1 if [#<none>]\nX1 K2\nG0 X1 X1\no1 else 5\nG99.5\no1 endif\nM2\nG0 X1 X1\n"
    assert [(severity, code, line) for severity, code, line, *_ in faults(text, keep_going=True)] == [
        ("error", "undefined-name", 1), ("error", "repeated-word", 3), ("error", "misplaced-words", 4),
        ("error", "unknown-code", 5),
    ]  # fmt: skip


def test_what_did_not_run_is_a_warning_in_a_check_and_nothing_in_a_run() -> None:
    """LinuxCNC never reads a branch not taken, a subroutine not called, or what follows the end."""
    text = "o1 if [0]\nG0 X1 & 2\no1 endif\nM2\n& & &\no2 sub\nG0 X1 X1\no2 endsub\nG0 X1 X1\n"
    assert [(severity, code, line) for severity, code, line, *_ in faults(text, keep_going=True)] == [
        ("warning", "expected", 2), ("warning", "repeated-word", 7),
    ]  # fmt: skip
    assert faults(text) == []


def test_an_abort_and_a_runaway_end_a_check() -> None:
    assert [d[1] for d in faults("(ABORT,no)\no1 while\nM2\n", keep_going=True)] == ["aborted", "expected"]
    limits = Limits(blocks=50)
    text = "o1 while [1]\no1 endwhile\nM2\n"
    assert [d[1] for d in faults(text, keep_going=True, limits=limits)] == ["block-budget"]


def test_a_spline_whose_points_failed_has_none() -> None:
    text = "G5.2 X1 Y1 L3\nX2 P1\nG5.3\nM2\n"
    assert [d[1:3] for d in faults(text, keep_going=True)] == [
        ("missing-feed", 1), ("wrong-state", 2), ("wrong-state", 3),
    ]  # fmt: skip
