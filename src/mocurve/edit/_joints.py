"""What hips and ankles of people can do, and how far legs that are set anew go beyond it.

A hip is watched by how far the thigh has swung out of the middle of a cone, and how far it is twisted about itself, as
`limit` does it and with its ranges; an ankle by how far the sole is bent up towards the shank, and turned out of the
plane of the leg, which is in part the shank's turn against the thigh: the knee is a hinge here. Whatever a leg does in
the clip itself it may do. Compiled: every edit asks for it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from .._jit import kernel
from ._anatomy import ALLOWANCE, CONES, TWISTS
from ._hinge import SWIVEL, Hinge

# degrees, lowest and highest: swing of the hip out of the middle of its cone and its twist to the left, as `limit` has
# them; bend of the ankle, down 50 (AAOS 1965), up 40 with the weight on it (Konor et al. 2012; 20 without); turn of the
# foot to the left, 30 and more of the shank, 20 of the foot (Kapandji, The Physiology of the Joints 2)
PEOPLE = np.array(
    [
        [0.0, CONES["knee"][1]],
        [-TWISTS["knee"], TWISTS["knee"]],
        [-50.0 - ALLOWANCE, 40.0 + ALLOWANCE],
        [-30.0 - 20.0, 30.0 + 20.0],
    ]
)
SLACK = np.radians(5.0)  # a joint may always be turned by as much: a clip at the end of a range is no reason to pivot
COMFORT = np.radians(30.0)  # how far a foot is turned against its body, more than it ever is in the clip
UPRIGHT = 0.3  # of a bone's length: as much of a turn about the vertical is its own twist at least

Vectors = tuple[np.ndarray, np.ndarray, np.ndarray]
Numbers = tuple[float, ...]


@dataclass(frozen=True, eq=False)
class Joints:
    """Hip and ankle of a leg in the source, as the world sees them.

    vectors:   (F, 6, 3) of length 1: the thigh, from hip to knee; the axis of the knee; the middle of the hip's cone,
               and where the knee's axis points there without twist; the shank, from ankle to knee; the sole, from heel
               to ball.
    ends:      (4, 2) degrees, what the leg may do: what people can, and what it does in the source.
    rooms:     (F, 2, 2) radians by how much more hip, then ankle, may be turned about the vertical, left, then right.
    turned:    (F,) radians by how much the foot is turned to the left of where the body faces. most: (2,) to the right
               (negative) and to the left, the most of it while the foot stands.
    low, high: (F,) radians by how much a foot may be turned against its body, to the right (negative) and to the left:
               COMFORT more than it ever is while it stands in the source, and no more than hip and ankle can.
    """

    vectors: np.ndarray
    ends: np.ndarray
    rooms: np.ndarray
    turned: np.ndarray
    most: np.ndarray
    low: np.ndarray
    high: np.ndarray

    def cut(self, span: slice) -> Joints:
        """Some of the frames."""
        parts = {name: getattr(self, name)[span] for name in ("vectors", "rooms", "turned", "low", "high")}
        return replace(self, **parts)

    def more(self, turn: np.ndarray) -> np.ndarray:
        """By how much (F,), radians, a foot turned by (F,) against the body is turned more than it ever is while it
        stands in the source."""
        there = self.turned + turn
        return np.minimum(np.abs(turn), np.maximum(np.maximum(there - self.most[1], self.most[0] - there), 0.0))

    def share(self, turn: np.ndarray) -> np.ndarray:
        """The part (F,) of such a turn that the hip makes: half, unless hip or ankle comes near its end."""
        part = np.full(len(turn), SWIVEL)
        _share(turn, self.rooms, part)
        return part

    def beyond(self, thigh: np.ndarray, shank: np.ndarray, foot: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """By how many degrees (F,) hip and ankle are beyond what they may, where thigh (against the body), shank and
        foot are turned (F, 4) against the source."""
        over = np.zeros((2, len(foot)))
        _beyond(self.vectors, thigh, shank, foot, self.ends, over)
        return over[0], over[1]


def joints_of(hinge: Hinge, above: np.ndarray, other: np.ndarray, sole: np.ndarray, stands: np.ndarray) -> Joints:
    """Hip and ankle of a leg. above: (F, 4) how the world sees what carries the hip; other: (F, 3) the other hip; sole:
    (F, 3) from heel to ball; stands: (F,) where it does.

    Up is where the world's up is on the mean, as the body sees it; left is along the line of the hips, to where the
    knee's axis points, about which it bends back.
    """
    frames = len(above)
    means, vectors, angles = np.zeros((3, 3)), np.zeros((frames, 6, 3)), np.zeros((frames, 4))
    rooms, turned = np.zeros((frames, 2, 2)), np.zeros(frames)
    _mean(above, hinge.hip - other, hinge.knee, hinge.axis, means)
    _see(_ways(*means), above, (hinge.knee, hinge.p, hinge.axis), (hinge.hip, hinge.ankle, sole), vectors, turned)
    _angles(vectors, angles)
    low, high = (angles.min(axis=0), angles.max(axis=0)) if frames else PEOPLE.T
    ends = np.stack([np.minimum(low, PEOPLE[:, 0]), np.maximum(high, PEOPLE[:, 1])], axis=1)
    _rooms(vectors, angles, ends, rooms)
    own = turned[stands]
    most = np.array([own.min(), own.max()]) if len(own) else np.zeros(2)
    right, left = np.minimum(most[0] - turned, 0.0) - COMFORT, np.maximum(most[1] - turned, 0.0) + COMFORT
    right, left = np.maximum(right, -rooms[:, :, 1].sum(axis=1)), np.minimum(left, rooms[:, :, 0].sum(axis=1))
    return Joints(vectors, ends, rooms, turned, most, right, left)


def saturated(values: np.ndarray, limit: np.ndarray, over: float) -> np.ndarray:
    """Values up to a limit as they are, above it never more than `over` beyond it, smooth to the second derivative."""
    return np.where(values > limit, limit + over * np.tanh((values - limit) / over), values)


# -- in call order ---------------------------------------------------------------------------------


@kernel
def _share(turn: np.ndarray, rooms: np.ndarray, part: np.ndarray) -> None:
    """Each joint makes half up to half of its room, then less and less, never more than all of it; the other the
    rest."""
    for f in range(len(turn)):
        half, way = 0.5 * abs(turn[f]), 0 if turn[f] > 0.0 else 1
        for joint in range(2):
            knee = 0.5 * rooms[f, joint, way]
            if half > knee:
                rest = half - knee - knee * np.tanh((half - knee) / knee)
                part[f] += (rest if joint == 1 else -rest) / (2.0 * half)


def _ways(up: np.ndarray, across: np.ndarray, axis: np.ndarray) -> np.ndarray:
    """(3, 3) the middle of the hip's cone, left and ahead, as the body sees them."""
    up = up / max(np.linalg.norm(up), 1e-9)
    left = across if across @ axis > 0 else -across
    left = left - (left @ up) * up
    left = left / max(np.linalg.norm(left), 1e-9)
    _, down, forwards = CONES["knee"][0]
    ahead = np.cross(left, up)
    return np.stack([down * up + forwards * ahead, left, ahead])


@kernel
def _mean(above: np.ndarray, across: np.ndarray, knee: np.ndarray, axis: np.ndarray, means: np.ndarray) -> None:
    """Where up, the line of the hips and the axis of the knee are for the body on the mean, (3, 3)."""
    up, seen, made = np.array([0.0, 1.0, 0.0]), np.empty(3), np.empty(3)
    back = np.empty(4)
    for f in range(len(above)):
        back[0], back[1], back[2], back[3] = above[f, 0], -above[f, 1], -above[f, 2], -above[f, 3]
        _rotate(knee[f], axis, seen)
        for i in range(3):
            _rotate(back, up if i == 0 else across[f] if i == 1 else seen, made)
            for j in range(3):
                means[i, j] += made[j] / len(above)


@kernel
def _see(
    ways: np.ndarray, above: np.ndarray, leg: Vectors, places: Vectors, vectors: np.ndarray, turned: np.ndarray
) -> None:
    """Fill in the vectors (F, 6, 3), and how the foot is turned (F,)."""
    knee, p, axis = leg
    hip, ankle, sole = places
    ahead = np.empty(3)
    for f in range(len(above)):
        v = vectors[f]
        _rotate(knee[f], p[f], v[0])
        _rotate(knee[f], axis, v[1])
        _rotate(above[f], ways[0], v[2])
        _rotate(above[f], ways[1], v[3])
        _rotate(above[f], ways[2], ahead)
        alone = sole[f, 0] == 0.0 and sole[f, 1] == 0.0 and sole[f, 2] == 0.0  # no foot to turn
        for j in range(3):
            v[0, j] = -v[0, j]
            v[4, j] = hip[f, j] + v[0, j] - ankle[f, j]
            v[5, j] = ahead[j] if alone else sole[f, j]
        for i in range(6):
            size = np.sqrt(v[i, 0] ** 2 + v[i, 1] ** 2 + v[i, 2] ** 2)
            for j in range(3):
                v[i, j] /= max(size, 1e-12)
        turned[f] = np.arctan2(v[5, 0] * ahead[2] - v[5, 2] * ahead[0], v[5, 0] * ahead[0] + v[5, 2] * ahead[2])


@kernel
def _angles(vectors: np.ndarray, angles: np.ndarray) -> None:
    """Angles (F, 4), degrees, as they stand."""
    for f in range(len(vectors)):
        v = vectors[f]
        _put(_of_hip(v[0], v[1], v[2], v[3]), _of_ankle(v[4], v[1], v[5]), angles[f])


@kernel
def _put(hip: Numbers, ankle: Numbers, angles: np.ndarray) -> None:
    angles[0] = np.degrees(np.arccos(min(max(hip[0], -1.0), 1.0)))
    angles[1] = np.degrees(np.arctan2(hip[2], hip[1]))
    angles[2] = np.degrees(np.arcsin(min(max(ankle[0], -1.0), 1.0)))
    angles[3] = np.degrees(np.arcsin(min(max(ankle[1], -1.0), 1.0)))


@kernel
def _rooms(vectors: np.ndarray, angles: np.ndarray, ends: np.ndarray, rooms: np.ndarray) -> None:
    for f in range(len(vectors)):
        v = vectors[f]
        for joint in range(2):
            along = abs(v[0, 1]) if joint == 0 else np.sqrt(v[5, 0] ** 2 + v[5, 2] ** 2)
            angle, end = angles[f, 2 * joint + 1], ends[2 * joint + 1]
            for way in range(2):
                room = end[1] - angle if way == 0 else angle - end[0]
                rooms[f, joint, way] = max(np.radians(room) / max(along, UPRIGHT), SLACK)


@kernel
def _beyond(
    vectors: np.ndarray, thigh: np.ndarray, shank: np.ndarray, foot: np.ndarray, ends: np.ndarray, over: np.ndarray
) -> None:
    """How far hips and ankles are beyond their ends, (2, F), with thigh, shank and foot turned."""
    moved, found = np.empty((5, 3)), np.empty(4)
    swing, twist = np.cos(np.radians(ends[0, 1])), 1.0 / np.tan(np.radians(min(-ends[1, 0], ends[1, 1])))
    low, high = np.sin(np.radians(ends[2, 0])), np.sin(np.radians(ends[2, 1]))
    turn = np.sin(np.radians(min(-ends[3, 0], ends[3, 1])))
    for f in range(len(vectors)):
        v = vectors[f]
        _rotate(thigh[f], v[0], moved[0])
        _rotate(thigh[f], v[1], moved[1])
        _rotate(shank[f], v[4], moved[2])
        _rotate(shank[f], v[1], moved[3])
        _rotate(foot[f], v[5], moved[4])
        hip = _of_hip(moved[0], moved[1], v[2], v[3])
        ankle = _of_ankle(moved[2], moved[3], moved[4])
        if hip[0] < swing or hip[1] <= twist * abs(hip[2]) or not low <= ankle[0] <= high or abs(ankle[1]) > turn:
            _put(hip, ankle, found)
            for i in range(4):
                over[i // 2, f] = max(over[i // 2, f], found[i] - ends[i, 1], ends[i, 0] - found[i])


@kernel
def _of_hip(limb: np.ndarray, axis: np.ndarray, centre: np.ndarray, zero: np.ndarray) -> Numbers:
    """The cosine of the swing, and the twist as cosine and sine, unscaled: what the shortest way from the middle makes
    of `zero` is no twist."""
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
    return near, straight, -across  # about the way up the limb: a turn to the left is positive


@kernel
def _of_ankle(shank: np.ndarray, axis: np.ndarray, sole: np.ndarray) -> Numbers:
    """How far a sole is bent up towards the shank, and turned out of the plane of the leg to the left: sines."""
    up = sole[0] * shank[0] + sole[1] * shank[1] + sole[2] * shank[2]
    return up, sole[0] * axis[0] + sole[1] * axis[1] + sole[2] * axis[2]


@kernel
def _rotate(q: np.ndarray, vector: np.ndarray, made: np.ndarray) -> None:
    x = 2.0 * (q[2] * vector[2] - q[3] * vector[1])
    y = 2.0 * (q[3] * vector[0] - q[1] * vector[2])
    z = 2.0 * (q[1] * vector[1] - q[2] * vector[0])
    made[0] = vector[0] + q[0] * x + q[2] * z - q[3] * y
    made[1] = vector[1] + q[0] * y + q[3] * x - q[1] * z
    made[2] = vector[2] + q[0] * z + q[1] * y - q[2] * x
