"""A ball moving along a straight line against a body of triangles, found through a tree of boxes.

A triangle is convex, so the ball center's distance to it is a convex function of the way, and
Newton's steps from the start of the way come up to the first contact without ever passing it:
`geometry.contact.approach`, written out for a triangle.

Triangles: (9n,) mm, three corners of x, y, z each. The tree stands in four columns, a row for a
box, parents before children, the left child right after its parent:
bounds: (6m,) mm, low x, y, z and high x, y, z; right: (m,) the right child, -1 for a leaf;
first, last: (m,) the range of triangles below the box.
Coordinates are good to 1e-15 of their size; nothing here is single precision.
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

STACK = 256  # entries of scratch; the tree halves its triangles, so it is never 64 deep


@cython.boundscheck(False)
@cython.wraparound(False)
@cython.cdivision(True)
def build(
    triangles: cython.double[::1],
    order: cython.int[::1],
    bounds: cython.double[::1],
    right: cython.int[::1],
    first: cython.int[::1],
    last: cython.int[::1],
    stack: cython.int[::1],
):
    """Make the tree over n triangles; returns the number of its boxes, less than 2n.

    order: (n,) any order of all triangles in, the order that first and last speak of out.
    bounds: (12n,), right, first, last: (2n,), written. stack: (STACK,) scratch.
    """
    leaf: cython.int = 4  # triangles at most
    count: cython.int = len(order)
    boxes: cython.int = 0
    top: cython.int = 0
    box: cython.int
    parent: cython.int
    low: cython.int
    high: cython.int
    middle: cython.int
    i: cython.int
    j: cython.int
    from_: cython.int
    to: cython.int
    swap: cython.int
    axis: cython.int
    widest: cython.int
    at: cython.Py_ssize_t
    x: cython.double
    y: cython.double
    z: cython.double
    least: cython.double
    most: cython.double
    near: cython.double
    far: cython.double
    width: cython.double
    widest_width: cython.double
    pivot: cython.double

    stack[0] = 0
    stack[1] = count
    stack[2] = -1
    top = 3
    while top > 0:
        top -= 3
        low = stack[top]
        high = stack[top + 1]
        parent = stack[top + 2]
        box = boxes
        boxes += 1
        if parent >= 0:
            right[parent] = box
        right[box] = -1
        first[box] = low
        last[box] = high
        widest = 0
        widest_width = -1.0
        for axis in range(3):
            least = 1e300
            most = -1e300
            near = 1e300
            far = -1e300
            for i in range(low, high):
                at = 9 * order[i] + axis
                x = triangles[at]
                y = triangles[at + 3]
                z = triangles[at + 6]
                least = min(least, x, y, z)
                most = max(most, x, y, z)
                x = x + y + z
                near = min(near, x)
                far = max(far, x)
            bounds[6 * box + axis] = least
            bounds[6 * box + 3 + axis] = most
            width = far - near
            if width > widest_width:
                widest_width = width
                widest = axis
        if high - low <= leaf:
            continue

        # Hoare's selection: the lower half of the centers in front.
        middle = low + (high - low) // 2
        from_ = low
        to = high - 1
        while from_ < to:
            at = 9 * order[from_ + (to - from_) // 2] + widest
            pivot = triangles[at] + triangles[at + 3] + triangles[at + 6]
            i = from_
            j = to
            while i <= j:
                while True:
                    at = 9 * order[i] + widest
                    if triangles[at] + triangles[at + 3] + triangles[at + 6] >= pivot:
                        break
                    i += 1
                while True:
                    at = 9 * order[j] + widest
                    if triangles[at] + triangles[at + 3] + triangles[at + 6] <= pivot:
                        break
                    j -= 1
                if i <= j:
                    swap = order[i]
                    order[i] = order[j]
                    order[j] = swap
                    i += 1
                    j -= 1
            if middle <= j:
                to = j
            elif middle >= i:
                from_ = i
            else:
                break

        stack[top] = middle
        stack[top + 1] = high
        stack[top + 2] = box
        stack[top + 3] = low
        stack[top + 4] = middle
        stack[top + 5] = -1
        top += 6
    return boxes


@cython.boundscheck(False)
@cython.wraparound(False)
@cython.cdivision(True)
def sweep(
    triangles: cython.double[::1],
    bounds: cython.double[::1],
    right: cython.int[::1],
    first: cython.int[::1],
    last: cython.int[::1],
    path: cython.double[::1],
    radius: cython.double,
    skin: cython.double,
    slide: cython.double,
    spans: cython.double[::1],
    stack: cython.int[::1],
) -> cython.double:
    """Where along a path the ball touches the triangles, as parts of the path from 0 to 1.

    path: (6,) mm, the ball's center at the start, and the move from there to the end.
    radius: mm, of the ball. skin: mm, a ball this far from the triangles still touches them.
    spans: (2k,); where k = 0, the sweep returns the first contact, 2.0 for none. Otherwise it
    returns the number of triangles touched, and writes the first and last contact with each in
    any order, up to k of them. stack: (STACK,) scratch.
    Error: 1e-11 mm between ball and triangle. A point, radius 0, may slip through a triangle that is
    thinner than 1e-6 mm; a ball does not.
    """
    tries: cython.int = 200
    inner: cython.double = 0.875 * skin
    pad: cython.double = radius + skin + 1e-6
    room: cython.int = len(spans) // 2
    gather: cython.bint = room > 0
    turns: cython.int = 2 if gather else 1
    found: cython.int = 0
    best: cython.double = 2.0
    mx: cython.double = path[3]
    my: cython.double = path[4]
    mz: cython.double = path[5]
    length: cython.double = sqrt(mx * mx + my * my + mz * mz)
    top: cython.int = 1
    box: cython.int
    left: cython.int
    other: cython.int
    axis: cython.int
    k: cython.int
    turn: cython.int
    edge: cython.int
    hit: cython.bint
    inside: cython.bint
    thick: cython.bint
    at: cython.Py_ssize_t
    i: cython.Py_ssize_t
    j: cython.Py_ssize_t
    start: cython.double
    end: cython.double
    near: cython.double
    far: cython.double
    position: cython.double
    entry: cython.double
    u: cython.double
    following: cython.double
    entered: cython.double
    falling: cython.double
    rising: cython.double
    gap: cython.double
    slope: cython.double
    distance: cython.double
    # the ball's center, its way, the triangle's normal, an edge, from corner to center, excess
    ox: cython.double
    oy: cython.double
    oz: cython.double
    vx: cython.double
    vy: cython.double
    vz: cython.double
    px: cython.double
    py: cython.double
    pz: cython.double
    nx: cython.double
    ny: cython.double
    nz: cython.double
    nn: cython.double
    wx: cython.double
    wy: cython.double
    wz: cython.double
    ww: cython.double
    qx: cython.double
    qy: cython.double
    qz: cython.double
    ex: cython.double
    ey: cython.double
    ez: cython.double
    fx: cython.double
    fy: cython.double
    fz: cython.double
    part: cython.double
    square: cython.double
    least: cython.double

    stack[0] = 0
    while top > 0:
        top -= 1
        box = stack[top]
        start = 0.0
        end = best if best < 1.0 else 1.0
        for axis in range(3):
            position = path[axis]
            near = bounds[6 * box + axis] - pad
            far = bounds[6 * box + 3 + axis] + pad
            if path[3 + axis] == 0.0:
                if position < near or position > far:
                    end = -1.0
                continue
            near = (near - position) / path[3 + axis]
            far = (far - position) / path[3 + axis]
            if near > far:
                position = near
                near = far
                far = position
            if near > start:
                start = near
            if far < end:
                end = far
        if start > end:
            continue

        if right[box] >= 0:  # nearer child on top
            left = box + 1
            other = right[box]
            i = 6 * left
            j = 6 * other
            near = (
                (bounds[j] + bounds[j + 3] - bounds[i] - bounds[i + 3]) * mx
                + (bounds[j + 1] + bounds[j + 4] - bounds[i + 1] - bounds[i + 4]) * my
                + (bounds[j + 2] + bounds[j + 5] - bounds[i + 2] - bounds[i + 5]) * mz
            )
            if near >= 0.0:
                stack[top] = other
                stack[top + 1] = left
            else:
                stack[top] = left
                stack[top + 1] = other
            top += 2
            continue

        for k in range(first[box], last[box]):
            at = 9 * k
            wx = triangles[at + 3] - triangles[at]
            wy = triangles[at + 4] - triangles[at + 1]
            wz = triangles[at + 5] - triangles[at + 2]
            qx = triangles[at + 6] - triangles[at]
            qy = triangles[at + 7] - triangles[at + 1]
            qz = triangles[at + 8] - triangles[at + 2]
            nx = wy * qz - wz * qy
            ny = wz * qx - wx * qz
            nz = wx * qy - wy * qx
            nn = nx * nx + ny * ny + nz * nz
            # A sliver's normal is noise; its edges are all there is of it.
            thick = nn > 1e-16 * (wx * wx + wy * wy + wz * wz) * (qx * qx + qy * qy + qz * qz)

            entry = 0.0
            for turn in range(turns):
                if turn == 0:
                    ox = path[0]
                    oy = path[1]
                    oz = path[2]
                    vx = mx
                    vy = my
                    vz = mz
                    u = start
                else:  # the last contact is the first one on the way back
                    ox = path[0] + mx
                    oy = path[1] + my
                    oz = path[2] + mz
                    vx = -mx
                    vy = -my
                    vz = -mz
                    u = 0.0
                hit = False
                entered = 2.0
                falling = -1.0
                rising = -1.0
                for _ in range(tries):
                    px = ox + u * vx
                    py = oy + u * vy
                    pz = oz + u * vz

                    # The excess: from the nearest point of the triangle to the center.
                    inside = thick
                    least = 1e300
                    ex = 0.0
                    ey = 0.0
                    ez = 0.0
                    for edge in range(3):
                        i = at + 3 * edge
                        j = at if edge == 2 else i + 3
                        wx = triangles[j] - triangles[i]
                        wy = triangles[j + 1] - triangles[i + 1]
                        wz = triangles[j + 2] - triangles[i + 2]
                        qx = px - triangles[i]
                        qy = py - triangles[i + 1]
                        qz = pz - triangles[i + 2]
                        if inside:
                            part = nx * (wy * qz - wz * qy) + ny * (wz * qx - wx * qz) + nz * (wx * qy - wy * qx)
                            inside = part >= 0.0
                        ww = wx * wx + wy * wy + wz * wz
                        part = qx * wx + qy * wy + qz * wz
                        if part <= 0.0:
                            part = 0.0
                        elif part >= ww:
                            part = 1.0
                        else:
                            part = part / ww
                        fx = qx - part * wx
                        fy = qy - part * wy
                        fz = qz - part * wz
                        square = fx * fx + fy * fy + fz * fz
                        if square < least:
                            least = square
                            ex = fx
                            ey = fy
                            ez = fz
                    if inside:  # from the nearest edge: a normal's noise has no lever there
                        part = (nx * ex + ny * ey + nz * ez) / nn
                        ex = nx * part
                        ey = ny * part
                        ez = nz * part

                    distance = sqrt(ex * ex + ey * ey + ez * ez)
                    gap = distance - radius
                    slope = ex * vx + ey * vy + ez * vz
                    if rising >= 0.0:  # the bottom is between falling and rising
                        if gap <= 0.0 or slope >= 0.0:
                            rising = u
                        else:
                            falling = u
                        u = (falling + rising) / 2.0
                        if u <= falling or u >= rising:
                            u = rising
                            break
                        continue
                    if gap <= 0.0 or (u == 0.0 and gap <= skin):
                        hit = True
                        break
                    if gap <= skin and not hit:
                        hit = True
                        entered = u
                    slope = slope / distance  # before it is looked at: the smallest become 0 by it
                    if slope >= 0.0:
                        if not hit or falling < 0.0:
                            break
                        rising = u
                        u = (falling + rising) / 2.0
                        continue
                    if u == 1.0:
                        break
                    if hit:
                        falling = u
                    following = u - (gap - inner if gap > skin else gap) / slope
                    if following > 1.0:
                        following = 1.0
                    if (following - u) * length < 1e-13:  # noise
                        break
                    u = following
                    if u > best and not hit:
                        break
                if hit and (u - entered) * length > slide:
                    u = entered
                if turn == 1:
                    if found < room:
                        spans[2 * found] = entry
                        spans[2 * found + 1] = max(entry, 1.0 - u) if hit else entry
                    found += 1
                elif not hit:
                    break
                elif gather:
                    entry = u
                elif u < best:
                    best = u
    return found if gather else best


@cython.boundscheck(False)
@cython.wraparound(False)
@cython.cdivision(True)
def crossings(
    triangles: cython.double[::1],
    bounds: cython.double[::1],
    right: cython.int[::1],
    first: cython.int[::1],
    last: cython.int[::1],
    point: cython.double[::1],
    axis: cython.int,
    stack: cython.int[::1],
) -> cython.int:
    """How many triangles a ray from a point along +axis (0 X, 1 Y, 2 Z) passes through.

    Odd inside a closed surface. A ray through an edge or corner counts as passing beside it, on the
    same side for all triangles there, so that the count's parity holds; the point itself must
    not lie on the surface. point: (3,) mm. stack: (STACK,) scratch.
    """
    u: cython.int = (axis + 1) % 3
    v: cython.int = (axis + 2) % 3
    pu: cython.double = point[u]
    pv: cython.double = point[v]
    count: cython.int = 0
    top: cython.int = 1
    box: cython.int
    k: cython.int
    edge: cython.int
    odd: cython.bint
    base: cython.Py_ssize_t
    i: cython.Py_ssize_t
    j: cython.Py_ssize_t
    au: cython.double
    av: cython.double
    bu: cython.double
    bv: cython.double
    swap: cython.double
    ru: cython.double
    rv: cython.double
    normal: cython.double
    height: cython.double

    stack[0] = 0
    while top > 0:
        top -= 1
        box = stack[top]
        base = 6 * box
        if (
            bounds[base + u] > pu
            or bounds[base + 3 + u] < pu
            or bounds[base + v] > pv
            or bounds[base + 3 + v] < pv
            or bounds[base + 3 + axis] < point[axis]
        ):
            continue
        if right[box] >= 0:
            stack[top] = right[box]
            stack[top + 1] = box + 1
            top += 2
            continue
        for k in range(first[box], last[box]):
            base = 9 * k
            odd = False
            for edge in range(3):
                i = base + 3 * edge
                j = base if edge == 2 else i + 3
                au = triangles[i + u]
                av = triangles[i + v]
                bu = triangles[j + u]
                bv = triangles[j + v]
                if (av > pv) == (bv > pv):
                    continue
                if bv < av:  # from below, so that both neighbors reckon the same bits
                    swap = au
                    au = bu
                    bu = swap
                    swap = av
                    av = bv
                    bv = swap
                if au + (pv - av) * ((bu - au) / (bv - av)) > pu:
                    odd = not odd
            if not odd:
                continue
            # Where the ray meets the triangle's plane: from the first corner along two edges.
            au = triangles[base + 3 + u] - triangles[base + u]
            av = triangles[base + 3 + v] - triangles[base + v]
            bu = triangles[base + 6 + u] - triangles[base + u]
            bv = triangles[base + 6 + v] - triangles[base + v]
            ru = pu - triangles[base + u]
            rv = pv - triangles[base + v]
            normal = au * bv - av * bu
            height = triangles[base + axis]
            if normal != 0.0:
                height += (
                    (triangles[base + 3 + axis] - height) * (ru * bv - rv * bu)
                    + (triangles[base + 6 + axis] - height) * (au * rv - av * ru)
                ) / normal
            if height > point[axis]:
                count += 1
    return count
