"""From the codes and letters of a block to the steps that carry it out, in order.

All static checks of a block stand here, once, driven by the rows: unknown codes,
two of one modal group, words that nothing uses, words missing.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from aircut.diagnostics import Refusal
from aircut.diagnostics import faults as F
from aircut.interpreter.table import AXES, POLAR_WORDS, Code, Dialect, Group

#: What words mean, by letter; and for some codes by code and letter.
MEANINGS = {
    **dict.fromkeys(("M98 p", "G65 p", "G66 p", "CALL p"), "P is the subroutine: its number, or its name in quotes"),
    "G4 p": "P is how long to wait, in seconds",
    **dict.fromkeys(
        ("G10 L2 p", "G10 L20 p"), "P is the work system: 1 for G54 to 9 for G59.3, 0 for the one in force"
    ),
    **dict.fromkeys(("G10 L1 p", "G10 L10 p", "G10 L11 p"), "P is the tool's number"),
    **dict.fromkeys(("M62 p", "M63 p", "M68 p"), "P is the output's number"),
    **dict.fromkeys(("M66 p", "M67 p"), "P is the input's number"),
    "G10 l": "L is what to set: 2 and 20 a work system, 1 and 10 a tool, 100 other values",
    "p": "P is the code's number: which one, how long or how often",
    "q": "Q is the code's own parameter",
    "l": "L is how many times, or what kind",
}


class Steps(NamedTuple):
    """What a block does. null: its words may be null (macro arguments)."""

    codes: tuple[Code, ...]
    null: bool


def find(name: str, dialect: Dialect, word: str = "") -> Code:
    """The row of a code by its normalized name ("g59.1"). Raises Refusal."""
    row = dialect.codes.get(name)
    if row is not None:
        return row
    if name in dialect.unsupported:
        raise Refusal(F.UNSUPPORTED_CODE, word, code=name.upper())
    raise Refusal(F.UNKNOWN_CODE, word, code=name.upper())


def code_name(letter: str, value: float) -> str:
    """Normalized name of a G or M code; within 0.0001 a number counts as the code (AMB-LEX-13)."""
    if letter == "g":
        tenths = round(value * 10) if abs(value) < 1e6 else -1
        if abs(value * 10 - tenths) < 1e-3 and tenths >= 0:
            return f"g{tenths // 10}.{tenths % 10}" if tenths % 10 else f"g{tenths // 10}"
    elif abs(value - round(value) if abs(value) < 1e6 else 1.0) < 1e-4 and value > -1e-4:
        return f"m{round(value)}"
    return f"{letter}{value:g}"


def arrange(rows: Sequence[Code], letters: Sequence[str], motion: Code | None, dialect: Dialect, axes: str) -> Steps:
    """The steps of a block with these codes and word letters. Raises Refusal.

    motion: the motion mode in force. axes: letters of the axes that the machine has.
    """
    present = set(letters)
    rows = sole(rows)
    if rows and rows[0].sole:
        missing(rows, present)
        return Steps(tuple(rows), True)
    exclusive(rows)
    rows = [row for row in rows if not (row.weak and rival(row, rows))]
    axis_letters = [x for x in letters if x in AXES + POLAR_WORDS and not any(x in row.takes for row in rows)]
    takers = [row for row in rows if row.axes]
    if axis_letters and len(takers) > 1:
        raise Refusal(F.AXIS_CONFLICT, axis_letters[0], first=takers[0].name, second=takers[1].name)
    woken = motion is not None and any(letter in motion.wakes for letter in letters)
    if not takers and (axis_letters or (woken and not uses(rows, letters))):
        rows.append(implied(rows, motion, dialect, axis_letters))
        takers = rows[-1:]
    for row in rows:
        if row.fits and takers and takers[0].name not in row.fits:
            raise Refusal(F.MISFIT, "g", code=row.name, fits=", ".join(row.fits), motion=takers[0].name)
    for letter in axis_letters:
        if letter in POLAR_WORDS:
            if takers and takers[0].group is not Group.MOTION:
                raise Refusal(F.UNUSED_WORD, letter, word=letter)
        elif letter not in axes:
            wanted = "".join(a for a in AXES if a in axes or a == letter).upper()
            raise Refusal(F.AXIS_DISABLED, letter, axis=letter.upper(), wanted=wanted)
    if not axis_letters and not (takers and any(letter in takers[0].wakes for letter in letters)):
        rows = [row for row in rows if not row.fits]  # nothing moves that they could modify
    items = [dialect.items[letter] for letter in letters if letter in dialect.items]
    used(rows, letters, dialect)
    missing(rows, present)
    for row in takers:
        if row.needs_axes and not axis_letters:
            raise Refusal(F.MISSING_AXES, code=row.name)
    order = sorted([*rows, *items], key=lambda row: row.order)
    return Steps(tuple(order), False)


def sole(rows: Sequence[Code]) -> list[Code]:
    for at, row in enumerate(rows):
        if row.sole and len(rows) > 1:
            other = rows[0] if at else rows[1]
            raise Refusal(F.SOLE_CODE, row.name[0].lower(), code=row.name, other=other.name)
    return list(rows)


def exclusive(rows: Sequence[Code]) -> None:
    """Refuse two codes of one modal group."""
    for i, row in enumerate(rows):
        for other in rows[:i]:
            if row.group & other.group and row.weak == other.weak:
                group = (row.group & other.group).title
                raise Refusal(F.MODAL_CONFLICT, row.name[0].lower(), first=other.name, second=row.name, group=group)


def rival(row: Code, rows: Sequence[Code]) -> bool:
    return any(other is not row and other.group & row.group for other in rows)


def uses(rows: Sequence[Code], letters: Sequence[str]) -> bool:
    """Whether a code of the block takes one of the center letters (G10 takes I, J, K)."""
    return any(letter in row.takes for row in rows for letter in letters if letter in "ijk")


def implied(rows: Sequence[Code], motion: Code | None, dialect: Dialect, axis_letters: Sequence[str]) -> Code:
    """The motion that a block means which names none. Raises Refusal."""
    word = axis_letters[0] if axis_letters else ""
    if any(row.weak for row in rows):
        raise Refusal(F.G80_AXES, word)
    for row in rows:
        if row.alone:
            return dialect.codes[row.alone]._replace(modal=False)
    if motion is None or motion.weak:
        raise Refusal(F.NO_MOTION_MODE, word)
    return motion


def used(rows: Sequence[Code], letters: Sequence[str], dialect: Dialect) -> None:
    """Refuse words that no code takes, or that two codes take."""
    for letter in letters:
        if letter in AXES + POLAR_WORDS or letter in dialect.items:
            continue
        takers = [row for row in rows if letter in row.takes]
        if not takers:
            raise Refusal(F.UNUSED_WORD, letter, word=letter.upper())
        if len(takers) > 1:
            first, second = takers[0].name, takers[1].name
            raise Refusal(F.AMBIGUOUS_WORD, letter, word=letter.upper(), first=first, second=second)


def meaning(code: str, letter: str) -> str:
    """What a word of a code means; empty where the house does not say."""
    return MEANINGS.get(f"{code} {letter}") or MEANINGS.get(letter, "")


def missing(rows: Sequence[Code], present: set[str]) -> None:
    for row in rows:
        for letter in row.needs:
            if letter not in present:
                raise Refusal(F.MISSING_WORD, code=row.name, word=letter.upper(), meaning=meaning(row.name, letter))
