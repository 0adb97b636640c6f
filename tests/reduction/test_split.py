"""split: the thesis's recursion to the letter, the optimal tangents, and the form that keeps a tolerance."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from signals import KINDS, sampled, signal

import mocurve as mc
from mocurve import hermite
from mocurve.reduction import linear, split


def error_distance_ratio(bx, by, cx, cy, ex, ey):
    """findErrorDistanceRatio of appendix B.2: Heron's area of a triangle over its base, over its base again: half of
    height / base.
    """
    a = math.sqrt((cy - by) ** 2 + (cx - bx) ** 2)
    b = math.sqrt((ey - by) ** 2 + (ex - bx) ** 2)
    c = math.sqrt((cy - ey) ** 2 + (cx - ex) ** 2)
    s = (a + b + c) / 2
    area = math.sqrt(max(s * (s - a) * (s - b) * (s - c), 0.0))
    return area / b / b


def recursion_of_the_thesis(y, threshold):
    """Curve_DoRecursive of appendix B.2, from the two initial keys."""
    keys = {0, len(y) - 1}

    def recursive(first, last):
        largest, at = 0.0, -1
        for now in range(first, last):
            ratio = error_distance_ratio(first, y[first], now, y[now], last, y[last])
            if ratio > largest:
                largest, at = ratio, now
        if largest > threshold:
            keys.add(at)
            recursive(first, at)
            recursive(at, last)

    recursive(0, len(y) - 1)
    return sorted(keys)


@settings(max_examples=60, deadline=None)
@given(
    st.sampled_from(["noise", "walk", "smooth"]),
    st.integers(1, 120),
    st.integers(0, 10**6),
    st.sampled_from([0.001, 0.005, 0.01, 0.02, 0.03, 0.1, 0.3]),
)
def test_ratio_form_is_the_recursion_of_the_thesis(kind, count, seed, ratio):
    y = signal(kind, count, np.random.default_rng(seed)) * 10
    assert split.ratio_keys(y, ratio).tolist() == recursion_of_the_thesis(y.tolist(), ratio / 2)


def test_twenty_thousand_splits_deep_is_no_recursion_error():
    peaks = np.arange(20_000) * (-1.0) ** np.arange(20_000)
    assert len(split.ratio_keys(peaks, 0.001)) == 20_000


@pytest.mark.parametrize("ratio", [-1, math.nan])
def test_a_ratio_that_cannot_be_is_refused(ratio):
    with pytest.raises(mc.OptionError, match="ratio is height over chord length, a number from 0 on"):
        split.ratio_keys(np.zeros(5), ratio)


@pytest.mark.parametrize("count", [0, 1, 2])
def test_the_shortest_channels_keep_every_frame(count):
    assert split.with_ratio(np.ones(count), 0.01).frames.tolist() == list(range(count))


def test_a_constant_keeps_its_two_ends():
    keys = split.with_ratio(np.full(50, 3.0), 0.001)
    assert keys.frames.tolist() == [0, 49]
    np.testing.assert_allclose(sampled(keys, 50), 3.0, atol=1e-12)


def test_optimal_tangents_leave_no_error_that_a_slope_could_take_away():
    rng = np.random.default_rng(1)
    y = np.cumsum(np.convolve(rng.normal(size=300), np.ones(9) / 9, "same"))
    keys = split.with_ratio(y, 0.02)
    count = len(keys.frames)
    assert 10 < count < 150
    assert np.array_equal(keys.values[0], y[keys.frames])
    error = y - sampled(keys, 300)[0]
    for k in range(count):
        basis = hermite.evaluate(keys.frames, np.zeros(count), np.eye(count)[k], np.arange(300))
        assert abs(basis @ error) <= 2e-3 * np.linalg.norm(basis) * np.linalg.norm(error)
        assert np.sum((error - 0.01 * basis) ** 2) >= np.sum(error**2) * (1 - 1e-6)


def test_optimal_tangents_beat_central_differences():
    y = mc.unroll(mc.Motion(*_one_channel(np.sin(np.arange(200) / 9) * 40))).values[:, 0]
    keys = split.with_ratio(y, 0.05)
    central = np.gradient(y)[keys.frames]
    fitted = np.abs(sampled(keys, 200)[0] - y)
    plain = np.abs(hermite.evaluate(keys.frames, y[keys.frames], central, np.arange(200)) - y)
    assert (fitted**2).sum() < (plain**2).sum()


def _one_channel(values):
    skeleton = mc.Skeleton(("Hips",), np.array([-1]), np.zeros((1, 3)), (("Zrotation",),))
    return skeleton, values[:, None], 1 / 120


@settings(max_examples=120, deadline=None)
@given(
    st.sampled_from(KINDS),
    st.integers(1, 90),
    st.integers(1, 3),
    st.integers(0, 10**6),
    st.sampled_from([0, 1e6]),
    st.floats(-8, 0),
)
def test_every_frame_of_every_member_is_in_the_band(kind, count, members, seed, offset, thinnest):
    rng = np.random.default_rng(seed)
    middle = np.stack([signal(kind, count, rng) for _ in range(members)]) + offset
    half = 10.0 ** rng.uniform(thinnest, 1, size=middle.shape)
    keys = split.solve(middle, half)
    assert (np.abs(sampled(keys, count) - middle) <= half).all()
    assert keys.frames.tolist() == sorted(set(keys.frames.tolist()) | {0, count - 1})


def test_a_cubic_needs_two_keys():
    at = np.arange(400) / 100
    y = (3 * at**3 - 10 * at**2 + at)[None]
    assert len(split.solve(y, np.full_like(y, 1e-3)).frames) == 2


def test_fitted_splits_need_far_fewer_keys_than_straight_lines():
    y = (signal("smooth", 600, np.random.default_rng(0)))[None]
    half = np.full_like(y, 0.05)
    assert len(split.solve(y, half).frames) < 0.5 * len(linear.solve(y, half).frames)


def test_no_given_key_is_taken_away():
    y = signal("walk", 150, np.random.default_rng(5))[None]
    start = np.array([0, 3, 4, 5, 70, 149])
    assert np.isin(start, split.grown(start, y, np.full_like(y, 0.5)).frames).all()


def test_the_band_holds_on_a_capture(jump):
    motion = mc.unroll(mc.read(jump))
    for channel in range(0, motion.values.shape[1], 7):
        y = np.ascontiguousarray(motion.values[:, channel])[None]
        half = np.full_like(y, 0.2)
        assert (np.abs(sampled(split.solve(y, half), y.shape[1]) - y) <= half).all()
