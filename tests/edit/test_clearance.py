"""Feet that pass: a swing keeps its distance from the standing foot, on its own side, left alone where it does."""

from __future__ import annotations

import numpy as np
import pytest

from mocurve.edit._clearance import MOST, cleared
from mocurve.edit._footprints import Targets
from mocurve.edit._stances import Stances

FRAMES, RATE = 150, 120
SWING = slice(40, 110)


def stood(spans: list[list[int]]) -> Stances:
    of = np.full(FRAMES, -1)
    for i, (first, end) in enumerate(spans):
        of[first:end] = i
    none = np.zeros((FRAMES, 3))
    few = np.zeros(len(spans), bool)
    return Stances(
        np.array(spans), of, none[: len(spans)], few, few, none, none, none[:, 0], none[:, 0], np.array(spans)
    )


def foot(x: float, z: np.ndarray) -> Targets:
    """A foot of 14 cm at x, its ball at z (F,)."""
    ball = np.column_stack([np.full(FRAMES, x), np.zeros(FRAMES), z])
    return Targets(ball, ball - [0.0, 0.0, 14.0], np.zeros(FRAMES))


def swinging(x: float) -> Targets:
    return foot(x, 120.0 * np.clip((np.arange(FRAMES) - 40) / 70.0, 0.0, 1.0) - 60.0)


STANDS = foot(0.0, np.zeros(FRAMES))
BOTH = (stood([[0, 40], [110, 150]]), stood([[0, 150]]))
LEVEL = np.zeros(FRAMES)


def passed(now: float, before: float = 10.0, heading: np.ndarray = LEVEL) -> np.ndarray:
    """Where the swinging foot goes aside (F,) when it is at `now`, and in the source at `before`."""
    made = cleared(swinging(now), STANDS, (swinging(before), STANDS), BOTH, heading, 1 / RATE)
    np.testing.assert_allclose(made.ankle - made.ball, STANDS.ankle - STANDS.ball)
    np.testing.assert_allclose(made.ball[:, 1:], swinging(now).ball[:, 1:], atol=1e-9)
    return made.ball[:, 0]


@pytest.mark.parametrize("now", [10.0, 14.0, 9.0])
def test_a_foot_that_keeps_most_of_its_distance_is_left_alone(now: float) -> None:
    np.testing.assert_array_equal(passed(now), now)


@pytest.mark.parametrize("now", [5.0, 0.0, -3.0])
def test_a_foot_that_would_come_too_near_goes_around_by_no_more_than_it_must(now: float) -> None:
    x = passed(now)
    assert (x[: SWING.start] == now).all()
    assert (x[SWING.stop :] == now).all()
    beside = np.abs(swinging(now).ball[:, 2]) < 14.0
    assert x[beside].min() > 7.4
    assert x.max() < 12.1
    assert np.abs(np.diff(x, 2)).max() < 0.2


def test_a_foot_on_the_wrong_side_comes_back_to_its_own() -> None:
    assert passed(-9.0)[75] > 7.0
    assert passed(-9.0, before=-10.0)[75] == -9.0


def test_what_would_take_too_much_is_left_or_done_as_far_as_it_helps() -> None:
    np.testing.assert_array_equal(passed(-2.0 * MOST), -2.0 * MOST)


def test_the_direction_is_that_of_the_body() -> None:
    turned = np.full(FRAMES, np.pi)
    x = passed(-5.0, heading=turned)
    assert -12.1 < x.min() < -7.4


def test_feet_that_do_not_pass_are_left_alone() -> None:
    apart = cleared(swinging(1.0), STANDS, (swinging(60.0), STANDS), BOTH, LEVEL, 1 / RATE)
    np.testing.assert_array_equal(apart.ball, swinging(1.0).ball)
    both_swing = (BOTH[0], stood([[0, 20], [130, 150]]))
    flying = cleared(swinging(1.0), STANDS, (swinging(10.0), STANDS), both_swing, LEVEL, 1 / RATE)
    np.testing.assert_array_equal(flying.ball, swinging(1.0).ball)
