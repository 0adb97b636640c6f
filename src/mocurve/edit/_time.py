"""Time bent: a map from old times to new ones that always goes forward, and clips stretched evenly."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np

from .. import hermite
from ..errors import OptionError
from ..keyed import HermiteCurve, KeyedMotion
from ..motion import frame_count
from ..spline import SplineMotion
from ._slopes import rate_of

Pairs = Sequence[str] | Sequence[tuple[float, float]] | Mapping[float, float] | str
Curves = TypeVar("Curves", bound=KeyedMotion | SplineMotion)
NEWTON_STEPS = 60
EVEN = 1e-12  # of the speed: less than this it does not change


@dataclass(frozen=True, eq=False)
class TimeMap:
    """New times against old ones: a cubic through pairs, smooth in its speed, strictly rising.

    old, new: (K,) seconds, rising. speed: (K,) new seconds per old one at the pairs, above 0.
    """

    old: np.ndarray
    new: np.ndarray
    speed: np.ndarray

    @property
    def even(self) -> bool:
        """Whether the speed never changes: a straight line."""
        lines = np.diff(self.new) / np.diff(self.old)
        first = self.speed[0]
        return bool(np.ptp(np.concatenate([self.speed, lines])) <= EVEN * first)

    def at(self, times: np.ndarray) -> np.ndarray:
        """New times of old ones; beyond the pairs the speed stays."""
        times = np.asarray(times, np.float64)
        if self.even:
            return self.new[0] + (times - self.old[0]) * self.speed[0]
        inside = hermite.evaluate(self.old, self.new, self.speed, times)
        before, after = np.minimum(times - self.old[0], 0.0), np.maximum(times - self.old[-1], 0.0)
        return inside + self.speed[0] * before + self.speed[-1] * after

    def speeds(self, times: np.ndarray) -> np.ndarray:
        """New seconds per old one at old times."""
        times = np.clip(np.asarray(times, np.float64), self.old[0], self.old[-1])
        return np.full(times.shape, self.speed[0]) if self.even else rate_of(self.old, self.new, self.speed, times)

    def back(self, times: np.ndarray) -> np.ndarray:
        """Old times of new ones."""
        times = np.asarray(times, np.float64)
        if self.even:
            return self.old[0] + (times - self.new[0]) / self.speed[0]
        inside = np.clip(times, self.new[0], self.new[-1])
        span = np.clip(np.searchsorted(self.new, inside, "right") - 1, 0, len(self.new) - 2)
        low, high = self.old[span].copy(), self.old[span + 1].copy()
        found = low + (inside - self.new[span]) / (self.new[span + 1] - self.new[span]) * (high - low)
        for _ in range(NEWTON_STEPS):  # Newton's steps, halving wherever one leaves what holds the answer
            off = self.at(found) - inside
            low, high = np.where(off <= 0, found, low), np.where(off >= 0, found, high)
            step = off / self.speeds(found)
            if (np.abs(step) <= 4e-16 * (1.0 + np.abs(found))).all():
                break
            ahead = found - step
            found = np.where((ahead < low) | (ahead > high), 0.5 * (low + high), ahead)
        beyond = (times - inside) / np.where(times < self.new[0], self.speed[0], self.speed[-1])
        return found + beyond


def pairs_of(given: Pairs) -> list[tuple[float, float]]:
    """(old, new) seconds from any of the forms: "1:1.2", "1:1.2,2:2.5", lists of these, [(1, 1.2)], {1: 1.2}."""
    if isinstance(given, str):
        return [_pair(text.split(":"), text) for text in given.split(",")]
    if isinstance(given, Mapping):
        return [_pair(pair, pair) for pair in given.items()]
    found: list[tuple[float, float]] = []
    for item in given if isinstance(given, Sequence | np.ndarray) else [given]:
        found += pairs_of(item) if isinstance(item, str) else [_pair(item, item)]
    return found


def stretched(clip: Curves, length: float, frame_time: float) -> Curves:
    """The same curves, evenly faster or slower, so that the clip lasts so long (seconds); exact."""
    own = length_of(clip)
    if length == own and frame_time == clip.frame_time:
        return clip
    factor = length / own if own > 0 else 1.0
    frames = frame_count(length, frame_time)
    if isinstance(clip, SplineMotion):
        return replace(clip, knots=clip.knots * factor, frames=frames, frame_time=frame_time, report=None)
    curves = tuple(
        HermiteCurve(c.times * factor, c.values, c.slopes / factor, c.in_slopes / factor) for c in clip.curves
    )
    return replace(clip, curves=curves, frames=frames, frame_time=frame_time, report=None)


def length_of(clip: KeyedMotion | SplineMotion) -> float:
    """Seconds: to the last frame of keys, to where the curves of a spline end."""
    return clip.domain[1] if isinstance(clip, SplineMotion) else clip.duration


def _pair(given: object, told: object) -> tuple[float, float]:
    try:
        old, new = (float(number) for number in given)  # type: ignore[attr-defined]
    except (TypeError, ValueError):
        raise _odd(told) from None
    if not np.isfinite([old, new]).all():
        raise _odd(told)
    return old, new


def _odd(given: object) -> OptionError:
    return OptionError(f"a pair of times is old:new in seconds, like 1.2:1.5, not {given!r}")
