"""Operators and functions: one row each, next to what it computes.

Values are floats, or None for null. What may not see null fails with TypeError
on it, which the interpreter turns into the fault `null-value`.
Sources: 000 section 3.1; decisions AMB-EXP-1 to AMB-EXP-9, AMB-VAR-7.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

from aircut.diagnostics import Refusal
from aircut.diagnostics import faults as F
from aircut.kernels.angles import cosine, sine, tangent, to_degrees

Value = float | None
EQUAL = 1e-4  # values nearer than this are equal (000 section 3.1.1)
LARGEST = 1.7976931348623157e308
DOMAIN_SLACK = 1e-9  # beyond ±1 that ASIN and ACOS forgive


def finite(value: float) -> float:
    """The value; raises Refusal(overflow) for infinities and NaN."""
    if -LARGEST <= value <= LARGEST:
        return value
    raise Refusal(F.OVERFLOW, operation="this expression")


def add(left: float, right: float) -> float:
    return left + right


def subtract(left: float, right: float) -> float:
    return left - right


def multiply(left: float, right: float) -> float:
    return left * right


def divide(left: float, right: float) -> float:
    if right == 0.0:
        raise Refusal(F.DIVISION_BY_ZERO)
    return finite(left / right)


def modulo(left: float, right: float) -> float:
    """Remainder in [0, |right|)."""
    if right == 0.0:
        raise Refusal(F.DIVISION_BY_ZERO)
    try:
        rest = math.fmod(left, right)
    except ValueError:
        raise Refusal(F.DOMAIN, function="MOD", value=left) from None
    return rest + abs(right) if rest < 0.0 else rest


def power(left: float, right: float) -> float:
    if left < 0.0 and right != math.floor(right):
        raise Refusal(F.DOMAIN, function="a negative number to a fractional power", value=left)
    if left == 0.0 and right < 0.0:
        raise Refusal(F.DIVISION_BY_ZERO)
    try:
        return finite(float(left**right))
    except OverflowError:
        raise Refusal(F.OVERFLOW, operation="**") from None


def equal(left: Value, right: Value) -> float:
    """1 when both are null, or nearer than EQUAL. Null here is also the constant #<math.nan>."""
    if left is None or right is None:
        return 1.0 if is_null(left) and is_null(right) else 0.0
    if left == right:
        return 1.0
    return 1.0 if abs(left - right) < EQUAL else 0.0


def is_null(value: Value) -> bool:
    """Whether a value is null, or not a number."""
    return value is None or value != value


def unequal(left: Value, right: Value) -> float:
    return 1.0 - equal(left, right)


# Against null the other relations take it as zero (table of 000 section 2.4).


def greater(left: Value, right: Value) -> float:
    return 1.0 if (left or 0.0) > (right or 0.0) else 0.0


def at_least(left: Value, right: Value) -> float:
    return 1.0 if (left or 0.0) >= (right or 0.0) else 0.0


def less(left: Value, right: Value) -> float:
    return 1.0 if (left or 0.0) < (right or 0.0) else 0.0


def at_most(left: Value, right: Value) -> float:
    return 1.0 if (left or 0.0) <= (right or 0.0) else 0.0


def logical_and(left: float, right: float) -> float:
    left, right = +left, +right
    return 1.0 if left and right else 0.0


def logical_or(left: float, right: float) -> float:
    left, right = +left, +right
    return 1.0 if left or right else 0.0


def logical_xor(left: float, right: float) -> float:
    return 1.0 if (+left != 0.0) != (+right != 0.0) else 0.0


def bits(value: float, operator: str) -> int:
    """The value as a 32-bit integer. Raises Refusal."""
    nearest = round(value) if -(2.0**31) - 1 < value < 2.0**32 else 0
    if not abs(value - nearest) <= EQUAL or not -(2**31) <= nearest < 2**32:
        raise Refusal(F.NOT_INTEGER_OPERAND, operator=operator, value=value)
    return nearest


def bit_and(left: float, right: float) -> float:
    return float(bits(left, "&") & bits(right, "&"))


def bit_or(left: float, right: float) -> float:
    return float(bits(left, "|") | bits(right, "|"))


def bit_xor(left: float, right: float) -> float:
    return float(bits(left, "^") ^ bits(right, "^"))


class Operator(NamedTuple):
    """One binary operator."""

    name: str
    level: int  # binds tighter the higher; all are left-associative
    run: Callable[[float, float], float]
    title: str
    inline: bool = False  # Python's own operator of this name does the same
    null: bool = False  # may see null


OPERATORS = (
    Operator("**", 5, power, "power"),
    Operator("*", 4, multiply, "product", inline=True),
    Operator("/", 4, divide, "quotient"),
    Operator("mod", 4, modulo, "remainder, never negative"),
    Operator("+", 3, add, "sum", inline=True),
    Operator("-", 3, subtract, "difference", inline=True),
    Operator("eq", 2, equal, "1 if equal within 0.0001", null=True),
    Operator("ne", 2, unequal, "1 if not equal within 0.0001", null=True),
    Operator("gt", 2, greater, "1 if greater", null=True),
    Operator("ge", 2, at_least, "1 if greater or equal", null=True),
    Operator("lt", 2, less, "1 if less", null=True),
    Operator("le", 2, at_most, "1 if less or equal", null=True),
    Operator("and", 1, logical_and, "1 if both are not zero"),
    Operator("or", 1, logical_or, "1 if one or both are not zero"),
    Operator("xor", 1, logical_xor, "1 if one, but not both, is not zero"),
    Operator("&", 1, bit_and, "bitwise and of 32-bit integers"),
    Operator("|", 1, bit_or, "bitwise or of 32-bit integers"),
    Operator("^", 1, bit_xor, "bitwise exclusive or of 32-bit integers"),
)


def refuse(function: str, value: float) -> Refusal:
    return Refusal(F.DOMAIN, function=function, value=value)


def arc_cosine(value: float) -> float:
    if abs(value) > 1.0 + DOMAIN_SLACK:
        raise refuse("ACOS", value)
    return to_degrees(math.acos(max(-1.0, min(1.0, value))))


def arc_sine(value: float) -> float:
    if abs(value) > 1.0 + DOMAIN_SLACK:
        raise refuse("ASIN", value)
    return to_degrees(math.asin(max(-1.0, min(1.0, value))))


def arc_tangent(y: float, x: float) -> float:
    angle = to_degrees(math.atan2(y, x))
    return 180.0 if angle == -180.0 else angle


def exponential(value: float) -> float:
    try:
        return math.exp(value)
    except OverflowError:
        raise Refusal(F.OVERFLOW, operation="EXP") from None


def round_half_away(value: float) -> float:
    whole = math.trunc(value)
    if abs(value - whole) >= 0.5:
        whole += 1 if value > 0 else -1
    return float(whole)


def logarithm(value: float) -> float:
    if value <= 0.0:
        raise refuse("LN", value)
    return math.log(value)


def square_root(value: float) -> float:
    if value < 0.0:
        raise refuse("SQRT", value)
    return math.sqrt(value)


class Function(NamedTuple):
    """One function. arguments: "one" [x], "two" [y]/[x], "name" [#<name>]."""

    name: str
    run: Callable[..., float]
    title: str
    arguments: str = "one"


FUNCTIONS = (
    Function("abs", lambda value: abs(value), "absolute value"),
    Function("acos", arc_cosine, "arc cosine, degrees"),
    Function("asin", arc_sine, "arc sine, degrees"),
    Function("atan", arc_tangent, "ATAN[y]/[x]: direction of the point x, y, degrees in (-180, 180]", "two"),
    Function("cos", cosine, "cosine of degrees"),
    Function("exp", exponential, "e to a power"),
    Function("fix", lambda value: float(math.floor(value)), "whole number below"),
    Function("fup", lambda value: float(math.ceil(value)), "whole number above"),
    Function("round", round_half_away, "nearest whole number, halves away from zero"),
    Function("ln", logarithm, "natural logarithm"),
    Function("sin", sine, "sine of degrees"),
    Function("sqrt", square_root, "square root"),
    Function("tan", tangent, "tangent of degrees"),
    Function("exists", lambda known: 1.0 if known else 0.0, "1 if the named variable exists", "name"),
)
