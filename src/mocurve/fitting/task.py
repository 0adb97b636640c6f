"""What a fit has to keep, and least squares on given knots, measured against it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .. import bspline
from ..bspline_fit import least_squares, settled
from ..errors import Mismatch
from ..kinematics import reach
from ..kinematics import world as places_of
from ..motion import Motion
from ..reduction import world
from ..reduction.problem import Problem

RESERVE = 1e-5  # part of every limit kept for rounding, that of a file with six decimals included
SMALLEST = 1e-300  # a limit of nothing
WEIGHTED = 4  # fits with other weights where the first one is not good enough
HOPELESS = 2.5  # times the limit: weights do not mend that


class Task(NamedTuple):
    """Samples (F, C) at times (F,), and what they may be off.

    channels (F, C) and joints (F, J) limits in file units and degrees, joints None where nothing is asked in space;
    targets (F, J, 3); allowed (F, C): about how far each channel alone may go."""

    motion: Motion
    times: np.ndarray
    channels: np.ndarray
    joints: np.ndarray | None
    targets: np.ndarray | None
    allowed: np.ndarray
    degree: int
    ends: bool

    def over(self, samples: np.ndarray) -> np.ndarray:
        """(F,) the largest error of each frame in limits: the promise holds where it is at most 1."""
        off = np.abs(samples - self.motion.values) / self.channels
        worst = off.max(axis=1, initial=0.0)
        if self.joints is None or self.targets is None:
            return worst
        moved = Motion(self.motion.skeleton, samples, self.motion.frame_time)
        away = np.linalg.norm(places_of(moved) - self.targets, axis=2) / self.joints
        return np.maximum(worst, away.max(axis=1, initial=0.0))


class Fit(NamedTuple):
    """A spline on inner knots at frames (K,), its errors in limits at every frame (F,) and the worst of them."""

    inner: np.ndarray
    knots: np.ndarray
    values: np.ndarray
    over: np.ndarray
    worst: float

    @property
    def holds(self) -> bool:
        return self.worst <= 1.0


def task_of(asked: Problem, degree: int, ends: bool) -> Task:
    """The task that a reduction's problem is for one basis of all channels."""
    motion, limits, _ = asked
    channels = np.maximum(limits.channels.T * (1.0 - RESERVE), SMALLEST)
    times = np.arange(motion.frames) * motion.frame_time
    if limits.joints is None:
        allowed = channels if np.isfinite(channels).all() else np.minimum(channels, _by_lever(motion))
        return Task(motion, times, channels, None, None, allowed, degree, ends)
    _, alone, cap = world.problem(motion, limits)
    allowed = np.maximum(np.minimum(alone, cap).T, SMALLEST)
    joints = np.maximum(limits.joints.T * (1.0 - RESERVE), SMALLEST)
    return Task(motion, times, channels, joints, places_of(motion), allowed, degree, ends)


def _by_lever(motion: Motion) -> np.ndarray:
    """(C,) what each channel turns or moves while all that hangs on it moves by one unit of length at most."""
    skeleton = motion.skeleton
    lever = np.radians(reach(motion)[skeleton.channel_joints])
    lever[~skeleton.rotation_channels] = 1.0
    longest = float(lever.max(initial=0.0)) or 1.0
    return np.asarray(1.0 / np.maximum(lever, 0.01 * longest))


def fitted(task: Task, inner: np.ndarray, weighted: int = WEIGHTED) -> Fit:
    """Least squares on inner knots at frames (fractions of frames are allowed), as few left out as do not settle.

    Where the promise nearly holds frames are weighted by their error and fitted again: towards the smallest largest
    error (Lawson 1961). The best of these fits is returned.
    """
    motion, p = task.motion, task.degree
    last = motion.frames - 1
    breaks = np.concatenate([[0.0], inner, [last]]) * motion.frame_time
    knots = settled(bspline.clamped(breaks, p), p, task.times)
    inner = knots[p + 1 : -p - 1] / motion.frame_time
    head, tail = (motion.values[:1], motion.values[-1:]) if task.ends else (None, None)
    weights, best = np.ones(motion.frames), None
    for _ in range(weighted + 1):
        try:
            values = least_squares(knots, p, task.times, motion.values, weights=weights, first=head, last=tail)
        except Mismatch:  # settled in theory, but not in floating-point numbers
            break
        over = task.over(bspline.evaluate(knots, values, p, task.times))
        worst = float(over.max())
        if best is None or worst < best.worst:
            best = Fit(inner, knots, values, over, worst)
        if worst <= 1.0 or not worst < HOPELESS:
            break
        weights = weights * (0.05 + over / worst) ** 2
        weights = np.maximum(weights / weights.max(), 1e-6)
    if best is None:
        return Fit(
            inner, knots, np.full((len(knots) - p - 1, motion.values.shape[1]), np.nan), weights * np.inf, np.inf
        )
    return best
