"""Random programs under cutter radius compensation that mean the same to LinuxCNC's interpreter."""

from __future__ import annotations

import random
from math import atan2, cos, hypot, pi, sin

from aircut.dialects import load
from aircut.interpreter.table import CutterRules, Dialect

WORDS = {"G17": ("X", "Y", "I", "J", "Z"), "G18": ("Z", "X", "K", "I", "Y")}
EVENTS = ("F150", "S500 M3", "M5", "M8", "M9", "(between)", "G4 P1", "F20 S90")

#: What LinuxCNC's interpreter does otherwise than the documents of the other language.
RULES = CutterRules(
    forbids=frozenset({"G41", "G42", "G41.1", "G42.1", "G28", "G30", "G53", "M6"}),
    flushes=frozenset({"M0", "M1", "M60"}),
    at_once=frozenset({"MESSAGE", "SELECT_TOOL", "SELECT_PLANE", "USE_LENGTH_UNITS"}),
    straight=0.05,
    plunge_first=False,
    zero_is_loaded=True,
)


def dialect() -> Dialect:
    """Our language with the other one's rules of compensation."""
    return load("rosetta")._replace(cutter=RULES)


class Contours:
    """Writes one random program: one or more contours, each with its own compensation."""

    def __init__(self, seed: int, short: float = 0.1) -> None:
        """short: part of the moves that are short beside the tool, so that it may not fit."""
        self.random = random.Random(seed)
        self.short = short
        self.plane = self.random.choice(("G17", "G17", "G18"))
        self.at = (0.0, 0.0)
        self.direction = 0.0
        self.height = 0.0

    def number(self, low: float, high: float) -> float:
        return self.random.uniform(low, high)

    def lines(self) -> list[str]:
        lines = ["G21 F100", self.plane]
        for _ in range(self.random.choice((1, 1, 2))):
            lines += self.contour()
        return [*lines, "M2"]

    def contour(self) -> list[str]:
        u, v, *_ = WORDS[self.plane]
        self.at = (round(self.number(-50, 50), 4), round(self.number(-50, 50), 4))
        radius = self.number(0.5, 6)
        first = f"G0 {u}{self.at[0]:.4f} {v}{self.at[1]:.4f}"
        sign = -1 if self.random.random() < 0.1 else 1
        on = f"{self.random.choice(('G41.1', 'G42.1'))} D{sign * 2 * radius:.4f}"
        self.direction = self.number(-pi, pi)
        body = [self.move(radius, 0)]
        for _ in range(self.random.randint(1, 8)):
            if self.random.random() < 0.15:
                body.append(self.random.choice(EVENTS))
            if self.random.random() < 0.12:
                body.append(self.across())
            body.append(self.move(radius, self.turned()))
        self.at = (round(self.at[0] + 30, 4), self.at[1])
        out = f"G{self.random.choice((0, 1))} {u}{self.at[0]:.4f}"
        return [first, on, *body, "G40", out]

    def turned(self) -> float:
        """A change of direction, radians; now and then none, or half a turn."""
        pick = self.random.random()
        if pick < 0.15:
            return 0.0
        if pick < 0.2:
            return self.random.choice((0.03, -0.03, 0.04, -0.04, pi / 2, -pi / 2))
        return self.number(-pi, pi) * 0.97

    def across(self) -> str:
        axis = WORDS[self.plane][4]
        self.height = self.number(-9, 9)
        return f"G{self.random.choice((0, 1))} {axis}{self.height:.4f}"

    def move(self, radius: float, turned: float) -> str:
        """A line or an arc that sets out in a direction turned from where the last one led."""
        u, v, i, j, across = WORDS[self.plane]
        length = radius * (self.number(0.1, 2) if self.random.random() < self.short else self.number(3, 9))
        direction = self.direction + turned
        rise = f" {across}{self.number(-9, 9):.4f}" if self.random.random() < 0.15 else ""
        if self.random.random() < 0.55:
            end = (self.at[0] + length * cos(direction), self.at[1] + length * sin(direction))
            code = "G0" if self.random.random() < 0.1 else "G1"
            text = f"{code} {self.go(end)}{rise}"
            self.direction = direction
            return text
        sign = self.random.choice((-1, 1))
        bend = radius * (self.number(0.3, 2) if self.random.random() < self.short else self.number(1.5, 8))
        swept = min(length / bend, 5.5)
        center = (
            round(self.at[0] - sign * bend * sin(direction), 4),
            round(self.at[1] + sign * bend * cos(direction), 4),
        )
        whole = self.random.random() < 0.05
        start = atan2(self.at[1] - center[1], self.at[0] - center[0])
        exact = hypot(self.at[0] - center[0], self.at[1] - center[1])
        words = f"{i}{center[0] - self.at[0]:.4f} {j}{center[1] - self.at[1]:.4f}"
        code = "G3" if sign > 0 else "G2"
        if whole:
            turns = f" P{self.random.randint(1, 2)}"
            self.direction = direction
            return f"{code} {u}{self.at[0]:.4f} {v}{self.at[1]:.4f} {words}{rise}{turns}"
        angle = start + sign * swept
        end = (center[0] + exact * cos(angle), center[1] + exact * sin(angle))
        text = f"{code} {self.go(end)} {words}{rise}"
        self.direction = angle + sign * pi / 2
        return text

    def go(self, end: tuple[float, float]) -> str:
        self.at = (round(end[0], 4), round(end[1], 4))
        u, v, *_ = WORDS[self.plane]
        return f"{u}{self.at[0]:.4f} {v}{self.at[1]:.4f}"
