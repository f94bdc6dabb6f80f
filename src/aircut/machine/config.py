"""A machine as configured: machine.toml, or the built-in one where no folder is given.

Lengths mm, speeds mm/min (deg/min), accelerations mm/s² (deg/s²).
"""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Literal

import msgspec

from aircut.machine import tools as tool_library
from aircut.machine.tools import EMPTY, Tool

AXES = "xyzabc"
LINEAR = "xyz"

AxisType = Literal["disabled", "linear", "rotary_free", "rotary_head", "rotary_table", "gantry_1", "gantry_2"]


class MachineError(Exception):
    """A machine's folder or one of its files cannot be used; the text says which and why."""


class Axis(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """One axis."""

    type: AxisType = "linear"
    min: float = -10_000.0
    max: float = 10_000.0
    velocity: float = 10_000.0
    acceleration: float = 500.0


class Options(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Settings of the controller."""

    missing_feed: Literal["default", "error"] = "default"  # a feed move with no F (AMB-FEED-1)
    default_feed: float = 1000.0
    units: Literal[20, 21] = 21  # of the user interface


class Spindle(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The spindle. max_speed: revolutions a minute."""

    max_speed: float = 60_000.0


class System(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """What the controller says of itself (AMB-NAM-13)."""

    version: tuple[int, int, int, int] = (0, 3, 7, 167)
    customer: int = 0
    interface_level: int = 9


class File(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The shape of machine.toml."""

    name: str = "machine"
    axes: dict[str, Axis] = {}
    options: Options = Options()
    spindle: Spindle = Spindle()
    system: System = System()


class Machine:
    """A machine: configuration, tools, and the variables that it remembers.

    tools: by id. own_tools: a library was given, so a tool that is not in it is an
    error (AMB-TC-5). macros: folders searched for macro files, in order.
    variables: numbered variables before the run (mm, degrees); a run that ends
    hands back what is to be remembered by `remember`.
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
        self.axes = file.axes
        self.options = file.options
        self.spindle = file.spindle
        self.system = file.system
        self.tools = tools
        self.own_tools = own_tools
        self.macros = tuple(macros)
        self.folder = folder
        self.variables: dict[int, float] = {}

    @property
    def letters(self) -> str:
        """Letters of the axes that the machine has."""
        return "".join(a for a in AXES if a in self.axes and self.axes[a].type != "disabled")

    def tool(self, id: int) -> Tool | None:
        """The tool of this id; tool 0 is no tool; None when it is not in the library."""
        return EMPTY if id == 0 else self.tools.get(id)


def built_in(axes: str = "XYZ") -> Machine:
    """The machine that serves when none is given: ±10,000 mm, tools 1 to 5 without length or diameter.

    axes: letters of the axes it has; A, B and C are rotary tables. Raises MachineError.
    """
    letters = axes.lower()
    if not letters or set(letters) - set(AXES) or len(set(letters)) < len(letters):
        raise MachineError(f"axes {axes!r}: give some of {AXES.upper()}, each once")
    rotary = Axis(type="rotary_table", min=-1e9, max=1e9)
    file = File("built-in", {a: Axis() if a in LINEAR else rotary for a in letters})
    return Machine(file, {i: Tool(i, slot=i) for i in range(1, 6)}, own_tools=False)


def load(folder: Path) -> Machine:
    """The machine in a folder (machine.toml, tools.toml, macros/, state.db). Raises MachineError."""
    import tomllib

    path = folder / "machine.toml"
    try:
        file = msgspec.convert(tomllib.loads(path.read_text("utf-8")), File)
    except OSError as error:
        raise MachineError(f"{path}: {error.strerror}") from None
    except (ValueError, msgspec.ValidationError) as error:
        raise MachineError(f"{path}: {error}") from None
    axes = {letter.lower(): axis for letter, axis in file.axes.items()}
    if unknown := set(axes) - set(AXES):
        raise MachineError(f"{path}: axes are {AXES.upper()}, not {', '.join(sorted(unknown)).upper()}")
    file = msgspec.structs.replace(file, axes=axes or {a: Axis() for a in LINEAR})
    own = folder / "tools.toml"
    tools = load_tools(own) if own.exists() else {}
    machine = Machine(file, tools, own.exists(), [folder / "macros"], folder)
    from aircut.machine import memory

    machine.variables = memory.recall(folder)
    return machine


def load_tools(path: Path) -> dict[int, Tool]:
    """The tools of a tools.toml by id. Raises MachineError."""
    try:
        return tool_library.parse(path.read_text("utf-8"))
    except OSError as error:
        raise MachineError(f"{path}: {error.strerror}") from None
    except (ValueError, msgspec.ValidationError) as error:
        raise MachineError(f"{path}: {error}") from None
