"""A motion of one body on another one: its way and its height are those of other legs."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..kinematics import world
from ..motion import Motion
from ._pair import onto


def fitted(first: Motion, motion: Motion) -> tuple[Motion, np.ndarray]:
    """The motion on the body and floor of another one, and which channels (C,) it had; joints that it does not have
    hold still as in the other's first frame."""
    held = replace(first, values=np.repeat(first.values[:1], motion.frames, axis=0), report=None)
    made, had = onto(held, motion)
    return scaled(replace(made, frame_time=motion.frame_time), *size_of(first, motion, made)), had


def main_root(motion: Motion) -> int:
    """The root that most joints hang on."""
    roots = np.flatnonzero(motion.skeleton.parents < 0).tolist()
    return max(roots, key=lambda root: int(motion.skeleton.below(root).sum()))


def rooted(first: Motion, motion: Motion) -> Motion:
    """The motion, its root called as that of the first, if no other joint of either is called so: root, hip, Hips."""
    own, other = (clip.skeleton.names[main_root(clip)] for clip in (motion, first))
    if own in first.skeleton.names or other in motion.skeleton.names:
        return motion
    names = tuple(other if name == own else name for name in motion.skeleton.names)
    return replace(motion, skeleton=replace(motion.skeleton, names=names))


def size_of(a: Motion, b: Motion, fitted: Motion) -> tuple[float, float]:
    """How much longer the legs of `a` are than those of `b`, and how much higher its floor is than b's, so scaled.

    fitted: b with the joints of a. 1 and 0 where both have the same bones.
    """
    if len(a.skeleton.names) == len(b.skeleton.names) and np.allclose(a.skeleton.offsets, b.skeleton.offsets):
        return 1.0, 0.0
    (floor, _), (own_floor, own_height), (_, height) = (_standing(clip) for clip in (a, b, fitted))
    scale = height / own_height if own_height > 0 and height > 0 else 1.0
    return scale, floor - scale * own_floor


def scaled(fitted: Motion, scale: float, higher: float) -> Motion:
    """The way and the height of all roots scaled, and so much higher."""
    if (scale, higher) == (1.0, 0.0):
        return fitted
    skeleton = fitted.skeleton
    moves = ~skeleton.rotation_channels & (skeleton.parents[skeleton.channel_joints] < 0)
    values = np.array(fitted.values, order="F")
    values[:, moves] *= scale
    values[:, moves & (skeleton.channel_axes == 1)] += higher
    return replace(fitted, values=values)


def _standing(motion: Motion) -> tuple[float, float]:
    """Where the floor is, and how high the root stands above the lowest joint: medians over the frames."""
    heights = world(motion)[..., 1]
    lowest = heights.min(axis=1)
    return float(np.median(lowest)), float(np.median(heights[:, 0] - lowest))
