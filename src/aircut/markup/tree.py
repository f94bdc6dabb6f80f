"""What a message says, once its tags are understood: runs of styled text, line breaks, lists.

Styles are of a run, not nodes around it: the tags start and stop a style and need not nest,
so `<B>a<I>b</B>c</I>` is three runs. Only lists nest.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum, Flag, auto


class Style(Flag):
    """How a run of text looks; any of them together."""

    NONE = 0
    BOLD = auto()
    UNDERLINE = auto()
    ITALIC = auto()
    STRIKE = auto()
    SUB = auto()
    SUP = auto()
    SHADOW = auto()
    HIGHLIGHT = auto()
    ERROR = auto()


class Bullet(Enum):
    """The mark before a list item; its value is CSS's name of it."""

    DISC = "disc"  # where the program says nothing
    CIRCLE = "circle"
    SQUARE = "square"


@dataclass(frozen=True, slots=True)
class Text:
    """A run of text of one style, never empty."""

    text: str  # as written: may hold any character
    style: Style = Style.NONE


@dataclass(frozen=True, slots=True)
class Break:
    """A line break."""


@dataclass(frozen=True, slots=True)
class Item:
    """A list item."""

    nodes: tuple[Node, ...]
    bullet: Bullet | None = Bullet.DISC  # None: what stands in a list before its first item
    color: str | None = None  # of the bullet: # and six hexadecimal digits, nothing else


@dataclass(frozen=True, slots=True)
class List:
    """An unordered list: one item or more."""

    items: tuple[Item, ...]


@dataclass(frozen=True, slots=True)
class Document:
    """A message. Blanks beside line breaks, lists and items are gone; all other text is as written."""

    nodes: tuple[Node, ...]


Node = Text | Break | List
