"""Lines that did not run: they are read all the same, so that one run shows all faults of form.

Source: decision AMB-CALL-3.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from aircut.diagnostics import Refusal
from aircut.diagnostics import faults as F
from aircut.interpreter.arranging import arrange, find
from aircut.interpreter.table import Group
from aircut.interpreter.unit import Statement
from aircut.kernels import scan

if TYPE_CHECKING:
    from aircut.interpreter.interpreter import Interpreter
    from aircut.interpreter.unit import Unit

WAYS_OUT = Group.RETURN | Group.STOP


class Written(NamedTuple):
    """What stands in a line, whatever the modes in force."""

    codes: tuple[str, ...] = ()
    letters: tuple[str, ...] = ()
    moving: bool = False  # among the letters are codes whose number is computed
    returns: bool = False


def written(run: Interpreter, unit: Unit, line: int) -> Written:
    """Read a line. Raises Refusal."""
    if unit.source.classes[line] == scan.BLANK:
        return Written()
    shape = run.shape(unit, line)
    if shape is not None:
        return Written(shape.codes, shape.letters)
    statement, _ = unit.statement(line)
    if not isinstance(statement, Statement):
        return Written()
    jump = statement.block.jump
    returns = jump is not None and jump.kind == "return"
    return Written(statement.codes, statement.letters, statement.moving, returns)


def check(run: Interpreter) -> None:
    """Tell the faults of all lines that did not run, and put the diagnostics in the order of the lines."""
    check_ends(run, run.units[run.files[0]])
    for unit in run.units.values():
        first, end = unit.structure.order[0].first, unit.structure.order[-1].end
        line = unit.seen.find(0, first, end)
        while line >= 0:
            check_line(run, unit, line)
            line = unit.seen.find(0, line + 1, end)
        for line, refusal in unit.encoding:
            run.tell_refusal(refusal, unit, line, stack=False)
    run.diagnostics.sort(key=lambda d: (d.file != run.files[0], d.file, d.span.line))


def check_line(run: Interpreter, unit: Unit, line: int) -> None:
    """Tell what is wrong with the form of a line: its text, its codes, its words."""
    try:
        found = written(run, unit, line)
        if not found.moving:
            rows = [find(name, run.dialect, name[0]) for name in found.codes]
            arrange(rows, found.letters, run.dialect.codes["g1"], run.dialect, run.state.axes + "xyzabc")
    except Refusal as refusal:
        if refusal.fault is not F.UNUSED_WORD:  # that depends on the modes in force
            run.tell_refusal(refusal, unit, line, stack=False)


def check_ends(run: Interpreter, unit: Unit) -> None:
    """Subroutines of the program that were never called want an end as well."""
    for routine in unit.structure.routines.values():
        if any(unit.seen[routine.first : routine.end]):
            continue  # it has run, and would have been found out
        if not any(leads_out(run, unit, line) for line in range(routine.first, routine.end)):
            refusal = Refusal(F.NO_SUBROUTINE_END, name=routine.name)
            run.tell_refusal(refusal, unit, routine.declared, stack=False)


def leads_out(run: Interpreter, unit: Unit, line: int) -> bool:
    """Whether a line can return from its routine, or end the program; one at fault might."""
    try:
        found = written(run, unit, line)
    except Refusal:
        return True
    rows = [run.dialect.codes[name] for name in found.codes if name in run.dialect.codes]
    return found.moving or found.returns or any(row.group & WAYS_OUT for row in rows)
