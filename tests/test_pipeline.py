"""The way of coordinates from the program to the machine, against an independent composition of matrices.

A random program sets units, offsets, tool length, scaling, rotation and tilt in any order and moves
between them. A model of its own, written with 4x4 matrices, says where each move must lead.
"""

from __future__ import annotations

from math import cos, radians, sin

import numpy as np
import pytest

import aircut
from aircut.geometry.arcs import PLANE_AXES, sweep

SEED = 20240517
PROGRAMS = 150
LINES = 40
SYSTEMS = ("G54", "G55", "G56", "G57", "G58", "G59", "G59.1", "G59.2", "G59.3")


def shift(by: np.ndarray) -> np.ndarray:
    made = np.eye(4)
    made[:3, 3] = by
    return made


def linear(matrix: np.ndarray, center: np.ndarray) -> np.ndarray:
    made = np.eye(4)
    made[:3, :3] = matrix
    return shift(center) @ made @ shift(-center)


def spun(axis: int, degrees: float) -> np.ndarray:
    c, s = cos(radians(degrees)), sin(radians(degrees))
    return np.array([
        [[1, 0, 0], [0, c, -s], [0, s, c]],
        [[c, 0, s], [0, 1, 0], [-s, 0, c]],
        [[c, -s, 0], [s, c, 0], [0, 0, 1]],
    ][axis])  # fmt: skip


class Model:
    """Where the machine stands, and what the program must read."""

    def __init__(self, generator: np.random.Generator) -> None:
        self.generator = generator
        self.unit = 1.0
        self.absolute = True
        self.plane = 0
        self.origins = np.zeros((9, 3))
        self.system = 0
        self.local = np.zeros(3)
        self.g92 = np.zeros(3)
        self.scaling = np.eye(4)
        self.rotation = np.eye(4)
        self.tilted: bool | None = None  # of the rotation in force
        self.tool = np.zeros(3)
        self.axes = np.zeros(3)  # of the machine
        self.lines: list[str] = []
        self.ends: list[np.ndarray] = []  # of the moves: machine coordinates of the tip
        self.reads: list[np.ndarray] = []  # after each line: #5001 to #5003

    @property
    def offset(self) -> np.ndarray:
        return self.origins[self.system] + self.local + self.g92

    @property
    def tip(self) -> np.ndarray:
        return self.axes - self.tool

    @property
    def matrix(self) -> np.ndarray:
        return self.rotation @ self.scaling @ shift(self.offset)

    @property
    def position(self) -> np.ndarray:
        return (np.linalg.inv(self.matrix) @ [*self.tip, 1.0])[:3]

    def point(self) -> np.ndarray:
        """A random point, program units."""
        return self.generator.integers(-400, 400, 3) / 8.0

    def words(self, values: np.ndarray, letters: str = "XYZ", leave: float = 0.3) -> tuple[str, np.ndarray]:
        """Some of the words, and which."""
        named = self.generator.random(3) >= leave
        return "".join(f" {x}{v:.6f}" for x, v, n in zip(letters, values, named, strict=True) if n), named

    def write(self, line: str) -> None:
        self.lines.append(line)
        self.reads.append(self.position / self.unit)

    # --- lines

    def move(self) -> None:
        text, named = self.words(self.point())
        values = np.array([float(word[1:]) if word else 0.0 for word in self.split(text, "XYZ")]) * self.unit
        here = self.position
        goal = np.where(named, values if self.absolute else here + values, here)
        if named.any():
            self.axes = (self.matrix @ [*goal, 1.0])[:3] + self.tool
            self.ends.append(self.tip)
        self.write("G0" + text)

    @staticmethod
    def split(text: str, letters: str) -> list[str]:
        found = {word[0]: word for word in text.split()}
        return [found.get(letter, "") for letter in letters]

    def machine(self) -> None:
        text, named = self.words(self.point())
        if not named.any():
            return
        values = self.numbers(text)
        self.axes = np.where(named, values * self.unit, self.axes)
        self.ends.append(self.tip)
        self.write("G53 G0" + text)

    def numbers(self, text: str, letters: str = "XYZ") -> np.ndarray:
        return np.array([float(word[1:]) if word else 0.0 for word in self.split(text, letters)])

    def units(self) -> None:
        self.unit = float(self.generator.choice([1.0, 25.4]))
        self.write("G21" if self.unit == 1.0 else "G20")

    def distances(self) -> None:
        self.absolute = bool(self.generator.random() < 0.6)
        self.write("G90" if self.absolute else "G91")

    def planes(self) -> None:
        self.plane = int(self.generator.integers(3))
        self.write(("G17", "G18", "G19")[self.plane])

    def work(self) -> None:
        self.system = int(self.generator.integers(9))
        self.write(SYSTEMS[self.system])

    def origin(self) -> None:
        text, named = self.words(self.point())
        number = int(self.generator.integers(9))
        self.origins[number] = np.where(named, self.numbers(text) * self.unit, self.origins[number])
        self.write(f"G10 L2 P{number + 1}{text}")

    def origin_here(self) -> None:
        text, named = self.words(self.point())
        number = int(self.generator.integers(9))
        before = (np.linalg.inv(self.rotation @ self.scaling) @ [*self.tip, 1.0])[:3]
        wanted = before - self.local - self.g92 - self.numbers(text) * self.unit
        self.origins[number] = np.where(named, wanted, self.origins[number])
        self.write(f"G10 L20 P{number + 1}{text}")

    def shifted(self) -> None:
        text, named = self.words(self.point())
        if not named.any():
            return
        self.local = np.where(named, self.numbers(text) * self.unit, self.local)
        self.write("G52" + text)

    def named_here(self) -> None:
        text, named = self.words(self.point())
        if not named.any():
            return
        self.g92 = np.where(named, self.g92 + self.position - self.numbers(text) * self.unit, self.g92)
        self.write("G92" + text)

    def length(self) -> None:
        text, named = self.words(self.point())
        if not named.any():
            return
        self.tool = np.where(named, self.numbers(text) * self.unit, self.tool)
        self.write("G43.1" + text)

    def no_length(self) -> None:
        self.tool = np.zeros(3)
        self.write("G49")

    def scaled(self) -> None:
        center, named = self.words(self.point())
        if self.generator.random() < 0.5:
            factor = float(self.generator.choice([0.5, 2.0, -1.0, -0.25, 3.0]))
            factors, text = np.full(3, factor), f" P{factor}"
        else:
            values = self.generator.choice([0.5, 2.0, -1.0, -0.25, 3.0], 3)
            text, given = self.words(values, "IJK")
            factors = np.where(given, values, 1.0)
            if not given.any():
                return
        here = (np.linalg.inv(self.rotation) @ [*self.tip, 1.0])[:3]
        middle = np.where(named, self.numbers(center) * self.unit + self.offset, here)
        self.scaling = linear(np.diag(factors), middle)
        self.write("G51" + center + text)

    def unscaled(self) -> None:
        self.scaling = np.eye(4)
        self.write("G50")

    def rotated(self) -> None:
        if self.tilted:
            return
        center, named = self.words(self.point())
        angle = float(self.generator.integers(-4000, 4000)) / 10.0
        scaled = (self.scaling @ shift(self.offset) @ [*(self.numbers(center) * self.unit), 1.0])[:3]
        middle = np.where(named, scaled, self.tip)
        self.rotation = linear(spun((2, 1, 0)[self.plane], angle), middle)
        self.tilted = False
        self.write(f"G68{center} R{angle}")

    def tilt(self) -> None:
        if self.tilted is False:
            return
        center, _ = self.words(self.point())
        angles = self.generator.integers(-3600, 3600, 3) / 10.0
        text, given = self.words(angles, "IJK")
        if not given.any():
            return
        i, j, k = np.where(given, angles, 0.0)
        middle = (self.scaling @ shift(self.offset) @ [*(self.numbers(center) * self.unit), 1.0])[:3]
        self.rotation = linear(spun(2, k) @ spun(1, j) @ spun(0, i), middle)
        self.tilted = True
        self.write("G68.2" + center + text)

    def unrotated(self) -> None:
        self.rotation = np.eye(4)
        self.tilted = None
        self.write("G69")

    def run(self) -> None:
        steps = (
            *[self.move] * 10, self.machine, self.units, self.distances, self.planes, self.work, self.origin,
            self.origin_here, self.shifted, self.named_here, self.length, self.no_length, *[self.scaled] * 2,
            self.unscaled, *[self.rotated] * 2, *[self.tilt] * 2, self.unrotated,
        )  # fmt: skip
        while len(self.lines) < LINES:
            steps[int(self.generator.integers(len(steps)))]()


@pytest.mark.parametrize("number", range(PROGRAMS))
def test_moves_and_positions_are_those_of_the_matrices(number: int) -> None:
    model = Model(np.random.default_rng([SEED, number]))
    model.run()
    text = "".join(
        f"{line}\n#[1000+{3 * at}]=#5001 #[1001+{3 * at}]=#5002 #[1002+{3 * at}]=#5003\n"
        for at, line in enumerate(model.lines)
    )
    result = aircut.loads(text + "M2\n").run(keep_going=True)
    assert {d.code for d in result.diagnostics} <= {"travel-limit"}, (result.diagnostics, text)
    largest = max(1.0, *(float(np.abs(end).max()) for end in model.ends))
    np.testing.assert_allclose(result.toolpath.ends()[:, :3], model.ends, rtol=0, atol=1e-9 * largest)
    read = [[result.variables.get(1000 + 3 * at + i) for i in range(3)] for at in range(len(model.lines))]
    np.testing.assert_allclose(np.array(read, float), model.reads, rtol=1e-7, atol=1e-7)


def along(text: str) -> np.ndarray:
    """Points on the last move of a program, an arc; (k, 3) machine coordinates."""
    toolpath = aircut.loads(text).run().toolpath
    (plane, which, start, end, center), = toolpath.arcs()  # fmt: skip
    assert which.tolist() == [len(toolpath) - 1]
    swept = sweep(tuple(start[0][:2]), tuple(end[0][:2]), tuple(center[0][:2]), int(toolpath.turns[-1]))
    radius = np.hypot(*(start[0] - center[0])[:2])
    first = np.arctan2(*(start[0] - center[0])[1::-1])
    part = np.linspace(0.0, 1.0, 50)
    places = np.empty((50, 3))
    u, v, w = PLANE_AXES[plane]
    places[:, u] = center[0][0] + radius * np.cos(first + swept * part)
    places[:, v] = center[0][1] + radius * np.sin(first + swept * part)
    places[:, w] = start[0][2] + part * (end[0] - start[0])[2]
    return places


@pytest.mark.parametrize("number", range(100))
def test_arcs_are_the_images_of_their_points(number: int) -> None:
    """Under even scaling, mirroring and rotation of the plane an arc's points go where the matrices lead."""
    generator = np.random.default_rng([SEED, 1000 + number])
    plane = int(generator.integers(3))
    u, v, w = PLANE_AXES[plane]
    center, radius = generator.uniform(-50, 50, 2), generator.uniform(1, 40)
    angles = generator.uniform(-np.pi, np.pi, 2)
    start, end = np.zeros(3), np.zeros(3)
    start[[u, v]] = center + radius * np.array([np.cos(angles[0]), np.sin(angles[0])])
    end[[u, v]] = center + radius * np.array([np.cos(angles[1]), np.sin(angles[1])])
    end[w] = generator.uniform(-9, 9)
    words = "".join(f" {x}{value:.6f}" for x, value in zip("XYZ", end, strict=True))
    first = "".join(f" {x}{value:.6f}" for x, value in zip("XYZ", start, strict=True))
    way = center - start[[u, v]]
    move = f"G{generator.integers(2, 4)}{words} {'IJK'[u]}{way[0]:.6f} {'IJK'[v]}{way[1]:.6f}"
    factors = np.full(3, generator.uniform(0.2, 3.0)) * generator.choice([1.0, -1.0], 3)
    middle, about = generator.uniform(-50, 50, (2, 3))
    angle = generator.uniform(-400, 400)
    scaled = (
        "G51" + "".join(f" {x}{a:.6f}" for x, a in zip("XYZ", middle, strict=True))
        + "".join(f" {x}{a:.9f}" for x, a in zip("IJK", factors, strict=True))
    )  # fmt: skip
    turned = f"G68 {'XYZ'[u]}{about[u]:.6f} {'XYZ'[v]}{about[v]:.6f} R{angle:.6f}"
    head = f"G21 G90 G91.1 {('G17', 'G18', 'G19')[plane]} F100\n"
    plain = along(f"{head}G0{first}\n{move}\nM2\n")
    made = along(f"{head}{turned}\n{scaled}\nG0{first}\n{move}\nM2\n")
    matrix = linear(spun(w, angle), about) @ linear(np.diag(factors), middle)  # the center came before the scaling
    image = np.column_stack([plain, np.ones(50)]) @ matrix.T
    np.testing.assert_allclose(made, image[:, :3], atol=2e-3)
