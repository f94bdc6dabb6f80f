"""The markup of a message's text (M109): `#n` expanded, tags parsed, the result shown as text, ANSI or HTML.

`expand` comes first, then `parse`, then one of the renderers; none of them raises, whatever the text is.
Sources: 000 section 10; decisions AMB-MSG-5, 6, 8, AMB-OCR-16.
"""

from aircut.markup.expanding import UNKNOWN, expand, number
from aircut.markup.parsing import DEEPEST, ToolInfo, parse
from aircut.markup.rendering import ansi, html, plain
from aircut.markup.tree import Break, Bullet, Document, Item, List, Node, Style, Text

__all__ = [
    "DEEPEST",
    "UNKNOWN",
    "Break",
    "Bullet",
    "Document",
    "Item",
    "List",
    "Node",
    "Style",
    "Text",
    "ToolInfo",
    "ansi",
    "expand",
    "html",
    "number",
    "parse",
    "plain",
]
