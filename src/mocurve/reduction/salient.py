"""Salient poses: for every number of keys the best frames (Roberts, Lewis, Anjyo, Seo and Seol 2019, Optimal and
interactive keyframe selection for motion capture, Computational Visual Media 5(2)).

A posture is a point in many dimensions. What leaving out the frames between two keys costs is the largest distance of
a posture between them from the chord; dynamic programming over all pairs of frames finds, for all numbers of keys at
once, the keys whose largest cost is least.
"""

from __future__ import annotations

import numpy as np

from ..errors import OptionError
from ..motion import Motion
from ._pairs import best_ways, chord_errors
from .choices import Choices, postures

LONGEST = 4096  # frames: beyond, tables of all pairs take gigabytes


def choose(motion: Motion, pinned: np.ndarray, most: int) -> Choices:
    """The best choices up to `most` keys; pinned (F,) True where a key has to be. OptionError for a clip that is too
    long for tables of all pairs."""
    refuse_long(motion, "salient")
    points, last = postures(motion), last_from(pinned)
    errors = np.zeros((motion.frames, max(motion.frames - 1, 1)))
    chord_errors(points, points @ points.T, last, errors)
    return ways(errors, last, most, "largest distance of a posture from the chord between its keys")


def refuse_long(motion: Motion, method: str) -> None:
    """OptionError where tables of all pairs of frames would be too large."""
    if motion.frames > LONGEST:
        raise OptionError(
            f"{method} compares all pairs of frames, of at most {LONGEST} frames; the clip has {motion.frames}: "
            "take a piece (trim), or another method"
        )


def last_from(pinned: np.ndarray) -> np.ndarray:
    """(F,) the furthest frame to which a segment from each frame may go: the next pin."""
    pins = np.flatnonzero(pinned)
    after = np.searchsorted(pins, np.arange(len(pinned)), side="right")
    return pins[np.minimum(after, len(pins) - 1)]


def ways(errors: np.ndarray, last: np.ndarray, most: int, measure: str) -> Choices:
    """The best ways through the segments with these errors (F, L), as choices."""
    found, before = best_ways(errors, last, most)
    frames = []
    for keys in np.flatnonzero(np.isfinite(found)):
        way = [len(errors) - 1]
        for k in range(keys, 1, -1):
            way.append(int(before[k, way[-1]]))
        frames.append(np.array(way[::-1], np.int64))
    return Choices(frames, found[np.isfinite(found)], measure)
