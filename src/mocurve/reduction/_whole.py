"""Whole poses as curves: compiled fits of all channels at once to keys at shared times, judged in space.

All channels share key frames and weights, so that one banded matrix serves them all: two unknowns a key (value and
slope), half-bandwidth 3, factorised once. Rows are frames or keys and columns channels, so that the inner loops run
along memory. The error of a frame is the largest distance of a point from its target, in the point's limits.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .._jit import kernel
from ._least_squares import LAWSON_FLOOR, STIFFNESS, hermite_row
from ._tubes import Body, pose


class Stage(NamedTuple):
    """A clip, and how far its poses may be off."""

    body: Body
    samples: np.ndarray  # (F, C) in the channel's unit
    target: np.ndarray  # (F, 3, P) where the points of the body are
    limits: np.ndarray  # (F, P) what their distances are counted in
    room: np.ndarray  # (F, C) what distances of the channels' own values are counted in; (F, 0): they are not counted


@kernel
def hermite_rows(frames, values, leaving, arriving, first, out):
    """Samples (N, C) from frame `first` on of Hermite curves with keys at frames (K,); values and slopes (K, C)."""
    row = np.empty(4)
    for q in range(len(frames) - 1):
        a, b = frames[q], frames[q + 1]
        for f in range(a if q == 0 else a + 1, b + 1):
            hermite_row((f - a) / (b - a), b - a, row)
            for c in range(values.shape[1]):
                near = row[0] * values[q, c] + row[1] * leaving[q, c]
                out[f - first, c] = near + row[2] * values[q + 1, c] + row[3] * arriving[q + 1, c]
    for c in range(values.shape[1]):  # exact, whatever the rounding
        for q in range(len(frames)):
            out[frames[q] - first, c] = values[q, c]


@kernel
def errors_of(stage, first, curves, errors):
    """errors (N,) at the frames from `first` on of curves (N, C)."""
    n, points = len(curves), stage.target.shape[2]
    there, axes = np.empty((n, 3, points)), np.empty((n, 3, curves.shape[1]))
    pose(stage.body, curves, there, axes)
    for f in range(n):
        worst = 0.0
        for p in range(points):
            x = there[f, 0, p] - stage.target[first + f, 0, p]
            y = there[f, 1, p] - stage.target[first + f, 1, p]
            z = there[f, 2, p] - stage.target[first + f, 2, p]
            off = x * x + y * y + z * z
            limit = stage.limits[first + f, p]
            if off > 0.0:
                worst = max(worst, off / (limit * limit))
        worst = np.sqrt(worst)
        for c in range(stage.room.shape[1]):
            off = abs(curves[f, c] - stage.samples[first + f, c])
            if off > 0.0:
                worst = max(worst, off / stage.room[first + f, c])
        errors[f] = worst


@kernel
def normal_rows(frames, samples, base, weights, band, right):
    """Normal equations of curves with keys at frames (K,): band (2K, 4) for all channels, right (2K, C).

    weights (N,) count from the first key. As in `_least_squares`, slopes are drawn a little towards their chord."""
    band[:] = 0.0
    right[:] = 0.0
    row = np.empty(4)
    start = frames[0]
    for q in range(len(frames) - 1):
        a, b = frames[q], frames[q + 1]
        total = 0.0
        for f in range(a if q == 0 else a + 1, b + 1):
            w = weights[f - start]
            total += w
            hermite_row((f - a) / (b - a), b - a, row)
            for i in range(4):
                part = w * row[i]
                for d in range(i + 1):
                    band[2 * q + i, d] += part * row[i - d]
                for c in range(samples.shape[1]):
                    right[2 * q + i, c] += part * (samples[f, c] - base[c])
        pull = STIFFNESS * (b - a) * total
        for i in (1, 3):
            band[2 * q + i, 0] += pull
            for c in range(samples.shape[1]):
                right[2 * q + i, c] += pull * (samples[b, c] - samples[a, c]) / (b - a)


@kernel
def hold_row(band, right, i, values):
    """Fix unknown i of all channels at values (C,)."""
    n = len(right)
    for d in range(1, 4):
        for j, part in ((i - d, band[i, d]), (i + d, band[i + d, d] if i + d < n else 0.0)):
            if 0 <= j < n and part != 0.0:
                for c in range(right.shape[1]):
                    right[j, c] -= part * values[c]
        band[i, d] = 0.0
        if i + d < n:
            band[i + d, d] = 0.0
    band[i, 0] = 1.0
    for c in range(right.shape[1]):
        right[i, c] = values[c]


@kernel
def solve_rows(band, right):
    """Banded Cholesky in place; the solutions (2K, C) replace the right sides."""
    n, channels = right.shape
    for i in range(n):
        for d in range(min(3, i), -1, -1):
            j = i - d
            s = band[i, d]
            for k in range(max(0, i - 3), j):
                s -= band[i, i - k] * band[j, j - k]
            band[i, d] = s / band[j, 0] if d > 0 else np.sqrt(max(s, 1e-300))
    for i in range(n):
        for d in range(1, min(3, i) + 1):
            for c in range(channels):
                right[i, c] -= band[i, d] * right[i - d, c]
        part = 1.0 / band[i, 0]
        for c in range(channels):
            right[i, c] *= part
    for i in range(n - 1, -1, -1):
        for d in range(1, min(3, n - 1 - i) + 1):
            for c in range(channels):
                right[i, c] -= band[i + d, d] * right[i + d, c]
        part = 1.0 / band[i, 0]
        for c in range(channels):
            right[i, c] *= part


@kernel
def refit_poses(stage, frames, values, slopes, hold_first, hold_last, weights, errors, sweeps):
    """C1 curves of all channels through keys at frames (K,), least squares with weights (N,) from the first key on.

    Writes values and slopes (K, C), weights and errors (N,). The states of the first and last key may be held. Each of
    the `sweeps` further solutions multiplies a frame's weight with its error in space (Lawson): the largest error
    comes down. The best is kept, and its largest error returned. weights are left as the best had them."""
    first, keys, channels = frames[0], len(frames), values.shape[1]
    n = frames[-1] - first + 1
    band, right = np.empty((2 * keys, 4)), np.empty((2 * keys, channels))
    new_values, new_slopes = np.empty((keys, channels)), np.empty((keys, channels))
    curves, error, trial = np.empty((n, channels)), np.empty(n), weights.copy()
    base, held = stage.samples[first].copy(), np.empty(channels)
    best = np.inf
    for sweep in range(sweeps + 1):
        normal_rows(frames, stage.samples, base, trial, band, right)
        for end, holds in ((0, hold_first), (keys - 1, hold_last)):
            if holds:
                for c in range(channels):
                    held[c] = values[end, c] - base[c]
                hold_row(band, right, 2 * end, held)
                hold_row(band, right, 2 * end + 1, slopes[end])
        solve_rows(band, right)
        for q in range(keys):
            for c in range(channels):
                new_values[q, c], new_slopes[q, c] = right[2 * q, c] + base[c], right[2 * q + 1, c]
        hermite_rows(frames, new_values, new_slopes, new_slopes, first, curves)
        errors_of(stage, first, curves, error)
        worst = 0.0
        for f in range(n):
            worst = max(worst, error[f])
        if worst < best or sweep == 0:
            best = worst
            values[:], slopes[:], errors[:], weights[:] = new_values, new_slopes, error, trial
        if not worst > 0.0 or not worst < np.inf:
            break
        largest = 0.0
        for f in range(n):
            trial[f] *= error[f] / worst + LAWSON_FLOOR
            largest = max(largest, trial[f])
        for f in range(n):
            trial[f] = trial[f] / largest + 1e-9
    return best
