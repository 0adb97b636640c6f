"""Kernels of dynamic.py: states of a key, the error of a segment as a quadratic form, and the shortest path over the
keys.

A state of a key is a frame (3), a value (3) and a slope (9). Its value and slope are counted from the present curve
at that frame, so that a window slides along the curve. Of the offsets of one time pair, x = (value, slope, value,
slope), a segment's squared error is base - 2 right . x + x . gram x, summed over the frames once for all 27 x 27
pairs of offsets.
"""

from __future__ import annotations

import numpy as np

from .._jit import kernel

TIMES, OFFSETS = 3, 27  # states of a key in time; in value and slope together
STEPS = (0, -1, 1)  # the centre of a window first: of equal costs the first state wins


@kernel
def segment_form(y, a, va, ma, b, vb, mb, last, gram, right):
    """The quadratic form of the segment from (a, va, ma) to (b, vb, mb) on y (F,): fills gram (4, 4), right (4,),
    returns base.

    It counts the frames from a to before b, and b itself where the segment is the last: each frame of a curve counts
    once.
    """
    h, per_h, rise = float(b - a), 1.0 / (b - a), vb - va
    g00 = g10 = g11 = g20 = g21 = g22 = g30 = g31 = g32 = g33 = 0.0
    r0 = r1 = r2 = r3 = base = 0.0
    for t in range(a, b + 1 if last else b):
        s = (t - a) * per_h
        u = 1.0 - s
        p2 = (3.0 - 2.0 * s) * s * s
        p0, p1, p3 = 1.0 - p2, s * u * u * h, -s * s * u * h
        error = y[t] - va - p2 * rise - p1 * ma - p3 * mb
        base += error * error
        r0, r1, r2, r3 = r0 + p0 * error, r1 + p1 * error, r2 + p2 * error, r3 + p3 * error
        g00, g10, g11, g20 = g00 + p0 * p0, g10 + p1 * p0, g11 + p1 * p1, g20 + p2 * p0
        g21, g22, g30, g31 = g21 + p2 * p1, g22 + p2 * p2, g30 + p3 * p0, g31 + p3 * p1
        g32, g33 = g32 + p3 * p2, g33 + p3 * p3
    right[0], right[1], right[2], right[3] = r0, r1, r2, r3
    gram[0, 0], gram[1, 1], gram[2, 2], gram[3, 3] = g00, g11, g22, g33
    gram[0, 1] = gram[1, 0] = g10
    gram[0, 2] = gram[2, 0] = g20
    gram[0, 3] = gram[3, 0] = g30
    gram[1, 2] = gram[2, 1] = g21
    gram[1, 3] = gram[3, 1] = g31
    gram[2, 3] = gram[3, 2] = g32
    return base


@kernel
def squared_error(y, frames, values, slopes, arriving):
    """Sum over all frames of (curve - y) squared, for one member."""
    gram, right, total = np.empty((4, 4)), np.empty(4), 0.0
    last = len(frames) - 2
    for q in range(last + 1):
        total += segment_form(
            y, frames[q], values[q], slopes[q], frames[q + 1], values[q + 1], arriving[q + 1], q == last, gram, right
        )
    return total


@kernel
def segment_holds(y, half, a, va, ma, b, vb, mb, last):
    """Whether the segment is within half of y at the frames that it counts (see segment_form), every eighth first."""
    h, per_h, rise = float(b - a), 1.0 / (b - a), vb - va
    for step in (8, 1):
        for t in range(a, b + 1 if last else b, step):
            s = (t - a) * per_h
            error = y[t] - va - (3.0 - 2.0 * s) * s * s * rise - s * (1.0 - s) * h * ((1.0 - s) * ma - s * mb)
            if abs(error) > half[t]:
                return False
    return True


@kernel
def _centres(frames, values, slopes, arriving, reach):
    """Window centres: frames (K, 3), and there the present curve's value, slope leaving and slope arriving (K, 3
    states, 3).
    """
    keys = len(frames)
    at, there = np.empty((keys, TIMES), np.int64), np.empty((keys, TIMES, 3))
    for q in range(keys):
        for i in range(TIMES):
            t = frames[q] + STEPS[i] * reach[q]
            at[q, i] = t
            if t == frames[q]:
                there[q, i] = values[q], slopes[q], arriving[q]
                continue
            p = q if t > frames[q] else q - 1
            h = float(frames[p + 1] - frames[p])
            s, rise = (t - frames[p]) / h, values[p + 1] - values[p]
            m0, m1 = slopes[p], arriving[p + 1]
            value = values[p] + (3.0 - 2.0 * s) * s * s * rise + s * (1.0 - s) * h * ((1.0 - s) * m0 - s * m1)
            slope = 6.0 * s * (1.0 - s) * rise / h + (1.0 - s) * (1.0 - 3.0 * s) * m0 + s * (3.0 * s - 2.0) * m1
            there[q, i] = value, slope, slope
    return at, there


@kernel
def _offsets(value_window, slope_window, dv, dm):
    """The 27 offsets of a key: 3 values, and 9 slopes from a step for the tangent's y and a third of it for its x."""
    for j in range(OFFSETS):
        dv[j] = STEPS[j // 9] * value_window
        dm[j] = (STEPS[j // 3 % 3] + STEPS[j % 3] / 3.0) * slope_window


@kernel
def _halves(gram, right, i, v, m, out):
    """What one end (i = 0 first, 2 second) adds to the form by itself, for each of its offsets."""
    for k in range(len(v)):
        out[k] = v[k] * (gram[i, i] * v[k] - 2.0 * right[i]) + m[k] * (gram[i + 1, i + 1] * m[k] - 2.0 * right[i + 1])
        out[k] += 2.0 * gram[i, i + 1] * v[k] * m[k]


@kernel
def _relax(y, half, banded, at, there, q, i, j, last, v, m, before, total, came_from):
    """Extend the cheapest paths to key q in its time i, costs before (27,), to key q + 1 in its time j: 729
    combinations.

    v, m (2, 27): offsets of both keys. total, came_from (27,): best cost and the state of key q that it came from.
    """
    a, b = at[q, i], at[q + 1, j]
    va, ma, vb, mb = there[q, i, 0], there[q, i, 1], there[q + 1, j, 0], there[q + 1, j, 2]
    gram, right, first, second = np.empty((4, 4)), np.empty(4), np.empty(OFFSETS), np.empty(OFFSETS)
    base = segment_form(y, a, va, ma, b, vb, mb, last, gram, right)
    _halves(gram, right, 0, v[0], m[0], first)
    _halves(gram, right, 2, v[1], m[1], second)
    for k in range(OFFSETS):
        if before[k] == np.inf:
            continue
        cost, state = before[k] + base + first[k], i * OFFSETS + k
        by_v = 2.0 * (gram[0, 2] * v[0, k] + gram[1, 2] * m[0, k])
        by_m = 2.0 * (gram[0, 3] * v[0, k] + gram[1, 3] * m[0, k])
        if banded:
            for n in range(OFFSETS):
                there_cost = cost + second[n] + by_v * v[1, n] + by_m * m[1, n]
                if there_cost < total[n] and segment_holds(
                    y, half, a, va + v[0, k], ma + m[0, k], b, vb + v[1, n], mb + m[1, n], last
                ):
                    total[n], came_from[n] = there_cost, state
        else:
            for n in range(OFFSETS):
                there_cost = cost + second[n] + by_v * v[1, n] + by_m * m[1, n]
                better = there_cost < total[n]
                total[n] = there_cost if better else total[n]
                came_from[n] = state if better else came_from[n]


@kernel
def best_path(y, half, banded, frames, values, slopes, arriving, reach, value_window, slope_window):
    """One round for one member: the cheapest of all 81 ** K paths over the keys' states, by dynamic programming.

    reach (K,): time windows in frames, 0 where the key stays (the ends do); they must not meet. value_window,
    slope_window (K,).
    Returns frames, values, slopes, arriving (K,); unchanged where no path stays in the band.
    """
    keys = len(frames)
    at, there = _centres(frames, values, slopes, arriving, reach)
    total = np.full((TIMES, OFFSETS), np.inf)
    came_from = np.zeros((keys, TIMES, OFFSETS), np.int64)
    v, m = np.empty((2, OFFSETS)), np.empty((2, OFFSETS))
    _offsets(value_window[0], slope_window[0], v[1], m[1])
    total[0] = 0.0
    for q in range(keys - 1):
        v[0], m[0] = v[1], m[1]
        _offsets(value_window[q + 1], slope_window[q + 1], v[1], m[1])
        before = total.copy()
        total[:] = np.inf
        for j in range(TIMES):
            if reach[q + 1] == 0 and j > 0:
                continue
            for i in range(TIMES):
                if reach[q] > 0 or i == 0:
                    _relax(
                        y,
                        half,
                        banded,
                        at,
                        there,
                        q,
                        i,
                        j,
                        q == keys - 2,
                        v,
                        m,
                        before[i],
                        total[j],
                        came_from[q + 1, j],
                    )
    state = total.argmin()
    frames, values, slopes, arriving = frames.copy(), values.copy(), slopes.copy(), arriving.copy()
    if not total.min() < np.inf:
        return frames, values, slopes, arriving
    for q in range(keys - 1, -1, -1):
        i, k = state // OFFSETS, state % OFFSETS
        _offsets(value_window[q], slope_window[q], v[0], m[0])
        frames[q] = at[q, i]
        values[q], slopes[q], arriving[q] = there[q, i, 0] + v[0, k], there[q, i, 1] + m[0, k], there[q, i, 2] + m[0, k]
        state = came_from[q, i, k]
    return frames, values, slopes, arriving


@kernel
def best_times(y, half, banded, frames, values, slopes, arriving, reach):
    """One round for the times that M members share: 3 states a key, each member's key sliding along its present curve.

    y, half (M, F); values, slopes, arriving (M, K). Returns the same four as best_path.
    """
    members, keys = values.shape
    at, there = np.empty((keys, TIMES), np.int64), np.empty((members, keys, TIMES, 3))
    for k in range(members):
        at, there[k] = _centres(frames, values[k], slopes[k], arriving[k], reach)
    came_from, total = np.zeros((keys, TIMES), np.int64), np.zeros(TIMES)
    gram, right = np.empty((4, 4)), np.empty(4)
    for q in range(keys - 1):
        last, before = q == keys - 2, total.copy()
        total[:] = np.inf
        for j in range(TIMES):
            for i in range(TIMES):
                if (i > 0 and reach[q] == 0) or (j > 0 and reach[q + 1] == 0):
                    continue
                cost = before[i]
                for k in range(members):
                    a, va, ma = at[q, i], there[k, q, i, 0], there[k, q, i, 1]
                    b, vb, mb = at[q + 1, j], there[k, q + 1, j, 0], there[k, q + 1, j, 2]
                    if not cost < total[j]:
                        break
                    if banded and not segment_holds(y[k], half[k], a, va, ma, b, vb, mb, last):
                        cost = np.inf
                    else:
                        cost += segment_form(y[k], a, va, ma, b, vb, mb, last, gram, right)
                if cost < total[j]:
                    total[j], came_from[q + 1, j] = cost, i
    frames, values, slopes, arriving = frames.copy(), values.copy(), slopes.copy(), arriving.copy()
    i = total.argmin()
    if not total[i] < np.inf:
        return frames, values, slopes, arriving
    for q in range(keys - 1, -1, -1):
        frames[q] = at[q, i]
        values[:, q], slopes[:, q], arriving[:, q] = there[:, q, i, 0], there[:, q, i, 1], there[:, q, i, 2]
        i = came_from[q, i]
    return frames, values, slopes, arriving
