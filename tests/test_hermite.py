"""Hermite curves: the thesis' matrix form, the Bézier form there and back, subdivision."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mocurve import HermiteCurve, Mismatch, hermite

# Önder 2007, section 3.1: v(s) = [s³ s² s 1] M [p0 p1 r0 r1]
THESIS = np.array([[2, -2, 1, 1], [-3, 3, -2, -1], [0, 0, 1, 0], [1, 0, 0, 0]])
number = st.floats(-1000, 1000)


@st.composite
def curves(draw: st.DrawFn, least: int = 2, broken: bool = False) -> tuple[np.ndarray, ...]:
    """times, values, slopes and, if broken, in_slopes; the gaps between keys differ by up to a factor of 10,000."""
    count = draw(st.integers(least, 6))
    gaps = [draw(st.sampled_from([1 / 120, 1 / 30, 0.1, 1.0, 80.0])) for _ in range(count)]
    rows = [np.array([draw(number) for _ in range(count)]) for _ in range(3 if broken else 2)]
    return draw(st.floats(-10, 10)) + np.cumsum(gaps), *rows


def digits(times: np.ndarray) -> float:
    """How well a place between keys is known, in parts of the curve's size: as well as the time differences are."""
    return 1e-12 + 2e-15 * float(np.abs(times).max() / np.diff(times).min())


def inside(times: np.ndarray) -> np.ndarray:
    return np.concatenate([np.linspace(a, b, 9) for a, b in pairwise(times)])


@given(curves(broken=True))
def test_a_curve_is_the_thesis_matrix_form(curve: tuple[np.ndarray, ...]) -> None:
    times, values, slopes, in_slopes = curve
    scale = np.abs(values).max() + np.abs(curve[2:]).max() * np.ptp(times)
    for i in range(len(times) - 1):
        h = times[i + 1] - times[i]
        s = np.linspace(0.0, 1.0, 11)
        tangents = h * slopes[i], h * in_slopes[i + 1]
        expected = np.stack([s**3, s**2, s, s**0], axis=1) @ THESIS @ [values[i], values[i + 1], *tangents]
        found = hermite.evaluate(times, values, slopes, times[i] + s * h, in_slopes)
        leaves = s < 1 if i + 2 < len(times) else slice(None)  # a segment's end belongs to the next one
        np.testing.assert_allclose(found[leaves], expected[leaves], rtol=0, atol=digits(times) * scale)


@given(curves(least=1, broken=True))
def test_a_curve_goes_exactly_through_its_keys_and_is_constant_outside(curve: tuple[np.ndarray, ...]) -> None:
    times, values, slopes, in_slopes = curve
    np.testing.assert_array_equal(hermite.evaluate(times, values, slopes, times, in_slopes), values)
    outside = hermite.evaluate(times, values, slopes, np.array([times[0] - 1e9, times[0] - 1e-9, times[-1] + 5]))
    np.testing.assert_array_equal(outside, values[[0, 0, -1]])


@given(curves())
def test_the_slope_at_a_key_is_the_slope_that_the_key_says(curve: tuple[np.ndarray, ...]) -> None:
    times, values, slopes = curve
    h = np.diff(times).min()
    step = 1e-4 * h
    before, after = (hermite.evaluate(times, values, slopes, times + d) for d in (-step, step))
    bend = np.abs(values).max() / h + np.abs(slopes).max()  # a cubic bends no more than some times this / h
    np.testing.assert_allclose(((after - before) / (2 * step))[1:-1], slopes[1:-1], rtol=0, atol=2e-3 * bend)


@given(st.tuples(*[number] * 4), st.floats(0.1, 10))
def test_every_cubic_is_such_a_curve(cubic: tuple[float, ...], h: float) -> None:
    polynomial = np.polynomial.Polynomial(cubic)
    times = np.array([0.0, 0.3, 1.0]) * h
    found = hermite.evaluate(times, polynomial(times), polynomial.deriv()(times), inside(times))
    np.testing.assert_allclose(found, polynomial(inside(times)), rtol=0, atol=1e-12 * max(np.abs(cubic)) * max(1, h**3))


def test_times_may_come_in_any_order_and_number() -> None:
    curve = HermiteCurve([0.0, 1.0, 3.0], [0.0, 2.0, 6.0], [2.0, 2.0, 2.0])
    np.testing.assert_allclose(curve.at(np.array([2.5, 0.25, 99.0, -1.0])), [5.0, 0.5, 6.0, 0.0])
    assert curve.at(np.empty(0)).shape == (0,)


def test_a_curve_without_keys_has_no_values() -> None:
    nothing = np.empty(0)
    assert hermite.evaluate(nothing, nothing, nothing, nothing).shape == (0,)
    with pytest.raises(Mismatch, match="a curve without keys has no values"):
        hermite.evaluate(nothing, nothing, nothing, np.zeros(1))


# -- Bézier form -------------------------------------------------------------------------------------
@given(curves(broken=True))
def test_a_curve_comes_back_from_its_bezier_form(curve: tuple[np.ndarray, ...]) -> None:
    times, values, slopes, in_slopes = curve
    back = hermite.from_bezier(hermite.to_bezier(times, values, slopes, in_slopes))
    np.testing.assert_array_equal(back[0], times)
    np.testing.assert_array_equal(back[1], values)
    rounding = 1e-13 * (np.abs(values).max() + np.abs(times).max() * np.abs(curve[2:]).max()) / np.diff(times).min()
    np.testing.assert_allclose(back[2][:-1], slopes[:-1], rtol=1e-9, atol=rounding)
    arriving = back[2] if back[3] is None else back[3]
    np.testing.assert_allclose(arriving[1:], in_slopes[1:], rtol=1e-9, atol=rounding)


@given(curves())
def test_tangents_that_were_whole_do_not_break_by_rounding(curve: tuple[np.ndarray, ...]) -> None:
    times, values, slopes = curve
    assert hermite.from_bezier(hermite.to_bezier(times, values, slopes))[3] is None
    points = hermite.to_bezier(times, values, slopes)
    again = hermite.to_bezier(*hermite.from_bezier(points)[:3])
    np.testing.assert_allclose(again, points, rtol=0, atol=1e-12 * np.abs(points).max())


def test_a_broken_tangent_stays_broken() -> None:
    points = hermite.to_bezier(np.arange(3.0), np.zeros(3), np.array([0.0, 1.0, 0.0]), np.array([0.0, -1.0, 0.0]))
    _, _, slopes, in_slopes = hermite.from_bezier(points)
    assert in_slopes is not None
    np.testing.assert_allclose([slopes[1], in_slopes[1]], [1.0, -1.0])


@given(curves(broken=True), st.floats(0, 1))
def test_subdividing_the_bezier_form_evaluates_the_curve(curve: tuple[np.ndarray, ...], s: float) -> None:
    times, values, slopes, in_slopes = curve
    points = hermite.to_bezier(times, values, slopes, in_slopes)
    left, right = hermite.subdivide(points, s)
    np.testing.assert_array_equal(left[:, 3], right[:, 0])
    cut = times[:-1] + s * np.diff(times)
    scale = np.abs(points).max() + np.abs(curve[2:]).max() * np.ptp(times)
    np.testing.assert_allclose(left[:, 3, 0], cut, rtol=0, atol=1e-12 * np.abs(points).max())
    if s < 1:
        expected = hermite.evaluate(times, values, slopes, cut, in_slopes)
        np.testing.assert_allclose(left[:, 3, 1], expected, rtol=0, atol=digits(times) * scale)


@given(curves(), st.floats(0.05, 0.95))
def test_both_halves_are_the_same_curve(curve: tuple[np.ndarray, ...], s: float) -> None:
    times, values, slopes = (row[:2] for row in curve)
    left, right = hermite.subdivide(hermite.to_bezier(times, values, slopes), s)
    cut_times, cut_values, cut_slopes, _ = hermite.from_bezier(np.concatenate([left, right]))
    at = np.linspace(times[0], times[1], 21)
    scale = np.abs(values).max() + np.abs(slopes).max() * np.ptp(times)
    found = hermite.evaluate(cut_times, cut_values, cut_slopes, at)
    np.testing.assert_allclose(found, hermite.evaluate(times, values, slopes, at), rtol=0, atol=1e-9 * scale)


def test_segments_may_be_cut_each_at_its_own_place() -> None:
    points = hermite.to_bezier(np.arange(3.0), np.array([0.0, 1.0, 0.0]), np.zeros(3))
    left, right = hermite.subdivide(points, np.array([0.0, 1.0]))
    np.testing.assert_array_equal(left[1], points[1])
    np.testing.assert_array_equal(right[0], points[0])
    many, _ = hermite.subdivide(points[0], np.linspace(0, 1, 5))
    assert many.shape == (5, 4, 2)


@pytest.mark.parametrize(
    ("spoil", "message"),
    [
        (lambda p: p[:, :2], r"shape \(segments, 4, 2\).*not \(2, 2, 2\)"),
        (lambda p: p[:0], "at least one"),
        (lambda p: p + np.array([0.0, 1.0])[:, None, None] * [0.0, 1.0], "segment 0 does not end where the next"),
        (lambda p: p * [-1.0, 1.0], "segment 0 does not go forward in time"),
        (lambda p: p + np.array([0, 0, 0.1, 0])[:, None] * [1.0, 0.0], "segment 0 has a handle that is not at a third"),
    ],
)
def test_a_bezier_form_without_hermite_keys_is_refused(spoil: object, message: str) -> None:
    points = hermite.to_bezier(np.arange(3.0), np.array([0.0, 1.0, 0.0]), np.zeros(3))
    with pytest.raises(Mismatch, match=message):
        hermite.from_bezier(spoil(points))  # type: ignore[operator]
