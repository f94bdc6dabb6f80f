"""Messages and media: M109, M120; and the parameters of G10 L100.

Sources: 000 section 10; decisions AMB-MSG-1 to AMB-MSG-11, AMB-VAR-5.
"""

from __future__ import annotations

from collections.abc import Generator
from functools import partial
from pathlib import Path
from typing import Any

from aircut.diagnostics import Refusal
from aircut.diagnostics import faults as F
from aircut.interpreter import media as media_files
from aircut.interpreter import rotary
from aircut.interpreter.compiling import walk
from aircut.interpreter.requests import Answer, Ask, Overlay, Request
from aircut.interpreter.state import State, out_of_range, whole
from aircut.interpreter.table import Code, Group, Order, Words
from aircut.language.expressions import Parser
from aircut.language.text import clean

ERROR, VALUE, HUD, CUSTOM = -1, 3, 4, 100  # kinds, by Q
MOST = 10  # values that can be asked for
INPUTS = 5730  # number of the first value's variable
WITHOUT_TEXT = "generic user error with {} q-1"


def expanded(m: State, text: str) -> str:
    """The text with the values of its #n and #<name>."""

    from aircut import markup

    def value(reference: str) -> str | None:
        try:
            number = walk(Parser(clean(reference).code).variable(), m)
        except Refusal:
            return None
        return markup.number(number)

    return markup.expand(text, value)


def show(media: bool, m: State, w: Words) -> Generator[Request, Any, None]:
    """M109, M120 P Q R D: tell the operator, and wait where the window has buttons. Raises Refusal."""
    from aircut import markup

    kind = whole(w, "q") if "q" in w else 0
    name = "m120" if media else "m109"
    if not (kind in (ERROR, 0, 1, 2, VALUE, HUD) or kind >= CUSTOM):
        raise out_of_range(w, "q", "-1, 0 to 4, or 100 and above")
    if "p" not in w and kind != ERROR:
        raise Refusal(F.MISSING_WORD, code=name.upper(), word="P", meaning="P is the text, in quotes")
    given = w.get("p", WITHOUT_TEXT.format(name))
    text = expanded(m, given) if isinstance(given, str) else markup.number(given)
    if kind == ERROR:
        raise Refusal(F.USER_ERROR, text=text)
    number = asked(w, kind)
    m.out.event("MESSAGE", text, kind, "media" if media else "text")
    defaults = [w.get("d", m.entered[0] if m.entered[0] is not None else 0.0)]
    defaults += [value if value is not None else 0.0 for value in m.entered[1:number]]
    file = picture(m, text) if media else None
    if kind == HUD:
        yield Overlay(text, media, file)
        return
    reply: Answer | None = yield Ask(text, media, kind, tuple(defaults[:number]), file)
    if reply is not None and reply.stop:
        raise Refusal(F.OPERATOR_STOP, text=markup.plain(markup.parse(text)))
    values = defaults[:number] if reply is None or not reply.values else list(reply.values)[:number]
    if kind == VALUE:
        m.answer = values[0] if values else None
    elif kind >= CUSTOM:
        m.entered[: len(values)] = values


def picture(m: State, name: str) -> Path | None:
    """The picture of M120; one that the machine's media folder lacks is told of (AMB-MSG-11)."""
    if m.machine.folder is None:
        return None
    folder = m.machine.folder / "media"
    found = media_files.find(name, folder)
    if found is None and name:
        m.warn(F.NO_PICTURE, "p", name=name, folder=folder)
    return found


def asked(w: Words, kind: int) -> int:
    """How many values the window asks for: the R word. Raises Refusal."""
    if kind != VALUE and kind < CUSTOM:
        if "r" in w:
            raise out_of_range(w, "r", "this window asks for no values")
        return 0
    number = whole(w, "r") if "r" in w else 1
    if not 1 <= number <= (MOST if kind >= CUSTOM else 1):
        raise out_of_range(w, "r", "1 to 10 values; one with Q3")
    return number


def set_parameter(m: State, w: Words) -> None:
    """G10 L100 P V: one of the special parameters. Raises Refusal."""
    number, value = whole(w, "p"), w["v"]
    if INPUTS <= number < INPUTS + MOST:
        m.entered[number - INPUTS] = value
    elif number == 5800:
        if value not in (0.0, 1.0):
            raise out_of_range(w, "v", "0 for G0, 1 for G1")
        m.macro_motion = int(value)
    elif 5801 <= number <= 5804:
        if not rotary.set_parameter(m, number, value):
            raise out_of_range(w, "v", "a modulus above 0" if number == 5801 else "rotary modes are 0 to 3")
    else:
        raise out_of_range(w, "p", "5730 to 5739, or 5800 to 5804")


CODES = (
    Code("M109", "Message", partial(show, False), Group.MESSAGE, Order.MESSAGE, takes="pqrd", text=True),
    Code("M120", "Media message", partial(show, True), Group.MESSAGE, Order.MESSAGE, takes="pqrd", text=True),
)

SETTINGS = {
    100: Code(
        "G10 L100", "Special parameters", set_parameter, Group.NON_MODAL, Order.NON_MODAL, takes="pv", needs="pv"
    ),
}
