"""Dynamic time warping: the cheapest way through all pairs of frames, and a smooth map of times along it.

Sources: Sakoe and Chiba 1978, Dynamic programming algorithm optimization for spoken word recognition (band and slope);
Bruderlin and Williams 1995, Motion signal processing, section 4.2 (for motion).
"""

from __future__ import annotations

import numpy as np
from scipy.interpolate import BSpline
from scipy.optimize import lsq_linear

KNOTS, SPANS = 0.2, 300  # seconds between the knots of the map; further apart where these are too many
PAIRS = 4  # of a map, from knot to knot
STIFF = 0.1  # weight of a change of speed from knot to knot, in frames


def path(distances: np.ndarray, slope: int | None = None, band: float = np.inf) -> tuple[float, np.ndarray]:
    """Least sum of distances (N, M) from the first pair to the last, and the pairs (K, 2) that it goes through.

    A step goes on by a frame in one of the two or in both. slope: how often in a row it may go on in the same one only,
    None for any. band: frames of the first by which a pair may be off the straight way. Infinite, and no pairs, where
    no way leads to the end.

    All cells of an antidiagonal are reached at once; per cell there is a cost for every count of steps in one.
    """
    rows, columns = distances.shape
    run = slope or 1
    states = 1 + 2 * run  # both went on; the first did so alone 1 ... run times; the second did
    firsts, seconds = range(1, 1 + run), range(1 + run, states)
    to_first = list(range(states)) if slope is None else [0, *seconds]  # from where the first may start going alone
    to_second = list(range(states)) if slope is None else [0, *firsts]
    before = np.full((states, rows + 1), np.inf)  # of a diagonal, [state, 1 + i]; two diagonals are kept
    last = before.copy()
    came = np.zeros((rows + columns - 1, 3, rows), np.uint8)
    for diagonal in range(rows + columns - 1):
        i = np.arange(max(0, diagonal - columns + 1), min(diagonal, rows - 1) + 1)
        now = np.full_like(last, np.inf)
        here = now[:, i + 1]
        if diagonal == 0:
            here[0] = 0.0
        else:
            for place, (state, pool, source) in enumerate(
                (
                    (0, list(range(states)), before[:, i]),
                    (1, to_first, last[:, i]),
                    (1 + run, to_second, last[:, i + 1]),
                )
            ):
                best = np.argmin(source[pool], axis=0)
                came[diagonal, place, i] = np.array(pool, np.uint8)[best]
                here[state] = source[pool][best, np.arange(len(i))]
            here[2 : 1 + run] = last[1:run, i]
            here[2 + run :] = last[1 + run : states - 1, i + 1]
        here += distances[i, diagonal - i]
        here[:, np.abs(i - (diagonal - i) * ((rows - 1) / max(columns - 1, 1))) > band] = np.inf
        now[:, i + 1] = here
        before, last = last, now
    state = int(np.argmin(last[:, rows]))
    cost = float(last[state, rows])
    return cost, _traced(came, state, run, rows, columns) if np.isfinite(cost) else np.zeros((0, 2), np.int64)


def smooth_map(old: np.ndarray, new: np.ndarray, step: float, slope: int) -> np.ndarray:
    """Pairs (K, 2) of a strictly rising map that follows old and new times (P,) of a path, seconds, ends kept.

    The rates of a cubic B-spline lie between those of its coefficients: least squares over these, which are bounded by
    what a path of this slope can do, slope + 1 frames of one to one of the other. step: the longer frame time, in which
    misses and changes of speed are weighed.
    """
    start, end = old[0], old[-1]
    count = min(max(1, round((end - start) / KNOTS)), SPANS)
    spacing = max(KNOTS, (end - start) / SPANS)
    knots = np.concatenate([[start] * 3, np.linspace(start, end, count + 1), [end] * 3])
    basis = BSpline.design_matrix(np.clip(old, start, end), knots, 3).toarray()
    greville = (knots[1:-3] + knots[2:-2] + knots[3:-1]) / 3.0
    gaps = np.diff(greville)
    even = (new[-1] - new[0]) / (end - start)
    steps = len(gaps)
    rising = basis @ np.tril(np.ones((steps + 1, steps)), -1)  # from differences of coefficients to times
    speed = np.diag(1.0 / gaps)
    change = STIFF * spacing * np.diff(speed, axis=0)
    ends = np.full((1, steps), 1e4)  # the last coefficient is where the second clip ends
    matrix = np.concatenate([rising, change, ends])
    wanted = np.concatenate([new - new[0], np.zeros(len(change)), [1e4 * (new[-1] - new[0])]])
    low, high = min(1.0 / (slope + 1), 0.99 * even), max(slope + 1.0, 1.01 * even)
    found = lsq_linear(matrix / step, wanted / step, bounds=(low * gaps, high * gaps), tol=1e-12).x
    found *= (new[-1] - new[0]) / found.sum()
    curve = BSpline(knots, new[0] + np.concatenate([[0.0], np.cumsum(found)]), 3)
    times = np.linspace(start, end, PAIRS * count + 1)
    mapped = curve(times)
    mapped[[0, -1]] = new[[0, -1]]
    return np.stack([times, mapped], axis=1)


def _traced(came: np.ndarray, state: int, run: int, rows: int, columns: int) -> np.ndarray:
    """The pairs (K, 2) from the first to the last, traced backwards."""
    i, j = rows - 1, columns - 1
    pairs = [(i, j)]
    while i or j:
        if state == 0:
            place, di, dj = 0, 1, 1
        elif state <= run:
            place, di, dj = 1, 1, 0
        else:
            place, di, dj = 2, 0, 1
        started = state in (0, 1, 1 + run)
        state = int(came[i + j, place, i]) if started else state - 1
        i, j = i - di, j - dj
        pairs.append((i, j))
    return np.array(pairs[::-1])
