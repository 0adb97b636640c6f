"""Keys for targets that know only slerp and straight lines, as glTF's linear animation does, with the same promise.

A joint's rotation is a chain of quaternion keys, its place a chain of points: a *way*. All ways are held to what
`reduce` promises: no joint or end site moves further than the tolerance at any frame, no joint turns further against
its parent.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from .. import rotation
from ..keyed import KeyedMotion
from ..kinematics import rest_height, rotations, world
from ..motion import Clip, Motion
from ..skeleton import Skeleton
from ._slerp import Room, fewest
from .problem import Problem, problem
from .tolerance import DEFAULT
from .world import SHELL

SHARE = 0.4  # of what a lever arm allows: where the search starts
LEAST_SHARE = 1e-6
RESERVE = 1e-3  # part of every limit that the search leaves to the rounding to single precision


class Track(NamedTuple):
    """Keys of one joint's rotation or place.

    frames: (K,) int64, rising, from 0 to the last frame; a single one where a constant does.
    values: (K, 4) unit quaternions wxyz, each on the side of the one before, or (K, 3) file units in the parent's
            frame.
    """

    frames: np.ndarray
    values: np.ndarray


class JointTracks(NamedTuple):
    """Per joint (J,) its tracks; None where it has no channels of the kind."""

    rotations: tuple[Track | None, ...]
    positions: tuple[Track | None, ...]


class Way(NamedTuple):
    """One joint's rotation or place, and how far its own limits let it stray."""

    joint: int
    turns: bool
    states: np.ndarray  # (F, 4) unit quaternions wxyz, unrolled; or x y z 0
    stray: np.ndarray  # (F, 4) as in Room


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
        tracks = held(asked, ways, search(asked, ways))
    return _by_joint(asked.motion.skeleton, ways, tracks)


def _asked(clip: Clip, tolerance: str | Sequence[str] | None, feet: float | None) -> tuple[Clip, Sequence[str], float]:
    """The reference, the tolerance and the part of planted feet."""
    told = clip.report if isinstance(clip, KeyedMotion) else None
    made: dict = {}
    # a report that was measured on other curves tells nothing of these
    if told is not None and told.clips is not None and getattr(told.clips[1], "curves", None) is clip.curves:
        made = next((step for step in reversed(clip.history) if step.get("tolerance")), {})
    reference = told.clips[0] if made else clip
    tolerance = made.get("tolerance", DEFAULT) if tolerance is None else tolerance
    texts = [tolerance] if isinstance(tolerance, str) else tolerance
    return reference, texts, made.get("feet", 0.25) if feet is None else feet


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
    """The tracks, and more keys in them until no limit is broken. The last resort, a key at every frame, is exact.

    Where single precision can hold the promise it holds for times and values rounded to it too, as files have them."""
    while True:
        broken = _broken(asked, ways, tracks, False) | _broken(asked, ways, tracks, True)
        mended = [_mended(way, track, bad) for way, track, bad in zip(ways, tracks, broken, strict=True)]
        if all(new is old for new, old in zip(mended, tracks, strict=True)):
            return tracks
        tracks = mended


def _broken(asked: Problem, ways: list[Way], tracks: list[Track], single: bool) -> np.ndarray:
    """(ways, F) True where a way is beyond its own limits, or moves a joint that is beyond its own."""
    motion, limits, _ = asked
    skeleton = motion.skeleton
    turned, placed = local_states(motion)
    target = places_in_world(skeleton, turned, placed)
    broken = np.zeros((len(ways), motion.frames), bool)
    for w, (way, track) in enumerate(zip(ways, tracks, strict=True)):
        now = states_at(way.turns, track, motion.frames, motion.frame_time, single)
        if way.turns:
            # the angle from the sine of its quarter: it keeps its digits where angles are small
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


def states_at(turns: bool, track: Track, frames: int, frame_time: float, single: bool) -> np.ndarray:
    """(F, 4) what a player shows at every frame. single: the file keeps times and values in single precision."""
    times, values = track.frames * frame_time, track.values
    if single:
        times, values = times.astype(np.float32).astype(float), values.astype(np.float32).astype(float)
    if len(times) == 1:
        return np.repeat(values, frames, axis=0)
    at = np.arange(frames) * frame_time
    if not single:  # on frames exactly
        times, at = track.frames.astype(float), np.arange(frames, dtype=float)
    segment = np.clip(np.searchsorted(times, at, side="right") - 1, 0, len(times) - 2)
    part = np.clip((at - times[segment]) / (times[segment + 1] - times[segment]), 0.0, 1.0)
    a, b = values[segment], values[segment + 1]
    if not turns:
        return a + part[:, None] * (b - a)
    now = rotation.slerp(a, b, part)
    return now / np.linalg.norm(now, axis=1, keepdims=True)


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


# -- the search --------------------------------------------------------------------------------------------------------


def search(asked: Problem, ways: list[Way]) -> list[Track]:
    """Every way in a share of what its lever arm allows, which is lowered until the promise holds."""
    alone = [_allowance(asked, way) for way in ways]
    share = SHARE
    while True:
        tracks = [
            _chords(way, np.minimum(way.stray, share * room) * (1.0 - RESERVE))
            for way, room in zip(ways, alone, strict=True)
        ]
        if share < LEAST_SHARE or not _broken(asked, ways, tracks, True).any():
            return tracks
        share *= 0.7


def _allowance(asked: Problem, way: Way) -> np.ndarray:
    """(F, 4) how far a way may stray on its own by what hangs on it, as in Room."""
    if asked.limits.joints is None:
        return np.full_like(way.states, np.inf)
    skeleton = asked.motion.skeleton
    below = np.flatnonzero(skeleton.below(way.joint))
    limits = asked.limits.joints[below].T
    if way.turns:
        places = world(asked.motion)
        arms = np.linalg.norm(places[:, below] - places[:, [way.joint]], axis=-1)
        limits = 0.5 * limits / (arms + 0.5 * SHELL * rest_height(asked.motion))
    return np.repeat(limits.min(axis=1)[:, None], 4, axis=1)


def _chords(way: Way, stray: np.ndarray) -> Track:
    if np.array_equal(way.states, np.broadcast_to(way.states[0], way.states.shape)):
        return Track(np.zeros(1, np.int64), way.states[:1])
    frames = len(way.states)
    none = np.zeros((frames, 0, 3))
    room = Room(way.turns, way.states, stray, none, none, none[:, :, 0], way.states, stray[:, :3].min(axis=1))
    found = fewest(room, way.states[:, None])
    return Track(found, way.states[found])
