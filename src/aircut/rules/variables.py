"""The rule of variables that are read before they are set.

It is read from the text, in order, and speaks only where no way leads from an
assignment to the reading: loops, backward GOTOs, calls and computed variables
(`#[#1]=2`) count as ways. Tests for null (`#1 EQ #0`, EXISTS) are no readings;
nor are arguments (#1 to #33 in a subroutine), and variables that outlive a run.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field

from aircut.diagnostics import Diagnostic, Severity, Span
from aircut.diagnostics import faults as F
from aircut.interpreter.unit import Unit
from aircut.language.blocks import Block
from aircut.language.structure import Routine
from aircut.rules.flow import names
from aircut.rules.page import Page, Parts

NULL = rb"#[ \t]*(?:0+(?!\d)|<[ \t]*math\.nan[ \t]*>)"
ONE = rb"#[ \t]*(?:\d[\d \t]*|<[^>\n]*>)"
#: Comments and strings, tests for null, EXISTS; and variables, each with the = behind it.
TOKEN = re.compile(
    rb"\([^()\n]*\)|;[^\n]*|\"[^\"\n]*\"|exists[ \t]*\[[^\]\n]*\]"
    rb"|" + NULL + rb"[ \t]*(?:eq|ne)[ \t]*" + ONE + rb"|" + ONE + rb"[ \t]*(?:eq|ne)[ \t]*" + NULL +
    rb"|(#[ \t]*(?:\d[\d \t]*|<[^>\n]*>|[#\[][^=\n]*))([ \t]*=)?"
)  # fmt: skip
CALLS = tuple(
    map(
        re.compile,
        (rb"m[ \t]*0*98(?![\d.])", rb"g[ \t]*6[56](?![\d.])", rb"call", rb"m[ \t]*0*6(?![\d.])",
         rb"g[ \t]*[2-4]\d\d(?!\d)", rb"m[ \t]*2\d\d"),
    )
)  # fmt: skip
COMPUTED = ""  # the name of all variables that are set by a computed number


@dataclass
class Uses:
    """Where a routine first reads and first sets each variable, by name: (start, end) in the bytes."""

    reads: dict[str, tuple[int, int]] = field(default_factory=dict)
    sets: dict[str, int] = field(default_factory=dict)


def unset(page: Page) -> Iterator[Diagnostic]:
    """The first reading of each variable, in each routine, that cannot have been set by then."""
    run, unit = page.run, page.unit
    found = {routine: uses(page.parts, *bounds(unit, routine)) for routine in page.structure.order}
    others = [uses(Parts(other), 0, len(other.source.data)) for other in run.units.values() if other is not unit]
    told = {(d.file, d.span.line) for d in run.diagnostics if d.severity is Severity.ERROR}
    ways = back_ways(page)
    calls = page.lines(*CALLS)
    unknown = [line for line in calls if not looked_at(page, line)]
    for routine, used in found.items():
        rest = [each for other, each in found.items() if other is not routine] + others
        for name, (start, end) in sorted(used.reads.items(), key=lambda item: item[1]):
            kind = kind_of(name, routine, page)
            line = page.line_of(start)
            if not kind or (unit.source.name, line + 1) in told:
                continue
            at = [page.line_of(used.sets[key]) for key in (name, COMPUTED) if key in used.sets]
            if any(leads(place, line, ways) for place in at):
                continue
            if kind == "shared":
                before = calls if routine.name else [place for place in calls if place < line]
                elsewhere = any(key in each.sets for each in rest for key in (name, COMPUTED))
                if any(place in unknown for place in before) or ((before or routine.name) and elsewhere):
                    continue
            later = page.line_of(used.sets[name]) if name in used.sets else -1
            yield diagnostic(page, start, end, later)


def looked_at(page: Page, line: int) -> bool:
    """Whether what a line calls is among the texts that have been read."""
    called = names(page, line)
    if called and called <= set(page.structure.routines):
        return True
    found = page.parsed(line)
    certain = found is not None and isinstance(found.body, Block) and found.body.condition is None
    return certain and bool(page.unit.seen[line])


def bounds(unit: Unit, routine: Routine) -> tuple[int, int]:
    """First byte of a routine and the byte after its last."""
    source = unit.source
    first, end = (
        source.start(line) if line < len(source) else len(source.data) for line in (routine.first, routine.end)
    )
    return first, end


def uses(parts: Parts, first: int, end: int) -> Uses:
    """The variables of a stretch of text."""
    found = Uses()
    known: set[tuple[bytes, bool]] = set()
    for place, match in (
        (at, match) for at, low in parts for match in TOKEN.finditer(low, max(first - at, 0), max(end - at, 0))
    ):
        token, sets = match.groups()
        if token is None or (token, sets is None) in known:
            continue
        known.add((token, sets is None))
        name = name_of(token)
        if sets:
            found.sets.setdefault(name, place + match.start())
        elif name:
            found.reads.setdefault(name, (place + match.start(1), place + match.end(1)))
        if not name:
            for inner in re.finditer(rb"#[ \t]*(\d+)", token[1:]):
                at = place + match.start() + 1
                found.reads.setdefault(str(int(inner[1][:9])), (at + inner.start(), at + inner.end()))
    return found


def name_of(token: bytes) -> str:
    """The name of a variable as written; COMPUTED where it has none of its own."""
    text = token.translate(None, b" \t")[1:]
    if text[:1] == b"<":
        return COMPUTED if b"[" in text or b"#" in text else text[1:-1].decode("utf-8", "replace")
    return str(int(text[:9])) if text.isdigit() else COMPUTED


def kind_of(name: str, routine: Routine, page: Page) -> str:
    """Whether calls can set a variable ("shared") or not ("own"); empty for what the rule leaves alone."""
    run = page.run
    if name.isdigit():
        number = int(name)
        if 0 < number < 34:
            return "" if routine.name or page.macro else "shared"
        fresh = any(row.first <= number <= row.last and row.initial == "null" for row in run.dialect.ranges)
        return "shared" if fresh else ""
    if name in run.dialect.named or name.startswith("_args."):
        return ""
    return "own" if run.state.is_local(name) else "shared"


def back_ways(page: Page) -> list[tuple[int, int]]:
    """Where the flow goes back: (from, to), lines."""
    ways = [(block.last, block.first) for block in page.structure.blocks if block.kind == "while"]
    for line, targets in page.gotos:
        ways += [(line, at) for at in ((0,) if targets is None else targets) if at <= line]
    if page.lines(re.compile(rb"m[ \t]*47(?![\d.])")):
        ways.append((len(page.unit.source), 0))
    return ways


def leads(start: int, end: int, ways: list[tuple[int, int]]) -> bool:
    """Whether what line `start` sets can be met in line `end`."""
    if start < end:
        return True
    low = start
    while ends := [to for origin, to in ways if origin >= low]:
        if min(ends) <= end:
            return True
        if min(ends) >= low:
            break
        low = min(ends)
    return False


def diagnostic(page: Page, start: int, end: int, later: int) -> Diagnostic:
    source = page.unit.source
    line = page.line_of(start)
    column = len(source.data[source.start(line) : start].decode("utf-8", "replace"))
    written = source.data[start:end].decode("utf-8", "replace").strip()
    how = f"it is set only in line {later + 1}" if later > line else "nothing sets it"
    if later == line:
        how = "its own line sets it, after reading"
    span = Span(line + 1, column + 1, column + 1 + len(written))
    return F.UNSET_VARIABLE.at(source.name, span, what=written, how=how)
