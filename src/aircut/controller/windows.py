"""What the operator sees of M109 and M120: windows with their buttons, and the text over the picture (HUD).

Sources: 000 section 10.1; decisions AMB-MSG-1, AMB-MSG-3, AMB-MSG-8.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

from aircut import markup
from aircut.interpreter.requests import Ask
from aircut.markup import Document, ToolInfo

HUD = 4  # the kind that is no window
RESUME, STOP = "Resume", "Stop"
#: By the Q word; windows above 100 are custom ones.
BUTTONS = {0: (RESUME,), 1: (STOP,), 2: (STOP, RESUME), 3: (STOP, RESUME)}
CUSTOM = (STOP, RESUME)
TAGGED = (0, 1, 2, 3)  # kinds that show tags; others show the text as it is


class Window(NamedTuple):
    """A window as it is shown. inputs: the values that its fields begin with."""

    text: str  # values expanded, tags as written
    kind: int  # the Q word
    buttons: tuple[str, ...]
    inputs: tuple[float | None, ...]
    document: Document
    picture: Path | None = None


def window(ask: Ask, tool: Callable[[int], ToolInfo | None] | None = None) -> Window:
    """The window of a request. tool: tools by id, for the tags that tell of them."""
    buttons = BUTTONS.get(ask.kind, CUSTOM)
    return Window(ask.text, ask.kind, buttons, ask.defaults, shown(ask.text, ask.kind, tool), ask.picture)


def shown(text: str, kind: int, tool: Callable[[int], ToolInfo | None] | None = None) -> Document:
    """A message as its window shows it."""
    return markup.parse(text, tool, tags=kind in TAGGED)
