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
from ._polygons import CORNERS, area, centre, clip, copy
from ._strips import furthest, new_program

# Columns of a node: its frame, the node before it, the corners of each member's polygon.
FRAME, PARENT, COUNTS = 0, 1, 2

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
    for m in range(middle.shape[0]):
        counts[m] = 4
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
    nodes: np.ndarray,
    corners: np.ndarray,
    s0: int,
    s1: int,
    middle: np.ndarray,
    half: np.ndarray,
    guess: int,
) -> int:
    """Last frame that one more segment reaches from any node of the level s0 .. s1 - 1."""
    far = nodes[s0, FRAME] + 1
    for s in range(s0, s1):
        i = nodes[s, FRAME]
        known = max(far, i + 1)
        tried = known + 1 if s > s0 else known + guess
        far = max(far, group_reach(lp, nodes[s, COUNTS:], corners[s], middle, half, i, known, tried))
        if far == middle.shape[1] - 1:
            break
    return far


@kernel
def candidates(nodes: np.ndarray, s0: int, s1: int, far: int, width: int, stride: int, out: np.ndarray) -> int:
    """Frames for the next level, furthest first: in steps of `stride` % of the segment, and those one frame ahead.

    More than `width`, as some may turn out to have no states. Returns how many, at most 4 width.
    """
    first = nodes[s0, FRAME]
    step = max(1, (far - first) * stride // 100)
    n = 0
    for j in range(far, max(far - 3 * width * step, first), -step):
        out[n] = j
        n += 1
    for s in range(s0, s1):
        j, at = nodes[s, FRAME] + 1, n
        while at > 0 and out[at - 1] < j:
            at -= 1
        if at == 0 or out[at - 1] != j:
            for k in range(n, at, -1):
                out[k] = out[k - 1]
            out[at] = j
            n += 1
    return n


@kernel
def twice(nodes: np.ndarray, corners: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The nodes with twice the room."""
    new_nodes = np.empty((2 * nodes.shape[0], nodes.shape[1]), np.int64)
    new_corners = np.empty((2 * nodes.shape[0], *corners.shape[1:]))
    for s in range(nodes.shape[0]):
        for c in range(nodes.shape[1]):
            new_nodes[s, c] = nodes[s, c]
        for m in range(corners.shape[1]):
            copy(corners[s, m], CORNERS, new_corners[s, m])
    return new_nodes, new_corners


@kernel
def best_source(
    room: tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray],
    nodes: np.ndarray,
    corners: np.ndarray,
    first: int,
    last: int,
    end: int,
    middle: np.ndarray,
    half: np.ndarray,
    j: int,
    most: int,
) -> bool:
    """Put the polygons at frame j, from the node among first .. last that gives them most area, at the place `end`.

    A trial lies one place further and moves here if it is the best.
    """
    nodes[end, FRAME] = j
    best = -np.inf
    for s in range(first, last + 1):
        i = nodes[s, FRAME]
        if i + 1 == j:  # a one-frame segment can end in any state
            nodes[end, PARENT] = s
            free_states(middle, half, j, nodes[end, COUNTS:], corners[end])
            return True
        if i < j:
            old, new = nodes[s, COUNTS:], nodes[end + 1, COUNTS:]
            covered = group_arrive(room, old, corners[s], middle, half, i, j, most, best, new, corners[end + 1])
            if covered > best:
                best, nodes[end, PARENT] = covered, s
                for m in range(middle.shape[0]):
                    nodes[end, COUNTS + m] = new[m]
                    copy(corners[end + 1, m], new[m], corners[end, m])
    return best > -np.inf


@kernel
def forward(
    middle: np.ndarray, half: np.ndarray, rounding: float, width: int, stride: int, most: int
) -> tuple[np.ndarray, np.ndarray, int]:
    """Search to the last frame. Returns nodes (N, 2 + M), polygons (N, M, CORNERS, 2) and the last node."""
    members, n = middle.shape
    nodes, corners = np.empty((64, COUNTS + members), np.int64), np.empty((64, members, CORNERS, 2))
    supports, order = new_supports(CORNERS)
    room = new_program(CORNERS, rounding), supports, order, np.empty((2 * CORNERS, 2))
    ahead = np.empty(4 * width, np.int64)
    nodes[0, FRAME], nodes[0, PARENT] = 0, -1
    free_states(middle, half, 0, nodes[0, COUNTS:], corners[0])
    s0, s1, guess = 0, 1, 8
    while nodes[s0, FRAME] < n - 1:
        far = level_reach(room[0], nodes, corners, s0, s1, middle, half, guess)
        guess, end = far - nodes[s0, FRAME], s1
        if end + width >= len(nodes):
            nodes, corners = twice(nodes, corners)
        for j in ahead[: candidates(nodes, s0, s1, far, width, stride, ahead)]:
            # The best source is nearly always that of the candidate before, or the one ahead of it.
            won = nodes[end - 1, PARENT] if end > s1 else -1
            near = won >= 0 and best_source(room, nodes, corners, max(s0, won - 1), won, end, middle, half, j, most)
            if near or best_source(room, nodes, corners, s0, s1 - 1, end, middle, half, j, most):
                end += 1
                if end - s1 == width or j == n - 1:
                    break
        s0, s1 = s1, end
    return nodes, corners, s0


@kernel(fastmath=True)
def choose(
    polygon: np.ndarray,
    size: int,
    y: np.ndarray,
    half: np.ndarray,
    i: int,
    h: int,
    end_value: float,
    end_slope: float,
    spare: np.ndarray,
) -> tuple[float, float]:
    """A state of a polygon at frame i from which a segment of h frames to a given end state holds: their middle."""
    v, m = centre(polygon, size)
    for g in range(1, h):
        s = g / h
        rise = (3.0 - 2.0 * s) * s * s
        base = rise * (end_value - y[i]) - (1.0 - s) * s * s * h * end_slope + y[i] - y[i + g]
        size = clip(polygon, size, base, 1.0 - rise, s * (1.0 - s) * (1.0 - s) * h, half[i + g], spare)
        if size == 0:  # rounding; the check that follows mends it
            break
        v, m = centre(polygon, size)
    return y[i] + v, m


@kernel
def backward(
    middle: np.ndarray, half: np.ndarray, nodes: np.ndarray, corners: np.ndarray, last: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """One state a key from the last node to the first: frames (K,), values (M, K), slopes (M, K).

    Every state of a polygon has a segment before it, and some have one after it: convexity leaves room in every clip.
    """
    keys, node = 0, last
    while node >= 0:
        keys, node = keys + 1, nodes[node, PARENT]
    members = middle.shape[0]
    frames, values, slopes = np.empty(keys, np.int64), np.empty((members, keys)), np.empty((members, keys))
    spare, node = np.empty((2 * CORNERS, 2)), last
    for k in range(keys - 1, -1, -1):
        frames[k] = nodes[node, FRAME]
        after = min(k + 1, keys - 1)
        h = frames[after] - frames[k]
        for m in range(members):
            values[m, k], slopes[m, k] = choose(
                corners[node, m],
                nodes[node, COUNTS + m],
                middle[m],
                half[m],
                frames[k],
                h,
                values[m, after],
                slopes[m, after],
                spare,
            )
        node = nodes[node, PARENT]
    return frames, values, slopes
