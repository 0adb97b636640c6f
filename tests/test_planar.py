"""Planar transforms: a group with a screw, an alignment that nothing betters, distances equal to one pair at a time."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import minimize

from mocurve import Mismatch, OptionError, planar, rotation

TURNS = st.one_of(st.floats(-1e-9, 1e-9), st.floats(-3.1, 3.1))
MOVES = st.tuples(TURNS, st.floats(-9, 9), st.floats(-9, 9)).map(np.array)
SEEDS = st.integers(0, 2**32 - 1)


def cloud(seed: int, *shape: int) -> np.ndarray:
    return np.random.default_rng(seed).normal(size=(*shape, 3))


# -- the group ---------------------------------------------------------------------------------------
@given(MOVES, MOVES, SEEDS)
def test_the_composed_transform_moves_as_one_after_the_other(g: np.ndarray, h: np.ndarray, seed: int) -> None:
    places = cloud(seed, 5)
    np.testing.assert_allclose(
        planar.move(planar.compose(g, h), places), planar.move(g, planar.move(h, places)), atol=1e-12
    )
    np.testing.assert_allclose(planar.move(planar.inverse(g), planar.move(g, places)), places, atol=1e-12)


@given(MOVES)
def test_the_quaternion_turns_as_the_transform_does(g: np.ndarray) -> None:
    turn = g * [1.0, 0.0, 0.0]
    places = cloud(1, 4)
    np.testing.assert_allclose(rotation.rotate(planar.quaternion(g), places), planar.move(turn, places), atol=1e-12)
    ahead = planar.move(np.array([0.3, 0.0, 0.0]), np.array([0.0, 0.0, 1.0]))
    assert ahead[0] == pytest.approx(np.sin(0.3))  # z turns towards x


@given(MOVES, st.floats(-3, 3), st.floats(-3, 3))
def test_powers_add_up(g: np.ndarray, a: float, b: float) -> None:
    together = planar.compose(planar.power(g, a), planar.power(g, b))
    np.testing.assert_allclose(planar.power(g, a + b), together, atol=1e-7 * (1 + np.abs(together).max()))


@given(MOVES, st.integers(-4, 4))
def test_a_whole_power_is_the_transform_so_many_times(g: np.ndarray, count: int) -> None:
    result = np.zeros(3)
    for _ in range(abs(count)):
        result = planar.compose(g if count > 0 else planar.inverse(g), result)
    np.testing.assert_allclose(planar.power(g, count), result, atol=1e-10 * (1 + np.abs(result).max()))


@given(MOVES)
def test_the_screw_of_a_transform_leads_to_it(g: np.ndarray) -> None:
    np.testing.assert_allclose(planar.exp(planar.log(g)), g, atol=1e-12 * (1.0 + np.abs(g).max()))
    np.testing.assert_allclose(planar.exp(0.5 * planar.log(g)), planar.power(g, 0.5), atol=1e-12)


def test_a_screw_keeps_its_centre_and_many_exponents_come_at_once() -> None:
    g = np.array([0.8, 3.0, -1.0])
    parts = planar.power(g, np.linspace(0, 1, 9))
    assert parts.shape == (9, 3)
    quarter = 2.0 * np.pi / 0.8
    np.testing.assert_allclose(planar.power(g, quarter)[1:], 0.0, atol=1e-12)  # once around the centre
    np.testing.assert_allclose(parts[-1], g, atol=1e-12)


def test_a_whole_turn_with_a_shift_has_no_power() -> None:
    with pytest.raises(OptionError, match="no centre"):
        planar.power(np.array([2.0 * np.pi, 1.0, 0.0]), 0.5)


# -- alignment ---------------------------------------------------------------------------------------
@given(MOVES, SEEDS)
def test_alignment_finds_the_transform_that_was_done(g: np.ndarray, seed: int) -> None:
    places = cloud(seed, 6)
    found = planar.align(planar.move(g, places), places)
    np.testing.assert_allclose(planar.move(found, places), planar.move(g, places), atol=1e-9)


def test_no_other_transform_is_nearer_than_the_alignment() -> None:
    target, places, weights = cloud(2, 7), cloud(3, 7), np.arange(7.0)

    def miss(g: np.ndarray) -> float:
        return float((weights[:, None] * (target - planar.move(g, places)) ** 2).sum())

    found = planar.align(target, places, weights)
    sought = min((minimize(miss, [a, 0, 0], tol=1e-14) for a in (-2.0, 0.0, 2.0)), key=lambda one: one.fun)
    assert miss(found) <= sought.fun + 1e-9


def test_alignment_takes_many_clouds_at_once() -> None:
    target, places = cloud(4, 3, 2, 5), cloud(5, 3, 2, 5)
    found = planar.align(target, places)
    assert found.shape == (3, 2, 3)
    np.testing.assert_allclose(found[2, 1], planar.align(target[2, 1], places[2, 1]))


# -- distances of all pairs ----------------------------------------------------------------------------
@pytest.mark.parametrize(("window", "chunk"), [(1, 4_000_000), (4, 4_000_000), (4, 20)])
def test_distances_are_those_of_one_pair_at_a_time(window: int, chunk: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(planar, "CHUNK", chunk)
    first, second = cloud(6, 12, 5) + np.array([300.0, 80.0, -50.0]), 1.3 * cloud(7, 9, 5) + np.array([0.0, 80.0, 9e2])
    weights = np.array([1.0, 2.0, 0.0, 0.5, 1.0])
    found = planar.frame_distances(first, second, window, weights)
    shares = np.tile(weights / weights.sum() / window, window)
    for i, j in np.ndindex(13 - window, 10 - window):
        p, q = first[i : i + window].reshape(-1, 3), second[j : j + window].reshape(-1, 3)
        apart = p - planar.move(planar.align(p, q, shares), q)
        assert found[i, j] == pytest.approx(np.sqrt((shares[:, None] * apart**2).sum()), abs=1e-9)
    assert found.shape == (13 - window, 10 - window)


def test_where_a_clip_stands_and_faces_does_not_matter() -> None:
    places = cloud(8, 10, 4)
    moved = planar.move(np.array([1.1, 40.0, -7.0]), places)
    assert np.diag(planar.frame_distances(places, moved, 3)).max() < 1e-6
    raised = planar.frame_distances(places, places + np.array([0.0, 2.0, 0.0]), 3)
    np.testing.assert_allclose(np.diag(raised), 2.0)


@pytest.mark.parametrize(
    ("window", "weights", "words"), [(4, None, "window of 4"), (0, None, "window of 0"), (1, [1, -1], "2 numbers")]
)
def test_what_cannot_be_compared_is_refused(window: int, weights: list[float] | None, words: str) -> None:
    with pytest.raises(OptionError, match=words):
        planar.frame_distances(cloud(1, 3, 2), cloud(1, 5, 2), window, weights)
    with pytest.raises(Mismatch, match="same joints"):
        planar.frame_distances(cloud(1, 3, 2), cloud(1, 3, 4))
