"""Predefined named variables: what the machine's configuration says, and the constants of the language.

Values of `cnc` are mm, mm/min and mm/s², degrees in place of mm for rotary axes,
whatever units are in force.

Sources: 000 and 004 section 2.2.3; decisions AMB-NAM-4 to AMB-NAM-13, AMB-VAR-4, AMB-VAR-17, AMB-OCR-10.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator
from operator import attrgetter

from aircut.interpreter.state import INCH, State
from aircut.interpreter.table import NamedParameter
from aircut.machine import Axis
from aircut.machine.config import AUXILIARY, AXIS_TYPES, KINEMATICS, LINEAR, ROTARY

MACHINE_TYPES = ("mill",)


def constant(name: str, value: float | None, title: str) -> NamedParameter:
    number = None if value is None else float(value)
    return NamedParameter(name, title, lambda m: number)


def enumeration(prefix: str, title: str, members: Iterable[tuple[str, float | None]]) -> Iterator[NamedParameter]:
    """Constants of one kind: names and their values."""
    for name, value in members:
        told = "null" if value is None else f"{value:g}"
        yield constant(prefix + name, value, f"{title.format(name.replace('_', ' '))} ({told})")


def setting(name: str, path: str, title: str) -> NamedParameter:
    """A number of the machine, by its path from there."""
    read: Callable[[object], float] = attrgetter(path)
    return NamedParameter(name, title, lambda m: float(read(m.machine)))


def version(place: int) -> Callable[[State], float]:
    return lambda m: float(m.machine.system.version[place])


SYS = (
    NamedParameter("sys.version.major", "Major version of the controller", version(0)),
    NamedParameter("sys.version.minor", "Minor version of the controller", version(1)),
    NamedParameter("sys.version.release", "Release of the controller", version(2)),
    NamedParameter("sys.version.build", "Build of the controller", version(3)),
    setting("sys.customer_id", "system.customer", "Customer"),
    setting("sys.interface_level", "system.interface_level", "Interface level"),
    setting("sys.ui.units_mode", "options.units", "Units of the user interface: 20 or 21"),
)

MATH = (
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
)

#: What is told of each axis: name, title with a place for the unit, value. A disabled axis tells zeros.
AXIS: tuple[tuple[str, str, Callable[[Axis], float]], ...] = (
    ("type", "type, see `axis.type`", lambda axis: AXIS_TYPES.index(axis.type)),
    ("max_vel", "highest velocity, {}/min", lambda axis: axis.velocity),
    ("acc", "acceleration, {}/s²", lambda axis: axis.acceleration),
    ("min_lim", "lower limit, {}", lambda axis: axis.min),
    ("max_lim", "upper limit, {}", lambda axis: axis.max),
)
ROTARY_AXIS: tuple[tuple[str, str, Callable[[Axis], float]], ...] = (
    ("motion_mode", "0 continuous, 1 indexing", lambda axis: axis.motion_mode == "indexing"),
    ("convention", "0 normal, 1 inverse", lambda axis: axis.convention == "inverse"),
    ("wrapped_rotary", "1 when wrapped", lambda axis: axis.wrapped_rotary),
    ("parallel_to", "parallel to 0 X, 1 Y, 2 Z", lambda axis: "XYZ".index(axis.parallel_to)),
    ("origin_mode", "origin: 0 custom, 1 to 9 a work system",
     lambda axis: 0 if axis.origin_mode == "custom" else axis.origin_mode),
    ("origin_x", "origin X, mm", lambda axis: axis.origin_x),
    ("origin_y", "origin Y, mm", lambda axis: axis.origin_y),
    ("origin_z", "origin Z, mm", lambda axis: axis.origin_z),
)  # fmt: skip
UNIT = dict.fromkeys(LINEAR, "mm") | dict.fromkeys(ROTARY + AUXILIARY, "mm or degrees")


def of_axis(letter: str, value: Callable[[Axis], float]) -> Callable[[State], float]:
    """Reads one value of an axis. Source: AMB-VAR-17."""

    def read(m: State) -> float:
        axis = m.machine.axes.get(letter) or m.machine.auxiliary.get(letter)
        return 0.0 if axis is None or axis.type == "disabled" else float(value(axis))

    return read


def offsets(section: str, title: str, arms: str) -> Iterator[NamedParameter]:
    """The offsets of a kind of kinematics, mm."""
    for arm in arms:
        for axis in "xyz":
            field = f"{section}.{arm}_{axis}"
            yield setting(f"cnc.{field}", field, f"{title}, {arm.upper()}.{axis} in mm")


CNC = (
    NamedParameter("cnc.compile.mode", "What is being compiled, see `compile.mode_…`",
                   lambda m: float(m.compile_mode)),
    NamedParameter("cnc.compile.line", "Line that the program is started or resumed from",
                   lambda m: float(m.compile_line)),
    NamedParameter("cnc.machine_type", "Machine type: 0 mill", lambda m: float(MACHINE_TYPES.index(m.machine.type))),
    NamedParameter("cnc.kinematics_model", "Kinematics model, see `kinematics.model`",
                   lambda m: float(KINEMATICS.index(m.machine.kinematics))),
    *(NamedParameter(f"cnc.{letter}.{name}", f"{letter.upper()} {title.format(UNIT[letter])}", of_axis(letter, value))
      for letter in UNIT
      for name, title, value in (AXIS + ROTARY_AXIS if letter in ROTARY else AXIS)),
    setting("cnc.spindle.max_speed", "spindle.max_speed", "Highest spindle speed, revolutions a minute"),
    *offsets("rotary_table", "Rotary table", "d"),
    *offsets("tilting_spindle", "Tilting spindle", "hj"),
)  # fmt: skip

#: Numbers are not in the documents: AMB-NAM-8. The last is also known as they misprint it (AMB-OCR-10).
MODES = (
    ("mdi", "an MDI command"),
    ("macro", "a macro of the user interface"),
    ("program", "the program"),
    ("program_from_line", "the program, from a line"),
    ("program_for_resume", "the program, to resume it after a stop"),
    ("program_for_resume_from_line", "the program, to resume it from a line after a stop"),
    ("program_for_analysis", "the program, for analysis"),
)
COMPILE = (
    *(constant(f"compile.mode_{name}", i, f"Compiling {title} ({i})") for i, (name, title) in enumerate(MODES)),
    constant("compile.mode_program_for_analysis'", 6.0, "The same, as the documents print it (6)"),
)

NAMED = (
    *SYS,
    *MATH,
    *CNC,
    *COMPILE,
    *enumeration("kinematics.model.", "Kinematics: {}", ((name, i) for i, name in enumerate(KINEMATICS))),
    *enumeration("kinematics.model.", "Kinematics: {}, another name of the head CA", [("tilting_spindle_ac", 4.0)]),
    *enumeration("axis.type.", "Axis type: {}", ((name, i) for i, name in enumerate(AXIS_TYPES))),
    *enumeration("tool.type.", "Tool type: {}", (
        ("generic", 0.0), ("flat_end_mill", 1.0), ("ball_nose_end_mill", 2.0), ("drill", 3.0), ("probe", 4.0),
        ("saw", 5.0), ("plasma", 6.0), ("drag_knife", 7.0), ("lathe", 8.0))),
    *enumeration("probe.state.", "Probe state in #5700: {}", (
        ("succeed", 1.0), ("not_tripped", -1.0), ("already_tripped", -2.0), ("not_yet_executed", None))),
    *enumeration("wait_input.", "M66 L: {}", (
        ("low", 0.0), ("high", 1.0), ("fall", 2.0), ("rise", 3.0), ("immediate", 4.0),
        ("alarm_low", 10.0), ("alarm_high", 11.0), ("alarm_fall", 12.0), ("alarm_rise", 13.0))),
    *enumeration("wait_input.", "Result of M66 in #5722: {}", (
        ("success", 0.0), ("succes", 0.0), ("succees", 0.0), ("failure", 1.0))),
    *enumeration("pick_place.mode_", "The tool changer's panel: {}", (
        ("pick", 1.0), ("place", 2.0), ("place_pick", 3.0))),
)  # fmt: skip
