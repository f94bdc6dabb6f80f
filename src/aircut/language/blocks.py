"""Lines: a label, and a block of words and settings or a mark of the program's structure.

Grammar of a clean line, after an optional "/" and "N" label:
    block  = { word | setting | jump }                       in any order
    word   = letter value | "p" string
    setting = variable "=" value
    jump   = "goto" value | "break" digits | "return" | "endsub"
    mark   = "if" cond "then" digits | "elif" cond "then" digits | "else" digits
           | "end" digits | "while" cond "do" digits | ("o"|"sub") (digits|string)
    "if" cond ("then" block | jump) is a block with a condition.
"""

from __future__ import annotations

import re
from typing import NamedTuple

from aircut.diagnostics import Refusal
from aircut.diagnostics import faults as F
from aircut.language.expressions import (
    Expression,
    Name,
    Number,
    Parser,
    Text,
    Variable,
    Where,
    illegal_character,
)
from aircut.language.text import COMMENT

LETTERS = "abcdefghijklmpqrstuvwxyz@^"  # of words; n and o are not among them
KEYWORD = re.compile(r"(goto|break|return|endsub|call(?=[a-z]|$|\x01))")
#: No word begins so, but for I with FIX or FUP behind it.
MARK = re.compile(r"(elif|if(?!ix\[|up\[)|else|endsub|end|while|sub|o(?=[\d\"]|$|\x01))")
#: What LinuxCNC's language writes where this one declares a subroutine.
O_WORD = re.compile(
    r"o(?:<[^>]*>|\d+|\[.*?\]|#\d+)"
    r"(sub|endsub|call|return|if|elseif|else|endif|while|endwhile|do|repeat|endrepeat|break|continue)(?![\d\"])"
)
DIGITS = re.compile(r"\d+")
LABEL = re.compile(r"(/?)\x01*(?:n(\d*))?")


class Word(NamedTuple):
    """A letter and its value."""

    letter: str
    value: Expression | Text
    where: Where


class Setting(NamedTuple):
    """variable = value."""

    target: Variable | Name
    value: Expression
    where: Where


class Jump(NamedTuple):
    """goto, break or return; target: the label or id."""

    kind: str
    target: Expression | None
    where: Where


class Block(NamedTuple):
    """What a line does."""

    words: tuple[Word, ...] = ()
    settings: tuple[Setting, ...] = ()
    jump: Jump | None = None
    condition: Expression | None = None
    call: Where | None = None  # the keyword CALL


class Mark(NamedTuple):
    """What a line is in the structure: if, elif, else, end, while, sub."""

    kind: str
    name: str  # the id, or the subroutine's name
    condition: Expression | None
    where: Where


class Line(NamedTuple):
    """A parsed line."""

    deleted: bool  # it begins with /
    label: int | None
    body: Block | Mark | None


def parse(code: str, shape: bool = False) -> Line:
    """Parse a clean line; in a shape, `?` stands for any literal number. Raises Refusal with the place in it."""
    parser = LineParser(code, shape)
    return parser.line()


class LineParser(Parser):
    """Reads a whole line."""

    def skip(self) -> None:
        while self.code.startswith(COMMENT, self.at):
            self.at += 1

    def line(self) -> Line:
        self.skip()
        match = LABEL.match(self.code, self.at)
        assert match is not None
        self.at = match.end()
        label = None
        if match[2] is not None:
            if not match[2]:
                raise self.expected("a line number")
            if self.code[self.at : self.at + 1] == ".":
                raise Refusal(F.BAD_NUMBER, where=(match.start(2), self.at + 1), text=f"{match[2]}.")
            label = int(match[2][:18])
        self.skip()
        body: Block | Mark | None = None
        if self.at < len(self.code):
            body = self.mark() or self.block(None)
        return Line(bool(match[1]), label, body)

    def mark(self) -> Mark | Block | None:
        match = MARK.match(self.code, self.at)
        if match is None or match[1] == "endsub":
            return None
        start = self.at
        self.at = match.end()
        kind = match[1]
        if foreign := O_WORD.match(self.code, start):
            raise Refusal(F.OTHER_LANGUAGE, where=foreign.span(), word=f"O-{foreign[1].upper()}")
        if kind in ("o", "sub"):
            return self.subroutine(start, kind)
        if kind in ("else", "end"):
            return Mark(kind, self.id(kind.upper()), None, (start, self.at))
        self.skip()
        condition = self.condition(kind.upper())
        self.skip()
        if kind == "while":
            if not self.take("do"):
                hint = "the letter O, not a zero" if self.code.startswith("d0", self.at) else ""
                raise self.expected("DO and a number", hint)
            return Mark(kind, self.id("DO"), condition, (start, self.at))
        if self.take("then"):
            if DIGITS.match(self.code, self.at):
                return Mark(kind, self.id("THEN"), condition, (start, self.at))
            if kind == "elif":
                raise self.expected("the number of the block")
            self.skip()
            if self.at >= len(self.code):
                raise self.expected("a statement or the number of a block")
            if (inner := MARK.match(self.code, self.at)) and inner[1] != "endsub":
                raise self.expected("a statement", "IF and WHILE have lines of their own")
            return self.block(condition)
        if kind == "elif" or not self.code.startswith(("goto", "break"), self.at):
            raise self.expected("THEN, GOTO or BREAK" if kind == "if" else "THEN")
        return self.block(condition)

    def subroutine(self, start: int, kind: str) -> Mark:
        if self.code.startswith('"', self.at):
            name = self.string().text.strip().lower()
        elif digits := DIGITS.match(self.code, self.at):
            self.at = digits.end()
            name = str(int(digits[0][:18]))
        else:
            raise self.expected("a number or a name in quotes")
        mark = Mark("sub", name, None, (start, self.at))
        self.ends(f"{kind.upper()} {name}")
        return mark

    def id(self, what: str) -> str:
        digits = DIGITS.match(self.code, self.at)
        if digits is None:
            raise self.expected(f"a number behind {what}")
        self.at = digits.end()
        self.ends(f"{what}{digits[0]}")
        return str(int(digits[0][:18]))

    def ends(self, what: str) -> None:
        self.skip()
        if self.at < len(self.code):
            raise Refusal(F.MISPLACED_WORDS, where=(self.at, len(self.code)), what=what)

    def condition(self, what: str) -> Expression:
        if not self.code.startswith("[", self.at):
            raise self.expected(f"[condition] behind {what}")
        return self.brackets()

    def string(self) -> Text:
        start = self.at
        self.at = self.code.index('"', start + 1) + 1
        return Text(self.code[start + 1 : self.at - 1], (start, self.at))

    def block(self, condition: Expression | None) -> Block:
        words: list[Word] = []
        settings: list[Setting] = []
        jump: Jump | None = None
        call: Where | None = None
        self.skip()
        while self.at < len(self.code):
            start = self.at
            character = self.code[start]
            if jump is not None:
                raise Refusal(F.MISPLACED_WORDS, where=(start, len(self.code)), what=jump.kind.upper())
            if character == "#":
                settings.append(self.setting())
            elif keyword := KEYWORD.match(self.code, start):
                self.at = keyword.end()
                if keyword[1] == "call":
                    if words or settings:
                        raise self.expected("CALL at the start of the block")
                    call = keyword.span()
                else:
                    jump = self.jump(keyword[1], start)
            elif character in LETTERS:
                words.append(self.word())
            else:
                raise self.illegal(character)
            self.skip()
        return Block(tuple(words), tuple(settings), jump, condition, call)

    def illegal(self, character: str) -> Refusal:
        where = (self.at, self.at + 1)
        if foreign := O_WORD.match(self.code, self.at):
            return Refusal(F.OTHER_LANGUAGE, where=foreign.span(), word=f"O-{foreign[1].upper()}")
        if character == "n":
            return Refusal(F.MISPLACED_LABEL, where=where)
        if character == "/":
            return Refusal(F.MISPLACED_SLASH, where=where)
        if character == "%":
            return Refusal(F.MISPLACED_PERCENT, where=where)
        hint = ""
        if character == "o":
            digit = self.at > 0 and self.code[self.at - 1] in "0123456789."
            hint = "is the digit 0 meant?" if digit else "a subroutine is declared at the start of a line"
        elif character == ",":
            hint = "decimals are written with a point, as in 1.5"
        return illegal_character(character, where, hint)

    def word(self) -> Word:
        start = self.at
        letter = self.code[start]
        self.at += 1
        if self.code.startswith('"', self.at):
            value: Expression | Text = self.string()
            if letter != "p":
                raise Refusal(F.MISPLACED_STRING, where=(start, self.at), word=letter.upper())
        else:
            following = self.code[self.at : self.at + 1]
            if not following or (following in LETTERS and not self.is_function()):
                where = (start, self.at)
                if following == COMMENT:
                    raise Refusal(F.MISPLACED_COMMENT, where=where)
                raise Refusal(F.MISSING_VALUE, where=where, word=letter.upper())
            value = self.value()
        return Word(letter, value, (start, self.at))

    def is_function(self) -> bool:
        return re.match(r"[a-z]+\[", self.code[self.at :]) is not None

    def setting(self) -> Setting:
        target = self.variable()
        if not self.take("="):
            raise self.expected("= and a value", "a line assigns a variable, or uses it behind a letter")
        value = self.value()
        if self.at < len(self.code) and self.code[self.at] in "+-*/&|^":
            raise self.expected("the end of the value", "operators stand in brackets: #1 = [#2 + 1]")
        return Setting(target, value, (target.where[0], self.at))

    def jump(self, kind: str, start: int) -> Jump:
        if kind == "goto":
            return Jump(kind, self.value(), (start, self.at))
        if kind == "break":
            digits = DIGITS.match(self.code, self.at)
            if digits is None:
                raise self.expected("a number behind BREAK")
            self.at = digits.end()
            return Jump(kind, Number(float(digits[0][:18]), digits.span()), (start, self.at))
        return Jump("return", None, (start, self.at))
