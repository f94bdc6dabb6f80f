"""Points along splines: Bézier curves and NURBS in a plane."""

from __future__ import annotations

from collections.abc import Sequence

Point = tuple[float, float]
Weighted = tuple[float, float, float]  # x, y, weight

STEPS = 32  # straight pieces a span


def nurbs(points: Sequence[Weighted], order: int) -> list[Point]:
    """Points of a clamped, uniform NURBS curve after its first one, the last one included.

    order: degree + 1, at most the number of control points.
    """
    spans = len(points) - order + 1
    knots = [0.0] * order + [float(i) for i in range(1, spans)] + [float(spans)] * order
    places = [span + step / STEPS for span in range(spans) for step in range(1, STEPS + 1)]
    return [de_boor(points, order, knots, place) for place in places]


def de_boor(points: Sequence[Weighted], order: int, knots: Sequence[float], place: float) -> Point:
    """A point of the curve, by de Boor's algorithm on homogeneous coordinates."""
    last = len(points) - 1
    span = min(int(place) + order - 1, last)
    work = [(x * w, y * w, w) for x, y, w in points[span - order + 1 : span + 1]]
    for level in range(1, order):
        for j in range(order - 1, level - 1, -1):
            low = knots[span - order + 1 + j]
            share = (place - low) / (knots[j + 1 + span - level] - low)
            work[j] = tuple(a + share * (b - a) for a, b in zip(work[j - 1], work[j], strict=True))  # type: ignore[assignment]
    x, y, w = work[-1]
    return x / w, y / w
