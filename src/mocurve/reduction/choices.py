"""What a way to choose whole poses returns, and the postures that it looks at."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..kinematics import world
from ..motion import Motion


class Choices(NamedTuple):
    """Key frames for every number of keys that there is a choice for, and what it is judged by.

    frames: one array a choice, rising, each with one key more than the one before; always the first and the last frame
    and those that are pinned. errors: (N,) in the method's own measure, which `measure` tells."""

    frames: list[np.ndarray]
    errors: np.ndarray
    measure: str


def postures(motion: Motion) -> np.ndarray:
    """Postures as points (F, D): where all joints and end sites are, file units, about their mean."""
    points = world(motion).reshape(motion.frames, -1)
    return np.ascontiguousarray(points - points.mean(axis=0))


def stances(motion: Motion) -> np.ndarray:
    """Postures as vectors (F, D) that can be added: places of joints and end sites from the first root, file units."""
    places = world(motion)
    return np.ascontiguousarray((places - places[:, :1]).reshape(motion.frames, -1))


def astray(stances: np.ndarray, keys: np.ndarray) -> np.ndarray:
    """How far every posture (F, D) is from the nearest linear combination of those at the key frames (K,): file
    units."""
    axes = _span(stances[keys])
    return np.linalg.norm(stances - (stances @ axes) @ axes.T, axis=1)


def _span(rows: np.ndarray) -> np.ndarray:
    """An orthonormal basis (D, R) of what the rows (K, D) span, directions of rounding left out."""
    _, sizes, axes = np.linalg.svd(rows, full_matrices=False)
    return axes[sizes > 1e-10 * sizes.max(initial=0.0)].T
