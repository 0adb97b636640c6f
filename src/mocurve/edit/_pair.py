"""Two clips side by side: the same joints, the same frames, turns counted alike."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from .. import hermite, kinematics, rotation
from ..errors import Mismatch, UnknownName
from ..keyed import KeyedMotion
from ..motion import Clip, History, Motion, complete, unroll
from ..skeleton import Skeleton
from ..spline import SplineMotion
from ._turns import free_joints

MATCHES = ("exact", "names")


def check(a: Skeleton, b: Skeleton, match: str) -> None:
    """Mismatch that names the first difference of the bodies, unless joints are matched by name; a warning where only
    the lengths of bones differ."""
    if match not in MATCHES:
        raise UnknownName("way to match joints", match, MATCHES)
    if match == "names":
        if not set(a.names) & set(b.names):
            raise Mismatch(f"no joint of the first is called as one of the second: {a.names[0]!r}, {b.names[0]!r}")
        for skeleton in (a, b):
            twice = next((name for i, name in enumerate(skeleton.names) if name in skeleton.names[:i]), None)
            if twice is not None:
                raise Mismatch(f"several joints are called {twice!r}: they cannot be matched by name")
        return
    for place, (mine, other) in enumerate(zip(a.names, b.names, strict=False)):
        if mine != other:
            raise Mismatch(f"the skeletons differ: joint {place + 1} is {mine!r} in the first, {other!r} in the second")
        if a.parents[place] != b.parents[place]:
            over = [_over(skeleton, place) for skeleton in (a, b)]
            raise Mismatch(f"the skeletons differ: {mine!r} hangs on {over[0]} in the first, {over[1]} in the second")
        if a.channels[place] != b.channels[place]:
            told = [" ".join(s.channels[place]) or "no channels" for s in (a, b)]
            raise Mismatch(f"the skeletons differ: {mine!r} has {told[0]} in the first, {told[1]} in the second")
    if len(a.names) != len(b.names):
        longer, which = (a, "first") if len(a.names) > len(b.names) else (b, "second")
        name = longer.names[min(len(a.names), len(b.names))]
        raise Mismatch(f"the skeletons differ: only the {which} has {name!r}")
    if a.unit is not None and b.unit is not None and not np.isclose(a.unit, b.unit, rtol=1e-3):
        raise Mismatch(f"the length units differ: {a.unit:g} m in the first, {b.unit:g} m in the second")
    other_bones = ~np.isclose(a.offsets, b.offsets, rtol=1e-6, atol=1e-9).all(axis=1)
    if other_bones.any():
        name = a.names[int(np.argmax(other_bones))]
        warnings.warn(
            f"bones have other lengths in the second clip ({name!r}): the body of the first is kept", stacklevel=3
        )


def onto(a: Motion, b: Motion) -> tuple[Motion, np.ndarray]:
    """b with the joints of a, found by name (both checked, as many frames), and which channels (C,) b had.

    Where b has no such joint or channel, the values are those of a. A joint whose rotation channels stand in another
    order is turned as in b.
    """
    body, other = a.skeleton, b.skeleton
    if body.channels == other.channels and body.names == other.names:
        return replace(b, skeleton=body), np.ones(body.channel_count, bool)
    values, had = np.array(a.values, order="F"), np.zeros(body.channel_count, bool)
    places = {name: place for place, name in enumerate(other.channel_names)}
    joints = {name: joint for joint, name in enumerate(other.names)}
    turned = kinematics.rotations(b)
    rotates, owner = body.rotation_channels, body.channel_joints
    free = {joint: (columns, order) for joint, columns, order in free_joints(body)}
    for joint, name in enumerate(body.names):
        own = np.flatnonzero(owner == joint)
        if name not in joints:
            continue
        theirs = other.channels[joints[name]]
        for column in own[~rotates[own]]:
            place = places.get(body.channel_names[column])
            if place is not None:
                values[:, column], had[column] = b.values[:, place], True
        turning = own[rotates[own]]
        kinds = [kind for kind in theirs if kind.endswith("rotation")]
        if [body.channel_names[column] for column in turning] == [f"{name}.{kind}" for kind in kinds]:
            values[:, turning] = b.values[:, [places[f"{name}.{kind}"] for kind in kinds]]
        elif joint in free:
            columns, order = free[joint]
            angles = rotation.to_euler(turned[:, joints[name]], order)
            values[:, columns] = rotation.unroll_euler(np.vstack([a.values[:1, columns], angles]), order)[1:]
        else:
            raise Mismatch(f"the channels of {name!r} cannot express the rotations of the second clip")
        had[turning] = True
    return replace(b, skeleton=body, values=values), had


def at_times(clip: Clip, times: np.ndarray, frame_time: float) -> Motion:
    """The clip at these times (F,), as a motion of this frame time.

    Keys and splines say their values. Samples do at their frames, to the last digit where all times are its frames; the
    unrolled channels are smooth between them (Catmull and Rom 1974: slopes from the neighbours).
    """
    if isinstance(clip, KeyedMotion):
        values = (
            np.stack([curve.at(times) for curve in clip.curves], axis=1) if clip.curves else np.zeros((len(times), 0))
        )
        return Motion(clip.skeleton, values, frame_time, clip.history)
    if isinstance(clip, SplineMotion):
        return Motion(clip.skeleton, clip.at(times), frame_time, clip.history)
    motion = complete(clip.sample())
    own = np.arange(motion.frames) * motion.frame_time
    if len(own) == len(times) and np.allclose(own, times, rtol=0.0, atol=1e-9 * motion.frame_time):
        return replace(motion, frame_time=frame_time, report=None)
    smooth = unroll(motion).values
    values = np.empty((len(times), smooth.shape[1]), order="F")
    for channel in range(smooth.shape[1]):
        column = smooth[:, channel]
        slopes = np.gradient(column, motion.frame_time) if len(own) > 1 else np.zeros(len(own))
        values[:, channel] = hermite.evaluate(own, column, slopes, times)
    return replace(motion, values=values, frame_time=frame_time, report=None)


def side_by_side(a: Clip, b: Clip, match: str, asked: str) -> tuple[Motion, Motion, np.ndarray]:
    """Samples of both at the frames of `a`, with its joints, and which channels (C,) b had. `asked` names the verb.

    Mismatch where they are not equally long.
    """
    check(a.skeleton, b.skeleton, match)
    if abs(a.duration - b.duration) > 0.5 * min(a.frame_time, b.frame_time):
        raise Mismatch(
            f"{asked} needs clips of one length, not {a.duration:.6g} and {b.duration:.6g} s: cut or retime one"
        )
    if not min(a.frames, b.frames):
        raise Mismatch(f"{asked} needs clips with frames, not a clip with none")
    first = complete(a.sample())
    times = np.arange(first.frames) * first.frame_time
    second, had = onto(first, at_times(b, times, first.frame_time))
    return first, second, had


def same_curves(clips: Sequence[Clip]) -> bool:
    """Whether all are keys, or all splines, of one set of channels: what is done to the curves keeps them."""
    kinds = {type(clip) for clip in clips}
    names = {clip.skeleton.channel_names for clip in clips}
    return len(kinds) == 1 and kinds <= {KeyedMotion, SplineMotion} and len(names) == 1


def tell_sampled(clips: Sequence[Clip], why: str) -> None:
    """A warning where keys or coefficients are about to become samples."""
    kinds = {KeyedMotion: "keys", SplineMotion: "splines"}
    lost = [kinds[type(clip)] for clip in clips if type(clip) in kinds]
    if lost:
        warnings.warn(f"{lost[0]} become samples: {why}", stacklevel=3)


def recorded(made: Clip, history: History) -> Clip:
    """The clip with these steps as its history. What a report measured of it before is no longer true of it."""
    return replace(made, history=history, report=None)  # type: ignore[type-var]  # every kind of clip is a dataclass


def check_mode(mode: str, modes: Sequence[str]) -> None:
    """UnknownName for a mode that is none of these."""
    if mode not in modes:
        raise UnknownName("mode", mode, modes)


def whole_turns(apart: np.ndarray) -> np.ndarray:
    """Degrees (C,), whole turns, that bring channels (F, C) this far apart as near as they get, one for all frames."""
    return 360.0 * np.rint(np.mean(apart, axis=0) / 360.0) if len(apart) else np.zeros(apart.shape[1])


def _over(skeleton: Skeleton, joint: int) -> str:
    parent = skeleton.parents[joint]
    return "no joint" if parent < 0 else repr(skeleton.names[parent])
