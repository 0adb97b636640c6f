"""Where feet are to be while the body is carried elsewhere: footprints stay, swings go with the body.

carry (F, 4) takes the body of each frame elsewhere: angle, x, z, and how far up. A foot that stands is taken by one
transform for the whole contact, the mean of the carries over it (Gleicher 2001, Motion path editing, section 4, freezes
one), and so does not move. What this leaves between the foot and its carried body is, in the body's frame, led through
the swings: the swinging foot follows the body.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from .. import planar, rotation
from ._hinge import Hinge
from ._joints import Joints
from ._pivots import Pivots, pivots
from ._stances import GROUND, Stances
from ._swings import filled

LEAST, MOVES = 1.0, 5.5  # cm that a footprint may move to relieve its knee: evenly carried, and unevenly
STAYS = 1e-6  # cm, where somebody said the place
BENDS = np.radians(6.0)  # flexion that is as bad


@dataclass(frozen=True, eq=False)
class Prints:
    """The footprints of a leg: transforms (N, 3), angle, x, z, that take each stance of the source to where it is now;
    by how much (N,), cm, it is lifted; how far (N,), cm, the carries are from there, which is how far they may move;
    the rotation vectors (N, 2), about x and z, that lay soles along a slope, None on level ground; and how feet turn on
    the spot. below: (N, 3) what is under them in the source, as `_heights` has it, once it is known."""

    taken: np.ndarray
    lift: np.ndarray
    uneven: np.ndarray
    pivots: Pivots
    tilt: np.ndarray | None = None
    below: np.ndarray | None = None

    def cut(self, some: slice, span: slice) -> Prints:
        """Some of the stances, in some of the frames."""
        tilt, below = (None if part is None else part[some] for part in (self.tilt, self.below))
        turns = self.pivots.cut(span, some)
        return Prints(self.taken[some], self.lift[some], self.uneven[some], turns, tilt, below)


@dataclass(frozen=True, eq=False)
class Targets:
    """Where a leg is to be: ball and ankle (F, 3), cm, by how much the foot is turned, (F,) radians, and by which
    rotation (F, 4) it is then laid along a slope, None on level ground."""

    ball: np.ndarray
    ankle: np.ndarray
    yaw: np.ndarray
    tilt: np.ndarray | None = None


def prints(stances: Stances, carry: np.ndarray, joints: Joints, frame_time: float) -> Prints:
    """Footprints where the body passes on the mean, turning on the spot where it turns too far for hip and ankle."""
    there = planar.move(carry, stances.places[np.maximum(stances.of, 0)]) if len(stances.spans) else None
    if there is None:
        none = np.zeros(0)
        return Prints(np.zeros((0, 3)), none, none, pivots(stances, none, carry[:, 0], joints, frame_time))
    angle = stances.mean(carry[:, :1])
    place = stances.mean(there)
    turned = planar.move(np.concatenate([angle, 0.0 * angle, 0.0 * angle], axis=1), stances.places)
    taken = np.concatenate([angle, (place - turned)[:, GROUND]], axis=1)
    away = np.linalg.norm(there - place[np.maximum(stances.of, 0)], axis=1)
    turns = np.abs(carry[:, 0] - angle[np.maximum(stances.of, 0), 0])
    uneven = np.zeros(len(taken))
    inside = stances.of >= 0
    np.maximum.at(uneven, stances.of[inside], np.maximum(away, 10.0 * turns)[inside])  # a foot is 10 cm either way
    turns = pivots(stances, taken[:, 0], carry[:, 0], joints, frame_time)
    return Prints(taken, np.zeros(len(taken)), uneven, turns)


def targets(
    stances: Stances,
    prints: Prints,
    carry: np.ndarray,
    pinned: np.ndarray,
    offset: np.ndarray,
    flat: np.ndarray,
    frame_time: float,
) -> Targets:
    """Where the foot is to be in every frame. pinned: (F, 3) the ball held still in the source (`Stances.pinned`);
    offset: (F, 3) from ball to ankle there; flat: (F,) which part of a slope's tilt the foot takes on.

    Over the ground, places are complex numbers z + i x, which a turn by an angle multiplies by exp(i angle).
    """
    inside = stances.of >= 0
    place, turn, shift = _ground(pinned), np.exp(1j * carry[:, 0]), carry[:, 2] + 1j * carry[:, 1]
    away = np.zeros((len(pinned), 4))
    taken = prints.taken[stances.of[inside]]
    stands = np.exp(1j * taken[:, 0]) * place[inside] + taken[:, 2] + 1j * taken[:, 1]
    yaws = taken[:, 0]
    if prints.pivots.whole.any():
        more, about = prints.pivots.angle[inside], _ground(stances.places[stances.of[inside]])
        stands = stands + np.exp(1j * yaws) * (np.exp(1j * more) - 1.0) * (place[inside] - about)
        yaws = yaws + more
    off = np.conj(turn[inside]) * (stands - shift[inside]) - place[inside]
    away[inside, 0], away[inside, 1], away[inside, 2] = off.imag, off.real, yaws - carry[inside, 0]
    lift = prints.lift[stances.of[inside]]
    away[inside, 3] = lift - carry[inside, 3]
    away = filled(away, stances.spans, frame_time)
    away[~inside, 2] = prints.pivots.swung(away[:, 2])[~inside]
    there, yaw = turn * (place + away[:, 1] + 1j * away[:, 0]) + shift, carry[:, 0] + away[:, 2]
    there[inside], yaw[inside] = stands, yaws  # not by way of the body: a foot that stands is still
    up, rise, tilt = np.exp(1j * yaw) * _ground(offset), offset[:, 1], None
    height = pinned[:, 1] + carry[:, 3] + away[:, 3]
    height[inside] = pinned[inside, 1] + lift
    if prints.tilt is not None:
        tilt = _tilted(stances, prints.tilt, flat, frame_time)
        up, rise = _leant(tilt, up, rise)
    ankle = there + up
    return Targets(
        np.column_stack([there.imag, height, there.real]),
        np.column_stack([ankle.imag, height + rise, ankle.real]),
        yaw,
        tilt,
    )


def _tilted(stances: Stances, tilt: np.ndarray, flat: np.ndarray, frame_time: float) -> np.ndarray:
    """The rotations (F, 4) of feet that are laid along a slope in their stances (N, 2)."""
    vectors = np.zeros((len(flat), 2))
    inside = stances.of >= 0
    vectors[inside] = tilt[stances.of[inside]]
    vectors = flat[:, None] * filled(vectors, stances.spans, frame_time)
    return rotation.exp(np.stack([vectors[:, 0], 0.0 * flat, vectors[:, 1]], axis=1))


def _leant(tilt: np.ndarray, along: np.ndarray, up: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """What lies along the ground (F,) and up (F,), rotated (F, 4)."""
    made = rotation.rotate(tilt, np.stack([along.imag, up, along.real], axis=1))
    return _ground(made), made[:, 1]


def _ground(places: np.ndarray) -> np.ndarray:
    return places[:, 2] + 1j * places[:, 0]


def relieved(
    prints: Prints, stances: Stances, hinge: Hinge, hip: np.ndarray, target: np.ndarray, wanted: np.ndarray
) -> Prints:
    """Each footprint moved over the ground so that its own knee bends as wanted: two unknowns a stance."""
    inside = np.flatnonzero(stances.of >= 0)
    if not len(inside):
        return prints
    to = (hip - target)[inside]
    length = np.linalg.norm(to, axis=1)
    flexion, slope = (part[inside] for part in hinge.bend(np.linalg.norm(hip - target, axis=1)))
    gx, gz = -slope * to[:, 0] / length, -slope * to[:, 2] / length
    off = flexion - wanted[inside]
    xx, xz, zz, x, z, count = (
        np.bincount(stances.of[inside], part, len(prints.taken))
        for part in (gx * gx, gx * gz, gz * gz, -gx * off, -gz * off, np.ones(len(inside)))
    )
    free = np.where(stances.placed, STAYS, np.clip(prints.uneven, LEAST, MOVES))
    ridge = (BENDS / free) ** 2 * count
    xx, zz = xx + ridge, zz + ridge
    size = xx * zz - xz * xz
    taken = prints.taken.copy()
    taken[:, 1] += (zz * x - xz * z) / size
    taken[:, 2] += (xx * z - xz * x) / size
    return replace(prints, taken=taken)
