"""Runs of a channel that are foreign, one after the other: the one that most speaks for, then what is left."""

from __future__ import annotations

import numpy as np

from .._jit import kernel
from ._evidence import LONGEST, NEVER, ONE_SIDED, REACH, VISIBLE, evidence, root

BURST = 10  # frames that a run has at most unless the search found it
NEW = 2.5  # log odds that a run which the search overlooked is short of
HOT = 2.5  # usual deviations of a leap, from where a run may begin or end
PART, SEEN = 0.15, 3.0  # of a run's largest deviation, of noise: frames that are off by less are good ones between two


@kernel
def pursue(y, sigma, smoothing, usual, unit, prior, found, left_out):
    """Adds to left_out (n,) the frames of a channel y (n,) that are foreign; found (n,): those that a search proposes.

    usual: standard deviation of the leap between two frames, as the third difference tells it; unit: one degree in the
    channel's unit; prior: log odds that a run is foreign before it is looked at."""
    data = y, sigma, root(smoothing), unit, prior, found
    given = left_out.copy()
    keep_long(found, given)
    left_out[:] = given
    best_first(data, max(HOT * usual, 0.5 * VISIBLE * sigma), given, left_out)
    ask_again(data, given, left_out)
    among_found(data, given, left_out)


@kernel
def keep_long(found, given):
    """Adds to given what is too long to be weighed."""
    i, n = 0, len(found)
    while i < n:
        j = i
        while j < n and found[j]:
            j += 1
        if j - i > LONGEST:
            given[i:j] = True
        i = j + 1


@kernel
def best_first(data, least, given, left_out):
    """Leaves out the run with the highest odds, weighs those around it again, and so on."""
    y, sigma, factor, unit, _, found = data
    starts, ends = pairs(y, least, found, given)
    odds, off = np.empty(len(starts)), np.empty(LONGEST)
    for k in range(len(starts)):
        odds[k] = weigh(data, starts[k], ends[k], left_out)
    while len(odds):
        best = np.argmax(odds)
        if odds[best] <= 0.0:
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
                    odds[k] = max(weigh(data, starts[k], ends[k], left_out), NEVER + 1.0)


@kernel
def weigh(data, p, q, left_out):
    """Log odds of a run, prior and search counted in."""
    y, sigma, factor, unit, prior, found = data
    off = np.empty(LONGEST)
    odds = evidence(y, sigma, factor, p, q, left_out, unit, off)
    if not found[p:q].all():
        return odds + prior - NEW if odds > ONE_SIDED else odds
    first, last = p, q
    while first > 0 and found[first - 1]:
        first -= 1
    while last < len(y) and found[last]:
        last += 1
    near = slice(max(0, first - REACH), min(len(y), last + REACH))
    if (found[near] & ~left_out[near]).sum() > last - first:  # others may hide it
        others = left_out | found
        others[first:last] = left_out[first:last]
        odds = max(odds, evidence(y, sigma, factor, p, q, others, unit, off))
    return max(odds + prior, NEVER + 1.0)  # what hides it now may be left out later


@kernel
def ask_again(data, given, left_out):
    """Takes back runs that are not believed now that all others are known."""
    found = data[5]
    i, n = 0, len(left_out)
    while i < n:
        j = i
        while j < n and left_out[j] and not given[j]:
            j += 1
        if j > i:
            left_out[i:j] = False
            fits = j - i <= LONGEST and (found[i:j].all() or (i >= 2 and j <= n - 2))
            left_out[i:j] = fits and weigh(data, i, j, left_out) > 0.0
        i = j + 1


@kernel
def among_found(data, given, left_out):
    """Leaves out runs, or what is left of them, that the search found and that hid one another, and such as leap but on
    one side where most runs are foreign, unless what is new nearby explains them."""
    y, sigma, factor, unit, prior, found = data
    all_found = left_out | found
    i, n = 0, len(y)
    while i < n:
        j = i
        while j < n and found[j] and not left_out[j]:
            j += 1
        near = slice(max(0, i - REACH), min(n, j + REACH))
        if j > i and not (left_out[near] & ~found[near] & ~given[near]).any():
            whole = (i == 0 or not found[i - 1]) and (j == n or not found[j])
            all_found[i:j] = False
            odds = evidence(y, sigma, factor, i, j, all_found, unit, np.empty(LONGEST))
            left_out[i:j] = odds + prior > 0.0 or (whole and odds == ONE_SIDED and prior > 0.0)
            all_found[i:j] = True
        i = j + 1


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


@kernel
def odds_of(y, sigma, smoothing, unit, marked, left_out, odds):
    """Log odds (n,) of each run marked (n,), at its first frame; elsewhere NaN."""
    factor, off, others = root(smoothing), np.empty(LONGEST), left_out.copy()
    i, n = 0, len(y)
    odds[:] = np.nan
    while i < n:
        j = i
        while j < n and marked[j]:
            j += 1
        if j > i and j - i <= LONGEST:
            others[i:j] = False
            odds[i] = evidence(y, sigma, factor, i, j, others, unit, off)
            others[i:j] = left_out[i:j]
        i = j + 1
