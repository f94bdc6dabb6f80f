"""Ramps: from one speed to another, with limited acceleration and, where there is one, jerk.

Columns in, columns out. Speeds in units a second, an infinite jerk for none. A ramp begins and ends
without acceleration; its three phases have jerk +, 0, - (signs turned where it slows down).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Array = NDArray[np.float64]


def phases(first: Array, last: Array, accel: Array, jerk: Array) -> tuple[Array, Array, Array]:
    """Seconds of the first (and of the last) and of the middle phase, and the peak acceleration, signed."""
    import numpy as np

    change = last - first
    size = np.abs(change)
    limited = np.isfinite(jerk)
    finite = np.where(limited, jerk, 1.0)
    peak = np.where(limited, np.minimum(accel, np.sqrt(size * finite)), accel)
    ends = np.where(limited, peak / finite, 0.0)
    middle = np.maximum(np.divide(size, peak, out=np.zeros_like(size), where=peak > 0) - ends, 0.0)
    return ends, middle, np.copysign(peak, change)


def at(time: Array, first: Array, last: Array, accel: Array, jerk: Array) -> tuple[Array, Array, Array, Array]:
    """Way, speed, acceleration and jerk at a time since the ramp's start, 0 to its end."""
    import numpy as np

    ends, middle, peak = phases(first, last, accel, jerk)
    hard = np.divide(peak, ends, out=np.zeros_like(peak), where=ends > 0)
    one = np.minimum(time, ends)
    two = np.clip(time - ends, 0.0, middle)
    three = np.maximum(time - ends - middle, 0.0)
    way = first * one + hard * one**3 / 6.0
    speed = first + hard * one**2 / 2.0
    way += speed * two + peak * two**2 / 2.0
    speed = speed + peak * two
    way += speed * three + peak * three**2 / 2.0 - hard * three**3 / 6.0
    speed = speed + peak * three - hard * three**2 / 2.0
    slope = hard * one - hard * three
    slope = np.where((two > 0) & (three <= 0) | (ends == 0.0), peak, slope)
    now = np.where(three > 0, -hard, np.where(two > 0, 0.0, hard))
    return way, speed, slope, now
