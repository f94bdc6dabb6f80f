"""Roughing of a turned contour in passes along it, as G71 and G72 do it; finishing as G70 does.

Points are (along, height), mm: the contour leads to smaller `along`, the stock lies above it. Whoever asks turns
and mirrors the machine's axes into this frame. A path begins with the approach, from the start down to the contour.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from enum import Enum, auto
from math import hypot
from typing import NamedTuple

from aircut.geometry.offsetting import Element, Point, crossings, distance, heading, offset
from aircut.geometry.offsetting import along as way_along
from aircut.geometry.offsetting import length as way_length

SAME = 1e-9  # mm
LEVEL = 1e-6  # mm by which a level may lie above a summit and still count as at it
GAP = 0.01  # mm along the contour: an outside corner that is less open is closed by no arc
ROUNDED = 1e-2  # part of an arc's radius by which a line may miss it
MOST_PASSES = 100_000


class Turning(ValueError):
    """The contour cannot be turned; the text says why."""


class Pockets(Enum):
    """What becomes of pockets: cut with the rest, left standing, or cut alone."""

    ALL = auto()
    NONE = auto()
    ONLY = auto()


class Cut(NamedTuple):
    """A move to a point; center and turns of an arc."""

    rapid: bool
    end: Point
    center: Point | None = None
    turns: int = 0


def side_of(start: Point, contour: Sequence[Element]) -> float:
    """+1 where the stock lies to the right of the contour, as seen along it; -1 where the start tells otherwise."""
    first, last = contour[0].start, contour[-1].start
    cross = (last[0] - first[0]) * (start[1] - first[1]) - (last[1] - first[1]) * (start[0] - first[0])
    return -1.0 if cross > 0.0 else 1.0


def rounded(contour: Sequence[Element], corners: Mapping[int, tuple[float, bool]]) -> list[Element]:
    """The contour with the corners behind some elements rounded off, or cut straight between the same points.

    corners: radius, mm, and whether an arc takes the corner's place. Raises Turning.
    """
    path: list[Element] = []
    for number, element in enumerate(contour):
        radius, arc = corners.get(number - 1, (0.0, False))
        if radius and path:
            before = path[-1]
            a, b = heading(before, before.end), heading(element, element.start)
            left = radius if a[0] * b[1] - a[1] * b[0] > 0.0 else -radius
            inner = offset(before, left), offset(element, left)
            if inner[0] is None or inner[1] is None:
                raise Turning("an arc is too small for the radius of a corner")
            center = meeting(inner[0], inner[1])
            first, last = foot(before, center, left), foot(element, center, left)
            path[-1] = before._replace(end=first)
            path.append(Element(first, last, center, 1 if left > 0.0 else -1) if arc else Element(first, last))
            element = element._replace(start=last)
        path.append(element)
    return path


def foot(element: Element, center: Point, left: float) -> Point:
    """Where a circle with this center, so far to its left, touches the element."""
    if element.center is None:
        du, dv = heading(element, element.end)
        return center[0] + left * dv, center[1] - left * du
    share = element.radius / (element.radius - element.sign * left)
    (u, v), (cu, cv) = center, element.center
    return cu + (u - cu) * share, cv + (v - cv) * share


def beside(contour: Sequence[Element], right: float) -> list[Element]:
    """The contour at a distance to its right. Raises Turning."""
    if right == 0.0:
        return list(contour)
    moved: list[Element] = []
    whole: Element | None = None  # the way beside the element before, not cut
    for before, element in zip((None, *contour), contour):  # noqa: B905  # the last has none behind it
        whole, last = moved_right(element, right), whole
        path = whole
        apart = 0.0 if before is None else distance(moved[-1].end, path.start)
        if before is not None and (apart > SAME or before.center is element.center is None):
            a, b = heading(before, before.end), heading(element, element.start)
            away = (a[0] * b[1] - a[1] * b[0]) * right > 0.0
            if away and abs(path.start[0] - moved[-1].end[0]) > GAP:
                moved.append(Element(moved[-1].end, path.start, element.start, 1 if right > 0.0 else -1))
            else:
                assert last is not None
                corner = meeting(last, path)
                moved[-1] = moved[-1]._replace(end=corner)
                path = path._replace(start=corner)
        moved.append(path)
    return moved


def moved_right(element: Element, right: float) -> Element:
    """The parallel element at a distance to its right. Raises Turning."""
    if element.center is None:
        du, dv = element.end[0] - element.start[0], element.end[1] - element.start[1]
        reach = hypot(du, dv)
        u, v = dv * right / reach, -(du * right / reach)  # in this order: see `between`
        return Element((element.start[0] + u, element.start[1] + v), (element.end[0] + u, element.end[1] + v))
    path = offset(element, -right)
    if path is None:
        raise Turning("an arc is too small for its allowance")
    return path


def between(first: Element, second: Element) -> Point:
    """Where two straight lines meet. Raises Turning.

    Ways that go straight on are parallel but for rounding, and what rounding leaves decides where on the first
    they meet, or that they do not: so the order of the operations is the oracle's, found by trying.
    """
    (u, v), (end_u, end_v) = second.start, second.end
    reach = hypot(end_u - u, end_v - v)
    du, dv = (end_u - u) / reach, (end_v - v) / reach
    begin, end = ((p[0] - end_u) * dv - (p[1] - end_v) * du for p in (first.start, first.end))  # beside the second
    if begin == end:
        raise Turning("two ways with the allowance do not meet")
    part = begin / (begin - end)
    (u, v), (end_u, end_v) = first.start, first.end
    return u + part * (end_u - u), v + part * (end_v - v)


def meeting(first: Element, second: Element) -> Point:
    """Where two elements meet at an inside corner; arcs have the radius of their start. Raises Turning."""
    if first.center is second.center is None:
        return between(first, second)
    points = crossings(*(one if one.center is None else one._replace(end=one.start) for one in (first, second)))
    if not points:
        return touching(first, second)
    return min(points, key=lambda point: distance(point, first.end) + distance(point, second.start))


def touching(first: Element, second: Element) -> Point:
    """Where a line and an arc touch that miss each other by what the program rounds. Raises Turning."""
    line, arc = (first, second) if first.center is None else (second, first)
    if line.center is None and arc.center is not None:
        du, dv = heading(line, line.end)
        at = (arc.center[0] - line.start[0]) * du + (arc.center[1] - line.start[1]) * dv
        point = (line.start[0] + at * du, line.start[1] + at * dv)
        if distance(point, arc.center) < arc.radius * (1.0 + ROUNDED):
            return point
    raise Turning("two ways with the allowance do not meet")


def check_monotonic(path: Sequence[Element]) -> None:
    """Raises Turning where the contour goes back."""
    for element in path:
        back = element.end[0] > element.start[0] + SAME
        if element.center is not None and not back:
            extreme = (element.center[0] + element.radius, element.center[1])
            inside = SAME < way_along(element, extreme) < way_length(element) - SAME
            leftmost = (element.center[0] - element.radius, element.center[1])
            back = inside or SAME < way_along(element, leftmost) < way_length(element) - SAME
        if back:
            raise Turning("the contour goes back along its length")


def split(path: Sequence[Element]) -> list[Element]:
    """The path with its arcs cut at their summits."""
    pieces: list[Element] = []
    for element in path:
        if element.center is not None:
            summit = (element.center[0], element.center[1] + element.radius)
            at = way_along(element, summit)
            if at < way_length(element) - SAME and (at > SAME or falls(element)):  # there also at its very start
                pieces += [element._replace(end=summit), element._replace(start=summit)]
                continue
        pieces.append(element)
    return pieces


def falls(element: Element) -> bool:
    """Whether the element begins downwards."""
    if distance(element.start, element.end) < SAME:
        return False
    slope = heading(element, element.start)[1]
    if element.center is not None and abs(slope) < SAME:
        return element.center[1] < element.start[1]
    return slope < -SAME


def at_level(element: Element, level: float, *, beyond: float = -1.0) -> Point | None:
    """The first point of the element at a height, farther along it than `beyond`; its end counts for arcs alone."""
    if distance(element.start, element.end) < SAME:
        return element.start if abs(element.start[1] - level) < SAME and beyond < 0.0 else None
    if element.center is None:
        low, high = sorted((element.start[1], element.end[1]))
        if not low - SAME <= level <= high + SAME:
            return None
        if high - low < SAME:
            point = element.start
        else:
            part = (level - element.start[1]) / (element.end[1] - element.start[1])
            point = (element.start[0] + part * (element.end[0] - element.start[0]), level)
        return point if way_along(element, point) > beyond else None
    square = element.radius**2 - (level - element.center[1]) ** 2
    if square < -SAME * element.radius:
        return None
    half = max(square, 0.0) ** 0.5
    points = [(element.center[0] + half, level), (element.center[0] - half, level)]
    whole = way_length(element)
    found = [(way_along(element, point), point) for point in points]
    found = [(at, point) for at, point in found if beyond < at <= whole + SAME]
    return min(found)[1] if found else None


class Roughing:
    """The passes along one path. depth: of a pass, above 0; retract: below 0 means half of the pass."""

    def __init__(self, start: Point, path: Sequence[Element], depth: float, retract: float, pockets: Pockets) -> None:
        self.path = split(path)
        self.depth = depth
        self.retract = retract
        self.pockets = pockets
        self.top = start[1]
        self.level = start[1]
        self.at = 0
        self.passes = 0

    def cuts(self) -> Iterator[Cut]:
        """All moves, from the start of the path. Raises Turning."""
        if falls(self.path[0]):
            yield from self.descend(self.pockets is not Pockets.ONLY, True)
        while self.at < len(self.path):
            if self.pockets is Pockets.NONE:
                across = self.across(self.path[self.at].start)
                if across is None:
                    return
                yield Cut(False, across)
                yield from self.follow()
                continue
            if not falls(self.path[self.at]):
                yield from self.follow()
                continue
            self.raise_level(self.path[self.at].start[1])
            yield from self.descend(True, False)

    def follow(self, rapid: bool = False) -> Iterator[Cut]:
        """The rest of an element; of an arc only where there is a rest."""
        element = self.path[self.at]
        self.at += 1
        if element.center is None or distance(element.start, element.end) > SAME:
            yield Cut(rapid, element.end, element.center, element.turns)

    def raise_level(self, summit: float) -> None:
        """The level of the first pass below a summit."""
        if self.pockets is Pockets.ONLY:
            self.level = summit
            return
        while self.level + self.depth <= min(summit, self.top) + LEVEL:
            self.level += self.depth

    def descend(self, passes: bool, rapid: bool) -> Iterator[Cut]:
        """Down as far as the path falls, with a pass at each level."""
        while self.at < len(self.path) and falls(self.path[self.at]):
            element = self.path[self.at]
            point = self.reached(element) if passes else None
            if point is None:
                yield from self.follow(rapid)
                rapid = False
                continue
            if element.center is None or distance(element.start, point) > SAME:
                yield Cut(rapid, point, element.center, element.turns)
            self.path[self.at] = element._replace(start=point)
            yield from self.pass_(point, rapid)
            self.level -= self.depth

    def reached(self, element: Element) -> Point | None:
        """Where a falling element comes down to the level; what begins below takes the next level."""
        while self.level > element.start[1] + SAME:
            self.level -= self.depth
        point = at_level(element, self.level)
        if point is None or (element.center is None and point[1] < element.end[1] + SAME):
            return None
        return point

    def pass_(self, start: Point, rapid: bool) -> Iterator[Cut]:
        """One pass from the path to where it comes up again, and back above it. Raises Turning."""
        self.passes += 1
        if self.passes > MOST_PASSES:
            raise Turning("more passes than any turning has")
        end = self.hit(start, self.at, 10 * SAME)
        if end is None:
            raise Turning("the contour does not come up again to the height of a pass")
        length = start[0] - end[0]
        if length < SAME:
            return
        lift = self.retract if 0.0 <= 2.0 * self.retract <= length else length / 2.0
        yield Cut(False, end)
        yield Cut(True, (end[0] + lift, start[1] + lift))
        yield Cut(True, (start[0] - lift, start[1] + lift))
        yield Cut(rapid, start)

    def hit(self, start: Point, first: int, beyond: float) -> Point | None:
        """The next point of the path at the height of a point of it."""
        for number, element in enumerate(self.path[first:]):
            point = at_level(element, start[1], beyond=beyond if number == 0 else -1.0)
            if point is not None:
                return point
        return None

    def across(self, start: Point) -> Point | None:
        """Level across a pocket to the path's next piece; there it goes on. None where it ends in the pocket."""
        falling = falls(self.path[self.at])
        for number in range(self.at, len(self.path)):
            element = self.path[number]
            point = at_level(element, start[1], beyond=10 * SAME if falling and number == self.at else -1.0)
            if point is not None and not (falling and falls(element._replace(start=point))):
                self.path[number] = element._replace(start=point)
                self.at = number
                return point
        return None


def finishing(path: Sequence[Element]) -> Iterator[Cut]:
    """Along the path; the approach is rapid."""
    for number, element in enumerate(path):
        yield Cut(number == 0, element.end, element.center, element.turns)


def joined(begin: Point, contour: Sequence[Element]) -> list[Element]:
    """The contour with the approach before it."""
    return [Element(begin, contour[0].start), *contour]


def escaped(start: Point, path: list[Element]) -> list[Element]:
    """The path led out to the height of its start."""
    end = path[-1].end
    return [*path, Element(end, (end[0], start[1]))] if end[1] < start[1] - SAME else path


def is_move(a: Point, b: Point) -> bool:
    return hypot(b[0] - a[0], b[1] - a[1]) > SAME
