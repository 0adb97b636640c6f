"""Forward kinematics: where the joints are, and the rotations behind the channels.

A joint's place is its parent's place plus the parent's rotation applied to its offset; a position channel replaces
that axis of the offset and leaves the others, as Blender reads BVH. Rotation channels turn in file order, each about
the axes that the earlier ones have moved (Meredith and Maddock 2001, Motion capture file formats explained).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from . import rotation
from .errors import Mismatch
from .motion import Motion

SAME_DEGREES = 1e-11  # rotations as near as this are the same one: the channels stay as they are
EXPRESSIBLE_DEGREES = 1e-6


def world(motion: Motion) -> np.ndarray:
    """Places (F, J, 3) of joints and end sites, file units; stored joint after joint, axis after axis."""
    from .kinematics_kernel import walk  # here, so that asking for the rest pose does not load the compiler

    skeleton = motion.skeleton
    joints, rotating = skeleton.channel_joints, skeleton.rotation_channels
    inner = np.zeros(len(skeleton.names), bool)
    inner[skeleton.parents[skeleton.parents >= 0]] = True  # nobody asks for the rotation of a joint without children
    turning = rotating & inner[joints] & motion.values.any(axis=0)
    turned = np.zeros(len(skeleton.names), bool)
    turned[joints[turning]] = True
    # cosine and sine follow from the tangent of half the angle; NumPy has it five times as fast as the two together
    tangents = motion.values.T[turning]
    tangents *= np.pi / 360.0
    np.tan(tangents, out=tangents)
    places = np.empty((len(skeleton.names), 3, motion.frames))
    firsts = np.concatenate([[0], np.cumsum([len(kinds) for kinds in skeleton.channels], dtype=np.int64)])
    rows = [np.where(chosen, np.cumsum(chosen) - 1, -1) for chosen in (turning, ~rotating)]
    shifts = motion.values.T[~rotating]
    walk(skeleton.parents, skeleton.offsets, firsts, skeleton.channel_axes, *rows, turned, tangents, shifts, places)
    return places.transpose(2, 0, 1)


def rotations(motion: Motion) -> np.ndarray:
    """Quaternions (F, J, 4) wxyz: each joint's rotation against its parent; (1, 0, 0, 0) where it has no channels."""
    result = np.empty((motion.frames, len(motion.skeleton.names), 4))
    for joint, (columns, order) in enumerate(motion.skeleton.eulers):
        result[:, joint] = rotation.from_euler(motion.values[:, columns], order)
    return result


def world_rotations(motion: Motion, joints: Sequence[int]) -> np.ndarray:
    """Quaternions (F, len(joints), 4) wxyz: how the world sees these joints' axes."""
    skeleton, eulers = motion.skeleton, motion.skeleton.eulers
    known: dict[int, np.ndarray] = {-1: np.broadcast_to([1.0, 0.0, 0.0, 0.0], (motion.frames, 4))}

    def turned(joint: int) -> np.ndarray:
        line = []
        while joint not in known:
            line.append(joint)
            joint = int(skeleton.parents[joint])
        above = known[joint]
        for each in reversed(line):
            columns, order = eulers[each]
            own = rotation.from_euler(motion.values[:, columns], order) if order else None
            above = known[each] = above if own is None else rotation.mul(above, own)
        return above

    return np.stack([turned(int(joint)) for joint in joints], axis=1)


def with_rotations(motion: Motion, wxyz: np.ndarray) -> Motion:
    """The motion with other joint rotations (F, J, 4) wxyz, written in each joint's own order and unrolled.

    The angles start as near as they can to those of the first frame. A joint whose rotations are those it has keeps
    its channels to the last digit. Mismatch where the shape is another, where a quaternion has not length 1, and
    where a joint's channels cannot express its rotation (it has fewer than three axes).
    """
    before = rotations(motion)
    wxyz = np.asarray(wxyz, np.float64)
    if wxyz.shape != before.shape:
        raise Mismatch(f"the rotations have shape {wxyz.shape}, the motion needs (frames, joints, 4) = {before.shape}")
    odd = ~(np.abs(np.einsum("fjk,fjk->fj", wxyz, wxyz) - 1.0) < 1e-6)
    _refuse(motion, odd, "is no quaternion of length 1")
    values = np.array(motion.values, order="F")
    changed = np.any(rotation.angle(before, wxyz) > SAME_DEGREES, axis=0)
    lost = np.zeros(odd.shape)
    for joint, (columns, order) in enumerate(motion.skeleton.eulers):
        if not changed[joint]:
            continue
        angles = rotation.to_euler(wxyz[:, joint], order)
        lost[:, joint] = rotation.angle(rotation.from_euler(angles, order), wxyz[:, joint])
        values[:, columns] = rotation.unroll_euler(np.vstack([values[:1, columns], angles]), order)[1:]
    _refuse(motion, lost > EXPRESSIBLE_DEGREES, "cannot be expressed by the channels")
    return replace(motion, values=values)


def rest_offsets(motion: Motion) -> np.ndarray:
    """Offsets (J, 3), file units, of the body at rest.

    Below a root, the median of a position channel replaces the offset: some programs leave the offsets at zero and
    keep the bone lengths in channels that never change.
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
    """Largest extent along any axis, file units, of the rest pose: no rotation, roots at their offsets."""
    places = rest_offsets(motion)
    for joint, parent in enumerate(motion.skeleton.parents):
        if parent >= 0:
            places[joint] += places[parent]
    return float(np.ptp(places, axis=0).max()) if len(places) else 0.0


def reach(motion: Motion) -> np.ndarray:
    """Length (J,), file units, of the longest chain of bones below each joint: the lever arm of its rotation."""
    skeleton = motion.skeleton
    bones = np.linalg.norm(rest_offsets(motion), axis=1)
    longest = np.zeros(len(bones))
    for joint in range(len(bones) - 1, -1, -1):  # children before parents
        parent = skeleton.parents[joint]
        if parent >= 0:
            longest[parent] = max(longest[parent], bones[joint] + longest[joint])
    return longest


def _refuse(motion: Motion, bad: np.ndarray, what: str) -> None:
    """Mismatch that names the first joint and frame of bad (F, J), if there is one."""
    if not bad.any():
        return
    joint, frame = (int(found[0]) for found in np.nonzero(bad.T))
    kinds = " ".join(motion.skeleton.channels[joint]) or "no channels"
    raise Mismatch(f"the rotation of joint {motion.skeleton.names[joint]!r} ({kinds}) at frame {frame} {what}")
