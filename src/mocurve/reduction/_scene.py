"""Compiled steps of the promise in space: every step takes curves inside their tubes to other curves inside their
tubes.

`near` (C, F) is how far a channel may be from its original sample, whatever the points say. Key states: values and
slopes per frame.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .._jit import kernel
from ._least_squares import refit
from ._tubes import Body, narrow, turn

STILL = 1e-12  # changes smaller than this are rounding, and left out
THIN = 1e-9  # least half-width of a tube: degrees or length
SWEEPS = 2  # Lawson sweeps of a fit inside a tube
SPAN = 3  # keys to either side of a key that is taken out, whose states may move


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
        for f in range(len(out)):
            out[f] = values[0]
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
def settle(scene, k, frames, states, hold_first, hold_last, near):
    """Draw channel k's curve between its key frames (K,) to the middle of its tube, and everything below it along.

    states (K, 2): value and slope per frame, written; those of the first and last key may be held. False, and nothing
    changed in the scene, where the curve would leave the tube: the states are then of no use."""
    n, begin, end = scene.samples.shape[1], frames[0], frames[-1] + 1
    middle, half = np.empty(n), np.empty(n)
    tube(scene, k, near, begin, end, middle, half)
    local = np.empty_like(frames)
    for q in range(len(frames)):
        local[q] = frames[q] - begin
    if refit(local, states, hold_first, hold_last, middle[begin:end], half[begin:end], SWEEPS) > 1.0:
        return False
    sampled(frames, states[:, 0], states[:, 1], states[:, 1], middle)
    put(scene, k, middle, begin, end)
    return True


@kernel
def centre(scene, k, frames, values, slopes, near):
    """Draw channel k's curve to the middle of its tube, key frames (K,) kept: it makes up for the others' error."""
    states = np.empty((len(frames), 2))
    if settle(scene, k, frames, states, False, False, near):
        for q in range(len(frames)):
            values[q], slopes[q] = states[q, 0], states[q, 1]


@kernel
def try_window(scene, members, kept, lo, hi, frames, values, slopes, near, states):
    """Put the key frames `kept` in place of keys lo to hi for all members, leaves first, each inside its tube.

    Writes the new states (M, len(kept), 2) and returns True, or puts everything back as it was and returns False."""
    begin, end, last = frames[lo], frames[hi] + 1, len(kept) - 1
    before = np.empty((len(members), scene.samples.shape[1]))
    for i in range(len(members) - 1, -1, -1):
        for f in range(begin, end):
            before[i, f] = scene.samples[members[i], f]
        states[i, 0, 0], states[i, 0, 1] = values[i, lo], slopes[i, lo]
        states[i, last, 0], states[i, last, 1] = values[i, hi], slopes[i, hi]
        if not settle(scene, members[i], kept, states[i, : last + 1], lo > 0, hi < len(frames) - 1, near):
            for back in range(i + 1, len(members)):
                put(scene, members[back], before[back], begin, end)
            return False
    return True


@kernel
def without(frames, q, merge, lo, hi):
    """Key frames lo to hi less key q; merge: less keys q and q + 1, with one in the middle between them."""
    kept = np.empty(hi - lo, np.int64)
    c = 0
    for r in range(lo, hi + 1):
        if r != q and not (merge and r == q + 1):
            kept[c] = frames[r]
            c += 1
        elif merge and r == q:
            kept[c] = (frames[q] + frames[q + 1]) // 2
            c += 1
    return kept


@kernel
def prune(scene, members, frames, values, slopes, near):
    """Take out keys that the members (M,) of a group can do without, or put one in the middle for two.

    Works in frames (K,), values and slopes (M, K) and returns how many keys are left at their start. Exact for any
    group: each trial moves its members one after the other, and is undone where one of them would leave its tube."""
    count, q = len(frames), 1
    states = np.empty((len(members), 2 * SPAN + 2, 2))
    while q < count - 1:
        done = False
        for merge in (False, True):
            if done or (merge and q + 1 >= count - 1):
                continue
            lo, hi = max(0, q - SPAN), min(count - 1, q + int(merge) + SPAN)
            kept = without(frames, q, merge, lo, hi)
            done = try_window(scene, members, kept, lo, hi, frames[:count], values, slopes, near, states)
            if not done:
                continue
            for r in range(lo, count - 1):
                inside = r < lo + len(kept)
                frames[r] = kept[r - lo] if inside else frames[r + 1]
                for i in range(len(members)):
                    values[i, r] = states[i, r - lo, 0] if inside else values[i, r + 1]
                    slopes[i, r] = states[i, r - lo, 1] if inside else slopes[i, r + 1]
            count -= 1
        q = max(1, q - 1) if done else q + 1
    return count
