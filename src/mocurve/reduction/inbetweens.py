"""Curves through whole poses: all channels keyed at the same frames, nearest to the clip in space.

The poses are where they are; values and slopes of every channel are free. `fitted` is one least-squares fit with a
weight a frame that grows with the frame's error in space (Lawson). `centred` then draws the channels, one after the
other, to the middle of the room that the others leave them, so that children make up for their parents' error, and
closes that room as the largest error comes down.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from ..motion import Motion
from ._scene import Scene, centre
from ._tubes import pose
from ._whole import Stage, errors_of, hermite_rows, refit_poses
from .keys import Keys
from .tolerance import Limits
from .world import RESERVE, SHELL, body_of, point_limits

SWEEPS = 8  # of Lawson's weights, over the whole clip
WINDOW_SWEEPS = 3  # the same in a window
REACH = 3  # keys to either side of a change whose curves are fitted again
GAIN = 0.99  # of the largest error: a round that leaves more is the last
ROUNDS = 40  # of `centred`, at most
STRAY = 2.0  # how far `centred` lets a channel go from its samples, in what it is off at most now


@dataclass
class Inbetweens:
    """Keys of all channels at frames (K,), and how far their curves are off; a search works in it.

    values, slopes (K, C), per frame; weights, errors (F,); pinned (F,): frames whose keys stay. costs: of keys, what
    the error beside them would be without them, and the frames from which to which that holds."""

    stage: Stage
    pinned: np.ndarray
    frames: np.ndarray
    values: np.ndarray
    slopes: np.ndarray
    weights: np.ndarray
    errors: np.ndarray
    costs: dict[int, tuple[float, int, int]] = field(default_factory=dict)

    @property
    def worst(self) -> float:
        return float(self.errors.max())


@dataclass(frozen=True)
class Change:
    """Other keys between keys lo and hi, which stay: frames, values and slopes of all from lo to hi, and what they come
    to."""

    worst: float
    lo: int
    hi: int
    frames: np.ndarray
    values: np.ndarray
    slopes: np.ndarray
    weights: np.ndarray
    errors: np.ndarray


def stage_of(motion: Motion, limits: Limits | None = None) -> Stage:
    """The clip as a stage. Without limits errors are distances of joints and end sites, in file units; with limits, of
    the shell points too, in the limits, and of the channels in theirs."""
    body = body_of(motion, 0.0 if limits is None else SHELL)
    samples = np.ascontiguousarray(motion.values)
    frames, points = motion.frames, len(body.shell)
    target, axes = np.empty((frames, 3, points)), np.empty((frames, 3, samples.shape[1]))
    pose(body, samples, target, axes)
    allowed, room = np.ones((frames, points)), np.empty((frames, 0))
    if limits is not None:
        if limits.joints is None:
            allowed[:] = np.inf
        else:
            allowed = point_limits(body, limits.joints) * (1.0 - RESERVE)
        if np.isfinite(limits.channels).any():
            room = np.ascontiguousarray(limits.channels.T) * (1.0 - RESERVE)
    return Stage(body, samples, target, allowed, room)


def fitted(stage: Stage, pinned: np.ndarray, frames: np.ndarray | Sequence[int], sweeps: int = SWEEPS) -> Inbetweens:
    """The curves through poses at the frames (K,), at least two, the first and the last frame among them."""
    at = np.array(frames, np.int64)
    values, slopes = np.zeros((2, len(at), stage.samples.shape[1]))
    weights, errors = np.ones(len(stage.samples)), np.zeros(len(stage.samples))
    refit_poses(stage, at, values, slopes, False, False, weights, errors, sweeps)
    return Inbetweens(stage, pinned, at, values, slopes, weights, errors)


def given(stage: Stage, pinned: np.ndarray, keys: Keys) -> Inbetweens:
    """Keys of all channels as they are."""
    values, slopes = np.ascontiguousarray(keys.values.T), np.ascontiguousarray(keys.slopes.T)
    curves, errors = np.empty_like(stage.samples), np.empty(len(stage.samples))
    hermite_rows(keys.frames, values, slopes, slopes, 0, curves)
    errors_of(stage, 0, curves, errors)
    return Inbetweens(stage, pinned, keys.frames, values, slopes, np.ones(len(errors)), errors)


def changed(now: Inbetweens, lo: int, hi: int, between: np.ndarray) -> Change:
    """What it comes to if frames `between` are keys in place of those between keys lo and hi."""
    frames = np.concatenate([now.frames[lo : lo + 1], between, now.frames[hi : hi + 1]]).astype(np.int64)
    values, slopes = np.zeros((2, len(frames), now.values.shape[1]))
    values[[0, -1]], slopes[[0, -1]] = now.values[[lo, hi]], now.slopes[[lo, hi]]
    weights = now.weights[frames[0] : frames[-1] + 1].copy()
    weights = weights / max(weights.max(), 1e-300) + 1e-6
    errors = np.zeros(len(weights))
    ends = lo > 0, hi < len(now.frames) - 1
    worst = refit_poses(now.stage, frames, values, slopes, *ends, weights, errors, WINDOW_SWEEPS)
    return Change(worst, lo, hi, frames, values, slopes, weights, errors)


def take(now: Inbetweens, change: Change) -> None:
    """Make the change."""
    before, after = slice(0, change.lo), slice(change.hi + 1, None)
    for name in ("frames", "values", "slopes"):
        old, new = getattr(now, name), getattr(change, name)
        setattr(now, name, np.concatenate([old[before], new, old[after]]))
    first, last = int(change.frames[0]), int(change.frames[-1])
    now.weights[first : last + 1], now.errors[first : last + 1] = change.weights, change.errors
    now.costs = {key: cost for key, cost in now.costs.items() if cost[2] <= first or cost[1] >= last}


def settled(now: Inbetweens, sweeps: int = SWEEPS) -> bool:
    """Fit all curves again with the weights that there are; False, and nothing changed, where that is no better."""
    values, slopes = np.zeros((2, *now.values.shape))
    weights, errors = now.weights / max(now.weights.max(), 1e-300) + 1e-9, np.zeros(len(now.errors))
    if refit_poses(now.stage, now.frames, values, slopes, False, False, weights, errors, sweeps) >= now.worst:
        return False
    now.values, now.slopes, now.weights, now.errors, now.costs = values, slopes, weights, errors, {}
    return True


def centred(now: Inbetweens, good: float = 0.0) -> Inbetweens:
    """The same keys; every channel drawn to the middle of what the present largest error leaves it, until that no
    longer comes down, or is at most `good`."""
    stage, worst = now.stage, now.worst
    if len(now.frames) < 2 or not 0.0 < worst < np.inf:
        return now
    channels, frames = now.values.shape[1], len(now.errors)
    curves, errors = np.empty((frames, channels)), np.empty(frames)
    hermite_rows(now.frames, now.values, now.slopes, now.slopes, 0, curves)
    points, axes = np.empty_like(stage.target), np.empty((frames, 3, channels))
    pose(stage.body, curves, points, axes)
    original, samples = np.ascontiguousarray(stage.samples.T), np.ascontiguousarray(curves.T)
    values, slopes = np.ascontiguousarray(now.values.T), np.ascontiguousarray(now.slopes.T)
    best = now
    for _ in range(ROUNDS):
        scene = Scene(stage.body, original, samples, stage.target, points, axes, stage.limits * (worst * (1.0 + 1e-9)))
        near = np.repeat(STRAY * np.abs(samples - original).max(axis=1, keepdims=True) + 1e-6, frames, axis=1)
        if stage.room.shape[1]:
            near = np.minimum(near, worst * (1.0 + 1e-9) * stage.room.T)
        for channel in range(channels - 1, -1, -1):
            centre(scene, channel, now.frames, values[channel], slopes[channel], near)
        errors_of(stage, 0, np.ascontiguousarray(samples.T), errors)
        reached = float(errors.max())
        if not reached < best.worst:
            break
        state = np.ascontiguousarray(values.T), np.ascontiguousarray(slopes.T)
        best = Inbetweens(stage, now.pinned, now.frames, *state, now.weights, errors.copy())
        if reached > GAIN * worst or reached <= good:
            break
        worst = reached
    return best


def keys_of(now: Inbetweens) -> Keys:
    """The keys as a method returns them."""
    return Keys(now.frames, np.ascontiguousarray(now.values.T), np.ascontiguousarray(now.slopes.T))
