"""Under radius compensation too, the fast lane and the general lane mean the same, to the last bit."""

from __future__ import annotations

import random
from math import cos, pi, sin
from typing import Any

import msgspec
import pytest

import aircut
from aircut.interpreter import lane, leading
from aircut.interpreter.running import Limits
from aircut.kernels import beside, twin
from aircut.machine import built_in

OTHERS = (
    "G20", "G21", "G90", "G91", "G94", "G61", "G64 P0.1", "G4 P0.1", "#1=[1+2]\nG1 X#1", "G1 X1 (a remark)",
    "(a remark)", "M3 S1000", "M8", "G40", "G40\nG1 X-50 Y-50", "G40\nG0 X-60\nG42.1 D3\nG1 X-40 Y-30", "G1 Z-1", "Z-2",
    "G0 Z3", "X0 Y0", "X0 Y0", "F300", "G2 X3 Y4 I1 J2", "G3 I5", "M7\nM9", "; remark", "", "G55", "G54", "M2",
)  # fmt: skip
PLANES = (("X", "Y", "I", "J", "G17"), ("X", "Y", "I", "J", "G17"), ("Z", "X", "K", "I", "G18"))


class Writer:
    """A contour of lines and arcs, its corners mostly wide enough for the tool."""

    def __init__(self, seed: int) -> None:
        self.random = random.Random(seed)
        self.u, self.v, self.i, self.j, self.plane = self.random.choice(PLANES)
        self.sharp = self.random.choice((0.4, 0.9, 1.6, 3.0))
        self.step = self.random.choice((8.0, 12.0, 12.0, 3.0))
        self.at = (0.0, 0.0)
        self.angle = 0.0

    def move(self) -> str:
        pick = self.random
        self.angle += pick.uniform(-self.sharp, self.sharp) if pick.random() < 0.8 else 0.0
        far = self.step * pick.uniform(0.5, 2.0)
        if abs(self.at[0]) > 60.0 or abs(self.at[1]) > 60.0:
            self.angle += pi / 2
        start = self.at
        feed = pick.choice((*[""] * 12, " F500", " F90.5"))
        number = pick.choice(("", "", "", f"N{pick.randint(1, 99)} "))
        across = "XYZ".replace(self.u, "").replace(self.v, "")
        deep = pick.choice(
            (*[""] * 15, f" {across}{pick.uniform(-1, 1):.2f}", f" {pick.choice('AB')}{pick.uniform(-9, 9):.2f}")
        )
        if pick.random() < 0.3:
            return number + self.arc(pick, far) + deep + feed
        self.at = (start[0] + far * cos(self.angle), start[1] + far * sin(self.angle))
        code = pick.choice((*["G1"] * 20, "G0", ""))
        words = f"{self.u}{self.at[0]:.3f} {self.v}{self.at[1]:.3f}"
        return f"{number}{code} {words}{deep}{feed}"

    def arc(self, pick: random.Random, far: float) -> str:
        """An arc that leaves in the direction of travel."""
        left = pick.choice((1.0, -1.0))
        radius = far
        center = (self.at[0] - left * radius * sin(self.angle), self.at[1] + left * radius * cos(self.angle))
        turned = pick.uniform(0.3, 2.5)
        self.angle += left * turned
        end = (center[0] + left * radius * sin(self.angle), center[1] - left * radius * cos(self.angle))
        i, j = center[0] - self.at[0], center[1] - self.at[1]
        self.at = (round(end[0], 3), round(end[1], 3))
        code = "G3" if left > 0.0 else "G2"
        return f"{code} {self.u}{end[0]:.3f} {self.v}{end[1]:.3f} {self.i}{i:.3f} {self.j}{j:.3f}"

    def program(self) -> str:
        pick = self.random
        tool = pick.choice(("G41.1 D2", "G42.1 D2", "G41.1 D5", "G42.1 D0.5", "G41.1 D3", "G42.1 D3"))
        if self.plane == "G18" and pick.random() < 0.6:
            tool += f" L{pick.randint(0, 9)}"
        lines = [f"G21 G90 {self.plane} F500", f"G0 {self.u}-30 {self.v}-20", tool]
        for _ in range(pick.randint(1, 6)):
            lines += [self.move() for _ in range(pick.randint(3, 40))]
            lines.append(pick.choice(OTHERS))
        return "\n".join([*lines, "G40", "G0 X-70", "M2", ""])


def run(text: str, dialect: str, entry: str, fast: bool, monkeypatch: pytest.MonkeyPatch) -> tuple[Any, ...]:
    with monkeypatch.context() as patch:
        patch.setattr(leading, "FEW", 6)
        if not fast:
            patch.setattr(lane.Lane, "known", lambda self, m: False)
        made = built_in("XYZA")
        made.options = msgspec.structs.replace(made.options, entry=entry)
        if len(text) % 2:  # odd ones find the limits near
            made.axes = {
                letter: msgspec.structs.replace(axis, min=-68.0, max=66.0) for letter, axis in made.axes.items()
            }
        keep_going = len(text) % 4 < 3
        result = aircut.loads(text, dialect).run(made, keep_going=keep_going, limits=Limits(blocks=9999))
    events = [(event.at, event.name, event.values, event.line, event.file) for event in result.events]
    contour = result.recording.contour.to_numpy().tobytes()
    return result.toolpath.to_numpy().tobytes(), events, result.diagnostics, result.state, contour


def compare(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    writer = Writer(seed)
    text = writer.program()
    dialect = writer.random.choice(("rosetta", "linuxcnc"))
    entry = writer.random.choice(("nist", "easy", "nist", "normal"))
    fast = run(text, dialect, entry, True, monkeypatch)
    slow = run(text, dialect, entry, False, monkeypatch)
    for part, other in zip(fast, slow, strict=True):
        assert part == other, f"{dialect} {entry}\n{text}"


@pytest.mark.parametrize("seed", range(150))
def test_lanes_agree(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    compare(seed, monkeypatch)


@pytest.mark.parametrize("seed", range(20))
def test_the_kernel_and_its_twin_agree(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    text, dialect = Writer(seed).program(), ("rosetta", "linuxcnc")[seed % 2]
    compiled = run(text, dialect, "nist", True, monkeypatch)
    monkeypatch.setattr(leading, "beside", twin("beside", "beside_uncompiled"))
    for part, other in zip(run(text, dialect, "nist", True, monkeypatch), compiled, strict=True):
        assert part == other, text


def test_a_long_contour_is_the_kernels(monkeypatch: pytest.MonkeyPatch) -> None:
    """All but the entry, and batches follow each other: 30,000 moves of a zigzag, left of it, as one would write it."""
    teeth = "".join(f"X{4 * n}.5 Y{3 * (n % 2)}\n" for n in range(1, 30_000))
    text = f"G21 G90 F500\nG0 X-9 Y-9 Z5\nG41.1 D1\nG1 X0 Y0\nX0.5\n{teeth}G40\nG0 Y99\nM2\n"
    taken: list[int] = []
    lead = beside.lead
    monkeypatch.setattr(leading.beside, "lead", lambda *a: taken.append(lead(*a)) or taken[-1])
    made = built_in("XYZ")
    made.axes = {letter: msgspec.structs.replace(axis, min=-1e6, max=1e6) for letter, axis in made.axes.items()}
    result = aircut.loads(text).run(made)
    assert result.ok, result.diagnostics
    assert sum(taken) > 29_990
    assert max(taken) > 10_000
