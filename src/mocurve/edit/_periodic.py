"""A cycle as periodic B-splines: what closes by construction, with all derivatives below the degree.

Source: Sudarsky and House 1998, Motion capture data manipulation and reuse via B-splines (cyclification: the last p
coefficients are the first p). What a cycle travels and turns is taken out before, and put back afterwards.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from .. import bspline, planar, rotation
from ..bspline_fit import periodic_least_squares
from ..errors import OptionError
from ..kinematics import rest_height, world
from ..motion import Motion, unroll
from ..spline import SplineMotion
from ._poses import Poses, motion_of, moved
from ._splices import carried

SPAN = 0.08  # seconds between the first knots
HALVINGS = 6
NEAR = 0.005  # of the body's height: where a joint is further off, knots are added as long as frames lie between
NEAR_UNITS = 0.1  # degrees and file units, where the body has no height


def as_frames(closed: Poses, base: Motion, step: np.ndarray, degree: int = 3) -> tuple[Poses, float]:
    """The frames of a closed cycle, which is carried on by `step` (3,), as periodic splines have them, and how far a
    joint is from where it was, at most, file units.

    base: as many frames. Quaternions are fitted, which know no gimbal lock; a joint that turns round in a cycle has
    that turn taken out before.
    """
    count = len(closed)
    along = np.arange(count) / count
    seen = moved(closed, base.skeleton, planar.power(step, -along))
    turns = rotation.unroll(seen.turns)
    spin = rotation.exp(-along[:, None, None] * _spins(turns))
    turns = rotation.unroll(rotation.mul(turns, spin))
    signals = np.concatenate([seen.shifts.reshape(count, -1), turns.reshape(count, -1)], axis=1)

    def poses(values: np.ndarray) -> Poses:
        shifts, found = np.split(values, [seen.shifts[0].size], axis=1)
        found = found.reshape(turns.shape)
        found = found / np.linalg.norm(found, axis=-1, keepdims=True)
        return Poses(shifts.reshape(seen.shifts.shape), rotation.mul(found, rotation.inv(spin)))

    period = count * base.frame_time
    breaks = np.linspace(0.0, period, max(1, round(period / SPAN)) + 1)
    _, values, off = _fitted(
        signals, breaks, degree, base, lambda found: motion_of(poses(found), base), motion_of(seen, base)
    )
    return moved(poses(values), base.skeleton, planar.power(step, along)), off


def as_spline(
    closed: Poses, base: Motion, step: np.ndarray, breaks: np.ndarray, degree: int
) -> tuple[Callable[[int, float, int], SplineMotion], float]:
    """The same as splines of the channels, with knots at the breaks, seconds from 0 to the period.

    A function from the number of cycles, the frame time and the number of frames to one spline whose coefficients
    repeat, carried on; and how far off a joint is at most.
    """
    along = np.arange(len(closed)) / len(closed)
    seen = unroll(motion_of(moved(closed, base.skeleton, planar.power(step, -along)), base))
    seen, turns = _without_turns(seen)
    breaks, values, off = _fitted(
        seen.values, breaks, degree, base, lambda found: replace(seen, values=found), seen, coefficients=True
    )
    period, spans = breaks[-1], len(breaks) - 1

    def repeated(cycles: int, frame_time: float, frames: int) -> SplineMotion:
        whole = np.append((period * np.arange(cycles)[:, None] + breaks[:-1]).ravel(), cycles * period)
        before, after = breaks[-degree - 1 : -1] - period, breaks[1 : degree + 1] + whole[-1]
        knots = np.concatenate([before, whole, after])
        share = bspline.greville(knots, degree) / period
        cycle = values[np.arange(len(share)) % spans] + share[:, None] * turns
        once = SplineMotion(base.skeleton, knots, cycle, degree, frame_time, frames)
        return carried(once, planar.power(step, share))[0]

    return repeated, off


# -- in call order ---------------------------------------------------------------------------------


def _spins(turns: np.ndarray) -> np.ndarray:
    """(J, 3) of joints that turn round once more than they turn back in a cycle (F, J, 4): that turn, radians."""
    steps = rotation.log(rotation.mul(rotation.inv(turns), np.roll(turns, -1, axis=0))).sum(axis=0)
    size = np.linalg.norm(steps, axis=-1, keepdims=True)
    around = (turns[0] * turns[-1]).sum(axis=-1)[:, None] < 0
    return np.where(around & (size > 0), 2.0 * np.pi * steps / np.where(size > 0, size, 1.0), 0.0)


def _fitted(
    signals: np.ndarray,
    breaks: np.ndarray,
    degree: int,
    base: Motion,
    motion: Callable[[np.ndarray], Motion],
    wanted: Motion,
    coefficients: bool = False,
) -> tuple[np.ndarray, np.ndarray, float]:
    """Breaks, what the curves are at the frames (or their coefficients), and how far a joint is off at most.

    Spans in which a joint is further off than half a percent of the body's height are halved, as long as frames lie
    between. motion: what the signals (F, K) say.
    """
    at = base.frame_time * np.arange(len(signals))
    least = 2.0 * base.frame_time
    kept = (np.diff(breaks, prepend=-np.inf) >= least) & (breaks <= breaks[-1] - least)
    breaks = np.append(breaks[kept], breaks[-1])
    height, places = rest_height(base), world(wanted)
    for _ in range(HALVINGS + 1):
        while len(breaks) <= degree:
            breaks = np.sort(np.concatenate([breaks, 0.5 * (breaks[:-1] + breaks[1:])]))
        knots = bspline.periodic(breaks, degree)
        values = periodic_least_squares(knots, degree, at, signals)
        found = bspline.evaluate(knots, values, degree, at)
        if height > 0:
            off = np.linalg.norm(world(motion(found)) - places, axis=-1).max(axis=1, initial=0.0)
        else:
            off = np.abs(found - signals).max(axis=1, initial=0.0)
        spans = np.unique(np.searchsorted(breaks, at[off > (NEAR * height or NEAR_UNITS)], "right") - 1)
        spans = spans[np.diff(breaks)[spans] >= least]
        if not len(spans):
            break
        breaks = np.sort(np.concatenate([breaks, 0.5 * (breaks[spans] + breaks[spans + 1])]))
    return knots[degree : len(knots) - degree], values if coefficients else found, float(off.max(initial=0.0))


def _without_turns(seen: Motion) -> tuple[Motion, np.ndarray]:
    """Channels that come back to where they were, and the whole turns (C,) that they make in a cycle, degrees."""
    around = unroll(replace(seen, values=np.vstack([seen.values, seen.values[:1]]))).values
    away = around[-1] - around[0]
    turns = 360.0 * np.rint(away / 360.0)
    odd = np.flatnonzero(np.abs(away - turns) > 1e-6)
    if len(odd):
        name = seen.skeleton.names[seen.skeleton.channel_joints[odd[0]]]
        raise OptionError(f"the angles of {name!r} come back as another Euler triple: sample the spline to loop it")
    return replace(seen, values=around[:-1] - np.outer(np.arange(seen.frames) / seen.frames, turns)), turns
