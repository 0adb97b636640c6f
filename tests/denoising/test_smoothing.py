"""The strength that cross-validation finds."""

from __future__ import annotations

import numpy as np
import pytest
from gestures import jitter, kick, rmse, swing

from mocurve.denoising import smoothing
from mocurve.denoising.smoothing import GRID, SOFTEST, Strength, cutoff, place_of

FPS = 120.0


def chosen(y: np.ndarray, w: np.ndarray | None = None, **options) -> Strength:
    """y (C, n)"""
    w = np.ones_like(y) if w is None else w
    return smoothing.strength(y, w, options.pop("pools", []), **options)


@pytest.mark.parametrize("sigma", [0.1, 0.5, 2.0])
def test_the_noise_of_a_moving_channel_is_told_within_a_tenth(sigma: float) -> None:
    y = jitter(swing(900, FPS, 6), sigma).T
    np.testing.assert_allclose(chosen(y).sigma, sigma, rtol=0.1)


def test_white_noise_is_smoothed_more_than_motion_and_keeps_next_to_no_freedom() -> None:
    rng = np.random.default_rng(1)
    still, moving = rng.normal(size=(8, 600)), jitter(swing(600, FPS, 8), 1.0).T
    assert chosen(still).place.min() > chosen(moving).place.max()
    assert chosen(still).free.min() > 0.97


def test_motion_without_noise_is_hardly_smoothed() -> None:
    y = swing(400, FPS, 4).T
    at = chosen(y)
    assert at.sigma.max() < 1e-3
    assert rmse(smoothing.fit(y, np.ones_like(y), at)[0], y) < 1e-3


def test_the_choice_is_near_the_best_that_the_truth_would_choose() -> None:
    truth = swing(800, FPS, 6).T
    y = jitter(truth, 0.5, 3)
    w, at = np.ones_like(y), chosen(y)
    errors = []
    for place in range(SOFTEST, len(GRID)):
        every = at._replace(place=np.full(len(y), float(place)))
        errors.append(((smoothing.fit(y, w, every)[0] - truth) ** 2).mean(1))
    mine = ((smoothing.fit(y, w, at)[0] - truth) ** 2).mean(1)
    assert (mine < 1.3 * np.min(errors, axis=0)).all()


@pytest.mark.parametrize("times", [1e-3, 7.0, 1e6])
def test_the_choice_does_not_depend_on_the_unit(times: float) -> None:
    y = jitter(swing(300, FPS, 5), 0.5).T
    pools = [np.arange(5)]
    one, other = chosen(y, pools=pools), chosen(times * y, pools=pools)
    np.testing.assert_allclose(other.place, one.place, atol=1e-4)
    np.testing.assert_allclose(other.sigma, times * one.sigma, rtol=1e-4)


def test_time_may_run_backwards() -> None:
    y = jitter(swing(300, FPS, 5), 0.5).T
    one, other = chosen(y), chosen(np.ascontiguousarray(y[:, ::-1]))
    np.testing.assert_allclose(other.place, one.place, atol=1e-6)


def test_channels_are_judged_alone_without_a_pool() -> None:
    y = jitter(swing(300, FPS, 5), 0.5).T
    for c in range(5):
        for mine, alone in zip(chosen(y), chosen(y[c : c + 1]), strict=True):
            np.testing.assert_array_equal(mine[c], alone[0])


def test_masked_frames_do_not_matter() -> None:
    y = jitter(swing(300, FPS, 3), 0.5).T
    w = np.ones_like(y)
    w[1, 100:110] = w[2, :4] = 0.0
    other = np.where(w == 0, 1e4, y)
    for mine, same in zip(chosen(y, w), chosen(other, w), strict=True):
        np.testing.assert_array_equal(mine, same)


def test_what_is_known_to_be_near_leads_to_the_same_choice() -> None:
    y = jitter(swing(500, FPS, 4), 0.5).T
    free = chosen(y)
    for away in (-2.0, 0.0, 2.0, 8.0):
        near = free._replace(place=free.place + away)
        np.testing.assert_allclose(chosen(y, near=near).place, free.place, atol=1e-9)


def test_a_pool_narrows_the_spread_over_short_clips() -> None:
    y = np.concatenate([jitter(swing(40, 60.0, 12, seed), 0.5, seed).T for seed in range(4)])
    alone, pooled = chosen(y).sigma, chosen(y, pools=[np.arange(len(y))]).sigma
    assert np.log(pooled).std() < 0.9 * np.log(alone).std()


def test_a_pool_leaves_a_channel_that_is_plainly_another_alone() -> None:
    y = jitter(swing(600, FPS, 9), 0.2)
    y[:, 4] = jitter(swing(600, FPS, 1, 9), 3.0, 5)[:, 0]
    pooled = chosen(y.T, pools=[np.arange(9)]).sigma
    assert pooled[4] == pytest.approx(3.0, rel=0.15)
    np.testing.assert_allclose(np.delete(pooled, 4), 0.2, rtol=0.15)


def test_freedom_counted_more_times_smooths_more() -> None:
    y = jitter(swing(300, FPS, 6), 0.5).T
    places = [chosen(y, inflate=times).place for times in (0.5, 1.0, 1.4, 1.8, 4.0)]
    assert (np.diff(places, axis=0) > -1e-9).all()
    assert (places[-1] > places[0]).all()


def test_a_cut_off_halves_an_oscillation() -> None:
    t = np.arange(4000)
    for frequency in (0.004, 0.02, 0.1, 0.3):
        place = place_of(frequency)
        assert cutoff(np.array([place]))[0] == pytest.approx(frequency)
        y = np.cos(2 * np.pi * frequency * t)[None]
        x = smoothing.fit(y, np.ones_like(y), Strength(np.array([place]), np.ones(1), np.ones(1)))[0]
        inner = slice(1000, 3000)
        assert rmse(x[:, inner], 0.5 * y[:, inner]) < 0.01


def test_a_mixture_is_better_than_one_strength_where_calm_and_kicks_meet() -> None:
    truth = np.tile(kick(1200, FPS, 5.0), (8, 1))
    y = jitter(truth, 0.5, 6)
    w, at = np.ones_like(y), chosen(y)
    mixed = smoothing.mixture(y, w, at, FPS, 0.0)
    assert rmse(mixed, truth) < 0.95 * rmse(smoothing.fit(y, w, at)[0], truth)


def test_many_channels_are_mixed_as_few_are() -> None:
    y = jitter(swing(150, FPS, 40), 0.5).T
    w, at = np.ones_like(y), chosen(y)
    few = slice(14, 19)
    alone = smoothing.mixture(y[few], w[few], Strength(*(a[few] for a in at)), FPS, 0.0)
    np.testing.assert_array_equal(smoothing.mixture(y, w, at, FPS, 0.0)[few], alone)
