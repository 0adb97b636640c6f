"""The verb `mix`: the weighted mean of several clips."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..errors import Mismatch, OptionError
from ..motion import Clip, Motion, frame_count
from ._means import mean_of_channels, mean_of_rotations
from ._pair import at_times, check, check_mode, onto, recorded, same_curves, tell_sampled
from ._weights import parse
from .blend import between_clips

MODES = ("rotations", "curves")


def mix(clips: Sequence[Clip], weights: Sequence[float], *, mode: str = "rotations", match: str = "exact") -> Clip:
    """The mean of several clips, each with its weight; the weights are divided by their sum.

    Parameters
    ----------
    weights
        A number for each clip, as in 0.2,0.3,0.5.
    mode
        rotations: the mean of rotations, where the weighted rotation vectors to all of them cancel; keys and splines
        become samples. curves: channel by channel, keys stay keys and splines stay splines.
    match
        exact: all have the same joints and channels. names: joints are found by name, others stay as in the first.

    Clips of different length are stretched onto one another; the result lasts as long as their weighted mean says. Body
    and frame time are the first's. Errors: Mismatch naming the first difference of the skeletons, OptionError for the
    weights.

    >>> three = mc.mix([walk, run, limp], [1, 1, 2])
    """
    clips = list(clips)
    check_mode(mode, MODES)
    shares = _shares(clips, weights)
    for other in clips[1:]:
        check(clips[0].skeleton, other.skeleton, match)
    if not min(clip.frames for clip in clips):
        raise Mismatch("mix needs clips with frames, not a clip with none")
    step = {"verb": "mix", "weights": shares.tolist(), "mode": mode, "match": match}
    history = (*clips[0].history, {**step, "with": [list(clip.history) for clip in clips[1:]]})
    if mode == "curves" and same_curves(clips):
        made = _of_curves(clips, shares)
    else:
        same = "all clips must be keys, or all splines, with the same channels"
        tell_sampled(clips, same if mode == "curves" else "joints turn frame by frame (mode curves keeps keys)")
        made = _of_samples(clips, shares, mode)
    return recorded(made, history)


# -- in call order ---------------------------------------------------------------------------------


def _shares(clips: Sequence[Clip], weights: Sequence[float]) -> np.ndarray:
    try:
        given = np.array(weights, np.float64).reshape(-1)
    except (TypeError, ValueError):
        raise OptionError(f"weights are numbers, one for each clip, not {weights!r}") from None
    if len(given) != len(clips) or not len(clips):
        raise OptionError(f"{len(given)} weights are given for {len(clips)} clips")
    if not (np.isfinite(given).all() and (given >= 0).all() and given.sum() > 0):
        raise OptionError(f"weights are numbers from 0 up, not all of them 0; not {given.tolist()}")
    return given / given.sum()


def _of_curves(clips: Sequence[Clip], shares: np.ndarray) -> Clip:
    """Two at a time: what is linear does not mind."""
    made, so_far = clips[0], shares[0]
    for clip, share in zip(clips[1:], shares[1:], strict=True):
        so_far += share
        if share > 0:
            made = between_clips(made, clip, parse(share / so_far), "curves")
    return made


def _of_samples(clips: Sequence[Clip], shares: np.ndarray, mode: str) -> Motion:
    step = clips[0].frame_time
    length = float(shares @ [clip.duration for clip in clips])
    times = np.arange(frame_count(length, step)) * step
    along = times / length if length > 0 else times
    first = at_times(clips[0], along * clips[0].duration, step)
    others = [onto(first, at_times(clip, along * clip.duration, step))[0] for clip in clips[1:]]
    mean = mean_of_rotations if mode == "rotations" else mean_of_channels
    return mean([first, *others], shares)
