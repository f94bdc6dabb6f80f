"""Plain lines (see kernels.scan) in the general lane: what lines of one shape mean is found out once.

What a line's values decide beyond that, and lines with anything doubtful, is left to
`blocks`, which reads every character.
"""

from __future__ import annotations

import re
from array import array
from collections.abc import Collection

from aircut.interpreter.linuxcnc.arranging import FREE, LOWEST, MOST_M, WHOLE, Steps
from aircut.interpreter.linuxcnc.state import NINE
from aircut.interpreter.linuxcnc.text import LONGEST
from aircut.kernels.scan import PLAIN
from aircut.source import BATCH, Batch, Source

WORD = re.compile(rb"([a-z])([\d.]*)")
ELSEWHERE = frozenset(("m2", "m30", "m98", "m99"))  # codes that end a program or lead away
FIRST_BATCH = 16  # lines scanned where the program has jumped
MOST = 1e9  # whole numbers beyond are left to others


class Shape:
    """What lines of one shape have in common."""

    __slots__ = ("codes", "letters", "limits", "steps")

    def __init__(self, codes: tuple[str, ...], letters: tuple[str, ...]) -> None:
        self.codes = codes
        self.letters = letters
        #: Letters whose values have limits of form: the lowest, and whether they must be whole.
        self.limits = [
            (letter, LOWEST.get(letter, -MOST), letter in WHOLE)
            for letter in letters
            if letter in LOWEST or letter in WHOLE or letter in "pq"
        ]
        self.steps: dict[str, Steps] = {}  # by the motion mode in force

    def words(self, values: array[float]) -> dict[str, float] | None:
        """The words of a line; None where a value is at fault, or means that it is absent."""
        words = dict(zip(self.letters, values))  # noqa: B905  one value a letter by construction
        for letter, least, whole in self.limits:
            value = words[letter]
            if value < least or (value <= FREE and letter in "pq"):
                return None
            if whole:
                if not (value < MOST and value == int(value)):
                    return None
                words[letter] = int(value)
        return words


def shape_of(words: bytes, axes: Collection[str]) -> Shape | None:
    """The shape that these words have, see kernels.scan. axes: letters of those that the machine has."""
    codes: list[str] = []
    letters: list[str] = []
    for match in WORD.finditer(words):
        letter = match[1].decode()
        if match[2]:
            codes.append(letter + match[2].decode())
        else:
            letters.append(letter)
    of_m = [name for name in codes if name[0] == "m"]
    if len(of_m) > MOST_M or any("." in name or name in ELSEWHERE for name in of_m):
        return None
    if any(letter in NINE and letter not in axes for letter in letters):
        return None
    return Shape(tuple(codes), tuple(letters))


class Words:
    """The words of a source's plain lines; lines in sequence are scanned in ever larger batches."""

    def __init__(self, source: Source) -> None:
        self.source = source
        self.batch = Batch(min(BATCH, max(len(source), 1)))
        self.room = FIRST_BATCH
        self.long: frozenset[int] = frozenset()  # lines of the batch that are too long, or nearly

    def of(self, line: int) -> tuple[bytes, array[float]] | None:
        """Shape and values of a line; None where it is not plain."""
        source, batch = self.source, self.batch
        at = line - batch.first
        if not 0 <= at < batch.count:
            self.room = min(len(batch.shape_ends), self.room * 8) if at == batch.count else FIRST_BATCH
            source.batch(line, self.room, batch)
            start, end = source.start(line), source.start(min(line + batch.count, source.ended))
            lines = source.data[start:end].split(b"\n") if end > start else []
            self.long = frozenset(line + nth for nth, text in enumerate(lines) if len(text) >= LONGEST - 1)
        if source.classes[line] != PLAIN or line in self.long or line >= source.ended:
            return None
        return batch.words(line)
