"""Which joints are hip, knee, ankle and ball of the foot: by name and by shape."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from .. import rotation
from ..errors import Mismatch, OptionError
from ..info import unit_of
from ..kinematics import rest_height, rest_offsets, world, world_rotations
from ..motion import Motion
from ..skeleton import Skeleton

FOOT = re.compile(r"foot|toe|ankle|heel|ball(?!oon)", re.IGNORECASE)
HELPER = re.compile(r"ik|target|ctrl|control|pole|roll", re.IGNORECASE)  # of rigs: they hang beside the legs
LONG = 0.42  # of the longest bone of the leg: where the thigh begins, shorter bones above belong to the pelvis
STIFF = 1.0  # degrees: a joint whose channels never change more does not turn
SHORT = 1e-6  # of the height at rest: a bone without length
HEEL = 0.25  # foot lengths that the heel stands behind the ankle
LOWEST, LEVEL = 0.05, 10.0  # of the frames, in which feet stand; degrees off what is usual there: a foot that points


class Leg(NamedTuple):
    """Joints of a leg and the heel: where in the ankle's frame (3,), file units, a point under the heel is fixed."""

    hip: int
    knee: int
    ankle: int
    ball: int
    heel: np.ndarray


def legs(motion: Motion, feet: str | Sequence[str] | None = None) -> tuple[Leg, ...]:
    """Both legs. `feet` names the ball (toe base) of each foot, or its ankle; without it feet are found by name.

    The thigh begins at the first long bone of a joint that turns, below the joint where the legs part; the knee is the
    joint nearest to the middle of the way from there to the ankle: joints in between (twist bones) do no harm. The ball
    is the first joint or end site below the ankle that lies elsewhere. Mismatch where there are not two legs with
    knees.
    """
    skeleton = motion.skeleton
    names = [feet] if isinstance(feet, str) else feet
    if names is not None and not (isinstance(names, Sequence) and all(isinstance(name, str) for name in names)):
        raise OptionError(f"feet are two names of joints, not {feet!r}")
    ankles = _named(skeleton, names) if names is not None else _found(skeleton)
    if len({ankle for ankle, _ in ankles}) != 2:
        told = ", ".join(repr(skeleton.names[joint]) for joint, _ in ankles[:6]) or "none"
        asked = "the option feet says which: the toe base of each foot"
        raise Mismatch(f"two feet are needed, and {len(ankles)} were found ({told}); {asked}")
    (left, _), (right, _) = ankles
    both = _above(skeleton, right)
    top = next((joint for joint in _above(skeleton, left) if joint in both), -1)
    bones = np.linalg.norm(rest_offsets(motion), axis=1)
    found = []
    for ankle, ball in ankles:
        hip, knee = _thigh(motion, bones, top, ankle)
        found.append((hip, knee, ankle, _ball(skeleton, bones, ankle, SHORT * bones.sum()) if ball < 0 else ball))
    names = [skeleton.names[joint] for joints in found for joint in dict.fromkeys(joints[2:])]
    twice = next((name for i, name in enumerate(names) if name in names[:i]), None)
    if twice is not None:
        raise Mismatch(f"several joints of the feet are called {twice!r}: contacts are told apart by name")
    return tuple(Leg(*joints, heel) for joints, heel in zip(found, _heels(motion, found), strict=True))


def tracks(motion: Motion, both: Sequence[Leg]) -> tuple[np.ndarray, np.ndarray]:
    """Where the balls and the heels of these legs go: two arrays (legs, F, 3), file units."""
    places = world(motion)
    turned = world_rotations(motion, [leg.ankle for leg in both])
    balls = np.stack([places[:, leg.ball] for leg in both])
    heels = [places[:, leg.ankle] + rotation.rotate(turned[:, i], leg.heel) for i, leg in enumerate(both)]
    return balls, np.stack(heels)


def feet_of(motion: Motion, both: Sequence[Leg]) -> list[tuple[str, str]]:
    """What the ball and the ankle of each leg are called."""
    names = motion.skeleton.names
    return [(names[leg.ball], names[leg.ankle]) for leg in both]


def centimetres(motion: Motion) -> float:
    """Centimetres a file unit, as said or as `info` guesses it; a body without height: one unit is one."""
    if motion.skeleton.unit is None and not rest_height(motion) > 0:
        return 1.0
    return 100.0 * unit_of(motion).metres


# -- in call order ---------------------------------------------------------------------------------


def _named(skeleton: Skeleton, names: Sequence[str]) -> list[tuple[int, int]]:
    """(ankle, ball) of joints given by name; ball -1 where the joint is the ankle itself."""
    found = []
    for name in names:
        joint = skeleton.joint(name)
        line = [joint, *_above(skeleton, joint)]
        feet = [place for place in line if FOOT.search(skeleton.names[place])]
        ankle = feet[-1] if feet else int(skeleton.parents[joint])
        if ankle < 0:
            raise Mismatch(f"{name!r} hangs on no leg")
        found.append((ankle, joint if joint != ankle else -1))
    return found


def _found(skeleton: Skeleton) -> list[tuple[int, int]]:
    """The uppermost joints with names of feet that have at least two joints of a leg above them."""
    found = []
    for joint, name in enumerate(skeleton.names):
        above = _above(skeleton, joint)
        inner = any(FOOT.search(skeleton.names[place]) for place in above)
        if FOOT.search(name) and not HELPER.search(name) and not inner and len(above) >= 3:
            found.append((joint, -1))
    return found


def _above(skeleton: Skeleton, joint: int) -> list[int]:
    line, joint = [], int(skeleton.parents[joint])
    while joint >= 0:
        line.append(joint)
        joint = int(skeleton.parents[joint])
    return line


def _thigh(motion: Motion, bones: np.ndarray, top: int, ankle: int) -> tuple[int, int]:
    """Hip and knee of the chain from below `top` to the ankle."""
    skeleton = motion.skeleton
    line = [ankle, *_above(skeleton, ankle)]
    chain = line[: line.index(top) if top in line else len(line)][::-1]
    turning = [joint for joint in chain[:-2] if _turns(motion, joint)]
    chain = chain[chain.index(turning[0]) if turning else 0 :]  # what never turns above the leg is the pelvis
    lengths = bones[chain[1:]]
    longest = lengths.max(initial=0.0)
    if len(chain) < 3 or not longest > 0:
        raise Mismatch(f"there is no knee above {skeleton.names[ankle]!r}")
    first = int(np.argmax(lengths >= LONG * longest))
    if first > len(chain) - 3:
        raise Mismatch(f"there is no knee between {skeleton.names[chain[first]]!r} and {skeleton.names[ankle]!r}")
    along = np.concatenate([[0.0], np.cumsum(lengths[first:])])
    inner = along[1:-1] / along[-1]
    knee = first + 1 + int(np.argmin(np.abs(inner - 0.5)))
    return chain[first], chain[knee]


def _turns(motion: Motion, joint: int) -> bool:
    columns = motion.skeleton.eulers[joint][0]
    return bool(motion.frames) and bool((np.ptp(motion.values[:, columns], axis=0) > STIFF).any())


def _ball(skeleton: Skeleton, bones: np.ndarray, ankle: int, least: float) -> int:
    """The first joint below the ankle that lies elsewhere, one called after a toe or ball before others; else the
    ankle itself."""
    below = [joint for joint in range(ankle + 1, len(bones)) if ankle in _above(skeleton, joint)]
    apart = [joint for joint in below if bones[joint] > least]
    named = [joint for joint in apart if re.search(r"toe|ball(?!oon)", skeleton.names[joint], re.IGNORECASE)]
    return (named or apart or [ankle])[0]


def _heels(motion: Motion, found: Sequence[tuple[int, int, int, int]]) -> list[np.ndarray]:
    """A point of each foot, in the ankle's frame: on the floor where the foot stands lowest, a quarter of the foot
    behind the ankle."""
    if not motion.frames:
        return [np.zeros(3)] * len(found)
    places = world(motion)
    turned = world_rotations(motion, [joints[2] for joints in found])
    heels = []
    for i, (_, _, ankle, ball) in enumerate(found):
        lowest = _flat(places[:, ankle], places[:, ball])
        down = -HEEL * (places[lowest, ball] - places[lowest, ankle])
        down[1] = min(0.0, places[lowest, ball, 1] - places[lowest, ankle, 1])
        heels.append(rotation.rotate(rotation.inv(turned[lowest, i]), down))
    return heels


def _flat(ankle: np.ndarray, ball: np.ndarray) -> int:
    """The frame in which a foot is lowest, of those in which it is tilted as it usually is where it is low: a foot that
    points down may be lower than one that stands."""
    way = ball - ankle
    tilt = np.degrees(np.arctan2(way[:, 1], np.hypot(way[:, 0], way[:, 2])))
    height = ankle[:, 1] + ball[:, 1]
    low = np.argsort(height)[: max(1, int(LOWEST * len(height)))]
    usual = np.abs(tilt - np.median(tilt[low])) < LEVEL
    return int(np.argmin(np.where(usual, height, np.inf)))
