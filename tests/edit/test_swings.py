"""Swings: what is known in contacts is kept, and in between places, speeds and accelerations meet."""

from __future__ import annotations

import numpy as np
import pytest

from mocurve.edit._swings import REACH, filled

RATE = 1000.0  # frames a second: differences are derivatives
SPANS = np.array([[0, 300], [700, 1000], [4000, 4400]])


def curved(frames: int) -> np.ndarray:
    """Two channels that are quadratic in each contact."""
    t = np.arange(frames) / RATE
    return np.stack([3.0 * t * t - t + 1.0, np.where(t < 2.0, 2.0 * t, 5.0 - 4.0 * (t - 4.0) ** 2)], axis=1)


@pytest.mark.parametrize("die", [None, 0.08])
def test_values_speeds_and_accelerations_meet_at_every_edge(die: float | None) -> None:
    known = curved(5000)
    found = filled(known, SPANS, 1 / RATE, die)
    for first, end in SPANS:
        np.testing.assert_array_equal(found[first:end], known[first:end])
    first, second = (np.diff(found, order, axis=0) * RATE**order for order in (1, 2))
    scale = np.abs(second).max()
    for edge in [300, 700, 1000, 4000, 4400]:
        assert np.abs(np.diff(first[edge - 4 : edge + 4], axis=0)).max() < 8.0 * scale / RATE
        assert np.abs(np.diff(second[edge - 4 : edge + 4], axis=0)).max() < 0.15 * scale


def test_long_gaps_and_ends_go_to_nothing() -> None:
    found = filled(curved(6000), SPANS, 1 / RATE)
    reach = int(REACH * RATE)
    assert not found[1000 + reach : 4000 - reach].any()
    assert not found[4400 + reach :].any()
    assert found[1000:1500].any()


def test_speeds_that_die_out_do_not_overshoot() -> None:
    t = np.arange(1000) / RATE
    known = np.where(t < 0.3, 10.0 * t, 3.0)[:, None]  # it slides at 10 a second, and then stands
    spans = np.array([[0, 300], [700, 1000]])
    across, died = (filled(known, spans, 1 / RATE, die)[300:700, 0] for die in (None, 0.08))
    assert across.max() > 3.3
    assert died.max() < 3.2
    np.testing.assert_allclose(died[90:], 3.0, atol=0.011)  # the last frame in contact is at 2.99


def test_without_contacts_there_is_nothing() -> None:
    assert not filled(np.ones((5, 2)), np.zeros((0, 2), int), 0.01).any()


@pytest.mark.parametrize("spans", [[[0, 1]], [[3, 4], [5, 6]], [[0, 2], [3, 5]], [[0, 6]]])
def test_contacts_of_a_frame_or_two_have_no_speed(spans: list[list[int]]) -> None:
    found = filled(np.full((6, 1), 7.0), np.array(spans), 0.01)
    assert np.isfinite(found).all()
    assert np.abs(found).max() <= 7.0 + 1e-9
