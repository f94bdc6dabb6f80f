"""Speeds at the joints of a path, and the time its pieces take, with limited acceleration.

Pieces: length, highest speed, acceleration and deceleration along the path; enter: highest speed at its start.
Any unit of length; seconds.
"""

from __future__ import annotations

try:
    import cython
except ImportError:
    from aircut.kernels import nocython as cython

if cython.compiled:
    from cython.cimports.libc.math import sqrt
else:
    from math import sqrt

COMPILED = cython.compiled


@cython.boundscheck(False)
@cython.wraparound(False)
@cython.cdivision(True)
def brake(
    length: cython.double[::1],
    speed: cython.double[::1],
    decel: cython.double[::1],
    enter: cython.double[::1],
    joint: cython.double[::1],
):
    """The highest speeds at which the path can be entered at each joint and still be followed to rest.

    joint: (n + 1,), written: the speed at the start of each piece, and 0 at the end of the last.
    """
    count: cython.Py_ssize_t = length.shape[0]
    k: cython.Py_ssize_t
    most: cython.double
    reach: cython.double
    joint[count] = 0.0
    for k in range(count - 1, -1, -1):
        most = speed[k] if speed[k] < enter[k] else enter[k]
        if k > 0 and speed[k - 1] < most:
            most = speed[k - 1]
        reach = joint[k + 1] * joint[k + 1] + 2.0 * decel[k] * length[k]
        if most * most > reach:
            most = sqrt(reach)
        joint[k] = most


@cython.boundscheck(False)
@cython.wraparound(False)
@cython.cdivision(True)
def trapezoids(
    length: cython.double[::1],
    speed: cython.double[::1],
    accel: cython.double[::1],
    decel: cython.double[::1],
    joint: cython.double[::1],
    top: cython.double[::1],
    time: cython.double[::1],
):
    """Accelerate from rest under the joints' speeds, which are lowered to what is reached.

    top: (n,), written: the highest speed in each piece. time: (n,), written: seconds that it takes.
    """
    count: cython.Py_ssize_t = length.shape[0]
    k: cython.Py_ssize_t
    first: cython.double
    last: cython.double
    most: cython.double
    reach: cython.double
    cruise: cython.double
    up: cython.double
    down: cython.double
    if count > 0:
        joint[0] = 0.0
    for k in range(count):
        first = joint[k]
        last = joint[k + 1]
        up = accel[k]
        down = decel[k]
        reach = first * first + 2.0 * up * length[k]
        if last * last > reach:
            last = sqrt(reach)
            joint[k + 1] = last
        most = speed[k]
        reach = (2.0 * up * down * length[k] + down * first * first + up * last * last) / (up + down)
        if most * most > reach:
            most = sqrt(reach)
        if most < first:
            most = first
        if most < last:
            most = last
        cruise = length[k] - (most - first) * (most + first) / (2.0 * up) - (most - last) * (most + last) / (2.0 * down)
        top[k] = most
        time[k] = (most - first) / up + (most - last) / down
        if cruise > 0.0:
            time[k] += cruise / most
