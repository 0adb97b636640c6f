"""How far a body turns when it is laid along another path: the difference of the two paths' headings, made smooth.

Where the body hardly moves a path has no direction worth following; there the turn goes over evenly from what it was
before to what it is after. A constant difference stays exactly what it is.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from ..motion import Motion
from ..whittaker import smoothed
from ._seams import centimetres

GATE = 20.0  # cm/s: at this speed a heading counts half
STANDING = 10.0  # cm/s: a body that is never faster has no direction
MOVING = 0.1  # of the largest weight: below, a heading is not looked at, and what is put there has this weight
WIDTH = 0.15  # seconds over which a turn is smooth
ALIKE = 0.9  # of headings that all point one way


def gate(motion: Motion) -> tuple[float, float]:
    """The speeds (file units a second) at which a heading counts half, and under which there is none; 0 where nobody
    knows how long a unit is."""
    length = centimetres(motion)
    return (GATE / length, STANDING / length) if length else (0.0, 0.0)


def speeds(distance: np.ndarray, cycle: np.ndarray, frame_time: float) -> np.ndarray:
    """How fast (G,) distances change, units a second; what begins again is another run."""
    result = np.zeros(len(distance))
    for run in runs(cycle):
        if run.stop - run.start > 1:
            result[run] = np.abs(np.gradient(distance[run])) / frame_time
    return result


def turns(
    old: np.ndarray,
    new: np.ndarray,
    speed: np.ndarray,
    limits: tuple[float, float],
    width: float,
    held: tuple[bool, bool] = (False, False),
) -> np.ndarray:
    """Radians (G,), whole turns counted, from headings old (G,) to new (G,), smooth.

    speed: (G,) units a second. limits: as `gate` has them. width: frames over which it is smooth.
    held:  whether before the first and after the last frame the body does not turn.
    """
    apart = np.angle(np.exp(1j * (new - old)))
    if not speed.max(initial=0.0) > limits[1] and not any(held):  # a body that stands
        middle = np.exp(1j * apart).mean()
        return np.full(len(old), np.angle(middle) if abs(middle) > ALIKE else 0.0)
    square = speed * speed
    weights = square / np.maximum(square + limits[0] ** 2, 1e-300)
    moving = np.flatnonzero(weights >= MOVING * weights.max(initial=0.0))
    steady = np.unwrap(apart[moving])  # what headings do in between, where the body hardly moves, says nothing
    apart = np.interp(np.arange(len(old)), moving, steady) if len(moving) else np.zeros(len(old))
    weights = np.maximum(weights, MOVING)
    from_there = 0.0 if any(held) else apart[0]
    if (apart == from_there).all():  # so that what is alike stays so to the last digit
        return apart
    return from_there + smoothed((apart - from_there)[:, None], weights, width, held)[:, 0]


def runs(cycle: np.ndarray) -> list[slice]:
    """The frames of each cycle."""
    edges = np.concatenate([[0], np.flatnonzero(np.diff(cycle)) + 1, [len(cycle)]]).tolist()
    return [slice(first, last) for first, last in pairwise(edges) if last > first]
