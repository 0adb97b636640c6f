"""The set of states in which a segment can end, as a convex polygon whose corners are true extreme points."""

from __future__ import annotations

import numpy as np

from .._jit import kernel
from ._strips import CUBIC, ROUNDING, aim, solve, start_basis, start_strips


@kernel
def new_supports(corners: int) -> tuple[np.ndarray, np.ndarray]:
    """Room for `corners` supports (see `support`), and for their counterclockwise order."""
    return np.empty((corners, ROUNDING + 1, 4)), np.empty(corners, np.int64)


@kernel(fastmath=True)
def support(
    lp: np.ndarray, count: int, y: np.ndarray, half: np.ndarray, i: int, j: int, dv: float, dm: float, s: np.ndarray
) -> bool:
    """The end state furthest in the direction (dv, dm); False if there is none.

    Into s: row 0 the state (value from y[i], slope per segment) and the direction; below it the program's basis, from
    which directions nearby need few pivots.
    """
    aim(lp, 1.0, dv, dm)
    if solve(lp, count, y, half, i, j, 1.0 / (j - i)) > 0:
        return False
    x0, x1, x2, x3 = lp[CUBIC, 0], lp[CUBIC, 1], lp[CUBIC, 2], lp[CUBIC, 3]
    s[0, 0], s[0, 1], s[0, 2], s[0, 3] = x0 + x1 + x2 + x3, x1 + 2.0 * x2 + 3.0 * x3, dv, dm
    for r in range(ROUNDING):
        for a in range(4):
            s[1 + r, a] = lp[r, a]
    return True


@kernel
def take_basis(lp: np.ndarray, s: np.ndarray) -> None:
    """Go on from the basis of a support."""
    for r in range(ROUNDING):
        for a in range(4):
            lp[r, a] = s[1 + r, a]


@kernel(fastmath=True)
def first_supports(
    lp: np.ndarray,
    start: np.ndarray,
    count: int,
    y: np.ndarray,
    half: np.ndarray,
    i: int,
    j: int,
    s: np.ndarray,
    order: np.ndarray,
) -> bool:
    """Four supports, counterclockwise: largest and least value, and the furthest to either side of their line."""
    span = float(j - i)
    start_strips(lp, start, count, span)
    start_basis(lp, count, y, half, i, j, span)
    if not support(lp, count, y, half, i, j, 1.0, 0.0, s[0]) or not support(lp, count, y, half, i, j, -1.0, 0.0, s[2]):
        return False
    dx, dy = s[2, 0, 0] - s[0, 0, 0], s[2, 0, 1] - s[0, 0, 1]
    if not support(lp, count, y, half, i, j, dy, -dx, s[1]):
        return False
    take_basis(lp, s[0])
    order[0], order[1], order[2], order[3] = 0, 1, 2, 3
    return support(lp, count, y, half, i, j, -dy, dx, s[3])


@kernel(fastmath=True)
def missing(p: np.ndarray, q: np.ndarray) -> float:
    """Area that may be missing beyond the edge from support p to q: triangle of the edge and both supporting lines."""
    dx, dy = q[0] - p[0], q[1] - p[1]
    turn = p[2] * q[3] - p[3] * q[2]
    return -0.5 * (q[2] * dx + q[3] * dy) * (p[3] * dy + p[2] * dx) / turn if turn > 0.0 else 0.0


@kernel(fastmath=True)
def arrive(
    lp: np.ndarray,
    start: np.ndarray,
    count: int,
    y: np.ndarray,
    half: np.ndarray,
    i: int,
    j: int,
    most: int,
    floor: float,
    s: np.ndarray,
    order: np.ndarray,
    polygon: np.ndarray,
) -> int:
    """Polygon of states (value from y[j], slope per frame) at frame j reached from the polygon `start` at frame i.

    Returns its corners, at most `most`; 0: there is none, or its area cannot be more than `floor`.
    Sandwich: each support bounds the set by a line as well; the next direction is square to the edge beyond which most
    area may be missing.
    """
    if not first_supports(lp, start, count, y, half, i, j, s, order):
        return 0
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
            return 0
        if at < 0:
            break
        p, q = s[order[at], 0], s[order[at + 1 if at + 1 < n else 0], 0]
        take_basis(lp, s[order[at]])
        if not support(lp, count, y, half, i, j, q[1] - p[1], p[0] - q[0], s[n]):
            break
        for k in range(n, at + 1, -1):
            order[k] = order[k - 1]
        order[at + 1] = n
        n += 1
    return distinct(s, order, n, y[i] - y[j], float(j - i), polygon)


@kernel(fastmath=True)
def distinct(s: np.ndarray, order: np.ndarray, n: int, shift: float, span: float, polygon: np.ndarray) -> int:
    """Write the supports, without repeated ones, as a polygon of states. Returns its corners."""
    size = 0
    for k in range(n):
        p, q = s[order[k], 0], s[order[k - 1 if k > 0 else n - 1], 0]
        if p[0] != q[0] or p[1] != q[1]:
            polygon[size, 0], polygon[size, 1] = p[0] + shift, p[1] / span
            size += 1
    return size
