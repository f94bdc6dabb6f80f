"""Whether rows of the toolpath stay within the travel of the axes."""

from __future__ import annotations

try:
    import cython
except ImportError:
    from aircut.kernels import nocython as cython

COMPILED = cython.compiled

STRIDE = 11  # eight-byte words of a row, the first six of them the axes


@cython.boundscheck(False)
@cython.wraparound(False)
def outside(rows: cython.double[::1], first: cython.Py_ssize_t, last: cython.Py_ssize_t, box: cython.double[::1]):
    """The first row from `first` to before `last` that is not within the box; `last` if all are.

    box: (12,), lowest and highest X, then Y, Z, A, B, C; mm and degrees.
    """
    row: cython.Py_ssize_t
    i: cython.Py_ssize_t
    value: cython.double
    for row in range(first, last):
        for i in range(6):
            value = rows[STRIDE * row + i]
            if not (box[2 * i] <= value <= box[2 * i + 1]):
                return row
    return last
