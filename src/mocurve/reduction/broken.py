"""The method *broken*: whole poses exactly as captured, and between two of them curves with slopes of their own.

The tangents of a key are broken: what arrives and what leaves differ. So every pair of frames is a fit of its own, its
error in space is known, and dynamic programming over all pairs finds, for all numbers of keys at once, the keys whose
largest error is least: optimal for these curves. Own method, in the frame of Roberts et al. 2019.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from ..motion import Motion
from . import salient
from ._pairs import broken_error, broken_errors, broken_slopes
from ._whole import Stage
from .choices import Choices
from .inbetweens import stage_of
from .keys import Keys
from .salient import last_from, refuse_long, ways

SPARSE = 40  # frames a key: so few keys, at least, have a choice
PATIENCE = 24  # longer segments, one after the other, that were too far off: the last of them from that frame
LONGEST = 720  # frames of a segment: keeps the table of a long clip small


def choose(motion: Motion, pinned: np.ndarray, most: int, least: int | None = None) -> Choices:
    """The best choices up to `most` keys; pinned (F,) True where a key has to be. least: the fewest keys that need a
    choice, a key in 40 frames if not said; fewer, and longer segments, take more time.

    What salient poses leave with `least` keys bounds what a segment may leave."""
    refuse_long(motion, "broken")
    stage, last = stage_of(motion), last_from(pinned)
    least = max(motion.frames // SPARSE, 2) if least is None else least
    known = salient.choose(motion, pinned, max(least, int(pinned.sum()))).frames[-1]
    enough = error_of(stage, known) * (1.0 + 1e-9)
    errors = np.zeros((motion.frames, max(1, min(motion.frames - 1, LONGEST))))
    broken_errors(stage, last, enough, PATIENCE, errors)
    found = ways(errors, last, most, "largest distance of a joint or end site from where it was, file units")
    first = len(found.frames[0]) if found.frames else most + 1
    if first <= len(known):
        return found
    # so few keys need segments longer than the table: salient poses stand in
    further = [way for way in salient.choose(motion, pinned, first - 1).frames if len(way) >= len(known)]
    errors = np.array([error_of(stage, way) for way in further])
    return Choices(further + found.frames, np.append(errors, found.errors), found.measure)


def error_of(stage: Stage, frames: np.ndarray) -> float:
    """The largest error in space of the curves that `keys_at` makes of key frames (K,)."""
    return max((float(broken_error(stage, a, b, np.inf)) for a, b in pairwise(frames)), default=0.0)


def keys_at(stage: Stage, frames: np.ndarray) -> Keys:
    """The poses of the clip at the frames (K,), and of every segment the slopes that follow the clip best."""
    samples = stage.samples
    leaving, arriving = np.zeros((2, len(frames), samples.shape[1]))
    slopes = np.empty((2, samples.shape[1]))
    for q in range(len(frames) - 1):
        broken_slopes(samples, frames[q], frames[q + 1], slopes)
        leaving[q], arriving[q + 1] = slopes
    if len(frames) > 1:
        arriving[0], leaving[-1] = leaving[0], arriving[-1]
    values, leaving, arriving = (np.ascontiguousarray(part.T) for part in (samples[frames], leaving, arriving))
    return Keys(frames, values, leaving, arriving)
