"""The tool library: tools.toml in the machine's folder."""

from __future__ import annotations

import math

import msgspec

NO_TOOL = 0


class Tool(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """One tool. Lengths in mm."""

    id: int
    name: str = ""
    slot: int = 0  # 0: not in the magazine
    x: float = 0.0  # offsets; z is the length
    y: float = 0.0
    z: float = 0.0
    diameter: float = 0.0
    type: int = 0  # 0 generic, 1 flat, 2 ball nose, 3 drill, 4 probe, 5 saw, 6 plasma, 7 drag knife, 8 lathe
    p1: float = 0.0
    p2: float = 0.0
    p3: float = 0.0
    a: float = 0.0  # offsets of the other axes, degrees and mm
    b: float = 0.0
    c: float = 0.0
    u: float = 0.0
    v: float = 0.0
    w: float = 0.0

    def offsets(self) -> list[float]:
        """Offsets along X Y Z A B C U V W, mm and degrees."""
        return [self.x, self.y, self.z, self.a, self.b, self.c, self.u, self.v, self.w]


class Library(msgspec.Struct, forbid_unknown_fields=True):
    """The file's shape: [[tools]] tables."""

    tools: list[Tool] = []


EMPTY = Tool(NO_TOOL)


def parse(text: str) -> dict[int, Tool]:
    """Tools by id from the text of a tools.toml.

    Raises ValueError: TOML's or msgspec's, two tools of one id, a number that is not finite.
    """
    import tomllib

    tools: dict[int, Tool] = {}
    for tool in msgspec.convert(tomllib.loads(text), Library).tools:
        if tool.id in tools or tool.id < 1:
            raise ValueError(f"tool {tool.id}: ids are above zero, and each stands once")
        for field, value in msgspec.structs.asdict(tool).items():
            if isinstance(value, float) and not math.isfinite(value):
                raise ValueError(f"tool {tool.id}: {field} must be a finite number, not {value}")
        tools[tool.id] = tool
    return tools
