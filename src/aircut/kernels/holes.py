"""Holes of one pattern: the rows of a canned cycle's hole, put at many places."""

from __future__ import annotations

try:
    import cython
except ImportError:
    from aircut.kernels import nocython as cython

COMPILED = cython.compiled
WIDTH = 11  # 8-byte places of a row
MARK = 9  # of them, that of line and tool
LINE = 0xFFFFFFFF  # of the mark


@cython.boundscheck(False)
@cython.wraparound(False)
def repeat(
    places: cython.double[::1],
    place_marks: cython.longlong[::1],
    count: cython.Py_ssize_t,
    pattern: cython.const[cython.double][::1],
    pattern_marks: cython.const[cython.longlong][::1],
    first: cython.Py_ssize_t,
    second: cython.Py_ssize_t,
    rows: cython.double[::1],
    marks: cython.longlong[::1],
):
    """Write the pattern's rows at each place; returns at how many: it stops before a place like the one before.

    places: `count` packed rows, of which places in the plane and lines are taken; the row before them is
    that of the pattern. pattern: packed rows of one hole. first, second: the plane's axes. rows, marks: the same
    memory, as doubles and as integers, for count times the pattern; so are places, place_marks and the others.
    """
    width: cython.Py_ssize_t = WIDTH
    mark: cython.Py_ssize_t = MARK
    keep: cython.longlong = ~LINE
    of_line: cython.longlong = LINE
    size: cython.Py_ssize_t = len(pattern)
    at: cython.Py_ssize_t = 0
    hole: cython.Py_ssize_t
    row: cython.Py_ssize_t
    i: cython.Py_ssize_t
    line: cython.longlong
    u: cython.double
    v: cython.double
    before_u: cython.double = pattern[first]
    before_v: cython.double = pattern[second]
    for hole in range(count):
        u = places[hole * width + first]
        v = places[hole * width + second]
        if u == before_u and v == before_v:
            return hole
        line = place_marks[hole * width + mark] & of_line
        row = 0
        while row < size:
            for i in range(width):
                marks[at + i] = pattern_marks[row + i]
            rows[at + first] = u
            rows[at + second] = v
            marks[at + mark] = (pattern_marks[row + mark] & keep) | line
            row += width
            at += width
        before_u = u
        before_v = v
    return count
