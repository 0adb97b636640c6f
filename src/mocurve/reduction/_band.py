"""The band that a method aims at: the promised one less what rounding may cost."""

from __future__ import annotations

import numpy as np


def inner(middle: np.ndarray, half: np.ndarray) -> np.ndarray:
    """Half-widths (M, F) a little inside `half`, so that a curve kept inside them is inside `half` however it is
    evaluated.

    Never negative: where the band is thinner than the rounding of the numbers in it, only the middle itself is left.
    """
    rounding = 16 * np.finfo(np.float64).eps * np.abs(middle).max(axis=1, keepdims=True, initial=0.0)
    return np.ascontiguousarray(np.maximum(half * (1 - 1e-9) - rounding, 0.0))
