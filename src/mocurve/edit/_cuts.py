"""Where one motion may go over into another: the pairs of windows that look most alike."""

from __future__ import annotations

import numpy as np

from .. import planar

PAIRS = 1_000_000  # of frames are compared at once; in longer clips first only every second, third ... frame


def find(
    first: np.ndarray, second: np.ndarray, window: int, rows: range, columns: range, most: int
) -> list[tuple[int, int]]:
    """The starts of the windows that are nearest after planar alignment, the nearest first, at most so many.

    first, second: places (F, J, 3) of the same joints. rows, columns: where the windows may start. Of starts that lie
    within half a window of a better pair in both clips, only that one is told.
    """
    stride = max(1, int(np.ceil(np.sqrt(len(rows) * len(columns) / PAIRS))))
    coarse = max(1, window // stride)
    mine, other = (
        places[spots.start : spots.stop + stride * (coarse - 1) : stride]
        for places, spots in ((first, rows), (second, columns))
    )
    distances = planar.frame_distances(mine, other, coarse)
    radius = max(1, coarse // 2)
    found: list[tuple[int, int]] = []
    while len(found) < most and np.isfinite(distances).any():
        i, j = np.unravel_index(np.argmin(distances), distances.shape)
        distances[max(i - radius, 0) : i + radius + 1, max(j - radius, 0) : j + radius + 1] = np.inf
        found.append(_refined(first, second, window, _near(rows, int(i), stride), _near(columns, int(j), stride)))
    return found


def _near(spots: range, place: int, stride: int) -> range:
    middle = spots.start + stride * place
    return range(max(middle - stride + 1, spots.start), min(middle + stride, spots.stop))


def _refined(first: np.ndarray, second: np.ndarray, window: int, rows: range, columns: range) -> tuple[int, int]:
    a, b = (places[spots.start : spots.stop + window - 1] for places, spots in ((first, rows), (second, columns)))
    distances = planar.frame_distances(a, b, window)
    i, j = np.unravel_index(np.argmin(distances), distances.shape)
    return rows.start + int(i), columns.start + int(j)
