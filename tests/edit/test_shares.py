"""How much of each clip: examples reproduced, lines kept, whatever the adverbs are counted in."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from mocurve import OptionError
from mocurve.edit._shares import cardinal, shares_of


def spots(count: int, dimensions: int, seed: int) -> np.ndarray:
    return np.random.default_rng(seed).uniform(-3.0, 5.0, (count, dimensions)) * 10.0 ** np.arange(dimensions)


@given(st.integers(1, 8), st.integers(1, 3), st.integers(0, 10_000))
@example(2, 2, 179)  # after the mean is taken off, one direction is left
def test_examples_come_back_and_lines_stay_lines(count: int, dimensions: int, seed: int) -> None:
    places = spots(count, dimensions, seed)
    np.testing.assert_array_equal(cardinal(places, places), np.eye(count))
    beside = spots(5, dimensions, seed + 1)
    shares = cardinal(places, beside)
    np.testing.assert_allclose(shares.sum(axis=0), 1.0, atol=1e-9)
    if count > dimensions + 1:
        size = 1.0 + np.abs(beside).max(axis=0)
        np.testing.assert_allclose((shares.T @ places - beside) / size, 0.0, atol=1e-6)


def test_shares_are_continuous_at_an_example() -> None:
    places = spots(5, 2, 3)
    near = cardinal(places, places[:1] + 1e-9)
    np.testing.assert_allclose(near[:, 0], np.eye(5)[0], atol=1e-7)


def test_between_two_it_is_a_straight_line() -> None:
    np.testing.assert_allclose(
        cardinal(np.array([[1.0], [3.0]]), np.array([[1.5], [4.0]])).T, [[0.75, 0.25], [-0.5, 1.5]]
    )


def test_what_the_line_leaves_is_brought_in_near_its_example() -> None:
    """Four values, of which one sticks out: far from it the line is hardly changed, and at it the value is met."""
    places = np.array([[0.0], [1.0], [2.0], [10.0]])
    values = np.array([0.0, 1.0, 0.0, 0.0])
    made = cardinal(places, np.array([[1.0], [0.0], [10.0]])).T @ values
    np.testing.assert_allclose(made, [1.0, 0.0, 0.0], atol=1e-12)
    line = np.polyval(np.polyfit(places[:, 0], values, 1), 5.0)
    assert abs(float(cardinal(places, np.array([[5.0]])).T[0] @ values) - line) < 0.1


def test_places_on_a_line_in_the_plane_still_sum_to_one() -> None:
    places = np.array([[0.0, 1.0], [1.0, 1.0], [2.0, 1.0]])
    np.testing.assert_allclose(cardinal(places, np.array([[0.5, 7.0]])).sum(), 1.0, atol=1e-12)


@pytest.mark.parametrize(
    ("weights", "told"),
    [
        ("1,2", [1.0, 2.0]),
        (["1,2"], [1.0, 2.0]),
        (["1", "2"], [1.0, 2.0]),
        (np.array([1, 2]), [1.0, 2.0]),
        (["0:1,2:0", "0:0,2:1"], [["0.0:1.0,2.0:0.0"], ["0.0:0.0,2.0:1.0"]]),
        ([[(0, 1), (2, 0)], {"Head": 1}], [["0.0:1.0,2.0:0.0"], ["Head=1.0"]]),
        (None, [1.0, 1.0]),
    ],
)
def test_weights_are_told_as_they_can_be_given(weights: object, told: list[object]) -> None:
    found = shares_of(2, weights, None, None).told()  # type: ignore[arg-type]
    assert found == {"weights": told, "places": None, "at": None}
    assert shares_of(2, found["weights"], None, None).told() == found


def test_places_too() -> None:
    found = shares_of(3, None, ["0,0", "1,0", "0,2"], "0.5,1").told()
    assert found == {"weights": None, "places": [[0.0, 0.0], [1.0, 0.0], [0.0, 2.0]], "at": [0.5, 1.0]}
    assert shares_of(3, None, found["places"], found["at"]).told() == found
    assert shares_of(2, None, "0,1", ["0:0,2:1"]).told()["at"] == [["0.0:0.0,2.0:1.0"]]


def test_places_that_cannot_be_told_apart_are_refused() -> None:
    with pytest.raises(OptionError, match="stand at the same place"):
        shares_of(3, None, [0, 1, 0], 0.5)
