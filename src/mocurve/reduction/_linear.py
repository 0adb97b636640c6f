"""Kernels of linear.py: a breadth-first search over frames.

`skip` leads to the frames that no chord has reached yet.
"""

from __future__ import annotations

import numpy as np

from .._jit import kernel

STRIDES = (64, 8)  # frames between the looks of the first, coarse tests of a cone


@kernel
def _next_open(skip: np.ndarray, frame: int) -> int:
    """First frame from `frame` on that no chord has reached yet; F where there is none.

    Paths are shortened on the way.
    """
    root = frame
    while skip[root] != root:
        root = skip[root]
    while skip[frame] != root:
        skip[frame], frame = root, skip[frame]
    return root


@kernel
def _hopeful(middle: np.ndarray, half: np.ndarray, i: int, skip: np.ndarray, stride: int) -> bool:
    """Whether chords of one member (F,) from frame i may reach an open frame, judged by every stride-th frame between.

    Without this test a long flat stretch costs the square of its length: each of its frames would walk to its end for
    nothing.
    """
    low, high = -np.inf, np.inf
    t, j = i + stride, _next_open(skip, i + 1)
    while j < len(middle):
        while t < j:
            per_frame = 1.0 / (t - i)
            slope, reach = (middle[t] - middle[i]) * per_frame, half[t] * per_frame
            low, high = max(low, slope - reach), min(high, slope + reach)
            if low > high:
                return False
            t += stride
        if low <= (middle[j] - middle[i]) / (j - i) <= high:
            return True
        j = _next_open(skip, j + 1)
    return False


@kernel
def _walk(middle: np.ndarray, half: np.ndarray, inverse: np.ndarray, i: int, end: int, fits: np.ndarray) -> int:
    """Narrow the cone of one member (F,) from frame i until it is empty or `end`; return where it ended.

    fits: (F,) cleared where the chord from i to that frame leaves the band of this member.
    """
    low, high, start = -np.inf, np.inf, middle[i]
    for t in range(i + 1, end):
        per_frame = inverse[t - i]
        slope, reach = (middle[t] - start) * per_frame, half[t] * per_frame
        if slope < low or slope > high:
            fits[t] = False
        low, high = max(low, slope - reach), min(high, slope + reach)
        if low > high:
            return t + 1
    return end


@kernel
def fewest_chords(middle: np.ndarray, half: np.ndarray) -> np.ndarray:
    """Key frames (K,) of the shortest chain of chords from the first frame to the last that keeps |chord - middle| <=
    half.

    middle, half: (M, F). Level by level: level c holds the frames that c chords reach and c - 1 do not, furthest first.
    """
    members, count = middle.shape
    came_from = np.full(count, -1, np.int64)
    skip = np.arange(count + 1)
    skip[0] = 1
    first_middle, first_half = middle[0], half[0]
    inverse = 1.0 / np.arange(count)  # the first is never used
    fits = np.ones(count, np.bool_)
    level, following = np.zeros(count, np.int64), np.empty(count, np.int64)
    size = 1
    while count > 1 and came_from[count - 1] < 0:
        reached = 0
        for i in level[:size]:
            if not _hopeful(first_middle, first_half, i, skip, STRIDES[0]):
                continue
            if not _hopeful(first_middle, first_half, i, skip, STRIDES[1]):
                continue
            end = touched = _walk(first_middle, first_half, inverse, i, count, fits)
            for m in range(1, members):
                end = _walk(middle[m], half[m], inverse, i, end, fits)
            for t in range(i + 1, end):
                if fits[t] and skip[t] == t:
                    came_from[t], skip[t] = i, t + 1
                    following[reached] = t
                    reached += 1
            fits[i + 1 : touched] = True
            if came_from[count - 1] >= 0:
                break
        level[:reached] = following[:reached] if reached < 2 else np.sort(following[:reached])[::-1]
        size = reached
    chain = [count - 1]
    while chain[-1] > 0:
        chain.append(came_from[chain[-1]])
    return np.array(chain[::-1])
