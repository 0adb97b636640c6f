"""Curves of keys, and splines, kept within limits: displacements that are keys themselves, so keys stay keys."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise

import numpy as np

from ..keyed import HermiteCurve, KeyedMotion
from ..spline import SplineMotion, to_keys
from ._envelope import LEAST
from ._extremes import extremes
from .warp import Bump, added, within

PASSES = 60
LEFT = 0.1 * LEAST  # less is not mended: it is no violation
HALVINGS = 50


def curves_of(clip: KeyedMotion | SplineMotion) -> tuple[HermiteCurve, ...] | None:
    """A curve of keys for each channel, None where there are none that say the same."""
    if isinstance(clip, SplineMotion):
        return to_keys(clip).curves if clip.degree <= 3 and clip.frames else None
    return clip.curves


def bounded(
    clip: KeyedMotion | SplineMotion, limits: Mapping[int, tuple[float, float]], support: float
) -> KeyedMotion | SplineMotion | None:
    """The clip with channels (by index) within limits everywhere, also between frames; None where that is not reached.

    A displacement for each run beyond a limit: as large as the violation at each of its peaks, at rest there, and gone
    `support` seconds before and after the run. What is left between the peaks is done again.
    """
    start, end = clip.domain if isinstance(clip, SplineMotion) else (0.0, clip.duration)
    if not end > start:
        return None
    for _ in range(PASSES):
        curves = curves_of(clip)
        if curves is None:
            return None
        bumps = {}
        for channel, (low, high) in limits.items():
            if not len(curves[channel]):
                continue
            middle = 0.5 * (low + high) if high - low < np.inf else None
            by = _bump(curves[channel], high, middle, 1.0, support, (start, end))
            by = by or _bump(curves[channel], low, middle, -1.0, support, (start, end))
            if by is not None:
                bumps[channel] = within(by, start, end)
        if not bumps:
            return clip
        clip = added(clip, bumps)
    return None


def _bump(
    curve: HermiteCurve, limit: float, middle: float | None, way: float, support: float, span: tuple[float, float]
) -> Bump | None:
    """What is to be added to a curve that goes beyond an upper (way 1) or lower (-1) limit.

    It is gone before the curve has its next extreme on the other side of `middle`, that it may not leave there.
    """
    times, values = extremes(curve)
    beyond = way * (values - limit)
    above = np.flatnonzero(beyond > LEFT)
    if not len(above):
        return None
    other = np.array([]) if middle is None else times[way * (values - middle) < 0]
    points: list[tuple[float, float]] = []
    ends = -np.inf  # of the run before, its support included
    for first, last in _stretches(above):
        begins = _crossing(curve, limit, times, first, -1) - support
        begins = max(begins, other[other < times[first]].max(initial=-np.inf))
        if begins > ends:
            points += [(ends, 0.0)] if points else []
            points += [(span[0], beyond[0])] if first == 0 else [(begins, 0.0)]
        for k in range(first, last + 1):
            if beyond[k] >= beyond[max(k - 1, 0) : k + 2].max():
                points.append((float(times[k]), float(beyond[k])))
        ends = _crossing(curve, limit, times, last, 1) + support
        ends = min(ends, other[other > times[last]].min(initial=np.inf))
        if last == len(times) - 1:
            points.append((span[1], float(beyond[-1])))
            ends = np.inf
    if np.isfinite(ends):
        points.append((ends, 0.0))
    kept = [point for point, after in pairwise([*points, (np.inf, 0.0)]) if after[0] - point[0] > 1e-9]
    when, by = np.array(kept).T
    return Bump(when, -way * by[:, None], np.zeros((len(by), 1)))


def _stretches(places: np.ndarray) -> list[tuple[int, int]]:
    """First and last of each run of neighbouring numbers."""
    cuts = np.flatnonzero(np.diff(places) > 1)
    return list(zip(places[[0, *(cuts + 1)]].tolist(), places[[*cuts, len(places) - 1]].tolist(), strict=True))


def _crossing(curve: HermiteCurve, limit: float, times: np.ndarray, inside: int, step: int) -> float:
    """When the curve crosses the limit between an extreme beyond it and the next that is not; there it is monotone."""
    outside = inside + step
    if not 0 <= outside < len(times):
        return float(times[inside])
    beyond, within_ = float(times[inside]), float(times[outside])
    sign = np.sign(curve.at(np.array([beyond]))[0] - limit)
    for _ in range(HALVINGS):
        middle = 0.5 * (beyond + within_)
        if (curve.at(np.array([middle]))[0] - limit) * sign > 0:
            beyond = middle
        else:
            within_ = middle
    return beyond
