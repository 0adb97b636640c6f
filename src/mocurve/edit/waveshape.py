"""The verb `waveshape`: values of channels put through a curve (Bruderlin and Williams 1995, motion waveshaping)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any, NamedTuple

import numpy as np

from .. import hermite
from ..errors import OptionError
from ..keyed import KeyedMotion
from ..motion import Clip, complete
from ..skeleton import Skeleton, matching
from ..spline import SplineMotion
from ._extremes import extremes
from ._pair import recorded, tell_sampled
from ._ranges import by_name
from ._ranges import parse as parse_ranges
from ._slopes import speeds
from ._time import pairs_of

Ranges = Mapping[str, tuple[float | None, float | None]] | Sequence[str] | str
Maps = Mapping[str, Sequence[tuple[float, float]]] | Sequence[str] | str
SOFT = 0.1  # of the range from one limit to the other


@dataclass(frozen=True)
class Shaped:
    """What became of a channel: the share of its frames that changed, its least and largest value before and after."""

    channel: str
    changed: float
    before: tuple[float, float]
    after: tuple[float, float]

    def __str__(self) -> str:
        was, now = (f"{low:.4g} to {high:.4g}" for low, high in (self.before, self.after))
        return f"{self.channel}: {was} -> {now}, {100 * self.changed:.3g} % of the frames changed"


class Soft(NamedTuple):
    """Identity from low + m to high - m, m being `margin`, and exponentially flatter towards low and high."""

    low: float
    high: float
    margin: float

    def at(self, values: np.ndarray) -> np.ndarray:
        top, bottom = self.high - self.margin, self.low + self.margin
        over, under = np.maximum(values - top, 0.0), np.maximum(bottom - values, 0.0)
        made = np.where(over > 0, self.high - self.margin * np.exp(-over / self.margin), values)
        return np.where(under > 0, self.low + self.margin * np.exp(-under / self.margin), made)


class Through(NamedTuple):
    """A rising cubic through pairs of an old and a new value, straight on beyond the first and the last."""

    old: np.ndarray
    new: np.ndarray

    def at(self, values: np.ndarray) -> np.ndarray:
        if (self.old == self.new).all():
            return values
        slopes = speeds(self.old, self.new)
        before, after = np.minimum(values - self.old[0], 0.0), np.maximum(values - self.old[-1], 0.0)
        return hermite.evaluate(self.old, self.new, slopes, values) + slopes[0] * before + slopes[-1] * after


def waveshape(clip: Clip, soft: Ranges = (), map: Maps = (), *, margin: float | None = None) -> Clip:
    """The clip with the values of channels put through a curve that rises and is smooth in its slope.

    Parameters
    ----------
    soft
        {channel: (low, high)} such as {"LeftArm.Zrotation": (-90, 45)}: values inside stay, those near and beyond a
        limit bend towards it and never reach it; None for a side without limit. * stands for anything.
    map
        {channel: [(old, new), ...]} such as {"LeftArm.Zrotation": [(-90, -60), (0, 0), (90, 60)]}: a rising curve
        through these pairs (Fritsch and Carlson 1980), straight on beyond them.
    margin
        How far from a soft limit values begin to bend, in the channel's degrees or units; by default a tenth of the
        range between the limits, or of the channel's own where one side is open.

    Values are those of the channel itself, whole turns included. Channels that are not named, and values that stay,
    come back to the last digit. Keys and splines whose values all stay are kept, others become samples. The last step
    of the `history` tells of each channel the share of its frames that changed and its range before and after. Errors:
    OptionError for ranges and pairs, UnknownName for a channel.

    >>> calm = mc.waveshape(walk, {"LeftForeArm.*": (-60, 60)})
    """
    own = complete(clip.sample())
    if margin is not None and (
        isinstance(margin, bool) or not (isinstance(margin, int | float) and 0 < margin < np.inf)
    ):
        raise OptionError(f"margin is a number above 0, not {margin!r}")
    ranges, maps = parse_ranges(soft, "soft limit"), _maps(map)
    curves = _curves(ranges, maps, own.skeleton, own.values, margin)
    values = np.array(own.values, order="F")
    for column, curve in curves.items():
        made = curve.at(values[:, column])
        values[:, column] = made
    stays = not (values != own.values).any() and _kept(clip, curves)
    if not stays:
        tell_sampled((clip,), "their values are shaped frame by frame")
    told = [_told(own.skeleton.channel_names[c], own.values[:, c], values[:, c]) for c in curves]
    step: dict[str, Any] = {"verb": "waveshape", "soft": ranges, "map": maps, "margin": margin}
    step["measured"] = [asdict(row) for row in told]
    return recorded(clip if stays else replace(own, values=values), (*clip.history, step))


# -- in call order ---------------------------------------------------------------------------------


def _maps(given: Any) -> dict[str, list[tuple[float, float]]]:
    """{channel: pairs} from any of the forms, also "LeftArm.Zrotation=-90:-60,0:0,90:60"."""
    found = {}
    form = "a map is CHANNEL=OLD:NEW,OLD:NEW, like LeftArm.Zrotation=-90:-60,90:60"
    for name, given_pairs in by_name(given, form):
        try:
            pairs = sorted(pairs_of(given_pairs))
        except OptionError:
            raise OptionError(f"{name}: pairs are old:new values, like -90:-60,90:60; not {given_pairs!r}") from None
        rising = len(pairs) > 1 and (np.diff(np.array(pairs), axis=0) > 0).all()
        if not rising:
            raise OptionError(f"{name}: a map has two pairs or more, and new values rise with the old ones")
        found[str(name)] = pairs
    return found


def _curves(
    ranges: Mapping[str, tuple[float | None, float | None]],
    maps: Mapping[str, list[tuple[float, float]]],
    skeleton: Skeleton,
    values: np.ndarray,
    margin: float | None,
) -> dict[int, Soft | Through]:
    """The curve of each channel (index) that has one."""
    names = skeleton.channel_names
    found: dict[int, Soft | Through] = {}
    for given in (ranges, maps):
        for name, numbers in given.items():
            for column in matching(name, names, names, "channel"):
                if column in found and name in names:
                    raise OptionError(f"two curves are given for {names[column]}")
                if given is ranges:
                    found[column] = _soft(*ranges[name], values[:, column], margin, name)
                else:
                    found[column] = Through(*np.array(numbers, np.float64).T)
    return dict(sorted(found.items()))


def _soft(low: float | None, high: float | None, values: np.ndarray, margin: float | None, name: str) -> Soft:
    bottom, top = (-np.inf if low is None else low), (np.inf if high is None else high)
    wide = top - bottom
    if margin is None:
        own = float(np.ptp(values)) if len(values) else 0.0
        margin = SOFT * (wide if np.isfinite(wide) else own or 1.0)
    if not wide >= 2.0 * margin > 0:
        raise OptionError(f"{name}: the limits are {wide:g} apart, which has no room for two margins of {margin:g}")
    return Soft(bottom, top, margin)


def _kept(clip: Clip, curves: Mapping[int, Soft | Through]) -> bool:
    """Whether no value of the clip changes, also between frames."""
    if isinstance(clip, KeyedMotion):
        reached = {c: extremes(clip.curves[c])[1] for c in curves}
    elif isinstance(clip, SplineMotion):  # a curve lies among its coefficients
        reached = {c: clip.values[:, c] for c in curves}
    else:
        return False
    return all((curve.at(reached[c]) == reached[c]).all() for c, curve in curves.items())


def _told(name: str, before: np.ndarray, after: np.ndarray) -> Shaped:
    ends = [
        (float(v.min(initial=np.inf)), float(v.max(initial=-np.inf))) if len(v) else (0.0, 0.0) for v in (before, after)
    ]
    return Shaped(name, float(np.mean(before != after)) if len(before) else 0.0, *ends)
