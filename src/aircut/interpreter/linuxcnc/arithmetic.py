"""Operators and functions of LinuxCNC's language: those of the house, but for what it does otherwise."""

from __future__ import annotations

import math
import re
from collections.abc import Callable

from aircut.diagnostics import Refusal
from aircut.diagnostics import faults as F
from aircut.language.arithmetic import FUNCTIONS as HOUSE_FUNCTIONS
from aircut.language.arithmetic import OPERATORS as HOUSE_OPERATORS


def arc_cosine(value: float) -> float:
    if not abs(value) <= 1.0:
        raise Refusal(F.DOMAIN, function="ACOS", value=value)
    return math.degrees(math.acos(value))


def arc_sine(value: float) -> float:
    if not abs(value) <= 1.0:
        raise Refusal(F.DOMAIN, function="ASIN", value=value)
    return math.degrees(math.asin(value))


def arc_tangent(y: float, x: float) -> float:
    return math.degrees(math.atan2(y, x))


OWN: dict[str, Callable[..., float]] = {"acos": arc_cosine, "asin": arc_sine, "atan": arc_tangent}
OPERATORS = tuple(operator for operator in HOUSE_OPERATORS if operator.name not in "&|^")
FUNCTIONS = tuple(row._replace(run=OWN.get(row.name, row.run)) for row in HOUSE_FUNCTIONS)
OPERATOR_ROWS = {operator.name: operator for operator in OPERATORS}
FUNCTION_ROWS = {function.name: function for function in FUNCTIONS}
OPERATOR = re.compile("|".join(re.escape(o.name) for o in sorted(OPERATORS, key=lambda o: -len(o.name))))
