"""Plain motion: stretches of lines of nothing but G0 to G3, axis words, arc centers and feeds.

`run` goes through such lines from bytes to packed rows of the toolpath, and stops
before the first that asks for anything else: another word, a mode that is not held
here, anything doubtful. That line is the general lane's, whose meaning this follows
to the last bit.
"""

from __future__ import annotations

from math import fabs, sqrt

try:
    import cython
    from cython.cimports.libc.math import fabs, sqrt
except ImportError:
    from aircut.kernels import nocython as cython

COMPILED = cython.compiled

# Places in `numbers`: in and out.
LINE, ROWS, FEEDS, MOTION = 0, 1, 2, 3
# In only.
ABSOLUTE, ARC_ABSOLUTE, PLANE, FLAGS, TOOL, FILE, AXES, RADIUS, ALONE, LONGEST = 4, 5, 6, 7, 8, 9, 10, 11, 12, 13
PLACE = 14  # in and out: the byte at which the line starts
BARE = 15  # in only: axis words alone may stand
NUMBERS = 16
SETS, STAYS = 1, 2  # of ALONE
# Places in `reals`: position, offset, low and high limits and shift are six each.
POSITION, OFFSET, LOW, HIGH, UNIT, FEED, SAID, LEAST, ZERO, SHIFT = 0, 6, 12, 18, 24, 25, 26, 27, 28, 29
REALS = 35

# By byte: 0-5 the axes, 6-8 I J K, 9 R, 10 F, 11 G, 12 N; 31 for all that ends a stretch.
PLACES = bytes("xyzabcijkrfgn".find(chr(byte).lower()) & 31 if byte < 128 else 31 for byte in range(256))
WIDTH = 11  # 8-byte places of a row
FAR = 1e9  # as the general lane's
MISMATCH = 0.0253  # mm: arcs whose radii differ by more are the general lane's
SMALL = 1e-3  # mm: so are those of radii below LEAST, which is at least this
LARGE = 1e8  # mm: and of larger ones
SLACK = 1e-6  # part by which half the chord stays below an R at least
DIGITS = 15


@cython.boundscheck(False)
@cython.wraparound(False)
@cython.cdivision(True)
def run(
    data: cython.const[cython.uchar][::1],
    last: cython.Py_ssize_t,
    numbers: cython.longlong[::1],
    reals: cython.double[::1],
    rows: cython.double[::1],
    marks: cython.longlong[::1],
    feeds: cython.double[::1],
    feed_places: cython.longlong[::1],
    powers: cython.double[::1],
    places: cython.const[cython.uchar][::1],
):
    """Run lines from numbers[LINE] up to `last`, and write what comes of them. Each must end with a line feed.

    data: the program. numbers, reals: the modes and
    positions (see the places above), brought up to date for where it stops. AXES: letters
    that may stand, by bits. RADIUS: whether R may. ALONE: what G0 and G1 do that stand alone: 0 nothing
    that is known here, SETS the mode, STAYS: a move to where it is.
    LONGEST: bytes of a line, 0 without a limit. FEED: mm/min; SAID: the F word, as written.
    SHIFT, OFFSET: what is added to a place, in this order. ZERO: what absolute words are added to, 0 or -0.
    rows, marks: the same memory, as doubles and as integers: the packed rows; no more
    are written than there is room for. feeds, feed_places: the F words met, mm/min, each
    with its row and line; no more lines than there is room for. powers: scan.POWERS. places: PLACES.
    Lengths mm, angles degrees.
    """
    line: cython.Py_ssize_t = numbers[LINE]
    start: cython.Py_ssize_t = numbers[PLACE]
    at: cython.Py_ssize_t
    row: cython.Py_ssize_t = 0
    room: cython.Py_ssize_t = len(rows) // WIDTH
    told: cython.Py_ssize_t = 0
    tellable: cython.Py_ssize_t = len(feeds)
    base: cython.Py_ssize_t
    motion: cython.int = numbers[MOTION]
    absolute: cython.bint = numbers[ABSOLUTE]
    arc_absolute: cython.bint = numbers[ARC_ABSOLUTE]
    plane: cython.int = numbers[PLANE]
    axes: cython.int = numbers[AXES]
    by_radius: cython.bint = numbers[RADIUS]
    alone: cython.int = numbers[ALONE]
    moves: cython.int
    stays: cython.int = STAYS
    tool: cython.longlong = numbers[TOOL] << 32
    tail: cython.longlong = (numbers[FILE] << 16) | (numbers[PLANE] << 40) | (numbers[FLAGS] << 48)
    width: cython.Py_ssize_t = WIDTH
    far: cython.double = FAR
    mismatch: cython.double = MISMATCH
    small: cython.double = reals[LEAST]
    large: cython.double = LARGE
    slack: cython.double = 1.0 - SLACK
    most: cython.int = DIGITS
    unit: cython.double = reals[UNIT]
    feed: cython.double = reals[FEED]
    said: cython.double = reals[SAID]
    zero: cython.double = reals[ZERO]
    longest: cython.Py_ssize_t = numbers[LONGEST]
    barred: cython.uint = 0x0FC0 if numbers[BARE] else 0
    first: cython.int
    second: cython.int
    c: cython.int
    code: cython.int
    axis: cython.int
    i: cython.int
    digits: cython.Py_ssize_t
    begin: cython.Py_ssize_t
    decimals: cython.Py_ssize_t
    seen: cython.uint
    bit: cython.uint
    negative: cython.bint
    fine: cython.bint
    mantissa: cython.longlong
    number: cython.double
    word: cython.double[18]
    goal: cython.double[6]
    here: cython.double[6]
    offset: cython.double[6]
    shift: cython.double[6]
    low: cython.double[6]
    high: cython.double[6]
    place: cython.double
    u: cython.double
    v: cython.double
    radius: cython.double
    other: cython.double
    half: cython.double
    rise: cython.double
    way_u: cython.double
    way_v: cython.double
    kind: cython.longlong
    if not cython.compiled:
        word, goal, here, low, high = [0.0] * 18, [0.0] * 6, [0.0] * 6, [0.0] * 6, [0.0] * 6
        offset, shift = [0.0] * 6, [0.0] * 6

    first = 0
    second = 1
    if plane == 1:
        first = 2
        second = 0
    elif plane == 2:
        first = 1
        second = 2
    for i in range(6):
        here[i] = reals[POSITION + i]
        offset[i] = reals[OFFSET + i]
        shift[i] = reals[SHIFT + i]
        low[i] = reals[LOW + i]
        high[i] = reals[HIGH + i]

    while line < last and row < room and told < tellable:
        at = start
        seen = 0  # bits: 0-5 the axes, 6-8 I J K, 9 R, 10 F, 11 G, 12 N, 13 anything at all
        code = motion
        fine = True
        while True:
            c = data[at]
            if c == 10:
                break
            if c == 32 or c == 9 or c == 13:
                at += 1
                continue
            if c == 59:  # ; comments out the rest
                break
            axis = places[c]
            bit = 1 << axis
            if axis == 31 or seen & bit or (axis == 12 and seen):
                fine = False
                break
            seen |= bit
            at += 1

            mantissa = 0
            c = data[at]
            negative = c == 45
            if negative or c == 43:
                at += 1
                c = data[at]
            begin = at
            decimals = 0
            while c >= 48 and c <= 57:
                mantissa = mantissa * 10 + (c - 48)
                at += 1
                c = data[at]
            digits = at - begin
            if c == 46:
                at += 1
                begin = at
                c = data[at]
                while c >= 48 and c <= 57:
                    mantissa = mantissa * 10 + (c - 48)
                    at += 1
                    c = data[at]
                decimals = at - begin
                digits += decimals
            if digits == 0 or digits > most:
                fine = False
                break
            while c == 32 or c == 9 or c == 13:
                at += 1
                c = data[at]
            if c < 59 and c != 10:  # a number goes on behind a blank, or something else
                fine = False
                break
            if axis < 11:
                number = mantissa / powers[decimals]
                word[axis] = -number if negative else number
            elif axis == 12:
                if negative or decimals > 0 or data[begin - 1] == 46 or data[begin - 1] == 43:
                    fine = False
                    break
            else:
                if negative or decimals > 0 or mantissa > 3:
                    fine = False
                    break
                code = mantissa
        if not fine:
            break
        while data[at] != 10:
            at += 1
        if longest > 0 and at - start > longest:
            break
        if seen & 0x0FFF == 0:  # blank, or a number alone
            line += 1
            start = at + 1
            continue

        # What stands here must be a whole move, or a feed.
        if seen & 0x3F & ~axes or seen & barred:
            break
        if seen & 0x3F == 0 and (seen & 0x3C0 or (seen & 2048 and (code > 1 or not alone))):
            break
        if seen & 1024 and not (word[10] > 0.0 and word[10] <= far):
            break
        moves = seen & 0x3F or (seen & 2048 and alone == stays)
        if moves:
            if code < 0:
                break
            for i in range(6 if seen & 0x38 else 3):
                if seen & (1 << i):
                    place = word[i] * unit if i < 3 else word[i]
                    goal[i] = place + (zero if absolute else here[i])
                    if goal[i] > far or goal[i] < -far:
                        fine = False
                    place = goal[i] + shift[i] + offset[i]
                    if place < low[i] or place > high[i]:
                        fine = False
                else:
                    goal[i] = here[i]
            number = word[10] * unit if seen & 1024 else feed
            if not fine or (code > 0 and not number > 0.0):
                break
            base = row * width
            if code < 2:
                if seen & 0x3C0:
                    break
                u = 0.0
                v = 0.0
            else:
                if seen & 0x200:
                    if seen & 0x1C0 or not by_radius or not seen & ((1 << first) | (1 << second)):
                        break
                    way_u = goal[first] - here[first]
                    way_v = goal[second] - here[second]
                    half = sqrt(way_u * way_u + way_v * way_v) / 2
                    radius = word[9] * unit
                    if half < small or fabs(radius) > large or half > fabs(radius) * slack:
                        break
                    rise = sqrt(radius * radius - half * half)
                    if (radius > 0.0) != (code == 3):
                        rise = -rise
                    u = (here[first] + goal[first]) / 2 - rise * (way_v / (2 * half))
                    v = (here[second] + goal[second]) / 2 + rise * (way_u / (2 * half))
                else:
                    bit = (64 << first) | (64 << second)
                    if not seen & bit or seen & 0x1C0 & ~bit:
                        break
                    if arc_absolute:
                        if seen & bit != bit:
                            break
                        u = word[6 + first] * unit
                        v = word[6 + second] * unit
                    else:
                        u = here[first] + (word[6 + first] if seen & (64 << first) else 0.0) * unit
                        v = here[second] + (word[6 + second] if seen & (64 << second) else 0.0) * unit
                    way_u = here[first] - u
                    way_v = here[second] - v
                    radius = sqrt(way_u * way_u + way_v * way_v)
                    way_u = goal[first] - u
                    way_v = goal[second] - v
                    other = sqrt(way_u * way_u + way_v * way_v)
                    if radius < small or radius > large or fabs(radius - other) > mismatch:
                        break
                    radius = radius if radius > other else other
                radius = fabs(radius)
                u = u + shift[first] + offset[first]
                v = v + shift[second] + offset[second]
                # The whole circle must be within the limits; else the general lane looks closer.
                if u - radius < low[first] or u + radius > high[first]:
                    break
                if v - radius < low[second] or v + radius > high[second]:
                    break
            for i in range(3):
                here[i] = goal[i]
                rows[base + i] = goal[i] + shift[i] + offset[i]
            if seen & 0x38:
                for i in range(3, 6):
                    here[i] = goal[i]
            for i in range(3, 6):
                rows[base + i] = here[i] + shift[i] + offset[i]
            rows[base + 6] = u
            rows[base + 7] = v
            rows[base + 8] = number if code else 0.0
            marks[base + 9] = (line + 1) | tool
            kind = code
            if code == 2:  # clockwise: turns are -1
                kind = (kind << 32) | 65535
            elif code == 3:
                kind = ((kind - 1) << 32) | 1
            else:
                kind <<= 32
            marks[base + 10] = tail | kind
            if seen & 1024:
                feed = number
                said = word[10]
                feeds[told] = number
                feed_places[2 * told] = row
                feed_places[2 * told + 1] = line + 1
                told += 1
            row += 1
        elif seen & 1024:  # F without a move
            said = word[10]
            feed = said * unit
            feeds[told] = feed
            feed_places[2 * told] = row
            feed_places[2 * told + 1] = line + 1
            told += 1
        motion = code
        line += 1
        start = at + 1

    numbers[LINE] = line
    numbers[PLACE] = start
    numbers[ROWS] = row
    numbers[FEEDS] = told
    numbers[MOTION] = motion
    for i in range(6):
        reals[POSITION + i] = here[i]
    reals[FEED] = feed
    reals[SAID] = said
