"""The summary of a run, as a table."""

from __future__ import annotations

from typing import IO, TYPE_CHECKING, Any

from rich.console import Console
from rich.table import Table
from rich.text import Text

from aircut import markup
from aircut.cli.common import totals
from aircut.controller.windows import BUTTONS, CUSTOM, HUD, shown
from aircut.export.report import figures

if TYPE_CHECKING:
    from aircut.api import Message, Result


def summary(result: Result, out: IO[str]) -> None:
    """Write the summary."""
    console = Console(file=out, highlight=False, soft_wrap=not out.isatty(), width=None if out.isatty() else 100)
    numbers = figures(result)
    console.print(extents(numbers["extents"]))
    rest = Table(show_header=False, box=None, pad_edge=False)
    rest.add_column(style="bold")
    rest.add_column(overflow="fold")
    for title, text in lines(result, numbers, out.isatty()):
        rest.add_row(title, Text.from_ansi(text))
    console.print(rest)


def extents(boxes: dict[str, Any]) -> Table:
    """Lowest and highest position on each axis, rapid and feed apart."""
    table = Table(title="Extents, machine coordinates", title_justify="left")
    table.add_column("axis")
    for kind in ("rapid", "feed"):
        table.add_column(f"{kind} from", justify="right")
        table.add_column("to", justify="right")
    rapid, feed = boxes["rapid"] or {}, boxes["feed"] or {}
    for axis in "xyzabc":
        if axis in rapid or axis in feed:
            unit = "mm" if axis in "xyz" else "°"
            cells = [f"{value:.3f}" for box in (rapid, feed) for value in box.get(axis, ())]
            if axis not in rapid:
                cells = ["", "", *cells]
            table.add_row(f"{axis.upper()} {unit}", *cells)
    return table


def window(message: Message, result: Result, terminal: bool) -> tuple[str, str]:
    """A message as the operator sees it: what it is, and its text with the window's buttons."""
    show = markup.ansi if terminal else markup.plain
    text = show(shown(message.text, message.kind, result.tool))
    if message.kind == HUD:
        return "HUD", text
    buttons = " ".join(f"[{button}]" for button in BUTTONS.get(message.kind, CUSTOM))
    return "picture" if message.medium == "media" else "message", f"{text}  {buttons}"


def lines(result: Result, numbers: dict[str, Any], terminal: bool = False) -> list[tuple[str, str]]:
    """The other figures: title and text. terminal: with codes for the styles of messages."""
    counts = numbers["counts"]
    length, rotation = numbers["length"], numbers["rotation"]
    rows = [
        ("path", f"{length['rapid']:.3f} mm rapid, {length['feed']:.3f} mm feed"),
        (
            "moves",
            "{moves:,}: {rapids:,} rapid, {feeds:,} straight feed, {arcs:,} arc".format(**counts),
        ),
        ("tools", ", ".join(f"T{tool}" for tool in numbers["tools"]) or "none"),
        ("lines", f"{counts['lines']:,}"),
    ]
    if rotation["rapid"] or rotation["feed"]:
        rows.insert(1, ("rotation", f"{rotation['rapid']:.3f}° rapid, {rotation['feed']:.3f}° feed"))
    if counts["stops"]:
        rows.append(("stops", f"{counts['stops']:,}, waiting for the operator"))
    if numbers["dwell_seconds"]:
        rows.append(("dwell", f"{numbers['dwell_seconds']:g} s"))
    rows += midway(result)
    rows += [window(message, result, terminal) for message in result.messages if message.text]
    rows.append(("faults", totals(result.diagnostics) or "none"))
    return rows


def midway(result: Result) -> list[tuple[str, str]]:
    """Where the run began and ended, if not with the program."""
    rows = []
    if result.arrival is not None:
        start = result.arrival
        rows.append(("start", f"line {start.line}, at {place(start.place)}, with {' '.join(start.modes)} {start.told}"))
        way = ", ".join(f"{code} {place(point)}" for code, point in start.approach)
        rows.append(("approach", f"{way or 'none'} (machine coordinates)"))
    if result.stop is not None:
        rows.append(("stop", f"before line {result.stop.line}, at {place(result.stop.place)} (machine coordinates)"))
    return rows


def place(point: tuple[float, ...]) -> str:
    """A point for people; rotary axes only where they are not at zero."""
    named = zip("XYZABC", point, strict=True)
    return " ".join(f"{axis}{round(value, 3) + 0.0:g}" for axis, value in named if axis in "XYZ" or value)
