"""Where feet rest, be it on the floor or not: a mask for those who treat slow feet with more care."""

from __future__ import annotations

import numpy as np

from ..kinematics import rest_height, world
from ..motion import Motion
from .legs import FOOT

SPEED = 0.25  # rest heights a second: 0.4 m/s on a person; slower is planted
WINDOW = 5  # frames: a foot is planted where it is slow all around


def planted(motion: Motion) -> np.ndarray:
    """(J, F) True where a joint or end site of a foot rests: slower than a quarter of the rest height per second, in
    all of 5 frames.

    Feet are the joints with foot, toe, ankle, heel or ball in their name, and all that hangs on them. No joint is
    called so: nothing is planted.
    """
    skeleton = motion.skeleton
    resting = np.zeros((len(skeleton.names), motion.frames), bool)
    feet = np.zeros(len(skeleton.names), bool)
    for joint, name in enumerate(skeleton.names):
        if FOOT.search(name):
            feet |= skeleton.below(joint)
    if motion.frames < 2 or not feet.any():
        return resting
    places = world(motion)[:, feet]
    speed = np.linalg.norm(np.gradient(places, axis=0), axis=-1) / motion.frame_time
    slow = speed < SPEED * rest_height(motion)
    padded = np.pad(slow, ((WINDOW // 2, WINDOW // 2), (0, 0)), constant_values=True)
    resting[feet] = np.lib.stride_tricks.sliding_window_view(padded, WINDOW, axis=0).all(axis=-1).T
    return resting
