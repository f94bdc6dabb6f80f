"""Splines of LinuxCNC's language: G5, G5.1, and G5.2 with G5.3.

The listing has a spline as one command; the toolpath has its points, as feeds.
Source: the canonical listing, section 11.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

from aircut.canon import TOLD
from aircut.diagnostics import Refusal
from aircut.diagnostics import faults as F
from aircut.geometry.splines import Point, nurbs
from aircut.interpreter.linuxcnc.motion import FEED, go, goal, wrong
from aircut.interpreter.linuxcnc.state import State
from aircut.interpreter.table import Code, Group, Order, Words

LEAST_ORDER = 3
FREE = -1.0  # P that counts as not given


def check(m: State, w: Words) -> None:
    """What all splines need. Raises Refusal."""
    if m.plane_code != 170:
        raise wrong("splines need G17")
    if any(letter in w for letter in "zabcuvw"):
        raise wrong("splines move X and Y alone")
    check_spline_feed(m, w)
    if m.cutter:
        raise Refusal(F.UNDER_COMPENSATION, what="a spline")


def check_spline_feed(m: State, w: Words) -> None:
    """G93 wants an F word, G94 some feed; G95 none, and a spindle that stands is not asked for. Raises Refusal."""
    if m.feed_mode == 93:
        if "f" not in w:
            raise Refusal(F.INVERSE_TIME_FEED, "f")
    elif m.feed_mode == 94 and m.gave_feed <= 0.0:
        raise Refusal(F.MISSING_FEED)


def trace(m: State, count: int, points: Sequence[Point], end: list[float]) -> None:
    """Tell a spline of so many control points, and write its moves.

    LinuxCNC's stand-alone interpreter takes a spline for a move to X0 Y0.
    """
    told = [0.0, 0.0, *m.told[2:]]
    m.out.event("NURBS_FEED", count)
    for x, y in points:
        go(m, FEED, [x, y, *m.position[2:]], m.gave_feed * m.unit, m.flags | TOLD)
    m.position = end
    m.told = told
    if m.cycle is not None:  # a cycle in force goes on afterwards, from where it finds the tool
        m.cycle = m.cycle._replace(level=None)


def cubic(m: State, w: Words) -> None:
    """G5: I J from the start, P Q from the end; without I J, the P Q before turned round. Raises Refusal."""
    check(m, w)
    if "p" not in w or "q" not in w:
        raise Refusal(F.MISSING_WORD, code="G5", word="P and Q", meaning="")
    if ("i" in w) != ("j" in w):
        raise Refusal(F.MISSING_WORD, code="G5", word="I and J, or neither,", meaning="")
    start = m.position
    end = goal(m, w)
    leave = (m.length(w, "i"), m.length(w, "j"))
    if "i" not in w:
        before = m.spline_end or (0.0, 0.0)
        leave = (-before[0], -before[1])
    m.spline_end = (m.length(w, "p"), m.length(w, "q"))
    m.sticky |= {"i": -w["p"], "j": -w["q"]}  # LinuxCNC keeps them where a cycle in force finds its I and J
    points = [
        (start[0], start[1]),
        (start[0] + leave[0], start[1] + leave[1]),
        (end[0] + m.spline_end[0], end[1] + m.spline_end[1]),
        (end[0], end[1]),
    ]
    behind_collected(m, points, end)


def quadratic(m: State, w: Words) -> None:
    """G5.1: I J from the start. Raises Refusal."""
    check(m, w)
    if "i" not in w or "j" not in w:
        raise Refusal(F.MISSING_WORD, code="G5.1", word="I and J", meaning="")
    start = m.position
    end = goal(m, w)
    points = [(start[0], start[1]), (start[0] + m.length(w, "i"), start[1] + m.length(w, "j")), (end[0], end[1])]
    behind_collected(m, points, end)


def behind_collected(m: State, points: list[tuple[float, float]], end: list[float]) -> None:
    """Run a Bézier curve. Points that a G5.2 left without its G5.3 stand before its own, and bend it with them."""
    all_points = [*collected(m), *((x, y, 1.0) for x, y in points)]
    trace(m, len(all_points), nurbs(all_points, len(points)), end)


def collected(m: State) -> list[tuple[float, float, float]]:
    """Points and weights of G5.2 so far, mm; there are none any more then."""
    points = [(x * m.unit, y * m.unit, weight if weight > 0.0 else 1.0) for x, y, weight in m.spline]
    m.spline = []
    return points


def collect(m: State, w: Words) -> None:
    """G5.2: a control point and its weight. Raises Refusal.

    X and Y are read in the unit of the G5.3, under G91 from the start of the spline; the other axes are
    passed over. Points before another motion are forgotten, but only once the checks are done.
    """
    named = "x" in w or "y" in w
    if named and not ("x" in w and "y" in w):
        raise wrong("a control point needs X and Y")
    if m.spline and not w.get("p", FREE) > 0.0:
        raise Refusal(F.MISSING_WORD, code="G5.2", word="P", meaning="the weight of the control point, above zero")
    if m.spline and not named:
        raise wrong("P without X and Y is for the first control point")
    if m.feed_mode == 94 and m.gave_feed <= 0.0:
        raise Refusal(F.MISSING_FEED)
    weight = w.get("p", 1.0)
    if not m.spline or m.motion_before != "g5.2":
        m.spline_order = LEAST_ORDER
        m.spline = [(m.position[0] / m.unit, m.position[1] / m.unit, 1.0 if named else weight)]
    m.spline_order = max(LEAST_ORDER, int(w.get("l", m.spline_order)))
    if named:
        place = goal(m, w)
        m.spline.append((place[0] / m.unit, place[1] / m.unit, weight))


def run_collected(m: State, w: Words) -> None:
    """G5.3: the spline of the points collected. Raises Refusal."""
    if m.motion_before != "g5.2" or not m.spline:  # a G5.2 that failed leaves none
        raise wrong("G5.3 without G5.2 before")
    if len(m.spline) < m.spline_order:
        raise wrong(f"a spline of order {m.spline_order} needs as many points; there are {len(m.spline)}")
    points = collected(m)
    end = [points[-1][0], points[-1][1], *m.position[2:]]
    trace(m, len(points), nurbs(points, m.spline_order), end)


spline = partial(Code, group=Group.MOTION, order=Order.MOTION, axes=True)

CODES = (
    spline("G5", "Cubic spline", cubic, takes="ijpq", needs_axes=True),
    spline("G5.1", "Quadratic spline", quadratic, takes="ij", needs_axes=True),
    spline("G5.2", "Control point of a spline", collect, takes="pl", modal=True),
    Code("G5.3", "Run the spline", run_collected, Group.NON_MODAL, Order.NON_MODAL, nameless=True, fits=("G5.2", "")),
)
