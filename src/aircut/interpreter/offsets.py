"""Work offsets: G10 L2 and L20, G52, G54 to G59.3, G92.

Sources: 000 sections 1.1, 8.1.3; decisions AMB-COD-15, AMB-VAR-19, AMB-XF-11 to AMB-XF-14.
"""

from __future__ import annotations

from functools import partial

from aircut.diagnostics import Refusal
from aircut.diagnostics import faults as F
from aircut.interpreter.arranging import meaning
from aircut.interpreter.modes import comment
from aircut.interpreter.motion import NUMBERED_AXES
from aircut.interpreter.state import WORK_SYSTEMS, State, out_of_range, whole
from aircut.interpreter.table import Code, Group, Order, Words


def values(m: State, w: Words) -> dict[int, float]:
    """The axis words by axis number, mm and degrees."""
    return {i: w[axis] * (m.unit if i < 3 else 1.0) for i, axis in NUMBERED_AXES if axis in w}


def tell_system(m: State) -> None:
    m.out.event("SET_G5X_OFFSET", m.system + 1, *m.origins[m.system])


def tell_shift(m: State) -> None:
    m.out.event("SET_G92_OFFSET", *m.told_shift())


def tell_rotation(m: State) -> None:
    m.out.event("SET_XY_ROTATION", 0.0)


def select(number: int, m: State, w: Words) -> None:
    """G54 to G59.3."""
    if number == m.system:
        comment(m, "continuing to use same coordinate system")
        return
    m.system = number
    m.add_offsets()
    tell_system(m)
    tell_shift(m)
    tell_rotation(m)


def local_shift(m: State, w: Words) -> None:
    """G52: a shift on top of every work system."""
    for i, value in values(m, w).items():
        m.local[i] = value
    m.add_offsets()
    tell_shift(m)


def set_position(m: State, w: Words) -> None:
    """G92: shift so that the present position reads as given."""
    shift = list(m.shift) if m.shifted else [0.0] * 6
    for i, value in values(m, w).items():
        shift[i] += m.position[i] - value
    m.shift = shift
    m.shifted = True
    m.add_offsets()
    tell_shift(m)


def clear_shift(m: State, w: Words) -> None:
    """G92.1: the shift becomes zero; whether it is on stays."""
    m.shift = [0.0] * 6
    m.add_offsets()
    tell_shift(m)


def switch_shift(on: bool, m: State, w: Words) -> None:
    """G92.2, G92.3: off, and on again with the values kept."""
    m.shifted = on
    m.add_offsets()
    tell_shift(m)


def set_data(m: State, w: Words) -> None:
    """G10: what is set depends on L."""
    row = m.dialect.settings.get(whole(w, "l"))
    if row is None:
        raise Refusal(F.UNKNOWN_PARAMETER, "l", l=w["l"])
    for letter in w:
        if letter not in "lfst" and letter not in row.takes and not (row.axes and letter in "xyzabc"):
            raise Refusal(F.UNUSED_WORD, letter, word=letter.upper())
    for letter in row.needs:
        if letter not in w:
            raise Refusal(F.MISSING_WORD, code=row.name, word=letter.upper(), meaning=meaning(row.name, letter))
    row.run(m, w)


def system_of(m: State, w: Words) -> int:
    """The work system of the P word, from 0; P0 is the active one. Raises Refusal."""
    number = whole(w, "p")
    if not 0 <= number <= WORK_SYSTEMS:
        raise out_of_range(w, "p", "work systems are 1 to 9, and 0 is the active one")
    return number - 1 if number else m.system


def changed(m: State, number: int) -> None:
    """Tell of a new origin."""
    if number == m.system:
        m.add_offsets()
        tell_system(m)
        tell_rotation(m)
    else:
        comment(m, "setting coordinate system origin")


def set_origin(m: State, w: Words) -> None:
    """G10 L2 P: the origin of a work system, in machine coordinates."""
    number = system_of(m, w)
    for i, value in values(m, w).items():
        m.origins[number][i] = value
    changed(m, number)


def calculate_origin(m: State, w: Words) -> None:
    """G10 L20 P: the origin that makes the present position read as given."""
    number = system_of(m, w)
    machine = [p + o for p, o in zip(m.position, m.offset, strict=True)]
    shift = m.told_shift()
    for i, value in values(m, w).items():
        m.origins[number][i] = machine[i] - shift[i] - value
    changed(m, number)


single = partial(Code, group=Group.NON_MODAL, order=Order.NON_MODAL)
SYSTEMS = ("G54", "G55", "G56", "G57", "G58", "G59", "G59.1", "G59.2", "G59.3")

CODES = (
    *(
        Code(name, f"Work system {i + 1}", partial(select, i), Group.SYSTEM, Order.SYSTEM, modal=True)
        for i, name in enumerate(SYSTEMS)
    ),
    single("G10", "Set data", set_data, takes="lprdqijkv", needs="l", axes=True),
    single("G52", "Local shift", local_shift, axes=True, needs_axes=True),
    single("G92", "Shift so that the position reads as given", set_position, axes=True, needs_axes=True),
    single("G92.1", "Clear the G92 shift", clear_shift),
    single("G92.2", "Suspend the G92 shift", partial(switch_shift, False)),
    single("G92.3", "Resume the G92 shift", partial(switch_shift, True)),
)

SETTINGS = {
    2: single("G10 L2", "Origin of a work system", set_origin, takes="p", needs="p", axes=True),
    20: single("G10 L20", "Origin of a work system, from the position", calculate_origin,
               takes="p", needs="p", axes=True),
}  # fmt: skip
