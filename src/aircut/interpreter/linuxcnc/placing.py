"""In which subroutine a line of a file stands: a run that starts from there arrives in a call of it."""

from __future__ import annotations

import re

from aircut.diagnostics import Refusal
from aircut.interpreter.linuxcnc.files import Text
from aircut.interpreter.linuxcnc.unrun import O_WORD

END = re.compile(rb"m[ \t]*0*(?:2|30)(?![\d.])", re.IGNORECASE)
BACK = re.compile(rb"m[ \t]*0*99(?![\d.])", re.IGNORECASE)


def sub_of(text: Text, line: int) -> str:
    """Name of the subroutine in which a line (from 0) stands; empty in the main program.

    Between SUB and ENDSUB; or, where the main program has ended before, behind a bare number up to M99.
    """
    raw = text.source.raw
    left = False  # by an M99 before the line
    for at in range(line, -1, -1):
        content = raw(at)
        left = left or (at < line and BACK.search(content) is not None)
        if not O_WORD.match(content):
            continue
        try:
            word = text.line(at).oline
        except Refusal:
            continue
        if word is None or not isinstance(word.label, str):
            continue
        if word.keyword == "sub":
            return word.label
        if word.keyword == "endsub" and at < line:
            return ""
        if word.keyword == "":
            ended = any(END.search(raw(before)) for before in range(at))
            return word.label if ended and not left else ""
    return ""
