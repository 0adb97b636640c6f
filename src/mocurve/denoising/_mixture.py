"""How strongly to smooth: cross-validated for the whole channel, then mixed frame by frame over nearby strengths."""

from __future__ import annotations

import numpy as np

from .._jit import kernel
from ._smoother import DIAGONAL, LANES, MARGIN, factor, substitute


@kernel
def scores(y, w, gaps, grid, wanted, squares, traces):
    """Squared residuals and trace of the smoother, over the kept frames, where wanted (C, G).

    y, w (C, n); gaps (C,) whether any w is 0; grid (G,) values of lambda; squares, traces (C, G) are filled there."""
    parts, x = room(y.shape[1])
    some = np.zeros(len(y), np.bool_)
    for c in range(len(y)):
        some[c] = wanted[c].any()
    for own in (False, True):
        rows = blocks(some & (gaps == own))
        values, weights = packed(y, rows), packed(w, rows)
        for g in range(len(grid)):
            made = False
            for b in range(len(rows)):
                asked = False
                for k in range(LANES):
                    asked = asked or wanted[rows[b, k], g]
                if not asked:
                    continue
                if own or not made:
                    factor(weights[b], np.full(LANES, grid[g]), parts)
                    made = True
                substitute(values[b], weights[b], parts, x)
                left, trace = residuals(values[b], weights[b], parts, x)
                for k in range(LANES):
                    if wanted[rows[b, k], g]:
                        squares[rows[b, k], g], traces[rows[b, k], g] = left[k], trace[k]


@kernel
def blocks(chosen):
    """(B, LANES) numbers of the chosen channels (C,); the last one is repeated where there are no more."""
    rows = np.flatnonzero(chosen)
    found = np.empty((-(-len(rows) // LANES), LANES), np.int64)
    for place in range(found.size):
        found[place // LANES, place % LANES] = rows[min(place, len(rows) - 1)]
    return found


@kernel
def packed(a, rows):
    """(B, n, LANES) of a (C, n)."""
    out = np.empty((len(rows), a.shape[1], LANES))
    for b in range(len(rows)):
        for i in range(a.shape[1]):
            for k in range(LANES):
                out[b, i, k] = a[rows[b, k], i]
    return out


@kernel
def room(n):
    """For the factors and the fit of a block."""
    return np.zeros((5, n + 2 * MARGIN, LANES)), np.zeros((n + 2 * MARGIN, LANES))


@kernel
def residuals(y, w, parts, x):
    """(LANES,) sums of squared residuals of the kept frames, and traces of the smoother."""
    squares, trace = np.zeros(LANES), np.zeros(LANES)
    for i in range(len(y)):
        for k in range(LANES):
            squares[k] += w[i, k] * (y[i, k] - x[i + MARGIN, k]) ** 2
            trace[k] += w[i, k] * parts[DIAGONAL, i + MARGIN, k]
    return squares, trace


@kernel
def fit(y, w, smoothing, x, variance):
    """Fits (C, n) at one lambda a channel, and the diagonal of the inverse: variance of the fit over that of noise."""
    n = y.shape[1]
    parts, fitted = room(n)
    rows = blocks(np.ones(len(y), np.bool_))
    for b in range(len(rows)):
        weights = packed(w, rows[b : b + 1])[0]
        factor(weights, smoothing[rows[b]], parts)
        substitute(packed(y, rows[b : b + 1])[0], weights, parts, fitted)
        for k in range(LANES):
            for i in range(n):
                x[rows[b, k], i] = fitted[i + MARGIN, k]
                variance[rows[b, k], i] = parts[DIAGONAL, i + MARGIN, k]


@kernel
def mix(y, w, gaps, grid, softest, centre, below, above, sigma, reach, temperature, prior, x):
    """x (C, n): average of the fits at the strengths from centre - below (at least grid[softest]) to centre + above,
    weighted frame by frame.

    Weights fall with the local risk of each fit, Stein's unbiased estimate summed over +-reach frames (a box, and once
    more one of half the width), and with the distance from the cross-validated centre (C,), in steps of the grid."""
    channels, n = y.shape
    parts, fitted = room(n)
    risk, spare = np.empty(n), np.empty(n)
    best, total = np.full((channels, n), -np.inf), np.zeros((channels, n))
    for own in (False, True):
        rows = blocks(gaps == own)
        values, weights = packed(y, rows), packed(w, rows)
        for g in range(softest, len(grid)):
            away, made = g - centre, False
            used = (away >= -below) & (away <= above)
            for b in range(len(rows)):
                if not used[rows[b]].any():
                    continue
                if own or not made:
                    factor(weights[b], np.full(LANES, grid[g]), parts)
                    made = True
                substitute(values[b], weights[b], parts, fitted)
                for k in range(LANES):
                    c = rows[b, k]
                    if not used[c] or (k > 0 and c == rows[b, k - 1]):
                        continue
                    noise = sigma[c] * sigma[c]
                    one, freedom = fitted[MARGIN:, k], parts[DIAGONAL, MARGIN:, k]
                    for i in range(n):
                        risk[i] = w[c, i] * ((y[c, i] - one[i]) ** 2 + (2.0 * freedom[i] - 1.0) * noise)
                    box(risk, reach, spare)
                    box(spare, max(1, reach // 2), risk)
                    scale = (2 * reach + 1) / (temperature * noise + 1e-300)
                    blend(one, risk, scale, prior * abs(away[c]), best[c], total[c], x[c])
    for c in range(channels):
        for i in range(n):
            x[c, i] /= total[c, i]


@kernel
def blend(one, risk, scale, away, best, total, x):
    """Adds a fit to x (n,), weighted by exp(-risk * scale - away); total: the weights, best: the largest exponent so
    far, which all weights are told relative to."""
    for i in range(len(x)):
        told = -risk[i] * scale - away
        if told > best[i]:
            fade = np.exp(best[i] - told)
            total[i] = total[i] * fade + 1.0
            x[i] = (x[i] * fade if total[i] > 1.0 else 0.0) + one[i]
            best[i] = told
        else:
            share = np.exp(told - best[i])
            total[i] += share
            x[i] += share * one[i]


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
