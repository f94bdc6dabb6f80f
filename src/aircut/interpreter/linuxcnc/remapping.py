"""Codes that an INI file remaps to subroutines.

Such a code runs in its place among the others of its block, with words of the block as named locals; a code
that stands in its own subroutine is the built-in one. Behavior was learnt by asking `rs274 -i`.
"""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, NoReturn

from aircut.diagnostics import Refusal
from aircut.diagnostics import faults as F
from aircut.interpreter.linuxcnc.arranging import given
from aircut.interpreter.linuxcnc.blocks import LETTERS
from aircut.interpreter.linuxcnc.motion import wrong
from aircut.interpreter.linuxcnc.state import State
from aircut.interpreter.table import Code, Dialect, Group, Order, Words
from aircut.machine.config import MachineError
from aircut.machine.remaps import ANY_M, BUILT_IN, Remap

if TYPE_CHECKING:
    from aircut.interpreter.linuxcnc.interpreter import Interpreter

DEEPEST = 9
INVERSE_TIME = 93
#: A code of each modal group that has some; group 10 has none.
MEMBERS = {4: "m0", 5: "m62", 6: "m6", 7: "m3", 8: "m9", 9: "m48"}
TAKES = "".join(sorted(LETTERS - set("@^")))


def extended(dialect: Dialect, remaps: tuple[Remap, ...]) -> Dialect:
    """The language with these codes, but for those that no remap changes. Raises MachineError for one that breaks."""
    if not remaps:
        return dialect
    codes, items = dict(dialect.codes), dict(dialect.items)
    for remap in remaps:
        table = items if remap.group == 0 else codes
        known = table.get(remap.code)
        if possible(remap, known):
            table[remap.code] = row_of(remap, known, dialect)
        elif known is not None and known.group is not group_of(remap, dialect)[0]:
            raise MachineError(f"[RS274NGC]REMAP: LinuxCNC lets no remap of {remap.code.upper()} come into force")
    return dialect._replace(codes=codes, items=items)


def idle(remaps: tuple[Remap, ...], dialect: Dialect) -> list[str]:
    """The codes among them that stay as they are."""
    known = dialect.codes
    return [remap.code.upper() for remap in remaps if not possible(remap, known.get(remap.code))]


def possible(remap: Remap, known: Code | None) -> bool:
    if remap.code[0] == "m":
        number = int(remap.code[1:]) if remap.code[1:].isdecimal() else -1
        return remap.code in BUILT_IN or ANY_M[0] <= number <= ANY_M[1] or (known is None and 0 <= number < 98)
    return remap.group == 0 or known is None


def row_of(remap: Remap, known: Code | None, dialect: Dialect) -> Code:
    if remap.group == 0:
        assert known is not None
        group, order = known.group, known.order
    else:
        group, order = group_of(remap, dialect)
    run = partial(refuse, remap) if remap.python else partial(start, remap, known)
    title = f"O<{remap.label}>" if remap.label else remap.python
    return Code(remap.code.upper(), title, run, group, order, axes=remap.code[0] == "g", takes=TAKES)


def group_of(remap: Remap, dialect: Dialect) -> tuple[Group, Order]:
    """The group that a G or M code is put into, and its place."""
    if remap.group in MEMBERS:
        member = dialect.codes[MEMBERS[remap.group]]
        return member.group, member.order
    return (Group.MOTION, Order.MOTION) if remap.code[0] == "g" else (Group.USER, Order.USER)


def refuse(remap: Remap, m: State, w: Words) -> NoReturn:
    """Raises Refusal."""
    raise Refusal(F.PYTHON_REMAP, code=remap.code.upper(), option=remap.python)


def start(remap: Remap, known: Code | None, m: State, w: Words) -> None:
    """Run the code: its subroutine, or what is built in, as the F of inverse time always is. Raises Refusal."""
    built_in = remap.code in m.remaps or (remap.code == "f" and m.feed_mode == INVERSE_TIME)
    if known is None or not built_in:
        m.transfer = partial(enter, remap, w)
        return
    for letter in known.needs:
        if not given(w, letter):
            raise Refusal(F.MISSING_WORD, code=known.name, word=letter.upper(), meaning="")
    if known.check is not None:
        known.check(m, w)
    known.run(m, w)


def enter(remap: Remap, w: Words, run: Interpreter) -> bool:
    """Go into the subroutine; what is left of the block waits until it comes back. Raises Refusal."""
    m = run.state
    if len(m.remaps) >= DEEPEST:
        raise Refusal(F.TOO_DEEP, limit=DEEPEST, what="remapped codes")
    values, named = arguments(remap, m, w)
    rest = run.rest
    run.flow.enter(remap.label, values, 1)
    m.scope |= named
    m.remaps = (*m.remaps, remap.code)
    run.flow.stack[-1] = run.flow.stack[-1]._replace(rest=rest)
    return True


def arguments(remap: Remap, m: State, w: Words) -> tuple[tuple[float, ...], dict[str, float]]:
    """The values of numbered and of named locals. Raises Refusal where one that is needed is missing."""
    found: dict[str, float] = {}
    for letter in remap.arguments:
        if letter in ">^" and (m.gave_feed if letter == ">" else m.speed) <= 0.0:
            raise wrong(f"{remap.code.upper()} needs {'F' if letter == '>' else 'S'} above zero")
        name = letter.lower()
        if name == "n":
            found[name] = float(m.line)
        elif name in w:
            found.setdefault(name, w[name] / 2.0 if name == "x" and m.diameter else w[name])
        elif letter.isupper():
            raise Refusal(F.MISSING_WORD, code=remap.code.upper(), word=letter, meaning=f"O<{remap.label}> asks for it")
    return (tuple(found.values()), {}) if "@" in remap.arguments else ((), found)


def resume(run: Interpreter, rest: object) -> None:
    """Carry out what is left of the block that the subroutine stood in. Raises Refusal."""
    m = run.state
    m.remaps = m.remaps[:-1]
    run.line = run.next_line - 1
    m.line = m.out.line = run.next_line
    run.perform(*rest)  # type: ignore[misc]
