"""The structure of a text: routines, branches, loops and labels, as line numbers to go to.

It is worked out once before anything runs, from the marks alone, so that the
interpreter keeps no stack of open blocks: wherever it is, the next line follows
from the line. Lines are counted from 0.
Sources: 000 sections 3.2, 3.4; decisions AMB-FLOW-1 to AMB-FLOW-9, AMB-CALL-3, AMB-CALL-13.
"""

from __future__ import annotations

import re
from bisect import bisect_right
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import NamedTuple

from aircut.diagnostics import Refusal
from aircut.diagnostics import faults as F
from aircut.language.blocks import Mark
from aircut.source import Source

DEEPEST = 100  # open blocks in a routine
LABEL = re.compile(rb"^[ \t]*(/?)(?:[ \t]|\([^()\n]*\))*[nN][ \t]*(\d[\d \t]*)", re.MULTILINE)
OPENERS = {"if": "IF", "while": "WHILE"}


class Routine(NamedTuple):
    """A stretch of lines with its own ids and labels: the main part (no name) or a subroutine."""

    name: str
    declared: int  # line of the declaration; -1 for the main part
    first: int
    end: int  # the line after its last

    def title(self) -> str:
        return f"subroutine {self.name}" if self.name else "the main program"


class Span(NamedTuple):
    """A block of lines, from its IF or WHILE to its END."""

    kind: str
    id: str
    first: int
    last: int


@dataclass
class Structure:
    """Where to go from each mark."""

    routines: dict[str, Routine] = field(default_factory=dict)
    main: Routine = field(default_factory=lambda: Routine("", -1, 0, 0))
    #: if, elif: where to go when the condition is false. while: the line after its END. else: not used.
    otherwise: dict[int, int] = field(default_factory=dict)
    #: elif, else: the line after the END, for who comes from the branch above. end of a while: the WHILE.
    onward: dict[int, int] = field(default_factory=dict)
    loops: set[int] = field(default_factory=set)  # lines of WHILE
    blocks: list[Span] = field(default_factory=list)
    faults: list[tuple[int, Refusal]] = field(default_factory=list)
    starts: list[int] = field(default_factory=list)  # first lines of all routines, in order
    order: list[Routine] = field(default_factory=list)
    labels: dict[int, list[int]] | None = None

    def routine(self, line: int) -> Routine:
        """The routine that a line belongs to."""
        return self.order[max(0, bisect_right(self.starts, line) - 1)]

    def around(self, line: int) -> list[Span]:
        """The blocks that a line stands in, outermost first."""
        return [block for block in self.blocks if block.first < line <= block.last]

    def after_break(self, line: int, id: str) -> int:
        """Where BREAKid in this line leads. Raises Refusal."""
        for block in reversed(self.around(line)):
            if block.id == id:
                if block.kind == "while":
                    return block.last + 1
                break
        raise Refusal(F.NOT_A_LOOP, id=id)

    def target(self, line: int, label: int, source: Source, block_delete: bool) -> int:
        """The line that GOTO in this line leads to. Raises Refusal."""
        if self.labels is None:
            self.labels = find_labels(source, block_delete)
        routine = self.routine(line)
        inside = [at for at in self.labels.get(label, ()) if routine.first <= at < routine.end]
        if not inside:
            raise Refusal(F.NO_TARGET, label=label, place=routine.title())
        at = next((at for at in inside if at > line), inside[0])
        here = self.around(line)
        for block in self.around(at):
            if block not in here:
                raise Refusal(F.JUMP_INTO_BLOCK, label=label, line=block.first + 1)
        return at


def find_labels(source: Source, block_delete: bool) -> dict[int, list[int]]:
    """All N labels and the lines that carry them, in order."""
    labels: dict[int, list[int]] = {}
    for match in LABEL.finditer(source.data):
        if not (match[1] and block_delete):
            number = int(match[2].translate(None, b" \t")[:18])
            labels.setdefault(number, []).append(source.line_at(match.start()))
    return labels


def build(marks: Iterable[tuple[int, Mark]], first: int, end: int) -> Structure:
    """The structure of the lines from `first` to before `end`; faults are collected in it."""
    structure = Structure()
    marks = list(marks)
    declarations = [(line, mark) for line, mark in marks if mark.kind == "sub"]
    edges = [line for line, _ in declarations] + [end]
    structure.main = Routine("", -1, first, edges[0])
    structure.order.append(structure.main)
    for (line, mark), stop in zip(declarations, edges[1:], strict=True):
        routine = Routine(mark.name, line, line + 1, stop)
        structure.order.append(routine)
        known = structure.routines.setdefault(mark.name, routine)
        if known is not routine:
            fault = Refusal(F.DUPLICATE_SUBROUTINE, where=mark.where, name=mark.name, line=known.declared + 1)
            structure.faults.append((line, fault))
    structure.starts = [routine.first for routine in structure.order]
    Matcher(structure).match(marks)
    structure.blocks.sort(key=lambda block: block.first)
    return structure


class Open(NamedTuple):
    """A block whose END has not come yet; marks: its IF or WHILE and its branches so far."""

    kind: str
    id: str
    marks: list[tuple[int, str]]


class Matcher:
    """Pairs openers and closers."""

    def __init__(self, structure: Structure) -> None:
        self.structure = structure
        self.open: list[Open] = []
        self.broken = False

    def match(self, marks: list[tuple[int, Mark]]) -> None:
        for line, mark in marks:
            try:
                self.STEPS[mark.kind](self, line, mark)
            except Refusal as refusal:
                if self.broken and refusal.fault is F.UNMATCHED_END:
                    continue
                refusal.where = mark.where
                self.structure.faults.append((line, refusal))
        self.close_all()

    def damaged(self, _line: int, _mark: Mark) -> None:
        """A line that cannot be read may have opened or closed a block: what does not fit then is its fault."""
        self.broken = True

    def sub(self, _line: int, _mark: Mark) -> None:
        self.close_all()

    def close_all(self) -> None:
        for block in () if self.broken else self.open:
            what = f"{OPENERS[block.kind]} … {block.id}"
            fault = Refusal(F.UNCLOSED_BLOCK, what=what, closer=f"END{block.id}")
            self.structure.faults.append((block.marks[0][0], fault))
        self.open.clear()

    def opening(self, line: int, mark: Mark) -> None:
        for block in self.open:
            if block.id == mark.name:
                opener = OPENERS[block.kind]
                raise Refusal(F.ID_IN_USE, id=mark.name, opener=opener, line=block.marks[0][0] + 1)
        self.open.append(Open(mark.kind, mark.name, [(line, mark.kind)]))
        if len(self.open) > DEEPEST:
            raise Refusal(F.TOO_DEEP, limit=DEEPEST, what="blocks")

    def innermost(self, mark: Mark, opener: str) -> Open:
        """The block that a closer or branch belongs to."""
        what = f"{mark.kind.upper()}{mark.name}"
        if not self.open:
            raise Refusal(F.UNMATCHED_END, what=what, opener=f"its {opener}", hint="")
        block = self.open[-1]
        if block.id != mark.name:
            hint = f"the block open here is {OPENERS[block.kind]} … {block.id} of line {block.marks[0][0] + 1}"
            raise Refusal(F.UNMATCHED_END, what=what, opener=f"its {opener}", hint=hint)
        return block

    def branch(self, line: int, mark: Mark) -> None:
        block = self.innermost(mark, "IF")
        if block.kind != "if":
            raise Refusal(F.UNMATCHED_END, what=f"{mark.kind.upper()}{mark.name}", opener="its IF", hint="")
        if block.marks[-1][1] == "else":
            raise Refusal(F.ELSE_TWICE, what=mark.kind.upper(), id=mark.name)
        self.structure.otherwise[block.marks[-1][0]] = line
        block.marks.append((line, mark.kind))

    def end(self, line: int, mark: Mark) -> None:
        block = self.innermost(mark, "IF or WHILE")
        self.open.pop()
        first = block.marks[0][0]
        self.structure.blocks.append(Span(block.kind, block.id, first, line))
        if block.kind == "while":
            self.structure.otherwise[first] = line + 1
            self.structure.loops.add(first)
            self.structure.onward[line] = first
            return
        if block.marks[-1][1] != "else":
            self.structure.otherwise[block.marks[-1][0]] = line
        for at, _ in block.marks[1:]:
            self.structure.onward[at] = line + 1

    STEPS = {"if": opening, "while": opening, "elif": branch, "else": branch, "end": end, "sub": sub, "broken": damaged}
