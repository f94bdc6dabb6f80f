"""Carries out blocks: their words computed, put in order and checked, their codes run in turn.

`aircut.interpreter.linuxcnc.interpreter` says which lines are run.
Source: the canonical listing, sections 3, 6 and 7.
"""

from __future__ import annotations

import re
from collections.abc import Generator
from typing import Any

from aircut.diagnostics import Refusal
from aircut.diagnostics import faults as F
from aircut.interpreter import path
from aircut.interpreter.linuxcnc import places
from aircut.interpreter.linuxcnc.arranging import FREE, Steps, arrange, check_values, gather
from aircut.interpreter.linuxcnc.blocks import Block, parse, read
from aircut.interpreter.linuxcnc.comments import say
from aircut.interpreter.linuxcnc.files import Line, Text
from aircut.interpreter.linuxcnc.flow import Flow
from aircut.interpreter.linuxcnc.shapes import Shape, shape_of
from aircut.interpreter.linuxcnc.state import NINE, State
from aircut.interpreter.linuxcnc.text import check
from aircut.interpreter.linuxcnc.tooling import retained
from aircut.interpreter.midway import Marked
from aircut.interpreter.requests import Request
from aircut.interpreter.running import Settings
from aircut.interpreter.table import Dialect, Group
from aircut.language.text import COMMENT
from aircut.machine import Machine
from aircut.source import Source

NO_MODE = "g-0.1"  # the motion mode after a spline of points: it reads as -1
LITERAL = re.compile(r"(?<=[abcdefhijklpqrstuvwxyz=\[+\-*/,])(\d+\.?\d*|\.\d+)(?![\d.])")


class Blocks(Marked):
    """What a run does with a block."""

    state: State
    unit: Text
    units: dict[str, Text]
    flow: Flow

    def __init__(self, source: Source, dialect: Dialect, machine: Machine, settings: Settings | None) -> None:
        super().__init__(source, dialect, machine, settings)
        self.rest: tuple[Steps, dict[str, float]] | None = None  # of a block, where a code leads elsewhere
        self.shared: dict[str, Block] = {}
        self.steps: dict[Any, Steps] = {}
        self.shapes: dict[bytes, Shape | None] = {}
        #: A code that asks the world: its conversation, the codes still to run, and the block's words.
        self.talk: tuple[Generator[Request, Any, None], Steps, dict[str, float]] | None = None
        self.repeated = 0
        self.modal = dialect.codes["g80"]

    def plain(self, text: Text) -> bool:
        """Run a plain line; False where it must be read character by character. Raises Refusal."""
        known = text.words_of(self.line, self.repeated > 0 or bool(self.flow.stack))
        if known is None or self.state.ini.keeps_length:
            return False
        bare, values = known
        if bare not in self.shapes:
            self.shapes[bare] = shape_of(bare, self.state.axes)
        shape = self.shapes[bare]
        words = None if shape is None else shape.words(values)
        if shape is None or words is None:
            return False
        text.ran[self.line] = 1
        if shape.codes or words:
            steps = shape.steps.get(self.modal.name)
            if steps is None:
                steps = shape.steps[self.modal.name] = arrange(shape.codes, words, self.modal, self.dialect)
            if steps.checked:
                check_values(self.state, steps.codes, words)
            self.perform(steps, words)
        return True

    def values(self, block: Block, line: Line) -> tuple[float, ...]:
        """The values of a block. Raises Refusal."""
        try:
            return block.values(self.state, line.literals)
        except places.EVALUATION as failure:
            raise places.explained(places.values_of(read(line.code)), self.state, failure) from None

    def block(self, line: Line) -> None:
        """Run a block of words. Raises Refusal."""
        m = self.state
        block = line.block
        if block is None:
            block = self.compile(line)
            self.check_axes(block)
        values = self.values(block, line)
        if block.letters:
            names, words = gather(block.letters, values, self.dialect)
            key = (tuple(names), tuple(words), self.modal.name, words.get("p") == FREE, words.get("q") == FREE)
            steps = self.steps.get(key)
            if steps is None:
                steps = self.steps[key] = arrange(names, words, self.modal, self.dialect)
            if steps.checked:
                check_values(m, steps.codes, words)
        else:
            steps, words = None, {}
        if block.targets:
            self.settle(block, line.code, values)
        if line.comment is not None:
            try:
                say(m, line.comment)
            except Refusal as refusal:
                refusal.where = (line.code.rindex(COMMENT), len(line.code))
                raise
        if m.ini.keeps_length and any(m.tool_offset):
            steps = Steps(retained(steps.codes if steps else ()), None)
        if steps is not None:
            self.perform(steps, words)

    def check_axes(self, block: Block) -> None:
        """Raises Refusal where a word names an axis that the machine does not have: it is no letter then."""
        for letter in block.letters:
            if letter in NINE and letter not in self.state.axes:
                hint = "the machine has no such axis"
                raise Refusal(F.ILLEGAL_CHARACTER, letter, character=letter.upper(), hint=hint)

    def compile(self, line: Line) -> Block:
        """The compiled block of a line; lines that differ in literal numbers alone share it. Raises Refusal."""
        code = line.code
        check(code)
        if "<" in code or "?" in code or "n" in code[:2]:
            line.block = parse(code)
            return line.block
        shape = LITERAL.sub("?", code)
        block = self.shared.get(shape)
        if block is None:
            try:
                block = parse(shape, True)
            except Refusal:
                block = parse(code)
                line.block = block
                return block
            self.shared[shape] = block
        line.literals = tuple(map(float, LITERAL.findall(code)))
        line.block = block
        return block

    def settle(self, block: Block, code: str, values: tuple[float, ...]) -> None:
        """Assign what the block sets. Raises Refusal."""
        m = self.state
        settings = zip(block.targets, values[len(block.letters) :], strict=False)
        for nth, ((target, place), value) in enumerate(settings):
            try:
                if isinstance(target, str):
                    m.write_name(target, value)
                    continue
                number = m.number_of(values[place]) if target is None else target
                m.check_write(number)
            except Refusal as refusal:
                refusal.where = places.target_of(code, nth)
                raise
            m.numbered[number] = value

    def perform(self, steps: Steps, words: dict[str, float]) -> None:
        """Carry out the codes of a block in order; what M72 brings back stands in place of the rest. Raises Refusal."""
        m = self.state
        m.codes = steps.codes
        m.words = words
        m.machine_frame = False
        m.changed = None
        before = self.modal, m.motion_name
        m.motion_before = m.motion_name
        for nth, row in enumerate(steps.codes):
            if row.nameless:
                self.modal = self.dialect.codes["g80"]
                m.motion_name = NO_MODE
            elif row.modal:
                self.modal = row
                m.motion_name = row.name.lower()
            if row.group is Group.MOTION and not row.cycle and (row.modal or row.nameless):
                m.cycle = None
            if row.group is Group.STOP:
                path.flush(m)
            try:
                talk = row.run(m, words)
            except Refusal as refusal:
                refusal.values.setdefault("code", row.name)  # the word to show
                raise
            if m.indexed:  # LinuxCNC does not note the mode of a move of a locked axis
                m.indexed = False
                self.modal, m.motion_name = before
            if talk is not None:
                self.talk = (talk, steps._replace(codes=steps.codes[nth + 1 :]), words)
                return
            if m.transfer is not None:
                transfer, m.transfer = m.transfer, None
                self.rest = steps._replace(codes=steps.codes[nth + 1 :]), words
                if transfer(self):
                    return

    def converse(
        self, talk: Generator[Request, Any, None], rest: Steps, words: dict[str, float]
    ) -> Generator[Request, Any, None]:
        """Carry on a block whose code has something to ask, and the codes after it. Raises Refusal."""
        self.talk = None
        try:
            if self.midway is None:
                yield from talk
            else:
                for _ in talk:  # before the start nobody is asked
                    pass
        except Refusal as refusal:
            refusal.values.setdefault("code", self.modal.name)
            raise
        self.perform(rest, words)

    def carry_out(self, names: list[str], words: dict[str, float]) -> None:
        """Run codes that no line has written. Raises Refusal."""
        self.perform(arrange(names, words, self.modal, self.dialect), words)
