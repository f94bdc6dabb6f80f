"""Thins a run of points: those near the chord of what stays may go (Douglas and Peucker)."""

from __future__ import annotations

try:
    import cython
except ImportError:
    from aircut.kernels import nocython as cython

COMPILED = cython.compiled

STACK = 256  # entries of scratch, a pair for each halving of what is left


@cython.boundscheck(False)
@cython.wraparound(False)
@cython.cdivision(True)
def thin(
    points: cython.double[::1],
    first: cython.Py_ssize_t,
    last: cython.Py_ssize_t,
    tolerance: cython.double,
    keep: cython.uchar[::1],
    stack: cython.longlong[::1],
):
    """Mark in keep which of the points first to last stay; none that goes is farther than tolerance from its chord.

    points: (3n,) mm. keep: (n,), set to 1; the ends stay. stack: (STACK,) scratch.
    """
    top: cython.int = 0
    i: cython.Py_ssize_t
    j: cython.int
    at: cython.Py_ssize_t
    chord: cython.double
    along: cython.double
    d: cython.double
    way: cython.double
    away: cython.double
    worst: cython.double
    keep[first] = 1
    while True:
        # The farthest point from the chord first to last, the chord being a segment.
        chord = 0.0
        for j in range(3):
            d = points[3 * last + j] - points[3 * first + j]
            chord += d * d
        worst = -1.0
        at = first
        for i in range(first + 1, last):
            along = 0.0
            if chord > 0.0:
                for j in range(3):
                    d = points[3 * last + j] - points[3 * first + j]
                    along += (points[3 * i + j] - points[3 * first + j]) * d
                along = along / chord
                if along < 0.0:
                    along = 0.0
                if along > 1.0:
                    along = 1.0
            away = 0.0
            for j in range(3):
                way = points[3 * first + j] + along * (points[3 * last + j] - points[3 * first + j])
                d = points[3 * i + j] - way
                away += d * d
            if away > worst:
                worst = away
                at = i
        if worst > tolerance * tolerance:
            if top >= stack.shape[0]:  # deeper than any halving: keep what is left as it is
                for i in range(first, last + 1):
                    keep[i] = 1
            else:
                stack[top] = last
                top += 1
                last = at
                continue
        keep[last] = 1
        if top == 0:
            return
        first = last
        top -= 1
        last = stack[top]
