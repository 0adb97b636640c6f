"""The verb `limit`: joints kept within what they can do, by one smooth displacement for each violation (Sudarsky and House
1998, section 4.3; Bruderlin and Williams 1995 for limits as such)."""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from fnmatch import fnmatchcase
from typing import Any

import numpy as np

from ..errors import OptionError, UnknownName
from ..keyed import KeyedMotion
from ..motion import Clip, Motion
from ..skeleton import Skeleton, matching
from ..spline import SplineMotion
from . import _anatomy, _envelope, _key_limits
from ._extremes import extremes
from ._pair import complete, recorded, tell_sampled
from ._ranges import Eulers, Limit, OfChannel, parse

Limits = Mapping[str, tuple[float | None, float | None]] | Sequence[str] | str
PASSES = 8
BELIEVED = 0.25  # of the frames; a limit that a file says and whose own motion is beyond it more often fits neither
INSIDE = 1e-6  # degrees further than to a limit, where channels are computed from angles: files round


@dataclass(frozen=True)
class Limited:
    """What became of one angle of a joint, or one channel.

    low, high: its limits, degrees (file units for a position), None where open. runs: how many stretches of frames were
    beyond them. frames: how many frames changed. before, after: the largest violation. acceleration: the largest of the
    angle, degrees per second squared, where it was changed, before and after.
    """

    angle: str
    low: float | None
    high: float | None
    runs: int
    frames: int
    before: float
    after: float
    acceleration: tuple[float, float]

    @property
    def named(self) -> str:
        """The angle and its limits."""
        low, high = ("" if end is None else f"{end:g}" for end in (self.low, self.high))
        ends = f"{low} to {high}" if low and high else f"up to {high}" if high else f"{low} and more"
        return f"{self.angle} ({ends})"

    def __str__(self) -> str:
        ratio = self.acceleration[1] / self.acceleration[0] if self.acceleration[0] else np.inf
        many = f"{self.runs} run{'s' if self.runs > 1 else ''}, {self.frames} frames changed"
        return f"{self.named}: beyond by {self.before:.3g}, now {self.after:.2g}; {many}, acceleration x {ratio:.2f}"


def limit(clip: Clip, limits: Limits | None = None, *, only: str | Sequence[str] = (), support: float = 0.2) -> Clip:
    """The clip with its joints within their limits, bent smoothly wherever they are not.

    Parameters
    ----------
    limits
        {name: (low, high)} such as {"LeftArm.Zrotation": (-90, 45)}, None for a side that is open: of channels, or of the
        angles of joints that are recognised: LeftLeg.flexion, LeftUpLeg.swing, LeftUpLeg.twist. * stands for anything.
        By default what the file says (Acclaim), or else ranges of people, with a warning, for knees and elbows
        (flexion, 0 is straight) and for hips and shoulders (swing out of the middle of a cone, and twist).
    only
        Joints that are looked at, * stands for anything: *Leg.
    support
        How long before and after a run of violations the clip may change, seconds.

    At the worst frame of a run what is added is as large as the violation; elsewhere no smaller than there is need. It is
    smooth up to its acceleration, and frames outside of the support stay to the last digit. Afterwards no frame is
    beyond a limit by more than 1e-6 degrees. Keys and splines stay what they are where the limits are of channels, and
    keep them between frames too; else they become samples. The last step of the `history` tells of each angle its limits,
    runs, changed frames, largest violation and acceleration under "measured". Errors: OptionError for limits and where no
    joint is recognised, UnknownName.

    >>> able = mc.limit(walk)
    """
    if isinstance(support, bool) or not (isinstance(support, int | float) and 0 < support < np.inf):
        raise OptionError(f"support is a number of seconds above 0, not {support!r}")
    own = complete(clip.sample())
    asked = None if limits is None else parse(limits, "limit")
    found, source, lost = _limits(own, asked)
    found = _chosen(found, own.skeleton, only)
    made = _bounded(clip, own, found, support)
    rows = _measured(clip, own, made, found)
    if source == _anatomy.SOURCE and any(row.runs for row in rows):
        warnings.warn(f"the limits are {source}, not those of this body: limits (--limit) says others", stacklevel=2)
    step = {"verb": "limit", "limits": asked, "only": only if isinstance(only, str) else list(only), "support": support}
    told = {"source": source, **_summed(rows, own, made), "angles": [asdict(row) for row in rows], "not_limited": lost}
    return recorded(made, (*clip.history, {**step, "measured": told}))


# -- in call order ---------------------------------------------------------------------------------


def _limits(
    motion: Motion, asked: Mapping[str, tuple[float | None, float | None]] | None
) -> tuple[list[Limit], str, list[str]]:
    """What is to be held, where it comes from, and what was recognised but cannot be."""
    if asked is not None:
        return _given(motion, asked), "given", []
    if motion.skeleton.limits:
        return _believed(_of_file(motion), motion)
    found, lost = _anatomy.of_people(motion)
    if not found and motion.frames:
        why = f" ({lost[0]})" if lost else ""
        raise OptionError(
            f"no knee, elbow, hip or shoulder is recognised by its name{why}: say limits, --limit LeftArm.Zrotation=-90:45"
        )
    return found, _anatomy.SOURCE, lost


def _given(motion: Motion, asked: Mapping[str, tuple[float | None, float | None]]) -> list[Limit]:
    channels = motion.skeleton.channel_names
    angles: list[Limit] = []
    found: dict[str, Limit] = {}
    for name, (low, high) in asked.items():
        ends = np.array([-np.inf if low is None else low]), np.array([np.inf if high is None else high])
        fitting: dict[str, Limit] = {
            channel: OfChannel((channel,), column, *ends)
            for column, channel in enumerate(channels)
            if name == channel or fnmatchcase(channel, name)
        }
        if not fitting:
            angles = angles or [*_anatomy.of_people(motion)[0], *_of_file(motion)]
            fitting = {
                angle: _alone(kind, place, *ends)
                for kind in angles
                for place, angle in enumerate(kind.names)
                if name == angle or fnmatchcase(angle, name)
            }
        if not fitting:
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


def _believed(limits: list[Limit], motion: Motion) -> tuple[list[Limit], str, list[str]]:
    """Without the angles that are beyond a file's limit in much of its own motion: templates say more than bodies."""
    lost = []
    kept: list[Limit] = []
    for kind in limits:
        share = (
            (_beyond(kind, kind.angles(motion.values)) > 0).mean(axis=0) if motion.frames else np.zeros(len(kind.names))
        )
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
    return kept, "the file", lost


def _chosen(limits: list[Limit], skeleton: Skeleton, only: str | Sequence[str]) -> list[Limit]:
    names = [only] if isinstance(only, str) else list(only)
    if not names:
        return limits
    joints = {skeleton.names[j] for name in names for j in matching(name, skeleton.names, skeleton.names, "joint")}
    found = [kind for kind in limits if kind.names[0].rpartition(".")[0] in joints]
    if not found:
        raise OptionError(f"none of the joints that {', '.join(names)} names has limits here")
    return found


def _bounded(clip: Clip, own: Motion, limits: list[Limit], support: float) -> Clip:
    """The clip itself where nothing is beyond a limit."""
    if isinstance(clip, KeyedMotion | SplineMotion) and all(isinstance(kind, OfChannel) for kind in limits):
        ends = {
            kind.column: (float(kind.low[0]), float(kind.high[0])) for kind in limits if isinstance(kind, OfChannel)
        }
        made = _key_limits.bounded(clip, ends, support)
        if made is not None:
            return made
    half = max(1, int(0.5 * support / own.frame_time))
    values = np.array(own.values, order="F")
    for _ in range(PASSES):
        beyond = [kind for kind in limits if _beyond(kind, kind.angles(values)).any()]
        if not beyond:
            break
        for kind in beyond:
            before = kind.angles(values)
            inside = 0.0 if isinstance(kind, OfChannel) else INSIDE
            after = np.stack(
                [
                    _envelope.bounded(before[:, k], kind.low[k], kind.high[k], half, inside)
                    for k in range(before.shape[1])
                ],
                axis=1,
            )
            kind.put(values, before, after, np.flatnonzero((before != after).any(axis=1)))
    if not (values != own.values).any():
        return clip
    tell_sampled((clip,), "they are kept within limits frame by frame")
    return replace(own, values=values, report=None)


def _beyond(kind: Limit, angles: np.ndarray) -> np.ndarray:
    return np.stack([_envelope.over(angles[:, k], kind.low[k], kind.high[k]) for k in range(len(kind.names))], axis=1)


def _measured(clip: Clip, own: Motion, made: Clip, limits: list[Limit]) -> list[Limited]:
    after = made.sample()
    rows = []
    for kind in limits:
        was, now = kind.angles(own.values), kind.angles(after.values)
        left = _beyond(kind, was), np.maximum(np.maximum(now - kind.high, kind.low - now), 0.0)
        for k, name in enumerate(kind.names):
            low, high = float(kind.low[k]), float(kind.high[k])
            if low == -np.inf and high == np.inf:
                continue
            changed = np.abs(now[:, k] - was[:, k]) > 1e-9
            worst = [float(left[i][:, k].max(initial=0.0)) for i in (0, 1)]
            if isinstance(kind, OfChannel):
                worst = [max(w, _between(c, kind.column, low, high)) for w, c in zip(worst, (clip, made), strict=True)]
            rows.append(
                Limited(
                    name,
                    None if low == -np.inf else low,
                    None if high == np.inf else high,
                    _envelope.runs(left[0][:, k] > 0) or int(worst[0] > _envelope.LEAST),
                    int(changed.sum()),
                    *worst,
                    _accelerations(was[:, k], now[:, k], changed, own.frame_time),
                )
            )
    return rows


def _summed(rows: Sequence[Limited], own: Motion, made: Clip) -> dict[str, Any]:
    joints = {row.angle.rpartition(".")[0] for row in rows if row.runs}
    moved = np.abs(made.sample().values - own.values) > 1e-9
    return {
        "joints": len(joints),
        "runs": sum(row.runs for row in rows),
        "frames": int(moved.any(axis=1).sum()),
        "before": max((row.before for row in rows), default=0.0),
        "after": max((row.after for row in rows), default=0.0),
    }


def _between(clip: Clip, channel: int, low: float, high: float) -> float:
    """The largest violation of a channel's curve, also between frames; of samples 0."""
    curves = _key_limits.curves_of(clip) if isinstance(clip, KeyedMotion | SplineMotion) else None
    if curves is None or not len(curves[channel]):
        return 0.0
    values = extremes(curves[channel])[1]
    return float(np.maximum(np.maximum(values - high, low - values), 0.0).max())


def _accelerations(
    before: np.ndarray, after: np.ndarray, changed: np.ndarray, frame_time: float
) -> tuple[float, float]:
    """Largest accelerations around the frames that changed, before and after."""
    near = changed[:-2] | changed[1:-1] | changed[2:]
    found = [np.abs(np.diff(angle, 2))[near].max(initial=0.0) / frame_time**2 for angle in (before, after)]
    return float(found[0]), float(found[1])
