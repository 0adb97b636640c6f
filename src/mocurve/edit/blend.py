"""The verb `blend`: between two clips (Sudarsky and House 1998, blending; rotations as in Shoemake 1985)."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from .. import bspline, kinematics, rotation
from ..bspline_fit import least_squares
from ..errors import Mismatch, OptionError
from ..keyed import HermiteCurve, KeyedMotion
from ..motion import Clip, Motion, frame_count, unroll
from ..spline import SplineMotion, align, clamped, raised
from ._pair import at_times, check, check_mode, onto, recorded, same_curves, tell_sampled, whole_turns
from ._time import length_of, stretched
from ._turns import between, free_joints, part
from ._weights import Rule, Weight, constant, parse, resolve, told

LONGEST = 10  # times the longer clip: what weights beyond 1 may stretch a clip to
MODES = ("rotations", "curves", "coefficients")


def blend(a: Clip, b: Clip, weight: Weight = 0.5, *, mode: str = "rotations", match: str = "exact") -> Clip:
    """Between two clips: a at weight 0, b at weight 1.

    Parameters
    ----------
    weight
        How much of the second clip: 0.3, or changing in time, 0:0,2:1 (0 at second 0, 1 at second 2, straight between),
        or of some joints, 'Left*=0.3' (the others stay as in the first). Several may be given, the later one counts.
    mode
        rotations: joints turn the shorter way at even speed, frame by frame; keys and splines become samples. curves:
        channel by channel, keys stay keys and splines stay splines, exactly. coefficients: as curves, but a weight that
        changes in time is applied to the coefficients of splines, which is smoother than the product, but not it.
    match
        exact: both have the same joints and channels. names: joints are found by name, others stay as in the first.

    Clips of different length are stretched onto one another, and the result lasts as long between them as the mean
    weight says (as the first where joints have weights of their own); its frame time is the first's. What of the body
    is not motion (the lengths of bones) is the first's.
    Errors: Mismatch naming the first difference of the skeletons, OptionError for a weight, UnknownName for a joint.

    >>> half = mc.blend(walk, run, 0.5)
    """
    rules = parse(weight)
    check_mode(mode, MODES)
    check(a.skeleton, b.skeleton, match)
    step = {"verb": "blend", "weight": told(rules), "mode": mode, "match": match}
    history = (*a.history, {**step, "with": list(b.history)})
    if not min(a.frames, b.frames):
        raise Mismatch("blend needs clips with frames, not a clip with none")
    everywhere = resolve(rules, a.skeleton, _moments(rules, a.duration), 0.0)
    if not everywhere.any():
        return recorded(a, history)
    if (everywhere == 1).all() and type(a) is type(b) and a.skeleton.channel_names == b.skeleton.channel_names:
        return recorded(replace(b, skeleton=a.skeleton), history)  # type: ignore[type-var]
    return recorded(between_clips(a, b, rules, mode), history)


def between_clips(a: Clip, b: Clip, rules: tuple[Rule, ...], mode: str, *, nearest: bool = True) -> Clip:
    """Between two clips that were found to match. nearest: whole turns between channels do not count."""
    share = _share(rules, a)
    if mode != "rotations" and same_curves((a, b)) and (constant(rules) or isinstance(a, SplineMotion)):
        return _of_curves(a, b, rules, share, mode, nearest)
    tell_sampled((a, b), _why(mode, a, b))
    return _of_samples(a, b, rules, share, mode, nearest)


# -- in call order ---------------------------------------------------------------------------------


def _share(rules: tuple[Rule, ...], a: Clip) -> float:
    """The mean weight over time; 0 where joints have weights of their own, so that the first clip keeps its length."""
    times = _moments(rules, a.duration)
    weights = resolve(rules, a.skeleton, times, 0.0)
    if (weights != weights[:, :1]).any():
        return 0.0
    one = weights[:, 0] if weights.size else np.zeros(1)
    return float(one[0] if len(times) < 2 else np.diff(times) @ (one[1:] + one[:-1]) / 2 / (times[-1] - times[0]))


def _moments(rules: tuple[Rule, ...], duration: float) -> np.ndarray:
    """Times (n,) between which weights are straight lines: the ends of the clip and the rules' own."""
    points = np.concatenate([[0.0, duration], *(rule.times for rule in rules)])
    return np.unique(np.clip(points, 0.0, duration))


def _why(mode: str, a: Clip, b: Clip) -> str:
    if mode == "rotations":
        return "joints turn frame by frame (mode curves keeps keys and splines)"
    if isinstance(a, KeyedMotion) and isinstance(b, KeyedMotion):
        return "a weight that changes in time makes no Hermite curves of Hermite curves"
    return "both clips must be keys, or both splines, with the same channels, to be blended as curves"


def _of_samples(a: Clip, b: Clip, rules: tuple[Rule, ...], share: float, mode: str, nearest: bool) -> Motion:
    times, (first, second, had) = _on_common_frames(a, b, share)
    weights = resolve(rules, a.skeleton, times, 0.0)
    owner = a.skeleton.channel_joints
    by_channel = np.where(had, weights[:, owner], 0.0)
    smooth = [unroll(clip).values for clip in (first, second)]
    turns = np.where(a.skeleton.rotation_channels, nearest * whole_turns(smooth[1] - smooth[0]), 0.0)
    values = (1.0 - by_channel) * smooth[0] + by_channel * (smooth[1] - turns)
    if mode == "rotations":
        values = _turned(replace(first, values=values), first, second, by_channel)
    values = np.where((by_channel == 0).all(axis=0), first.values, values)
    return replace(first, values=np.where((by_channel == 1).all(axis=0), second.values, values))


def _on_common_frames(a: Clip, b: Clip, share: float) -> tuple[np.ndarray, tuple[Motion, Motion, np.ndarray]]:
    """Times (F,) as the first clip has them, and both clips at them, stretched onto one another."""
    length = _length(a.duration, b.duration, share)
    at = np.arange(frame_count(length, a.frame_time)) * a.frame_time
    along = at / length if length > 0 else at
    first, second = (at_times(clip, along * clip.duration, a.frame_time) for clip in (a, b))
    second, had = onto(first, second)
    return along * a.duration, (first, second, had)


def _length(a: float, b: float, share: float) -> float:
    """Seconds between those of two clips."""
    if abs(a - b) < 1e-9 * max(a, b):
        return a
    length = (1.0 - share) * a + share * b
    if not 0 <= length <= LONGEST * max(a, b):
        raise Mismatch(f"with weight {share:g} the clip would last {length:.6g} s; retime one of the clips first")
    return length


def _turned(base: Motion, first: Motion, second: Motion, by_channel: np.ndarray) -> np.ndarray:
    """Values (F, C) of base, the joints that can express any rotation turned between first and second."""
    turned = kinematics.rotations(base)
    before, after = kinematics.rotations(first), kinematics.rotations(second)
    for joint, columns, _ in free_joints(base.skeleton):
        way = part(between(before[:, joint], after[:, joint]), by_channel[:, columns[0]])
        turned[:, joint] = rotation.mul(way, before[:, joint])
    return kinematics.with_rotations(base, turned).values


def _of_curves(a: Any, b: Any, rules: tuple[Rule, ...], share: float, mode: str, nearest: bool) -> Clip:
    """Two clips of keys, or two splines."""
    length = _length(length_of(a), length_of(b), share)
    if not length > 0:
        raise Mismatch(f"the blended clip would last {length:.6g} s: curves need a length")
    first, second = align(a, stretched(b, length_of(a), a.frame_time))
    if isinstance(first, SplineMotion):
        return stretched(_between_splines(first, second, rules, mode, nearest), length, a.frame_time)
    weights = resolve(rules, a.skeleton, np.zeros(1), 0.0)[0, a.skeleton.channel_joints]
    turns = a.skeleton.rotation_channels & nearest
    pairs = zip(first.curves, second.curves, weights, turns, strict=True)
    curves = tuple(
        own if weight == 0 else _between_curves(mine, other, weight, turn)
        for own, (mine, other, weight, turn) in zip(a.curves, pairs, strict=True)
    )
    return stretched(replace(first, curves=curves), length, a.frame_time)


def _between_curves(a: HermiteCurve, b: HermiteCurve, weight: float, turns: bool) -> HermiteCurve:
    """Two curves with keys at the same times."""
    if not len(a) or not len(b):
        return a
    shift = 360.0 * np.rint(np.mean(b.values - a.values) / 360.0) if turns and weight != 1 else 0.0
    return HermiteCurve(
        a.times,
        (1.0 - weight) * a.values + weight * (b.values - shift),
        (1.0 - weight) * a.slopes + weight * b.slopes,
        (1.0 - weight) * a.in_slopes + weight * b.in_slopes,
    )


def _between_splines(
    a: SplineMotion, b: SplineMotion, rules: tuple[Rule, ...], mode: str, nearest: bool
) -> SplineMotion:
    """Two splines on the same knots. A weight that changes in time: at each coefficient's place, or the product."""
    owner, turning = a.skeleton.channel_joints, a.skeleton.rotation_channels & nearest
    turns = np.where(turning, whole_turns(b.values - a.values), 0.0)
    if mode == "coefficients" or constant(rules):
        weights = resolve(rules, a.skeleton, bspline.greville(a.knots, a.degree), 0.0)[:, owner]
        return replace(a, values=(1.0 - weights) * a.values + weights * (b.values - turns))
    a, b = clamped(a), clamped(b)
    knots = _of_the_product(a, rules)
    at = _inside_all_spans(knots, a.degree + 2)
    weights = resolve(rules, a.skeleton, at, 0.0)[:, owner]
    product = (1.0 - weights) * a.at(at) + weights * (b.at(at) - turns)
    values = least_squares(knots, a.degree + 1, at, product)  # nothing is left over: the product is such a spline
    return replace(a, knots=knots, values=values, degree=a.degree + 1)


def _of_the_product(clip: SplineMotion, rules: tuple[Rule, ...]) -> np.ndarray:
    """Knots of a degree more, on which curves times straight lines are splines, with corners where the lines meet."""
    if clip.degree == max(bspline.DEGREES):
        raise OptionError(
            f"a weight that changes in time raises the degree, and {clip.degree} is the highest: use mode coefficients"
        )
    higher = raised(clip, clip.degree + 1)
    start, end = higher.domain
    corners = np.unique(np.concatenate([rule.times for rule in rules if len(rule.times) > 1]))
    corners = bspline.snapped(corners, higher.knots)
    corners = corners[(corners > start) & (corners < end)]
    return bspline.union(higher.knots, np.repeat(corners, higher.degree))


def _inside_all_spans(knots: np.ndarray, count: int) -> np.ndarray:
    """So many times inside each span, as roots of a Chebyshev polynomial lie."""
    breaks = np.unique(knots)
    along = 0.5 - 0.5 * np.cos(np.pi * (np.arange(count) + 0.5) / count)
    return (breaks[:-1, None] + np.diff(breaks)[:, None] * along).reshape(-1)
