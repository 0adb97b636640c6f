"""All pairs of frames: what a segment between two of them costs, and the best ways through them, for every number of
keys at once."""

from __future__ import annotations

import numpy as np

from .._jit import kernel
from ._least_squares import STIFFNESS, hermite_row
from ._whole import errors_of

SEEN = 48  # frames of a long segment that are looked at, at least; at 120 fps those between look alike


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


@kernel
def broken_slopes(samples, a, b, slopes):
    """Slopes (2, C) per frame at frames a and b of the cubics through the samples (F, C) there that are nearest to
    those between, least squares, drawn a little towards the chord."""
    channels, h = samples.shape[1], b - a
    row = np.empty(4)
    s11 = s12 = s22 = 0.0
    slopes[:] = 0.0
    for f in range(a + 1, b):
        hermite_row((f - a) / h, h, row)
        s11 += row[1] * row[1]
        s12 += row[1] * row[3]
        s22 += row[3] * row[3]
        for c in range(channels):
            left = samples[f, c] - row[0] * samples[a, c] - row[2] * samples[b, c]
            slopes[0, c] += row[1] * left
            slopes[1, c] += row[3] * left
    pull = STIFFNESS * h * max(h - 1, 1)
    s11, s22 = s11 + pull, s22 + pull
    below = s11 * s22 - s12 * s12
    for c in range(channels):
        chord = pull * (samples[b, c] - samples[a, c]) / h
        first, second = slopes[0, c] + chord, slopes[1, c] + chord
        slopes[0, c] = (first * s22 - second * s12) / below
        slopes[1, c] = (second * s11 - first * s12) / below


@kernel
def broken_error(stage, a, b, enough):
    """The largest error in space of a segment between frames a and b with slopes of its own; told as soon as it is
    over `enough`, coarse frames first. Of a long segment not more than 2 x SEEN frames are looked at, evenly."""
    channels, h = stage.samples.shape[1], b - a
    slopes, row = np.empty((2, channels)), np.empty(4)
    curve, error = np.empty((1, channels)), np.empty(1)
    broken_slopes(stage.samples, a, b, slopes)
    worst, gap = 0.0, 1
    while 2 * gap < h:
        gap *= 2
    while gap > 0 and 2 * SEEN * gap > h:
        for f in range(a + gap, b, 2 * gap):
            hermite_row((f - a) / h, h, row)
            for c in range(channels):
                near = row[0] * stage.samples[a, c] + row[1] * slopes[0, c]
                curve[0, c] = near + row[2] * stage.samples[b, c] + row[3] * slopes[1, c]
            errors_of(stage, f, curve, error)
            worst = max(worst, error[0])
            if worst > enough:
                return worst
        gap //= 2
    return worst


@kernel
def broken_errors(stage, last, enough, patience, errors):
    """errors (F, L) at [i, d] of the segments from i to i + 1 + d: inf where over `enough`, and no longer looked at
    once `patience` segments in a row were. Lowers last (F,) to what has been looked at."""
    for i in range(len(errors)):
        over = 0
        for j in range(i + 1, last[i] + 1):
            found = broken_error(stage, i, j, enough)
            over = over + 1 if found > enough else 0
            errors[i, j - i - 1] = np.inf if found > enough else found
            if over >= patience or j - i >= errors.shape[1]:
                last[i] = j
                break
