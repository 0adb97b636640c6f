"""How well pieces of motion fit together: numbers that the eye would see as a jump."""

from __future__ import annotations

import numpy as np

from ..errors import OptionError
from ..info import unit_of
from ..motion import Motion


def centimetres(motion: Motion) -> float | None:
    """Centimetres a file unit, None where nobody said and there is no height to guess it from."""
    try:
        return 100.0 * unit_of(motion).metres
    except OptionError:
        return None


def bends(places: np.ndarray) -> np.ndarray:
    """How far (F,) some joint is at frame f + 1 from where it was going at f - 1 and f, file units; 0 at both ends."""
    away = np.linalg.norm(places[2:] - 2.0 * places[1:-1] + places[:-2], axis=-1).max(axis=-1)
    return np.concatenate([[0.0], away, [0.0]])[: len(places)]


def steps(places: np.ndarray) -> np.ndarray:
    """How far (F - 1,) the joint goes that goes furthest, file units a frame."""
    return np.linalg.norm(np.diff(places, axis=0), axis=-1).max(axis=-1)
