"""Moments of a signal that a person would point at: where it turns; and the same moments found in another signal."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..errors import OptionError

SWING = 0.1  # of the signal's range: what it moves by less does not count as turning
FLAT, JITTERED = 0.05, 0.25  # of the swing beside an extreme: so near to it in height its place is fitted; most
LEAST_FITTED = 6  # samples
SMOOTH = 0.04  # seconds: what is shorter is no movement of a hand
JITTERS = 10.0  # standard deviations of the jitter: what is lower by so much is so for another reason
RATE_HZ, SAMPLES = 240.0, 200_000  # of the signal without jitter
EVEN = 1e-9  # of the largest value: a range so small is none
MOST = 200  # features
SKIP = 0.4  # what it costs to leave out a feature as large as the whole signal; smaller ones by the root of it
RATE = 0.2  # weight of a speed that is not that of the whole, per factor of e
BACK = 4  # features that may be left out in a row in either signal, beside those that it has more


class Features(NamedTuple):
    """Where a signal turns: times (K,) in seconds; levels (K,) from 0 (lowest) to 1 (highest); sizes (K,) of the
    smaller swing beside it, as a part of the range; kinds (K,): 1 high, -1 low, 0 a tap."""

    times: np.ndarray
    levels: np.ndarray
    sizes: np.ndarray
    kinds: np.ndarray

    def __len__(self) -> int:
        return len(self.times)

    def only(self, kinds: tuple[int, ...]) -> Features:
        kept = np.isin(self.kinds, kinds)
        return Features(*(part[kept] for part in self))


def turns(times: np.ndarray, values: np.ndarray, flat: float = FLAT) -> Features:
    """The highs and lows of a signal (N,) at times (N,) that rise from 0. Jitter is taken out first, and movement by
    less than a tenth of the range is none. flat: of the swing beside an extreme; so near to it its place is fitted, in
    signals that are compared the same."""
    at, smooth = smoothed(times, values[:, None])
    level = smooth[:, 0]
    low, size = float(level.min()), float(np.ptp(level))
    if not size > EVEN * max(float(np.abs(values).max()), 1e-300):
        return Features(np.zeros(0), np.zeros(0), np.zeros(0), np.zeros(0, np.int64))
    places, kinds = _turning(level, SWING * size)
    swings = np.abs(np.diff(np.concatenate([level[:1], level[places], level[-1:]]))) / size
    sizes = np.maximum(np.minimum(swings[:-1], swings[1:]), SWING)
    spans = np.concatenate([[0], places, [len(level) - 1]])
    found = [0.0] * len(places)
    for k, (place, kind) in enumerate(zip(places, kinds, strict=True)):
        start, end = _around(kind * level, spans[k], place, spans[k + 2], flat * sizes[k] * size)
        there = (times >= at[start]) & (times <= at[end])
        found[k] = _fitted(times, kind * values, there, float(at[place]))
    return Features(np.array(found), (level[places] - low) / size, sizes, kinds)


def flat(values: np.ndarray) -> float:
    """How near to an extreme of a signal (N,) its place can be told from, as a part of the swing: further in jitter.

    Jitter is what third differences find, which a smooth signal does not have.
    """
    size, third = float(np.ptp(values)), np.abs(np.diff(values, 3))
    jitter = 1.4826 * float(np.median(third)) / 20.0**0.5 if len(third) else 0.0
    return float(np.clip(JITTERS * jitter / size, FLAT, JITTERED)) if size > 0 else FLAT


def smoothed(times: np.ndarray, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Even times (M,) and the signal (N, C) there, without jitter."""
    from scipy.ndimage import gaussian_filter1d  # a tenth of a second, for who needs it

    at = np.linspace(0.0, times[-1], int(min(times[-1] * RATE_HZ, SAMPLES)) + 2)
    even = np.stack([np.interp(at, times, column) for column in values.T], axis=1)
    sigma = min(SMOOTH / (at[1] - at[0]), float(len(at)))
    beyond = min(int(4.0 * sigma) + 1, len(at) - 1)
    padded = np.pad(even, ((beyond, beyond), (0, 0)), "reflect", reflect_type="odd")  # goes on as it begins and ends
    return at, gaussian_filter1d(padded, sigma, axis=0)[beyond : beyond + len(at)]


def taps(times: np.ndarray) -> Features:
    """Moments (N,) without a signal."""
    return Features(times, np.full(len(times), 0.5), np.ones(len(times)), np.zeros(len(times), np.int64))


def matched(
    own: Features, performed: Features, ends: tuple[float, float] | None
) -> tuple[Features, Features, np.ndarray]:
    """The features that were matched, and pairs (K, 2) of those that are the same, by number, in order.

    ends: the durations (seconds) of both signals, which then begin together and end together, as pairs of their own;
    None: they need not. A pair costs how differently high the two are; two pairs in a row, how far the speed between
    them is from that of the whole (its logarithm; less in a short time); a feature that is left out, by its size.
    """
    for features, whose in ((own, "the clip"), (performed, "the performance")):
        if len(features) > MOST:
            raise OptionError(f"{whose} turns {len(features)} times; at most {MOST} can be matched: cut it")
    if ends is not None:
        own, performed = (_framed(features, end) for features, end in zip((own, performed), ends, strict=True))
    return own, performed, _path(own, performed, ends is not None)


# -- in call order ---------------------------------------------------------------------------------


def _turning(values: np.ndarray, least: float) -> tuple[np.ndarray, np.ndarray]:
    """Frames (K,) and kinds (K,) of extremes before and after which the signal moves by at least so much."""
    found: list[tuple[int, int]] = []
    low = high = going = 0  # frames of the lowest and highest since the last that counts; 1 up, -1 down since then
    for at, value in enumerate(values.tolist()):
        if going >= 0 and value > values[high]:
            high = at
        if going <= 0 and value < values[low]:
            low = at
        if going >= 0 and values[high] - value >= least:
            found += [(high, 1)] if going else []
            going, low = -1, at
        elif going <= 0 and value - values[low] >= least:
            found += [(low, -1)] if going else []
            going, high = 1, at
    places, kinds = np.array(found, np.int64).reshape(-1, 2).T
    return places, kinds


def _around(level: np.ndarray, before: int, place: int, after: int, near: float) -> tuple[int, int]:
    """First and last frame around a high that are no lower than so much below it, between its neighbours."""
    low = level[before : after + 1] < level[place] - near
    left, right = np.flatnonzero(low[: place - before]), np.flatnonzero(low[place - before :])
    return before + (int(left[-1]) + 1 if len(left) else 0), int(place + right[0] - 1 if len(right) else after)


def _fitted(times: np.ndarray, values: np.ndarray, near: np.ndarray, about: float) -> float:
    """The time of a high: of the cubic through the samples that are near (N,); of the parabola through the highest and
    its neighbours where they are few; the highest itself where they are far between."""
    if not near.any():
        return about
    if np.count_nonzero(near) < LEAST_FITTED:
        top = int(np.flatnonzero(near)[np.argmax(values[near])])
        beside = slice(max(top - 1, 0), top + 2)
        if len(times[beside]) < 3 or np.diff(times[beside]).max() > SMOOTH:
            return float(times[top])
        times, values, degree = times[beside], values[beside], 2
    else:
        times, values, degree = times[near], values[near], 3
    slope = np.polynomial.Polynomial.fit(times, values, degree).deriv()
    roots = [float(root.real) for root in slope.roots() if abs(root.imag) < 1e-9 and times[0] <= root.real <= times[-1]]
    highs = [root for root in roots if slope.deriv()(root) < 0]
    return float(min(highs, key=lambda root: abs(root - about))) if highs else float(times.mean())


def _framed(features: Features, end: float) -> Features:
    """With the start and the end of the signal as features of their own kinds, of which there is one each."""
    inner = (features.times > 0) & (features.times < end)
    framed = zip(features, ((0.0, end), (0.5, 0.5), (1.0, 1.0), (2, 3)), strict=True)
    return Features(*(np.concatenate([[first], part[inner], [last]]) for part, (first, last) in framed))


def _path(own: Features, performed: Features, framed: bool) -> np.ndarray:
    """The cheapest pairs (K, 2), none where there are no two of one kind."""
    rows, columns = len(own), len(performed)
    differ = own.kinds[:, None] != performed.kinds
    differ &= (own.kinds[:, None] != 0) & (performed.kinds != 0) | (own.kinds[:, None] > 1) | (performed.kinds > 1)
    taps = (own.kinds[:, None] == 0) | (performed.kinds == 0)
    apart = np.where(taps, 0.0, np.abs(own.levels[:, None] - performed.levels))
    left, right = (SKIP * np.concatenate([[0.0], np.cumsum(np.sqrt(part.sizes))]) for part in (own, performed))
    reach = BACK + 1 + abs(rows - columns)
    usual = _spacing(own)
    rate = _spacing(performed) / usual
    cost = np.full((rows, columns), np.inf)
    came = np.full((rows, columns, 2), -1)
    for i, j in np.argwhere(~differ):
        best = left[i] + right[j] if not framed or i == j == 0 else np.inf
        a, b = max(i - reach, 0), max(j - reach, 0)
        if i > a and j > b:
            gaps = own.times[i] - own.times[a:i, None]
            slower = np.abs(np.log((performed.times[j] - performed.times[b:j]) / gaps / rate))
            ways = cost[a:i, b:j] + RATE * np.minimum(gaps / usual, 1.0) * slower
            ways += (left[i] - left[a + 1 : i + 1])[:, None] + (right[j] - right[b + 1 : j + 1])
            k, n = np.unravel_index(np.argmin(ways), ways.shape)
            if ways[k, n] < best:
                best, came[i, j] = ways[k, n], (a + k, b + n)
        cost[i, j] = best + apart[i, j]
    last = cost + (left[-1] - left[1:])[:, None] + (right[-1] - right[1:])
    at = (rows - 1, columns - 1) if framed else np.unravel_index(np.argmin(last), last.shape) if last.size else (0, 0)
    if not last.size or not np.isfinite(last[at]):
        return np.zeros((0, 2), np.int64)
    pairs = [at]
    while came[pairs[-1]][0] >= 0:
        pairs.append(tuple(came[pairs[-1]]))
    return np.array(pairs[::-1])


def _spacing(features: Features) -> float:
    """Seconds from one to the next, on the whole."""
    return float(features.times[-1] - features.times[0]) / (len(features) - 1) if len(features) > 1 else 1.0
