"""Predefined named variables: constants and what the machine's configuration says.

Sources: 000 and 004 section 2.2.3; decisions AMB-NAM-10, AMB-NAM-13.
"""

from __future__ import annotations

import math
from collections.abc import Callable

from aircut.interpreter.state import INCH, State
from aircut.interpreter.table import NamedParameter


def constant(name: str, value: float | None, title: str) -> NamedParameter:
    return NamedParameter(name, title, lambda m: value)


def version(place: int) -> Callable[[State], float]:
    return lambda m: float(m.machine.system.version[place])


NAMED = (
    NamedParameter("sys.version.major", "Major version of the controller", version(0)),
    NamedParameter("sys.version.minor", "Minor version of the controller", version(1)),
    NamedParameter("sys.version.release", "Release of the controller", version(2)),
    NamedParameter("sys.version.build", "Build of the controller", version(3)),
    NamedParameter("sys.customer_id", "Customer", lambda m: float(m.machine.system.customer)),
    NamedParameter("sys.interface_level", "Interface level", lambda m: float(m.machine.system.interface_level)),
    NamedParameter("sys.ui.units_mode", "Units of the user interface: 20 or 21",
                   lambda m: float(m.machine.options.units)),
    constant("math.max", 1.7e308, "Largest value"),
    constant("math.min", 5e-324, "Smallest value above zero"),
    constant("math.nan", math.nan, "Not a number"),
    constant("math.infinity", math.inf, "Infinity"),
    constant("math.neg_infinity", -math.inf, "Negative infinity"),
    constant("math.e", 2.7182818284590452354, "Euler's number"),
    constant("math.pi", 3.14159274101257324218, "Pi, as the controller has it"),
    constant("math.ln_2", 0.69314718055994530942, "Natural logarithm of 2"),
    constant("math.ln_10", 2.30258509299404568402, "Natural logarithm of 10"),
    constant("math.ln_pi", 1.14472988584940017414, "Natural logarithm of pi"),
    constant("math.to_mm", INCH, "Millimeters an inch"),
    constant("math.to_in", 1.0 / INCH, "Inches a millimeter"),
    constant("math.to_rad", math.pi / 180.0, "Radians a degree"),
    constant("math.to_deg", 180.0 / math.pi, "Degrees a radian"),
)  # fmt: skip
