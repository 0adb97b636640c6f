"""Smoothing that finds its own strength: channels (C, n) on a uniform grid, frames with weight 0 are filled in."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from . import _mixture as kernels

STEP = 1.5  # of log lambda, between neighbours of the grid
GRID = np.exp(np.arange(-12.0, 25.0, STEP))  # stronger ones are lost in rounding
SOFTEST = 3  # first strength that cross-validation may choose: log lambda -7.5
WALK = 3  # strengths tried on both sides of a known one
BELOW, ABOVE = 6.0, 3.0  # strengths mixed around the chosen one, in steps
TEMPERATURE, PRIOR = 1.4, 0.8  # of the mixture's weights
REACH = 0.12  # seconds of risk around a frame
POOL = 4  # channels that can tell what is usual
SILENT = 1e-9  # noise below it is rounding
PULL, ALIKE, FAR = 8.0, 0.1, 4.0  # of the pull: its weight, the least spread of log noise, where it levels off
NO_FLOOR = 0.05  # freedom: with less left to noise, noise and motion could not be told apart
CHUNK = 16  # channels at a time, so that what the kernels hold stays small


class Strength(NamedTuple):
    """What cross-validation chose. place: (C,) on GRID, between its points; sigma: (C,) standard deviation of noise;
    free: (C,) part of the samples' freedom that the curve leaves to noise."""

    place: np.ndarray
    sigma: np.ndarray
    free: np.ndarray

    @property
    def smoothing(self) -> np.ndarray:
        """(C,) lambda."""
        return np.exp(np.log(GRID[0]) + STEP * self.place)


def strength(
    y: np.ndarray, w: np.ndarray, pools: Sequence[np.ndarray], inflate: float = 1.0, near: Strength | None = None
) -> Strength:
    """The strength with the least generalised cross-validation score (Craven and Wahba 1979) on the kept frames.

    pools: channels whose noise is much the same, as that of all rotations of a capture: the score of each is pulled
    towards the noise that is usual there, which saves short clips from the wide spread of cross-validation.
    inflate: counts the smoother's degrees of freedom that many times; above 1 smooths more (Kim and Gu 2004).
    near: what is known to be about right; only its surroundings are searched."""
    channels, size, at = len(y), len(GRID), np.arange(len(GRID))
    squares, traces = np.full((2, channels, size), np.nan)
    gaps, kept = (w == 0).any(1), w.sum(1)[:, None]
    low, high = np.full(channels, SOFTEST), np.full(channels, size - 1)
    if near is not None:
        low, high = (np.rint(near.place).astype(int) + side for side in (-WALK, WALK))
        low, high = np.clip(low, SOFTEST, size - 1), np.clip(high, SOFTEST, size - 1)
    usual = None if near is None else _usual(np.log(near.sigma), pools)
    while True:
        missing = np.isnan(squares) & (at >= low[:, None]) & (at <= high[:, None])
        if not missing.any():
            break
        rows = np.lexsort((low, gaps))  # those that go side by side in the kernels want the same strengths
        rows = rows[missing[rows].any(1)]
        part = squares[rows], traces[rows]
        kernels.scores(y[rows], w[rows], gaps[rows], GRID, missing[rows], *part)
        squares[rows], traces[rows] = part
        spread = _noise(squares, traces, kept)
        score = _score(squares, traces, kept, inflate)
        if usual is None:
            best = np.nanargmin(score, 1)
            usual = _usual(spread[np.arange(channels), best], pools)
        score += _pull(spread, usual) / kept
        best = np.nanargmin(score, 1)
        low = np.where((best == low) & (low > SOFTEST), low - WALK, low).clip(SOFTEST)
        high = np.where((best == high) & (high < size - 1), high + WALK, high).clip(max=size - 1)
    row = np.arange(channels)
    return Strength(_vertex(score, best), np.exp(spread[row, best]), 1 - traces[row, best] / kept[:, 0])


def _noise(squares: np.ndarray, traces: np.ndarray, kept: np.ndarray) -> np.ndarray:
    """Log of the standard deviation of noise that each strength leaves as residual."""
    return 0.5 * np.log(np.maximum(squares, 1e-200) / np.maximum(kept - traces, 1e-9))


def _usual(noise: np.ndarray, pools: Sequence[np.ndarray]) -> np.ndarray:
    """(2, C) the usual log noise in the pool of each channel, and how far channels are from it; NaN where nothing is
    usual."""
    usual = np.full((2, len(noise)), np.nan)
    for pool in pools:
        live = noise[pool][noise[pool] > np.log(SILENT)]
        if len(live) >= POOL:
            middle = np.median(live)
            usual[0, pool] = middle
            usual[1, pool] = np.hypot(ALIKE, 1.4826 * np.median(np.abs(live - middle)))
    usual[:, noise <= np.log(SILENT)] = np.nan
    return usual


def _pull(noise: np.ndarray, usual: np.ndarray) -> np.ndarray:
    """What a score gets for noise that is unusual: the square of the distance, levelling off for a channel that is
    plainly another."""
    away = ((noise - usual[0][:, None]) / usual[1][:, None]) ** 2
    return np.nan_to_num(PULL * away / (1 + away / FAR))


def _score(squares: np.ndarray, traces: np.ndarray, kept: np.ndarray, inflate: float) -> np.ndarray:
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.log(np.maximum(squares, 1e-300) / kept) - 2 * np.log(np.maximum(1 - inflate * traces / kept, 1e-9))


def _vertex(score: np.ndarray, best: np.ndarray) -> np.ndarray:
    """Where the parabola through the best strength and its two neighbours is lowest."""
    row = np.arange(len(best))
    inside = (best > SOFTEST) & (best < score.shape[1] - 1)
    left, right = (score[row, np.clip(best + side, 0, score.shape[1] - 1)] for side in (-1, 1))
    bend = left + right - 2 * score[row, best]
    with np.errstate(divide="ignore", invalid="ignore"):
        shift = np.where(inside & (bend > 0), 0.5 * (left - right) / bend, 0.0)
    return best + np.clip(np.nan_to_num(shift), -0.5, 0.5)


def fit(y: np.ndarray, w: np.ndarray, at: Strength) -> tuple[np.ndarray, np.ndarray]:
    """One fit a channel, (C, n), and the variance of its values over that of the noise."""
    x, variance = np.empty_like(y), np.empty_like(y)
    kernels.fit(y, w, at.smoothing, x, variance)
    return x, variance


def mixture(y: np.ndarray, w: np.ndarray, at: Strength, fps: float, softest: float) -> np.ndarray:
    """The final curves (C, n): strengths mixed frame by frame, so that kicks stay sharp while rest is smoothed.

    softest: place on GRID below which no strength may be."""
    x = np.empty_like(y)
    reach = max(5, round(REACH * fps))
    gaps = (w == 0).any(1)
    centre = np.maximum(at.place, np.ceil(softest))
    order = np.lexsort((centre, gaps))  # those that go side by side in the kernels use the same strengths
    for some in np.split(order, range(CHUNK, len(y), CHUNK)):
        weights, part = (BELOW, ABOVE, at.sigma[some], reach, TEMPERATURE, PRIOR), np.empty((len(some), y.shape[1]))
        kernels.mix(y[some], w[some], gaps[some], GRID, int(np.ceil(softest)), centre[some], *weights, part)
        x[some] = part
    return x


def place_of(frequency: float) -> float:
    """The place on GRID of the strength that halves an oscillation of this frequency (per frame, below 1/2)."""
    strongest = len(GRID) - 1.0
    return float(np.clip((-6 * np.log(2 * np.sin(np.pi * frequency)) - np.log(GRID[0])) / STEP, 0.0, strongest))


def cutoff(place: np.ndarray) -> np.ndarray:
    """Frequency per frame that the strength halves; 1/2 where it halves none."""
    strength = GRID[0] * np.exp(STEP * place)
    return np.arcsin(np.minimum(1.0, 0.5 * strength ** (-1 / 6))) / np.pi
