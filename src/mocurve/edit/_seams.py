"""How well pieces of motion fit together: numbers that the eye would see as a jump."""

from __future__ import annotations

import numpy as np

from ..errors import OptionError
from ..info import first_frame_is_t_pose, unit_of
from ..kinematics import world
from ..motion import Motion

USUAL = 99.5  # percent of a clip's frames that are below what is counted as its fastest


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


def usual(*clips: Motion) -> tuple[float, float]:
    """The largest usual step and bend of a joint in the calmest of the clips, file units, without T-poses in front."""
    places = [world(clip[int(first_frame_is_t_pose(clip)) :]) for clip in clips]
    found = [[float(np.percentile(of(p), USUAL)) if len(p) > 2 else 0.0 for p in places] for of in (steps, bends)]
    return min(found[0]), min(found[1])
