"""The search for few keys of slerp.py: ways through what each frame allows, one way after the other, in rounds.

At each frame the other ways leave a joint's rotation, or place, a set of states that keep all points that it carries
within their limits: its room. Each way starts in a share of what its lever arm allows. Then rounds, leaves first: draw
the keys to where the worst point is furthest inside its limit (children make up for their parents' error), find fewer
chords from corner to corner inside the room, and take out keys that can be done without. Every step goes from ways
inside their rooms to ways inside their rooms, so the promise holds all the time. How far a way may stray grows from
round to round, lest one takes all the room early (world.py does the same for single channels).
"""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from typing import NamedTuple

import numpy as np

from .. import progress
from ..errors import OptionError
from ..kinematics import rest_height
from ._slerp import Room, fewest, sampled
from ._slerp_fit import prune, refit
from ._slerp_scene import Scene, find_centre, furnish, offer, pose, worst
from .problem import Problem
from .world import SHELL, body_of, cores, limbs, point_limits
from .world import _side_by_side as side_by_side

RESERVE = 1e-5  # part of every limit left to rounding
GRAIN = 2.5e-7  # radians, and part of a length: what single precision changes in a key's state
SHARE = 0.15  # of what a way's lever arm allows: where it starts
LEAST_SHARE = 1e-9  # below, a limit of nothing is asked: the check of the promise gives every frame its key


class Track(NamedTuple):
    """Keys of one joint's rotation or place.

    frames: (K,) int64, rising, from 0 to the last frame; a single one where a constant does.
    values: (K, 4) unit quaternions wxyz, each on the side of the one before, or (K, 3) file units in the parent's
            frame.
    """

    frames: np.ndarray
    values: np.ndarray


class Way(NamedTuple):
    """One joint's rotation or place, and how far its own limits let it stray."""

    joint: int
    turns: bool
    states: np.ndarray  # (F, 4) unit quaternions wxyz, unrolled; or x y z 0
    stray: np.ndarray  # (F, 4) as in Room


class Round(NamedTuple):
    """One round of the search."""

    stray: float  # how far a way may be from its original, in what its lever arm allows it
    sweeps: int  # of Newton steps, where keys are drawn to the midst and where one is taken out
    choices: int  # states that a frame offers to a chain of chords: as it is, the midst, more towards the edge


# chains from edge to edge leave nothing to the other ways: they come last
ROUNDS = (Round(0.4, 2, 2), Round(1.6, 3, 2), Round(2.4, 4, 2), Round(2.4, 4, 2), Round(2.4, 8, 4))
ALONE = (Round(1.0, 6, 4), Round(1.0, 6, 4))  # of a way that shares its room with no other


def search(asked: Problem, ways: list[Way], turned: np.ndarray, placed: np.ndarray) -> list[Track]:
    """Tracks of all ways that keep every limit, less the reserve.

    turned, placed: (J, F, 4) rotations and places of all joints, as slerp.local_states has them."""
    drifts = [_drift(way, asked.motion.frame_time) for way in ways]
    caps = [
        _less(way.stray, drift[:, None] * (0.5 if way.turns else 1.0)) for way, drift in zip(ways, drifts, strict=True)
    ]
    if asked.limits.joints is None:
        done: list[Track] = []
        for way, cap in zip(ways, caps, strict=True):
            progress.advance("keys of joints", len(done), len(ways))
            room = _room(way, cap, 0)
            track = _chords(way.states, room)
            for step in ALONE:
                track = _better(room, track, step)
            done.append(track)
        progress.advance("keys of joints", len(ways), len(ways))
        return done
    scene = scene_of(asked, ways, drifts, turned, placed)
    alone = [_allowance(scene, way, 0.5 * SHELL * rest_height(asked.motion)) for way in ways]
    _refuse_unlimited(asked, ways, [np.minimum(*both) for both in zip(alone, caps, strict=True)])
    tracks = _start(scene, ways, alone, caps)
    parts = _limbs(asked, ways)
    with ThreadPoolExecutor(cores()) as threads:
        for number, step in enumerate(ROUNDS):
            progress.advance("keys of joints", number, len(ROUNDS))

            def improve(w: int, step: Round = step) -> None:
                room = _furnished(scene, ways[w], np.minimum(step.stray * alone[w], caps[w]))
                tracks[w] = _better(room, tracks[w], step)
                _put(scene, ways[w], tracks[w])

            side_by_side(threads, parts, improve)
    progress.advance("keys of joints", len(ROUNDS), len(ROUNDS))
    return tracks


def _limbs(asked: Problem, ways: list[Way]) -> list[list[int]]:
    """The ways by number, leaves first: of each limb, and last of the trunk."""
    owners = asked.motion.skeleton.channel_joints
    of_joint: dict[int, list[int]] = {}
    for w in range(len(ways) - 1, -1, -1):
        of_joint.setdefault(ways[w].joint, []).append(w)
    parts = limbs(asked.motion, asked.groups)
    return [[w for g in part for w in of_joint[int(owners[asked.groups[g][0]])]] for part in parts]


def _drift(way: Way, frame_time: float) -> np.ndarray:
    """(F,) how far single precision may shift a way at each frame, radians or length: by its keys' times and states."""
    step = np.linalg.norm(np.diff(way.states, axis=0), axis=1) * (2.0 if way.turns else 1.0)
    fastest = np.maximum(np.append(step, 0.0), np.append(0.0, step))  # a frame
    times = (np.arange(len(way.states)) * frame_time).astype(np.float32)
    late = 0.5 * np.spacing(times).astype(float) / frame_time  # frames
    return fastest * late + GRAIN * (1.0 if way.turns else np.abs(way.states).max(axis=1, initial=0.0))


def _less(limits: np.ndarray, rounding: np.ndarray) -> np.ndarray:
    """Limits less what rounding may take, at most half of them."""
    return np.maximum(limits * (1.0 - RESERVE) - rounding, 0.5 * limits)


def scene_of(
    asked: Problem, ways: list[Way], drifts: list[np.ndarray], turned: np.ndarray, placed: np.ndarray
) -> Scene:
    """The clip as it was given, its limits less what single precision may take."""
    motion, joints = asked.motion, asked.limits.joints
    assert joints is not None
    body = body_of(motion)
    last = np.array([int(np.flatnonzero(motion.skeleton.below(j))[-1]) + 1 for j in range(len(body.parents))])
    points = np.empty((motion.frames, len(body.shell), 3))
    limits = np.zeros((motion.frames, len(body.shell)))
    scene = Scene(body, last, turned.copy(), placed.copy(), np.empty_like(turned), points, points.copy(), limits)
    pose(scene, 0, len(last))
    scene.target[:] = scene.points
    for way, drift in zip(ways, drifts, strict=True):
        carried, arms = _carried(scene, way)
        limits[:, carried] += drift[:, None] * arms
    limits[:] = _less(point_limits(body, joints), limits)
    return scene


def _carried(scene: Scene, way: Way) -> tuple[slice, np.ndarray]:
    """The points that a way moves, and by how much for a radian, or a unit of length, (F, P)."""
    first, last = scene.body.first_point[way.joint] + way.turns, scene.body.last_point[way.joint]
    if not way.turns:
        return slice(first, last), np.ones((len(scene.target), last - first))
    return slice(first, last), np.linalg.norm(scene.target[:, first:last] - scene.target[:, first - 1 : first], axis=-1)


def _allowance(scene: Scene, way: Way, floor: float) -> np.ndarray:
    """(F, 4) how far a way may stray on its own by what hangs on it, as in Room, no lever arm shorter than `floor`."""
    carried, arms = _carried(scene, way)
    limits = scene.limits[:, carried]
    if way.turns:
        limits = 0.5 * limits / np.maximum(arms, floor)
    return np.repeat(limits.min(axis=1, initial=np.inf)[:, None], 4, axis=1)


def _refuse_unlimited(asked: Problem, ways: list[Way], limits: list[np.ndarray]) -> None:
    for way, limit in zip(ways, limits, strict=True):
        if np.isinf(limit[:, : 1 if way.turns else 3]).any() and (way.states != way.states[:1]).any():
            name = asked.motion.skeleton.names[way.joint]
            raise OptionError(
                f"nothing hangs on joint {name!r}, so this tolerance leaves it free; add one like '0.5deg'"
            )


def _start(scene: Scene, ways: list[Way], alone: list[np.ndarray], caps: list[np.ndarray]) -> list[Track]:
    """Every way in a share of its allowance, which is lowered until the promise holds."""
    share = SHARE
    while True:
        tracks = []
        for way, room, cap in zip(ways, alone, caps, strict=True):
            tracks.append(_chords(way.states, _room(way, np.minimum(share * room, cap), 0)))
            states = scene.turned if way.turns else scene.placed
            sampled(way.turns, *tracks[-1], states[way.joint])
        pose(scene, 0, len(scene.last_joint))
        over = worst(scene)
        if over <= 1.0 or share < LEAST_SHARE:
            return tracks
        share *= 0.9 / over


def _room(way: Way, stray: np.ndarray, points: int) -> Room:
    """Room about the original, without points yet."""
    frames = len(way.states)
    arms, limits = np.empty((frames, points, 3)), np.empty((frames, points))
    inner = (stray[:, :1] if way.turns else stray[:, :3]).min(axis=1)
    return Room(way.turns, way.states, stray, arms, np.empty_like(arms), limits, way.states.copy(), inner)


def _furnished(scene: Scene, way: Way, stray: np.ndarray) -> Room:
    body = scene.body
    room = _room(way, stray, body.last_point[way.joint] - body.first_point[way.joint] - way.turns)
    furnish(scene, way.joint, room)
    find_centre(room, (scene.turned if way.turns else scene.placed)[way.joint])
    return room


def _put(scene: Scene, way: Way, track: Track) -> None:
    sampled(way.turns, *track, (scene.turned if way.turns else scene.placed)[way.joint])
    pose(scene, way.joint, scene.last_joint[way.joint])


def _chords(states: np.ndarray, room: Room) -> Track:
    found = fewest(room, states[:, None])
    return Track(found, states[found])


def _better(room: Room, track: Track, step: Round) -> Track:
    """The track drawn to the midst of its room, and fewer keys where they will do."""
    start = np.zeros(1, np.int64)
    constant = room.centre[len(room.centre) // 2][None].copy() if len(track.frames) > 1 else track.values.copy()
    enough = 1.0 if len(track.frames) > 1 else 0.0
    if refit(room, start, constant, False, False, step.sweeps, enough) <= 1.0 or len(track.frames) == 1:
        return Track(start, constant)
    states = np.empty((len(room.centre), step.choices, 4))
    sampled(room.turns, *track, states[:, 0])
    states[:, 1] = room.centre
    offer(room, track.frames, states)
    found = fewest(room, states)
    frames, values = track.frames.copy(), track.values.copy()
    if len(found) < len(frames):
        frames = found // step.choices
        values = states[frames, found % step.choices]
    refit(room, frames, values, False, False, step.sweeps, 0.0)
    count = prune(room, frames, values, step.sweeps)
    return Track(frames[:count].copy(), values[:count].copy())
