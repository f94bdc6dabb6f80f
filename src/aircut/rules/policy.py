"""Which warnings are told, and how bad they are: the project's file, comments, the command line.

`aircut.toml` stands in the program's folder or in one above it:

    [rules]
    spindle-off = "off"
    no-feed = "error"

In a program: `(aircut: ignore RULE)` for its line, `(aircut: off RULE)` from its line on,
`(aircut: on RULE)` to undo that. Several rules are separated by blanks or commas.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Literal, NamedTuple

from aircut.diagnostics import FAULTS, Diagnostic, Severity, Span
from aircut.diagnostics import faults as F

if TYPE_CHECKING:
    from aircut.source import Source

PROJECT = "aircut.toml"
Level = Literal["off", "warning", "error"]
DIRECTIVE = re.compile(rb"(?i)[(;][ \t]*aircut[ \t]*:([^)\r\n]*)")
WORDS = re.compile(r"[ \t,]+")


class RulesError(ValueError):
    """A project file or an option names what is not there; the text says where."""


class Directive(NamedTuple):
    """What a comment says of rules."""

    line: int  # from 1
    verb: str  # ignore, off, on
    codes: tuple[str, ...]


class Policy(NamedTuple):
    """What the user has said of rules."""

    levels: Mapping[str, Level] = {}

    @classmethod
    def of(cls, program: Path, ignored: Iterable[str] = ()) -> Policy:
        """From the project file above the program, and the rules to be ignored. Raises RulesError."""
        levels: dict[str, Level] = {}
        if (path := project(program)) is not None:
            levels |= read(path)
        for code in ignored:
            known(code, "--ignore")
            levels[code] = "off"
        return cls(levels)

    def applied(self, diagnostics: Iterable[Diagnostic], sources: Mapping[str, Source]) -> list[Diagnostic]:
        """The diagnostics that are left. Errors always are; comments that say nothing are told of."""
        said = {name: found for name, source in sources.items() if (found := spoken(source))}
        left = []
        wrong = [d for name, found in said.items() for d in misspoken(name, sources[name], found)]
        for diagnostic in [*diagnostics, *wrong]:
            if diagnostic.severity is not Severity.WARNING:
                left.append(diagnostic)
                continue
            level = self.levels.get(diagnostic.code, "warning")
            if level != "off" and not silenced(diagnostic, said.get(diagnostic.file, [])):
                left.append(diagnostic._replace(severity=Severity(level)))
        return left


def project(program: Path) -> Path | None:
    """The project file of a program: in its folder or above."""
    for folder in program.absolute().parents:
        if (folder / PROJECT).is_file():
            return folder / PROJECT
    return None


def read(path: Path) -> dict[str, Level]:
    """The levels that a project file sets. Raises RulesError."""
    import tomllib

    import msgspec

    class Project(msgspec.Struct, forbid_unknown_fields=True):
        rules: dict[str, Level] = {}

    try:
        levels = msgspec.convert(tomllib.loads(path.read_text("utf-8")), Project).rules
    except OSError as error:
        raise RulesError(f"{path}: {error.strerror}") from None
    except ValueError as error:
        reason = re.sub(r" - at `\$\.(.*)`$", r" (at \1)", str(error))
        raise RulesError(f"{path}: {reason.replace(chr(96), '')}") from None
    for code in levels:
        known(code, str(path))
    return levels


def known(code: str, where: str) -> None:
    """Raises RulesError for a code that is no rule."""
    if problem := unknown(code):
        raise RulesError(f"{where}: {problem}")


def unknown(code: str) -> str:
    """Why a code cannot be switched off; empty where it can."""
    fault = FAULTS.get(code)
    if fault is None:
        from difflib import get_close_matches

        rules = [fault.code for fault in FAULTS.values() if fault.severity is Severity.WARNING]
        near = get_close_matches(code, rules, 1)
        return f"there is no rule {code}" + (f"; {near[0]} is meant?" if near else "")
    return "" if fault.severity is Severity.WARNING else f"{code} is an error, which cannot be switched off"


def spoken(source: Source) -> list[Directive]:
    """What the comments of a text say, in order.

    Those that cannot be understood have no verb, and what is wrong instead of codes.
    """
    found = []
    for first, match in (
        (first, match)
        for first, text in source.foreign()
        if b"aircut" in text.lower()
        for match in DIRECTIVE.finditer(text)
    ):
        line = source.line_at(first + match.start()) + 1
        verb, *codes = WORDS.split(match[1].decode("utf-8", "replace").strip().lower()) or [""]
        problem = next(filter(None, map(unknown, codes)), "" if codes else "it names no rule")
        if verb not in ("ignore", "off", "on"):
            problem = "it begins with ignore, off or on"
        found.append(Directive(line, "", (problem,)) if problem else Directive(line, verb, tuple(codes)))
    return found


def misspoken(name: str, source: Source, said: Iterable[Directive]) -> Iterator[Diagnostic]:
    """Warnings of the comments that cannot be understood."""
    for line, verb, codes in said:
        if not verb:
            text = source.text(line - 1)
            yield F.BAD_DIRECTIVE.at(name, Span(line, 1, len(text) + 1), problem=codes[0])


def silenced(diagnostic: Diagnostic, said: Iterable[Directive]) -> bool:
    """Whether the comments of its file switch a warning off."""
    off = False
    for line, verb, codes in said:
        if diagnostic.code in codes:
            if verb == "ignore":
                if line == diagnostic.span.line:
                    return True
            elif line <= max(diagnostic.span.line, 1):
                off = verb == "off"
    return off
