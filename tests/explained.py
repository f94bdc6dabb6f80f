"""Differences from LinuxCNC's interpreter that are its own faults, or rounding that decides: each with its reason.

What is behind such a difference in a program is not compared.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Sequence
from math import hypot
from typing import NamedTuple

NUMBER = re.compile(r"-?\d+\.\d+")
POLE = 1e14  # tangents beyond it are those of right angles
BACK_OFF = (0.254, 0.01)  # mm, inches


class Explained(NamedTuple):
    """One kind of them. applies: to the program, and the first lines of the two listings that differ."""

    name: str
    reason: str
    applies: Callable[[str, str, str, float], bool]  # program, lines, greatest offset before


def numbers(line: str) -> list[float]:
    return [float(number) for number in NUMBER.findall(line)]


def huge(text: str, ours: str, theirs: str, offset: float) -> bool:
    x, y = numbers(ours), numbers(theirs)
    same = len(x) == len(y) and NUMBER.sub("#", ours) == NUMBER.sub("#", theirs)
    return same and all(abs(p - q) <= max(1e-4, 1e-11 * max(abs(p), offset)) for p, q in zip(x, y, strict=True))


def still(text: str, ours: str, theirs: str, offset: float) -> bool:
    x, y = numbers(ours), numbers(theirs)
    if not re.search(r"G38\.", text, re.IGNORECASE) or len(x) != len(y):
        return False
    steps = [abs(p - q) for p, q in zip(x, y, strict=True) if abs(p - q) > 1e-4]
    if all(any(abs(step - off) < 1e-3 for off in BACK_OFF) for step in steps):
        return True
    turned = re.search(r"^[^XYZ(\n]*[ABC][^XYZ(\n]*$", text, re.IGNORECASE | re.MULTILINE) is not None
    return turned and "STRAIGHT_" in ours and x[3:] == y[3:] and any(hypot(*steps) <= 2.0 * off for off in BACK_OFF)


def unset(text: str, ours: str, theirs: str, offset: float) -> bool:
    if not re.search(r"G0?5(\.[13])?(?!\d)", text, re.IGNORECASE):
        return False
    across = {"G19": r"TRAVERSE\(0\.0000,", "G18": r"TRAVERSE\(\S+ 0\.0000,"}
    level = any(plane in text.upper() and re.search(move, theirs) for plane, move in across.items())
    return level or ("@" in text and "ON_RESET" in ours and "STRAIGHT_" in theirs)


def turning(text: str, ours: str, theirs: str, offset: float) -> bool:
    x, y = numbers(ours), numbers(theirs)
    if len(x) != len(y) or NUMBER.sub("#", ours) != NUMBER.sub("#", theirs):
        return False
    if re.search(r"(sin|cos|tan)\[[^()\n]*(\*\*|exp)", text, re.IGNORECASE):
        return True
    poles = all(min(abs(p), abs(q)) > POLE for p, q in zip(x, y, strict=True) if abs(p - q) > 1e-4)
    return poles and re.search(r"tan\[", text, re.IGNORECASE) is not None


def declared(text: str, ours: str, theirs: str, offset: float) -> bool:
    beside = re.search(r"G4[12]", text, re.IGNORECASE) is not None
    return beside and "CHANGE_TOOL_NUMBER" in theirs and ("STRAIGHT_" in ours or "ARC_FEED" in ours)


EXPLAINED = (
    Explained(
        "huge",
        "numbers and offsets above a million millions have but sixteen digits that mean something",
        huge,
    ),
    Explained("still", "a G38 without a way backs off in the direction of a rounding error, or not at all", still),
    Explained("unset", "behind a spline it takes over an X and Y never set, all but zero, which then decide", unset),
    Explained("declared", "M61 beside a contour: the end of the move that it waits with is lost", declared),
    Explained(
        "turning",
        "the angles of SIN, COS and TAN of huge powers, and TAN of a right angle: it calculates them in 80 bits",
        turning,
    ),
)
MET: Counter[str] = Counter()


def explained(text: str, difference: str, listing: Sequence[str] = ()) -> bool:
    """Whether a difference, as oracle.differ words it in a listing, is one of these; it is counted then."""
    lines = difference.split("\n")
    if len(lines) < 3:
        return False
    before = listing[: int(re.search(r"\d+", lines[0])[0])]  # type: ignore[index]
    offset = max((abs(n) for line in before if "_OFFSET(" in line for n in numbers(line)), default=0.0)
    ours, theirs = lines[1].removeprefix("  ours   "), lines[2].removeprefix("  theirs ")
    kind = next((kind for kind in EXPLAINED if kind.applies(text, ours, theirs, offset)), None)
    if kind is not None:
        MET[kind.name] += 1
    return kind is not None
