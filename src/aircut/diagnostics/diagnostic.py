"""A fault is a value with a place.

A Fault is a kind, one row in `faults`. Where a program commits it, code raises
Refusal(fault, values); the interpreter, which knows the place, makes the
Diagnostic that every face shows.
"""

from __future__ import annotations

from enum import StrEnum
from typing import Any, NamedTuple


class Severity(StrEnum):
    """How bad it is: with an error the program is not fit to run."""

    ERROR = "error"
    WARNING = "warning"


class Span(NamedTuple):
    """Place in a text: line from 1, columns from 1, `end` is the column after the last; 0 where unknown."""

    line: int = 0
    column: int = 0
    end: int = 0


class Frame(NamedTuple):
    """One call on the way to a fault: what was called, and from where."""

    name: str
    file: str
    line: int


class Diagnostic(NamedTuple):
    """One occasion of a fault."""

    code: str  # stable: the vendor's number, or a slug
    severity: Severity
    message: str
    file: str
    span: Span
    hint: str = ""
    stack: tuple[Frame, ...] = ()

    def __str__(self) -> str:
        place = f"{self.file}:{self.span.line}:{max(self.span.column, 1)}" if self.span.line else self.file
        return f"{place}: {self.severity.value} {self.code}: {self.message}"

    def vendor(self) -> str:
        """As the vendor's controller writes it: `[E0345] in line 40 (G390, line 532) - text` (003, section 2.2).

        The first line is that of the main program; name and second line are those of the macro.
        """
        if not self.stack:
            return f"[{self.code}] in line {self.span.line} - {self.message}"
        macro = self.stack[-1].name.removesuffix(".ngc").removesuffix(".ngx").upper()
        return f"[{self.code}] in line {self.stack[0].line} ({macro}, line {self.span.line}) - {self.message}"


class Fault(NamedTuple):
    """A kind of fault."""

    code: str
    message: str  # a str.format template
    hint: str = ""  # likewise
    severity: Severity = Severity.ERROR
    why: str = ""  # for the reference page: what it means and what to do

    def at(
        self,
        file: str,
        span: Span,
        stack: tuple[Frame, ...] = (),
        severity: Severity | None = None,
        **values: Any,
    ) -> Diagnostic:
        """The Diagnostic of one occasion."""
        return Diagnostic(
            self.code,
            severity or self.severity,
            self.message.format(**values),
            file,
            span,
            self.hint.format(**values),
            stack,
        )


class Refusal(Exception):
    """A program's fault on its way to the interpreter.

    letter: of the word at fault (the interpreter finds its columns);
    where: (start, end) in the cleaned line when known.
    """

    def __init__(self, fault: Fault, letter: str = "", where: tuple[int, int] | None = None, **values: Any) -> None:
        super().__init__(fault.code)
        self.fault = fault
        self.letter = letter
        self.where = where
        self.values = values
