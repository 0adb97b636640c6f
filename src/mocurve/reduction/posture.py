"""Key postures by curve simplification (Lim and Thalmann 2001, Key-posture extraction out of human motion data by curve
simplification; Önder 2007, section 2.4).

The whole posture is a point in many dimensions and the motion a polyline through them. Lowe's algorithm splits a piece
at the posture farthest from its chord; here always the piece that is worst, so that there is a choice for every number
of keys, each with the keys of the one before.
"""

from __future__ import annotations

from heapq import heapify, heappop, heappush
from itertools import pairwise

import numpy as np

from ..motion import Motion
from .choices import Choices, postures


def choose(motion: Motion, pinned: np.ndarray, most: int) -> Choices:
    """The choices up to `most` keys; pinned (F,) True where a key has to be."""
    points = postures(motion)
    keys = np.flatnonzero(pinned).tolist()
    pieces = [_farthest(points, a, b) for a, b in pairwise(keys)]
    heapify(pieces)
    frames, errors = [np.array(keys, np.int64)], [_error(pieces)]
    while len(keys) < most and pieces and pieces[0][1] >= 0:
        _, split, a, b = heappop(pieces)
        keys.append(split)
        for start, end in ((a, split), (split, b)):
            heappush(pieces, _farthest(points, start, end))
        frames.append(np.array(sorted(keys), np.int64))
        errors.append(_error(pieces))
    return Choices(frames, np.array(errors), "largest distance of a posture from the chord between its keys")


def _farthest(points: np.ndarray, a: int, b: int) -> tuple[float, int, int, int]:
    """(-distance, frame, a, b) of the posture farthest from the chord between frames a and b; frame -1: none between.

    What has no posture between comes last in a heap."""
    if b - a < 2:
        return 1.0, -1, a, b
    chord, inner = points[b] - points[a], points[a + 1 : b] - points[a]
    length = chord @ chord
    part = np.clip(inner @ chord / length, 0.0, 1.0) if length > 0.0 else np.zeros(len(inner))
    off = np.linalg.norm(inner - part[:, None] * chord, axis=1)
    # where nothing is off, as in a clip that stands still, the middle
    at = int(np.argmax(off)) if off.max() > 0.0 else (b - a) // 2 - 1
    return -float(off[at]), a + 1 + at, a, b


def _error(pieces: list[tuple[float, int, int, int]]) -> float:
    return max(0.0, -pieces[0][0]) if pieces else 0.0
