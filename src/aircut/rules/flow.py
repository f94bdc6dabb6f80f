"""Rules that follow the program's flow in its text: code that can never run, subroutines that nothing calls.

They speak only where it is certain: a computed GOTO or call may lead anywhere, lines
that did run are never reported, and a line with `/` may be skipped.
"""

from __future__ import annotations

import re
from collections.abc import Iterator

from aircut.diagnostics import Diagnostic, Refusal
from aircut.diagnostics import faults as F
from aircut.interpreter.arranging import code_name
from aircut.interpreter.macros import stem
from aircut.interpreter.unit import takes_arguments
from aircut.kernels import scan
from aircut.language.blocks import Block, Mark
from aircut.language.expressions import Number, Text
from aircut.language.structure import Routine, find_labels
from aircut.rules.page import Page

#: Where a line may be that always leads elsewhere.
LEAVING = tuple(
    map(re.compile, (rb"m[ \t]*0*(?:2|30|47|99|102)(?![\d.])", rb"goto", rb"return", rb"endsub", rb"break"))
)
LEAVES = {"m2", "m30", "m47", "m99", "m102"}
CALLING = tuple(map(re.compile, (rb"m[ \t]*0*98(?![\d.])", rb"g[ \t]*6[56](?![\d.])", rb"call")))


# --- code that can never run


def unreachable(page: Page) -> Iterator[Diagnostic]:
    """Lines behind one that always leads elsewhere, and that nothing leads to."""
    unit = page.unit
    labels = targets(page)
    dead = -1
    for line in page.lines(*LEAVING):
        if line > dead and leaves(page, line):
            stretch = behind(page, line, labels)
            if stretch:
                dead = stretch[-1]
                if not any(unit.seen[at] for at in stretch):
                    span = unit.place(stretch[0], Refusal(F.UNREACHABLE))
                    yield F.UNREACHABLE.at(unit.source.name, span, lines=spoken(stretch), line=line + 1)


def spoken(stretch: list[int]) -> str:
    first, last = stretch[0] + 1, stretch[-1] + 1
    return "this line" if first == last else f"lines {first} to {last}"


def targets(page: Page) -> set[int]:
    """Lines that a GOTO may lead to."""
    if any(lines is None for _, lines in page.gotos):
        labels = find_labels(page.unit.source, page.unit.block_delete)
        return {line for lines in labels.values() for line in lines}
    return {at for _, lines in page.gotos if lines for at in lines}


def leaves(page: Page, line: int) -> bool:
    """Whether the line after this one never follows it."""
    found = page.parsed(line)
    if found is None or found.deleted or not isinstance(found.body, Block) or found.body.condition is not None:
        return False
    if found.body.jump is not None:
        return True
    if takes_arguments(found.body, page.unit.dialect):
        return False
    return any(
        word.letter == "m" and isinstance(word.value, Number) and code_name("m", word.value.value) in LEAVES
        for word in found.body.words
    )


def behind(page: Page, line: int, labels: set[int]) -> list[int]:
    """The lines after one that leads elsewhere, up to where other lines lead."""
    unit = page.unit
    depth = 0
    stretch: list[int] = []
    for at in range(line + 1, unit.structure.routine(line).end):
        if unit.source.classes[at] == scan.BLANK or not unit.says_something(at):
            continue
        if at in labels or (not stretch and unit.seen[at]):
            break
        found = page.parsed(at) if unit.source.classes[at] == scan.OTHER else None
        if found is not None and isinstance(found.body, Mark):
            if found.body.kind in ("if", "while"):
                depth += 1
            elif depth == 0:
                break
            elif found.body.kind == "end":
                depth -= 1
        stretch.append(at)
    return stretch


# --- subroutines that nothing calls


def unused(page: Page) -> Iterator[Diagnostic]:
    """Subroutines of the file that neither its program nor a subroutine that is called calls."""
    unit, structure = page.unit, page.structure
    entry = unit.entry()
    calls: dict[Routine, set[str]] = {}
    for line in page.lines(*CALLING):
        found = names(page, line)
        if found is None:
            return
        calls.setdefault(structure.routine(line), set()).update(found)
    todo = [structure.main, entry, *(r for r in structure.order if any(unit.seen[r.first : r.end]))]
    used: set[Routine] = set()
    while todo:
        routine = todo.pop()
        if routine not in used:
            used.add(routine)
            todo += [structure.routines[name] for name in calls.get(routine, ()) if name in structure.routines]
    for routine in structure.order:
        if routine not in used and structure.routines.get(routine.name) is routine:
            span = unit.place(routine.declared, Refusal(F.UNUSED_SUBROUTINE, name=routine.name))
            yield F.UNUSED_SUBROUTINE.at(unit.source.name, span, name=routine.name)


def names(page: Page, line: int) -> set[str] | None:
    """What a line calls, with and without extension; None where it is computed."""
    found = page.parsed(line)
    if found is None or not isinstance(found.body, Block):
        return set()
    for word in found.body.words:
        if word.letter == "p":
            if isinstance(word.value, Number):
                return {str(round(word.value.value))}
            if isinstance(word.value, Text):
                name = word.value.text.strip().lower()
                return {name, stem(name)}
            return None
    return set()
