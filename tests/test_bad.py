"""Bad input gives diagnostics: never a traceback, a hang, or memory without bound."""

import os
import resource
import subprocess
import sys
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import aircut
from aircut.api import Limits
from aircut.diagnostics import Severity

MEGABYTE = 1 << 20
ALPHABET = 'GXYZMNFSTPIJKR0123456789.#[]<>="()%;/+-* \n'
WORDS = ("IF", "THEN", "ELSE", "ELIF", "END", "WHILE", "DO", "GOTO", "BREAK", "SUB", "ENDSUB", "RETURN", "CALL",
         "O1", "M98 P1", "M99", "G65 P1 A1", "M2", "EQ", "MOD", "SIN", "\n", "#1=", "[", "]", "1", "G1 X1",
         'M109 P"a#1#<b>" Q3', "M109 Q-1", "G38.3 Z-5 F9", "M66 P1 L4", "G66 P1", "G67", "G43 H1", "G10 L1 P1 Z5",
         "M0", "G10 L100 P5730 V2", "G250 X1", "G390", "T1 M6", "M62 P1", "G#1", "M#2", "G100 P1", "M47")  # fmt: skip


def codes(text: str | bytes, **limits: int) -> set[str]:
    """Codes of the diagnostics of a text."""
    return {d.code for d in aircut.loads(text).check(limits=Limits(**limits))}


@pytest.mark.parametrize(
    ("text", "code"),
    [
        (b"G0 X1\0\n", "illegal-character"),
        (b"G0 X\xff1\n", "illegal-character"),
        (b"(caf\xe9)\nM2\n", "invalid-utf8"),
        ("G0 X1\nM2\n".encode("utf-16"), "not-utf8"),
        ("#1=[1+[2\n", "unclosed-bracket"),
        ("#1=" + "[" * 500 + "1" + "]" * 500, "expression-too-deep"),
        ("#1=[" + "1+" * 5000 + "1]", "expression-too-deep"),
        ("(open\n", "unclosed-comment"),
        ('M98 P"x\n', "unclosed-string"),
        ("M98 P1\nM2\nO1\nM98 P1\nM99\n", "too-deep"),
        ("WHILE [1 EQ 1] DO1\nEND1\nM2\n", "endless-loop"),
        ("N1 G4 P0\nGOTO 1\n", "endless-loop"),
        ("#1=[1/0]\n", "division-by-zero"),
        ("#1=LN[-1]\n", "domain-error"),
        ("#1=[10**400]\n", "overflow"),
        ("#1=#[1000000]\n", "no-variable"),
        ("#[-1]=1\n", "bad-index"),
        ("M98 P9\n", "no-subroutine"),
        ('M98 P"../../etc/passwd"\n', "bad-file-name"),
        ("G1 X1\n", "no-feed"),
        ("G0 X" + "9" * 400 + "\n", "overflow"),
        ("", "empty-program"),
    ],
)
def test_each_kind(text: str | bytes, code: str) -> None:
    assert code in codes(text)


def test_a_chain_of_a_thousand_operators_is_fine() -> None:
    assert "expression-too-deep" not in codes("#1=[" + "1+" * 1000 + "1]\nM2\n")


def test_budget_stops_loops_that_do_change_something() -> None:
    text = "#1=0\nN1 #1=[#1+1]\nGOTO 1\nM2\n"
    diagnostic = next(d for d in aircut.loads(text).check(limits=Limits(blocks=5000)) if d.code == "block-budget")
    assert diagnostic.span.line == 3 and "2 to 3" in diagnostic.message


def test_budget_counts_calls() -> None:
    assert "block-budget" in codes("M98 P1 L100000\nM2\nO1\nG4 P0\nM99\n", blocks=5000)


def test_straight_programs_never_meet_the_budget() -> None:
    assert codes("G21 G0 X1\n" * 5000 + "M2\n", blocks=0) == set()


def test_moves_are_limited_where_they_are_kept() -> None:
    text = "G91\n#1=0\nWHILE [#1 LT 300000] DO1\n#1=[#1+1]\nG0 X0.01\nEND1\nM2\n"
    result = aircut.loads(text).run(limits=Limits(moves=100_000))
    assert [d.code for d in result.diagnostics] == ["output-limit"]
    assert len(result.toolpath) < 200_000


def limited() -> None:
    """Bound the memory of a child process."""
    resource.setrlimit(resource.RLIMIT_AS, (1500 * MEGABYTE, 1500 * MEGABYTE))


@pytest.mark.parametrize("text", [b"G0 X1 ", b"a", b"[", b"(", b"\x00", b"#1=[1+"])
def test_a_line_of_100_megabytes(text: bytes, tmp_path: Path) -> None:
    path = tmp_path / "long.ngc"
    path.write_bytes(text * (100_000_000 // len(text)))
    done = subprocess.run(
        [sys.executable, "-m", "aircut", "check", str(path)],
        capture_output=True, text=True, timeout=60, preexec_fn=limited,
    )  # fmt: skip
    assert done.returncode == 1 and "line-too-long" in done.stdout, done.stderr[-500:]
    assert "Traceback" not in done.stderr


def fit(text: str | bytes) -> None:
    """Check and run a text; only our own faults would raise."""
    limits = Limits(blocks=2000, moves=100_000)
    program = aircut.loads(text)
    diagnostics = program.check(limits=limits)
    for diagnostic in diagnostics:
        assert diagnostic.message and str(diagnostic)
        if diagnostic.span.line and diagnostic.file == program.source.name:
            assert diagnostic.span.line <= max(len(program.source), 1)
            width = len(program.source.text(diagnostic.span.line - 1))
            assert 1 <= diagnostic.span.column <= width + 1
            assert diagnostic.span.column < diagnostic.span.end <= width + 2
    failed = any(d.severity is Severity.ERROR for d in diagnostics)
    result = program.run(limits=limits)
    assert result.ok or failed
    list(result.canon())


@settings(max_examples=400, deadline=None)
@given(st.binary(max_size=300))
def test_any_bytes(data: bytes) -> None:
    fit(data)


@settings(max_examples=400, deadline=None)
@given(st.text(ALPHABET, max_size=200))
def test_any_text_of_the_language_s_characters(text: str) -> None:
    fit(text)


@settings(max_examples=400, deadline=None)
@given(st.lists(st.sampled_from(WORDS), max_size=60).map(" ".join))
def test_any_words_of_the_language(text: str) -> None:
    fit(text)


def test_random_file() -> None:
    fit(os.urandom(50_000))
