"""The verbs: `reduce` finds few keys for a clip, `refine` polishes the keys there are."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from time import perf_counter
from typing import Any, NamedTuple

import numpy as np

from .. import progress
from ..errors import Mismatch, OptionError
from ..keyed import KeyedMotion
from ..measure import compare
from ..motion import Clip, Motion
from . import dynamic, split, world
from .bound import lower_bound
from .keys import Keys
from .problem import Problem, curves, held, known, problem
from .tolerance import DEFAULT, OF_NOISE, parse


class Method(NamedTuple):
    """A reduction method. solve(middle (M, F), half (M, F), quality) -> Keys with |curve - middle| <= half.

    again: it is quick enough to run again inside the tubes of the promise in space, in every round."""

    solve: world.Solve
    again: bool = False


def reduce(
    clip: Clip,
    *,
    tolerance: str | Sequence[str] | None = None,
    method: str = "optimal",
    align: str = "channel",
    quality: str = "default",
    feet: float = 0.25,
    ratio: float | None = None,
    denoise: bool = False,
) -> KeyedMotion:
    """Few Hermite keys instead of a sample at every frame; nothing moves more than the tolerance, which is checked.

    Parameters
    ----------
    clip
        A Motion, or a KeyedMotion to be reduced further.
    tolerance
        How far anything may move: in space 2mm 0.2cm 0.05in 0.1%height 0.35u (u: file units), or of each channel's
        value 0.5deg 0.5%range. For a joint or channel, or from one second to another: LeftHand=0.5mm,
        LeftHand@1.2..2.0=0.2mm. Several hold together: 2mm and 5deg bound the twist too. None: 0.1%height, and with
        denoise 0.3sigma, a part of each channel's noise.
    method
        optimal (fewest keys), split (Lowe, after Önder), dynamic (Önder's dynamic programming), linear (straight
        segments).
    align
        Which channels share key times: channel (none do; fewest keys), joint, or pose (all).
    quality
        fast, default, good or best: fewer keys for more time.
    feet
        Part of the tolerance that planted feet get; 1 treats them like the rest.
    ratio
        The thesis's own threshold for method split, height over base in frames and degrees (0.001 to 0.1): it replaces
        the tolerance and promises nothing.
    denoise
        Take noise, spikes and dropouts out first (as the verb denoise does), and hold the tolerance against what is
        left.

    Returns a KeyedMotion whose `report` tells keys, errors, time and the proven lower bound. Errors: OptionError for
    an option's value, UnknownName for a joint, Mismatch for samples that are no numbers.

    Source: Önder 2007, chapter 3, for split and dynamic; the promise in space and the method optimal are mocurve's own.

    >>> keys = mc.reduce(mc.read("walk.bvh"), tolerance="2mm")
    """
    from . import METHODS, QUALITIES

    started = perf_counter()
    known("method", method, METHODS)
    known("quality", quality, QUALITIES)
    if tolerance is None:
        tolerance = OF_NOISE if denoise else DEFAULT
    parse(tolerance)  # refused before work is done
    texts = [tolerance] if isinstance(tolerance, str) else list(tolerance)
    if denoise:
        from ..denoising import denoise as freed_of_noise

        clip = replace(freed_of_noise(clip), history=clip.history)
    step = {"verb": "reduce", "tolerance": texts, "method": method, "align": align, "quality": quality, "feet": feet}
    if denoise:
        step["denoise"] = True
    if ratio is not None:
        return _by_ratio(clip, ratio, step, started)
    asked = problem(clip, texts, align, feet)
    solve, again = METHODS[method]
    tubes: list[world.Tube] = []
    if asked.motion.frames == 0:
        keys = [Keys(np.zeros(0, np.int64), np.zeros((len(g), 0)), np.zeros((len(g), 0))) for g in asked.groups]
    elif asked.limits.joints is None:
        tubes = asked.bands()
        keys = _side_by_side(lambda tube: world.group_keys(*tube, solve, quality), tubes, "reducing")
        if denoise:  # as near to the clean curve as these keys can be
            keys = [_polished(*each) for each in zip(held(asked, keys), tubes, strict=True)]
    else:
        keys, tubes = world.fit(asked.motion, asked.groups, asked.limits, solve, again, quality)
    return _reported(clip, asked, held(asked, keys), tubes, step, started)


def refine(keys: KeyedMotion, original: Clip) -> KeyedMotion:
    """The same number of keys, moved in time, value and slope until they follow the clip better: Önder 2007, section
    3.1, as polish.

    Without a promise in space the squared error of no channel grows, or its sum over channels that share their times;
    with one, every curve is drawn towards the middle of what the promise leaves it, and the RMS error in space does not
    grow (channels that share their times stay as they are). A promise that `reduce` made and that holds against this
    clip still holds. Shared key times stay shared.
    Mismatch where keys and clip have different skeletons or lengths, or a key lies between two frames.

    >>> mc.refine(mc.reduce(walk, method="split"), walk)
    """
    started = perf_counter()
    if not isinstance(keys, KeyedMotion):
        raise Mismatch(f"refine moves keys, and {keys!r} has none: reduce makes keys of it")
    made = next((step for step in reversed(keys.history) if "tolerance" in step), {})
    asked = problem(original, made.get("tolerance"), made.get("align", "channel"), made.get("feet", 1.0))
    before = _on_frames(keys, asked)
    if asked.motion.frames == 0:
        return keys
    if asked.limits.joints is None:
        after = [_polished(*each) for each in zip(before, asked.bands(), strict=True)]
    else:
        after = world.polish(asked.motion, asked.groups, asked.limits, before, dynamic.refine_keys)
        if _error_in_space(asked, after) > _error_in_space(asked, before):
            after = before
    return _reported(keys, asked, after, [], {"verb": "refine", "with": list(original.history)}, started, made)


# -- reduce, in call order -------------------------------------------------------------------------


def _by_ratio(clip: Clip, ratio: float, step: dict[str, Any], started: float) -> KeyedMotion:
    """The thesis's curve simplification as it stands: every channel by the ratio, then optimal tangents."""
    if step["method"] != "split" or step["align"] != "channel" or step["tolerance"] != [DEFAULT]:
        raise OptionError("a ratio goes with method 'split' and align 'channel', and takes the place of the tolerance")
    if not (isinstance(ratio, int | float) and 0.0 <= ratio < np.inf):
        raise OptionError(f"a ratio is a number from 0 up, like 0.005, not {ratio!r}")
    asked = problem(clip, None, "channel", 1.0)
    keys = [split.with_ratio(samples[0], ratio) for samples, _ in asked.bands()]
    return _reported(clip, asked, keys, [], {**step, "tolerance": None, "ratio": ratio}, started)


def _side_by_side(work: Callable[[world.Tube], Any], tubes: list[world.Tube], label: str) -> list[Any]:
    """work(tube) of every tube, one thread a core: the kernels let go of the interpreter."""
    done = []
    with ThreadPoolExecutor(world.cores()) as threads:
        for result in threads.map(work, tubes):
            done.append(result)
            progress.advance(label, len(done), len(tubes))
    return done


def _reported(
    clip: Clip,
    asked: Problem,
    keys: list[Keys],
    tubes: list[world.Tube],
    step: dict[str, Any],
    started: float,
    promised: dict[str, Any] | None = None,
) -> KeyedMotion:
    """The keys as a clip that carries what was measured and how it was made. promised: the step that asked for what is
    to hold, where it is another."""
    motion = asked.motion
    history = (*clip.history, step)
    made = KeyedMotion(motion.skeleton, curves(asked, keys), motion.frame_time, motion.frames, history)
    bounds = _side_by_side(lambda tube: lower_bound(*tube), tubes, "proving the lower bound")
    of_channel = {int(k): bound for group, bound in zip(asked.groups, bounds, strict=False) for k in group}
    report = compare(motion, made)
    channels = [replace(row, lower_bound=of_channel.get(k)) for k, row in enumerate(report.channels)]
    asking = step if promised is None else promised
    told = replace(
        report,
        clips=(clip, made),
        noise=getattr(clip.report, "noise", None) if isinstance(clip, Motion) else None,
        channels=_with_tolerance(channels, asked.limits.channels),
        joints=_with_tolerance(report.joints, asked.limits.joints),
        lower_bound=sum(of_channel.values()) if of_channel else None,
        seconds=perf_counter() - started,
        tolerance=", ".join(
            asking.get("tolerance") or ["none" if "ratio" not in asking else f"ratio {asking['ratio']:g}"]
        ),
        method=asking.get("method"),
        align=asking.get("align"),
        quality=asking.get("quality"),
    )
    return replace(made, report=told)


def _with_tolerance(rows: Sequence[Any], limits: np.ndarray | None) -> tuple[Any, ...]:
    """The rows of a report with the tightest limit (N, F) of each, where there is one."""
    if limits is None:
        return tuple(rows)
    tightest = limits.min(axis=1, initial=np.inf)
    return tuple(
        replace(row, tolerance=float(limit)) if np.isfinite(limit) else row
        for row, limit in zip(rows, tightest, strict=False)
    )


# -- refine, in call order -------------------------------------------------------------------------


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


def _polished(keys: Keys, band: world.Tube) -> Keys:
    """Inside the band where the keys are inside it now, else without it."""
    samples, half = band
    now = np.array([world.samples_of(keys, member, samples.shape[1]) for member in range(len(samples))])
    inside = bool((np.abs(now - samples) <= half).all()) and bool(np.isfinite(half).all())
    return dynamic.refine_keys(keys, samples, half if inside else None)


def _error_in_space(asked: Problem, keys: list[Keys]) -> float:
    motion = asked.motion
    made = KeyedMotion(motion.skeleton, curves(asked, keys), motion.frame_time, motion.frames)
    return compare(motion, made).rms_error_world
