"""Expressions: their nodes, and a parser that needs nothing but the operator and function rows.

Nodes are frozen and carry `where`, their (start, end) in the clean line.
Grammar:
    value      = "-" value | "+" value | number | variable | function | "[" sum "]"
    variable   = "#" value | "#<" name with [ sum ] in it ">"
    sum        = value { operator value }      by precedence, left to right
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import NamedTuple

from aircut.diagnostics import Refusal
from aircut.diagnostics import faults as F
from aircut.language.arithmetic import FUNCTIONS, OPERATORS, Function, Operator
from aircut.language.text import COMMENT, illegal_character

DEEPEST = 100  # brackets in brackets
LONGEST = 2000  # operators in one chain

Where = tuple[int, int]


class Number(NamedTuple):
    """A literal number."""

    value: float
    where: Where


class Parameter(NamedTuple):
    """A literal number of a line of which only the shape is known: the n-th of the line's values."""

    nth: int
    where: Where


class Variable(NamedTuple):
    """#n: a numbered variable."""

    number: Expression
    where: Where


class Name(NamedTuple):
    """#<name>: parts are text and index expressions in turn, as in `a[`, 1, `]`."""

    parts: tuple[str | Expression, ...]
    where: Where


class Sign(NamedTuple):
    """A sign before a value: it wants a number, so a plus is not nothing."""

    negative: bool
    operand: Expression
    where: Where


class Binary(NamedTuple):
    """left operator right."""

    operator: Operator
    left: Expression
    right: Expression
    where: Where


class Application(NamedTuple):
    """A function of its arguments."""

    function: Function
    arguments: tuple[Expression, ...]
    where: Where


class Text(NamedTuple):
    """A string between double quotes."""

    text: str
    where: Where


Expression = Number | Parameter | Variable | Name | Sign | Binary | Application

NUMBER = re.compile(r"\d+\.?\d*|\.\d+")
NAME_TEXT = re.compile(r"[^\[\]<>#\x01\"]+")
FUNCTION = re.compile("(" + "|".join(sorted((f.name for f in FUNCTIONS), key=len, reverse=True)) + r")(?=\[)")
WORD = re.compile(r"[a-z]+")
OPERATOR = re.compile("|".join(re.escape(o.name) for o in sorted(OPERATORS, key=lambda o: -len(o.name))))
FUNCTION_ROWS = {function.name: function for function in FUNCTIONS}
OPERATOR_ROWS = {operator.name: operator for operator in OPERATORS}


class Parser:
    """Reads values and expressions from a clean line, from `at` on.

    operator, operators, functions: the language's operators (a pattern that finds one) and functions by name.
    """

    operator: re.Pattern[str] = OPERATOR
    operators: Mapping[str, Operator] = OPERATOR_ROWS
    functions: Mapping[str, Function] = FUNCTION_ROWS

    def __init__(self, code: str, shape: bool = False) -> None:
        self.code = code
        self.shape = shape
        self.at = 0
        self.depth = 0
        self.parameters = 0

    def found(self) -> str:
        """What stands here, for messages."""
        if self.at >= len(self.code):
            return "the end of the line"
        if self.code[self.at] == COMMENT:
            return "a comment"
        return f"“{self.code[self.at : self.at + 12]}”"

    def expected(self, wanted: str, hint: str = "") -> Refusal:
        here = (self.at, min(self.at + 1, len(self.code)))
        if self.code[self.at : self.at + 1] == COMMENT:
            return Refusal(F.MISPLACED_COMMENT, where=here)
        if not " " <= self.code[self.at : self.at + 1] <= "~" and self.at < len(self.code):
            return illegal_character(self.code[self.at], here)
        if not hint and self.code[self.at : self.at + 1] == "o":
            hint = "is the digit 0 meant?"
        return Refusal(F.EXPECTED, where=here, wanted=wanted, found=self.found(), hint=hint)

    def compared(self) -> str:
        """A hint where a comparison is written as in other languages."""
        return "comparisons are EQ, NE, GT, GE, LT and LE" if self.code[self.at : self.at + 1] in "=<>!" else ""

    def take(self, text: str) -> bool:
        """Pass over this text if it stands here."""
        if self.code.startswith(text, self.at):
            self.at += len(text)
            return True
        return False

    def number(self) -> Number | None:
        """A literal number, if one stands here."""
        match = NUMBER.match(self.code, self.at)
        if match is None:
            return None
        end = match.end()
        if self.code[end : end + 1] == ".":
            raise Refusal(F.BAD_NUMBER, where=(self.at, end + 1), text=self.code[self.at : end + 1])
        self.at = end
        value = float(match[0])
        if value == float("inf"):
            raise Refusal(F.OVERFLOW, where=match.span(), operation="this number")
        return Number(value, match.span())

    def value(self) -> Expression:
        """A value: what may stand behind a letter, or as an operand."""
        start = self.at
        negative = False
        while self.at < len(self.code) and self.code[self.at] in "+-":
            negative ^= self.code[self.at] == "-"
            self.at += 1
        signed = self.at > start
        node = self.primary()
        if not signed or (isinstance(node, Number | Parameter) and not negative):
            return node
        where = (start, self.at)
        return Number(-node.value, where) if isinstance(node, Number) else Sign(negative, node, where)

    def primary(self) -> Expression:
        start = self.at
        character = self.code[start : start + 1]
        if number := self.number():
            return number
        if character == "?" and self.shape:
            self.at += 1
            self.parameters += 1
            return Parameter(self.parameters - 1, (start, self.at))
        if character == "#":
            return self.variable()
        if character == "[":
            return self.brackets()
        if match := FUNCTION.match(self.code, start):
            return self.application(self.functions[match[0]])
        word = WORD.match(self.code, start)
        if word and self.code[word.end() : word.end() + 1] == "[":
            raise Refusal(F.UNKNOWN_FUNCTION, where=word.span(), name=word[0].upper())
        if character in (".", "-", "+"):
            raise Refusal(F.BAD_NUMBER, where=(start, start + 1), text=f"“{character}”")
        raise self.expected("a number, #variable, [expression] or function")

    def variable(self) -> Variable | Name:
        start = self.at
        self.at += 1
        self.deeper(start)
        if not self.code.startswith("<", self.at):
            number = self.value()
            self.depth -= 1
            return Variable(number, (start, self.at))
        self.at += 1
        parts: list[str | Expression] = []
        while not self.take(">"):
            if match := NAME_TEXT.match(self.code, self.at):
                parts.append(match[0])
                self.at = match.end()
            elif self.code.startswith("[", self.at) and parts:
                parts += ["[", self.brackets(), "]"]
            else:
                raise self.expected("a name and >", "a named variable is written #<name>")
        if not parts:
            raise Refusal(F.EXPECTED, where=(start, self.at), wanted="a name", found="“>”", hint="")
        self.depth -= 1
        return Name(tuple(parts), (start, self.at))

    def brackets(self) -> Expression:
        start = self.at
        self.deeper(start)
        self.at += 1
        node = self.sum(1)
        if not self.take("]"):
            if self.at >= len(self.code):
                raise Refusal(F.UNCLOSED_BRACKET, where=(start, start + 1))
            raise self.expected("an operator or ]", self.compared())
        self.depth -= 1
        return node

    def deeper(self, start: int) -> None:
        self.depth += 1
        if self.depth > DEEPEST:
            raise Refusal(F.EXPRESSION_TOO_DEEP, where=(start, start + 1), limit=DEEPEST)

    def sum(self, level: int) -> Expression:
        """Values and the operators of this level or tighter ones between them."""
        start = self.at
        node = self.value()
        for _ in range(LONGEST):
            match = self.operator.match(self.code, self.at)
            if match is None or self.operators[match[0]].level < level:
                return node
            operator = self.operators[match[0]]
            self.at = match.end()
            right = self.sum(operator.level + 1)
            node = Binary(operator, node, right, (start, self.at))
        raise Refusal(F.EXPRESSION_TOO_DEEP, where=(start, self.at), limit=LONGEST)

    def application(self, function: Function) -> Application:
        start = self.at
        self.at += len(function.name)
        if function.arguments == "name":
            opening = self.at
            self.at += 1
            is_name = self.code.startswith("#<", self.at)
            argument: Expression = self.variable() if is_name else self.sum(1)
            if not isinstance(argument, Name) or not self.take("]"):
                raise Refusal(F.BAD_EXISTS, where=(opening, self.at))
            return Application(function, (argument,), (start, self.at))
        arguments = [self.brackets()]
        if function.arguments == "two":
            if not self.code.startswith("/[", self.at):
                raise self.expected("/[ and the second argument", f"{function.name.upper()} is written ATAN[y]/[x]")
            self.at += 1
            arguments.append(self.brackets())
        return Application(function, tuple(arguments), (start, self.at))
