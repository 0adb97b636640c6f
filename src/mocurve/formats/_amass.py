"""AMASS: poses of the SMPL family as axis-angle vectors, without the body. Metres, Z up, as the files have it.

Joints and their order are those of SMPL-X, SMPL-H and SMPL (M. Loper et al., SMPL, 2015; J. Romero et al., Embodied
hands, 2017; G. Pavlakos et al., Expressive body capture, 2019). The data set is N. Mahmood et al., AMASS, ICCV 2019.
"""

from __future__ import annotations

import os
import warnings
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from .. import rotation
from ..errors import FileError, Mismatch
from ..info import unit_of
from ..kinematics import rest_offsets, rotations
from ..motion import Motion
from ..skeleton import Skeleton
from ._amass_body import BONES, ENDS, HEIGHT
from ._bvh_header import end_site_name
from ._files import Path

FPS = 120.0  # of most of the data set, where a file does not say it
_LARGEST = 1e6  # radians: beyond, few digits of the angle are left
_ORDER = "ZYX"
_NEAR = 1e-3  # frames a second: a rate as near as this to a whole one is that
_CHANNELS = ("Xposition", "Yposition", "Zposition", *(f"{axis}rotation" for axis in _ORDER))
_SIDES = ("left", "right")
_BODY = [
    "pelvis", "left_hip", "right_hip", "spine1", "left_knee", "right_knee", "spine2", "left_ankle", "right_ankle",
    "spine3", "left_foot", "right_foot", "neck", "left_collar", "right_collar", "head", "left_shoulder",
    "right_shoulder", "left_elbow", "right_elbow", "left_wrist", "right_wrist",
]  # fmt: skip
_FINGERS = [
    f"{side}_{finger}{i}"
    for side in _SIDES
    for finger in ("index", "middle", "pinky", "ring", "thumb")
    for i in (1, 2, 3)
]
MODELS = {  # numbers in a row of poses: joints in that order
    165: [*_BODY, "jaw", "left_eye_smplhf", "right_eye_smplhf", *_FINGERS],
    156: [*_BODY, *_FINGERS],
    72: [*_BODY, "left_hand", "right_hand"],
    66: _BODY,
}


def motion(poses: np.ndarray, trans: np.ndarray, rate: float | None, skeleton: Path | None, path: Path) -> Motion:
    """The motion of poses (F, 66, 72, 156 or 165) radians and trans (F, 3) metres at `rate` frames a second.

    The body is that of the file `skeleton`, joints found by their names, or a mean one. Channels are ZYX.
    """
    joints = MODELS.get(poses.shape[1])
    if joints is None:
        raise FileError(f"poses: {', '.join(map(str, MODELS))} columns expected, {poses.shape[1]} found", path)
    if trans.shape != (len(poses), 3):
        raise FileError(f"trans: the shape {(len(poses), 3)} expected, as of poses, {trans.shape} found", path)
    if not (np.isfinite(trans).all() and (np.abs(poses) < _LARGEST).all()):
        raise FileError("poses, trans: finite numbers expected, and no angles beyond sense", path)
    if rate is not None and not (np.isfinite(rate) and rate > 0):
        raise FileError(f"a frame rate above 0 expected, {rate} found", path)
    told = [] if rate is not None else [f"no frame rate in the file, {FPS:g} frames a second assumed"]
    if skeleton is None:
        told.append(f"no bones in the file: those of a mean body of {HEIGHT:g} m are taken; skeleton= names other ones")
    if told:
        warnings.warn(f"{os.fspath(path)}: {'; '.join(told)}", stacklevel=5)
    body = _mean_body(joints) if skeleton is None else _named_body(joints, skeleton)
    quaternions = rotation.exp(poses.astype(np.float64).reshape(len(poses), len(joints), 3))
    columns = [trans.astype(np.float64)]
    for name, kinds in zip(body.names, body.channels, strict=True):
        if kinds:
            angles = rotation.to_euler(quaternions[:, joints.index(name)], _ORDER)
            columns.append(rotation.unroll_euler(angles, _ORDER))
    return Motion(body, np.hstack(columns), 1.0 / _whole(FPS if rate is None else rate))


def _whole(rate: float) -> float:
    return float(round(rate)) if abs(rate - round(rate)) < _NEAR and rate > 1 else rate


# -- bodies --------------------------------------------------------------------------------------
class _Bone(NamedTuple):
    """What hangs on a joint: its own place and the ends of it, metres in the parent's frame."""

    offset: np.ndarray
    ends: list[tuple[str, np.ndarray]]


def parent_of(name: str) -> str:
    """The joint that a joint of these models hangs on, "" for the pelvis."""
    return BONES[name].parent


def _mean_body(joints: Sequence[str]) -> Skeleton:
    bones = {}
    for name in joints:
        leaf = not any(parent_of(other) == name for other in joints)
        ends = [(end_site_name(name, 1), HEIGHT * np.array(ENDS[name]))] if leaf else []
        bones[name] = _Bone(HEIGHT * np.array(BONES[name].offset), ends)
    return _skeleton(joints, bones)


def _named_body(joints: Sequence[str], skeleton: Path) -> Skeleton:
    """The bones of any clip that has joints of these names, in metres."""
    from . import read  # which knows this module

    clip = read(skeleton).sample()
    body, unit = clip.skeleton, unit_of(clip)
    if not unit.said:
        warnings.warn(f"{os.fspath(skeleton)}: the unit of its bones is guessed: {unit.name}", stacklevel=6)
    places = _places(joints, body)
    offsets = rest_offsets(clip) * unit.metres
    ends = {
        name: [(body.names[i], offsets[i]) for i in np.flatnonzero(body.end_sites & (body.parents == place))]
        for name, place in zip(joints, places, strict=True)
    }
    return _skeleton(joints, {name: _Bone(offsets[i], ends[name]) for name, i in zip(joints, places, strict=True)})


def _places(joints: Sequence[str], body: Skeleton) -> list[int]:
    """Index of each joint in a body; Mismatch for the first that is not there, or that hangs on another one."""
    known = dict(zip(body.names, range(len(body.names)), strict=True))
    for name in joints:
        if name not in known:
            raise Mismatch(f"AMASS has the joints of SMPL, and there is no {name!r} among those of the skeleton")
        above = int(body.parents[body.joint(name)])
        if (body.names[above] if above >= 0 else "") != parent_of(name):
            raise Mismatch(f"{name!r} hangs on {parent_of(name) or 'nothing'!r} in AMASS, not so in the skeleton")
    return [known[name] for name in joints]


def _skeleton(joints: Sequence[str], bones: dict[str, _Bone]) -> Skeleton:
    """Depth first, children in the order of the model, ends after them."""
    names: list[str] = []
    parents: list[int] = []
    offsets: list[np.ndarray] = []
    channels: list[tuple[str, ...]] = []
    waiting = [("pelvis", -1)]
    while waiting:
        name, parent = waiting.pop()
        waiting += [(child, len(names)) for child in reversed(joints) if parent_of(child) == name]
        at = len(names)
        for label, offset, above in [(name, bones[name].offset, parent), *((n, o, at) for n, o in bones[name].ends)]:
            names.append(label)
            parents.append(above)
            offsets.append(offset)
            channels.append(() if label != name else _CHANNELS[0 if parent < 0 else 3 :])
    ends = np.array([not kinds for kinds in channels])
    return Skeleton(tuple(names), np.array(parents), np.array(offsets), tuple(channels), ends, 1.0)


# -- writing -------------------------------------------------------------------------------------
def arrays(clip: Motion) -> dict[str, np.ndarray]:
    """What an AMASS file of this motion holds. Mismatch where its joints are not those of a model.

    A warning says what is lost: always the body, for which the mean one of the model stands.
    """
    if not np.isfinite(clip.values).all():
        raise Mismatch("a value of the clip is not finite, which an AMASS file cannot hold")
    body = clip.skeleton
    names = set(body.names)
    joints = next((known for known in MODELS.values() if names.issuperset(known)), _BODY)
    places = _places(joints, body)
    unit = unit_of(clip)
    _warn_of_losses(clip, places, None if unit.said else unit.name)
    poses = rotation.log(rotations(clip)[:, places]).reshape(clip.frames, -1)
    trans = np.tile(body.offsets[places[0]], (clip.frames, 1))
    columns = np.flatnonzero((body.channel_joints == places[0]) & ~body.rotation_channels)
    trans[:, body.channel_axes[columns]] = clip.values[:, columns]
    rate = np.array(_whole(1.0 / clip.frame_time))
    return {
        "poses": poses,
        "trans": trans * unit.metres,
        "mocap_framerate": rate,
        "mocap_frame_rate": rate,
        "betas": np.zeros(16),
        "gender": np.array("neutral"),
    }


def _warn_of_losses(clip: Motion, places: Sequence[int], guess: str | None) -> None:
    body = clip.skeleton
    told = ["bone lengths, end sites, rotation orders and history are not in AMASS files and are lost"]
    outside = ~np.isin(body.channel_joints, places)
    if outside.any():
        lost = sorted({body.names[joint] for joint in body.channel_joints[outside]})
        told.append(f"so are joints that it does not know: {', '.join(lost[:3])}{' …' if len(lost) > 3 else ''}")
    if np.any(~body.rotation_channels & ~outside & (body.channel_joints != places[0])):
        told.append("so are position channels below the root")
    if guess:
        told.append(f"the length unit is guessed: {guess}")
    warnings.warn("; ".join(told), stacklevel=6)
