"""Splines cut and put together on their coefficients: what they are outside of an overlap stays exactly.

Source: Sudarsky and House 1998, Motion capture data manipulation and reuse via B-splines, transitions.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from .. import bspline, planar, rotation
from ..bspline_fit import least_squares
from ..errors import Mismatch
from ..skeleton import AXES
from ..spline import SplineMotion, clamped, raised, refined
from ._poses import smooth

SPANS = 12  # of an overlap, at least: so many steps from one clip's coefficients to the other's
AT = 50  # moments of an overlap at which the clips' angles are compared
STILL = 1e-15  # radians
NEAR_DEGREES = 0.01  # a root's angles that no spline says exactly are fitted so near
HALVINGS = 5


def spliced(a: SplineMotion, b: SplineMotion, start: float, end: float) -> SplineMotion:
    """a up to `start`, b from `end` on (seconds, of both clips), and in between a blend of their coefficients.

    Exact outside, and as smooth as its degree says throughout: knots are single there unless a clip's own are not. a
    has to reach to `end`, b from `start` on; knots, degree and domain follow from both.
    """
    degree = max(a.degree, b.degree)
    a, b = (clamped(raised(clip, degree)) for clip in (a, b))
    a = replace(a, knots=bspline.snapped(a.knots, np.array([start, end])))
    b = replace(b, knots=bspline.snapped(b.knots, np.unique(np.concatenate([a.knots, [start, end]]))))
    b = _counted_alike(a, b, np.linspace(start, end, AT))
    inner = bspline.union(*(clip.knots[(clip.knots > start) & (clip.knots < end)] for clip in (a, b)))
    inner = _narrow(np.concatenate([[start], inner, [end]]), (end - start) / SPANS)[1:-1]
    (before, starts, _, _), (_, _, ends, after) = (_around(clip.knots, start, end) for clip in (a, b))
    knots = np.concatenate([before, starts, inner, ends, after])
    first, second = (_on_knots(clip, inner, start, end) for clip in (a, b))
    count = len(knots) - degree - 1
    begins = len(before) + len(starts) - 1  # the first function that starts where the overlap does
    stops = len(before) + len(starts) + len(inner) - degree  # the first that goes on beyond it
    mine, other = np.zeros((2, count, a.values.shape[1]))
    mine[:stops], other[begins:] = first.values[:stops], second.values[len(second.values) - (count - begins) :]
    share = smooth(np.clip((bspline.greville(knots, degree) - start) / (end - start), 0.0, 1.0))
    share[:begins], share[stops:] = 0.0, 1.0
    values = (1.0 - share)[:, None] * mine + share[:, None] * other
    return replace(a, knots=knots, values=values, degree=degree, report=None)


def carried(clip: SplineMotion, steps: np.ndarray) -> tuple[SplineMotion, float]:
    """The whole body taken elsewhere by planar transforms (3,), or one a coefficient (N, 3), and by how many degrees
    the roots' angles are off at most.

    Places are carried exactly: coefficients move as points do. So are the angles of a root whose first rotation channel
    is about the vertical; those of others are fitted.
    """
    skeleton = clip.skeleton
    steps = np.broadcast_to(steps, (len(clip.values), 3))
    off = 0.0
    roots = np.flatnonzero(skeleton.parents < 0)
    for joint in roots:
        clip = _shifted(clip, int(joint), steps)
    for joint in roots:
        columns, order = skeleton.eulers[joint]
        turns = bool(np.abs(steps[:, 0]).max(initial=0.0) > STILL)
        if order[:1] == "Y":
            clip = _with(clip, columns[:1], clip.values[:, columns[:1]] + np.degrees(steps[:, :1]))
        elif turns and (order or (skeleton.parents == joint).any()):
            clip, steps, most = _refitted(clip, steps, int(joint), columns, order)
            off = max(off, most)
    return clip, off


# -- in call order ---------------------------------------------------------------------------------


def _counted_alike(a: SplineMotion, b: SplineMotion, at: np.ndarray) -> SplineMotion:
    """b with its angles as near to those of a at these times as whole turns and the other Euler triple of the same
    rotations (a + 180, 180 - b, c + 180) bring them."""
    values = np.array(b.values, order="F")
    mine, other = a.at(at), b.at(at)
    for columns, order in a.skeleton.eulers:
        found = []
        for flipped in (False, True) if len(order) == 3 and len(set(order)) == 3 else (False,):
            sign, add = (np.array([1.0, -1.0, 1.0]), 180.0) if flipped else (np.ones(len(columns)), 0.0)
            turns = 360.0 * np.rint((mine[:, columns] - add - sign * other[:, columns]).mean(axis=0) / 360.0)
            away = mine[:, columns] - add - turns - sign * other[:, columns]
            found.append((float((away**2).sum()), sign, add + turns))
        _, sign, add = min(found, key=lambda one: one[0])
        values[:, columns] = values[:, columns] * sign + add
    return replace(b, values=values)


def _narrow(knots: np.ndarray, most: float) -> np.ndarray:
    """These knots and more, so that none are further apart than `most` (seconds)."""
    parts = np.maximum(np.ceil(np.diff(knots) / most - 1e-9), 1).astype(np.int64)
    new = [np.linspace(low, high, n + 1)[1:-1] for low, high, n in zip(knots[:-1], knots[1:], parts, strict=True)]
    return np.sort(np.concatenate([knots, *new]))


def _around(knots: np.ndarray, start: float, end: float) -> list[np.ndarray]:
    """Knots before the overlap, at its start (one at least), at its end (one at least), and after it."""
    at = [knots[knots == time] for time in (start, end)]
    at = [own if len(own) else np.array([time]) for own, time in zip(at, (start, end), strict=True)]
    return [knots[knots < start], *at, knots[knots > end]]


def _on_knots(clip: SplineMotion, inner: np.ndarray, start: float, end: float) -> SplineMotion:
    """The same curves, with these knots within the overlap and at its ends, as far as the clip goes."""
    before, starts, ends, after = _around(clip.knots, start, end)
    return refined(clip, np.concatenate([before, starts, inner, ends, after]))


def _with(clip: SplineMotion, columns: list[int], values: np.ndarray) -> SplineMotion:
    new = np.array(clip.values, order="F")
    new[:, columns] = values
    return replace(clip, values=new, report=None)


def _shifted(clip: SplineMotion, joint: int, steps: np.ndarray) -> SplineMotion:
    """The places of a root carried; Mismatch where it has to go where it has no channel."""
    skeleton = clip.skeleton
    own = np.flatnonzero((skeleton.channel_joints == joint) & ~skeleton.rotation_channels)
    axes = skeleton.channel_axes[own]
    places = np.repeat(skeleton.offsets[joint][None], len(clip.values), axis=0)
    places[:, axes] = clip.values[:, own]
    moved = planar.move(steps, places)
    for axis in (0, 2):
        if axis not in axes and not np.allclose(moved[:, axis], places[:, axis], atol=1e-9):
            raise Mismatch(f"joint {skeleton.names[joint]!r} has to be moved, and has no channel {AXES[axis]}position")
    return _with(clip, own.tolist(), moved[:, axes])


def _refitted(
    clip: SplineMotion, steps: np.ndarray, joint: int, columns: list[int], order: str
) -> tuple[SplineMotion, np.ndarray, float]:
    """A root's angles after its turning, by least squares on knots that are halved until they are near enough."""
    if len(set(order)) < 3:
        raise Mismatch(f"the channels of {clip.skeleton.names[joint]!r} cannot express the turning of the body")
    for halving in range(HALVINGS + 1):
        breaks = np.unique(clip.knots[clip.degree : len(clip.knots) - clip.degree])
        along = (np.arange(2 * clip.degree + 2) + 0.5) / (2 * clip.degree + 2)
        at = np.sort(np.concatenate([breaks, (breaks[:-1, None] + np.diff(breaks)[:, None] * along).ravel()]))
        angles = bspline.evaluate(clip.knots, steps[:, :1], clip.degree, at)[:, 0]
        turning = planar.quaternion(np.stack([angles, 0.0 * angles, 0.0 * angles], axis=1))
        own = clip.at(at)[:, columns]
        turned = rotation.to_euler(rotation.mul(turning, rotation.from_euler(own, order)), order)
        wanted = rotation.unroll_euler(np.vstack([own[:1], turned]), order)[1:]
        values = least_squares(clip.knots, clip.degree, at, wanted)
        found = bspline.evaluate(clip.knots, values, clip.degree, at)
        off = float(rotation.angle(*(rotation.from_euler(angles, order) for angles in (found, wanted))).max())
        if off <= NEAR_DEGREES or halving == HALVINGS:
            break
        finer = np.sort(np.concatenate([clip.knots, 0.5 * (breaks[:-1] + breaks[1:])]))
        steps = bspline.refine(clip.knots, steps, clip.degree, finer)
        clip = refined(clip, finer)
    return _with(clip, columns, values), steps, off
