"""Least-squares B-splines: normal equations in a band, one Cholesky factorisation for all channels.

Sudarsky and House 1998, section 3; de Boor 1978, chapter XIV.
"""

from __future__ import annotations

import numpy as np

from . import bspline
from ._jit import kernel
from .errors import Mismatch


def least_squares(
    knots: np.ndarray,
    degree: int,
    at: np.ndarray,
    samples: np.ndarray,
    *,
    weights: np.ndarray | None = None,
    first: np.ndarray | None = None,
    last: np.ndarray | None = None,
) -> np.ndarray:
    """Coefficients (N, C) with the least weighted sum of squares at the times `at` (M,), rising, of samples (M, C).

    weights: (M,) of the squares, above 0; None: all 1. first, last: (n, C) coefficients that are given: with clamped
    knots the first and the last one are the values at the ends. Mismatch where the samples do not settle every
    coefficient (Schoenberg and Whitney).
    """
    short = unsettled(knots, degree, at)
    if len(short):
        raise Mismatch(
            f"too few samples from {knots[short[0]]:g} to {knots[short[0] + degree + 1]:g} s for the knots there"
        )
    band, right = _normal_equations(knots, degree, at, samples, weights)
    count = right.shape[0]
    head = np.zeros((0, right.shape[1])) if first is None else np.asarray(first, np.float64)
    tail = np.zeros((0, right.shape[1])) if last is None else np.asarray(last, np.float64)
    a, b = len(head), count - len(tail)
    if a >= b:
        return np.concatenate([head, tail])[:count]
    for d in range(1, degree + 1):  # band[d, i] couples i and i + d
        for i in range(max(a - d, 0), min(a, count - d)):
            right[i + d] -= band[d, i] * head[i]
        for i in range(max(b - d, 0), min(b, count - d)):
            right[i] -= band[d, i] * tail[i + d - b]
    return np.asfortranarray(np.concatenate([head, _solved(band[:, a:b], right[a:b]), tail]))


def periodic_least_squares(knots: np.ndarray, degree: int, at: np.ndarray, samples: np.ndarray) -> np.ndarray:
    """Coefficients (N, C) on periodic knots, the last p of them the first p, so that the curve closes exactly.

    The samples are those of one period. The band is closed by a border of p unknowns, taken out by their Schur
    complement.
    """
    count = len(knots) - degree - 1
    unknowns = count - degree
    at = np.asarray(at, np.float64)
    held = np.searchsorted(at, knots[degree + 1 : count + 1]) - np.searchsorted(at, knots[degree:count])
    if len(at) < unknowns or (held == 0).any():  # no theorem says less for curves that close
        raise Mismatch(f"a periodic spline takes a sample in every span, and {unknowns} in all")
    band, right = _normal_equations(knots, degree, at, samples, None)
    if unknowns <= 2 * degree:  # the band meets itself: a small full matrix
        full = np.zeros((unknowns, unknowns))
        for d in range(degree + 1):
            for i in range(count - d):
                full[i % unknowns, (i + d) % unknowns] += band[d, i]
                if d:
                    full[(i + d) % unknowns, i % unknowns] += band[d, i]
        right[:degree] += right[unknowns:]
        closed = _solved_full(full, right[:unknowns])
        return np.asfortranarray(np.concatenate([closed, closed[:degree]]))
    return _bordered(band, right, degree)


def unsettled(knots: np.ndarray, degree: int, at: np.ndarray) -> np.ndarray:
    """Basis functions, by number, that have no sample of their own at the times `at` (M,), rising: none may be left.

    Schoenberg and Whitney: samples u[0] < u[1] < ..., one for each function i, with knots[i] < u[i] < knots[i + p + 1].
    """
    count = len(knots) - degree - 1
    at = np.asarray(at, np.float64)
    low, high = knots[:count], knots[degree + 1 :]
    least = np.searchsorted(at, low, "right")
    most = np.searchsorted(at, high, "left")
    start, end = knots[degree], knots[count]
    clamp = low == knots[degree : degree + count]  # a function that is 1 where it begins
    least = np.where(clamp & (low <= start), np.searchsorted(at, low, "left"), least)
    clamp = knots[1 : count + 1] == high
    most = np.where(clamp & (high >= end), np.searchsorted(at, high, "right"), most)
    numbers = np.arange(count)
    taken = np.maximum.accumulate(least - numbers) + numbers  # the sample of each: the first one still free
    return numbers[taken >= most]


def settled(knots: np.ndarray, degree: int, at: np.ndarray) -> np.ndarray:
    """Clamped knots, without as many of the inner ones as leave a coefficient that the times `at` (M,) do not settle.

    Mismatch where there are fewer times than coefficients without any inner knot.
    """
    while True:
        short = unsettled(knots, degree, at)
        if not len(short):
            return knots
        if len(knots) == 2 * degree + 2:
            raise Mismatch(f"a curve of degree {degree} takes {degree + 1} samples or more, not {len(at)}")
        inner = np.clip(short[0] + (degree + 1) // 2, degree + 1, len(knots) - degree - 2)
        knots = np.delete(knots, inner)


# -- in call order ---------------------------------------------------------------------------------


def _normal_equations(
    knots: np.ndarray, degree: int, at: np.ndarray, samples: np.ndarray, weights: np.ndarray | None
) -> tuple[np.ndarray, np.ndarray]:
    """The diagonals (p + 1, N) of B'WB, the main one first, and B'WY (N, C)."""
    start, values = bspline.basis(knots, degree, at)
    weighted = values if weights is None else values * np.asarray(weights, np.float64)[:, None]
    count = len(knots) - degree - 1
    band = np.zeros((degree + 1, count))
    for d in range(degree + 1):
        for j in range(degree + 1 - d):
            band[d] += np.bincount(start + j, weighted[:, j] * values[:, j + d], minlength=count)
    rows = np.ascontiguousarray(np.asarray(samples, np.float64).T)
    right = np.zeros((len(rows), count))
    project(start, np.ascontiguousarray(weighted), rows, right)
    return band, np.asfortranarray(right.T)


@kernel
def project(start: np.ndarray, weighted: np.ndarray, rows: np.ndarray, right: np.ndarray) -> None:
    """Add to right (C, N) what every sample of rows (C, M) gives the basis functions from start (M,) on."""
    samples, width = weighted.shape
    for c in range(rows.shape[0]):
        for m in range(samples):
            value, i = rows[c, m], start[m]
            for j in range(width):
                right[c, i + j] += weighted[m, j] * value


def _solved(band: np.ndarray, right: np.ndarray) -> np.ndarray:
    """Solve the symmetric system with these diagonals (p + 1, n) for right sides (n, C)."""
    from scipy.linalg import LinAlgError, solveh_banded  # a tenth of a second, for who fits

    band = band[: len(right)]  # no more diagonals than rows
    try:
        return np.asarray(solveh_banded(band, right, lower=True, check_finite=False))
    except LinAlgError as error:
        raise Mismatch("the samples do not settle the coefficients of these knots: take fewer knots") from error


def _bordered(band: np.ndarray, right: np.ndarray, degree: int) -> np.ndarray:
    """Coefficients (N, C) of the system (p + 1, N) folded onto itself by p: the last p unknowns are the border."""
    count, p = band.shape[1], degree
    unknowns = count - p
    inner = unknowns - p  # rows whose band meets no border are coupled in the band alone
    folded = right[:unknowns].copy()
    folded[:p] += right[unknowns:]
    main = band[:, :inner].copy()
    across, corner = np.zeros((inner, p)), np.zeros((p, p))
    for d in range(p + 1):
        for i in range(count - d):
            a, b = i % unknowns, (i + d) % unknowns
            if i + d < inner:
                continue  # in the band already
            if a < inner and b < inner:  # both past the seam: the first ones again
                main[d, a] += band[d, i]
            elif a >= inner and b >= inner:
                corner[a - inner, b - inner] += band[d, i]
                if d:
                    corner[b - inner, a - inner] += band[d, i]
            elif a < inner:
                across[a, b - inner] += band[d, i]
            else:
                across[b, a - inner] += band[d, i]
    solved = _solved(main, np.concatenate([folded[:inner], across], axis=1))
    channels = folded.shape[1]
    free, through = solved[:, :channels], solved[:, channels:]
    border = _solved_full(corner - across.T @ through, folded[inner:] - across.T @ free)
    closed = np.concatenate([free - through @ border, border])
    return np.asfortranarray(np.concatenate([closed, closed[:p]]))


def _solved_full(matrix: np.ndarray, right: np.ndarray) -> np.ndarray:
    """Solve a small symmetric system; Mismatch where it is singular, as a closed curve can be with a sample a span."""
    if not np.linalg.cond(matrix) < 1e12:
        raise Mismatch("the samples do not settle the coefficients of these periodic knots: take fewer knots")
    return np.linalg.solve(matrix, right)
