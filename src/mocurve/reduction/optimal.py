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
SETTINGS = {"fast": (2, 20, 5), "default": (3, 15, 5), "good": (5, 10, 6), "best": (12, 5, 6)}


@kernel
def largest(middle: np.ndarray) -> float:
    """Largest absolute value."""
    found = 0.0
    for m in range(middle.shape[0]):
        for f in range(middle.shape[1]):
            found = max(found, abs(middle[m, f]))
    return found


@kernel
def safe_half(half: np.ndarray, rounding: float) -> np.ndarray:
    """Half-widths less a reserve for rounding, of the width and of the values; at least a half of the width."""
    out = np.empty_like(half)
    for m in range(half.shape[0]):
        for f in range(half.shape[1]):
            out[m, f] = max(0.5 * half[m, f], half[m, f] * (1.0 - MARGIN) - 4.0 * rounding)
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
def search(
    middle: np.ndarray, half: np.ndarray, width: int, stride: int, most: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Keys for at least two frames: frames (K,), values and slopes (M, K), and whether each segment fails (K - 1,)."""
    rounding = 1e-15 * largest(middle)
    safe = safe_half(half, rounding)
    nodes, corners, last = forward(middle, safe, rounding, width, stride, most)
    frames, values, slopes = backward(middle, half, nodes, corners, last)
    failed = np.zeros(len(frames) - 1, np.bool_)
    for q in range(len(frames) - 1):
        a, b = frames[q], frames[q + 1]
        for m in range(middle.shape[0]):
            v, s = values[m], slopes[m]
            if not segment_holds(middle[m], half[m], a, b, v[q], s[q], v[q + 1], s[q + 1]):
                failed[q] = True
    return frames, values, slopes, failed


def mended(middle: np.ndarray, half: np.ndarray, keys: Keys, failed: np.ndarray) -> Keys:
    """The keys, and keys on every frame of the segments that failed for any member (rounding): exact there."""
    on = np.zeros(middle.shape[1], np.bool_)
    for q in np.nonzero(failed)[0]:
        on[keys.frames[q] : keys.frames[q + 1] + 1] = True
    values, slopes = middle.copy(), np.gradient(middle, axis=1)
    kept = np.abs(keys.values - middle[:, keys.frames]) <= half[:, keys.frames]
    values[:, keys.frames] = np.where(kept, keys.values, values[:, keys.frames])
    slopes[:, keys.frames] = np.where(kept, keys.slopes, slopes[:, keys.frames])
    on[keys.frames] = True
    frames = np.nonzero(on)[0]
    return Keys(frames, values[:, frames], slopes[:, frames])


def solve(middle: np.ndarray, half: np.ndarray, quality: str) -> Keys:
    """Keys of M channels with shared times, |curve - middle| <= half at every frame.

    middle, half: (M, F), the channels' unit, finite, half > 0. quality: a name of SETTINGS.
    """
    middle, half = np.ascontiguousarray(middle), np.ascontiguousarray(half)
    if middle.shape[1] < 2:
        return Keys(np.arange(middle.shape[1]), middle.copy(), np.zeros_like(middle))
    frames, values, slopes, failed = search(middle, half, *SETTINGS[quality])
    keys = Keys(frames, values, slopes)
    return mended(middle, half, keys, failed) if failed.any() else keys
