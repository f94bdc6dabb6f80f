"""Blanks, letter case, the order of words and comments between them do not change what a program does."""

from typing import NamedTuple

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import aircut

# --- programs as lines of pieces


class Line(NamedTuple):
    """One line: words that may change places, or pieces that may not; `fixed` text is kept as it is."""

    pieces: tuple[str, ...]
    free: bool = False  # the pieces are words and settings, in any order
    fixed: str = ""  # a comment at the end


SETUP = [
    Line(("G17", "G21", "G90", "G0", "X1", "Y2", "Z3", "F250"), True),
    Line(("#1=2.5", "#2=-4"), True),
    Line(("#<some name>=7", "#<_own>=0.5"), True),
    Line(("#<list[1]>=3", "#<list[2]>=6"), True),
]

numbers = st.one_of(
    st.sampled_from(["0", "1", "12.5", "-3", ".25", "+7", "-0.125", "5.", "1000", "007"]),
    st.integers(-99, 99).map(str),
)
values = st.one_of(
    numbers,
    numbers,
    st.sampled_from([
        "#1", "-#2", "#<some name>", "#<_own>", "[#1+2]", "[#<some name> MOD 4-#2**2]", "SQRT[16]",
        "[#<list[#1-1.5]>*2]", "ATAN[1]/[1]", "##600", "[1 EQ 1 AND 2 GT 1]",
    ]),
)  # fmt: skip
comments = st.sampled_from(["", "", "", "; Text  G0 X99", "(Text  G0 X99)", "(a; b) (C)", ";"])


@st.composite
def moves(draw):
    """Words of a block, each letter once."""
    words = [letter + draw(values) for letter in draw(st.sets(st.sampled_from("XYZ"), max_size=3))]
    groups = [["G0", "G1", "g01", "G#603"], ["G90", "G91"], ["G20", "G21"], ["M3", "M5"], ["M7", "M8", "M9"]]
    for group in draw(st.lists(st.sampled_from(groups), max_size=3, unique_by=id)):
        words.append(draw(st.sampled_from(group)))
    if draw(st.booleans()):
        words.append("F" + draw(st.sampled_from(["100", "2.5", "[#<some name>*10]"])))
    for number in draw(st.sets(st.integers(500, 505), max_size=2)):
        words.append(f"#{number}={draw(values)}")
    if draw(st.booleans()):
        words.append(draw(st.sampled_from(["#<list[1]>=[#<list[1]>+1]", "#<Other>=2", "#[500+9]=#1"])))
    return [Line(tuple(words), True, draw(comments))]


arcs = st.sampled_from(["I1 J0", "I0.5 J-.5 P2", "X[#5001+2] R1", "X[#5001-1] R-5 Z4"]).map(
    lambda text: [Line(("G2", *text.split()), True), Line(("G1",), True)]
)
flow = st.sampled_from([
    [("IF [", "#1", " GT 2", "]", "THEN", "#510", "=", "5", "X9"), ("N10", "GOTO", "20"), ("X98",), ("N20", "Y5")],
    [("#511", "=", "0"), ("WHILE", "[", "#511 LT 3", "]", "DO", "1"), ("#511", "=", "[#511+1]"), ("X", "#511"),
     ("IF [#511 EQ 2]", "BREAK", "1"), ("END", "1")],
    [("IF[", "#2 GT 0]", "THEN", "1"), ("X1",), ("ELIF [", "#2 LT 0", "]", "THEN1"), ("X2",), ("ELSE", "1"),
     ("X3",), ("END1",)],
    [("M98", "P", "77", "L", "2")],
    [("G65", "P78", "A", "5", "B#1", "X", "2")],
    [("CALL", "P", '"The Sub"', "A", "[1+1]")],
]).map(lambda block: [Line(tuple(line)) for line in block])  # fmt: skip
SUBS = [
    Line(("M2",), True),
    Line(("O", "77")), Line(("X[", "#5001", "+1]"),), Line(("M99",), True),
    Line(("SUB", "78"),), Line(("Y", "[#1+#24]")), Line(("#520", "=", "#<_args.b>")), Line(("END", "SUB")),
    Line(("SUB", '"the sub"'), fixed="(Comment)"), Line(("Z", "#1")), Line(("RETURN",)),
]  # fmt: skip
programs = st.lists(st.one_of(moves(), moves(), arcs, flow), min_size=1, max_size=8).map(
    lambda parts: [Line(("#600=601", "#601=8", "#603=1"), True), *SETUP, *(x for part in parts for x in part), *SUBS]
)
seldom = st.integers(0, 5).map(lambda n: n == 0)


def plain(lines):
    """The text as one would write it."""
    return "".join(" ".join(line.pieces) + f" {line.fixed}\n" for line in lines)


def outcome(text):
    """All that a run did: moves, values, diagnostics."""
    result = aircut.loads(text).run(keep_going=True)
    return (
        result.toolpath.to_numpy().tobytes(),
        result.variables,
        result.state,
        [(d.code, d.span.line) for d in result.diagnostics],
    )


def changed(text, change):
    """The text with its code changed piece by piece: strings and comments stay."""
    out, at = [], 0
    while at < len(text):
        closing = {'"': '"', "(": ")"}.get(text[at])
        if text[at] == ";":
            out.append(text[at:])
            break
        if closing:
            end = text.index(closing, at + 1) + 1
            out.append(text[at:end])
        else:
            end = at + 1
            out.append(change(text[at:end]))
        at = end
    return "".join(out)


def test_the_programs_do_something():
    """The generated programs run without error, so the tests below compare more than refusals."""
    result = aircut.loads(plain([Line(("#600=601", "#601=8", "#603=1"), True), *SETUP, *SUBS])).run()
    assert result.ok and len(result.toolpath) == 1


@given(programs, st.randoms(use_true_random=False))
@settings(max_examples=200, deadline=None)
def test_blanks(lines, random):
    def blank(character):
        return random.choice(["", "", "", " ", "\t", "  "]) + character

    given_text = plain(lines)
    spaced = "\n".join(changed(line, blank) for line in given_text.split("\n"))
    assert outcome(spaced) == outcome(given_text)


@given(programs)
@settings(max_examples=100, deadline=None)
def test_no_blanks(lines):
    given_text = plain(lines)
    tight = "\n".join(changed(line, lambda c: c.strip()) for line in given_text.split("\n"))
    assert outcome(tight) == outcome(given_text)


@given(programs, st.randoms(use_true_random=False))
@settings(max_examples=200, deadline=None)
def test_letter_case(lines, random):
    def other(character):
        return random.choice([character.lower(), character.upper()])

    given_text = plain(lines)
    assert outcome("\n".join(changed(line, other) for line in given_text.split("\n"))) == outcome(given_text)


@given(programs, st.randoms(use_true_random=False))
@settings(max_examples=200, deadline=None)
def test_order_of_words(lines, random):
    shuffled = [
        line._replace(pieces=tuple(random.sample(line.pieces, len(line.pieces)))) if line.free else line
        for line in lines
    ]
    assert outcome(plain(shuffled)) == outcome(plain(lines))


@given(programs, st.randoms(use_true_random=False))
@settings(max_examples=200, deadline=None)
def test_comments_between_words(lines, random):
    commented = [
        line._replace(pieces=tuple(random.choice(["", "(x)", "( G0 ; X1 ) "]) + p for p in line.pieces))
        if line.free
        else line
        for line in lines
    ]
    assert outcome(plain(commented)) == outcome(plain(lines))


@given(programs, st.sampled_from(["\r\n", "\n\n", "\n \t\n"]))
@settings(max_examples=100, deadline=None)
def test_line_ends(lines, end):
    """Line ends of either system; empty lines move line numbers only."""
    given_text = plain(lines)
    other = outcome(given_text.replace("\n", end))
    same = outcome(given_text)
    if end == "\r\n":
        assert other == same
    else:
        assert other[1:3] == same[1:3]
        assert [code for code, _ in other[3]] == [code for code, _ in same[3]]


@given(programs, st.lists(st.integers(0, 99999), min_size=60, max_size=60))
@settings(max_examples=100, deadline=None)
def test_labels(lines, labels):
    """A number before a line changes nothing where no GOTO wants it."""
    numbered = [
        line._replace(pieces=(f"N{100 + label}", " ".join(line.pieces))) if line.pieces[:1] != ("N10",) else line
        for line, label in zip(lines, labels * 3, strict=False)
    ]
    if any(line.pieces[:1] in (("N10",), ("N20",)) for line in lines):
        numbered = lines
    assert outcome(plain(numbered)) == outcome(plain(lines))


@given(programs)
@settings(max_examples=100, deadline=None)
def test_errors_apart(lines):
    """The generated programs have no faults of form: what is compared above is motion."""
    codes = {d.code for d in aircut.loads(plain(lines)).run(keep_going=True).diagnostics}
    codes = {code for code in codes if not code.startswith("arc-")}
    assert codes <= {"bad-value", "travel-limit"}, codes  # beyond all machines, or this one


@pytest.mark.parametrize("dialect", ["rosetta", "linuxcnc"])
def test_the_character_that_marks_comments_is_none_in_a_file(dialect: str) -> None:
    result = aircut.loads("G0\x01X1\nM2\n", dialect).run()
    assert [(d.code, d.span.column) for d in result.diagnostics] == [("illegal-character", 3)]
    assert "0x01" in result.diagnostics[0].message
    assert aircut.loads("G0 (a\x01b) X1\nM2\n", dialect).run().ok
