"""Loops as Python functions: what a WHILE repeats is compiled whole.

The general lane stays the meaning. A loop's function does what that would, line by line,
and gives a line back before anything of it has happened where the line asks for more:
a value that cannot be computed, a jump, a limit in the way, a line not run before.
Straight moves are packed here; all other codes are carried out by the interpreter.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple

from aircut.canon import CHUNK, ROW, Kind
from aircut.diagnostics import Refusal
from aircut.interpreter.compiling import ENVIRONMENT, FAILURES, Writer
from aircut.interpreter.path import RECORDER
from aircut.interpreter.table import Dialect, Group
from aircut.interpreter.unit import Branch, Statement, Unit, takes_arguments
from aircut.kernels import scan
from aircut.language.arithmetic import LARGEST
from aircut.language.blocks import Mark, Word, parse
from aircut.language.expressions import Application, Binary, Expression, Name, Number, Text, Variable

if TYPE_CHECKING:
    from aircut.interpreter.interpreter import Interpreter
    from aircut.interpreter.state import State

FULL = CHUNK * ROW.size
FAR = 1e9  # as the general lane's
STRAIGHT = {"g0": int(Kind.TRAVERSE), "g1": int(Kind.FEED)}
LINEAR = "xyz"
#: What ends a function early: the general lane runs that line, and says what is wrong with it.
EVALUATION = (*FAILURES, Refusal, KeyError)

Loom = Callable[["Interpreter"], tuple[int, bool]]


class Modes(NamedTuple):
    """What straight moves need to know; it is asked again after codes that may change it."""

    absolute: bool
    unit: float  # mm
    feed: float  # mm/min
    tool: int
    plane: int
    flags: int
    box: tuple[float, ...]  # lowest and highest X, then Y, Z, in the program's frame, mm
    offset: tuple[float, ...]


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
    box = m.box
    if lx < -FAR or hx > FAR or ly < -FAR or hy > FAR or lz < -FAR or hz > FAR:
        box = tuple(min(max(limit, -FAR), FAR) for limit in box)
    return Modes(m.absolute, m.unit, m.feed, m.tool, m.plane, m.flags, box, tuple(m.offset))


class Unwoven(Exception):
    """The loop cannot be compiled."""


class Values(Writer):
    """Writes expressions; names of the program's own are looked up at once."""

    def expression(self, node: Expression | Text) -> tuple[str, int]:
        if isinstance(node, Name) and (name := plain_name(node)) is not None and name not in self.dialect.named:
            return f"{scope_of(name, self.dialect)}[{name!r}]", 0
        return super().expression(node)


def plain_name(node: Name) -> str | None:
    """The text of a name without indexes."""
    parts = [part for part in node.parts if isinstance(part, str)]
    return "".join(parts) if len(parts) == len(node.parts) else None


def scope_of(name: str, dialect: Dialect) -> str:
    return "S" if name.startswith("_") == dialect.local_underscore else "N"


class Weaver:
    """Writes the function of one loop."""

    def __init__(self, unit: Unit) -> None:
        self.unit = unit
        self.lines: list[str] = []
        self.space: dict[str, Any] = {"unit": unit, "seen": unit.seen}
        self.run_from = self.run_to = 0  # lines of the straight run being written

    # --- text

    def put(self, depth: int, *lines: str) -> None:
        self.lines += ["    " * depth + line for line in lines]

    def value(self, depth: int, name: str, node: Expression | Text, line: int) -> None:
        """Compute a value into a variable of the function, or give the line back."""
        writer = Values(self.unit.dialect)
        text, _ = writer.expression(node)
        for step in writer.steps:
            self.put(depth, step.strip())
        if "m.read" in text or any("m.read" in step for step in writer.steps):
            self.put(depth, f"m.line = out.line = {line + 1}")
        self.put(depth, f"{name} = {text}")
        computed = isinstance(node, Application) and node.function.arguments != "name"
        if computed or (isinstance(node, Binary) and node.operator.inline):
            self.put(depth, f"if not -{LARGEST!r} <= {name} <= {LARGEST!r}: return {line}, False")

    # --- structure

    def loop(self, depth: int, first: int) -> int:
        """A WHILE; returns the line after its END. Raises Unwoven."""
        structure = self.unit.structure
        after = structure.otherwise.get(first)
        if after is None or structure.onward.get(after - 1) != first:
            raise Unwoven
        last = after - 1
        self.put(depth, "while True:", f"    line = {first}")
        self.value(depth + 1, "t", self.condition(first), first)
        self.put(depth + 1, f"if t is None: return {first}, False", "if t == 0.0: break")
        self.body(depth + 1, first + 1, last)
        self.passed(depth + 1, last)
        self.put(
            depth + 1,
            f"line = {last}",
            "acting = True",
            f"back(unit, {last}, {first})",
            "acting = False",
            f"if len(out.rows) >= {FULL}: return {first}, True",
        )
        return after

    def condition(self, line: int) -> Expression:
        body = parse(self.unit.clean(line).code).body
        if not isinstance(body, Mark) or body.condition is None:
            raise Unwoven
        return body.condition

    def body(self, depth: int, first: int, end: int) -> None:
        """Lines from `first` to before `end`. Raises Unwoven."""
        at = first
        fresh = True  # a run of lines without branches begins
        self.put(depth, "pass")
        while at < end:
            mark = self.mark(at)
            if fresh or mark is not None:
                stop = at + 1
                while mark is None and stop < end and self.mark(stop) is None:
                    stop += 1
                self.put(depth, f"if unseen and seen.find(0, {at}, {stop}) >= 0: return {at}, False")
                fresh = False
            if mark is None:
                self.line(depth, at)
                at += 1
            elif mark.kind == "while":
                at = self.loop(depth, at)
                fresh = True
            elif mark.kind == "if":
                at = self.branches(depth, at)
                fresh = True
            else:
                raise Unwoven

    def mark(self, line: int) -> Mark | None:
        if self.unit.source.classes[line] != scan.OTHER:
            return None
        try:
            statement = self.unit.statement(line)[0]
        except Refusal:
            return None  # the general lane tells
        return statement.mark if isinstance(statement, Branch) else None

    def branches(self, depth: int, first: int) -> int:
        """An IF to its END; returns the line after it. Raises Unwoven."""
        structure = self.unit.structure
        at, end = first, structure.otherwise.get(first)
        level = depth
        while True:
            if end is None:
                raise Unwoven
            self.put(level, f"line = {first}")  # nobody can begin at an ELIF
            self.value(level, "t", self.condition(at), first)
            self.put(level, f"if t is None: return {first}, False", "if t != 0.0:")
            self.body(level + 1, at + 1, end)
            mark = self.mark(end)
            if mark is None:
                raise Unwoven
            if mark.kind == "end":
                self.passed(level, end)
                return end + 1
            self.passed(level + 1, end)
            self.put(level, "else:")
            level += 1
            self.put(level, f"if unseen and not seen[{end}]: return {first}, False")
            if mark.kind != "elif":
                break
            at, end = end, structure.otherwise.get(end)
        after = structure.onward.get(end)  # of ELSE: the line after its END
        if after is None:
            raise Unwoven
        self.body(level, end + 1, after - 1)
        self.passed(level, after - 1)
        return after

    def passed(self, depth: int, mark: int) -> None:
        """A mark that does nothing here but to have been seen."""
        self.put(depth, f"if unseen and not seen[{mark}]: return {mark}, False")

    # --- lines

    def line(self, depth: int, at: int) -> None:
        unit = self.unit
        if unit.source.classes[at] == scan.BLANK:
            return
        self.put(depth, f"line = {at}")
        statement = None
        try:
            if unit.source.raw(at).isascii():
                statement = unit.statement(at)[0]
                text = unit.clean(at)
                whole = unit.fresh(text, text.code) if statement is not None else None
        except Refusal:
            whole = None
            statement = unit  # type: ignore[assignment]  # there is something
        if statement is None and unit.source.raw(at).isascii():
            return
        if not isinstance(statement, Statement) or not isinstance(whole, Statement):
            self.put(depth, f"return {at}, False")
            return
        block = whole.block
        if block.condition is not None:
            self.value(depth, "t", block.condition, at)
            self.put(depth, f"if t is None: return {at}, False", "if t != 0.0:", "    pass")
            depth += 1
        if block.jump is not None or not self.settings_known(whole):
            self.put(depth, f"return {at}, False")
            return
        self.statement(depth, at, whole)

    def settings_known(self, statement: Statement) -> bool:
        """Whether the settings can be made here: those that may fail stand alone."""
        settings = statement.block.settings
        kinds = [kind for kind, _ in statement.targets]
        if len(settings) > 1 and not {*kinds} <= {"local", "numbered"}:
            return False
        return not (settings and "computed" in kinds and (statement.codes or statement.letters))

    def statement(self, depth: int, at: int, statement: Statement) -> None:
        """Values first, then settings, comment and codes, as the general lane has them."""
        block, dialect = statement.block, self.unit.dialect
        words = kept_words(statement, dialect)
        for i, word in enumerate(words):
            self.value(depth, f"w{i}", word.value, at)
        for i, setting in enumerate(block.settings):
            self.value(depth, f"s{i}", setting.value, at)
        for i, ((kind, target), setting) in enumerate(zip(statement.targets, block.settings, strict=True)):
            if kind == "local":
                self.put(depth, f"L[{target}] = s{i}")
            elif kind == "numbered":
                self.put(depth, f"V[{target}] = s{i}")
            elif kind == "named":
                name = plain_name(setting.target) if isinstance(setting.target, Name) else None
                if name is None or name in dialect.named:
                    self.put(depth, f"return {at}, False")
                    return
                self.put(depth, f"{scope_of(name, dialect)}[{name!r}] = s{i}")
            else:
                assert isinstance(setting.target, Variable)
                self.value(depth, "i", setting.target.number, at)
                self.put(depth, f"m.line = out.line = {at + 1}", f"m.write(i, s{i})")
        if statement.comment:
            self.put(depth, f"out.line = {at + 1}", f"out.event('COMMENT', {statement.comment.lstrip()!r})")
        if not statement.codes and not words:
            return
        values = "".join(f"w{i}, " for i in range(len(words)))
        self.space[f"s_{at}"] = statement
        carry = (
            f"run.line = {at}",
            f"m.line = out.line = {at + 1}",
            "acting = True",
            f"run.perform(unit, {at}, s_{at}, ({values}))",
            "acting = False",
            f"if run.talk is not None or m.transfer is not None: return {at + 1}, True",
            "M = asked",
        )
        letters, codes = {word.letter for word in words}, set(statement.codes)
        alone = not block.settings and not statement.comment  # the line can be given back
        if alone and letters and letters <= set(LINEAR) and codes <= set(STRAIGHT) and len(codes) < 2:
            code = statement.codes[0] if codes else ""
            self.put(depth, "if M is asked: M = modes(m)")
            self.put(depth, f"if M is None or not (m.motion is g0 or m.motion is g1 or {bool(code)}):")
            self.put(depth + 1, *carry)
            self.put(depth, "else:")
            self.move(depth + 1, at, code, {word.letter: f"w{i}" for i, word in enumerate(words)})
        else:
            self.put(depth, *carry)

    def move(self, depth: int, at: int, code: str, words: dict[str, str]) -> None:
        """A straight move, from words to its row."""
        self.put(depth, "absolute, scale, speed, tool, plane, flags, box, offset = M", "x, y, z, a, b, c = m.position")
        for letter, word in words.items():
            self.put(depth, f"{letter} = {word} * scale if absolute else {letter} + {word} * scale")
        inside = " and ".join(
            f"box[{2 * i}] <= {letter} <= box[{2 * i + 1}]" for i, letter in enumerate(LINEAR) if letter in words
        )
        self.put(depth, f"if not ({inside}): return {at}, False")
        if code:
            self.put(depth, f"if m.motion is not {code}: run.set_mode({code})")
        kind = str(STRAIGHT[code]) if code else "(1 if m.motion is g1 else 0)"
        self.put(
            depth,
            f"kind = {kind}",
            "i, j, k, n, o, p = offset",
            "out.rows += pack(x + i, y + j, z + k, a + n, b + o, c + p, 0.0, 0.0, speed if kind else 0.0, "
            f"{at + 1}, tool, 0, out.file, kind, plane, flags)",
            "m.position = [x, y, z, a, b, c]",
        )

    def build(self, first: int) -> Loom:
        """The function of a loop. Raises Unwoven."""
        end = self.loop(2, first)
        head = [
            "def woven(run):",
            "    m = run.state",
            "    out = m.out",
            "    back = run.back",
            "    L, V, S, N = m.locals, m.numbered, m.scope, m.names",
            "    g0, g1 = run.lane.motions[:2]",
            f"    unseen = seen.find(0, {first}, {end}) >= 0",
            "    M = asked",
            "    acting = False",
            "    try:",
        ]
        tail = [
            f"        return {end}, True",
            "    except EVALUATION:",
            "        if not acting: return line, False",
            "        run.line = line",
            "        m.line = out.line = line + 1",
            "        raise",
        ]
        space = {
            **ENVIRONMENT,
            **self.space,
            "modes": modes,
            "asked": object(),
            "pack": ROW.pack,
            "EVALUATION": EVALUATION,
        }
        exec(compile("\n".join([*head, *self.lines, *tail]), "<loop>", "exec"), space)
        woven: Loom = space["woven"]
        return woven


def kept_words(statement: Statement, dialect: Dialect) -> list[Word]:
    """The words that are not codes with literal numbers, as Statement.letters has them."""
    macro = takes_arguments(statement.block, dialect)
    return [
        word
        for word in statement.block.words
        if not (isinstance(word.value, Number) and (word.letter == "g" or (word.letter == "m" and not macro)))
    ]


def weave(unit: Unit, first: int) -> Loom | None:
    """The function of the loop that begins at a line; None where it cannot be compiled."""
    try:
        return Weaver(unit).build(first)
    except (Unwoven, Refusal, RecursionError, SyntaxError):
        return None
