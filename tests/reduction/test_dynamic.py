"""dynamic: exact segment errors, the best of all combinations, a polish that never makes worse, and the band."""

from __future__ import annotations

from itertools import pairwise, product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from signals import KINDS, sampled, signal

import mocurve as mc
from mocurve import hermite
from mocurve.reduction import dynamic, linear, split
from mocurve.reduction._dynamic import OFFSETS, _offsets, best_path, segment_form, squared_error
from mocurve.reduction.keys import Keys


def squared(keys, middle):
    return ((sampled(keys, middle.shape[1]) - middle) ** 2).sum()


def some_keys(middle, spacing, rng):
    """Keys near the middle (M, F) with poor values and slopes."""
    count = middle.shape[1]
    frames = np.unique(np.append(np.arange(0, count - 1, spacing), count - 1))
    return Keys(
        frames,
        middle[:, frames] + rng.normal(size=(len(middle), len(frames))),
        rng.normal(size=(len(middle), len(frames))),
    )


@settings(max_examples=60, deadline=None)
@given(st.sampled_from(KINDS), st.integers(2, 60), st.integers(0, 10**6), st.sampled_from([0, 1e5]), st.booleans())
def test_the_quadratic_form_is_the_error_summed_frame_by_frame(kind, count, seed, offset, last):
    rng = np.random.default_rng(seed)
    y = signal(kind, count, rng) + offset
    state, change = rng.normal(size=4), rng.normal(size=4)
    state[[0, 2]] += offset
    gram, right = np.empty((4, 4)), np.empty(4)
    base = segment_form(y, 0, state[0], state[1], count - 1, state[2], state[3], last, gram, right)
    v0, m0, v1, m1 = state + change
    counted = np.arange(count if last else count - 1)
    curve = hermite.evaluate(np.array([0, count - 1]), np.array([v0, v1]), np.array([m0, m1]), counted)
    direct = ((curve - y[counted]) ** 2).sum()
    assert base - 2 * right @ change + change @ gram @ change == pytest.approx(direct, rel=1e-7, abs=1e-7)


def test_a_key_has_nine_slopes_and_27_offsets():
    v, m = np.empty(OFFSETS), np.empty(OFFSETS)
    _offsets(2.0, 0.3, v, m)
    assert sorted({round(x, 9) for x in m}) == pytest.approx([0.1 * k for k in range(-4, 5)])
    assert sorted(set(v)) == [-2.0, 0.0, 2.0]
    assert len(set(zip(v, m.round(9), strict=True))) == OFFSETS
    assert (v[0], m[0]) == (0.0, 0.0)


@pytest.mark.parametrize("seed", range(4))
def test_no_path_through_the_states_is_cheaper(seed):
    rng = np.random.default_rng(seed)
    y = np.cumsum(rng.normal(size=14))
    frames, values, slopes = np.array([0, 6, 13]), y[[0, 6, 13]] + rng.normal(size=3), rng.normal(size=3) * 0.3
    reach, window, steep = np.array([0, 2, 0]), np.array([0.9, 0.7, 0.8]), np.array([0.5, 0.6, 0.4])
    found = best_path(y, y, False, frames, values, slopes, slopes, reach, window, steep)
    cost = squared_error(y, *found)
    v, m = np.empty((3, OFFSETS)), np.empty((3, OFFSETS))
    for q in range(3):
        _offsets(window[q], steep[q], v[q], m[q])
    cheapest = np.inf
    for time in (4, 6, 8):
        value = hermite.evaluate(frames, values, slopes, np.array([time]))[0]
        slope = (hermite.evaluate(frames, values, slopes, time + np.array([-1e-6, 1e-6])) @ [-1, 1]) / 2e-6
        at = np.array([0, time, 13])
        table = np.zeros((2, OFFSETS, OFFSETS))
        for q, i, j in product(range(2), range(OFFSETS), range(OFFSETS)):
            ends = np.array([values[0], value, values[2]])[q : q + 2] + np.array([v[q, i], v[q + 1, j]])
            lean = np.array([slopes[0], slope, slopes[2]])[q : q + 2] + np.array([m[q, i], m[q + 1, j]])
            part = np.arange(at[q], at[q + 1] + q)
            curve = hermite.evaluate(at[q : q + 2], ends, lean, part)
            table[q, i, j] = ((curve - y[part]) ** 2).sum()
        cheapest = min(cheapest, (table[0].min(axis=0) + table[1].min(axis=1)).min())
    assert cost == pytest.approx(cheapest, rel=1e-5)


@settings(max_examples=60, deadline=None)
@given(st.sampled_from(KINDS), st.integers(1, 120), st.integers(1, 3), st.integers(1, 30), st.integers(0, 10**6))
def test_polish_never_makes_worse_and_keeps_the_number_of_keys(kind, count, members, spacing, seed):
    rng = np.random.default_rng(seed)
    middle = np.stack([signal(kind, count, rng) for _ in range(members)])
    keys = some_keys(middle, spacing, rng)
    better = dynamic.refine_keys(keys, middle)
    assert len(better.frames) == len(keys.frames)
    assert (np.diff(better.frames) > 0).all()
    assert better.frames[[0, -1]].tolist() == keys.frames[[0, -1]].tolist()
    assert squared(better, middle) <= squared(keys, middle) * (1 + 1e-9)


@pytest.mark.parametrize("members", [1, 3])
def test_polish_moves_keys_in_time_to_a_small_error(members):
    rng = np.random.default_rng(2)
    at = np.arange(240)
    middle = np.stack([10 * np.exp(-(((at - 77) / 11) ** 2)) + rng.normal() * at / 40 for _ in range(members)])
    start = some_keys(middle, 24, rng)
    better = dynamic.refine_keys(start, middle)
    assert not np.array_equal(better.frames, start.frames)
    assert squared(better, middle) < 0.02 * squared(start, middle)


@pytest.mark.parametrize("members", [1, 3])
def test_polish_stays_in_the_band(members):
    rng = np.random.default_rng(4)
    middle = np.stack([np.convolve(np.cumsum(rng.normal(size=330)), np.ones(15) / 15, "valid") for _ in range(members)])
    half = np.exp(rng.normal(size=middle.shape) * 0.3) * 0.3
    keys = split.solve(middle, half)
    better = dynamic.refine_keys(keys, middle, half)
    assert (np.abs(sampled(better, middle.shape[1]) - middle) <= half * (1 + 1e-9)).all()
    assert squared(better, middle) < 0.9 * squared(keys, middle)


def test_broken_tangents_turn_together_and_stay_in_time():
    rng = np.random.default_rng(5)
    middle = np.convolve(np.cumsum(rng.normal(size=210)), np.ones(11) / 11, "valid")[None]
    keys = linear.solve(middle, np.full_like(middle, 0.4))
    better = dynamic.refine_keys(keys, middle)
    assert keys.in_slopes is not None
    assert better.in_slopes is not None
    assert np.array_equal(better.frames, keys.frames)
    np.testing.assert_allclose(better.slopes - better.in_slopes, keys.slopes - keys.in_slopes, atol=1e-12)
    assert squared(better, middle) < squared(keys, middle)


def test_initial_keys_lie_where_a_derivative_is_zero():
    period = 80
    y = 30 * np.sin(2 * np.pi * np.arange(4 * period + 1) / period)
    frames = dynamic.initial_keys(y[None]).frames
    turns = np.arange(0, 4 * period + 1, period // 4)  # extremes and inflections
    assert len(frames) == len(turns)
    assert np.abs(frames - turns).max() <= 1


def test_initial_keys_of_one_member_are_the_sign_changes_of_either_derivative():
    y = np.cumsum(np.random.default_rng(6).normal(size=150))[None]
    smooth = dynamic._smoothed(y, dynamic.SIGMA)[0]
    first, second = np.sign(np.gradient(smooth)[1:-1]), np.sign(np.diff(smooth, 2))
    either = (np.diff(first) != 0) ^ (np.diff(second) != 0)
    assert dynamic.initial_keys(y).frames.tolist() == [0, *(np.flatnonzero(either) + 1), 149]


@pytest.mark.parametrize("kind", ["constant", "line"])
def test_a_channel_without_turns_starts_with_its_ends(kind):
    y = signal(kind, 60, np.random.default_rng(7))[None]
    assert dynamic.initial_keys(y).frames.tolist() == [0, 59]


@settings(max_examples=60, deadline=None)
@given(
    st.sampled_from(KINDS),
    st.integers(1, 70),
    st.integers(1, 3),
    st.integers(0, 10**6),
    st.sampled_from([0, 1e6]),
    st.floats(-8, 0),
)
def test_every_frame_of_every_member_is_in_the_band(kind, count, members, seed, offset, thinnest):
    rng = np.random.default_rng(seed)
    middle = np.stack([signal(kind, count, rng) for _ in range(members)]) + offset
    half = 10.0 ** rng.uniform(thinnest, 1, size=middle.shape)
    keys = dynamic.solve(middle, half)
    assert (np.abs(sampled(keys, count) - middle) <= half).all()
    assert keys.frames.tolist() == sorted(set(keys.frames.tolist()) | {0, count - 1})


def test_error_falls_from_round_to_round(jump, monkeypatch):
    motion = mc.unroll(mc.read(jump))
    y = np.ascontiguousarray(motion.values[:, motion.skeleton.channel("LeftUpLeg.Xrotation")])[None]
    start = dynamic.initial_keys(y)
    errors = [squared(start, y)]
    for rounds in (1, 2, 4, 10):
        monkeypatch.setattr(dynamic, "ROUNDS", rounds)
        errors.append(squared(dynamic.refine_keys(start, y), y))
    assert all(after <= before for before, after in pairwise(errors))
    assert errors[-1] < 0.5 * errors[0]
    assert len(dynamic.thesis_keys(y[0]).frames) == len(start.frames)
