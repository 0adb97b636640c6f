"""Rotations between two clips: the turn from one to the other, and parts of it, without flips.

The turn from a to b is continuous in time: which of the two ways round it goes is chosen once for the whole clip, on
the whole the shorter one, so that poses nearly opposite do not flip from frame to frame. Where it comes near a whole
turn, as between a root that has turned several times and one that has not, its axis can no longer be told from it; then
the turning about the one coordinate axis that it turns most about is counted as an angle, and only what is left is a
rotation vector (for a root, heading and tilt).
"""

from __future__ import annotations

import numpy as np

from .. import rotation
from ..skeleton import Skeleton

LONG = np.radians(270.0)  # a turn beyond is counted about an axis; a rotation vector is singular at 360 degrees
MEAN_STEPS, MEAN_RADIANS = 20, 1e-13


def free_joints(skeleton: Skeleton) -> list[tuple[int, list[int], str]]:
    """(joint, columns of its rotation channels, their order) of the joints whose channels can express any rotation."""
    return [
        (joint, columns, order)
        for joint, (columns, order) in enumerate(skeleton.eulers)
        if len(order) == 3 and order[1] not in (order[0], order[2])
    ]


def between(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """The turn (F, 4) from a (F, 4) to b (F, 4) as the parent sees it, continuous, on the whole the shorter way."""
    return _continuous(rotation.mul(b, rotation.inv(a)))


def part(turn: np.ndarray, share: np.ndarray) -> np.ndarray:
    """So much (F,) of a continuous turn (F, 4): 0 is none, 1 all of it, 0.5 half, -1 the way back."""
    half = np.arctan2(np.linalg.norm(turn[:, 1:], axis=1), turn[:, 0])  # 0 to pi
    if 2.0 * half.max(initial=0.0) <= LONG:
        return rotation.exp(_vectors(turn) * share[:, None])
    return _counted(turn[None], share[None])


def mean(turns: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """(F, 4) the weighted mean of turns (N, F, 4) from one rotation to N others; weights (N,) or (N, F) sum to 1.

    The mean is where the weighted rotation vectors to all of them cancel; it is found by going there a few times.
    Where a turn is longer than half a turn the mean is that of `part`, one step.
    """
    half = np.arctan2(np.linalg.norm(turns[..., 1:], axis=-1), turns[..., 0])
    if 2.0 * half.max(initial=0.0) > LONG:
        return _counted(turns, weights)
    weights = np.broadcast_to(weights.reshape(len(turns), -1), turns.shape[:2])
    middle = rotation.exp(np.einsum("nf,nfk->fk", weights, _vectors(turns)))
    if 2.0 * half.max(initial=0.0) < np.pi:
        for _ in range(MEAN_STEPS):
            step = np.einsum("nf,nfk->fk", weights, rotation.log(rotation.mul(turns, rotation.inv(middle))))
            middle = rotation.mul(rotation.exp(step), middle)
            if np.abs(step).max(initial=0.0) < MEAN_RADIANS:
                break
    return middle


def _counted(turns: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """The mean where the turning about one axis is an angle (N, F), and what is left are rotation vectors."""
    angles = 2.0 * np.unwrap(np.arctan2(turns[..., 1:], turns[..., :1]), axis=-2)  # (N, F, 3) twist about each axis
    axis = told_axis(turns)
    angle = angles[..., axis] - 2.0 * np.pi * np.rint(angles[:, :1, axis] / (2.0 * np.pi))
    about = np.eye(3)[axis]
    left = rotation.mul(rotation.inv(rotation.exp(angle[..., None] * about)), turns)
    rest = np.stack([_vectors(_continuous(one)) for one in left])
    weights = weights.reshape(len(turns), -1)  # (N, 1) or (N, F)
    twist = rotation.exp((weights * angle).sum(axis=0)[:, None] * about)
    return rotation.mul(twist, rotation.exp((weights[..., None] * rest).sum(axis=0)))


def told_axis(turns: np.ndarray) -> int:
    """The coordinate axis whose twist is told best throughout: where what is left of a rotation (..., 4) without it
    comes least near a half turn, at which it is not defined."""
    told = turns[..., 1:] ** 2 + turns[..., :1] ** 2
    return int(np.argmax(told.reshape(-1, 3).min(axis=0, initial=1.0)))


def _continuous(turn: np.ndarray) -> np.ndarray:
    turn = rotation.unroll(turn)
    return -turn if turn[:, 0].sum() < 0 else turn


def _vectors(turn: np.ndarray) -> np.ndarray:
    """Rotation vectors (..., 3), radians, 0 to 2 pi long, of unit quaternions (..., 4) of either sign."""
    sine = np.linalg.norm(turn[..., 1:], axis=-1, keepdims=True)
    near_zero = (sine < 1e-12) & (turn[..., :1] > 0)  # there the angle is twice the sine, to the last digit
    safe_sine = np.where(sine < 1e-12, 1.0, sine)
    return turn[..., 1:] * np.where(near_zero, 2.0, 2.0 * np.arctan2(sine, turn[..., :1]) / safe_sine)
