"""The floor under the points of feet, by where they are slow and low."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

FLOOR = 5.0  # percent of the frames are lower than where the search for a joint's own floor begins
TILT, BANDS = 0.03, (3.0, 3.0, 2.0, 1.5, 1.0, 1.0)  # usual slope of a floor; heights within which it is looked for
APART, MANY = 25.0, 1000  # cm: places that are as near are one; more places are not counted


def floors(points: Sequence[np.ndarray], slow: Sequence[np.ndarray], height: float, feet: int) -> list[np.ndarray]:
    """Heights (F,) of the floor under points (F, 3), the first of them balls of so many feet, by the places where they
    are slow (N, 3). Each has a floor of its own. These are level, or nearly, unless both feet stand in more places of a
    ramp, all of one slope, than of a level."""
    starts = [np.array([np.percentile(point[:, 1], FLOOR), 0.0, 0.0]) for point in points]
    level = [_plane(part, start, height) for part, start in zip(slow, starts, strict=True)]
    counts = [_places(part[low]) for part, (_, low) in zip(slow, level, strict=True)]
    planes = [plane for plane, _ in level]
    apart = np.concatenate([part - part.mean(axis=0) for part in slow if len(part)] or [np.zeros((0, 3))])
    if sum(counts) < sum(map(_places, slow)) and np.isfinite(apart).all():
        slope = np.linalg.lstsq(apart[:, ::2], apart[:, 1], rcond=None)[0]
        ramp = [_plane(part, _start(part, slope), height) for part in slow]
        more = [_places(part[low]) for part, (_, low) in zip(slow, ramp, strict=True)]
        if sum(more) > sum(counts) and (min(more[:feet]) >= 2 or max(more[:feet]) >= 3):
            planes = [plane for plane, _ in ramp]
    return [
        plane[0] + (point[:, ::2] - _middle(part)) @ plane[1:]
        for point, part, plane in zip(points, slow, planes, strict=True)
    ]


# -- in call order ---------------------------------------------------------------------------------


def _plane(slow: np.ndarray, plane: np.ndarray, height: float) -> tuple[np.ndarray, np.ndarray]:
    """A plane (3,) through most of the places (N, 3) near another one, and which are near it, (N,). It is looked for in
    bands that narrow around it, so that a foot that is held up does not lift it."""
    at, low = np.column_stack([np.ones(len(slow)), _flat(slow)]), np.zeros(len(slow), bool)
    for band in BANDS:
        low = np.abs(slow[:, 1] - at @ plane) < band * height
        if low.sum() < 3:
            break
        level = np.diag([0.0, *np.full(2, (0.1 * low.sum() / 3.0 + 1.0) * TILT**-2.0)])
        plane = np.linalg.solve(at[low].T @ at[low] + level, at[low].T @ slow[low, 1])
    return plane, low


def _start(slow: np.ndarray, slope: np.ndarray) -> np.ndarray:
    """The plane (3,) of a slope (2,) with as many places (N, 3) above it as below."""
    height = np.median(slow[:, 1] - _flat(slow) @ slope) if len(slow) else 0.0
    return np.array([height, *slope])


def _middle(slow: np.ndarray) -> np.ndarray:
    return slow[:, ::2].mean(axis=0) if len(slow) else np.zeros(2)


def _flat(slow: np.ndarray) -> np.ndarray:
    flat: np.ndarray = slow[:, ::2] - _middle(slow)
    return flat


def _places(slow: np.ndarray) -> int:
    """How many places (N, 3) there are that are a step apart, up to MANY."""
    count = 0
    while len(slow) and count < MANY:
        slow = slow[np.linalg.norm(slow[:, ::2] - slow[0, ::2], axis=1) > APART]
        count += 1
    return count
