"""Slopes for curves through given values: smooth ones, and ones that never overshoot."""

from __future__ import annotations

import numpy as np


def smooth(times: np.ndarray, values: np.ndarray) -> np.ndarray:
    """(K, C) slopes of the cubic spline through values (K, C) that rests at both ends: its curvature does not jump
    between."""
    slopes = np.zeros_like(values)
    if len(times) < 3:
        return slopes
    h = np.diff(times)[:, None]
    secants = np.diff(values, axis=0) / h
    left, right = h[1:, 0], h[:-1, 0]  # rows: h[k+1] m[k] + 2 (h[k] + h[k+1]) m[k+1] + h[k] m[k+2]
    matrix = np.diag(2.0 * (left + right)) + np.diag(left[1:], -1) + np.diag(right[:-1], 1)
    slopes[1:-1] = np.linalg.solve(matrix, 3.0 * (h[1:] * secants[:-1] + h[:-1] * secants[1:]))
    return slopes


def limited(times: np.ndarray, values: np.ndarray) -> np.ndarray:
    """(K, C) slopes with which no curve leaves the range of its two values: 0 at an extreme, else the harmonic mean of
    the lines on both sides; 0 at both ends (Fritsch and Carlson 1980)."""
    slopes = np.zeros_like(values)
    if len(times) < 3:
        return slopes
    before, after = (
        np.diff(values, axis=0)[:-1] / np.diff(times)[:-1, None],
        np.diff(values, axis=0)[1:] / np.diff(times)[1:, None],
    )
    same = before * after > 0
    total = np.where(same, before + after, 1.0)
    slopes[1:-1] = np.where(same, 2.0 * before * after / total, 0.0)
    return slopes


def speeds(times: np.ndarray, values: np.ndarray) -> np.ndarray:
    """(K,) slopes above 0 through values (K,) that rise: those of the parabola through three neighbours, but at most
    twice the flatter line beside, so that the curve rises too (Fritsch and Carlson 1980)."""
    h, lines = np.diff(times), np.diff(values) / np.diff(times)
    if len(lines) == 1:
        return np.repeat(lines, 2)
    inner = (h[1:] * lines[:-1] + h[:-1] * lines[1:]) / (h[:-1] + h[1:])
    inner = np.minimum(inner, 2.0 * np.minimum(lines[:-1], lines[1:]))
    ends = 2.0 * lines[[0, -1]] - inner[[0, -1]]  # the parabola's own slope there
    ends = np.clip(ends, lines[[0, -1]] / 3.0, 2.0 * lines[[0, -1]])
    return np.concatenate([ends[:1], inner, ends[1:]])


def rate_of(times: np.ndarray, values: np.ndarray, slopes: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Slopes (N,) at times (N,), between the first key and the last, of the cubic Hermite curve through keys (K,)."""
    i = np.clip(np.searchsorted(times, at, side="right") - 1, 0, len(times) - 2)
    h = np.diff(times)[i]
    u = (at - times[i]) / h
    rise = 6.0 * u * (1.0 - u) * np.diff(values)[i] / h
    return rise + slopes[i] * (1.0 - u) * (1.0 - 3.0 * u) + slopes[i + 1] * u * (3.0 * u - 2.0)
