"""Penalised least squares of order 3 on a uniform grid: min sum w (y - x)^2 + lambda sum (third difference of x)^2.

The matrix W + lambda D'D has half-bandwidth 3. It is factored as L D L' (Golub and Van Loan, section 4.3); the diagonal
of its inverse, which cross-validation and predicted variances need, follows from the factors by Takahashi's recursion
(Erisman and Tinney 1975). A factor belongs to weights and lambda alone, so channels without masked frames share it.
"""

from __future__ import annotations

from .._jit import kernel

ORDER = 3
LEAST_PIVOT = 1e-14  # where a run of masked frames leaves nothing but rounding


@kernel
def factor(w, smoothing, first, second, third, inverse, diagonal):
    """Factors of W + smoothing D'D: rows of L (first, second, third below the diagonal), 1/D, and diag of the inverse.

    w (n,) weights; all others (n,), overwritten."""
    n = len(w)
    a1 = a2 = 0.0  # the row before: its entries of L one and two below the diagonal
    b1 = 0.0  # two rows before
    r1 = r2 = r3 = 0.0  # 1/D of the three rows before
    for i in range(n):
        p0, p1, p2, p3 = penalty(i, n)
        e3 = smoothing * p3
        e2 = smoothing * p2 - e3 * b1
        e1 = smoothing * p1 - e3 * a2 - e2 * a1
        l3, l2, l1 = e3 * r3, e2 * r2, e1 * r1
        pivot = max(w[i] + smoothing * p0 - e3 * l3 - e2 * l2 - e1 * l1, LEAST_PIVOT)
        first[i], second[i], third[i], inverse[i] = l1, l2, l3, 1.0 / pivot
        b1, a1, a2 = a1, l1, l2
        r3, r2, r1 = r2, r1, inverse[i]
    z11 = z12 = z13 = z22 = z23 = z33 = 0.0  # of the inverse, at the three rows below
    l1 = l2 = l3 = 0.0
    for i in range(n - 1, -1, -1):
        l1 = first[i + 1] if i + 1 < n else 0.0
        l2 = second[i + 2] if i + 2 < n else 0.0
        l3 = third[i + 3] if i + 3 < n else 0.0
        y1 = -(l1 * z11 + l2 * z12 + l3 * z13)
        y2 = -(l1 * z12 + l2 * z22 + l3 * z23)
        y3 = -(l1 * z13 + l2 * z23 + l3 * z33)
        z33, z23, z22 = z22, z12, z11
        z13, z12 = y2, y1
        z11 = inverse[i] - (l1 * y1 + l2 * y2 + l3 * y3)
        diagonal[i] = z11


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
def substitute(y, w, first, second, third, inverse, x):
    """x (n,): the fit to y, given the factors."""
    n = len(y)
    b1 = b2 = b3 = 0.0
    for i in range(n):
        b = (w[i] * y[i] - third[i] * b3 - second[i] * b2) - first[i] * b1
        x[i] = b
        b3, b2, b1 = b2, b1, b
    b1 = b2 = b3 = 0.0
    l1 = l2 = l3 = 0.0
    for i in range(n - 1, -1, -1):
        l1 = first[i + 1] if i + 1 < n else 0.0
        l2 = second[i + 2] if i + 2 < n else 0.0
        l3 = third[i + 3] if i + 3 < n else 0.0
        b = (x[i] * inverse[i] - l3 * b3 - l2 * b2) - l1 * b1
        x[i] = b
        b3, b2, b1 = b2, b1, b
