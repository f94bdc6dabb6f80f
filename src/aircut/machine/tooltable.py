"""LinuxCNC's tool table: a tool a line, in words of a letter and a number.

    T1 P1 D+6.000000 Z+42.500000 ;6 mm end mill

Lengths are in the machine's units, which the table does not name. Read as LinuxCNC 2.9
reads it, but stricter with numbers: T5.5 or D1mm are faults here, where LinuxCNC takes the
digits and drops the rest.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator

import msgspec

from aircut.machine.tools import EMPTY, Tool

NUMBER = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:e[+-]?\d+)?", re.ASCII | re.IGNORECASE)
WHOLE = re.compile(r"[+-]?\d{1,9}(\.0*)?", re.ASCII)  # tool editors write Q2.0

#: Words of lengths, and where they go in a Tool.
LENGTHS = {"D": "diameter", **{letter: letter.lower() for letter in "XYZUVW"}}
#: Words of a turning tool: front angle and back angle in degrees, orientation 1 to 9.
TURNING = {"I": "p1", "J": "p2", "Q": "p3"}
ANGLES = {letter: letter.lower() for letter in "ABC"}
WHOLE_WORDS = "TPQ"
LATHE = 8
UNUSED = Tool(-1)  # in a slot of LinuxCNC's whose line is at fault


def read(text: str, unit_mm: float) -> Iterator[tuple[int, Tool | None, str]]:
    """Each line that is not blank: its number from 1, its tool, and what was wrong with it.

    unit_mm: mm in one of the table's units of length.
    Without a tool the line is skipped.
    The comment is the name, P the slot; I, J and Q become parameters 1 to 3 and make it
    a lathe tool (there is no other place for them).
    """
    for number, line in enumerate(text.split("\n"), 1):
        words, _, comment = line.partition(";")
        if not words.strip():
            continue
        try:
            yield number, entry(words.split(), comment.strip(), unit_mm), ""
        except ValueError as error:
            yield number, None, str(error)


def slots(text: str, unit_mm: float) -> list[Tool]:
    """The tools by LinuxCNC's slots: a line with a P word has the next one from 1; one without is in the spindle, 0."""
    found = [EMPTY]
    lines = text.split("\n")
    for number, tool, _ in read(text, unit_mm):
        if any(word[0] in "Pp" for word in lines[number - 1].partition(";")[0].split()):
            found.append(tool or UNUSED)
        elif tool:
            found[0] = tool
    return found


def entry(words: list[str], name: str, unit_mm: float) -> Tool:
    """The tool of a line's words. Raises ValueError."""
    values: dict[str, float] = {}
    for word in words:
        letter, number = word[0].upper(), word[1:]
        if letter not in "TP" and letter not in LENGTHS and letter not in {**TURNING, **ANGLES}:
            raise ValueError(f"unknown word {word[:20]}")
        if not (WHOLE if letter in WHOLE_WORDS else NUMBER).fullmatch(number):
            raise ValueError(f"{word[:20]} is not a word with {'a whole' if letter in WHOLE_WORDS else 'a'} number")
        values[letter] = float(number)
    if values.get("T", 0.0) < 1.0:
        raise ValueError("no T word above 0")
    # Rounding to 1e-9 mm takes away what binary adds to 0.125 * 25.4.
    fields = {field: round(values[w] * unit_mm, 9) for w, field in LENGTHS.items() if w in values}
    fields |= {field: values[w] for w, field in (TURNING | ANGLES).items() if w in values}
    if not all(math.isfinite(value) for value in fields.values()):
        raise ValueError("a number is too large")
    turning = any(values.get(w) for w in TURNING)
    tool = Tool(int(values["T"]), name, slot=max(int(values.get("P", 0.0)), 0), type=LATHE if turning else 0)
    return msgspec.structs.replace(tool, **fields)
