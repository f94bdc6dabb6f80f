"""Runs programs of LinuxCNC's language, line by line.

Source: the canonical listing, sections 3, 6, 7 and 9.
"""

from __future__ import annotations

import re
from collections.abc import Generator
from typing import Any

from aircut.canon import CHUNK, ROW, Chunk, Recorder
from aircut.diagnostics import Frame, Refusal, Severity, Span
from aircut.diagnostics import faults as F
from aircut.interpreter import path
from aircut.interpreter.compiling import FAILURES
from aircut.interpreter.linuxcnc import files, places, remapping, starting, unrun
from aircut.interpreter.linuxcnc.arranging import arrange, gather, whole
from aircut.interpreter.linuxcnc.blocks import OLine
from aircut.interpreter.linuxcnc.files import Line, Text
from aircut.interpreter.linuxcnc.flow import Flow, Search
from aircut.interpreter.linuxcnc.lane import Lane
from aircut.interpreter.linuxcnc.looms import ASKED, Loom, steady
from aircut.interpreter.linuxcnc.performing import Blocks
from aircut.interpreter.linuxcnc.placing import sub_of
from aircut.interpreter.linuxcnc.saving import snapshot
from aircut.interpreter.linuxcnc.state import LOCALS, State
from aircut.interpreter.linuxcnc.text import LONGEST, too_long
from aircut.interpreter.linuxcnc.weaving import weave_loop, weave_routine
from aircut.interpreter.requests import Request
from aircut.interpreter.running import Log, Mode, Settings, Stopped
from aircut.interpreter.table import Dialect
from aircut.kernels import scan
from aircut.language.text import COMMENT
from aircut.machine import Machine
from aircut.source import Source

#: A line number with more than one point: where lines are passed over, nobody minds.
DOTTED = re.compile(rb"[ \t]*/?[ \t]*n[ \t]*\d[\d \t]*\.[\d \t]*\.", re.IGNORECASE)
STRETCH = 4  # lines without others among them that the fast lane is worth while for
FULL = CHUNK * ROW.size
FATAL = (F.BLOCK_BUDGET, F.ABORTED)


class Interpreter(Blocks):
    """A run of a program of this language."""

    scratch = "mdi"

    def __init__(self, source: Source, dialect: Dialect, machine: Machine, settings: Settings | None = None) -> None:
        ini = machine.ini
        self.remaps = ini.remaps if ini is not None else ()
        super().__init__(source, remapping.extended(dialect, self.remaps), machine, settings)
        if ini is not None:
            for code in remapping.idle(self.remaps, dialect):
                self.tell(F.IDLE_REMAP.at(str(ini.path), Span(), code=code))
        self.state = State(dialect, machine, self.warn)
        self.mark_sub = ""  # subroutine that the mark stands in
        self.unit = Text(source)
        self.units = {source.name: self.unit}
        for name, value in machine.names.items():  # kept from the run before
            self.state.write_name(name, value)
        self.own = self.state.scope  # named variables of the main program
        self.flow = Flow(self)
        self.routines: dict[str, Loom] = {}  # subroutines compiled whole
        self.called: dict[str, int] = {}  # how often those that are not
        self.next_line = 0
        self.argument_cache: dict[OLine, Any] = {}
        self.percent = False
        self.broken = False  # the run ended before its end, in the main program
        self.found: dict[str, Text | None] = {}
        self.folders = files.folders(source.name, machine.macros)
        self.lane = Lane(self.state, min(len(source), self.settings.limits.moves or 0))

    # --- diagnostics

    def warn(self, fault: Any, letter: str = "", **values: Any) -> None:
        """A warning of the block being run. Raises Refusal for an error."""
        if fault.severity is Severity.ERROR:
            raise Refusal(fault, letter, **values)
        self.tell_refusal(Refusal(fault, letter, **values))

    def tell_refusal(self, refusal: Refusal) -> None:
        text = self.unit
        frames = tuple(Frame(level.label, level.text.source.name, level.line) for level in self.flow.stack)
        span = places.span(text.source, self.line, refusal) if self.line < len(text.source) else Span()
        self.tell(refusal.fault.at(text.source.name, span, frames, **refusal.values))

    # --- the run

    def begin(self) -> None:
        starting.begin(self.state)

    def command(self, source: Source) -> Generator[Chunk | Request, Any, None]:
        m = self.state
        self.unit = self.units[self.files[0]] = Text(source)
        self.diagnostics = []
        self._told.clear()
        self.flow = Flow(self)
        self.routines.clear()
        self.called.clear()
        self.next_line = self.repeated = 0
        self.ended = self.talk = None
        m.finished = False
        m.scope = self.own
        try:
            yield from self.lines()
        except Stopped:
            pass
        if self.flow.stack:  # a fault in a subroutine: its caller's values come back
            first = self.flow.stack[0]
            m.saved = first.saved
            if first.locals is not None:
                m.numbered[1 : LOCALS + 1] = first.locals
        m.scope = self.own
        m.calls = m.out.file = m.out.line = 0
        m.transfer = self.talk = None
        try:
            path.flush(m)
        except Refusal as refusal:
            self.tell_refusal(refusal)
        if m.finished:
            starting.renew(m)
            self.modal = self.dialect.codes["g1"]

    def execute(self) -> Generator[Chunk | Request, Any, None]:
        m = self.state
        starting.begin(m)
        source = self.unit.source
        first = next((at for at in range(len(source)) if source.raw(at).strip()), None)
        if first is None:
            self.tell(F.EMPTY_PROGRAM.at(source.name, Span())._replace(severity=F.END_MISSING.severity))
            yield m.out.take()
            return
        if source.length(first) > LONGEST:  # found when the file is opened
            self.line = first
            self.tell_refusal(too_long(source.length(first)))
            yield m.out.take()
            return
        m.out.event("ON_RESET")
        if source.raw(first).strip() == b"%":
            self.percent = True
            self.next_line = first + 1
        if self.prepare():
            self.mark_sub = sub_of(self.unit, self.mark - 1) if self.mark else ""
            try:
                yield from self.lines()
            except Stopped:
                pass
        if self.midway is not None:
            self.midway.drop(m)
            m.out.first = 0
        if self.settings.keep_going:
            unrun.check(self, self.broken)
        locals_ = self.flow.stack[0].scope if self.flow.stack else m.scope
        self.machine.names = {name: value for name, value in (m.names | locals_).items() if value is not None}
        m.out.drop()
        m.out.line = 0
        for _ in range(m.ini.resets):
            m.out.event("ON_RESET")
        yield m.out.take()

    def lines(self) -> Generator[Chunk | Request, Any, None]:
        """The main loop: a line a turn."""
        m = self.state
        out = m.out
        while True:
            self.line = self.next_line
            if self.line >= len(self.unit.slow):
                self.run_off()
                continue
            self.next_line = self.line + 1
            m.line = out.line = self.line + 1
            try:
                if self.mark and self.unit is self.units[self.files[0]]:
                    self.at_mark()
                if self.unit.slow[self.line] or not self.glide():
                    self.step()
                if self.talk is not None:
                    yield from self.converse(*self.talk)
            except Refusal as refusal:
                self.tell_refusal(refusal)
                self.go_on(refusal)
            except FAILURES:
                self.tell_refusal(Refusal(F.NO_VALUE))
                self.go_on(None)
            if m.finished:
                self.finish()
            if len(out.rows) >= FULL or out.used > out.stowed:
                limit = self.settings.limits.moves
                if limit is not None and out.moves > limit:
                    self.tell_refusal(Refusal(F.OUTPUT_LIMIT, limit=limit))
                    raise Stopped
                if self.midway is None:
                    yield out.take()
                else:
                    self.midway.drop(m)

    def at_mark(self) -> None:
        """Before a line that is run, in the subroutine of the mark or the main program. Raises Refusal, Stopped."""
        if self.flow.search is None and self.flow.sub == self.mark_sub:
            self.state.motion = self.modal
            before = self.midway
            self.pass_mark(self.line)
            if before is not None and self.midway is None:
                self.state.logs.forget()

    def in_force(self) -> tuple[tuple[str, ...], str]:
        m = self.state
        now = snapshot(m)
        names = ("plane", "distance", "feed mode", "system", "retract", "arc distance", "diameter", "path")
        codes = (m.motion_name, now.units, *(now.modes[name] for name in names))
        return tuple(code.upper() for code in codes), f"G{m.cutter or 40}"

    def called_from(self) -> tuple[int, int] | None:
        return (self.flow.stack[0].line, self.flow.moves) if self.flow.stack else None

    def go_on(self, refusal: Refusal | None) -> None:
        """After an error: go on with the next line where that is asked for and safe. Raises Stopped."""
        if not self.settings.keep_going:
            self.halt()
        if refusal is not None and refusal.fault in FATAL:
            raise Stopped from None
        if unrun.O_WORD.match(self.unit.source.raw(self.line)):  # nobody knows what would follow
            self.broken = not self.flow.stack
            raise Stopped from None
        self.state.transfer = self.talk = None

    def glide(self) -> bool:
        """Run a stretch of plain motion in the fast lane; False where there is none."""
        text, line = self.unit, self.line
        if self.flow.search is not None:
            return False
        end = len(text.source)
        if self.mark and text is self.units[self.files[0]]:
            if line >= self.mark - 1:
                return False
            end = self.mark - 1
        if text.source.classes.find(scan.OTHER, line, line + STRETCH) >= 0:
            text.slow[line] = 1
            return False
        m = self.state
        m.motion = self.modal
        if not self.lane.open(m):
            return False
        after = self.lane.run(m, text.source, line, end)
        if after == line:
            text.slow[line] = 1
            return False
        text.ran[line:after] = b"\x01" * (after - line)
        if not self.modal.cycle:
            self.modal = self.lane.motions[self.lane.motion]
            m.motion_name = self.modal.name.lower()
        self.line = after - 1
        self.next_line = after
        return True

    def step(self) -> None:
        """Run a line. Raises Refusal."""
        self.state.begin_line()
        text = self.unit
        source = text.source
        if source.classes[self.line] == scan.PLAIN and self.flow.search is None and self.plain(text):
            return
        if source.classes[self.line] == 0 and not source.raw(self.line).strip():
            return
        if self.settings.block_delete and source.raw(self.line).lstrip().startswith(b"/"):
            return
        try:
            line = text.line(self.line)
        except Refusal:
            if self.flow.search is not None and DOTTED.match(source.raw(self.line)):
                return
            raise
        if line.oline is not None:
            self.flow.step(line.oline)
            return
        percent = line.code == "%" and source.raw(self.line).strip() == b"%"
        main = self.unit is self.units[self.files[0]]
        if percent and self.percent and (main or self.flow.search is not None):
            self.close()
        if line.fanuc is not None and (line.fanuc[1] == "98" or self.flow.stack or self.flow.search is not None):
            self.fanuc(line, line.fanuc)
            return
        if self.flow.search is not None:
            return
        if line.code == "%":
            raise Refusal(F.MISPLACED_PERCENT, where=(0, 1))
        self.block(line)

    def fanuc(self, line: Line, start: re.Match[str]) -> None:
        """M98, and M99 in a subroutine. M98 is read even where lines are passed over. Raises Refusal."""
        passed = self.flow.search is not None
        if start[1] == "99":
            if self.flow.search is not None:
                self.flow.pass_m99(self.flow.search)
            else:
                self.flow.m99((start.end(), len(line.code.rstrip(COMMENT))))
            return
        if line.code.startswith(".", start.end()):
            raise Refusal(F.UNKNOWN_CODE, where=(start.start(1) - 1, start.end() + 1), code="M98.")
        block = line.block or self.compile(line)
        with self.flow.unrun():
            values = self.values(block, line)
        names, words = gather(block.letters, values, self.dialect)
        if "p" not in words:
            raise Refusal(F.MISSING_WORD, code="M98", word="P", meaning="the number of the subroutine")
        if names.count("m98") > 1:
            raise Refusal(F.UNKNOWN_CODE, "m", code="M98")
        if not passed:
            arrange(names, words, self.modal, self.dialect)
            self.flow.m98(str(whole("p", words["p"])), int(words.get("l", 1.0)))

    # --- ends

    def jump(self, text: Text, line: int) -> None:
        """Go on with this line."""
        if text is not self.unit:
            self.enter_text(text)
        if line <= self.line:
            self.repeated += 1
            if self.repeated > self.settings.limits.blocks:
                raise Refusal(F.BLOCK_BUDGET, limit=self.settings.limits.blocks, first=line + 1, last=self.line + 1)
        self.next_line = line

    def advance(self, line: int, glide: bool) -> None:
        """Run one line of a loop or subroutine that has been compiled, or a stretch of them. Raises Refusal."""
        m = self.state
        self.line = line
        self.next_line = m.line = m.out.line = line + 1
        if not glide or self.unit.slow[line] or not self.glide():
            self.step()

    def loop(self, text: Text, line: int) -> None:
        """The program has jumped back to the start of a loop: run it compiled, if that can be."""
        if line not in text.looms:
            text.looms[line] = weave_loop(self, text, line)
        loom = text.looms[line]
        if loom is not None and loom.sub == self.flow.sub:
            self.weave(loom)

    def routine(self, name: str, text: Text, line: int) -> None:
        """A subroutine has been entered at this line: run it compiled, if that can be, from the second time on."""
        if name not in self.routines:
            self.called[name] = self.called.get(name, 0) + 1
            if self.called[name] == 2 and (loom := weave_routine(self, text, line, name)) is not None:
                self.routines[name] = loom
        if name in self.routines:
            self.weave(self.routines[name])

    def weave(self, loom: Loom) -> None:
        """Run what is compiled, if all stands as its lines expect. Raises Refusal.

        Contours of G70 to G72 are stepped through by those codes.
        """
        if self.mark:
            return
        if not self.remaps and steady(self.state) and not self.flow.continuing and isinstance(self.state.out, Recorder):
            loom.run(self, ASKED)

    def enter_text(self, text: Text) -> None:
        """Go on in this text."""
        self.unit = text
        self.state.out.file = self.files.index(text.source.name)

    def run_off(self) -> None:
        """The file has no more lines: a call that found nothing is passed over in a check. Raises Stopped."""
        flow = self.flow
        if flow.search is not None and flow.search.call and flow.search.where:
            self.unit, self.line = flow.search.where
            refusal = self.not_found(flow.search)
            flow.give_up()
        elif self.settings.mode == Mode.MDI:
            if flow.search is not None:
                self.tell_refusal(self.not_found(flow.search))
            raise Stopped
        else:
            self.line = max(len(self.unit.source) - 1, 0)
            refusal = Refusal(F.END_MISSING)
        self.tell_refusal(refusal)
        if refusal.fault is F.END_MISSING or not self.settings.keep_going:
            raise Stopped

    def not_found(self, search: Search) -> Refusal:
        """That nothing has been found of what was sought: a call's subroutine, or the end of what is passed over."""
        if not search.call:
            return Refusal(F.O_WORD, what=f"{' or '.join(search.kinds).upper()} is missing", hint="")
        file = self.found.get(search.file)
        hint = files.missing(search.label, search.file, file.source.name if file else None, self.folders)
        return Refusal(F.NO_SUBROUTINE, name=search.label, hint=hint)

    def close(self) -> None:
        """A second percent sign. Raises Stopped."""
        self.state.out.event("FINISH")
        if self.flow.search is not None:
            self.tell_refusal(self.not_found(self.flow.search))
        raise Stopped

    def finish(self) -> None:
        """The end of the program. Raises Stopped."""
        self.not_arrived()
        starting.finish(self.state)
        if self.percent:
            source = self.units[self.files[0]].source
            last = self.line + 1 if self.unit is self.units[self.files[0]] else 0
            if not any(source.raw(at).strip() == b"%" for at in range(last, len(source))):
                self.state.out.event("COMMENT", "interpreter: percent sign missing from end of file")
        raise Stopped

    def logs(self) -> dict[str, Log]:
        return self.state.logs.files

    def remembered(self) -> dict[int, float]:
        """The parameters that were given, and those that outlive every run: in inches for a parameter file, else in mm.

        Source: the canonical listing, section 8.
        """
        return starting.remembered(self.state)

    # --- files

    def find_file(self, name: str) -> Text | None:
        """The file of a subroutine. Raises Refusal where it cannot be read."""
        if name not in self.found:
            path = files.find(name, self.folders)
            text = None
            if path is not None and (text := self.units.get(str(path))) is None:
                text = self.units[str(path)] = files.load(path)
                self.files.append(str(path))
            self.found[name] = text
        return self.found[name]
