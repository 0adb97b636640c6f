"""The kernels against dense matrices of NumPy."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mocurve.denoising import _mixture, _smoother
from mocurve.denoising.smoothing import GRID


def system(w: np.ndarray, smoothing: float) -> np.ndarray:
    """W + lambda D'D."""
    n = len(w)
    third = np.diff(np.eye(n), 3, axis=0) if n > 3 else np.zeros((0, n))
    return np.diag(w) + smoothing * third.T @ third


def solved(y: np.ndarray, w: np.ndarray, smoothing: float) -> tuple[np.ndarray, np.ndarray]:
    """Fit and diagonal of the inverse by the kernels."""
    x, diagonal = np.empty((2, 1, len(y)))
    _mixture.fit(y[None], w[None], np.array([smoothing]), x, diagonal)
    return x[0], diagonal[0]


@st.composite
def channels(draw: st.DrawFn, longest: int = 40) -> tuple[np.ndarray, np.ndarray]:
    """Values (n,) and weights (n,) of which some are 0, but at least every fourth is not."""
    n = draw(st.integers(1, longest))
    rng = np.random.default_rng(draw(st.integers(0, 2**32)))
    w = (rng.random(n) > draw(st.sampled_from([0.0, 0.3, 0.9]))).astype(float)
    w[::4] = w[-2:] = 1.0
    return rng.normal(0, 50, n), w


@settings(max_examples=60)
@given(channels(), st.floats(-8, 7))
def test_a_fit_and_its_variance_are_those_of_the_dense_system(channel: tuple, log_smoothing: float) -> None:
    y, w = channel
    matrix = system(w, np.exp(log_smoothing))
    if len(y) <= 3:
        matrix, w = np.eye(len(y)), np.ones(len(y))
    x, diagonal = solved(y, w, np.exp(log_smoothing))
    np.testing.assert_allclose(x, np.linalg.solve(matrix, w * y), rtol=1e-6, atol=1e-6)
    np.testing.assert_allclose(diagonal, np.diag(np.linalg.inv(matrix)), rtol=1e-6)


@pytest.mark.parametrize("n", [1, 2, 3, 4, 5, 6, 7, 12])
def test_a_row_of_the_penalty_is_that_of_third_differences(n: int) -> None:
    dense = system(np.zeros(n), 1.0)
    for i in range(n):
        rows = [dense[i, i - k] if i >= k else 0.0 for k in range(4)]
        assert list(_smoother.penalty(i, n)) == rows


@pytest.mark.parametrize("smoothing", GRID[::5])
def test_a_parabola_stays_at_any_strength(smoothing: float) -> None:
    t = np.linspace(-1, 1, 300)
    y = 12 - 30 * t + 70 * t**2
    np.testing.assert_allclose(solved(y, np.ones(300), smoothing)[0], y, atol=1e-5)


def test_a_strong_fit_is_the_least_squares_parabola() -> None:
    y = np.random.default_rng(0).normal(size=60)
    t = np.arange(60)
    x, diagonal = solved(y, np.ones(60), 1e9)
    np.testing.assert_allclose(x, np.polyval(np.polyfit(t, y, 2), t), atol=2e-3)
    assert diagonal.sum() == pytest.approx(3.0, abs=1e-3)


def test_frames_of_weight_0_do_not_matter() -> None:
    rng = np.random.default_rng(0)
    y, w = rng.normal(size=80), np.ones(80)
    w[20:32] = w[:3] = w[-5:] = 0.0
    np.testing.assert_array_equal(solved(y, w, 10.0)[0], solved(np.where(w == 0, 1e6, y), w, 10.0)[0])


def test_a_gap_is_filled_by_the_polynomial_of_degree_5_that_bends_least() -> None:
    """At next to no strength a gap's fit has vanishing sixth differences in it and goes through all else."""
    t = np.arange(60.0)
    y, w = np.sin(t / 7), np.ones(60)
    w[30:36] = 0.0
    x = solved(y, w, 1e-6)[0]
    np.testing.assert_allclose(x[w == 1], y[w == 1], atol=1e-6)
    np.testing.assert_allclose(np.diff(x, 6)[30 - 3 : 36 - 3], 0.0, atol=1e-8)


def test_scores_are_residuals_and_traces_of_the_dense_smoother() -> None:
    rng = np.random.default_rng(2)
    y, w = rng.normal(size=(3, 50)), np.ones((3, 50))
    w[1, 10:17] = 0.0
    grid, wanted = np.exp([-3.0, 0.0, 4.0]), np.ones((3, 3), bool)
    wanted[2, 1] = False
    squares, traces = np.full((2, 3, 3), -7.0)
    _mixture.scores(y, w, (w == 0).any(1), grid, wanted, squares, traces)
    for c in range(3):
        for g, smoothing in enumerate(grid):
            if not wanted[c, g]:
                assert squares[c, g] == traces[c, g] == -7.0
                continue
            hat = np.linalg.inv(system(w[c], smoothing)) @ np.diag(w[c])
            assert squares[c, g] == pytest.approx((w[c] * (y[c] - hat @ y[c]) ** 2).sum())
            assert traces[c, g] == pytest.approx(np.trace(hat))


@given(st.integers(1, 40), st.integers(1, 50))
def test_a_box_is_the_mean_of_the_frames_in_reach(n: int, reach: int) -> None:
    a, out = np.random.default_rng(n).normal(size=n), np.empty(n)
    _mixture.box(a, reach, out)
    np.testing.assert_allclose(out, [a[max(0, i - reach) : i + reach + 1].mean() for i in range(n)], atol=1e-12)


def mixed_by_numpy(y: np.ndarray, w: np.ndarray, sigma: float, centre: float, reach: int) -> np.ndarray:
    """The mixture of a channel (n,) from its formula: weights by Stein's risk over a box and a half."""

    def boxed(a: np.ndarray, wide: int) -> np.ndarray:
        return np.array([a[max(0, i - wide) : i + wide + 1].mean() for i in range(len(a))])

    near = [g for g in range(4, len(GRID)) if -6.0 <= g - centre <= 3.0]
    fits, told = [], []
    for g in near:
        x, freedom = solved(y, w, GRID[g])
        risk = w * ((y - x) ** 2 + (2 * freedom - 1) * sigma**2)
        risk = boxed(boxed(risk, reach), reach // 2)
        fits.append(x)
        told.append(-risk * (2 * reach + 1) / (2.0 * sigma**2) - 1.0 * abs(g - centre))
    weights = np.exp(np.array(told) - np.max(told, axis=0))
    return (weights * fits).sum(0) / weights.sum(0)


def test_a_mixture_is_weighted_by_the_risk_around_a_frame() -> None:
    rng = np.random.default_rng(5)
    y, w = np.cumsum(rng.normal(size=(2, 120)), axis=1), np.ones((2, 120))
    w[1, 60:66] = 0.0
    x, centre, sigma = np.empty_like(y), np.array([8.3, 9.0]), np.array([0.8, 0.5])
    _mixture.mix(y, w, (w == 0).any(1), GRID, 4, centre, 6.0, 3.0, sigma, 10, 2.0, 1.0, x)
    for c in range(2):
        np.testing.assert_allclose(x[c], mixed_by_numpy(y[c], w[c], sigma[c], centre[c], 10), atol=1e-9)


@pytest.mark.parametrize("count", [1, 7, 8, 9, 20])
def test_channels_side_by_side_are_fitted_as_if_alone(count: int) -> None:
    rng = np.random.default_rng(count)
    y, w = rng.normal(size=(count, 30)), (rng.random((count, 30)) > 0.2).astype(float)
    smoothing = np.exp(rng.uniform(-3, 3, count))
    x, diagonal = np.empty_like(y), np.empty_like(y)
    _mixture.fit(y, w, smoothing, x, diagonal)
    for c in range(count):
        alone = solved(y[c], w[c], smoothing[c])
        np.testing.assert_array_equal((x[c], diagonal[c]), alone)


def test_a_mixture_lies_between_the_fits_that_it_mixes() -> None:
    rng = np.random.default_rng(3)
    y, w = np.cumsum(rng.normal(size=(4, 90)), axis=1), np.ones((4, 90))
    w[2, 40:50] = 0.0
    x, softest, centre = np.empty_like(y), 4, np.array([9.0, 9.5, 12.0, 3.0])
    gaps = (w == 0).any(1)
    _mixture.mix(y, w, gaps, GRID, softest, centre, 6.0, 3.0, np.ones(4), 10, 2.0, 1.0, x)
    for c in range(4):
        mixed = [g for g in range(softest, len(GRID)) if -6.0 <= g - centre[c] <= 3.0]
        fits = np.stack([solved(y[c], w[c], GRID[g])[0] for g in mixed])
        assert (x[c] >= fits.min(0) - 1e-9).all()
        assert (x[c] <= fits.max(0) + 1e-9).all()
        assert np.abs(x[c] - fits[0]).max() > 1e-3


def test_a_channel_is_mixed_as_if_it_were_alone() -> None:
    rng = np.random.default_rng(4)
    y, w = rng.normal(size=(3, 70)), np.ones((3, 70))
    w[1, 20:25] = 0.0

    def mixed(some: slice) -> np.ndarray:
        x = np.empty_like(y[some])
        rest = (6.0, 3.0, np.ones(3)[some], 10, 2.0, 1.0)
        _mixture.mix(y[some], w[some], (w[some] == 0).any(1), GRID, 3, np.array([8.0, 9.0, 11.0])[some], *rest, x)
        return x

    np.testing.assert_array_equal(mixed(slice(None)), np.concatenate([mixed(slice(c, c + 1)) for c in range(3)]))


def test_many_channels_with_gaps_of_their_own_are_scored_as_if_alone() -> None:
    rng = np.random.default_rng(6)
    y, w = rng.normal(size=(20, 40)), (rng.random((20, 40)) > 0.2).astype(float)
    told = np.empty((2, 20, 2))
    grid, wanted = np.array([1.0, 50.0]), np.ones((20, 2), bool)
    _mixture.scores(y, w, np.ones(20, bool), grid, wanted, told[0], told[1])
    for c in range(20):
        alone, one = np.empty((2, 1, 2)), slice(c, c + 1)
        _mixture.scores(y[one], w[one], np.ones(1, bool), grid, wanted[one], alone[0], alone[1])
        np.testing.assert_array_equal(told[:, one], alone)
