"""Motion: samples of every channel at every frame."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from . import rotation
from .errors import Mismatch, OptionError
from .skeleton import Skeleton, frozen

if TYPE_CHECKING:
    from .measure import Report

History = tuple[dict[str, Any], ...]
MAX_FRAMES = 100_000_000  # of any clip: eleven days at 100 frames a second


class Clip(Protocol):
    """What every verb accepts: anything that can say its samples."""

    @property
    def skeleton(self) -> Skeleton: ...
    @property
    def frame_time(self) -> float: ...
    @property
    def frames(self) -> int: ...
    @property
    def duration(self) -> float: ...
    @property
    def history(self) -> History: ...
    def sample(self, frame_time: float | None = None) -> Motion: ...


def checked_frame_time(frame_time: float) -> float:
    """The frame time in seconds, or OptionError where it is no positive number."""
    if not (np.isfinite(frame_time) and frame_time > 0):
        raise OptionError(f"a frame time is a positive number of seconds, not {frame_time!r}")
    return float(frame_time)


def trimmed(start: float, end: float) -> dict[str, Any]:
    """The step of a history that says which piece was kept (seconds)."""
    return {"verb": "trim", "start": start, "end": end}


def frame_count(duration: float, frame_time: float) -> int:
    """How many frames at this frame time lie within the duration (seconds), both ends included; OptionError where they
    are more than any clip has."""
    if not duration / frame_time < MAX_FRAMES:
        raise OptionError(f"{duration:g} s in frames of {frame_time:g} s are more than {MAX_FRAMES:,} frames")
    return int(np.floor(duration / frame_time + 1e-6)) + 1


@dataclass(frozen=True, eq=False)
class Motion:
    """Frames x channels over a skeleton: exactly the file's numbers.

    values:     (F, C) degrees and file length units, channels in file order; read-only, stored channel after channel.
    frame_time: seconds from one frame to the next.
    history:    the steps that made it, as a recipe can run them again.
    report:     what the denoising that made it measured; None for samples that came otherwise.
    """

    skeleton: Skeleton
    values: np.ndarray
    frame_time: float
    history: History = ()
    report: Report | None = None

    def __post_init__(self) -> None:
        values = np.asfortranarray(self.values, np.float64)
        if values.ndim != 2 or values.shape[1] != self.skeleton.channel_count:
            raise Mismatch(
                f"the skeleton has {self.skeleton.channel_count} channels, the values have shape {values.shape}"
            )
        object.__setattr__(self, "frame_time", checked_frame_time(self.frame_time))
        object.__setattr__(self, "values", frozen(values))

    def __repr__(self) -> str:
        joints = len(self.skeleton.names) - int(self.skeleton.end_sites.sum())
        size = f"{self.frames} frames, {self.duration:.2f} s, {joints} joints, {self.skeleton.channel_count} channels"
        return f"<Motion {size}>"

    def __getitem__(self, span: slice) -> Motion:
        """Some of the frames: motion[100:200] keeps frames 100 to 199."""
        if not isinstance(span, slice) or span.step not in (None, 1):
            raise OptionError("frames are cut with a plain slice, motion[first:last]")
        first, last, _ = span.indices(self.frames)
        kept = self.values[span].copy(order="F")
        history = self.history
        if 0 < len(kept) < self.frames:
            history = (*history, trimmed(first * self.frame_time, (last - 1) * self.frame_time))
        return replace(self, values=kept, history=history, report=None)

    @property
    def frames(self) -> int:
        return len(self.values)

    @property
    def duration(self) -> float:
        """Seconds from the first frame to the last."""
        return max(self.frames - 1, 0) * self.frame_time

    def sample(self, frame_time: float | None = None) -> Motion:
        """The motion at another frame time (seconds), straight lines between the frames of the unrolled channels."""
        if frame_time is None or frame_time == self.frame_time or self.frames < 2:
            return self if frame_time is None else replace(self, frame_time=frame_time)
        step = checked_frame_time(frame_time)
        times = np.arange(frame_count(self.duration, step)) * step
        mine = np.arange(self.frames) * self.frame_time
        smooth = unroll(self).values
        values = np.empty((len(times), smooth.shape[1]), order="F")
        for channel in range(smooth.shape[1]):
            values[:, channel] = np.interp(times, mine, smooth[:, channel])
        return replace(self, values=values, frame_time=step, report=None)


def complete(motion: Motion) -> Motion:
    """The motion; Mismatch where a sample is missing."""
    bad = ~np.isfinite(motion.values)
    if bad.any():
        frame, channel = (int(place) for place in np.argwhere(bad)[0])
        name = motion.skeleton.channel_names[channel]
        raise Mismatch(f"channel {name!r} has no value at frame {frame}: fill the gaps first, with denoise")
    return motion


def unroll(motion: Motion, *, triples: bool = True) -> Motion:
    """The same rotations, written so that no channel jumps: the rotation fix of Önder 2007, appendix B.1.

    Whole turns are taken out of every rotation channel. triples: where a joint has three rotations about three axes,
    take also the other Euler triple of the same rotation, (a+180, 180-b, c+180), where it is nearer to the frame before
    and the rotation itself does not leap.
    """
    if motion.frames < 2:
        return motion
    values = np.array(motion.values, order="F")
    if not triples:
        rotates = motion.skeleton.rotation_channels
        values[:, rotates] = np.unwrap(values[:, rotates], period=360.0, axis=0)
        return replace(motion, values=values)
    for columns, order in motion.skeleton.eulers:
        values[:, columns] = rotation.unroll_euler(values[:, columns], order)
    return replace(motion, values=values)
