"""Feet that turn on the spot: a body that is turned far over a standing foot takes the foot along by what is too much.

The foot turns about its ball (about its heel, where only that stands), which stays where it is: by one part of what
the body turns, so that it turns while the body does, and as slowly as it can. It lands and leaves without turning. What
the foot does not turn, hip and ankle do, half each unless one of them is at its end.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .._jit import kernel
from ._joints import Joints, saturated
from ._stances import Stances

COMES = 0.1  # seconds in which a foot begins to turn, and comes to rest
OVER = np.radians(15.0)  # further than that a swinging foot is never turned
MOST = 1.3  # times as fast as the body: what was missed at both ends is made up for


@dataclass(frozen=True, eq=False)
class Pivots:
    """How standing feet turn on the spot: angle (F,), radians, beside their footprint's; how much (N,) each turns in
    all. low, high: (F,) by how much a foot is turned against its body at most."""

    angle: np.ndarray
    whole: np.ndarray
    low: np.ndarray
    high: np.ndarray

    def cut(self, span: slice, some: slice) -> Pivots:
        """Some of the frames, with the stances that are in them."""
        return Pivots(self.angle[span], self.whole[some], self.low[span], self.high[span])

    def swung(self, turn: np.ndarray) -> np.ndarray:
        """Turns (F,) of a swinging foot against its body, led on from fast turns of standing ones, kept within what
        legs can do."""
        if ((turn > self.high) | (turn < self.low)).any():
            turn = -saturated(-saturated(turn, self.high, OVER), -self.low, OVER)
        return turn

    def speeds(self, stances: Stances, frame_time: float) -> np.ndarray:
        """Radians a second (F,) at which standing feet turn."""
        found = np.zeros(len(self.angle))
        if self.whole.any():
            found[1:] = np.abs(np.diff(self.angle)) / frame_time * (stances.of[1:] == stances.of[:-1])
        return found


def pivots(stances: Stances, angles: np.ndarray, heading: np.ndarray, joints: Joints, frame_time: float) -> Pivots:
    """How feet turn whose footprints are turned by angles (N,) under a body that is turned by heading (F,)."""
    made = Pivots(np.zeros(len(heading)), np.zeros(len(angles)), joints.low, joints.high)
    count = max(1, round(COMES / frame_time))
    _turn(stances.spans, stances.down, angles, heading, made.low, made.high, count, made.angle, made.whole)
    return made


# -- in call order ---------------------------------------------------------------------------------


@kernel
def _turn(
    spans: np.ndarray,
    down: np.ndarray,
    angles: np.ndarray,
    heading: np.ndarray,
    low: np.ndarray,
    high: np.ndarray,
    count: int,
    angle: np.ndarray,
    whole: np.ndarray,
) -> None:
    """How far feet turn at every frame, so that they are turned against the body by no more than low and high (F,), or
    as little more as can be; in frames `down` (N, 2) alone, coming and going within so many frames."""
    for i in range(len(spans)):
        first, end = spans[i]
        inside = True
        for f in range(first, end):
            away = angles[i] - heading[f]
            inside = inside and low[f] <= away <= high[f]
        if inside:
            continue
        mean = 0.0
        for f in range(first + 1, end):
            angle[f] = angle[f - 1] + (heading[f] - heading[f - 1]) * _speed(f - 0.5, down[i], count)
            mean += angle[f] / (end - first)
        part = 0.0
        for f in range(first, end):
            angle[f] -= mean
            away = angles[i] - heading[f]
            over = away - high[f] if away > high[f] else min(away - low[f], 0.0)
            if over * angle[f] < 0.0 and abs(over) < 2.0 * MOST * abs(angle[f]):  # else no turn helps there
                part = max(part, -over / angle[f])
        part = min(part, MOST)
        least, most = 0.0, 0.0
        for f in range(first, end):
            angle[f] *= part
            least, most = min(least, angle[f]), max(most, angle[f])
        whole[i] = most - least


@kernel
def _speed(at: float, down: np.ndarray, count: int) -> float:
    """1 while a foot is free to turn, smoothly from and to 0 at both ends."""
    first, last = down[0], down[1] - 1
    ramp = min(float(count), 0.5 * (last - first))
    u = min(at - first, last - at) / ramp if ramp > 0.0 else 0.0
    u = min(max(u, 0.0), 1.0)
    return u * u * u * (10.0 + u * (6.0 * u - 15.0))
