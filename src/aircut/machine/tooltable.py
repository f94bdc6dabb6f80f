"""LinuxCNC's tool table: a tool a line, in words of a letter and a number.

    T1 P1 D+6.000000 Z+42.500000 ;6 mm end mill

Lengths are in the machine's units, which the table does not name. Read as LinuxCNC 2.9
reads it (`tooldata_read_entry`), but stricter with numbers: T5.5 or D1mm are faults here,
where LinuxCNC takes the digits and drops the rest.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator

import msgspec

from aircut.machine.tools import Tool

NUMBER = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:e[+-]?\d+)?", re.ASCII | re.IGNORECASE)
WHOLE = re.compile(r"[+-]?\d{1,9}", re.ASCII)

#: Words of lengths, and where they go in a Tool.
LENGTHS = {"D": "diameter", "X": "x", "Y": "y", "Z": "z"}
#: Words of a turning tool: front angle and back angle in degrees, orientation 1 to 9.
TURNING = {"I": "p1", "J": "p2", "Q": "p3"}
WHOLE_WORDS = "TPQ"
DROPPED = "ABCUVW"  # offsets that a Tool has no place for
LATHE = 8


def read(text: str, unit_mm: float) -> Iterator[tuple[int, Tool | None, str]]:
    """Each line that is not blank: its number from 1, its tool, and what was wrong with it.

    unit_mm: mm in one of the table's units of length.
    Without a tool the line is skipped; with a tool and a fault, some word of it is dropped.
    The comment is the name, P the slot; I, J and Q become parameters 1 to 3 and make it
    a lathe tool (there is no other place for them).
    """
    for number, line in enumerate(text.split("\n"), 1):
        words, _, comment = line.partition(";")
        if not words.strip():
            continue
        try:
            tool, fault = entry(words.split(), comment.strip(), unit_mm)
        except ValueError as error:
            tool, fault = None, str(error)
        yield number, tool, fault


def entry(words: list[str], name: str, unit_mm: float) -> tuple[Tool, str]:
    """The tool of a line's words, and what of it is dropped. Raises ValueError."""
    values: dict[str, float] = {}
    for word in words:
        letter, number = word[0].upper(), word[1:]
        if letter not in "TP" and letter not in LENGTHS and letter not in TURNING and letter not in DROPPED:
            raise ValueError(f"unknown word {word[:20]}")
        if not (WHOLE if letter in WHOLE_WORDS else NUMBER).fullmatch(number):
            raise ValueError(f"{word[:20]} is not a word with {'a whole' if letter in WHOLE_WORDS else 'a'} number")
        values[letter] = float(number)
    if values.get("T", 0.0) < 1.0:
        raise ValueError("no T word above 0")
    # Rounding to 1e-9 mm takes away what binary adds to 0.125 * 25.4.
    fields = {field: round(values[w] * unit_mm, 9) for w, field in LENGTHS.items() if w in values}
    fields |= {field: values[w] for w, field in TURNING.items() if w in values}
    if not all(math.isfinite(value) for value in fields.values()):
        raise ValueError("a number is too large")
    turning = any(values.get(w) for w in TURNING)
    tool = Tool(int(values["T"]), name, slot=max(int(values.get("P", 0.0)), 0), type=LATHE if turning else 0)
    dropped = [w for w in DROPPED if values.get(w)]
    return msgspec.structs.replace(tool, **fields), f"no place for {', '.join(dropped)}: dropped" if dropped else ""
