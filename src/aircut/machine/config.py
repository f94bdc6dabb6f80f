"""A machine as configured: machine.toml, or the built-in one where no folder is given.

Lengths mm, speeds mm/min (deg/min), accelerations mm/s² (deg/s²), jerk mm/s³ (deg/s³).
Every setting is told in docs/reference/machine.md.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal, TypeVar, get_args, get_type_hints

import msgspec
from msgspec import Meta

from aircut.machine.tools import EMPTY, Tool

if TYPE_CHECKING:
    from aircut.machine.inifile import Ini

AXES = "xyzabc"  # programmable
LINEAR = "xyz"
ROTARY = "abc"
AUXILIARY = "uvw"  # configured, read by programs, never moved by them (AMB-VAR-17)
UNBOUNDED = 1e9  # mm or degrees, the limit of an axis that has none

AxisType = Literal["disabled", "linear", "rotary_free", "rotary_head", "rotary_table", "gantry_1", "gantry_2"]
#: Source: 004 section 2.2.3; model 4 is the "Tilting Spindle AC" of 000 (AMB-NAM-11).
Kinematics = Literal[
    "trivial", "independent_rot_axes", "rotary_table_ac", "rotary_table_bc", "tilting_spindle_ca", "tilting_spindle_ab"
]
#: Names by the number that a program reads.
AXIS_TYPES: tuple[str, ...] = get_args(AxisType)
KINEMATICS: tuple[str, ...] = get_args(Kinematics)
#: The rotary axes that a model turns about.
MODEL_AXES = {
    "rotary_table_ac": "ac",
    "rotary_table_bc": "bc",
    "tilting_spindle_ca": "ca",
    "tilting_spindle_ab": "ab",
}

LARGEST = sys.float_info.max
Finite = Annotated[float, Meta(ge=-LARGEST, le=LARGEST)]
Positive = Annotated[float, Meta(gt=0.0, le=LARGEST)]
NotNegative = Annotated[float, Meta(ge=0.0, le=LARGEST)]
Count = Annotated[int, Meta(ge=0)]

REACH = 10_000.0  # mm that a linear axis may go to either side, if nothing else is said


class MachineError(Exception):
    """A machine's folder or one of its files cannot be used; the text says which and why."""


class Axis(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """One axis. What stands below `jerk` matters for rotary axes only.

    Raises ValueError where min is not below max.
    """

    type: AxisType = "linear"
    min: Finite = -REACH
    max: Finite = REACH
    velocity: Positive = 10_000.0
    acceleration: Positive = 500.0
    jerk: NotNegative = 0.0  # 0: not limited
    motion_mode: Literal["continuous", "indexing"] = "continuous"
    convention: Literal["normal", "inverse"] = "normal"  # inverse: turns left-handed
    wrapped_rotary: bool = False  # a display setting, without effect on targets (AMB-ROT-7)
    parallel_to: Literal["X", "Y", "Z"] = "X"  # the linear axis that it turns about
    origin_mode: Literal["custom", 1, 2, 3, 4, 5, 6, 7, 8, 9] = "custom"  # or a work system, 1 for G54
    origin_x: Finite = 0.0  # a point of its line, machine coordinates
    origin_y: Finite = 0.0
    origin_z: Finite = 0.0

    def __post_init__(self) -> None:
        if not self.min < self.max:
            raise ValueError(f"min must be less than max, not {self.min:g} and {self.max:g}")

    @property
    def rotary(self) -> bool:
        """Whether it turns: its positions are degrees."""
        return self.type.startswith("rotary")


class Options(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Settings of the controller. Counts are how many there are, numbered from 1."""

    missing_feed: Literal["default", "error"] = "default"  # a feed move with no F (AMB-FEED-1)
    default_feed: Positive = 1000.0
    units: Literal[20, 21] = 21  # of the user interface
    rotary_feed_handling: bool = False  # F is the speed over the turning part (AMB-FEED-5)
    tool_change: Literal["internal", "macro"] = "internal"  # M6
    pallet_shuttle: bool = False  # M60 and M30 run pallet_shuttle.ngc (AMB-IO-9)
    m66_read_back: bool = True  # M66 puts the input's value into #5720 (AMB-IO-2)
    inputs: Count = 32
    outputs: Count = 32
    analog_inputs: Count = 8
    analog_outputs: Count = 8
    peck_retract: Positive = 0.254  # mm, whatever the units in force (AMB-CYC-7)
    rtcp: bool = True  # G43.4 and G43.7, where the kinematics are those of a five-axis machine (AMB-RTCP-2)
    entry: Literal["nist", "easy", "normal"] = "nist"  # lead-in of cutter compensation (AMB-CMP-5)


class Spindle(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The spindle. max_speed: revolutions a minute. acceleration: rpm a second; 0: at once."""

    max_speed: Positive = 60_000.0
    acceleration: NotNegative = 6000.0


class Motion(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """How the controller moves. profile: auto is jerk-limited where an axis has a jerk.

    cycle: seconds, the controller's period. A jump of velocity at a joint of the path is spread over one;
    with 0 nothing may jump.
    """

    profile: Literal["auto", "trapezoidal", "jerk-limited"] = "auto"
    cycle: NotNegative = 0.001


class Durations(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Seconds of what is not motion of the axes."""

    tool_change: NotNegative = 6.0
    pallet: NotNegative = 0.0
    operator: NotNegative = 0.0  # M0, M1 where it stops, M60, messages with buttons
    input: NotNegative = 0.0  # M66, M67
    orient: NotNegative = 1.0  # M19, the spindle at rest


class RotaryTable(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Where a rotary table's axes meet: D of AMB-RTCP-1, mm."""

    d_x: Finite = 0.0
    d_y: Finite = 0.0
    d_z: Finite = 0.0


class TiltingSpindle(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The arms of a tilting spindle: H and J of AMB-RTCP-1, mm."""

    h_x: Finite = 0.0
    h_y: Finite = 0.0
    h_z: Finite = 0.0
    j_x: Finite = 0.0
    j_y: Finite = 0.0
    j_z: Finite = 0.0


class System(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """What the controller says of itself (AMB-NAM-13)."""

    version: tuple[Count, Count, Count, Count] = (0, 3, 7, 167)
    customer: Count = 0
    interface_level: Count = 9


class File(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The shape of machine.toml. axes: by small letter.

    Raises ValueError where an axis or the kinematics model does not fit the machine.
    """

    name: str = "machine"
    type: Literal["mill"] = "mill"
    kinematics: Kinematics = "trivial"
    axes: dict[str, Axis] = {}
    options: Options = Options()
    spindle: Spindle = Spindle()
    motion: Motion = Motion()
    durations: Durations = Durations()
    rotary_table: RotaryTable = RotaryTable()
    tilting_spindle: TiltingSpindle = TiltingSpindle()
    system: System = System()

    def __post_init__(self) -> None:
        for letter in LINEAR:
            if letter in self.axes and self.axes[letter].rotary:
                raise ValueError(
                    f"axes.{letter.upper()}.type cannot be {self.axes[letter].type}: X, Y and Z are linear"
                )
        wanted = MODEL_AXES.get(self.kinematics, "")
        if not all(letter in self.axes and self.axes[letter].rotary for letter in wanted):
            raise ValueError(f"kinematics: {self.kinematics} needs rotary axes {' and '.join(wanted.upper())}")


class Machine:
    """A machine: configuration, tools, and the variables that it remembers.

    axes: the programmable ones by small letter; auxiliary: U, V, W.
    tools: by id. own_tools: a library was given, so a tool that is not in it is an
    error (AMB-TC-5). macros: folders searched for macro files, in order.
    variables: numbered variables before the run (mm, degrees); a run that ends
    hands back what is to be remembered by `remember`. names: named variables that a
    language keeps from run to run, in memory alone.
    """

    def __init__(
        self,
        file: File,
        tools: dict[int, Tool],
        own_tools: bool,
        macros: Iterable[Path] = (),
        folder: Path | None = None,
    ) -> None:
        self.name = file.name
        self.type = file.type
        self.kinematics = file.kinematics
        self.axes = {letter: axis for letter, axis in file.axes.items() if letter in AXES}
        self.auxiliary = {letter: axis for letter, axis in file.axes.items() if letter in AUXILIARY}
        self.options = file.options
        self.spindle = file.spindle
        self.motion = file.motion
        self.durations = file.durations
        self.rotary_table = file.rotary_table
        self.tilting_spindle = file.tilting_spindle
        self.system = file.system
        self.tools = tools
        self.own_tools = own_tools
        self.macros = tuple(macros)
        self.folder = folder
        self.library = tools  # the tools as given, before what programs have changed
        self.key: str | None = None  # opens encrypted macros
        self.variables: dict[int, float] = {}
        self.parameters: dict[int, float] | None = None  # of a parameter file, inches: in LinuxCNC's language alone
        self.slots: list[Tool] | None = None  # the tool table's lines, from slot 0: in LinuxCNC's language alone
        self.ini: Ini | None = None  # LinuxCNC's configuration
        self.names: dict[str, float] = {}

    @property
    def letters(self) -> str:
        """Letters of the programmable axes that the machine has."""
        return "".join(a for a in AXES if a in self.axes and self.axes[a].type != "disabled")

    def tool(self, id: int) -> Tool | None:
        """The tool of this id; tool 0 is no tool; None when it is not in the library."""
        return EMPTY if id == 0 else self.tools.get(id)


def built_in(axes: str = "XYZ", known: str = AXES, reach: float = REACH) -> Machine:
    """The machine that serves when none is given: tools 1 to 5 without length or diameter.

    axes: letters of the axes it has; A, B and C are rotary tables. known: those it may have. reach: how far the linear
    ones may go to either side, mm. Raises MachineError.
    """
    letters = axes.lower()
    if not letters or set(letters) - set(known) or len(set(letters)) < len(letters):
        raise MachineError(f"axes {axes!r}: give some of {known.upper()}, each once")
    file = File("built-in", axes={a: axis_of(a, {} if a in ROTARY else {"min": -reach, "max": reach}) for a in letters})
    return Machine(file, {i: Tool(i, slot=i) for i in range(1, 6)}, own_tools=False)


def load(folder: Path) -> Machine:
    """The machine in a folder (machine.toml, tools.toml, macros/, state.db). Raises MachineError."""
    import tomllib

    path = folder / "machine.toml"
    try:
        file = parse(tomllib.loads(path.read_text("utf-8")))
    except OSError as error:
        raise MachineError(f"{path}: {error.strerror}") from None
    except ValueError as error:
        raise MachineError(f"{path}: {error}") from None
    own = folder / "tools.toml"
    tools = load_tools(own) if own.exists() else {}
    machine = Machine(file, tools, own.exists(), [folder / "macros"], folder)
    from aircut.machine import store

    machine.library = dict(machine.tools)
    stored = store.recall(folder)
    machine.variables = stored.variables
    machine.tools |= stored.tools
    return machine


def load_tools(path: Path) -> dict[int, Tool]:
    """The tools of a tools.toml, or of another library (see imports), by id. Raises MachineError."""
    from aircut.machine.imports import read_tools

    return read_tools(path)


# --- reading machine.toml


def parse(tables: dict[str, Any]) -> File:
    """The machine that the tables of a machine.toml describe. Raises ValueError naming the field."""
    given = tables.get("axes", {})
    if not isinstance(given, dict):
        raise ValueError("axes: write a table for each axis: [axes.X]")
    axes: dict[str, Axis] = {}
    for name, settings in given.items():
        letter = name.lower()
        if len(letter) != 1 or letter not in AXES + AUXILIARY:
            raise ValueError(f"axes.{name}: axes are {', '.join((AXES + AUXILIARY).upper())}")
        if letter in axes:
            raise ValueError(f"axes.{name}: the axis stands twice")
        axes[letter] = axis_of(letter, settings, f"axes.{name}")
    if not set(axes) & set(AXES):
        axes |= {letter: Axis() for letter in LINEAR}
    file = converted({**tables, "axes": axes}, File)
    if file.options.rotary_feed_handling:
        check_origins(given, axes)
    return file


def check_origins(given: Mapping[str, Any], axes: Mapping[str, Axis]) -> None:
    """Refuse Rotary Feed Handling where it is not said what a rotary axis turns about. Raises ValueError."""
    for name, settings in given.items():
        if axes[name.lower()].rotary and not any(field.startswith("origin_") for field in settings):
            raise ValueError(f"options.rotary_feed_handling needs axes.{name}.origin_mode or origin_x to origin_z")


def axis_of(letter: str, settings: Any, name: str = "") -> Axis:
    """An axis from its table; what is left out follows from the letter.

    A, B and C are rotary tables without limits, turning about X, Y and Z.
    name: of the table, for messages. Raises ValueError naming the field.
    """
    if not isinstance(settings, Mapping):
        raise ValueError(f"{name}: write a table: [{name}]")
    made: dict[str, Any] = {"type": "linear", **settings}
    if letter in ROTARY:
        made = {"type": "rotary_table", "parallel_to": "XYZ"[ROTARY.index(letter)], **settings}
    if str(made["type"]).startswith("rotary"):
        made = {"min": -UNBOUNDED, "max": UNBOUNDED, **made}
    axis = converted(made, Axis, name)
    if axis.jerk and "acceleration" not in settings:
        raise ValueError(f"{name}.jerk needs an acceleration beside it".lstrip("."))
    return axis


Shape = TypeVar("Shape", bound=msgspec.Struct)


def converted(tables: Mapping[str, Any], shape: type[Shape], name: str = "") -> Shape:
    """Tables as a structure. Raises ValueError that begins with the field's whole name."""
    try:
        return msgspec.convert(tables, shape)
    except msgspec.ValidationError as error:
        reason, _, place = str(error).partition(" - at `$")
        path = place.rstrip("`").lstrip(".")
        where = ".".join(filter(None, (name, path)))
        if reason.startswith("Invalid enum value") and (choices := choices_of(shape, path)):
            reason = f"{reason.removeprefix('Invalid enum value ')} is not one of {', '.join(map(str, choices))}"
        elif re.search(r"e\+308$", reason):
            reason = "Expected a finite number"
        raise ValueError(f"{where}: {reason}" if where else reason) from None


def choices_of(shape: Any, path: str) -> tuple[Any, ...]:
    """The values that the field at a path may have."""
    for field in path.split("."):
        shape = get_type_hints(shape).get(field)
    return get_args(shape)
