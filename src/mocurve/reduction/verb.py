"""The verb `reduce`: few keys for a clip."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from time import perf_counter
from typing import Any, NamedTuple

import numpy as np

from ..errors import OptionError
from ..keyed import KeyedMotion
from ..motion import Clip
from . import split, world
from .keys import Keys
from .poses import CHOOSERS, Pins, pins, with_fewer, with_number, within_limits, within_span
from .problem import ALIGNMENTS, Problem, held, known, problem, with_pins
from .refine import polished
from .reported import reported, side_by_side
from .tolerance import DEFAULT, OF_NOISE, THRESHOLDS, parse


class Method(NamedTuple):
    """A reduction method. solve(middle (M, F), half (M, F), quality) -> Keys with |curve - middle| <= half.

    again: it is quick enough to run again inside the tubes of the promise in space, in every round."""

    solve: world.Solve
    again: bool = False


def reduce(
    clip: Clip,
    *,
    tolerance: str | Sequence[str] | None = None,
    keys: int | None = None,
    pin: Pins | None = None,
    method: str = "optimal",
    align: str | None = None,
    quality: str = "default",
    feet: float = 0.25,
    denoise: bool = False,
) -> KeyedMotion:
    """Few Hermite keys instead of a sample at every frame; nothing moves more than the tolerance, which is checked.
    Or so many whole poses, with the least error in space.

    Parameters
    ----------
    clip
        A Motion, or a KeyedMotion to be reduced further.
    tolerance
        How far anything may move: in space 2mm 0.2cm 0.05in 0.1%height 0.35u (u: file units), or of each channel's
        value 0.5deg 0.5%range. For a joint or channel, or from one second to another: LeftHand=0.5mm,
        LeftHand@1.2..2.0=0.2mm. Several hold together: 2mm and 5deg bound the twist too. None: 0.1%height, and with
        denoise 0.3sigma, a part of each channel's noise. Or a paper's own threshold, which promises nothing: 0.01ratio
        (split: height over base, in frames and degrees), 3%span (probe and cluster: of a posture, what no combination
        of the keys makes).
    keys
        How many whole poses, in place of a tolerance: their times and curves are chosen so that the largest error in
        space is as small as the method finds.
    pin
        Where a key has to be, whatever the method: a frame (40), a time (1.2s), or contacts, where a foot comes to
        stand and where it stands last.
    method
        optimal (fewest keys), split (Lowe, after Önder), dynamic (Önder's dynamic programming), linear (straight
        segments). Whole poses: optimal, broken (best for broken tangents), salient (Roberts et al.), posture (Lim and
        Thalmann), probe (Huang et al.), cluster (Park and Shin).
    align
        Which channels share key times: channel (none do; fewest keys), joint, or pose (all). None: pose where keys or
        a method for whole poses is asked for, else channel.
    quality
        fast, default, good or best: fewer keys for more time.
    feet
        Part of the tolerance that planted feet get; 1 treats them like the rest.
    denoise
        Take noise, spikes and dropouts out first (as the verb denoise does), and hold the tolerance against what is
        left.

    Returns a KeyedMotion whose `report` tells keys, errors, time and the proven lower bound. Errors: OptionError for
    an option's value, UnknownName for a joint, Mismatch for samples that are no numbers.

    Source: Önder 2007, chapter 3, for split and dynamic; the ways to choose whole poses name theirs; the promise in
    space and the methods optimal and broken are mocurve's own.

    >>> curves = mc.reduce(mc.read("walk.bvh"), tolerance="2mm")
    >>> blocked = mc.reduce(mc.read("walk.bvh"), keys=16, pin=["contacts"])
    """
    from . import METHODS, QUALITIES

    started = perf_counter()
    known("method", method, {**METHODS, **CHOOSERS})
    known("quality", quality, QUALITIES)
    align = _alignment(align, method, keys)
    texts = _texts(tolerance, keys, denoise)
    own = _threshold(texts, method, align)
    if denoise:
        from ..denoising import denoise as freed_of_noise

        clip = replace(freed_of_noise(clip), history=clip.history)
    asked = problem(clip, None if own is not None else texts, align, feet)
    pinned = pins(pin, asked.motion)
    step: dict[str, Any] = {"verb": "reduce", "tolerance": texts, "method": method, "align": align, "quality": quality}
    step["feet"] = feet
    step |= {"keys": int(keys)} if keys is not None else {}
    step |= {"pin": [one if isinstance(one, str) else int(one) for one in pin]} if pin else {}
    step |= {"denoise": True} if denoise else {}
    tubes: list[world.Tube] = []
    if asked.motion.frames == 0:
        found = [Keys(np.zeros(0, np.int64), np.zeros((len(g), 0)), np.zeros((len(g), 0))) for g in asked.groups]
    elif method in CHOOSERS or keys is not None:
        found, tubes = _whole_poses(asked, method, pinned, keys, own, quality)
    else:
        found, tubes = _curves(asked, METHODS[method], own, quality, denoise)
        if method == "optimal" and align == "pose" and len(asked.groups):
            kept = with_pins(held(asked, found)[0], pinned)
            found = [with_fewer(asked.motion, pinned, asked.limits, kept, quality)]
            tubes = world.ended_with(asked.motion, asked.groups, asked.limits, found)
    found = [with_pins(one, pinned) for one in held(asked, found)]
    return reported(clip, asked, found, tubes, step, started)


# -- reduce, in call order -------------------------------------------------------------------------


def _alignment(align: str | None, method: str, keys: int | None) -> str:
    """Which channels share key times, where it was said or is meant; OptionError where the rest cannot go with it."""
    whole = keys is not None or method in CHOOSERS
    align = ("pose" if whole else "channel") if align is None else align
    known("alignment", align, ALIGNMENTS)
    if keys is not None and method != "optimal" and method not in CHOOSERS:
        raise OptionError(f"a number of keys goes with the methods optimal, {', '.join(CHOOSERS)}; not with {method!r}")
    if whole and align != "pose":
        what = f"method {method!r}" if method in CHOOSERS else "a number of keys"
        raise OptionError(f"{what} is for whole poses, align 'pose', not {align!r}")
    return align


def _texts(tolerance: str | Sequence[str] | None, keys: int | None, denoise: bool) -> list[str] | None:
    """The tolerance as texts, refused before work is done; None where a number of keys stands for it."""
    if keys is not None:
        if isinstance(keys, bool) or not isinstance(keys, int | np.integer) or keys < 1:
            raise OptionError(f"keys is a whole number of poses from 1 up, not {keys!r}")
        if tolerance is not None:
            raise OptionError("keys says how many, a tolerance how near: give one of them")
        return None
    if tolerance is None:
        tolerance = OF_NOISE if denoise else DEFAULT
    parse(tolerance)
    return [tolerance] if isinstance(tolerance, str) else list(tolerance)


def _threshold(texts: list[str] | None, method: str, align: str) -> float | None:
    """The paper's own threshold, where the tolerance is one."""
    rule = parse(texts)[0] if texts else None
    if rule is None or rule.unit not in THRESHOLDS:
        return None
    if method not in THRESHOLDS[rule.unit]:
        raise OptionError(f"a tolerance in {rule.unit} goes with method {' or '.join(THRESHOLDS[rule.unit])}")
    if rule.unit == "ratio" and align != "channel":
        raise OptionError(f"a tolerance in ratio goes with align 'channel', not {align!r}")
    return rule.amount / (100.0 if rule.unit.startswith("%") else 1.0)


def _curves(
    asked: Problem, method: Method, own: float | None, quality: str, denoise: bool
) -> tuple[list[Keys], list[world.Tube]]:
    """Keys of every group within the tolerance, and the tubes that they ended with."""
    solve, again = method
    if own is not None:  # the thesis's curve simplification as it stands
        return [split.with_ratio(samples[0], own) for samples, _ in asked.bands()], []
    if asked.limits.joints is not None:
        return world.fit(asked.motion, asked.groups, asked.limits, solve, again, quality)
    tubes = asked.bands()
    keys = side_by_side(lambda tube: world.group_keys(*tube, solve, quality), tubes, "reducing")
    if denoise:  # as near to the clean curve as these keys can be
        keys = [polished(*each) for each in zip(held(asked, keys), tubes, strict=True)]
    return keys, tubes


def _whole_poses(
    asked: Problem, method: str, pinned: np.ndarray, keys: int | None, own: float | None, quality: str
) -> tuple[list[Keys], list[world.Tube]]:
    """Keys of all channels together: so many, or as few as keep the tolerance; and the tubes that they ended with."""
    motion = asked.motion
    if not asked.groups:
        return [], []
    if keys is not None:
        return [with_number(motion, method, pinned, keys, quality)], []
    if own is not None:
        return [within_span(motion, method, pinned, own, quality)], []
    found = [within_limits(motion, method, pinned, asked.limits)]
    return found, world.ended_with(motion, asked.groups, asked.limits, found)
