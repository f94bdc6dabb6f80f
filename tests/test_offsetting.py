"""Compensated paths against an independent offset: shapely's buffer of the programmed contour."""

from __future__ import annotations

import random
from math import atan2, cos, hypot, pi, sin, tan

import msgspec
import numpy as np
import pytest
import shapely

import aircut
from aircut.geometry.polylines import polyline
from aircut.machine import Machine, built_in

FINE = 1e-4  # mm between a drawn arc and its chords
NEAR = 1e-3  # mm: the tool may be nearer to the contour than its radius by this
SEEDS = 20
ROUND = 128  # segments to a quarter of the buffer's circles


class Contour:
    """Lines and arcs from point to point: its program, and its shape as shapely sees it."""

    def __init__(self, start: tuple[float, float]) -> None:
        self.start = self.at = (round(start[0], 6), round(start[1], 6))
        self.blocks: list[str] = []
        self.points = [self.at]
        self.elements: list[list[tuple[float, float]]] = []
        self.centers: list[tuple[float, float] | None] = []

    def line(self, end: tuple[float, float]) -> None:
        self.at = (round(end[0], 6), round(end[1], 6))
        self.blocks.append(f"G1 X{self.at[0]:.6f} Y{self.at[1]:.6f}")
        self.add(None, [self.at])

    def arc(self, end: tuple[float, float], bulge: float) -> None:
        """An arc whose height over its chord is bulge·chord, to the left if positive."""
        end = (round(end[0], 6), round(end[1], 6))
        chord = hypot(end[0] - self.at[0], end[1] - self.at[1])
        # The angle swept is 4·atan(2·bulge); clockwise when it bends to the left of the chord.
        swept = 4 * np.arctan(2 * abs(bulge))
        radius = chord / 2 / sin(swept / 2)
        sign = -1 if bulge > 0 else 1
        ahead = atan2(end[1] - self.at[1], end[0] - self.at[0])
        height = sign * chord / 2 / tan(swept / 2)
        center = (
            (self.at[0] + end[0]) / 2 - height * sin(ahead),
            (self.at[1] + end[1]) / 2 + height * cos(ahead),
        )
        i, j = center[0] - self.at[0], center[1] - self.at[1]
        code = "G3" if sign > 0 else "G2"
        self.blocks.append(f"{code} X{end[0]:.6f} Y{end[1]:.6f} I{i:.9f} J{j:.9f}")
        pieces = int(swept / np.sqrt(8 * FINE / radius)) + 2
        first = atan2(-j, -i)
        angles = [first + sign * swept * k / pieces for k in range(1, pieces)]
        self.add(center, [*((center[0] + radius * cos(a), center[1] + radius * sin(a)) for a in angles), end])
        self.at = end

    def add(self, center: tuple[float, float] | None, points: list[tuple[float, float]]) -> None:
        self.elements.append([self.points[-1], *points])
        self.centers.append(center)
        self.points += points

    def edge(self, end: tuple[float, float], bulge: float) -> None:
        if abs(bulge) < 0.02:
            self.line(end)
        else:
            self.arc(end, bulge)

    def band(self, radius: float) -> shapely.Geometry:
        """All that is nearer to the contour than a radius, put together of exact parts.

        shapely's buffer of the whole simplifies concave stretches by a hundredth of the radius.
        """
        parts = [shapely.Point(place).buffer(radius, quad_segs=ROUND) for place in (self.start, *self.ends)]
        first = self.start
        for center, points in zip(self.centers, self.elements, strict=True):
            if center is None:
                parts.append(shapely.LineString([first, points[-1]]).buffer(radius, cap_style="flat"))
            else:
                spokes = np.subtract(points, center)
                size = np.hypot(*spokes[0])
                outer = center + spokes * (1 + radius / size)
                inner = center + spokes * max(1 - radius / size, 0.0)
                parts.append(shapely.Polygon([*outer, *inner[::-1]]))
            first = points[-1]
        return shapely.union_all(parts)

    @property
    def ends(self) -> list[tuple[float, float]]:
        return [points[-1] for points in self.elements]


def star(seed: int, rough: float, smallest: int = 4, bent: float = 0.3) -> Contour:
    """A closed contour, counterclockwise, that begins and ends within a straight edge. rough: of its radii."""
    pick = random.Random(seed)
    count = pick.randint(smallest, 2 * smallest)
    corners = []
    for k in range(count):
        angle = (k + pick.uniform(-0.3, 0.3)) * 2 * pi / count
        radius = 50 * (1 + rough * pick.uniform(-1, 1))
        corners.append((radius * cos(angle), radius * sin(angle)))
    (ax, ay), (bx, by) = corners[-1], corners[0]
    made = Contour(((ax + bx) / 2, (ay + by) / 2))
    made.line(corners[0])
    for corner in corners[1:]:
        made.edge(corner, pick.choice((0.0, pick.uniform(-bent, bent))))
    made.line(made.start)
    return made


def terrain(seed: int) -> Contour:
    """An open contour from left to right with steps and slots that no tool of some size reaches."""
    pick = random.Random(seed)
    made = Contour((0.0, 0.0))
    made.line((20.0, 0.0))
    for _ in range(pick.randint(3, 10)):
        end = (made.at[0] + pick.uniform(0.5, 15), pick.uniform(-12, 12))
        steep = abs(end[1] - made.at[1]) / (end[0] - made.at[0])
        made.edge(end, pick.choice((0.0, pick.uniform(-0.2, 0.2))) if steep < 1 else 0.0)
    made.line((made.at[0] + 5.0, 0.0))
    made.line((made.at[0] + 20.0, 0.0))
    return made


def machine(entry: str) -> Machine:
    made = built_in()
    made.options = msgspec.structs.replace(made.options, entry=entry)
    return made


def led(contour: Contour, radius: float, side: str, entry: str, start: tuple[float, float]) -> np.ndarray | None:
    """Where the tool's center goes beside the contour, entry and exit left out; None for gouging."""
    program = "\n".join([
        f"F500 G0 X{start[0]:.6f} Y{start[1]:.6f}",
        f"{side} D{2 * radius:.6f}",
        f"G1 X{contour.start[0]:.6f} Y{contour.start[1]:.6f}",
        *contour.blocks,
        "G40",
        f"G1 X{start[0]:.6f} Y{start[1]:.6f}",
        "M2",
    ])  # fmt: skip
    result = aircut.loads(program).run(machine(entry))
    if not result.ok:
        (fault,) = (d.code for d in result.diagnostics if d.severity == "error")
        assert fault.startswith("gouging"), program
        return None
    points, move = polyline(result.toolpath, tolerance_mm=FINE)
    last = len(result.toolpath) - 1
    return points[(move > 0) & (move < last)][:, :2]


def matches(path: np.ndarray, wanted: shapely.Geometry, contour: Contour, radius: float, spared: float = 0.0) -> None:
    """The path is the wanted line, and its points are a radius from the contour. spared: mm around its start."""
    tolerance = 2e-3  # the chords of arcs, and what rounding programs to 1e-6 does at shallow corners
    line = shapely.LineString(path)
    shape = shapely.LineString(contour.points)
    dense, all_of = (shapely.points(shapely.segmentize(one, 0.5).coords) for one in (line, wanted))
    assert shapely.distance(dense, shape).min() > radius - NEAR
    for points, other in ((dense, wanted), (all_of, line)):
        far = points[shapely.distance(points, shapely.Point(contour.start)) > spared]
        assert shapely.distance(far, other).max() < tolerance


def reached(contour: Contour, offset: shapely.Geometry, radius: float) -> float:
    """How far beyond its radius the tool's way stays from the element that it does not touch, if any, mm."""
    return max(float(shapely.distance(shapely.LineString(one), offset)) - radius for one in contour.elements)


@pytest.mark.parametrize("entry", ["nist", "easy", "normal"])
@pytest.mark.parametrize("side", ["G41.1", "G42.1"])
def test_closed_contours(side, entry):
    """Inside and outside a random closed contour the path is the buffer's boundary, or gouging is told where it is."""
    seen = told = 0
    for seed in range(SEEDS):
        contour = star(seed, 0.15)
        shape = shapely.Polygon(contour.points)
        radius = random.Random(seed).uniform(1, 5)
        inside = side == "G41.1"
        band = contour.band(radius)
        offset = shape.difference(band) if inside else shape.union(band)
        if offset.geom_type != "Polygon" or offset.interiors:
            continue
        first = np.subtract(contour.points[1], contour.start)
        back = np.array([-first[1], first[0]]) / np.hypot(*first) - 0.3 * first / np.hypot(*first)
        start = np.add(contour.start, (1 if inside else -1) * 3 * radius * back)
        path = led(contour, radius, side, entry, tuple(start))
        if path is None:
            assert entry != "normal" and reached(contour, offset, radius) > 1e-5, seed
            told += 1
            continue
        matches(path, offset.boundary, contour, radius, 2.5 * radius if entry == "nist" else 0.0)
        seen += 1
    assert seen > SEEDS / 3, told


def test_what_the_tool_cannot_reach_is_left_out():
    """Over random steps and slots the entry Normal leads the tool along the boundary of all that it may not enter."""
    cut = 0
    for seed in range(60):
        contour = terrain(seed)
        radius = random.Random(seed).uniform(1, 8)
        (left, _), (right, _) = contour.start, contour.at
        ground = shapely.Polygon([*contour.points, (right, -60), (left, -60)])
        if not ground.is_valid:
            continue
        offset = ground.union(contour.band(radius)).union(shapely.box(left - 9, -60, left, 0))
        path = led(contour, radius, "G41.1", "normal", (left - 5, 3 * radius))
        assert path is not None, seed
        sky = shapely.box(left + 0.01, -50, right - 0.01, 99)
        line = shapely.LineString(path)
        dense = shapely.points(shapely.segmentize(line, 0.5).coords)
        assert shapely.distance(dense, shapely.LineString(contour.points)).min() > radius - NEAR, seed
        assert shapely.distance(dense, offset.boundary).max() < 3e-3, seed
        wanted = shapely.points(shapely.get_coordinates(shapely.segmentize(offset.boundary.intersection(sky), 0.5)))
        assert shapely.distance(wanted, line).max() < 3e-3, seed
        cut += led(contour, radius, "G41.1", "easy", (left - 5, 3 * radius)) is None
    assert cut > 20
