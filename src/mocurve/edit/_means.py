"""The weighted mean of motions of one body and as many frames, whose moments belong together."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from .. import kinematics, rotation
from ..motion import Motion, unroll
from ._pair import whole_turns
from ._turns import between, free_joints, mean


def mean_of_channels(motions: Sequence[Motion], shares: np.ndarray) -> Motion:
    """Channel by channel, turns counted as in the heaviest; shares (N,) or, of joints that change, (N, F, J) sum to 1.

    A motion that has all of the weight comes back to the last digit.
    """
    heaviest = heaviest_of(shares)
    first = motions[heaviest]
    if (np.moveaxis(shares, 0, -1)[..., heaviest] == 1).all():
        return first
    smooth = [unroll(motion).values for motion in motions]
    turning = first.skeleton.rotation_channels
    each = shares if shares.ndim == 1 else shares[:, :, first.skeleton.channel_joints]
    values = np.zeros_like(smooth[heaviest])
    for share, value in zip(each, smooth, strict=True):
        values += share * (value - np.where(turning, whole_turns(value - smooth[heaviest]), 0.0))
    return replace(first, values=values)


def mean_of_rotations(motions: Sequence[Motion], shares: np.ndarray) -> Motion:
    """The same, and the joints that can express any rotation turned to the mean of all, seen from the heaviest."""
    heaviest = heaviest_of(shares)
    made = mean_of_channels(motions, shares)
    if made is motions[heaviest]:
        return made
    turned = kinematics.rotations(made)
    each = [kinematics.rotations(motion) for motion in motions]
    base = each[heaviest]
    for joint, _, _ in free_joints(made.skeleton):
        turns = np.stack([between(base[:, joint], other[:, joint]) for other in each])
        turned[:, joint] = rotation.mul(
            mean(turns, shares if shares.ndim == 1 else shares[:, :, joint]), base[:, joint]
        )
    return kinematics.with_rotations(made, turned)


def heaviest_of(shares: np.ndarray) -> int:
    """Which of the motions has most of the weight, the first of equally heavy ones."""
    return int(np.argmax(shares.reshape(len(shares), -1).mean(axis=1)))
