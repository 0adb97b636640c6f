"""Several motions in step, as one: moments that belong together, bodies that face alike, and the way they go.

Sources: Bruderlin and Williams 1995, Motion signal processing, section 3.2 (multitarget interpolation) and 4.2 (in
step); Kovar and Gleicher 2003, Flexible automatic motion blending with registration curves (the alignment of every
moment, and the way as a sum of steps in the body's own direction).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from .. import kinematics, planar, rotation
from ..errors import OptionError
from ..motion import Motion, frame_count
from ..progress import advance
from ._bodies import fitted, main_root, scaled, size_of
from ._means import heaviest_of, mean_of_rotations
from ._pair import at_times, onto
from ._poses import motion_of, moved, poses_of
from ._shares import Shares
from ._slopes import speeds
from ._time import TimeMap
from ._turns import free_joints
from .register import Registration, matched

AROUND = 0.1  # seconds on either side over which the direction of a body is found
FINE = 4  # times a frame: of time that runs with shares that change
LONGEST = 1_000_000  # frames of a result


@dataclass(frozen=True, eq=False)
class Family:
    """Motions whose moments belong together.

    motions:   N of them, as they are. reference: which of them the others run with.
    maps:      from the reference's seconds to each one's own.
    found:     how each was registered, None for the reference.
    """

    motions: list[Motion]
    reference: int
    maps: list[TimeMap]
    found: list[Registration | None]


@dataclass(frozen=True, eq=False)
class Moments:
    """The frames of the result: seconds of each clip (N, F), and shares (N, F, J) of the joints of the first."""

    times: np.ndarray
    shares: np.ndarray


def registered(motions: list[Motion], reference: int | None = None) -> Family:
    """All motions registered with one of them, by default the one of the middle length."""
    if min(motion.frames for motion in motions) < 2:
        raise OptionError("clips of fewer than two frames have no time to match")
    chosen = _middle(motions) if reference is None else reference
    bodies = motions
    if all(motion.skeleton.names == motions[0].skeleton.names for motion in motions):
        bodies = [fitted(motions[0], motion)[0] for motion in motions]  # longer legs are no other pose
    found: list[Registration | None] = []
    for place, body in enumerate(bodies):
        advance("registering", place, len(motions))
        found.append(None if place == chosen else matched(body, bodies[chosen]))
    advance("registering", len(motions), len(motions))
    whole = [[0.0, 0.0], [motions[chosen].duration] * 2]
    return Family(motions, chosen, [_map(whole if one is None else one.pairs) for one in found], found)


def moments(family: Family, shares: Shares, lead: float = 0.0) -> Moments:
    """Which moment of each clip belongs to each frame of the result, and how much of it.

    Time runs as fast as the weighted mean of the clips says: the maps are added, weighted, and turned round.
    lead: seconds of the first clip before its first frame here.
    """
    first = family.motions[0]
    bent = _mean_time(family, shares, lead)
    count = frame_count(float(bent.new[-1]), first.frame_time)
    if count > LONGEST:
        raise OptionError(f"the result would have {count} frames, more than {LONGEST}")
    reference = np.minimum(bent.back(np.arange(count) * first.frame_time), bent.old[-1])
    times = np.stack([one.at(reference) for one in family.maps])
    return Moments(times, shares.at(lead + times[0], first.skeleton))


def in_step(family: Family, when: Moments) -> Motion:
    """The weighted mean of the motions at these moments; it begins where the heaviest is then."""
    bodies = on_first(family.motions, when.times)
    root = main_root(bodies[0])
    share = when.shares[:, :, root]
    middle = 0.5 * (share[:, 1:] + share[:, :-1])
    angles = _directions(bodies, family.reference, root)
    places = np.stack([kinematics.world(body)[:, root] for body in bodies])  # (N, F, 3)
    heaviest = heaviest_of(when.shares[:, :1, root])
    home = places[heaviest, 0]
    alike = [_aligned(body, angle, place, home) for body, angle, place in zip(bodies, angles, places, strict=True)]
    made = mean_of_rotations(alike, when.shares)
    heading = -angles[heaviest, 0] - _summed(middle * np.diff(angles))
    steps = planar.move(_turning(0.5 * (angles[:, 1:] + angles[:, :-1])), np.diff(places, axis=1))
    step = np.einsum("nf,nfk->fk", middle, steps)
    way = planar.move(_turning(0.5 * (heading[1:] + heading[:-1])), step)
    at = home + np.concatenate([np.zeros((1, 3)), np.cumsum(way, axis=0)])
    back = planar.compose(_shift(at), planar.compose(_turning(heading), _shift(-home)))
    return motion_of(moved(poses_of(made), made.skeleton, back), made)


def on_first(motions: list[Motion], times: np.ndarray) -> list[Motion]:
    """Every motion at its times (N, F) on the body of the first."""
    first = motions[0]
    own = at_times(first, times[0], first.frame_time)
    bodies = [own]
    for motion, at in zip(motions[1:], times[1:], strict=True):
        there, _ = onto(own, at_times(motion, at, first.frame_time))
        bodies.append(scaled(there, *size_of(first, motion, fitted(first, motion)[0])))
    return bodies


# -- in call order ---------------------------------------------------------------------------------


def _middle(motions: Sequence[Motion]) -> int:
    """The motion of the middle length; of equally long ones it does not depend on their order."""
    order = sorted(range(len(motions)), key=lambda place: (motions[place].duration, motions[place].values.tobytes()))
    return order[len(order) // 2]


def _mean_time(family: Family, shares: Shares, lead: float) -> TimeMap:
    """From the reference's seconds to those of the result.

    Of shares that do not change the sum of the maps, itself a cubic between all their pairs; else the sum of their
    speeds, added up over fine steps.
    """
    first, maps = family.motions[0], family.maps
    length = family.motions[family.reference].duration

    def speed(at: np.ndarray) -> np.ndarray:
        return (share_of_time(at) * [one.speeds(at) for one in maps]).sum(axis=0)

    def share_of_time(at: np.ndarray) -> np.ndarray:
        return shares.at(lead + maps[0].at(at), first.skeleton)[:, :, main_root(first)]

    at = np.unique(np.clip(np.concatenate([one.old for one in maps]), 0.0, length))
    at = at[np.concatenate([[True], np.diff(at) > 1e-9 * length])]
    fine = np.linspace(0.0, length, max(2, FINE * round(length / first.frame_time) + 1))
    if not min(speed(at).min(), speed(fine).min()) > 0:
        raise OptionError("with these weights time would run backwards: take weights nearer to those of a mean")
    if not shares.constant:
        steps = 0.5 * (speed(fine)[1:] + speed(fine)[:-1]) * np.diff(fine)
        return TimeMap(fine, np.concatenate([[0.0], np.cumsum(steps)]), speed(fine))
    return TimeMap(at, (share_of_time(at) * [one.at(at) for one in maps]).sum(axis=0), speed(at))


def _map(pairs: list[list[float]]) -> TimeMap:
    own, reference = np.array(pairs).T
    return TimeMap(reference, own, speeds(reference, own))


def _directions(bodies: Sequence[Motion], reference: int, root: int) -> np.ndarray:
    """(N, F) radians by which each body has to be turned to face as the reference does, without whole turns between
    frames; 0 where the root cannot be turned.

    What is compared are the axes of their roots, brought together on the ground in the sense of least squares: limbs
    swing differently, and what lies or stands on its head has a direction too.
    """
    skeleton = bodies[0].skeleton
    if root not in [joint for joint, _, _ in free_joints(skeleton)]:
        return np.zeros((len(bodies), bodies[0].frames))
    axes = [rotation.rotate(kinematics.rotations(body)[:, root, None], np.eye(3)) for body in bodies]  # (F, 3, 3)
    half = min(max(1, round(AROUND / bodies[0].frame_time)), max(1, bodies[0].frames // 2))
    angles = []
    for of in axes:
        to = axes[reference]
        along = np.einsum("fj,fj->f", to[..., 0], of[..., 0]) + np.einsum("fj,fj->f", to[..., 2], of[..., 2])
        across = np.einsum("fj,fj->f", to[..., 0], of[..., 2]) - np.einsum("fj,fj->f", to[..., 2], of[..., 0])
        angles.append(np.unwrap(np.arctan2(_averaged(across, half), _averaged(along, half))))
    return np.stack(angles)


def _averaged(values: np.ndarray, half: int) -> np.ndarray:
    """The mean (F,) around every frame, of so many on both sides as there are as many on either."""
    total = np.concatenate([[0.0], np.cumsum(values)])
    frames = np.arange(len(values))
    reach = np.minimum(np.minimum(frames, len(values) - 1 - frames), half)
    return (total[frames + reach + 1] - total[frames - reach]) / (2 * reach + 1)


def _aligned(body: Motion, angle: np.ndarray, place: np.ndarray, home: np.ndarray) -> Motion:
    """The body turned by angles (F,) about its root, which is put at home (3,), on the ground."""
    by = planar.compose(_shift(home), planar.compose(_turning(angle), _shift(-place)))
    return motion_of(moved(poses_of(body), body.skeleton, by), body)


def _turning(angle: np.ndarray) -> np.ndarray:
    none = np.zeros_like(angle)
    return np.stack([angle, none, none], axis=-1)


def _shift(place: np.ndarray) -> np.ndarray:
    return np.stack([np.zeros(place.shape[:-1]), place[..., 0], place[..., 2]], axis=-1)


def _summed(steps: np.ndarray) -> np.ndarray:
    """(F,) running sum over frames of the sum over clips of steps (N, F - 1), from 0 on."""
    return np.concatenate([[0.0], np.cumsum(steps.sum(axis=0))])
