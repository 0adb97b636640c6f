"""The verb `interpolate`: between motions of one kind, in step.

Sources: Bruderlin and Williams 1995, Motion signal processing (multitarget); Rose, Cohen and Bodenheimer 1998, Verbs
and adverbs (places); Unuma, Anjyo and Takeuchi 1995, Fourier principles for emotion-based human figure animation.
"""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ..errors import Mismatch, OptionError, UnknownName
from ..info import first_frame_is_t_pose
from ..motion import Clip, Motion, complete
from ..skeleton import Skeleton
from . import _fourier, _in_step
from ._bodies import main_root, rooted
from ._interpolated import Interpolation, length_of, measured
from ._means import heaviest_of
from ._pair import check, tell_sampled
from ._shares import Places, Shares, Weights, shares_of
from .register import Registration

UNLIKE = 0.6  # of the mean distance of any two moments: matched poses that are further apart do not belong together
METHODS = ("multitarget", "fourier")
MOST = 10_000  # cycles
HARMONICS = range(1, 65)


def interpolate(
    clips: Sequence[Clip],
    weights: Weights | None = None,
    places: Places | None = None,
    at: Weights | None = None,
    *,
    method: str = "multitarget",
    cycles: int = 1,
    harmonics: int = 12,
    match: str = "exact",
) -> Motion:
    """Between several motions of one kind: brought in step, then the mean of poses, of timing and of the way they go.

    Parameters
    ----------
    weights
        How much of each clip: 0.3,0.7, or for each a number, or numbers at times (seconds of the first clip) as in
        0:1,2:0, with NAME= before it for some joints. They are divided by their sum; below 0 is away from a clip. By
        default all the same.
    places
        Instead of weights: where each clip stands among adverbs (speed, mood ...), a number for each as in 0,1,2, or
        with more adverbs 0,0 1,0 0,1.
    at
        Where the result stands among the places: a number for each adverb, which may change in time as weights do.
    method
        multitarget: from the first frame to the last, every clip registered with the one of middle length. fourier: one
        cycle of each, as a Fourier series, repeated.
    cycles
        With fourier, how many.
    harmonics
        With fourier, how many waves a cycle is made of, 1 to 64.
    match
        exact: all have the same joints and channels. names: joints are found by name, roots whatever they are called,
        others move as in the first.

    Body and frame time are the first's. The result begins where the heaviest clip begins, and a clip that has all the
    weight comes back to the last digit (with fourier: as its series). Other joints' weights change only these joints;
    timing and way follow the root. The last step of its `history` has the numbers of `Interpolation` under "measured".
    Errors: Mismatch naming the first difference of the skeletons, OptionError for weights, places and clips that do not
    go together or are not cyclic. A warning where registered clips still differ much.

    >>> jog = mc.interpolate([walk, run], [0.5, 0.5], method="fourier", cycles=4)
    """
    clips = list(clips)
    shares = _checked(clips, weights, method, places, at, cycles, harmonics)
    for other in clips[1:]:
        check(clips[0].skeleton, other.skeleton, match)
    tell_sampled(clips, "motions are interpolated frame by frame")
    motions = [complete(clip.sample()) for clip in clips]
    if match == "names":
        motions = [rooted(motions[0], motion) for motion in motions]
    made, found = _cyclic(motions, shares, cycles, harmonics) if method == "fourier" else _once(motions, shares)
    options = {"method": method, "cycles": cycles, "harmonics": harmonics, "match": match}
    step = {"verb": "interpolate", **shares.told(), **options, "measured": found.to_json()}
    history = (*clips[0].history, {**step, "with": [list(clip.history) for clip in clips[1:]]})
    return replace(made, history=history, report=None)


# -- in call order ---------------------------------------------------------------------------------


def _checked(
    clips: list[Clip],
    weights: Weights | None,
    method: str,
    places: Places | None,
    at: Weights | None,
    cycles: int,
    harmonics: int,
) -> Shares:
    if method not in METHODS:
        raise UnknownName("method", method, METHODS)
    if not clips:
        raise OptionError("no clip is given")
    if not min(clip.frames for clip in clips):
        raise Mismatch("interpolate needs clips with frames, not a clip with none")
    if isinstance(cycles, bool) or not (isinstance(cycles, int) and 1 <= cycles <= MOST):
        raise OptionError(f"cycles is a whole number from 1 to {MOST}, not {cycles!r}")
    if isinstance(harmonics, bool) or harmonics not in HARMONICS:
        raise OptionError(f"harmonics is a whole number from 1 to {HARMONICS[-1]}, not {harmonics!r}")
    if method != "fourier" and cycles != 1:
        raise OptionError("cycles are repeated with the method fourier; a multitarget result can be looped")
    shares = shares_of(len(clips), weights, places, at)
    if method == "fourier" and not shares.constant:
        raise OptionError("with fourier the weights do not change in time: a cycle is the same all along")
    return shares


def _all_of_one(shares: Shares, skeleton: Skeleton) -> int | None:
    """The clip that has all the weight, if one has, all the time."""
    if not shares.constant:
        return None
    each = shares.at(np.zeros(1), skeleton)
    whole = np.flatnonzero((each == 1).all(axis=(1, 2)))
    return int(whole[0]) if len(whole) else None


def _once(motions: list[Motion], shares: Shares) -> tuple[Motion, Interpolation]:
    """From the first frame to the last. T-poses in front are no part of the motion, and stay in front if all have
    one."""
    first = motions[0]
    lead = np.array([int(first_frame_is_t_pose(motion)) for motion in motions])
    whole = _all_of_one(shares, first.skeleton)
    front = bool(lead.all() if whole is None else lead[whole])
    if lead.any() and not front:
        place = int(np.argmax(lead))
        warnings.warn(f"the T-pose in front of clip {place + 1} is left out: not all clips have one", stacklevel=4)
    bare = [motion[skip:] for motion, skip in zip(motions, lead.tolist(), strict=True)]
    family = _in_step.registered(bare)
    _tell_unlike(family)
    when = _in_step.moments(family, shares, lead[0] * first.frame_time)
    times = when.times + (lead * [motion.frame_time for motion in motions])[:, None]
    if front:
        times = np.hstack([np.zeros((len(times), 1)), times])
    if whole is None:
        made = _in_step.in_step(family, when)
        if front:
            pose = _in_step.on_first(motions, times[:, :1])[heaviest_of(when.shares)]
            made = replace(made, values=np.vstack([pose.values, made.values]))
    else:
        made = _in_step.on_first(motions, times)[whole]
    told = [_registration(found) for found in family.found]
    share = when.shares[:, :, main_root(first)].mean(axis=1)
    return made, measured(made, motions, times, share, told, front=int(front), reference=family.reference)


def _cyclic(motions: list[Motion], shares: Shares, cycles: int, harmonics: int) -> tuple[Motion, Interpolation]:
    """One cycle, or more."""
    first = motions[0]
    found = _fourier.cycles_of(motions, harmonics)
    each = shares.at(np.zeros(1), first.skeleton)[:, 0]
    made, period, times = _fourier.between_cycles(found, each, cycles, first.frame_time)
    length = length_of(first)[1]
    told: list[dict[str, float | None]] = [
        {"start": one.start, "period": one.period, "residual": one.residual, "error": length * one.error}
        for one in found
    ]
    share = each[:, main_root(first)]
    return made, measured(made, motions, times, share, told, period=period)


def _registration(found: Registration | None) -> dict[str, float | None]:
    names = ("slowest", "fastest", "distance", "even_distance")
    return {} if found is None else {name: getattr(found, name) for name in names}


def _tell_unlike(family: _in_step.Family) -> None:
    """A warning where clips go through other poses, or through another number of cycles."""
    for place, found in enumerate(family.found):
        if found is not None and found.distance > UNLIKE * found.usual_distance:
            warnings.warn(
                f"clips {family.reference + 1} and {place + 1} do not go together: in step their poses still are "
                f"{found.distance:.3g} {found.unit} apart, any two of them {found.usual_distance:.3g}. Cut both so "
                "that they begin and end alike, or take the method fourier for gaits",
                stacklevel=5,
            )
