"""Distances along a curve: from its parameter to the distance, and back.

The speed is integrated by 5-point Gauss-Legendre on intervals that are halved where that changes the length. Within
one the speed is the polynomial through its five values there, so that the distance is a polynomial too, and the way
back Newton's method on it, halving wherever a step leaves the interval.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

NODES = 0.5 + 0.5 * np.polynomial.legendre.leggauss(5)[0]  # (5,) of the interval 0 ... 1
# (5, 5) from values at the nodes to the coefficients of x ... x^5 of their polynomial's integral
INTEGRAL = np.linalg.inv(np.vander(NODES, increasing=True)) / np.arange(1, 6)[:, None]
FIRST_PARTS = 8  # intervals between two breaks
HALVINGS = 12
NEAR = 1e-11  # of the whole length: an interval and its halves are equally long
STEPS = 60  # of Newton's method: bisection alone would settle the last digit in so many


@dataclass(frozen=True, eq=False)
class LengthTable:
    """Distances from the beginning of a curve.

    parameters: (B + 1,) rising, from 0 to 1. lengths: (B + 1,) the distances there.
    rises:      (B, 5) coefficients of x ... x^5 of the distance gone within each interval, x going from 0 to 1.
    """

    parameters: np.ndarray
    lengths: np.ndarray
    rises: np.ndarray

    @property
    def length(self) -> float:
        """Of the whole curve."""
        return float(self.lengths[-1])

    def distance(self, parameter: np.ndarray) -> np.ndarray:
        """Distances (M,) at parameters (M,) from 0 to 1."""
        at = np.clip(parameter, 0.0, 1.0)
        place = np.clip(np.searchsorted(self.parameters, at, "right") - 1, 0, len(self.rises) - 1)
        width = self.parameters[place + 1] - self.parameters[place]
        return self.lengths[place] + _risen(self.rises[place], (at - self.parameters[place]) / width)[0]

    def parameter(self, distance: np.ndarray) -> np.ndarray:
        """Parameters (M,) at distances (M,); those beyond an end are that end's."""
        at = np.clip(distance, 0.0, self.length)
        place = np.clip(np.searchsorted(self.lengths, at, "right") - 1, 0, len(self.rises) - 1)
        rises, wanted = self.rises[place], at - self.lengths[place]
        whole = rises.sum(axis=1)
        x = np.divide(wanted, whole, out=np.zeros_like(wanted), where=whole > 0)
        low, high = np.zeros_like(x), np.ones_like(x)
        for _ in range(STEPS):
            risen, slope = _risen(rises, x)
            off = risen - wanted
            low, high = np.where(off <= 0, x, low), np.where(off >= 0, x, high)
            step = np.divide(off, slope, out=np.zeros_like(off), where=slope > 0)
            if (np.abs(step) <= 4e-16).all() and ((slope > 0) | (off == 0)).all():
                break
            ahead = x - step
            x = np.where((slope <= 0) | (ahead < low) | (ahead > high), 0.5 * (low + high), ahead)
        width = self.parameters[place + 1] - self.parameters[place]
        return self.parameters[place] + x * width


def measured(speed: Callable[[np.ndarray], np.ndarray], breaks: np.ndarray) -> LengthTable:
    """The table of a curve whose speed (M,) per parameter is given at parameters (M,) from 0 to 1.

    breaks: (B,) from 0 to 1, between which the curve is smooth. Intervals are halved until the halves are as long
    together as the whole, but not further than cusps are worth it.
    """
    parts = np.arange(FIRST_PARTS) / FIRST_PARTS
    starts = (breaks[:-1, None] + np.diff(breaks)[:, None] * parts).reshape(-1)
    widths = np.diff(np.append(starts, breaks[-1]))
    rises = _rises(speed, starts, widths)
    done: list[tuple[np.ndarray, np.ndarray]] = []
    for _ in range(HALVINGS):
        allowed = NEAR * sum(part[1].sum() for part in [*done, (starts, rises)])
        halves = np.stack([starts, starts + 0.5 * widths], axis=1), np.stack([0.5 * widths] * 2, axis=1)
        finer = _rises(speed, *(part.reshape(-1) for part in halves)).reshape(-1, 2, len(NODES))
        rough = np.abs(finer.sum(axis=(1, 2)) - rises.sum(axis=1)) > allowed
        done.append((starts[~rough], rises[~rough]))
        starts, widths = (part[rough].reshape(-1) for part in halves)
        rises = finer[rough].reshape(-1, len(NODES))
        if not rough.any():
            break
    starts, rises = (np.concatenate(part) for part in zip(*done, (starts, rises), strict=True))
    order = np.argsort(starts, kind="stable")
    starts, rises = starts[order], rises[order]
    lengths = np.concatenate([[0.0], np.cumsum(rises.sum(axis=1))])
    return LengthTable(np.append(starts, breaks[-1]), lengths, rises)


def _rises(speed: Callable[[np.ndarray], np.ndarray], starts: np.ndarray, widths: np.ndarray) -> np.ndarray:
    """(M, 5) of intervals from starts (M,), widths (M,) long."""
    speeds = speed((starts[:, None] + widths[:, None] * NODES).reshape(-1)).reshape(-1, len(NODES))
    return widths[:, None] * (speeds @ INTEGRAL.T)


def _risen(rises: np.ndarray, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The polynomials without constant, coefficients (M, 5), and their slopes at x (M,)."""
    value, slope = np.zeros_like(x), np.zeros_like(x)
    for power in range(rises.shape[1] - 1, -1, -1):  # Horner's rule
        slope = slope * x + (power + 1) * rises[:, power]
        value = (value + rises[:, power]) * x
    return value, slope
