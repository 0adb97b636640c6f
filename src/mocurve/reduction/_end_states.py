"""The set of states in which a segment can end, as a convex polygon whose corners are true extreme points."""

from __future__ import annotations

import numpy as np

from .._jit import kernel
from ._strips import CUBIC, EDGES, aim, solve, start_basis, start_strips

THIN = 1e-9  # less area than this, in half-widths, is taken for a point that rounding may lose


@kernel
def new_supports(corners):
    """Room for `corners` supports (see `support`), and for their counterclockwise order."""
    return np.empty((corners, EDGES + 1, 4)), np.empty(corners, np.int64)


@kernel(fastmath=True)
def support(lp, count, y, half, i, j, dv, dm, s):
    """The end state furthest in the direction (dv, dm). Into s: row 0 the state (value from y[i], slope per segment) and the
    direction, below it the program's basis, from which directions nearby need few pivots."""
    aim(lp, 1.0, dv, dm)
    if solve(lp, count, y, half, i, j, 1.0 / (j - i)) > 0:
        return False
    x0, x1, x2, x3 = lp[CUBIC, 0], lp[CUBIC, 1], lp[CUBIC, 2], lp[CUBIC, 3]
    s[0, 0], s[0, 1], s[0, 2], s[0, 3] = x0 + x1 + x2 + x3, x1 + 2.0 * x2 + 3.0 * x3, dv, dm
    s[1:] = lp[:EDGES]
    return True


@kernel(fastmath=True)
def first_supports(lp, start, count, y, half, i, j, s, order):
    """Four supports in counterclockwise order: least and largest value, and the furthest to either side of their line."""
    span = float(j - i)
    start_strips(lp, start, count, span)
    start_basis(lp, count, y, half, i, j, span)
    if not support(lp, count, y, half, i, j, 1.0, 0.0, s[0]) or not support(lp, count, y, half, i, j, -1.0, 0.0, s[2]):
        return False
    dx, dy = s[2, 0, 0] - s[0, 0, 0], s[2, 0, 1] - s[0, 0, 1]
    if not support(lp, count, y, half, i, j, dy, -dx, s[1]):
        return False
    lp[:EDGES] = s[0, 1:]
    order[0], order[1], order[2], order[3] = 0, 1, 2, 3
    return support(lp, count, y, half, i, j, -dy, dx, s[3])


@kernel(fastmath=True)
def missing(p, q):
    """Area that may be missing beyond the edge from support p to q: triangle of the edge and the two supporting lines."""
    dx, dy = q[0] - p[0], q[1] - p[1]
    turn = p[2] * q[3] - p[3] * q[2]
    return -0.5 * (q[2] * dx + q[3] * dy) * (p[3] * dy + p[2] * dx) / turn if turn > 0.0 else 0.0


@kernel(fastmath=True)
def arrive(lp, start, count, y, half, i, j, most, floor, s, order, polygon):
    """Polygon of states at frame j reached from the polygon `start` at frame i: corners (0: none) and area.

    Sandwich: each support bounds the set by a line as well; the next direction is square to the edge beyond which most area
    may be missing. Given up once the area cannot become more than `floor`."""
    if not first_supports(lp, start, count, y, half, i, j, s, order):
        return 0, 0.0
    n = 4
    while n < most:
        largest, at, outer = 0.0, -1, 0.0
        for k in range(n):
            p, q = s[order[k], 0], s[order[k + 1 if k + 1 < n else 0], 0]
            gain = missing(p, q)
            outer += gain + 0.5 * (p[0] * q[1] - p[1] * q[0])
            if gain > largest:
                largest, at = gain, k
        if outer <= floor * (j - i):
            return 0, 0.0
        if at < 0:
            break
        p, q = s[order[at], 0], s[order[at + 1 if at + 1 < n else 0], 0]
        lp[:EDGES] = s[order[at], 1:]
        if not support(lp, count, y, half, i, j, q[1] - p[1], p[0] - q[0], s[n]):
            break
        for k in range(n, at + 1, -1):
            order[k] = order[k - 1]
        order[at + 1] = n
        n += 1
    return write_polygon(s, order, n, y[i] - y[j], float(j - i), THIN * half[j] * half[j], polygon)


@kernel(fastmath=True)
def write_polygon(s, order, n, shift, span, thin, polygon):
    """The distinct supports as a polygon of states (value, slope per frame). Returns its corners (0 if thin) and area."""
    size = 0
    for k in range(n):
        p, q = s[order[k], 0], s[order[k - 1 if k > 0 else n - 1], 0]
        if p[0] != q[0] or p[1] != q[1]:
            polygon[size, 0], polygon[size, 1] = p[0] + shift, p[1] / span
            size += 1
    area = 0.0
    for k in range(1, size - 1):
        area += (polygon[k, 0] - polygon[0, 0]) * (polygon[k + 1, 1] - polygon[0, 1])
        area -= (polygon[k, 1] - polygon[0, 1]) * (polygon[k + 1, 0] - polygon[0, 0])
    area *= 0.5
    return (size, area) if size >= 3 and area * span > thin else (0, 0.0)
