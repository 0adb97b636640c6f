"""The keys of a reduction as a clip that carries what was measured and how it was made."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from time import perf_counter
from typing import Any

import numpy as np

from .. import progress
from ..keyed import KeyedMotion
from ..measure import compare
from ..motion import Clip, Motion
from . import world
from .bound import lower_bound
from .keys import Keys
from .problem import Problem, curves


def reported(
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
    bounds = side_by_side(lambda tube: lower_bound(*tube), tubes, "proving the lower bound")
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
        tolerance=", ".join(asking.get("tolerance") or [f"{asking['keys']} keys" if "keys" in asking else "none"]),
        method=asking.get("method"),
        align=asking.get("align"),
        quality=asking.get("quality"),
    )
    return replace(made, report=told)


def side_by_side(work: Callable[[world.Tube], Any], tubes: list[world.Tube], label: str) -> list[Any]:
    """work(tube) of every tube, one thread a core: the kernels let go of the interpreter."""
    done = []
    with ThreadPoolExecutor(world.cores()) as threads:
        for result in threads.map(work, tubes):
            done.append(result)
            progress.advance(label, len(done), len(tubes))
    return done


def _with_tolerance(rows: Sequence[Any], limits: np.ndarray | None) -> tuple[Any, ...]:
    """The rows of a report with the tightest limit (N, F) of each, where there is one."""
    if limits is None:
        return tuple(rows)
    tightest = limits.min(axis=1, initial=np.inf)
    return tuple(
        replace(row, tolerance=float(limit)) if np.isfinite(limit) else row
        for row, limit in zip(rows, tightest, strict=False)
    )
