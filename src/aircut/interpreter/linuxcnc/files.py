"""Texts of programs and subroutines, read line by line as they are met, and where they are found.

Source: the canonical listing, section 9.
"""

from __future__ import annotations

import re
from array import array
from collections.abc import Iterable, Sequence
from pathlib import Path, PurePosixPath
from typing import Any

from aircut.diagnostics import Refusal
from aircut.diagnostics import faults as F
from aircut.interpreter.linuxcnc import calls
from aircut.interpreter.linuxcnc.blocks import Block, OLine, check_number, parse_o
from aircut.interpreter.linuxcnc.shapes import Words
from aircut.interpreter.linuxcnc.text import clean
from aircut.source import Source


class Line:
    """A line, read as far as needed. code: clean; comment: its last one."""

    __slots__ = ("block", "code", "comment", "fanuc", "literals", "oline")

    def __init__(self, code: str, comment: str | None) -> None:
        self.code = code
        self.comment = comment
        self.oline: OLine | None = None
        self.block: Block | None = None
        self.literals: tuple[float, ...] = ()
        self.fanuc: re.Match[str] | None = None  # M98 or M99 at its start


class Text:
    """A file being run: its source, and its lines as they are first met."""

    def __init__(self, source: Source) -> None:
        self.source = source
        self.lines: dict[int, Line] = {}
        self.slow = bytearray(len(source))  # lines at which the fast lane has got nowhere
        self.ran = bytearray(len(source))  # plain lines that were run
        self.looms: dict[int, Any] = {}  # loops compiled whole, by their first line; None: they cannot be
        self.words: Words | None = None
        self.plain: dict[int, tuple[bytes, array[float]]] = {}  # words of lines that were run again

    def words_of(self, at: int, keep: bool) -> tuple[bytes, array[float]] | None:
        """Shape and values of a plain line; None of others. keep: it is likely to be run again."""
        known = self.plain.get(at)
        if known is None:
            if self.words is None:
                self.words = Words(self.source)
            known = self.words.of(at)
            if keep and known is not None:
                self.plain[at] = known
        return known

    def line(self, at: int) -> Line:
        """A clean line. Raises Refusal."""
        known = self.lines.get(at)
        if known is None:
            text = clean(self.source.text(at), self.source.length(at))
            known = Line(text.code, text.comment)
            check_number(text.code)
            known.oline = parse_o(text.code)
            known.fanuc = calls.START.match(text.code)
            self.lines[at] = known
        return known


# --- files of subroutines


def folders(program: str, others: Iterable[Path]) -> list[Path]:
    """Where files of subroutines are looked for: the working directory, the program's folder, the machine's."""
    return list(dict.fromkeys((Path(), Path(program).parent, *others)))


def find(name: str, places: Sequence[Path]) -> Path | None:
    """The file of a subroutine, in or below one of the folders; None where there is none."""
    path = PurePosixPath(f"{name}.ngc")
    if path.is_absolute() or ".." in path.parts or "\0" in name:
        return None
    return next((folder / path for folder in places if (folder / path).is_file()), None)


def load(path: Path) -> Text:
    """A file's text. Raises Refusal."""
    try:
        return Text(Source.load(path))
    except OSError as error:
        raise Refusal(F.CANNOT_READ, reason=f"{path}: {error.strerror}") from None


def missing(label: str, name: str, file: str | None, places: Sequence[Path]) -> str:
    """A hint where a subroutine is not found. file: where it should be."""
    if file is not None:
        return f"there is no O<{label}> SUB in {file}"
    where = ", ".join(str(folder.absolute()) for folder in places)
    return f"it is neither in this file, behind the call, nor is there a file {name}.ngc in {where}"
