"""Key probe (Huang, Chang, Hsu and Yang 2005, Key Probe: a technique for animation keyframe extraction; Önder 2007,
section 2.2).

The clip A (F, D) is to be W H with H the key postures: a frame is a linear combination of all keys, and no in-between
of two. Greedy: the next key is the frame that A H⁺ H misses by most. Once the keys span every posture the next pass
begins, among the frames that are left.
"""

from __future__ import annotations

import numpy as np

from ..motion import Motion
from .choices import Choices, stances

ROUNDING = 1e-9  # of the largest posture: missed by less is spanned


def choose(motion: Motion, pinned: np.ndarray, most: int) -> Choices:
    """The choices up to `most` keys; pinned (F,) True where a key has to be."""
    clip = stances(motion)
    size = np.linalg.norm(clip, axis=1)
    least = ROUNDING * size.max(initial=0.0)
    free, rest, spanned = ~pinned, clip.copy(), False
    for frame in np.flatnonzero(pinned).tolist():
        _take_out(rest, frame, least)
    frames, errors = [np.flatnonzero(pinned)], [0.0 if spanned else part_missed(rest, size)]
    while len(frames[-1]) < most and free.any():
        missed = np.where(free, np.linalg.norm(rest, axis=1), -1.0)
        if missed.max() <= least:  # every frame is a combination of the keys: again, among the frames that are left
            spanned, rest = True, clip.copy()
            missed = np.where(free, np.linalg.norm(rest, axis=1), -1.0)
        frame = int(np.argmax(missed))
        free[frame] = False
        _take_out(rest, frame, least)
        frames.append(np.flatnonzero(~free))
        errors.append(0.0 if spanned else part_missed(rest, size))
    return Choices(frames, np.array(errors), "largest part of a posture that no combination of the keys makes")


def weights(motion: Motion, keys: np.ndarray) -> np.ndarray:
    """W (F, K): every posture as the combination of those at the key frames (K,) that is nearest to it; a key is
    itself."""
    clip = stances(motion)
    found = clip @ np.linalg.pinv(clip[keys], rcond=1e-10)
    found[keys] = np.eye(len(keys))
    return found


def part_missed(rest: np.ndarray, size: np.ndarray) -> float:
    """The largest part of a posture of that size (F,) that is left (F, D)."""
    left = np.linalg.norm(rest, axis=1)
    return float(np.divide(left, size, out=np.zeros_like(left), where=size > 0.0).max(initial=0.0))


def _take_out(rest: np.ndarray, frame: int, least: float) -> None:
    """What the posture at the frame adds to the span of the keys goes from all."""
    length = np.linalg.norm(rest[frame])
    if length > least:
        axis = rest[frame] / length
        for _ in range(2):  # once more for the rounding of the first time
            rest -= np.outer(rest @ axis, axis)
