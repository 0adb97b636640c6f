"""Kernels of split.py: the thesis's chord test, and splitting on the error of the fitted curve."""

from __future__ import annotations

import numpy as np

from .._jit import kernel
from ._least_squares import hold, normal_equations, solve_band

LOCAL_ROUNDS = (
    60  # rounds that split only the segments that are worse than their neighbours; later rounds split all that fail
)
THICKEST = 1e3  # the fit sees no half-width below this part of the widest: thinner places get a key that is held


@kernel
def chord_frames(y: np.ndarray, ratio: float) -> np.ndarray:
    """Frames (K,) that recursive splitting keeps: the height over the chord, divided by the chord's length, exceeds
    the ratio.

    A stack instead of recursion: 135,000 frames may split 135,000 deep.
    """
    count = len(y)
    keep = np.zeros(count, np.bool_)
    keep[0] = keep[count - 1] = True
    ends = np.empty(count + 1, np.int64)  # last frames of the segments that wait, nearest on top
    ends[0], waiting, a = count - 1, 1, 0
    while waiting > 0:
        b = ends[waiting - 1]
        width, rise = float(b - a), y[b] - y[a]
        farthest, top = 0.0, -1
        for t in range(a + 1, b):
            area = abs(width * (y[t] - y[a]) - rise * (t - a))  # twice the triangle's: height times base
            if area > farthest:
                farthest, top = area, t
        if farthest > ratio * (width * width + rise * rise):
            keep[top] = True
            ends[waiting] = top
            waiting += 1
        else:
            a = b
            waiting -= 1
    return np.nonzero(keep)[0]


@kernel
def excess(middle, half, frames, v, leaving, arriving, worst):
    """Raise worst (F,) to |curve - middle| / half of one member at every frame; 0 / 0 counts as 0.

    v, leaving, arriving (K,).
    """
    for q in range(len(frames) - 1):
        a, b = frames[q], frames[q + 1]
        h, rise = float(b - a), v[q + 1] - v[q]
        for t in range(a, b + 1):
            s = (t - a) / h
            bend = (1.0 - s) * leaving[q] - s * arriving[q + 1]
            curve = v[q] + (3.0 - 2.0 * s) * s * s * rise + s * (1.0 - s) * h * bend
            error = abs(curve - middle[t])
            worst[t] = max(worst[t], error / half[t] if error > 0.0 else 0.0)


@kernel
def fit(middle: np.ndarray, weights: np.ndarray, frames: np.ndarray, held: np.ndarray):
    """Values and slopes (K,) of one member with the least weighted squared error; held (K,): keys that keep the
    middle's value.
    """
    keys, base = len(frames), middle[frames[0]]  # counted from here: a large offset leaves the digits to the shape
    y = middle - base
    band, solution = np.empty((2 * keys, 4)), np.empty(2 * keys)
    normal_equations(frames, y, weights, band, solution)
    for q in range(keys):
        if held[q]:
            hold(band, solution, 2 * q, y[frames[q]])
    solve_band(band, solution)
    return np.where(held, middle[frames], solution[0::2] + base), solution[1::2].copy()


@kernel
def _marks(frames: np.ndarray, worst: np.ndarray, everywhere: bool, on: np.ndarray, held: np.ndarray) -> bool:
    """Mark new keys where segments fail and hold the keys that fail themselves; False where there is nothing left to
    do.

    A new key comes on the segment's worst frame, moved into its middle half: shorter pieces were measured to cost
    1.2x the keys.
    """
    segments = len(frames) - 1
    peaks, places = np.zeros(segments), np.zeros(segments, np.int64)
    for q in range(segments):
        a, b = frames[q], frames[q + 1]
        for t in range(a + 1, b):
            if worst[t] > peaks[q]:
                peaks[q], places[q] = worst[t], t
        places[q] = min(max(places[q], a + (b - a) // 4), b - (b - a) // 4)
    changed = False
    for q in range(segments):
        beaten = (q > 0 and peaks[q - 1] > peaks[q]) or (q < segments - 1 and peaks[q + 1] > peaks[q])
        if peaks[q] > 1.0 and (everywhere or not beaten):
            on[places[q]] = changed = True
    for frame in frames:
        if worst[frame] > 1.0 and not held[frame]:
            held[frame] = changed = True
    return changed


@kernel
def grow(middle: np.ndarray, half: np.ndarray, start: np.ndarray):
    """Add keys to the frames `start` until the fitted curve is within half (M, F) of the middle at every frame.

    Returns frames (K,), values (M, K), slopes (M, K).
    """
    members, count = middle.shape
    on, held = np.zeros(count, np.bool_), np.zeros(count, np.bool_)
    on[start] = True
    weights = np.empty_like(half)
    for k in range(members):
        floor = half[k].max() / THICKEST
        for t in range(count):
            weights[k, t] = (floor / max(half[k, t], floor)) ** 2 if floor > 0.0 else 1.0
    rounds = 0
    while True:
        frames = np.nonzero(on)[0]
        values, slopes, worst = np.empty((members, len(frames))), np.empty((members, len(frames))), np.zeros(count)
        for k in range(members):
            values[k], slopes[k] = fit(middle[k], weights[k], frames, held[frames])
            excess(middle[k], half[k], frames, values[k], slopes[k], slopes[k], worst)
        rounds += 1
        if not _marks(frames, worst, rounds > LOCAL_ROUNDS, on, held):
            return frames, values, slopes
