"""Runs of a channel that are foreign, one after the other: the one that most speaks for, then what is left."""

from __future__ import annotations

import numpy as np

from .._jit import kernel
from ._evidence import LONGEST, NEVER, REACH, VISIBLE, evidence, root

BURST, SHORT = 10, 2  # frames: longest run looked for; runs that the search finds well, so that one more is in doubt
DOUBT = 1.0  # log odds
HOT = 2.5  # usual deviations of a leap, from where a run may begin or end
PART, SEEN = 0.15, 3.0  # of a run's largest deviation, of noise: frames that are off by less are good ones between two


@kernel
def pursue(y, sigma, smoothing, usual, believed, unit, left_out):
    """Adds to left_out (n,) the frames of a channel y (n,) that are foreign.

    usual: standard deviation of the leap between two frames, as the third difference tells it; believed: log odds;
    unit: one degree in the channel's unit."""
    n, factor, off = len(y), root(smoothing), np.empty(LONGEST)
    given = left_out.copy()
    starts, ends = pairs(y, max(HOT * usual, 0.5 * VISIBLE * sigma), given)
    odds = np.empty(len(starts))
    for k in range(len(starts)):
        odds[k] = doubted(y, sigma, factor, starts[k], ends[k], left_out, unit, off)
    while len(odds):
        best = np.argmax(odds)
        if odds[best] <= believed:
            break
        p, q = starts[best], ends[best]
        evidence(y, sigma, factor, p, q, left_out, unit, off)
        least = max(SEEN * sigma, PART * np.abs(off[: q - p]).max())
        for i in range(p, q):
            left_out[i] = abs(off[i - p]) > least
        odds[best] = NEVER
        for k in range(len(odds)):
            if starts[k] < q + REACH and p < ends[k] + REACH and odds[k] > NEVER:
                taken = left_out[starts[k] : ends[k]].any()
                again = NEVER if taken else doubted(y, sigma, factor, starts[k], ends[k], left_out, unit, off)
                odds[k] = NEVER if taken else max(again, NEVER + 1.0)
    i = 0
    while i < n:  # each again, now that all others are known
        j = i
        while j < n and left_out[j] and not given[j]:
            j += 1
        if j > i:
            left_out[i:j] = False
            short = i >= 2 and j <= n - 2 and j - i <= LONGEST
            left_out[i:j] = short and doubted(y, sigma, factor, i, j, left_out, unit, off) > believed
        i = j + 1


@kernel
def doubted(y, sigma, factor, p, q, left_out, unit, off):
    """Log odds of a run that nothing found before."""
    return evidence(y, sigma, factor, p, q, left_out, unit, off) - (DOUBT if q - p <= SHORT else 0.0)


@kernel
def pairs(y, least, given):
    """First frames, and frames after the last, of all runs between two leaps of the channel."""
    n = len(y)
    hot = np.zeros(n, np.bool_)
    for i in range(2, n - 1):
        leap = 0.5 * abs(y[i + 1] - 3.0 * y[i] + 3.0 * y[i - 1] - y[i - 2])
        hot[i] = leap > least or given[i] != given[i - 1]
    total = 0
    for last in range(2):
        count = 0
        if last:
            starts, ends = np.empty(total, np.int64), np.empty(total, np.int64)
        for p in range(2, n - 1):
            if not hot[p]:
                continue
            for q in range(p + 1, min(n - 2, p + BURST) + 1):
                if given[q - 1]:
                    break
                if hot[q]:
                    if last:
                        starts[count], ends[count] = p, q
                    count += 1
        total = count
    return starts, ends


@kernel
def beside(y, sigma, smoothing, believed, unit, others, left_out):
    """Adds to left_out (n,) those of the runs in others (n,) that this channel of the joint takes part in."""
    n, factor, off = len(y), root(smoothing), np.empty(LONGEST)
    i = 0
    while i < n:
        j = i
        while j < n and others[j]:
            j += 1
        if j > i and i >= 2 and j <= n - 2 and j - i <= LONGEST and not left_out[i:j].any():
            left_out[i:j] = evidence(y, sigma, factor, i, j, left_out, unit, off) > believed
        i = j + 1


@kernel
def odds(y, sigma, smoothing, p, q, left_out, unit):
    """Log odds of one run."""
    return evidence(y, sigma, root(smoothing), p, q, left_out, unit, np.empty(LONGEST))
