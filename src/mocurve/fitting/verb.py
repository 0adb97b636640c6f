"""The verb `fit`: samples become B-splines."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from time import perf_counter

from ..bspline import DEGREES
from ..errors import Mismatch, OptionError
from ..measure import compare
from ..motion import Clip
from ..reduction.problem import known, problem
from ..reduction.tolerance import DEFAULT, parse
from ..spline import SplineMotion
from .task import Fit, task_of


def fit(
    clip: Clip,
    *,
    tolerance: str | Sequence[str] | None = None,
    knots: str = "fewest",
    spans: int | None = None,
    degree: int = 3,
    ends: bool = True,
    feet: float = 0.25,
) -> SplineMotion:
    """B-splines on few knots instead of samples; nothing moves more than the tolerance, which is checked.

    Parameters
    ----------
    clip
        A Motion, or any other clip, which is sampled at its frames.
    tolerance
        How far anything may move, as of reduce: in space 2mm 0.1%height 0.35u, or of each channel's value 0.5deg
        0.5%range; LeftHand=0.5mm, @1.2..2.0=0.2mm. None: 0.1%height.
    knots
        fewest (halve the worst spans, then take out knots), bisected (halve them only), curvature (equal shares of it,
        weighted by lever arm) or uniform. All channels share them.
    spans
        So many polynomial pieces (knots: curvature or uniform) instead of a tolerance: nothing is promised, the report
        tells the errors.
    degree
        1 (straight lines) to 5; 3 has smooth speed and acceleration without a jump.
    ends
        The first and the last frame are kept exactly.
    feet
        Part of the tolerance that planted feet get; 1 treats them like the rest.

    Returns a SplineMotion whose `report` tells knots, coefficients, errors and time. Errors: OptionError for an
    option's value or a tolerance finer than rounding, UnknownName for a joint, Mismatch for too few samples or samples
    that are no numbers.

    Source: Sudarsky and House 1998, section 3; the promise in space is mocurve's own.

    >>> curves = mc.fit(mc.read("walk.bvh"), tolerance="2mm")
    """
    from . import KNOTS

    started = perf_counter()
    known("way to choose knots", knots, KNOTS)
    if isinstance(degree, bool) or degree not in DEGREES:
        raise OptionError(f"the degree of a spline is a whole number from 1 to 5, not {degree!r}")
    if spans is not None and (tolerance is not None or knots not in ("curvature", "uniform")):
        raise OptionError("a number of spans goes with knots 'curvature' or 'uniform', and takes the tolerance's place")
    if spans is not None and (isinstance(spans, bool) or not isinstance(spans, int) or spans < 1):
        raise OptionError(f"spans is a whole number from 1 up, not {spans!r}")
    parse(DEFAULT if tolerance is None else tolerance)  # refused before work is done
    texts = [tolerance] if isinstance(tolerance, str) else list(tolerance or [DEFAULT])
    asked = problem(clip, None if spans else texts, "pose", feet)
    motion = asked.motion
    if motion.frames <= degree:
        raise Mismatch(
            f"a spline of degree {degree} takes {degree + 1} frames or more, the clip has {motion.frames}; "
            "a lower degree takes fewer"
        )
    if spans is not None and spans + degree > motion.frames:
        raise OptionError(
            f"{motion.frames} frames settle at most {motion.frames - degree} spans of degree {degree}, not {spans}"
        )
    found = KNOTS[knots](task_of(asked, degree, ends), spans)
    if found.worst == float("inf"):
        raise OptionError(f"the {motion.frames} frames do not settle {spans} spans of degree {degree}: take fewer")
    if spans is None and not found.holds:
        raise OptionError(
            f"the tolerance is finer than the rounding of a spline of degree {degree} through every frame; ask for more"
        )
    step: dict[str, object] = {"verb": "fit", "tolerance": None if spans else texts, "knots": knots, "spans": spans}
    step |= {"degree": degree, "ends": ends, "feet": feet}
    return _reported(clip, motion, found, degree, step, started)


def _reported(
    clip: Clip, motion: Clip, found: Fit, degree: int, step: dict[str, object], started: float
) -> SplineMotion:
    made = SplineMotion(
        motion.skeleton,
        found.knots,
        found.values,
        degree,
        motion.frame_time,
        motion.frames,
        (*clip.history, {name: value for name, value in step.items() if value is not None}),
    )
    texts = step["tolerance"]
    report = replace(
        compare(motion, made),
        clips=(clip, made),
        seconds=perf_counter() - started,
        tolerance=", ".join(texts) if isinstance(texts, list) else None,
        method=str(step["knots"]),
    )
    return replace(made, report=report)
