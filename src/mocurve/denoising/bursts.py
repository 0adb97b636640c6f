"""Runs of frames that leap out of the motion and back, told from kicks by the weight of evidence."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from . import _bursts, _verdict
from ._quantiles import quantile
from .artefacts import SHIFT, Body, runs
from .smoothing import Strength

FIRST = 2.0  # log odds that a run is foreign before it is looked at, for a first round
RARE = 0.01  # of the runs that are weighed the foreign ones, where a clip shows none; counts as one run
LEAD = 2.0  # log odds that do not count when the foreign ones are
BESIDE = -3.0  # next to a channel of the joint that is believed
LEAST_NOISE = 1e-6  # degrees
STEPS = 30  # of the maximisation


def bursts(
    y: np.ndarray,
    at: Strength,
    bad: np.ndarray,
    given: np.ndarray,
    certain: int,
    groups: Sequence[np.ndarray],
    body: Body,
    turns: np.ndarray,
) -> np.ndarray:
    """Frames (C, n) that the evidence calls bad: the given ones, of those that the search calls bad all that are no
    motion after all, and runs that it overlooked.

    What else a clip holds tells what to think of a doubtful run: beside many that are certainly foreign it is believed,
    and in a clip without any other it is not, for most likely it is a kick.
    at: strengths without the bad ones; certain: runs, found otherwise, that are no motion; turns (groups, n): second
    difference of a joint's rotation itself, without which only its notation leaps."""
    units = body.shift / SHIFT
    found = bad & ~given
    sigma = np.maximum(at.sigma, LEAST_NOISE * units)
    usual = 0.5 * 1.4826 * quantile(np.abs(np.diff(y, 3, axis=1)), 0.5)

    def weighed(prior: float) -> np.ndarray:
        left_out = given.copy()
        for c in range(len(y)):
            _bursts.pursue(y[c], sigma[c], at.smoothing[c], usual[c], units[c], prior, found[c], left_out[c])
        return left_out

    out, odds = weighed(FIRST), np.empty_like(y)
    for c in range(len(y)):
        marked = (out[c] | found[c]) & ~given[c]
        _bursts.odds_of(y[c], sigma[c], at.smoothing[c], units[c], marked, out[c], odds[c])
    out = weighed(usual_odds(odds[np.isfinite(odds)], certain))
    new = out & ~bad
    for group, turn in zip(groups, turns, strict=True):
        together = new[group].any(0)
        for c in group if together.any() else ():
            others = together & ~new[c]
            _bursts.beside(y[c], sigma[c], at.smoothing[c], BESIDE, units[c], others, out[c])
        for c in group:
            for p, q in runs(out[c] & ~bad[c]):
                out[c, p:q] = not _verdict.only_notation(y[c], turn, p, q)
    return out


def usual_odds(odds: np.ndarray, certain: int) -> float:
    """Log odds that a run of this clip is foreign before it is looked at: the part of the foreign among those with
    these odds and some that are certain, by expectation and maximisation, which begins with a clip without any."""
    part = RARE
    for _ in range(STEPS):
        foreign = 1 / (1 + np.exp(LEAD - odds - np.log(part / (1 - part))))
        part = (RARE + certain + foreign.sum()) / (1 + certain + len(odds))
    return float(np.log(part / (1 - part)))
