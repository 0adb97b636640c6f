"""Propagation of sets of key states: the search behind the method *optimal*.

The state of a key is (value, slope). From a convex set of states at one key the states that can be reached at a later frame, every frame between
being within its strip, form a convex set too. Forward: convex polygons (inner approximations with true corners) are carried from each level
(number of segments) to the few frames near the furthest that one more segment reaches. Backward: from the last frame a state is picked in every polygon
of the winning chain. Members of a group share key times: each has its own polygon, and a frame is reached only where all members reach it.
"""

from __future__ import annotations

import numpy as np

from .._jit import kernel
from ._strips import CUBIC, aim, furthest, new_program, solve, start_basis, start_strips

CORNERS = 12  # room for the corners of a polygon of states
FREE = 2.2  # slopes of a state without history: local difference +- this times the half-width
THIN = 1e-9  # polygons with less area than this, in half-widths, are taken for points that rounding may lose


@kernel
def free_states(y, half, j, polygon):
    """Rectangle of states, counted from y[j], for a key without history: any value, a slope near the local difference."""
    a, b = (j, j + 1) if j + 1 < len(y) else (j - 1, j)
    slope, spread = y[b] - y[a], FREE * max(half[a], half[b])
    polygon[0, 0], polygon[0, 1] = -half[j], slope - spread
    polygon[1, 0], polygon[1, 1] = half[j], slope - spread
    polygon[2, 0], polygon[2, 1] = half[j], slope + spread
    polygon[3, 0], polygon[3, 1] = -half[j], slope + spread


@kernel(fastmath=True)
def support(lp, count, y, half, i, j, dv, dm, s):
    """The end state (value from y[i], slope per segment) furthest in the direction (dv, dm), into s with the direction."""
    aim(lp, 1.0, dv, dm)
    if solve(lp, count, y, half, i, j, 1.0 / (j - i)) > 0:
        return False
    x0, x1, x2, x3 = lp[CUBIC, 0], lp[CUBIC, 1], lp[CUBIC, 2], lp[CUBIC, 3]
    s[0], s[1], s[2], s[3] = x0 + x1 + x2 + x3, x1 + 2.0 * x2 + 3.0 * x3, dv, dm
    return True


@kernel(fastmath=True)
def corner_gain(s, a, b):
    """Area that the set may still have beyond the edge between the supports a and b: triangle of the edge and the two supporting lines."""
    dx, dy = s[b, 0] - s[a, 0], s[b, 1] - s[a, 1]
    turn = s[a, 2] * s[b, 3] - s[a, 3] * s[b, 2]
    if turn <= 0.0:
        return 0.0
    along = (s[b, 2] * dx + s[b, 3] * dy) / turn
    return 0.5 * along * (-s[a, 3] * dy - s[a, 2] * dx)


@kernel(fastmath=True)
def polygon_of(s, n, y, i, j, span, polygon):
    """Write the distinct supports as a polygon of (value from y[j], slope per frame). Returns the count of corners and the area."""
    k, shift = 0, y[i] - y[j]
    for a in range(n):
        b = a - 1 if a > 0 else n - 1
        if s[a, 0] != s[b, 0] or s[a, 1] != s[b, 1]:
            polygon[k, 0], polygon[k, 1] = s[a, 0] + shift, s[a, 1] / span
            k += 1
    area = 0.0
    for a in range(1, k - 1):
        area += (polygon[a, 0] - polygon[0, 0]) * (polygon[a + 1, 1] - polygon[0, 1])
        area -= (polygon[a, 1] - polygon[0, 1]) * (polygon[a + 1, 0] - polygon[0, 0])
    return k, 0.5 * area


@kernel(fastmath=True)
def arrive(lp, start, count, y, half, i, j, most, s, polygon):
    """Polygon of states at frame j reached from the polygon `start` at frame i: corners (0: none) and area.

    Sandwich: each support (point, direction) bounds the set by a line as well; the next direction is square to the edge
    beyond which most area may be missing."""
    span = float(j - i)
    start_strips(lp, start, count, span)
    start_basis(lp, count, y, half, i, j, span)
    if not support(lp, count, y, half, i, j, 1.0, 0.0, s[0]) or not support(lp, count, y, half, i, j, -1.0, 0.0, s[2]):
        return 0, 0.0
    dx, dy = s[2, 0] - s[0, 0], s[2, 1] - s[0, 1]
    if not support(lp, count, y, half, i, j, dy, -dx, s[1]) or not support(lp, count, y, half, i, j, -dy, dx, s[3]):
        return 0, 0.0
    n = 4
    while n < most:
        best, at = 0.0, -1
        for a in range(n):
            gain = corner_gain(s, a, a + 1 if a + 1 < n else 0)
            if gain > best:
                best, at = gain, a
        if at < 0:
            break
        b = at + 1 if at + 1 < n else 0
        if not support(lp, count, y, half, i, j, s[b, 1] - s[at, 1], s[at, 0] - s[b, 0], s[n]):
            break
        for a in range(n, at + 1, -1):
            for c in range(4):
                s[a, c], s[a - 1, c] = s[a - 1, c], s[a, c]
        n += 1
    k, area = polygon_of(s, n, y, i, j, span, polygon)
    return (k, area) if k >= 3 and area * span > THIN * half[j] * half[j] else (0, 0.0)


@kernel
def group_reach(lp, polygons, counts, middle, half, i, known, guess):
    """Last frame that every member can reach from frame i; `known` if that is no further."""
    last = middle.shape[1] - 1
    for m in range(middle.shape[0]):
        last = furthest(lp, polygons[m], counts[m], middle[m], half[m], i, known, last, guess if m == 0 else last)
        if last <= known:
            break
    return last


@kernel
def group_arrive(lp, polygons, counts, middle, half, i, j, most, supports, best, size, corners, found):
    """Polygons of all members at frame j, kept in `corners`, `found` if their areas multiply to more than `best` (a sum of logs)."""
    total = 0.0
    members = middle.shape[0]
    trial = np.empty((members, CORNERS, 2))
    trial_size = np.empty(members, np.int64)
    for m in range(members):
        k, area = arrive(lp, polygons[m], counts[m], middle[m], half[m], i, j, most, supports, trial[m])
        if k == 0:
            return best
        trial_size[m] = k
        total += np.log(area)
    if total <= best:
        return best
    corners[:] = trial
    found[:] = trial_size
    return total


@kernel
def candidates(frames, s0, s1, far, width, stride, out):
    """Frames of the next level, furthest first: `width` of them in steps of `stride` % of the segment, and those after one-frame segments."""
    step = max(1, (far - frames[s0]) * stride // 100)
    n = 0
    for o in range(width):
        if far - o * step > frames[s0]:
            out[n] = far - o * step
            n += 1
    for s in range(s0, s1):
        j = frames[s] + 1
        at = n
        while at > 0 and out[at - 1] < j:
            at -= 1
        if at == 0 or out[at - 1] != j:
            for a in range(n, at, -1):
                out[a] = out[a - 1]
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
    lp, supports, ahead = new_program(CORNERS), np.empty((CORNERS + 1, 4)), np.empty(2 * width, np.int64)
    frames[0], parents[0], counts[0] = 0, -1, 4
    for m in range(members):
        free_states(middle[m], half[m], 0, corners[0, m])
    s0, s1, guess = 0, 1, 8
    while True:
        far = frames[s0] + 1
        for s in range(s0, s1):
            reached = group_reach(
                lp,
                corners[s],
                counts[s],
                middle,
                half,
                frames[s],
                max(far, frames[s] + 1),
                far + 1 if s > s0 else far + guess,
            )
            far = max(far, reached)
            if far == n - 1:
                break
        guess = max(1, far - frames[s0] - 1)
        end = s1
        if end + width > room:
            room *= 2
            frames, parents, counts, corners = (
                larger(frames, room),
                larger(parents, room),
                larger(counts, room),
                larger(corners, room),
            )
        for c in range(candidates(frames, s0, s1, far, width, stride, ahead)):
            j, best = ahead[c], -np.inf
            for s in range(s0, s1):
                if frames[s] + 1 == j:  # a one-frame segment can end in any state
                    best, parents[end], counts[end] = np.inf, s, 4
                    for m in range(members):
                        free_states(middle[m], half[m], j, corners[end, m])
                elif frames[s] < j and best < np.inf:
                    area = group_arrive(
                        lp,
                        corners[s],
                        counts[s],
                        middle,
                        half,
                        frames[s],
                        j,
                        most,
                        supports,
                        best,
                        s,
                        corners[end],
                        counts[end],
                    )
                    if area > best:
                        best, parents[end] = area, s
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
