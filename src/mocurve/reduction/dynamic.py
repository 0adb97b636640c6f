"""Curve fitting by dynamic programming (Önder 2007, sections 3.1 and B.1): it polishes keys, their number stays.

A key is predicted where the first or second derivative changes sign. Around each key lies a search window in time,
value and slope with 3 x 3 x 9 = 81 states; 81 x 81 combinations of states shape a segment; the cheapest path over all
keys, by the sum of squared errors at the frames, moves the keys; the windows are halved, and again.

Ours: the thesis's tangent vector has a time and a value component, 3 x 3 states. A curve over time, (time, value)
with the handles at a third of the interval, knows only the slope. So the value component moves the slope by a whole
step of its window and the time component
by a third of a step: nine evenly spaced slopes, none twice. The error of a segment is a quadratic form in its two
values and two slopes, so that its frames are summed once for 729 combinations. Nothing is accepted that does not
lessen the error.
"""

from __future__ import annotations

import numpy as np
from scipy.fft import dst, idst

from ._band import inner
from ._dynamic import best_path, best_times, squared_error
from ._split import excess
from .keys import Keys
from .split import grown

ROUNDS = 10  # as in B.1
LEAST_GAIN = 1e-3  # two rounds in a row that lessen the squared error by a smaller part end the search
FORGIVEN = 0.3  # measured: 2.5-2.7 times the lower bound of keys, 3-8 times with light smoothing
SIGMA = 1.0  # frames: the light smoothing before derivatives are taken
ROUNDING = 1e-13  # of the largest value: a smaller second difference is none
LEAST_WIDTH = 1e-100  # a band of no width: products of two quotients by it are still numbers
STEEP = 4.0  # slope window: so many value windows over the frames to the nearest key


def solve(middle: np.ndarray, half: np.ndarray, quality: str = "default") -> Keys:
    """Keys of M channels with shared times: |curve - middle| <= half holds at every frame.

    The thesis's start and search, which know no tolerance, then more keys where the band is left (as split does; none
    is taken away), then the search again, inside the band. middle, half: (M, F), in the channel's unit. quality: not
    used.
    """
    if middle.shape[1] < 3:
        return grown(np.arange(middle.shape[1]), middle, half)
    start = refine_keys(initial_keys(middle, half), middle)
    return refine_keys(grown(start.frames, middle, half), middle, inner(middle, half))


def thesis_keys(samples: np.ndarray) -> Keys:
    """The thesis's curve fitting of one channel (F,): initial keys, polished. It promises no tolerance."""
    y = np.ascontiguousarray(samples, np.float64)[None]
    return refine_keys(initial_keys(y), y)


def initial_keys(middle: np.ndarray, half: np.ndarray | None = None) -> Keys:
    """First and last frame, and every frame where the first or second derivative of the smoothed channel changes sign.

    Of M members (M, F) that share keys: where the product of both derivatives, summed over the members, changes sign;
    for one member that is the same. Smoothing: a Gaussian of SIGMA frames; with a band, the widest of SIGMA, 2 SIGMA,
    4 SIGMA ... that moves no more than FORGIVEN of the samples by the band's width: wiggles below the tolerance
    deserve no key. Values are the smoothed channel's, slopes its central differences.
    """
    count, sigma = middle.shape[1], SIGMA
    smooth = _smoothed(middle, sigma)
    while half is not None and sigma < count / 8:
        wider = _smoothed(middle, 2 * sigma)
        if (np.abs(wider - middle) > 2 * half).mean() > FORGIVEN:
            break
        smooth, sigma = wider, 2 * sigma
    slopes = np.gradient(smooth, axis=1) if count > 1 else np.zeros_like(smooth)
    scale = 1.0 if half is None else np.maximum(half.mean(axis=1, keepdims=True), LEAST_WIDTH)
    bends = np.diff(smooth, 2, axis=1)
    bends[np.abs(bends) <= ROUNDING * np.abs(smooth).max(axis=1, keepdims=True)] = 0.0
    turning = _signs((slopes[:, 1:-1] / scale * bends / scale).sum(axis=0))
    inside = np.flatnonzero(turning[1:] != turning[:-1]) + 1
    frames = np.unique(np.concatenate([[0], inside, [count - 1]])).astype(np.int64)
    return Keys(frames, smooth[:, frames], slopes[:, frames])


def _smoothed(y: np.ndarray, sigma: float) -> np.ndarray:
    """Gaussian smoothing of (M, F) by sigma frames that keeps both ends and straight lines.

    What is left over the line between the ends is continued beyond them by its own image, turned about the end: a sine
    transform, so that the widest Gaussian costs no more than the narrowest.
    """
    count = y.shape[1]
    if count < 3:
        return y.copy()
    line = y[:, :1] + (y[:, -1:] - y[:, :1]) * (np.arange(count) / (count - 1))
    waves = dst((y - line)[:, 1:-1], 1, axis=1)
    waves *= np.exp(-0.5 * (np.pi * sigma * np.arange(1, count - 1) / (count - 1)) ** 2)
    line[:, 1:-1] += idst(waves, 1, axis=1)
    return line


def _signs(x: np.ndarray) -> np.ndarray:
    """Signs of x (N,), each zero taking the sign before it; the first ones that after them."""
    signs = np.sign(x)
    last = np.maximum.accumulate(np.where(signs != 0, np.arange(len(x)), -1))
    return np.where(last >= 0, signs[last], signs[np.argmax(signs != 0)] if len(x) else 0.0)


def refine_keys(
    keys: Keys, middle: np.ndarray, half: np.ndarray | None = None, pinned: np.ndarray | None = None
) -> Keys:
    """The same number of keys with a smaller or equal sum of squared errors to middle (M, F), by dynamic programming.

    half: (M, F) a band that the keys keep now and shall keep: no key moves to where a frame leaves it. The first and
    last key stay in time, and so do those at `pinned` frames (F,) and a key with a broken tangent, whose two slopes
    turn together. Members share
    their times: the times move first, together, then each member's values and slopes.
    """
    middle = np.ascontiguousarray(middle)
    if len(keys.frames) < 2 or middle.shape[1] < 3:
        return keys
    arriving = keys.slopes if keys.in_slopes is None else keys.in_slopes
    now = tuple(np.array(part) for part in (keys.frames, keys.values, keys.slopes, arriving))
    fixed = (arriving != keys.slopes).any(axis=0)
    fixed[[0, -1]] = True
    if pinned is not None:
        fixed |= pinned[keys.frames]
    windows, spread = _windows(middle, *now)
    cost, idle = _cost(middle, now), 0
    for scale in 0.5 ** np.arange(ROUNDS):
        reach = np.where(fixed, 0, np.minimum(_room(now[0]), (spread * scale).astype(np.int64)))
        moved = _round(middle, half, now, reach, windows[0] * scale, windows[1] * scale)
        moved_cost = _cost(middle, moved)
        idle = 0 if moved_cost < (1 - LEAST_GAIN) * cost else idle + 1
        if moved_cost < cost and (half is None or _holds(middle, half, moved)):
            now, cost = moved, moved_cost
        if idle == 2 or cost == 0.0:
            break
    return Keys(now[0], now[1], now[2], None if keys.in_slopes is None else now[3])


Curve = tuple[np.ndarray, ...]  # frames (K,), values, slopes leaving, slopes arriving (M, K)


def _room(frames: np.ndarray) -> np.ndarray:
    """How far (K,) each key may move when its neighbours may move as far as they can: less than half-way."""
    gaps = np.diff(frames, prepend=frames[0] - 1, append=frames[-1] + 1)
    return (np.minimum(gaps[:-1], gaps[1:]) - 1) // 2


def _windows(
    middle: np.ndarray, frames: np.ndarray, *curve: np.ndarray
) -> tuple[tuple[np.ndarray, np.ndarray], np.ndarray]:
    """First windows: (value, slope) each (M, K), from the largest error beside the key; and in time (K,), up to the
    neighbours' half.
    """
    errors = np.stack([_errors(y, frames, *part) for y, *part in zip(middle, *curve, strict=True)])
    largest = np.maximum.reduceat(errors, frames[:-1], axis=1)
    beside = np.maximum(np.pad(largest, ((0, 0), (1, 0))), np.pad(largest, ((0, 0), (0, 1))))
    gaps = np.diff(frames)
    nearest = np.minimum(np.append(gaps, gaps[-1]), np.insert(gaps, 0, gaps[0]))
    return (beside, STEEP * beside / nearest), _room(frames)


def _errors(
    y: np.ndarray, frames: np.ndarray, values: np.ndarray, slopes: np.ndarray, arriving: np.ndarray
) -> np.ndarray:
    """|curve - y| (F,) of one member."""
    errors = np.zeros_like(y)
    excess(y, np.ones_like(y), frames, values, slopes, arriving, errors)
    return errors


def _cost(middle: np.ndarray, now: Curve) -> float:
    return sum(squared_error(y, now[0], *part) for y, *part in zip(middle, *now[1:], strict=True))


def _holds(middle: np.ndarray, half: np.ndarray, now: Curve) -> bool:
    bands = zip(middle, half, *now[1:], strict=True)
    return all(bool((_errors(y, now[0], *part) <= width).all()) for y, width, *part in bands)


def _round(
    middle: np.ndarray, half: np.ndarray | None, now: Curve, reach: np.ndarray, values: np.ndarray, slopes: np.ndarray
) -> Curve:
    """One search through all windows: time (K,), value and slope (M, K)."""
    banded = half is not None
    band = np.ascontiguousarray(half) if half is not None else np.empty_like(middle)
    if len(middle) > 1:
        now, reach = best_times(middle, band, banded, *now, reach), np.zeros_like(reach)
    found = [
        best_path(y, width, banded, now[0], *part, reach, *window)
        for y, width, *part, window in zip(middle, band, *now[1:], zip(values, slopes, strict=True), strict=True)
    ]
    return found[0][0], *(np.stack([member[part] for member in found]) for part in (1, 2, 3))
