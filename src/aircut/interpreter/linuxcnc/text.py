"""A line of LinuxCNC's language made clean: blanks gone, letters small, the last comment set aside.

Source: 001 Format of a line, Comments; the canonical listing, sections 4 and 7.
"""

from __future__ import annotations

import re
from typing import NamedTuple

from aircut.diagnostics import Refusal
from aircut.diagnostics import faults as F
from aircut.language.text import COMMENT, STRAY, illegal_character, stray_fault

LONGEST = 253  # bytes with the line end, whatever that is
BLANKS = " \t\r\n"
TRAILING = BLANKS + "\v\f"
NAME = re.compile("#<[^>]*>")
SMALL = {ord(c): None for c in BLANKS} | {c: c + 32 for c in range(ord("A"), ord("Z") + 1)} | {ord(COMMENT): STRAY}
PIECES = re.compile(r"\(([^()]*)\)|(;.*)|([^();]+)|(.)", re.DOTALL)
PYTHON = re.compile(r";[ \t]*py(run|reload)?,", re.IGNORECASE)  # the only one behind a semicolon that means something
STRANGE = re.compile(r"[^ -z\x01]")


class Clean(NamedTuple):
    """A clean line. comment: the last one in parentheses, without them."""

    code: str
    comment: str | None = None


def clean(text: str, length: int) -> Clean:
    """Clean one line of this many bytes, its end among them. Raises Refusal with the place in the line as written."""
    if length > LONGEST:
        raise too_long(length)
    text = text.rstrip(TRAILING)
    comment = None
    if "(" in text or ";" in text or ")" in text:
        code: list[str] = []
        for piece in PIECES.finditer(text):
            inner, rest, plain, stray = piece.groups()
            if plain is not None:
                code.append(plain.translate(SMALL))
            elif inner is not None:
                code.append(COMMENT)
                comment = inner
            elif rest is not None and PYTHON.match(rest):
                comment = rest[1:]
            elif stray == ")":  # found where the line is read further
                code.append(stray)
            elif stray is not None and rest is None:
                at = piece.start()
                raise Refusal(stray_fault(text, at), where=(at, at + 1))
        joined = "".join(code)
    else:
        joined = text.translate(SMALL)
    return Clean(joined, comment)


def too_long(length: int) -> Refusal:
    return Refusal(F.LINE_TOO_LONG, where=(0, 1), length=length, limit=LONGEST)


def columns(text: str) -> list[int]:
    """For each character of the clean line (and for its end) its index in the line as written."""
    places: list[int] = []
    for piece in PIECES.finditer(text):
        if piece[3] is not None:
            places += [at for at in range(*piece.span()) if text[at] not in BLANKS]
        elif piece[1] is not None or piece[4] is not None:
            places.append(piece.start())
        elif piece[2] is not None:
            break
    places.append(places[-1] + 1 if places else len(text.rstrip()))
    return places


def check(code: str) -> None:
    """Refuse characters that no line holds outside comments, or names of parameters. Raises Refusal."""
    if ")" in code:
        at = NAME.sub(lambda name: "_" * len(name[0]), code).find(")")
        if at >= 0:
            raise Refusal(F.STRAY_PARENTHESIS, where=(at, at + 1))
    if strange := STRANGE.search(code):
        raise illegal_character(strange[0], strange.span())
