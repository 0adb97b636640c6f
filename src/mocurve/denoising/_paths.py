"""The cheapest smooth path through noisy frames that may skip runs of them: a dynamic program."""

from __future__ import annotations

import numpy as np

from .._jit import kernel

SHORT = 2  # frames: the dynamic program finds such excursions better
BACK = 0.25  # of the largest distance: nearer, an excursion is over


@kernel
def skip(y, noise, motion, first, last, gap, end, each, entry, cap, skipped):
    """Marks in skipped (n,) the frames of first ... last that the cheapest path leaves out.

    y (n, C) channels of one joint; noise (C,) variance of a sample; motion (n, C) variance of the motion's own second
    difference. A state is a kept frame and the gap to the kept frame before. Keeping k after j after i costs how far
    the slope turns at j, in units of what noise and motion explain, and at most cap; leaving out m frames costs
    entry + each * m."""
    n, channels, widest = last - first + 1, y.shape[1], gap + 1
    cost = np.full((n, widest + 1), np.inf)
    came = np.zeros((n, widest + 1), np.int64)
    cost[1, 1] = 0.0
    if first == 0:  # the path may start later, and end earlier, where the clip does
        for k in range(2, min(end + 2, n)):
            cost[k, 1] = entry + each * (k - 1)
    slack = 2.0 * cap + channels
    for k in range(2, n):
        for g2 in range(1, min(widest, k) + 1):
            j = k - g2
            best, came_from = cost[k, g2], 0
            step = entry + each * (g2 - 1) if g2 > 1 else 0.0
            for g1 in range(1, min(widest, j) + 1):
                before = cost[j, g1] + step
                if before >= best:
                    continue
                i = j - g1
                spread = 1.0 / (g1 * g1) + 1.0 / (g2 * g2) + (1.0 / g1 + 1.0 / g2) ** 2
                reach = (0.5 * (g1 + g2)) ** 2
                z = 0.0
                for c in range(channels):
                    turn = (y[first + k, c] - y[first + j, c]) / g2 - (y[first + j, c] - y[first + i, c]) / g1
                    z += turn * turn / (noise[c] * spread + motion[first + j, c] * reach)
                    if z > slack:
                        break
                now = before + min(cap, 0.5 * max(0.0, z - channels))
                if now < best:
                    best, came_from = now, g1
            if came_from > 0:
                cost[k, g2] = best
                came[k, g2] = came_from
    g, k, least = 1, n - 1, np.inf
    for e in range(max(1, n - 1 - end) if last == len(y) - 1 else n - 1, n):
        over = entry + each * (n - 1 - e) if e < n - 1 else 0.0
        for q in range(1, min(widest, e) + 1):
            if cost[e, q] + over < least:
                g, k, least = q, e, cost[e, q] + over
    skipped[first + k + 1 : last + 1] = True
    while k > 0:
        skipped[first + k - g + 1 : first + k] = True
        k, g = k - g, came[k, g]
        if g == 0:
            skipped[first : first + k] = True
            break


@kernel
def excursions(y, impossible, longest, marks):
    """Marks in marks (n,) where a channel leaves with a turn that no motion makes, and comes back with another.

    y (C, n) channels of a joint; impossible (C, n) such turns; longest: frames that it may be away."""
    channels, n = y.shape
    for c in range(channels):
        i = 0
        while i < n:
            if not impossible[c, i]:
                i += 1
                continue
            most, after = 0.0, i + 1
            for t in range(i + 1, min(n, i + 1 + longest)):
                away = abs(y[c, t] - y[c, i])
                most = max(most, away)
                if away < BACK * most and (impossible[c, t] or impossible[c, t - 1]):
                    if t - i > SHORT + 1:
                        marks[i + 1 : t] = True
                    after = t + 2  # the turn of the frame after belongs to it
                    break
            i = after
