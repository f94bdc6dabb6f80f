"""The ball stops where it touches: by hand, by an independent search, and on bodies of triangles."""

from itertools import product
from math import cos, hypot, pi, sin, sqrt, tau

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from aircut.geometry.contact import (
    CLEAR,
    INNER_SKIN,
    SKIN,
    SLIDE,
    Box,
    Cylinder,
    Mesh,
    Placed,
    Sphere,
    Union,
    path,
    scratch,
)
from aircut.kernels import mesh as kernel
from aircut.kernels import twin

uncompiled = twin("mesh", "mesh_uncompiled")

CUBE = Box((0, 0, 0), (10, 20, 30))
POST = Cylinder((0, 0, 0), (0, 0, 1), 10, 5)
BALL = Sphere((1, 2, 3), 5)


def at(start, end, part):
    """The position after this part of the way."""
    return np.array(start) + part * (np.array(end, float) - start)


# Bodies of triangles


def box_mesh(low, high):
    """(12, 3, 3) mm."""
    corner = [np.where(which, high, low) for which in product((False, True), repeat=3)]
    faces = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))
    return np.array([[corner[i] for i in three] for a, b, c, d in faces for three in ((a, b, c), (a, c, d))], float)


def ball_mesh(radius, times):
    """An octahedron, each face cut in four `times` times, corners on the sphere about 0: (8·4^times, 3, 3) mm."""
    found = np.array([np.diag(signs) for signs in product((1.0, -1.0), repeat=3)])
    for _ in range(times):
        a, b, c = found[:, 0], found[:, 1], found[:, 2]
        ab, bc, ca = a + b, b + c, c + a
        found = np.concatenate(
            [np.stack(three, axis=1) for three in ((a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca))]
        )
        found /= np.linalg.norm(found, axis=2, keepdims=True)
    return radius * found


def inner_radius(triangles):
    """The largest sphere about 0 inside a ball of triangles, mm."""
    normal = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    return (np.abs((normal * triangles[:, 0]).sum(axis=1)) / np.linalg.norm(normal, axis=1)).min()


def post_mesh(radius, height, sides):
    """A prism along +Z that stands in the cylinder: (4·sides, 3, 3) mm."""
    ring = [(radius * cos(tau * i / sides), radius * sin(tau * i / sides)) for i in range(sides)]
    found = []
    for (ax, ay), (bx, by) in zip(ring, ring[1:] + ring[:1], strict=True):
        low, next_low, high, next_high = (ax, ay, 0), (bx, by, 0), (ax, ay, height), (bx, by, height)
        found += [(low, next_low, next_high), (low, next_high, high)]
        found += [((0, 0, 0), next_low, low), ((0, 0, height), high, next_high)]
    return np.array(found, float)


# By hand


@pytest.mark.parametrize(
    ("shape", "start", "end", "radius", "length"),  # length: mm from the start to the contact
    [
        pytest.param(CUBE, (5, 5, 50), (5, 5, 0), 2, 18, id="face from above"),
        pytest.param(CUBE, (5, 5, 50), (5, 5, 0), 0, 20, id="point on a face"),
        pytest.param(CUBE, (-8, 5, 5), (12, 5, 5), 3, 5, id="face from the side"),
        pytest.param(CUBE, (20, 25, 10), (20, 15, 10), 10, 5, id="graze a face as the way passes its edge"),
        pytest.param(CUBE, (11, 5, 50), (11, 5, 0), 2, 20 - sqrt(3), id="edge"),
        pytest.param(CUBE, (12, 23, 31), (-12, 20, 30), 0, None, id="miss behind a corner"),
        pytest.param(CUBE, (10 + 4, 20 + 4, 30 + 4), (10, 20, 30), 1.5, sqrt(48) - 1.5, id="corner"),
        pytest.param(CUBE, (11, 21, 50), (11, 21, 0), 2, 20 - sqrt(2), id="corner from above"),
        pytest.param(CUBE, (11, 21, 50), (11, 21, 0), 1.4, None, id="beside a corner"),
        pytest.param(CUBE, (12, 5, 50), (12, 5, 0), 2, 20, id="tangent to a face"),
        pytest.param(CUBE, (12 + 3e-10, 5, 50), (12 + 3e-10, 5, 0), 2, 20, id="tangent within the skin"),
        pytest.param(CUBE, (12 + 3e-10, 5, 50), (12 + 1e-10, 5, 0), 2, 20, id="slides on in the skin"),
        pytest.param(CUBE, (12 + 2e-9, 5, 50), (12 + 2e-9, 5, 0), 2, None, id="just beside a face"),
        pytest.param(CUBE, (5, 5, 50), (5, 5, 32), 2, 18, id="at the very end"),
        pytest.param(CUBE, (5, 5, 50), (5, 5, 32.001), 2, None, id="just short"),
        pytest.param(CUBE, (5, 5, 1e4), (5, 5, 0), 20, 1e4 - 50, id="from far"),
        pytest.param(POST, (20, 0, 2), (0, 0, 2), 3, 7, id="side"),
        pytest.param(POST, (3, 4, 20), (3, 4, 0), 2.5, 12.5, id="cap"),
        pytest.param(POST, (3, 4, -20), (3, 4, 0), 2.5, 17.5, id="cap from below"),
        pytest.param(POST, (11, 0, 20), (11, 0, 0), 2, 15 - sqrt(3), id="rim from above"),
        pytest.param(POST, (20, 0, 6), (0, 0, 6), 2, 10 - sqrt(3), id="rim from the side"),
        pytest.param(POST, (13, 0, 8), (10, 0, 5), 2, sqrt(18) - 2, id="rim straight on"),
        pytest.param(POST, (-20, 6, 6), (20, 6, 6), 2, 20 - sqrt((10 + sqrt(3)) ** 2 - 36), id="rim across"),
        pytest.param(POST, (-20, 13, 2), (20, 13, 2), 3, 20, id="graze the side"),
        pytest.param(POST, (-20, 13.001, 2), (20, 13.001, 2), 3, None, id="beside the side"),
        pytest.param(POST, (0, 0, 7), (30, 0, 7), 2, 0, id="tangent to the cap at the start"),
        pytest.param(BALL, (1, 2, 30), (1, 2, 3), 2, 20, id="top of the sphere"),
        pytest.param(BALL, (-20, 2, 3 + 5), (20, 2, 3 + 5), 1, 21 - sqrt(11), id="sphere off its middle"),
        pytest.param(BALL, (-20, 2, 3 + 6), (20, 2, 3 + 6), 1, 21, id="graze the sphere"),
        pytest.param(BALL, (1, 2, 30), (1, 2, 40), 2, None, id="away from the sphere"),
    ],
)
def test_touch_by_hand(request, shape, start, end, radius, length):
    grazing = "graze" in request.node.name or "tangent" in request.node.name
    part = shape.touch(start, end, radius)
    if length is None:
        assert part is None
    else:
        # How near a tangent comes is good to 1e-12 mm, where it does so to the root of that.
        slack = 1e-4 if "slides" in request.node.name else 1e-6 if grazing else 2e-11
        assert part * np.linalg.norm(np.subtract(end, start)) == pytest.approx(length, abs=slack)
        assert shape.touches(at(start, end, part), radius)


def test_noise_at_the_edge_of_the_skin():
    """A step into the skin that lands a last bit outside must not be repeated for ever."""
    ball = Sphere((-2.976149937839221, -9.840865696716904, -17.10202482201337), 19.297867764586982)
    start, end = (-3.0121608269186306, 19.11748924444476, -9.578485235539798), (-28.1334, -12.2275, -12.5835)
    part = ball.touch(start, end, 10.441586827965878)
    assert part is not None and ball.touches(at(start, end, part), 10.441586827965878)


def test_grazing_a_round_body_within_the_skin():
    """Newton's steps may jump over the bottom; it is found all the same."""
    for tenth in range(-40, 35):
        off = 7 + tenth * 1e-11
        for shape in (BALL, Mesh([[(1, 2, 8), (1, 3, 0), (1, 1, 0)]])):
            part = shape.touch((-20, 2, 3 + off), (20, 2, 3 + off), 2)
            assert part is not None and part * 40 == pytest.approx(21, abs=1e-4)


@pytest.mark.parametrize("shape", [CUBE, Cylinder((5, 10, 0), (0, 0, 1), 4, 30), Sphere((5, 10, 15), 4)])
def test_start_in_contact(shape):
    assert shape.touch((5, 10, 15), (5, 10, 90), 2) == 0.0
    assert shape.touch((5, 10, 15), (5, 10, 16), 0) == 0.0
    assert shape.touch((5, 10, 15), (5, 10, 15), 0) == 0.0
    assert shape.clear((5, 10, 15), (5, 10, 16), 0) is None
    assert shape.clear((5, 10, 15), (5, 10, 15), 0) is None


def test_no_way_at_all():
    assert CUBE.touch((5, 5, 32), (5, 5, 32), 2) == 0.0
    assert CUBE.touch((5, 5, 33), (5, 5, 33), 2) is None
    assert CUBE.clear((5, 5, 33), (5, 5, 33), 2) == 0.0
    assert CUBE.clear((5, 5, 32), (5, 5, 32), 2) is None


@pytest.mark.parametrize(
    ("shape", "start", "end", "radius", "length"),
    [
        pytest.param(CUBE, (5, 5, 32), (5, 5, 42), 2, 0, id="off a face at once"),
        pytest.param(CUBE, (5, 5, 25), (5, 5, 45), 2, 7, id="out of the body"),
        pytest.param(CUBE, (11, 5, 30), (11, 5, 40), 2, sqrt(3), id="off an edge"),
        pytest.param(CUBE, (5, 5, 32), (20, 5, 32), 2, 5, id="slide along a face and off its edge"),
        pytest.param(CUBE, (5, 5, 32), (9, 5, 32), 2, None, id="slide along a face"),
        pytest.param(CUBE, (5, 5, 35), (5, 5, 45), 2, 0, id="not in contact"),
        pytest.param(CUBE, (5, 5, 31), (5, 5, -30), 2, 33, id="through the body"),
        pytest.param(POST, (11, 0, 5), (11, 0, 20), 2, sqrt(3), id="off the rim"),
        pytest.param(POST, (11, 0, 2), (31, 0, 2), 3, 2, id="off the side"),
        pytest.param(BALL, (1, 2, 9), (1, 2, 19), 2, 1, id="off the sphere"),
    ],
)
def test_clear_by_hand(request, shape, start, end, radius, length):
    part = shape.clear(start, end, radius)
    if length is None:
        assert part is None
    else:
        # A way that slides off at a tangent is the longest for the skin: sqrt(2·radius·CLEAR) of it.
        slack = sqrt(2 * radius * CLEAR) * 1.01 if "slide" in request.node.name else 3 * CLEAR
        assert part * np.linalg.norm(np.subtract(end, start)) == pytest.approx(length, abs=slack)
        assert not shape.touches(at(start, end, part), radius)


def test_a_way_of_one_last_bit():
    """Its slope to the body is the smallest number there is, and nothing when divided."""
    sheet, corners = Box((-1, 0, 0), (-1, 0, 0)), box_mesh((-2, -1, -1), (-1, 0, 0))
    for shape in (sheet, Mesh(corners)):
        assert shape.touch((0, 2, 0), (-5e-324, 2, 0), 0) is None
        assert shape.clear((0, 2, 0), (-5e-324, 2, 0), 0) == 0.0
        assert shape.clear((0, 2, 0), (-5e-324, 2, 0), 5) is None


def test_union_goes_on_to_the_last_contact():
    steps = Union([Box((0, 0, 0), (10, 10, 10)), Box((10, 0, 0), (20, 10, 5)), Sphere((40, 5, 5), 3)])
    assert steps.touch((-10, 5, 2), (50, 5, 2), 1) == pytest.approx(9 / 60)
    assert steps.touch((15, 5, 20), (15, 5, 0), 1) == pytest.approx(14 / 20)
    assert steps.clear((5, 5, 3), (55, 5, 3), 1) == pytest.approx(16 / 50)
    assert steps.clear((5, 5, 3), (21, 5, 3), 1) is None
    assert steps.clear((5, 5, 20), (5, 5, 0), 1) == 0.0
    assert steps.touches((40, 5, 9), 1) and not steps.touches((30, 5, 5), 1)
    assert Union([]).touch((0, 0, 0), (1, 1, 1), 20) is None
    assert Union([]).clear((0, 0, 0), (1, 1, 1), 20) == 0.0


def test_placed():
    turned = ((0, -1, 0), (1, 0, 0), (0, 0, 1))  # the body's X points along the machine's Y
    bar = Placed(Box((0, 0, 0), (10, 2, 1)), (100, 200, 300), turned)
    assert bar.touches((99, 209, 300.5), 0) and not bar.touches((101, 209, 300.5), 0)
    assert bar.touch((99, 220, 300.5), (99, 200, 300.5), 2) == pytest.approx(8 / 20)
    assert bar.clear((99, 209, 300.5), (99, 219, 300.5), 0) == pytest.approx(1 / 10)
    assert Placed(BALL, (0, 0, -3)).touch((1, 2, 20), (1, 2, 0), 0) == pytest.approx(15 / 20)


@pytest.mark.parametrize(
    "make",
    [
        lambda: Box((0, 0, 0), (1, -1, 1)),
        lambda: Box((0, 0, float("nan")), (1, 1, 1)),
        lambda: Sphere((0, 0, 0), -1),
        lambda: Cylinder((0, 0, 0), (0, 0, 0), 1, 1),
        lambda: Cylinder((0, 0, 0), (0, 0, 1), 1, float("inf")),
        lambda: Placed(BALL, (0, 0, 0), ((1, 0, 0), (0, 1, 0), (0, 1, 1))),
        lambda: Mesh(np.zeros((0, 3, 3))),
        lambda: Mesh(np.zeros((3, 3))),
        lambda: Mesh(np.full((1, 3, 3), np.nan)),
        lambda: BALL.touch((0, 0, float("nan")), (0, 0, 0), 1),
    ],
)
def test_nonsense_is_refused(make):
    with pytest.raises(ValueError):
        make()


# By an independent search: the distance in other formulas, the contact by sampling and halving


def box_distance(low, high):
    return lambda p: np.linalg.norm(np.maximum(np.maximum(np.subtract(low, p), np.subtract(p, high)), 0), axis=-1)


def post_distance(base, axis, radius, height):
    axis = np.array(axis) / np.linalg.norm(axis)

    def distance(p):
        rel = np.subtract(p, base)
        out = np.linalg.norm(np.cross(rel, axis), axis=-1) - radius
        up = np.abs(rel @ axis - height / 2) - height / 2
        return np.hypot(np.maximum(out, 0), np.maximum(up, 0))

    return distance


def ball_distance(center, radius):
    return lambda p: np.maximum(np.linalg.norm(np.subtract(p, center), axis=-1) - radius, 0)


def search(distance, start, end, radius):
    """(part of the first contact or None, least distance): by samples around the least, then halving."""
    low, high = 0.0, 1.0
    for _ in range(40):  # the least distance: a convex function's
        parts = np.linspace(low, high, 41)
        found = distance(np.array(start) + parts[:, None] * np.subtract(end, start))
        i = int(found.argmin())
        low, high = parts[max(i - 1, 0)], parts[min(i + 1, 40)]
    nearest, least = parts[i], found[i]
    if least > radius:
        return None, least
    low, high = 0.0, nearest
    if distance(at(start, end, 0.0)) <= radius:
        return 0.0, least
    for _ in range(80):
        middle = (low + high) / 2
        low, high = (low, middle) if distance(at(start, end, middle)) <= radius else (middle, high)
    return high, least


def size(least, most):
    return st.floats(least, most).map(lambda x: round(x, 3)) | st.floats(least, most)


def place(reach):
    return st.tuples(*[size(-reach, reach)] * 3)


@st.composite
def bodies(draw):
    """A convex body near 0 and its distance."""
    kind = draw(st.sampled_from(("box", "post", "ball")))
    if kind == "box":
        low = draw(place(20))
        high = tuple(x + draw(size(0, 30)) for x in low)
        return Box(low, high), box_distance(low, high)
    if kind == "ball":
        center, radius = draw(place(20)), draw(size(0, 20))
        return Sphere(center, radius), ball_distance(center, radius)
    axis = draw(st.sampled_from([(0, 0, 1), (1, 0, 0), (0, -2, 0)]) | place(1))
    assume(hypot(*axis) > 0.1)
    args = draw(place(20)), axis, draw(size(0, 20)), draw(size(0, 30))
    return Cylinder(*args), post_distance(*args)


@st.composite
def ways(draw):
    """Start, end and radius: toward 0 or past it, from near or far."""
    start = draw(place(60) | place(5000))
    end = draw(place(60) | place(20) | place(5000))
    return start, end, draw(st.just(0.0) | size(0, 20))


@given(bodies(), ways())
@settings(max_examples=600, deadline=None)
def test_touch_against_a_search(body, way):
    shape, distance = body
    start, end, radius = way
    part, (expected, least) = shape.touch(*way), search(distance, *way)
    if part is None:
        assert least > radius + INNER_SKIN - 1e-11
        return
    assert least <= radius + SKIN + 1e-10
    where = at(start, end, part)
    assert shape.touches(where, radius)
    if part > 0:
        assert distance(where) == pytest.approx(radius, abs=SKIN + 1e-10)
    before = at(start, end, np.linspace(0, part, 200)[:-1, None])
    assert part == 0 or (distance(before) >= radius - 1e-10).all()
    if expected is not None:
        # Along the way the error grows with the way's slant to the body: bound it at 1e-6 mm unless grazing.
        length = np.linalg.norm(np.subtract(end, start))
        chord = sqrt(max(radius - least, 0.0) * 2 * (radius + 1e-3))
        assert abs(expected - part) * length <= 1e-9 or chord < 1e-3 or abs(expected - part) * length * chord < 1e-8


@given(bodies(), ways())
@settings(max_examples=400, deadline=None)
def test_clear_against_a_search(body, way):
    shape, distance = body
    start, end, radius = way
    start = shape.touch(start, end, radius)
    assume(start is not None)
    start = tuple(at(way[0], way[1], start))
    part = shape.clear(start, end, radius)
    if part is None:
        assert distance(np.array(end)) <= radius + SKIN + 1e-10
        return
    where = at(start, end, part)
    assert not shape.touches(where, radius)
    assert distance(where) == pytest.approx(radius + CLEAR, abs=SKIN + 1e-10) or part == 1.0
    assert (distance(at(start, end, np.linspace(0, part, 200)[:, None])) <= radius + CLEAR + SKIN + 1e-10).all()


@given(bodies(), ways(), place(1), st.floats(0, tau), place(500))
@settings(max_examples=200, deadline=None)
def test_placing_moves_the_answer(body, way, axis, angle, translation):
    assume(hypot(*axis) > 0.1)
    x, y, z = np.array(axis) / np.linalg.norm(axis)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    rotation = np.eye(3) + sin(angle) * cross + (1 - cos(angle)) * cross @ cross
    shape, distance = body
    start, end = (tuple(rotation @ p + translation) for p in way[:2])
    part = Placed(shape, translation, rotation).touch(start, end, way[2])
    _, least = search(distance, *way)
    if part is None:
        assert least > way[2] - 1e-10
    elif part > 0:
        assert distance(at(way[0], way[1], part)) == pytest.approx(way[2], abs=SKIN + 1e-10)


# Triangles


@given(place(20), st.tuples(*[size(0.5, 30)] * 3), ways())
@settings(max_examples=400, deadline=None)
def test_a_box_of_triangles_is_a_box(low, sizes, way):
    high = tuple(np.add(low, sizes))
    box, body = Box(low, high), Mesh(box_mesh(low, high))
    assert body.closed
    start, end, radius = way
    distance = box_distance(low, high)
    _, least = search(distance, *way)
    assume(abs(least - radius) > 1e-8)
    part, expected = body.touch(*way), box.touch(*way)
    assert (part is None) == (expected is None)
    if part is not None:
        length = np.linalg.norm(np.subtract(end, start))
        where = at(start, end, part)
        assert abs(part - expected) * length <= 1e-9 or distance(where) == pytest.approx(radius, abs=SKIN)
        assert body.touches(where, radius)
        off, expected_off = body.clear(tuple(where), end, radius), box.clear(tuple(where), end, radius)
        assert (off is None) == (expected_off is None)
        if off is not None:
            assert not body.touches(at(where, end, off), radius)
            assert distance(at(where, end, off)) == pytest.approx(radius + CLEAR, abs=SKIN + 1e-10)


FACETS = ball_mesh(12, 4)
FACETED = Mesh(FACETS)
INNER = inner_radius(FACETS)


def bracket(body, outer, inner, way):
    """The touch lies between those with a body around and a body inside."""
    latest, part, first = (shape.touch(*way) for shape in (inner, body, outer))
    if first is None:
        assert part is None
    elif part is None:
        assert latest is None
    else:
        assert first - 1e-9 <= part
        assert latest is None or part <= latest + 1e-9


@given(ways())
@settings(max_examples=300, deadline=None)
def test_a_ball_of_triangles_is_nearly_a_ball(way):
    assert FACETED.closed and len(FACETED) == 2048
    bracket(FACETED, Sphere((0, 0, 0), 12), Sphere((0, 0, 0), INNER), way)


@given(ways())
@settings(max_examples=300, deadline=None)
def test_a_prism_is_nearly_a_cylinder(way):
    outer = Cylinder((0, 0, 0), (0, 0, 1), 9, 14)
    bracket(PRISM, outer, Cylinder((0, 0, 0), (0, 0, 1), 9 * cos(pi / 90), 14), way)


PRISM = Mesh(post_mesh(9, 14, 90))
BLOCKS = ((-30, -5, -5), (-10, 5, 5)), ((0, -8, -8), (12, 8, 3)), ((20, -5, 4), (26, 5, 9))
TWO_WAYS = (
    Union([Box(*block) for block in BLOCKS]),
    Mesh(np.concatenate([box_mesh(*block) for block in BLOCKS])),
)


@given(place(35), place(35), st.just(0.0) | size(0, 6))
@settings(max_examples=400, deadline=None)
def test_several_blocks_as_one_mesh(start, end, radius):
    union, body = TWO_WAYS
    assert body.touches(start, radius) == union.touches(start, radius)
    length = hypot(*np.subtract(end, start))
    for one, other in (
        (union.touch(start, end, radius), body.touch(start, end, radius)),
        (union.clear(start, end, radius), body.clear(start, end, radius)),
    ):
        assert (one is None) == (other is None)
        assert one is None or abs(one - other) * length < 1e-7


def test_inside_a_mesh():
    for x, y, z in product((0.0, 3.0, 8.9), (0.0, -2.0), (0.5, 7.0, 13.9)):
        assert PRISM.inside((x, y, z)) == (hypot(x, y) < 9)
        assert PRISM.touch((x, y, z), (x, y, z + 50), 0) == (0.0 if hypot(x, y) < 9 else None)
    for point in ((0, 0, -1), (0, 0, 15), (9.1, 0, 7), (0, 9, 14), (20, 0, 7)):
        assert not PRISM.touches(point, 0) or point == (0, 9, 14)
    # Deep inside, all of a way, and out of it.
    assert PRISM.clear((0, 0, 7), (1, 0, 7), 1) is None
    assert PRISM.clear((0, 0, 7), (0, 0, 27), 1) == pytest.approx(8 / 20)
    assert PRISM.clear((0, 0, 7), (0, 0, 27), 0) == pytest.approx(7 / 20)
    assert PRISM.clear((0, 0, -1), (0, 0, 29), 1) == pytest.approx(16 / 30)


def test_an_open_sheet_has_no_inside():
    sheet = Mesh([[(0, 0, 0), (10, 0, 0), (0, 10, 0)]])
    assert not sheet.closed
    assert sheet.touch((2, 2, 9), (2, 2, -9), 1) == pytest.approx(8 / 18)
    assert sheet.touch((2, 2, -9), (2, 2, 9), 1) == pytest.approx(8 / 18)
    assert sheet.touch((2, 2, -9), (2, 2, 9), 0) == pytest.approx(9 / 18)
    assert sheet.touch((2, -1, 9), (2, -1, -9), 2) == pytest.approx((9 - sqrt(3)) / 18)
    assert sheet.touch((-1, -1, 9), (-1, -1, -9), 2) == pytest.approx((9 - sqrt(2)) / 18)
    assert sheet.touch((6, 6, 9), (6, 6, -9), 2) == pytest.approx((9 - sqrt(2)) / 18)
    assert sheet.touch((20, 20, 9), (20, 20, -9), 2) is None
    assert sheet.clear((2, 2, 0), (2, 2, -10), 1) == pytest.approx(0.1)
    cup = Mesh(np.delete(box_mesh((0, 0, 0), (9, 9, 9)), (10, 11), axis=0))
    assert not cup.closed and not cup.inside((4, 4, 4))


def test_slivers_and_points():
    needle = Mesh([[(0, 0, 0), (10, 0, 0), (5, 1e-12, 0)], [(3, 3, 3)] * 3])
    assert needle.touch((5, 0, 9), (5, 0, 0), 2) == pytest.approx(7 / 9)
    assert needle.touch((3, 3, 9), (3, 3, 0), 2) == pytest.approx(4 / 9)


def test_no_leak_between_triangles():
    """A point that meets an edge or corner of the mesh meets the mesh."""
    for a, b, c in FACETS[::37]:
        for target in (a, (a + b) / 2, (b + 2 * c) / 3):
            start = 3 * target + np.array((0.1, 0.2, -0.3))
            part = FACETED.touch(start, -target, 0)
            assert part is not None
            assert np.linalg.norm(at(start, -target, part)) >= INNER - 1e-9


def test_trimesh_reads_what_a_mesh_takes(tmp_path):
    trimesh = pytest.importorskip("trimesh")
    trimesh.creation.cylinder(radius=8, height=6, sections=128).export(tmp_path / "post.stl")
    body = Mesh(trimesh.load(tmp_path / "post.stl", force="mesh").triangles)
    assert body.closed
    assert body.touch((1, 2, 20), (1, 2, 0), 2) == pytest.approx(15 / 20, abs=1e-7)  # STL is single precision
    assert body.touches((0, 0, 0), 0)


# The kernel and its twin


def tree(module, triangles):
    """The tree that one module builds."""
    from array import array

    count = len(triangles)
    order, bounds = array("i", range(count)), array("d", bytes(96 * count))
    right, first, last = (array("i", bytes(8 * count)) for _ in range(3))
    boxes = module.build(array("d", triangles.tobytes()), order, bounds, right, first, last, scratch())
    flat = array("d", triangles[np.array(order)].tobytes())
    return boxes, order, flat, bounds, right, first, last


@pytest.mark.skipif(not kernel.COMPILED, reason="the kernel is not compiled")
@given(st.integers(0, 2**32 - 1), st.integers(1, 200), ways(), st.booleans())
@settings(max_examples=150, deadline=None)
def test_twins(seed, count, way, grid):
    from array import array

    triangles = np.random.default_rng(seed).uniform(-30, 30, (count, 3, 3))
    if grid:
        triangles = triangles.round(-1)
    built, pure = tree(kernel, triangles), tree(uncompiled, triangles)
    assert built == pure
    start, end, radius = way
    touched = []
    for module in (kernel, uncompiled):
        spans = array("d", bytes(16 * count))
        touched.append(
            (
                module.sweep(*built[2:], path(start, end), radius, SKIN, SLIDE, array("d"), scratch()).hex(),
                int(module.sweep(*built[2:], path(start, end), radius, SKIN, SLIDE, spans, scratch())),
                spans.tobytes(),
                [module.crossings(*built[2:], array("d", end), axis, scratch()) for axis in range(3)],
            )
        )
    assert touched[0] == touched[1]
