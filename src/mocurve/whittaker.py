"""Smoothing evenly spaced values against their second differences (Whittaker 1923), exact for straight lines."""

from __future__ import annotations

import numpy as np

DIFFERENCE = (1.0, -2.0, 1.0)
WIDEST = 2000.0  # samples: what is smoothed more has no digits left


def smoothed(
    values: np.ndarray, weights: np.ndarray, width: float, held: tuple[bool, bool] = (False, False)
) -> np.ndarray:
    """The y (F, C) for which sum of weights |y - values|^2 + width^4 |second differences of y|^2 is least.

    values: (F, C). weights: (F,) above 0.
    width:  in samples, up to WIDEST; a wave 2 pi times as long is halved where the weight is 1.
    held:   whether y is 0 before the first and after the last sample; otherwise it ends freely.
    """
    from scipy.linalg import solveh_banded  # a tenth of a second, for who smooths

    count = len(values)
    first, last = (-2 if held[0] else 0), (count - 1 if held[1] else count - 3)  # samples where a difference begins
    bands = np.zeros((3, count))
    for a in range(3):
        for b in range(a, 3):
            begin, end = max(first + a, 0), min(last + a, count - 1 - (b - a))
            bands[b - a, begin : max(end + 1, begin)] += DIFFERENCE[a] * DIFFERENCE[b]
    bands *= min(width, WIDEST) ** 4
    bands[0] += weights
    return np.asarray(solveh_banded(bands[:count], weights[:, None] * values, lower=True, check_finite=False))
