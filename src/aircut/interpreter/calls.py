"""Calls and returns: M98, M99, G65 and CALL.

Sources: 000 sections 2.5, 3.3, 3.4; decisions AMB-CALL-1 to AMB-CALL-14.
"""

from __future__ import annotations

from functools import partial
from typing import Any, NamedTuple

from aircut.diagnostics import Refusal
from aircut.diagnostics import faults as F
from aircut.interpreter.state import State, out_of_range, whole
from aircut.interpreter.table import Code, Group, Order, Words

#: Letters that become local variables, and which (000 section 2.5).
ARGUMENTS = {
    "a": 1, "b": 2, "c": 3, "d": 7, "e": 8, "f": 9, "h": 11, "i": 4, "j": 5, "k": 6, "m": 13, "q": 17,
    "r": 18, "s": 19, "t": 20, "u": 21, "v": 22, "w": 23, "x": 24, "y": 25, "z": 26,
}  # fmt: skip


class Call(NamedTuple):
    """Run a subroutine. arguments: None keeps the caller's local variables (M98)."""

    name: str  # as called: digits, or a name, maybe with an extension
    numbered: bool
    repeat: int
    arguments: dict[str, float] | None
    numbers: tuple[float, ...] = ()  # values for #1, #2 … that are no arguments: a tool change macro's
    then: Any = None  # the transfer that follows when it has come back
    file: bool = False  # only a macro file is meant, not a subroutine of the calling file

    @property
    def own_locals(self) -> bool:
        """Whether it opens a new level of #1 to #33."""
        return self.arguments is not None or bool(self.numbers)


class Return(NamedTuple):
    """Back to the caller."""


def go(m: State, transfer: Call | Return) -> None:
    """Where control goes after the block: behind a tool change by macro, if the block has one."""
    before = m.transfer
    m.transfer = before._replace(then=transfer) if isinstance(before, Call) else transfer


def callee(w: Words) -> tuple[str, bool]:
    """Name of the called subroutine from the P word, and whether it is a number. Raises Refusal."""
    value: Any = w["p"]
    if isinstance(value, str):
        return value.strip(), False
    number = whole(w, "p")
    if number < 0:
        raise out_of_range(w, "p", "a subroutine's number")
    return str(number), True


def repeats(w: Words) -> int:
    """The L word: how many times; 1 without it. Raises Refusal."""
    if "l" not in w:
        return 1
    times = whole(w, "l")
    if times < 0:
        raise out_of_range(w, "l", "a number of repetitions")
    return times


def call(m: State, w: Words) -> None:
    """M98 P L: the subroutine shares the caller's #1 to #33."""
    name, numbered = callee(w)
    go(m, Call(name, numbered, repeats(w), None))


def macro(m: State, w: Words) -> None:
    """G65 P L and arguments, CALL: the macro has its own #1 to #33."""
    name, numbered = callee(w)
    arguments = {}
    for letter, value in w.items():
        if letter in ARGUMENTS:
            if value is not None:
                arguments[letter] = value
        elif letter not in "pl":
            raise Refusal(F.UNUSED_WORD, letter, word=letter.upper())
    m.transfer = Call(name, numbered, repeats(w), arguments)


def modal_macro(m: State, w: Words) -> None:
    """G66 P L and arguments: call the macro after each block that moves an axis, until G67."""
    macro(m, w)
    m.macro, m.transfer = m.transfer, None
    m.macro_level = m.calls
    m.macro_count = 0
    m.motion = m.dialect.codes["g1" if m.macro_motion else "g0"]


def no_modal_macro(m: State, w: Words) -> None:
    """G67."""
    m.macro = None
    m.motion = m.modal[Group.MOTION]


def custom(name: str, m: State, w: Words) -> None:
    """G200 to G499, M200 to M299: the macro file of that name, with arguments."""
    for letter in "pl":
        if letter in w:
            raise Refusal(F.UNUSED_WORD, letter, word=letter.upper())
    arguments = {letter: value for letter, value in w.items() if letter in ARGUMENTS and value is not None}
    m.transfer = Call(f"{name}.ngc", False, 1, arguments, file=True)


def back(m: State, w: Words) -> None:
    """M99."""
    go(m, Return())


def user(name: str) -> Code:
    """The row of a user defined code."""
    return Code(name, "User defined code", partial(custom, name.lower()), Group.NON_MODAL, Order.CALL, sole=True)


CODES = (
    Code("M98", "Call a subroutine", call, Group.CALL, Order.CALL, takes="pl", needs="p", text=True),
    Code("M99", "Return from a subroutine", back, Group.RETURN, Order.RETURN),
    Code("G65", "Call a macro with arguments", macro, Group.NON_MODAL, Order.CALL, needs="p", sole=True, text=True),
    Code("G66", "Modal macro call", modal_macro, Group.MACRO, Order.CALL, needs="p", sole=True, text=True),
    Code("G67", "Modal macro call off", no_modal_macro, Group.MACRO, Order.CALL),
    *(user(f"G{number}") for number in range(200, 500)),
    *(user(f"M{number}") for number in range(200, 300)),
    Code("CALL", "Call a macro with arguments", macro, Group.NON_MODAL, Order.CALL, needs="p", sole=True, text=True),
)
