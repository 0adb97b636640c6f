"""Weighted least squares of C1 cubic Hermite curves with fixed key times.

Two unknowns a key (value, slope). The normal matrix has half-bandwidth 3 and is solved by banded Cholesky.
It is kept as band[i, d] = A[i, i - d].
"""

from __future__ import annotations

import numpy as np

from .._jit import kernel

STIFFNESS = 1e-6  # pull of each slope towards its segment's chord, against frames that do not determine it
HOPELESS = (3.0, 2.0, np.inf)  # a fit that far out of its band after the first, second solution is given up
LAWSON_FLOOR = 0.05  # added to the error by which a sweep multiplies a weight, so that no frame is ever forgotten


@kernel(fastmath=True)
def hermite_row(s: float, h: float, row: np.ndarray) -> None:
    """Weights of (value, slope, value, slope) at the part s of a segment of h frames."""
    rise = (3.0 - 2.0 * s) * s * s
    row[0], row[1], row[2], row[3] = 1.0 - rise, s * (1.0 - s) * (1.0 - s) * h, rise, s * s * (s - 1.0) * h


@kernel(fastmath=True)
def normal_equations(
    frames: np.ndarray, y: np.ndarray, weights: np.ndarray, band: np.ndarray, right: np.ndarray
) -> None:
    """Sum the normal equations of all frames from the first key to the last, the chord's pull included."""
    band[:] = 0.0
    right[:] = 0.0
    row = np.empty(4)
    for q in range(len(frames) - 1):
        a, b = frames[q], frames[q + 1]
        total = 0.0
        for f in range(a if q == 0 else a + 1, b + 1):
            w = weights[f]
            total += w
            hermite_row((f - a) / (b - a), b - a, row)
            for i in range(4):
                right[2 * q + i] += w * row[i] * y[f]
                for d in range(i + 1):
                    band[2 * q + i, d] += w * row[i] * row[i - d]
        pull = STIFFNESS * (b - a) * total
        for i in (1, 3):
            band[2 * q + i, 0] += pull
            right[2 * q + i] += pull * (y[b] - y[a]) / (b - a)


@kernel(fastmath=True)
def hold(band: np.ndarray, right: np.ndarray, i: int, value: float) -> None:
    """Fix unknown i: its column goes to the right side."""
    n = len(right)
    for d in range(1, 4):
        if i - d >= 0:
            right[i - d] -= band[i, d] * value
            band[i, d] = 0.0
        if i + d < n:
            right[i + d] -= band[i + d, d] * value
            band[i + d, d] = 0.0
    band[i, 0], right[i] = 1.0, value


@kernel(fastmath=True)
def solve_band(band: np.ndarray, right: np.ndarray) -> None:
    """Banded Cholesky in place; the solution replaces the right side."""
    n = len(right)
    for i in range(n):
        for d in range(min(3, i), -1, -1):
            j = i - d
            s = band[i, d]
            for k in range(max(0, i - 3), j):
                s -= band[i, i - k] * band[j, j - k]
            band[i, d] = s / band[j, 0] if d > 0 else np.sqrt(max(s, 1e-300))
    for i in range(n):
        for d in range(1, min(3, i) + 1):
            right[i] -= band[i, d] * right[i - d]
        right[i] /= band[i, 0]
    for i in range(n - 1, -1, -1):
        for d in range(1, min(3, n - 1 - i) + 1):
            right[i] -= band[i + d, d] * right[i + d]
        right[i] /= band[i, 0]


@kernel(fastmath=True)
def errors(frames: np.ndarray, states: np.ndarray, y: np.ndarray, out: np.ndarray) -> None:
    """|curve - y| at every frame, from the first key to the last, into out (F,); states (2K,): value, slope, value …"""
    out[0] = abs(states[0] - y[0])
    for q in range(len(frames) - 1):
        a, h = frames[q], frames[q + 1] - frames[q]
        va, ma, vb, mb = states[2 * q], h * states[2 * q + 1], states[2 * q + 2], h * states[2 * q + 3]
        c2 = 3.0 * (vb - va) - 2.0 * ma - mb
        c3 = 2.0 * (va - vb) + ma + mb
        for f in range(a, a + h + 1):
            s = (f - a) / h
            out[f] = abs(va + s * (ma + s * (c2 + s * c3)) - y[f])


@kernel
def refit(
    frames: np.ndarray,
    states: np.ndarray,
    hold_first: bool,
    hold_last: bool,
    middle: np.ndarray,
    half: np.ndarray,
    sweeps: int,
) -> float:
    """The C1 Hermite curve with the key frames (K,) nearest to middle (F,), weight 1/half²: states (K, 2), written.

    A state is value and slope per frame; that of the first and last key may be held. `sweeps` more solutions with
    Lawson's weights (each times its error) draw the largest error down, up to the first that is inside the band. Keeps
    the best and returns its largest |curve - middle| / half. Frames count from the first key.
    """
    keys, n = len(frames), len(middle)
    band, right = np.empty((2 * keys, 4)), np.empty(2 * keys)
    weights, error, y = np.empty(n), np.empty(n), np.empty(n)
    base = middle[0]  # counted from here: offsets of a million leave the digits to the shape
    thinnest = np.inf
    for f in range(n):
        y[f] = middle[f] - base
        thinnest = min(thinnest, half[f])
    for f in range(n):
        weights[f] = (thinnest / half[f]) ** 2 + 1e-12
    best = np.inf
    for sweep in range(sweeps + 1):
        normal_equations(frames, y, weights, band, right)
        for i in range(2):
            if hold_first:
                hold(band, right, i, states[0, i] - (base if i == 0 else 0.0))
            if hold_last:
                hold(band, right, 2 * keys - 2 + i, states[keys - 1, i] - (base if i == 0 else 0.0))
        solve_band(band, right)
        errors(frames, right, y, error)
        worst = 0.0
        for f in range(n):
            error[f] /= half[f]
            worst = max(worst, error[f])
        if worst < best:
            best = worst
            for q in range(keys):
                states[q, 0], states[q, 1] = right[2 * q] + base, right[2 * q + 1]
        if best <= 1.0 or worst > HOPELESS[min(sweep, 2)]:
            break
        largest = 0.0
        for f in range(n):
            weights[f] *= error[f] + LAWSON_FLOOR * worst
            largest = max(largest, weights[f])
        for f in range(n):
            weights[f] = weights[f] / largest + 1e-12
    return best


@kernel
def fit_slopes(frames: np.ndarray, values: np.ndarray, y: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """Slopes (K,) per frame: of the C1 Hermite curves through values (K,) the one nearest to y (F,); weights (F,)."""
    slopes = np.zeros(len(frames))
    if len(frames) < 2:
        return slopes
    band, right = np.empty((2 * len(frames), 4)), np.empty(2 * len(frames))
    base = y[frames[0]]
    normal_equations(frames, y - base, weights, band, right)
    for q in range(len(frames)):
        hold(band, right, 2 * q, values[q] - base)
    solve_band(band, right)
    slopes[:] = right[1::2]
    return slopes
