"""From moves to the pieces of path that a planner plans: lines, arcs, and blends at their corners.

The path's parameter s is the length in the space of all six axes, a degree as long as a millimeter, so it
grows steadily whether linear or rotary axes move. A piece has bounds that hold all along it: on the speed
ds/dt, and on the acceleration and jerk along the path that leave room for those of its curvature.
Lengths mm (and degrees), times s.

Work arrays: points (12,) start and end of the move. Two slots, one for the move at hand and one for that
before: ways (24,) directions at start and end; bends (24,) second derivatives there, by s; facts (16,)
LENGTH 0, FEED_LENGTH 1, SPEED 2, ACCEL 3, DECEL 4, JERK 5, TURNS 6 (rotary axes move), CURVED 7.
limits (18,): velocity, acceleration, jerk of the axes; jerk infinite where there is none.
"""

from __future__ import annotations

try:
    import cython
except ImportError:
    from aircut.kernels import nocython as cython

if cython.compiled:
    from cython.cimports.libc.math import atan2, cos, fabs, fmod, sin, sqrt
else:
    from math import atan2, cos, fabs, fmod, sin, sqrt

COMPILED = cython.compiled

LINE, ARC, FILLET, CURVE = range(4)  # kinds of pieces


@cython.cfunc
@cython.boundscheck(False)
@cython.wraparound(False)
@cython.cdivision(True)
def line(
    slot: cython.int,
    feed: cython.double,
    points: cython.double[::1],
    ways: cython.double[::1],
    bends: cython.double[::1],
    facts: cython.double[::1],
    limits: cython.double[::1],
) -> cython.double:
    """Measure a straight move into a slot; returns its length, 0 for none. feed: per second, or infinite."""
    i: cython.int
    step: cython.double
    part: cython.double
    linear: cython.double = 0.0
    rotary: cython.double = 0.0
    for i in range(6):
        step = points[6 + i] - points[i]
        if i < 3:
            linear += step * step
        else:
            rotary += step * step
    length: cython.double = sqrt(linear + rotary)
    if length < 1e-12:
        return 0.0
    linear = sqrt(linear)
    rotary = sqrt(rotary)
    asked: cython.double = linear if linear > 1e-7 else rotary
    speed: cython.double = feed * (length / asked)
    accel: cython.double = 1e300
    jerk: cython.double = 1e300
    at: cython.int = 12 * slot
    for i in range(6):
        step = (points[6 + i] - points[i]) / length
        ways[at + i] = ways[at + 6 + i] = step
        bends[at + i] = bends[at + 6 + i] = 0.0
        part = fabs(step)
        if part > 0.0:
            if part * speed > limits[i]:
                speed = limits[i] / part
            if part * accel > limits[6 + i]:
                accel = limits[6 + i] / part
            if part * jerk > limits[12 + i]:
                jerk = limits[12 + i] / part
    at = 8 * slot
    facts[at] = length
    facts[at + 1] = asked
    facts[at + 2] = speed
    facts[at + 3] = facts[at + 4] = accel
    facts[at + 5] = jerk
    facts[at + 6] = rotary
    facts[at + 7] = 0.0
    return length


@cython.cfunc
@cython.boundscheck(False)
@cython.wraparound(False)
@cython.cdivision(True)
def arc(
    slot: cython.int,
    feed: cython.double,
    plane: cython.int,
    turns: cython.int,
    center_u: cython.double,
    center_v: cython.double,
    points: cython.double[::1],
    ways: cython.double[::1],
    bends: cython.double[::1],
    facts: cython.double[::1],
    limits: cython.double[::1],
) -> cython.double:
    """Measure an arc or helix into a slot; returns its length.

    What its two axes do is bounded over all directions, so the bound is the same all around. Of the lesser
    one's acceleration the curvature may take √3/2, which leaves a half along the path.
    """
    tau: cython.double = 6.283185307179586
    u: cython.int = 0
    v: cython.int = 1
    w: cython.int = 2
    if plane == 1:
        u, v, w = 2, 0, 1
    elif plane == 2:
        u, v, w = 1, 2, 0
    fu: cython.double = points[u] - center_u
    fv: cython.double = points[v] - center_v
    lu: cython.double = points[6 + u] - center_u
    lv: cython.double = points[6 + v] - center_v
    first: cython.double = sqrt(fu * fu + fv * fv)
    last: cython.double = sqrt(lu * lu + lv * lv)
    start: cython.double = atan2(fv, fu)
    # Swept angle, as geometry.arcs.sweep has it.
    sign: cython.double = 1.0 if turns > 0 else -1.0
    swept: cython.double = fmod(sign * (atan2(lv, lu) - start), tau)
    if swept < 0.0:
        swept += tau
    if swept < 1e-6:
        swept += tau
    swept += tau * (turns * sign - 1.0)
    angle: cython.double = sign * swept
    rise: cython.double = points[6 + w] - points[w]
    around: cython.double = (first + last) / 2.0 * swept
    asked: cython.double = sqrt(around * around + rise * rise)
    rotary: cython.double = 0.0
    i: cython.int
    step: cython.double
    for i in range(3, 6):
        step = points[6 + i] - points[i]
        rotary += step * step
    length: cython.double = sqrt(asked * asked + rotary)
    if length < 1e-12:
        return 0.0
    rotary = sqrt(rotary)

    # Derivatives by s: along the circle, of the radius, and of what runs straight.
    turn: cython.double = angle / length
    grow: cython.double = (last - first) / length
    widest: cython.double = first if first > last else last
    along: cython.double = sqrt(widest * widest * turn * turn + grow * grow)
    bend: cython.double = widest * turn * turn + 2.0 * fabs(grow * turn)
    twist: cython.double = fabs(turn) * (widest * turn * turn + 3.0 * fabs(grow * turn))
    at: cython.int = 12 * slot
    for i in range(6):
        step = (points[6 + i] - points[i]) / length
        ways[at + i] = ways[at + 6 + i] = step
        bends[at + i] = bends[at + 6 + i] = 0.0
    c: cython.double = cos(start)
    s: cython.double = sin(start)
    ways[at + u] = grow * c - first * turn * s
    ways[at + v] = grow * s + first * turn * c
    bends[at + u] = -2.0 * grow * turn * s - first * turn * turn * c
    bends[at + v] = 2.0 * grow * turn * c - first * turn * turn * s
    c = cos(start + angle)
    s = sin(start + angle)
    ways[at + 6 + u] = grow * c - last * turn * s
    ways[at + 6 + v] = grow * s + last * turn * c
    bends[at + 6 + u] = -2.0 * grow * turn * s - last * turn * turn * c
    bends[at + 6 + v] = 2.0 * grow * turn * c - last * turn * turn * s

    velocity: cython.double = limits[u] if limits[u] < limits[v] else limits[v]
    most: cython.double = limits[6 + u] if limits[6 + u] < limits[6 + v] else limits[6 + v]
    hard: cython.double = limits[12 + u] if limits[12 + u] < limits[12 + v] else limits[12 + v]
    speed: cython.double = feed * (length / asked)
    if along * speed > velocity:
        speed = velocity / along
    if bend * speed * speed > 0.8660254037844386 * most:
        speed = sqrt(0.8660254037844386 * most / bend)
    accel: cython.double = 1e300
    jerk: cython.double = 1e300
    part: cython.double
    for i in range(6):
        if i != u and i != v:
            part = fabs(ways[at + i])
            if part > 0.0:
                if part * speed > limits[i]:
                    speed = limits[i] / part
                if part * accel > limits[6 + i]:
                    accel = limits[6 + i] / part
                if part * jerk > limits[12 + i]:
                    jerk = limits[12 + i] / part
    if hard < 1e300:
        # Of the jerk, 3·speed·accel across the path and jerk + speed³ along it.
        if twist * speed * speed * speed > 0.6 * hard:
            speed = (0.6 * hard / twist) ** (1.0 / 3.0)
        if 3.0 * bend * speed * accel > 0.6 * hard:
            accel = 0.2 * hard / (bend * speed)
        part = (0.8 * hard - twist * speed * speed * speed) / along
        if part < jerk:
            jerk = part
    if along * accel > most / 2.0:
        accel = most / 2.0 / along
    at = 8 * slot
    facts[at] = length
    facts[at + 1] = asked
    facts[at + 2] = speed
    facts[at + 3] = facts[at + 4] = accel
    facts[at + 5] = jerk
    facts[at + 6] = rotary
    facts[at + 7] = 1.0
    return length


@cython.cfunc
def taken(
    speed: cython.double, jump: cython.double, bend: cython.double, accel: cython.double, cycle: cython.double
) -> cython.double:
    """Acceleration that an axis needs around a joint. jump: of its velocity, a second, for each unit of speed."""
    beside: cython.double = speed + accel * cycle / 8.0  # half a cycle away
    across: cython.double = bend * beside * beside
    return jump * speed + sqrt(across * across + accel * accel / 16.0)


@cython.cfunc
@cython.boundscheck(False)
@cython.wraparound(False)
@cython.cdivision(True)
def kink(
    before: cython.int,
    after: cython.int,
    cycle: cython.double,
    share: cython.double,
    ways: cython.double[::1],
    bends: cython.double[::1],
    limits: cython.double[::1],
) -> cython.double:
    """Highest speed at which the axes can take the change of direction from one move to the next.

    A jump of velocity counts as what it is over one cycle of the controller, of which it may take a share of
    the acceleration and jerk; a jump of acceleration likewise of the jerk. Infinite where nothing jumps.
    """
    speed: cython.double = 1e300
    i: cython.int
    jump: cython.double
    most: cython.double
    least: cython.double = 0.0
    middle: cython.double = 0.0
    bend: cython.double
    for i in range(6):
        least += bends[12 * before + 6 + i] * bends[12 * before + 6 + i]
        middle += bends[12 * after + i] * bends[12 * after + i]
    bend = sqrt(least if least > middle else middle)  # across any axis, as it turns about
    for i in range(6):
        jump = fabs(ways[12 * after + i] - ways[12 * before + 6 + i])
        if jump > 0.2 or (cycle == 0.0 and jump > 1e-9):  # a corner: nothing is gained by not stopping
            return 0.0
        if jump > 1e-9:
            most = share * cycle * limits[6 + i] / jump
            if most < speed:
                speed = most
            most = share * cycle * cycle * limits[12 + i] / jump
            if most < speed:
                speed = most
            # What an arc needs of the acceleration, across the path and (a quarter) along it, must be left.
            if bend > 0.0 and taken(speed, jump / cycle, bend, limits[6 + i], cycle) > limits[6 + i]:
                least = 0.0
                for _ in range(50):
                    middle = (least + speed) / 2.0
                    if taken(middle, jump / cycle, bend, limits[6 + i], cycle) > limits[6 + i]:
                        speed = middle
                    else:
                        least = middle
                speed = least
        if limits[12 + i] < 1e300:
            jump = fabs(bends[12 * after + i] - bends[12 * before + 6 + i])
            if jump * speed * speed > share * cycle * limits[12 + i]:
                speed = sqrt(share * cycle * limits[12 + i] / jump)
    return speed


@cython.cfunc
@cython.boundscheck(False)
@cython.wraparound(False)
@cython.cdivision(True)
def fillet(
    before: cython.int,
    after: cython.int,
    room: cython.double,
    tolerance: cython.double,
    ways: cython.double[::1],
    limits: cython.double[::1],
    bounds: cython.double[::1],
) -> cython.double:
    """A circle touching both lines, no farther than the tolerance from their corner.

    Returns how much of each line it takes, at most room; 0 where there is none. Writes to bounds:
    length, speed, accel, jerk.
    """
    i: cython.int
    sum2: cython.double = 0.0
    diff2: cython.double = 0.0
    p: cython.double
    q: cython.double
    for i in range(6):
        p = ways[12 * before + 6 + i]
        q = ways[12 * after + i]
        sum2 += (q + p) * (q + p)
        diff2 += (q - p) * (q - p)
    s: cython.double = sqrt(diff2) / 2.0  # sine and cosine of half the turn
    c: cython.double = sqrt(sum2) / 2.0
    if s < 1e-9 or c < 1e-3:
        return 0.0
    take: cython.double = tolerance * (1.0 + c) / s
    if take > room:
        take = room
    radius: cython.double = take * c / s
    if radius < 1e-9:
        return 0.0
    speed: cython.double = 1e300
    accel: cython.double = 1e300
    part: cython.double
    for i in range(6):
        # Length of the axis' shadow on the circle's plane.
        p = ways[12 * before + 6 + i]
        q = ways[12 * after + i]
        part = sqrt((q + p) * (q + p) / sum2 + (q - p) * (q - p) / diff2)
        if part > 0.0:
            if part * speed > limits[i]:
                speed = limits[i] / part
            if part * accel > limits[6 + i]:
                accel = limits[6 + i] / part
    most: cython.double = sqrt(0.8660254037844386 * accel * radius)
    if most < speed:
        speed = most
    bounds[0] = 2.0 * radius * atan2(s, c)
    bounds[1] = speed
    bounds[2] = accel / 2.0
    bounds[3] = 1e300
    return take


@cython.cfunc
@cython.boundscheck(False)
@cython.wraparound(False)
@cython.cdivision(True)
def curve(
    before: cython.int,
    after: cython.int,
    smooth: cython.bint,
    feed: cython.double,
    room: cython.double,
    tolerance: cython.double,
    ways: cython.double[::1],
    limits: cython.double[::1],
    bounds: cython.double[::1],
) -> cython.double:
    """A curve along which one direction passes into the other: q' = (1-f)·before + f·after.

    f grows from 0 to 1 over twice the length taken of each line: steadily, a parabola; or, if smooth, as
    3r² - 2r³, so that it begins and ends without curvature. Any axes. Returns and writes as `fillet` does;
    the parameter's speed is the tool's at both ends only, between it is a little more.
    """
    i: cython.int
    diff2: cython.double = 0.0
    sum2: cython.double = 0.0
    p: cython.double
    q: cython.double
    for i in range(6):
        p = ways[12 * before + 6 + i]
        q = ways[12 * after + i]
        sum2 += (q + p) * (q + p)
        diff2 += (q - p) * (q - p)
    if diff2 < 1e-18 or sum2 < 1e-6:
        return 0.0
    take: cython.double = tolerance / ((0.1875 if smooth else 0.25) * sqrt(diff2))
    if take > room:
        take = room
    if take < 1e-9:
        return 0.0
    length: cython.double = 2.0 * take
    speed: cython.double = feed
    accel: cython.double = 1e300
    jerk: cython.double = 1e300
    part: cython.double
    bend: cython.double
    twist: cython.double
    for i in range(6):
        p = fabs(ways[12 * before + 6 + i])
        q = fabs(ways[12 * after + i])
        part = p if p > q else q
        if part * speed > limits[i]:
            speed = limits[i] / part
        bend = fabs(ways[12 * after + i] - ways[12 * before + 6 + i]) / length * (1.5 if smooth else 1.0)
        if bend * speed * speed > 0.8 * limits[6 + i]:
            speed = sqrt(0.8 * limits[6 + i] / bend)
        if smooth:
            twist = bend * 4.0 / length
            if twist * speed * speed * speed > 0.6 * limits[12 + i]:
                speed = (0.6 * limits[12 + i] / twist) ** (1.0 / 3.0)
    for i in range(6):
        p = fabs(ways[12 * before + 6 + i])
        q = fabs(ways[12 * after + i])
        part = p if p > q else q
        bend = fabs(ways[12 * after + i] - ways[12 * before + 6 + i]) / length * (1.5 if smooth else 1.0)
        if part * accel > limits[6 + i] - bend * speed * speed:
            accel = (limits[6 + i] - bend * speed * speed) / part
        if smooth:
            if 3.0 * bend * speed * accel > 0.2 * limits[12 + i]:
                accel = 0.2 * limits[12 + i] / (3.0 * bend * speed)
            twist = bend * 4.0 / length
            p = 0.8 * limits[12 + i] - twist * speed * speed * speed
            if part * jerk > p:
                jerk = p / part
    bounds[0] = length
    bounds[1] = speed
    bounds[2] = accel
    bounds[3] = jerk
    return take


@cython.cfunc
@cython.boundscheck(False)
@cython.wraparound(False)
def emit(
    out: cython.double[::1],
    room: cython.Py_ssize_t,
    at: cython.Py_ssize_t,
    length: cython.double,
    speed: cython.double,
    accel: cython.double,
    decel: cython.double,
    jerk: cython.double,
    enter: cython.double,
    offset: cython.double,
) -> cython.double:
    """Write one piece into the columns of `lay`."""
    out[at] = length
    out[room + at] = speed
    out[2 * room + at] = accel
    out[3 * room + at] = decel
    out[4 * room + at] = jerk
    out[5 * room + at] = enter
    out[6 * room + at] = offset
    return 0.0


@cython.cfunc
@cython.boundscheck(False)
@cython.wraparound(False)
def body(
    out: cython.double[::1],
    room: cython.Py_ssize_t,
    at: cython.Py_ssize_t,
    length: cython.double,
    offset: cython.double,
    speed: cython.double,
    enter: cython.double,
    head: cython.double,
    tail: cython.double,
    share: cython.double,
    slot: cython.int,
    facts: cython.double[::1],
) -> cython.Py_ssize_t:
    """Write what blends have left of a move; returns the index after it.

    head, tail: lengths beside joints where something jumps: there the motion leaves a share to the jump.
    """
    accel: cython.double = facts[8 * slot + 3]
    decel: cython.double = facts[8 * slot + 4]
    jerk: cython.double = facts[8 * slot + 5]
    rest: cython.double = 1.0 - share
    if 2.0 * (head + tail) > length:
        emit(out, room, at, length, speed, rest * accel, rest * decel, rest * jerk, enter, offset)
        return at + 1
    if head > 0.0:
        emit(out, room, at, head, speed, rest * accel, rest * decel, rest * jerk, enter, offset)
        enter = 1e300
        at += 1
    emit(out, room, at, length - head - tail, speed, accel, decel, jerk, enter, offset + head)
    at += 1
    if tail > 0.0:
        enter = offset + length - tail
        emit(out, room, at, tail, speed, rest * accel, rest * decel, rest * jerk, 1e300, enter)
        at += 1
    return at


@cython.boundscheck(False)
@cython.wraparound(False)
@cython.cdivision(True)
def lay(
    x: cython.const[cython.double][:],
    y: cython.const[cython.double][:],
    z: cython.const[cython.double][:],
    a: cython.const[cython.double][:],
    b: cython.const[cython.double][:],
    c: cython.const[cython.double][:],
    u: cython.const[cython.double][:],
    v: cython.const[cython.double][:],
    feed: cython.const[cython.double][:],
    turns: cython.const[cython.short][:],
    kind: cython.const[cython.uchar][:],
    plane: cython.const[cython.uchar][:],
    flags: cython.const[cython.ushort][:],
    points: cython.double[::1],
    limits: cython.double[::1],
    cycle: cython.double,
    share: cython.double,
    parts: cython.double,
    smooth: cython.bint,
    stops: cython.longlong[::1],
    regime_at: cython.longlong[::1],
    regimes: cython.double[::1],
    work: cython.double[::1],
    out: cython.double[::1],
    move: cython.int[::1],
    shape: cython.uchar[::1],
):
    """Lay out the pieces of n moves; returns their number, or -1 - i where move i has no speed.

    x to flags: the toolpath's columns. points: (12,), the start in its first six. stops: sorted indices of
    moves before which the machine stands. regime_at, regimes: from move regime_at[j] on holds regimes[7j:]:
    blend tolerance mm, acceleration and deceleration of feed moves (0 the axes' own), share of the jerk,
    highest rapid mm/s (0 the axes' own), feed and rapid factors. work: (72,) scratch. smooth: blends
    have no jump of curvature. parts: mm by which a move told in parts may round their corners. cycle and
    share: see `kink`.
    Written, all 4n long: out, seven columns end to end: length; highest speed all along; acceleration,
    deceleration, jerk along the path; highest speed at the start; offset, where on its move the piece
    starts, of a blend how much of each line it takes. move: index; shape: LINE, ARC, FILLET, CURVE.
    """
    count: cython.Py_ssize_t = x.shape[0]
    space: cython.Py_ssize_t = move.shape[0]
    ways: cython.double[::1] = work[0:24]
    bends: cython.double[::1] = work[24:48]
    facts: cython.double[::1] = work[48:64]
    bounds: cython.double[::1] = work[64:72]
    at: cython.Py_ssize_t = 0
    i: cython.Py_ssize_t
    j: cython.int
    regime: cython.Py_ssize_t = 0
    stop: cython.Py_ssize_t = 0
    now: cython.int = 0  # slots
    before: cython.int = 1
    has_before: cython.bint = False
    halt: cython.bint = False
    blends: cython.bint = False  # the move before may be blended with this one
    tolerance: cython.double = 0.0
    entry: cython.double = 0.0  # highest speed at the start of the body of the move before
    trimmed: cython.double = 0.0  # what a blend has taken from its start
    last: cython.Py_ssize_t = 0  # its index
    take: cython.double
    most: cython.double
    room: cython.double
    left: cython.double
    wanted: cython.double
    ratio: cython.double
    is_arc: cython.bint
    linked: cython.bint
    slow: cython.double
    head: cython.double = 0.0
    tail: cython.double
    reach: cython.double = 3.0 if smooth else 1.0  # cycles over which a jump is seen
    form: cython.int = 2
    k: cython.Py_ssize_t
    start: cython.Py_ssize_t

    for i in range(count):
        while regime + 1 < regime_at.shape[0] and regime_at[regime + 1] <= i:
            regime += 1
        while stop < stops.shape[0] and stops[stop] <= i:
            halt = True
            stop += 1
        points[6] = x[i]
        points[7] = y[i]
        points[8] = z[i]
        points[9] = a[i]
        points[10] = b[i]
        points[11] = c[i]
        is_arc = kind[i] == 2 and turns[i] != 0
        if kind[i] == 0:
            wanted = regimes[7 * regime + 4] if regimes[7 * regime + 4] > 0.0 else 1e300
        else:
            wanted = feed[i] / 60.0 * regimes[7 * regime + 5]
            if not wanted > 0.0:
                return -1 - i
        if is_arc:
            left = arc(now, wanted, plane[i], turns[i], u[i], v[i], points, ways, bends, facts, limits)
        else:
            left = line(now, wanted, points, ways, bends, facts, limits)
        for j in range(6):
            points[j] = points[6 + j]
        if kind[i] == 3 or (has_before and (kind[i] == 0) != (kind[last] == 0)):
            halt = True
        if left == 0.0:
            if flags[i] & 1:
                halt = True
            continue
        if kind[i] == 0:
            facts[8 * now + 2] *= regimes[7 * regime + 6]
        else:
            ratio = facts[8 * now] / facts[8 * now + 1]
            if regimes[7 * regime + 1] > 0.0 and regimes[7 * regime + 1] * ratio < facts[8 * now + 3]:
                facts[8 * now + 3] = regimes[7 * regime + 1] * ratio
            if regimes[7 * regime + 2] > 0.0 and regimes[7 * regime + 2] * ratio < facts[8 * now + 4]:
                facts[8 * now + 4] = regimes[7 * regime + 2] * ratio
            facts[8 * now + 5] *= regimes[7 * regime + 3]

        if has_before:
            take = 0.0
            most = 0.0
            linked = False
            slow = facts[8 * before + 2]
            if not halt:
                if blends and not is_arc and facts[8 * before + 7] == 0.0:
                    room = facts[8 * before] - trimmed - head
                    if facts[8 * now] / 2.0 < room:
                        room = facts[8 * now] / 2.0
                    wanted = slow if slow < facts[8 * now + 2] else facts[8 * now + 2]
                    if smooth or facts[8 * before + 6] > 0.0 or facts[8 * now + 6] > 0.0:
                        take = curve(before, now, smooth, wanted, room, tolerance, ways, limits, bounds)
                        form = 3
                    else:
                        take = fillet(before, now, room, tolerance, ways, limits, bounds)
                        form = 2
                        if take > 0.0:
                            if wanted < bounds[1]:
                                bounds[1] = wanted
                if take > 0.0:
                    most = 1e300
                else:
                    # With limited jerk, velocity and acceleration may jump at one joint: a half each.
                    most = kink(before, now, cycle, share / 2.0 if smooth else share, ways, bends, limits)
                    linked = most < 1e300 and most > 0.0
            tail = 0.0
            if linked:
                tail = reach * most * cycle + reach * facts[8 * before + 3] * cycle * cycle
            left = facts[8 * before] - trimmed - take
            start = at
            if left > 1e-12 * facts[8 * before]:
                if (tail > 0.0 or head > 0.0) and left / cycle < slow:
                    slow = left / cycle
                at = body(out, space, at, left, trimmed, slow, entry, head, tail, share, before, facts)
                entry = 1e300
            for k in range(start, at):
                move[k] = last
                shape[k] = 1 if facts[8 * before + 7] > 0.0 else 0
            if take > 0.0:
                for j in range(3):
                    if facts[8 * before + 3 + j] < bounds[2 if j < 2 else 3]:
                        bounds[4 + j] = facts[8 * before + 3 + j]
                    else:
                        bounds[4 + j] = bounds[2 if j < 2 else 3]
                emit(out, space, at, bounds[0], bounds[1], bounds[4 + 0], bounds[4 + 1], bounds[4 + 2], entry, take)
                move[at] = last
                shape[at] = form
                at += 1
            entry = most
            trimmed = take
            head = 0.0
            if linked:
                head = reach * most * cycle + reach * facts[8 * now + 3] * cycle * cycle
        has_before = True
        last = i
        halt = (flags[i] & 1) != 0 or kind[i] == 3
        tolerance = regimes[7 * regime]
        blends = tolerance > 0.0 and not flags[i] & 3
        if flags[i] & 32 and kind[i] != 3:  # parts of one move: the chords' corners are not the program's
            if tolerance < parts or not blends:
                tolerance = parts
            blends = True
        before = now
        now = 1 - now

    if has_before:
        left = facts[8 * before] - trimmed
        start = at
        if left > 1e-12 * facts[8 * before]:
            slow = facts[8 * before + 2]
            if head > 0.0 and left / cycle < slow:
                slow = left / cycle
            at = body(out, space, at, left, trimmed, slow, entry, head, 0.0, share, before, facts)
        for k in range(start, at):
            move[k] = last
            shape[k] = 1 if facts[8 * before + 7] > 0.0 else 0
    return at
