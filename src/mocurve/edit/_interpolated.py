"""The numbers of an interpolation: what was made of how much of which clip, whether feet slide or anything jerks."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from ..feet.planted import planted
from ..info import first_frame_is_t_pose
from ..kinematics import world
from ..motion import Motion
from ._seams import bends, centimetres

USUAL = 99.5  # percent of a clip's frames that are below what is counted as its fastest


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


def measured(
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
    unit, length = length_of(made)
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
        own = length_of(motion)[1] * float(speed[rest].mean()) if rest.any() else None
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


def length_of(motion: Motion) -> tuple[str, float]:
    """The unit that lengths are told in, and how many of it a file unit is."""
    length = centimetres(motion)
    return ("cm", length) if length else ("units", 1.0)


# -- in call order ---------------------------------------------------------------------------------


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
