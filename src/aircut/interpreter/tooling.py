"""Tools: length compensation, the tool table, and changes by macro.

Sources: 000 sections 1.1, 1.2, 3.5; decisions AMB-TC-*, AMB-TT-*, AMB-XF-16.
"""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import msgspec

from aircut.diagnostics import Refusal
from aircut.diagnostics import faults as F
from aircut.geometry.kinematics import Setup
from aircut.interpreter import path
from aircut.interpreter.auxiliary import known_tool
from aircut.interpreter.calls import Call
from aircut.interpreter.motion import LINEAR_AXES
from aircut.interpreter.state import State, out_of_range, whole
from aircut.interpreter.table import Code, Group, Order, Words
from aircut.machine import Tool
from aircut.machine.tools import EMPTY

if TYPE_CHECKING:
    from aircut.interpreter.rtcp import Control

TOOL_CHANGE = "tool_change.ngc"
TYPES = 8  # the highest tool type


def tool_of(m: State, w: Words, letter: str) -> Tool:
    """The tool that a word names, or the one in the spindle without the word. Raises Refusal."""
    number = known_tool(m, w, letter) if letter in w else m.tool
    return m.tools.get(number, EMPTY)


def compensate(m: State, offset: list[float], tool: Tool, control: Control | None = None) -> None:
    """Put a tool offset in force, with tool center point control or without: the machine stays, the program
    position changes.
    """
    axes = m.machine_position()
    before, m.setup = m.setup, None if control is None else control.setup
    m.tool_offset = offset
    m.fence()
    m.compensated_tool = tool
    m.position = m.to_program(m.of_axes(axes))
    m.out.event("USE_TOOL_LENGTH_OFFSET", *offset, 0.0, 0.0, 0.0)
    if before is not None or m.setup is not None:
        path.set_stage(m, "rtcp", control)
        m.out.event("TOOL_CENTER_POINT", *(m.setup or Setup(0)))


def length(m: State, w: Words) -> None:
    """G43 H: the offset of a tool of the table, in place of any before."""
    tool = tool_of(m, w, "h")
    compensate(m, [tool.x, tool.y, tool.z, 0.0, 0.0, 0.0], tool)


def dynamic_length(m: State, w: Words) -> None:
    """G43.1 X Y Z: the given offset; axes not given keep theirs."""
    offset = m.tool_offset[:]
    for i, axis in LINEAR_AXES:
        if axis in w:
            offset[i] = w[axis] * m.unit
    compensate(m, offset, EMPTY)


def added_length(m: State, w: Words) -> None:
    """G43.2 H: the offset of a tool on top of the one in force."""
    tool = tool_of(m, w, "h")
    added = (tool.x, tool.y, tool.z, 0.0, 0.0, 0.0)
    compensate(m, [a + b for a, b in zip(m.tool_offset, added, strict=True)], tool)


def no_length(m: State, w: Words) -> None:
    """G49."""
    compensate(m, [0.0] * 6, EMPTY)


def table_entry(calculated: bool, m: State, w: Words) -> None:
    """G10 L1 and L10 P: write a tool's entry; what is not given keeps its value, or is 0 for a new tool."""
    number = whole(w, "p")
    if not 0 < number < 2**31:
        raise out_of_range(w, "p", "tools are whole numbers above 0")
    if w.get("d", 0.0) < 0.0:
        raise out_of_range(w, "d", "diameters are not negative")
    if "q" in w and not 0 <= whole(w, "q") <= TYPES:
        raise out_of_range(w, "q", f"tool types are 0 to {TYPES}")
    known = m.tools.get(number)
    changes: dict[str, float | int] = {}
    for i, axis in LINEAR_AXES:
        if axis in w:
            value = w[axis] * m.unit
            changes[axis] = m.position[i] + m.tool_offset[i] - value if calculated else value
    if "d" in w:
        changes["diameter"] = w["d"] * m.unit
    if "q" in w:
        changes["type"] = whole(w, "q")
    changes |= {name: w[letter] for letter, name in (("i", "p1"), ("j", "p2"), ("k", "p3")) if letter in w}
    if "v" in w:
        slot = whole(w, "v")
        if known is not None:
            m.warn(F.SLOT_KEPT, "v", tool=number, slot=known.slot)
        elif slot and any(tool.slot == slot for tool in m.tools.values()):
            raise Refusal(F.SLOT_TAKEN, "v", slot=slot)
        else:
            changes["slot"] = slot
    tool = msgspec.structs.replace(known or Tool(number), **changes)
    m.tools = {**m.tools, number: tool}
    m.out.event(
        "SET_TOOL_TABLE_ENTRY", tool.slot, number, tool.x, tool.y, tool.z, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0
    )


def change_tool(m: State, w: Words) -> None:
    """M6: by the controller itself, or by the macro where the machine says so."""
    if m.machine.options.tool_change == "macro":
        slots = [float(m.tools[tool].slot) if tool in m.tools else 0.0 for tool in (m.selected_tool, m.tool)]
        numbers = (float(m.selected_tool), slots[0], float(m.tool), slots[1])
        m.tool_code = 6.0
        m.declared = False
        m.transfer = Call(TOOL_CHANGE, False, 1, None, numbers)
        return
    m.out.event("START_CHANGE")
    m.spindle = 5
    m.out.event("STOP_SPINDLE_TURNING", 0)
    m.tool = m.selected_tool
    m.tool_code = 6.0
    m.out.event("CHANGE_TOOL", m.tool)


def declare_tool(m: State, w: Words) -> None:
    """M61 Q: the tool in the spindle, without a change."""
    m.tool = known_tool(m, w, "q")
    m.declared = True
    m.out.event("CHANGE_TOOL_NUMBER", m.tool)


def internal_change(m: State, w: Words) -> None:
    """M106: the controller's own part of a change by macro; the selected tool is in the spindle then."""
    m.tool = m.selected_tool
    m.tool_code = 106.0
    m.declared = True
    m.out.event("CHANGE_TOOL", m.tool)


def change_macro(running: bool, m: State, w: Words) -> None:
    """M107, M108: the tool change macro has started, has ended."""
    m.changing = running
    m.out.event("TOOL_CHANGE_MACRO", int(running))


lengths = partial(Code, group=Group.TOOL_LENGTH, order=Order.TOOL_LENGTH, modal=True)
entry = partial(Code, group=Group.NON_MODAL, order=Order.NON_MODAL, takes="pdqijkv", needs="p", axes=True)

CODES = (
    lengths("G43", "Tool length compensation", length, takes="h"),
    lengths("G43.1", "Dynamic tool length compensation", dynamic_length, axes=True, needs_axes=True),
    lengths("G43.2", "Additional tool length compensation", added_length, takes="h", needs="h"),
    lengths("G49", "Tool length compensation off", no_length),
    Code("M6", "Tool change", change_tool, Group.TOOL, Order.TOOL_CHANGE),
    Code("M61", "Declare the loaded tool", declare_tool, Group.TOOL, Order.TOOL_CHANGE, takes="q", needs="q"),
    Code("M106", "Internal tool change procedure", internal_change, Group.TOOL, Order.TOOL_CHANGE),
    Code("M107", "Tool change macro starts", partial(change_macro, True), Group.TOOL_MACRO, Order.MACRO_START),
    Code("M108", "Tool change macro ends", partial(change_macro, False), Group.TOOL_MACRO, Order.MACRO_END),
)

SETTINGS = {
    1: entry("G10 L1", "Tool table entry", partial(table_entry, False)),
    10: entry("G10 L10", "Tool table entry, from the position", partial(table_entry, True)),
}
