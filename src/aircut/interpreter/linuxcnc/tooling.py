"""Tools of LinuxCNC's language: T, M6, M61, length offsets.

Sources: 001; the canonical listing, section 10.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

from msgspec.structs import replace

from aircut.diagnostics import Refusal
from aircut.diagnostics import faults as F
from aircut.interpreter.linuxcnc.arranging import given
from aircut.interpreter.linuxcnc.motion import home_of, index_and_go, wrong
from aircut.interpreter.linuxcnc.spindles import stop_all
from aircut.interpreter.linuxcnc.state import G30, NUMBERED_NINE, State
from aircut.interpreter.table import Code, Group, Order, Words
from aircut.machine.tools import EMPTY


def select_tool(m: State, w: Words) -> None:
    """T. Raises Refusal."""
    number = int(w["t"])
    slot = m.slot_of(number)
    m.selected_slot = slot
    m.selected_tool = number
    m.out.event("SELECT_TOOL", number)


def change(m: State, w: Words) -> None:
    """M6: load the selected tool; of tool 0, what was in the spindle stays there. Raises Refusal."""
    if m.cutter:
        raise Refusal(F.UNDER_COMPENSATION, what="a tool change")
    slot = m.selected_slot
    m.out.event("START_CHANGE")
    if not m.ini.spindle_on:
        stop_all(m)
    if m.ini.quill_up:
        space = m.to_space(m.position)
        space[2] = -m.tool_offset[2]
        out_of_the_way(m, m.to_program(space))
    if m.ini.at_g30:
        out_of_the_way(m, home_of(m, G30))
    m.out.event("CHANGE_TOOL", slot)
    m.slots[0] = m.slots[slot]
    if slot:
        m.spindle_pocket = m.slots[slot].slot
    recall_pocket(m)
    load(m, slot)


def recall_pocket(m: State) -> None:
    """G10 makes the spindle's entry that of the tool's own slot; a tool change forgets the pocket of that again."""
    if m.slots[0] is not EMPTY and not m.ini.random:
        m.slots[0] = replace(m.slots[0], slot=m.spindle_pocket)


def out_of_the_way(m: State, place: list[float]) -> None:
    """A move of the tool change itself, which pictures leave out."""
    m.out.event("COMMENT", "AXIS,hide")
    index_and_go(m, place)
    m.out.event("COMMENT", "AXIS,show")


def load(m: State, slot: int) -> None:
    m.slot = slot
    m.tool = m.slots[slot].id
    m.changed = m.slots[slot]
    m.show_tool()
    m.stale = True


def declare(m: State, w: Words) -> None:
    """M61: the tool Q is in the spindle. Raises Refusal."""
    if not given(w, "q"):
        raise Refusal(F.MISSING_WORD, code="M61", word="Q", meaning="the tool's number")
    number = round(w["q"])
    if number < 0:
        raise Refusal(F.BAD_VALUE, "q", word="Q", value=w["q"], wanted="a tool's number")
    slot = m.slot_of(number)
    m.out.event("CHANGE_TOOL_NUMBER", slot)
    recall_pocket(m)
    m.slot = slot
    m.tool = number
    m.changed = m.slots[slot]
    m.stale = True


def put_offset(m: State, offset: list[float]) -> None:
    """Put a tool's offset in force: the position reads otherwise, nothing moves. It lies along the machine's axes."""
    before = m.tool_offset
    steps = [b - n for b, n in zip(before, offset, strict=True)]
    if m.rotation:
        steps[:2] = m.turned(steps[0], steps[1], -m.rotation)
    m.position = [p + s for p, s in zip(m.position, steps, strict=True)]
    m.tool_offset = offset
    m.fence()
    m.out.event("USE_TOOL_LENGTH_OFFSET", *offset)


def bar(m: State) -> None:
    if m.cutter:
        raise Refusal(F.UNDER_COMPENSATION, what="another tool length")


def of_tool(m: State, w: Words) -> list[float]:
    """Offsets of the tool that H names; without H, of what this block brings, or of the spindle's. Raises Refusal."""
    if "h" not in w:
        return (m.changed or m.slots[0]).offsets()
    if w["h"] < 0:
        raise Refusal(F.NO_TOOL, "h", tool=int(w["h"]))
    if w["h"] == 0 and m.ini.random:
        return m.slots[m.slot].offsets()
    return m.slots[m.slot_of(int(w["h"]))].offsets()


def tool_length(m: State, w: Words) -> None:
    """G43. Raises Refusal."""
    bar(m)
    put_offset(m, of_tool(m, w))


def dynamic_length(m: State, w: Words) -> None:
    """G43.1: offsets as given. Raises Refusal."""
    bar(m)
    offset = m.tool_offset[:]
    for i, letter in NUMBERED_NINE:
        if letter in w:
            offset[i] = m.axis(w, i)
    put_offset(m, offset)


def added_length(m: State, w: Words) -> None:
    """G43.2: a tool's offset on top of that in force. Raises Refusal."""
    bar(m)
    if any(letter in w for _, letter in NUMBERED_NINE):
        raise wrong("G43.2 takes no axis words", "its offset is that of the tool H")
    if "h" not in w:
        raise wrong("G43.2 needs H")
    put_offset(m, [a + b for a, b in zip(m.tool_offset, of_tool(m, w), strict=True)])


def no_length(m: State, w: Words) -> None:
    """G49. Raises Refusal."""
    bar(m)
    put_offset(m, [0.0] * 9)


length = partial(Code, group=Group.TOOL_LENGTH, order=Order.TOOL_LENGTH)

CODES = (
    Code("M6", "Change the tool", change, Group.TOOL, Order.TOOL_CHANGE),
    Code("M61", "Declare the tool", declare, Group.TOOL, Order.TOOL_CHANGE, takes="q"),
    length("G43", "Tool length", tool_length, takes="h"),
    length("G43.1", "Tool length as given", dynamic_length, axes=True),
    length("G43.2", "Tool length added", added_length, takes="h@^"),
    length("G49", "No tool length", no_length),
)


def put_again(m: State, w: Words) -> None:
    """What RETAIN_G43 does beside a tool change: the length of the tool in the spindle."""
    tool_length(m, {})


LENGTH = next(row for row in CODES if row.name == "G43")
AGAIN = Code("G43", "Tool length, again", put_again, Group.TOOL_LENGTH, Order.TOOL_CHANGE)


def retained(codes: Sequence[Code]) -> tuple[Code, ...]:
    """The codes of a block under [RS274NGC]RETAIN_G43 while a length is in force.

    Every block puts it again, twice, and whatever code of its group the block has is taken for G43.
    """
    rows = [row for row in codes if not row.group & Group.TOOL_LENGTH]
    return tuple(sorted([*rows, AGAIN, LENGTH], key=lambda row: row.order))


ITEMS = (Code("T", "Tool that the next change loads", select_tool, Group(0), Order.TOOL),)
