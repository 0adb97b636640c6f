"""From one motion over into another, frame by frame: how the second is placed, and what is shown in between.

Sources: Kovar, Gleicher and Pighin 2002, Motion graphs, section 3.2 (overlap); Bollo 2018, Inertialization:
high-performance animation transitions in Gears of War, GDC (inertial); Sudarsky and House 1998 (spline).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from .. import bspline, planar, rotation
from ..bspline_fit import least_squares
from ..kinematics import world
from ..motion import Motion, unroll
from ..spline import SplineMotion
from ._poses import Poses, mixed, motion_of, moved, poses_of, smooth
from ._splices import spliced

RESTS = 0.5  # of the transition: a foot that rests so long in both clips may be what they are aligned by
SHORTEST = 0.5  # of the transition: sooner no joint stops
BESIDE = 40  # frames on both sides that the interpolating splines of a transition reach over: 0.27^40 is nothing


class Cut(NamedTuple):
    """The transition takes so many frames, from frame i of the first clip and j of the second on; `step` (3,) is the
    planar transform that takes the second to where the first has arrived."""

    i: int
    j: int
    frames: int
    step: np.ndarray


def alignments(a: Motion, b: Motion, at: tuple[int, int], count: int, mode: str, rests: np.ndarray) -> list[np.ndarray]:
    """Planar transforms (3,) that may bring b to a at these frames: by all joints, and by the feet that rest in both
    (J, n) through most of the transition, if any do."""
    i, j = at
    lead, over = (min(i, j, 1), 1) if mode == "inertial" else (0, count)
    clouds = [world(clip[frame - lead : frame + over]) for clip, frame in ((a, i), (b, j))]
    step = planar.align(*(cloud.reshape(-1, 3) for cloud in clouds))
    rests = rests & (rests.mean(axis=1, keepdims=True) >= RESTS)
    if not rests.any():
        return [step]
    common = rests.shape[1]
    turned = planar.move(step, world(b[j : j + common]))
    away = (world(a[i : i + common]) - turned).transpose(1, 0, 2)[rests].mean(axis=0)
    return [step, step + np.array([0.0, away[0], away[2]])]


def joined(a: Motion, b: Motion, cut: Cut, mode: str, after: int | None = None) -> Motion:
    """What follows frame i - 1 of a: the transition, and then so many frames of b (None: all), moved; its channels go
    on from where a leaves them."""
    i, j, count, _ = cut
    middle = MODES[mode](a, b, cut)
    rest = _moved(a, b, cut, j + count, b.frames if after is None else j + count + after)
    made = np.vstack([a.values[max(i - 1, 0) : max(i, 1)], middle.values, rest.values])
    return unroll(replace(a, values=made, report=None))[1:]


def _moved(a: Motion, b: Motion, cut: Cut, start: int, end: int) -> Motion:
    """Frames of b where a has arrived; their channels start as near as they can to those of a at the cut."""
    part = b[start:end]
    if not part.frames:
        return part
    first = np.array(part.values, order="F")
    first[0] = a.values[cut.i]
    return motion_of(moved(poses_of(part), a.skeleton, cut.step), replace(part, values=first))


# -- the ways over: the frames of a transition -----------------------------------------------------


def _overlap(a: Motion, b: Motion, cut: Cut) -> Motion:
    """The one fades into the other."""
    weights = smooth(np.arange(1, cut.frames + 1) / (cut.frames + 1))
    others = _moved(a, b, cut, cut.j, cut.j + cut.frames)
    return motion_of(mixed(poses_of(a[cut.i : cut.i + cut.frames]), poses_of(others), weights), others)


def _inertial(a: Motion, b: Motion, cut: Cut) -> Motion:
    """The second, with what the first was ahead of it in pose and speed dying away."""
    lead = min(cut.i, cut.j, 1)
    others = _moved(a, b, cut, cut.j - lead, cut.j + cut.frames)
    before, after = poses_of(a[cut.i - lead : cut.i + 1]), poses_of(others)
    shifts = before.shifts - after.shifts[: lead + 1]
    turns = rotation.log(rotation.mul(rotation.inv(after.turns[: lead + 1]), before.turns))
    shift, turn = (_decaying(ahead[lead], ahead[lead] - ahead[0], cut.frames) for ahead in (shifts, turns))
    after = after[lead:]
    return motion_of(Poses(after.shifts + shift, rotation.mul(after.turns, rotation.exp(turn))), others[lead:])


def _decaying(ahead: np.ndarray, speed: np.ndarray, count: int) -> np.ndarray:
    """(count, J, 3) what becomes of differences (J, 3) that change at a speed (J, 3) a frame: they end in `count`
    frames without speed or acceleration.

    A joint that comes nearer by itself stops sooner, and begins with the acceleration that keeps it from going beyond.
    """
    size = np.linalg.norm(ahead, axis=-1)
    along = ahead / np.where(size > 0, size, 1.0)[:, None]
    nearer = -np.einsum("jk,jk->j", along, speed)
    frames = np.where(nearer > 0, 5.0 * size / np.where(nearer > 0, nearer, 1.0), count)
    frames = np.clip(frames, SHORTEST * count, count)
    bent = np.maximum(8.0 * nearer * frames - 20.0 * size, 0.0)
    u = np.minimum(np.arange(count)[:, None] / frames, 1.0)[..., None]
    v = 1.0 - u
    place, change = v * v * v * (1.0 + u * (3.0 + 6.0 * u)), u * v * v * v * (1.0 + 3.0 * u)
    return place * ahead + change * frames[:, None] * speed + 0.5 * u * u * v * v * v * bent[:, None] * along


def _spline(a: Motion, b: Motion, cut: Cut) -> Motion:
    """Cubic splines through all frames of both; over the transition their coefficients are blended."""
    i, j, count, _ = cut
    here = unroll(a[max(i - BESIDE, 0) : i + count + BESIDE])
    before = min(j, BESIDE)
    there = unroll(_moved(a, b, cut, j - before, j + count + BESIDE))
    step = a.frame_time
    lead = min(i, BESIDE) * step
    mine, other = _through(here), _through(there)
    other = replace(other, knots=other.knots + lead - before * step)
    made = spliced(mine, other, lead, lead + count * step)
    return replace(there, values=made.at(lead + np.arange(count) * step))


def _through(motion: Motion) -> SplineMotion:
    """The cubic splines through all frames, with a knot at every frame but the second and the last but one."""
    degree = min(3, motion.frames - 1)
    at = np.arange(motion.frames) * motion.frame_time
    knots = bspline.clamped(np.concatenate([at[:1], at[2:-2] if degree == 3 else [], at[-1:]]), degree)
    values = least_squares(knots, degree, at, motion.values)
    return SplineMotion(motion.skeleton, knots, values, degree, motion.frame_time, motion.frames)


MODES: dict[str, Callable[[Motion, Motion, Cut], Motion]] = {
    "overlap": _overlap,
    "inertial": _inertial,
    "spline": _spline,
}
