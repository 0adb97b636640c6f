"""The verb `loop`: one cycle of a motion, repeated without a seam.

Source: Sudarsky and House 1998, Motion capture data manipulation and reuse via B-splines (cyclification); the travel
of a cycle is a planar rigid motion, so that a walk in a curve goes on along its circle.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from .. import planar, rotation
from ..errors import OptionError, UnknownName
from ..info import first_frame_is_t_pose
from ..kinematics import world
from ..motion import Clip, Motion
from ..skeleton import Skeleton
from . import _cycles
from ._pair import complete, tell_sampled
from ._poses import Poses, mixed, motion_of, moved, poses_of, smooth, strung
from ._seams import bends, centimetres

FADE = 0.4  # seconds around the seam
MOST = 10_000  # cycles
SAME_TIME = 1e-6  # seconds: times are given in decimal digits


@dataclass(frozen=True)
class Loop:
    """The cycle that was taken, and how well its end meets its beginning.

    start, end:   seconds in the clip; the pose at the end is the one at the start again.
    frames:       of one cycle.
    unit:         of the lengths that follow: "cm", or "units" of the file where nobody knows how long these are.
    travel, turn: how far the body goes in a cycle, and how many degrees it turns.
    distance:     between the poses around start and end in the clip, root mean square over joints, after alignment.
    jump:         how far, where the cycles meet, some joint is from where it was going.
    acceleration: the same as a part of the clip's: of what 95 % of its frames stay below.
    """

    start: float
    end: float
    frames: int
    unit: str
    travel: float
    turn: float
    distance: float
    jump: float
    acceleration: float

    def __str__(self) -> str:
        return (
            f"cycle: {self.start:.3f} to {self.end:.3f} s, {self.frames} frames\n"
            f"it travels {self.travel:.4g} {self.unit} and turns {self.turn:.3g} degrees\n"
            f"its ends in the clip are {self.distance:.3g} {self.unit} apart\n"
            f"seam: {self.jump:.3g} {self.unit} beyond where it was going, {self.acceleration:.2f} of the clip's "
            "largest accelerations"
        )

    def to_json(self) -> dict[str, Any]:
        """The same as plain numbers and texts."""
        return asdict(self)


def loop(
    clip: Clip,
    *,
    start: float | None = None,
    end: float | None = None,
    cycles: int = 1,
    close: str = "crossfade",
) -> Motion:
    """One cycle of a motion, closed and repeated.

    Parameters
    ----------
    start
        Second at which the cycle begins; by default the clearest cycle is found.
    end
        Second at which the pose of the start has come back; by default found.
    cycles
        How many; each goes on from where the one before has arrived, also in a curve.
    close
        What is done about the difference between the two ends: crossfade (what surrounds one fades into what
        surrounds the other), cubic (it is spread over the cycle, so that places and speeds meet), linear (so that
        places meet).

    The result has cycles x frames of a cycle + 1 frames: the last pose is the first one, carried on. The last step of
    its `history` has the numbers of `Loop` under "measured". Errors: OptionError where no cycle is found or the times
    do not lie in the clip, Mismatch where samples are missing or the root has no channels to travel or turn by.
    A warning where the seam shows.

    >>> walk = mc.loop(mc.read("walk.bvh"), cycles=4)
    """
    _check(start, end, cycles, close)
    motion = complete(clip.sample())
    tell_sampled([clip], "a loop is made of frames")
    dropped = int(first_frame_is_t_pose(motion))
    motion = motion[dropped:]
    places = world(motion)
    bend = bends(places)
    first, last = _ends(motion, places, *(_frame(time, motion, dropped) for time in (start, end)))
    step = _cycles.step(places, first, last, motion.frame_time)
    closed = CLOSINGS[close](poses_of(motion), motion, first, last, step)
    made = _repeated(closed, motion, first, step, cycles)
    twice = made if cycles > 1 else _repeated(closed, motion, first, step, 2)
    found = _measured(motion, places, bend, (first, last, dropped), step, world(twice))
    _tell_seam(found, bend)
    told = {"verb": "loop", "start": start, "end": end, "cycles": cycles, "close": close, "measured": found.to_json()}
    return replace(made, history=(*clip.history, told), report=None)


# -- in call order ---------------------------------------------------------------------------------


def _check(start: float | None, end: float | None, cycles: int, close: str) -> None:
    if close not in CLOSINGS:
        raise UnknownName("way to close a loop", close, CLOSINGS)
    if not (isinstance(cycles, int) and 1 <= cycles <= MOST):
        raise OptionError(f"cycles is a whole number from 1 to {MOST}, not {cycles!r}")
    if start is None and end is not None:
        raise OptionError("end is given without start: say start too, or neither")
    if start is not None and end is not None and not end > start:
        raise OptionError(f"the cycle ends at {end:g} s, not after its start at {start:g} s")


def _frame(time: float | None, motion: Motion, dropped: int) -> int | None:
    """The frame at a second of the clip as it was given, with a T-pose in front."""
    if time is None:
        return None
    last = (motion.frames - 1 + dropped) * motion.frame_time
    if not dropped * motion.frame_time - SAME_TIME <= time <= last + SAME_TIME:
        lead = ", and its first frame is a T-pose" if dropped else ""
        raise OptionError(f"{time:g} s is not in the clip: it ends at {last:g} s{lead}")
    return round(time / motion.frame_time) - dropped


def _ends(motion: Motion, places: np.ndarray, start: int | None, end: int | None) -> tuple[int, int]:
    """First and last frame of the cycle, looked for as far as they are not given."""
    if start is not None and end is not None:
        if end - start < 2:
            raise OptionError("a cycle has at least two frames")
        return start, end
    room = min(round(0.5 * FADE / motion.frame_time), motion.frames // 8)
    return _cycles.find(places, motion.frame_time, room, start)


def _crossfade(poses: Poses, motion: Motion, first: int, last: int, step: np.ndarray) -> Poses:
    """What surrounds the end fades into what surrounds the start; where they meet it is half of each."""
    count = min(round(0.5 * FADE / motion.frame_time), (last - first) // 2, first, len(poses) - 1 - last)
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


def _repeated(closed: Poses, motion: Motion, first: int, step: np.ndarray, cycles: int) -> Motion:
    """The cycles one after the other, each carried on by the planar motion of one, and the first pose once more."""
    frames = np.arange(cycles * len(closed) + 1)
    cycle, within = np.divmod(frames, len(closed))
    base = replace(motion, values=motion.values[first + within], report=None)
    return motion_of(moved(closed[within], motion.skeleton, planar.power(step, cycle)), base)


def _measured(
    motion: Motion, places: np.ndarray, bend: np.ndarray, cut: tuple[int, int, int], step: np.ndarray, made: np.ndarray
) -> Loop:
    """The numbers of a cut (first, last, frames dropped before) and of the places of at least two cycles made of it."""
    first, last, dropped = cut
    jump = float(bends(made)[last - first - 1 : last - first + 1].max())
    usual = float(np.percentile(bend, 95))
    length = centimetres(motion)
    scale = length or 1.0
    return Loop(
        start=(first + dropped) * motion.frame_time,
        end=(last + dropped) * motion.frame_time,
        frames=last - first,
        unit="cm" if length else "units",
        travel=scale * float(np.linalg.norm((places[last] - places[first]).mean(axis=0)[[0, 2]])),
        turn=float(np.degrees(step[0])),
        distance=scale * _cycles.apart(places, first, last, motion.frame_time),
        jump=scale * jump,
        acceleration=jump / usual if usual > 0 else 0.0,
    )


def _tell_seam(found: Loop, bend: np.ndarray) -> None:
    """A warning where the seam is rougher than anything in the clip."""
    usual = float(np.percentile(bend, 95))
    if found.acceleration * usual > 1.05 * bend.max():
        warnings.warn(
            f"the seam shows, its acceleration is {found.acceleration:.2g} times the usual largest: the ends of the "
            f"cycle are {found.distance:.3g} {found.unit} apart",
            stacklevel=3,
        )
