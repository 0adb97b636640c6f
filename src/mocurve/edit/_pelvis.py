"""Where the pelvis goes so that both feet reach what they should and the knees bend as they did: one banded least
squares over all frames.

Unknown is a shift (F, 3), cm, of the whole body. Every term is divided by its tolerance in its own unit; the bend of a
knee as it depends on the shift is made linear a few times (Gauss and Newton).
"""

from __future__ import annotations

import numpy as np
from scipy.linalg import solveh_banded

from ._hinge import Hinge

BENDS = np.radians(6.0)  # flexion off what is wanted
QUICKENS = np.radians(1500.0)  # a second a second, of that
SIDEWAYS, UP = 2.5, 2.5  # cm of shift
HURRIES = 300.0  # cm a second a second, of the shift
FAST = 1e12  # weight of a shift that is to be none
BAND = 9


class Legs:
    """What pulls at the pelvis: hips as carried (F, 3), ankle targets, hinges, wanted flexion and weights (F,)."""

    def __init__(self, hinge: Hinge, hip: np.ndarray, wanted: np.ndarray, weight: np.ndarray) -> None:
        self.hinge, self.hip, self.wanted, self.weight = hinge, hip, wanted, weight


def shifted(legs: list[tuple[Legs, np.ndarray]], at: np.ndarray, fixed: np.ndarray, frame_time: float) -> np.ndarray:
    """The best shift (F, 3), the knees linear about the shift `at`. legs: each with its ankle targets (F, 3). Where
    `fixed` (F,) the shift is none."""
    frames = len(at)
    band, right = _quiet(frames, frame_time, fixed), np.zeros((3, frames))
    for leg, target in legs:
        _add(band, right, leg, target, at, frame_time)
    # filled axis after axis, solved frame after frame: the unknowns are x, y, z of the first, then of the second
    found = solveh_banded(
        band.transpose(0, 2, 1).reshape(BAND, 3 * frames),
        right.T.reshape(-1),
        lower=True,
        overwrite_ab=True,
        check_finite=False,
    )
    result: np.ndarray = found.reshape(frames, 3)
    result[fixed] = 0.0
    return result


# -- in call order ---------------------------------------------------------------------------------


def _quiet(frames: int, frame_time: float, fixed: np.ndarray) -> np.ndarray:
    """Lower band (9, 3, F) of: a small shift, without haste."""
    band = np.zeros((BAND, 3, frames))
    band[0] = np.array([SIDEWAYS, UP, SIDEWAYS])[:, None] ** -2.0
    weight = (HURRIES * frame_time * frame_time) ** -2.0
    for first, a in enumerate((1.0, -2.0, 1.0)):
        for second, b in enumerate((1.0, -2.0, 1.0)[first:]):
            band[3 * second, :, first : frames - 2 + first] += weight * a * b
    band[0][:, fixed] += FAST
    return band


def _add(band: np.ndarray, right: np.ndarray, leg: Legs, target: np.ndarray, at: np.ndarray, frame_time: float) -> None:
    """A leg's pull: the flexion off what is wanted, and its second difference, both as bend + slope . shift."""
    to = (leg.hip + at - target).T
    length = np.sqrt((to * to).sum(axis=0))
    flexion, slope = leg.hinge.bend(length)
    pull = to * (slope / length)  # (3, F)
    off = flexion - leg.wanted - (pull * at.T).sum(axis=0)
    _square(band, right, pull, off, leg.weight / BENDS**2)
    rows = np.concatenate([pull[:, :-2], -2.0 * pull[:, 1:-1], pull[:, 2:]])
    change = off[:-2] - 2.0 * off[1:-1] + off[2:]
    _square(band, right, rows, change, leg.weight[1:-1] / (QUICKENS * frame_time**2) ** 2)


def _square(band: np.ndarray, right: np.ndarray, rows: np.ndarray, off: np.ndarray, weight: np.ndarray) -> None:
    """Add the squares weight (row . unknowns + off)^2, rows (3 or 9, T) beginning at the first unknown of frame t."""
    wide, count = rows.shape
    heavy = rows * weight
    for j in range(wide):
        at = slice(j // 3, j // 3 + count)
        right[j % 3, at] -= heavy[j] * off
        for i in range(wide - j):
            band[i, j % 3, at] += heavy[j] * rows[j + i]
