"""A body that walks exactly periodically, straight or in a curve: what the verbs that match motions are tested on."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from mocurve import Motion, Skeleton, planar
from mocurve.edit._poses import motion_of, moved, poses_of

STEP = 1.0 / 60.0
PERIOD = 66  # frames
ALL = ("Zrotation", "Xrotation", "Yrotation")
PLACE = ("Xposition", "Yposition", "Zposition")
BODY = Skeleton(
    ("Hips", "LeftLeg", "LeftFoot", "RightLeg", "RightFoot", "Head"),
    [-1, 0, 1, 0, 3, 0],
    [[0, 90, 0], [10, 0, 0], [0, -85, 0], [-10, 0, 0], [0, -85, 0], [0, 70, 5]],
    [PLACE + ALL, ALL, ALL, ALL, ALL, ("Xrotation", "Yrotation")],
    unit=0.01,
)


def walk(frames: int = 180, turn: float = 0.0, phase: float = 0.0, skeleton: Skeleton = BODY) -> Motion:
    """PERIOD frames a cycle; each goes 120 cm ahead and turns by `turn` radians, along one planar screw."""
    angle = 2.0 * np.pi * (np.arange(frames) / PERIOD) + phase
    values = np.zeros((frames, skeleton.channel_count), order="F")
    for channel in range(skeleton.channel_count):
        if skeleton.rotation_channels[channel]:
            side = np.pi if skeleton.channel_joints[channel] >= 3 else 0.0
            size = 25.0 / (1.0 + channel % 3 + 2 * (skeleton.channel_joints[channel] == 0))
            values[:, channel] = size * np.sin(angle + side + 0.7 * channel) + 3.0 * np.cos(2.0 * angle + channel)
    values[:, 1] = 90.0 + 2.0 * np.cos(2.0 * angle)
    standing = Motion(skeleton, values, STEP)
    ahead = planar.power(np.array([turn, 0.0, 120.0]), np.arange(frames) / PERIOD)
    return motion_of(moved(poses_of(standing), skeleton, ahead), standing)


def drifting(motion: Motion, degrees: float = 4.0) -> Motion:
    """The same with every rotation that is no root's drifting steadily, by so much from the first frame to the last."""
    values = np.array(motion.values, order="F")
    chosen = motion.skeleton.rotation_channels & (motion.skeleton.channel_joints > 0)
    values[:, chosen] += np.linspace(0.0, degrees, motion.frames)[:, None]
    return replace(motion, values=values)
