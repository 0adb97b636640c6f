"""All pairs of frames: what a segment between two of them costs, and the best ways through them, for every number of
keys at once."""

from __future__ import annotations

import numpy as np

from .._jit import kernel


@kernel
def chord_errors(points, products, last, errors):
    """errors (F, L): of the postures between frames i and i + 1 + d the largest distance from the chord, at [i, d].

    points (F, D); products (F, F), of all pairs of points; last (F,): no chord from i goes further than last[i]. The
    distance is that from the line piece in posture space. Found with the products, told from the points themselves."""
    frames, dimensions = points.shape
    for i in range(frames):
        for j in range(i + 1, last[i] + 1):
            base = products[i, i]
            length = products[j, j] - 2.0 * products[i, j] + base
            most, where = 0.0, -1
            for f in range(i + 1, j):
                away = products[f, f] - 2.0 * products[i, f] + base
                along = products[f, j] - products[i, f] - products[i, j] + base
                if length > 0.0 and along > 0.0:
                    away += length - 2.0 * along if along >= length else -along * along / length
                if away > most:
                    most, where = away, f
            if where < 0:
                errors[i, j - i - 1] = 0.0
                continue
            length = along = away = 0.0
            for k in range(dimensions):
                chord, here = points[j, k] - points[i, k], points[where, k] - points[i, k]
                length += chord * chord
                along += chord * here
            part = min(max(along / length, 0.0), 1.0) if length > 0.0 else 0.0
            for k in range(dimensions):
                here = points[where, k] - points[i, k] - part * (points[j, k] - points[i, k])
                away += here * here
            errors[i, j - i - 1] = np.sqrt(away)


@kernel
def best_ways(errors, last, most):
    """For every number of keys up to `most`: the least largest error of a way from frame 0 to the last frame.

    errors (F, L) of the segments from i to i + 1 + d, none beyond last[i]. Returns the errors (most + 1,), inf where no
    way has so many keys, and before (most + 1, F): the key before frame j on the best way to it with so many keys."""
    frames = len(errors)
    before = np.full((most + 1, frames), -1, np.int32)
    found = np.full(most + 1, np.inf)
    reached, earlier = np.full(frames, np.inf), np.empty(frames)
    reached[0] = 0.0
    if frames == 1:
        found[1] = 0.0
    for keys in range(2, most + 1):
        earlier[:] = reached
        reached[:] = np.inf
        for i in range(keys - 2, frames - 1):
            so_far = earlier[i]
            if so_far == np.inf:
                continue
            for j in range(i + 1, last[i] + 1):
                worst = max(so_far, errors[i, j - i - 1])
                if worst < reached[j]:
                    reached[j] = worst
                    before[keys, j] = i
        found[keys] = reached[frames - 1]
    return found, before
