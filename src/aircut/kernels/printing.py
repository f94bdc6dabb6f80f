"""Rows of the toolpath as lines of the canonical listing.

`moves` writes lines into a buffer until a row asks for what it does not know: tool center
point control, another file, a number too large or too fine. Numbers have four decimals and are
those that C's printf writes: rounded from the exact value, halves to even.
"""

from __future__ import annotations

from math import copysign

try:
    import cython
    from cython.cimports.libc.math import copysign
except ImportError:
    from aircut.kernels import nocython as cython

COMPILED = cython.compiled

WIDTH = 11  # 8-byte places of a row
LINE = 400  # bytes of a line at most
BLOCK = 1024  # bytes of a text of which the line feeds are counted together, as in `scan`
LABEL = 64  # digits of a line's number at most
LIMIT = 1e15  # numbers from here on are not the kernel's
PARTS = 2.0**53  # of a fraction: times 625 they fit into 63 bits, and are then 1 / 2**49 of 0.0001 each
MASK, HALF = 2**49 - 1, 2**48
#: Heads of the lines by kind; each has 20 bytes, the last of them its length.
HEADS = b"".join(
    name.ljust(19) + bytes((len(name),))
    for name in (b"STRAIGHT_TRAVERSE(", b"STRAIGHT_FEED(", b"ARC_FEED(", b"STRAIGHT_PROBE(", b"SET_FEED_RATE(")
)
HEAD = 20
PAIRS = b"".join(b"%02d" % number for number in range(100))

# Flags of a row.
TIP, UNLISTED = 16, 8 | 32 | 64
# Places in `numbers`, in and out: row to go on with, bytes written, lines counted; in only: file, rows.
ROW, USED, COUNT, FILE, ROWS = 0, 1, 2, 3, 4
# In and out: feed to go on with; in only: the index of row 0 as feeds count them.
TOLD, FIRST = 5, 6
NUMBERS = 7
# Places in `reals`: offset of the six axes, mm a unit, center, cosine and sine of the rotation.
OFFSET, UNIT, CENTER, COSINE, SINE, TURNED = 0, 6, 7, 9, 10, 11
REALS = 12


@cython.boundscheck(False)
@cython.wraparound(False)
@cython.cdivision(True)
def moves(
    rows: cython.const[cython.double][::1],
    marks: cython.const[cython.longlong][::1],
    data: cython.const[cython.uchar][::1],
    counts: cython.const[cython.longlong][::1],
    numbers: cython.longlong[::1],
    reals: cython.double[::1],
    feed_at: cython.const[cython.longlong][::1],
    feed_lines: cython.const[cython.int][::1],
    feed_files: cython.const[cython.ushort][::1],
    feeds: cython.const[cython.double][::1],
    out: cython.uchar[::1],
    heads: cython.const[cython.uchar][::1],
    pairs: cython.const[cython.uchar][::1],
):
    """Write rows from numbers[ROW] up to numbers[ROWS], and feeds, as long as there is room for a line in `out`.

    rows, marks: the same memory, as doubles and as integers: packed rows. data, counts: the text of
    file numbers[FILE], and the line feeds before each of its blocks; no text where no line has a
    number. reals: see the places above; TURNED is 0.0 where
    there is no rotation. feed_at, feed_lines, feed_files, feeds: of each feed the row before which it comes, by its
    index in the run, its line and file, and the feed, mm/min. heads, pairs: HEADS and PAIRS.
    """
    row: cython.Py_ssize_t = numbers[ROW]
    last: cython.Py_ssize_t = numbers[ROWS]
    at: cython.Py_ssize_t = numbers[USED]
    count: cython.longlong = numbers[COUNT]
    file: cython.longlong = numbers[FILE]
    room: cython.Py_ssize_t = len(out) - LINE
    size: cython.Py_ssize_t = len(data)
    blocks: cython.Py_ssize_t = len(counts) - 1
    length: cython.Py_ssize_t = BLOCK
    near: cython.Py_ssize_t = 64
    known: cython.longlong = -1  # a line of which the start is known
    known_at: cython.Py_ssize_t = 0
    high: cython.Py_ssize_t
    middle: cython.Py_ssize_t
    width: cython.Py_ssize_t = WIDTH
    limit: cython.double = LIMIT
    most: cython.Py_ssize_t = LABEL
    unlisted: cython.longlong = UNLISTED
    tip: cython.longlong = TIP
    head: cython.Py_ssize_t = HEAD
    unit: cython.double = reals[UNIT]
    turned: cython.bint = reals[TURNED] != 0.0
    center_x: cython.double = reals[CENTER]
    center_y: cython.double = reals[CENTER + 1]
    cosine: cython.double = reals[COSINE]
    sine: cython.double = reals[SINE]
    base: cython.Py_ssize_t = 0
    begin: cython.Py_ssize_t
    told: cython.Py_ssize_t = numbers[TOLD]
    tellable: cython.Py_ssize_t = len(feeds)
    before: cython.longlong = numbers[FIRST]
    telling: cython.bint
    place: cython.Py_ssize_t
    end: cython.Py_ssize_t
    i: cython.int
    first: cython.int
    second: cython.int
    third: cython.int
    amount: cython.int
    kind: cython.int
    plane: cython.int = 0
    turns: cython.int
    fine: cython.bint
    mark: cython.longlong
    tail: cython.longlong = 0
    line: cython.longlong
    number: cython.longlong
    whole: cython.longlong
    scaled: cython.longlong
    four: cython.longlong
    rest: cython.longlong
    half: cython.longlong = HALF
    mask: cython.longlong = MASK
    parts: cython.double = PARTS
    u: cython.double
    v: cython.double
    value: cython.double
    fraction: cython.double
    offset: cython.double[6]
    values: cython.double[9]
    if not cython.compiled:
        offset, values = [0.0] * 6, [0.0] * 9
    for i in range(6):
        offset[i] = reals[OFFSET + i]

    while at <= room:
        telling = told < tellable and (feed_at[told] - before <= row or row >= last)
        if telling:
            line = feed_lines[told]
            if line and feed_files[told] != file:
                break
            kind = 4
        else:
            if row >= last:
                break
            base = row * width
            tail = marks[base + 10]
            mark = tail >> 48 & 0xFFFF
            if mark & unlisted:
                row += 1
                continue
            line = marks[base + 9] & 0xFFFFFFFF
            if mark & tip or (line and (tail >> 16 & 0xFFFF) != file):
                break
            kind = tail >> 32 & 0xFF
            plane = tail >> 40 & 0xFF
        begin = at

        # The count, in five places or more.
        count += 1
        number = count
        end = at + 5
        while number >= 100000:
            end += 1
            number //= 10
        number = count
        place = end
        while number >= 10:
            rest = number // 100
            number -= rest * 100
            place -= 2
            out[place] = pairs[2 * number]
            out[place + 1] = pairs[2 * number + 1]
            number = rest
        if number:
            place -= 1
            out[place] = 48 + number
        while place > at:
            place -= 1
            out[place] = 32
        at = end
        out[at] = 32
        at += 1

        # The line's own number.
        fine = False
        if line and size:
            line -= 1
            if known < 0 or line < known or line - known > near:
                end = 0  # the last block with fewer line feeds before it than lie before the line
                high = blocks
                while high - end > 1:
                    middle = (end + high) // 2
                    if counts[middle] < line:
                        end = middle
                    else:
                        high = middle
                known = counts[end]
                known_at = end * length
            while known < line and known_at < size:
                if data[known_at] == 10:
                    known += 1
                known_at += 1
            place = known_at
            while place < size and (data[place] == 32 or data[place] == 9 or data[place] == 47):
                place += 1
            if place < size and data[place] | 32 == 110:
                fine = True
                out[at] = 78
                at += 1
                place += 1
                end = at
                while place < size and data[place] >= 48 and data[place] <= 57 and at - end <= most:
                    out[at] = data[place]
                    at += 1
                    place += 1
                if at - end > most:
                    at = begin
                    count -= 1
                    break
                while at - end < 6:
                    out[at] = 32
                    at += 1
        if not fine:
            out[at] = 78
            for i in range(1, 6):
                out[at + i] = 46
            out[at + 6] = 32
            at += 7

        # What it says.
        for i in range(heads[kind * head + head - 1]):
            out[at + i] = heads[kind * head + i]
        at += heads[kind * head + head - 1]
        amount = 6
        if telling:
            amount = 1
            values[0] = feeds[told] / unit
        else:
            for i in range(6):
                values[i] = rows[base + i]
        if turned and not telling:
            u = values[0] - center_x
            v = values[1] - center_y
            values[0] = u * cosine + v * sine + center_x
            values[1] = v * cosine - u * sine + center_y
        turns = 0
        if kind == 2:
            amount = 8
            turns = tail & 0xFFFF
            if turns >= 32768:
                turns -= 65536
            first = 0
            second = 1
            third = 2
            if plane == 1:
                first = 2
                second = 0
                third = 1
            elif plane == 2:
                first = 1
                second = 2
                third = 0
            u = rows[base + 6]
            v = rows[base + 7]
            if turned and plane == 0:
                value = u - center_x
                fraction = v - center_y
                u = value * cosine + fraction * sine + center_x
                v = fraction * cosine - value * sine + center_y
            values[7] = values[5] - offset[5]
            values[6] = values[4] - offset[4]
            values[5] = values[3] - offset[3]
            value = (values[third] - offset[third]) / unit
            fraction = (values[first] - offset[first]) / unit
            values[1] = (values[second] - offset[second]) / unit
            values[0] = fraction
            values[4] = value
            values[2] = (u - offset[first]) / unit
            values[3] = (v - offset[second]) / unit
        elif not telling:
            for i in range(3):
                values[i] = (values[i] - offset[i]) / unit
            for i in range(3, 6):
                values[i] = values[i] - offset[i]

        fine = True
        for i in range(amount):
            value = values[i]
            if copysign(1.0, value) < 0.0:
                out[at] = 45
                at += 1
                value = -value
            if value == 0.0:
                whole = 0
                four = 0
            elif not value < limit:  # not a number neither
                fine = False
                break
            else:
                whole = int(value)
                fraction = (value - whole) * parts
                scaled = int(fraction)
                fraction -= scaled
                scaled *= 625
                four = scaled >> 49
                rest = scaled & mask
                # Below 0.5 a number may have bits beyond the 53 looked at: 625 times these are less than 625.
                if fraction > 0.0 and rest <= half and rest >= half - 625:
                    fine = False
                    break
                if rest > half or (rest == half and four & 1):
                    four += 1
                    if four == 10000:
                        four = 0
                        whole += 1
            if whole < 10:
                out[at] = 48 + whole
                at += 1
            elif whole < 100:
                out[at] = pairs[2 * whole]
                out[at + 1] = pairs[2 * whole + 1]
                at += 2
            else:
                number = whole
                end = at
                while number:
                    end += 1
                    number //= 10
                place = end
                while place > at:
                    place -= 1
                    out[place] = 48 + whole % 10
                    whole //= 10
                at = end
            out[at] = 46
            number = four // 100
            four -= number * 100
            out[at + 1] = pairs[2 * number]
            out[at + 2] = pairs[2 * number + 1]
            out[at + 3] = pairs[2 * four]
            out[at + 4] = pairs[2 * four + 1]
            at += 5
            if i == 3 and kind == 2:  # turns stand behind the center
                out[at] = 44
                out[at + 1] = 32
                at += 2
                if turns < 0:
                    out[at] = 45
                    at += 1
                    turns = -turns
                number = turns
                end = at
                while number or end == at:
                    end += 1
                    number //= 10
                place = end
                number = turns
                while place > at:
                    place -= 1
                    out[place] = 48 + number % 10
                    number //= 10
                at = end
            if i + 1 < amount:
                out[at] = 44
                out[at + 1] = 32
                at += 2
        if not fine:
            at = begin
            count -= 1
            break
        out[at] = 41
        out[at + 1] = 10
        at += 2
        if telling:
            told += 1
        else:
            row += 1

    numbers[ROW] = row
    numbers[USED] = at
    numbers[TOLD] = told
    numbers[COUNT] = count
