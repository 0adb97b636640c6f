"""A leg as hip, a knee that is a fixed hinge, and ankle: its length from the bend of the knee, and back, closed form.

The hinge is one axis for the whole clip, so the bend has a sign and does not flip where the leg is straight. The axis
need not stand at right angles to the bones: with p from knee to hip and q from knee to ankle, parts along it included,
the distance from hip to ankle is sqrt(C + 2 D cos(flexion)).
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace

import numpy as np

from .. import rotation
from ..errors import Mismatch
from ..feet.legs import Leg
from ..motion import Motion

STRAIGHT = np.radians(6.0)  # flexion below which its length is continued as a straight line, when the pelvis is placed
DAMPED = np.radians(25.0)  # the same for a leg that swings: there the knee is damped
MOST = np.radians(15.0)  # how far the damped knee goes from where it was wanted
RIGID = 0.03  # sine of the bend: a knee that never bends more has no axis of its own
TURNING = np.radians(20.0)  # in all, there and back: a knee that turns less tells no axis
LEAST = np.radians(1.0)  # flexion that a swinging knee keeps, unless the source had less
SWIVEL = 0.5  # part of the foot's extra turn that the whole leg makes, so that the ankle need not


@dataclass(frozen=True, eq=False)
class Hinge:
    """One leg in the source, cm and radians.

    hip, ankle: places (F, 3). thigh, knee, shin, foot: how the world sees the axes (F, 4) of the hip, of what carries
    the knee (the hip, or a twist joint below it), of the knee and of the ankle.
    axis: (3,) of the hinge, in the frame of what carries the knee; there too, p: knee to hip, q: knee to ankle (F, 3).
    c, d, flexion: (F,) as above.
    """

    hip: np.ndarray
    ankle: np.ndarray
    thigh: np.ndarray
    knee: np.ndarray
    shin: np.ndarray
    foot: np.ndarray
    axis: np.ndarray
    p: np.ndarray
    q: np.ndarray
    c: np.ndarray
    d: np.ndarray
    flexion: np.ndarray

    def cut(self, span: slice) -> Hinge:
        """Some of the frames."""
        return replace(self, **{f.name: getattr(self, f.name)[span] for f in fields(self) if f.name != "axis"})

    def length(self, flexion: np.ndarray) -> np.ndarray:
        """From hip to ankle (F,)."""
        return np.sqrt(self.c + 2.0 * self.d * np.cos(flexion))

    def bend(self, length: np.ndarray, straight: float = STRAIGHT) -> tuple[np.ndarray, np.ndarray]:
        """Flexion (F,) for lengths (F,), and its derivative: exact above `straight`, below it a straight line, which
        goes on below zero where the leg is too short."""
        cosine = np.minimum((length * length - self.c) / (2.0 * self.d), np.cos(straight))
        flexion = np.arccos(np.maximum(cosine, -1.0))
        end = np.sqrt(self.c + 2.0 * self.d * np.cos(straight))
        slope = -end / (self.d * np.sin(straight))
        over = np.maximum(length - end, 0.0)
        inner = -length / (self.d * np.maximum(np.sin(flexion), 1e-6))
        return flexion + over * slope, np.where(over > 0, slope, inner)


def hinge_of(motion: Motion, leg: Leg, places: np.ndarray, turned: np.ndarray) -> Hinge:
    """The hinge of a leg. places: (F, J, 3), cm; turned: (F, 4, 4) of hip, what carries the knee, knee and ankle."""
    hip, knee, ankle, ball = (places[:, joint] for joint in (leg.hip, leg.knee, leg.ankle, leg.ball))
    thigh, carrier, shin, foot = np.moveaxis(turned, 1, 0)
    back = rotation.inv(carrier)
    p, q = rotation.rotate(back, hip - knee), rotation.rotate(back, ankle - knee)
    axis = _axis(p, q, rotation.rotate(back, ball - ankle), rotation.mul(back, shin))
    along_p, along_q = p @ axis, q @ axis
    across_p, across_q = p - along_p[:, None] * axis, q - along_q[:, None] * axis
    d = np.linalg.norm(across_p, axis=1) * np.linalg.norm(across_q, axis=1)
    if not (d > 0).all():
        names = motion.skeleton.names
        raise Mismatch(f"the leg from {names[leg.hip]!r} to {names[leg.ankle]!r} has a bone without length")
    c = (p * p).sum(axis=1) + (q * q).sum(axis=1) - 2.0 * along_p * along_q
    turn = np.arctan2(np.cross(across_p, across_q) @ axis, (across_p * across_q).sum(axis=1))
    flexion = np.remainder(turn, 2.0 * np.pi) - np.pi  # p and q point away from one another where the leg is straight
    return Hinge(hip, ankle, thigh, carrier, shin, foot, axis, p, q, c, d, flexion)


def reached(
    hinge: Hinge,
    hip: np.ndarray,
    target: np.ndarray,
    yaw: np.ndarray,
    heading: np.ndarray,
    wanted: np.ndarray,
    exact: np.ndarray,
    swivel: float | np.ndarray = SWIVEL,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The leg from hips (F, 3) to ankle targets (F, 3): the turn of the whole leg as the world sees it (F, 4), the turn
    of the knee in the frame of what carries it (F, 4), and by how much (F,), cm, the ankle falls short.

    yaw, heading: (F,) by how much the foot and the body are turned against the source. wanted: (F,) flexion. exact:
    (F,) 1 where the target is reached to the last digit, 0 where the knee is damped instead of snapping straight.
    swivel: part, or parts (F,), of the foot's extra turn that the whole leg makes.
    """
    to = target - hip
    length = np.linalg.norm(to, axis=1)
    flexion = np.arccos(np.clip((length * length - hinge.c) / (2.0 * hinge.d), -1.0, 1.0))
    free = exact < 1.0
    if free.any():
        there, own = hinge.bend(length, DAMPED)[0], hinge.bend(hinge.length(wanted), DAMPED)[0]
        damped = wanted + MOST * np.tanh((there - own) / MOST)
        flexion = np.where(free, exact * hinge.bend(length)[0] + (1.0 - exact) * damped, flexion)
    # a knee that bends the other way in the source, by noise, does so still where nothing is asked of it
    flexion = np.maximum(flexion, np.minimum(LEAST, wanted))
    knee = rotation.exp((flexion - hinge.flexion)[:, None] * hinge.axis)
    turned = _about_y(heading + swivel * (yaw - heading))
    now = rotation.rotate(rotation.mul(turned, hinge.knee), rotation.rotate(knee, hinge.q) - hinge.p)
    leg = rotation.mul(_shortest(now, to), turned)
    return leg, knee, length - hinge.length(flexion)


# -- in call order ---------------------------------------------------------------------------------


def _axis(p: np.ndarray, q: np.ndarray, forward: np.ndarray, bends: np.ndarray) -> np.ndarray:
    """The direction (3,) that the knee turns about most, positive for the way it bends. bends: its rotations (F, 4).

    Not the normal of the leg's plane: where bones stand askew to the hinge that is another direction, and a knee of one
    channel could not turn about it. A knee that hardly turns has only the normal, a straight one what is across the
    foot.
    """
    normals = np.cross(-p, q)
    if (np.linalg.norm(normals, axis=1) < RIGID * np.linalg.norm(p, axis=1) * np.linalg.norm(q, axis=1)).all():
        normals = np.cross(p, forward)
    steps = rotation.log(rotation.mul(bends[1:], rotation.inv(bends[:-1])))
    turns = steps if np.linalg.norm(steps, axis=1).sum() > TURNING else normals
    axis: np.ndarray = np.linalg.eigh(turns.T @ turns)[1][:, 2]
    return axis if (normals @ axis).sum() >= 0 else -axis


def _about_y(angle: np.ndarray) -> np.ndarray:
    none = np.zeros_like(angle)
    return np.stack([np.cos(0.5 * angle), none, np.sin(0.5 * angle), none], axis=-1)


def _shortest(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """The rotation (F, 4) by the shortest arc from directions a to b (F, 3)."""
    a, b = (v / np.linalg.norm(v, axis=1, keepdims=True) for v in (a, b))
    turn = np.concatenate([1.0 + (a * b).sum(axis=1, keepdims=True), np.cross(a, b)], axis=1)
    return turn / np.linalg.norm(turn, axis=1, keepdims=True)
