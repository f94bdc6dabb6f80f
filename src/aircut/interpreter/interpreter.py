"""The interpreter: runs a program block by block, in the dialect's order of execution."""

from __future__ import annotations

import re
from collections.abc import Generator
from typing import Any

from aircut.canon import CHUNK, ROW, Chunk
from aircut.diagnostics import Refusal, Span
from aircut.diagnostics import faults as F
from aircut.interpreter import compensation, path, starting, unrun
from aircut.interpreter.arranging import Steps, arrange, code_name, find
from aircut.interpreter.flow import EVALUATION, Flow
from aircut.interpreter.inputs import switched_off
from aircut.interpreter.lane import Lane
from aircut.interpreter.looms import ASKED
from aircut.interpreter.requests import Request
from aircut.interpreter.running import Settings, Stopped
from aircut.interpreter.state import State
from aircut.interpreter.table import Code, Dialect, Group, Words
from aircut.interpreter.unit import Branch, Shape, Statement, Unit
from aircut.kernels import scan
from aircut.language.arithmetic import is_null
from aircut.language.blocks import Block, parse
from aircut.machine import Machine
from aircut.source import Source

FULL = CHUNK * ROW.size
STRETCH = 4  # lines without others among them that the fast lane is worth while for
PLAIN, BLANK = scan.PLAIN, scan.BLANK
FATAL = (F.BLOCK_BUDGET, F.ENDLESS_LOOP, F.USER_ERROR, F.PROBE_FAILED, F.INPUT_TIMEOUT, F.OPERATOR_STOP)
#: Modal groups that the line of an MDI desk shows.
STANDING = ("MOTION", "PLANE", "UNITS", "DISTANCE", "FEED_MODE", "SYSTEM", "CUTTER", "TOOL_LENGTH")
UTF16 = (b"\xff\xfe", b"\xfe\xff")  # byte order marks
SHAPE_WORD = re.compile(rb"([a-z])([\d.]*)")


class Interpreter(Flow):
    """Runs one program on one machine. Iterate `run()`; then read `state` and `diagnostics`."""

    scratch = "_value"

    def __init__(self, source: Source, dialect: Dialect, machine: Machine, settings: Settings | None = None) -> None:
        super().__init__(source, dialect, machine, settings)
        settings = self.settings
        self.state = State(dialect, machine, self.warn)
        self.unit = Unit(source, dialect, settings.block_delete, settings.limits.line)
        self.units = {source.name: self.unit}
        self.ran = False  # the program was fit to be run
        self.plans: dict[bytes, Shape] = {}
        self.lane = Lane(self.state, min(len(source), settings.limits.moves or 0))
        self.routine = self.unit.entry()
        #: A code that asks the world: its conversation, the codes still to run, and the block's words.
        self.talk: tuple[Generator[Request, Any, None], tuple[Code, ...], Words] | None = None

    # --- the run

    def execute(self) -> Generator[Chunk | Request, Any, None]:
        """Run the program: yields motion and events, and requests, to be sent replies (None: not executed)."""
        m = self.state
        starting.begin(m)
        self.check_structure(self.unit)
        if self.unit.source.data[:2] in UTF16:
            self.tell(F.NOT_UTF8.at(self.unit.source.name, Span(1, 1, 2)))
        elif not len(self.unit.source) or not any(self.unit.source.classes):
            self.tell(F.EMPTY_PROGRAM.at(self.unit.source.name, Span()))
        elif (self.settings.keep_going or not self.failed) and self.prepare():
            try:
                self.ran = True
                yield from self.blocks()
            except Stopped:
                m.out.drop()
            yield from switched_off(m)
            unrun.check(self)
        if self.midway is not None:
            self.midway.drop(m)
            m.out.first = 0
        m.out.event("ON_RESET")
        m.out.event("ON_RESET")
        yield m.out.take()

    def bound(self) -> int:
        """The line at which the main loop looks up: the routine's end; 0, at every line, where the mark lies in it."""
        if (
            self.mark
            and self.unit is self.units[self.files[0]]
            and self.routine == self.unit.structure.routine(self.mark - 1)
        ):
            return 0
        return self.routine.end

    def in_force(self) -> tuple[tuple[str, ...], str]:
        modal = self.state.modal
        return tuple(row.name for row in modal.values()), modal[Group.CUTTER].name

    def called_from(self) -> tuple[int, int] | None:
        return (self.stack[0].line, self.stack[0].moves) if self.stack else None

    def begin(self) -> None:
        starting.begin(self.state)

    def command(self, source: Source) -> Generator[Chunk | Request, Any, None]:
        unit = Unit(source, self.dialect, self.settings.block_delete, self.settings.limits.line)
        self.enter_command(unit)
        if not self.failed and any(unit.source.classes):
            try:
                yield from self.blocks()
            except Stopped:
                pass
            yield from switched_off(self.state)
        self.leave_command()

    def standing(self) -> tuple[str, ...]:
        return tuple(row.name for group, row in self.state.modal.items() if group.name in STANDING)

    def enter_command(self, unit: Unit) -> None:
        """Make ready for a command of its own, with the modes and global variables as they are."""
        m = self.state
        self.unit = self.units[self.files[0]] = unit
        self.routine = unit.entry()
        self.diagnostics = []
        self._told.clear()
        self.repeated = self.passes = self.until = 0
        self.watched = self.ended = None
        m.locals, m.scope = [None] * 34, {}
        self.check_structure(unit)

    def leave_command(self) -> None:
        """Nothing of a command that failed stays open."""
        m = self.state
        if self.stack:
            self.unit = self.stack[0].unit
            self.stack.clear()
        m.calls = m.out.file = m.out.line = 0
        m.transfer = self.talk = None
        m.exact_stop = m.machine_frame = False
        try:
            path.flush(m)
        except Refusal as refusal:
            self.tell_refusal(refusal, self.unit, self.line)

    def blocks(self) -> Generator[Chunk | Request, Any, None]:
        """The main loop: each turn of the outer one enters a routine, each of the inner one runs a line."""
        m = self.state
        out = m.out
        plans = self.plans
        line = self.routine.first
        while True:
            unit, routine, end = self.unit, self.routine, self.bound()
            classes, seen, cache = unit.source.classes, unit.seen, unit.plain
            slow, looms = unit.slow, unit.looms
            here = True
            while here:
                if line >= end:
                    place = line if line < self.routine.end else self.line
                    try:
                        if line >= self.routine.end:
                            line = self.run_off()
                            break
                        self.pass_mark(line)
                    except Refusal as refusal:
                        self.tell_refusal(refusal, unit, place)
                        out.line = 0
                        raise Stopped from None
                    end = self.bound()
                kind = classes[line]
                seen[line] = 1
                if kind == BLANK:
                    line += 1
                    continue
                self.line = line
                m.line = out.line = line + 1
                try:
                    if kind == PLAIN:
                        if not slow[line]:
                            after = self.glide(line)
                            if after > line:
                                line = after
                                if out.used > out.stowed:
                                    self.check_moves()
                                    yield out.take()
                                continue
                        known = cache.get(line)
                        if known is None:
                            words, values = unit.words(line)
                            if classes[line] != PLAIN:
                                continue
                            shape = plans.get(words) or self.plan(words)
                            if shape is None:
                                classes[line] = scan.OTHER
                                continue
                            if self.repeated:
                                cache[line] = (shape, values)
                        else:
                            shape, values = known
                        steps = shape.steps.get(m.motion) or self.arranged(shape.codes, shape.letters, shape.steps)
                        w = dict(zip(shape.letters, values))  # noqa: B905  one value a letter by construction
                        self.carry_out(steps.codes, w)
                        line += 1
                    elif line in looms:
                        line = self.repeat(unit, line)
                        here = self.routine is routine
                    else:
                        line = self.step(unit, line)
                    while self.talk is not None or m.transfer is not None:
                        if self.talk is not None:
                            yield from self.converse()
                        if m.transfer is not None:
                            line = self.follow(line)
                            here = False
                except Refusal as refusal:
                    self.tell_refusal(refusal, self.unit, self.line)
                    if not self.settings.keep_going or refusal.fault in FATAL:
                        self.halt()
                    self.recover(refusal)
                    line = self.unit.structure.otherwise.get(self.line, self.line + 1)
                    here = self.routine is routine
                if len(out.rows) >= FULL:
                    self.check_moves()
                    if self.midway is None:
                        yield out.take()
                    else:
                        self.midway.drop(m)

    def repeat(self, unit: Unit, line: int) -> int:
        """Run a loop that has been compiled whole; returns the line to go on with. Raises Refusal."""
        loom = unit.looms[line]
        if loom is None or self.midway is not None or self.mark:
            return self.step(unit, line)
        self.modes = ASKED
        line, whole = loom(self)
        if whole:
            return line
        self.unit.seen[line] = 1
        self.line = line
        self.state.line = self.state.out.line = line + 1
        return self.step(self.unit, line)

    def glide(self, line: int) -> int:
        """Run a stretch of plain motion in the fast lane; returns the line to go on with, `line` if there is none."""
        unit = self.unit
        m = self.state
        if self.mark or unit.source.classes.find(scan.OTHER, line, line + STRETCH) >= 0 or not self.lane.open(m):
            unit.slow[line] = 1
            return line
        after = self.lane.run(m, unit.source, line, self.routine.end)
        if after == line:
            unit.slow[line] = 1
            return line
        unit.seen[line:after] = b"\x01" * (after - line)
        self.line = after - 1
        row = self.lane.motions[self.lane.motion]
        if row is not m.motion and not (m.motion and m.motion.cycle):
            self.set_mode(row)
        return after

    def recover(self, refusal: Refusal) -> None:
        """Make ready for the block after one at fault."""
        m = self.state
        m.transfer = self.talk = None
        m.exact_stop = m.machine_frame = False

    def check_moves(self) -> None:
        limit = self.settings.limits.moves
        if limit is not None and self.state.out.moves > limit:
            self.warn(F.OUTPUT_LIMIT, limit=limit)
            raise Stopped

    def set_mode(self, row: Code) -> None:
        m = self.state
        m.modal[row.group] = row
        if not row.cycle and row.group is Group.MOTION:
            m.cycle = None
        if row.group is Group.MOTION and (m.macro is None or m.calls != m.macro_level):
            m.motion = row

    # --- blocks

    def plan(self, words: bytes) -> Shape | None:
        """What plain lines of this shape (see kernels.scan) mean; None leaves them to the general lane."""
        codes: list[str] = []
        letters: list[str] = []
        for match in SHAPE_WORD.finditer(words):
            letter = match[1].decode()
            if match[2]:
                codes.append(code_name(letter, float(match[2])))
            else:
                letters.append(letter)
        if any(name[0] == "m" for name in codes) and any(self.is_macro(name) for name in codes):
            return None  # its M is an argument
        shape = self.plans[words] = Shape(tuple(codes), tuple(letters), {})
        return shape

    def shape(self, unit: Unit, line: int) -> Shape | None:
        """What a plain line means; None for all others."""
        if unit.source.classes[line] != PLAIN:
            return None
        words = unit.source.words(line)[0]
        return self.plan(words) if unit.source.classes[line] == PLAIN else None

    def is_macro(self, name: str) -> bool:
        return name[0] == "g" and name in self.dialect.codes and self.dialect.codes[name].sole

    def arranged(self, codes: tuple[str, ...], letters: tuple[str, ...], known: dict[Any, Steps]) -> Steps:
        """The steps of a block under the motion mode in force, remembered in `known`. Raises Refusal."""
        motion = self.state.motion
        rows = [find(name, self.dialect, name[0]) for name in codes]
        steps = known[motion] = arrange(rows, letters, motion, self.dialect, self.state.axes)
        return steps

    def step(self, unit: Unit, line: int) -> int:
        """Run a line of the general lane; returns the line to go on with. Raises Refusal."""
        statement, literals = unit.statement(line)
        if statement is None:
            return line + 1
        if isinstance(statement, Branch):
            return self.branch(unit, line, statement)
        m = self.state
        try:
            if statement.condition is not None:
                truth = statement.condition(m, literals)
                if truth is None:
                    raise TypeError("null condition")
                if truth == 0.0:
                    return line + 1
            values, results = statement.values(m, literals)
            targets = [
                (kind, target(m, literals) if kind in ("named", "computed") else target)
                for kind, target in statement.targets
            ]
            label = statement.jump(m, literals) if statement.jump else None
        except EVALUATION as failure:
            self.explain(unit, line, failure)
        for (kind, target), value in zip(targets, results):  # noqa: B905  one value a target by construction
            if kind == "local":
                m.locals[target] = value
            elif kind == "numbered":
                m.numbered[target] = value
            else:
                self.assign(unit, line, kind == "named", target, value)
        if statement.comment is not None:
            text = statement.comment.lstrip()
            if text or statement.comment:
                m.out.event("COMMENT", text)
        if statement.codes or values:
            self.perform(unit, line, statement, values)
        return self.jump(unit, line, statement.block, label) if statement.block.jump else line + 1

    def assign(self, unit: Unit, line: int, named: bool, target: Any, value: float | None) -> None:
        try:
            if named:
                self.state.write_name(target, value)
            else:
                self.state.write(target, value)
        except (Refusal, TypeError) as failure:
            if isinstance(failure, Refusal):
                block = parse(unit.clean(line).code).body
                assert isinstance(block, Block)
                wheres = [setting.target.where for setting in block.settings]
                failure.where = wheres[-1] if len(wheres) == 1 else None
                raise
            self.explain(unit, line, failure)

    def perform(self, unit: Unit, line: int, statement: Statement, values: tuple[Any, ...]) -> None:
        """Carry out the codes and words of a block. Raises Refusal."""
        m = self.state
        codes, letters = statement.codes, statement.letters
        if statement.moving:
            if any(letter in "gm" and is_null(value) for letter, value in zip(letters, values, strict=True)):
                self.explain(unit, line, TypeError("null word"))
            codes, letters, values = self.computed_codes(codes, letters, values)
            steps = self.arranged(codes, letters, {})
        else:
            steps = statement.steps.get(m.motion) or self.arranged(codes, letters, statement.steps)
        w = dict(zip(letters, values, strict=True))
        if None in values or any(value != value for value in values):
            if not steps.null or is_null(w.get("p", 0.0)) or is_null(w.get("l", 0.0)):
                self.explain(unit, line, TypeError("null word"))
        self.carry_out(steps.codes, w)

    def carry_out(self, codes: tuple[Code, ...], w: Words) -> None:
        """Run the codes of a block in turn, up to one that has something to ask. Raises Refusal."""
        m = self.state
        for row in codes:
            if m.compensating:
                compensation.before(m, row)
            if row.modal:
                self.set_mode(row)
            if (talk := row.run(m, w)) is not None:
                self.talk = (talk, codes[codes.index(row) + 1 :], w)
                return

    def converse(self) -> Generator[Request, Any, None]:
        """Carry on a block whose code has something to ask, and the codes after it. Raises Refusal."""
        assert self.talk is not None
        talk, rest, w = self.talk
        self.talk = None
        self.state.asked += 1
        if self.midway is None:
            yield from talk
        else:
            for _ in talk:  # before the start nobody is asked: not executed
                pass
        self.carry_out(rest, w)
        if self.talk is not None:
            yield from self.converse()

    def computed_codes(
        self, codes: tuple[str, ...], letters: tuple[str, ...], values: tuple[Any, ...]
    ) -> tuple[tuple[str, ...], tuple[str, ...], tuple[Any, ...]]:
        """Words like G#1 turned into codes. Raises Refusal."""
        named = list(codes)
        rest: dict[str, Any] = {}
        for letter, value in zip(letters, values, strict=True):
            if letter in "gm":
                if value is None:
                    raise Refusal(F.NULL_VALUE, letter, what=f"the number of {letter.upper()}", operation="no code")
                named.append(code_name(letter, value))
            elif letter in rest:
                raise Refusal(F.REPEATED_WORD, letter, word=letter.upper())
            else:
                rest[letter] = value
        return tuple(named), tuple(rest), tuple(rest.values())
