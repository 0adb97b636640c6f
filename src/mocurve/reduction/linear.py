"""Straight segments, for targets that read nothing else: the exact least number of keys.

A key lies on the middle of the band. From a key at frame i the slopes that stay inside the band form a cone, which
each further frame narrows; frame j can be the next key when the chord to it lies in the cone of the frames between
(Imai & Iri 1988, "Polygonal approximations of a curve", with the vertical distance). A breadth-first search over the
frames finds the fewest chords.
"""

from __future__ import annotations

import numpy as np

from ._band import inner
from ._linear import fewest_chords
from .keys import Keys


def solve(middle: np.ndarray, half: np.ndarray, quality: str = "default") -> Keys:
    """The fewest keys on the middle of the band whose straight segments stay in it at every frame, for all members at
    once.

    middle, half: (M, F) the band and its half-width, in the channel's unit; |curve - middle| <= half holds at every
    frame.
    quality:      not used: the answer is exact.
    Returns Keys with broken tangents: the slopes are those of the chords, so that the cubic Hermite curve is the
    polyline.
    """
    frames = fewest_chords(np.ascontiguousarray(middle), inner(middle, half))
    return polyline(frames, middle[:, frames])


def polyline(frames: np.ndarray, values: np.ndarray) -> Keys:
    """Straight segments through values (M, K) at frames (K,), as keys with broken tangents."""
    if len(frames) == 1:
        return Keys(frames, values, np.zeros_like(values))
    chords = np.diff(values, axis=1) / np.diff(frames)
    leaving = np.concatenate([chords, chords[:, -1:]], axis=1)
    arriving = np.concatenate([chords[:, :1], chords], axis=1)
    return Keys(frames, values, leaving, arriving)
