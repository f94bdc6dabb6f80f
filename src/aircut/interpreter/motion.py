"""Motion: straight moves and arcs, and the codes that send the machine home.

Sources: 000 sections 1.1, 1.6, 1.8; decisions AMB-COD-3 to AMB-COD-6, AMB-COD-11,
AMB-COD-12, AMB-FEED-1, AMB-FEED-3, AMB-XF-15 to AMB-XF-19.
"""

from __future__ import annotations

from functools import partial
from math import hypot

from aircut.canon import EXACT_STOP, INVERSE_TIME, ROW, TIP, Kind
from aircut.diagnostics import Refusal
from aircut.diagnostics import faults as F
from aircut.geometry import arcs
from aircut.interpreter import polar, rotary, transforming, travel
from aircut.interpreter.feeding import TINY, arc_speed, feed_speed, line_speed
from aircut.interpreter.path import RECORDER
from aircut.interpreter.state import INCH, PLANES, State, out_of_range, whole
from aircut.interpreter.table import AXES, Code, Group, Order, Words
from aircut.interpreter.travel import FAR

pack = ROW.pack
TRAVERSE, FEED, ARC, PROBE = int(Kind.TRAVERSE), int(Kind.FEED), int(Kind.ARC), int(Kind.PROBE)
NUMBERED_AXES = tuple(enumerate(AXES))
LINEAR_AXES = NUMBERED_AXES[:3]
ROTARY_AXES = NUMBERED_AXES[3:]
CENTER_WORDS = "ijk"
MISMATCH = 0.0254  # mm by which an arc's two radii may differ, or
MISMATCH_SHARE = 0.001  # this part of the larger
RADIUS_SLACK = 1e-4  # part of the chord by which an R may be too short
SAME = 1e-9  # mm, degrees: positions nearer than this are one


def target(m: State, w: Words) -> list[float] | None:
    """Where the axis words lead, in the program's frame; None without axis words."""
    unit = m.unit
    goal = m.position[:]
    named = False
    if m.machine_frame:
        axes = {i: w[axis] * (unit if i < 3 else 1.0) for i, axis in NUMBERED_AXES if axis in w}
        named = bool(axes)
        goal = at_axes(m, axes)
    elif m.absolute:
        for i, axis in LINEAR_AXES:
            if axis in w:
                named = True
                goal[i] = w[axis] * unit
        for i, axis in ROTARY_AXES:
            if axis in w:
                named = True
                goal[i] = w[axis]
        if m.rollover:
            rotary.roll(m, w, goal)
    else:
        for i, axis in NUMBERED_AXES:
            if axis in w:
                named = True
                goal[i] += w[axis] * (unit if i < 3 else 1.0)
    if m.polar or "@" in w or "^" in w:
        named = polar.place(m, w, goal) or named
    x, y, z, a, b, c = goal
    if not (
        -FAR <= x <= FAR and -FAR <= y <= FAR and -FAR <= z <= FAR
        and -FAR <= a <= FAR and -FAR <= b <= FAR and -FAR <= c <= FAR
    ):  # fmt: skip
        axis = max((abs(goal[i]), axis) for i, axis in NUMBERED_AXES)[1]
        raise Refusal(
            F.BAD_VALUE,
            axis,
            word=axis.upper(),
            value=w.get(axis, 0.0),
            wanted="it leads beyond all machines",
        )
    return goal if named else None


def at_axes(m: State, axes: dict[int, float]) -> list[float]:
    """The programmed point at which these axes stand at these machine positions, and the others where they are."""
    if m.frame is not None or m.setup is not None:
        machine = m.machine_position()
        for i, value in axes.items():
            machine[i] = value
        return m.to_program(m.of_axes(machine))
    goal = m.position[:]
    for i, value in axes.items():
        goal[i] = value - m.offset[i] - m.tool_offset[i]
    return goal


def write(m: State, kind: int, goal: list[float], speed: float, flags: int) -> None:
    """Move straight to a point of the program's frame, and be there."""
    if m.indexers:
        rotary.check_indexers(m, kind, goal)
    if m.frame is not None or m.way is not RECORDER:
        m.way.line(m, kind, m.to_space(goal), speed, flags)
    else:
        x, y, z, a, b, c = goal
        ox, oy, oz, oa, ob, oc = m.offset
        lx, hx, ly, hy, lz, hz, la, ha, lb, hb, lc, hc = m.box
        if not (
            lx <= x <= hx and ly <= y <= hy and lz <= z <= hz and la <= a <= ha and lb <= b <= hb and lc <= c <= hc
        ):
            travel.check_line(m, m.to_space(goal))
        out = m.out
        out.rows += pack(
            x + ox, y + oy, z + oz, a + oa, b + ob, c + oc,
            0.0, 0.0, speed, out.line, m.tool, 0, out.file, kind, m.plane, flags,
        )  # fmt: skip
    m.position = goal


def write_axes(m: State, kind: int, goal: list[float], speed: float, flags: int) -> None:
    """Move the axes straight to where they stand for a point of the program's frame: as write, but that tool center
    point control looks on (AMB-RTCP-6).
    """
    if m.setup is None:
        write(m, kind, goal, speed, flags)
        return
    if m.indexers:
        rotary.check_indexers(m, kind, goal)
    axes = m.to_axes(m.to_space(goal))
    RECORDER.line(m, kind, [a - t for a, t in zip(axes, m.tool_offset, strict=True)], speed, flags | TIP)
    m.position = goal


def write_arc(m: State, end: list[float], center: tuple[float, float], turns: int, speed: float, flags: int) -> None:
    """Move along an arc of the program's frame (center in the plane's axes), and be at its end."""
    if m.indexers:
        rotary.check_indexers(m, ARC, end)
    o = m.offset
    first, second, _ = arcs.PLANE_AXES[m.plane]
    m.way.arc(m, m.to_space(end), (center[0] + o[first], center[1] + o[second]), turns, speed, flags)
    m.position = end


def traverse(m: State, w: Words) -> None:
    """G0: as fast as the axes can."""
    goal = target(m, w)
    if goal is not None:
        (write_axes if m.machine_frame else write)(m, TRAVERSE, goal, 0.0, m.flags)
        if m.macro is not None:
            trigger(m)
    m.machine_frame = False


def trigger(m: State) -> None:
    """After a move under G66: call the macro, unless this is inside a call (AMB-CALL-9)."""
    if m.calls == m.macro_level:
        m.macro_count += 1
        m.transfer = m.macro


def feed(m: State, w: Words) -> None:
    """G1: straight at the feed rate."""
    goal = target(m, w)
    if goal is None:
        return
    flags = m.flags
    if m.exact_stop:
        flags |= EXACT_STOP
        m.exact_stop = False
    onward = write_axes if m.machine_frame else write
    m.machine_frame = False
    if m.inverse_time:
        flags |= INVERSE_TIME
    if m.inverse_time or m.feed <= 0.0 or m.unit != 1.0 or m.surface_feed:
        speed = line_speed(m, w, goal)
    else:
        speed = m.feed
    onward(m, FEED, goal, speed, flags)
    if m.macro is not None:
        trigger(m)


def arc(turn: int, m: State, w: Words) -> None:
    """G2 (turn -1) and G3 (turn +1): arcs and helices in the active plane."""
    goal = target(m, w)
    centered = any(letter in w for letter in CENTER_WORDS)
    if goal is None and not centered and "r" not in w:
        return
    if m.frame is not None:
        transforming.check_arc(m)
    turns = turns_of(w)
    axes = arcs.PLANE_AXES[m.plane]
    end = goal or m.position[:]
    here = (m.position[axes[0]], m.position[axes[1]])
    there = (end[axes[0]], end[axes[1]])
    if "r" in w:
        if centered:
            raise Refusal(F.ARC_CENTER_AND_RADIUS, "r")
        if not any(AXES[i] in w for i in axes[:2]) and "@" not in w and "^" not in w:
            raise Refusal(F.ARC_NO_END, "r")
        center = center_by_radius(m, w, turn, here, there)
    elif centered:
        center = center_by_words(m, w, turn, axes, here)
        check_radii(m, here, there, center)
    else:
        plane = " and ".join(sorted(CENTER_WORDS[axis].upper() for axis in axes[:2]))
        raise Refusal(F.ARC_NO_CENTER, code="G2" if turn < 0 else "G3", words=plane)
    flags = m.flags
    if m.exact_stop:
        flags |= EXACT_STOP
        m.exact_stop = False
    if m.inverse_time:
        flags |= INVERSE_TIME
    if m.frame is not None:
        transforming.write_arc(m, w, end, center, turn * turns, w["r"] * m.unit if "r" in w else None, flags)
        if m.macro is not None:
            trigger(m)
        return
    if m.inverse_time or m.surface_feed:
        radius = hypot(here[0] - center[0], here[1] - center[1])
        around = radius * arcs.sweep(here, there, center, turn * turns)
        speed = arc_speed(m, w, end, hypot(around, end[axes[2]] - m.position[axes[2]]))
    else:
        speed = m.feed if m.feed > 0.0 else feed_speed(m, w, 0.0)
    write_arc(m, end, center, turn * turns, speed, flags)
    if m.macro is not None:
        trigger(m)


def turns_of(w: Words) -> int:
    """The P word of an arc. Raises Refusal."""
    if "p" not in w:
        return 1
    turns = whole(w, "p")
    if not 1 <= turns <= 32767:
        raise out_of_range(w, "p", "the number of turns, from 1 to 32767")
    return turns


def center_by_words(
    m: State, w: Words, turn: int, axes: tuple[int, int, int], here: tuple[float, float]
) -> tuple[float, float]:
    """Center from I, J, K, in the plane's axes, mm. Raises Refusal."""
    across = CENTER_WORDS[axes[2]]
    if across in w:
        raise Refusal(F.ARC_WRONG_CENTER, across, word=across.upper(), plane=PLANES[m.plane])
    words = [CENTER_WORDS[axis] for axis in axes[:2]]
    if m.arc_absolute:
        for word in words:
            if word not in w:
                wanted = " and ".join(word.upper() for word in sorted(words))
                raise Refusal(F.ARC_NO_CENTER, code="under G90.1, G2" if turn < 0 else "under G90.1, G3", words=wanted)
        return w[words[0]] * m.unit, w[words[1]] * m.unit
    return here[0] + w.get(words[0], 0.0) * m.unit, here[1] + w.get(words[1], 0.0) * m.unit


def check_radii(m: State, here: tuple[float, float], there: tuple[float, float], center: tuple[float, float]) -> None:
    """Refuse arcs whose ends lie on different circles (AMB-COD-6)."""
    first = hypot(here[0] - center[0], here[1] - center[1])
    last = hypot(there[0] - center[0], there[1] - center[1])
    if not first < FAR:
        raise Refusal(F.ARC_TOO_LARGE)
    if first < TINY:
        raise Refusal(F.ARC_ZERO_RADIUS)
    gap = abs(first - last)
    if gap > MISMATCH and gap > MISMATCH_SHARE * max(first, last):
        raise Refusal(
            F.ARC_RADIUS_MISMATCH,
            start=first / m.unit,
            end=last / m.unit,
            difference=gap / m.unit,
            unit="in" if m.unit == INCH else "mm",
        )


def center_by_radius(
    m: State, w: Words, turn: int, here: tuple[float, float], there: tuple[float, float]
) -> tuple[float, float]:
    """Center from R, in the plane's axes, mm. Raises Refusal."""
    chord = hypot(there[0] - here[0], there[1] - here[1])
    if chord < TINY:
        raise Refusal(F.ARC_SAME_END, "r")
    if abs(w["r"]) * m.unit > FAR:
        raise Refusal(F.ARC_TOO_LARGE, "r")
    center = arcs.center_of_radius(here, there, w["r"] * m.unit, turn, RADIUS_SLACK * chord)
    if center is None:
        unit = "in" if m.unit == INCH else "mm"
        raise Refusal(F.ARC_RADIUS_TOO_SMALL, "r", radius=w["r"], half=chord / 2 / m.unit, unit=unit)
    return center


def exact_stop(m: State, w: Words) -> None:
    """G9: the motion of this block stops at its end."""
    m.exact_stop = True


def machine_frame(m: State, w: Words) -> None:
    """G53: the axis words of this block are machine coordinates."""
    m.machine_frame = True


def cancel(m: State, w: Words) -> None:
    """G80: no motion mode."""
    m.out.event("COMMENT", "interpreter: motion mode set to none")


def go_home(stored: str, m: State, w: Words) -> None:
    """G28, G30: through the point given to the stored point, in the named axes or in all."""
    middle = target(m, w)
    if middle is not None and apart(middle, m.position):
        write(m, TRAVERSE, middle, 0.0, m.flags)
    home = getattr(m, stored)
    goal = at_axes(m, {i: home[i] for i, axis in NUMBERED_AXES if axis in m.axes and (middle is None or axis in w)})
    if apart(goal, m.position):
        write_axes(m, TRAVERSE, goal, 0.0, m.flags)


def apart(goal: list[float], place: list[float]) -> bool:
    """Whether two positions are different, but for what sums of offsets round."""
    return any(abs(a - b) > SAME for a, b in zip(goal, place, strict=True))


def store_home(stored: str, m: State, w: Words) -> None:
    """G28.1, G30.1: remember where the machine is."""
    setattr(m, stored, m.machine_position())


move = partial(Code, group=Group.MOTION, order=Order.MOTION, axes=True, modal=True)
arc_move = partial(move, takes="ijkrp", wakes="ijk")
single = partial(Code, group=Group.NON_MODAL, order=Order.NON_MODAL)

CODES = (
    move("G0", "Straight traverse", traverse),
    move("G1", "Straight feed", feed),
    arc_move("G2", "Clockwise arc feed", partial(arc, -1)),
    arc_move("G3", "Counterclockwise arc feed", partial(arc, +1)),
    Code("G9", "Exact stop, for one block", exact_stop, Group.EXACT_STOP, Order.ROTATION,
         fits=("G1", "G2", "G3"), alone="g1"),
    Code("G53", "Machine coordinates, for one block", machine_frame, Group.NON_MODAL, Order.ROTATION,
         fits=("G0", "G1", "G9", "G38.2", "G38.3", "G38.4", "G38.5")),
    Code("G80", "Cancel the motion mode", cancel, Group.MOTION, Order.MOTION, modal=True, weak=True),
    single("G28", "Go to the G28 position", partial(go_home, "home"), axes=True),
    single("G30", "Go to the G30 position", partial(go_home, "second_home"), axes=True),
    single("G28.1", "Store the G28 position", partial(store_home, "home")),
    single("G30.1", "Store the G30 position", partial(store_home, "second_home")),
)  # fmt: skip
