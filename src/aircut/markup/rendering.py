"""A message's document for those who show it: plain text, text for a terminal, HTML.

Each style is a row, with its terminal code and its HTML tag. Text of the program goes out escaped:
nothing in it can be a tag in a page or a command to a terminal.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from html import escape
from typing import NamedTuple

from aircut.markup.tree import Break, Bullet, Document, Item, Node, Style, Text


class Look(NamedTuple):
    """How a style is shown."""

    code: str = ""  # the terminal's (SGR, ECMA-48)
    tag: str = ""  # HTML's
    css: str = ""  # the tag's style attribute


LOOKS = {
    Style.BOLD: Look("1", "b"),
    Style.UNDERLINE: Look("4", "u"),
    Style.ITALIC: Look("3", "i"),
    Style.STRIKE: Look("9", "s"),
    Style.SUB: Look("", "sub"),
    Style.SUP: Look("", "sup"),
    Style.SHADOW: Look("", "span", "text-shadow:1px 1px 2px"),
    Style.HIGHLIGHT: Look("7", "mark"),
    # a wavy line has a code of its own (4:3), which some terminals take for another
    Style.ERROR: Look("4;31", "span", "text-decoration:underline wavy red"),
}

MARKS = {Bullet.DISC: "•", Bullet.CIRCLE: "◦", Bullet.SQUARE: "▪"}
INDENT = "  "  # as wide as a bullet with its blank

RAISED = str.maketrans("0123456789+-=()ni", "⁰¹²³⁴⁵⁶⁷⁸⁹⁺⁻⁼⁽⁾ⁿⁱ")
LOWERED = str.maketrans("0123456789+-=()", "₀₁₂₃₄₅₆₇₈₉₊₋₌₍₎")

UNSAFE = re.compile(r"[\x00-\x08\x0b-\x1f\x7f-\x9f\ud800-\udfff]")  # controls and lone surrogates
INSTEAD = "\N{REPLACEMENT CHARACTER}"


# --- lines of text


def plain(document: Document) -> str:
    """The document as text with newlines. Text without tags is itself.

    Bullets are characters; raised and lowered text is Unicode's or `^(text)`, `_(text)`, lest
    10<SUP>3</SUP> read as 103; other styles are not shown. Not made safe for a terminal: see `ansi`.
    """
    return "\n".join(lines(document.nodes, shifted, plain_bullet))


def ansi(document: Document) -> str:
    """The document for a terminal: `plain`, with SGR codes for the styles that terminals have.

    Control characters of the program's (escape sequences) are replaced. No code lasts beyond a line.
    """
    return "\n".join(lines(document.nodes, ansi_run, ansi_bullet))


def lines(nodes: tuple[Node, ...], run: Callable[[str, Style], str], bullet: Callable[[Item], str]) -> list[str]:
    """The lines of a block.

    run: shows text that has no newline.    bullet: shows an item's bullet, two columns wide.
    """
    done: list[str] = []
    line: list[str] | None = None  # None: not begun, and no line unless something follows
    for node in nodes:
        if isinstance(node, Text):
            for nth, part in enumerate(node.text.split("\n")):
                if nth:
                    done.append("".join(line or []))
                    line = None
                line = line or []
                line.append(run(part, node.style))
        elif isinstance(node, Break):
            done.append("".join(line or []))
            line = None
        else:
            if line is not None:
                done.append("".join(line))
                line = None
            for item in node.items:
                head, *tail = lines(item.nodes, run, bullet) or [""]
                done.append((bullet(item) + head).rstrip(" "))
                done += [INDENT + below if below else "" for below in tail]
    if line is not None:
        done.append("".join(line))
    return done


def shifted(text: str, style: Style) -> str:
    """The text, raised or lowered where its style says so."""
    for shift, letters, sign in ((Style.SUP, RAISED, "^"), (Style.SUB, LOWERED, "_")):
        if shift in style and text.strip():
            small = text.translate(letters)
            fits = all(ord(character) in letters or character == " " for character in text)
            text = small if fits else f"{sign}({text})"
    return text


def plain_bullet(item: Item) -> str:
    return INDENT if item.bullet is None else MARKS[item.bullet] + " "


def ansi_run(text: str, style: Style) -> str:
    codes = ";".join(look.code for bit, look in LOOKS.items() if bit in style and look.code)
    text = safe(shifted(text, style))
    return f"\x1b[{codes}m{text}\x1b[0m" if codes and text else text


def ansi_bullet(item: Item) -> str:
    if item.bullet is None or item.color is None:
        return plain_bullet(item)
    red, green, blue = bytes.fromhex(item.color[1:])
    return f"\x1b[38;2;{red};{green};{blue}m{MARKS[item.bullet]}\x1b[0m "


def safe(text: str) -> str:
    """The text without what a terminal or a page might obey or choke on."""
    return UNSAFE.sub(INSTEAD, text)


# --- HTML


def html(document: Document) -> str:
    """The document as a fragment of HTML, safe in a page's body.

    It has no tags but b, u, i, s, sub, sup, mark, span, br, ul, li, no attributes but style and
    aria-hidden, and no values in them but this module's own and checked colors. Newlines and rows
    of blanks are as in the text: show it under `white-space: pre-wrap`.
    """
    return "".join(map(html_node, document.nodes))


def html_node(node: Node) -> str:
    if isinstance(node, Text):
        return html_run(node)
    if isinstance(node, Break):
        return "<br>"
    # said, because browsers choose another bullet for a list in a list
    return '<ul style="list-style-type:disc">' + "".join(map(html_item, node.items)) + "</ul>"


def html_run(node: Text) -> str:
    opening, closing = "", ""
    for bit, look in LOOKS.items():
        if bit in node.style:
            opening += f'<{look.tag} style="{look.css}">' if look.css else f"<{look.tag}>"
            closing = f"</{look.tag}>" + closing
    return opening + escape(safe(node.text)) + closing


def html_item(item: Item) -> str:
    inside = "".join(map(html_node, item.nodes))
    if item.bullet is None:
        return f'<li style="list-style-type:none">{inside}</li>'
    if item.color is not None:  # CSS colors a bullet only from a style sheet, so this one is text
        css = f"display:inline-block;width:1em;margin-left:-1em;color:{item.color}"
        mark = f'<span aria-hidden="true" style="{css}">{MARKS[item.bullet]}</span>'
        return f'<li style="list-style-type:none">{mark}{inside}</li>'
    if item.bullet is Bullet.DISC:
        return f"<li>{inside}</li>"
    return f'<li style="list-style-type:{item.bullet.value}">{inside}</li>'
