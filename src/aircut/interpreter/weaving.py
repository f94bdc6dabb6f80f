"""Loops and subroutines as Python functions: what repeats is compiled whole.

The general lane stays the meaning. A function does what that would, line by line,
and gives a line back before anything of it has happened where the line asks for more:
a value that cannot be computed, a jump, a limit in the way, a line not run before.
Straight moves are packed here; all other codes are carried out by the interpreter.
"""

from __future__ import annotations

from typing import Any

from aircut.canon import CHUNK, ROW, Kind
from aircut.diagnostics import Refusal
from aircut.interpreter import calls
from aircut.interpreter.compiling import ENVIRONMENT
from aircut.interpreter.looms import (
    ASKED,
    DONE,
    EVALUATION,
    LINEAR_PLACE,
    Callee,
    Loom,
    Values,
    kept_words,
    modes,
    plain_name,
    scope_of,
    template,
)
from aircut.interpreter.table import Group
from aircut.interpreter.tooling import TOOL_CHANGE
from aircut.interpreter.unit import Branch, Level, Statement, Unit
from aircut.kernels import scan
from aircut.language.arithmetic import LARGEST
from aircut.language.blocks import Mark, parse
from aircut.language.expressions import Application, Binary, Expression, Name, Number, Text, Variable
from aircut.language.structure import Routine

DEEPEST_CALL = 100
LOCALS = 34
FULL = CHUNK * ROW.size
STRAIGHT = {"g0": int(Kind.TRAVERSE), "g1": int(Kind.FEED)}
LINEAR = "xyz"
SYSTEM = 5000  # writing variables from here on may change modes


class Unwoven(Exception):
    """It cannot be compiled."""


class Weaver:
    """Writes the function of one loop or subroutine."""

    def __init__(self, unit: Unit, routine: Routine | None = None) -> None:
        """routine: the one that is to be compiled, no loop."""
        self.unit = unit
        self.routine = routine
        self.lines: list[str] = []
        self.space: dict[str, Any] = {"unit": unit, "seen": unit.seen}

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
            "passes = run.passes + 1",
            f"if passes & run.passes == 0 or passes <= run.until or run.repeated + {last - first + 1} > limit:",
            f"    line = {last}",
            "    acting = True",
            f"    back(unit, {last}, {first})",
            "    acting = False",
            "else:",
            "    run.passes = passes",
            f"    run.repeated += {last - first + 1}",
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
        if self.routine is not None and self.returns(whole):
            self.back(depth, at, self.routine)
        elif block.jump is not None or not self.settings_known(whole):
            self.put(depth, f"return {at}, False")
        elif not self.call(depth, at, whole):
            self.statement(depth, at, whole)

    def returns(self, statement: Statement) -> bool:
        """Whether a line leads back to the caller, and does no more."""
        block = statement.block
        if statement.letters or block.settings or statement.comment:
            return False
        if block.jump is not None:
            return block.jump.kind in ("return", "endsub") and not statement.codes
        rows = [self.unit.dialect.codes.get(name) for name in statement.codes]
        return len(rows) == 1 and rows[0] is not None and rows[0].run is calls.back

    def back(self, depth: int, at: int, routine: Routine) -> None:
        """Go back to the caller of a subroutine."""
        blocks = max(at + 1 - routine.first, 0)
        self.put(
            depth,
            f"if not stack: return {at}, False",
            "to, routine, _, called, call, left, kept, scope, _ = stack[-1]",
            "if left != 1 or call.then is not None or call.name == TOOL_CHANGE or m.macro is not None"
            f" or run.repeated + {blocks} > limit: return {at}, False",
            "stack.pop()",
            f"run.repeated += {blocks}",
            "if call.own_locals: m.locals = kept",
            "m.scope = scope",
            "m.calls = len(stack)",
            "run.unit, run.routine = to, routine",
            "if to is not unit: out.file = run.files.index(to.source.name)",
            f"run.line = {at}",
            "m.line = out.line = called",
            "run.modes = M",
            "return done",
        )

    def call(self, depth: int, at: int, statement: Statement) -> bool:
        """A call of a subroutine by its function, where it has one; False if the line is no such call."""
        row = self.unit.dialect.codes.get(statement.codes[0]) if len(statement.codes) == 1 else None
        if row is None or row.run not in (calls.macro, calls.call) or statement.moving:
            return False
        words = kept_words(statement, self.unit.dialect)
        own = row.run is calls.macro
        target = next((word.value for word in words if word.letter == "p"), None)
        given = [word for word in words if word.letter != "p"]
        if statement.block.settings or statement.comment or any(word.letter not in calls.ARGUMENTS for word in given):
            return False
        if not isinstance(target, Number | Text) or (given and not own):
            return False
        name, numbered = calls.callee({"p": target.value if isinstance(target, Number) else target.text})
        for i, word in enumerate(given):
            self.value(depth, f"a{i}", word.value, at)
            if not isinstance(word.value, Number):
                self.put(depth, f"if a{i} is None: return {at}, False")
        places = {calls.ARGUMENTS[word.letter]: f"a{i}" for i, word in enumerate(given)}
        arguments = ", ".join(f"{word.letter!r}: a{i}" for i, word in enumerate(given))
        scope = ", ".join(f"'_args.{word.letter}': a{i}" for i, word in enumerate(given))
        self.put(
            depth,
            f"callee = callees.get({(name, numbered)!r})",
            f"if callee is None or len(stack) >= {DEEPEST_CALL} or run.repeated >= limit or m.compensating"
            f" or m.macro is not None: return {at}, False",
            f"call = new(Call, ({name!r}, {numbered}, 1, {'{' + arguments + '}' if own else None}, (), None, False))",
            f"stack.append(new(Level, (unit, run.routine, {at + 1}, {at + 1}, call, 1, L, S,"
            f" out.first + len(out.rows) // {ROW.size})))",
            "m.calls = len(stack)",
            "_, run.unit, run.routine = callee",
            "if run.unit is not unit: out.file = run.files.index(run.unit.source.name)",
            f"m.scope = {{{scope if own else ''}}}",
            "run.repeated += 1",
            "if M is asked or M is None: m.motion = m.modal[motion_group]",  # else it is that
        )
        if own:
            self.put(
                depth, "m.locals = own = nulls[:]", *(f"own[{place}] = {value}" for place, value in places.items())
            )
        self.put(
            depth,
            "run.modes = M",
            "acting = None",
            "place = callee.run(run)",
            "acting = False",
            "if place is not done: return place",
            "M = run.modes",
        )
        return True

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
                self.put(depth, f"if not i < {SYSTEM}: M = asked")
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
        self.put(
            depth,
            "if known is not M:",
            "    absolute, scale, lx, hx, ly, hy, lz, hz, ox, oy, oz, rest = known = M",
            "    here = None",
            "if here is not m.position: x, y, z, a, b, c = here = m.position",
        )
        for letter, word in words.items():
            self.put(depth, f"n{letter} = {word} * scale if absolute else {letter} + {word} * scale")
        inside = " and ".join(f"l{letter} <= n{letter} <= h{letter}" for letter in words)
        self.put(depth, f"if not ({inside}): return {at}, False")
        for letter in words:
            self.put(depth, f"{letter} = n{letter}")
        if code:
            self.put(depth, f"if m.motion is not {code}:")
            self.put(depth + 1, f"m.modal[motion_group] = m.motion = {code}", "m.cycle = None")
        else:
            self.put(depth, "kind = 1 if m.motion is g1 else 0")
        kind = str(STRAIGHT[code]) if code else "kind"
        self.space[f"r_{at}"] = [None, None, None]  # the row of this line but for its place, and what it was made for
        self.put(
            depth,
            f"if r_{at}[0] is not M{'' if code else f' or r_{at}[2] != kind'}:",
            f"    r_{at}[:] = M, template(rest, {at + 1}, {kind}, out.file), {kind}",
            f"row = r_{at}[1]",
            "place_in(row, 0, x + ox, y + oy, z + oz)",
            "out.rows += row",
            "m.position = here = [x, y, z, a, b, c]",
        )

    def build(self, first: int, end: int, last: str) -> Loom:
        """The function of these lines. last: what it returns when it is through them."""
        head = [
            "def woven(run):",
            "    m = run.state",
            "    out = m.out",
            "    back = run.back",
            "    L, V, S, N = m.locals, m.numbered, m.scope, m.names",
            "    stack, callees, limit = run.stack, unit.callees, run.settings.limits.blocks",
            "    g0, g1 = run.lane.motions[:2]",
            f"    unseen = seen.find(0, {first}, {end}) >= 0",
            "    M = run.modes",
            "    known = here = None",
            "    acting = False",
            "    try:",
            *self.lines,
            f"        return {last}",
            "    except EVALUATION:",
            "        if acting is None: raise",
            "        if not acting: return line, False",
            "        run.line = line",
            "        m.line = out.line = line + 1",
            "        raise",
        ]
        space = {
            **ENVIRONMENT,
            **self.space,
            "modes": modes,
            "asked": ASKED,
            "done": DONE,
            "new": tuple.__new__,
            "Level": Level,
            "Call": calls.Call,
            "TOOL_CHANGE": TOOL_CHANGE,
            "nulls": [None] * LOCALS,
            "motion_group": Group.MOTION,
            "template": template,
            "place_in": LINEAR_PLACE.pack_into,
            "EVALUATION": EVALUATION,
        }
        exec(compile("\n".join(head), "<woven>", "exec"), space)
        woven: Loom = space["woven"]
        return woven


def weave(unit: Unit, first: int) -> Loom | None:
    """The function of the loop that begins at a line; None where it cannot be compiled."""
    weaver = Weaver(unit)
    try:
        end = weaver.loop(2, first)
        return weaver.build(first, end, f"{end}, True")
    except (Unwoven, Refusal, RecursionError, SyntaxError):
        return None


def weave_routine(unit: Unit, routine: Routine) -> Callee | None:
    """The function of a subroutine; None where it cannot be compiled."""
    weaver = Weaver(unit, routine)
    try:
        weaver.body(2, routine.first, routine.end)
        return Callee(weaver.build(routine.first, routine.end, f"{routine.end}, True"), unit, routine)
    except (Unwoven, Refusal, RecursionError, SyntaxError):
        return None
