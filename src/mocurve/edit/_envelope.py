"""One smooth displacement for each run of values beyond a limit (Sudarsky and House 1998, joint limits).

It is as large as the violation where that is worst, nowhere smaller, and gone within the support. How: the largest
violation nearby (a running maximum as wide as half the support) is smoothed by a kernel just as wide, so at every frame
it is a mean of values none of which is below that frame's own violation.
"""

from __future__ import annotations

import numpy as np
from scipy.ndimage import correlate1d, maximum_filter1d

from ._poses import smooth

LEAST = 1e-6  # degrees or units; less is no violation: files round
PASSES = 12


def over(values: np.ndarray, low: float, high: float) -> np.ndarray:
    """How far (F,) values are beyond their limits; 0 where by no more than rounding."""
    away = np.maximum(np.maximum(values - high, low - values), 0.0)
    return np.where(away > LEAST, away, 0.0)


def bounded(values: np.ndarray, low: float, high: float, half: int, inside: float = 0.0) -> np.ndarray:
    """The values (F,) with a displacement for each run beyond a limit; others than within 2 x `half` frames of a run
    stay to the last digit. `inside`: how much further than to the limit.

    Where runs beyond both limits stand so close that each displacement throws the other side out, both are done again,
    and what is then still beyond is cut off.
    """
    made = values
    for _ in range(PASSES):
        if not over(made, low, high).any():
            return made
        made = _below(made, high - inside, over(made, -np.inf, high) > 0, half, low)
        made = -_below(-made, -low - inside, over(made, low, np.inf) > 0, half, -high)
    return np.where(over(made, low, high) > 0, np.clip(made, low, high), made)


def runs(beyond: np.ndarray) -> int:
    """How many stretches of True there are in (F,)."""
    return int(np.sum(beyond[1:] & ~beyond[:-1]) + beyond[:1].sum())


def _below(values: np.ndarray, limit: float, beyond: np.ndarray, half: int, other: float) -> np.ndarray:
    """Values (F,) brought below a limit; less those that are near the other one, that they may not leave there."""
    if not beyond.any():
        return values
    largest = maximum_filter1d(np.where(beyond, values - limit, 0.0), 2 * half + 1, mode="nearest")
    place = np.arange(-half, half + 1) / (half + 1.0)
    kernel = (1.0 - place**2) ** 2
    by = correlate1d(largest, kernel / kernel.sum(), mode="nearest")
    if np.isfinite(other) and limit > other:
        by *= smooth(np.clip((values - other) / (limit - other), 0.0, 1.0))
    return np.where(by > 0, np.minimum(values - by, limit), values)
