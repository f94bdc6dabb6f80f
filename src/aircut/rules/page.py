"""The text of a program as the rules search it: in small letters, lines read when they are asked for."""

from __future__ import annotations

import re
from collections.abc import Iterator

from aircut.diagnostics import Refusal
from aircut.interpreter.interpreter import Interpreter
from aircut.interpreter.unit import Unit
from aircut.language.blocks import Line, parse
from aircut.language.structure import find_labels

#: A GOTO and its label; without one it is computed.
GOTO = re.compile(rb"goto[ \t]*(?:(\d[\d \t]*)|.)")
RETURN = re.compile(rb"m[ \t]*0*99(?![\d.])")


class Page:
    """The program's own file, after the run. Lines count from 0."""

    def __init__(self, run: Interpreter) -> None:
        self.run = run
        self.unit: Unit = run.units[run.files[0]]
        self.structure = self.unit.structure
        self.parts = Parts(self.unit)
        self.gotos = list(self._gotos())
        #: Whether the file is a macro: it begins with O or SUB, or its main part has an M99.
        self.macro = run.macro_file or any(self.structure.routine(line).name == "" for line in self.lines(RETURN))

    def line_of(self, place: int) -> int:
        """The line of a byte."""
        return self.unit.source.line_at(place)

    def lines(self, *patterns: re.Pattern[bytes]) -> list[int]:
        """Lines of the program on which one of the patterns stands, in order."""
        first, end = self.structure.order[0].first, self.structure.order[-1].end
        found = {
            self.line_of(place + match.start())
            for place, low in self.parts
            for pattern in patterns
            for match in pattern.finditer(low)
        }
        return sorted(line for line in found if first <= line < end)

    def parsed(self, line: int) -> Line | None:
        """A line read; None where it cannot be."""
        try:
            return parse(self.unit.clean(line).code)
        except Refusal:
            return None

    def _gotos(self) -> Iterator[tuple[int, list[int] | None]]:
        """Lines with a GOTO, and where it may lead: None where that is computed."""
        labels = None
        for place, match in ((place, match) for place, low in self.parts for match in GOTO.finditer(low)):
            if labels is None:
                labels = find_labels(self.unit.source, self.unit.block_delete)
            line = self.line_of(place + match.start())
            if match[1] is None:
                yield line, None
            else:
                yield line, labels.get(int(match[1].translate(None, b" \t")[:18]), [])


class Parts:
    """What a text has beside plain motion, in small letters: pieces of whole lines, each with its first byte."""

    def __init__(self, unit: Unit) -> None:
        self.source = unit.source
        self.kept = None if unit.source.mapped else list(self.made())

    def made(self) -> Iterator[tuple[int, bytes]]:
        for first, text in self.source.foreign():
            yield first, text.lower()

    def __iter__(self) -> Iterator[tuple[int, bytes]]:
        return self.made() if self.kept is None else iter(self.kept)

    def __contains__(self, text: bytes) -> bool:
        return any(text in low for _, low in self)
