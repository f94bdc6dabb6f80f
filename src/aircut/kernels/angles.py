"""Sine, cosine and tangent of degrees in the widest float there is, which LinuxCNC's interpreter reckons in.

Where that has 64 bits, SIN[30] is 0.5 to the last one, and FIX[SIN[30] * 10] is 5.
"""

from __future__ import annotations

try:
    import cython
    from cython.cimports.libc.math import cosl, sinl, tanl
except ImportError:
    from aircut.kernels import nocython as cython

COMPILED = cython.compiled
if not cython.compiled:
    from numpy import cos as cosl
    from numpy import longdouble
    from numpy import sin as sinl
    from numpy import tan as tanl


def sine(degrees: cython.double) -> cython.double:
    return float(sinl(turn(degrees)))


def cosine(degrees: cython.double) -> cython.double:
    return float(cosl(turn(degrees)))


def tangent(degrees: cython.double) -> cython.double:
    return float(tanl(turn(degrees)))


def to_degrees(radians: cython.double) -> cython.double:
    """Degrees: the product is rounded to 53 bits, the quotient is not."""
    product: cython.double = radians * 180.0
    return float(product / pi())


@cython.cfunc
def turn(degrees: cython.double) -> cython.longdouble:
    """Radians. Raises ValueError for an infinite angle, as Python's own sine does."""
    if degrees - degrees != 0.0:
        raise ValueError("math domain error")
    return degrees * pi() / 180.0


@cython.cfunc
def pi() -> cython.longdouble:
    """From two doubles, as a literal has no more bits than one."""
    wide: cython.longdouble
    if cython.compiled:
        wide = 3.141592653589793
    else:
        wide = longdouble(3.141592653589793)
    return wide + 1.2246467991473532e-16
