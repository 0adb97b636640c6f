"""Smoothing against second differences: straight lines stay, ends are held or free, weights count."""

from __future__ import annotations

import numpy as np
import pytest

from mocurve.whittaker import smoothed


@pytest.mark.parametrize("count", [1, 2, 3, 4, 50])
@pytest.mark.parametrize("held", [(False, False), (True, False), (False, True), (True, True)])
def test_it_is_the_least_squares_solution(count: int, held: tuple[bool, bool]) -> None:
    dice = np.random.default_rng(count)
    values, weights = dice.normal(0, 1, (count, 2)), dice.uniform(0.1, 2, count)
    padded = np.diff(np.eye(count + 4), 2, axis=0)[:, 2:-2]  # second differences with two zeros on both sides
    inner = padded[0 if held[0] else 2 : None if held[1] else count]
    dense = np.diag(weights) + 3.0**4 * inner.T @ inner
    np.testing.assert_allclose(smoothed(values, weights, 3.0, held), np.linalg.solve(dense, weights[:, None] * values))


def test_straight_lines_stay() -> None:
    line = np.linspace(3, 8, 200)[:, None]
    np.testing.assert_allclose(smoothed(line, np.full(200, 0.3), 20.0), line, atol=1e-9)


def test_a_wave_of_two_pi_widths_is_halved() -> None:
    wave = np.cos(np.arange(2001) / 15.0)[:, None]
    made = smoothed(wave, np.ones(2001), 15.0)
    assert made[1000, 0] / wave[1000, 0] == pytest.approx(0.5, abs=0.01)


def test_the_widest_is_a_straight_line_and_wider_is_as_wide() -> None:
    values = np.random.default_rng(3).normal(size=(419, 2))
    line = np.polynomial.polynomial.polyval(
        np.arange(419.0), np.polynomial.polynomial.polyfit(np.arange(419.0), values, 1)
    )
    for width in (2000.0, 1e6, 1e300):
        np.testing.assert_allclose(smoothed(values, np.ones(419), width), line.T, atol=1e-3)
