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


def from_bezier(points: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray | None]:
    """times, values, slopes and in_slopes (K,) of Bézier segments (K-1, 4, 2) that join one another.

    in_slopes is None where no tangent is broken. Mismatch where two segments do not join, where time does not rise,
    or where a handle is not at a third of its interval: such a segment is no cubic function of time, and no Hermite
    keys stand for it.
    """
    points = np.asarray(points, np.float64)
    if points.ndim != 3 or points.shape[1:] != (4, 2) or len(points) == 0:
        raise Mismatch(f"Bézier segments have shape (segments, 4, 2), with at least one, not {points.shape}")
    start, end = points[:, 0, 0], points[:, 3, 0]
    size = np.abs(points).max(axis=(0, 1))  # of times, of values
    _refuse(~(end > start), "does not go forward in time")
    _refuse(
        (np.abs(points[:-1, 3] - points[1:, 0]) > 1e-9 * size).any(axis=1), "does not end where the next one starts"
    )
    thirds = np.linspace(start, end, 4, axis=1)
    _refuse(
        (np.abs(points[:, :, 0] - thirds) > 1e-9 * size[0]).any(axis=1),
        "has a handle that is not at a third of the interval",
    )
    third = (end - start) / 3.0
    leaving, arriving = (points[:, 1, 1] - points[:, 0, 1]) / third, (points[:, 3, 1] - points[:, 2, 1]) / third
    slopes, in_slopes = np.append(leaving, arriving[-1]), np.append(leaving[0], arriving)
    rounding = 16.0 * np.finfo(np.float64).eps * size[1] / third.min()
    broken = np.abs(slopes - in_slopes).max() > rounding
    return (
        np.append(start, end[-1]),
        np.append(points[:, 0, 1], points[-1, 3, 1]),
        slopes,
        in_slopes if broken else None,
    )


def subdivide(points: np.ndarray, s: float | np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The two halves (..., 4, 2) of Bézier segments (..., 4, 2) cut at the parameter s, 0 to 1 (de Casteljau).

    The left half ends, and the right half starts, on the curve: what the thesis evaluates with.
    """
    level = np.asarray(points, np.float64)
    s = np.asarray(s, np.float64)[..., None, None]
    level = np.broadcast_to(level, np.broadcast_shapes(level.shape, s.shape))
    left, right = [level[..., 0, :]], [level[..., -1, :]]
    for _ in range(3):
        level = (1.0 - s) * level[..., :-1, :] + s * level[..., 1:, :]
        left.append(level[..., 0, :])
        right.insert(0, level[..., -1, :])
    return np.stack(left, axis=-2), np.stack(right, axis=-2)


def _refuse(bad: np.ndarray, what: str) -> None:
    if bad.any():
        raise Mismatch(f"Bézier segment {int(np.argmax(bad))} {what}")
