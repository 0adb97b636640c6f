"""How much speaks for a run of frames being foreign to a motion rather than part of it: log odds of two explanations.

Motion is a curve whose third differences are drawn at random, as the smoothing assumes, with a scale that is not known
and may be large where a kick is (Student's t). A foreign run is the same curve plus a plateau: it leaps out, stays
about there, and leaps back. The odds are those of the two explanations given the frames around (Kass and Raftery 1995),
together with how large the leaps are, beside the curvature of the motion around and as such. The weights of these four
were found by logistic regression on runs of known kind.
"""

from __future__ import annotations

from math import lgamma

import numpy as np

from .._jit import kernel

REACH, LONGEST = 12, 12  # frames looked at on both sides of a run; of a run
SIZE = 2 * REACH + LONGEST
TAIL = 2.0  # degrees of freedom of the scale: the fewer, the more kicks are expected
RANGE = 80.0  # degrees that a plateau may be off
WAVE, LEAST_WAVE, LASTS = 0.3, 3.0, 3.0  # part of its height, degrees and frames in which a plateau wanders
NEAR = 8  # frames in which curvature counts
FAVOURED, VISIBLE = 3.0, 4.0  # log odds of the curves alone, and deviations of noise, that there have to be
ODDS, LESS, MORE, CURVED, LONG, BIAS = 0.22, 2.12, 2.67, 1.74, 1.21, -11.1  # weights of evidence
TELLING = 25.0  # degrees: a larger leap tells nothing more
ONCE = 2.0  # log odds that a run at an end of the clip is short of: nobody saw it leap back
NEVER, ONE_SIDED = -50.0, -49.5  # log odds of what the curves do not speak for; of what does not leap in and out


@kernel
def root(smoothing):
    """(SIZE, 4) rows of the Cholesky factor of D D' + 1/smoothing, D third differences; its start serves fewer."""
    factor = np.zeros((SIZE, 4))  # factor[i, k] is entry i, i - k
    for i in range(SIZE):
        for k in range(min(i, 3), -1, -1):
            j = i - k
            left = 20.0 + 1.0 / smoothing if k == 0 else -15.0 if k == 1 else 6.0 if k == 2 else -1.0
            for h in range(max(0, i - 3), j):
                left -= factor[i, i - h] * factor[j, j - h]
            factor[i, k] = np.sqrt(max(left, 1e-12)) if k == 0 else left / factor[j, 0]
    return factor


@kernel
def whiten(factor, b):
    """Solves L x = b in place."""
    for i in range(len(b)):
        for k in range(1, min(i, 3) + 1):
            b[i] -= factor[i, k] * b[i - k]
        b[i] /= factor[i, 0]


@kernel
def differences(y, sigma, factor, first, size):
    """The whitened third differences (size,) of a channel from a frame on."""
    z = np.empty(max(size, 0))
    for i in range(size):
        at = first + i
        z[i] = (y[at + 3] - 3.0 * y[at + 2] + 3.0 * y[at + 1] - y[at]) / sigma
    whiten(factor, z)
    return z


@kernel
def column(factor, frame, size, basis, known):
    """What one frame adds to the whitened third differences, less what the first `known` rows of the basis explain."""
    v = np.zeros(size)
    for r in range(max(0, frame - 3), min(size - 1, frame) + 1):
        step = frame - r
        v[r] = -1.0 if step == 0 else 3.0 if step == 1 else -3.0 if step == 2 else 1.0
    whiten(factor, v)
    for row in range(known):
        v -= (v * basis[row]).sum() * basis[row]
    return v


@kernel
def cholesky(a):
    """Factors a (m, m) in place, lower part."""
    for i in range(len(a)):
        for j in range(i + 1):
            left = a[i, j]
            for k in range(j):
                left -= a[i, k] * a[j, k]
            a[i, j] = np.sqrt(max(left, 1e-12)) if i == j else left / a[j, j]


@kernel
def solved(a, b):
    """(m,) L^-1 b."""
    x = b.copy()
    for i in range(len(b)):
        for k in range(i):
            x[i] -= a[i, k] * x[k]
        x[i] /= a[i, i]
    return x


@kernel
def solved_back(a, b):
    """(m,) L'^-1 b."""
    x = b.copy()
    for i in range(len(b) - 1, -1, -1):
        for k in range(i + 1, len(b)):
            x[i] -= a[k, i] * x[k]
        x[i] /= a[i, i]
    return x


@kernel
def log_diagonal(a):
    total = 0.0
    for i in range(len(a)):
        total += np.log(a[i, i])
    return total


@kernel
def likelihood(freedom, squares):
    """Log likelihood of whitened differences of unknown scale, but for what all explanations share."""
    half = 0.5 * (freedom + TAIL)
    return lgamma(half) - half * np.log(TAIL + squares) - 0.5 * freedom * np.log(np.pi)


@kernel
def plateau(gram, pull, squares, freedom, scale, sigma, unit):
    """Log likelihood of a plateau that wanders: its height, and about it a first-order autoregression.

    gram (m, m), pull (m,): normal equations of the run's deviations; scale: variance there, in that of noise."""
    m = len(gram)
    total, sums = gram.sum(), pull.sum()
    level = -0.5 * np.log(total) + np.log(sigma / (RANGE * unit))
    flat = likelihood(freedom - 1, max(squares - sums * sums / total, 0.0)) + level
    wave = max(LEAST_WAVE * unit, WAVE * abs(sums / total) * sigma, VISIBLE * sigma)
    stiff, keeps = scale * (sigma / wave) ** 2 + 1e-12, np.exp(-1.0 / LASTS)
    fresh = 1.0 / (1.0 - keeps * keeps)
    a = gram.copy()
    for i in range(m):
        a[i, i] += stiff * fresh * (1.0 + keeps * keeps if 0 < i < m - 1 else 1.0)
        if i:
            a[i, i - 1] -= stiff * fresh * keeps
    cholesky(a)
    waves, ones = solved(a, pull), solved(a, gram.sum(axis=1))
    rest = max(total - (ones * ones).sum(), 1e-12)
    height = sums - (ones * waves).sum()
    left = max(squares - (waves * waves).sum() - height * height / rest, 0.0)
    spread = 2.0 * log_diagonal(a) - m * np.log(stiff) - (m - 1) * np.log(fresh) + np.log(rest)
    wavy = likelihood(freedom - 1, left) - 0.5 * spread + np.log(sigma / (RANGE * unit))
    return max(flat, wavy) + np.log1p(np.exp(-abs(flat - wavy)))


@kernel
def evidence(y, sigma, factor, p, q, left_out, unit, off):
    """Log odds that frames p ... q - 1 of a channel y (n,) are foreign; off (m,) is how far they are.

    sigma: noise; factor: `root` of the smoothing; left_out (n,) frames that are no motion already; unit: one degree."""
    first, last, m = max(0, p - REACH), min(len(y), q + REACH), q - p
    size = last - first - 3
    z = differences(y, sigma, factor, first, size)
    basis, known = np.empty((SIZE, max(size, 0))), 0
    for i in range(first, last):
        if left_out[i] and not p <= i < q:
            v = column(factor, i - first, size, basis, known)
            norm = np.sqrt((v * v).sum())
            if norm > 1e-9:
                basis[known] = v / norm
                z -= (z * basis[known]).sum() * basis[known]
                known += 1
    freedom = size - known
    if freedom - m < 2:
        return NEVER
    columns, gram, pull = np.empty((m, size)), np.empty((m, m)), np.empty(m)
    for i in range(m):
        columns[i] = column(factor, p - first + i, size, basis, known)
        pull[i] = (columns[i] * z).sum()
        for j in range(i + 1):
            gram[i, j] = gram[j, i] = (columns[i] * columns[j]).sum()
    if gram.sum() < 1e-9:
        return NEVER
    a = gram.copy()
    for i in range(m):
        a[i, i] *= 1.0 + 1e-10
    cholesky(a)
    u = solved(a, pull)
    squares = (z * z).sum()
    scale = (TAIL + max(squares - (u * u).sum(), 0.0)) / (TAIL + freedom - m)
    odds = plateau(gram, pull, squares, freedom, scale, sigma, unit) - likelihood(freedom, squares)
    off[:m] = solved_back(a, u)
    for i in range(m):
        z -= off[i] * columns[i]
    off[:m] *= sigma
    return weighed(y, sigma, factor, p, q, left_out, unit, off, z, odds) if odds > FAVOURED else NEVER


@kernel
def curve(y, sigma, factor, p, q, off, z):
    """The frames around a run as they are without it, smooth, and the run's own place on that curve."""
    first, m, size = max(0, p - REACH), q - p, len(z)
    for i in range(size - 1, -1, -1):  # L'^-1
        for k in range(1, min(3, size - 1 - i) + 1):
            z[i] -= factor[i + k, k] * z[i + k]
        z[i] /= factor[i, 0]
    x = y[first : first + size + 3].copy()
    for i in range(size):
        x[i] += sigma * z[i]
        x[i + 1] -= 3.0 * sigma * z[i]
        x[i + 2] += 3.0 * sigma * z[i]
        x[i + 3] -= sigma * z[i]
    for i in range(m):
        x[p - first + i] = y[p + i] - off[i]
    return x


@kernel
def weighed(y, sigma, factor, p, q, left_out, unit, off, z, odds):
    """Log odds from those of the curves and from the leaps; z (size,): what the curve without the run leaves over."""
    first, m = max(0, p - REACH), q - p
    x = curve(y, sigma, factor, p, q, off, z)
    curved = 2.0 * sigma
    for i in range(max(1, p - first - NEAR), min(len(x) - 1, q - first + NEAR)):
        at = first + i
        if p <= at < q or not (left_out[at - 1] or left_out[at] or left_out[at + 1]):
            curved = max(curved, abs(x[i - 1] - 2.0 * x[i] + x[i + 1]))
    before = 0.0 if p == 0 or left_out[p - 1] else abs(y[p - 1] - x[p - 1 - first])
    after = 0.0 if q == len(y) or left_out[q] else abs(y[q] - x[q - first])
    entry, leave = abs(off[0]) - before, abs(off[m - 1]) - after
    at_end = p == 0 or q == len(y)
    if at_end:  # it leaps but once
        entry = leave = leave if p == 0 else entry
    less, more = min(entry, leave), max(entry, leave)
    if less < VISIBLE * sigma:
        return ONE_SIDED
    less, more = min(less, TELLING * unit), min(more, TELLING * unit)
    leaps = LESS * np.log(less / unit) + MORE * np.log(more / unit) - CURVED * np.log(curved / unit)
    return ODDS * min(odds, 60.0) + leaps - LONG * np.log(m) + BIAS - (ONCE if at_end else 0.0)
