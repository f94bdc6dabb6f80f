"""What compiled loops and subroutines are made of: their values, and the modes that straight moves need.

See `weaving`.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple

from aircut.interpreter.linuxcnc import blocks
from aircut.interpreter.linuxcnc.blocks import BRACKETS
from aircut.interpreter.linuxcnc.state import ARGUMENTS, FAULTS
from aircut.interpreter.path import RECORDER
from aircut.language.arithmetic import LARGEST
from aircut.language.expressions import Application, Binary, Expression, Name, Text

if TYPE_CHECKING:
    from aircut.interpreter.linuxcnc.files import Text as Program
    from aircut.interpreter.linuxcnc.interpreter import Interpreter
    from aircut.interpreter.linuxcnc.state import State

#: Relations written out.
RELATIONS = {"lt": "<", "le": "<=", "gt": ">", "ge": ">="}

#: What straight moves need to know: absolute, mm a program unit; lowest and highest X, then Y, Z, in space; shift
#: and origin of X Y Z; and what a template takes (see the house's `looms`).
Modes = tuple[Any, ...]
ASKED: Modes = (None,)  # the modes are to be asked for
NEITHER: Modes = ()  # straight moves ask for more


class Loom(NamedTuple):
    """A compiled loop or subroutine."""

    run: Callable[[Interpreter, Modes], Modes | None]
    sub: str  # that it stands in
    first: int  # line that it begins with, from 0
    text: Program


def modes(run: Interpreter) -> Modes:
    """The modes, if a straight move leads just from words to a row under them."""
    m = run.state
    if (
        m.way is not RECORDER or m.feed_mode != 94 or m.diameter or m.rotation != 0.0 or m.arc_refused
        or m.gave_feed <= 0.0 or not m.ini.plain or m.plane_code % 10
        or (m.auxiliary and m.to_space(m.position)[6:] != m.led)
    ):  # fmt: skip
        return NEITHER
    box = m.space_box
    space = m.to_space(m.position)
    if not all(box[2 * i] <= space[i] <= box[2 * i + 1] for i in range(6)):
        return NEITHER
    rest = (*space[3:6], m.gave_feed * m.unit, m.tool, m.plane, m.flags)
    return (m.absolute, m.unit, *box[:6], *m.shift[:3], *m.origin[:3], rest)


def steady(m: State) -> bool:
    """Whether blocks begin without more ado."""
    return not (m.stale or m.numbered[FAULTS[0]] or m.numbered[FAULTS[1]])


def fail() -> float:
    """A value that the general lane is to look into."""
    raise ValueError


class Values(blocks.Writer):
    """Writes expressions; names of the program's own are looked up at once."""

    def __init__(self, m: State) -> None:
        super().__init__(m.dialect)
        self.m = m
        self.guards = 0

    def expression(self, node: Expression | Text) -> tuple[str, int]:
        if isinstance(node, Name) and own_name(self.m, str(node.parts[0])):
            name = str(node.parts[0])
            return f"{'S' if self.m.is_local(name) else 'N'}[{name!r}]", 0
        if isinstance(node, Application) and node.function is BRACKETS:
            text, depth = self.checked(node.arguments[0])
            return self.guarded(text, depth)
        return super().expression(node)

    def checked(self, node: Expression | Text) -> tuple[str, int]:
        text, depth = self.expression(node)
        if isinstance(node, Application) and node.function.arguments != "name" and node.function is not BRACKETS:
            return self.guarded(text, depth)
        return text, depth

    def guarded(self, text: str, depth: int) -> tuple[str, int]:
        self.guards += 1
        name = f"q{self.guards}"
        return self.step(f"({name} if -{LARGEST!r} <= ({name} := {text}) <= {LARGEST!r} else fail())", depth + 1)

    def chain(self, node: Binary) -> tuple[str, int]:
        relation = RELATIONS.get(node.operator.name)
        if relation is None or isinstance(node.left, Binary):
            return super().chain(node)
        left, depth = self.checked(node.left)
        right, other = self.checked(node.right)
        return self.step(f"(1.0 if {left} {relation} {right} else 0.0)", max(depth, other) + 1)


def own_name(m: State, name: str) -> bool:
    """Whether a name is the program's: nothing else gives it a value."""
    return (
        name not in m.dialect.named and m.ini.named(name) is None and not (name == ARGUMENTS and m.ini.counts_arguments)
    )
