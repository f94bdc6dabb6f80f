"""Scaling and rotation: G50, G51, G68, G68.2 and G69.

They are steps 4 and 5 of the way from the program to the machine; units, distances,
polar words and the offsets come before. A center is where the program's words for it
lead when the code runs; it then stays in space, whatever the offsets do. Toolpath and
listing have the positions that result, so whoever reads them need not know these codes.

Sources: 000 sections 1.1 and 8.1; decisions AMB-VAR-12, AMB-XF-5 to AMB-XF-10.
"""

from __future__ import annotations

from functools import partial

from aircut.canon import EXACT_STOP, Kind
from aircut.diagnostics import Refusal
from aircut.diagnostics import faults as F
from aircut.geometry.arcs import PLANE_AXES
from aircut.geometry.transforms import Vector
from aircut.interpreter.feeding import arc_speed
from aircut.interpreter.frame import Frame, Rotation, Scaling
from aircut.interpreter.rotary import check_indexers
from aircut.interpreter.state import PLANES, State, out_of_range
from aircut.interpreter.table import AXES, Code, Group, Order, Words
from aircut.interpreter.travel import FAR

FEED = int(Kind.FEED)
LINEAR = AXES[:3]
ANGLES = "ijk"
CENTER_WORDS = "ab"  # of the plane's first and second axis, in the order of its letters
SMALLEST, LARGEST = 1e-6, 1e6  # factors of scaling


# --- the codes


def scale(m: State, w: Words) -> None:
    """G51: by P, or by I, J, K along X, Y, Z, about X, Y, Z or the present position. Raises Refusal."""
    check_words(m, w)
    rotation = parts(m)[1]
    before = m.to_space(m.position) if rotation is None else [*rotation.back()(*m.to_space(m.position)[:3])]
    here = [place - offset for place, offset in zip(before, m.offset)]  # noqa: B905  three of six
    programmed = [w[axis] * m.unit if axis in w else here[i] for i, axis in enumerate(LINEAR)]
    center = [programmed[i] + m.offset[i] if axis in w else before[i] for i, axis in enumerate(LINEAR)]
    put(m, Scaling(factors_of(w), vector(center), vector(programmed)), rotation)


def factors_of(w: Words) -> Vector:
    """The words P, or I, J, K. Raises Refusal."""
    own = [letter for letter in ANGLES if letter in w]
    if ("p" in w) == bool(own):
        raise Refusal(F.SCALING_WORDS, "p" if "p" in w else "g")
    for letter in own or "p":
        if not SMALLEST <= abs(w[letter]) <= LARGEST:
            raise out_of_range(w, letter, f"a factor is {SMALLEST:g} to {LARGEST:g} or the negative of that, not zero")
    x, y, z = (w.get(letter, 1.0) if own else w["p"] for letter in ANGLES)
    return x, y, z


def unscale(m: State, w: Words) -> None:
    """G50."""
    put(m, None, parts(m)[1])


def rotate(m: State, w: Words) -> None:
    """G68: by R degrees in the plane, about the given point or where the cutter is. Raises Refusal."""
    check_words(m, w, CENTER_WORDS)
    scaling, rotation = parts(m)
    if rotation is not None and rotation.plane is None:
        raise Refusal(F.ROTATION_CONFLICT, "g", code="G68", other="G68.2")
    words = dict(w)
    in_plane = [LINEAR.index(letter.lower()) for letter in PLANES[m.plane]]
    for letter, i in zip(CENTER_WORDS, in_plane, strict=True):
        if letter in w:
            if LINEAR[i] in w:
                raise Refusal(F.CENTER_TWICE, letter, word=letter.upper(), axis=LINEAR[i].upper())
            words[LINEAR[i]] = w[letter]
    space = m.to_space(m.position)
    unscaled = space if scaling is None else [*scaling.back()(*space[:3])]
    programmed = [words.get(axis, 0.0) * m.unit for axis in LINEAR]
    for i in in_plane:
        if LINEAR[i] not in words:
            programmed[i] = unscaled[i] - m.offset[i]
    center = placed(m, scaling, programmed)
    for i in in_plane:
        if LINEAR[i] not in words:
            center[i] = space[i]
    angles = [0.0, 0.0, 0.0]
    angles[PLANE_AXES[m.plane][2]] = w["r"]
    put(m, scaling, Rotation(m.plane, vector(angles), vector(center), vector(programmed)))


def tilt(m: State, w: Words) -> None:
    """G68.2: by I, J, K degrees about X, Y, Z, in this order, about the given point or the origin. Raises Refusal."""
    check_words(m, w)
    scaling, rotation = parts(m)
    if rotation is not None and rotation.plane is not None:
        raise Refusal(F.ROTATION_CONFLICT, "g", code="G68.2", other="G68")
    if not any(letter in w for letter in ANGLES):
        raise Refusal(F.MISSING_WORD, code="G68.2", word="I, J or K", meaning="they are angles about X, Y and Z")
    angles = vector([w.get(letter, 0.0) for letter in ANGLES])
    programmed = [w.get(axis, 0.0) * m.unit for axis in LINEAR]
    put(m, scaling, Rotation(None, angles, vector(placed(m, scaling, programmed)), vector(programmed)))


def unrotate(m: State, w: Words) -> None:
    """G69."""
    put(m, parts(m)[0], None)


def check_words(m: State, w: Words, allowed: str = "") -> None:
    """Refuse words of rotary axes, and centers beyond all machines."""
    for letter in LINEAR + allowed:
        if letter in w and not abs(w[letter]) * m.unit <= FAR:
            raise out_of_range(w, letter, "it is beyond all machines")
    for letter in AXES[3:]:
        if letter in w and letter not in allowed:
            raise Refusal(F.UNUSED_WORD, letter, word=letter.upper())


def parts(m: State) -> tuple[Scaling | None, Rotation | None]:
    """What is in force."""
    return (None, None) if m.frame is None else (m.frame.scaling, m.frame.rotation)


def placed(m: State, scaling: Scaling | None, programmed: list[float]) -> list[float]:
    """Where a programmed center lies once the offsets are added and it is scaled."""
    place = [p + o for p, o in zip(programmed, m.offset)]  # noqa: B905  three of six
    return place if scaling is None else [*scaling.forth()(*place)]


def vector(values: list[float]) -> Vector:
    x, y, z = values
    return x, y, z


def put(m: State, scaling: Scaling | None, rotation: Rotation | None) -> None:
    """Put a scaling and a rotation in force. Raises Refusal where radius compensation could not follow."""
    if (scaling, rotation) == parts(m):
        return
    frame = None if scaling is None and rotation is None else Frame(scaling, rotation)
    if m.compensating:
        if rotation is not None and rotation.plane != m.plane:
            raise Refusal(F.COMPENSATING, "g", code="a rotation of another plane")
        if mirrored(frame, m.plane) != mirrored(m.frame, m.plane):
            raise Refusal(F.COMPENSATING, "g", code="a change of mirroring")
    m.set_frame(frame)


def mirrored(frame: Frame | None, plane: int) -> bool:
    """Whether left and right have changed sides in a plane."""
    return frame is not None and frame.mirrors(plane)


# --- arcs


def write_arc(
    m: State, w: Words, end: list[float], center: tuple[float, float], turns: int, radius: float | None, flags: int
) -> None:
    """Move along an arc of the program's frame as scaling and rotation leave it, and be at its end.

    center: in the plane's axes, mm. radius: the R word in mm, where there was one.
    """
    assert m.frame is not None
    if m.indexers:
        check_indexers(m, int(Kind.ARC), end)
    u, v, _ = PLANE_AXES[m.plane]
    start, goal = ([p + o for p, o in zip(place, m.offset, strict=True)] for place in (m.position, end))
    bow = m.frame.bow(m.plane, start, goal, (center[0] + m.offset[u], center[1] + m.offset[v]), turns, radius)
    speed = arc_speed(m, w, end, bow.length)
    first = flags if bow.rest is None else (flags & ~EXACT_STOP) | m.flags
    m.way.arc(m, bow.end, bow.center, bow.turns, speed, first)
    if bow.rest is not None:
        m.way.line(m, FEED, bow.rest, speed, flags)
    m.position = end


def check_arc(m: State) -> None:
    """Refuse an arc that would leave its plane (AMB-XF-9, AMB-XF-10)."""
    refuse_tilted(m, "an arc")
    rotation = parts(m)[1]
    if rotation is not None and rotation.plane is not None and rotation.plane != m.plane:
        raise Refusal(F.ARC_ROTATED, "g", plane=PLANES[m.plane], other=PLANES[rotation.plane])


def refuse_tilted(m: State, code: str) -> None:
    """Refuse what a tilted plane does not allow."""
    if m.frame is not None and m.frame.tilted:
        raise Refusal(F.TILTED, "g", code=code)


scaling_code = partial(Code, group=Group.SCALING, order=Order.SCALING, modal=True)
rotation_code = partial(Code, group=Group.ROTATION, order=Order.ROTATION, modal=True)

CODES = (
    scaling_code("G50", "Scaling off", unscale),
    scaling_code("G51", "Scaling, mirroring", scale, axes=True, takes="ijkp"),
    rotation_code("G68", "Rotation in the plane", rotate, axes=True, takes="rab", needs="r"),
    rotation_code("G68.2", "Tilted plane", tilt, axes=True, takes="ijk"),
    rotation_code("G69", "Rotation off", unrotate),
)
