"""Probing whole programs on bodies in any pose, against closed forms; meshes that are not closed.

Where a convex body has the point P on its surface and an outward normal n there (any of those at an edge),
it lies behind the plane through P across n. So a ball of radius r that comes from before that plane touches
first with its center at C = P + r n, if it comes there at all: that is the closed form of all these tests.
"""

from math import cos, hypot, sin, tau
from pathlib import Path

import numpy as np
import pytest
import trimesh
from click.testing import CliRunner
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import aircut
from aircut.cli.main import cli
from aircut.controller import Simulation, World
from aircut.controller.world import Body, File
from aircut.machine import Tool, built_in

LENGTH = 80.0
MICRON = 1e-3

unit = st.floats(-1.0, 1.0)
share = st.floats(0.0, 1.0)
place = st.tuples(*[st.floats(-200.0, 200.0)] * 3)
size = st.floats(5.0, 60.0)
degrees = st.floats(-180.0, 180.0)


def turned(turn):
    """The matrix that turns about X, then Y, then Z: by multiplication, unlike the world's."""
    a, b, c = np.radians(turn)
    about_x = [[1, 0, 0], [0, cos(a), -sin(a)], [0, sin(a), cos(a)]]
    about_y = [[cos(b), 0, sin(b)], [0, 1, 0], [-sin(b), 0, cos(b)]]
    about_z = [[cos(c), -sin(c), 0], [sin(c), cos(c), 0], [0, 0, 1]]
    return np.array(about_z) @ np.array(about_y) @ np.array(about_x)


@st.composite
def boxes(draw):
    """A body, a point of its surface and a normal there; at faces, edges and corners."""
    sizes = draw(st.tuples(size, size, size))
    sides = [draw(st.sampled_from([-1, 0, 1])) for _ in range(3)]
    assume(any(sides))
    point = [s if side > 0 else 0.0 if side < 0 else s * draw(share) for side, s in zip(sides, sizes, strict=True)]
    normal = np.array([side * draw(st.floats(0.1, 1.0)) for side in sides])
    return Body("box", size=sizes), np.array(point), normal / np.linalg.norm(normal)


@st.composite
def cylinders(draw):
    radius, height, angle = draw(size), draw(size), draw(st.floats(0.0, tau))
    out = np.array([cos(angle), sin(angle), 0.0])
    where = draw(st.sampled_from(["wall", "top", "bottom", "rim"]))
    up = {"top": 1.0, "rim": 1.0, "bottom": 0.0}.get(where, draw(share))
    distance = radius if where in ("wall", "rim") else radius * draw(share)
    along, across = {"wall": (0.0, 1.0), "top": (1.0, 0.0), "bottom": (-1.0, 0.0)}.get(
        where, (draw(share), draw(share))
    )
    assume(hypot(along, across) > 0.1)
    normal = (across * out + np.array([0.0, 0.0, along])) / hypot(along, across)
    return Body("cylinder", radius=radius, height=height), distance * out + np.array([0.0, 0.0, up * height]), normal


@st.composite
def spheres(draw):
    radius = draw(size)
    normal = np.array([draw(unit), draw(unit), draw(unit)])
    assume(np.linalg.norm(normal) > 0.1)
    normal /= np.linalg.norm(normal)
    return Body("sphere", radius=radius), radius * normal, normal


def probe(body: Body, start, target, radius: float, code: str) -> tuple[float | None, np.ndarray]:
    """#5700 and the place of the ball's center, from #5711 to #5713; start and target: of the center."""
    made = built_in("XYZ")
    made.tools = {9: Tool(9, z=LENGTH, diameter=2 * radius, type=4)}
    tip = np.array([0.0, 0.0, radius])
    words = ["X{:.10f} Y{:.10f} Z{:.10f}".format(*(np.array(p) - tip)) for p in (start, target)]
    run = aircut.loads(f"T9 M6 G43\nF100\nG0 {words[0]}\n{code} {words[1]}\n#500=#5700\nM2\n").interpreter(made)
    for _ in Simulation(run, World(File(bodies=[body]))).run():
        pass
    assert not run.failed, run.diagnostics
    m = run.state
    stopped = np.array([np.nan if v is None else v for v in m.probed_machine[:3]])
    return m.numbered[500], stopped - [0.0, 0.0, LENGTH - radius]


@settings(max_examples=250, deadline=None)
@given(
    what=st.one_of(boxes(), cylinders(), spheres()),
    at=place,
    turn=st.tuples(degrees, degrees, degrees),
    radius=st.floats(0.1, 6.0),
    way=st.tuples(unit, unit, unit),
    before=st.floats(0.5, 80.0),
    beyond=st.floats(1.0, 50.0),
)
def test_first_contact_and_leaving(what, at, turn, radius, way, before, beyond) -> None:
    body, point, normal = what
    body = Body(body.shape, at, body.size, radius=body.radius, height=body.height, turn=turn)
    matrix = turned(turn)
    point, normal = np.array(at) + matrix @ point, matrix @ normal
    assume(np.linalg.norm(way) > 0.1)
    direction = np.array(way) / np.linalg.norm(way)
    steep = -float(normal @ direction)
    assume(steep > 0.05)
    center = point + radius * normal
    state, stop = probe(body, center - before * direction, center + beyond * direction, radius, "G38.2")
    assert state == 1.0
    assert np.abs(stop - center).max() < MICRON
    inside = center + radius * steep * direction
    state, stop = probe(body, inside, center - before * direction, radius, "G38.4")
    assert state == 1.0
    assert np.abs(stop - center).max() < MICRON


def test_turns_of_a_body_by_hand() -> None:
    """A box of 10 by 20 by 30 turned by 90 degrees about Z reaches from X -20 to 0 and from Y 0 to 10."""
    body = Body("box", at=(0.0, 0.0, 0.0), size=(10.0, 20.0, 30.0), turn=(0.0, 0.0, 90.0))
    assert probe(body, (-50, 5, 15), (0, 5, 15), 1.0, "G38.2")[1] == pytest.approx([-21, 5, 15], abs=1e-9)
    assert probe(body, (-10, 50, 15), (-10, 0, 15), 1.0, "G38.2")[1] == pytest.approx([-10, 11, 15], abs=1e-9)
    assert probe(body, (5, 5, 15), (1.5, 5, 15), 1.0, "G38.3")[0] == -1.0


def test_a_mesh_that_is_not_closed_is_told_of(tmp_path: Path) -> None:
    cube = trimesh.creation.box(extents=(20.0, 20.0, 10.0))
    cube.export(tmp_path / "whole.stl")
    cube.update_faces([True] * 10 + [False] * 2)
    cube.export(tmp_path / "open.stl")
    (tmp_path / "p.ngc").write_text("M2\n")
    for name, warned in (("whole", False), ("open", True)):
        world = World(File(bodies=[Body("stl", file=f"{name}.stl")]), tmp_path)
        assert bool(world.warnings) is warned
        (tmp_path / "w.toml").write_text(f'[[bodies]]\nshape = "stl"\nfile = "{name}.stl"\n')
        done = CliRunner().invoke(cli, ["run", str(tmp_path / "p.ngc"), "--world", str(tmp_path / "w.toml")])
        assert done.exit_code == 0
        assert ("open.stl: the surface is not closed" in done.output) is warned


def test_a_turned_mesh(tmp_path: Path) -> None:
    trimesh.creation.box(extents=(20.0, 20.0, 10.0)).export(tmp_path / "part.stl")
    body = Body("stl", at=(50.0, 0.0, 0.0), file="part.stl", turn=(0.0, 90.0, 0.0))
    shape = World(File(bodies=[body]), tmp_path).body
    assert shape is not None
    part = shape.touch((0.0, 0.0, 0.0), (100.0, 0.0, 0.0), 2.0)
    assert part == pytest.approx((50.0 - 5.0 - 2.0) / 100.0, abs=1e-8)
