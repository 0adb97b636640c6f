"""Channels in, clean channels out: what is no motion is found and left out, noise is smoothed away as the data ask for.

In this order: gaps and frozen runs are filled; parts that are displaced as a whole are moved back; then twice, the
second time on what a fit leaves over: candidates, which the cheapest smooth path leaves out, and the verdict on each;
last the curves, each smoothed by the strength that predicts left-out samples best, frame by frame.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from .. import progress
from . import artefacts, smoothing, steps
from .artefacts import Body
from .bursts import bursts
from .smoothing import Strength

PASSES = 2  # the second sees the samples minus a fit, where the motion's own curvature is gone
ROUNDS = 2  # the second judges the core of what was not believed as a whole
SHORTEST = 8  # samples: fewer cannot tell noise from motion
REAL = 0.3  # part of a leap that the rotation of the joint has at least
COMES_TO_REST = 0.1  # seconds, for frames that are filled in at an end of the clip
LABEL = "cleaning"


class Cleaned(NamedTuple):
    """What became of F frames of C channels.

    values: (F, C); masked: (F, C) frames that were no motion and were filled in; lost, frozen: (F, C) those of them
    that were missing, or repeated a frame; offsets: parts that were moved back; sigma: (C,) noise; floor: (C,) whether
    noise could be told from motion; cutoff: (C,) cycles a frame at which the usual strength halves an oscillation.
    """

    values: np.ndarray
    masked: np.ndarray
    lost: np.ndarray
    frozen: np.ndarray
    offsets: list[steps.Offset]
    sigma: np.ndarray
    floor: np.ndarray
    cutoff: np.ndarray


def clean(
    values: np.ndarray,
    fps: float,
    groups: Sequence[np.ndarray] | None = None,
    *,
    pools: Sequence[np.ndarray] | None = None,
    body: Body | None = None,
    turns: np.ndarray | None = None,
    strength: float = 1.0,
    limit: float | None = None,
    known: np.ndarray | None = None,
) -> Cleaned:
    """Clean channels (F, C) without jumps of whole turns; NaN where a sample is missing, at least 8 others a channel.

    groups: channels of each joint, judged together (by default each alone); pools: channels of much the same noise
    (all); body: what no motion exceeds (degrees); turns: (groups, F) second difference in degrees of the rotation of
    each joint itself, below 0 where it is not known; strength: counts the degrees of freedom of the smoothing that many
    times; limit: Hz above which nothing is motion; known: (F, C) frames to leave out instead of looking for them.
    """
    y = np.ascontiguousarray(values.T, np.float64)
    lost = ~np.isfinite(y)
    y = bridged(y, lost)
    groups = [np.array([c]) for c in range(len(y))] if groups is None else groups
    pools = [np.arange(len(y))] if pools is None else pools
    body = Body.of_degrees(len(y), fps) if body is None else body
    turns = np.full((len(groups), y.shape[1]), -1.0) if turns is None else turns
    frozen = np.zeros_like(lost)
    for group in groups:
        frozen[group] = artefacts.repeats(y[group])
    zero = frozen & (y == 0)
    middle = np.median(y, axis=1, keepdims=True)
    y -= middle
    raised: list[steps.Offset] = []
    near = None
    if known is None:
        if frozen.any():
            w = (~(lost | frozen)).astype(np.float64)
            at = smoothing.strength(y, w, pools, strength)
            level = np.minimum(at.sigma, artefacts.noise_level(bridged(y, lost | frozen)))  # spikes are still there
            frozen = artefacts.believed(frozen, y, smoothing.fit(y, w, at)[0], level, zero, groups)
        filled = bridged(y, lost | frozen)
        level = artefacts.noise_level(filled)
        displaced = steps.offsets(filled, level, body.sharpest, body.leap, artefacts.GAP)
        raised = [
            part for part in displaced if part.last - part.first > artefacts.GAP and _lasts(part, body, turns, groups)
        ]
        for channel, first, last, by in raised:
            y[channel, first:last] -= by
        leapt = np.zeros_like(lost)  # a few frames at an end of the clip: smoothing fills them in better
        for channel, first, last, _ in (part for part in displaced if part.last - part.first <= artefacts.GAP):
            leapt[channel, first:last] = True
        filled = bridged(y, lost | frozen | leapt)
        moved = sorted({part.channel for part in displaced})
        level[moved] = artefacts.noise_level(filled[moved])
        filled_in = lost | frozen | leapt
        bad, near = _found(y, filled, filled_in, level, groups, pools, body, turns, strength, fps)
        if y.shape[1] >= 2 * SHORTEST:
            near, _ = _strength(filled, bad, pools, strength, near, level)
            certain = sum(len(artefacts.runs(channel)) for channel in frozen)
            given = lost | frozen
            bad = bursts(bridged(y, given), near, bad, given, certain, groups, body, turns)
    else:
        bad = np.ascontiguousarray(known.T) | lost
        frozen &= bad
    progress.advance(LABEL, 3, 4)
    w = (~bad).astype(np.float64)
    at = smoothing.strength(y, w, pools, strength, near)
    softest = 0.0 if limit is None else smoothing.place_of(limit / fps)
    x = smoothing.mixture(y, w, at, fps, softest)
    _damp_ends(x, bad, fps)
    x += middle
    cutoff = smoothing.cutoff(np.maximum(at.place, softest))
    floor = at.free > smoothing.NO_FLOOR
    progress.advance(LABEL, 4, 4)
    return Cleaned(x.T, bad.T, lost.T, (frozen & ~lost).T, raised, at.sigma, floor, cutoff)


def _found(
    y: np.ndarray,
    filled: np.ndarray,
    filled_in: np.ndarray,
    level: np.ndarray,
    groups: Sequence[np.ndarray],
    pools: Sequence[np.ndarray],
    body: Body,
    turns: np.ndarray,
    inflate: float,
    fps: float,
) -> tuple[np.ndarray, Strength]:
    """Frames (C, n) that are no motion, those filled in before among them, and how strongly to smooth the rest.

    filled: y with straight lines over the frames filled_in; level: (C,) its noise, robustly."""
    sigma, base, bad, least = level, np.zeros_like(y), filled_in, artefacts.least_jumps(y, body)
    at: Strength | None = None
    for turn in range(PASSES):
        progress.advance(LABEL, turn + 1, 4)
        candidate = bad | artefacts.candidates(filled - base, np.maximum(sigma, 1e-9), groups, body, fps)
        if at is not None and (candidate == bad).all():
            break
        if at is None:
            at, sigma = _strength(y, candidate, pools, inflate, None, level)
        bad = filled_in
        for _ in range(ROUNDS):
            x, variance = smoothing.fit(y, (~candidate).astype(np.float64), at)
            variance *= at.sigma[:, None] ** 2
            bad = bad | artefacts.verified(y, x, variance, sigma, candidate & ~bad, groups, body, turns, least)
            if (candidate == bad).all():
                break
            candidate = bad | artefacts.cores(y - x, variance, sigma, candidate & ~bad, groups)
        if turn + 1 < PASSES:
            at, sigma = _strength(y, bad, pools, inflate, at, level)
            base = smoothing.fit(y, (~bad).astype(np.float64), at)[0]
    assert at is not None  # PASSES is at least 1
    return bad, at


def _strength(
    y: np.ndarray,
    bad: np.ndarray,
    pools: Sequence[np.ndarray],
    inflate: float,
    near: Strength | None,
    level: np.ndarray,
) -> tuple[Strength, np.ndarray]:
    """The strength without bad frames, and the noise that goes with it, which the robust level keeps in bounds."""
    at = smoothing.strength(y, (~bad).astype(np.float64), pools, inflate, near)
    return at, np.clip(at.sigma, 0.4 * level, 2 * level + 1e-9)


def _lasts(part: steps.Offset, body: Body, turns: np.ndarray, groups: Sequence[np.ndarray]) -> bool:
    """Whether a displaced part is to be moved back: it is far, and the joint leaps, not just its notation."""
    turn = turns[next(g for g, group in enumerate(groups) if part.channel in group)]
    ends = [at for at in (part.first, part.last) if 0 < at < len(turn)]
    leaps = all(turn[at - 1 : at + 1].max() >= REAL * abs(part.by) or turn[at] < 0 for at in ends)
    return leaps and abs(part.by) >= body.shift[part.channel]


def _damp_ends(x: np.ndarray, bad: np.ndarray, fps: float) -> None:
    """Frames before the first good one, and after the last, go on from there and come to rest: nothing says how the
    motion went, and a polynomial runs away."""
    for c in np.flatnonzero(bad[:, 0] | bad[:, -1]):
        good = np.flatnonzero(~bad[c])
        for edge, inner, away in ((good[0], good[0] + 1, -1), (good[-1], good[-1] - 1, 1)):
            frames = np.arange(edge + away, -1 if away < 0 else x.shape[1], away)
            slope = x[c, edge] - x[c, inner]
            x[c, frames] = x[c, edge] + slope * COMES_TO_REST * fps * -np.expm1(
                -np.abs(frames - edge) / (COMES_TO_REST * fps)
            )


def bridged(y: np.ndarray, bad: np.ndarray) -> np.ndarray:
    """Straight lines (C, n) over the bad frames; a channel without good ones stays."""
    out, frames = y.copy(), np.arange(y.shape[1])
    for c in np.flatnonzero(bad.any(1) & ~bad.all(1)):
        out[c, bad[c]] = np.interp(frames[bad[c]], frames[~bad[c]], y[c, ~bad[c]])
    return out
