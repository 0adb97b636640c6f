"""The cubic profile: Hermite curves of Euler angles as CUBICSPLINE of quaternions.

A joint gets a key wherever one of its curves has one. There the quaternion and, by the chain rule, its rate on both
sides are exact. In between, what players see is the cubic of the four components, made of length 1: where that leaves
the curves by too much, keys on the curves are added. Positions need none: they are the cubics of their channels.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from .. import hermite, kinematics, rotation
from ..keyed import HermiteCurve, KeyedMotion
from ..motion import Motion
from ..skeleton import AXES
from ._gltf_buffer import key_times
from ._gltf_write_tracks import JointTracks, Track, local_places, moving

MOST_DEGREES = 1e-3  # off the curves, of a joint's own rotation; players are within twice that
MOST_LENGTH = 8e-4  # off the curves in the world, file units; players are within 1e-3
LEAST_DEGREES = 2e-5  # float32 quaternions are hardly better
MOST_SLACK = 16.0  # joints seldom err together: times the part of MOST_LENGTH that is safe for each
SHORTEST = 0.124  # frames: no key is added within less than twice that
SAMPLES = np.arange(1, 8) / 8.0  # of a stretch between two keys


def tracks(clip: KeyedMotion, motion: Motion) -> JointTracks:
    """Cubic keys of every joint; `motion` is the clip's own sampling."""
    curves = [_on_frames(curve, clip.frame_time) for curve in clip.curves]
    ends = np.unique([0.0, clip.duration])
    channels = list(zip(clip.skeleton.eulers, moving(clip.skeleton), strict=True))
    positions: list[Track | None] = []
    for (_, axes), offset in zip(channels, clip.skeleton.offsets.tolist(), strict=True):
        moved = [curves[axes[axis]] if axis in axes else _still(offset[axis]) for axis in range(3)]
        positions.append(_position(moved, ends, clip.frame_time) if axes else None)
    limits = _limits(motion)
    halves = clip.sample(0.5 * clip.frame_time)
    meant = kinematics.rotations(halves)
    slack = MOST_SLACK
    with np.errstate(over="ignore", invalid="ignore"):  # what is too large is told where it is written
        while True:
            rotations = [
                _rotation([curves[c] for c in columns], order, limit, ends, clip.frame_time) if columns else None
                for ((columns, order), _), limit in zip(channels, np.minimum(slack * limits, MOST_DEGREES), strict=True)
            ]
            apart = _apart(halves, meant, rotations)
            if not apart > MOST_LENGTH or slack == 1.0:  # no number where curves overflow
                break
            slack = max(slack * min(MOST_LENGTH / apart, 0.8), 1.0)
    return JointTracks(tuple(rotations), tuple(positions))


def _on_frames(curve: HermiteCurve, frame_time: float) -> HermiteCurve:
    """Key times that miss a frame by rounding are put on it, so that the joint's curves share their keys."""
    frames = np.rint(curve.times / frame_time)
    times = np.where(np.abs(curve.times / frame_time - frames) < 1e-6, frames * frame_time, curve.times)
    return replace(curve, times=times) if (np.diff(times) > 0).all() else curve


def _limits(motion: Motion) -> np.ndarray:
    """(J,) degrees that each joint may be off, so that no chain of joints adds up to more than MOST_LENGTH.

    Each joint of a chain gets the same part of it, at the end of the longest chain of bones below.
    """
    skeleton = motion.skeleton
    moves = [bool(columns) and np.ptp(motion.values[:, columns], axis=0).any() for columns, _ in skeleton.eulers]
    chain = np.array(moves, np.int64)  # joints that turn, from the root to here
    for joint, parent in enumerate(skeleton.parents):
        chain[joint] += chain[parent] if parent >= 0 else 0
    for joint, parent in reversed(list(enumerate(skeleton.parents))):  # on the longest way through here
        if parent >= 0:
            chain[parent] = max(chain[parent], chain[joint])
    lever = kinematics.reach(motion) * np.maximum(chain, 1)
    with np.errstate(divide="ignore"):
        return np.clip(np.degrees(MOST_LENGTH / lever), LEAST_DEGREES, MOST_DEGREES)


def _apart(halves: Motion, meant: np.ndarray, rotations: Sequence[Track | None]) -> float:
    """How far joints are from where they should be, file units, at frames and half frames."""
    times = np.arange(halves.frames) * halves.frame_time
    seen = meant.copy()
    for joint, track in enumerate(rotations):
        if track is not None and track.slopes is not None:
            parts = zip(track.values.T, track.slopes[1].T, track.slopes[0].T, strict=True)
            seen[:, joint] = np.column_stack([hermite.evaluate(track.times, v, m, times, n) for v, m, n in parts])
    seen = _of_length_1(seen)
    places, parents = local_places(halves), halves.skeleton.parents
    return float(
        np.linalg.norm(_world(seen, places, parents) - _world(meant, places, parents), axis=2).max(initial=0.0)
    )


def _world(wxyz: np.ndarray, local: np.ndarray, parents: np.ndarray) -> np.ndarray:
    """Places (F, J, 3) from rotations (F, J, 4) and places (F, J, 3) against the parents."""
    turned, places = wxyz.copy(), local.copy()
    for joint, parent in enumerate(parents):
        if parent >= 0:
            turned[:, joint] = rotation.mul(turned[:, parent], wxyz[:, joint])
            places[:, joint] = places[:, parent] + rotation.rotate(turned[:, parent], local[:, joint])
    return places


def _of_length_1(wxyz: np.ndarray) -> np.ndarray:
    size = np.linalg.norm(wxyz, axis=-1, keepdims=True)
    return wxyz / np.where(size > 0, size, 1.0)


def _rotation(curves: Sequence[HermiteCurve], order: str, limit: float, ends: np.ndarray, frame_time: float) -> Track:
    """Quaternion keys wxyz that are nowhere more than `limit` degrees off the curves (degrees) of the axes in order."""
    times = _union(curves, ends)
    starts, stops = times[:-1], times[1:]
    added = [times]
    while len(starts):
        wide = _wide(curves, order, starts, stops, limit) & (stops - starts > 2.0 * SHORTEST * frame_time)
        middles = _middles(starts[wide], stops[wide], frame_time)
        added.append(middles)
        starts, stops = np.append(starts[wide], middles), np.append(middles, stops[wide])
    times, angles, arriving, leaving = _rounded(curves, np.sort(np.concatenate(added)), frame_time)
    wxyz, rates = _turned(angles, np.stack([arriving, leaving]), order)
    signs = np.where(np.sum(rotation.unroll(wxyz) * wxyz, axis=1) < 0, -1.0, 1.0)[:, None]  # a step may be a whole turn
    return Track(times, signs * wxyz, signs * rates)


def _position(curves: Sequence[HermiteCurve], ends: np.ndarray, frame_time: float) -> Track:
    times, values, arriving, leaving = _rounded(curves, _union(curves, ends), frame_time)
    return Track(times, values, np.stack([arriving, leaving]))


def _rounded(
    curves: Sequence[HermiteCurve], times: np.ndarray, frame_time: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Times as the file can have them, and as in `_at` what the curves are there.

    A key moved back goes on as it leaves, one moved on as it came: so the value at the true time is what it was. Beside
    a step, whose stretch is shorter than any frame, it is the other way round.
    """
    near = key_times(times, frame_time).astype(np.float64)
    values, arriving, leaving = _at(curves, times)
    step = np.diff(times) < 0.1 * frame_time
    came = np.where(near > times, np.append(True, ~step), np.append(step, False))[:, None]
    return near, values + (near - times)[:, None] * np.where(came, arriving, leaving), arriving, leaving


def _still(value: float) -> HermiteCurve:
    return HermiteCurve(np.zeros(1), np.full(1, value), np.zeros(1))


def _union(curves: Sequence[HermiteCurve], ends: np.ndarray) -> np.ndarray:
    """Key times of all the curves within the clip, and its ends."""
    times = np.unique(np.concatenate([ends, *(curve.times for curve in curves)]))
    return times[(times >= ends[0]) & (times <= ends[-1])]


def _at(curves: Sequence[HermiteCurve], times: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Values, and slopes arriving at and leaving these times, each (N, n): a column a curve."""
    values = np.column_stack([curve.at(times) for curve in curves])
    arriving, leaving = (np.column_stack([_slopes(c, times, side) for c in curves]) for side in ("left", "right"))
    return values, arriving, leaving


def _slopes(curve: HermiteCurve, times: np.ndarray, side: str) -> np.ndarray:
    """(N,) value per second just before ("left") or just after ("right") the times."""
    if len(curve) < 2:
        return np.zeros(len(times))
    segment = np.searchsorted(curve.times, times, side=side) - 1  # type: ignore[call-overload]  # NumPy wants literals
    inside = (segment >= 0) & (segment < len(curve) - 1)
    i = np.where(inside, segment, 0)
    h = np.diff(curve.times)[i]
    u = (times - curve.times[i]) / h
    chord = np.diff(curve.values)[i] / h
    v = 1.0 - u
    slope = 6.0 * u * v * chord + v * (1.0 - 3.0 * u) * curve.slopes[i] - u * (2.0 - 3.0 * u) * curve.in_slopes[i + 1]
    return np.where(inside, slope, 0.0)


def _wide(
    curves: Sequence[HermiteCurve], order: str, starts: np.ndarray, stops: np.ndarray, limit: float
) -> np.ndarray:
    """(S,) whether the stretches, in none of which a curve has a key, need a key more."""
    (first, _, leaving), (last, arriving, _) = _at(curves, starts), _at(curves, stops)
    h = (stops - starts)[:, None]
    q0, rate0 = _turned(first, leaving[None], order)
    q1, rate1 = _turned(last, arriving[None], order)
    meant = rotation.from_euler(_between(first, last, leaving, arriving, h), order)
    seen = _of_length_1(_between(q0, q1, rate0[0], rate1[0], h))
    return ~(rotation.angle(meant, seen).max(axis=1) <= limit)  # also where there is no number


def _between(v0: np.ndarray, v1: np.ndarray, m0: np.ndarray, m1: np.ndarray, h: np.ndarray) -> np.ndarray:
    """Samples (S, 7, n) of cubics (S, n) between their ends; hermite.py has the formula."""
    v0, v1, m0, m1, h = (x[:, None] for x in (v0, v1, m0, m1, h))
    u = SAMPLES[:, None]
    return v0 + (v1 - v0) * (u * u * (3.0 - 2.0 * u)) + h * u * (1.0 - u) * ((1.0 - u) * m0 - u * m1)


def _middles(starts: np.ndarray, stops: np.ndarray, frame_time: float) -> np.ndarray:
    """Times halfway, on a frame where one lies between."""
    middles = 0.5 * (starts + stops)
    frames = np.rint(middles / frame_time) * frame_time
    room = 0.25 * frame_time
    return np.where((frames > starts + room) & (frames < stops - room), frames, middles)


def _turned(degrees: np.ndarray, rates: np.ndarray, order: str) -> tuple[np.ndarray, np.ndarray]:
    """Quaternions (N, 4) of Euler angles (N, n), and their rates (m, N, 4) for rates (m, N, n) of the angles.

    A continuous function of the angles: q and -q are told apart by whole turns.
    """
    wxyz = np.zeros((len(degrees), 4))
    wxyz[:, 0] = 1.0
    turning = np.zeros((*rates.shape[:2], 4))
    for column, axis in enumerate(order):  # the product rule
        half = np.radians(0.5 * degrees[:, column])
        turn, across = np.zeros((2, len(degrees), 4))
        turn[:, 0], turn[:, 1 + AXES.index(axis)] = np.cos(half), np.sin(half)
        across[:, 0], across[:, 1 + AXES.index(axis)] = -np.sin(half), np.cos(half)
        rate = np.radians(0.5 * rates[..., column])[..., None]
        turning = rotation.mul(turning, turn) + rate * rotation.mul(wxyz, across)
        wxyz = rotation.mul(wxyz, turn)
    return wxyz, turning
