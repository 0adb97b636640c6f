"""The method *optimal*: few C1 cubic Hermite keys with a promise at every frame, by propagation of state sets.

Own method: the search is told in `_state_sets`, its linear programs in `_strips`.
"""

from __future__ import annotations

import numpy as np

from .._jit import kernel
from ._state_sets import backward, forward
from .keys import Keys

MARGIN = 1e-8  # the search keeps this part of every half-width in reserve for rounding

# Frames kept per level, distance between them in % of the segment, corners of a polygon of states.
SETTINGS = {"fast": (2, 15, 6), "default": (3, 15, 5), "good": (5, 10, 8), "best": (8, 5, 8)}


@kernel
def safe_half(middle: np.ndarray, half: np.ndarray) -> np.ndarray:
    """Half-widths less a reserve for rounding, of the width and of the largest value; at least a half of the width."""
    largest = 0.0
    for y in middle.flat:
        largest = max(largest, abs(y))
    out = np.empty_like(half)
    for m in range(half.shape[0]):
        for f in range(half.shape[1]):
            out[m, f] = max(0.5 * half[m, f], half[m, f] * (1.0 - MARGIN) - 4e-15 * largest)
    return out


@kernel
def segment_holds(y: np.ndarray, half: np.ndarray, a: int, b: int, va: float, ma: float, vb: float, mb: float) -> bool:
    """Is a Hermite segment within half of y at all its frames, both ends included?"""
    h = b - a
    for f in range(a, b + 1):
        s = (f - a) / h
        rise = (3.0 - 2.0 * s) * s * s
        p = va + rise * (vb - va) + s * (1.0 - s) * h * ((1.0 - s) * ma - s * mb)
        if not abs(p - y[f]) <= half[f]:
            return False
    return True


@kernel
def mend(
    middle: np.ndarray, half: np.ndarray, frames: np.ndarray, values: np.ndarray, slopes: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray, int]:
    """Keys on every frame of a segment that fails for any member (rounding): exact there. Last: how many failed."""
    members, n = middle.shape
    on = np.zeros(n, np.bool_)
    on[frames] = True
    all_values, all_slopes = np.empty((members, n)), np.empty((members, n))
    all_values[:, frames], all_slopes[:, frames] = values, slopes
    failed = 0
    for q in range(len(frames) - 1):
        a, b = frames[q], frames[q + 1]
        holds = True
        for m in range(members):
            holds &= segment_holds(
                middle[m], half[m], a, b, values[m, q], slopes[m, q], values[m, q + 1], slopes[m, q + 1]
            )
        if holds:
            continue
        failed += 1
        on[a : b + 1] = True
        for f in range(a, b + 1):
            c, d = max(f - 1, 0), min(f + 1, n - 1)
            for m in range(members):
                if a < f < b or not abs(all_values[m, f] - middle[m, f]) <= half[m, f]:
                    all_values[m, f] = middle[m, f]
                    all_slopes[m, f] = (middle[m, d] - middle[m, c]) / (d - c)
    frames = np.nonzero(on)[0]
    return frames, all_values[:, frames], all_slopes[:, frames], failed


@kernel
def fit(
    middle: np.ndarray, half: np.ndarray, width: int, stride: int, corners: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray, int]:
    """Keys within half of middle (M, F), C-order: frames (K,), values, slopes per frame (M, K), segments mended."""
    members, n = middle.shape
    if n < 2:
        return np.zeros(n, np.int64), middle.copy(), np.zeros((members, n)), 0
    safe = safe_half(middle, half)
    frames, counts, polygons = forward(middle, safe, width, stride, corners)
    values, slopes = np.empty((members, len(frames))), np.empty((members, len(frames)))
    for m in range(members):
        values[m], slopes[m] = backward(middle[m], half[m], frames, counts[:, m], polygons[:, m])
    return mend(middle, half, frames, values, slopes)


def solve(middle: np.ndarray, half: np.ndarray, quality: str) -> Keys:
    """Keys of M channels with shared times, |curve - middle| <= half at every frame.

    middle, half: (M, F), the channels' unit, finite, half > 0. quality: a name of SETTINGS.
    """
    frames, values, slopes, _ = fit(np.ascontiguousarray(middle), np.ascontiguousarray(half), *SETTINGS[quality])
    return Keys(frames, values, slopes)
