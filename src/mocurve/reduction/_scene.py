"""Compiled steps of the promise in space: every step takes curves inside their tubes to other curves inside their
tubes.

`near` (C, F) is how far a channel may be from its original sample, whatever the points say. Key states: values and
slopes per frame.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .._jit import kernel
from ._least_squares import errors, hold, normal_equations, refit, solve_band
from ._tubes import Body, narrow, turn

STILL = 1e-12  # changes smaller than this are rounding, and left out
THIN = 1e-9  # least half-width of a tube: degrees or length
SWEEPS = 2  # Lawson sweeps of a fit inside a tube
SPAN = 3  # keys to either side of a key that is taken out, whose states may move
HOPELESS = (3.0, 2.0)  # a fit that far out of the tube after the first, second sweep is given up


class Scene(NamedTuple):
    """The clip, its curves as they are now and the pose that they make; the kernels keep samples, points and axes in
    step."""

    body: Body
    original: np.ndarray  # (C, F) the samples that were given
    samples: np.ndarray  # (C, F) of the curves as they are now
    target: np.ndarray  # (F, 3, P) where the points were
    points: np.ndarray  # (F, 3, P) where they are now
    axes: np.ndarray  # (F, 3, C) axis of every channel in the world now
    limits: np.ndarray  # (F, P) how far a point may be from its target


@kernel
def sampled(frames, values, slopes, arriving, out):
    """Samples of a Hermite curve at every frame between its first key and its last, into out; a single key is a
    constant."""
    if len(frames) == 1:
        out[:] = values[0]
    for q in range(len(frames) - 1):
        a, h = frames[q], frames[q + 1] - frames[q]
        va, ma = values[q], h * slopes[q]
        rise = values[q + 1] - va
        c2 = 3.0 * rise - 2.0 * ma - h * arriving[q + 1]
        c3 = ma + h * arriving[q + 1] - 2.0 * rise
        for g in range(h):
            s = g / h
            out[a + g] = va + s * (ma + s * (c2 + s * c3))
        out[a + h] = values[q + 1]


@kernel
def tube(scene, k, near, begin, end, middle, half):
    """Middle and half-width of channel k's tube at frames begin to end, given all other channels as they are now."""
    samples = scene.samples[k]
    low, high = np.empty(len(samples)), np.empty(len(samples))
    for f in range(begin, end):
        gap = scene.original[k, f] - samples[f]
        low[f], high[f] = min(0.0, gap - near[k, f]), max(0.0, gap + near[k, f])
    narrow(scene.body, k, scene.points, scene.target, scene.axes, scene.limits, begin, end, low, high)
    for f in range(begin, end):
        middle[f] = samples[f] + 0.5 * (low[f] + high[f])
        half[f] = max(0.5 * (high[f] - low[f]), THIN)


@kernel
def put(scene, k, new, begin, end):
    """Give channel k new samples at frames begin to end; everything below it follows."""
    delta = np.zeros(end)
    for f in range(begin, end):
        change = new[f] - scene.samples[k, f]
        if abs(change) > STILL:
            delta[f] = change
            scene.samples[k, f] = new[f]
    turn(scene.body, k, delta, begin, end, scene.points, scene.axes)


@kernel
def centre(scene, k, frames, values, slopes, near):
    """Draw channel k's curve to the middle of its tube, same key frames, states written in place: it makes up for the
    others' error."""
    n = scene.samples.shape[1]
    middle, half, new = np.empty(n), np.empty(n), np.empty(n)
    tube(scene, k, near, 0, n, middle, half)
    v, m, worst = refit(frames, middle, half, SWEEPS)
    if worst <= 1.0:
        values[:], slopes[:] = v, m
        sampled(frames, v, m, m, new)
        put(scene, k, new, 0, n)


@kernel
def fit_window(frames, values, slopes, hold_left, hold_right, middle, half):
    """Weighted least squares like `refit`, on a window: frames (K,) counted from it; the state of the first or last
    key may be held.

    Writes values and slopes, returns the largest |curve - middle| / half; above 1 they are of no use."""
    keys = len(frames)
    band, right, error = np.empty((2 * keys, 4)), np.empty(2 * keys), np.empty(len(middle))
    base = middle[0]
    y = middle - base
    weights = (half.min() / half) ** 2 + 1e-12
    worst = np.inf
    for sweep in range(SWEEPS + 1):
        normal_equations(frames, y, weights, band, right)
        if hold_left:
            hold(band, right, 0, values[0] - base)
            hold(band, right, 1, slopes[0])
        if hold_right:
            hold(band, right, 2 * keys - 2, values[-1] - base)
            hold(band, right, 2 * keys - 1, slopes[-1])
        solve_band(band, right)
        errors(frames, right[0::2], right[1::2], y, error)
        worst = np.max(error / half)
        if worst <= 1.0:
            values[:], slopes[:] = right[0::2] + base, right[1::2]
            return worst
        if sweep < len(HOPELESS) and worst > HOPELESS[sweep]:
            return worst
        weights *= error / half + 0.05 * worst
        weights *= 1.0 / weights.max()
        weights += 1e-12
    return worst


@kernel
def try_window(scene, members, kept, lo, hi, frames, values, slopes, near):
    """Put the key frames `kept` in place of keys lo to hi for all members, leaves first, each inside its tube as it
    then is.

    Returns the new states (members, len(kept), 2) and True, or puts everything back as it was and returns False."""
    begin, end = frames[lo], frames[hi] + 1
    n, keys = scene.samples.shape[1], len(frames)
    states = np.empty((len(members), len(kept), 2))
    before = np.empty((len(members), end - begin))
    middle, half, new = np.empty(n), np.empty(n), np.empty(n)
    local = kept - begin
    for i in range(len(members) - 1, -1, -1):
        k = members[i]
        before[i] = scene.samples[k, begin:end]
        v, m = np.empty(len(kept)), np.empty(len(kept))
        v[0], m[0], v[-1], m[-1] = values[i, lo], slopes[i, lo], values[i, hi], slopes[i, hi]
        tube(scene, k, near, begin, end, middle, half)
        if fit_window(local, v, m, lo > 0, hi < keys - 1, middle[begin:end], half[begin:end]) > 1.0:
            for back in range(i + 1, len(members)):
                new[begin:end] = before[back]
                put(scene, members[back], new, begin, end)
            return states, False
        sampled(kept, v, m, m, new)
        put(scene, k, new, begin, end)
        states[i, :, 0], states[i, :, 1] = v, m
    return states, True


@kernel
def prune(scene, members, frames, values, slopes, near):
    """Take out keys that the members (M,) of a group can do without, or put one in the middle for two: returns frames,
    values, slopes.

    Exact for any group: each trial moves its members one after the other, and is undone where one of them leaves its
    tube."""
    frames, values, slopes = frames.copy(), values.copy(), slopes.copy()
    q = 1
    while q < len(frames) - 1:
        done = False
        for merge in range(2):
            if merge and q + 1 >= len(frames) - 1:
                break
            lo, hi = max(0, q - SPAN), min(len(frames) - 1, q + merge + SPAN)
            kept = np.empty(hi - lo, np.int64)
            c = 0
            for r in range(lo, hi + 1):
                if r != q and not (merge and r == q + 1):
                    kept[c] = frames[r]
                    c += 1
                elif merge and r == q:
                    kept[c] = (frames[q] + frames[q + 1]) // 2
                    c += 1
            states, done = try_window(scene, members, kept, lo, hi, frames, values, slopes, near)
            if done:
                frames = np.concatenate((frames[:lo], kept, frames[hi + 1 :]))
                values = np.concatenate((values[:, :lo], states[:, :, 0], values[:, hi + 1 :]), axis=1)
                slopes = np.concatenate((slopes[:, :lo], states[:, :, 1], slopes[:, hi + 1 :]), axis=1)
                break
        q = max(1, q - 1) if done else q + 1
    return frames, values, slopes
