"""The state of a run of LinuxCNC's language: what the house's state has, and what is its own.

Lengths mm, angles degrees. Numbered parameters hold what programs see: the machine's
units are inches, so offsets among them are inches (canonical listing, section 2).
Axes are X Y Z A B C U V W; a rotation about Z stands between the work system's origin
and the axis offset of G92: machine = origin + rotated(position + shift).
"""

from __future__ import annotations

from math import cos, radians, sin
from typing import Any

from aircut.diagnostics import Refusal
from aircut.diagnostics import faults as F
from aircut.interpreter import state as house
from aircut.interpreter.linuxcnc.arithmetic import integer
from aircut.interpreter.linuxcnc.logs import Logs
from aircut.interpreter.linuxcnc.spindles import Spindle
from aircut.interpreter.state import INCH
from aircut.interpreter.table import Code
from aircut.machine.inifile import NO_INI
from aircut.machine.tools import EMPTY, Tool
from aircut.machine.tooltable import UNUSED

NINE = "xyzabcuvw"
NUMBERED_NINE = tuple(enumerate(NINE))
LINEAR = frozenset((0, 1, 2, 6, 7, 8))
LAST = 5601  # highest numbered parameter
LOCALS = 30  # of them the first ones belong to a call
POSITION = 5420  # parameters of the present position
READ_ONLY = (*range(5400, 5414), *range(POSITION, POSITION + 9))
G28, G30, G92, SYSTEM, ORIGINS, STEP = 5161, 5181, 5210, 5220, 5221, 20
PROBED, TRIPPED = 5061, 5070
TOOL_DATA = 5400
#: Stored lengths: G28, G30, G92 and the work systems, each along X Y Z U V W.
KEPT_LENGTHS = frozenset(
    first + i for first in (G28, G30, G92 + 1, *(ORIGINS + STEP * n for n in range(9))) for i in LINEAR
)
PER_MM = 0.03937007874016  # inches: so LinuxCNC converts what parameters and tables keep, but for programs in inches
DEBUGGING = 5599
FAULTS = (5600, 5601)  # of the tool changer
ARGUMENTS = "n_args"  # name of the number of a call's arguments, where the INI file wants it
INPUT = 5399  # what M66 read


class State(house.State):
    """All that a block of this language can read and change."""

    numbered: list[float]  # type: ignore[assignment]  # nothing is null here
    position: list[float]  # nine

    def __init__(self, dialect: Any, machine: Any, warn: Any) -> None:
        self.ini = machine.ini or NO_INI
        self.spindles = [Spindle() for _ in range(self.ini.spindles)]
        self.chosen = 0  # the spindle that cycles, threads and feeds a revolution go with
        super().__init__(dialect, machine, warn)
        self.position = [0.0] * 9
        self.numbered = [0.0] * (LAST + 1)
        #: U, V and W, if the machine has one of them, and where the next move leaves them (machine coordinates, mm).
        own = {letter: axis for letter, axis in machine.auxiliary.items() if axis.type != "disabled"}
        self.auxiliary = [(i, NINE[i], own.get(NINE[i])) for i in (6, 7, 8)] if own else []
        self.axes += "".join(own)
        self.led = [0.0] * 3
        self.numbered_of(machine)
        self.numbered[DEBUGGING] = 1.0
        self.origin = [0.0] * 9
        self.rotation = 0.0  # degrees
        self.shift = [0.0] * 9  # G92 and G52
        self.tool_offset = [0.0] * 9
        #: End of the last printed move. It follows changes of offsets, but neither rotations nor tool lengths:
        #: so LinuxCNC's stand-alone interpreter remembers it.
        self.told = [0.0] * 9
        self.stale = False  # the position is taken from there before the next line
        self.slots: list[Tool] = list(machine.slots or (EMPTY, *machine.tools.values()))  # slot 0 is the spindle
        if self.ini.random and self.slots[0] is EMPTY:
            self.slots[0] = UNUSED
        self.show_tool()
        self.slot = min(1, len(self.slots) - 1)  # of the tool in the spindle, before any change
        #: Where the tool of the last M6 came from.
        self.spindle_pocket = -1 if self.slots[0] is EMPTY else self.slots[0].slot
        self.changed: Tool | None = None  # by M6 or M61 of this block
        self.selected_slot = 0
        self.gave_feed = 0.0  # the F word in force
        self.words: dict[str, float] = {}  # of the block
        self.codes: tuple[Code, ...] = ()  # of the block
        self.motion_name = "g80"
        self.motion_before = "g80"  # before the block
        self.retract = 99
        self.diameter = False  # G7
        self.feed_mode = 94
        self.plane_code = 170
        self.path_mode = 64
        self.cutter = 0  # 0, 41, 42
        self.indexed = False  # this block's G0 has turned a locked axis
        self.arc_refused = False  # right after G40
        self.adaptive = False
        self.followed = [True, True]  # the machine follows the overrides of feed and speed, M50 and M51 or not
        self.hold = True
        self.value = 0.0  # of the last return
        self.value_returned = False
        self.remaps: tuple[str, ...] = ()  # codes whose subroutines run, the innermost last
        self.defining = False  # names without a value read as 0, in a definition that is passed over
        self.spline: list[tuple[float, float, float]] = []  # control points of G5.2: x, y, weight
        self.spline_order = 0
        self.spline_end: tuple[float, float] | None = None  # P Q of the last G5
        self.sticky: dict[str, float] = {}  # words that a cycle remembers
        self.cycle_height: float | None = None  # where the first cycle began
        self.finished = False
        self.logs = Logs()
        self.saved: Any = None  # by M70 at this level of calls

    def numbered_of(self, machine: Any) -> None:
        """Take the parameters before the run: the machine's folder has lengths in mm, a parameter file in inches."""
        for number, value in machine.variables.items():
            if number in KEPT_LENGTHS:
                value *= PER_MM
            if 0 < number <= LAST:
                self.numbered[number] = value
        for number, value in (machine.parameters or {}).items():
            self.numbered[number] = value

    # --- the first spindle

    @property
    def speed(self) -> float:
        return self.spindles[0].speed

    @speed.setter
    def speed(self, value: float) -> None:
        self.spindles[0].speed = value

    @property
    def spindle(self) -> int:
        return self.spindles[0].direction

    @spindle.setter
    def spindle(self, value: int) -> None:
        self.spindles[0].direction = value

    # --- position

    def to_space(self, place: list[float]) -> list[float]:
        """From the program's frame to machine coordinates, without the tool's offset."""
        x, y, z, a, b, c, u, v, w = place  # written out, as every move comes by
        sx, sy, sz, sa, sb, sc, su, sv, sw = self.shift
        ox, oy, oz, oa, ob, oc, ou, ov, ow = self.origin
        x += sx
        y += sy
        if self.rotation != 0.0:
            x, y = self.turned(x, y, self.rotation)
        return [
            x + ox, y + oy, z + sz + oz, a + sa + oa, b + sb + ob, c + sc + oc, u + su + ou, v + sv + ov, w + sw + ow
        ]  # fmt: skip

    def to_program(self, place: list[float]) -> list[float]:
        """The inverse of `to_space`; of six axes, U, V and W stay."""
        place = [*place, *self.position[len(place) :]]
        moved = [p - o for p, o in zip(place, self.origin, strict=True)]
        moved[0], moved[1] = self.turned(moved[0], moved[1], -self.rotation)
        return [p - s for p, s in zip(moved, self.shift, strict=True)]

    @staticmethod
    def turned(x: float, y: float, angle: float) -> tuple[float, float]:
        """A vector turned counterclockwise by degrees."""
        if angle == 0.0:
            return x, y
        c, s = cos(radians(angle)), sin(radians(angle))
        return x * c - y * s, x * s + y * c

    def machine_position(self) -> list[float]:
        """Positions of the machine's axes: the tool's offset included."""
        return [s + t for s, t in zip(self.to_space(self.position), self.tool_offset, strict=True)]

    def begin_line(self) -> None:
        """What every line begins with, those of O-words too."""
        if self.stale:
            self.stale = False
            self.position = self.told[:]
        for number in FAULTS:
            self.numbered[number] = 0.0

    def load_system(self) -> None:
        """Take origin and rotation of the active system from the parameters; the machine stays."""
        first = ORIGINS + STEP * self.system
        here = self.to_space(self.position)
        before = self.origin
        self.origin = self.stored(first)
        self.rotation = self.numbered[first + 9]
        self.position = self.to_program(here)
        self.told = [t + b - n for t, b, n in zip(self.told, before, self.origin, strict=True)]

    def set_shift(self, shift: list[float]) -> None:
        """Put G92's offset in force; the machine stays."""
        steps = [b - n for b, n in zip(self.shift, shift, strict=True)]
        self.told = [t + b - n for t, b, n in zip(self.told, self.shift, shift, strict=True)]
        self.position = [p + step for p, step in zip(self.position, steps, strict=True)]
        self.shift = shift

    def stored(self, first: int) -> list[float]:
        """Nine parameters of lengths and angles, mm and degrees."""
        values = self.numbered[first : first + 9]
        if self.unit == INCH:
            return [value * INCH if i in LINEAR else value for i, value in enumerate(values)]
        return [value / PER_MM if i in LINEAR else value for i, value in enumerate(values)]

    def to_kept(self, value: float, axis: int) -> float:
        """A length (mm) or angle as parameters have it."""
        if axis not in LINEAR:
            return value
        return value / INCH if self.unit == INCH else value * PER_MM

    def store(self, first: int, place: list[float]) -> None:
        """Put nine lengths and angles into parameters."""
        for i, value in enumerate(place):
            self.numbered[first + i] = self.to_kept(value, i)

    def told_shift(self) -> list[float]:
        return self.shift

    def length(self, w: Any, letter: str, otherwise: float = 0.0) -> float:
        """A word of a length, mm."""
        return w[letter] * self.unit if letter in w else otherwise

    def axis(self, w: Any, i: int) -> float:
        """The word of an axis, mm or degrees."""
        value: float = w[NINE[i]]
        if i in LINEAR:
            value *= self.unit
            if i == 0 and self.diameter:
                value /= 2.0
        return value

    # --- parameters

    def number_of(self, index: float | None) -> int:
        if index is None:
            raise TypeError("null index")
        number = integer(index)
        if number is None or number < 0:
            raise Refusal(F.BAD_INDEX, value=f"{index:g}", wanted="parameters have whole numbers from 0")
        return number

    def index(self, value: float | None) -> int:
        """A parameter's number. Raises Refusal."""
        number = self.number_of(value)
        if not 1 <= number <= LAST:
            raise Refusal(F.NO_VARIABLE, number=number, hint=self.dialect.no_variable)
        return number

    def read(self, index: float | None) -> float:
        number = self.index(index)
        if POSITION <= number < POSITION + 9:
            if self.cutter:
                raise Refusal(F.UNDER_COMPENSATION, what=f"#{number}")
            return self.shown(number - POSITION)
        return self.numbered[number]

    def shown(self, i: int) -> float:
        """The present position on an axis, program units."""
        return self.position[i] / self.unit if i in LINEAR else self.position[i]

    def guided(self) -> list[float]:
        """The position; under cutter compensation where the tool is led to, as far as that is known."""
        stage: Any = self.stages.get("compensation")
        led: list[float] | None = (
            stage.led(self) if hasattr(stage, "led") else None
        )  # behind G40 there is another stage
        return self.position if led is None else led

    def beside(self, i: int) -> float:
        """That position on an axis, program units."""
        place = self.guided()[i]
        return place / self.unit if i in LINEAR else place

    def has_number(self, index: float) -> bool:
        """EXISTS of a numbered parameter."""
        number = round(index) if abs(index) < 1e9 else -1
        return 1 <= number <= LAST

    def check_write(self, number: int) -> None:
        """Raises Refusal."""
        if not 1 <= number <= LAST:
            raise Refusal(F.NO_VARIABLE, number=number, hint=self.dialect.no_variable)
        if number in READ_ONLY:
            raise Refusal(F.READ_ONLY, what=f"#{number}", title="tool and position are only read")

    def read_name(self, name: str) -> float | None:
        value = self.ini.named(name)
        if value is not None:
            return value
        try:
            return super().read_name(name)
        except Refusal:
            if self.defining:
                return 0.0
            raise

    def exists(self, name: str) -> bool:
        return super().exists(name) or self.ini.named(name) is not None

    def write_name(self, name: str, value: float | None) -> None:
        if self.ini.named(name) is not None:
            raise Refusal(F.READ_ONLY, what=f"#<{name}>", title="a value of the INI file")
        if name == ARGUMENTS and self.ini.counts_arguments and self.calls:
            raise Refusal(F.READ_ONLY, what=f"#<{name}>", title="the number of the call's arguments")
        super().write_name(name, value)

    def create(self, name: str) -> None:
        """A name that a line sets can be read behind that, as 0."""
        if name not in self.dialect.named:
            (self.scope if self.is_local(name) else self.names).setdefault(name, 0.0)

    # --- overrides

    def follow_feed(self, on: bool) -> None:
        self.followed[0] = on
        self.out.event("ENABLE_FEED_OVERRIDE" if on else "DISABLE_FEED_OVERRIDE")

    def follow_speed(self, on: bool, spindle: int) -> None:
        self.followed[1] = on  # one for all spindles, as LinuxCNC keeps it
        self.out.event("ENABLE_SPEED_OVERRIDE" if on else "DISABLE_SPEED_OVERRIDE", spindle)

    # --- tools

    def show_tool(self) -> None:
        """Fill the parameters of the tool in the spindle."""
        tool = self.slots[0]
        data = (float(tool.id), *(v * PER_MM if i in LINEAR else v for i, v in enumerate(tool.offsets())),
                tool.diameter * PER_MM, tool.p1, tool.p2, tool.p3)  # fmt: skip
        self.numbered[TOOL_DATA : TOOL_DATA + len(data)] = data

    def slot_of(self, number: int) -> int:
        """The slot of a tool, 0 for tool 0. Raises Refusal."""
        if number == 0:
            return 0
        for slot, tool in enumerate(self.slots):
            if slot and tool.id == number:
                return slot
        if self.slots[0].id == number:
            return 0
        raise Refusal(F.NO_TOOL, "t", tool=number)
