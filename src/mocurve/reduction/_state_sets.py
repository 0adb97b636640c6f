"""Propagation of sets of key states: the search behind the method *optimal*.

The state of a key is (value, slope). From a convex set of states at one key, the states that can be reached at a later
frame, every frame between being within its strip, form a convex set too. Forward: polygons are carried from each level
(number of segments) to the few frames near the furthest that one more segment reaches. Backward: from the last frame
on, a state is picked in every polygon of the winning chain. Members of a group share key times: each has its own
polygon, and a frame is reached only where all members reach it.
"""

from __future__ import annotations

import numpy as np

from .._jit import kernel
from ._end_states import arrive, new_supports
from ._polygons import CORNERS, area, clip
from ._strips import furthest, new_program

# Slopes that a key may have: from the difference to one neighbour to that to the other, and this much more.
# Without a limit the slopes of noise wander off: the frames hold, but the curve between them swings.
FREE_HALVES = 3.0  # half-widths
FREE_SPREAD = 1.0  # times the distance between the two differences
THIN = 1e-9  # polygons with less area, in half-widths and slopes per segment, are points that rounding may lose


@kernel
def slope_range(y: np.ndarray, half: np.ndarray, j: int) -> tuple[float, float]:
    """Least and largest slope that a key at frame j may have."""
    a, b = max(j - 1, 0), min(j + 1, len(y) - 1)
    before = y[j] - y[a] if a < j else y[b] - y[j]
    after = y[b] - y[j] if j < b else before
    room = FREE_HALVES * max(half[j], max(half[a], half[b])) + FREE_SPREAD * abs(after - before)
    return min(before, after) - room, max(before, after) + room


@kernel
def free_states(middle: np.ndarray, half: np.ndarray, j: int, counts: np.ndarray, corners: np.ndarray) -> None:
    """The rectangle of all states that a key at frame j may have, counted from middle[:, j]."""
    counts[:] = 4
    for m in range(middle.shape[0]):
        low, high = slope_range(middle[m], half[m], j)
        for c in range(4):
            corners[m, c, 0] = half[m, j] if c == 1 or c == 2 else -half[m, j]
            corners[m, c, 1] = high if c >= 2 else low


@kernel
def group_reach(
    lp: np.ndarray,
    counts: np.ndarray,
    corners: np.ndarray,
    middle: np.ndarray,
    half: np.ndarray,
    i: int,
    known: int,
    guess: int,
) -> int:
    """Last frame that every member can reach from frame i; `known` if that is no further."""
    last = middle.shape[1] - 1
    for m in range(middle.shape[0]):
        last = furthest(lp, corners[m], counts[m], middle[m], half[m], i, known, last, guess if m == 0 else last)
        if last <= known:
            break
    return last


@kernel
def group_arrive(
    room: tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray],
    counts: np.ndarray,
    corners: np.ndarray,
    middle: np.ndarray,
    half: np.ndarray,
    i: int,
    j: int,
    most: int,
    best: float,
    new_counts: np.ndarray,
    new_corners: np.ndarray,
) -> float:
    """Polygons of all members at frame j. Returns the sum of the logs of their areas; -inf: not more than `best`."""
    lp, supports, order, spare = room
    total, members = 0.0, middle.shape[0]
    for m in range(members):
        y, h, polygon = middle[m], half[m], new_corners[m]
        floor = np.exp(best - total) if m == members - 1 else 0.0
        size = arrive(lp, corners[m], counts[m], y, h, i, j, most, floor, supports, order, polygon)
        if size < 3:
            return -np.inf
        low, high = slope_range(y, h, j)
        size = clip(polygon, size, -0.5 * (low + high), 0.0, 1.0, 0.5 * (high - low), spare)
        covered = area(polygon, size)
        if covered * (j - i) <= THIN * h[j] * h[j]:
            return -np.inf
        new_counts[m] = size
        total += np.log(covered)
    return total


@kernel
def level_reach(
    lp: np.ndarray,
    frames: np.ndarray,
    counts: np.ndarray,
    corners: np.ndarray,
    middle: np.ndarray,
    half: np.ndarray,
    guess: int,
) -> int:
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
def candidates(frames: np.ndarray, far: int, width: int, stride: int, out: np.ndarray) -> int:
    """Frames for the next level, furthest first: in steps of `stride` % of the segment, and those one frame ahead.

    More than `width`, as some may turn out to have no states. Returns how many, at most 4 width.
    """
    step = max(1, (far - frames[0]) * stride // 100)
    n = 0
    for j in range(far, max(far - 3 * width * step, frames[0]), -step):
        out[n] = j
        n += 1
    for frame in frames:
        j, at = frame + 1, n
        while at > 0 and out[at - 1] < j:
            at -= 1
        if at == 0 or out[at - 1] != j:
            for k in range(n, at, -1):
                out[k] = out[k - 1]
            out[at] = j
            n += 1
    return n


@kernel
def larger(old: np.ndarray, size: int) -> np.ndarray:
    """The array with room for `size` rows."""
    new = np.empty((size, *old.shape[1:]), old.dtype)
    new[: len(old)] = old
    return new


@kernel
def forward(
    middle: np.ndarray, half: np.ndarray, width: int, stride: int, most: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Key frames of the winning chain, and its polygons: frames (K,), counts (K, M), corners (K, M, CORNERS, 2)."""
    members, n = middle.shape
    frames, parents = np.empty(64, np.int64), np.empty(64, np.int64)
    counts, corners = np.empty((64, members), np.int64), np.empty((64, members, CORNERS, 2))
    supports, order = new_supports(CORNERS)
    room = new_program(CORNERS), supports, order, np.empty((2 * CORNERS, 2))
    ahead = np.empty(4 * width, np.int64)
    frames[0], parents[0] = 0, -1
    free_states(middle, half, 0, counts[0], corners[0])
    s0, s1, guess = 0, 1, 8
    while frames[s0] < n - 1:
        far = level_reach(room[0], frames[s0:s1], counts[s0:s1], corners[s0:s1], middle, half, guess)
        guess, end = far - frames[s0], s1
        if end + width >= len(frames):
            size = 2 * len(frames)
            frames, parents = larger(frames, size), larger(parents, size)
            counts, corners = larger(counts, size), larger(corners, size)
        for j in ahead[: candidates(frames[s0:s1], far, width, stride, ahead)]:
            best = -np.inf
            for s in range(s0, s1):
                i = frames[s]
                if i + 1 == j:  # a one-frame segment can end in any state
                    best, parents[end] = np.inf, s
                    free_states(middle, half, j, counts[end], corners[end])
                elif i < j and best < np.inf:  # tried one place further, moved here if it is the best
                    trial = counts[end + 1], corners[end + 1]
                    covered = group_arrive(room, counts[s], corners[s], middle, half, i, j, most, best, *trial)
                    if covered > best:
                        best, parents[end] = covered, s
                        counts[end], corners[end] = trial
            if best > -np.inf:
                frames[end] = j
                end += 1
                if j == n - 1 or end - s1 == width:
                    break
        s0, s1 = s1, end
    return chain(s0, frames, parents, counts, corners)


@kernel
def chain(
    node: int, frames: np.ndarray, parents: np.ndarray, counts: np.ndarray, corners: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
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
def backward(
    y: np.ndarray, half: np.ndarray, frames: np.ndarray, counts: np.ndarray, corners: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """One state a key, last to first: the mean of its polygon, clipped by the frames of the segment that follows.

    Every state of a polygon has a segment before it, and some have one after it: convexity leaves room in every clip.
    """
    keys = len(frames)
    values, slopes = np.empty(keys), np.empty(keys)
    polygon, spare = np.empty((CORNERS, 2)), np.empty((2 * CORNERS, 2))
    for key in range(keys - 1, -1, -1):
        size, i = counts[key], frames[key]
        polygon[:size] = corners[key, :size]
        v, m = polygon[:size, 0].mean(), polygon[:size, 1].mean()
        h = frames[key + 1] - i if key + 1 < keys else 0
        for g in range(1, h):
            s = g / h
            rise = (3.0 - 2.0 * s) * s * s
            base = rise * (values[key + 1] - y[i]) - (1.0 - s) * s * s * h * slopes[key + 1] + y[i] - y[i + g]
            size = clip(polygon, size, base, 1.0 - rise, s * (1.0 - s) * (1.0 - s) * h, half[i + g], spare)
            if size == 0:  # rounding; the check that follows mends it
                break
            v, m = polygon[:size, 0].mean(), polygon[:size, 1].mean()
        values[key], slopes[key] = y[i] + v, m
    return values, slopes
