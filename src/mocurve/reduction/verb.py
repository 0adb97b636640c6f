"""`reduce` and `refine`: the promise is kept here, whatever the methods do."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from time import perf_counter
from typing import Any, NamedTuple

import numpy as np

from .. import progress
from ..contacts import planted
from ..errors import Mismatch, OptionError, UnknownName
from ..keyed import HermiteCurve, KeyedMotion
from ..kinematics import world as places_of
from ..measure import Report, compare
from ..motion import Clip, Motion, unroll
from . import dynamic, linear, split, world
from .bound import lower_bound
from .keys import Keys
from .tolerance import DEFAULT, Limits, parse, resolve

LARGEST = 1e12  # degrees or length: beyond, double precision has no digits left for an error
SLACK = 1e-5  # part of a channel's own limit kept for rounding, that of a file with six decimals included


class Method(NamedTuple):
    """A reduction method. solve(middle (M, F), half (M, F), quality) -> Keys with |curve - middle| <= half.

    again: it is quick enough to run again inside the tubes of the promise in space, in every round."""

    solve: world.Solve
    again: bool = False


class Problem(NamedTuple):
    """What is to be kept: samples, limits on channels and joints, and which channels share key times."""

    motion: Motion
    limits: Limits
    groups: list[np.ndarray]


def reduce(
    clip: Clip,
    *,
    tolerance: str | Sequence[str] = DEFAULT,
    method: str = "optimal",
    align: str = "channel",
    quality: str = "default",
    feet: float = 0.25,
    ratio: float | None = None,
) -> KeyedMotion:
    """Few Hermite keys instead of a sample at every frame, with a promise that is checked at every frame.

    Parameters
    ----------
    clip
        A Motion, or a KeyedMotion to be reduced further.
    tolerance
        How far anything may move: in space 2mm 0.2cm 0.05in 0.1%height 0.35u (u: file units), or of each channel's value
        0.5deg 0.5%range. For a joint or channel, or from one second to another: LeftHand=0.5mm, LeftHand@1.2..2.0=0.2mm.
        Several hold together: 2mm and 5deg bound the twist too.
    method
        optimal (fewest keys), split (Lowe, after Önder), dynamic (Önder's dynamic programming), linear (straight segments).
    align
        Which channels share key times: channel (none do; fewest keys), joint, or pose (all).
    quality
        fast, default, good or best: fewer keys for more time.
    feet
        Part of the tolerance that planted feet get; 1 treats them like the rest.
    ratio
        The thesis's own threshold for method split, height over base in frames and degrees (0.001 to 0.1): it replaces the
        tolerance and promises nothing.

    Returns a KeyedMotion whose `report` tells keys, errors, time and the proven lower bound. Errors: OptionError for an option's
    value, UnknownName for a joint, Mismatch for samples that are no numbers.

    Source: Önder 2007, chapter 3, for split and dynamic; the promise in space and the method optimal are mocurve's own.

    >>> keys = mc.reduce(mc.read("walk.bvh"), tolerance="2mm")
    """
    from . import METHODS, QUALITIES

    started = perf_counter()
    _known("method", method, METHODS)
    _known("quality", quality, QUALITIES)
    texts = [tolerance] if isinstance(tolerance, str) else list(tolerance)
    step: dict[str, Any] = {
        "verb": "reduce",
        "tolerance": texts,
        "method": method,
        "align": align,
        "quality": quality,
        "feet": feet,
    }
    if ratio is not None:
        return _by_ratio(clip, ratio, step, started)
    problem = _problem(clip, texts, align, feet)
    chosen = METHODS[method]
    if problem.motion.frames == 0:
        keys, tubes = (
            [Keys(np.zeros(0, np.int64), np.zeros((len(g), 0)), np.zeros((len(g), 0))) for g in problem.groups],
            [],
        )
    elif problem.limits.joints is None:
        keys, tubes = _by_channel(problem, chosen.solve, quality)
    else:
        keys, tubes = world.fit(problem.motion, problem.groups, problem.limits, chosen.solve, chosen.again, quality)
    return _reported(clip, problem, _held(problem, keys), tubes, step, started)


def refine(keys: KeyedMotion, clip: Clip) -> KeyedMotion:
    """The same number of keys, moved in time, value and slope until they follow the clip better: Önder 2007, section 3.1, as polish.

    Without a promise in space the squared error of no channel grows; with one, every curve is drawn towards the middle of what the
    promise leaves it, and the RMS error in space does not grow. A promise that `reduce` made and that holds against this clip still
    holds. Key times that channels share stay shared. Mismatch where keys and clip have different skeletons or lengths, or a key lies
    between two frames.

    >>> mc.refine(mc.reduce(walk, method="split"), walk)
    """
    started = perf_counter()
    made = next((step for step in reversed(keys.history) if step.get("verb") == "reduce"), {})
    texts, align, feet = made.get("tolerance"), made.get("align", "channel"), made.get("feet", 1.0)
    problem = _problem(clip, texts or ["360deg"], align, feet)
    before = _on_frames(keys, problem)
    if problem.limits.joints is None:
        after = [
            _polished(*each, promised=texts is not None)
            for each in zip(before, *_samples_and_limits(problem), strict=True)
        ]
    else:
        after = world.polish(problem.motion, problem.groups, problem.limits, before, dynamic.refine_keys)
    step = {**made, "verb": "refine", "tolerance": texts}
    result = _reported(keys, problem, _held(problem, after) if texts is not None else after, [], step, started)
    told = compare(problem.motion, keys)
    return result if result.report.rms_error_world <= told.rms_error_world or problem.limits.joints is None else keys


def _polished(keys: Keys, samples: np.ndarray, half: np.ndarray, promised: bool) -> Keys:
    return dynamic.refine_keys(keys, samples, half if promised and _inside(keys, samples, half) else None)


def _inside(keys: Keys, samples: np.ndarray, half: np.ndarray) -> bool:
    now = np.array([world.samples_of(keys, member, samples.shape[1]) for member in range(len(samples))])
    return bool((np.abs(now - samples) <= half).all())


def _on_frames(keys: KeyedMotion, problem: Problem) -> list[Keys]:
    """The curves as groups of keys on frames."""
    motion = problem.motion
    if keys.skeleton.channel_names != motion.skeleton.channel_names or keys.frames != motion.frames:
        raise Mismatch(f"{keys!r} and {motion!r} are not the same motion: channels or frames differ")
    step, last = motion.frame_time, max(motion.frames - 1, 0)
    result = []
    for group in problem.groups:
        curves = [keys.curves[k] for k in group]
        frames = np.rint(curves[0].times / step).astype(np.int64)
        name = motion.skeleton.channel_names[group[0]]
        for curve in curves:
            if len(curve) != len(frames) or (np.abs(curve.times - frames * step) > 1e-6 * step).any():
                raise Mismatch(
                    f"the keys of {name!r} do not lie on frames, or not where those that share their times do"
                )
        if len(frames) > 1 and (frames[0] != 0 or frames[-1] != last):
            raise Mismatch(f"the keys of {name!r} do not reach from the first frame to the last")
        arriving = (
            np.array([curve.in_slopes for curve in curves]) * step if any(curve.broken for curve in curves) else None
        )
        values, slopes = (
            np.array([curve.values for curve in curves]),
            np.array([curve.slopes for curve in curves]) * step,
        )
        result.append(Keys(frames, values, slopes, arriving))
    return result


# -- the problem -----------------------------------------------------------------------------------


def _problem(clip: Clip, tolerance: Sequence[str], align: str, feet: float) -> Problem:
    from . import ALIGNMENTS

    _known("alignment", align, ALIGNMENTS)
    if not (isinstance(feet, int | float) and 0.0 < feet <= 1.0):
        raise OptionError(f"feet is a part of the tolerance, above 0 and at most 1, not {feet!r}")
    rules = parse(tolerance)
    motion = unroll(_numbers(clip.sample()))
    limits = resolve(rules, motion)
    if limits.joints is not None and feet < 1.0:
        limits = replace(limits, joints=np.where(planted(motion), feet, 1.0) * limits.joints)
    return Problem(motion, limits, _groups(motion, align))


def _numbers(motion: Motion) -> Motion:
    bad = ~(np.abs(motion.values) <= LARGEST)
    if bad.any():
        channel = int(np.flatnonzero(bad.any(axis=0))[0])
        frame = int(np.flatnonzero(bad[:, channel])[0])
        name, value = motion.skeleton.channel_names[channel], motion.values[frame, channel]
        raise Mismatch(
            f"channel {name!r} has the value {value} at frame {frame}: only numbers up to {LARGEST:g} can be reduced"
        )
    return motion


def _groups(motion: Motion, align: str) -> list[np.ndarray]:
    """Channels that share their key times."""
    channels = np.arange(motion.skeleton.channel_count)
    if align == "channel":
        return [channels[k : k + 1] for k in channels]
    if align == "pose":
        return [channels] if len(channels) else []
    owners = motion.skeleton.channel_joints
    return [channels[owners == joint] for joint in np.unique(owners)]


def _known(kind: str, name: str, names: Any) -> None:
    if name not in names:
        raise UnknownName(kind, str(name), names)


# -- keys ------------------------------------------------------------------------------------------


def _by_channel(problem: Problem, solve: world.Solve, quality: str) -> tuple[list[Keys], list[world.Tube]]:
    """Every group on its own, inside its channels' limits; one thread a core."""
    tubes = list(zip(*_samples_and_limits(problem), strict=True))
    keys = _side_by_side(lambda tube: world.group_keys(*tube, solve, quality), tubes, "reducing")
    return keys, tubes


def _samples_and_limits(problem: Problem) -> tuple[list[np.ndarray], list[np.ndarray]]:
    """Of every group its samples and its channels' limits, (M, F) each."""
    samples = np.ascontiguousarray(problem.motion.values.T)
    half = np.maximum(problem.limits.channels * (1.0 - SLACK), 1e-300)
    return [samples[group] for group in problem.groups], [half[group] for group in problem.groups]


def _side_by_side(work: Callable[[world.Tube], Any], tubes: list[world.Tube], label: str) -> list[Any]:
    done = []
    with ThreadPoolExecutor(
        len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    ) as threads:
        for result in threads.map(work, tubes):
            done.append(result)
            progress.advance(label, len(done), len(tubes))
    return done


def _by_ratio(clip: Clip, ratio: float, step: dict[str, Any], started: float) -> KeyedMotion:
    """The thesis's curve simplification as it stands: every channel by the ratio, then optimal tangents."""
    if step["method"] != "split" or step["align"] != "channel" or step["tolerance"] != [DEFAULT]:
        raise OptionError("a ratio goes with method 'split' and align 'channel', and takes the place of the tolerance")
    if not (isinstance(ratio, int | float) and 0.0 <= ratio < np.inf):
        raise OptionError(f"a ratio is a number from 0 up, like 0.005, not {ratio!r}")
    motion = unroll(_numbers(clip.sample()))
    groups = _groups(motion, "channel")
    keys = [split.with_ratio(np.ascontiguousarray(motion.values[:, k]), ratio) for k in range(len(groups))]
    nothing = np.full((len(groups), motion.frames), np.inf)
    step = {**step, "tolerance": None, "ratio": ratio}
    return _reported(clip, Problem(motion, Limits(nothing, None), groups), keys, [], step, started)


# -- the promise -----------------------------------------------------------------------------------


def _held(problem: Problem, keys: list[Keys]) -> list[Keys]:
    """The keys, with more of them where a limit is broken, until none is: the last resort is a key at every frame, which is exact."""
    while True:
        broken = _broken(problem, keys)
        if not broken.any():
            return keys
        keys = [
            _repaired(found, problem.motion.values[:, group], broken[group].any(axis=0))
            for group, found in zip(problem.groups, keys, strict=True)
        ]


def _broken(problem: Problem, keys: list[Keys]) -> np.ndarray:
    """(C, F) True where a channel is beyond its limit, or moves a joint that is beyond its own."""
    motion, limits = problem.motion, problem.limits
    curves = _curves(problem, keys)
    now = KeyedMotion(motion.skeleton, curves, motion.frame_time, motion.frames).sample()
    broken = ~(np.abs(now.values - motion.values) <= limits.channels.T).T
    if limits.joints is None:
        return broken
    off = np.linalg.norm(places_of(now) - places_of(motion), axis=-1).T
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
    """A key with the sample's value on every frame of every segment that touches a broken frame. samples (F, M), broken (F,)."""
    if not broken.any():
        return keys
    frames = len(samples)
    wanted = np.zeros(frames, bool)
    wanted[keys.frames] = True
    wanted[[0, -1]] = True
    ends = np.flatnonzero(wanted)
    for a, b in zip(ends[:-1], ends[1:], strict=True):
        wanted[a : b + 1] |= broken[a : b + 1].any()
    at = np.flatnonzero(wanted)
    values, slopes = (
        samples[at].T.copy(),
        np.gradient(samples, axis=0)[at].T.copy() if frames > 1 else np.zeros((samples.shape[1], 1)),
    )
    kept = np.isin(at, keys.frames[~broken[keys.frames]])
    old = np.isin(keys.frames, at[kept])
    values[:, kept], slopes[:, kept] = keys.values[:, old], keys.slopes[:, old]
    if keys.in_slopes is None:
        return Keys(at, values, slopes)
    arriving = slopes.copy()
    arriving[:, kept] = keys.in_slopes[:, old]
    return Keys(at, values, slopes, arriving)


# -- the result ------------------------------------------------------------------------------------


def _curves(problem: Problem, keys: list[Keys]) -> list[HermiteCurve]:
    """One curve a channel, in seconds."""
    step = problem.motion.frame_time
    curves: dict[int, HermiteCurve] = {}
    for group, found in zip(problem.groups, keys, strict=True):
        for member, channel in enumerate(group):
            arriving = None if found.in_slopes is None else found.in_slopes[member] / step
            curves[channel] = HermiteCurve(
                found.frames * step, found.values[member], found.slopes[member] / step, arriving
            )
    return [curves[channel] for channel in range(len(curves))]


def _reported(
    clip: Clip, problem: Problem, keys: list[Keys], tubes: list[world.Tube], step: dict[str, Any], started: float
) -> KeyedMotion:
    motion = problem.motion
    made = KeyedMotion(
        motion.skeleton, tuple(_curves(problem, keys)), motion.frame_time, motion.frames, (*clip.history, step)
    )
    report = compare(motion, made)
    bounds = _side_by_side(lambda tube: lower_bound(*tube), tubes, "proving the lower bound")
    of_channel = {int(k): bound for group, bound in zip(problem.groups, bounds, strict=False) for k in group}
    tightest = problem.limits.channels.min(axis=1, initial=np.inf)
    rows = tuple(
        replace(row, lower_bound=of_channel.get(k), tolerance=float(tightest[k]) if np.isfinite(tightest[k]) else None)
        for k, row in enumerate(report.channels)
    )
    joints = report.joints
    if problem.limits.joints is not None:
        nearest = problem.limits.joints.min(axis=1, initial=np.inf)
        joints = tuple(
            replace(row, tolerance=float(nearest[j]) if np.isfinite(nearest[j]) else None)
            for j, row in enumerate(joints)
        )
    told: Report = replace(
        report,
        clips=(clip, made),
        channels=rows,
        joints=joints,
        lower_bound=sum(of_channel.values()) if of_channel else None,
        seconds=perf_counter() - started,
        tolerance=f"ratio {step['ratio']:g}, no promise"
        if "ratio" in step
        else ", ".join(step["tolerance"] or ["none"]),
        method=step.get("method"),
        align=step.get("align"),
        quality=step.get("quality"),
    )
    return replace(made, report=told)
