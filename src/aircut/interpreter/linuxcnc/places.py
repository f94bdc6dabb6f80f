"""Where a fault lies in a line: the columns of the word, the setting or the value at fault."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from aircut.diagnostics import Refusal, Span
from aircut.diagnostics import faults as F
from aircut.interpreter.compiling import FAILURES
from aircut.interpreter.linuxcnc.arranging import g_name
from aircut.interpreter.linuxcnc.blocks import Item, check_number, checked, parse_o, read
from aircut.interpreter.linuxcnc.text import clean, columns
from aircut.language.expressions import Application, Binary, Expression, Name, Number, Sign, Variable, Where
from aircut.language.text import COMMENT

if TYPE_CHECKING:
    from aircut.interpreter.linuxcnc.state import State
    from aircut.source import Source

EVALUATION = (Refusal, *FAILURES)


def span(source: Source, line: int, refusal: Refusal) -> Span:
    """Columns of a fault in a line, from 1."""
    text = source.text(line)
    try:
        code = clean(text, source.length(line)).code
    except Refusal as raised:  # the line could not even be cleaned: the place is as written
        start, end = raised.where or (0, 1)
        return Span(line + 1, start + 1, end + 1)
    start, end = place(code, refusal)
    at = columns(text)
    start, end = min(start, len(at) - 1), min(max(end, start + 1), len(at))
    last = at[end - 1]
    if code[end - 1 : end] == COMMENT:
        last = text.index(")", last)
    return Span(line + 1, at[start] + 1, last + 2)


def place(code: str, refusal: Refusal) -> Where:
    """Where a fault lies in a clean line."""
    try:
        oline = parse_o(code)
        items = read(code) if oline is None else []
        first = check_number(code) if oline is None else 0
    except Refusal as raised:
        return refusal.where or raised.where or (0, len(code))
    if oline is not None:
        return refusal.where or (code.index("o"), oline.end)
    return refusal.where or word(items, refusal) or (first, max(len(code.rstrip(COMMENT)), 1))


def word(items: Sequence[Item], refusal: Refusal) -> Where | None:
    """The last word that a Refusal speaks of: by its letter, and of codes by their name."""
    letter = refusal.letter
    code = str(refusal.values.get("second") or refusal.values.get("code") or "").split(" ")[0].lower()
    of_letter = [item for item in items if item.letter == letter and letter]
    of_code = [item for item in items if code and name_of(item) == code]
    found = (of_letter or of_code) if letter not in "gm" else (of_code or of_letter)
    return found[-1].where if found else None


def name_of(item: Item) -> str:
    """Name of a code that is written with its number; empty of all else."""
    if item.letter not in ("g", "m") or not isinstance(item.value, Number):
        return ""
    try:
        return g_name(item.value.value) if item.letter == "g" else f"m{item.value.value:g}"
    except Refusal as refusal:
        return str(refusal.values["code"]).lower()


# --- values


def explained(nodes: Sequence[Expression], m: State, failure: Exception) -> Refusal:
    """The Refusal of a value that could not be computed, with the place of the innermost that fails."""
    refusal = failure if isinstance(failure, Refusal) else Refusal(F.NO_VALUE)
    if refusal.where is None:
        refusal.where = failing(nodes, m)
    return refusal


def failing(nodes: Sequence[Expression], m: State) -> Where | None:
    """Place of the innermost value that cannot be computed."""
    for node in nodes:
        try:
            checked(node)(m, ())
        except EVALUATION:
            return failing(parts(node), m) or node.where
    return None


def parts(node: Expression) -> Sequence[Expression]:
    match node:
        case Variable():
            return (node.number,)
        case Sign():
            return (node.operand,)
        case Binary():
            return (node.left, node.right)
        case Application() if node.function.arguments != "name":
            return node.arguments
    return ()


def values_of(items: Sequence[Item]) -> list[Expression]:
    """All that is computed of a block: words, settings, the numbers of what they set."""
    numbers = [item.target.number for item in items if isinstance(item.target, Variable)]
    return [*(item.value for item in items), *numbers]


def target_of(code: str, nth: int) -> Where:
    """Place of the nth parameter that a block sets."""
    targets = [item.target for item in read(code) if isinstance(item.target, Variable | Name)]
    return targets[nth].where
