"""Frames that are no motion: spikes, bursts, flips, dropouts. Channels (C, n), a joint's channels judged together."""

from __future__ import annotations

from collections.abc import Sequence
from math import comb
from typing import NamedTuple

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from . import _paths, _verdict
from ._quantiles import median_of_windows, quantile

ORDERS = (3, 4, 5, 6)  # differences that noise is read from: a low one still sees motion, a high one only noise
GAP, EACH, ENTRY, CAP = 12, 1.2, 8.0, 14.0  # frames a path may skip at once, its costs, and the most a turn costs
END = 6  # frames it may skip at an end of the clip
TRIGGER = 4.0  # standard deviations of the second difference
LEAST, MOST = 3, 30  # frames that repeat: a dropout
VISIBLE = 2.0  # standard deviations of noise that a frozen joint is off at least
COARSE = 3.0  # steps of its resolution that it is off at least
HELD = 0.3  # of all frames repeat: the channel is stored coarsely, no dropout
SHARPEST = 1e5  # degrees/s2 that no joint exceeds: kicks and impacts of people stay below
LEAP = 250.0  # degrees/s: slower jumps are no artefacts
SHIFT = 10.0  # degrees: a channel that is displaced by less stays where it is
LEVER = 0.5  # metres: what an angle comes to in space
USUAL = 0.95  # part of a channel's frame steps: jumps below are no artefacts either
AWAY = 0.3  # seconds that a curve may be away between two impossible turns
LOCAL = 0.5  # seconds of motion that tell how curved it is here


class Body(NamedTuple):
    """What bodies do, in a channel's unit and frames. sharpest: (C,) second difference that no motion exceeds;
    leap: (C,) frame step below which nothing is called an artefact; shift: (C,) below which nothing is moved back."""

    sharpest: np.ndarray
    leap: np.ndarray
    shift: np.ndarray

    @classmethod
    def of_degrees(cls, channels: int, fps: float) -> Body:
        """For channels of angles."""
        return cls(*(np.full(channels, limit) for limit in (SHARPEST / fps**2, LEAP / fps, SHIFT)))

    def in_lengths(self, lengths: np.ndarray, metres: float | None) -> Body:
        """The same where (C,) `lengths` are positions, in units of so many metres; None: bodies of unknown size."""
        lever = np.inf if metres is None else np.radians(LEVER) / metres
        return Body(*(np.where(lengths, angle * lever, angle) for angle in self))


def noise_level(y: np.ndarray) -> np.ndarray:
    """Standard deviation (C,) of white noise, robustly: the least over orders p of 1.4826 MAD(p-th difference) over
    sqrt(C(2p, p))."""
    least = np.full(len(y), np.inf)
    differences = y
    for order in range(1, max(ORDERS) + 1):
        differences = np.diff(differences, axis=1)
        if order in ORDERS and y.shape[1] > 3 * order:
            spread = 1.4826 * quantile(np.abs(differences), 0.5)
            least = np.minimum(least, spread / np.sqrt(comb(2 * order, order)))
    return np.where(np.isfinite(least), least, 0.0)


def repeats(y: np.ndarray) -> np.ndarray:
    """Frames (n,) in runs that repeat the frame before exactly, in every channel of the joint that moves at all."""
    bad = np.zeros(y.shape[1], bool)
    live = y[np.ptp(y, axis=1) > 0]
    if not len(live):
        return bad
    same = np.concatenate(([False], (np.diff(live, axis=1) == 0).all(0)))
    if same.mean() > HELD:
        return bad
    for a, b in runs(same):
        if LEAST - 1 <= b - a <= MOST:
            bad[a:b] = True
            bad[a - 1] |= bool((live[:, a - 1] == 0).all())  # zeroed: its first frame repeats nothing
    return bad


def believed(
    frozen: np.ndarray,
    y: np.ndarray,
    x: np.ndarray,
    sigma: np.ndarray,
    zero: np.ndarray,
    groups: Sequence[np.ndarray],
) -> np.ndarray:
    """Of the frozen runs (C, n) those where the joint leaps visibly, by more than noise and the steps that its samples
    are stored in; what rests may well repeat itself.

    Where it is zero (C, n) the fit x without the run has to be the simpler curve too, swinging less about the chord
    than the joint leaps: a knee that is stopped at zero for long leaves a gap that no curve crosses well."""
    out = frozen.copy()
    for group in groups:
        least = max(VISIBLE * np.linalg.norm(sigma[group]), COARSE * np.linalg.norm(_resolution(y[group])))
        for a, b in runs(frozen[group].any(0)):
            if a == 0 or b == y.shape[1]:
                continue
            along = np.arange(1, b - a + 1) / (b - a + 1)
            chord = y[group, a - 1, None] + (y[group, b] - y[group, a - 1])[:, None] * along
            swing, leap = np.abs(x[group, a:b] - chord).max(1), np.abs(y[group, a:b] - chord).max(1)
            stopped = zero[group, a:b].all() and np.linalg.norm(leap) < np.linalg.norm(swing)
            if stopped or np.linalg.norm(leap) < least:
                out[group, a:b] = False
    return out


def _resolution(y: np.ndarray) -> np.ndarray:
    """(C,) the step that samples are stored in, if it is a coarse one: what nearly all frame steps but 0 exceed."""
    steps = np.abs(np.diff(y, axis=1))
    return np.array([np.quantile(some[some > 0], 0.01) if (some > 0).any() else 0.0 for some in steps])


def runs(marked: np.ndarray) -> list[tuple[int, int]]:
    """[(first, one after last)] of the runs of True."""
    edges = np.diff(np.concatenate(([0], marked.astype(np.int8), [0])))
    return list(zip(np.flatnonzero(edges == 1).tolist(), np.flatnonzero(edges == -1).tolist(), strict=True))


def candidates(y: np.ndarray, sigma: np.ndarray, groups: Sequence[np.ndarray], body: Body, fps: float) -> np.ndarray:
    """Frames (C, n) that the cheapest smooth path leaves out, the same for all channels of a joint. y: minus a fit."""
    skipped = np.zeros(y.shape, bool)
    n = y.shape[1]
    if n < 8:
        return skipped
    bend = np.zeros_like(y)
    bend[:, 1:-1] = y[:, 2:] - 2 * y[:, 1:-1] + y[:, :-2]
    noise = np.maximum(sigma, 1e-9) ** 2
    motion = motion_variance(bend, noise, body.sharpest[:, None], fps)
    strange = np.abs(bend) > TRIGGER * np.sqrt(6 * noise[:, None] + motion)
    impossible = np.abs(bend) > body.sharpest[:, None] + 6 * np.sqrt(6 * noise[:, None])
    for group in groups:
        hot = np.flatnonzero(strange[group].any(0))
        if not len(hot):
            continue
        here, told = np.ascontiguousarray(y[group].T), np.ascontiguousarray(motion[group].T)
        marks = np.zeros(n, bool)
        for part in np.split(hot, np.flatnonzero(np.diff(hot) > GAP + 6) + 1):
            first, last = max(0, part[0] - GAP - 4), min(n - 1, part[-1] + GAP + 4)
            _paths.skip(here, noise[group], told, first, last, GAP, END, EACH, ENTRY, CAP, marks)
        _paths.excursions(y[group], impossible[group], round(AWAY * fps), marks)
        skipped[group] = marks
    return skipped


def motion_variance(bend: np.ndarray, noise: np.ndarray, sharpest: np.ndarray, fps: float) -> np.ndarray:
    """Variance (C, n) of the second difference that is motion: the local one, at least that of the clip's tail."""
    size = np.abs(bend)
    size = np.where(size > sharpest, 0.0, size)  # no motion: it must not make others look like motion
    local = 1.4826 * _local_median(size, max(9, round(fps * LOCAL) | 1))
    size = size[:, 1:-1]
    tail = np.minimum(quantile(size, 0.9) / 1.645, 4 * 1.4826 * quantile(size, 0.5))[:, None]
    return np.maximum(np.maximum(local, tail) ** 2 - 6 * noise[:, None], 1e-6 + (0.05 * tail) ** 2)


def _local_median(a: np.ndarray, width: int) -> np.ndarray:
    """Medians over blocks of about width frames, every half width, and straight lines between."""
    n = a.shape[1]
    half = max(1, min(width // 2, n))
    padded = np.pad(a, ((0, 0), (half, half)), constant_values=np.nan)
    medians = median_of_windows(sliding_window_view(padded, 2 * half + 1, axis=1)[:, ::half])
    blocks = medians.shape[1]
    place = np.minimum(np.arange(n) / half, blocks - 1)
    left = np.minimum(place.astype(int), max(blocks - 2, 0))
    right = np.minimum(left + 1, blocks - 1)
    return medians[:, left] + (medians[:, right] - medians[:, left]) * (place - left)


def least_jumps(y: np.ndarray, body: Body) -> np.ndarray:
    """(C,) jumps below which nothing is called an artefact."""
    return np.minimum(body.leap, quantile(np.abs(np.diff(y, axis=1)), USUAL))


def verified(
    y: np.ndarray,
    x: np.ndarray,
    variance: np.ndarray,
    sigma: np.ndarray,
    candidate: np.ndarray,
    groups: Sequence[np.ndarray],
    body: Body,
    turns: np.ndarray,
    least: np.ndarray,
) -> np.ndarray:
    """Of the candidate frames (C, n) those that are artefacts; x, variance: fit and its variance without candidates;
    turns (groups, n): second difference of a joint's rotation itself, below 0 where there is no such thing; least (C,):
    `least_jumps`."""
    out = np.zeros(y.shape, bool)
    for group, turn in zip(groups, turns, strict=True):
        together = candidate[group].any(0)
        if together.any():
            marks = np.zeros((len(group), y.shape[1]), bool)
            data = (y[group], x[group], variance[group], sigma[group])
            _verdict.judge(*data, together, turn, body.sharpest[group], least[group], marks)
            out[group] = marks
    return out


def cores(
    off: np.ndarray, variance: np.ndarray, sigma: np.ndarray, candidate: np.ndarray, groups: Sequence[np.ndarray]
) -> np.ndarray:
    """The one or two frames about the largest deviation of each candidate run; the path may have left out good ones."""
    out = np.zeros(off.shape, bool)
    for group in groups:
        together = candidate[group].any(0)
        if together.any():
            marks = np.zeros(off.shape[1], bool)
            _verdict.core(off[group], variance[group], sigma[group], together, marks)
            out[group] = marks
    return out
