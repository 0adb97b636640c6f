"""Poses apart from the channels that carry them, so that two of them can be mixed and a whole body moved."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from .. import kinematics, planar, rotation
from ..errors import Mismatch
from ..motion import Motion
from ..skeleton import AXES, Skeleton

STAYED = 1e-9  # of the largest shift: an axis without a channel may be off by so much


@dataclass(frozen=True, eq=False)
class Poses:
    """Where and how every joint stands against its parent.

    shifts: (F, J, 3) file units: its offset, or what its position channels say. turns: (F, J, 4) wxyz.
    """

    shifts: np.ndarray
    turns: np.ndarray

    def __len__(self) -> int:
        return len(self.shifts)

    def __getitem__(self, frames: slice | np.ndarray) -> Poses:
        return Poses(self.shifts[frames], self.turns[frames])


def poses_of(motion: Motion) -> Poses:
    """The poses of every frame."""
    skeleton = motion.skeleton
    shifts = np.repeat(skeleton.offsets[None], motion.frames, axis=0)
    columns, joints, axes = _positions(skeleton)
    shifts[:, joints, axes] = motion.values[:, columns]
    return Poses(shifts, kinematics.rotations(motion))


def motion_of(poses: Poses, base: Motion) -> Motion:
    """The motion in these poses. Joints that stand as in `base` (of as many frames) keep its channels.

    A joint below a root that has fewer than three rotation channels gets the nearest rotation that they can express: a
    mix of two such rotations lies a little beside them. So does a root that carries nothing (a marker). Mismatch where
    another root lacks a channel to go or turn by.
    """
    skeleton = base.skeleton
    columns, joints, axes = _positions(skeleton)
    carried = np.repeat(skeleton.offsets[None], len(poses), axis=0)
    carried[:, joints, axes] = poses.shifts[:, joints, axes]
    off = np.abs(carried - poses.shifts).max(axis=0, initial=0.0)
    if (off > STAYED * (1.0 + np.abs(poses.shifts).max(initial=0.0))).any():
        joint, axis = (int(places[0]) for places in np.nonzero(off > 0))
        raise Mismatch(f"joint {skeleton.names[joint]!r} has to be moved, and has no channel {AXES[axis]}position")
    values = np.array(base.values, order="F")
    values[:, columns] = poses.shifts[:, joints, axes]
    return kinematics.with_rotations(replace(base, values=values, report=None), _expressible(poses.turns, skeleton))


def moved(poses: Poses, skeleton: Skeleton, by: np.ndarray) -> Poses:
    """The whole body taken elsewhere by planar transforms, (3,) or one a frame (F, 3)."""
    roots = skeleton.parents < 0
    shifts, turns = poses.shifts.copy(), poses.turns.copy()
    shifts[:, roots] = planar.move(by[..., None, :], shifts[:, roots])
    turns[:, roots] = rotation.mul(planar.quaternion(by)[..., None, :], turns[:, roots])
    return Poses(shifts, turns)


def mixed(a: Poses, b: Poses, weights: np.ndarray) -> Poses:
    """From a (weight 0) to b (weight 1), a weight a frame (F,): shifts straight, turns the shorter way."""
    return Poses(
        a.shifts + weights[:, None, None] * (b.shifts - a.shifts), rotation.slerp(a.turns, b.turns, weights[:, None])
    )


def strung(*parts: Poses) -> Poses:
    """One after the other."""
    return Poses(np.concatenate([part.shifts for part in parts]), np.concatenate([part.turns for part in parts]))


def smooth(u: np.ndarray) -> np.ndarray:
    """0 to 1 over u from 0 to 1, without speed or acceleration at either end."""
    return u * u * u * (10.0 + u * (6.0 * u - 15.0))


def _positions(skeleton: Skeleton) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Of every position channel its column, joint and axis."""
    columns = np.flatnonzero(~skeleton.rotation_channels)
    return columns, skeleton.channel_joints[columns], skeleton.channel_axes[columns]


def _expressible(turns: np.ndarray, skeleton: Skeleton) -> np.ndarray:
    turns = turns.copy()
    for joint, kinds in enumerate(skeleton.channels):
        order = "".join(kind[0] for kind in kinds if kind.endswith("rotation"))
        turns_others = skeleton.parents[joint] < 0 and joint in skeleton.parents
        if len(order) < 3 and not turns_others:
            turns[:, joint] = rotation.from_euler(rotation.to_euler(turns[:, joint], order), order)
    return turns
