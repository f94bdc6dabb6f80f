"""The virtual world around the machine, as a TOML file describes it.

Lengths mm in machine coordinates, times seconds since the run began.
"""

from __future__ import annotations

from math import cos, radians, sin
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import msgspec

if TYPE_CHECKING:
    from aircut.geometry.contact import Shape

Point = tuple[float, float, float]


class WorldError(Exception):
    """A world's file cannot be used; the text says which and why."""


class Body(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Something that the probe can touch.

    box: `at` is its lowest corner, `size` its edges. cylinder: `at` is the middle of its base, `axis` its
    direction. sphere: `at` is its middle. stl: a file beside the world's, moved by `at`.
    turn: degrees about X, then Y, then Z of the machine, with `at` staying in its place.
    """

    shape: Literal["box", "cylinder", "sphere", "stl"]
    at: Point = (0.0, 0.0, 0.0)
    size: Point = (0.0, 0.0, 0.0)
    axis: Point = (0.0, 0.0, 1.0)
    radius: float = 0.0
    height: float = 0.0
    file: str = ""
    turn: Point = (0.0, 0.0, 0.0)


class Input(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """One input: a constant `value`, or scripted: `times` of [seconds, value] pairs, or a `sequence` of readings."""

    number: int
    analog: bool = False
    value: float = 0.0
    times: list[tuple[float, float]] = []
    sequence: list[float] = []


class Reply(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """What the operator does with one window: presses Stop, or enters values and resumes."""

    stop: bool = False
    values: list[float | None] = []


class TrueTool(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A tool as it really is, where the table does not say so."""

    id: int
    length: float = 0.0
    diameter: float = 0.0


class File(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The shape of the file."""

    bodies: list[Body] = []
    inputs: list[Input] = []
    operator: list[Reply] = []
    tools: list[TrueTool] = []
    overshoot: float = 0.0  # mm that the probe moves on after its trip


class World:
    """Bodies, inputs and an operator."""

    def __init__(self, file: File | None = None, folder: Path = Path()) -> None:
        """Raises WorldError for a body that cannot be made."""
        self.file = file or File()
        self.warnings: list[str] = []  # what may not be as it was meant
        self.folder = folder
        self.body = self.make()
        self.tools = {tool.id: tool for tool in self.file.tools}
        self.inputs = {(one.number, one.analog): one for one in self.file.inputs}

    def make(self) -> Shape | None:
        """All bodies as one shape; None where there is none."""
        if not self.file.bodies:
            return None
        from aircut.geometry.contact import Union

        return Union([self.shape(body) for body in self.file.bodies])

    def shape(self, body: Body) -> Shape:
        from aircut.geometry import contact

        try:
            make = getattr(self, f"_{body.shape}")
            if not any(body.turn):
                return make(body, contact)
            made = make(msgspec.structs.replace(body, at=(0.0, 0.0, 0.0)), contact)
            return contact.Placed(made, body.at, rotation(body.turn))
        except (ValueError, OSError) as error:
            raise WorldError(f"{body.shape} at {body.at}: {error}") from None

    def _box(self, body: Body, contact: Any) -> Any:
        if min(body.size) <= 0.0:
            raise ValueError("size must be above zero on X, Y and Z")
        return contact.Box(body.at, tuple(a + s for a, s in zip(body.at, body.size, strict=True)))

    def _cylinder(self, body: Body, contact: Any) -> Any:
        if body.radius <= 0.0 or body.height <= 0.0:
            raise ValueError("radius and height must be above zero")
        return contact.Cylinder(body.at, body.axis, body.radius, body.height)

    def _sphere(self, body: Body, contact: Any) -> Any:
        if body.radius <= 0.0:
            raise ValueError("radius must be above zero")
        return contact.Sphere(body.at, body.radius)

    def _stl(self, body: Body, contact: Any) -> Any:
        import numpy as np
        import trimesh

        mesh = trimesh.load_mesh(self.folder / body.file)
        made = contact.Mesh(np.asarray(mesh.triangles, float) + np.asarray(body.at))
        if not made.closed:
            self.warnings.append(f"{body.file}: the surface is not closed: it counts as a sheet, with nothing inside")
        return made


def rotation(turn: Point) -> tuple[Point, Point, Point]:
    """Rows of the matrix that turns about X, then Y, then Z, degrees."""
    (sa, sb, sc), (ca, cb, cc) = (tuple(map(f, map(radians, turn))) for f in (sin, cos))
    return (
        (cb * cc, sa * sb * cc - ca * sc, ca * sb * cc + sa * sc),
        (cb * sc, sa * sb * sc + ca * cc, ca * sb * sc - sa * cc),
        (-sb, sa * cb, ca * cb),
    )


def load(path: Path) -> World:
    """The world in a file. Raises WorldError."""
    import tomllib

    try:
        file = msgspec.convert(tomllib.loads(path.read_text("utf-8")), File)
        return World(file, path.parent)
    except OSError as error:
        raise WorldError(f"{path}: {error.strerror}") from None
    except (ValueError, msgspec.ValidationError) as error:
        raise WorldError(f"{path}: {error}") from None
    except WorldError as error:
        raise WorldError(f"{path}: {error}") from None
