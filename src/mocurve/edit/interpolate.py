"""The verb `interpolate`: between motions of one kind, in step.

Sources: Bruderlin and Williams 1995, Motion signal processing (multitarget); Rose, Cohen and Bodenheimer 1998, Verbs
and adverbs (places); Unuma, Anjyo and Takeuchi 1995, Fourier principles for emotion-based human figure animation.
"""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from ..contacts import planted
from ..errors import Mismatch, OptionError, UnknownName
from ..info import first_frame_is_t_pose
from ..kinematics import world
from ..motion import Clip, Motion
from ..skeleton import Skeleton
from . import _fourier, _in_step
from ._bodies import main_root, rooted
from ._means import heaviest_of
from ._pair import check, complete, tell_sampled
from ._seams import bends, centimetres
from ._shares import Places, Shares, Weights, shares_of
from .register import Registration

USUAL = 99.5  # percent of a clip's frames that are below what is counted as its fastest
UNLIKE = 0.6  # of the mean distance of any two moments: matched poses that are further apart do not belong together
METHODS = ("multitarget", "fourier")
MOST = 10_000  # cycles
HARMONICS = range(1, 65)


@dataclass(frozen=True)
class Interpolation:
    """What was made of how much of which clip.

    unit:         of lengths: "cm", or "units" of the file where nobody knows how long these are.
    clips:        of each: `share` (mean over time) and `duration`; with multitarget `slowest` and `fastest` (seconds of
                  the reference per second of its own), `distance` of matched poses and `even_distance` of those of a
                  clip that is only stretched, all four absent for the reference; with fourier `start` and `period` of
                  its cycle, `residual` (how far apart the ends were, as a part of the largest distance within) and
                  `error` (distance of the joints from the series, root mean square). `foot_speed`: mean, a second, in
                  the clip itself, of the feet that rest in all clips.
    reference:    the clip, counted from 0, that the others were registered with; None with fourier.
    duration:     seconds of the result, and its `frames`. period: of a cycle, None with multitarget.
    foot_speed:   mean speed, a second, of feet where all clips rest them; None where they never do.
    acceleration: the largest of a joint, as a part of what 99.5 % of the frames of the fastest clip stay below.
    """

    unit: str
    clips: list[dict[str, float | None]]
    reference: int | None
    duration: float
    period: float | None
    frames: int
    foot_speed: float | None
    acceleration: float

    def __str__(self) -> str:
        lines = [f"{self.duration:.3f} s" + ("" if self.period is None else f", {self.period:.3f} s a cycle")]
        for place, clip in enumerate(self.clips):
            lines.append(f"clip {place + 1}: {clip['share']:.3g} of {clip['duration']:.3f} s{self._how(clip)}")
        feet = "" if self.foot_speed is None else f", feet that rest in all go {self.foot_speed:.3g} {self.unit}/s"
        lines.append(f"largest acceleration {self.acceleration:.2f} of the clips' own{feet}")
        return "\n".join(lines)

    def _how(self, clip: dict[str, float | None]) -> str:
        if "distance" in clip:
            even = f"{clip['even_distance']:.3g} if only stretched"
            return f", matched poses {clip['distance']:.3g} {self.unit} apart, {even}"
        if "residual" in clip:
            cycle = f"a cycle of {clip['period']:.3f} s from {clip['start']:.3f} s on"
            return f", {cycle}, its series {clip['error']:.2g} {self.unit} off"
        return ", the others in step with it"

    def to_json(self) -> dict[str, Any]:
        """The same as plain numbers, texts and lists."""
        return asdict(self)


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
    return made, _measured(made, motions, times, share, told, front=int(front), reference=family.reference)


def _cyclic(motions: list[Motion], shares: Shares, cycles: int, harmonics: int) -> tuple[Motion, Interpolation]:
    """One cycle, or more."""
    first = motions[0]
    found = _fourier.cycles_of(motions, harmonics)
    each = shares.at(np.zeros(1), first.skeleton)[:, 0]
    made, period, times = _fourier.between_cycles(found, each, cycles, first.frame_time)
    told: list[dict[str, float | None]] = [
        {"start": one.start, "period": one.period, "residual": one.residual, "error": one.error * _length(motion)[1]}
        for one, motion in zip(found, motions, strict=True)
    ]
    share = each[:, main_root(first)]
    return made, _measured(made, motions, times, share, told, period=period)


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


def _measured(
    made: Motion,
    motions: list[Motion],
    times: np.ndarray,
    shares: np.ndarray,
    told: list[dict[str, float | None]],
    *,
    front: int = 0,
    **more: Any,
) -> Interpolation:
    """The numbers of a result whose frames are at these seconds (N, F) of every clip."""
    unit, length = _length(made)
    frames = [
        np.clip(np.rint(time / motion.frame_time).astype(np.int64), 0, motion.frames - 1)
        for time, motion in zip(times, motions, strict=True)
    ]
    rest = np.ones((len(made.skeleton.names), made.frames), bool)
    for motion, at, share in zip(motions, frames, shares, strict=True):
        if share != 0:
            rest &= _of_joints(planted(motion)[:, at], motion, made)
    clips, usual = [], 0.0
    for motion, at, share, found in zip(motions, frames, shares, told, strict=True):
        speed = _of_joints(_speeds(motion)[:, at], motion, made)
        own = length * float(speed[rest].mean()) if rest.any() else None
        clips.append({"share": float(share), "duration": motion.duration, **found, "foot_speed": own})
        bare = motion[int(first_frame_is_t_pose(motion)) :]
        if bare.frames > 2:
            usual = max(usual, float(np.percentile(bends(world(bare)), USUAL)) / motion.frame_time**2)
    largest = float(bends(world(made[front:])).max(initial=0.0)) / made.frame_time**2
    return Interpolation(
        unit=unit,
        clips=clips,
        duration=made.duration,
        frames=made.frames,
        foot_speed=length * float(_speeds(made)[rest].mean()) if rest.any() else None,
        acceleration=largest / usual if usual > 0 else 0.0,
        **{"reference": None, "period": None, **more},
    )


def _length(motion: Motion) -> tuple[str, float]:
    length = centimetres(motion)
    return ("cm", length) if length else ("units", 1.0)


def _speeds(motion: Motion) -> np.ndarray:
    """(J, F) file units a second."""
    if motion.frames < 2:
        return np.zeros((len(motion.skeleton.names), motion.frames))
    return np.linalg.norm(np.gradient(world(motion), axis=0), axis=-1).T / motion.frame_time


def _of_joints(values: np.ndarray, motion: Motion, first: Motion) -> np.ndarray:
    """Rows (J, F) of a motion for the joints of the first, by name; zeros for those that it does not have."""
    places = {name: place for place, name in enumerate(motion.skeleton.names)}
    found = [places.get(name, -1) for name in first.skeleton.names]
    return np.vstack([values, np.zeros_like(values[:1])])[found]
