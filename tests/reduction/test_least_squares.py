"""Banded least squares: against dense least squares, and the laws of a refit with fixed key times."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from mocurve import hermite
from mocurve.reduction._least_squares import fit_slopes, refit

FRAMES = np.array([0, 20, 70, 71, 150, 300, 399])


def design(frames, count):
    """Matrix (F, 2K) from (value, slope) of every key to the curve at every frame, one unit key at a time."""
    at, columns = np.arange(count, dtype=float), []
    for k in range(2 * len(frames)):
        unit = np.zeros(2 * len(frames))
        unit[k] = 1.0
        columns.append(hermite.evaluate(frames.astype(float), unit[0::2], unit[1::2], at))
    return np.column_stack(columns)


def refitted(frames, middle, half, sweeps):
    """Values, slopes and largest error of a refit that holds no state."""
    states = np.full((len(frames), 2), np.nan)
    worst = refit(frames, states, False, False, middle, half, sweeps)
    return states[:, 0], states[:, 1], worst


@pytest.fixture
def band():
    rng = np.random.default_rng(1)
    y = 20 * np.sin(np.arange(400) * 0.03) + 0.1 * rng.normal(size=400)
    return y, 10 ** rng.uniform(-1, 1, 400)


def test_a_refit_is_the_weighted_least_squares_solution(band):
    y, half = band
    values, slopes, worst = refitted(FRAMES, y, half, 0)
    rows = design(FRAMES, 400) / half[:, None]
    dense = np.linalg.lstsq(rows, y / half, rcond=None)[0]
    np.testing.assert_allclose(values, dense[0::2], atol=2e-3)  # the pull towards the chords moves it this much
    np.testing.assert_allclose(slopes, dense[1::2], atol=2e-3)
    error = np.abs(hermite.evaluate(FRAMES.astype(float), values, slopes, np.arange(400.0)) - y)
    assert worst == pytest.approx((error / half).max())


def test_sweeps_never_make_the_largest_error_larger(band):
    y, half = band
    part = 0.5 * refitted(FRAMES, y, half, 0)[2]  # a band that the first solution leaves, and not by far
    worst = [refitted(FRAMES, y, part * half, sweeps)[2] for sweeps in range(6)]
    assert all(later <= earlier for earlier, later in pairwise(worst))
    assert worst[-1] < worst[0]


@pytest.mark.parametrize("offset", [0.0, 1e6])
def test_a_curve_made_of_the_same_keys_comes_back(offset):
    rng = np.random.default_rng(3)
    values, slopes = rng.normal(size=7) + offset, 0.1 * rng.normal(size=7)
    y = hermite.evaluate(FRAMES.astype(float), values, slopes, np.arange(400.0))
    found = refitted(FRAMES, y, np.full(400, 1e-3), 3)
    assert found[2] <= 1.0
    np.testing.assert_allclose(found[0], values, atol=1e-3)
    np.testing.assert_allclose(found[1], slopes, atol=1e-3)


def test_held_states_stay_and_the_rest_makes_up_for_them(band):
    y, half = band
    states = np.zeros((len(FRAMES), 2))
    states[0], states[-1] = (y[0] + 1.0, 0.5), (y[-1] - 1.0, -0.5)
    refit(FRAMES, states, True, True, y, 5 * half, 0)
    assert tuple(states[0]) == pytest.approx((y[0] + 1.0, 0.5))
    assert tuple(states[-1]) == pytest.approx((y[-1] - 1.0, -0.5))
    rows, target = design(FRAMES, 400) / half[:, None], y / half
    held = [0, 1, 2 * len(FRAMES) - 2, 2 * len(FRAMES) - 1]
    free = np.setdiff1d(np.arange(2 * len(FRAMES)), held)
    flat = states.reshape(-1)
    dense = np.linalg.lstsq(rows[:, free], target - rows[:, held] @ flat[held], rcond=None)[0]
    np.testing.assert_allclose(flat[free], dense, atol=5e-3)


def test_fitted_slopes_are_the_least_squares_ones_with_values_held(band):
    y, weights = band
    slopes = fit_slopes(FRAMES, y[FRAMES], y, weights)
    rows, root = design(FRAMES, 400), np.sqrt(weights)
    dense = np.linalg.lstsq(rows[:, 1::2] * root[:, None], (y - rows[:, 0::2] @ y[FRAMES]) * root, rcond=None)[0]
    np.testing.assert_allclose(slopes, dense, atol=1e-3)


def test_keys_on_all_frames_take_the_slopes_of_the_chords():
    y = np.array([1.0, 3.0, 2.0])
    first, middle, last = fit_slopes(np.array([0, 1, 2]), y, y, np.ones(3))
    assert (first, last) == pytest.approx((2.0, -1.0))
    assert -1.0 < middle < 2.0


def test_a_single_key_lies_still():
    y = np.array([1.0])
    np.testing.assert_array_equal(fit_slopes(np.array([0]), y[:1], y[:1], np.ones(1)), [0.0])
    values, slopes, worst = refitted(np.array([0]), y[:1], np.ones(1), 2)
    assert (values, slopes, worst) == (1.0, 0.0, 0.0)
