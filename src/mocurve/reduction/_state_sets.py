"""Propagation of sets of key states: the search behind the method *optimal*.

The state of a key is (value, slope). From a convex set of states at one key, the states that can be reached at a later frame,
every frame between being within its strip, form a convex set too. Forward: polygons are carried from each level (number of
segments) to the few frames near the furthest that one more segment reaches. Backward: from the last frame on, a state is
picked in every polygon of the winning chain. Members of a group share key times: each has its own polygon, and a frame is
reached only where all members reach it.
"""

from __future__ import annotations

import numpy as np

from .._jit import kernel
from ._end_states import arrive, new_supports
from ._strips import furthest, new_program

CORNERS = 12  # room for the corners of a polygon of states
FREE = 2.2  # slopes of a state without history: local difference +- this times the half-width


@kernel
def free_states(middle, half, j, counts, corners):
    """A rectangle of states, counted from middle[:, j], for a key without history: any value, slopes near the difference."""
    a, b = (j, j + 1) if j + 1 < middle.shape[1] else (j - 1, j)
    counts[:] = 4
    for m in range(middle.shape[0]):
        slope, spread = middle[m, b] - middle[m, a], FREE * max(half[m, a], half[m, b])
        for c in range(4):
            corners[m, c, 0] = half[m, j] if c == 1 or c == 2 else -half[m, j]
            corners[m, c, 1] = slope + (spread if c >= 2 else -spread)


@kernel
def group_reach(lp, counts, corners, middle, half, i, known, guess):
    """Last frame that every member can reach from frame i; `known` if that is no further."""
    last = middle.shape[1] - 1
    for m in range(middle.shape[0]):
        last = furthest(lp, corners[m], counts[m], middle[m], half[m], i, known, last, guess if m == 0 else last)
        if last <= known:
            break
    return last


@kernel
def group_arrive(lp, counts, corners, middle, half, i, j, most, best, supports, order, new_counts, new_corners):
    """Polygons of all members at frame j. Returns the sum of the logarithms of their areas; -inf: not more than `best`."""
    total, members = 0.0, middle.shape[0]
    for m in range(members):
        floor = np.exp(best - total) if m == members - 1 else 0.0
        new_counts[m], area = arrive(
            lp, corners[m], counts[m], middle[m], half[m], i, j, most, floor, supports, order, new_corners[m]
        )
        if new_counts[m] == 0:
            return -np.inf
        total += np.log(area)
    return total


@kernel
def level_reach(lp, frames, counts, corners, middle, half, guess):
    """Last frame that one more segment reaches from any node of a level."""
    far = frames[0] + 1
    for s in range(len(frames)):
        known = max(far, frames[s] + 1)
        tried = known + 1 if s > 0 else known + guess
        far = max(far, group_reach(lp, counts[s], corners[s], middle, half, frames[s], known, tried))
        if far == middle.shape[1] - 1:
            break
    return far


@kernel
def candidates(frames, far, width, stride, out):
    """Frames of the next level, furthest first: `width` in steps of `stride` % of the segment, and those one frame ahead."""
    step = max(1, (far - frames[0]) * stride // 100)
    n = 0
    for j in range(far, max(far - width * step, frames[0]), -step):
        out[n] = j
        n += 1
    for frame in frames:
        j, at = frame + 1, n
        while at > 0 and out[at - 1] < j:
            at -= 1
        if at == 0 or out[at - 1] != j:
            out[at + 1 : n + 1] = out[at:n].copy()
            out[at] = j
            n += 1
    return n


@kernel
def larger(old, size):
    """The array with room for `size` rows."""
    new = np.empty((size, *old.shape[1:]), old.dtype)
    new[: len(old)] = old
    return new


@kernel
def forward(middle, half, width, stride, most):
    """Key frames of the winning chain, and its polygons: frames (K,), counts (K, M), corners (K, M, CORNERS, 2)."""
    members, n = middle.shape
    room = 64
    frames, parents = np.empty(room, np.int64), np.empty(room, np.int64)
    counts, corners = np.empty((room, members), np.int64), np.empty((room, members, CORNERS, 2))
    lp, ahead = new_program(CORNERS), np.empty(2 * width, np.int64)
    supports, order = new_supports(CORNERS)
    frames[0], parents[0] = 0, -1
    free_states(middle, half, 0, counts[0], corners[0])
    s0, s1, guess = 0, 1, 8
    while True:
        far = level_reach(lp, frames[s0:s1], counts[s0:s1], corners[s0:s1], middle, half, guess)
        guess = far - frames[s0]
        end = s1
        if end + width >= room:
            room *= 2
            frames, parents, counts, corners = (
                larger(frames, room),
                larger(parents, room),
                larger(counts, room),
                larger(corners, room),
            )
        for j in ahead[: candidates(frames[s0:s1], far, width, stride, ahead)]:
            best = -np.inf
            for s in range(s0, s1):
                if frames[s] + 1 == j:  # a one-frame segment can end in any state
                    best, parents[end] = np.inf, s
                    free_states(middle, half, j, counts[end], corners[end])
                elif frames[s] < j and best < np.inf:
                    area = group_arrive(
                        lp,
                        counts[s],
                        corners[s],
                        middle,
                        half,
                        frames[s],
                        j,
                        most,
                        best,
                        supports,
                        order,
                        counts[end + 1],
                        corners[end + 1],
                    )
                    if area > best:  # the trial lies one place further
                        best, parents[end], counts[end], corners[end] = area, s, counts[end + 1], corners[end + 1]
            if best > -np.inf:
                frames[end] = j
                end += 1
                if j == n - 1 or end - s1 == width:
                    break
        s0, s1 = s1, end
        if frames[s0] == n - 1:
            return chain(s0, frames, parents, counts, corners)


@kernel
def chain(node, frames, parents, counts, corners):
    """The nodes from the first key to `node`."""
    length, at = 0, node
    while at >= 0:
        length += 1
        at = parents[at]
    path = np.empty(length, np.int64)
    for k in range(length - 1, -1, -1):
        path[k] = node
        node = parents[node]
    return frames[path], counts[path], corners[path]


@kernel(fastmath=True)
def cut(x, z, q, k, high, x2, z2, q2):
    """The part of a convex polygon with q <= high, into x2, z2, q2."""
    c = 0
    b = k - 1
    for a in range(k):
        if (q[a] <= high) != (q[b] <= high):
            t = (high - q[a]) / (q[b] - q[a])
            x2[c], z2[c], q2[c] = x[a] + (x[b] - x[a]) * t, z[a] + (z[b] - z[a]) * t, high
            c += 1
        if q[a] <= high:
            x2[c], z2[c], q2[c] = x[a], z[a], q[a]
            c += 1
        b = a
    return c


@kernel(fastmath=True)
def drop_corner(x, z, k):
    """Leave out the corner of a convex polygon that costs least area: long flat channels pile up nearly equal corners."""
    least, at = np.inf, 0
    for a in range(k):
        b, c = (a if a > 0 else k) - 1, a + 1 if a + 1 < k else 0
        area = abs((x[a] - x[b]) * (z[c] - z[b]) - (z[a] - z[b]) * (x[c] - x[b]))
        if area < least:
            least, at = area, a
    for a in range(at, k - 1):
        x[a], z[a] = x[a + 1], z[a + 1]
    return k - 1


@kernel(fastmath=True)
def backward(y, half, frames, counts, corners):
    """One state per key, last to first: the polygon of the key, clipped by the frames of the segment that follows, has room left; its mean."""
    keys = len(frames)
    values, slopes = np.empty(keys), np.empty(keys)
    room = 2 * CORNERS
    x, z, q, x2, z2, q2 = np.empty(room), np.empty(room), np.empty(room), np.empty(room), np.empty(room), np.empty(room)
    for key in range(keys - 1, -1, -1):
        k, i = counts[key], frames[key]
        for a in range(k):
            x[a], z[a] = corners[key, a, 0], corners[key, a, 1]
        v, m = x[:k].mean(), z[:k].mean()
        h = frames[key + 1] - i if key + 1 < keys else 0
        for g in range(1, h):
            s = g / h
            rise = (3.0 - 2.0 * s) * s * s
            fixed = rise * (values[key + 1] - y[i]) + (s - 1.0) * s * s * h * slopes[key + 1] + y[i] - y[i + g]
            lean = s * (1.0 - s) * (1.0 - s) * h
            low, high = np.inf, -np.inf
            for a in range(k):
                q[a] = fixed + (1.0 - rise) * x[a] + lean * z[a]
                low, high = min(low, q[a]), max(high, q[a])
            if high > half[i + g]:
                k = cut(x, z, q, k, half[i + g], x2, z2, q2)
                for a in range(k):
                    x[a], z[a], q[a] = x2[a], z2[a], q2[a]
            if low < -half[i + g]:
                for a in range(k):
                    q[a] = -q[a]
                k = cut(x, z, q, k, half[i + g], x2, z2, q2)
                for a in range(k):
                    x[a], z[a] = x2[a], z2[a]
            if k == 0:  # rounding; the check that follows mends it
                break
            while k > room - 2:
                k = drop_corner(x, z, k)
            v, m = x[:k].mean(), z[:k].mean()
        values[key], slopes[key] = y[i] + v, m
    return values, slopes
