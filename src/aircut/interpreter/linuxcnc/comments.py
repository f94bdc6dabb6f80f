"""Comments of LinuxCNC's language, and those that do something.

Sources: 001 Comments to Comment parameters; the canonical listing, section 4.
"""

from __future__ import annotations

import re

from aircut.diagnostics import Refusal
from aircut.diagnostics import faults as F
from aircut.interpreter.linuxcnc.state import DEBUGGING, LAST, POSITION, State

ACTIVE = re.compile(r"[ \t]*(msg|debug|print|logopen|logappend|logclose|log|abort)(,|$)", re.IGNORECASE)
PYTHON = re.compile(r"[ \t]*(py,|py$|pyrun,|pyreload(,|$))", re.IGNORECASE)
PIECES = re.compile(r"#(\d+)|#<([^>]*)>|%(d)|%(f)|%\.(\d)f|%\.|(.)", re.DOTALL)
UNCLOSED = re.compile(r"#<[^>]*\Z")
UNKNOWN = "######"
LONGEST = 30  # characters of a number
NEAR_ZERO = 1e-4
BLANKS = str.maketrans("", "", " \t")


def say(m: State, comment: str) -> None:
    """Carry out the last comment of a block. Raises Refusal."""
    if PYTHON.match(comment):
        m.warn(F.PYTHON_COMMENT)
        return
    active = ACTIVE.match(comment)
    kind = active[1].lower() if active else ""
    if active is None or (kind == "logclose") == bool(active[2]):
        text = comment.lstrip(" \t")
        if comment:
            m.out.event("COMMENT", text)
            m.logs.comment(comment)
        return
    text = comment[active.end() :]
    if kind == "msg":
        m.out.event("MESSAGE", text, 0, "text")
    elif kind == "debug":
        if m.numbered[DEBUGGING] > 0.0:
            m.out.event("MESSAGE", expanded(m, text), 0, "text")
    elif kind == "print":
        m.out.event("PRINT", expanded(m, text))
    elif kind == "log":
        text = expanded(m, text)
        m.out.event("LOG", text)
        if m.logs.log is not None:
            m.logs.log.lines.append(text)
    elif kind == "abort":
        raise Refusal(F.ABORTED, text=expanded(m, text))
    elif kind == "logclose":
        m.out.event("LOGCLOSE")
        m.logs.log = None
    else:
        m.out.event(kind.upper(), text)
        m.logs.log = m.logs.start(text, kind == "logappend")


def expanded(m: State, text: str) -> str:
    """The text with its parameters' values, up to a name that is not closed; %d, %f and %.nf set the decimals of
    those that follow.
    """
    decimals = 6
    parts: list[str] = []
    for number, name, whole, four, digits, other in PIECES.findall(UNCLOSED.sub("", text)):
        if whole:
            decimals = 0
        elif four:
            decimals = 4
        elif digits:
            decimals = int(digits)
        elif other:
            parts.append(other)
        elif number or name:
            value = value_of(m, number, name)
            value = None if value is None else float(value)  # also where it is none to calculate with
            shown = "" if value is None else f"{0.0 if abs(value) < NEAR_ZERO else value:.{decimals}f}"
            shown = "-nan" if shown == "nan" else shown
            parts.append(shown if 0 < len(shown) < LONGEST else UNKNOWN)
        else:
            parts.append(".")  # a %. that is no format loses its %
    return "".join(parts)


def value_of(m: State, number: str, name: str) -> float | None:
    """Value of a parameter in a text; None where there is none."""
    if number:
        index = int(number[:9])
        if index > LAST:
            return None
        return m.beside(index - POSITION) if POSITION <= index < POSITION + 9 else m.numbered[index]
    key = name.translate(BLANKS).lower()
    try:
        return m.read_name(key) if m.exists(key) else None
    except Refusal:
        return None
