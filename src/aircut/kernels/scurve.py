"""Speeds with limited jerk, under those that acceleration alone allows.

The path is cut at joints into spans. A span has a ramp from its first speed up to its top, a stretch at that,
and a ramp down to its last; a ramp begins and ends without acceleration, its jerk is +J, 0, -J. What limited
acceleration allows (`lookahead`) bounds all that jerk-limited motion can do, so a span between two joints at
which that bound touches a limit of speed keeps all limits; where it must pass over such a joint it is checked.
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


@cython.cfunc
@cython.cdivision(True)
def ramp_time(change: cython.double, accel: cython.double, jerk: cython.double) -> cython.double:
    """Seconds of a ramp by which speed changes."""
    if change <= 0.0:
        return 0.0
    if change * jerk < accel * accel:
        return 2.0 * sqrt(change / jerk)
    return change / accel + accel / jerk


@cython.cfunc
def ramp_length(low: cython.double, high: cython.double, accel: cython.double, jerk: cython.double) -> cython.double:
    """Length of a ramp between two speeds."""
    return (low + high) / 2.0 * ramp_time(high - low, accel, jerk)


@cython.cfunc
@cython.cdivision(True)
def ramp_slope(low: cython.double, high: cython.double, accel: cython.double, jerk: cython.double) -> cython.double:
    """By how much a ramp is longer for each unit that its upper speed is higher."""
    change: cython.double = high - low
    root: cython.double
    if change <= 0.0:
        return 0.0
    if change * jerk < accel * accel:
        root = sqrt(change / jerk)
        return root + (low + high) / (2.0 * jerk * root)
    return high / accel + accel / (2.0 * jerk)


@cython.cfunc
@cython.cdivision(True)
def peak(
    first: cython.double,
    last: cython.double,
    length: cython.double,
    accel: cython.double,
    decel: cython.double,
    jerk: cython.double,
    most: cython.double,
) -> cython.double:
    """Highest top, at most `most`, of a span; the ramp between first and last fits into its length.

    Newton's method in the square root of the top's height over both ends: in that the length is convex, so
    the way down to the root is steady. A bracket guards it; the result is never above the root.
    """
    base: cython.double = first if first > last else last
    if most <= base:
        return base
    if ramp_length(first, most, accel, jerk) + ramp_length(last, most, decel, jerk) <= length:
        return most
    least: cython.double = base
    top: cython.double = most
    gap: cython.double
    slope: cython.double
    root: cython.double
    for _ in range(100):
        gap = ramp_length(first, top, accel, jerk) + ramp_length(last, top, decel, jerk) - length
        slope = ramp_slope(first, top, accel, jerk) + ramp_slope(last, top, decel, jerk)
        if gap > 0.0:
            most = top
        else:
            least = top
            if -gap <= 1e-15 * top * slope:
                break
        if most - least <= 1e-15 * most:
            break
        root = sqrt(top - base)
        root -= gap / (2.0 * root * slope)
        top = (base + root * root) * 0.9999999999999996
        if not (root > 0.0 and least < top < most):
            top = (least + most) / 2.0
    return least


@cython.cfunc
def reach(low: cython.double, length: cython.double, accel: cython.double, jerk: cython.double) -> cython.double:
    """Highest speed to which a ramp from a speed leads within a length."""
    most: cython.double = sqrt(low * low + 2.0 * accel * length)
    return peak(low, low, 2.0 * length, accel, accel, jerk, most)


@cython.cfunc
@cython.boundscheck(False)
@cython.wraparound(False)
@cython.cdivision(True)
def ramp_at(
    way: cython.double,
    low: cython.double,
    high: cython.double,
    accel: cython.double,
    jerk: cython.double,
    found: cython.double[::1],
) -> cython.double:
    """Seconds that a ramp from low to high takes for a part of its way; writes the speed there to found[1]."""
    change: cython.double = high - low
    total: cython.double = ramp_time(change, accel, jerk)
    top: cython.double = accel
    if change * jerk < accel * accel:
        top = sqrt(change * jerk)
    ends: cython.double = top / jerk
    middle: cython.double = total - 2.0 * ends
    if middle < 0.0:
        middle = 0.0
    one: cython.double = low * ends + jerk * ends * ends * ends / 6.0
    speed: cython.double = low + top * ends / 2.0
    two: cython.double = one + speed * middle + top * middle * middle / 2.0
    t: cython.double
    gap: cython.double
    v: cython.double
    begin: cython.double = low
    bend: cython.double = jerk
    if way > one and way <= two:
        gap = way - one
        t = 2.0 * gap / (speed + sqrt(speed * speed + 2.0 * top * gap))
        found[1] = speed + top * t
        return ends + t
    backward: cython.bint = way > two
    if backward:  # from the end, where the speed falls away likewise
        way = (low + high) / 2.0 * total - way
        begin = high
        bend = -jerk
    if way <= 0.0:
        found[1] = begin
        return total if backward else 0.0
    # Newton's method. Its first guess comes from the speed alone, or from the jerk alone where that leads farther:
    # the root is next to one of them, and on the side from which the way there is steady.
    t = ends
    if begin * ends > way:
        t = way / begin
    if not backward and bend * t * t > 6.0 * begin:
        gap = (6.0 * way / bend) ** (1.0 / 3.0)
        if gap < t:
            t = gap
    for _ in range(50):
        v = begin + bend * t * t / 2.0
        if not v > 0.0:
            break
        gap = (begin * t + bend * t * t * t / 6.0 - way) / v
        t -= gap
        if gap <= 1e-15 * t and gap >= -1e-15 * t:
            break
    if t > ends:
        t = ends
    found[1] = begin + bend * t * t / 2.0
    return total - t if backward else t


@cython.cfunc
@cython.boundscheck(False)
@cython.wraparound(False)
@cython.cdivision(True)
def span_at(
    way: cython.double,
    length: cython.double,
    first: cython.double,
    top: cython.double,
    last: cython.double,
    accel: cython.double,
    decel: cython.double,
    jerk: cython.double,
    found: cython.double[::1],
) -> cython.double:
    """Seconds that a span takes for a part of its way; writes the speed there to found[1]."""
    rise: cython.double = ramp_length(first, top, accel, jerk)
    fall: cython.double = ramp_length(last, top, decel, jerk)
    flat: cython.double = length - rise - fall
    if flat < 0.0:
        flat = 0.0
    if way < rise:
        return ramp_at(way, first, top, accel, jerk, found)
    up: cython.double = ramp_time(top - first, accel, jerk)
    if way <= rise + flat:
        found[1] = top
        return up + (way - rise) / top if top > 0.0 else up
    down: cython.double = ramp_time(top - last, decel, jerk)
    all_of_it: cython.double = up + (flat / top if top > 0.0 else 0.0) + down
    if way >= length:
        found[1] = last
        return all_of_it
    return all_of_it - ramp_at(length - way, last, top, decel, jerk, found)


@cython.cfunc
@cython.cdivision(True)
def gentle(low: cython.double, high: cython.double, length: cython.double, jerk: cython.double) -> cython.double:
    """Acceleration of the ramp that takes just this length, which is enough for it."""
    total: cython.double = 2.0 * length / (low + high)
    rest: cython.double = total * total - 4.0 * (high - low) / jerk
    if rest < 0.0:
        rest = 0.0
    return jerk * (total - sqrt(rest)) / 2.0


@cython.cfunc
@cython.boundscheck(False)
@cython.wraparound(False)
def fits(
    here: cython.Py_ssize_t,
    there: cython.Py_ssize_t,
    first: cython.double,
    top: cython.double,
    last: cython.double,
    accel: cython.double,
    decel: cython.double,
    jerk: cython.double,
    way: cython.double[::1],
    speed: cython.double[::1],
    joint: cython.double[::1],
    found: cython.double[::1],
) -> cython.bint:
    """Whether a span keeps under the bound at all joints inside, and its top under the pieces' speeds."""
    k: cython.Py_ssize_t
    length: cython.double = way[there] - way[here]
    rise: cython.double = ramp_length(first, top, accel, jerk)
    fall: cython.double = ramp_length(last, top, decel, jerk)
    flat: cython.bint = top > first and top > last
    for k in range(here, there):
        if k > here:
            span_at(way[k] - way[here], length, first, top, last, accel, decel, jerk, found)
            if found[1] > joint[k] * 1.000000001:
                return False
        if flat and top > speed[k] * 1.000000001:
            if way[k + 1] - way[here] > rise and way[k] - way[here] < length - fall:
                return False
    return True


@cython.cfunc
def highest(
    here: cython.Py_ssize_t,
    there: cython.Py_ssize_t,
    first: cython.double,
    last: cython.double,
    accel: cython.double,
    decel: cython.double,
    jerk: cython.double,
    most: cython.double,
    way: cython.double[::1],
    speed: cython.double[::1],
    joint: cython.double[::1],
    found: cython.double[::1],
) -> cython.double:
    """Highest top, to a thousandth, with which a span keeps under the bound; -1 where there is none."""
    least: cython.double = first if first > last else last
    top: cython.double = peak(first, last, way[there] - way[here], accel, decel, jerk, most)
    middle: cython.double
    if fits(here, there, first, top, last, accel, decel, jerk, way, speed, joint, found):
        return top
    most = top
    top = -1.0
    for _ in range(200):
        if most - least <= 0.001 * most and (top >= 0.0 or least > 0.0):
            break
        middle = (least + most) / 2.0
        if fits(here, there, first, middle, last, accel, decel, jerk, way, speed, joint, found):
            least = top = middle
        else:
            most = middle
    return top


@cython.boundscheck(False)
@cython.wraparound(False)
@cython.cdivision(True)
def spans(
    way: cython.double[::1],
    speed: cython.double[::1],
    accel: cython.double[::1],
    decel: cython.double[::1],
    jerk: cython.double[::1],
    enter: cython.double[::1],
    joint: cython.double[::1],
    top: cython.double[::1],
    anchor: cython.longlong[::1],
    out: cython.double[::1],
    first_of: cython.longlong[::1],
    until: cython.double[::1],
):
    """Cut a path of n pieces into spans; returns their number.

    way: (n + 1,) of the joints. speed to enter: as of the pieces. joint, top: what `lookahead.trapezoids`
    left. anchor: (n + 1,) scratch, and so becomes enter. Written: out, six columns n long end to end: first,
    top and last speed, acceleration, deceleration, jerk; first_of: (n,) first piece of each span;
    until: (n,) seconds at which each piece ends.
    """
    count: cython.Py_ssize_t = speed.shape[0]
    anchors: cython.Py_ssize_t = 0
    k: cython.Py_ssize_t
    i: cython.Py_ssize_t
    j: cython.Py_ssize_t
    m: cython.Py_ssize_t
    got: cython.Py_ssize_t = 0
    done: cython.bint
    least: cython.double
    a: cython.double
    d: cython.double
    jj: cython.double
    cap: cython.double
    length: cython.double
    low: cython.double
    high: cython.double
    part: cython.double
    t0: cython.double
    longest: cython.Py_ssize_t = 1000  # anchors that a ramp may pass over, which bounds the work
    found: cython.double[::1] = out[6 * count : 6 * count + 2]
    slow: cython.double[::1] = enter  # the speed at each joint that is kept; that at the end is 0

    # Anchors: the joints at which a limit of speed is touched. There a span may begin.
    for k in range(count + 1):
        if k == 0 or k == count:
            least = 0.0
        else:
            least = speed[k] if speed[k] < speed[k - 1] else speed[k - 1]
            if enter[k] < least:
                least = enter[k]
        if k == 0 or k == count or joint[k] >= least * (1.0 - 1e-12):
            anchor[anchors] = k
            if k < count:
                slow[k] = joint[k]
            anchors += 1
        else:
            slow[k] = -1.0

    # Backward: speeds from which a ramp down to the next kept anchor fits.
    j = anchors - 1
    while j > 0:
        a = d = jj = 1e300
        high = slow[anchor[j]] if anchor[j] < count else 0.0
        i = j - 1
        done = False
        k = anchor[j]
        while i >= 0 and j - i <= longest:
            while k > anchor[i]:
                k -= 1
                if decel[k] < d:
                    d = decel[k]
                if jerk[k] < jj:
                    jj = jerk[k]
            low = joint[anchor[i]]
            length = way[anchor[j]] - way[anchor[i]]
            if low <= high:
                done = True
                break
            if ramp_length(high, low, d, jj) <= length:
                if i == j - 1:
                    done = True
                    break
                part = gentle(high, low, length, jj)
                if fits(anchor[i], anchor[j], low, low, high, d, part, jj, way, speed, joint, found):
                    done = True
                    break
            i -= 1
        if not done:
            i = j - 1
            d = jj = 1e300
            for k in range(anchor[i], anchor[j]):
                if decel[k] < d:
                    d = decel[k]
                if jerk[k] < jj:
                    jj = jerk[k]
            slow[anchor[i]] = reach(high, way[anchor[j]] - way[anchor[i]], d, jj)
        for m in range(i + 1, j):
            slow[anchor[m]] = -1.0
        j = i

    # Forward: from each kept anchor to the next that a ramp reaches.
    k = 0
    for i in range(anchors):
        if anchor[i] == count or slow[anchor[i]] >= 0.0:
            anchor[k] = anchor[i]
            k += 1
    anchors = k
    i = 0
    t0 = 0.0
    while i < anchors - 1:
        low = slow[anchor[i]]
        a = d = jj = 1e300
        cap = 0.0
        k = anchor[i]
        j = i + 1
        done = False
        while j < anchors and j - i <= longest:
            while k < anchor[j]:
                if accel[k] < a:
                    a = accel[k]
                if decel[k] < d:
                    d = decel[k]
                if jerk[k] < jj:
                    jj = jerk[k]
                if top[k] > cap:
                    cap = top[k]
                k += 1
            high = slow[anchor[j]] if anchor[j] < count else 0.0
            length = way[anchor[j]] - way[anchor[i]]
            if high > low:
                if ramp_length(low, high, a, jj) > length:
                    j += 1
                    continue
            elif ramp_length(high, low, d, jj) > length:
                break
            least = peak(low, high, length, a, d, jj, cap)
            if fits(anchor[i], anchor[j], low, least, high, a, d, jj, way, speed, joint, found):
                done = True
                break
            if high > low:
                part = gentle(low, high, length, jj)
                if fits(anchor[i], anchor[j], low, high, high, part, d, jj, way, speed, joint, found):
                    least = high
                    a = part
                    done = True
                    break
                j += 1
                continue
            break
        if not done:
            # The next joint, at what can be reached: always possible, and never more than the bound.
            j = i + 1
            a = d = jj = 1e300
            cap = 0.0
            for k in range(anchor[i], anchor[j]):
                if accel[k] < a:
                    a = accel[k]
                if decel[k] < d:
                    d = decel[k]
                if jerk[k] < jj:
                    jj = jerk[k]
                if top[k] > cap:
                    cap = top[k]
            length = way[anchor[j]] - way[anchor[i]]
            high = slow[anchor[j]] if anchor[j] < count else 0.0
            if high > low:
                part = reach(low, length, a, jj)
                if part < high:
                    high = part
            if anchor[j] < count:
                slow[anchor[j]] = high
            least = highest(anchor[i], anchor[j], low, high, a, d, jj, cap, way, speed, joint, found)
            if least < 0.0:
                least = high if high > low else low
                if high > low:
                    a = gentle(low, high, length, jj)
                elif low > high:
                    d = gentle(high, low, length, jj)
        out[got] = low
        out[count + got] = least
        out[2 * count + got] = high
        out[3 * count + got] = a
        out[4 * count + got] = d
        out[5 * count + got] = jj
        first_of[got] = anchor[i]
        for k in range(anchor[i], anchor[j]):
            until[k] = t0 + span_at(way[k + 1] - way[anchor[i]], length, low, least, high, a, d, jj, found)
        t0 = until[anchor[j] - 1]
        got += 1
        i = j
    return got
