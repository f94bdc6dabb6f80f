"""Values in a message's text: `#n` and `#<name>` become numbers.

There is no escape: every reference expands (AMB-MSG-6). A reference ends where its name does, so
`#4010.` is #4010 and a dot. What does not read as a reference (`#`, `#<open`, `#[1]`) stays as written.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable

UNKNOWN = "######"  # printed for a name that does not exist (AMB-NAM-2)

NUMBERED = re.compile(r"#[0-9]+")
MARKS = re.compile(r"#<|[<>\[\]#]")  # all that matters to where a name ends


def number(value: float | None) -> str:
    """A value as messages print it.

    Whole numbers without decimals, others rounded to six with trailing zeros dropped; None is `null`.
    Source: AMB-MSG-5.
    """
    if value is None:
        return "null"
    if not math.isfinite(value):
        return str(value)
    text = f"{value:.6f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text


def expand(text: str, evaluate: Callable[[str], str | None]) -> str:
    """The text with each reference replaced by what `evaluate` prints for it.

    evaluate: is given a reference as written, such as `#4010` or `#<array[#<_index> + 1]>`; returns
    its text, None where there is no such variable, which prints `######`. What it returns is not
    expanded again. Time: proportional to the text, beside what `evaluate` takes.
    """
    pieces: list[str] = []
    open_names: set[int] = set()  # starts of names found to have no end
    done = 0
    at = text.find("#")
    while at >= 0:
        end = reference_end(text, at, open_names)
        if end is None:
            at = text.find("#", at + 1)
            continue
        value = evaluate(text[at:end])
        pieces += [text[done:at], UNKNOWN if value is None else value]
        done = end
        at = text.find("#", end)
    return "".join([*pieces, text[done:]])


def reference_end(text: str, start: int, open_names: set[int]) -> int | None:
    """Where the reference that begins with the `#` at `start` ends; None: there is none.

    open_names: starts that are known to begin no name. Where a name turns out not to end, it and
    all names open within it are added, so that no text is read again for each of them.
    """
    if match := NUMBERED.match(text, start):
        return match.end()
    if not text.startswith("#<", start) or start in open_names:
        return None
    stack: list[tuple[int, str]] = []  # what is open: where, and what closes it
    for mark in MARKS.finditer(text, start):
        at, what = mark.start(), mark[0]
        in_name = bool(stack) and stack[-1][1] == ">"
        if what == "[" and stack:
            stack.append((at, "]"))
        elif what in ("#<", "<") and not in_name:  # <name> in an index is a slip, but no end
            stack.append((at, ">"))
        elif what == "#" and not in_name:
            pass  # a numbered variable in an index
        elif what == stack[-1][1]:
            opening, _ = stack.pop()
            if not stack:
                named = text[opening + 2 : at].strip()
                return at + 1 if named else None
        else:
            break
    open_names.update(at for at, _ in stack)
    return None
