"""How far the curves of keys go: a cubic's extremes are known in closed form."""

from __future__ import annotations

import numpy as np

from ..keyed import HermiteCurve


def extremes(curve: HermiteCurve) -> tuple[np.ndarray, np.ndarray]:
    """Times (N,), rising, and values of the keys and of every extreme between two of them."""
    if len(curve) < 2:
        return curve.times, curve.values
    h, leaving, arriving = np.diff(curve.times), curve.slopes[:-1], curve.in_slopes[1:]
    rise = np.diff(curve.values) / h
    # the slope at u = 0..1 between two keys is a u^2 + b u + c
    a, b, c = 3.0 * (leaving + arriving - 2.0 * rise), 2.0 * (3.0 * rise - 2.0 * leaving - arriving), leaving
    root = np.sqrt(np.maximum(b * b - 4.0 * a * c, 0.0))
    q = -0.5 * (b + np.where(b < 0, -root, root))  # the root that does not cancel; the other is c / q
    with np.errstate(divide="ignore", invalid="ignore"):
        both = np.stack([q / a, c / q])
    inside = (b * b - 4.0 * a * c >= 0) & (both > 0) & (both < 1)
    _, segments = np.nonzero(inside)
    between = curve.times[segments] + both[inside] * h[segments]
    times = np.unique(np.concatenate([curve.times, between]))
    return times, curve.at(times)
