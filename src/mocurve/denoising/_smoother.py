"""Penalised least squares of order 3 on a uniform grid: min sum w (y - x)^2 + lambda sum (third difference of x)^2.

The matrix W + lambda D'D has half-bandwidth 3. It is factored as L D L' (Golub and Van Loan, section 4.3); the diagonal
of its inverse, which cross-validation and predicted variances need, follows from the factors by Takahashi's recursion
(Erisman and Tinney 1975). A factor belongs to weights and lambda alone, so channels without masked frames share it.

Each step of these recursions waits for the one before, so LANES channels go side by side: arrays are (n, LANES), those
of the factors and of the fit with MARGIN rows of zeros before and after.
"""

from __future__ import annotations

import numpy as np

from .._jit import kernel

LANES = 8
MARGIN = 3
LEAST_PIVOT = 1e-14  # where a run of masked frames leaves nothing but rounding
FIRST, SECOND, THIRD, INVERSE, DIAGONAL = range(5)  # of the parts


@kernel
def factor(w, smoothing, parts):
    """Factors of W + smoothing D'D: rows of L (first, second, third below the diagonal), 1/D, and diag of the inverse.

    w (n, LANES) weights; smoothing (LANES,); parts (5, n + 2 MARGIN, LANES), overwritten but for the margins of 0."""
    n = len(w)
    first, second, third = parts[FIRST], parts[SECOND], parts[THIRD]
    inverse, diagonal = parts[INVERSE], parts[DIAGONAL]
    for i in range(n):
        p0, p1, p2, p3 = penalty(i, n)
        r = i + MARGIN
        for k in range(LANES):
            e3 = smoothing[k] * p3
            e2 = smoothing[k] * p2 - e3 * first[r - 2, k]
            e1 = smoothing[k] * p1 - e3 * second[r - 1, k] - e2 * first[r - 1, k]
            l3, l2, l1 = e3 * inverse[r - 3, k], e2 * inverse[r - 2, k], e1 * inverse[r - 1, k]
            pivot = max(w[i, k] + smoothing[k] * p0 - e3 * l3 - e2 * l2 - e1 * l1, LEAST_PIVOT)
            first[r, k], second[r, k], third[r, k], inverse[r, k] = l1, l2, l3, 1.0 / pivot
    z = np.zeros((6, LANES))  # of the inverse, at the three rows below: 11, 12, 13, 22, 23, 33
    for r in range(n + MARGIN - 1, MARGIN - 1, -1):
        for k in range(LANES):
            l1, l2, l3 = first[r + 1, k], second[r + 2, k], third[r + 3, k]
            y1 = -(l1 * z[0, k] + l2 * z[1, k] + l3 * z[2, k])
            y2 = -(l1 * z[1, k] + l2 * z[3, k] + l3 * z[4, k])
            y3 = -(l1 * z[2, k] + l2 * z[4, k] + l3 * z[5, k])
            z[5, k], z[4, k], z[3, k], z[2, k], z[1, k] = z[3, k], z[1, k], z[0, k], y2, y1
            z[0, k] = inverse[r, k] - (l1 * y1 + l2 * y2 + l3 * y3)
            diagonal[r, k] = z[0, k]


@kernel
def penalty(i, n):
    """Row i of D'D on and below the diagonal, D the third differences of n values."""
    if 3 <= i < n - 3:
        return 20.0, -15.0, 6.0, -1.0
    p0 = p1 = p2 = p3 = 0.0
    for r in range(max(0, i - 3), min(i, n - 4) + 1):  # difference r has -1, 3, -3, 1 at r ... r+3
        at = weight(i - r)
        p0 += at * at
        if i > r:
            p1 += at * weight(i - 1 - r)
        if i > r + 1:
            p2 += at * weight(i - 2 - r)
        if i > r + 2:
            p3 += at * weight(i - 3 - r)
    return p0, p1, p2, p3


@kernel
def weight(k):
    return -1.0 if k == 0 else 3.0 if k == 1 else -3.0 if k == 2 else 1.0


@kernel
def substitute(y, w, parts, x):
    """The fit x (n + 2 MARGIN, LANES), with margins of 0, to y (n, LANES), given the factors."""
    n = len(y)
    first, second, third, inverse = parts[FIRST], parts[SECOND], parts[THIRD], parts[INVERSE]
    for i in range(n):
        r = i + MARGIN
        for k in range(LANES):
            known = w[i, k] * y[i, k] - third[r, k] * x[r - 3, k] - second[r, k] * x[r - 2, k]
            x[r, k] = known - first[r, k] * x[r - 1, k]
    for r in range(n + MARGIN - 1, MARGIN - 1, -1):
        for k in range(LANES):
            known = x[r, k] * inverse[r, k] - third[r + 3, k] * x[r + 3, k] - second[r + 2, k] * x[r + 2, k]
            x[r, k] = known - first[r + 1, k] * x[r + 1, k]
