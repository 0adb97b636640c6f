"""Dynamic time warping: the least cost of all ways, ways that keep slope and band, maps that rise."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mocurve.edit._dtw import PAIRS, SPANS, path, smooth_map

SIZES = st.integers(1, 9)
SEEDS = st.integers(0, 2**32 - 1)


def costs(rows: int, columns: int, seed: int) -> np.ndarray:
    return np.random.default_rng(seed).random((rows, columns))


def least(distances: np.ndarray, slope: int) -> float:
    """The same, cell by cell, all ways tried."""

    @cache
    def to(i: int, j: int, alone: int) -> float:
        """alone: how many steps in a row the first (+) or the second (-) went on by itself."""
        if i < 0 or j < 0:
            return np.inf
        if i == j == 0:
            return float(distances[0, 0]) if alone == 0 else np.inf
        if alone == 0:
            before = min(to(i - 1, j - 1, k) for k in range(-slope, slope + 1))
        elif alone == 1:
            before = min(to(i - 1, j, k) for k in range(-slope, 1))
        elif alone == -1:
            before = min(to(i, j - 1, k) for k in range(slope + 1))
        else:
            before = to(i - (alone > 0), j - (alone < 0), alone - (1 if alone > 0 else -1))
        return before + float(distances[i, j])

    return min(to(distances.shape[0] - 1, distances.shape[1] - 1, k) for k in range(-slope, slope + 1))


@given(SIZES, SIZES, SEEDS, st.integers(1, 4))
def test_the_cost_is_the_least_of_all_ways(rows: int, columns: int, seed: int, slope: int) -> None:
    distances = costs(rows, columns, seed)
    assert path(distances, slope)[0] == pytest.approx(least(distances, slope), abs=1e-12)
    assert path(distances)[0] == pytest.approx(least(distances, rows + columns), abs=1e-12)


@given(SIZES, SIZES, SEEDS, st.sampled_from([None, 1, 2, 4]))
def test_the_way_has_the_cost_and_keeps_the_slope(rows: int, columns: int, seed: int, slope: int | None) -> None:
    distances = costs(rows, columns, seed)
    cost, way = path(distances, slope)
    if not np.isfinite(cost):
        assert len(way) == 0
        return
    assert distances[tuple(way.T)].sum() == pytest.approx(cost)
    assert tuple(way[0]) == (0, 0)
    assert tuple(way[-1]) == (rows - 1, columns - 1)
    moves = "".join({(1, 1): "d", (1, 0): "i", (0, 1): "j"}[tuple(move)] for move in np.diff(way, axis=0).tolist())
    assert slope is None or ("i" * (slope + 1) not in moves and "j" * (slope + 1) not in moves)


def test_the_cost_is_that_of_a_reference_library() -> None:
    peer = pytest.importorskip("dtw", reason="dtw-python is not installed", exc_type=ImportError)
    for rows, columns in ((40, 60), (200, 170)):
        distances = costs(rows, columns, 3)
        assert path(distances)[0] == pytest.approx(peer.dtw(distances, step_pattern="symmetric1").distance, abs=1e-9)


def test_a_slope_as_steep_as_there_is_is_no_slope() -> None:
    distances = np.ones((90, 3))
    distances[:, 1] = 0.0
    cost, way = path(distances, 100)
    assert cost == path(distances)[0] == 2.0
    assert len(way) == 90


def test_the_same_twice_goes_straight() -> None:
    signal = np.sin(np.arange(50) / 5.0) + np.arange(50) / 40.0
    cost, way = path(np.abs(signal[:, None] - signal), 3)
    assert cost == 0.0
    np.testing.assert_array_equal(way, np.repeat(np.arange(50)[:, None], 2, axis=1))


def test_the_band_is_kept() -> None:
    distances = np.ones((40, 60))
    distances[np.arange(40), np.clip(np.arange(40) * 3, 0, 59)] = 0.0  # lures away from the middle
    for band in (3.0, 8.0):
        way = path(distances, None, band)[1]
        assert np.abs(way[:, 0] - way[:, 1] * 39 / 59).max() <= band + 1e-9
    assert not np.isfinite(path(distances, None, 0.1)[0])


def test_the_map_of_a_long_clip_has_no_more_knots_than_can_be_solved() -> None:
    old = np.linspace(0.0, 3600.0, 1500)
    pairs = smooth_map(old, old + 5.0 * np.sin(old / 300.0) - 5.0 * np.sin(12.0) * old / 3600.0, 2.4, 3)
    assert len(pairs) == PAIRS * SPANS + 1
    wanted = pairs[:, 0] + 5.0 * np.sin(pairs[:, 0] / 300.0) - 5.0 * np.sin(12.0) * pairs[:, 0] / 3600.0
    assert np.abs(pairs[:, 1] - wanted).max() < 1.0


@given(SEEDS, st.floats(0.3, 3.0), st.floats(0.3, 3.0), st.integers(1, 5))
def test_a_map_keeps_its_slope_and_its_ends(seed: int, length: float, other: float, slope: int) -> None:
    moves = np.random.default_rng(seed).random((60, 2)).round()  # also stands for long
    places = np.concatenate([[[0.0, 0.0]], np.cumsum(moves, axis=0) + 1e-9 * np.arange(60)[:, None]])
    old, new = (places / places[-1] * [length, other]).T
    pairs = smooth_map(old, new, 0.01, slope)
    rates = np.diff(pairs[:, 1]) / np.diff(pairs[:, 0])
    assert rates.min() > 0.95 * min(1 / (slope + 1), 0.99 * other / length)
    assert rates.max() < 1.05 * max(slope + 1, 1.01 * other / length)
    np.testing.assert_allclose(pairs[[0, -1]], [[0.0, 0.0], [length, other]], atol=1e-12)
