"""Parsed blocks turned into Python functions, and faults in them found again.

A block's expressions become one Python function that computes all values at
once. When it fails, `explain` walks the same nodes one by one with the operators'
and functions' own rows, and so finds which one failed and why: the walk is the
meaning, the function is the fast way to it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, NoReturn

from aircut.diagnostics import Refusal
from aircut.diagnostics import faults as F
from aircut.interpreter.state import State
from aircut.interpreter.table import Dialect
from aircut.language.arithmetic import FUNCTIONS, OPERATORS, finite
from aircut.language.blocks import Block
from aircut.language.expressions import (
    Application,
    Binary,
    Expression,
    Name,
    Number,
    Parameter,
    Sign,
    Text,
    Variable,
)

Values = Sequence[float]
#: What the generated code may raise where a value is null or out of reach.
FAILURES = (TypeError, ValueError, OverflowError, ZeroDivisionError)

ENVIRONMENT: dict[str, Any] = {
    "finite": finite,
    "inf": float("inf"),
    **{operator.run.__name__: operator.run for operator in OPERATORS},
    **{f"f_{function.name}": function.run for function in FUNCTIONS},
}
NESTING = 30  # parentheses in one Python expression; Python's own limit is 200


class Writer:
    """Writes one Python function. Deep expressions are cut into steps of their own."""

    def __init__(self, dialect: Dialect) -> None:
        self.dialect = dialect
        self.steps: list[str] = []

    def write(self, node: Expression | Text) -> str:
        """Python text of an expression's value, checked to be finite where it is computed."""
        text, _ = self.checked(node)
        return text

    def checked(self, node: Expression | Text) -> tuple[str, int]:
        text, depth = self.expression(node)
        computed = isinstance(node, Application) and node.function.arguments != "name"
        if computed or (isinstance(node, Binary) and node.operator.inline):
            return f"finite({text})", depth + 1
        return text, depth

    def step(self, text: str, depth: int) -> tuple[str, int]:
        if depth < NESTING:
            return text, depth
        name = f"t{len(self.steps)}"
        self.steps.append(f"    {name} = {text}")
        return name, 0

    def expression(self, node: Expression | Text) -> tuple[str, int]:
        match node:
            case Number():
                return repr(node.value), 0
            case Parameter():
                return f"k[{node.nth}]", 0
            case Text():
                return repr(node.text), 0
            case Variable():
                return self.variable(node)
            case Name():
                return f"m.read_name({self.name(node)})", 1
            case Sign():
                text, depth = self.checked(node.operand)
                return self.step(f"({'-' if node.negative else '+'}{text})", depth + 1)
            case Binary():
                return self.chain(node)
            case Application():
                if node.function.arguments == "name":
                    assert isinstance(node.arguments[0], Name)
                    return f"f_{node.function.name}(m.exists({self.name(node.arguments[0])}))", 2
                parts = [self.checked(argument) for argument in node.arguments]
                inner = ", ".join(text for text, _ in parts)
                return self.step(f"f_{node.function.name}({inner})", max(depth for _, depth in parts) + 1)
        raise AssertionError(node)

    def chain(self, node: Binary) -> tuple[str, int]:
        """A chain of operators: its left side is followed down in a loop, for it may be long."""
        nodes = [node]
        while isinstance(nodes[-1].left, Binary):
            nodes.append(nodes[-1].left)
        text, depth = self.checked(nodes[-1].left)
        while nodes:
            link = nodes.pop()
            operator = link.operator
            if operator.inline:
                right, other = self.expression(link.right)
                text, depth = self.step(f"({text} {operator.name} {right})", max(depth, other) + 1)
                if nodes and not nodes[-1].operator.inline:
                    text = f"finite({text})"
            else:
                right, other = self.checked(link.right)
                text, depth = self.step(f"{operator.run.__name__}({text}, {right})", max(depth, other) + 1)
        return text, depth

    def variable(self, node: Variable) -> tuple[str, int]:
        if isinstance(node.number, Number) and node.number.value == int(node.number.value):
            number = int(node.number.value)
            if 1 <= number <= 33:
                return f"L[{number}]", 0
            if any(row.first <= number <= row.last for row in self.dialect.ranges):
                return f"V[{number}]", 0
        text, depth = self.checked(node.number)
        return self.step(f"m.read({text})", depth + 1)

    def name(self, node: Name) -> str:
        if all(isinstance(part, str) for part in node.parts):
            return repr("".join(part for part in node.parts if isinstance(part, str)))
        parts = [repr(part) if isinstance(part, str) else f"index_text({self.write(part)})" for part in node.parts]
        return " + ".join(parts)


def index_text(value: float | None) -> str:
    """An index as part of a variable's name (AMB-NAM-3). Raises Refusal."""
    if value is None:
        raise TypeError("null index")
    nearest = round(value) if abs(value) < 1e15 else 0
    if not abs(value - nearest) <= 1e-4:
        raise Refusal(F.BAD_INDEX, value=f"{value:g}", wanted="an index is a whole number")
    return str(nearest)


ENVIRONMENT["index_text"] = index_text


def compile_block(block: Block, dialect: Dialect) -> Callable[[State, Values], tuple[Any, Any]]:
    """The function of a block: (state, literal values) -> (values of the words, of the settings)."""
    writer = Writer(dialect)
    words = [writer.write(word.value) for word in block.words]
    settings = [writer.write(setting.value) for setting in block.settings]
    result = f"({tuple_text(words)}, {tuple_text(settings)})"
    return build(writer.steps, result)


def compile_value(node: Expression, dialect: Dialect) -> Callable[[State, Values], Any]:
    """The function of one expression: (state, literal values) -> value."""
    writer = Writer(dialect)
    return build(writer.steps, writer.write(node))


def compile_name(node: Name, dialect: Dialect) -> Callable[[State, Values], Any]:
    """The function of a name with indexes: (state, literal values) -> the name."""
    writer = Writer(dialect)
    return build(writer.steps, writer.name(node))


def tuple_text(items: list[str]) -> str:
    return f"({', '.join(items)},)" if items else "()"


def build(steps: list[str], result: str) -> Callable[..., Any]:
    lines = ["def computed(m, k):"]
    if "L[" in result or any("L[" in step for step in steps):
        lines.append("    L = m.locals")
    if "V[" in result or any("V[" in step for step in steps):
        lines.append("    V = m.numbered")
    lines += steps
    lines.append(f"    return {result}")
    space = dict(ENVIRONMENT)
    exec(compile("\n".join(lines), "<block>", "exec"), space)
    computed: Callable[..., Any] = space["computed"]
    return computed


# --- the walk


def walk(node: Expression | Text, m: State, k: Values = ()) -> Any:
    """Value of an expression, node by node. Raises Refusal with the place of the node at fault."""
    try:
        match node:
            case Number():
                return node.value
            case Parameter():
                return k[node.nth]
            case Text():
                return node.text
            case Variable():
                return m.read(solid(node.number, m, k, "as the number of a variable"))
            case Name():
                return m.read_name(name_of(node, m, k))
            case Sign():
                value = solid(node.operand, m, k, "behind a sign")
                return -value if node.negative else value
            case Binary():
                return walk_chain(node, m, k)
            case Application():
                if node.function.arguments == "name":
                    assert isinstance(node.arguments[0], Name)
                    return node.function.run(m.exists(name_of(node.arguments[0], m, k)))
                what = f"as the argument of {node.function.name.upper()}"
                values = [solid(argument, m, k, what) for argument in node.arguments]
                return finite(applied(node, values))
    except Refusal as refusal:
        refusal.where = refusal.where or node.where
        raise
    raise AssertionError(node)


def walk_chain(node: Binary, m: State, k: Values) -> float:
    """Value of a chain of operators; its left side may be long. Raises Refusal."""
    nodes = [node]
    while isinstance(nodes[-1].left, Binary):
        nodes.append(nodes[-1].left)
    value = walk(nodes[-1].left, m, k)
    while nodes:
        link = nodes.pop()
        right = walk(link.right, m, k)
        if not link.operator.null:
            what = f"as an operand of {link.operator.name.upper()}"
            known(value, link.left, m, what)
            known(right, link.right, m, what)
        try:
            value = finite(link.operator.run(value, right))
        except Refusal as refusal:
            refusal.where = refusal.where or link.where
            raise
    assert value is not None
    return float(value)


def known(value: float | None, node: Expression, m: State, operation: str) -> float:
    """The value of a node, refused when it is null."""
    if value is None or value != value:
        raise Refusal(F.NULL_VALUE, where=node.where, what=title(node, m), operation=operation)
    return value


def applied(node: Application, values: Sequence[float]) -> float:
    """Value of a function. Raises Refusal."""
    try:
        return node.function.run(*values)
    except (ValueError, OverflowError):
        raise Refusal(F.DOMAIN, where=node.where, function=node.function.name.upper(), value=values[0]) from None


def solid(node: Expression, m: State, k: Values, operation: str) -> float:
    """Value of an expression that may not be null. Raises Refusal."""
    return known(walk(node, m, k), node, m, operation)


def title(node: Expression | Text, m: State) -> str:
    """A variable as a person would write it."""
    if isinstance(node, Variable):
        number = walk(node.number, m)
        return f"#{number:g}" if number is not None else "#[…]"
    if isinstance(node, Name):
        return f"#<{name_of(node, m, ())}>"
    return "the value"


def name_of(node: Name, m: State, k: Values) -> str:
    parts = (part if isinstance(part, str) else index_text(solid(part, m, k, "as an index")) for part in node.parts)
    return "".join(parts)


def explain(block: Block, m: State, failure: Exception, args_may_be_null: bool) -> NoReturn:
    """Raise the Refusal that names what failed in a block, given its nodes with literal numbers."""
    if block.condition is not None:
        solid(block.condition, m, (), "as a condition")
    for word in block.words:
        if args_may_be_null and word.letter not in "gpl":
            walk(word.value, m)
        elif not isinstance(word.value, Text):
            solid(word.value, m, (), f"as the value of {word.letter.upper()}")
    for setting in block.settings:
        walk(setting.value, m)
        if isinstance(setting.target, Variable):
            solid(setting.target.number, m, (), "as the number of a variable")
        else:
            name_of(setting.target, m, ())
    if block.jump is not None and block.jump.target is not None:
        solid(block.jump.target, m, (), "as the target of a jump")
    raise failure if isinstance(failure, Refusal) else Refusal(F.NO_VALUE)
