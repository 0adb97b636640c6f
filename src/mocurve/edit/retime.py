"""The verb `retime`: slower here, faster there (Sudarsky and House 1998, time constraints; Witkin and Popović 1995)."""

from __future__ import annotations

import warnings
from dataclasses import replace
from itertools import pairwise

import numpy as np

from .. import bspline
from ..bspline_fit import least_squares
from ..errors import OptionError
from ..keyed import HermiteCurve, KeyedMotion
from ..motion import Clip, frame_count
from ..spline import SplineMotion, clamped, refined
from ._pair import at_times, check_mode, recorded
from ._slopes import speeds
from ._time import Pairs, TimeMap, length_of, pairs_of

MODES = ("refit", "knots")
NEAR = 0.01  # of a frame: so near to the start or the end of the clip, it is meant
MOST = 10_000_000  # frames
SLOW, FAST = 2.0, 0.5  # new seconds per old one beyond which motion no longer looks like itself


def retime(clip: Clip, map: Pairs, *, mode: str = "refit") -> Clip:
    """The clip with its moments moved to other times; smooth in between, never backwards.

    Parameters
    ----------
    map
        Pairs of an old time and its new one, seconds: 1.2:1.5. The start stays at 0, and what comes after the last pair
        keeps its speed.
    mode
        For splines: refit, the bent curves fitted on moved knots, or knots, where knots are moved and coefficients
        only shifted along: at once, but near the bent curves (a warning tells how near). One even speed is exact.

    Samples are taken anew at the clip's frame time, keys are moved with their slopes. Errors: OptionError where times
    lie outside the clip or do not rise. A warning where the speed changes by more than a factor of two.

    >>> slower_landing = mc.retime(jump, {2.0: 2.0, 2.4: 3.0})
    """
    check_mode(mode, MODES)
    bent = time_map(clip, map)
    pairs = np.stack([bent.old, bent.new], axis=1).tolist()
    history = (*clip.history, {"verb": "retime", "map": pairs, "mode": mode})
    _tell_speed(bent)
    if isinstance(clip, KeyedMotion):
        made: Clip = _of_keys(clip, bent)
    elif isinstance(clip, SplineMotion):
        made = _of_spline(clip, bent, mode)
    else:
        new = np.arange(frame_count(float(bent.new[-1]), clip.frame_time)) * clip.frame_time
        made = at_times(clip, bent.back(new), clip.frame_time)
    return recorded(made, history)


def time_map(clip: Clip, map: Pairs) -> TimeMap:
    """The map that `retime` uses: through the pairs, from the clip's start to its end."""
    end = length_of(clip) if isinstance(clip, KeyedMotion | SplineMotion) else clip.duration
    if not end > 0:
        raise OptionError("a clip of one frame has no time to change")
    given = sorted(pairs_of(map))
    if not given:
        raise OptionError("no pair of times is given, like 1.2:1.5")
    for old, _ in given:
        if not -0.5 * clip.frame_time <= old <= end + 0.5 * clip.frame_time:
            raise OptionError(f"the time {old:g} s lies outside of the clip, which goes from 0 to {end:g} s")
    near = NEAR * clip.frame_time
    given = [(0.0 if old < near else end if old > end - near else old, new) for old, new in given]
    if given[0][0] > 0:
        given = [(0.0, 0.0), *given]
    if given[0][1] != 0:
        raise OptionError(f"the start of the clip stays at 0 s, it cannot go to {given[0][1]:g} s")
    if given[-1][0] < end:
        given = [*given, (end, given[-1][1] + end - given[-1][0])]
    for (old, new), (next_old, next_new) in pairwise(given):
        if next_old == old:
            raise OptionError(f"two new times are given for {old:g} s")
        if not next_new > new:
            raise OptionError(
                f"time cannot stand or run backwards: {old:g} s goes to {new:g} s, {next_old:g} s to {next_new:g} s"
            )
    if not given[-1][1] / clip.frame_time < MOST:
        raise OptionError(f"the clip would last {given[-1][1]:.6g} s, {given[-1][1] / clip.frame_time:.3g} frames")
    times = np.array(given)
    return TimeMap(times[:, 0], times[:, 1], speeds(times[:, 0], times[:, 1]))


def departure(clip: Clip, made: Clip, bent: TimeMap) -> dict[str, float]:
    """How far the retimed curves are from the bent ones: largest difference in degrees and in file length units, at
    eight times a frame."""
    step = clip.frame_time / 8
    old = np.arange(frame_count(float(bent.old[-1]), step)) * step
    kept = old[bent.at(old) <= made.duration + 1e-9]
    off = np.abs(at_times(made, bent.at(kept), step).values - at_times(clip, kept, step).values)
    turning = clip.skeleton.rotation_channels
    return {"degrees": float(off[:, turning].max(initial=0.0)), "units": float(off[:, ~turning].max(initial=0.0))}


# -- in call order ---------------------------------------------------------------------------------


def _tell_speed(bent: TimeMap) -> None:
    at = np.linspace(bent.old[0], bent.old[-1], 1000)
    rate = bent.speeds(at)
    slow, fast = int(np.argmax(rate)), int(np.argmin(rate))
    if rate[slow] > SLOW:
        warnings.warn(f"the clip runs {rate[slow]:.3g} times slower at {at[slow]:.3g} s", stacklevel=3)
    if rate[fast] < FAST:
        warnings.warn(f"the clip runs {1 / rate[fast]:.3g} times faster at {at[fast]:.3g} s", stacklevel=3)


def _of_keys(clip: KeyedMotion, bent: TimeMap) -> KeyedMotion:
    curves = []
    for curve in clip.curves:
        rate = bent.speeds(curve.times)
        curves.append(HermiteCurve(bent.at(curve.times), curve.values, curve.slopes / rate, curve.in_slopes / rate))
    return replace(clip, curves=tuple(curves), frames=frame_count(float(bent.new[-1]), clip.frame_time))


def _of_spline(clip: SplineMotion, bent: TimeMap, mode: str) -> SplineMotion:
    frames = frame_count(float(bent.new[-1]), clip.frame_time)
    if bent.even:
        return replace(clip, knots=bent.at(clip.knots), frames=frames)
    clip = clamped(clip)
    start, end = clip.domain
    pairs = bspline.snapped(bent.old, clip.knots)
    pairs = pairs[(pairs > start) & (pairs < end)]  # their images are to be knots
    times = 2 if mode == "refit" and clip.degree > 1 else 1  # the change of speed is not smooth at a pair
    clip = refined(clip, bspline.union(clip.knots, np.repeat(pairs, times)))
    moved = replace(clip, knots=bent.at(clip.knots), frames=frames)
    if mode == "refit":
        return _refitted(clip, moved, bent)
    moved = replace(moved, values=_carried(clip, moved, bent))
    off = departure(clip, moved, bent)
    warnings.warn(
        f"knots were moved: the curves are off by up to {off['degrees']:.3g} degrees and {off['units']:.3g} units "
        "(mode refit is nearer)",
        stacklevel=4,
    )
    return moved


def _carried(clip: SplineMotion, moved: SplineMotion, bent: TimeMap) -> np.ndarray:
    """Coefficients (N, C) for moved knots, right to the second order where the change of speed is smooth.

    A coefficient is the polar form of its p knots, which is the curve at their mean less half their variance / (p - 1)
    times its curvature. The mean of moved knots is `late`, and the curvature that the bent time adds makes that as much
    again, divided by p - 1; Sudarsky and House leave both as an error.
    """
    place, new = (bspline.greville(spline.knots, clip.degree) for spline in (clip, moved))
    knots, slopes, degree = bspline.derivative(clip.knots, clip.values, clip.degree)
    if degree == 0:  # straight lines meet where their coefficients are
        return clip.values
    late = (bent.back(new) - place) * clip.degree / (clip.degree - 1)
    return clip.values + late[:, None] * bspline.evaluate(knots, slopes, degree, place)


def _refitted(clip: SplineMotion, moved: SplineMotion, bent: TimeMap) -> SplineMotion:
    """The bent curves fitted on the moved knots, from several times inside every span; both ends are kept."""
    breaks = np.unique(moved.knots)
    count = 2 * (clip.degree + 1)
    along = (np.arange(count) + 0.5) / count
    new = (breaks[:-1, None] + np.diff(breaks)[:, None] * along).reshape(-1)
    ends = clip.values[:1], clip.values[-1:]
    values = least_squares(moved.knots, clip.degree, new, clip.at(bent.back(new)), first=ends[0], last=ends[1])
    return replace(moved, values=values)
