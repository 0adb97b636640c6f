"""A cycle as periodic B-splines: what closes by construction, with all derivatives below the degree.

Source: Sudarsky and House 1998, Motion capture data manipulation and reuse via B-splines (cyclification: the last p
coefficients are the first p). What a cycle travels and turns is taken out before and put back onto the coefficients.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from .. import bspline, planar
from ..bspline_fit import periodic_least_squares
from ..errors import OptionError
from ..kinematics import rest_height, world
from ..motion import Motion, unroll
from ..spline import SplineMotion
from ._poses import Poses, motion_of, moved, poses_of
from ._splices import carried

SPAN = 0.1  # seconds between the first knots
HALVINGS = 6
NEAR = 0.005  # of the body's height: where a joint is further off, knots are added as long as frames lie between
NEAR_DEGREES = 0.1  # where the body has no height


@dataclass(frozen=True, eq=False)
class Cycle:
    """One cycle as seen from where an even way along its planar transform has it.

    breaks: (K,) seconds from 0 to the period, the spans of the curves. values: (K - 1 + p, C), the last p the first p,
    but for whole turns (C,), degrees a cycle. step: (3,). base: the frames it was fitted to. off: the largest distance
    of a joint from them, file units (degrees where the body has no size).
    """

    breaks: np.ndarray
    values: np.ndarray
    degree: int
    turns: np.ndarray
    step: np.ndarray
    base: Motion
    off: float

    @property
    def period(self) -> float:
        return float(self.breaks[-1])

    def frames(self) -> Poses:
        """The poses of its frames, where the body is."""
        seen = replace(self.base, values=self._seen(self.base.frames))
        along = np.arange(self.base.frames) / self.base.frames
        return moved(poses_of(seen), self.base.skeleton, planar.power(self.step, along))

    def spline(self, cycles: int, frame_time: float, frames: int) -> tuple[SplineMotion, float]:
        """So many cycles as one spline whose coefficients repeat, carried on; and the degrees by which a root's
        angles are off where its channels cannot say its turning exactly."""
        count = len(self.breaks) - 1
        starts = self.period * np.arange(cycles)[:, None]
        breaks = np.append((starts + self.breaks[:-1]).ravel(), cycles * self.period)
        knots = self._beyond(breaks)
        along = bspline.greville(knots, self.degree) / self.period
        values = self.values[np.arange(len(knots) - self.degree - 1) % count]
        once = SplineMotion(
            self.base.skeleton, knots, values + along[:, None] * self.turns, self.degree, frame_time, frames
        )
        return carried(once, planar.power(self.step, along))

    def _seen(self, count: int) -> np.ndarray:
        at = self.period * np.arange(count) / count
        found = bspline.evaluate(bspline.periodic(self.breaks, self.degree), self.values, self.degree, at)
        return found + np.outer(at / self.period, self.turns)

    def _beyond(self, breaks: np.ndarray) -> np.ndarray:
        """Knots with these breaks that go on at both ends as the cycle does."""
        p = self.degree
        before, after = self.breaks[-p - 1 : -1] - self.period, self.breaks[1 : p + 1] + breaks[-1]
        return np.concatenate([before, breaks, after])


def fitted(closed: Poses, base: Motion, step: np.ndarray, breaks: np.ndarray | None, degree: int) -> Cycle:
    """The periodic curves nearest to the frames of a closed cycle, which is carried on by `step` (3,).

    base: as many frames whose channels these poses are written in. breaks: from 0 to the period, seconds; None: evenly.
    Spans in which a joint is further off than half a percent of the body's height are halved, as long as frames lie
    between.
    """
    count = len(closed)
    along = np.arange(count) / count
    seen = unroll(motion_of(moved(closed, base.skeleton, planar.power(step, -along)), base))
    seen, turns = _without_turns(seen)
    period = count * base.frame_time
    if breaks is None:
        breaks = np.linspace(0.0, period, max(1, round(period / SPAN)) + 1)
    kept = np.diff(breaks, prepend=-period) >= 2.0 * base.frame_time  # a span has samples
    breaks = np.append(breaks[:-1][kept[:-1] & (breaks[:-1] <= period - 2.0 * base.frame_time)], period)
    limit = NEAR * rest_height(base) or NEAR_DEGREES
    for _ in range(HALVINGS + 1):
        breaks = _enough(breaks, degree)
        knots = bspline.periodic(breaks, degree)
        values = periodic_least_squares(knots, degree, period * along, seen.values)
        off = _off(seen, bspline.evaluate(knots, values, degree, period * along))
        wanted = np.unique(np.searchsorted(breaks, period * along[off > limit], "right") - 1)
        wanted = wanted[np.diff(breaks)[wanted] >= 2.0 * base.frame_time]
        if not len(wanted):
            break
        breaks = np.sort(np.concatenate([breaks, 0.5 * (breaks[wanted] + breaks[wanted + 1])]))
    return Cycle(breaks, values, degree, turns, step, seen, float(off.max(initial=0.0)))


# -- in call order ---------------------------------------------------------------------------------


def _without_turns(seen: Motion) -> tuple[Motion, np.ndarray]:
    """Channels that come back to where they were, and the whole turns (C,) that they make in a cycle, degrees."""
    around = unroll(replace(seen, values=np.vstack([seen.values, seen.values[:1]]))).values
    away = around[-1] - around[0]
    turns = 360.0 * np.rint(away / 360.0)
    odd = np.flatnonzero(np.abs(away - turns) > 1e-6)
    if len(odd):
        name = seen.skeleton.names[seen.skeleton.channel_joints[odd[0]]]
        raise OptionError(f"the angles of {name!r} come back as another Euler triple: close the loop by crossfade")
    return replace(seen, values=around[:-1] - np.outer(np.arange(seen.frames) / seen.frames, turns)), turns


def _off(seen: Motion, values: np.ndarray) -> np.ndarray:
    """(F,) how far some joint is from where it was seen, file units (of a channel, where the body has no size)."""
    if rest_height(seen) > 0:
        away = world(replace(seen, values=values)) - world(seen)
        return np.asarray(np.linalg.norm(away, axis=-1).max(axis=1, initial=0.0))
    return np.asarray(np.abs(values - seen.values).max(axis=1, initial=0.0))


def _enough(breaks: np.ndarray, degree: int) -> np.ndarray:
    """At least as many spans as a periodic spline of this degree takes."""
    while len(breaks) <= degree:
        breaks = np.sort(np.concatenate([breaks, 0.5 * (breaks[:-1] + breaks[1:])]))
    return breaks
