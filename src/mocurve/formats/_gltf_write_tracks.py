"""Keys of joints as glTF has them: a track of quaternions and one of positions, in each of the three profiles."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .. import kinematics, rotation
from ..errors import OptionError
from ..keyed import KeyedMotion
from ..motion import Clip, Motion
from ..skeleton import Skeleton


class Track(NamedTuple):
    """Keys of one path of a joint.

    times: (K,) seconds, rising. values: (K, 4) unit quaternions wxyz with unrolled signs, or (K, 3) file units.
    slopes: (2, K, 4 or 3) per second, arriving at the keys and leaving them; None: straight (slerp) between the keys.
    """

    times: np.ndarray
    values: np.ndarray
    slopes: np.ndarray | None = None


class JointTracks(NamedTuple):
    """A track a joint, J of each; None where the joint has no such channels."""

    rotations: tuple[Track | None, ...]
    positions: tuple[Track | None, ...]


def joint_tracks(clip: Clip, motion: Motion, profile: str, tolerance: str | None) -> JointTracks:
    """The tracks of a clip, of which `motion` is the sampling; OptionError where the profile cannot be had of it."""
    if profile == "baked":
        return _baked(motion)
    if profile == "linear":
        return _linear(clip, tolerance)
    if not isinstance(clip, KeyedMotion):
        raise OptionError(f"the cubic profile writes the tangents of keys, a {type(clip).__name__} has none: reduce it")
    from . import _gltf_cubic

    return _gltf_cubic.tracks(clip, motion)


def turning(skeleton: Skeleton) -> list[tuple[list[int], str]]:
    """For each joint the columns of its rotation channels and their order, "ZYX"."""
    found = []
    first = 0
    for kinds in skeleton.channels:
        columns = [first + i for i, kind in enumerate(kinds) if kind.endswith("rotation")]
        found.append((columns, "".join(kinds[column - first][0] for column in columns)))
        first += len(kinds)
    return found


def moving(skeleton: Skeleton) -> list[dict[int, int]]:
    """For each joint {0, 1, 2 for X, Y, Z: column} of its position channels."""
    found: list[dict[int, int]] = [{} for _ in skeleton.names]
    for column, (joint, axis) in enumerate(zip(skeleton.channel_joints, skeleton.channel_axes, strict=True)):
        if not skeleton.rotation_channels[column]:
            found[joint][int(axis)] = column
    return found


def _baked(motion: Motion) -> JointTracks:
    skeleton = motion.skeleton
    times = np.arange(motion.frames) * motion.frame_time
    wxyz = rotation.unroll(kinematics.rotations(motion))
    rotations: list[Track | None] = []
    positions: list[Track | None] = []
    for joint, ((columns, _), axes) in enumerate(zip(turning(skeleton), moving(skeleton), strict=True)):
        rotations.append(Track(times, wxyz[:, joint]) if columns else None)
        places = np.tile(skeleton.offsets[joint], (motion.frames, 1))
        places[:, list(axes)] = motion.values[:, list(axes.values())]
        positions.append(Track(times, places) if axes else None)
    return JointTracks(tuple(rotations), tuple(positions))


def _linear(clip: Clip, tolerance: str | None) -> JointTracks:
    from ..reduction import slerp  # loads the compiler

    chosen = slerp.joint_keys(clip, tolerance)
    tracks = [
        tuple(None if track is None else Track(track.frames * clip.frame_time, track.values) for track in path)
        for path in (chosen.rotations, chosen.positions)
    ]
    return JointTracks(*tracks)
