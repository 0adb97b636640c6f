"""The verb `trim`: a piece of a clip, exactly as it was."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from .. import bspline
from ..errors import Mismatch, OptionError
from ..keyed import HermiteCurve, KeyedMotion
from ..motion import Clip, Motion, trimmed
from ..spline import SplineMotion, with_keys
from ._pair import recorded, tell_sampled


def trim(clip: Clip, *, start: float = 0.0, end: float | None = None) -> Clip:
    """The clip from one moment to another, which then begins at 0 seconds.

    Parameters
    ----------
    start
        Second of the first frame that stays.
    end
        Second of the last frame that stays; by default the clip's last.

    A time between two frames counts as the nearer one. Samples stay to the last digit. Keys get a key at both ends
    (their curves are divided exactly), splines get knots there; one moment of a spline becomes a sample. Errors:
    OptionError for times outside the clip or in the wrong order, Mismatch for a clip without frames.

    >>> landing = mc.trim(jump, start=2.0, end=2.8)
    """
    first, last = _frames(clip, start, end)
    if (first, last) == (0, clip.frames - 1):
        return clip
    if isinstance(clip, Motion):
        return clip[first : last + 1]
    start, end = first * clip.frame_time, last * clip.frame_time
    count = last - first + 1
    if isinstance(clip, KeyedMotion):
        curves = tuple(_of_curve(curve, start, end) for curve in clip.curves)
        made: Clip = replace(clip, curves=curves, frames=count)
    elif isinstance(clip, SplineMotion) and last > first:
        knots, values = _of_spline(clip, start, end)
        made = replace(clip, knots=knots, values=values, frames=count)
    else:
        tell_sampled((clip,), "one moment is no curve")
        made = clip.sample()[first : last + 1]
    return recorded(made, (*clip.history, trimmed(start, end)))


# -- in call order ---------------------------------------------------------------------------------


def _frames(clip: Clip, start: float, end: float | None) -> tuple[int, int]:
    """The first and the last frame that stay."""
    if not clip.frames:
        raise Mismatch("a clip without frames has no piece to keep")
    found = []
    for name, time in (("start", start), ("end", clip.duration if end is None else end)):
        if isinstance(time, bool) or not isinstance(time, int | float) or not np.isfinite(time):
            raise OptionError(f"{name} is a number of seconds, not {time!r}")
        if not -0.5 * clip.frame_time <= time <= clip.duration + 0.5 * clip.frame_time:
            raise OptionError(
                f"the {name} at {time:g} s lies outside of the clip, which goes from 0 to {clip.duration:g} s"
            )
        found.append(min(round(max(time, 0.0) / clip.frame_time), clip.frames - 1))
    if found[1] < found[0]:
        raise OptionError(f"the piece ends at {end:g} s, before its start at {start:g} s")
    return found[0], found[1]


def _of_curve(curve: HermiteCurve, start: float, end: float) -> HermiteCurve:
    if not len(curve):
        return curve
    if start == end:
        return HermiteCurve(np.zeros(1), curve.at(np.array([start])), np.zeros(1))
    if len(curve) > 1:
        ends = bspline.snapped(np.array([start, end]), curve.times)  # a key within rounding is the end
        start, end = float(ends[0]), float(ends[1])
    whole = with_keys(curve, np.union1d(curve.times, [start, end]))
    inside = (whole.times >= start) & (whole.times <= end)
    leaving, arriving = whole.slopes[inside].copy(), whole.in_slopes[inside].copy()
    arriving[0], leaving[-1] = leaving[0], arriving[-1]  # what lay beyond the ends is gone
    return HermiteCurve(whole.times[inside] - start, whole.values[inside], leaving, arriving)


def _of_spline(clip: SplineMotion, start: float, end: float) -> tuple[np.ndarray, np.ndarray]:
    """Knots and values of the piece, on clamped knots."""
    knots, values, p = *bspline.clamp(clip.knots, clip.values, clip.degree), clip.degree
    cuts = bspline.snapped(np.array([max(start, knots[0]), min(end, knots[-1])]), knots)
    missing = [np.repeat(cut, max(p - int((knots == cut).sum()), 0)) for cut in cuts if knots[0] < cut < knots[-1]]
    if missing:
        knots, values = bspline.insert(knots, values, p, np.concatenate(missing))
    low = int(np.searchsorted(knots, cuts[0], "right")) - p - 1  # the coefficient that is the value at the cut
    high = int(np.searchsorted(knots, cuts[1], "left"))
    inner = knots[(knots > cuts[0]) & (knots < cuts[1])]
    kept = bspline.clamped(np.concatenate([cuts[:1], inner, cuts[1:]]), p) - start
    return kept, values[low:high]
