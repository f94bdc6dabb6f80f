"""The rows that make a language: codes, word items, variables, and a dialect of them all."""

from __future__ import annotations

from collections.abc import Callable, Generator, Mapping
from enum import IntEnum, IntFlag, auto
from typing import TYPE_CHECKING, Any, NamedTuple

if TYPE_CHECKING:
    from aircut.interpreter.requests import Request
    from aircut.interpreter.running import Run
    from aircut.interpreter.state import State
    from aircut.machine.tools import Tool

Words = Mapping[str, Any]  # letter -> value, of one block
#: What carries a code out on its dialect's State: a function, or a generator of requests where it asks the world.
Handler = Callable[[Any, Words], "Generator[Request, Any, None] | None"]

AXES = "xyzabc"
POLAR_WORDS = "@^"  # radius and angle: axis words too, of motion alone


class Group(IntFlag):
    """Modal groups: of each, a block has one code at most. A code may stand in more than one."""

    MOTION = auto()
    EXACT_STOP = auto()
    PLANE = auto()
    DISTANCE = auto()
    ARC_DISTANCE = auto()
    FEED_MODE = auto()
    UNITS = auto()
    CUTTER = auto()
    TOOL_LENGTH = auto()
    RETRACT = auto()
    SCALING = auto()
    SYSTEM = auto()
    PATH = auto()
    MACRO = auto()
    ROTATION = auto()
    POLAR = auto()
    NON_MODAL = auto()
    STOP = auto()
    SPINDLE = auto()
    TOOL = auto()
    MIST = auto()
    FLOOD = auto()
    TORCH = auto()
    FEED_OVERRIDE = auto()
    SPEED_OVERRIDE = auto()
    IO = auto()
    MESSAGE = auto()
    TOOL_MACRO = auto()
    CALL = auto()
    RETURN = auto()
    SPINDLE_MODE = auto()
    DIAMETER = auto()
    USER = auto()
    SHIFT = auto()

    @property
    def title(self) -> str:
        """In words."""
        return (self.name or "").lower().replace("_", " ").replace("|", " and ")


class Order(IntEnum):
    """Places in the order of execution of a block. Source: 000 section 1.7, decision AMB-EXE-1."""

    SPINDLE_MODE = auto()
    FEED_MODE = auto()
    FEED = auto()
    SPEED = auto()
    TOOL = auto()
    IO = auto()
    TOOL_CHANGE = auto()
    SPINDLE = auto()
    COOLANT = auto()
    OVERRIDE = auto()
    USER = auto()
    MACRO_START = auto()
    MESSAGE = auto()
    MACRO_END = auto()
    DWELL = auto()
    PLANE = auto()
    UNITS = auto()
    DIAMETER = auto()
    CUTTER = auto()
    TOOL_LENGTH = auto()
    SYSTEM = auto()
    PATH = auto()
    DISTANCE = auto()
    POLAR = auto()
    ARC_DISTANCE = auto()
    RETRACT = auto()
    NON_MODAL = auto()
    SHIFT = auto()
    SCALING = auto()
    ROTATION = auto()
    MOTION = auto()
    STOP = auto()
    CALL = auto()
    RETURN = auto()


class Code(NamedTuple):
    """One G or M code, or word item (F, S, T): all that the house knows of it."""

    name: str  # as programmed: "G59.1"
    title: str
    run: Handler
    group: Group
    order: Order
    takes: str = ""  # letters of the words it may have
    needs: str = ""  # letters that it must have; of those with a slash between, one
    axes: bool = False  # it takes the axis words
    needs_axes: bool = False  # and wants one at least
    modal: bool = False  # it stays in force: State.modal holds the row
    nameless: bool = False  # after it no motion mode is in force
    weak: bool = False  # gives way to another code of its group in the block
    wakes: str = ""  # letters that make it run while modal, beside the axis words
    fits: tuple[str, ...] = ()  # motions that it may stand beside, if not all
    bars: tuple[str, ...] = ()  # motions that may not be written beside it
    alone: str = ""  # the code that the axis words beside it mean
    cycle: bool = False  # a canned cycle: what State.cycle holds stays in force
    sole: bool = False  # the only G or M code of its block; every letter is its argument
    check: Handler | None = None  # finds faults of form in the values of the words
    counts: str = ""  # letters of words that must be whole numbers
    least: int = -1000  # and at least this
    text: bool = False  # its P may be a string

    @property
    def number(self) -> float:
        """The code number as the system variables report it: 59.1 for G59.1."""
        return float(self.name[1:])


class SystemVariable(NamedTuple):
    """A range of numbered system variables, with what they read as; length-valued ones read in the active unit."""

    first: int
    last: int
    title: str
    read: Callable[[State, int], float | None]  # the state and the place within the range, from 0
    unit: str = ""  # "length": mm, turned into the active unit
    write: Callable[[State, int, float | None], None] | None = None


class Range(NamedTuple):
    """A range of numbered variables that hold what is put into them."""

    first: int
    last: int
    title: str
    initial: str  # "null" or "table": from the machine
    kept: bool = False  # written back to the machine after the run
    writable: bool = True


class NamedParameter(NamedTuple):
    """A predefined, read-only named variable."""

    name: str
    title: str
    read: Callable[[Any], float | None]


class CutterRules(NamedTuple):
    """What languages see differently in cutter radius compensation."""

    forbids: frozenset[str] = frozenset()  # codes that cannot run while it is on
    flushes: frozenset[str] = frozenset()  # codes before which no move is held back any longer
    at_once: frozenset[str] = frozenset()  # events that do not wait behind a move held back
    straight: float = 0.001  # radians: a smaller change of direction is no corner
    growth: tuple[float, float] = (0.0254, 0.0254)  # radians that an arc may grow by, in mm and inches
    plunge_first: bool = True  # moves across the plane may come before the entry
    zero_is_loaded: bool = False  # D0 means the loaded tool, not the radius 0


class Dialect(NamedTuple):
    """A language: its tables and the switches of its grammar."""

    name: str
    title: str
    interpreter: type[Run]  # (source, dialect, machine, settings): reads and runs its programs
    codes: Mapping[str, Code]  # by normalized text: "g59.1", "m3", "call"
    items: Mapping[str, Code]  # by letter
    unsupported: frozenset[str]  # codes that belong to relatives of the language only
    ranges: tuple[Range, ...]
    system: tuple[SystemVariable, ...]
    named: Mapping[str, NamedParameter]
    start: tuple[str, ...]  # codes in force when a run starts
    local_underscore: bool  # a leading _ makes a named variable local (else: global)
    settings: Mapping[int, Code]  # G10's L numbers
    no_variable: str  # hint for numbers outside all ranges
    cutter: CutterRules = CutterRules()
    letters: str = "xyzabc"  # of the axes that a machine may have
    axes: str = "XYZ"  # of the machine that serves when none is given
    reach: float = 10_000.0  # of its linear axes to either side, mm
    takes_ini: bool = False  # LinuxCNC's configuration moves its interpreter
    table_unit: float = 1.0  # mm in a unit of LinuxCNC's tool table, which does not name its own
    parameters: range | None = None  # that a parameter file may hold, if not the machine's own
    tools: tuple[Tool, ...] = ()  # that this machine has, if not the built-in ones
