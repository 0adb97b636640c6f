"""How far a body turns when it is laid along another path: the difference of the two paths' headings, made smooth.

Where the body hardly moves a path has no direction worth following; there the turn goes over from what it was before to
what it is after. A constant difference stays exactly what it is.
"""

from __future__ import annotations

import numpy as np

from ..motion import Motion
from ..whittaker import smoothed
from ._seams import centimetres

GATE = 20.0  # cm/s: at this speed a heading counts half
STANDING = 10.0  # cm/s: a body that is never faster has no direction
LEAST = 1e-6
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


def turns(old: np.ndarray, new: np.ndarray, speed: np.ndarray, limits: tuple[float, float], width: float) -> np.ndarray:
    """Radians (G,), whole turns counted, from headings old (G,) to new (G,), smooth.

    speed: (G,) units a second. limits: as `gate` has them. width: frames over which it is smooth.
    """
    apart = np.exp(1j * (new - old))
    middle = apart.mean()
    if not speed.max(initial=0.0) > limits[1]:  # a body that stands
        return np.full(len(old), np.angle(middle) if abs(middle) > ALIKE else 0.0)
    weights = _weights(speed, limits[0])
    whole = (weights * apart).sum()
    towards = apart[0] if abs(whole) < 1e-9 * weights.sum() else whole / abs(whole)
    away = apart / towards - 1.0  # 0 where all headings differ alike, and then smoothing leaves it 0
    return np.angle(towards) + _angles(away, weights, width, (False, False))


def turns_within(
    old: np.ndarray, new: np.ndarray, speed: np.ndarray, limits: tuple[float, float], width: float,
    held: tuple[bool, bool],
) -> np.ndarray:  # fmt: skip
    """The same for part of a motion, which is held: before it, or after it, the body does not turn."""
    away = np.exp(1j * (new - old)) - 1.0
    return _angles(away, _weights(speed, limits[0]), width, held)


def runs(cycle: np.ndarray) -> list[slice]:
    """The frames of each cycle."""
    edges = np.concatenate([[0], np.flatnonzero(np.diff(cycle)) + 1, [len(cycle)]]).tolist()
    return [slice(first, last) for first, last in zip(edges, edges[1:], strict=False) if last > first]


def _weights(speed: np.ndarray, gate: float) -> np.ndarray:
    square = speed * speed
    return square / np.maximum(square + gate * gate, 1e-300) + LEAST


def _angles(away: np.ndarray, weights: np.ndarray, width: float, held: tuple[bool, bool]) -> np.ndarray:
    """Angles of 1 + away (G,), which is made smooth."""
    if not away.any():
        return np.zeros(len(away))
    parts = smoothed(np.stack([away.real, away.imag], axis=1), weights, width, held)
    return np.unwrap(np.arctan2(parts[:, 1], 1.0 + parts[:, 0]))
