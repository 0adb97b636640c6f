"""The verb `warp`: curves bent so that they go through given values (Witkin and Popović 1995; Bruderlin and Williams
1995, displacement maps; Sudarsky and House 1998, motion warping, on the coefficients)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from .. import hermite, kinematics, rotation
from ..errors import Mismatch, OptionError
from ..keyed import HermiteCurve, KeyedMotion
from ..motion import Clip, Motion, complete
from ..skeleton import Skeleton, matching
from ..spline import SplineMotion, align, of_keys
from ._pair import check, check_mode, recorded, tell_sampled
from ._slopes import limited, rate_of, smooth
from ._turns import free_joints

MODES = ("offset", "scale")
SAME_DEGREES = 1e-6
LEAST_OF_RANGE = 1e-6  # of a channel's largest value: less cannot be multiplied


class Constraint(NamedTuple):
    """A channel (index) is to have a value at a time (seconds)."""

    channel: int
    time: float
    value: float


class Bump(NamedTuple):
    """A displacement as a cubic Hermite curve: times (K,), values and slopes (K, n); nothing before and after it."""

    times: np.ndarray
    values: np.ndarray
    slopes: np.ndarray

    def at(self, times: np.ndarray) -> np.ndarray:
        """Values (N, n) at times (N,)."""
        inside = (times >= self.times[0]) & (times <= self.times[-1])
        columns = zip(self.values.T, self.slopes.T, strict=True)
        values = np.stack([hermite.evaluate(self.times, v, m, times) for v, m in columns], axis=1)
        return np.where(inside[:, None], values, 0.0)


def warp(
    clip: Clip,
    at: float | Sequence[float],
    values: Mapping[str, float | Sequence[float | None]] | None = None,
    pose: Clip | None = None,
    *,
    only: str | Sequence[str] = (),
    support: float = 0.5,
    mode: str = "offset",
    overshoot: bool = True,
) -> Clip:
    """The clip bent smoothly so that channels have given values at given times; untouched outside the support.

    Parameters
    ----------
    at
        When, seconds; one time or several.
    values
        {channel: value} such as {"LeftArm.Zrotation": 30}; with several times a value for each, None where there is
        none. The value is that of the curve itself, whole turns included.
    pose
        A clip that tells the pose of all joints: one frame for all times, or one for each. Joints are turned to it as
        rotations, the shorter way.
    only
        Joints that take the pose, * stands for anything: LeftHand, *Arm.
    support
        How long before the first and after the last of neighbouring times the clip is changed, seconds.
    mode
        offset: something is added. scale: the curve is multiplied, so that what is small stays small.
    overshoot
        Between neighbouring times, go the smoothest way, even if that leaves the range of both changes.

    Samples have times at frames: a time between two counts as the nearer one. Keys get keys at the times and at the
    ends of the support, splines get knots there: both exact. With a pose, or mode scale, they become samples. To undo
    it, warp back to the values there were. Errors: OptionError for times outside the clip or given twice and for
    values, UnknownName for a channel.

    >>> raised = mc.warp(walk, 1.2, {"LeftArm.Zrotation": 30})
    """
    times, constraints = _asked(clip, at, values, support, mode)
    if (pose is None) == (not constraints):
        raise OptionError("warp takes values of channels, or a pose; one of them")
    if pose is not None and mode == "scale":
        raise OptionError("a pose is reached by rotations: mode scale is for values of channels")
    if only and pose is None:
        raise OptionError("only says which joints take a pose, and no pose is given")
    step = {"verb": "warp", "at": times.tolist(), "support": support, "mode": mode, "overshoot": overshoot}
    if pose is None and mode == "offset" and isinstance(clip, KeyedMotion | SplineMotion):
        made: Clip = _of_curves(clip, constraints, support, overshoot)
    else:
        tell_sampled((clip,), "a pose, or mode scale, is reached frame by frame")
        motion = complete(clip.sample())
        if pose is None:
            made = _bent(motion, constraints, support, mode, overshoot)
        else:
            made = _posed(motion, times, pose, only, support, overshoot)
    if pose is None:
        step["values"] = _told(clip.skeleton, times, constraints)
    else:
        step |= {"only": only if isinstance(only, str) else list(only), "with": list(pose.history)}
    return recorded(made, (*clip.history, step))


def at_frames(clip: Clip, times: np.ndarray) -> np.ndarray:
    """The times (seconds) as the clip can have them: samples at their frames, keys and splines at any."""
    if isinstance(clip, KeyedMotion | SplineMotion):
        return np.clip(times, 0.0, clip.duration)
    return np.clip(np.rint(times / clip.frame_time), 0, clip.frames - 1) * clip.frame_time


# -- in call order ---------------------------------------------------------------------------------


def _asked(
    clip: Clip, at: float | Sequence[float], values: object, support: float, mode: str
) -> tuple[np.ndarray, list[Constraint]]:
    """Times (K,) and what is asked of channels at them, all checked."""
    check_mode(mode, MODES)
    if isinstance(support, bool) or not (isinstance(support, int | float) and 0 < support < np.inf):
        raise OptionError(f"support is a number of seconds above 0, not {support!r}")
    if not clip.frames:
        raise Mismatch("a clip without frames cannot be warped")
    try:
        given = np.array(at, np.float64).reshape(-1)
    except (TypeError, ValueError):
        raise OptionError(f"at is a time in seconds, or several, not {at!r}") from None
    if not len(given) or not np.isfinite(given).all():
        raise OptionError(f"at is a time in seconds, or several, not {at!r}")
    outside = (given < -0.5 * clip.frame_time) | (given > clip.duration + 0.5 * clip.frame_time)
    if outside.any():
        raise OptionError(f"{given[outside][0]:g} s lies outside of the clip, which goes from 0 to {clip.duration:g} s")
    times = at_frames(clip, given)
    constraints = [] if values is None else _constraints(clip.skeleton, times, values)
    told = {(c.channel, c.time) for c in constraints}
    if len(told) < len(constraints) or (values is None and len(np.unique(times)) < len(times)):
        twice = next(t for i, t in enumerate(times) if t in times[:i])
        raise OptionError(f"two values are asked for at {twice:g} s (a time between frames counts as the nearer frame)")
    return times, constraints


def _constraints(skeleton: Skeleton, times: np.ndarray, values: object) -> list[Constraint]:
    if not isinstance(values, Mapping):
        raise OptionError(f"values are given by channel, like LeftArm.Zrotation=30, not as {values!r}")
    found = []
    for name, given in values.items():
        channel = skeleton.channel(name)
        several = isinstance(given, Sequence | np.ndarray) and not isinstance(given, str)
        each = list(given) if several else [given] * len(times)
        if len(each) != len(times):
            raise OptionError(f"{name}: {len(each)} values are given for {len(times)} times")
        for time, value in zip(times.tolist(), each, strict=True):
            if value is None:
                continue
            try:
                number = float(value)
            except (TypeError, ValueError):
                number = np.nan
            if not np.isfinite(number):
                raise OptionError(f"{name}: a value is a number, not {value!r}")
            found.append(Constraint(channel, time, number))
    return found


def _told(skeleton: Skeleton, times: np.ndarray, constraints: Sequence[Constraint]) -> dict[str, list[float | None]]:
    """The constraints as `warp` takes them: for each channel a value at each time, or None."""
    found = {(skeleton.channel_names[c.channel], c.time): c.value for c in constraints}
    return {name: [found.get((name, time)) for time in times.tolist()] for name in dict.fromkeys(n for n, _ in found)}


def _by_channel(constraints: Sequence[Constraint]) -> dict[int, tuple[np.ndarray, np.ndarray]]:
    """{channel: times and values (K,), in the order of time}"""
    found: dict[int, list[tuple[float, float]]] = {}
    for channel, time, value in constraints:
        found.setdefault(channel, []).append((time, value))
    return {channel: tuple(np.array(sorted(rows)).T) for channel, rows in found.items()}


def bump(times: np.ndarray, values: np.ndarray, support: float, overshoot: bool) -> Bump:
    """The displacement through values (K, n) at times (K,), rising: it starts and ends at rest, `support` seconds
    before and after each run of times that lie no more than twice as far apart."""
    run_starts = np.concatenate([[0], 1 + np.flatnonzero(np.diff(times) > 2.0 * support), [len(times)]])
    pieces = []
    nothing = np.zeros((1, values.shape[1]))
    for first, last in pairwise(run_starts.tolist()):
        own = np.concatenate([[times[first] - support], times[first:last], [times[last - 1] + support]])
        through = np.concatenate([nothing, values[first:last], nothing])
        pieces.append((own, through, (smooth if overshoot else limited)(own, through)))
    return Bump(*(np.concatenate(part) for part in zip(*pieces, strict=True)))


def _bent(motion: Motion, constraints: Sequence[Constraint], support: float, mode: str, overshoot: bool) -> Motion:
    values = np.array(motion.values, order="F")
    times = np.arange(motion.frames) * motion.frame_time
    for channel, (when, wanted) in _by_channel(constraints).items():
        column = values[:, channel]
        frames = np.rint(when / motion.frame_time).astype(int)
        if mode == "offset":
            column += bump(when, (wanted - column[frames])[:, None], support, overshoot).at(times)[:, 0]
        else:
            least = LEAST_OF_RANGE * max(np.abs(column).max(), 1e-300)
            bad = (np.abs(column[frames]) < least) | (wanted * column[frames] <= 0)
            if bad.any():
                k = int(np.argmax(bad))
                raise OptionError(
                    f"{motion.skeleton.channel_names[channel]} is {column[frames][k]:.6g} at {when[k]:g} s and cannot "
                    f"be multiplied to {wanted[k]:g}; use mode offset"
                )
            factor = bump(when, np.log(wanted / column[frames])[:, None], support, overshoot)
            column *= np.exp(factor.at(times)[:, 0])  # as an exponent it is undone by its negative
        column[frames] = wanted
    return replace(motion, values=values)


def _of_curves(
    clip: KeyedMotion | SplineMotion, constraints: Sequence[Constraint], support: float, overshoot: bool
) -> Clip:
    """The displacement as keys of its own, added to the curves on a common basis."""
    start, end = clip.domain if isinstance(clip, SplineMotion) else (0.0, clip.duration)
    if not end > start:
        raise Mismatch("a clip of one frame has no curves to bend")
    curves = {}
    for channel, (when, wanted) in _by_channel(constraints).items():
        now = clip.at(when)[:, channel] if isinstance(clip, SplineMotion) else clip.curves[channel].at(when)
        curves[channel] = within(bump(when, (wanted - now)[:, None], support, overshoot), start, end)
    return added(clip, curves)


def added(clip: KeyedMotion | SplineMotion, curves: Mapping[int, HermiteCurve]) -> KeyedMotion | SplineMotion:
    """The clip with displacements of channels (by index), keys from its start to its end, added; exact."""
    start, end = clip.domain if isinstance(clip, SplineMotion) else (0.0, clip.duration)
    nothing = HermiteCurve(np.array([start, end]), np.zeros(2), np.zeros(2))
    every = tuple(curves.get(channel, nothing) for channel in range(clip.skeleton.channel_count))
    by = KeyedMotion(clip.skeleton, every, clip.frame_time, clip.frames)
    if isinstance(clip, SplineMotion):
        base, more = align(clip, of_keys(by))
        return replace(base, values=base.values + more.values)
    return replace(
        clip, curves=tuple(_summed(clip, by, c) if c in curves else own for c, own in enumerate(clip.curves))
    )


def within(bump: Bump, start: float, end: float) -> HermiteCurve:
    """The displacement cut to a span (seconds), with keys at both its ends."""
    inside = (bump.times > start) & (bump.times < end)
    values, slopes = bump.values[:, 0], bump.slopes[:, 0]
    ends = np.array([start, end])
    there = (ends >= bump.times[0]) & (ends <= bump.times[-1])
    rates = np.where(there, rate_of(bump.times, values, slopes, ends), 0.0)
    edges = bump.at(ends)[:, 0]
    return HermiteCurve(
        np.concatenate([[start], bump.times[inside], [end]]),
        np.concatenate([edges[:1], values[inside], edges[1:]]),
        np.concatenate([rates[:1], slopes[inside], rates[1:]]),
    )


def _summed(clip: KeyedMotion, added: KeyedMotion, channel: int) -> HermiteCurve:
    """One channel's curve and its displacement, on the keys of both."""
    one = Skeleton(("curve",), np.array([-1]), np.zeros((1, 3)), (("Xposition",),))
    pair = (KeyedMotion(one, (keys.curves[channel],), clip.frame_time, clip.frames) for keys in (clip, added))
    (a,), (b,) = (keys.curves for keys in align(*pair))
    return HermiteCurve(a.times, a.values + b.values, a.slopes + b.slopes, a.in_slopes + b.in_slopes)


def _posed(
    motion: Motion, times: np.ndarray, pose: Clip, only: str | Sequence[str], support: float, overshoot: bool
) -> Motion:
    """Joints turned to the pose along rotation vectors, other channels moved to it."""
    check(motion.skeleton, pose.skeleton, "exact")
    told = complete(pose.sample())
    if told.frames not in (1, len(times)):
        raise OptionError(
            f"the pose has {told.frames} frames: one is needed, or one for each of the {len(times)} times"
        )
    order = np.argsort(times)
    wanted = np.broadcast_to(told.values, (len(times), told.values.shape[1]))[order]
    when = times[order]
    names = [only] if isinstance(only, str) else list(only)
    joints = np.full(len(motion.skeleton.names), not names)
    for name in names:
        joints[matching(name, motion.skeleton.names, motion.skeleton.names, "joint")] = True
    frames = np.rint(when / motion.frame_time).astype(int)
    values = np.array(motion.values, order="F")
    free = [entry for entry in free_joints(motion.skeleton) if joints[entry[0]]]
    turning = [column for _, columns, _ in free for column in columns]
    own = np.arange(motion.frames) * motion.frame_time
    for channel in np.setdiff1d(np.flatnonzero(joints[motion.skeleton.channel_joints]), turning):
        apart = wanted[:, channel] - values[frames, channel]
        if motion.skeleton.rotation_channels[channel]:
            apart -= 360.0 * np.rint(apart / 360.0)
        values[:, channel] += bump(when, apart[:, None], support, overshoot).at(own)[:, 0]
    goal = kinematics.rotations(replace(told, values=wanted))
    made = replace(motion, values=values)
    return _turned(made, [(j, c, o, goal[:, j]) for j, c, o in free], frames, when, support, overshoot)


def _turned(
    motion: Motion, goals: list, frames: np.ndarray, when: np.ndarray, support: float, overshoot: bool
) -> Motion:
    """Joints turned to goals [(joint, columns, order, rotations (K, 4))]; frames outside the support keep theirs."""
    values = np.array(motion.values, order="F")
    own = np.arange(motion.frames) * motion.frame_time
    now = kinematics.rotations(motion)
    for joint, columns, order, goal in goals:
        vectors = rotation.log(rotation.mul(rotation.inv(now[frames, joint]), goal))
        by = bump(when, vectors, support, overshoot).at(own)
        changed = np.flatnonzero(by.any(axis=1))
        if not len(changed):
            continue
        first, end = max(changed[0] - 1, 0), min(changed[-1] + 1, motion.frames - 1)
        turned = rotation.to_euler(rotation.mul(now[first : end + 1, joint], rotation.exp(by[first : end + 1])), order)
        angles = rotation.unroll_euler(np.vstack([values[first : first + 1, columns], turned]), order)[1:]
        after = values[end:, columns]
        if not by[end].any() and np.abs(angles[-1] - after[0]).max() > SAME_DEGREES:
            values[end:, columns] = rotation.unroll_euler(np.vstack([angles[-2:-1], after]), order)[
                1:
            ]  # whole turns on
        moved = by[first : end + 1].any(axis=1, keepdims=True)
        values[first : end + 1, columns] = np.where(moved, angles, values[first : end + 1, columns])
    return replace(motion, values=values)
