"""The verb `limit`: joints kept within what they can do, by one smooth displacement for each run of violations (a local
motion warp, as Sudarsky and House 1998 do it)."""

from __future__ import annotations

import warnings
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from ..errors import OptionError
from ..keyed import KeyedMotion
from ..motion import Clip, Motion, complete
from ..spline import SplineMotion
from . import _anatomy, _envelope, _key_limits
from ._extremes import extremes
from ._limits_of import beyond_of, sought
from ._pair import recorded, tell_sampled
from ._ranges import End, Limit, OfChannel, parse

Limits = Mapping[str, End] | Sequence[str] | str
PASSES = 8
SPIKE, BRIEF = 20.0, 0.05  # degrees and seconds: so far beyond for so short a time is no motion
CHANGED = 1e-9  # degrees or units
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
        {name: (low, high)} such as {"LeftArm.Zrotation": (-90, 45)}, None for a side that is open: of channels, or of
        angles of joints that are recognised, LeftLeg.flexion, LeftUpLeg.swing, LeftUpLeg.twist; * stands for anything.
        By default what the file says (Acclaim), or else ranges of people, with a warning, for knees and elbows
        (flexion, 0 is straight) and for hips and shoulders (swing out of the middle of a cone, and twist).
    only
        Joints that are looked at, * stands for anything: *Leg.
    support
        How long before and after a run of violations the clip may change, seconds; at least two frames.

    At the worst frame of a run what is added is as large as the violation; elsewhere no smaller than there is need. It
    is smooth up to its acceleration, and frames outside of the support stay to the last digit. Afterwards no frame is
    beyond a limit by more than 1e-6 degrees. A limit that the file says and that its own motion breaks in more than a
    quarter of the frames is not taken. Keys and splines stay what they are where the limits are of channels, and keep
    them between frames too; else they become samples. The last step of the `history` tells under "measured" the limits,
    runs, changed frames, largest violation and acceleration of each angle. Errors: OptionError for limits and where no
    joint is recognised, UnknownName.

    >>> able = mc.limit(walk)
    """
    if isinstance(support, bool) or not (isinstance(support, int | float) and 0 < support < np.inf):
        raise OptionError(f"support is a number of seconds above 0, not {support!r}")
    own = complete(clip.sample())
    asked = None if limits is None else parse(limits, "limit")
    found, source, lost = sought(own, asked, only)
    made = _bounded(clip, own, found, support)
    rows = _measured(clip, own, made, found)
    spike = next(_spikes(own, found), None)
    if spike is not None:
        warnings.warn(f"{spike}: a spike, which takes its neighbours along; denoise the clip first", stacklevel=2)
    left = [row.angle for row in rows if row.after > _envelope.LEAST]
    if left:
        warnings.warn(f"{', '.join(left[:3])}: still beyond its limits, which its channels cannot say", stacklevel=2)
    if source == _anatomy.SOURCE and any(row.runs for row in rows):
        warnings.warn(f"the limits are {source}, not those of this body: limits (--limit) says others", stacklevel=2)
    step = {"verb": "limit", "limits": asked, "only": only if isinstance(only, str) else list(only), "support": support}
    told = {"source": source, **_summed(rows, own, made), "angles": [asdict(row) for row in rows], "not_limited": lost}
    return recorded(made, (*clip.history, {**step, "measured": told}))


# -- in call order ---------------------------------------------------------------------------------


def _bounded(clip: Clip, own: Motion, limits: list[Limit], support: float) -> Clip:
    """The clip itself where nothing is beyond a limit."""
    if isinstance(clip, KeyedMotion | SplineMotion) and all(isinstance(kind, OfChannel) for kind in limits):
        ends = {
            kind.column: (float(kind.low[0]), float(kind.high[0])) for kind in limits if isinstance(kind, OfChannel)
        }
        made = _key_limits.bounded(clip, ends, support)
        if made is not None:
            return made
    half = max(1, int(min(0.5 * support / own.frame_time, own.frames)))
    values = np.array(own.values, order="F")
    for _ in range(PASSES):
        beyond = [kind for kind in limits if beyond_of(kind, kind.angles(values)).any()]
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


def _measured(clip: Clip, own: Motion, made: Clip, limits: list[Limit]) -> list[Limited]:
    after = made.sample()
    rows = []
    for kind in limits:
        was, now = kind.angles(own.values), kind.angles(after.values)
        beyond, left = beyond_of(kind, was), np.maximum(np.maximum(now - kind.high, kind.low - now), 0.0)
        for k, name in enumerate(kind.names):
            low, high = float(kind.low[k]), float(kind.high[k])
            if low == -np.inf and high == np.inf:
                continue
            changed = np.abs(now[:, k] - was[:, k]) > CHANGED
            before, rest = (float(away[:, k].max(initial=0.0)) for away in (beyond, left))
            if isinstance(kind, OfChannel):
                before = max(before, _between(clip, kind.column, low, high))
                rest = max(rest, _between(made, kind.column, low, high))
            row = Limited(
                angle=name,
                low=None if low == -np.inf else low,
                high=None if high == np.inf else high,
                runs=_envelope.runs(beyond[:, k] > 0) or int(before > _envelope.LEAST),
                frames=int(changed.sum()),
                before=before,
                after=rest,
                acceleration=_accelerations(was[:, k], now[:, k], changed, own.frame_time),
            )
            rows.append(row)
    return rows


def _spikes(own: Motion, limits: list[Limit]) -> Iterator[str]:
    """Where an angle is far beyond its limits for a moment, in words."""
    for kind in limits:
        beyond = beyond_of(kind, kind.angles(own.values))
        for name, angle in zip(kind.names, beyond.T, strict=True):
            edges = np.flatnonzero(np.diff(np.concatenate([[False], angle > 0, [False]])))
            for first, end in edges.reshape(-1, 2).tolist():
                inside = first > 0 and end < len(angle)
                most = angle[first:end].max()
                if inside and most > SPIKE and (end - first) * own.frame_time < BRIEF:
                    yield f"{name} is beyond its limits by {most:.3g} at {first * own.frame_time:.2f} s"


def _summed(rows: Sequence[Limited], own: Motion, made: Clip) -> dict[str, Any]:
    joints = {row.angle.rpartition(".")[0] for row in rows if row.runs}
    moved = np.abs(made.sample().values - own.values) > CHANGED
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
