"""The bytes of a program: where lines start, what class they are, and the words of those that are plain.

`survey` goes over the whole text once, block by block, and `classify` over the lines that may not be plain: a line
is taken to be plain by its characters. `scan` reads the words, and finds the few that are faulty to be OTHER.

A plain line holds nothing but words of one letter and a literal number
(`N10 G1 X1.5 Y-2`), blanks and a `;` comment. Its shape is its letters, with the
numbers of G and M kept: `g1xy`; the other numbers are its values. Lines of one
shape mean the same, so whoever runs them understands each shape once.
Everything else, a fault included, is OTHER and left to the general lane.
"""

from __future__ import annotations

try:
    import cython
except ImportError:
    from aircut.kernels import nocython as cython

COMPILED = cython.compiled

BLANK = 0
PLAIN = 1
OTHER = 2

WORDS = 32  # at most in a plain line
SHAPE = WORDS * 6  # bytes of a shape at most: letter, up to five of a code's number

# Exact powers: a 15-digit integer divided by one is the correctly rounded number.
BLOCK = 1024  # bytes that are looked at together
PART = 128  # bytes in which line feeds are counted in a byte
# By byte: 0 blank, 1 letter of a word, 2 number, 4 comment to the line's end, 8 anything else.
SORTS = bytes(
    0 if char in "\t\r " else 2 if char in "0123456789.+-" else 4 if char == ";" else
    1 if char.isascii() and char.isalpha() and char not in "oO" else 8
    for char in map(chr, range(256))
)  # fmt: skip

POWERS = (1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15)
DIGITS = 15


@cython.boundscheck(False)
@cython.wraparound(False)
@cython.cdivision(True)
def scan(
    data: cython.const[cython.uchar][::1],
    at: cython.Py_ssize_t,
    count: cython.Py_ssize_t,
    classes: cython.uchar[::1],
    first: cython.Py_ssize_t,
    shapes: cython.uchar[::1],
    shape_ends: cython.int[::1],
    values: cython.double[::1],
    value_ends: cython.int[::1],
    powers: cython.double[::1],
):
    """Scan up to `count` lines from byte `at`; returns the byte after them.

    classes: of the whole file, written from index `first`.
    shapes, values: the plain lines' shapes and values, end to end; line i of this
    scan has shapes[shape_ends[i-1]:shape_ends[i]], likewise values.
    Sizes: shapes count·SHAPE, values count·WORDS, the ends count. powers: POWERS.
    """
    size: cython.Py_ssize_t = len(data)
    row: cython.Py_ssize_t = 0
    shape_at: cython.Py_ssize_t = 0
    value_at: cython.Py_ssize_t = 0
    shape_from: cython.Py_ssize_t
    value_from: cython.Py_ssize_t
    kind: cython.int
    c: cython.int
    letter: cython.int
    words: cython.int
    digits: cython.int
    decimals: cython.int
    seen: cython.uint
    bit: cython.uint
    negative: cython.bint
    signed: cython.bint
    point: cython.bint
    mantissa: cython.longlong
    whole: cython.longlong
    tenth: cython.longlong
    scale: cython.longlong
    number: cython.double

    while row < count and at < size:
        shape_from = shape_at
        value_from = value_at
        kind = BLANK
        words = 0
        seen = 0
        while True:
            if at >= size:
                break
            c = data[at]
            if c == 10:
                break
            if c == 32 or c == 9 or c == 13:
                at += 1
                continue
            if c == 59:  # ; comments out the rest
                while at < size and data[at] != 10:
                    at += 1
                break
            letter = c | 32
            if c < 65 or letter < 97 or letter > 122 or c > 122 or letter == 111 or words == WORDS:
                kind = OTHER
                break
            if letter == 110:  # N: first or nowhere
                if kind != BLANK:
                    kind = OTHER
                    break
            elif letter != 103 and letter != 109:
                bit = 1 << (letter - 97)
                if seen & bit:
                    kind = OTHER
                    break
                seen |= bit
            kind = PLAIN
            words += 1
            at += 1

            negative = False
            signed = False
            point = False
            mantissa = 0
            digits = 0
            decimals = 0
            while at < size:
                c = data[at]
                if c >= 48 and c <= 57:
                    digits += 1
                    if digits > DIGITS:
                        break
                    mantissa = mantissa * 10 + (c - 48)
                    if point:
                        decimals += 1
                elif c == 46 and not point:
                    point = True
                elif (c == 45 or c == 43) and digits == 0 and not point and not signed:
                    signed = True
                    negative = c == 45
                elif c != 32 and c != 9 and c != 13:
                    break
                at += 1
            if digits == 0 or digits > DIGITS:
                kind = OTHER
                break
            if letter == 110:
                if signed or point:
                    kind = OTHER
                    break
                continue
            shapes[shape_at] = letter
            shape_at += 1
            if letter == 103 or letter == 109:
                while decimals > 1 and mantissa % 10 == 0:
                    mantissa = mantissa // 10
                    decimals -= 1
                if negative or decimals > 1 or mantissa > 9999:
                    kind = OTHER
                    break
                whole = mantissa
                tenth = 0
                if decimals:
                    whole = mantissa // 10
                    tenth = mantissa % 10
                scale = 1
                while scale * 10 <= whole:
                    scale *= 10
                while scale:
                    shapes[shape_at] = 48 + whole // scale % 10
                    shape_at += 1
                    scale = scale // 10
                if tenth:
                    shapes[shape_at] = 46
                    shapes[shape_at + 1] = 48 + tenth
                    shape_at += 2
            else:
                number = mantissa / powers[decimals]
                values[value_at] = -number if negative else number
                value_at += 1
        if kind == OTHER:
            shape_at = shape_from
            value_at = value_from
            while at < size and data[at] != 10:
                at += 1
        at += 1
        classes[first + row] = kind
        shape_ends[row] = shape_at
        value_ends[row] = value_at
        row += 1
    return at


@cython.boundscheck(False)
@cython.wraparound(False)
def survey(
    data: cython.const[cython.uchar][::1],
    counts: cython.longlong[::1],
    plain: cython.uchar[::1],
    first: cython.Py_ssize_t,
    last: cython.Py_ssize_t,
):
    """Look at the blocks from `first` to before `last`; returns whether there is an N among them.

    counts: line feeds before each block, and in all; known up to `first`. plain: by block, 1 where all
    is made of what stands in plain motion, lines begin with a letter, and G has but one digit, or a 0 first.
    """
    size: cython.Py_ssize_t = len(data)
    block: cython.Py_ssize_t
    at: cython.Py_ssize_t
    i: cython.Py_ssize_t
    end: cython.Py_ssize_t
    stop: cython.Py_ssize_t
    last_of_part: cython.Py_ssize_t
    length: cython.Py_ssize_t = BLOCK
    part: cython.Py_ssize_t = PART
    total: cython.longlong = counts[first]
    foreign: cython.uchar
    named: cython.uchar = 0
    feeds: cython.uchar
    c: cython.uchar
    d: cython.uchar
    e: cython.uchar
    sign: cython.uchar
    low: cython.uchar
    mid: cython.uchar
    high: cython.uchar
    feed: cython.uchar
    fine: cython.uchar
    letter: cython.uchar

    for block in range(first, last):
        counts[block] = total
        at = block * length
        end = at + length if at + length < size else size
        foreign = at == 0 and data[0] < 65
        stop = end
        if size - 2 < end:  # what stands behind is looked at too
            stop = size - 2 if size - 2 > at else at
            foreign = 1
        while at < stop:
            feeds = 0
            last_of_part = at + part if at + part < stop else stop
            for i in range(at, last_of_part):
                # Bytes alone, no `and`, no `or`, and ^ in place of |: so compilers look at many in one step.
                c = data[i]
                d = (data[i + 1] - 48) & 255
                e = (data[i + 2] - 48) & 255
                sign = (c - 43) & 255
                low = ((c | 32) - 97) & 255
                mid = (low - 8) & 255
                high = (low - 23) & 255
                feed = c == 10
                feeds += feed
                named |= low == 13
                fine = (sign <= 14) & (c != 44) & (c != 47)
                fine ^= feed ^ (c == 32) ^ (c == 13)
                letter = (low <= 2) ^ (low == 5) ^ (low == 6) ^ (mid <= 2) ^ (low == 13) ^ (low == 17) ^ (high <= 2)
                fine |= letter & (c >= 65)
                foreign |= fine ^ 1
                foreign |= feed & ((d < 17) | (d > 207))  # no letter begins the line
                foreign |= (low == 6) & ((d > 9) | ((d > 0) & (e <= 9)))
            total += feeds
            at += part
        for i in range(stop, end):
            c = data[i]
            total += c == 10
            named |= (c | 32) == 110
        plain[block] = not foreign
    counts[last] = total
    return named != 0


@cython.boundscheck(False)
@cython.wraparound(False)
def classify(
    data: cython.const[cython.uchar][::1],
    counts: cython.const[cython.longlong][::1],
    plain: cython.const[cython.uchar][::1],
    classes: cython.uchar[::1],
    sorts: cython.const[cython.uchar][::1],
):
    """Find the classes of the lines that are not all in plain blocks, by their characters. sorts: SORTS."""
    size: cython.Py_ssize_t = len(data)
    blocks: cython.Py_ssize_t = len(plain)
    length: cython.Py_ssize_t = BLOCK
    block: cython.Py_ssize_t
    at: cython.Py_ssize_t = 0
    done: cython.Py_ssize_t = 0  # the lines before this byte are classified
    end: cython.Py_ssize_t
    row: cython.Py_ssize_t = 0
    c: cython.uchar
    sort: cython.int
    before: cython.int
    kind: cython.int

    for block in range(blocks):
        if plain[block]:
            continue
        at = block * length
        end = at + length if at + length < size else size
        if done > at:
            at = done
        else:
            row = counts[block]
            while at > done and data[at - 1] != 10:
                at -= 1
        while at < end:
            kind = 0  # BLANK
            before = 0
            while at < size:
                c = data[at]
                if c == 10:
                    break
                sort = sorts[c]
                if sort == 4:
                    while at < size and data[at] != 10:
                        at += 1
                    break
                if sort == 8 or (sort == 1 and before == 1) or (sort == 2 and before == 0):
                    kind = 2  # OTHER
                    while at < size and data[at] != 10:
                        at += 1
                    break
                if sort:
                    kind = 1  # PLAIN
                    before = sort
                at += 1
            if before == 1 and kind == 1:
                kind = 2
            classes[row] = kind
            row += 1
            at += 1
        done = at
