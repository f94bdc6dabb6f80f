"""A program file made ready to run: its structure, and its lines compiled as they are first met."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Any, NamedTuple

from aircut.diagnostics import Refusal, Span
from aircut.diagnostics import faults as F
from aircut.interpreter.arranging import code_name
from aircut.interpreter.compiling import compile_block, compile_name, compile_value
from aircut.kernels import scan
from aircut.language import structure
from aircut.language.blocks import MARK, Block, Line, Mark, parse
from aircut.language.expressions import Name, Number, Text, Variable
from aircut.language.text import COMMENT, Clean, clean, columns
from aircut.source import BATCH, Batch

if TYPE_CHECKING:
    from array import array

    from aircut.interpreter.calls import Call
    from aircut.interpreter.table import Code, Dialect
    from aircut.language.structure import Routine
    from aircut.source import Source

FIRST_BATCH = 16  # lines scanned when the program has jumped
#: Literal numbers that do not decide what a line means, so that lines differing in them share a shape.
LITERAL = re.compile(r"(?<=[abcdefhijklpqrstuvwxyz@^=\[+\-*/,])(\d+\.?\d*|\.\d+)(?![\d.])")
INFINITE = float("inf")
LABEL = re.compile(r"/?(?:n\d+)?\x01*")
MARK_START = re.compile(r"/?\x01*(?:n\d+)?\x01*" + MARK.pattern)


class Shape(NamedTuple):
    """What lines of one shape have in common."""

    codes: tuple[str, ...]  # normalized names of the codes written with literal numbers
    letters: tuple[str, ...]  # of the other words
    steps: dict[Code | None, Any]  # by the motion mode in force


class Statement(NamedTuple):
    """A compiled line."""

    block: Block
    codes: tuple[str, ...]
    letters: tuple[str, ...]  # of the words that are not literal codes, in order
    moving: bool  # among the letters are codes whose number is computed
    values: Callable[..., Any]
    targets: tuple[tuple[str, Any], ...]  # of the settings: where to, and the number or the function of it
    condition: Callable[..., Any] | None
    jump: Callable[..., Any] | None  # the label of a GOTO
    steps: dict[Any, Any]
    comment: str | None


class Branch(NamedTuple):
    """A mark with its condition compiled."""

    mark: Mark
    condition: Callable[..., Any] | None


class Level(NamedTuple):
    """A caller, waiting for its call to come back."""

    unit: Unit
    routine: Routine
    back: int  # line to go on with
    line: int  # line of the call, from 1
    call: Call
    left: int  # repetitions still to do
    locals: list[float | None]
    scope: dict[str, float | None]
    moves: int  # made before it


class Unit:
    """One text, ready to run in a dialect."""

    def __init__(self, source: Source, dialect: Dialect, block_delete: bool, line_limit: int) -> None:
        self.source = source
        self.dialect = dialect
        self.block_delete = block_delete
        self.line_limit = line_limit
        self.statements: dict[int, tuple[Statement | Branch | None, tuple[float, ...]]] = {}
        self.shared: dict[str, Statement] = {}
        self.encoding: list[tuple[int, Refusal]] = []  # warnings
        self.seen = bytearray(len(source))
        self.slow = bytearray(len(source))  # plain lines at which the fast lane has got nowhere
        self.looms: dict[int, Any] = {}  # loops compiled whole, by the line of their WHILE; None: they cannot be
        self.called: Counter[tuple[str, bool]] = Counter()  # calls of names, numbered or not, from here
        self.callees: dict[tuple[str, bool], Any] = {}  # subroutines compiled whole (looms.Callee), as called from here
        self.percent = False
        self.plain: dict[int, tuple[Shape, Any]] = {}  # plain lines that run again
        self.batch = Batch(min(BATCH, max(len(source), 1)))
        self.room = FIRST_BATCH
        first, end = self.limits()
        self.structure = structure.build(self.marks(first, end), first, end)

    # --- text

    def clean(self, line: int) -> Clean:
        """The clean text of a line. Raises Refusal with the place in the line as written."""
        if self.source.length(line) > self.line_limit:
            length = self.source.length(line)
            raise Refusal(F.LINE_TOO_LONG, where=(0, 1), length=length, limit=self.line_limit)
        return clean(self.source.text(line))

    def deleted(self, line: int) -> bool:
        """Whether block delete takes the line away."""
        return self.block_delete and self.source.raw(line).lstrip().startswith(b"/")

    def limits(self) -> tuple[int, int]:
        """First line of the program and the line after its last: what `%` leaves."""
        classes = self.source.classes
        first = 0
        while first < len(classes) and classes[first] == scan.BLANK:
            first += 1
        end = len(classes)
        for line in self.source.lines_with(b"%"):
            if self.source.raw(line).strip() == b"%":
                if line != first:
                    return (first + 1 if self.percent else first), line
                self.percent = True
        return (first + 1 if self.percent else first), end

    def marks(self, first: int, end: int) -> Iterator[tuple[int, Mark]]:
        """The marks among the lines; lines that cannot be read are left for later."""
        classes = self.source.classes
        line = classes.find(scan.OTHER, first, end)
        while line >= 0:
            try:
                code = "" if self.deleted(line) else self.clean(line).code
                if MARK_START.match(code):
                    body = parse(code).body
                    if isinstance(body, Mark):
                        yield line, body
            except Refusal:
                if MARK_START.match(self.source.raw(line)[:80].lower().translate(None, b" \t").decode("latin-1")):
                    yield line, Mark("broken", "", None, (0, 0))
            line = classes.find(scan.OTHER, line + 1, end)

    def entry(self) -> Routine:
        """Where the text starts to run: at its top; behind the O or SUB that is its first line (AMB-CALL-4)."""
        main = self.structure.main
        if len(self.structure.order) > 1 and not any(self.says_something(line) for line in range(main.first, main.end)):
            return self.structure.order[1]
        return main

    def says_something(self, line: int) -> bool:
        """Whether a line is more than blanks and comments."""
        if self.source.classes[line] != scan.OTHER:
            return self.source.classes[line] == scan.PLAIN
        try:
            return bool(self.clean(line).code.strip(COMMENT))
        except Refusal:
            return True

    def place(self, line: int, refusal: Refusal) -> Span:
        """Columns of a fault in a line, from 1."""
        text = self.source.text(line) if self.source.length(line) <= self.line_limit else ""
        try:
            code = clean(text).code
        except Refusal as raised:  # the line could not even be cleaned: the place is as written
            start, end = raised.where or (0, 1)
            return Span(line + 1, start + 1, end + 1)
        where = refusal.where or self.find_word(code, refusal.letter)
        places = columns(text)
        start, end = min(where[0], len(places) - 1), min(max(where[1], where[0] + 1), len(places))
        return Span(line + 1, places[start] + 1, places[end - 1] + 2)

    def find_word(self, code: str, letter: str) -> tuple[int, int]:
        """Where a word stands in a clean line; the whole block when it is not known."""
        body = None
        try:
            body = parse(code).body
        except Refusal:
            pass
        words = body.words if isinstance(body, Block) else ()
        found = [word.where for word in words if word.letter == letter]
        if found:
            return found[-1]
        match = LABEL.match(code)
        start = match.end() if match else 0
        end = len(code.rstrip(COMMENT))
        return (start if start < end else 0, max(end, 1))

    # --- compiled lines

    def words(self, line: int) -> tuple[bytes, array[float]]:
        """Shape and values of a plain line; lines in sequence are scanned in ever larger batches."""
        at = line - self.batch.first
        if not 0 <= at < self.batch.count:
            self.room = min(len(self.batch.shape_ends), self.room * 8) if at == self.batch.count else FIRST_BATCH
            self.source.batch(line, self.room, self.batch)
        return self.batch.words(line)

    def statement(self, line: int) -> tuple[Statement | Branch | None, tuple[float, ...]]:
        """The compiled line and its literal values; None where there is nothing to do. Raises Refusal."""
        known = self.statements.get(line)
        if known is None:
            known = self.statements[line] = self.compile(line)
        return known

    def compile(self, line: int) -> tuple[Statement | Branch | None, tuple[float, ...]]:
        if self.deleted(line):
            return None, ()
        text = self.clean(line)
        self.check_encoding(line)
        code = text.code.strip(COMMENT)
        if not code:
            return (comment_only(text), ()) if text.comments else (None, ())
        values = tuple(map(float, LITERAL.findall(code)))
        if '"' in code or "<" in code or "?" in code or text.comments or MARK_START.match(code) or INFINITE in values:
            return self.fresh(text, text.code), ()
        shape = LITERAL.sub("?", code)
        statement = self.shared.get(shape)
        if statement is None or "n" in shape[:1] or "/" in shape[:1]:
            if not values:
                return self.fresh(text, code), ()
            try:
                made = self.fresh(text, shape, shape=True)
            except Refusal:
                made = None
            if not isinstance(made, Statement):  # say what is wrong with the line itself
                return self.fresh(text, code), ()
            self.shared[shape] = statement = made
        return statement, values

    def check_encoding(self, line: int) -> None:
        raw = self.source.raw(line)
        if not raw.isascii():
            try:
                raw.decode()
            except UnicodeDecodeError as error:
                where = (error.start, error.start + 1)
                self.encoding.append((line, Refusal(F.INVALID_UTF8, where=where, byte=raw[error.start])))

    def fresh(self, text: Clean, code: str, shape: bool = False) -> Statement | Branch | None:
        parsed: Line = parse(code, shape)
        if parsed.body is None:
            return comment_only(text) if text.comments else None
        if isinstance(parsed.body, Mark):
            condition = parsed.body.condition
            return Branch(parsed.body, compile_value(condition, self.dialect) if condition else None)
        return make(parsed.body, self.dialect, text.comments[-1] if text.comments else None)


def comment_only(text: Clean) -> Statement:
    nothing = lambda m, k: ((), ())  # noqa: E731
    return Statement(Block(), (), (), False, nothing, (), None, None, {}, text.comments[-1])


def make(block: Block, dialect: Dialect, comment: str | None = None) -> Statement:
    """Compile a block. Raises Refusal where it is wrong whatever the values."""
    codes: list[str] = ["call"] if block.call else []
    kept = []
    letters: list[str] = []
    moving = False
    macro = takes_arguments(block, dialect)
    for word in block.words:
        if word.letter == "g" or (word.letter == "m" and not macro):
            if isinstance(word.value, Number):
                codes.append(code_name(word.letter, word.value.value))
                continue
            moving = True
        elif word.letter in letters:
            raise Refusal(F.REPEATED_WORD, where=word.where, word=word.letter.upper())
        kept.append(word)
        letters.append(word.letter)
        if isinstance(word.value, Text) and not takes_text(codes, block, dialect):
            raise Refusal(F.MISPLACED_STRING, where=word.where, word="P")
    targets = [target_of(setting.target, dialect) for setting in block.settings]
    jump = None
    if block.jump is not None and block.jump.target is not None:
        jump = compile_value(block.jump.target, dialect)
    return Statement(
        block,
        tuple(codes),
        tuple(letters),
        moving,
        compile_block(block._replace(words=tuple(kept)), dialect),
        tuple(targets),
        compile_value(block.condition, dialect) if block.condition else None,
        jump,
        {},
        comment,
    )


def takes_arguments(block: Block, dialect: Dialect) -> bool:
    """Whether the block calls a macro by CALL or a G code: its M word is an argument then (AMB-CALL-11)."""
    names = [
        code_name("g", word.value.value)
        for word in block.words
        if word.letter == "g" and isinstance(word.value, Number)
    ]
    return bool(block.call) or any(name in dialect.codes and dialect.codes[name].sole for name in names)


def target_of(target: Variable | Name, dialect: Dialect) -> tuple[str, Any]:
    """Where a setting goes: "local" or "numbered" and the number, or "computed" or "named" and a function."""
    if isinstance(target, Name):
        return "named", compile_name(target, dialect)
    if isinstance(target.number, Number) and target.number.value == int(target.number.value):
        number = int(target.number.value)
        if 1 <= number <= 33:
            return "local", number
        if any(row.first <= number <= row.last and row.writable for row in dialect.ranges):
            return "numbered", number
    return "computed", compile_value(target.number, dialect)


def takes_text(codes: list[str], block: Block, dialect: Dialect) -> bool:
    """Whether a string may be the P of this block."""
    literal = {
        code_name(word.letter, word.value.value)
        for word in block.words
        if word.letter in "gm" and isinstance(word.value, Number)
    }
    return (
        bool(block.call)
        or any(name in dialect.codes and dialect.codes[name].text for name in literal)
        or any(word.letter in "gm" and not isinstance(word.value, Number) for word in block.words)
    )
