"""Operators and functions of LinuxCNC's language: those of the house, but for what it does otherwise."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from typing import Any

from aircut.diagnostics import Refusal
from aircut.diagnostics import faults as F
from aircut.kernels import angles
from aircut.language.arithmetic import EQUAL, round_half_away
from aircut.language.arithmetic import FUNCTIONS as HOUSE_FUNCTIONS
from aircut.language.arithmetic import OPERATORS as HOUSE_OPERATORS
from aircut.language.arithmetic import finite as house_finite

LEAST_WHOLE = 2.0**31


def integer(value: float) -> int | None:
    """The whole number that a value counts as, by its distance from the one below; None for none."""
    if not abs(value) < 1e9:
        return None
    below = math.floor(value)
    rest = value - below
    if rest > 1.0 - EQUAL:
        return below + 1
    return None if rest > EQUAL else below


def arc_cosine(value: float) -> float:
    if not abs(value) <= 1.0:
        raise Refusal(F.DOMAIN, function="ACOS", value=value)
    return angles.to_degrees(math.acos(value))


def arc_sine(value: float) -> float:
    if not abs(value) <= 1.0:
        raise Refusal(F.DOMAIN, function="ASIN", value=value)
    return angles.to_degrees(math.asin(value))


def arc_tangent(y: float, x: float) -> float:
    return angles.to_degrees(math.atan2(y, x))


class Unreadable(float):
    """An infinite value or what is no number, given in a call. LinuxCNC refuses it where it is read."""

    def refused(self, *others: object) -> Any:
        raise ValueError

    __lt__ = __le__ = __gt__ = __ge__ = __eq__ = __ne__ = __bool__ = refused
    __add__ = __radd__ = __sub__ = __rsub__ = __mul__ = __rmul__ = __truediv__ = __rtruediv__ = refused
    __neg__ = __pos__ = __abs__ = refused
    __hash__ = float.__hash__


def marked(value: float) -> float:
    """A value of a call, which may be none to calculate with. Raises Refusal."""
    if isinstance(value, Unreadable):
        raise Refusal(F.NO_VALUE)
    return value if math.isfinite(value) else Unreadable(value)


def finite(value: float) -> float:
    """The value; raises Refusal where it is infinite or no number."""
    if value != value:
        raise Refusal(F.NO_VALUE)
    return house_finite(value)


def nearest(value: float) -> float:
    """ROUND, which LinuxCNC does in 32 bits: what is outside of them becomes the lowest of these numbers."""
    rounded = round_half_away(value) if math.isfinite(value) else math.inf
    return rounded if abs(rounded) < LEAST_WHOLE else -LEAST_WHOLE


def modulo(left: float, right: float) -> float:
    """Remainder in [0, |right|); not a number where right is 0, which is refused where it is used."""
    if right == 0.0 or math.isinf(left):
        return math.nan
    rest = math.fmod(left, right)
    return rest + abs(right) if rest < 0.0 else rest


def power(left: float, right: float) -> float:
    """A power; infinite where it is too large."""
    if left < 0.0 and right != math.floor(right):
        raise Refusal(F.DOMAIN, function="a negative number to a fractional power", value=left)
    try:
        return math.pow(left, right)
    except (OverflowError, ValueError):
        return math.inf


def divide(left: float, right: float) -> float:
    if right == 0.0:
        raise Refusal(F.DIVISION_BY_ZERO)
    return left / right


def equal(left: float, right: float) -> float:
    """Nothing equals an infinite value or what is no number."""
    return 1.0 if abs(left - right) < EQUAL else 0.0


def unequal(left: float, right: float) -> float:
    """And those differ from finite numbers alone, the infinite ones."""
    return 1.0 if abs(left - right) >= EQUAL else 0.0


OWN: dict[str, Callable[..., float]] = {"acos": arc_cosine, "asin": arc_sine, "atan": arc_tangent, "round": nearest}
OWN_OPERATORS: dict[str, Callable[..., float]] = {
    "mod": modulo, "**": power, "/": divide, "eq": equal, "ne": unequal
}  # fmt: skip
OPERATORS = tuple(
    row._replace(run=OWN_OPERATORS.get(row.name, row.run)) for row in HOUSE_OPERATORS if row.name not in "&|^"
)
FUNCTIONS = tuple(row._replace(run=OWN.get(row.name, row.run)) for row in HOUSE_FUNCTIONS)
OPERATOR_ROWS = {operator.name: operator for operator in OPERATORS}
FUNCTION_ROWS = {function.name: function for function in FUNCTIONS}
OPERATOR = re.compile("|".join(re.escape(o.name) for o in sorted(OPERATORS, key=lambda o: -len(o.name))))
