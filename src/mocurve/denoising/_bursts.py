"""Runs of a channel that are foreign, one after the other: the one that most speaks for, then what is left."""

from __future__ import annotations

import numpy as np

from .._jit import kernel
from ._evidence import LONGEST, NEVER, REACH, VISIBLE, evidence, root

BURST, SHORT = 10, 2  # frames: longest run looked for; runs that the search finds well, so that one more is in doubt
DOUBT = 1.0  # log odds against such a run
FOUND = 3.0  # log odds that the search has found a run
HOT = 2.5  # usual deviations of a leap, from where a run may begin or end
PART, SEEN = 0.15, 3.0  # of a run's largest deviation, of noise: frames that are off by less are good ones between two


@kernel
def pursue(y, sigma, smoothing, usual, believed, unit, found, left_out):
    """Adds to left_out (n,) the frames of a channel y (n,) that are foreign; found (n,): what the search says they are.

    usual: standard deviation of the leap between two frames, as the third difference tells it; believed: log odds;
    unit: one degree in the channel's unit."""
    n, factor, off = len(y), root(smoothing), np.empty(LONGEST)
    keep_long(found, left_out)
    given = left_out.copy()
    starts, ends = pairs(y, max(HOT * usual, 0.5 * VISIBLE * sigma), found, given)
    odds = np.empty(len(starts))
    for k in range(len(starts)):
        odds[k] = weigh(y, sigma, factor, starts[k], ends[k], left_out, unit, believed, found, off)
    while len(odds):
        best = np.argmax(odds)
        if odds[best] <= believed:
            break
        p, q = starts[best], ends[best]
        evidence(y, sigma, factor, p, q, left_out, unit, off)
        least = max(SEEN * sigma, PART * np.abs(off[: q - p]).max())
        for i in range(p, q):
            left_out[i] = found[i] or abs(off[i - p]) > least
        odds[best] = NEVER
        for k in range(len(odds)):
            if starts[k] < q + REACH and p < ends[k] + REACH and odds[k] > NEVER:
                if left_out[starts[k] : ends[k]].any():
                    odds[k] = NEVER
                else:
                    again = weigh(y, sigma, factor, starts[k], ends[k], left_out, unit, believed, found, off)
                    odds[k] = max(again, NEVER + 1.0)
    i = 0
    while i < n:  # each again, now that all others are known
        j = i
        while j < n and left_out[j] and not given[j]:
            j += 1
        if j > i:
            left_out[i:j] = False
            fits = j - i <= LONGEST and (found[i:j].all() or (i >= 2 and j <= n - 2))
            left_out[i:j] = (
                fits and weigh(y, sigma, factor, i, j, left_out, unit, believed, found, off) > believed
            )
        i = j + 1
    i = 0
    while i < n:
        j = i
        while j < n and found[j] and not given[j]:
            j += 1
        if j > i and not left_out[i:j].any():
            new = False
            for k in range(max(0, i - REACH), min(n, j + REACH)):
                new = new or (left_out[k] and not found[k] and not given[k])
            if not new:
                odds_now = evidence(y, sigma, factor, i, j, left_out, unit, off)
                left_out[i:j] = odds_now == NEVER or odds_now > -FOUND
        i = j + 1


@kernel
def keep_long(found, left_out):
    """Leaves out what is too long to be weighed."""
    i, n = 0, len(found)
    while i < n:
        j = i
        while j < n and found[j]:
            j += 1
        if j - i > LONGEST:
            left_out[i:j] = True
        i = j + 1


@kernel
def weigh(y, sigma, factor, p, q, left_out, unit, believed, found, off):
    """Log odds of a run, what the search says counted in."""
    odds = evidence(y, sigma, factor, p, q, left_out, unit, off)
    if found[p:q].all():
        return max(odds + believed + FOUND, NEVER + 1.0)  # it is asked again
    if odds == NEVER:
        return odds
    return odds - DOUBT if q - p <= SHORT else odds


@kernel
def pairs(y, least, found, given):
    """First frames, and frames after the last, of all runs between two leaps of the channel, and of those found."""
    n = len(y)
    hot = np.zeros(n + 1, np.bool_)
    for i in range(n + 1):
        if 2 <= i < n - 1:
            hot[i] = 0.5 * abs(y[i + 1] - 3.0 * y[i] + 3.0 * y[i - 1] - y[i - 2]) > least
        if 0 < i < n:
            hot[i] = hot[i] or given[i] != given[i - 1]
        hot[i] = hot[i] or (i < n and found[i]) != (i > 0 and found[i - 1])
    total = 0
    for last in range(2):
        count = 0
        if last:
            starts, ends = np.empty(total, np.int64), np.empty(total, np.int64)
        for p in range(n):
            if not hot[p]:
                continue
            for q in range(p + 1, min(n, p + LONGEST) + 1):
                if given[q - 1]:
                    break
                if hot[q] and (found[p:q].all() or (p >= 2 and q <= n - 2 and q - p <= BURST)):
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
