"""Cubic Hermite curves as arrays, and their Bézier form (Önder 2007, section 3.1).

A key has a time, a value and a slope (value per time). Between two keys, h apart, with u from 0 to 1,
v(u) = v0 + (v1 - v0) u²(3 - 2u) + h u (1 - u) ((1 - u) m0 - u m1): the thesis' matrix form with its tangents r = h m.
"""

from __future__ import annotations

import numpy as np

from .errors import Mismatch


def evaluate(
    times: np.ndarray, values: np.ndarray, slopes: np.ndarray, at: np.ndarray, in_slopes: np.ndarray | None = None
) -> np.ndarray:
    """Values (N,) at the times `at` (N,) of the curve through K keys; exactly the keys' values at the keys' times.

    times (K,) rising, values (K,), slopes (K,) leaving a key, in_slopes (K,) arriving at it (None: the same).
    Before the first key and after the last the curve is constant. Mismatch where it has no key but is asked for values.
    """
    at = np.asarray(at, np.float64)
    if len(times) == 0 and at.size:
        raise Mismatch("a curve without keys has no values")
    if len(times) < 2:
        return np.full(at.shape, values[0] if len(times) else 0.0)
    arriving = slopes if in_slopes is None else in_slopes
    h = np.diff(times)
    i = np.searchsorted(times[1:-1], at, side="right")  # the segment's first key
    u = np.clip((at - times[i]) / h[i], 0.0, 1.0)
    v = 1.0 - u
    result = values[i] + np.diff(values)[i] * (u * u * (3.0 - 2.0 * u))
    result += (u * v) * (v * (h * slopes[:-1])[i] - u * (h * arriving[1:])[i])
    return np.where(at >= times[-1], values[-1], result)  # v0 + (v1 - v0) may miss v1 by rounding


def to_bezier(
    times: np.ndarray, values: np.ndarray, slopes: np.ndarray, in_slopes: np.ndarray | None = None
) -> np.ndarray:
    """Control points (K-1, 4, 2) of (time, value), a row of four a segment: handles at a third of the interval."""
    times, values = np.asarray(times, np.float64), np.asarray(values, np.float64)
    arriving = slopes if in_slopes is None else in_slopes
    third = np.diff(times) / 3.0
    points = np.empty((len(third), 4, 2))
    points[:, 0, 0], points[:, 0, 1] = times[:-1], values[:-1]
    points[:, 1, 0], points[:, 1, 1] = times[:-1] + third, values[:-1] + slopes[:-1] * third
    points[:, 2, 0], points[:, 2, 1] = times[1:] - third, values[1:] - arriving[1:] * third
    points[:, 3, 0], points[:, 3, 1] = times[1:], values[1:]
    return points
