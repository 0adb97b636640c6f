"""What a reduction has to keep, and whether it does: the promise is checked here, whatever a method returned."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from ..errors import Mismatch, OptionError, UnknownName
from ..feet.planted import planted
from ..keyed import HermiteCurve, KeyedMotion
from ..kinematics import world
from ..motion import Clip, Motion, unroll
from .keys import Keys
from .tolerance import Limits, parse, resolve

ALIGNMENTS = ("channel", "joint", "pose")
LARGEST = 1e12  # degrees or length: beyond, double precision has no digits left for an error
SLACK = 1e-5  # part of a channel's own limit kept for rounding, that of a file with six decimals included


class Problem(NamedTuple):
    """Samples, limits on channels and joints, and which channels (M,) share key times."""

    motion: Motion
    limits: Limits
    groups: list[np.ndarray]

    def bands(self) -> list[tuple[np.ndarray, np.ndarray]]:
        """Of every group its samples and its channels' limits, (M, F) each."""
        samples = np.ascontiguousarray(self.motion.values.T)
        half = np.maximum(self.limits.channels * (1.0 - SLACK), 1e-300)
        return [(samples[group], half[group]) for group in self.groups]


def problem(clip: Clip, tolerance: Sequence[str] | None, align: str, feet: float) -> Problem:
    """What the options ask of the clip, its samples without whole turns; without a tolerance nothing is limited."""
    known("alignment", align, ALIGNMENTS)
    if not (isinstance(feet, int | float) and 0.0 < feet <= 1.0):
        raise OptionError(f"feet is a part of the tolerance, above 0 and at most 1, not {feet!r}")
    rules = None if tolerance is None else parse(tolerance)
    motion = numbers(clip)
    if rules is None:
        limits = Limits(np.full((motion.skeleton.channel_count, motion.frames), np.inf), None)
    else:
        limits = resolve(rules, motion)
    if limits.joints is not None and feet < 1.0:
        limits = replace(limits, joints=np.where(planted(motion), feet, 1.0) * limits.joints)
    return Problem(motion, limits, _groups(motion, align))


def numbers(clip: Clip) -> Motion:
    """The samples of a clip, without whole turns; Mismatch for one that is no number."""
    motion = clip.sample()
    bad = ~(np.abs(motion.values) <= LARGEST)
    if bad.any():
        channel = int(np.flatnonzero(bad.any(axis=0))[0])
        frame = int(np.flatnonzero(bad[:, channel])[0])
        name, value = motion.skeleton.channel_names[channel], motion.values[frame, channel]
        if np.isnan(value):
            raise Mismatch(f"channel {name!r} has no sample at frame {frame}: fill the gaps first (denoise does)")
        raise Mismatch(
            f"channel {name!r} has the value {value} at frame {frame}: only numbers up to {LARGEST:g} can be reduced"
        )
    return unroll(motion, triples=False)


def known(kind: str, name: str, names: Any) -> None:
    """UnknownName where the name is none of the names."""
    if not isinstance(name, str) or name not in names:
        raise UnknownName(kind, str(name), names)


def held(problem: Problem, keys: list[Keys]) -> list[Keys]:
    """The keys, and more of them until no limit is broken. The last resort, a key at every frame, is exact."""
    while True:
        broken = _broken(problem, keys)
        if not broken.any():
            return keys
        keys = [
            _repaired(found, problem.motion.values[:, group], broken[group].any(axis=0))
            for group, found in zip(problem.groups, keys, strict=True)
        ]


def curves(problem: Problem, keys: list[Keys]) -> tuple[HermiteCurve, ...]:
    """One curve a channel, in seconds."""
    step = problem.motion.frame_time
    found: dict[int, HermiteCurve] = {}
    for group, of_group in zip(problem.groups, keys, strict=True):
        for i, channel in enumerate(group):
            leaving = of_group.slopes[i] / step
            arriving = leaving if of_group.in_slopes is None else of_group.in_slopes[i] / step
            found[channel] = HermiteCurve(of_group.frames * step, of_group.values[i], leaving, arriving)
    return tuple(found[channel] for channel in range(len(found)))


# -- in call order ---------------------------------------------------------------------------------


def _groups(motion: Motion, align: str) -> list[np.ndarray]:
    channels = np.arange(motion.skeleton.channel_count)
    if align == "channel":
        return [channels[k : k + 1] for k in channels]
    if align == "pose":
        return [channels] if len(channels) else []
    owners = motion.skeleton.channel_joints
    return [channels[owners == joint] for joint in np.unique(owners)]


def _broken(problem: Problem, keys: list[Keys]) -> np.ndarray:
    """(C, F) True where a channel is beyond its limit, or moves a joint that is beyond its own."""
    motion, limits, _ = problem
    now = KeyedMotion(motion.skeleton, curves(problem, keys), motion.frame_time, motion.frames).sample()
    broken = ~(np.abs(now.values - motion.values) <= limits.channels.T).T
    if limits.joints is None:
        return broken
    off = np.linalg.norm(world(now) - world(motion), axis=-1).T
    astray = ~(off <= limits.joints)
    exact = (now.values == motion.values).T
    for joint in np.flatnonzero(astray.any(axis=1)):
        at = joint
        while at >= 0:
            moving = motion.skeleton.channel_joints == at
            broken[moving] |= astray[joint] & ~exact[moving]
            at = motion.skeleton.parents[at]
    return broken


def _repaired(keys: Keys, samples: np.ndarray, broken: np.ndarray) -> Keys:
    """A key on every frame of every segment that touches a broken frame (F,), at the value of the samples (F, M)."""
    if not broken.any():
        return keys
    wanted = np.zeros(len(samples), bool)
    wanted[keys.frames] = True
    wanted[[0, -1]] = True
    for a, b in pairwise(np.flatnonzero(wanted)):
        wanted[a : b + 1] |= broken[a : b + 1].any()
    at = np.flatnonzero(wanted)
    slopes = np.gradient(samples, axis=0) if len(samples) > 1 else np.zeros_like(samples)
    values, slopes = samples[at].T.copy(), slopes[at].T.copy()
    states = [keys.values, keys.slopes, *([] if keys.in_slopes is None else [keys.in_slopes])]
    sound = np.isfinite(states).all(axis=(0, 1))
    kept = np.isin(at, keys.frames[sound & ~broken[keys.frames]])
    old = np.isin(keys.frames, at[kept])
    values[:, kept], slopes[:, kept] = keys.values[:, old], keys.slopes[:, old]
    if keys.in_slopes is None:
        return Keys(at, values, slopes)
    arriving = slopes.copy()
    arriving[:, kept] = keys.in_slopes[:, old]
    return Keys(at, values, slopes, arriving)


def with_pins(keys: Keys, pinned: np.ndarray) -> Keys:
    """The same curves with keys at the pinned frames (F,), too: a cubic cut in two is the same two cubics."""
    at = np.flatnonzero(pinned)
    new = np.setdiff1d(at, keys.frames)
    if len(new) == 0 or at[-1] == 0 or (len(keys.frames) == 1 and len(at) == 2):
        return keys
    if len(keys.frames) == 1:
        return Keys(at, np.repeat(keys.values, len(at), axis=1), np.zeros((len(keys.values), len(at))))
    frames = np.union1d(keys.frames, new)
    old, cut = np.searchsorted(frames, keys.frames), np.searchsorted(frames, new)
    q = np.searchsorted(keys.frames, new) - 1
    arriving = keys.slopes if keys.in_slopes is None else keys.in_slopes
    h = (keys.frames[q + 1] - keys.frames[q]).astype(np.float64)
    u = (new - keys.frames[q]) / h
    start, end = keys.values[:, q], keys.values[:, q + 1]
    first, last = h * keys.slopes[:, q], h * arriving[:, q + 1]
    rise = end - start
    two, three = 3.0 * rise - 2.0 * first - last, first + last - 2.0 * rise
    states = np.empty((3, len(keys.values), len(frames)))
    states[:, :, old] = keys.values, keys.slopes, arriving
    slope = (first + u * (2.0 * two + 3.0 * u * three)) / h
    states[:, :, cut] = start + u * (first + u * (two + u * three)), slope, slope
    return Keys(frames, states[0], states[1], None if keys.in_slopes is None else states[2])
