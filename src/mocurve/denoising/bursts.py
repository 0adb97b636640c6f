"""Runs of frames that leap out of the motion and back, told from kicks by the weight of evidence."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from . import _bursts, _verdict
from ._quantiles import quantile
from .artefacts import SHIFT, Body, runs
from .smoothing import Strength

import os
EC=float(os.environ.get("EC","4"))
PA,PN,TN,TF,GIV=(float(x) for x in os.environ.get('PP','.05,1,3.5,0,1').split(','))
BELIEVED = 1.5  # log odds of a run
BESIDE = -3.0  # next to a channel of the joint that is believed
LEAST_NOISE = 1e-6  # degrees


def bursts(
    y: np.ndarray,
    at: Strength,
    bad: np.ndarray,
    given: np.ndarray,
    groups: Sequence[np.ndarray],
    body: Body,
    turns: np.ndarray,
) -> np.ndarray:
    """Frames (C, n) that the evidence calls bad: the given ones, of those that the search calls bad all that are no
    motion after all, and runs that it overlooked.

    at: strengths without the bad ones; turns (groups, n): second difference of a joint's rotation itself, without which
    only its notation leaps."""
    out, units = given.copy(), body.shift / SHIFT
    found = bad & ~given
    sigma = np.maximum(at.sigma, LEAST_NOISE * units)
    usual = 0.5 * 1.4826 * quantile(np.abs(np.diff(y, 3, axis=1)), 0.5)
    for c in range(len(y)):
        _bursts.pursue(y[c], sigma[c], at.smoothing[c], usual[c], BELIEVED, units[c], found[c], out[c], 3.0)
    odds = np.empty_like(y)
    for c in range(len(y)):
        _bursts.odds_of(y[c], sigma[c], at.smoothing[c], units[c], (out[c]|found[c])&~given[c], out[c], odds[c])
    L = odds[np.isfinite(odds)]
    G = GIV*sum(len(runs(one)) for one in given)
    pi = PA
    for _ in range(30):
        pi = (PA*PN + G + (1/(1+np.exp(EC-L - np.log(pi/(1-pi))))).sum())/(PN+G+len(L))
    prior = np.log(pi/(1-pi))
    out = given.copy()
    for c in range(len(y)):
        _bursts.pursue(y[c], sigma[c], at.smoothing[c], usual[c], TN-prior, units[c], found[c], out[c], prior-TF)
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
