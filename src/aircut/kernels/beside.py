"""The way of a tool beside a contour: rows of the toolpath led to the side by the tool's radius.

What the stage of interpreter.compensation does with the moves that follow one it holds back, by the
formulas of geometry.offsetting in their order, to the last bit. It stops before the first
move that asks for more: one without motion in the plane, a corner that almost turns back, a gouge, a limit.
Lengths mm, angles radians.

facts (FACTS,): LEFT 0 (how far to the left), STRAIGHT 1 (a smaller change of direction is no corner), SHIFT 2 and 3
(from the tool's center to its control point, u and v), BOX 4 to 15 (lowest and highest X, then Y to C).
held (HELD,): of the move held back the START 0, END 2 and CENTER 4 of its contour and its TURNS 6 (0: a line),
PATH 7 (where its way begins), GUIDE 9 and 11 (its whole way), PLACE 13 to 18 (its end, six axes). In the plane u and v.
"""

from __future__ import annotations

try:
    import cython
except ImportError:
    from aircut.kernels import nocython as cython

if cython.compiled:
    from cython.cimports.libc.math import atan2, fabs, fmod, sqrt
else:
    from math import atan2, fabs, fmod, sqrt

COMPILED = cython.compiled

FACTS, HELD = 17, 19
WIDTH = 11  # eight-byte words of a row: six axes, two of an arc, the feed, two of integers
#: Bits of a row's integers: line and tool; turns, file, kind, plane, flags.
LINE, TURNS = 0xFFFFFFFF, 0xFFFF
KIND = 32
TRAVERSE, ARC = 0, 2
TAU = 6.283185307179586
PI = 3.141592653589793
BACK = 0.06  # radians from a half turn: nearer ones are not for here
STILL = 1e-9  # mm: shorter steps in the plane are none
PARALLEL = 1e-12
TOUCH = 1e-9
FULL_CIRCLE = 1e-6


@cython.cfunc
def distance(au: cython.double, av: cython.double, bu: cython.double, bv: cython.double) -> cython.double:
    return sqrt((bu - au) * (bu - au) + (bv - av) * (bv - av))


@cython.cfunc
@cython.boundscheck(False)
@cython.wraparound(False)
@cython.cdivision(True)
def heading(
    e: cython.double[::1], at: cython.Py_ssize_t, pu: cython.double, pv: cython.double, w: cython.double[::1]
) -> cython.double:
    """Direction of travel at a point of the element e[at:at+7], in w[0:2]; returns how long it was before."""
    du: cython.double
    dv: cython.double
    turns: cython.double = e[at + 6]
    if turns == 0.0:
        du = e[at + 2] - e[at]
        dv = e[at + 3] - e[at + 1]
    else:
        sign: cython.double = 1.0 if turns > 0.0 else -1.0
        du = sign * (e[at + 5] - pv)
        dv = sign * (pu - e[at + 4])
    length: cython.double = sqrt(du * du + dv * dv)
    if length == 0.0:
        return 0.0
    w[0] = du / length
    w[1] = dv / length
    return length


@cython.cfunc
def sweep(
    su: cython.double,
    sv: cython.double,
    eu: cython.double,
    ev: cython.double,
    cu: cython.double,
    cv: cython.double,
    turns: cython.double,
) -> cython.double:
    """As geometry.arcs.sweep."""
    angle: cython.double = atan2(ev - cv, eu - cu) - atan2(sv - cv, su - cu)
    if turns > 0.0:
        angle = fmod(angle, TAU)
        if angle < 0.0:
            angle += TAU
        if angle < FULL_CIRCLE:
            angle += TAU
        return angle + TAU * (turns - 1.0)
    angle = fmod(-angle, TAU)
    if angle < 0.0:
        angle += TAU
    angle = -angle
    if angle > -FULL_CIRCLE:
        angle -= TAU
    return angle + TAU * (turns + 1.0)


@cython.cfunc
@cython.boundscheck(False)
@cython.wraparound(False)
def pair(
    ou: cython.double,
    ov: cython.double,
    du: cython.double,
    dv: cython.double,
    along: cython.double,
    square: cython.double,
    radius: cython.double,
    w: cython.double[::1],
) -> cython.int:
    """The points at along ± the root of square from an origin, in w[0:4]; returns how many."""
    if square < -TOUCH * (radius * radius):
        return 0
    half: cython.double = sqrt(square if square > 0.0 else 0.0)
    t: cython.double = along - half
    w[0] = ou + t * du
    w[1] = ov + t * dv
    t = along + half
    w[2] = ou + t * du
    w[3] = ov + t * dv
    return 2


@cython.cfunc
@cython.boundscheck(False)
@cython.wraparound(False)
def line_circle(
    e: cython.double[::1],
    at: cython.Py_ssize_t,
    cu: cython.double,
    cv: cython.double,
    radius: cython.double,
    su: cython.double,
    sv: cython.double,
    w: cython.double[::1],
) -> cython.int:
    """Where the line e[at:at+7], shifted, meets a circle, in w[0:4]; returns in how many points."""
    if heading(e, at, 0.0, 0.0, w) == 0.0:
        return 0
    hu: cython.double = w[0]
    hv: cython.double = w[1]
    u: cython.double = e[at] + su
    v: cython.double = e[at + 1] + sv
    du: cython.double = cu - u
    dv: cython.double = cv - v
    along: cython.double = du * hu + dv * hv
    across: cython.double = dv * hu - du * hv
    return pair(u, v, hu, hv, along, radius * radius - across * across, radius, w)


@cython.cfunc
@cython.boundscheck(False)
@cython.wraparound(False)
@cython.cdivision(True)
def crossings(e: cython.double[::1], w: cython.double[::1]) -> cython.int:
    """Where the whole lines or circles of the elements e[0:7] and e[7:14] meet, in w[0:4]; returns how many points."""
    first: cython.double = e[6]
    second: cython.double = e[13]
    du: cython.double
    dv: cython.double
    along: cython.double
    if first == 0.0 and second == 0.0:
        if heading(e, 0, 0.0, 0.0, w) == 0.0:
            return 0
        au: cython.double = w[0]
        av: cython.double = w[1]
        if heading(e, 7, 0.0, 0.0, w) == 0.0:
            return 0
        bu: cython.double = w[0]
        bv: cython.double = w[1]
        sine: cython.double = au * bv - av * bu
        if fabs(sine) < PARALLEL:
            return 0
        du = e[7] - e[2]
        dv = e[8] - e[3]
        along = (du * bv - dv * bu) / sine
        w[0] = e[2] + along * au
        w[1] = e[3] + along * av
        return 1
    if first == 0.0:  # the line is led to the radius of the arc's end
        start: cython.double = distance(e[7], e[8], e[11], e[12])
        end: cython.double = distance(e[9], e[10], e[11], e[12])
        share: cython.double = (end - start) / start
        return line_circle(e, 0, e[11], e[12], end, (e[7] - e[11]) * share, (e[8] - e[12]) * share, w)
    radius: cython.double = distance(e[2], e[3], e[4], e[5])
    if second == 0.0:
        return line_circle(e, 7, e[4], e[5], radius, 0.0, 0.0, w)
    other: cython.double = distance(e[9], e[10], e[11], e[12])
    du = e[11] - e[4]
    dv = e[12] - e[5]
    apart: cython.double = sqrt(du * du + dv * dv)
    if apart < TOUCH * radius:
        return 0
    along = (apart * apart + radius * radius - other * other) / (2.0 * apart)
    return pair(
        e[4] + along * du / apart, e[5] + along * dv / apart, -dv / apart, du / apart, 0.0,
        radius * radius - along * along, radius, w,
    )  # fmt: skip


@cython.cfunc
@cython.boundscheck(False)
@cython.wraparound(False)
def spoils(
    facts: cython.double[::1], held: cython.double[::1], eu: cython.double, ev: cython.double, w: cython.double[::1]
) -> cython.bint:
    """Whether the held move must not end here: a line would go backwards, an arc be longer than before."""
    if held[6] == 0.0:
        heading(held, 0, 0.0, 0.0, w)
        return (eu - held[7]) * w[0] + (ev - held[8]) * w[1] < -STILL
    meant: cython.double = fabs(sweep(held[9], held[10], held[11], held[12], held[4], held[5], held[6]))
    return fabs(sweep(held[7], held[8], eu, ev, held[4], held[5], held[6])) - meant > facts[16]


@cython.cfunc
@cython.boundscheck(False)
@cython.wraparound(False)
def within(
    facts: cython.double[::1],
    place: cython.double[::1],
    at: cython.Py_ssize_t,
    u: cython.Py_ssize_t,
    v: cython.Py_ssize_t,
    eu: cython.double,
    ev: cython.double,
    cu: cython.double,
    cv: cython.double,
    turns: cython.double,
) -> cython.bint:
    """Whether a move that ends here (u, v, with the other axes of place[at:at+6]) stays within the box."""
    i: cython.Py_ssize_t
    low: cython.double
    high: cython.double
    value: cython.double
    reach: cython.double = 0.0
    mu: cython.double = eu
    mv: cython.double = ev
    if turns != 0.0:
        reach = distance(eu, ev, cu, cv)
        mu = cu
        mv = cv
    for i in range(6):
        low = facts[4 + 2 * i]
        high = facts[5 + 2 * i]
        if i == u:
            value = mu + facts[2]
        elif i == v:
            value = mv + facts[3]
        else:
            if not (low <= place[at + i] <= high):
                return False
            continue
        if not (low <= value - reach and value + reach <= high):
            return False
    return True


@cython.cfunc
@cython.boundscheck(False)
@cython.wraparound(False)
def turned_within(facts: cython.double[::1], place: cython.double[::1], at: cython.Py_ssize_t) -> cython.bint:
    """Whether the rotary axes of place[at:at+6] are within the box."""
    return (
        facts[10] <= place[at + 3] <= facts[11]
        and facts[12] <= place[at + 4] <= facts[13]
        and facts[14] <= place[at + 5] <= facts[15]
    )


@cython.cfunc
@cython.boundscheck(False)
@cython.wraparound(False)
def parallel(facts: cython.double[::1], e: cython.double[::1], w: cython.double[::1]) -> cython.bint:
    """The way beside the element e[14:21], in e[7:14]; False where there is none."""
    left: cython.double = facts[0]
    turns: cython.double = e[20]
    if turns != 0.0:
        sign: cython.double = 1.0 if turns > 0.0 else -1.0
        if distance(e[14], e[15], e[18], e[19]) - sign * left <= 0.0:
            return False
    if heading(e, 14, e[16], e[17], w) == 0.0:
        return False
    e[9] = e[16] - left * w[1]
    e[10] = e[17] + left * w[0]
    if turns != 0.0 and heading(e, 14, e[14], e[15], w) == 0.0:
        return False
    e[7] = e[14] - left * w[1]
    e[8] = e[15] + left * w[0]
    e[11] = e[18]
    e[12] = e[19]
    e[13] = turns
    return True


@cython.cfunc
@cython.boundscheck(False)
@cython.wraparound(False)
def cut_back(side: cython.double, loose: cython.bint, e: cython.double[::1], w: cython.double[::1]) -> cython.bint:
    """Where the ways e[0:7] and e[7:14] meet inside their corner, in w[0:2]; False where nowhere."""
    count: cython.int = crossings(e, w)
    if count == 0:
        return False
    if count == 1:
        return True
    later: cython.bint
    first: cython.double = e[6] * side
    second: cython.double = e[13] * side
    if not loose:
        later = distance(w[2], w[3], e[2], e[3]) < distance(w[0], w[1], e[2], e[3])
    elif e[6] == 0.0 or e[13] == 0.0:
        later = (first > 0.0 or second > 0.0) == (e[6] == 0.0)
    else:
        later = e[6] * e[13] * side > 0.0
    if later:
        w[0] = w[2]
        w[1] = w[3]
    return True


@cython.boundscheck(False)
@cython.wraparound(False)
@cython.cdivision(True)
def lead(
    facts: cython.double[::1],
    held: cython.double[::1],
    u: cython.Py_ssize_t,
    v: cython.Py_ssize_t,
    loose: cython.bint,
    contour: cython.double[::1],
    words: cython.longlong[::1],
    moves: cython.Py_ssize_t,
    rows: cython.double[::1],
    marks: cython.longlong[::1],
    firsts: cython.longlong[::1],
    end: cython.double[::1],
    e: cython.double[::1],
    w: cython.double[::1],
):
    """Lead the tool along rows of a contour; returns how many of them were taken.

    u, v: axes of the plane. loose: the rules of LinuxCNC's interpreter, where rows have the line of the move that
    released them. contour, words: rows as programmed, and their integers. rows, marks: space for two rows a move, what
    is written, and its integers; the first held move is not among it, but its end is in `end` (2,). firsts, of shape
    (moves + 1,): of each row of the contour the first row written behind the move before it, at last how many there
    are. held: then is the last move taken. e (21,), w (4,): to work with.
    """
    r: cython.Py_ssize_t
    i: cython.Py_ssize_t
    k: cython.Py_ssize_t
    at: cython.Py_ssize_t
    kind: cython.longlong
    word: cython.longlong
    turns: cython.longlong
    count: cython.Py_ssize_t = 0
    taken: cython.Py_ssize_t = 0
    eu: cython.double
    ev: cython.double
    au: cython.double
    av: cython.double
    gu: cython.double
    gv: cython.double
    angle: cython.double
    corner: cython.bint
    round_turns: cython.double
    side: cython.double = 1.0 if facts[0] > 0.0 else -1.0
    for r in range(moves):
        at = WIDTH * r
        word = words[at + 10]
        kind = (word >> KIND) & 0xFF
        turns = word & TURNS
        if turns >= 0x8000:
            turns -= 0x10000
        e[14] = held[2]
        e[15] = held[3]
        e[16] = contour[at + u]
        e[17] = contour[at + v]
        e[18] = contour[at + 6]
        e[19] = contour[at + 7]
        e[20] = float(turns) if kind == ARC else 0.0
        if e[20] == 0.0 and distance(e[14], e[15], e[16], e[17]) < STILL:
            break
        if not parallel(facts, e, w):
            break
        gu = e[7]
        gv = e[8]
        if heading(held, 0, held[2], held[3], w) == 0.0:
            break
        au = w[0]
        av = w[1]
        if heading(e, 14, e[14], e[15], w) == 0.0:
            break
        angle = side * atan2(au * w[1] - av * w[0], au * w[0] + av * w[1])
        if fabs(angle) > PI - BACK:
            break
        corner = False
        if angle > facts[1]:
            for i in range(4):
                e[i] = held[9 + i]
            e[4] = held[4]
            e[5] = held[5]
            e[6] = held[6]
            if not cut_back(side, loose, e, w):
                break
            eu = w[0]
            ev = w[1]
            if spoils(facts, held, eu, ev, w):
                break
            e[7] = eu
            e[8] = ev
        else:
            eu = held[11]
            ev = held[12]
            if not (loose and (e[20] != 0.0 or angle >= -facts[1])) and spoils(facts, held, eu, ev, w):
                break
            if angle < -facts[1]:
                corner = True
                round_turns = 0.0 if kind == TRAVERSE else -side
                if not within(facts, held, 13, u, v, e[7], e[8], e[14], e[15], round_turns):
                    break
                if loose and not turned_within(facts, contour, at):
                    break
            else:
                e[7] = eu
                e[8] = ev
        if not within(facts, held, 13, u, v, eu, ev, held[4], held[5], held[6]):
            break
        # --- the move held back ends here
        if r == 0:
            end[0] = eu
            end[1] = ev
        else:
            i = WIDTH * count
            at -= WIDTH
            for k in range(9):
                rows[i + k] = contour[at + k]
            marks[i + 9] = words[at + 9]
            marks[i + 10] = words[at + 10]
            at += WIDTH
            if loose:
                marks[i + 9] = (marks[i + 9] & ~LINE) | (words[at + 9] & LINE)
            rows[i + u] = eu + facts[2]
            rows[i + v] = ev + facts[3]
            if held[6] != 0.0:
                rows[i + 6] += facts[2]
                rows[i + 7] += facts[3]
            count += 1
        firsts[r] = count
        if corner:
            i = WIDTH * count
            for k in range(6):  # in LinuxCNC's language rotary axes turn on the way around the corner already
                rows[i + k] = contour[at + k] if loose and k > 2 else held[13 + k]
            rows[i + u] = e[7] + facts[2]
            rows[i + v] = e[8] + facts[3]
            rows[i + 6] = rows[i + 7] = 0.0
            rows[i + 8] = contour[at + 8]
            marks[i + 9] = words[at + 9]
            word &= ~(TURNS | (0xFF << KIND))
            if kind == TRAVERSE:
                word |= TRAVERSE << KIND
            else:
                rows[i + 6] = e[14] + facts[2]
                rows[i + 7] = e[15] + facts[3]
                word |= (ARC << KIND) | (TURNS if side > 0.0 else 1)
            marks[i + 10] = word
            count += 1
        for i in range(7):
            held[i] = e[14 + i]
        held[7] = e[7]
        held[8] = e[8]
        held[9] = gu
        held[10] = gv
        held[11] = e[9]
        held[12] = e[10]
        for i in range(6):
            held[13 + i] = contour[at + i]
        taken = r + 1
    firsts[taken] = count
    return taken
