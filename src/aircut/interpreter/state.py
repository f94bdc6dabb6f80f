"""The state of a run: position, modes, offsets, variables.

Lengths are mm, angles degrees, speeds mm/min. `position` is the controlled point
in the program's own frame; `to_space` leads to machine coordinates.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from aircut.canon import Recorder
from aircut.diagnostics import Refusal
from aircut.diagnostics import faults as F
from aircut.geometry import kinematics
from aircut.geometry.kinematics import Setup
from aircut.interpreter.path import RECORDER, Onward, Place, Stage
from aircut.interpreter.travel import shifted, travel_of
from aircut.language.arithmetic import EQUAL
from aircut.machine import Machine
from aircut.machine.tools import EMPTY

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from aircut.interpreter.frame import Frame
    from aircut.interpreter.table import Code, Dialect, Group

INCH = 25.4  # mm
PLANES = ("XY", "XZ", "YZ")  # by plane number, as canonical commands name them
WORK_SYSTEMS = 9


class State:
    """All that a block can read and change. Handlers get it as their first argument."""

    def __init__(self, dialect: Dialect, machine: Machine, warn: Callable[..., None]) -> None:
        self.dialect = dialect
        self.machine = machine
        self.warn = warn  # warn(fault, letter="", **values); an error stops the run, unless it keeps going
        self.out = Recorder()
        self.axes = machine.letters

        self.position = [0.0] * 6
        self.offset = [0.0] * 6  # work system + G52 + G92
        self.frame: Frame | None = None  # scaling and rotation
        self.travel = travel_of(machine)
        self.stages: dict[str, Stage] = {}  # by slot of the path
        self.way: Onward = RECORDER  # where moves go
        self.compensating = False  # G41, G42: the cutter's radius
        self.origins = [[0.0] * 6 for _ in range(WORK_SYSTEMS)]
        self.system = 0
        self.local = [0.0] * 6  # G52
        self.shift = [0.0] * 6  # G92
        self.shifted = False
        self.home = [0.0] * 6  # G28, machine axes
        self.second_home = [0.0] * 6  # G30
        self.tools = dict(machine.tools)  # the run's own table
        self.tool_offset: Place = [0.0] * 6
        self.fence()
        self.setup: Setup | None = None  # of tool center point control

        self.modal: dict[Group, Code] = {}
        self.motion: Code | None = None  # the modal code of group MOTION
        self.unit = 1.0  # mm a program unit
        self.absolute = True
        self.arc_absolute = False
        self.polar = False
        self.inverse_time = False
        self.plane = 0
        self.flags = 0  # of the toolpath's rows, from the path mode
        self.blend = 0.0  # G64 P
        self.thinning = 0.0  # G64 Q
        self.cycle: Any = None  # Sticky words of the canned cycles in force
        self.exact_stop = False  # G9, for one block
        self.machine_frame = False  # G53, for one block

        self.feed = 0.0  # mm/min; under G93 the F word itself
        self.surface_feed = machine.options.rotary_feed_handling
        self.feed_told = 0.0  # what the listing last heard
        self.speed = 0.0  # revolutions a minute
        self.spindle = 5
        self.mist = False
        self.flood = False
        self.selected_tool = 0
        self.tool = 0
        self.compensated_tool = EMPTY  # whose offset is in force
        self.declared = False  # M61 or M106 since the last M6
        self.changing = False  # between M107 and M108
        self.feed_override = 1
        self.speed_override = 1
        self.stop_code: float | None = None
        self.tool_code: float | None = None
        self.feed_override_code = 48.0
        self.speed_override_code = 48.0

        self.outputs_on: frozenset[tuple[int, bool]] = frozenset()  # number, and whether analog
        self.going_off: list[Any] = []  # the requests that put outputs off at the end
        self.interpolated = 0  # axes by bits, G101
        self.traverse_rate = 0.0  # mm/min, G103
        self.acceleration = 0.0  # mm/s², G104
        self.deceleration = 0.0
        self.jerk = 100.0  # percent

        self.probe_state: float | None = None  # #5700
        self.probed: list[float | None] = [None] * 6
        self.probed_machine: list[float | None] = [None] * 6
        self.input_value: float | None = None  # #5720
        self.answer: float | None = None  # #5721
        self.waited: float | None = None  # #5722
        self.entered: list[float | None] = [None] * 10  # #5730 to #5739
        self.input_group: list[float | None] = [None] * 20  # #5740 to #5759
        self.macro: Any = None  # the Call of G66
        self.macro_level = 0  # depth of calls at which G66 was given
        self.macro_count = 0  # #5148
        self.macro_motion = 0  # #5800
        self.rotary_modulus = 360.0
        self.rotary_modes = [0.0, 0.0, 0.0]
        self.rollover = False  # a rotary mode is not 0
        self.indexers: tuple[int, ...] = ()  # axes that move alone

        self.compile_mode = 2  # interpreter.midway.Mode
        self.compile_line = 0  # that the program starts from
        self.restarted: list[float | None] = [None] * 6  # #5081-#5086
        self.stopped: list[float | None] = [None] * 6  # #5091-#5096

        self.locals: list[float | None] = [None] * 34
        self.numbered: list[float | None] = [None] * 7000
        self.names: dict[str, float | None] = {}
        self.scope: dict[str, float | None] = {}
        self.line = 0  # line being run, from 1
        self.calls = 0  # depth
        self.asked = 0  # conversations with the world so far
        self.restarts = 0  # by M47
        self.transfer: Any = None  # where control goes after the block: a Call, Return, End or Restart

    # --- position

    def to_space(self, place: Place) -> Place:
        """From the program's frame to machine coordinates, without the tool's offset."""
        x, y, z, a, b, c = place  # written out, as every move under a stage comes by
        i, j, k, l, m, n = self.offset  # noqa: E741
        moved = [x + i, y + j, z + k, a + l, b + m, c + n]
        return moved if self.frame is None else self.frame.to_space(moved)

    def to_program(self, place: Place) -> Place:
        """The inverse of `to_space`."""
        moved = place if self.frame is None else self.frame.to_program(place)
        return [p - o for p, o in zip(moved, self.offset, strict=True)]

    def add_offsets(self) -> None:
        """Recompute `offset`; the machine position stays, so the program position changes."""
        here = self.to_space(self.position)
        origin, local, shift = self.origins[self.system], self.local, self.shift
        on = 1.0 if self.shifted else 0.0
        self.offset = [origin[i] + local[i] + on * shift[i] for i in range(6)]
        self.fence()
        self.position = self.to_program(here)

    def fence(self) -> None:
        """Recompute the boxes that the axes' travel allows, after a change of offsets."""
        self.space_box = shifted(self.travel, self.tool_offset)
        self.box = shifted(self.space_box, self.offset, 0.0)

    def bounds(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """Lowest and highest place in space that the axes can bring the controlled point to, mm and degrees."""
        return self.space_box[::2], self.space_box[1::2]

    def set_frame(self, frame: Frame | None) -> None:
        """Put a frame in force; the machine position stays."""
        here = self.to_space(self.position)
        self.frame = frame
        self.position = self.to_program(here)

    def told_shift(self) -> list[float]:
        """G52 and G92 together, as SET_G92_OFFSET tells them."""
        return [a + (b if self.shifted else 0.0) for a, b in zip(self.local, self.shift, strict=True)]

    def machine_position(self) -> list[float]:
        """Positions of the machine's axes: the tool's offset included."""
        return self.to_axes(self.to_space(self.position))

    def to_axes(self, space: Place) -> Place:
        """Positions of the machine's axes that put the controlled point at a place in space."""
        if self.setup is None:
            return [s + t for s, t in zip(space, self.tool_offset, strict=True)]
        return [*kinematics.inverse(self.setup, space[:3], space[3:]), *space[3:]]

    def of_axes(self, axes: Place) -> Place:
        """Where in space the controlled point is when the machine's axes stand so."""
        if self.setup is None:
            return [a - t for a, t in zip(axes, self.tool_offset, strict=True)]
        return [*kinematics.forward(self.setup, axes[:3], axes[3:]), *axes[3:]]

    # --- variables

    def read(self, index: float | None) -> float | None:
        """Value of a numbered variable. Raises Refusal."""
        number = self.number_of(index)
        if number < 34:
            return self.locals[number] if number else None
        for row in self.dialect.ranges:
            if row.first <= number <= row.last:
                return self.numbered[number]
        for system in self.dialect.system:
            if system.first <= number <= system.last:
                value = system.read(self, number - system.first)
                if system.unit == "length" and value is not None:
                    return value / self.unit
                return value
        self.unlisted(number)
        return None

    def number_of(self, index: float | None) -> int:
        if index is None:
            raise TypeError("null index")
        number = round(index) if abs(index) < 1e9 else -1
        if abs(index - number) > EQUAL or number < 0:
            wanted = "variables have whole numbers from 0"
            raise Refusal(F.BAD_INDEX, value=f"{index:g}", wanted=wanted)
        return number

    def unlisted(self, number: int) -> None:
        if 5000 <= number <= 5999:
            return
        raise Refusal(F.NO_VARIABLE, number=number, hint=self.dialect.no_variable)

    def write(self, index: float | None, value: float | None) -> None:
        """Assign a numbered variable. Raises Refusal."""
        number = self.number_of(index)
        if 0 < number < 34:
            self.locals[number] = value
            return
        if number == 0:
            raise Refusal(F.READ_ONLY, what="#0", title="it is null by definition")
        for row in self.dialect.ranges:
            if row.first <= number <= row.last:
                if not row.writable:
                    raise Refusal(F.READ_ONLY, what=f"#{number}", title=row.title)
                self.numbered[number] = value
                return
        for system in self.dialect.system:
            if system.first <= number <= system.last:
                if system.write is None:
                    raise Refusal(F.READ_ONLY, what=f"#{number}", title=system.title)
                if value is not None and system.unit == "length":
                    value *= self.unit
                system.write(self, number - system.first, value)
                return
        self.unlisted(number)
        raise Refusal(F.READ_ONLY, what=f"#{number}", title="a system variable without a meaning")

    def is_local(self, name: str) -> bool:
        return name.startswith("_") == self.dialect.local_underscore

    def exists(self, name: str) -> bool:
        """Whether a named variable has been given a value (a predefined one has)."""
        return name in self.dialect.named or name in (self.scope if self.is_local(name) else self.names)

    def read_name(self, name: str) -> float | None:
        """Value of a named variable. Raises Refusal."""
        if name in self.dialect.named:
            return self.dialect.named[name].read(self)
        try:
            return (self.scope if self.is_local(name) else self.names)[name]
        except KeyError:
            raise Refusal(F.UNDEFINED_NAME, name=name) from None

    def write_name(self, name: str, value: float | None) -> None:
        """Assign a named variable. Raises Refusal."""
        if name in self.dialect.named:
            raise Refusal(F.READ_ONLY, what=f"#<{name}>", title=self.dialect.named[name].title)
        (self.scope if self.is_local(name) else self.names)[name] = value

    # --- comparing states

    def snapshot(self) -> dict[str, Any]:
        """All that can decide what happens next; first the variables, which differ most often."""
        skip = ("out", "dialect", "machine", "warn", "line")
        found = {name: frozen(value) for name, value in self.__dict__.items() if name not in skip}
        return dict(sorted(found.items(), key=lambda item: not isinstance(item[1], dict)))

    def matches(self, snapshot: dict[str, Any]) -> bool:
        """Whether all is as it was then: at the same place that means an endless loop."""
        now = self.__dict__
        return all(
            (frozen(now[name]) if isinstance(value, tuple) else now[name]) == value for name, value in snapshot.items()
        )


def frozen(value: Any) -> Any:
    """A copy that later changes do not touch."""
    if isinstance(value, list):
        return tuple(map(tuple, value)) if value and isinstance(value[0], list) else tuple(value)
    return dict(value) if isinstance(value, dict) else value


def whole(words: Mapping[str, Any], letter: str) -> int:
    """The value of a word that must be a whole number (within 0.0001). Raises Refusal."""
    value = words[letter]
    nearest = round(value) if abs(value) < 1e15 else 0
    if abs(value - nearest) > EQUAL:
        raise Refusal(F.NOT_INTEGER, letter, word=letter.upper(), value=value)
    return nearest


def out_of_range(words: Mapping[str, Any], letter: str, wanted: str) -> Refusal:
    """The Refusal of a word's value."""
    return Refusal(F.BAD_VALUE, letter, word=letter.upper(), value=words[letter], wanted=wanted)
