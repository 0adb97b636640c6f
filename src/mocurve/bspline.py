"""B-spline curves as arrays: basis, values, refinement without change (Boehm, Oslo), degrees, Hermite keys both ways.

A basis is its knots (N + p + 1,), rising, and its degree p; a curve on it has N coefficients a channel, values (N, C).
Its domain is knots[p] to knots[N]; outside it every curve is constant. Clamped knots have their first and last value
p + 1 times, so that the curve begins at its first coefficient and ends at its last one; periodic knots do not.

Refinement, raised degrees and insertion are one formula here, the polar form (Ramshaw 1987): the coefficient i of a
curve on knots s is its polar form at s[i + 1] ... s[i + p], whatever finer knots s are.
"""

from __future__ import annotations

import numpy as np

from . import hermite
from .errors import Mismatch, OptionError

DEGREES = range(1, 6)
SAME = 1e-9  # of the domain: knots nearer than this are one knot


def checked(knots: np.ndarray, count: int, degree: int) -> np.ndarray:
    """The knots as floats; OptionError for a degree, Mismatch for knots on which `count` coefficients are no curve."""
    if isinstance(degree, bool) or degree not in DEGREES:
        raise OptionError(f"the degree of a spline is a whole number from 1 to 5, not {degree!r}")
    knots = np.array(knots, np.float64).reshape(-1)
    if count <= degree:
        raise Mismatch(f"a spline of degree {degree} has {degree + 1} coefficients or more, not {count}")
    if len(knots) != count + degree + 1:
        raise Mismatch(f"{count} coefficients of degree {degree} have {count + degree + 1} knots, not {len(knots)}")
    if not np.isfinite(knots).all() or (np.diff(knots) < 0).any():
        raise Mismatch("the knots of a spline are numbers that do not fall")
    if not knots[degree] < knots[count]:
        raise Mismatch("the knots of a spline leave it no time at all")
    inner = knots[1:-1]  # of p + 1 equal ones only the outermost at either end
    if (inner[degree:] == inner[:-degree]).any():
        extra = inner[degree:][inner[degree:] == inner[:-degree]]
        within = (extra > knots[degree]) & (extra < knots[count])
        if within.any():
            raise Mismatch(f"more than {degree} knots of a spline of degree {degree} lie at {extra[within][0]:g} s")
    return knots


def clamped(breaks: np.ndarray, degree: int = 3) -> np.ndarray:
    """Knots from breaks (B,), at least two, that do not fall: the ends p + 1 times, those between as often as given."""
    breaks = np.asarray(breaks, np.float64)
    return np.concatenate([np.repeat(breaks[0], degree), breaks, np.repeat(breaks[-1], degree)])


def periodic(breaks: np.ndarray, degree: int = 3) -> np.ndarray:
    """Knots from breaks (B,), rising, that go on beyond both ends as they lie at the other one.

    A curve on them closes with all its derivatives where its last p coefficients are its first p.
    Mismatch for fewer spans than the degree.
    """
    breaks = np.asarray(breaks, np.float64)
    if len(breaks) <= degree:
        raise Mismatch(f"a periodic spline of degree {degree} has {degree} spans or more, not {len(breaks) - 1}")
    period = breaks[-1] - breaks[0]
    return np.concatenate([breaks[-degree - 1 : -1] - period, breaks, breaks[1 : degree + 1] + period])


def greville(knots: np.ndarray, degree: int) -> np.ndarray:
    """(N,) where each coefficient acts most: the mean of its p inner knots."""
    return np.mean([knots[1 + j : len(knots) - degree + j] for j in range(degree)], axis=0)


def basis(knots: np.ndarray, degree: int, at: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Of each time (M,) the first basis function that is not 0 there, (M,), and the p + 1 values (M, p + 1) from it on.

    They are 0 or more and sum to 1. A time outside the domain counts as its nearest end (de Boor 1978, chapter X).
    """
    count = len(knots) - degree - 1
    at = np.clip(np.asarray(at, np.float64), knots[degree], knots[count])
    span = _spans(knots, degree, at)
    weights = np.zeros((degree + 1, len(at)))
    weights[0] = 1.0
    for d in range(1, degree + 1):
        carried = np.zeros(len(at))
        for j in range(d):
            left, right = knots[span + 1 + j - d], knots[span + 1 + j]
            width = right - left
            weights[j], carried = carried + (right - at) / width * weights[j], (at - left) / width * weights[j]
        weights[d] = carried
    return span - degree, weights.T


def evaluate(knots: np.ndarray, values: np.ndarray, degree: int, at: np.ndarray) -> np.ndarray:
    """Values (M, C), channel after channel in memory, of curves with coefficients (N, C) at times (M,)."""
    first, weights = basis(knots, degree, at)
    rows = np.ascontiguousarray(np.asarray(values).T)
    result = np.zeros((rows.shape[0], len(first)))
    for j in range(degree + 1):
        result += weights[:, j] * rows[:, first + j]
    return result.T


def derivative(knots: np.ndarray, values: np.ndarray, degree: int) -> tuple[np.ndarray, np.ndarray, int]:
    """Knots, coefficients and degree of the slope (per second); a basis function over no time has slope 0."""
    width = knots[degree + 1 : -1] - knots[1 : -degree - 1]
    scale = np.divide(degree, width, out=np.zeros_like(width), where=width > 0)
    return knots[1:-1], np.diff(values, axis=0) * scale[:, None], degree - 1


def polar(knots: np.ndarray, values: np.ndarray, degree: int, arguments: np.ndarray, inside: np.ndarray) -> np.ndarray:
    """(M, C) polar forms at arguments (M, p) of the polynomials that the curves are at the times `inside` (M,)."""
    span = _spans(knots, degree, inside)
    values = np.asarray(values, np.float64)
    points = [values[span - degree + j] for j in range(degree + 1)]
    for r in range(degree):
        argument = arguments[:, r]
        for j in range(degree - r):
            left, right = knots[span + 1 + j - degree + r], knots[span + 1 + j]
            part = ((argument - left) / (right - left))[:, None]
            points[j] = (1.0 - part) * points[j] + part * points[j + 1]
    return points[0]


def refine(knots: np.ndarray, values: np.ndarray, degree: int, finer: np.ndarray) -> np.ndarray:
    """Coefficients (N', C) of the same curves on finer knots, which hold all the old ones as often: the Oslo algorithm.

    Mismatch where a knot is missing among the finer ones, or the domain is another.
    """
    finer = np.asarray(finer, np.float64)
    if np.array_equal(knots, finer):
        return np.asarray(values, np.float64)
    at, counts = np.unique(knots, return_counts=True)
    lost = np.searchsorted(finer, at, "right") - np.searchsorted(finer, at, "left") < counts
    if lost.any():
        raise Mismatch(f"the finer knots lack one at {at[lost][0]:g} s")
    if finer[degree] != knots[degree] or finer[-degree - 1] != knots[-degree - 1]:
        raise Mismatch("finer knots have the domain of the old ones")
    arguments = _windows(finer, degree)
    return polar(knots, values, degree, arguments, _widest(finer, degree))


def insert(knots: np.ndarray, values: np.ndarray, degree: int, times: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Knots and coefficients of the same curves with more knots (seconds, within the domain), each as given."""
    times = np.asarray(times, np.float64).reshape(-1)
    if not ((times > knots[degree]) & (times < knots[-degree - 1])).all():
        raise Mismatch(f"knots are inserted between {knots[degree]:g} and {knots[-degree - 1]:g} s")
    finer = np.sort(np.concatenate([knots, times]))
    return finer, refine(knots, values, degree, finer)


def clamp(knots: np.ndarray, values: np.ndarray, degree: int) -> tuple[np.ndarray, np.ndarray]:
    """Clamped knots and the coefficients of the same curves on them; as they are where they are clamped."""
    start, end = knots[degree], knots[-degree - 1]
    finer = clamped(np.concatenate([[start], knots[(knots > start) & (knots < end)], [end]]), degree)
    if np.array_equal(knots, finer):
        return knots, values
    return finer, polar(knots, values, degree, _windows(finer, degree), _widest(finer, degree))


def union(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Knots with those of both, each as often as the basis says that has it more often."""
    at = np.unique(np.concatenate([first, second]))
    counts = [np.searchsorted(knots, at, "right") - np.searchsorted(knots, at, "left") for knots in (first, second)]
    return np.repeat(at, np.maximum(*counts))


def snapped(knots: np.ndarray, onto: np.ndarray) -> np.ndarray:
    """The knots, those within rounding of one of `onto` moved to it, so that a union has no spans of no length."""
    place = np.clip(np.searchsorted(onto, knots), 1, len(onto) - 1)
    near = np.where(knots - onto[place - 1] < onto[place] - knots, onto[place - 1], onto[place])
    return np.where(np.abs(near - knots) <= SAME * (onto[-1] - onto[0]), near, knots)


def raise_degree(knots: np.ndarray, values: np.ndarray, degree: int) -> tuple[np.ndarray, np.ndarray, int]:
    """Knots, coefficients and degree of the same curves, one degree higher: every knot once more.

    The polar form of the higher degree is the mean of the old one with each of its arguments left out (Ramshaw 1987).
    """
    at, counts = np.unique(knots, return_counts=True)
    finer = np.repeat(at, counts + 1)
    first = np.searchsorted(finer, knots[degree], "right") - (degree + 2)  # periodic knots need fewer beyond the ends
    last = np.searchsorted(finer, knots[-degree - 1]) + (degree + 2)
    finer = finer[first:last]
    arguments, inside = _windows(finer, degree + 1), _widest(finer, degree + 1)
    parts = [polar(knots, values, degree, np.delete(arguments, j, axis=1), inside) for j in range(degree + 1)]
    return finer, np.mean(parts, axis=0), degree + 1


def from_hermite(
    times: np.ndarray, values: np.ndarray, slopes: np.ndarray, in_slopes: np.ndarray | None = None
) -> tuple[np.ndarray, np.ndarray]:
    """Clamped cubic knots and coefficients (N,) of a Hermite curve through two keys or more: the same curve.

    Every inner key is a double knot, a triple one where its tangent is broken.
    """
    handles = hermite.to_bezier(times, values, slopes, in_slopes)[:, :, 1]
    arriving = slopes if in_slopes is None else in_slopes
    broken = np.asarray(arriving)[1:-1] != np.asarray(slopes)[1:-1]
    knots = clamped(np.concatenate([times[:1], np.repeat(times[1:-1], np.where(broken, 3, 2)), times[-1:]]), 3)
    kept = np.ones(handles.shape, bool)  # a segment's first value is the last one of that before
    kept[1:, 0] = False
    kept[:-1, 3] = broken
    return knots, handles[kept]


def to_hermite(knots: np.ndarray, values: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """times (K,) and values, slopes and in_slopes (K, C) of keys that are the same curves as a cubic spline."""
    count = len(knots) - 4
    breaks = np.unique(knots[3 : count + 1])
    start, end = breaks[:-1], breaks[1:]
    middle, third = 0.5 * (start + end), (end - start)[:, None] / 3.0

    def handle(*corners: np.ndarray) -> np.ndarray:
        return polar(knots, values, 3, np.stack(corners, axis=1), middle)

    first, last = handle(start, start, start), handle(end, end, end)
    leaving = (handle(start, start, end) - first) / third
    arriving = (last - handle(start, end, end)) / third
    return (
        breaks,
        np.concatenate([first, last[-1:]]),
        np.concatenate([leaving, arriving[-1:]]),
        np.concatenate([leaving[:1], arriving]),
    )


# -- places among knots ----------------------------------------------------------------------------


def _spans(knots: np.ndarray, degree: int, at: np.ndarray) -> np.ndarray:
    """(M,) i of the span knots[i] <= t < knots[i + 1] that has a length; the last one holds the end too."""
    count = len(knots) - degree - 1
    last = int(np.searchsorted(knots, knots[count])) - 1  # of the spans with a length
    return np.clip(np.searchsorted(knots, at, side="right") - 1, degree, last)


def _windows(knots: np.ndarray, width: int) -> np.ndarray:
    """(N, p) the inner knots of every basis function."""
    return np.lib.stride_tricks.sliding_window_view(knots[1:-1], width)


def _widest(knots: np.ndarray, degree: int) -> np.ndarray:
    """(N,) the middle of the longest span of each basis function, inside the domain: there the polar form is safest."""
    count = len(knots) - degree - 1
    inside = np.clip(knots, knots[degree], knots[count])
    widths = np.lib.stride_tricks.sliding_window_view(np.diff(inside), degree + 1)
    longest = np.argmax(widths, axis=1) + np.arange(count)
    return 0.5 * (inside[longest] + inside[longest + 1])
