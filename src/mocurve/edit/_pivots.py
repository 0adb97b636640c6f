"""Feet that turn on the spot: a body that is turned far over a standing foot takes the foot along by what is too much.

The foot turns about its ball (about its heel, where only that stands), which stays where it is: by one part of what
the body turns, so that it turns while the body does, and as slowly as it can. It lands and leaves without turning. What
the foot does not turn, hip and ankle do, half each unless one of them is at its end.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .._jit import kernel
from ._hinge import SWIVEL
from ._joints import Joints
from ._stances import Stances
from ._swings import filled

# radians that a foot is turned against its body, more than it ever is in the clip, without turning on the spot. In
# captures feet are turned against the body by up to 30 to 40 degrees either way in one contact
COMFORT = np.radians(30.0)
COMES = 0.1  # seconds in which a foot begins to turn, and comes to rest
MOST = 1.3  # times as fast as the body: what was missed at both ends is made up for


@dataclass(frozen=True, eq=False)
class Pivots:
    """How standing feet turn on the spot: angle (F,), radians, beside their footprint's; how much (N,) each turns in
    all; and shares (N,) of what a foot is turned against the body that the hip takes, the ankle the rest."""

    angle: np.ndarray
    whole: np.ndarray
    share: np.ndarray

    def cut(self, span: slice, some: slice) -> Pivots:
        """Some of the frames, with the stances that are in them."""
        return Pivots(self.angle[span], self.whole[some], self.share[some])

    def shares(self, stances: Stances, frame_time: float) -> np.ndarray:
        """The part of the turn that the hip takes at every frame, (F,)."""
        part = np.full(len(self.angle), SWIVEL)
        if (self.share != SWIVEL).any():
            known = np.where(stances.of >= 0, self.share[stances.of] - SWIVEL, 0.0)
            part += filled(known[:, None], stances.spans, frame_time)[:, 0]
        return part

    def speeds(self, stances: Stances, frame_time: float) -> np.ndarray:
        """Radians a second (F,) at which standing feet turn."""
        found = np.zeros(len(self.angle))
        if self.whole.any():
            found[1:] = np.abs(np.diff(self.angle)) / frame_time * (stances.of[1:] == stances.of[:-1])
        return found


def pivots(stances: Stances, angles: np.ndarray, heading: np.ndarray, joints: Joints, frame_time: float) -> Pivots:
    """How feet turn whose footprints are turned by angles (N,) under a body that is turned by heading (F,)."""
    made = Pivots(np.zeros(len(heading)), np.zeros(len(angles)), np.full(len(angles), SWIVEL))
    low, high = joints.most[0] - joints.turned - COMFORT, joints.most[1] - joints.turned + COMFORT
    low, high = np.maximum(low, -joints.rooms[:, :, 1].sum(axis=1)), np.minimum(high, joints.rooms[:, :, 0].sum(axis=1))
    count = max(1, round(COMES / frame_time))
    _turn(stances.spans, stances.down, angles, heading, low, high, count, made.angle, made.whole)
    _share(stances.spans, angles, heading, made.angle, joints.rooms, made.share)
    return made


# -- in call order ---------------------------------------------------------------------------------


@kernel
def _turn(spans, down, angles, heading, low, high, count, angle, whole):  # type: ignore[no-untyped-def]
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
            if over * angle[f] < -1e-9:
                part = max(part, -over / angle[f])
        part = min(part, MOST)
        least, most = 0.0, 0.0
        for f in range(first, end):
            angle[f] *= part
            least, most = min(least, angle[f]), max(most, angle[f])
        whole[i] = most - least


@kernel
def _speed(at, down, count):  # type: ignore[no-untyped-def]
    """1 while a foot is free to turn, smoothly from and to 0 at both ends."""
    first, last = down[0], down[1] - 1
    ramp = min(float(count), 0.5 * (last - first))
    u = min(at - first, last - at) / ramp if ramp > 0.0 else 0.0
    u = min(max(u, 0.0), 1.0)
    return u * u * u * (10.0 + u * (6.0 * u - 15.0))


@kernel
def _share(spans, angles, heading, angle, rooms, share):  # type: ignore[no-untyped-def]
    """The part of the turn that the hip takes: half, unless hip or ankle has no room for that."""
    for i in range(len(spans)):
        least, most = 0.0, 1.0
        for f in range(spans[i, 0], spans[i, 1]):
            turn = angles[i] + angle[f] - heading[f]
            size, way = abs(turn), 0 if turn > 0.0 else 1
            if size > 1e-9:
                least, most = max(least, 1.0 - rooms[f, 1, way] / size), min(most, rooms[f, 0, way] / size)
        share[i] = min(max(share[i], least), most) if least <= most else 0.5 * (least + most)
