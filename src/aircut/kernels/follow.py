"""A straight move of the tool's tip as moves of a five-axis machine, written as rows of the toolpath.

The formulas are those of geometry.kinematics, and so is the proof of the number of pieces.
Lengths mm, angles degrees, speeds per minute.

facts (FACTS,): HEAD 0 (1: the tool turns, 0: the part), OUTER 1 and INNER 2 (0 X, 1 Y, 2 Z: the lines that the
axes turn about), OUTER_SIGN 3 and INNER_SIGN 4 (radians a degree), FIRST 5 to 7 (D of a table, H of a head),
ARM 8 to 10 (J - L of a head), and for the bound REACH 11, ACROSS 12 and LENGTH 13 of a head, or
ASIDE 11 and HEIGHT 12 (where D is in XY and Z) of a table.
"""

from __future__ import annotations

try:
    import cython
except ImportError:
    from aircut.kernels import nocython as cython

if cython.compiled:
    from cython.cimports.libc.math import ceil, cos, fabs, sin, sqrt
else:
    from math import ceil, cos, fabs, sin, sqrt

COMPILED = cython.compiled

FACTS = 14
STRIDE = 11  # eight-byte words of a row: six axes, two of an arc, the feed, two of integers
TINY = 1e-7  # mm: shorter linear moves count as rotary ones


@cython.cfunc
@cython.boundscheck(False)
@cython.wraparound(False)
def turn(
    about: cython.int, c: cython.double, s: cython.double, rows: cython.double[::1], at: cython.Py_ssize_t
) -> cython.double:
    """Turn the point at rows[at:at+3] right-handed about X, Y or Z."""
    u: cython.Py_ssize_t = at + (about + 1) % 3
    v: cython.Py_ssize_t = at + (about + 2) % 3
    first: cython.double = rows[u]
    second: cython.double = rows[v]
    rows[u] = c * first - s * second
    rows[v] = s * first + c * second
    return 0.0


@cython.cfunc
@cython.boundscheck(False)
@cython.wraparound(False)
def place(facts: cython.double[::1], rows: cython.double[::1], at: cython.Py_ssize_t) -> cython.double:
    """Put the linear axes, less the tool's offset, where the tip is in rows[at:at+3]; angles stand behind it."""
    outer: cython.int = int(facts[1])
    inner: cython.int = int(facts[2])
    o: cython.double = rows[at + 3 + outer] * facts[3]
    i: cython.double = rows[at + 3 + inner] * facts[4]
    k: cython.int
    if facts[0] == 0.0:
        turn(inner, cos(i), sin(i), rows, at)
        for k in range(3):
            rows[at + k] -= facts[5 + k]
        turn(outer, cos(o), sin(o), rows, at)
        for k in range(3):
            rows[at + k] += facts[5 + k]
        return 0.0
    x: cython.double = rows[at]
    y: cython.double = rows[at + 1]
    z: cython.double = rows[at + 2]
    for k in range(3):
        rows[at + k] = facts[8 + k]
    turn(inner, cos(i), sin(i), rows, at)
    for k in range(3):
        rows[at + k] += facts[5 + k]
    turn(outer, cos(o), sin(o), rows, at)
    rows[at] = x - rows[at] + (facts[5] + facts[8])
    rows[at + 1] = y - rows[at + 1] + (facts[6] + facts[9])
    rows[at + 2] = z - rows[at + 2] + (facts[7] + facts[10])
    return 0.0


@cython.cfunc
@cython.boundscheck(False)
@cython.wraparound(False)
@cython.cdivision(True)
def cut(
    facts: cython.double[::1],
    start: cython.double[::1],
    first: cython.Py_ssize_t,
    end: cython.double[::1],
    last: cython.Py_ssize_t,
    tolerance: cython.double,
) -> cython.double:
    """Into how many pieces to cut the move from start[first:first+6] to end[last:last+6]."""
    outer: cython.int = int(facts[1])
    inner: cython.int = int(facts[2])
    o: cython.double = fabs((end[last + 3 + outer] - start[first + 3 + outer]) * facts[3])
    i: cython.double = fabs((end[last + 3 + inner] - start[first + 3 + inner]) * facts[4])
    if o == 0.0 and i == 0.0:
        return 1.0
    bend: cython.double
    if facts[0] != 0.0:
        bend = o * o * facts[11] + 2.0 * o * i * facts[12] + i * i * facts[13]
    else:
        x: cython.double = start[first]
        y: cython.double = start[first + 1]
        dx: cython.double = end[last] - x
        dy: cython.double = end[last + 1] - y
        dz: cython.double = end[last + 2] - start[first + 2]
        speed: cython.double = sqrt(dx * dx + dy * dy + dz * dz)
        radius: cython.double = sqrt(x * x + y * y)
        other: cython.double = sqrt(end[last] * end[last] + end[last + 1] * end[last + 1])
        if other > radius:
            radius = other
        height: cython.double = fabs(start[first + 2] - facts[12])
        other = fabs(end[last + 2] - facts[12])
        if other > height:
            height = other
        aside: cython.double = radius + facts[11]
        bend = o * o * sqrt(aside * aside + height * height) + 2.0 * o * (i * radius + speed)
        bend += i * i * radius + 2.0 * i * speed
    count: cython.double = ceil(sqrt(bend / (8.0 * tolerance)))
    return count if count > 1.0 else 1.0


def pieces(
    facts: cython.double[::1], start: cython.double[::1], end: cython.double[::1], tolerance: cython.double
) -> cython.double:
    """Into how many pieces to cut a straight move of the tip, as kinematics.pieces."""
    return cut(facts, start, 0, end, 0, tolerance)


@cython.cfunc
@cython.boundscheck(False)
@cython.wraparound(False)
@cython.cdivision(True)
def move(
    facts: cython.double[::1],
    start: cython.double[::1],
    first: cython.Py_ssize_t,
    end: cython.double[::1],
    final: cython.Py_ssize_t,
    feed: cython.double,
    count: cython.Py_ssize_t,
    numbers: cython.longlong,
    inner: cython.longlong,
    last: cython.longlong,
    before: cython.double[::1],
    rows: cython.double[::1],
    words: cython.longlong[::1],
    at: cython.Py_ssize_t,
) -> cython.double:
    """Write the move from start[first:first+6] to end[final:final+6] as `count` rows, the first one at `at`.

    before: where X, Y and Z stand; brought up to date. The rest as `follow`.
    """
    k: cython.int
    piece: cython.Py_ssize_t
    nth: cython.double
    whole: cython.double = count
    part: cython.double
    step: cython.double
    linear: cython.double = 0.0
    rotary: cython.double = 0.0
    for k in range(6):
        step = end[final + k] - start[first + k]
        if k < 3:
            linear += step * step
        else:
            rotary += step * step
    linear = sqrt(linear)
    rotary = sqrt(rotary)
    length: cython.double
    told: cython.double = linear if linear > TINY else rotary
    for piece in range(1, count + 1):
        nth = piece
        part = nth / whole  # as floating-point numbers, compiled too
        for k in range(6):
            if piece < count:
                rows[at + k] = start[first + k] + part * (end[final + k] - start[first + k])
            else:
                rows[at + k] = end[final + k]
        place(facts, rows, at)
        length = 0.0
        for k in range(3):
            step = rows[at + k] - before[k]
            length += step * step
            before[k] = rows[at + k]
        length = sqrt(length) * whole
        if length <= TINY:
            length = rotary
        rows[at + 6] = 0.0
        rows[at + 7] = 0.0
        rows[at + 8] = feed * (length / told) if told > 0.0 and length > 0.0 else feed
        words[at + 9] = numbers
        words[at + 10] = inner if piece < count else last
        at += STRIDE
    return 0.0


@cython.boundscheck(False)
@cython.wraparound(False)
def follow(
    facts: cython.double[::1],
    start: cython.double[::1],
    end: cython.double[::1],
    feed: cython.double,
    count: cython.Py_ssize_t,
    numbers: cython.longlong,
    inner: cython.longlong,
    last: cython.longlong,
    rows: cython.double[::1],
    words: cython.longlong[::1],
) -> cython.double:
    """Write a straight move of the tip as `count` rows.

    start, end: (6,) of the tip in space. feed: of the tip, mm a minute, or degrees where it stands still; a row gets
    the speed at which its own length takes as long. numbers, inner, last: integer words of the rows: the first of
    all, the second of all but the last and of the last. rows, words: the same memory, (count + 1)·STRIDE; the moves
    begin at the second row, the first is scratch.
    """
    k: cython.int
    for k in range(6):
        rows[k] = start[k]
    place(facts, rows, 0)
    return move(facts, start, 0, end, 0, feed, count, numbers, inner, last, rows, rows, words, STRIDE)


@cython.boundscheck(False)
@cython.wraparound(False)
def share(
    facts: cython.double[::1],
    start: cython.double[::1],
    tips: cython.double[::1],
    marks: cython.longlong[::1],
    moves: cython.Py_ssize_t,
    tolerance: cython.double,
    straight: cython.longlong,
    room: cython.longlong,
    firsts: cython.longlong[::1],
) -> cython.Py_ssize_t:
    """Share rows out to moves of the tip; returns how many of the moves can be written.

    start: (6,). tips, marks: the same memory, rows that hold the tip. straight: the greatest kind of straight moves;
    the first of another kind ends the stretch, and so does one for which there is no `room`, in rows.
    firsts: (moves + 1,), the first row of each move; behind the last one, the number of all.
    """
    at: cython.Py_ssize_t = 0
    done: cython.Py_ssize_t
    count: cython.double
    total: cython.longlong = 0
    firsts[0] = 0
    for done in range(moves):
        if ((marks[at + 10] >> 32) & 255) > straight:
            return done
        count = cut(facts, tips, at - STRIDE, tips, at, tolerance) if done else cut(facts, start, 0, tips, 0, tolerance)
        if not total + count <= room:
            return done
        total += int(count)
        firsts[done + 1] = total
        at += STRIDE
    return moves


@cython.boundscheck(False)
@cython.wraparound(False)
def stretch(
    facts: cython.double[::1],
    start: cython.double[::1],
    tips: cython.double[::1],
    marks: cython.longlong[::1],
    moves: cython.Py_ssize_t,
    firsts: cython.longlong[::1],
    every: cython.longlong,
    inner: cython.longlong,
    never: cython.longlong,
    before: cython.double[::1],
    rows: cython.double[::1],
    words: cython.longlong[::1],
) -> cython.double:
    """Write straight moves of the tip, rows shared out by `share`, as `follow` does one.

    every: bits to set in the second integer of all rows; inner, never: bits to set and to clear in those of all rows
    but the last of a move. before: (6,), scratch. rows, words: the same memory, for the rows shared out.
    """
    at: cython.Py_ssize_t = 0
    nth: cython.Py_ssize_t
    count: cython.Py_ssize_t
    last: cython.longlong
    others: cython.longlong
    k: cython.int
    for k in range(6):
        before[k] = start[k]
    place(facts, before, 0)
    for nth in range(moves):
        last = marks[at + 10] | every
        others = (last & ~never) | inner
        count = firsts[nth + 1] - firsts[nth]
        if nth:
            move(
                facts, tips, at - STRIDE, tips, at, tips[at + 8], count, marks[at + 9], others, last, before,
                rows, words, STRIDE * firsts[nth],
            )  # fmt: skip
        else:
            move(facts, start, 0, tips, 0, tips[8], count, marks[9], others, last, before, rows, words, 0)
        at += STRIDE
    return 0.0
