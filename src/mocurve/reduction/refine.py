"""The verb `refine`: as many keys, nearer to the clip."""

from __future__ import annotations

from functools import partial
from time import perf_counter
from typing import Any

import numpy as np

from ..errors import Mismatch
from ..keyed import KeyedMotion
from ..measure import compare
from ..motion import Clip, Motion
from . import dynamic, world
from .keys import Keys
from .poses import nearer, pins
from .problem import Problem, curves, problem
from .reported import reported
from .tolerance import bounds


def refine(keys: KeyedMotion, original: Clip) -> KeyedMotion:
    """The same number of keys, moved in time, value and slope until they follow the clip better: Önder 2007, section
    3.1, as polish.

    Without a promise in space the squared error of no channel grows, or its sum over channels that share their times;
    with one, every curve is drawn towards the middle of what the promise leaves it, and the RMS error in space does not
    grow (channels that share their times stay as they are). So many whole poses (`reduce` with keys) are moved to where
    their largest error in space is less. Pinned keys stay in time. A promise that `reduce` made and that holds
    against this clip still holds. Shared key times stay shared.
    Mismatch where keys and clip have different skeletons or lengths, or a key lies between two frames.

    >>> mc.refine(mc.reduce(walk, method="split"), walk)
    """
    started = perf_counter()
    if not isinstance(keys, KeyedMotion):
        raise Mismatch(f"refine moves keys, and {keys!r} has none: reduce makes keys of it")
    made = next((step for step in reversed(keys.history) if "tolerance" in step), {})
    asked = problem(original, bounds(made.get("tolerance")), made.get("align", "channel"), made.get("feet", 1.0))
    before = _on_frames(keys, asked)
    if asked.motion.frames == 0:
        return keys
    pinned = _pinned(keys, made, asked.motion)
    if "keys" in made:
        after = [nearer(asked.motion, pinned, one) for one in before]
    elif asked.limits.joints is None:
        after = [polished(*each, pinned) for each in zip(before, asked.bands(), strict=True)]
    else:
        better = partial(dynamic.refine_keys, pinned=pinned)
        after = world.polish(asked.motion, asked.groups, asked.limits, before, better)
        if _error_in_space(asked, after) > _error_in_space(asked, before):
            after = before
    return reported(keys, asked, after, [], {"verb": "refine", "with": list(original.history)}, started, made)


def polished(keys: Keys, band: world.Tube, pinned: np.ndarray | None = None) -> Keys:
    """Inside the band where the keys are inside it now, else without it."""
    samples, half = band
    now = np.array([world.samples_of(keys, member, samples.shape[1]) for member in range(len(samples))])
    inside = bool((np.abs(now - samples) <= half).all()) and bool(np.isfinite(half).all())
    return dynamic.refine_keys(keys, samples, half if inside else None, pinned)


# -- in call order ---------------------------------------------------------------------------------


def _on_frames(keys: KeyedMotion, asked: Problem) -> list[Keys]:
    """The curves as groups of keys on frames."""
    motion = asked.motion
    if keys.skeleton.channel_names != motion.skeleton.channel_names or keys.frames != motion.frames:
        raise Mismatch(f"{keys!r} and {motion!r} are not the same motion: channels or frames differ")
    step, last = motion.frame_time, max(motion.frames - 1, 0)
    result = []
    for group in asked.groups:
        found = [keys.curves[k] for k in group]
        frames = np.rint(found[0].times / step).astype(np.int64)
        name = motion.skeleton.channel_names[group[0]]
        for curve in found:
            if len(curve) != len(frames) or (np.abs(curve.times - frames * step) > 1e-6 * step).any():
                raise Mismatch(f"the keys of {name!r} do not lie on frames, or not on those that it shares with others")
        if len(frames) > 1 and (frames[0] != 0 or frames[-1] != last):
            raise Mismatch(f"the keys of {name!r} do not reach from the first frame to the last")
        values = np.array([curve.values for curve in found])
        slopes = np.array([curve.slopes for curve in found]) * step
        broken = any(curve.broken for curve in found)
        result.append(Keys(frames, values, slopes, np.array([c.in_slopes for c in found]) * step if broken else None))
    return result


def _pinned(keys: KeyedMotion, made: dict[str, Any], motion: Motion) -> np.ndarray:
    """(F,) the pins of the reduction that made the keys; where something else was done since they are not known."""
    last = next((step for step in reversed(keys.history) if step.get("verb") != "refine"), None)
    return pins(made.get("pin", ()) if last is made else (), motion)


def _error_in_space(asked: Problem, keys: list[Keys]) -> float:
    motion = asked.motion
    made = KeyedMotion(motion.skeleton, curves(asked, keys), motion.frame_time, motion.frames)
    return compare(motion, made).rms_error_world
