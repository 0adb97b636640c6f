"""Where one motion may go over into another: the pairs of moments that look most alike.

Sources: Kovar, Gleicher and Pighin 2002, Motion graphs, section 3.1, for the distance; Lee et al. 2002, Interactive
control of avatars animated with human motion data, section 3.1, for contacts that have to agree.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .. import planar

PAIRS = 1_000_000  # of frames are compared at once; in longer clips first only every second, third ... frame
NUMBERS = 10_000_000  # of places are held at once, 80 MB
DISAGREE = (
    1.0  # a pair in which every foot rests in one clip and not in the other counts as 1 + so many times as far apart
)


class Candidates(NamedTuple):
    """Two clips, and what makes a pair of moments in them a good cut.

    first, second: places (F, J, 3), (G, J, 3) of the same joints. resting, others: (F, K), (G, K) whether feet rest.
    window: frames from a moment on that are compared. ahead: frames by which each pose is also carried on at its own
    speed, and compared there; 0: speeds do not count. rough: (G,) factors on the distance, of the second's moments.
    """

    first: np.ndarray
    second: np.ndarray
    resting: np.ndarray
    others: np.ndarray
    window: int
    ahead: float
    rough: np.ndarray


def find(of: Candidates, rows: range, columns: range, apart: int, most: int) -> list[tuple[int, int]]:
    """The best pairs of moments, the best first, at most so many; rows and columns: where they may lie.

    Of pairs that lie within so many frames of a better one in both clips, only that one is told.
    """
    held = (len(rows) + len(columns)) * of.window * of.first[0].size
    stride = max(1, int(np.ceil(np.sqrt(max(len(rows) * len(columns) / PAIRS, held / NUMBERS)))))
    costs = _costs(of, rows[::stride], columns[::stride])
    radius = max(1, apart // stride)
    found: list[tuple[int, int]] = []
    while len(found) < most and np.isfinite(costs).any():
        i, j = np.unravel_index(np.argmin(costs), costs.shape)
        costs[max(i - radius, 0) : i + radius + 1, max(j - radius, 0) : j + radius + 1] = np.inf
        near, other = _near(rows, int(i), stride), _near(columns, int(j), stride)
        fine = _costs(of, near, other)
        i, j = np.unravel_index(np.argmin(fine), fine.shape)
        found.append((near[int(i)], other[int(j)]))
    return found


def _costs(of: Candidates, rows: range, columns: range) -> np.ndarray:
    """(R, C) of all pairs of these moments."""
    stride = max(rows.step, columns.step)
    count = max(1, of.window // stride)
    within = stride * np.arange(count)
    mine, other = (np.asarray(spots)[:, None] + within for spots in (rows, columns))  # (R, w), (C, w) frames
    near, other_near = _points(of.first, mine, of.ahead), _points(of.second, other, of.ahead)
    distances = planar.frame_distances(near, other_near)
    if of.resting.shape[1]:
        rests, rest = (
            states[spots].reshape(len(spots), -1).astype(np.float64)
            for states, spots in ((of.resting, mine), (of.others, other))
        )
        differ = rests.sum(axis=1)[:, None] + rest.sum(axis=1) - 2.0 * rests @ rest.T
        distances *= 1.0 + DISAGREE * differ / rests.shape[1]
    return distances * of.rough[np.asarray(columns)]


def _points(places: np.ndarray, spots: np.ndarray, ahead: float) -> np.ndarray:
    """The places (N, P, 3) that are compared of each moment: of w frames, or of one and where it is heading."""
    if not ahead:
        return places[spots].reshape(len(spots), -1, 3)
    at = spots[:, 0]
    speed = places[at] - places[np.maximum(at - 1, 0)]
    return np.concatenate([places[at], places[at] + ahead * speed], axis=1)


def _near(spots: range, place: int, stride: int) -> range:
    return spots[max(stride * place - stride + 1, 0) : stride * place + stride]
