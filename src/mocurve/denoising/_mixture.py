"""How strongly to smooth: cross-validated for the whole channel, then mixed frame by frame over nearby strengths."""

from __future__ import annotations

import numpy as np

from .._jit import kernel
from ._smoother import factor, substitute


@kernel
def scores(y, w, gaps, grid, wanted, squares, traces):
    """Squared residuals and trace of the smoother, over the kept frames, where wanted (C, G).

    y, w (C, n); gaps (C,) whether any w is 0; grid (G,) values of lambda; squares, traces (C, G) are filled there."""
    channels, n = y.shape
    shared, own = np.empty((5, n)), np.empty((5, n))
    x, ones = np.empty(n), np.ones(n)
    for g in range(len(grid)):
        whole = 0.0
        for c in range(channels):
            if not wanted[c, g]:
                continue
            if gaps[c]:
                factors(w[c], grid[g], own)
                squares[c, g], traces[c, g] = residuals(y[c], w[c], own, x), trace(w[c], own)
                continue
            if whole == 0.0:
                factors(ones, grid[g], shared)
                whole = trace(ones, shared)
            squares[c, g], traces[c, g] = residuals(y[c], w[c], shared, x), whole


@kernel
def factors(w, smoothing, out):
    factor(w, smoothing, out[0], out[1], out[2], out[3], out[4])


@kernel
def fitted(y, w, parts, x):
    substitute(y, w, parts[0], parts[1], parts[2], parts[3], x)


@kernel
def trace(w, parts):
    total = 0.0
    for i in range(len(w)):
        total += w[i] * parts[4, i]
    return total


@kernel
def residuals(y, w, parts, x):
    """Sum of squared residuals of the kept frames."""
    fitted(y, w, parts, x)
    total = 0.0
    for i in range(len(y)):
        total += w[i] * (y[i] - x[i]) ** 2
    return total


@kernel
def fit(y, w, gaps, smoothing, x, variance):
    """Fits (C, n) at one lambda a channel, and the diagonal of the inverse: variance of the fit over that of noise."""
    channels, n = y.shape
    parts, at = np.empty((5, n)), -1.0
    for c in range(channels):
        if gaps[c] or smoothing[c] != at:
            factors(w[c], smoothing[c], parts)
            at = -1.0 if gaps[c] else smoothing[c]
        fitted(y[c], w[c], parts, x[c])
        for i in range(n):
            variance[c, i] = parts[4, i]


@kernel
def mix(y, w, gaps, grid, softest, centre, below, above, sigma, reach, temperature, prior, x):
    """x (C, n): average of the fits at the strengths from centre - below (at least grid[softest]) to centre + above,
    weighted frame by frame.

    Weights fall with the local risk of each fit, Stein's unbiased estimate summed over +-reach frames (a box, and once
    more one of half the width), and with the distance from the cross-validated centre (C,), in steps of the grid."""
    channels, n = y.shape
    shared, own = np.empty((5, n)), np.empty((5, n))
    ones, one, risk, spare = np.ones(n), np.empty(n), np.empty(n), np.empty(n)
    best, total = np.full((channels, n), -np.inf), np.zeros((channels, n))
    for g in range(softest, len(grid)):
        made = False
        for c in range(channels):
            if not -below <= g - centre[c] <= above:
                continue
            parts = own if gaps[c] else shared
            if gaps[c] or not made:
                factors(w[c] if gaps[c] else ones, grid[g], parts)
                made = made or not gaps[c]
            fitted(y[c], w[c], parts, one)
            noise = sigma[c] * sigma[c]
            for i in range(n):
                risk[i] = w[c, i] * ((y[c, i] - one[i]) ** 2 + (2.0 * parts[4, i] - 1.0) * noise)
            box(risk, reach, spare)
            box(spare, max(1, reach // 2), risk)
            scale = (2 * reach + 1) / (temperature * noise + 1e-300)
            away = prior * abs(g - centre[c])
            for i in range(n):
                told = -risk[i] * scale - away
                if told > best[c, i]:
                    fade = np.exp(best[c, i] - told)
                    total[c, i] = total[c, i] * fade + 1.0
                    x[c, i] = (x[c, i] * fade if total[c, i] > 1.0 else 0.0) + one[i]
                    best[c, i] = told
                else:
                    share = np.exp(told - best[c, i])
                    total[c, i] += share
                    x[c, i] += share * one[i]
    for c in range(channels):
        for i in range(n):
            x[c, i] /= total[c, i]


@kernel
def box(a, reach, out):
    """Mean over the frames within reach that there are."""
    n, total = len(a), 0.0
    for i in range(min(reach, n)):
        total += a[i]
    for i in range(n):
        if i + reach < n:
            total += a[i + reach]
        if i > reach:
            total -= a[i - reach - 1]
        out[i] = total / (min(n - 1, i + reach) - max(0, i - reach) + 1)
