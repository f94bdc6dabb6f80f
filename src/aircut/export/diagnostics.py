"""Diagnostics for machines: JSON, SARIF 2.1.0, GitHub's workflow commands, and the vendor's own lines."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from typing import Any

from aircut.diagnostics import FAULTS, Diagnostic, Severity

JSON_VERSION = 1


def as_dict(diagnostic: Diagnostic) -> dict[str, Any]:
    """A diagnostic in the shape of the JSON formats."""
    return {
        "code": diagnostic.code,
        "severity": diagnostic.severity.value,
        "message": diagnostic.message,
        "file": diagnostic.file,
        "line": diagnostic.span.line,
        "column": diagnostic.span.column,
        "endColumn": diagnostic.span.end,
        "hint": diagnostic.hint,
        "stack": [{"name": f.name, "file": f.file, "line": f.line} for f in diagnostic.stack],
    }


def to_json(diagnostics: Sequence[Diagnostic]) -> str:
    return json.dumps({"version": JSON_VERSION, "diagnostics": [as_dict(d) for d in diagnostics]}, indent=2) + "\n"


def to_sarif(diagnostics: Sequence[Diagnostic]) -> str:
    """SARIF 2.1.0, one run."""
    from aircut import __version__

    codes = sorted({d.code for d in diagnostics})
    rules = [
        {"id": code, "shortDescription": {"text": FAULTS[code].message if code in FAULTS else code}} for code in codes
    ]
    results = [
        {
            "ruleId": d.code,
            "ruleIndex": codes.index(d.code),
            "level": d.severity.value,
            "message": {"text": f"{d.message}. {d.hint}" if d.hint else d.message},
            "locations": [{"physicalLocation": location(d)}],
        }
        for d in diagnostics
    ]
    driver = {"name": "aircut", "version": __version__, "rules": rules}
    run = {"tool": {"driver": driver}, "columnKind": "unicodeCodePoints", "results": results}
    schema = "https://json.schemastore.org/sarif-2.1.0.json"
    return json.dumps({"$schema": schema, "version": "2.1.0", "runs": [run]}, indent=2) + "\n"


def location(diagnostic: Diagnostic) -> dict[str, Any]:
    place: dict[str, Any] = {"artifactLocation": {"uri": diagnostic.file.replace("\\", "/")}}
    span = diagnostic.span
    if span.line:
        place["region"] = {"startLine": span.line}
        if span.column:
            place["region"] |= {"startColumn": span.column, "endColumn": max(span.end, span.column + 1)}
    return place


def to_github(diagnostics: Sequence[Diagnostic]) -> str:
    """Workflow commands that GitHub shows beside the lines."""
    return "".join(
        f"::{d.severity.value} file={escaped(d.file, True)}"
        + (f",line={d.span.line},col={max(d.span.column, 1)}" if d.span.line else "")
        + f",title={escaped(d.code, True)}::{escaped(d.message)}\n"
        for d in diagnostics
    )


def escaped(text: str, property: bool = False) -> str:
    text = text.replace("%", "%25").replace("\r", "%0D").replace("\n", "%0A")
    return text.replace(":", "%3A").replace(",", "%2C") if property else text


def to_vendor(diagnostics: Sequence[Diagnostic]) -> str:
    """Errors a line each, as the vendor's controller writes them; it knows no warnings."""
    return "".join(f"{d.vendor()}\n" for d in diagnostics if d.severity is Severity.ERROR)


FORMATS: dict[str, Callable[[Sequence[Diagnostic]], str]] = {
    "json": to_json,
    "sarif": to_sarif,
    "github": to_github,
    "vendor": to_vendor,
}
