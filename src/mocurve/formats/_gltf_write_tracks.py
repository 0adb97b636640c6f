"""Keys of joints as glTF has them: a track of quaternions and one of positions, in each of the three profiles."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .. import kinematics, rotation
from ..errors import OptionError
from ..keyed import KeyedMotion
from ..motion import Clip, Motion
from ..skeleton import Skeleton
from ._gltf_buffer import key_times


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


def moving(skeleton: Skeleton) -> list[dict[int, int]]:
    """For each joint {0, 1, 2 for X, Y, Z: column} of its position channels."""
    found: list[dict[int, int]] = [{} for _ in skeleton.names]
    for column, (joint, axis) in enumerate(zip(skeleton.channel_joints, skeleton.channel_axes, strict=True)):
        if not skeleton.rotation_channels[column]:
            found[joint][int(axis)] = column
    return found


def local_places(motion: Motion) -> np.ndarray:
    """(F, J, 3) of every joint in its parent's frame, file units: a position channel replaces an axis of the offset."""
    places = np.tile(motion.skeleton.offsets, (motion.frames, 1, 1))
    for joint, axes in enumerate(moving(motion.skeleton)):
        places[:, joint, list(axes)] = motion.values[:, list(axes.values())]
    return places


def _baked(motion: Motion) -> JointTracks:
    times = np.arange(motion.frames) * motion.frame_time
    wxyz, places = rotation.unroll(kinematics.rotations(motion)), local_places(motion)
    paths = (wxyz, [columns for columns, _ in motion.skeleton.eulers]), (places, moving(motion.skeleton))
    tracks = [
        tuple(_rounded(Track(times, keys[:, j]), motion.frame_time) if has else None for j, has in enumerate(channels))
        for keys, channels in paths
    ]
    return JointTracks(*tracks)


def _linear(clip: Clip, tolerance: str | None) -> JointTracks:
    from ..reduction import slerp  # loads the compiler

    step = clip.frame_time
    chosen = slerp.joint_keys(clip, tolerance)
    tracks = [
        tuple(None if keys is None else _rounded(Track(keys.frames * step, keys.values), step) for keys in path)
        for path in (chosen.rotations, chosen.positions)
    ]
    return JointTracks(*tracks)


def _rounded(track: Track, frame_time: float) -> Track:
    """The same straight stretches between keys at times that the file can have.

    32 bits miss the time of a frame by up to 1e-6 s in half a minute, in which fast joints turn by 0.01 degrees. So a
    key that comes too late lies further on the stretch before it, one that comes too early on that after it.
    """
    times = key_times(track.times, frame_time).astype(np.float64)
    if len(times) < 2:
        return Track(times, track.values)
    first = np.clip(np.arange(len(times)) - (times > track.times), 0, len(times) - 2)
    u = (times - track.times[first]) / np.diff(track.times)[first]
    start, end = track.values[first], track.values[first + 1]
    if start.shape[1] == 4:
        return Track(times, rotation.slerp(start, end, u))
    return Track(times, start + u[:, None] * (end - start))
