"""Outputs and inputs of LinuxCNC's language: M62 to M68.

Source: the canonical listing, section 14.
"""

from __future__ import annotations

from functools import partial

from aircut.diagnostics import Refusal
from aircut.diagnostics import faults as F
from aircut.interpreter.linuxcnc.motion import wrong
from aircut.interpreter.linuxcnc.state import INPUT, State
from aircut.interpreter.table import Code, Group, Order, Words

MOST = 1e9
NO_VALUE = -1.0  # of M67 and M68 without Q
WAYS = 4  # to wait for an input, beside 0: not at all


def bar(m: State) -> None:
    if m.cutter:
        raise Refusal(F.UNDER_COMPENSATION, what="M62 to M68")


def index(w: Words, letter: str) -> int:
    """The whole number next to a word. Raises Refusal."""
    if letter not in w:
        raise Refusal(F.MISSING_WORD, code="M62 to M68", word=letter.upper(), meaning="the number of the output")
    return round(w[letter]) if abs(w[letter]) < MOST else -1


def digital(event: str, m: State, w: Words) -> None:
    """M62 to M65: output P."""
    bar(m)
    m.out.event(event, index(w, "p"))


def analog(event: str, m: State, w: Words) -> None:
    """M67, M68: output E to Q."""
    bar(m)
    number = index(w, "e")
    if number < 0:
        raise Refusal(F.BAD_VALUE, "e", word="E", value=w["e"], wanted="an output, from 0")
    m.out.event(event, number, w.get("q", NO_VALUE))


def wait(m: State, w: Words) -> None:
    """M66: prints nothing; #5399 of a digital input becomes whether it was not zero. Raises Refusal."""
    bar(m)
    if ("p" in w) == ("e" in w):
        raise wrong("M66 needs P or E, and not both")
    if index(w, "p" if "p" in w else "e") < 0:
        letter = "p" if "p" in w else "e"
        raise Refusal(F.BAD_VALUE, letter, word=letter.upper(), value=w[letter], wanted="an input, from 0")
    kind = int(w.get("l", 0.0))
    if kind and w.get("q", 0.0) <= 0.0:
        raise wrong("M66 L1 to L4 needs Q above zero")
    if "e" in w and kind:
        raise wrong("M66 E takes only L0")
    if kind > WAYS:
        m.warn(F.LOOSE_VALUE, "l", word="L", value=kind, wanted=f"ways to wait from 0 to {WAYS}")
    if "p" in w:
        m.numbered[INPUT] = float(m.numbered[INPUT] != 0.0)


def unknown(number: int, m: State, w: Words) -> None:
    """M100 to M199 are programs beside LinuxCNC, of which the stand-alone interpreter has none. Raises Refusal."""
    raise Refusal(F.UNKNOWN_CODE, "m", code=f"M{number}")


io = partial(Code, group=Group.IO, order=Order.IO)

CODES = (
    *(Code(f"M{n}", "User's code", partial(unknown, n), Group.USER, Order.USER, takes="pq") for n in range(100, 200)),
    io("M62", "Output on with the motion", partial(digital, "SET_MOTION_OUTPUT_BIT"), takes="p"),
    io("M63", "Output off with the motion", partial(digital, "CLEAR_MOTION_OUTPUT_BIT"), takes="p"),
    io("M64", "Output on", partial(digital, "SET_AUX_OUTPUT_BIT"), takes="p"),
    io("M65", "Output off", partial(digital, "CLEAR_AUX_OUTPUT_BIT"), takes="p"),
    io("M66", "Wait for an input", wait, takes="pelq"),
    io("M67", "Analog output with the motion", partial(analog, "SET_MOTION_OUTPUT_VALUE"), takes="eq"),
    io("M68", "Analog output", partial(analog, "SET_AUX_OUTPUT_VALUE"), takes="eq"),
)
