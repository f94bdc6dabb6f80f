"""What compiled loops and subroutines are made of: their values, and the modes that straight moves need.

See `weaving`.
"""

from __future__ import annotations

from collections.abc import Callable
from struct import Struct
from typing import TYPE_CHECKING, Any, NamedTuple

from aircut.canon import ROW
from aircut.diagnostics import Refusal
from aircut.interpreter.compiling import FAILURES, Writer
from aircut.interpreter.path import RECORDER
from aircut.interpreter.table import Dialect, Group
from aircut.interpreter.unit import Statement, Unit, takes_arguments
from aircut.language.blocks import Word
from aircut.language.expressions import Binary, Expression, Name, Number, Text

if TYPE_CHECKING:
    from aircut.interpreter.interpreter import Interpreter
    from aircut.interpreter.state import State
    from aircut.language.structure import Routine

#: Relations written out: null counts as 0.
RELATIONS = {"lt": "<", "le": "<=", "gt": ">", "ge": ">="}
LINEAR_PLACE = Struct("<3d")  # X Y Z, the beginning of a row
FAR = 1e9  # as the general lane's
#: What ends a function early: the general lane runs that line, and says what is wrong with it.
EVALUATION = (*FAILURES, Refusal, KeyError)
#: What a function returns: the line to go on with, and whether all before it is done; else that line is given back.
Place = tuple[int, bool]
DONE: Place = (-1, True)  # of a subroutine that has come back to its caller
ASKED = object()  # the modes are to be asked for

Loom = Callable[["Interpreter"], Place]


class Callee(NamedTuple):
    """A subroutine compiled whole."""

    run: Loom
    unit: Unit
    routine: Routine


#: What straight moves need to know: absolute, mm a program unit; lowest and highest X, then Y, Z, in the program's
#: frame; the offset of X Y Z; and what a `template` takes. It is asked for again behind codes that may change it.
Modes = tuple[Any, ...]


def template(rest: tuple[Any, ...], line: int, kind: int, file: int) -> bytearray:
    """The row of a straight move but for X Y Z. rest: places of A B C, mm/min of a feed move, tool, plane, flags."""
    a, b, c, speed, tool, plane, flags = rest
    return bytearray(
        ROW.pack(0.0, 0.0, 0.0, a, b, c, 0.0, 0.0, speed if kind else 0.0, line, tool, 0, file, kind, plane, flags)
    )


def modes(m: State) -> Modes | None:
    """The modes, if a straight move leads just from words to a row under them."""
    if (
        m.way is not RECORDER or m.frame is not None or m.macro is not None or m.compensating or m.polar
        or m.inverse_time or m.surface_feed or m.exact_stop or m.machine_frame or m.indexers or m.feed <= 0.0
        or m.motion is not m.modal.get(Group.MOTION)
    ):  # fmt: skip
        return None
    x, y, z, a, b, c = m.position
    lx, hx, ly, hy, lz, hz, la, ha, lb, hb, lc, hc = m.box
    if not (lx <= x <= hx and ly <= y <= hy and lz <= z <= hz and la <= a <= ha and lb <= b <= hb and lc <= c <= hc):
        return None
    ox, oy, oz, oa, ob, oc = m.offset
    rest = (a + oa, b + ob, c + oc, m.feed, m.tool, m.plane, m.flags)
    return (m.absolute, m.unit, *(min(max(limit, -FAR), FAR) for limit in m.box[:6]), ox, oy, oz, rest)


class Values(Writer):
    """Writes expressions; names of the program's own are looked up at once."""

    def expression(self, node: Expression | Text) -> tuple[str, int]:
        if isinstance(node, Name) and (name := plain_name(node)) is not None and name not in self.dialect.named:
            return f"{scope_of(name, self.dialect)}[{name!r}]", 0
        return super().expression(node)

    def chain(self, node: Binary) -> tuple[str, int]:
        relation = RELATIONS.get(node.operator.name)
        if relation is None or isinstance(node.left, Binary):
            return super().chain(node)
        sides = [self.checked(side) for side in (node.left, node.right)]
        left, right = (
            text if isinstance(side, Number) else f"({text} or 0.0)"
            for side, (text, _) in zip((node.left, node.right), sides, strict=True)
        )
        return self.step(f"(1.0 if {left} {relation} {right} else 0.0)", max(depth for _, depth in sides) + 1)


def plain_name(node: Name) -> str | None:
    """The text of a name without indexes."""
    parts = [part for part in node.parts if isinstance(part, str)]
    return "".join(parts) if len(parts) == len(node.parts) else None


def scope_of(name: str, dialect: Dialect) -> str:
    return "S" if name.startswith("_") == dialect.local_underscore else "N"


def kept_words(statement: Statement, dialect: Dialect) -> list[Word]:
    """The words that are not codes with literal numbers, as Statement.letters has them."""
    macro = takes_arguments(statement.block, dialect)
    return [
        word
        for word in statement.block.words
        if not (isinstance(word.value, Number) and (word.letter == "g" or (word.letter == "m" and not macro)))
    ]
