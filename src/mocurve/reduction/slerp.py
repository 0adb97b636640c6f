"""Keys for targets that know only slerp and straight lines, as glTF's linear animation does, with the same promise.

A joint's rotation is a chain of quaternion keys, its place a chain of points: a *way*. All ways are held to what
`reduce` promises: no joint or end site moves further than the tolerance at any frame, no joint turns further against
its parent.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from .. import rotation
from ..keyed import KeyedMotion
from ..kinematics import rotations
from ..motion import Clip, Motion
from ..skeleton import Skeleton
from .problem import Problem, problem
from .slerp_search import Track, Way, search
from .tolerance import DEFAULT, bounds


class JointTracks(NamedTuple):
    """Per joint (J,) its tracks; None where it has no channels of the kind."""

    rotations: tuple[Track | None, ...]
    positions: tuple[Track | None, ...]


def joint_keys(clip: Clip, tolerance: str | Sequence[str] | None = None, *, feet: float | None = None) -> JointTracks:
    """Few keys per joint, slerp or a straight line between them; nothing moves more than the tolerance at any frame.

    clip:      a KeyedMotion that `reduce` made in this process is held to the capture that it was made of, any other
               clip to its own samples.
    tolerance: as for `reduce`; an amount in degrees bounds the angle between a joint's rotation and the clip's. None:
               what the clip was reduced to, else 0.1%height.
    feet:      part of the tolerance that planted feet get. None: as the clip was reduced, else 0.25.
    Errors: as for `reduce`.

    >>> joint_keys(mc.read("walk.bvh"), "2mm").rotations[0].values
    """
    reference, texts, part = _asked(clip, tolerance, feet)
    asked = problem(reference, texts, "joint", part)
    ways = ways_of(asked)
    if asked.motion.frames == 0:
        tracks = [Track(np.zeros(0, np.int64), np.zeros((0, 4))) for _ in ways]
    else:
        tracks = held(asked, ways, search(asked, ways, *local_states(asked.motion)))
    return _by_joint(asked.motion.skeleton, ways, tracks)


def _asked(clip: Clip, tolerance: str | Sequence[str] | None, feet: float | None) -> tuple[Clip, Sequence[str], float]:
    """The reference, the tolerance and the part of planted feet."""
    reference, made = clip, _making(clip)
    if made and clip.history[-1].get("verb") == "refine":  # its report compares with the keys before
        return _asked(clip.report.clips[0], tolerance, feet)  # type: ignore[attr-defined]
    if made:
        reference = clip.report.clips[0]  # type: ignore[attr-defined]
    tolerance = made.get("tolerance", DEFAULT) if tolerance is None else tolerance
    texts = [tolerance] if isinstance(tolerance, str) else tolerance
    return reference, texts, made.get("feet", 0.25) if feet is None else feet


def _making(clip: Clip) -> dict[str, Any]:
    """The step that made the clip's keys of another clip that its report still has, to a tolerance; else empty."""
    if not isinstance(clip, KeyedMotion) or clip.report is None or clip.report.clips is None:
        return {}
    made = next((step for step in reversed(clip.history) if "tolerance" in step), {})
    # a report that was measured on other curves tells nothing of these
    same = getattr(clip.report.clips[1], "curves", None) is clip.curves
    return made if same and bounds(made.get("tolerance")) else {}


def ways_of(asked: Problem) -> list[Way]:
    """The place and the rotation of every joint that has channels for them, parents first."""
    motion, skeleton = asked.motion, asked.motion.skeleton
    turned, placed = local_states(motion)
    owners, rotates, axes = skeleton.channel_joints, skeleton.rotation_channels, skeleton.channel_axes
    live = np.ptp(motion.values, axis=0) > 0.0 if motion.frames else np.zeros(len(owners), bool)
    ways = []
    for joint in range(len(skeleton.names)):
        moving, turning = (owners == joint) & ~rotates, (owners == joint) & rotates
        if moving.any():
            stray = np.full((motion.frames, 4), np.inf)
            for channel in np.flatnonzero(moving):
                stray[:, axes[channel]] = asked.limits.channels[channel]
            ways.append(Way(joint, False, placed[joint], stray))
        if turning.any():
            # an axis that never turns does not say how far the joint may
            counted = turning & live if (turning & live).any() else turning
            angle = np.radians(asked.limits.channels[counted].min(axis=0))
            chord = np.where(angle < np.pi, 2.0 * np.sin(0.25 * np.minimum(angle, np.pi)), np.inf)
            ways.append(Way(joint, True, turned[joint], np.repeat(chord[:, None], 4, axis=1)))
    return ways


def local_states(motion: Motion) -> tuple[np.ndarray, np.ndarray]:
    """Of every joint its rotations (J, F, 4) against its parent and its places (J, F, 4), x y z 0, in its parent's
    frame."""
    skeleton = motion.skeleton
    turned = rotation.unroll(rotations(motion)) if motion.frames else np.zeros((0, len(skeleton.names), 4))
    placed = np.zeros((len(skeleton.names), motion.frames, 4))
    placed[:, :, :3] = skeleton.offsets[:, None]
    for channel in np.flatnonzero(~skeleton.rotation_channels):
        placed[skeleton.channel_joints[channel], :, skeleton.channel_axes[channel]] = motion.values[:, channel]
    return np.ascontiguousarray(turned.transpose(1, 0, 2)), placed


def _by_joint(skeleton: Skeleton, ways: list[Way], tracks: list[Track]) -> JointTracks:
    turns: list[Track | None] = [None] * len(skeleton.names)
    places: list[Track | None] = [None] * len(skeleton.names)
    for way, (frames, values) in zip(ways, tracks, strict=True):
        if way.turns:
            turns[way.joint] = Track(frames, rotation.unroll(values) if len(values) else values)
        else:
            places[way.joint] = Track(frames, np.ascontiguousarray(values[:, :3]))
    return JointTracks(tuple(turns), tuple(places))


# -- the promise, whatever the search returned -----------------------------------------------------


def held(asked: Problem, ways: list[Way], tracks: list[Track]) -> list[Track]:
    """The tracks, and more keys in them until no limit is broken. The last resort, a key at every frame, is exact."""
    while True:
        broken = _broken(asked, ways, tracks)
        mended = [_mended(way, track, bad) for way, track, bad in zip(ways, tracks, broken, strict=True)]
        if all(new is old for new, old in zip(mended, tracks, strict=True)):
            return tracks
        tracks = mended


def _broken(asked: Problem, ways: list[Way], tracks: list[Track]) -> np.ndarray:
    """(ways, F) True where a way is beyond its own limits, or moves a joint that is beyond its own."""
    motion, limits, _ = asked
    skeleton = motion.skeleton
    turned, placed = local_states(motion)
    target = places_in_world(skeleton, turned, placed)
    broken = np.zeros((len(ways), motion.frames), bool)
    for w, (way, track) in enumerate(zip(ways, tracks, strict=True)):
        now = states_at(way.turns, track, motion.frames)
        if way.turns:
            away = np.minimum(*(np.linalg.norm(now + side * way.states, axis=1) for side in (1.0, -1.0)))
            broken[w] = ~(away <= way.stray[:, 0])
            turned[way.joint] = now
        else:
            broken[w] = ~(np.abs(now - way.states) <= way.stray).all(axis=1)
            placed[way.joint] = now
    if limits.joints is None:
        return broken
    off = np.linalg.norm(places_in_world(skeleton, turned, placed) - target, axis=-1)
    astray = ~(off <= limits.joints)
    for joint in np.flatnonzero(astray.any(axis=1)):
        chain = [joint]
        while skeleton.parents[chain[-1]] >= 0:
            chain.append(skeleton.parents[chain[-1]])
        for w, way in enumerate(ways):
            if way.joint in chain and not (way.turns and way.joint == joint):
                broken[w] |= astray[joint]
    return broken


def states_at(turns: bool, track: Track, frames: int) -> np.ndarray:
    """(F, n) what a player shows at every frame: slerp, or straight lines."""
    at, values = track
    if len(at) == 1:
        return np.repeat(values, frames, axis=0)
    segment = np.clip(np.searchsorted(at, np.arange(frames), side="right") - 1, 0, len(at) - 2)
    part = (np.arange(frames) - at[segment]) / (at[segment + 1] - at[segment])
    a, b = values[segment], values[segment + 1]
    return rotation.slerp(a, b, part) if turns else a + part[:, None] * (b - a)


def places_in_world(skeleton: Skeleton, turned: np.ndarray, placed: np.ndarray) -> np.ndarray:
    """(J, F, 3) of the local rotations (J, F, 4) and places (J, F, 4)."""
    places, turns = np.empty((*placed.shape[:2], 3)), np.empty_like(turned)
    for joint, parent in enumerate(skeleton.parents):
        places[joint], turns[joint] = placed[joint, :, :3], turned[joint]
        if parent >= 0:
            places[joint] = places[parent] + rotation.rotate(turns[parent], places[joint])
            turns[joint] = rotation.mul(turns[parent], turned[joint])
    return places


def _mended(way: Way, track: Track, broken: np.ndarray) -> Track:
    """A key on every frame of every segment that touches a broken frame (F,), with the clip's own state where it is
    broken; the same track where that changes nothing."""
    if not broken.any():
        return track
    wanted = np.zeros(len(broken), bool)
    wanted[track.frames] = True
    wanted[[0, -1]] = True
    for a, b in pairwise(np.flatnonzero(wanted)):
        wanted[a : b + 1] |= broken[a : b + 1].any()
    at = np.flatnonzero(wanted)
    values = way.states[at].copy()
    kept = np.isin(at, track.frames[~broken[track.frames]])
    values[kept] = track.values[np.isin(track.frames, at[kept])]
    same = len(at) == len(track.frames) and np.array_equal(values, track.values)
    return track if same else Track(at, values)
