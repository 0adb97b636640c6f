"""B-spline curves as arrays: the basis is one, refinement changes nothing, keys go both ways."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.interpolate import BSpline

from mocurve import Mismatch, OptionError, bspline, hermite

DEGREES = st.integers(1, 5)
SEEDS = st.integers(0, 10_000)


def curve(degree: int, seed: int, closed: bool = False) -> tuple[np.ndarray, np.ndarray, np.random.Generator]:
    """Knots over 10 s, coefficients of two channels; clamped knots have some of them up to p times."""
    rng = np.random.default_rng(seed)
    breaks = np.concatenate([[0.0], np.sort(rng.uniform(0.5, 9.5, degree + rng.integers(1, 9))), [10.0]])
    if closed:
        knots = bspline.periodic(breaks, degree)
    else:
        knots = bspline.clamped(np.sort(np.append(breaks, [breaks[1]] * rng.integers(degree))), degree)
    values = rng.normal(size=(len(knots) - degree - 1, 2))
    if closed:
        values[-degree:] = values[:degree]
    return knots, values, rng


def boehm(knots: np.ndarray, values: np.ndarray, p: int, z: float) -> tuple[np.ndarray, np.ndarray]:
    """One knot inserted as Boehm 1980 has it: the oracle."""
    j = np.searchsorted(knots, z, "right") - 1
    new = np.empty((len(values) + 1, values.shape[1]))
    for i in range(len(new)):
        if i <= j - p:
            new[i] = values[i]
        elif i > j:
            new[i] = values[i - 1]
        else:
            part = (z - knots[i]) / (knots[i + p] - knots[i])
            new[i] = part * values[i] + (1 - part) * values[i - 1]
    return np.insert(knots, j + 1, z), new


# -- basis and values ------------------------------------------------------------------------------
@given(DEGREES, SEEDS, st.booleans())
def test_the_basis_is_one_and_nowhere_below_nothing(degree: int, seed: int, closed: bool) -> None:
    knots, values, rng = curve(degree, seed, closed)
    at = np.concatenate([rng.uniform(0, 10, 50), knots[(knots >= 0) & (knots <= 10)]])
    first, weights = bspline.basis(knots, degree, at)
    np.testing.assert_allclose(weights.sum(axis=1), 1.0, atol=1e-13)
    assert weights.min() >= -1e-15
    assert first.min() >= 0
    assert first.max() + degree < len(values)


@given(DEGREES, SEEDS, st.booleans())
def test_values_and_slopes_are_those_of_scipy(degree: int, seed: int, closed: bool) -> None:
    knots, values, rng = curve(degree, seed, closed)
    at = rng.uniform(0, 10, 60)
    truth = BSpline(knots, values, degree)
    np.testing.assert_allclose(bspline.evaluate(knots, values, degree, at), truth(at), atol=1e-12)
    if degree > 1:
        slope = bspline.derivative(knots, values, degree)
        scale = np.abs(slope[1]).max()
        np.testing.assert_allclose(
            bspline.evaluate(slope[0], slope[1], slope[2], at), truth(at, 1), atol=1e-12 * scale, rtol=1e-10
        )


@given(DEGREES, SEEDS)
def test_a_clamped_curve_ends_at_its_end_coefficients_and_stays_there(degree: int, seed: int) -> None:
    knots, values, _ = curve(degree, seed)
    found = bspline.evaluate(knots, values, degree, np.array([-7.0, 0.0, 10.0, 99.0]))
    np.testing.assert_array_equal(found, values[[0, 0, -1, -1]])


@given(DEGREES, SEEDS)
def test_coefficients_at_their_greville_places_make_a_straight_line(degree: int, seed: int) -> None:
    knots, _, rng = curve(degree, seed)
    at = rng.uniform(0, 10, 20)
    line = bspline.greville(knots, degree)[:, None] * 3.0 - 1.0
    np.testing.assert_allclose(bspline.evaluate(knots, line, degree, at)[:, 0], 3.0 * at - 1.0, atol=1e-12)


@given(st.integers(2, 5), SEEDS)
def test_a_periodic_curve_closes_with_its_slope(degree: int, seed: int) -> None:
    knots, values, _ = curve(degree, seed, closed=True)
    ends = np.array([0.0, 10.0])
    start, end = bspline.evaluate(knots, values, degree, ends)
    np.testing.assert_allclose(start, end, atol=1e-12)
    slope = bspline.derivative(knots, values, degree)
    start, end = bspline.evaluate(slope[0], slope[1], slope[2], ends)
    np.testing.assert_allclose(start, end, atol=1e-12 * np.abs(slope[1]).max())


# -- refinement ------------------------------------------------------------------------------------
@given(DEGREES, SEEDS, st.booleans())
def test_refinement_leaves_the_curve(degree: int, seed: int, closed: bool) -> None:
    knots, values, rng = curve(degree, seed, closed)
    at = np.linspace(0, 10, 333)
    new = np.append(rng.uniform(0.1, 9.9, 20), [5.0] * degree)
    finer, refined = bspline.insert(knots, values, degree, new)
    before = bspline.evaluate(knots, values, degree, at)
    np.testing.assert_allclose(bspline.evaluate(finer, refined, degree, at), before, atol=1e-12)
    np.testing.assert_array_equal(bspline.refine(finer, refined, degree, finer), refined)


@given(DEGREES, SEEDS)
def test_one_new_knot_is_that_of_boehm(degree: int, seed: int) -> None:
    knots, values, rng = curve(degree, seed)
    z = rng.uniform(0.1, 9.9)
    finer, refined = bspline.insert(knots, values, degree, np.array([z]))
    wanted = boehm(knots, values, degree, z)
    np.testing.assert_array_equal(finer, wanted[0])
    np.testing.assert_allclose(refined, wanted[1], atol=1e-12)


@given(DEGREES, SEEDS)
def test_as_many_knots_as_the_degree_pin_the_curve_to_a_coefficient(degree: int, seed: int) -> None:
    knots, values, _ = curve(degree, seed)
    finer, refined = bspline.insert(knots, values, degree, np.full(degree, 0.25))
    on_it = bspline.evaluate(knots, values, degree, np.array([0.25]))[0]
    assert np.abs(refined - on_it).sum(axis=1).min() < 1e-12
    np.testing.assert_array_equal(np.sort(finer), finer)


@given(SEEDS)
def test_nearly_equal_knots_do_no_harm(seed: int) -> None:
    knots, values, rng = curve(3, seed)
    z = rng.uniform(1, 9)
    finer, refined = bspline.insert(knots, values, 3, np.array([z, z + 1e-9, z + 1e-7]))
    at = np.linspace(0, 10, 200)
    before = bspline.evaluate(knots, values, 3, at)
    np.testing.assert_allclose(bspline.evaluate(finer, refined, 3, at), before, atol=1e-10)


@given(DEGREES, SEEDS, st.booleans())
def test_clamping_leaves_the_curve(degree: int, seed: int, closed: bool) -> None:
    knots, values, _ = curve(degree, seed, closed)
    at = np.linspace(0, 10, 200)
    clamped, moved = bspline.clamp(knots, values, degree)
    assert (clamped[: degree + 1] == 0).all()
    assert (clamped[-degree - 1 :] == 10).all()
    before = bspline.evaluate(knots, values, degree, at)
    np.testing.assert_allclose(bspline.evaluate(clamped, moved, degree, at), before, atol=1e-12)


@given(st.integers(1, 4), SEEDS, st.booleans())
def test_a_raised_degree_leaves_the_curve(degree: int, seed: int, closed: bool) -> None:
    knots, values, _ = curve(degree, seed, closed)
    at = np.linspace(0, 10, 200)
    higher, raised, now = bspline.raise_degree(knots, values, degree)
    assert now == degree + 1
    bspline.checked(higher, len(raised), now)
    before = bspline.evaluate(knots, values, degree, at)
    np.testing.assert_allclose(bspline.evaluate(higher, raised, now, at), before, atol=1e-12)


def test_a_union_has_every_knot_as_often_as_one_of_the_two() -> None:
    first, second = np.array([0, 0, 1, 1, 2, 4, 4.0]), np.array([0, 0, 1, 3, 3, 4, 4.0])
    np.testing.assert_array_equal(bspline.union(first, second), [0, 0, 1, 1, 2, 3, 3, 4, 4])
    np.testing.assert_array_equal(bspline.union(first, first), first)


def test_knots_within_rounding_become_one() -> None:
    onto = np.array([0.0, 0.1, 0.30000000000000004, 1.0])
    np.testing.assert_array_equal(bspline.snapped(np.array([0.0, 0.3, 0.31, 1.0]), onto), [0.0, onto[2], 0.31, 1.0])


# -- keys ------------------------------------------------------------------------------------------
@given(SEEDS, st.integers(2, 9), st.booleans())
def test_hermite_keys_are_a_spline_and_come_back(seed: int, count: int, broken: bool) -> None:
    rng = np.random.default_rng(seed)
    times = np.cumsum(rng.uniform(0.05, 1.0, count))
    values, slopes, arriving = rng.normal(size=(3, count))
    if not broken:
        arriving = slopes
    elif count > 3:
        arriving[1] = slopes[1]
    knots, handles = bspline.from_hermite(times, values, slopes, arriving)
    at = np.concatenate([rng.uniform(times[0], times[-1], 100), times])
    found = bspline.evaluate(knots, handles[:, None], 3, at)[:, 0]
    np.testing.assert_allclose(found, hermite.evaluate(times, values, slopes, at, arriving), atol=1e-12)
    back = bspline.to_hermite(knots, handles[:, None])
    np.testing.assert_array_equal(back[0], times)
    np.testing.assert_allclose(back[1][:, 0], values, atol=1e-12)
    np.testing.assert_allclose(back[2][:-1, 0], slopes[:-1], atol=1e-10)
    np.testing.assert_allclose(back[3][1:, 0], arriving[1:], atol=1e-10)


def test_nine_keys_are_eighteen_coefficients() -> None:
    times = np.arange(9.0)
    knots, handles = bspline.from_hermite(times, times**2, 2 * times)
    assert len(handles) == 18
    assert len(knots) == 22


# -- refusals --------------------------------------------------------------------------------------
@pytest.mark.parametrize(
    ("knots", "count", "degree", "message"),
    [
        ([0, 0, 1, 1], 2, 0, "a whole number from 1 to 5, not 0"),
        ([0, 0, 1, 1], 2, True, "not True"),
        ([0, 0, 1, 1], 2, 3, "4 coefficients or more, not 2"),
        ([0, 0, 1], 2, 1, "2 coefficients of degree 1 have 4 knots, not 3"),
        ([0, 0, 2, 1], 2, 1, "do not fall"),
        ([0, 0, np.nan, 1], 2, 1, "do not fall"),
        ([1, 1, 1, 1], 2, 1, "no time at all"),
        ([0, 0, 1, 1, 2, 2], 4, 1, "more than 1 knots of a spline of degree 1 lie at 1 s"),
    ],
)
def test_knots_that_are_none_are_refused(knots: list[float], count: int, degree: int, message: str) -> None:
    with pytest.raises((Mismatch, OptionError), match=message):
        bspline.checked(np.array(knots, float), count, degree)


def test_what_is_not_finer_is_refused() -> None:
    knots = bspline.clamped(np.array([0.0, 1.0, 2.0]))
    values = np.zeros((5, 1))
    with pytest.raises(Mismatch, match="the finer knots lack one at 1 s"):
        bspline.refine(knots, values, 3, bspline.clamped(np.array([0.0, 0.5, 2.0])))
    with pytest.raises(Mismatch, match="the domain of the old ones"):
        bspline.refine(knots, values, 3, np.append(knots, [3.0] * 4))
    with pytest.raises(Mismatch, match="inserted between 0 and 2 s"):
        bspline.insert(knots, values, 3, np.array([2.0]))
    with pytest.raises(Mismatch, match="3 spans or more, not 2"):
        bspline.periodic(np.array([0.0, 1.0, 2.0]))
