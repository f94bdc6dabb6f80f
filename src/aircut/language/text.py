"""A line made clean: blanks gone, letters small, comments set aside.

Blanks have no meaning outside comments and strings (decision AMB-LEX-2), so they
are deleted before parsing; `columns` finds the way back to the line as written.
"""

from __future__ import annotations

import re
from typing import NamedTuple

from aircut.diagnostics import Fault, Refusal
from aircut.diagnostics import faults as F

COMMENT = "\x01"  # stands where a comment stood: separates words, fits into none
STRAY = "\ufdd0"  # stands for that character itself, which fits nowhere

BLANKS = " \t\r"
SMALL = {ord(c): None for c in BLANKS} | {c: c + 32 for c in range(ord("A"), ord("Z") + 1)} | {ord(COMMENT): STRAY}
PIECES = re.compile(r'\(([^()]*)\)|;(.*)|("[^"]*")|([^();"]+)|(.)', re.DOTALL)


class Clean(NamedTuple):
    """A clean line."""

    code: str
    comments: tuple[str, ...] = ()  # those in parentheses, without them


def clean(text: str) -> Clean:
    """Clean one line. Raises Refusal with the place in the line as written."""
    if not (";" in text or "(" in text or ")" in text or '"' in text):
        return Clean(text.translate(SMALL))
    code: list[str] = []
    comments: list[str] = []
    for piece in PIECES.finditer(text):
        comment, _, string, plain, stray = piece.groups()
        if plain is not None:
            code.append(plain.translate(SMALL))
        elif comment is not None:
            code.append(COMMENT)
            comments.append(comment)
        elif string is not None:
            code.append(string)
        elif stray is not None:
            at = piece.start()
            raise Refusal(stray_fault(text, at), where=(at, at + 1))
    return Clean("".join(code), tuple(comments))


def illegal_character(character: str, where: tuple[int, int], hint: str = "") -> Refusal:
    """The Refusal of a character that has no place where it stands."""
    number = ord(COMMENT if character == STRAY else character)
    name = f"“{character}”" if character.isprintable() else f"character {number:#04x}"
    return Refusal(F.ILLEGAL_CHARACTER, where=where, character=name, hint=hint)


def stray_fault(text: str, at: int) -> Fault:
    """What is wrong with a delimiter that opens or closes nothing."""
    if text[at] == '"':
        return F.UNCLOSED_STRING
    if text[at] == ")":
        return F.STRAY_PARENTHESIS
    return F.NESTED_COMMENT if "(" in text[at + 1 :].split(")")[0] else F.UNCLOSED_COMMENT


def columns(text: str) -> list[int]:
    """For each character of the clean line (and for its end) its index in the line as written."""
    places: list[int] = []
    for piece in PIECES.finditer(text):
        if piece[4] is not None:
            places += [at for at in range(*piece.span()) if text[at] not in BLANKS]
        elif piece[1] is not None:
            places.append(piece.start())
        elif piece[3] is not None:
            places += range(*piece.span())
        elif piece[2] is not None:
            break
    places.append(len(text.rstrip()) if not places else max(places[-1] + 1, 0))
    return places
