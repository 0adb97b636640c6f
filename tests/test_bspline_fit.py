"""Least squares: orthogonal to the basis, equal to a dense solution and to scipy's, refused where it is not settled."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.interpolate import BSpline, make_lsq_spline

from mocurve import Mismatch, bspline, bspline_fit
from mocurve.bspline_fit import least_squares, periodic_least_squares

SEEDS = st.integers(0, 10_000)


def case(degree: int, seed: int) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.random.Generator]:
    """Knots, times and samples (M, 3) on which every coefficient is settled."""
    rng = np.random.default_rng(seed)
    at = np.cumsum(rng.uniform(0.01, 0.02, rng.integers(40, 200)))
    breaks = np.concatenate([at[:1], np.sort(rng.uniform(at[0], at[-1], rng.integers(0, 12))), at[-1:]])
    knots = bspline_fit.settled(bspline.clamped(breaks, degree), degree, at)
    return knots, at, np.cumsum(rng.normal(size=(len(at), 3)), axis=0), rng


@given(st.integers(1, 5), SEEDS)
def test_what_is_left_over_is_orthogonal_to_every_basis_function(degree: int, seed: int) -> None:
    knots, at, samples, rng = case(degree, seed)
    weights = rng.uniform(0.5, 2.0, len(at))
    values = least_squares(knots, degree, at, samples, weights=weights)
    design = BSpline.design_matrix(at, knots, degree).toarray()
    left = samples - bspline.evaluate(knots, values, degree, at)
    np.testing.assert_allclose(design.T @ (weights[:, None] * left), 0.0, atol=1e-9 * np.abs(samples).max())


@given(st.integers(1, 5), SEEDS)
def test_it_equals_scipy(degree: int, seed: int) -> None:
    knots, at, samples, _ = case(degree, seed)
    values = least_squares(knots, degree, at, samples)
    peer = make_lsq_spline(at, samples, knots, degree)
    np.testing.assert_allclose(bspline.evaluate(knots, values, degree, at), peer(at), atol=1e-9)


def test_a_cubic_is_reproduced() -> None:
    at = np.linspace(0.0, 4.0, 200)
    samples = (at[:, None] - 1.0) ** 3 * [1.0, -2.0]
    knots = bspline.clamped(np.linspace(0.0, 4.0, 20))
    found = bspline.evaluate(knots, least_squares(knots, 3, at, samples), 3, at)
    np.testing.assert_allclose(found, samples, atol=1e-11)


@given(SEEDS, st.integers(0, 3), st.integers(0, 3))
def test_given_coefficients_stay_and_the_others_are_the_best_beside_them(seed: int, head: int, tail: int) -> None:
    knots, at, samples, rng = case(3, seed)
    count = len(knots) - 4
    first, last = rng.normal(size=(head, 3)), rng.normal(size=(tail, 3))
    values = least_squares(knots, 3, at, samples, first=first, last=last)
    assert values.shape == (count, 3)
    np.testing.assert_array_equal(values[:head], first[:count])
    if head + tail >= count:
        return
    np.testing.assert_array_equal(values[count - tail :], last)
    design = BSpline.design_matrix(at, knots, 3).toarray()
    free = slice(head, count - tail)
    rest = samples - design[:, :head] @ first - design[:, count - tail :] @ last
    dense = np.linalg.lstsq(design[:, free], rest, rcond=None)[0]
    np.testing.assert_allclose(design[:, free] @ values[free], design[:, free] @ dense, atol=1e-8)


@given(st.integers(1, 5), st.integers(0, 12), SEEDS)
def test_a_periodic_fit_closes_and_is_the_best_that_does(degree: int, more: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    spans = degree + 1 + more
    at = np.arange(12 * spans) / 30.0
    breaks = np.linspace(0.0, 12 * spans / 30.0, spans + 1)
    breaks[1:-1] += rng.uniform(-0.1, 0.1, spans - 1)
    knots = bspline.periodic(breaks, degree)
    samples = rng.normal(size=(len(at), 2))
    values = periodic_least_squares(knots, degree, at, samples)
    np.testing.assert_array_equal(values[-degree:], values[:degree])
    design = BSpline.design_matrix(at, knots, degree).toarray()
    folded = design[:, :spans].copy()
    folded[:, :degree] += design[:, spans:]
    dense = np.linalg.lstsq(folded, samples, rcond=None)[0]
    np.testing.assert_allclose(values[:spans], dense, atol=1e-8)


# -- Schoenberg and Whitney ------------------------------------------------------------------------
@given(st.integers(1, 5), SEEDS)
def test_samples_settle_all_coefficients_exactly_where_the_theorem_says(degree: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    count = degree + 1 + rng.integers(0, 5)
    breaks = np.concatenate([[0], np.sort(rng.choice(np.arange(1, 20), count - degree - 1, replace=False)), [20]])
    knots = bspline.clamped(breaks.astype(float), degree)
    at = np.sort(rng.choice(np.arange(0, 21), count + rng.integers(0, 4), replace=False)).astype(float)
    settled = not len(bspline_fit.unsettled(knots, degree, at))
    rank = np.linalg.matrix_rank(BSpline.design_matrix(at, knots, degree).toarray(), tol=1e-10)
    assert settled == (rank == count)


def test_a_gap_in_the_samples_is_told_with_its_place() -> None:
    at = np.concatenate([np.arange(30), np.arange(60, 90)]) / 30.0
    knots = bspline.clamped(np.linspace(0.0, at[-1], 25))
    with pytest.raises(Mismatch, match=r"too few samples from 0\.\d+ to 1\.\d+ s for the knots there"):
        least_squares(knots, 3, at, np.zeros((60, 1)))
    fewer = bspline_fit.settled(knots, 3, at)
    assert len(bspline_fit.unsettled(fewer, 3, at)) == 0
    assert 20 <= len(fewer) < len(knots)
    assert least_squares(fewer, 3, at, np.zeros((60, 1))).shape == (len(fewer) - 4, 1)


def test_fewer_samples_than_a_polynomial_takes_are_refused() -> None:
    knots = bspline.clamped(np.array([0.0, 0.5, 1.0]))
    with pytest.raises(Mismatch, match="takes 4 samples or more, not 3"):
        bspline_fit.settled(knots, 3, np.array([0.0, 0.5, 1.0]))


def test_a_periodic_fit_without_a_sample_in_a_span_is_refused() -> None:
    knots = bspline.periodic(np.arange(9.0))
    with pytest.raises(Mismatch, match="a sample in every span, and 8 in all"):
        periodic_least_squares(knots, 3, np.arange(7.0), np.zeros((7, 1)))


def test_a_closed_curve_that_its_samples_do_not_settle_is_refused() -> None:
    knots = bspline.periodic(np.arange(9.0), 2)  # an even number of spans: an alternating curve is 0 at all knots
    with pytest.raises(Mismatch, match="do not settle the coefficients of these periodic knots"):
        periodic_least_squares(knots, 2, np.arange(8.0), np.zeros((8, 1)))
