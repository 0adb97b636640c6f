"""Ways to make the end of a cycle meet its beginning, frame by frame.

Each takes poses, the motion they are of, the first frame and the last (the first again), and the planar transform (3,)
of a cycle; it gives the poses of the cycle's frames, the last one left out.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from .. import planar, rotation
from ..errors import OptionError
from ..motion import Motion
from ..skeleton import Skeleton
from ._poses import Poses, mixed, moved, smooth, strung

FADE = 0.4  # seconds around the seam


def beside(first: int, last: int, frames: int, frame_time: float) -> int:
    """Frames on either side of both ends that a crossfade can use."""
    return min(round(0.5 * FADE / frame_time), (last - first) // 2, first, frames - 1 - last)


def _crossfade(poses: Poses, motion: Motion, first: int, last: int, step: np.ndarray) -> Poses:
    """What surrounds the end fades into what surrounds the start; where they meet it is half of each."""
    count = beside(first, last, len(poses), motion.frame_time)
    if count < 2:
        raise OptionError("to crossfade, the clip must begin before the cycle and go on after it; close it by cubic")
    ahead, behind = np.arange(count), np.arange(-count + 1, 0)
    weights = smooth(0.5 + 0.5 * np.arange(-count + 1, count) / count)
    over = moved(poses[last + ahead], motion.skeleton, planar.inverse(step))
    lead = moved(poses[first + behind], motion.skeleton, step)
    return strung(
        mixed(over, poses[first + ahead], weights[count - 1 :]),
        poses[first + count : last - count + 1],
        mixed(poses[last + behind], lead, weights[: count - 1]),
    )


def _linear(poses: Poses, motion: Motion, first: int, last: int, step: np.ndarray) -> Poses:
    """The gap between the two ends is taken away bit by bit, half of it from each side: places meet."""
    u = _parts(first, last)
    shift, turn = _gap(poses, motion.skeleton, first, last, step)
    return _displaced(poses[first:last], motion.skeleton, step, (0.5 - u) * shift, (0.5 - u) * turn)


def _cubic(poses: Poses, motion: Motion, first: int, last: int, step: np.ndarray) -> Poses:
    """The same along a cubic that also takes away half the difference of speeds at either end: speeds meet too."""
    u = _parts(first, last)
    place, speed = 0.5 - u * u * (3.0 - 2.0 * u), 0.5 * u * (1.0 - u) * (last - first)
    gap = _gap(poses, motion.skeleton, first, last, step)
    faster = _faster(poses, motion.skeleton, first, last, step)
    shift, turn = (place * at + speed * by for at, by in zip(gap, faster, strict=True))
    return _displaced(poses[first:last], motion.skeleton, step, shift, turn)


def _parts(first: int, last: int) -> np.ndarray:
    """How much of the cycle is over at each frame (F, 1, 1)."""
    return (np.arange(last - first) / (last - first))[:, None, None]


def _gap(poses: Poses, skeleton: Skeleton, first: int, last: int, step: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """What the pose at `last` has more than the one at `first`, carried on: shifts (J, 3), those of roots as seen half
    a cycle earlier, and rotation vectors (J, 3) in the joint's own frame."""
    carried, there = moved(poses[first : first + 1], skeleton, step), poses[last : last + 1]
    turn = rotation.log(rotation.mul(rotation.inv(carried.turns), there.turns))[0]
    return _headed((there.shifts - carried.shifts)[0], skeleton, -0.5 * step[0]), turn


def _faster(poses: Poses, skeleton: Skeleton, first: int, last: int, step: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """How much more the joints move at `last` than at `first`, a frame, in the same terms."""
    (shift, turn), (before, turn_before) = (_speed(poses, frame) for frame in (last, first))
    half = 0.5 * step[0]
    return _headed(shift, skeleton, -half) - _headed(before, skeleton, half), turn - turn_before


def _speed(poses: Poses, frame: int) -> tuple[np.ndarray, np.ndarray]:
    """Shifts and rotation vectors (J, 3) a frame, from the frames on both sides as far as there are any."""
    start, end = max(frame - 1, 0), min(frame + 1, len(poses) - 1)
    turn = rotation.log(rotation.mul(rotation.inv(poses.turns[start]), poses.turns[end]))
    return (poses.shifts[end] - poses.shifts[start]) / (end - start), turn / (end - start)


def _headed(shift: np.ndarray, skeleton: Skeleton, angle: np.ndarray | float) -> np.ndarray:
    """Shifts (..., J, 3), those of roots turned by angles (...)."""
    angle = np.asarray(angle)
    roots = skeleton.parents < 0
    turned = shift.copy()
    turning = np.stack([angle, 0.0 * angle, 0.0 * angle], axis=-1)[..., None, :]
    turned[..., roots, :] = planar.move(turning, shift[..., roots, :])
    return turned


def _displaced(body: Poses, skeleton: Skeleton, step: np.ndarray, shift: np.ndarray, turn: np.ndarray) -> Poses:
    """The cycle with displacements (F, J, 3) as `_gap` has them; those of roots turn with the cycle."""
    heading = step[0] * (np.arange(len(body)) / len(body) - 0.5)
    return Poses(body.shifts + _headed(shift, skeleton, heading), rotation.mul(body.turns, rotation.exp(turn)))


CLOSINGS: dict[str, Callable[[Poses, Motion, int, int, np.ndarray], Poses]] = {
    "crossfade": _crossfade,
    "cubic": _cubic,
    "linear": _linear,
}
