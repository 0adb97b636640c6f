"""What other tolerances would give: keys against tolerance, error against ratio (Önder 2007, figures 4.5 and 4.7)."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from .keyed import KeyedMotion
from .measure import Report
from .motion import Clip, Motion
from .progress import advance

DEGREES = (0.1, 0.2, 0.5, 1.0, 2.0, 5.0)
HEIGHTS = (0.05, 0.1, 0.2, 0.5, 1.0)  # % of the rest height
RATIOS = (0.001, 0.005, 0.01, 0.02, 0.03, 0.1)  # those of the thesis's table 4.1
MOST_SAMPLES = 80_000  # of a longer clip the middle is taken


def sweep_data(report: Report) -> dict[str, Any] | None:
    """Lines of points, one a way to reduce; None where there is nothing to reduce."""
    assert report.clips is not None
    motion = _middle(report.clips[0])
    if motion.frames < 8 or not motion.skeleton.channel_count:
        return None
    runs = [(way, amount) for way, (amounts, _, _) in _ways().items() for amount in amounts]
    told: dict[str, list[Report]] = {way: [] for way, _ in runs}
    for done, (way, amount) in enumerate(runs):
        advance("trying tolerances", done, len(runs))
        made = _ways()[way][2](motion, amount)
        assert made.report is not None
        told[way].append(made.report)
    advance("trying tolerances", len(runs), len(runs))
    bounds = [None if one.lower_bound is None else one.lower_bound / len(one.channels) for one in told["optimal"]]
    return {
        "lines": [_line(way, told[way]) for way in told],
        "bound": {"tolerance": DEGREES, "keys": bounds},
        "here": {"percent": 100 * report.keys / max(report.samples, 1), "world": report.max_error_world},
        "words": _words(report, motion),
    }


# -- in call order -----------------------------------------------------------------------------------------------------


def _middle(clip: Clip) -> Motion:
    motion = clip.sample()
    kept = max(8, MOST_SAMPLES // max(1, motion.skeleton.channel_count))
    start = max(0, (motion.frames - kept) // 2)
    return motion[start : start + kept]


def _ways() -> dict[str, tuple[tuple[float, ...], str, Callable[[Motion, float], KeyedMotion]]]:
    """Name of a line: its amounts, how one of them is told, how the clip is reduced to it."""
    from .reduction import reduce  # Numba comes with it

    return {
        "optimal": (DEGREES, "{:g} degrees", lambda m, x: reduce(m, tolerance=f"{x:g}deg", quality="fast")),
        "optimal, held in space": (
            HEIGHTS,
            "{:g} % of the height",
            lambda m, x: reduce(m, tolerance=f"{x:g}%height", quality="fast"),
        ),
        "split": (DEGREES, "{:g} degrees", lambda m, x: reduce(m, tolerance=f"{x:g}deg", method="split")),
        "split by ratio": (RATIOS, "ratio {:g}", lambda m, x: reduce(m, method="split", tolerance=f"{x:g}ratio")),
    }


def _line(way: str, told: list[Report]) -> dict[str, Any]:
    amounts, label, _ = _ways()[way]
    return {
        "name": way,
        "labels": [f"{way}, {label.format(amount)}" for amount in amounts],
        "tolerance": amounts if amounts is DEGREES else None,
        "keys": [one.keys / len(one.channels) for one in told],
        "percent": [100 * one.keys / max(one.samples, 1) for one in told],
        "world": [one.max_error_world for one in told],
    }


def _words(report: Report, motion: Motion) -> str:
    whole = "the whole clip" if motion.frames == report.frames else f"the {motion.frames:,} frames in the clip's middle"
    return (
        f"Computed on {whole}. Left: each channel within a tolerance in degrees (for lengths, what that angle spans at "
        "the body's height). Right: also with a tolerance in space, 0.05 to 1 % of the height; and the curve "
        "simplification of Önder 2007, split by ratio, which bounds no error. Optimal is run at its fast setting. "
        "After that thesis's figures 4.5 and 4.7."
    )
