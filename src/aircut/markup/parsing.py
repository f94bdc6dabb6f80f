"""The tags of a message's text, read into a document.

The tags are rows: `STYLES` those that start and stop a style, the others `Reader.tags`. A tag that is
not documented, or is not well formed, is text. A style that is not stopped lasts to the end; a stop
without a start does nothing.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Protocol

from aircut.markup.expanding import number
from aircut.markup.tree import Break, Bullet, Document, Item, List, Node, Style, Text

DEEPEST = 16  # lists in lists; the items of deeper ones go into the deepest

BLANKS = " \t\r\n"  # nothing beside line breaks, lists and items

STYLES = {
    "b": Style.BOLD,
    "u": Style.UNDERLINE,
    "i": Style.ITALIC,
    "s": Style.STRIKE,
    "sub": Style.SUB,
    "sup": Style.SUP,
    "shad": Style.SHADOW,
    "hi": Style.HIGHLIGHT,
    "e": Style.ERROR,
}

COLORS = {
    "aqua": "#00ffff",
    "black": "#000000",
    "blue": "#0000ff",
    "brown": "#a52a2a",
    "cyan": "#00ffff",
    "fuchsia": "#ff00ff",
    "gold": "#ffd700",
    "gray": "#808080",
    "green": "#008000",
    "grey": "#808080",
    "lime": "#00ff00",
    "magenta": "#ff00ff",
    "maroon": "#800000",
    "navy": "#000080",
    "olive": "#808000",
    "orange": "#ffa500",
    "pink": "#ffc0cb",
    "purple": "#800080",
    "red": "#ff0000",
    "silver": "#c0c0c0",
    "teal": "#008080",
    "violet": "#ee82ee",
    "white": "#ffffff",
    "yellow": "#ffff00",
}

RULES = re.ASCII | re.IGNORECASE
BETWEEN = re.compile(r"<([^<>]*)>")
VALUE = r"""(?:"[^"]*"|'[^']*'|[^\s"'=/]++)"""
TAG = re.compile(rf"(/?)([a-z]++)((?:\s++[a-z]++\s*+=\s*+{VALUE})*+)\s*+/?", RULES)
ATTRIBUTE = re.compile(rf"([a-z]++)\s*+=\s*+({VALUE})", RULES)
TOOL_TAG = re.compile(r"@t([id])\s*+=\s*+(.*)", RULES | re.DOTALL)
TOOL_ID = re.compile(r"""["']?\+?([0-9]{1,9})(?:\.0*)?["']?""")
HEX_COLOR = re.compile(r"#(?:[0-9a-f]{3}|[0-9a-f]{6})")


class ToolInfo(Protocol):
    """What the tool tags tell of a tool; `aircut.machine.Tool` is one."""

    @property
    def id(self) -> int: ...
    @property
    def name(self) -> str: ...
    @property
    def slot(self) -> int: ...  # 0: not in the magazine
    @property
    def diameter(self) -> float: ...  # mm
    @property
    def z(self) -> float: ...  # length, mm


def parse(text: str, tool: Callable[[int], ToolInfo | None] | None = None, *, tags: bool = True) -> Document:
    """The document that a text with tags means; `expand` comes before.

    tool: the tool of an id, None where there is none; what a tag says of it is text and never tags.
    tags: False in windows that do not take them (Q4, Q100 and above): the text is shown as it is.
    Raises nothing of its own, whatever the text. Time: proportional to the text.
    Source: 000 sections 10.2 and 10.3; AMB-MSG-8, AMB-OCR-16.
    """
    reader = Reader(tool)
    if not tags:
        reader.text(text)
        return reader.finish()
    done = 0
    for match in BETWEEN.finditer(text):
        before = text[done : match.start()]
        if reader.tag(before, match[1]):
            done = match.end()
    reader.text(text[done:])
    return reader.finish()


class Level:
    """A list being read, or at the bottom the document itself."""

    def __init__(self) -> None:
        self.items: list[Item] = []
        self.begin()

    def begin(self, bullet: Bullet | None = None, color: str | None = None) -> None:
        """Begin an item; one without bullet counts only when something comes into it."""
        self.nodes: list[Node] = []
        self.bullet = bullet
        self.color = color

    def end(self) -> None:
        """End the item that is being read."""
        if self.nodes or self.bullet is not None:
            self.items.append(Item(tuple(self.nodes), self.bullet, self.color))


class Reader:
    """Puts a document together from its texts and tags, in order."""

    def __init__(self, tool: Callable[[int], ToolInfo | None] | None) -> None:
        self.tool = tool
        self.levels = [Level()]
        self.too_deep = 0  # lists open above DEEPEST
        self.counts = dict.fromkeys(STYLES, 0)  # times each style was started and not stopped
        self.style = Style.NONE
        self.run: list[str] = []  # pieces of text of one style, not yet a node
        self.at_margin = False  # right behind a break or bullet: blanks are nothing

    def text(self, text: str) -> None:
        """Text in the present style."""
        if self.at_margin:
            text = text.lstrip(BLANKS)
        if text:
            self.at_margin = False
            self.run.append(text)

    def tag(self, before: str, body: str) -> bool:
        """Carry out the tag that stands behind a text; False, with nothing done, where it is none.

        body: what stands between < and >.
        """
        if body.startswith("@"):
            match = TOOL_TAG.fullmatch(body)
            if match is None:
                return False
            self.text(before)
            self.text(self.told(match[1].lower(), match[2].strip()))
            return True
        match = TAG.fullmatch(body)
        if match is None:
            return False
        stop, name = bool(match[1]), match[2].lower()
        carry_out = self.tags.get((stop, name))
        if name not in STYLES and carry_out is None:
            return False
        self.text(before)
        if carry_out is not None:
            carry_out(self, match[3])
        else:
            self.switch(name, stop)
        return True

    def told(self, what: str, written: str) -> str:
        """What is said of a tool; nothing where it is not known.

        what: i for all of it, d for its description.    written: its id, as in the text.
        """
        match = TOOL_ID.fullmatch(written)
        tool = self.tool(int(match[1])) if match and self.tool else None
        if tool is None:
            return ""
        return tool_text(tool) if what == "i" else tool.name

    def switch(self, name: str, stop: bool) -> None:
        """Start or stop a style."""
        self.counts[name] = max(self.counts[name] - 1, 0) if stop else self.counts[name] + 1
        style = self.style | STYLES[name] if self.counts[name] else self.style & ~STYLES[name]
        if style != self.style:
            self.flush()
            self.style = style

    def flush(self) -> None:
        """Make a node of the run."""
        if self.run:
            self.levels[-1].nodes.append(Text("".join(self.run), self.style))
            self.run = []

    def margin(self) -> None:
        """A line ends here: the blanks before it and those to come are nothing."""
        self.flush()
        nodes = self.levels[-1].nodes
        while nodes and isinstance(last := nodes[-1], Text):
            nodes.pop()
            if kept := last.text.rstrip(BLANKS):
                nodes.append(Text(kept, last.style))
                break
        self.at_margin = True

    def line_break(self, _: str) -> None:
        self.margin()
        self.levels[-1].nodes.append(Break())

    def list_start(self, _: str) -> None:
        self.margin()
        if len(self.levels) <= DEEPEST:
            self.levels.append(Level())
        else:
            self.too_deep += 1

    def list_end(self, _: str) -> None:
        self.margin()
        if self.too_deep:
            self.too_deep -= 1
        elif len(self.levels) > 1:
            level = self.levels.pop()
            level.end()
            if level.items:
                self.levels[-1].nodes.append(List(tuple(level.items)))

    def item_start(self, attributes: str) -> None:
        """<LI>; outside of any list it begins one (AMB-OCR-16)."""
        self.margin()
        if len(self.levels) == 1:
            self.levels.append(Level())
        given = {name.lower(): value.strip("\"'").strip().lower() for name, value in ATTRIBUTE.findall(attributes)}
        kind = given.get("type", "")
        self.levels[-1].end()
        self.levels[-1].begin(BULLETS.get(kind, Bullet.DISC), color(given.get("color", "")))

    def item_end(self, _: str) -> None:
        """</LI>: not documented and often written; the next <LI> ends an item."""
        self.margin()

    def finish(self) -> Document:
        """The document; lists still open end here."""
        while len(self.levels) > 1:
            self.too_deep = 0
            self.list_end("")
        self.flush()
        return Document(tuple(self.levels[0].nodes))

    # by whether they stop something, and name
    tags: dict[tuple[bool, str], Callable[[Reader, str], None]] = {
        (False, "br"): line_break,
        (False, "ul"): list_start,
        (True, "ul"): list_end,
        (False, "li"): item_start,
        (True, "li"): item_end,
    }


BULLETS = {bullet.value: bullet for bullet in Bullet}


def color(written: str) -> str | None:
    """A color as # and six hexadecimal digits; None where it is none.

    written: in small letters; #rgb, #rrggbb or a name of COLORS, also in Delphi's form (clred).
    """
    if HEX_COLOR.fullmatch(written):
        return written if len(written) == 7 else "#" + "".join(2 * digit for digit in written[1:])
    return COLORS.get(written) or COLORS.get(written.removeprefix("cl"))


def tool_text(tool: ToolInfo) -> str:
    """A tool in one line: `T3 drill, diameter 5 mm, length 42.5 mm, slot 2`; what is 0 is left out."""
    parts = [f"T{tool.id} {tool.name}".rstrip()]
    if tool.diameter:
        parts.append(f"diameter {number(tool.diameter)} mm")
    if tool.z:
        parts.append(f"length {number(tool.z)} mm")
    if tool.slot:
        parts.append(f"slot {tool.slot}")
    return ", ".join(parts)
