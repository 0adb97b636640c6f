"""What hips and ankles of people can do, and how far legs that are set anew go beyond it.

A hip is watched by how far the thigh has swung out of the middle of a cone, and how far it is twisted about itself, as
`limit` does it and with its ranges; an ankle by how far the sole is bent up towards the shank, and turned out of the
plane of the leg, which is in part the shank's turn against the thigh: the knee is a hinge here. Whatever a leg does in
the clip itself it may do.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from .. import rotation
from .._jit import kernel
from ._anatomy import ALLOWANCE, CONES, TWISTS
from ._hinge import Hinge

# degrees: swing of the hip out of the middle of its cone, its twist to the left, bend of the ankle upwards (AAOS 1965:
# 20 up and 50 down), turn of the foot to the left (Kapandji, The Physiology of the Joints 2: of the shank 30 and 40, of
# the foot 35 to 45 in all, that is 20 either way); lowest and highest
PEOPLE = np.array(
    [
        [0.0, CONES["knee"][1]],
        [-TWISTS["knee"], TWISTS["knee"]],
        [-50.0 - ALLOWANCE, 20.0 + ALLOWANCE],
        [-30.0 - 20.0, 30.0 + 20.0],
    ]
)
SLACK = 5.0  # degrees that a joint may always be twisted: a clip at the end of a range is no reason to turn a foot
COMFORT = np.radians(30.0)  # how far a foot is turned against its body, more than it ever is in the clip
UPRIGHT = 0.3  # of a bone's length: as much of a turn about the vertical is its own twist at least


@dataclass(frozen=True, eq=False)
class Joints:
    """Hip and ankle of a leg in the source, as the world sees them.

    vectors: (F, 6, 3) of length 1: the thigh, from hip to knee; the axis of the knee; the middle of the hip's cone, and
    where the knee's axis points there without twist; the shank, from ankle to knee; the sole, from heel to ball.
    ends:    (4, 2) degrees, what the leg may do: what people can, and what it does in the source.
    rooms:   (F, 2, 2) radians by how much more hip, then ankle, may be turned about the vertical, left, then right.
    turned:  (F,) radians by how much the foot is turned to the left of where the body faces. most: (2,) to the right
    and to the left, the most of it while the foot stands.
    """

    vectors: np.ndarray
    ends: np.ndarray
    rooms: np.ndarray
    turned: np.ndarray
    most: np.ndarray

    def cut(self, span: slice) -> Joints:
        """Some of the frames."""
        return replace(self, vectors=self.vectors[span], rooms=self.rooms[span], turned=self.turned[span])

    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        """By how much (F,), radians, a foot may be turned against its body in every frame, to the right (negative) and
        to the left: COMFORT more than it ever is while it stands in the source, and no more than hip and ankle can."""
        own, most = self.turned, self.most
        low, high = np.minimum(most[0] - own, 0.0) - COMFORT, np.maximum(most[1] - own, 0.0) + COMFORT
        left, right = self.rooms.sum(axis=1).T
        return np.maximum(low, -right), np.minimum(high, left)

    def more(self, turn: np.ndarray) -> np.ndarray:
        """By how much (F,), radians, a foot turned by (F,) against the body is turned more than it ever is while it
        stands in the source."""
        there = self.turned + turn
        return np.minimum(np.abs(turn), np.maximum(np.maximum(there - self.most[1], self.most[0] - there), 0.0))

    def share(self, turn: np.ndarray) -> np.ndarray:
        """The part (F,) of such a turn that the hip makes: half, unless hip or ankle comes near its end."""
        half = 0.5 * np.abs(turn)
        rooms = np.where(turn[:, None] > 0, self.rooms[:, :, 0], self.rooms[:, :, 1])
        if not (half[:, None] > 0.5 * rooms).any():
            return np.full(len(turn), 0.5)
        rest = half[:, None] - saturated(half[:, None], 0.5 * rooms, 0.5 * rooms)
        return 0.5 + (rest[:, 1] - rest[:, 0]) / np.maximum(2.0 * half, 1e-9)

    def beyond(self, thigh: np.ndarray, shank: np.ndarray, yaw: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """By how many degrees (F,) hip and ankle are beyond what they may, where thigh (against the body) and shank are
        turned (F, 4) and the foot about the vertical, (F,) radians, all against the source."""
        over = np.zeros((len(yaw), 2))
        _beyond(self.vectors, thigh, shank, yaw, self.ends, over)
        return over[:, 0], over[:, 1]


def joints_of(hinge: Hinge, above: np.ndarray, other: np.ndarray, sole: np.ndarray, stands: np.ndarray) -> Joints:
    """Hip and ankle of a leg. above: (F, 4) how the world sees what carries the hip; other: (F, 3) the other hip; sole:
    (F, 3) from heel to ball; stands: (F,) where it does.

    Up is where the world's up is on the mean, as the body sees it; left is along the line of the hips, to where the
    knee's axis points, about which it bends back.
    """
    thigh, axis = -rotation.rotate(hinge.knee, hinge.p), rotation.rotate(hinge.knee, hinge.axis)
    centre, left, ahead = _ways(above, hinge.hip - other, axis)
    sole = np.where(sole.any(axis=1, keepdims=True), sole, ahead)  # no foot to turn
    vectors = np.stack([thigh, axis, centre, left, hinge.hip + thigh - hinge.ankle, sole], axis=1)
    vectors /= np.maximum(np.linalg.norm(vectors, axis=2, keepdims=True), 1e-12)
    angles = np.zeros((len(vectors), 4))
    _angles(vectors, angles)
    ends = np.stack([angles.min(axis=0, initial=np.inf), angles.max(axis=0, initial=-np.inf)], axis=1)
    ends = np.stack([np.minimum(ends[:, 0], PEOPLE[:, 0]), np.maximum(ends[:, 1], PEOPLE[:, 1])], axis=1)
    turned = np.angle((sole[:, 2] + 1j * sole[:, 0]) * (ahead[:, 2] - 1j * ahead[:, 0]))
    own = turned[stands]
    most = np.array([own.min(), own.max()]) if len(own) else np.zeros(2)
    return Joints(vectors, ends, _rooms(vectors, angles, ends), turned, most)


def saturated(values: np.ndarray, limit: np.ndarray, over: np.ndarray | float) -> np.ndarray:
    """Values up to a limit as they are, above it never more than `over` beyond it, smooth to the second derivative."""
    return np.where(values > limit, limit + over * np.tanh((values - limit) / over), values)


# -- in call order ---------------------------------------------------------------------------------


def _ways(above: np.ndarray, across: np.ndarray, axis: np.ndarray) -> list[np.ndarray]:
    """Where (F, 3) the middle of the hip's cone, left and ahead are in every frame."""
    if not len(above):
        return [axis, axis, axis]
    back = rotation.inv(above)
    up, left, side = (
        rotation.rotate(back, vectors).mean(axis=0) for vectors in (np.array([[0.0, 1.0, 0.0]]), across, axis)
    )
    left = left if left @ side > 0 else -left
    up /= max(np.linalg.norm(up), 1e-9)
    left = left - (left @ up) * up
    left /= max(np.linalg.norm(left), 1e-9)
    _, down, forwards = CONES["knee"][0]
    ahead = np.cross(left, up)
    return [rotation.rotate(above, way) for way in (down * up + forwards * ahead, left, ahead)]


def _rooms(vectors: np.ndarray, angles: np.ndarray, ends: np.ndarray) -> np.ndarray:
    twists = angles[:, [1, 3]]
    rooms = np.stack([ends[[1, 3], 1] - twists, twists - ends[[1, 3], 0]], axis=-1)
    along = np.stack([np.abs(vectors[:, 0, 1]), np.hypot(vectors[:, 5, 0], vectors[:, 5, 2])], axis=1)
    along = np.maximum(along, UPRIGHT)
    return np.radians(np.maximum(rooms / along[..., None], SLACK))


@kernel
def _angles(vectors, angles):  # type: ignore[no-untyped-def]
    """Angles (F, 4), degrees, as they stand."""
    for f in range(len(vectors)):
        v = vectors[f]
        angles[f, 0], angles[f, 1] = _of_hip(v[0], v[1], v[2], v[3])
        angles[f, 2], angles[f, 3] = _of_ankle(v[4], v[1], v[5])


@kernel
def _beyond(vectors, thigh, shank, yaw, ends, over):  # type: ignore[no-untyped-def]
    """How far hips and ankles are beyond their ends, (F, 2), with thigh, shank and foot turned."""
    found = np.empty(4)
    moved = np.empty((5, 3))
    for f in range(len(vectors)):
        v = vectors[f]
        _rotate(thigh[f], v[0], moved[0])
        _rotate(thigh[f], v[1], moved[1])
        _rotate(shank[f], v[4], moved[2])
        _rotate(shank[f], v[1], moved[3])
        cosine, sine = np.cos(yaw[f]), np.sin(yaw[f])
        moved[4, 0] = cosine * v[5, 0] + sine * v[5, 2]
        moved[4, 1] = v[5, 1]
        moved[4, 2] = cosine * v[5, 2] - sine * v[5, 0]
        found[0], found[1] = _of_hip(moved[0], moved[1], v[2], v[3])
        found[2], found[3] = _of_ankle(moved[2], moved[3], moved[4])
        for i in range(4):
            away = max(ends[i, 0] - found[i], found[i] - ends[i, 1])
            over[f, i // 2] = max(over[f, i // 2], away)


@kernel
def _of_hip(limb, axis, centre, zero):  # type: ignore[no-untyped-def]
    """Swing and twist, degrees: what the shortest way from the middle makes of `zero` is no twist."""
    near = limb[0] * centre[0] + limb[1] * centre[1] + limb[2] * centre[2]
    along = (limb[0] * zero[0] + limb[1] * zero[1] + limb[2] * zero[2]) / max(1.0 + near, 1e-9)
    x = zero[0] - along * (limb[0] + centre[0])
    y = zero[1] - along * (limb[1] + centre[1])
    z = zero[2] - along * (limb[2] + centre[2])
    straight = x * axis[0] + y * axis[1] + z * axis[2]
    across = (
        limb[0] * (y * axis[2] - z * axis[1])
        + limb[1] * (z * axis[0] - x * axis[2])
        + limb[2] * (x * axis[1] - y * axis[0])
    )
    # about the way up the limb: a turn to the left is positive
    return np.degrees(np.arccos(min(max(near, -1.0), 1.0))), -np.degrees(np.arctan2(across, straight))


@kernel
def _of_ankle(shank, axis, sole):  # type: ignore[no-untyped-def]
    """How far, degrees, a sole is bent up towards the shank, and turned out of the plane of the leg to the left."""
    up = sole[0] * shank[0] + sole[1] * shank[1] + sole[2] * shank[2]
    left = sole[0] * axis[0] + sole[1] * axis[1] + sole[2] * axis[2]
    return np.degrees(np.arcsin(min(max(up, -1.0), 1.0))), np.degrees(np.arcsin(min(max(left, -1.0), 1.0)))


@kernel
def _rotate(q, vector, made):  # type: ignore[no-untyped-def]
    x = 2.0 * (q[2] * vector[2] - q[3] * vector[1])
    y = 2.0 * (q[3] * vector[0] - q[1] * vector[2])
    z = 2.0 * (q[1] * vector[1] - q[2] * vector[0])
    made[0] = vector[0] + q[0] * x + q[2] * z - q[3] * y
    made[1] = vector[1] + q[0] * y + q[3] * x - q[1] * z
    made[2] = vector[2] + q[0] * z + q[1] * y - q[2] * x
