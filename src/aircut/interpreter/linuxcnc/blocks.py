"""Blocks of LinuxCNC's language, parsed and compiled.

    line     = ["/"] [ "n" number ] ( o-line | { word | setting | comment } )
    word     = letter value
    setting  = "#" ( value | "<" name ">" ) "=" value
    o-line   = "o" ( value | "<" name ">" ) keyword rest

Values are computed before anything of the line is done, so a line becomes one
Python function of the state, as in `interpreter.compiling`.
Source: 001 Format of a line; the canonical listing, sections 7 and 9.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any, NamedTuple

from aircut.diagnostics import Refusal
from aircut.diagnostics import faults as F
from aircut.interpreter import compiling
from aircut.interpreter.linuxcnc import arithmetic
from aircut.interpreter.linuxcnc.arithmetic import finite
from aircut.language.arithmetic import Function
from aircut.language.expressions import (
    Application,
    Binary,
    Expression,
    Name,
    Number,
    Parser,
    Text,
    Variable,
)
from aircut.language.text import COMMENT

LETTERS = frozenset("abcdefghijklmpqrstuvwxyz@^$")
KEYWORD = re.compile("endsub|sub|call|return|elseif|else|endif|if|endwhile|while|do|endrepeat|repeat|break|continue")
LABEL = re.compile(r"/?(?:n(\d+)(?:\.\d+)?)?")
START = re.compile(r"/?(?:n\d+\.?\d*)?o")
ANY_NAME = re.compile(r"[^>]*")
DIRECT = 5399  # numbered parameters up to this one are read as they are stored
ENVIRONMENT = {
    **compiling.ENVIRONMENT,
    **{operator.run.__name__: operator.run for operator in arithmetic.OPERATORS},
    **{f"f_{function.name}": function.run for function in arithmetic.FUNCTIONS},
}


BRACKETS = Function("brackets", finite, "an expression in brackets")
ENVIRONMENT["finite"] = ENVIRONMENT["f_brackets"] = finite


class ValueParser(Parser):
    """The house's parser with this language's operators, functions and names."""

    operator = arithmetic.OPERATOR
    operators = arithmetic.OPERATOR_ROWS
    functions = arithmetic.FUNCTION_ROWS

    def variable(self) -> Variable | Name:
        if self.code.startswith("#<", self.at):
            start = self.at
            self.at += 2
            name = self.name()
            return Name((name,), (start, self.at))
        return super().variable()

    def name(self) -> str:
        """What stands up to >, which is passed over too."""
        match = ANY_NAME.match(self.code, self.at)
        assert match is not None
        self.at = match.end()
        if not self.take(">"):
            raise self.expected("a name and >")
        return match[0].replace(COMMENT, "")

    def brackets(self) -> Application:
        """What stands in brackets is checked to be a number; what stands between operators alone is not."""
        start = self.at
        return Application(BRACKETS, (super().brackets(),), (start, self.at))

    def application(self, function: Any) -> Application:
        if function.arguments != "name":
            return super().application(function)
        start = self.at
        self.at += len(function.name) + 1
        argument = self.variable() if self.code.startswith("#", self.at) else None
        if argument is None or not self.take("]"):
            raise Refusal(F.BAD_EXISTS, where=(start, self.at))
        return Application(function, (argument,), (start, self.at))


def inside(argument: Expression) -> Expression:
    """An argument of a function: in its brackets nothing is checked to be a number, but its value is."""
    bracketed = isinstance(argument, Application) and argument.function is BRACKETS
    return argument.arguments[0] if bracketed else argument  # type: ignore[union-attr]


class Writer(compiling.Writer):
    """Writes a block's Python function."""

    def checked(self, node: Expression | Text) -> tuple[str, int]:
        text, depth = self.expression(node)
        if isinstance(node, Application) and node.function.arguments != "name" and node.function is not BRACKETS:
            return f"finite({text})", depth + 1
        return text, depth

    def chain(self, node: Binary) -> tuple[str, int]:
        nodes = [node]
        while isinstance(nodes[-1].left, Binary):
            nodes.append(nodes[-1].left)
        text, depth = self.checked(nodes[-1].left)
        for link in reversed(nodes):
            right, other = self.checked(link.right)
            joined = f"({text} {link.operator.name} {right})"
            if not link.operator.inline:
                joined = f"{link.operator.run.__name__}({text}, {right})"
            text, depth = self.step(joined, max(depth, other) + 1)
        return text, depth

    def variable(self, node: Variable) -> tuple[str, int]:
        if isinstance(node.number, Number) and node.number.value == int(node.number.value):
            number = int(node.number.value)
            if 1 <= number <= DIRECT:
                return f"V[{number}]", 0
        text, depth = self.checked(node.number)
        return self.step(f"m.read({text})", depth + 1)

    def name(self, node: Name) -> str:
        return repr(node.parts[0])

    def expression(self, node: Expression | Text) -> tuple[str, int]:
        if isinstance(node, Application) and node.function.arguments == "name":
            argument = node.arguments[0]
            if isinstance(argument, Name):
                return f"f_exists(m.exists({self.name(argument)}))", 2
            assert isinstance(argument, Variable)
            text, _ = self.checked(argument.number)
            return f"f_exists(m.has_number({text}))", 2
        if isinstance(node, Application) and node.function is not BRACKETS:
            return super().expression(node._replace(arguments=tuple(map(inside, node.arguments))))
        return super().expression(node)


def build(writer: Writer, result: str) -> Callable[..., Any]:
    lines = ["def computed(m, k):"]
    if "V[" in result or any("V[" in step for step in writer.steps):
        lines.append("    V = m.numbered")
    lines += writer.steps
    lines.append(f"    return {result}")
    space = dict(ENVIRONMENT)
    exec(compile("\n".join(lines), "<block>", "exec"), space)
    computed: Callable[..., Any] = space["computed"]
    return computed


def compiled(*nodes: Expression) -> Callable[..., tuple[float, ...]]:
    """The function (state, literals) -> values of some expressions, which may be infinite or no numbers."""
    writer = Writer(None)  # type: ignore[arg-type]  # this language's variables need no table
    return build(writer, compiling.tuple_text([writer.checked(node)[0] for node in nodes]))


def checked(node: Expression) -> Callable[..., Any]:
    """The function (state, literals) -> value of one expression, which must be a finite number."""
    writer = Writer(None)  # type: ignore[arg-type]  # this language's variables need no table
    return build(writer, writer.write(node))


class Block(NamedTuple):
    """A compiled line of words and settings."""

    letters: tuple[str, ...]
    values: Callable[..., tuple[float, ...]]  # of the words, then of the settings, then of computed targets
    #: Of the settings: a number, a name, or None where it is computed; then the place of that among the values.
    targets: tuple[tuple[int | str | None, int], ...]


class OLine(NamedTuple):
    """An O-word: its label and keyword, and what follows, not yet read."""

    label: str | Callable[..., tuple[float, ...]]  # a name, or a function of the number
    keyword: str  # "" for a bare number, "?" for what is none, "<" behind a name that is not closed
    code: str  # of the line, without the comments at its end
    end: int  # of the keyword in it

    @property
    def rest(self) -> str:
        """What follows the keyword."""
        return self.code[self.end :]


class Item(NamedTuple):
    """A word or a setting as written."""

    letter: str  # "" of a setting
    target: Variable | Name | None  # of a setting
    value: Expression
    where: tuple[int, int]


def parse_o(code: str) -> OLine | None:
    """The O-word of a clean line, if it is one. Raises Refusal."""
    start = START.match(code)
    if start is None:
        return None
    code = code.rstrip(COMMENT)
    parser = ValueParser(code)
    parser.at = start.end()
    label: str | Callable[..., tuple[float, ...]]
    if parser.take("<"):
        if ">" not in code[parser.at :]:
            return OLine("", "<", code, len(code))
        label = parser.name()
    else:
        node = parser.value()
        if isinstance(node, Number) and node.value == int(node.value):
            label = str(int(node.value))
        else:
            label = compiled(node)
    keyword = KEYWORD.match(code, parser.at)
    if keyword is None:
        return OLine(label, "" if code[parser.at :][:1] in ("", COMMENT) else "?", code, parser.at)
    return OLine(label, keyword[0], code, keyword.end())


def brackets(line: OLine, least: int, most: int) -> list[Expression]:
    """The values in brackets behind a keyword. Raises Refusal."""
    parser = ValueParser(line.code)
    parser.at = line.end
    while most > 1 and parser.take(COMMENT):  # between the values of a call
        pass
    nodes: list[Expression] = []
    while len(nodes) < most and line.code.startswith("[", parser.at):
        nodes.append(parser.brackets().arguments[0])  # not checked here
        while most > 1 and parser.take(COMMENT):
            pass
    if len(nodes) < least:
        raise parser.expected("[expression]")
    if parser.at < len(line.code):
        raise Refusal(F.MISPLACED_WORDS, where=(parser.at, len(line.code)), what="an O-word")
    return nodes


def to_value(line: OLine) -> OLine:
    """The line up to its first value in brackets, or its keyword. Raises Refusal."""
    parser = ValueParser(line.code)
    parser.at = line.end
    if line.code.startswith("[", parser.at):
        parser.brackets()
    return line._replace(code=line.code[: parser.at])


def arguments(line: OLine, least: int, most: int) -> Callable[..., tuple[float, ...]]:
    """The function of the values in brackets behind a keyword. Raises Refusal."""
    return compiled(*brackets(line, least, most))


def check_number(code: str) -> int:
    """Pass over / and N; the place behind them. Raises Refusal."""
    at = 1 if code.startswith("/") else 0
    if code.startswith("n", at):
        match = LABEL.match(code)
        if match is None or match.end() <= at:
            raise Refusal(F.BAD_NUMBER, where=(at, at + 1), text="the line number")
        at = match.end()
        if code.startswith(".", at):
            raise Refusal(F.BAD_NUMBER, where=(at, at + 1), text="the line number")
    return at


def read(code: str, shape: bool = False) -> list[Item]:
    """The words and settings of a clean line. shape: numbers are written as `?`. Raises Refusal."""
    parser = ValueParser(code, shape)
    parser.at = check_number(code)
    items: list[Item] = []
    while parser.at < len(code):
        start = parser.at
        character = code[start]
        if character == COMMENT:
            parser.at += 1
        elif character in LETTERS:
            parser.at += 1
            value = parser.value()
            items.append(Item(character, None, value, (start, parser.at)))
        elif character == "#":
            target = parser.variable()
            if not parser.take("="):
                raise parser.expected("=")
            value = parser.value()
            items.append(Item("", target, value, (start, parser.at)))
        else:
            raise parser.expected("a word or a setting")
    return items


def parse(code: str, shape: bool = False) -> Block:
    """A clean line of words and settings, compiled. shape: numbers are written as `?`. Raises Refusal."""
    items = read(code, shape)
    words = [item for item in items if item.target is None]
    settings = [item for item in items if item.target is not None]
    targets: list[tuple[int | str | None, int]] = []
    places: list[Expression] = []
    new: list[str] = []  # names that exist from here on
    for item in settings:
        target = item.target
        if isinstance(target, Name):
            name = str(target.parts[0])
            targets.append((name, -1))
            if code.find(f"#<{name}>") == item.where[0]:
                new.append(name)
        elif isinstance(target, Variable):
            number = target.number
            if isinstance(number, Number) and number.value == int(number.value):
                targets.append((int(number.value), -1))
            else:
                targets.append((None, len(places)))
                places.append(number)
    writer = Writer(None)  # type: ignore[arg-type]  # this language's variables need no table
    writer.steps += [f"    m.create({name!r})" for name in new]
    nodes = [writer.write(node) for node in (*(item.value for item in (*words, *settings)), *places)]
    first = len(items)
    return Block(
        tuple(item.letter for item in words),
        build(writer, compiling.tuple_text(nodes)),
        tuple((target, first + place) for target, place in targets),
    )
