"""Lines that did not run: `check` reads them too, as far as they belong to the program.

LinuxCNC does not read what it passes over, nor what follows the end: a fault in a branch
that was not taken, or in a subroutine that nobody called, is a warning. Behind the
O-word at which a run broke off it is an error, for the program would have come there.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import TYPE_CHECKING

from aircut.diagnostics import Refusal, Severity
from aircut.diagnostics import faults as F
from aircut.interpreter.linuxcnc import places
from aircut.interpreter.linuxcnc.arranging import arrange, gather
from aircut.interpreter.linuxcnc.blocks import KEYWORD, OLine, brackets, read
from aircut.interpreter.linuxcnc.state import LOCALS
from aircut.interpreter.linuxcnc.text import check as check_text
from aircut.language.expressions import Number

if TYPE_CHECKING:
    from aircut.interpreter.linuxcnc.files import Line, Text
    from aircut.interpreter.linuxcnc.interpreter import Interpreter

#: Values in brackets that may follow an O-word: the least and the most.
VALUES = {"if": (1, 1), "elseif": (1, 1), "while": (1, 1), "repeat": (1, 1), "call": (0, LOCALS),
          "return": (0, 1), "endsub": (0, 1)}  # fmt: skip
END = re.compile(r"(?<![a-z])m0*(2|30)(?!\d)")
MODAL = (F.UNUSED_WORD, F.MISFIT)  # these depend on the modes in force
#: The start of an O-word, in a line as written: where it is wrong, nobody knows what follows.
O_WORD = re.compile(rb"[ \t]*/?[ \t]*(n[ \t]*\d[\d. \t]*)?o", re.IGNORECASE)


def check(run: Interpreter, broken: bool) -> None:
    """Tell the faults of lines that did not run. broken: the run broke off in the main program."""
    main = run.units[run.files[0]]
    last = run.flow.stack[0].line - 1 if run.flow.stack else run.line
    for text in run.units.values():
        for at, inside in lines_of(text, last if text is main else -1):
            if run.settings.block_delete and text.source.raw(at).lstrip().startswith(b"/"):
                continue
            try:
                check_line(run, text.line(at))
            except Refusal as refusal:
                if refusal.fault not in MODAL:
                    reached = broken and text is main and at > last and not inside
                    severity = Severity.ERROR if reached else Severity.WARNING
                    span = places.span(text.source, at, refusal)
                    run.tell(refusal.fault.at(text.source.name, span, (), severity, **refusal.values))
    run.diagnostics.sort(key=lambda d: (d.file != run.files[0], d.file, d.span.line))


def lines_of(text: Text, last: int) -> Iterator[tuple[int, bool]]:
    """Lines of the main program up to its end, and those of subroutines, with whether they are that.

    last: the line that the main program came to.
    """
    ended = last < 0
    inside = False
    for at in range(len(text.source)):
        if text.ran[at]:
            continue
        raw = text.source.raw(at)
        if not raw.strip() or (raw.strip() == b"%" and not at):
            continue
        try:
            line = text.line(at)
        except Refusal:
            if inside or not ended:
                yield at, inside
            continue
        if line.oline is not None and line.oline.keyword == "sub":
            inside = True
        if inside or not ended:
            yield at, inside
        if line.oline is not None and line.oline.keyword == "endsub":
            inside = False
        if at >= last and (line.code == "%" or END.search(line.code)) and not inside:
            ended = True


def check_line(run: Interpreter, line: Line) -> None:
    """Raises Refusal for what is wrong with the form of a line."""
    if line.oline is not None:
        check_word(line.oline)
    elif line.block is None and line.code != "%":
        check_text(line.code)
        items = read(line.code)
        if all(isinstance(item.value, Number) for item in items):
            words = [item for item in items if item.target is None]
            letters, values = [item.letter for item in words], [float(item.value.value) for item in words]  # type: ignore[union-attr]
            names, rest = gather(letters, values, run.dialect)
            arrange(names, rest, run.dialect.codes["g1"], run.dialect)


def check_word(line: OLine) -> None:
    """Raises Refusal for an O-word that is none, or is followed by what it does not take."""
    if line.keyword in VALUES:
        brackets(line, *VALUES[line.keyword])
    elif line.rest and KEYWORD.fullmatch(line.keyword):
        raise Refusal(F.MISPLACED_WORDS, where=(line.end, len(line.code)), what=f"O … {line.keyword.upper()}")
