"""A body taken elsewhere: its roots are moved, the other channels stay as they are."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from .. import planar, rotation
from ..motion import Motion, unroll
from ..skeleton import Skeleton
from ._body import carried
from ._pair import at_times
from ._poses import Poses, motion_of, poses_of


class Plan(NamedTuple):
    """What is done to the roots of every frame: moved, then lifted, then tilted.

    by:    (F, 3) planar transforms. lift: (F, 1) upwards. pitch: (F, 1) radians by which they lean back.
    about: (F, 4) the place x, y, z of the level axis about which they lean, and the heading across which it lies.
    """

    by: np.ndarray
    lift: np.ndarray
    pitch: np.ndarray
    about: np.ndarray


def carried_out(motion: Motion, plan: Plan) -> Motion:
    """The motion with its roots moved; frames for which nothing is asked keep their channels to the last digit."""
    made = carried(motion, plan.by, plan.lift[:, 0])
    asked = np.flatnonzero(plan.pitch[:, 0] != 0)
    if not len(asked):
        return made
    roots, columns = _roots(motion.skeleton)
    part = Motion(roots, made.values[asked][:, columns], motion.frame_time)
    leaning = _tilted(poses_of(part), roots, plan.pitch[asked], plan.about[asked])
    values = np.array(made.values, order="F")
    values[asked[:, None], columns] = motion_of(leaning, part).values
    return replace(motion, values=values, report=None)


def at_frames(motion: Motion, frames: np.ndarray) -> Motion:
    """The motion at fractions of its frames (G,), smooth in between; frames themselves are exact."""
    whole = frames.astype(np.int64)
    if len(frames) == motion.frames and np.array_equal(frames, np.arange(motion.frames)):
        return motion
    values = np.array(motion.values[whole], order="F")
    between = np.flatnonzero(frames != whole)
    if len(between):
        near = slice(max(int(whole[between].min()) - 1, 0), int(whole[between].max()) + 3)
        part = motion[near]
        smooth = at_times(part, (frames[between] - near.start) * motion.frame_time, motion.frame_time).values
        # unrolled channels may be whole turns off those of the clip
        off = motion.values[whole[between]] - unroll(part).values[whole[between] - near.start]
        turning = 360.0 * np.rint(off / 360.0)
        turning[:, ~motion.skeleton.rotation_channels] = 0.0
        values[between] = smooth + np.where(np.abs(off - turning) < 1e-6, turning, 0.0)
    return replace(motion, values=values, report=None)


def _roots(skeleton: Skeleton) -> tuple[Skeleton, np.ndarray]:
    """The roots alone, each with an end where it carried something, and the columns (C,) of their channels."""
    names: list[str] = []
    parents: list[int] = []
    offsets: list[np.ndarray] = []
    channels: list[tuple[str, ...]] = []
    for joint in np.flatnonzero(skeleton.parents < 0).tolist():
        here = len(names)
        names.append(skeleton.names[joint])
        parents.append(-1)
        offsets.append(skeleton.offsets[joint])
        channels.append(skeleton.channels[joint])
        if joint in skeleton.parents:
            names.append(f"{skeleton.names[joint]}_End")
            parents.append(here)
            offsets.append(np.zeros(3))
            channels.append(())
    columns = np.flatnonzero(skeleton.parents[skeleton.channel_joints] < 0)
    return Skeleton(tuple(names), np.array(parents), np.array(offsets), tuple(channels)), columns


def _tilted(poses: Poses, skeleton: Skeleton, pitch: np.ndarray, about: np.ndarray) -> Poses:
    roots = skeleton.parents < 0
    across = np.stack([np.cos(about[:, 3]), np.zeros(len(about)), -np.sin(about[:, 3])], axis=1)
    turn = rotation.exp(-pitch * across)[:, None]
    shifts, turned = poses.shifts.copy(), poses.turns.copy()
    middle = about[:, None, :3]
    shifts[:, roots] = middle + rotation.rotate(turn, shifts[:, roots] - middle)
    turned[:, roots] = rotation.mul(turn, turned[:, roots])
    return Poses(shifts, turned)


def laid(turn: np.ndarray, old: np.ndarray, new: np.ndarray) -> np.ndarray:
    """Planar transforms (F, 3) that take places old (F, 2) x, z to new (F, 2), turning by (F,) radians."""
    nothing = np.zeros(len(turn))
    back = np.stack([nothing, -old[:, 0], -old[:, 1]], axis=1)
    return planar.compose(np.stack([turn, new[:, 0], new[:, 1]], axis=1), back)
