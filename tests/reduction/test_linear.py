"""linear: the exact least number of interpolating keys, against a plain dynamic program."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from signals import KINDS, sampled, signal

from mocurve.reduction import linear


def fewest_by_force(middle, half):
    """Least number of keys by trying every chord at every frame."""
    count = middle.shape[1]
    least = np.full(count, count + 1)
    least[0] = 1
    for j in range(1, count):
        for i in range(j):
            part = np.arange(i + 1, j)
            chord = middle[:, i, None] + (middle[:, j, None] - middle[:, i, None]) * (part - i) / (j - i)
            if (np.abs(chord - middle[:, i + 1 : j]) <= half[:, i + 1 : j] * (1 - 1e-9)).all():
                least[j] = min(least[j], least[i] + 1)
    return least[-1]


@settings(max_examples=40, deadline=None)
@given(st.sampled_from(KINDS), st.integers(1, 25), st.integers(1, 3), st.integers(0, 10**6), st.floats(-3, 1))
def test_no_chain_of_chords_is_shorter(kind, count, members, seed, size):
    rng = np.random.default_rng(seed)
    middle = np.stack([signal(kind, count, rng) for _ in range(members)])
    half = np.exp(rng.normal(size=middle.shape) + size)
    assert len(linear.solve(middle, half).frames) == fewest_by_force(middle, half)


def test_long_chords_and_frames_that_cannot_be_keys_lose_nothing():
    rng = np.random.default_rng(3)
    middle = np.where(rng.random((1, 200)) < 0.04, 2.7, 0.9) * rng.normal(size=(1, 200)) * 0.4
    half = np.ones_like(middle)
    keys = linear.solve(middle, half)
    assert np.diff(keys.frames).max() > 64
    assert len(keys.frames) == fewest_by_force(middle, half)


@settings(max_examples=80, deadline=None)
@given(st.sampled_from(KINDS), st.integers(1, 90), st.integers(1, 3), st.integers(0, 10**6), st.sampled_from([0, 1e6]))
def test_every_frame_of_every_member_is_in_the_band(kind, count, members, seed, offset):
    rng = np.random.default_rng(seed)
    middle = np.stack([signal(kind, count, rng) for _ in range(members)]) + offset
    half = 10.0 ** rng.uniform(-8, 1, size=middle.shape)
    keys = linear.solve(middle, half)
    assert (np.abs(sampled(keys, count) - middle) <= half).all()
    assert keys.frames[0] == 0
    assert keys.frames[-1] == count - 1


def test_the_curve_is_the_polyline_through_its_keys():
    rng = np.random.default_rng(0)
    middle = np.cumsum(rng.normal(size=(2, 200)), axis=1)
    keys = linear.solve(middle, np.full_like(middle, 0.8))
    for values, curve in zip(keys.values, sampled(keys, 200), strict=True):
        np.testing.assert_allclose(curve, np.interp(np.arange(200), keys.frames, values), atol=1e-12)
    assert keys.in_slopes is not None
    assert np.array_equal(keys.in_slopes[:, 1:], keys.slopes[:, :-1])


@pytest.mark.parametrize("count", [1, 2, 3])
def test_the_shortest_clips(count):
    keys = linear.solve(np.zeros((1, count)), np.ones((1, count)))
    assert keys.frames.tolist() == sorted({0, count - 1})


def test_long_flat_stretches_are_done_at_once():
    flat = np.zeros((1, 135_000))
    assert len(linear.solve(flat, np.ones_like(flat)).frames) == 2
    flat[:, 70_000:] = 5.0
    assert len(linear.solve(flat, np.ones_like(flat)).frames) == 4
