"""Which limits hold: those that are given, those of the file, or those of people."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from fnmatch import fnmatchcase

import numpy as np

from ..errors import OptionError, UnknownName
from ..motion import Motion
from ..skeleton import Skeleton, matching
from . import _anatomy, _envelope
from ._ranges import End, Eulers, Limit, OfChannel

BELIEVED = 0.25  # of the frames; a limit that a file says and whose own motion is beyond it more often fits neither


def sought(
    motion: Motion, asked: Mapping[str, End] | None, only: str | Sequence[str]
) -> tuple[list[Limit], str, list[str]]:
    """What is to be held, where it comes from, and a line for each joint that was looked at and is not limited."""
    lost: list[str] = []
    if asked is not None:
        found, source = _given(motion, asked), "given"
    elif motion.skeleton.limits:
        (found, lost), source = _believed(_of_file(motion), motion), "the file"
    else:
        (found, lost), source = _anatomy.of_people(motion), _anatomy.SOURCE
        if not found and motion.frames:
            why = f" ({lost[0]})" if lost else ""
            raise OptionError(
                f"no knee, elbow, hip or shoulder is recognised by its name{why}: say limits, as in "
                "--limit LeftArm.Zrotation=-90:45"
            )
    return _chosen(found, motion.skeleton, only), source, lost


def beyond_of(kind: Limit, angles: np.ndarray) -> np.ndarray:
    """How far (F, n) angles are beyond their limits, 0 where they are not."""
    return np.stack([_envelope.over(angles[:, k], kind.low[k], kind.high[k]) for k in range(len(kind.names))], axis=1)


# -- in call order ---------------------------------------------------------------------------------


def _given(motion: Motion, asked: Mapping[str, End]) -> list[Limit]:
    channels = motion.skeleton.channel_names
    angles: list[Limit] = []
    lost: list[str] = []
    found: dict[str, Limit] = {}
    for name, (low, high) in asked.items():
        if name in channels:
            motion.skeleton.channel(name)  # refused where there are several
        ends = np.array([-np.inf if low is None else low]), np.array([np.inf if high is None else high])
        fitting: dict[str, Limit] = {
            channel: OfChannel((channel,), column, *ends)
            for column, channel in enumerate(channels)
            if name == channel or fnmatchcase(channel, name)
        }
        if not fitting:
            if not angles:
                angles, lost = _anatomy.of_people(motion)
                angles = [*angles, *_of_file(motion)]
            fitting = {
                angle: _alone(kind, place, *ends)
                for kind in angles
                for place, angle in enumerate(kind.names)
                if name == angle or fnmatchcase(angle, name)
            }
        if not fitting:
            why = [line for line in lost if line.startswith(f"{name.rpartition('.')[0]}: ")]
            if why:
                raise OptionError(f"{name} cannot be limited: {why[0]}")
            raise UnknownName("channel or angle", name, (*(a for kind in angles for a in kind.names), *channels))
        for angle, kind in fitting.items():
            if angle in found and name == angle:
                raise OptionError(f"two limits are given for {angle}")
            found[angle] = kind
    return list(found.values())


def _alone(kind: Limit, place: int, low: np.ndarray, high: np.ndarray) -> Limit:
    """The same kind of limit with only one of its angles bounded."""
    lows, highs = np.full(len(kind.names), -np.inf), np.full(len(kind.names), np.inf)
    lows[place], highs[place] = low[0], high[0]
    return replace(kind, low=lows, high=highs)  # type: ignore[type-var]  # every kind is a dataclass


def _of_file(motion: Motion) -> list[Limit]:
    """The limits that the skeleton carries; of channels, where its angles are those."""
    skeleton = motion.skeleton
    found: list[Limit] = []
    for bounds in skeleton.limits:
        columns, order = skeleton.eulers[bounds.joint]
        name = skeleton.names[bounds.joint]
        middle = 0.5 * (np.maximum(bounds.low, -180.0) + np.minimum(bounds.high, 180.0))
        plain = order == bounds.order and not bounds.axes[1:].any()
        if plain and (np.abs(motion.values[:, columns] - middle) <= 180.0).all():
            ends = zip(columns, bounds.low, bounds.high, strict=True)
            found += [OfChannel((skeleton.channel_names[c],), c, low[None], high[None]) for c, low, high in ends]
        elif order:
            names = tuple(f"{name}.r{axis.lower()}" for axis in bounds.order)
            found.append(Eulers(names, columns, order, bounds.low, bounds.high, bounds.axes, bounds.order))
    return found


def _believed(limits: list[Limit], motion: Motion) -> tuple[list[Limit], list[str]]:
    """Without the angles that are beyond a file's limit in much of its own motion: templates say more than bodies."""
    lost = []
    kept: list[Limit] = []
    for kind in limits:
        beyond = beyond_of(kind, kind.angles(motion.values)) > 0
        share = beyond.sum(axis=0) / max(motion.frames, 1)
        odd = share > BELIEVED
        ends = zip(kind.names, kind.low, kind.high, share, odd, strict=True)
        lost += [
            f"{name}: the file says {low:g} to {high:g}, and {100 * part:.0f} % of its frames are beyond"
            for name, low, high, part, is_odd in ends
            if is_odd
        ]
        if not odd.all():
            low, high = np.where(odd, -np.inf, kind.low), np.where(odd, np.inf, kind.high)
            kept.append(replace(kind, low=low, high=high))  # type: ignore[type-var]  # every kind is a dataclass
    return kept, lost


def _chosen(limits: list[Limit], skeleton: Skeleton, only: str | Sequence[str]) -> list[Limit]:
    names = [only] if isinstance(only, str) else list(only)
    if not names:
        return limits
    joints = {skeleton.names[j] for name in names for j in matching(name, skeleton.names, skeleton.names, "joint")}
    found = [kind for kind in limits if kind.names[0].rpartition(".")[0] in joints]
    if not found:
        raise OptionError(f"none of the joints that {', '.join(names)} names has limits here")
    return found
