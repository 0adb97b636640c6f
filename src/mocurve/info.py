"""What a clip holds and what is odd about it: the things that files do not say, and that tools trip over later."""

from __future__ import annotations

import warnings
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass, replace
from os import PathLike, fspath
from typing import Any

import numpy as np

from .errors import OptionError
from .kinematics import rest_height, rest_offsets, world
from .motion import History, Motion, unroll

PERSON_METRES = 1.7
CMU_METRES = 0.0254 / 0.45  # the length unit of the CMU motion capture database, mocap.cs.cmu.edu/faqs.php
UNITS = {"mm": 0.001, "cm": 0.01, "inch": 0.0254, "m": 1.0, "CMU unit of 5.6444 cm": CMU_METRES}
BIG_JUMP_DEGREES = 90.0
SEEN = 8  # frames, to see which way is up


@dataclass(frozen=True)
class Unit:
    """The length unit of a clip: metres it stands for, its name, and whether somebody said so or it is a guess."""

    metres: float
    name: str
    said: bool


@dataclass(frozen=True)
class Info:
    """What `inspect` found; str() is a page of it.

    path: as given to `inspect`. rotation_orders: "ZYX" -> how many joints turn so. duration: seconds from first to
    last frame. rest_height: file units. unit: None where nobody said it and there is no height to guess it from.
    oddities: a line each. history: the steps that made it.
    """

    path: str | None
    joints: int
    end_sites: int
    channels: int
    rotation_orders: dict[str, int]
    frames: int
    fps: float
    duration: float
    rest_height: float
    unit: Unit | None
    oddities: tuple[str, ...]
    history: History = ()

    def __str__(self) -> str:
        orders = ", ".join(f"{order or 'none'} x {count}" for order, count in self.rotation_orders.items())
        lines = [
            f"{_count(self.joints, 'joint')}, {_count(self.end_sites, 'end site')}, {_count(self.channels, 'channel')}",
            f"rotation orders: {orders or 'none'}",
            f"{_count(self.frames, 'frame')} at {self.fps:.6g} fps, {self.duration:.2f} s",
            self._size(),
            *(f"odd: {text}" for text in self.oddities),
            *([f"made by: {', '.join(self._steps())}"] if self._steps() else []),
        ]
        return "\n".join(lines if self.path is None else [self.path, *("  " + line for line in lines)])

    def _steps(self) -> list[str]:
        """The verbs of the history; none where nothing was done since it was read."""
        verbs = [str(step.get("verb", "?")) for step in self.history]
        if verbs == ["read"]:
            return []
        return [
            f"{verb} {step['file']}" if "file" in step else verb for verb, step in zip(verbs, self.history, strict=True)
        ]

    def _size(self) -> str:
        height = f"{self.rest_height:.4g} units tall at rest"
        if self.unit is None:
            return f"{height}: no length unit can be guessed"
        how = "as said" if self.unit.said else "guessed from this height; the option unit says it"
        return f"{height}: {self.rest_height * self.unit.metres:.2f} m, the unit being the {self.unit.name} ({how})"

    def to_json(self) -> dict[str, Any]:
        """The same as plain numbers, texts and lists."""
        return {**asdict(self), "oddities": list(self.oddities), "history": list(self.history)}


def inspect(motion: Motion, path: str | PathLike[str] | None = None) -> Info:
    """Count what a motion holds and look for what is odd. `path` is only repeated in the answer.

    print(inspect(mocurve.read("walk.bvh"), "walk.bvh"))
    """
    skeleton = motion.skeleton
    ends = int(skeleton.end_sites.sum())
    orders = Counter(
        "".join(kind[0] for kind in kinds if kind.endswith("rotation"))
        for kinds, end in zip(skeleton.channels, skeleton.end_sites, strict=True)
        if not end
    )
    height = rest_height(motion)
    return Info(
        path=None if path is None else fspath(path),
        joints=len(skeleton.names) - ends,
        end_sites=ends,
        channels=skeleton.channel_count,
        rotation_orders=dict(orders.most_common()),
        frames=motion.frames,
        fps=1.0 / motion.frame_time,
        duration=motion.duration,
        rest_height=height,
        unit=unit_of(motion) if height > 0 or skeleton.unit is not None else None,
        oddities=(*_odd_skeleton(motion), *_odd_frames(motion), *_odd_curves(motion)),
        history=motion.history,
    )


def unit_of(motion: Motion) -> Unit:
    """The length unit that the skeleton says, or else a guess: the one that makes the rest height nearest to 1.7 m.

    Guessed among mm, cm, inch, m and the unit of the CMU database; nearest by ratio. OptionError where nobody said
    and there is no height.
    """
    said = motion.skeleton.unit
    if said is not None:
        names = [name for name, metres in UNITS.items() if np.isclose(metres, said, rtol=1e-4)]
        return Unit(said, names[0] if names else f"{said:g} m", True)
    height = rest_height(motion)
    if not height > 0:
        raise OptionError("the rest pose has no height to guess the length unit from: say it with the option unit")
    name = min(UNITS, key=lambda name: abs(np.log(height * UNITS[name] / PERSON_METRES)))
    return Unit(UNITS[name], name, False)


def z_is_up(places: np.ndarray) -> bool:
    """Whether bodies (F, J, 3) are clearly taller along Z than along Y, on the average over the frames; some joints in
    ten may be elsewhere, as a root is that stays where the body began."""
    tall = np.diff(np.percentile(places, [10, 90], axis=1), axis=0)[0].mean(axis=0)
    return bool(tall[2] > 1.2 * tall[1])


def tell_up(motion: Motion, what: str, stacklevel: int = 3) -> None:
    """A warning where a body seems to stand along z. what: is on the ground, where y has to be up."""
    frames = np.unique(np.linspace(0, max(motion.frames - 1, 0), SEEN).astype(int))
    if motion.frames and z_is_up(world(replace(motion, values=motion.values[frames], report=None))):
        told = f"the body seems to stand along z: {what} on the ground x, z, with y up; if z is up here, axes turns it"
        warnings.warn(told, stacklevel=stacklevel)


def first_frame_is_t_pose(motion: Motion) -> bool:
    """Whether frame 0 is a rest pose put before the motion, as conversions of CMU clips do.

    It is where the step from frame 0 to 1 is more than 5 times the median step, and frame 0 is less than half as far
    from no rotation as any other frame (root mean squares over the rotation channels, whole turns not counted).
    """
    if motion.frames < 4:
        return False
    angles = motion.values[:, motion.skeleton.rotation_channels]
    away, steps = _mean_turn(angles), _mean_turn(np.diff(angles, axis=0))
    return bool(steps[0] > 5.0 * np.median(steps) and away[0] < 0.5 * away[1:].min())


def _mean_turn(degrees: np.ndarray) -> np.ndarray:
    """Root mean square (F,) over the columns, without whole turns."""
    turns = degrees - 360.0 * np.rint(degrees / 360.0)
    return np.sqrt(np.einsum("fc,fc->f", turns, turns) / max(degrees.shape[1], 1))


def _odd_skeleton(motion: Motion) -> Iterable[str]:
    skeleton = motion.skeleton
    roots = [name for name, parent in zip(skeleton.names, skeleton.parents, strict=True) if parent < 0]
    if len(roots) != 1:
        yield f"{len(roots)} roots{_names(roots)}"
    twice = [name for name, count in Counter(skeleton.names).items() if count > 1]
    if twice:
        yield f"{_count(len(twice), 'name')} given to several joints{_names(twice)}"
    short = (np.abs(rest_offsets(motion)).max(axis=1) == 0) & (skeleton.parents >= 0)
    if short.any():
        yield f"{_count(short.sum(), 'bone')} of length zero{_names(_chosen(skeleton.names, short))}"
    stiff = [n for n, k in zip(skeleton.names, skeleton.channels, strict=True) if 0 < sum(map(_rotates, k)) < 3]
    if stiff:
        yield f"{_count(len(stiff), 'joint')} with only one or two rotation channels{_names(stiff)}"
    early = [n for n, k in zip(skeleton.names, skeleton.channels, strict=True) if list(k) != sorted(k, key=_rotates)]
    if early:
        yield f"{_count(len(early), 'joint')} with a rotation channel before a position channel{_names(early)}"


def _odd_frames(motion: Motion) -> Iterable[str]:
    fps = 1.0 / motion.frame_time
    if motion.frames < 2:
        yield "no frames" if motion.frames == 0 else "a single frame: a pose, not a motion"
    ntsc = abs(fps * 1.001 - round(fps * 1.001)) < 1e-3
    if not 10 <= fps <= 500 or not (ntsc or abs(fps - round(fps)) < 1e-3):
        yield f"{fps:.6g} frames a second is an unusual rate"
    missing = np.isnan(motion.values)
    if missing.any():
        where = _chosen(motion.skeleton.channel_names, missing.any(axis=0))
        gaps = f"{_count(len(where), 'channel')}{_names(where)}"
        yield f"{_count(missing.sum(), 'sample')} missing in {gaps}: denoise fills them"
    if first_frame_is_t_pose(motion):
        yield "frame 0 is a T-pose, not part of the motion"


def _odd_curves(motion: Motion) -> Iterable[str]:
    skeleton = motion.skeleton
    names = skeleton.channel_names
    if motion.frames < 2:
        return
    still = np.ptp(motion.values, axis=0) == 0
    if still.any():
        yield f"{still.sum()} of {_count(len(names), 'channel')} never change"
    below = ~skeleton.rotation_channels & (skeleton.parents[skeleton.channel_joints] >= 0) & ~still
    if below.any():
        yield f"bones change their length in {_count(below.sum(), 'channel')}{_names(_chosen(names, below))}"
    turning = skeleton.rotation_channels
    smooth = unroll(motion).values
    broken = turning & (np.abs(np.diff(motion.values, axis=0)) > 180).any(axis=0)
    if broken.any():
        where = _count(broken.sum(), "channel") + _names(_chosen(names, broken))
        yield f"jumps of more than 180 degrees in {where}: unroll mends that"
    exchanged = turning & (np.abs(np.remainder(smooth - motion.values + 180.0, 360.0) - 180.0) > 1e-6).any(axis=0)
    if exchanged.any():
        joints = _chosen(skeleton.names, np.bincount(skeleton.channel_joints[exchanged]) > 0)
        yield f"gimbal lock passed by {_count(len(joints), 'joint')}{_names(joints)}: unroll mends that"
    jumps = np.abs(np.diff(smooth, axis=0)) * turning
    if first_frame_is_t_pose(motion):
        jumps[0] = 0.0
    if (jumps > BIG_JUMP_DEGREES).any():
        frame, channel = (int(place) for place in np.unravel_index(np.argmax(jumps), jumps.shape))
        frames = _count((jumps > BIG_JUMP_DEGREES).any(axis=1).sum(), "frame")
        worst = f"{jumps[frame, channel]:.0f} in {names[channel]} at frame {frame + 1}"
        yield f"jumps of more than {BIG_JUMP_DEGREES:g} degrees that stay at {frames}, the worst {worst}"


def _rotates(kind: str) -> bool:
    return kind.endswith("rotation")


def _chosen(names: Sequence[str], chosen: np.ndarray) -> list[str]:
    return [name for name, wanted in zip(names, chosen, strict=False) if wanted]


def _names(names: Sequence[str]) -> str:
    more = f" and {len(names) - 3} more" if len(names) > 3 else ""
    return f" ({', '.join(names[:3])}{more})" if names else ""


def _count(count: int, noun: str) -> str:
    return f"{count} {noun}{'' if count == 1 else 's'}"
