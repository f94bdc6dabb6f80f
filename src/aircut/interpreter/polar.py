"""Polar coordinates: the words @ and ^ in any plane, and G16, which makes the plane's own words mean the same.

The pole is the origin of the program's frame. The angle is zero on the axis whose
letter stands for the radius and grows toward the other, so in G18 from X to Z.

Sources: 000 section 8.2; decisions AMB-XF-1 to AMB-XF-4; 001 Polar Coordinates.
"""

from __future__ import annotations

from math import atan2, cos, degrees, hypot, radians, sin
from typing import TYPE_CHECKING

from aircut.diagnostics import Refusal
from aircut.diagnostics import faults as F
from aircut.interpreter.table import AXES, Words

if TYPE_CHECKING:
    from aircut.interpreter.state import State

RADIUS, ANGLE = "@", "^"
PLANE_WORDS = ((0, 1), (0, 2), (1, 2))  # by plane: the axes that give radius and angle
POLE = 1e-9  # mm: nearer than this is the pole


def place(m: State, w: Words, goal: list[float]) -> bool:
    """Put the goal's axes of the plane where the polar words lead; False without polar words. Raises Refusal."""
    first, second = PLANE_WORDS[m.plane]
    radius_word, angle_word = AXES[first], AXES[second]
    if RADIUS in w or ANGLE in w:
        refuse_company(m, w, radius_word + angle_word)
        radius_word, angle_word = RADIUS, ANGLE
    elif not m.polar or m.machine_frame or not (radius_word in w or angle_word in w):
        return False
    x, y = m.position[first], m.position[second]
    radius = hypot(x, y)
    angle = degrees(atan2(y, x)) if radius > POLE else 0.0  # signed zeros have angles, too
    if m.absolute:
        if radius_word in w:
            radius = w[radius_word] * m.unit
        angle = w.get(angle_word, angle)
    else:
        if radius <= POLE:
            raise Refusal(F.POLAR_POLE, radius_word if radius_word in w else angle_word)
        radius += w.get(radius_word, 0.0) * m.unit
        angle += w.get(angle_word, 0.0)
    goal[first] = radius * cos(radians(angle))
    goal[second] = radius * sin(radians(angle))
    return True


def refuse_company(m: State, w: Words, plane_words: str) -> None:
    """Refuse @ and ^ beside the plane's own words, and with G53."""
    if m.machine_frame:
        raise Refusal(F.POLAR_MACHINE, RADIUS if RADIUS in w else ANGLE)
    for letter in plane_words:
        if letter in w:
            raise Refusal(F.POLAR_MIX, letter, word=letter.upper())
