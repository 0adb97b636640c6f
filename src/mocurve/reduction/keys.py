"""What a reduction method returns, before frames become seconds."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np


class Keys(NamedTuple):
    """Keys of M channels that share their key times.

    frames:    (K,) int64, rising, from 0 to the last frame (a single key only where a constant does).
    values:    (M, K) in the channel's unit.
    slopes:    (M, K) per frame, leaving the key.
    in_slopes: (M, K) per frame, arriving at the key; None where no tangent is broken.
    """

    frames: np.ndarray
    values: np.ndarray
    slopes: np.ndarray
    in_slopes: np.ndarray | None = None
