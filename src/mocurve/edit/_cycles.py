"""Where a motion repeats itself: pairs of frames that look alike, the body having moved in between."""

from __future__ import annotations

import numpy as np

from .. import planar
from ..errors import OptionError

SHORTEST, LONGEST = 0.3, 4.0  # seconds of a cycle: faster nobody runs, slower is no gait
COARSE = 30.0  # frames a second of the first search
AROUND = 0.04  # seconds on either side of a frame that are compared with it
ALIKE = 0.5  # of the largest distance within the cycle; more is no return
CLEAR = 0.1  # of it: as near as frames of the first search come where the cycle returns between two of them
MOVED = 0.02  # of the body's size, the deviation of its joints from their middle; less is standing still
NEARLY = 1.5  # times the best is as good, where something else is to be had for it
ROWS = 96  # places of the first search that the second looks at


def find(
    places: np.ndarray, frame_time: float, room: int, resting: np.ndarray, start: int | None = None
) -> tuple[int, int]:
    """First and last frame of the clearest cycle (the last is the first again), from `start` on if it is given.

    places: (F, J, 3). room: frames wanted before the first and after the last. resting: (F, K) whether feet do.

    A pair is judged by its distance as a part of the largest distance within the cycle, so that standing still is none.
    Of lags about as good the shortest is taken; of pairs about as good the one where the mean of both moves on most
    evenly, the feet that rest in one resting in the other too. OptionError where nothing returns.
    """
    stride = max(1, round(1.0 / (COARSE * frame_time)))
    offset = 0 if start is None else start % stride
    end = len(places) - room if start is None else len(places)
    alike = _returns(places[offset:end:stride], stride * frame_time)
    rows = offset + stride * np.arange(len(alike))
    wanted = rows >= room if start is None else rows == start
    alike, rows = alike[wanted], rows[wanted]
    best = alike.min(axis=0, initial=np.inf)
    low = np.flatnonzero((best[1:-1] <= best[:-2]) & (best[1:-1] <= best[2:]) & (best[1:-1] <= ALIKE)) + 1
    if len(low) == 0:
        since = "" if start is None else f" after {start * frame_time:g} s"
        raise OptionError(f"no cycle is found: no pose returns{since} that was left in between; say start and end")
    lag = int(low[np.argmax(best[low] <= max(NEARLY * best[low].min(), CLEAR))])
    order = np.argsort(alike[:, lag])[:ROWS]
    near = rows[order[alike[order, lag] <= NEARLY * best[lag]]]
    if start is None:
        near = np.unique(near[:, None] + np.arange(stride))
    lags = stride * lag + np.arange(-stride, stride + 1)
    first, last = (pairs.ravel() for pairs in np.broadcast_arrays(near[:, None], near[:, None] + lags))
    return _chosen(places, resting, first, last, frame_time)


def step(places: np.ndarray, first: int, last: int, frame_time: float) -> np.ndarray:
    """The planar transform (3,) that takes the body from where it is at `first` to where it is at `last`."""
    return planar.align(*(_flat(around) for around in _around(places, last, first, _half(frame_time))))


def apart(places: np.ndarray, first: int, last: int, frame_time: float) -> float:
    """How far the poses around two frames are apart, after alignment, root mean square over joints."""
    return float(_compared(*_around(places, first, last, _half(frame_time)))[0])


def _returns(places: np.ndarray, frame_time: float) -> np.ndarray:
    """(F, L) the distance of frames f and f + lag as a part of the largest at lesser lags, infinite where there is no
    such frame or the lag is too short."""
    count = len(places)
    shortest = max(2, round(SHORTEST / frame_time))
    longest = min(round(LONGEST / frame_time), count - 1)
    if longest <= shortest:
        return np.full((count, 3), np.inf)
    result = np.full((count, longest + 1), np.inf)
    least = max(MOVED * float(np.sqrt(places.var(axis=1).sum(axis=-1).mean())), 1e-300)
    padded = np.pad(places, ((1, 1), (0, 0), (0, 0)), "edge")  # windows of 3 frames, also around the outermost
    for first in range(0, count, longest):  # all pairs of a long clip would not fit into memory
        rows = min(longest, count - first)
        columns = min(rows + longest, count - first)
        found = planar.frame_distances(padded[first : first + rows + 2], padded[first : first + columns + 2], 3)
        for row in range(rows):
            line = found[row, row : row + longest + 1]
            largest = np.maximum.accumulate(line)
            result[first + row, : len(line)] = np.where(largest > least, line / np.maximum(largest, least), np.inf)
    result[:, :shortest] = np.inf
    return result


def _chosen(
    places: np.ndarray, resting: np.ndarray, first: np.ndarray, last: np.ndarray, frame_time: float
) -> tuple[int, int]:
    """Of pairs (P,) about as near to each other as the nearest, the one whose mean moves on most evenly, and whose feet
    do the same."""
    half = _half(frame_time)
    inside = (first >= half) & (last < len(places) - half)
    if not inside.any():  # the start is given, and lies at the very edge
        half, inside = 0, last < len(places)
    first, last = first[inside], last[inside]
    distance, bend = _compared(*_around(places, first, last, half))
    least = float(distance.min())
    cost = distance / max(least, 1e-300) + bend / max(float(bend.min()), 1e-300)
    if resting.shape[1]:
        rests, rest = _around(resting, first, last, half)
        cost *= 1.0 + np.mean(rests != rest, axis=(-2, -1))
    best = np.argmin(np.where(distance <= NEARLY * least, cost, np.inf))
    return int(first[best]), int(last[best])


def _half(frame_time: float) -> int:
    return max(1, round(AROUND / frame_time))


def _around(places: np.ndarray, first: np.ndarray | int, last: np.ndarray | int, half: int) -> list[np.ndarray]:
    """What is known of frames (F, ...), of those (..., w, ...) around each of two, as far as the clip goes on both
    sides of both."""
    half = min(half, *(min(np.min(frames), len(places) - 1 - np.max(frames)) for frames in (first, last)))
    near = np.arange(-half, half + 1)
    return [places[np.asarray(frames)[..., None] + near] for frames in (first, last)]


def _flat(around: np.ndarray) -> np.ndarray:
    return around.reshape(*around.shape[:-3], -1, 3)


def _compared(at_first: np.ndarray, at_last: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Of the poses around two frames, aligned: how far they are apart (...), and how unevenly their mean moves on (...)
    where one goes over into the other."""
    step = planar.align(_flat(at_last), _flat(at_first))
    carried = planar.move(step[..., None, None, :], at_first)
    distance = np.sqrt(((at_last - carried) ** 2).sum(axis=-1).mean(axis=(-2, -1)))
    middle = at_last.shape[-3] // 2
    mean = 0.5 * (at_last + carried)[..., max(middle - 2, 0) : middle + 2, :, :]
    bend = np.linalg.norm(np.diff(mean, 2, axis=-3), axis=-1).max(axis=(-2, -1), initial=0.0)
    return distance, bend
