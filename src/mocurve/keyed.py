"""Keys: what an animator edits. A Hermite curve per channel."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from . import hermite
from .errors import Mismatch
from .motion import History, Motion, checked_frame_time, frame_count
from .skeleton import Skeleton, frozen

if TYPE_CHECKING:
    from .measure import Report


@dataclass(frozen=True, eq=False)
class HermiteCurve:
    """A cubic Hermite curve through keys; constant before the first and after the last.

    times:     (K,) seconds, strictly rising.
    values:    (K,) degrees or file length.
    slopes:    (K,) per second, leaving the key.
    in_slopes: (K,) per second, arriving at the key; the same array as `slopes` unless the tangent is broken there.
    """

    times: np.ndarray
    values: np.ndarray
    slopes: np.ndarray
    in_slopes: np.ndarray = None  # type: ignore[assignment]  # None: not broken

    def __post_init__(self) -> None:
        for name in ("times", "values", "slopes"):
            object.__setattr__(self, name, frozen(np.array(getattr(self, name), np.float64).reshape(-1)))
        arriving = self.slopes if self.in_slopes is None else frozen(np.array(self.in_slopes, np.float64).reshape(-1))
        same = np.array_equal(arriving, self.slopes)
        object.__setattr__(self, "in_slopes", self.slopes if same else arriving)
        if not len(self.times) == len(self.values) == len(self.slopes) == len(self.in_slopes):
            raise Mismatch("times, values and slopes of a curve differ in length")
        if not (np.diff(self.times) > 0).all():
            raise Mismatch("the key times of a curve must rise")

    def __repr__(self) -> str:
        span = f", {self.times[0]:g} to {self.times[-1]:g} s" if len(self.times) else ""
        return f"<HermiteCurve {len(self.times)} keys{span}{', broken tangents' if self.broken else ''}>"

    def __len__(self) -> int:
        """How many keys."""
        return len(self.times)

    @property
    def broken(self) -> bool:
        return self.in_slopes is not self.slopes

    def at(self, times: np.ndarray) -> np.ndarray:
        """Values at any times (seconds)."""
        return hermite.evaluate(self.times, self.values, self.slopes, times, self.in_slopes)


@dataclass(frozen=True, eq=False)
class KeyedMotion:
    """One Hermite curve a channel, in file order, over a skeleton.

    curves:     C curves (no keys at all where the source had no frames).
    frame_time: seconds a frame of the source; frames: how many the source had.
    report:     what the reduction that made it measured; None for keys that came otherwise.
    """

    skeleton: Skeleton
    curves: tuple[HermiteCurve, ...]
    frame_time: float
    frames: int
    history: History = ()
    report: Report | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "curves", tuple(self.curves))
        object.__setattr__(self, "frame_time", checked_frame_time(self.frame_time))
        if len(self.curves) != self.skeleton.channel_count:
            raise Mismatch(
                f"the skeleton has {self.skeleton.channel_count} channels, {len(self.curves)} curves are given"
            )

    def __repr__(self) -> str:
        told = f": {self.report.sentence()}" if self.report is not None else ""
        return f"<KeyedMotion {self.keys} keys for {self.frames} frames x {len(self.curves)} channels{told}>"

    @property
    def keys(self) -> int:
        """All keys of all channels."""
        return sum(len(curve) for curve in self.curves)

    @property
    def duration(self) -> float:
        """Seconds from the first frame of the source to its last."""
        return max(self.frames - 1, 0) * self.frame_time

    def sample(self, frame_time: float | None = None) -> Motion:
        """Samples at a frame time (seconds), by default the source's own."""
        step = self.frame_time if frame_time is None else checked_frame_time(frame_time)
        frames = self.frames if step == self.frame_time or self.frames < 2 else frame_count(self.duration, step)
        times = np.arange(frames) * step
        values = np.empty((frames, len(self.curves)), order="F")
        for channel, curve in enumerate(self.curves):
            values[:, channel] = curve.at(times)
        return Motion(self.skeleton, values, step, self.history)
