"""Where a program goes on behind a line: branches, jumps, calls and ends; and what is told of a line.

`aircut.interpreter.interpreter` runs the lines.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any, NoReturn

from aircut.diagnostics import Fault, Frame, Refusal, Severity, Span
from aircut.diagnostics import faults as F
from aircut.interpreter import macros, starting
from aircut.interpreter.arranging import code_name
from aircut.interpreter.auxiliary import End, Restart
from aircut.interpreter.calls import ARGUMENTS, Call, Return
from aircut.interpreter.compiling import FAILURES, explain
from aircut.interpreter.looms import ASKED, DONE
from aircut.interpreter.midway import Marked
from aircut.interpreter.running import WHOLE, Mode, Settings, Stopped
from aircut.interpreter.table import Code, Dialect, Group
from aircut.interpreter.tooling import TOOL_CHANGE
from aircut.interpreter.unit import Branch, Level, Unit
from aircut.interpreter.weaving import DEEPEST_CALL, weave, weave_routine
from aircut.language.arithmetic import EQUAL
from aircut.language.blocks import Block, parse
from aircut.language.expressions import Number
from aircut.language.structure import Routine
from aircut.machine import INSTALLED, Machine
from aircut.source import Source

WATCH = 64  # passes through a loop that are compared with one before
EVALUATION = (*FAILURES, Refusal)


class Flow(Marked):
    """What leads a run from line to line."""

    unit: Unit
    routine: Routine  # of it, being run

    def __init__(self, source: Source, dialect: Dialect, machine: Machine, settings: Settings | None) -> None:
        super().__init__(source, dialect, machine, settings)
        self.found: dict[str, Path | None] = {}  # macro files by called name
        self.stack: list[Level] = []
        self.returned = False  # the file ended by M99, as macros do
        self.modes: Any = ASKED  # what compiled loops and subroutines hand on, see looms.modes
        self.repeated = 0
        self.passes = 0
        self.watched: tuple[int, dict[str, Any]] | None = None  # a jump back, and the state then
        self.until = 0  # so many passes are compared with it

    # --- diagnostics

    def stack_frames(self) -> tuple[Frame, ...]:
        return tuple(Frame(level.call.name, level.unit.source.name, level.line) for level in self.stack)

    def warn(self, fault: Fault, letter: str = "", **values: Any) -> None:
        """A warning of the block whose move is being written; or an error past which checking goes on as if all were
        well. Raises Stopped for an error in a run.
        """
        out = self.state.out
        unit = self.units[self.files[out.file]]
        self.tell_refusal(Refusal(fault, letter, **values), unit, out.line - 1)
        if fault.severity is Severity.ERROR and not self.settings.keep_going:
            self.halt()

    def tell_refusal(self, refusal: Refusal, unit: Unit, line: int, stack: bool = True) -> None:
        frames = self.stack_frames() if stack else ()
        span = unit.place(line, refusal) if line < len(unit.source) else Span()
        told = refusal.fault.at(unit.source.name, span, frames, **refusal.values)
        if refusal.fault is F.NULL_VALUE and self.stack and (missing := self.missing_argument(refusal.values["what"])):
            told = told._replace(hint=missing)
        self.tell(told)

    def missing_argument(self, what: str) -> str:
        """A hint where a null variable is an argument that the call has not given; empty where it is none."""
        level = self.stack[-1]
        letter = next((letter for letter, number in ARGUMENTS.items() if what == f"#{number}"), "")
        if letter == "" or level.call.arguments is None or letter in level.call.arguments:
            return ""
        place = f"line {level.line} of {level.unit.source.name}"
        return f"{what} is the argument {letter.upper()}, which the call in {place} does not give"

    def check_structure(self, unit: Unit) -> None:
        for line, refusal in unit.structure.faults:
            self.tell_refusal(refusal, unit, line, stack=False)

    def explain(self, unit: Unit, line: int, failure: Exception) -> NoReturn:
        """Raise the Refusal that says what failed in evaluating a line, and where."""
        body = parse(unit.clean(line).code).body
        null = isinstance(body, Block) and any(row.sole for row in self.rows_of(body))
        block = body if isinstance(body, Block) else Block(condition=body.condition if body else None)
        explain(block, self.state, failure, null)

    def rows_of(self, block: Block) -> list[Code]:
        names = ["call"] if block.call else []
        for word in block.words:
            if word.letter in "gm" and isinstance(word.value, Number):
                names.append(code_name(word.letter, word.value.value))
        return [self.dialect.codes[name] for name in names if name in self.dialect.codes]

    # --- branches and jumps

    def branch(self, unit: Unit, line: int, branch: Branch) -> int:
        """Where a mark leads. Raises Refusal."""
        mark, structure = branch.mark, unit.structure
        if mark.kind in ("if", "while"):
            return line + 1 if self.truth(unit, line, branch) else self.otherwise(unit, line)
        if mark.kind == "end":
            start = structure.onward.get(line)
            return line + 1 if start is None else self.back(unit, line, start)
        return structure.onward.get(line, line + 1)  # the end of a branch above: ELIF, ELSE

    def truth(self, unit: Unit, line: int, branch: Branch) -> bool:
        assert branch.condition is not None
        try:
            value = branch.condition(self.state, ())
            if value is None:
                raise TypeError("null condition")
        except EVALUATION as failure:
            self.explain(unit, line, failure)
        return bool(value != 0.0)

    def otherwise(self, unit: Unit, line: int) -> int:
        """The line after a condition that is false: the next branch that is taken."""
        structure = unit.structure
        while True:
            mark = structure.otherwise.get(line)
            if mark is None:  # the block is not closed, which has been told
                return line + 1
            if line in structure.loops:
                return mark
            unit.seen[mark] = 1
            branch = unit.statement(mark)[0]
            if not isinstance(branch, Branch) or branch.mark.kind != "elif":
                return mark + 1
            self.line = line = mark
            if self.truth(unit, line, branch):
                return line + 1

    def jump(self, unit: Unit, line: int, block: Block, label: float | None) -> int:
        """Where GOTO, BREAK or RETURN leads. Raises Refusal."""
        jump = block.jump
        assert jump is not None
        try:
            if jump.kind == "return":
                self.state.transfer = Return()
                return line + 1
            if jump.kind == "break":
                assert isinstance(jump.target, Number)
                return unit.structure.after_break(line, str(int(jump.target.value)))
            if label is None or label != label:
                self.explain(unit, line, TypeError("null label"))
            nearest = round(label) if -EQUAL < label < 1e18 else -1
            if nearest < 0 or abs(label - nearest) > EQUAL:
                raise Refusal(F.NO_TARGET, label=f"{label:g}", place=unit.structure.routine(line).title())
            target = unit.structure.target(line, nearest, unit.source, self.settings.block_delete)
        except Refusal as refusal:
            refusal.where = refusal.where or self.jump_place(unit, line)
            raise
        return target if target > line else self.back(unit, line, target)

    def jump_place(self, unit: Unit, line: int) -> tuple[int, int] | None:
        body = parse(unit.clean(line).code).body
        return body.jump.where if isinstance(body, Block) and body.jump else None

    def back(self, unit: Unit, line: int, target: int) -> int:
        """Jump back: count it, and see whether the loop can ever end. Raises Refusal."""
        self.count(line - target + 1, target, line)
        self.passes += 1
        if target not in unit.looms and target in unit.structure.loops:
            unit.looms[target] = weave(unit, target)
        if self.passes & (self.passes - 1) == 0:
            self.watched = (line, self.state.snapshot())
            self.until = self.passes + WATCH
        elif self.watched and self.watched[0] == line and self.passes <= self.until:
            if self.state.matches(self.watched[1]):
                raise Refusal(F.ENDLESS_LOOP, first=target + 1, last=line + 1)
        return target

    def count(self, blocks: int, first: int, last: int) -> None:
        """Count blocks that run again. Raises Refusal when they are too many."""
        self.repeated += blocks
        if self.repeated > self.settings.limits.blocks:
            raise Refusal(F.BLOCK_BUDGET, limit=self.settings.limits.blocks, first=first + 1, last=last + 1)

    # --- calls and ends

    def follow(self, line: int) -> int:
        """Go where the block's transfer leads; `line` is the one after it. Raises Refusal, Stopped."""
        m = self.state
        transfer, m.transfer = m.transfer, None
        match transfer:
            case Call():
                return self.call(transfer, line)
            case Return():
                return self.leave()
            case Restart():
                return self.restart(line)
            case End():
                self.finish(transfer)
        raise Stopped

    def call(self, call: Call, back: int) -> int:
        """Enter a subroutine; returns its first line. Raises Refusal."""
        if call.repeat == 0:
            return back
        unit, routine = self.lookup(call)
        if len(self.stack) >= DEEPEST_CALL:
            raise Refusal(F.TOO_DEEP, limit=DEEPEST_CALL, what="calls")
        m = self.state
        level = Level(self.unit, self.routine, back, m.line, call, call.repeat, m.locals, m.scope, m.out.moves)
        self.stack.append(level)
        m.calls = len(self.stack)
        line = self.enter(level, unit, routine)
        if call.file or call.numbers or self.midway is not None or self.mark:
            return line
        key, caller = (call.name, call.numbered), level.unit
        caller.called[key] += 1
        if caller.called[key] == 2 and (callee := weave_routine(unit, routine)) is not None:
            caller.callees[key] = callee
        if key not in caller.callees:
            return line
        self.modes = ASKED
        place = caller.callees[key].run(self)
        return back if place is DONE else place[0]

    def enter(self, level: Level, unit: Unit, routine: Routine) -> int:
        """Start a subroutine, for the first time or again."""
        m = self.state
        self.unit, self.routine = unit, routine
        m.out.file = self.files.index(unit.source.name)
        m.scope = {}
        self.count(1, routine.first, routine.first)
        m.motion = m.modal[Group.MOTION]
        if level.call.own_locals:
            m.locals = [None] * 34
            m.locals[1 : 1 + len(level.call.numbers)] = level.call.numbers
        if level.call.arguments is not None:
            for letter, value in level.call.arguments.items():
                m.locals[ARGUMENTS[letter]] = value
                m.scope[f"_args.{letter}"] = value
        return routine.first

    def lookup(self, call: Call) -> tuple[Unit, Routine]:
        """The subroutine of a name: in the calling file, then in the macros folders. Raises Refusal."""
        name = call.name.lower()
        routine = self.unit.structure.routines.get(name)
        if routine is not None and not call.file and (call.numbered or not macros.has_extension(call.name)):
            return self.unit, routine
        written = f"O{call.name}" if call.numbered else call.name
        unit = self.external(written)
        if unit is None:
            folders = (*self.machine.macros, INSTALLED)
            hint = macros.searched(written, folders, () if call.file else self.unit.structure.routines)
            raise Refusal(F.NO_SUBROUTINE, "p", name=written, hint=hint)
        entry = unit.entry()
        stem = macros.stem(call.name).lower()
        named = entry.name in (call.name.lower(), stem, stem.removeprefix("o"))
        return unit, entry if named else unit.structure.main

    def external(self, name: str) -> Unit | None:
        """The unit of a macro file. Raises Refusal for names that are no file names."""
        if name not in self.found:
            self.found[name] = macros.find(name, (*self.machine.macros, INSTALLED))
        found = self.found[name]
        if found is None:
            return None
        key = str(found)
        if key not in self.units:
            source = macros.load(found, self.machine.key)
            self.units[key] = Unit(source, self.dialect, self.settings.block_delete, self.settings.limits.line)
            self.files.append(key)
            self.check_structure(self.units[key])
            if self.failed and not self.settings.keep_going:
                raise Stopped
        return self.units[key]

    def leave(self) -> int:
        """M99, ENDSUB, RETURN: run the subroutine again, or go back to the caller. Raises Stopped."""
        if not self.stack:  # at top level it ends the program like the end of the file (AMB-CALL-10)
            self.returned = True
            return self.run_off()
        m = self.state
        level = self.stack.pop()
        self.count(max(m.line - self.routine.first, 0), self.routine.first, m.line - 1)
        if level.left > 1:
            self.stack.append(level._replace(left=level.left - 1))
            if level.call.own_locals:
                m.locals = level.locals
            return self.enter(level, self.unit, self.routine)
        if level.call.own_locals:
            m.locals = level.locals
        m.scope = level.scope
        m.calls = len(self.stack)
        if m.macro is not None and m.calls == m.macro_level:
            m.motion = self.dialect.codes["g1" if m.macro_motion else "g0"]
        if level.call.name == TOOL_CHANGE and not m.declared:
            self.tell_refusal(Refusal(F.TOOL_NOT_DECLARED, tool=m.tool), level.unit, level.line - 1)
        self.unit, self.routine = level.unit, level.routine
        m.out.file = self.files.index(level.unit.source.name)
        m.line = m.out.line = level.line
        if level.call.then is not None:
            m.transfer = level.call.then
            return self.follow(level.back)
        return level.back

    @property
    def macro_file(self) -> bool:
        """Whether the file is a macro, run by itself: it begins with an O or SUB, or ended by M99."""
        main = self.units[self.files[0]]
        return self.returned or main.entry() is not main.structure.main

    def run_off(self) -> int:
        """The routine has no more lines. Raises Stopped at the end of the program."""
        if self.stack:
            if self.routine.name and self.unit is self.stack[0].unit:
                refusal = Refusal(F.NO_SUBROUTINE_END, name=self.routine.name)
                self.tell_refusal(refusal, self.unit, self.routine.declared)
                if not self.settings.keep_going:
                    raise Stopped
            return self.leave()
        if self.settings.mode is Mode.MDI:
            raise Stopped
        if not self.unit.percent and not self.macro_file and self.settings.mode in WHOLE:
            last = self.routine.end - 1
            while last > 0 and not self.unit.seen[last]:
                last -= 1
            self.tell_refusal(Refusal(F.NO_PROGRAM_END), self.unit, last)
        self.finish(End(reset=False))
        raise Stopped

    def restart(self, line: int) -> int:
        """M47: from the first line again, as often as the settings allow. Raises Stopped."""
        self.state.restarts += 1
        if self.state.restarts > self.settings.restarts:
            self.finish(End(reset=False))
            raise Stopped
        self.count(line, 0, line)
        self.stack.clear()
        self.unit = self.units[self.files[0]]
        self.routine = self.unit.entry()
        self.state.out.file = 0
        return self.routine.first

    def finish(self, end: End) -> None:
        self.ended = end
        self.not_arrived()
        starting.finish(self.state, end)
