"""Tool center point control: G43.4, G43.7.

The program says where the tool's tip is on the part and how the rotary axes stand;
the linear axes follow. A move becomes as many straight ones of all axes as keep the
tip within TOLERANCE of its way. The toolpath's rows hold positions of the axes, less
the tool's offset as ever, and the speed of the axes at which the tip has the speed F.

Sources: 000 section 12; decisions AMB-RTCP-1 to AMB-RTCP-7.
"""

from __future__ import annotations

from array import array
from collections.abc import Generator
from functools import partial
from math import atan2, cos, hypot, radians, sin
from typing import TYPE_CHECKING, Any, NamedTuple

from aircut.canon import EXACT_STOP, PART, ROW, TIP, Kind
from aircut.diagnostics import Refusal
from aircut.diagnostics import faults as F
from aircut.geometry import arcs
from aircut.geometry.kinematics import MODELS, Setup, Sweep, minus, pieces
from aircut.interpreter import travel
from aircut.interpreter.motion import LINEAR_AXES
from aircut.interpreter.path import Onward, Place
from aircut.interpreter.state import State
from aircut.interpreter.table import Code, Group, Order, Words
from aircut.interpreter.tooling import compensate, tool_of
from aircut.kernels import follow as kernel
from aircut.machine import Machine
from aircut.machine.config import KINEMATICS, ROTARY

if TYPE_CHECKING:
    from aircut.interpreter.requests import Request

TOLERANCE = 0.01  # mm between the tip and its programmed way (AMB-RTCP-6)
MOST = 1_000_000  # pieces of a move
FEED = int(Kind.FEED)
FEW = 64


def scratch(count: int) -> tuple[memoryview, Any, Any]:
    """Memory for the start of a move and so many rows, as bytes, numbers and words."""
    rows = memoryview(bytearray((count + 1) * ROW.size))
    return rows, rows.cast("d"), rows.cast("q")


SCRATCH = scratch(FEW)  # where the rows of most moves are made

#: Modes that cannot be in force together with it (AMB-RTCP-6).
EXCLUDED = ("G41", "G41.1", "G42", "G42.1", "G51", "G68.2")


class Control(NamedTuple):
    """The stage that turns ways of the tip into ways of the axes: the last one before the recorder."""

    setup: Setup
    facts: array[float]  # the same, as the kernel wants it

    def line(self, m: State, kind: int, end: Place, speed: float, flags: int, *, onward: Onward) -> None:
        """The tip moves straight."""
        start, goal = array("d", m.to_space(m.position)), array("d", end)
        count = kernel.pieces(self.facts, start, goal, TOLERANCE)
        if count > MOST:
            raise Refusal(F.RTCP_TOO_LONG, limit=MOST)
        last = flags | TIP
        self.write(m, kind, start, goal, speed, int(count), (last & ~EXACT_STOP) | PART, last)

    def arc(
        self, m: State, end: Place, center: tuple[float, float], turns: int, speed: float, flags: int, *, onward: Onward
    ) -> None:
        """The tip moves along an arc or helix, in chords."""
        start = m.to_space(m.position)
        u, v, w = arcs.PLANE_AXES[m.plane]
        here, there = (start[u], start[v]), (end[u], end[v])
        swept = arcs.sweep(here, there, center, turns)
        first = hypot(here[0] - center[0], here[1] - center[1])
        grown = hypot(there[0] - center[0], there[1] - center[1]) - first
        sweep = around(self.setup, m.plane, center, (start[w], end[w]), first, grown, abs(swept))
        count = pieces(self.setup, sweep, start[3:], end[3:], TOLERANCE)
        if count > MOST:
            raise Refusal(F.RTCP_TOO_LONG, limit=MOST)
        begin = atan2(here[1] - center[1], here[0] - center[0])
        last = flags | TIP
        before = array("d", start)
        for piece in range(1, int(count)):
            part = piece / count
            place = array("d", [a + part * (b - a) for a, b in zip(start, end, strict=True)])
            angle, radius = begin + part * swept, first + part * grown
            place[u] = center[0] + radius * cos(angle)
            place[v] = center[1] + radius * sin(angle)
            self.write(m, FEED, before, place, speed, 1, 0, last & ~EXACT_STOP)
            before = place
        self.write(m, FEED, before, array("d", end), speed, 1, 0, last)

    def write(
        self, m: State, kind: int, start: array[float], end: array[float], speed: float, count: int, inner: int,
        last: int,
    ) -> None:  # fmt: skip
        """Write a move of the tip as so many rows. inner, last: flags of the last row and of those before it."""
        out = m.out
        room = (count + 1) * ROW.size
        rows, doubles, words = SCRATCH if count < FEW else scratch(count)
        numbers = out.line | m.tool << 32
        rest = out.file << 16 | kind << 32 | m.plane << 40
        kernel.follow(
            self.facts, start, end, speed, count, numbers, rest | inner << 48, rest | last << 48,
            doubles, words,
        )  # fmt: skip
        travel.check_rows(m, doubles, 1, count + 1)
        out.rows += rows[ROW.size : room]

    def flush(self, m: State, *, onward: Onward) -> None:
        """It holds nothing back."""


def control_of(setup: Setup) -> Control:
    """The stage for a setup."""
    model = MODELS[setup.model]
    h, arm = setup.h, minus(setup.j, setup.tool)
    if model.head:
        bound = (
            hypot(*(h[i] for i in range(3) if i != model.outer)) + hypot(*arm),
            hypot(*(arm[i] for i in range(3) if i != model.inner)),
        )
        rest = (*h, *arm, bound[0], bound[1], bound[1])
    else:
        rest = (*setup.d, 0.0, 0.0, 0.0, hypot(setup.d_x, setup.d_y), setup.d_z, 0.0)
    signs = (radians(setup.signs[model.outer]), radians(setup.signs[model.inner]))
    return Control(setup, array("d", (model.head, model.outer, model.inner, *signs, *rest)))


def around(
    setup: Setup, plane: int, center: tuple[float, float], ends: tuple[float, float], radius: float, grown: float,
    swept: float,
) -> Sweep:  # fmt: skip
    """Bounds of an arc of a plane. ends: along its axis. radius: at the start; grown: to the end. mm, radians."""
    u, v, w = arcs.PLANE_AXES[plane]
    widest = radius + max(grown, 0.0)
    low, high = [0.0] * 3, [0.0] * 3
    low[u], low[v], low[w] = center[0] - widest, center[1] - widest, min(ends)
    high[u], high[v], high[w] = center[0] + widest, center[1] + widest, max(ends)
    far = [max(abs(a), abs(b)) for a, b in zip(low, high, strict=True)]
    return Sweep(
        hypot(widest * swept, grown, ends[1] - ends[0]),
        hypot(widest * swept * swept, 2.0 * grown * swept),
        hypot(far[0], far[1]),
        max(abs(low[2] - setup.d_z), abs(high[2] - setup.d_z)),
    )


def setup_of(machine: Machine, tool: list[float]) -> Setup | None:
    """The machine's kinematics with a tool offset, mm; None where it has none, or not the feature."""
    number = KINEMATICS.index(machine.kinematics)
    if number not in MODELS or not machine.options.rtcp:
        return None
    table, head = machine.rotary_table, machine.tilting_spindle
    inverse = {letter for letter, axis in machine.axes.items() if axis.convention == "inverse"}
    sign_a, sign_b, sign_c = (-1.0 if letter in inverse else 1.0 for letter in "abc")
    return Setup(
        number, tool[0], tool[1], tool[2],
        table.d_x, table.d_y, table.d_z,
        head.h_x, head.h_y, head.h_z,
        head.j_x, head.j_y, head.j_z,
        sign_a, sign_b, sign_c,
    )  # fmt: skip


def control(name: str, own: bool, m: State, w: Words) -> None:
    """G43.4 H, and G43.7 H X Y Z, whose words replace the tool's offsets (AMB-RTCP-3). Nothing moves."""
    for row in m.modal.values():
        if row.name in EXCLUDED:
            raise Refusal(F.RTCP_CONFLICT, "g", code=name, other=row.name)
    tool = tool_of(m, w, "h")
    offset = [tool.x, tool.y, tool.z, 0.0, 0.0, 0.0]
    if own:
        for axis in ROTARY:
            if axis in w:
                raise Refusal(F.UNUSED_WORD, axis, word=axis.upper())
        for i, axis in LINEAR_AXES:
            if axis in w:
                offset[i] = w[axis] * m.unit
    setup = setup_of(m.machine, offset)
    if setup is None:
        told = "on" if m.machine.options.rtcp else "off"
        raise Refusal(F.NO_RTCP, "g", code=name, why=f"kinematics {m.machine.kinematics}, option rtcp {told}")
    compensate(m, offset, tool, control_of(setup))


def guarded(row: Code) -> Code:
    """A code that is refused while tool center point control is on."""

    def run(m: State, w: Words) -> Generator[Request, Any, None] | None:
        if m.setup is not None:
            raise Refusal(F.RTCP_CONFLICT, "g", code=row.name, other=m.modal[Group.TOOL_LENGTH].name)
        return row.run(m, w)

    return row._replace(run=run) if row.name in EXCLUDED else row


lengths = partial(Code, group=Group.TOOL_LENGTH, order=Order.TOOL_LENGTH, takes="h", modal=True)

CODES = (
    lengths("G43.4", "Tool center point control", partial(control, "G43.4", False)),
    lengths("G43.7", "Tool center point control with own offsets", partial(control, "G43.7", True), axes=True),
)
