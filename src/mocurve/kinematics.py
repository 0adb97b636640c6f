"""Forward kinematics: where the joints are, and the rotations behind the channels.

A joint's place is its parent's place plus the parent's rotation applied to its offset; a position channel replaces that axis of the
offset. Rotation channels turn in file order, each about the axes that the earlier ones have moved (Meredith and Maddock 2001,
Motion capture file formats explained, section 3).
"""

from __future__ import annotations

import numpy as np

from .motion import Motion
from .skeleton import AXES

FRAMES_AT_ONCE = 512  # so that the arrays of one step stay in the processor's second-level cache


def world(motion: Motion) -> np.ndarray:
    """Places (F, J, 3) of joints and end sites, in the file's length unit; stored joint after joint, axis after axis."""
    places = np.empty((len(motion.skeleton.names), 3, motion.frames))
    for start in range(0, motion.frames, FRAMES_AT_ONCE):
        span = slice(start, start + FRAMES_AT_ONCE)
        _walk(motion, span, places[:, :, span])
    return places.transpose(2, 0, 1)


def rest_offsets(motion: Motion) -> np.ndarray:
    """Offsets (J, 3), file units; where a joint below a root has position channels, the median of each replaces the offset.

    Some programs leave the offsets at zero and keep the bone lengths in position channels that never change.
    """
    skeleton = motion.skeleton
    offsets = skeleton.offsets.copy()
    moved = ~skeleton.rotation_channels & (skeleton.parents[skeleton.channel_joints] >= 0)
    if motion.frames:
        columns = np.flatnonzero(moved)
        offsets[skeleton.channel_joints[columns], skeleton.channel_axes[columns]] = np.median(
            motion.values[:, columns], axis=0
        )
    return offsets


def rest_height(motion: Motion) -> float:
    """Largest extent along any axis, in file units, of the rest pose: no rotation, roots at their offsets, end sites included."""
    places = rest_offsets(motion)
    for joint, parent in enumerate(motion.skeleton.parents):
        if parent >= 0:
            places[joint] += places[parent]
    return float(np.ptp(places, axis=0).max()) if len(places) else 0.0


def _walk(motion: Motion, span: slice, places: np.ndarray) -> None:
    """Fill places (J, 3, f) for the frames of `span`, parents first."""
    skeleton = motion.skeleton
    values = motion.values[span].T  # (C, f), each channel contiguous
    cosines, sines = _cosines_and_sines(values, skeleton.rotation_channels)
    turning = np.zeros(len(skeleton.names), bool)
    turning[skeleton.parents[skeleton.parents >= 0]] = True  # nobody asks for the rotation of a joint without children
    frames = places.shape[2]
    upright = np.broadcast_to(np.eye(3)[:, :, None], (3, 3, frames))
    rotations: dict[int, np.ndarray] = {}  # joint -> (3 columns, 3 components, f): the images of the axes
    channel = 0
    for joint, parent in enumerate(skeleton.parents):
        above = rotations[parent] if parent >= 0 else upright
        offset: list[np.ndarray | float] = list(skeleton.offsets[joint])
        mine = above
        for kind in skeleton.channels[joint]:
            axis = AXES.index(kind[0])
            if kind.endswith("position"):
                offset[axis] = values[channel]
            elif turning[joint] and values[channel].any():
                mine = _turned(mine, axis, cosines[channel], sines[channel])
            channel += 1
        places[joint] = places[parent] if parent >= 0 else 0.0
        for axis in range(3):
            if not (isinstance(offset[axis], float) and offset[axis] == 0.0):
                places[joint] += above[axis] * offset[axis]
        rotations[joint] = mine


def _cosines_and_sines(values: np.ndarray, rotating: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    radians = np.radians(values)
    return np.cos(radians), np.sin(radians)


def _turned(rotation: np.ndarray, axis: int, cosine: np.ndarray, sine: np.ndarray) -> np.ndarray:
    """Rotation (3 columns, 3 components, f) times a turn about one axis: only the two other columns change."""
    b, c = (axis + 1) % 3, (axis + 2) % 3
    turned = np.empty_like(rotation)
    turned[axis] = rotation[axis]
    turned[b] = rotation[b] * cosine + rotation[c] * sine
    turned[c] = rotation[c] * cosine - rotation[b] * sine
    return turned
