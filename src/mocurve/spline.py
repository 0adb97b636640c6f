"""Motion as B-splines: one basis for all channels of a clip, and a coefficient of each at each of its places.

Sudarsky and House 1998, section 3: what is done to the coefficients is done to the curves.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from . import bspline
from .errors import Mismatch
from .keyed import HermiteCurve, KeyedMotion
from .motion import History, Motion, checked_frame_time, frame_count
from .skeleton import Skeleton, frozen

if TYPE_CHECKING:
    from .measure import Report

Kind = TypeVar("Kind", Motion, KeyedMotion, "SplineMotion")


@dataclass(frozen=True, eq=False)
class SplineMotion:
    """One B-spline curve a channel, all on the same knots; constant before the first and after the last.

    knots:      (N + p + 1,) seconds, rising; where they are clamped the curves begin and end at their end coefficients.
    values:     (N, C) coefficients, degrees and file length, read-only, stored channel after channel.
    degree:     p, 1 to 5.
    frame_time: seconds a frame of the source; frames: how many the source had.
    report:     what the fit that made it measured; None for curves that came otherwise.
    """

    skeleton: Skeleton
    knots: np.ndarray
    values: np.ndarray
    degree: int
    frame_time: float
    frames: int
    history: History = ()
    report: Report | None = None

    def __post_init__(self) -> None:
        values = np.asfortranarray(self.values, np.float64)
        if values.ndim != 2 or values.shape[1] != self.skeleton.channel_count:
            raise Mismatch(
                f"the skeleton has {self.skeleton.channel_count} channels, the coefficients have shape {values.shape}"
            )
        object.__setattr__(self, "knots", frozen(bspline.checked(self.knots, len(values), self.degree)))
        object.__setattr__(self, "values", frozen(values))
        object.__setattr__(self, "frame_time", checked_frame_time(self.frame_time))

    def __repr__(self) -> str:
        told = f": {self.report.sentence()}" if self.report is not None else ""
        size = f"{len(self.values)} coefficients of degree {self.degree} for {self.frames} frames"
        return f"<SplineMotion {size} x {self.values.shape[1]} channels{told}>"

    @property
    def keys(self) -> int:
        """All coefficients of all channels."""
        return int(self.values.size)

    @property
    def duration(self) -> float:
        """Seconds from the first frame of the source to its last."""
        return max(self.frames - 1, 0) * self.frame_time

    @property
    def domain(self) -> tuple[float, float]:
        """Seconds from which and to which the curves are splines."""
        return float(self.knots[self.degree]), float(self.knots[len(self.values)])

    def at(self, times: np.ndarray) -> np.ndarray:
        """Values (M, C) at any times (M,), seconds."""
        return bspline.evaluate(self.knots, self.values, self.degree, np.asarray(times, np.float64).reshape(-1))

    def sample(self, frame_time: float | None = None) -> Motion:
        """Samples at a frame time (seconds), by default the source's own."""
        step = self.frame_time if frame_time is None else checked_frame_time(frame_time)
        frames = self.frames if step == self.frame_time or self.frames < 2 else frame_count(self.duration, step)
        return Motion(self.skeleton, self.at(np.arange(frames) * step), step, self.history)


def refined(clip: SplineMotion, knots: np.ndarray) -> SplineMotion:
    """The same curves on finer knots (seconds), which hold the clip's own; exact, by the Oslo algorithm."""
    values = bspline.refine(clip.knots, clip.values, clip.degree, knots)
    return replace(clip, knots=knots, values=values, report=None)


def clamped(clip: SplineMotion) -> SplineMotion:
    """The same curves on clamped knots: they begin at their first coefficient and end at their last one."""
    knots, values = bspline.clamp(clip.knots, clip.values, clip.degree)
    return replace(clip, knots=knots, values=values, report=None)


def raised(clip: SplineMotion, degree: int) -> SplineMotion:
    """The same curves with a degree as high or higher (at most 5)."""
    if degree < clip.degree:
        raise Mismatch(f"the degree can be raised from {clip.degree} on, not lowered to {degree}")
    if degree == clip.degree:
        return clip
    knots, values, now = clip.knots, clip.values, clip.degree
    while now < degree:
        knots, values, now = bspline.raise_degree(knots, values, now)
    return replace(clip, knots=knots, values=values, degree=now, report=None)


def align(a: Kind, b: Kind) -> tuple[Kind, Kind]:
    """The same two clips on a common basis, so that arithmetic on their values is arithmetic on their curves.

    Two splines get the higher degree and the union of their knots, two clips of keys a key of each channel wherever one
    of them has it: both exact. Two motions get the finer of their frame times.
    Mismatch names the first difference of the skeletons' channels; or durations differ, or the kinds.
    """
    mine, others = a.skeleton.channel_names, b.skeleton.channel_names
    if mine != others:
        at = next(
            (i for i, (m, o) in enumerate(zip(mine, others, strict=False)) if m != o), min(len(mine), len(others))
        )
        left, right = (names[at] if at < len(names) else "no more channels" for names in (mine, others))
        raise Mismatch(f"the skeletons differ: the first has {left!r} where the second has {right!r}")
    if type(a) is not type(b):
        raise Mismatch(f"a {type(a).__name__} and a {type(b).__name__} share no basis: sample, reduce or fit one first")
    if abs(a.duration - b.duration) > 0.5 * min(a.frame_time, b.frame_time):
        raise Mismatch(f"the clips last {a.duration:.6g} and {b.duration:.6g} s: cut, loop or retime one of them first")
    if isinstance(a, SplineMotion):
        return _aligned_splines(a, b)  # type: ignore[return-value, arg-type]
    if isinstance(a, KeyedMotion):
        return _aligned_keys(a, b)  # type: ignore[return-value, arg-type]
    return _aligned_samples(a, b)


def of_keys(keys: KeyedMotion) -> SplineMotion:
    """The same curves as cubic B-splines, exactly: all channels' keys are double knots (triple with a broken tangent).

    Meant for channels that share key times; else every channel pays for the keys of all.
    """
    ends = [(curve.times[0], curve.times[-1]) for curve in keys.curves if len(curve)]
    start, end = min((e[0] for e in ends), default=0.0), max((e[1] for e in ends), default=0.0)
    end = end if end > start else start + keys.frame_time
    curves = [_whole(curve, start, end) for curve in keys.curves]
    pieces = [bspline.from_hermite(c.times, c.values, c.slopes, c.in_slopes) for c in curves]
    knots = bspline.clamped(np.array([start, end]))
    for own, _ in pieces:
        knots = bspline.union(knots, own)
    values = np.empty((len(knots) - 4, len(pieces)), order="F")
    for channel, (own, handles) in enumerate(pieces):
        values[:, channel] = bspline.refine(own, handles[:, None], 3, knots)[:, 0]
    return SplineMotion(keys.skeleton, knots, values, 3, keys.frame_time, keys.frames, keys.history)


def to_keys(clip: SplineMotion) -> KeyedMotion:
    """The same curves as Hermite keys, exactly: a key of every channel at every knot. Mismatch above degree 3."""
    if clip.degree > 3:
        raise Mismatch(f"a spline of degree {clip.degree} has no Hermite keys that say the same: reduce it")
    cubic = raised(clip, 3)
    times, values, leaving, arriving = bspline.to_hermite(cubic.knots, cubic.values)
    smooth = np.abs(leaving - arriving) <= 1e-9 * np.abs(leaving).max(axis=0, initial=0.0)  # a single or double knot
    arriving = np.where(smooth, leaving, arriving)
    curves = tuple(
        HermiteCurve(times, values[:, c], leaving[:, c], arriving[:, c]) for c in range(clip.values.shape[1])
    )
    return KeyedMotion(clip.skeleton, curves, clip.frame_time, clip.frames, clip.history)


# -- in call order ---------------------------------------------------------------------------------


def _aligned_splines(a: SplineMotion, b: SplineMotion) -> tuple[SplineMotion, SplineMotion]:
    degree = max(a.degree, b.degree)
    a, b = raised(a, degree), raised(b, degree)
    if np.array_equal(a.knots, b.knots):
        return a, b
    a, b = clamped(a), clamped(b)
    if max(abs(x - y) for x, y in zip(a.domain, b.domain, strict=True)) > 1e-6 * (a.domain[1] - a.domain[0]):
        raise Mismatch(
            f"the splines lie from {a.domain[0]:g} to {a.domain[1]:g} s and {b.domain[0]:g} to {b.domain[1]:g} s"
        )
    other = bspline.snapped(_moved(b.knots, b.domain, a.domain), a.knots)
    b = replace(b, knots=other)
    knots = bspline.union(a.knots, b.knots)
    return refined(a, knots), refined(b, knots)


def _moved(knots: np.ndarray, old: tuple[float, float], new: tuple[float, float]) -> np.ndarray:
    """Knots stretched from one domain to another, ends exact."""
    if old == new:
        return knots
    moved = new[0] + (knots - old[0]) * ((new[1] - new[0]) / (old[1] - old[0]))
    moved[knots == old[0]], moved[knots == old[1]] = new
    return moved


def _aligned_keys(a: KeyedMotion, b: KeyedMotion) -> tuple[KeyedMotion, KeyedMotion]:
    pairs = []
    for mine, others in zip(a.curves, b.curves, strict=True):
        if not len(mine) or not len(others):
            pairs.append((mine, others))
            continue
        theirs = bspline.snapped(others.times, mine.times) if len(mine) > 1 else others.times
        others = replace(others, times=theirs)
        times = np.union1d(mine.times, theirs)
        pairs.append((with_keys(mine, times), with_keys(others, times)))
    first, second = (tuple(side) for side in zip(*pairs, strict=True)) if pairs else ((), ())
    return replace(a, curves=first, report=None), replace(b, curves=second, report=None)


def with_keys(curve: HermiteCurve, times: np.ndarray) -> HermiteCurve:
    """The same curve with a key at all these times, its own among them."""
    if len(times) < 2:
        return curve
    whole = _whole(curve, times[0], times[-1])
    knots, handles = bspline.from_hermite(whole.times, whole.values, whole.slopes, whole.in_slopes)
    new = np.setdiff1d(times, whole.times)
    knots, values = bspline.insert(knots, handles[:, None], 3, new)
    _, values, leaving, arriving = (part.reshape(len(times)) for part in bspline.to_hermite(knots, values))
    own = np.isin(times, whole.times)
    values[own], leaving[own], arriving[own] = whole.values, whole.slopes, whole.in_slopes
    arriving[~own] = leaving[~own]
    return HermiteCurve(times, values, leaving, arriving)


def _whole(curve: HermiteCurve, start: float, end: float) -> HermiteCurve:
    """The same curve with keys at start and end (seconds), two at least: constant where it had none."""
    if not len(curve):
        return HermiteCurve([start, end], [0.0, 0.0], [0.0, 0.0])  # type: ignore[arg-type]
    times, values, leaving, arriving = curve.times, curve.values, curve.slopes.copy(), curve.in_slopes.copy()
    if start < times[0]:
        arriving[0] = 0.0
        times, values = np.append(start, times), np.append(values[0], values)
        leaving, arriving = np.append(0.0, leaving), np.append(0.0, arriving)
    if end > times[-1]:
        leaving[-1] = 0.0
        times, values = np.append(times, end), np.append(values, values[-1])
        leaving, arriving = np.append(leaving, 0.0), np.append(arriving, 0.0)
    return HermiteCurve(times, values, leaving, arriving)


def _aligned_samples(a: Motion, b: Motion) -> tuple[Motion, Motion]:
    step = min(a.frame_time, b.frame_time)
    first, second = a.sample(step), b.sample(step)
    frames = min(first.frames, second.frames)
    return first[:frames] if first.frames > frames else first, second[:frames] if second.frames > frames else second
