"""A clip brought onto another's body, floor and frame rate, so that the two can follow one another."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from ..errors import OptionError
from ..feet.planted import planted
from ..motion import Clip, Motion, complete, frame_count
from ._bodies import size_of
from ._pair import at_times, onto
from ._seams import usual


class Pair(NamedTuple):
    """The first clip; the second on its body, which of its channels (C,) it had, and the factors and shifts (C,) that
    brought it there; what their fastest frames usually do; where feet rest in both, (J, F) and (J, G)."""

    a: Motion
    b: Motion
    had: np.ndarray
    factors: np.ndarray
    added: np.ndarray
    usual: tuple[float, float]
    resting: tuple[np.ndarray, np.ndarray]

    def both_rest(self, i: int, j: int, count: int) -> np.ndarray:
        """(J, n) of the frames from i and j on, as many of them as the first clip has."""
        count = min(count, self.a.frames - i)
        return self.resting[0][:, i : i + count] & self.resting[1][:, j : j + count]

    def holding(self, frame: int) -> Motion:
        """The second clip, joints that it does not have holding still as in a frame of the first."""
        return replace(self.b, values=np.where(self.had, self.b.values, self.a.values[frame]))


def at_rate(clip: Clip, frame_time: float) -> Motion:
    """The samples of a clip at another clip's frame time (seconds)."""
    if clip.frame_time == frame_time:
        return complete(clip.sample())
    return at_times(clip, np.arange(frame_count(clip.duration, frame_time)) * frame_time, frame_time)


def paired(a: Motion, b: Motion) -> Pair:
    """Both, the second on the body and the floor of the first, and what is known of them.

    Where bones have other lengths the way and the height of its roots are scaled as the legs are. OptionError for a
    clip without frames.
    """
    if not min(a.frames, b.frames):
        raise OptionError("a clip without frames cannot be joined")
    made, had = onto(replace(a, values=np.repeat(a.values[-1:], b.frames, axis=0)), b)
    factors, added = _fitting(a, b, made, had)
    made = replace(made, values=made.values * factors + added)
    return Pair(a, made, had, factors, added, usual(a, made), (planted(a), planted(made)))


def _fitting(a: Motion, b: Motion, made: Motion, had: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Factors and shifts (C,) that are to bring b, with the joints of a, onto its floor and into its strides."""
    skeleton = a.skeleton
    factors, added = np.ones(skeleton.channel_count), np.zeros(skeleton.channel_count)
    scale, higher = size_of(a, b, made)
    moves = ~skeleton.rotation_channels & (skeleton.parents[skeleton.channel_joints] < 0) & had
    factors[moves] = scale
    added[moves & (skeleton.channel_axes == 1)] = higher
    return factors, added
