"""The checks of a block that need its words alone, driven by the rows, and the order of its codes.

Source: 001 Repeated items, Modal groups, Order of execution; the canonical listing, sections 6, 7 and 15.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import floor
from typing import TYPE_CHECKING, NamedTuple

from aircut.diagnostics import Refusal
from aircut.diagnostics import faults as F
from aircut.interpreter.linuxcnc.arithmetic import integer
from aircut.interpreter.table import Code, Dialect, Group

if TYPE_CHECKING:
    from aircut.interpreter.linuxcnc.state import State

AXIS_WORDS = frozenset("xyzabcuvw@^")
ITEMS = "fst"  # words that are rows of their own
MOST_M = 4
WHOLE = {"m": "a whole number", "t": "a whole number", "h": "a whole number", "l": "a whole number"}
LOWEST = {"f": 0.0, "s": 0.0, "m": 0.0, "l": 0.0, "h": -1.0, "t": 0.0}
TWICE = "@^"  # of these the last counts
POINT = "G5.2"  # its points may be machine coordinates under G91 too
TURNS = 0.001  # what a P that counts turns or directions may differ from a whole number
FREE = -1.0  # a P or Q up to this may be given again; just this much counts as not given where it matters


def check_values(m: State, codes: Sequence[Code], words: Mapping[str, float]) -> None:
    """The values and modes that are a matter of form. Raises Refusal."""
    if ("@" in words or "^" in words) and m.plane_code != 170:
        raise Refusal(F.WRONG_STATE, "@", what="polar words need G17", hint="")
    absolute = m.absolute
    for row in codes:
        absolute = {"G90": True, "G91": False}.get(row.name, absolute)
        if "G0" in row.fits and not absolute and all(other.name != POINT for other in codes):
            raise Refusal(F.WRONG_STATE, "g", what="G53 is not possible under G91", hint="")
        if row.check is not None:
            row.check(m, words)
        for letter in row.counts:
            if letter in words:
                value = words[letter]
                if abs(value - round(value) if abs(value) < 1e9 else 1.0) > TURNS:
                    raise Refusal(F.NOT_INTEGER, letter, word=letter.upper(), value=value)
                if round(value) < row.least:
                    raise Refusal(F.BAD_VALUE, letter, word=letter.upper(), value=value, wanted="1 at least")


def given(w: Mapping[str, float], letter: str) -> bool:
    """Whether a word is there; a P or Q must not be the number that LinuxCNC keeps for none."""
    return letter in w and not (letter in "pq" and w[letter] == FREE)


class Steps(NamedTuple):
    """What a block does, in order."""

    codes: tuple[Code, ...]
    motion: Code | None  # the one that the axis words mean
    checked: bool = True  # there is something for check_values


def g_name(value: float) -> str:
    """Normalized name of a G code. Raises Refusal."""
    tenths = floor(value * 10.0) if abs(value) < 1e6 else 10**6
    rest = value * 10.0 - tenths
    if rest > 0.999:
        tenths += 1
    elif rest > 0.001:
        raise Refusal(F.UNKNOWN_CODE, "g", code=f"G{value:g}")
    if tenths < 0:
        raise Refusal(F.BAD_VALUE, "g", word="G", value=value, wanted="not below 0")
    return f"g{tenths // 10}.{tenths % 10}" if tenths % 10 else f"g{tenths // 10}"


def whole(letter: str, value: float) -> int:
    """A word that must be a whole number. Raises Refusal."""
    number = integer(value)
    if number is None:
        raise Refusal(F.NOT_INTEGER, letter, word=letter.upper(), value=value)
    return number


def gather(letters: Sequence[str], values: Sequence[float], dialect: Dialect) -> tuple[list[str], dict[str, float]]:
    """Names of the codes of a block, and its other words. Raises Refusal."""
    names: list[str] = []
    words: dict[str, float] = {}
    count = 0
    for letter, value in zip(letters, values, strict=False):  # values of settings follow
        if letter in WHOLE:
            value = whole(letter, value)
        if value < LOWEST.get(letter, value):
            wanted = f"not below {LOWEST[letter]:g}"
            raise Refusal(F.BAD_VALUE, letter, word=letter.upper(), value=value, wanted=wanted)
        if letter == "g":
            names.append(g_name(value))
        elif letter == "m":
            names.append(f"m{value:g}")
            count += 1
        else:
            if letter in words and letter not in TWICE and not (letter in "pq" and words[letter] <= FREE):
                raise Refusal(F.REPEATED_WORD, letter, word=letter.upper())
            words[letter] = value
    if count > MOST_M:
        raise Refusal(F.TOO_MANY_M, "m")
    return names, words


def find(name: str, dialect: Dialect) -> Code:
    """The row of a code. Raises Refusal."""
    row = dialect.codes.get(name)
    if row is None:
        raise Refusal(F.UNKNOWN_CODE, name[0], code=name.upper())
    return row


def arrange(names: Sequence[str], letters: Mapping[str, float], modal: Code, dialect: Dialect) -> Steps:
    """The steps of a block with these codes and words, under a motion mode. Raises Refusal."""
    rows = [find(name, dialect) for name in names]
    for i, row in enumerate(rows):
        for other in rows[:i]:
            if row.group & other.group and not row.weak and not other.weak:
                group = (row.group & other.group).title
                raise Refusal(F.MODAL_CONFLICT, row.name[0].lower(), first=other.name, second=row.name, group=group)
    alone = next((row for row in rows if row.sole), None)
    if alone is not None and (len(rows) > 1 or not set(letters) <= set(alone.takes)):
        raise Refusal(F.SOLE_CODE, "m", code=alone.name, other="anything else")
    axes = [letter for letter in letters if letter in AXIS_WORDS]
    polar = "@" in letters or "^" in letters
    if polar and ("x" in letters or "y" in letters):
        raise Refusal(F.POLAR_AND_AXES, "x" if "x" in letters else "y")
    cancels = [row for row in rows if row.weak]
    rows = [row for row in rows if not (row.weak and any(o.group & row.group for o in rows if not o.weak))]
    rows = list(dict.fromkeys(rows))  # what is weak may stand twice
    motion = next((row for row in rows if row.group & Group.MOTION and not row.weak), None)
    written = motion
    takers = [row for row in rows if row.axes and row is not motion]
    rivals = [row for row in takers if row.group & Group.NON_MODAL]  # the words of G43.1 may serve a motion too
    if motion is not None and rivals:
        raise Refusal(F.AXIS_CONFLICT, "g", first=rivals[0].name, second=motion.name)
    if axes and cancels and motion is None and not rivals:
        raise Refusal(F.G80_AXES, axes[0])
    if axes and not takers and motion is None:
        if modal.weak and not any("@" in row.takes for row in rows):  # G43.2 looks at them itself
            raise Refusal(F.NO_MOTION_MODE, axes[0])
        motion = modal
        rows.append(modal)
    elif not (motion or cancels or rivals or (takers and axes)) and any(letter in modal.wakes for letter in letters):
        used = {letter for row in rows for letter in row.takes}
        if any(letter in modal.wakes and letter not in used for letter in letters):
            motion = modal
            rows.append(modal)
    if polar and takers and motion is None:
        raise Refusal(F.UNUSED_WORD, "@", word="@ or ^")
    for row in rows:
        mover = written if row.nameless else motion
        beside = mover.name if mover else "G80" if cancels else ""
        if row.fits and beside not in row.fits:
            raise Refusal(F.MISFIT, "g", code=row.name, fits=" or ".join(filter(None, row.fits)), motion=beside)
    for row in rows:
        if row.needs_axes and not axes:
            raise Refusal(F.MISSING_AXES, code=row.name)
        for letter in row.needs:
            if not given(letters, letter):
                raise Refusal(F.MISSING_WORD, code=row.name, word=letter.upper(), meaning="")
        if written is not None and written.name in row.bars:
            raise Refusal(
                F.WRONG_STATE, "g", what=f"{row.name} is not possible with {written.name}: both use P", hint=""
            )
    items = [dialect.items[letter] for letter in letters if letter in ITEMS]
    takes = {letter for row in (*rows, *items) for letter in row.takes}
    for letter in letters:  # an unused P is found, whatever its value
        if (
            letter not in AXIS_WORDS
            and letter not in ITEMS
            and letter not in takes
            and (letter == "p" or given(letters, letter))
        ):
            raise Refusal(F.UNUSED_WORD, letter, word=letter.upper())
    order = sorted([*rows, *items], key=lambda row: row.order)
    checked = polar or any(row.fits or row.check or row.counts for row in order)
    return Steps(tuple(order), motion, checked)
