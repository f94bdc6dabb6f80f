"""Work systems, G92 and G52, and G10 of LinuxCNC's language.

Sources: 001; the canonical listing, sections 2 and 10.
"""

from __future__ import annotations

from functools import partial
from math import inf

from msgspec.structs import replace

from aircut.diagnostics import Refusal
from aircut.diagnostics import faults as F
from aircut.interpreter.linuxcnc.arranging import given
from aircut.interpreter.linuxcnc.modes import said
from aircut.interpreter.linuxcnc.motion import wrong
from aircut.interpreter.linuxcnc.state import G92, NUMBERED_NINE, ORIGINS, STEP, SYSTEM, State
from aircut.interpreter.linuxcnc.turning import check_turns
from aircut.interpreter.table import Code, Group, Order, Words
from aircut.language.arithmetic import EQUAL, round_half_away

SYSTEMS = 9


def tell_system(m: State) -> None:
    if m.auxiliary:
        m.out.event("AUXILIARY_OFFSETS", *m.origin[6:])
    m.out.event("SET_G5X_OFFSET", m.system + 1, *m.origin[:6])


def tell_rotation(m: State) -> None:
    m.out.event("SET_XY_ROTATION", m.rotation)


def tell_shift(m: State) -> None:
    if m.auxiliary:
        m.out.event("AUXILIARY_OFFSETS", *m.shift[6:])
    m.out.event("SET_G92_OFFSET", *m.shift[:6])


def select(system: int, m: State, w: Words) -> None:
    """G54 to G59.3. Raises Refusal."""
    if m.cutter:
        raise Refusal(F.UNDER_COMPENSATION, what="another work system")
    if system == m.system:
        said(m, "continuing to use same coordinate system")
        return
    m.system = system
    m.numbered[SYSTEM] = system + 1.0
    m.load_system()
    if m.numbered[G92]:  # the position reads by G92's parameters, even where the program has set them since
        m.position = [p + s - n for p, s, n in zip(m.position, m.shift, m.stored(G92 + 1), strict=True)]
    tell_system(m)
    tell_shift(m)
    tell_rotation(m)


def shift_of(m: State) -> None:
    """Remember the axis offset."""
    m.store(G92 + 1, m.shift)


def bar_shift(m: State) -> None:
    if m.cutter:
        raise Refusal(F.UNDER_COMPENSATION, what="an axis offset")


def set_here(m: State, w: Words) -> None:
    """G92: the present position reads as given. Raises Refusal."""
    bar_shift(m)
    check_turns(m, w)
    shift = m.shift[:]
    for i, letter in NUMBERED_NINE:
        if letter in w:
            shift[i] = m.position[i] + shift[i] - m.axis(w, i)
    put_shift(m, shift)
    for i, letter in NUMBERED_NINE:
        if letter in w:
            m.position[i] = m.axis(w, i)  # to the last bit


def set_local(m: State, w: Words) -> None:
    """G52: the offset itself. Raises Refusal."""
    bar_shift(m)
    check_turns(m, w)
    shift = m.shift[:]
    for i, letter in NUMBERED_NINE:
        if letter in w:
            shift[i] = m.axis(w, i)
    put_shift(m, shift)


def put_shift(m: State, shift: list[float]) -> None:
    m.set_shift(shift)
    tell_shift(m)
    m.numbered[G92] = 1.0
    shift_of(m)


def clear_shift(forget: bool, m: State, w: Words) -> None:
    """G92.1 (forgets the offset), G92.2. While compensation is on LinuxCNC passes them over."""
    if m.cutter:
        return
    m.set_shift([0.0] * 9)
    tell_shift(m)
    m.numbered[G92] = 0.0
    if forget:
        shift_of(m)


def restore_shift(m: State, w: Words) -> None:
    """G92.3. While compensation is on LinuxCNC passes it over."""
    if m.cutter:
        return
    m.set_shift(m.stored(G92 + 1))
    tell_shift(m)
    m.numbered[G92] = 1.0


def settings(m: State, w: Words) -> None:
    """G10: its L says what. Raises Refusal."""
    setting_of(m, w).run(m, w)


def setting_of(m: State, w: Words) -> Code:
    """The row of G10's L number, its words checked. Raises Refusal."""
    row: Code | None = m.dialect.settings.get(int(w["l"])) if "l" in w else None
    if row is None:
        raise Refusal(F.UNKNOWN_PARAMETER, "l", l=w.get("l", -1.0))
    for letter in row.needs:
        if letter not in w:
            raise Refusal(F.MISSING_WORD, code=row.name, word=letter.upper(), meaning="")
    if int(w["l"]):
        unused(w, "@^")
    return row


def unused(w: Words, letters: str) -> None:
    """Raises Refusal where one of these words is given."""
    for letter in letters:
        if letter in w:
            raise Refusal(F.UNUSED_WORD, letter, word=letter.upper())


def check_settings(m: State, w: Words) -> None:
    """G10's L and P, of which all of a block must be right before any of it runs. Raises Refusal."""
    row = setting_of(m, w)
    if row.check:
        row.check(m, w)


def check_number(low: float, high: float, wanted: str, m: State, w: Words) -> None:
    """G10's P: what is above a whole number is a fault, what is below it by less than a half LinuxCNC rounds.
    Raises Refusal.
    """
    value = w.get("p", 0.0)
    number = round_half_away(value)
    if value - number > EQUAL or not low <= number <= high:
        raise Refusal(F.BAD_VALUE, "p", word="P", value=value, wanted=wanted)


def set_system(here: bool, m: State, w: Words) -> None:
    """G10 L2: origin and rotation as given; L20: so that the present position reads as given. Raises Refusal."""
    unused(w, "ijr" if here else "ij")
    number = int(w["p"] + EQUAL)
    system = number - 1 if number else m.system
    if m.cutter and system == m.system:
        raise Refusal(F.UNDER_COMPENSATION, what="G10 on the active system")
    first = ORIGINS + STEP * system
    if "r" in w:
        m.numbered[first + 9] = w["r"]
    rotation = m.numbered[first + 9]
    if here:
        check_turns(m, w)
        store_here(m, w, first, rotation)
    else:
        for i, letter in NUMBERED_NINE:
            if letter in w:
                m.numbered[first + i] = m.to_kept(m.axis(w, i), i)
    if system == m.system:
        turned = rotation != m.rotation
        moved = m.position[:]
        moved[0], moved[1] = m.turned(moved[0], moved[1], m.rotation)
        moved = [p + o for p, o in zip(moved, m.origin, strict=True)]
        m.load_system()
        #: LinuxCNC forgets here that G92's offset turns too: the machine's position does not stay.
        if not here or turned or m.rotation == 0.0:
            moved = [p - o for p, o in zip(moved, m.origin, strict=True)]
            moved[0], moved[1] = m.turned(moved[0], moved[1], -m.rotation)
            m.position = moved
        tell_system(m)
        tell_rotation(m)
    else:
        said(m, "setting coordinate system origin")


def stored_shift(m: State) -> list[float]:
    """The offset of G92 and G52 as the parameters have it: a program may have changed them since."""
    return m.stored(G92 + 1) if m.numbered[G92] else [0.0] * 9


def store_here(m: State, w: Words, first: int, rotation: float) -> None:
    """Origins from which the present position reads as given; X and Y are solved in the rotated frame."""
    space = m.to_space(m.guided())
    origin = m.stored(first)
    shift = stored_shift(m)
    reads = [p - o for p, o in zip(space, origin, strict=True)]
    reads[0], reads[1] = m.turned(reads[0], reads[1], -rotation)
    for i, letter in NUMBERED_NINE:
        if letter in w:
            reads[i] = m.axis(w, i) + shift[i]
    reads[0], reads[1] = m.turned(reads[0], reads[1], rotation)
    for i, letter in NUMBERED_NINE:
        if letter in w or (i < 2 and rotation and ("x" in w or "y" in w)):
            m.numbered[first + i] = m.to_kept(space[i] - reads[i], i)


def reload_tools(m: State, w: Words) -> None:
    """G10 L0. What G10 L1 has set is in the table as well, and stays. Raises Refusal."""
    if m.slots[0].id > 0:
        raise wrong("G10 L0 is not possible with a tool in the spindle", "program T0 M6 before")
    m.out.event("RELOAD_TOOLDATA")
    m.stale = True


def set_tool(kind: int, m: State, w: Words) -> None:
    """G10 L1: offsets as given; L10, L11: so that the present position reads as given. Raises Refusal."""
    if not any(letter in w for letter in "xyzabcuvwrijq"):
        raise Refusal(F.MISSING_WORD, code="G10 L1", word="an offset", meaning="")
    slot = m.slot_of(int(round_half_away(w["p"])))
    tool = m.slots[slot]
    if given(w, "q") and (abs(w["q"] - round(w["q"])) >= EQUAL or not 0 <= round(w["q"]) <= 9):
        raise Refusal(F.BAD_VALUE, "q", word="Q", value=w["q"], wanted="an orientation, 0 to 9")
    changes: dict[str, float] = {}
    if kind == 1:
        changes = {letter: m.axis(w, i) for i, letter in NUMBERED_NINE if letter in w}
    elif named := [i for i, letter in NUMBERED_NINE if letter in w]:
        offsets = tool_of_reading(kind, m, w, named, tool.offsets())
        changes = {letter: offsets[i] for i, letter in NUMBERED_NINE if i in named or (i < 2 and min(named) < 2)}
    if "r" in w:
        changes["diameter"] = 2.0 * m.length(w, "r")
    changes |= {field: w[letter] for letter, field in (("i", "p1"), ("j", "p2")) if letter in w}
    if given(w, "q"):
        changes["p3"] = float(round(w["q"]))
    tool = m.slots[slot] = replace(tool, **changes)
    tell_tool(m, slot)
    if slot == m.slot and not m.ini.random:
        m.slots[0] = tool
        tell_tool(m, 0)
        m.show_tool()


def tool_of_reading(kind: int, m: State, w: Words, named: list[int], offsets: list[float]) -> list[float]:
    """Offsets of a tool with which the present position reads as the words say: in the active system (L10), or in
    G59.3 without G92 (L11); the system is that of the parameters. X and Y are those along the system's axes.
    """
    first = ORIGINS + STEP * (m.system if kind == 10 else SYSTEMS - 1)
    shift = stored_shift(m) if kind == 10 else [0.0] * 9
    angle = m.numbered[first + 9]
    place, used, kept = (
        [*m.turned(values[0], values[1], -angle), *values[2:]]
        for values in (
            [s - o for s, o in zip(m.to_space(m.guided()), m.stored(first), strict=True)],
            m.tool_offset,
            offsets,
        )
    )
    for i in named:
        kept[i] = place[i] - shift[i] + used[i] - m.axis(w, i)
    return [*m.turned(kept[0], kept[1], angle), *kept[2:]]


def tell_tool(m: State, slot: int) -> None:
    tool = m.slots[slot]
    m.out.event("STORE_TOOL", slot, tool.id, *tool.offsets(), tool.p1, tool.p2, int(tool.p3))


single = partial(Code, group=Group.NON_MODAL, order=Order.NON_MODAL)
shift = partial(Code, group=Group.SHIFT, order=Order.SHIFT)
setting = partial(Code, group=Group.NON_MODAL, order=Order.NON_MODAL)
check_any = partial(check_number, -inf, inf, "a whole number")
check_system = partial(check_number, 0, SYSTEMS, "a work system, 0 to 9")
check_tool = partial(check_number, 1, inf, "a tool's number")
SYSTEM_NAMES = ("G54", "G55", "G56", "G57", "G58", "G59", "G59.1", "G59.2", "G59.3")

CODES = (
    *(Code(name, "Work system", partial(select, i), Group.SYSTEM, Order.SYSTEM) for i, name in enumerate(SYSTEM_NAMES)),
    single("G10", "Set offsets or tools", settings, axes=True, takes="lpijqr", check=check_settings),
    single("G52", "Local offset", set_local, axes=True, needs_axes=True),
    single("G92", "Let the position read as given", set_here, axes=True, needs_axes=True),
    shift("G92.1", "Clear and forget G92", partial(clear_shift, True)),
    shift("G92.2", "Suspend G92", partial(clear_shift, False)),
    shift("G92.3", "Restore G92", restore_shift),
)

SETTINGS = {
    0: setting("G10 L0", "Reload the tool table", reload_tools, check=check_any),
    1: setting("G10 L1", "Set a tool's offsets", partial(set_tool, 1), takes="prijq", needs="p", check=check_tool),
    2: setting("G10 L2", "Set a work system", partial(set_system, False), takes="pqr", needs="p", check=check_system),
    10: setting(
        "G10 L10", "Set a tool by the position", partial(set_tool, 10), takes="prijq", needs="p", check=check_tool
    ),
    11: setting(
        "G10 L11",
        "Set a tool by the position in G59.3",
        partial(set_tool, 11),
        takes="prijq",
        needs="p",
        check=check_tool,
    ),
    20: setting(
        "G10 L20",
        "Set a work system by the position",
        partial(set_system, True),
        takes="pq",
        needs="p",
        check=check_system,
    ),
}
