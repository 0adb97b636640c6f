"""Curve simplification: split where the curve is farthest (Önder 2007, sections 3.2 and B.2, after Lowe 1987).

Two forms. `with_ratio` is the thesis's: split at the largest height over the chord while height / chord length
exceeds a ratio, then "the optimum values for the tangents": least squares on all slopes at once, the values held. Its
ratio mixes frames with the channel's unit, so that it depends on both and bounds no error. `solve` is ours: it keeps
a tolerance. It splits on the error of the fitted curve instead of the chord's, since cubics with good tangents need
far fewer keys than chords do: fit, split the segments that fail worst at their worst frame, fit again.
"""

from __future__ import annotations

import numpy as np

from ..errors import OptionError
from ._band import inner
from ._least_squares import fit_slopes
from ._split import chord_frames, grow
from .keys import Keys


def solve(middle: np.ndarray, half: np.ndarray, quality: str = "default") -> Keys:
    """Keys of M channels with shared times, from two keys on: |curve - middle| <= half holds at every frame.

    middle, half: (M, F) the band and its half-width, in the channel's unit. quality: not used, split has one setting.
    """
    return grown(np.array(sorted({0, middle.shape[1] - 1})), middle, half)


def grown(start: np.ndarray, middle: np.ndarray, half: np.ndarray) -> Keys:
    """Keys at the frames `start` (K,), first and last among them, and at as many more as the band (M, F) needs; none
    is taken away.
    """
    if middle.shape[1] == 1:
        return Keys(start, middle.copy(), np.zeros_like(middle))
    return Keys(*grow(np.ascontiguousarray(middle), inner(middle, half), start))


def ratio_keys(y: np.ndarray, ratio: float) -> np.ndarray:
    """Key frames (K,) of the thesis's recursion on one channel y (F,).

    A segment is split at the frame with the largest perpendicular distance from its chord while that distance, the
    height, divided by the chord's length is over `ratio`; the plane is (frames, channel unit).

    Two slips of the thesis are not copied: step 3 of 3.2 words the test the other way round, and the code of B.2 takes
    area / base for the height, which is half of it. So its threshold 0.005 is the ratio 0.01 here.
    """
    if not ratio >= 0:
        raise OptionError(f"ratio is height over chord length, a number from 0 on, not {ratio!r}")
    if len(y) < 2:
        return np.arange(len(y))
    return chord_frames(np.ascontiguousarray(y, np.float64), float(ratio))


def with_ratio(samples: np.ndarray, ratio: float) -> Keys:
    """The thesis's curve simplification of one channel (F,): keys on samples, then the optimal tangents.

    It promises no tolerance.
    """
    y = np.ascontiguousarray(samples, np.float64)
    return optimal_tangents(y, ratio_keys(y, ratio))


def optimal_tangents(y: np.ndarray, frames: np.ndarray) -> Keys:
    """The C1 curve through the samples y (F,) at the frames (K,) whose slopes make the squared error least over all
    frames.
    """
    return Keys(frames, y[None, frames], fit_slopes(frames, y[frames], y, np.ones_like(y))[None])
