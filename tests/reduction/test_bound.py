"""The lower bound: against linear programming on small inputs, and the laws that a least number of pieces has."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import linprog

from mocurve.reduction.bound import lower_bound


def cubic_fits(y, half):
    """Is there a cubic within half of y, by a linear program for the smallest excess?"""
    t = np.linspace(-1.0, 1.0, len(y))
    rows = np.vander(t, 4)
    above = np.column_stack([rows, -half])
    below = np.column_stack([-rows, -half])
    answer = linprog(
        [0, 0, 0, 0, 1], np.vstack([above, below]), np.concatenate([y, -y]), bounds=[(None, None)] * 4 + [(0, None)]
    )
    return answer.x[4] <= 1.0


def bound_by_linear_programs(y, half):
    if (y - half).max() <= (y + half).min():
        return 1
    i, keys = 0, 1
    while i < len(y) - 1:
        j = i + 1
        while j + 1 < len(y) and cubic_fits(y[i : j + 2], half[i : j + 2]):
            j += 1
        i, keys = j, keys + 1
    return keys


@pytest.mark.parametrize("seed", range(12))
def test_it_is_what_linear_programs_find(seed):
    rng = np.random.default_rng(seed)
    y = np.cumsum(rng.normal(size=30)) * 10 ** rng.uniform(-1, 1)
    half = np.full(30, 0.5) if seed % 2 else 10 ** rng.uniform(-1, 0.5, 30)
    assert lower_bound(y[None], half[None]) == bound_by_linear_programs(y, half)


def test_a_constant_needs_one_key_and_a_cubic_two():
    t = np.linspace(-1.0, 1.0, 200)
    cubic = 3 * t**3 - t + 5
    half = np.full((1, 200), 1e-6)
    assert lower_bound(np.full((1, 200), 7.5), half) == 1
    assert lower_bound(cubic[None], half) == 2
    assert lower_bound(np.abs(t)[None] * 10, half) == 3 + 1  # the kink lies between two frames: one piece spans it


@pytest.mark.parametrize("count", [1, 2, 3, 4, 5])
def test_few_frames_have_a_bound(count):
    y = np.arange(count, dtype=float)[None] ** 5
    assert lower_bound(y, np.full_like(y, 0.01)) == (1 if count == 1 else 2 if count <= 4 else 3)


@settings(deadline=None, max_examples=40)
@given(st.integers(0, 10**6), st.integers(5, 300), st.floats(-3, 3), st.floats(-6, 6))
def test_scale_shift_and_straight_lines_change_nothing(seed, count, scale, shift):
    rng = np.random.default_rng(seed)
    y = np.round(np.cumsum(rng.normal(size=count)), 3)[None]
    half = np.full_like(y, 0.7)
    moved = 10.0**scale * (y + shift + 0.5 * np.arange(count))
    # A line may be what makes a constant of it, or takes it away: one key or two.
    assert max(2, lower_bound(moved, 10.0**scale * half)) == max(2, lower_bound(y, half))


@settings(deadline=None, max_examples=40)
@given(st.integers(0, 10**6), st.integers(1, 200))
def test_wider_bands_fewer_frames_and_fewer_members_never_need_more(seed, count):
    rng = np.random.default_rng(seed)
    y = np.cumsum(rng.normal(size=(2, count)), axis=1)
    half = 10 ** rng.uniform(-2, 0.5, (2, count))
    group = lower_bound(y, half)
    assert lower_bound(y, 2 * half) <= group
    assert lower_bound(y[:, : count // 2 + 1], half[:, : count // 2 + 1]) <= group
    assert lower_bound(y[:1], half[:1]) <= group
    assert lower_bound(np.repeat(y[:1], 3, axis=0), np.repeat(half[:1], 3, axis=0)) == lower_bound(y[:1], half[:1])
