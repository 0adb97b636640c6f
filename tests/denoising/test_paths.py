"""The path that may skip frames against all paths there are, and excursions."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mocurve.denoising import _paths, _verdict

GAP, END, EACH, ENTRY, CAP = 3, 2, 1.2, 3.0, 6.0


def marked(y: np.ndarray, first: int = 0, last: int | None = None) -> np.ndarray:
    """The frames that the path through y (n, C) leaves out."""
    n, channels = y.shape
    skipped = np.zeros(n, bool)
    last = n - 1 if last is None else last
    _paths.skip(
        y, np.full(channels, 0.01), np.full((n, channels), 0.05), first, last, GAP, END, EACH, ENTRY, CAP, skipped
    )
    return skipped


def price(y: np.ndarray, kept: np.ndarray) -> float:
    """What the path over these frames costs; infinite where it is not allowed."""
    steps, n, channels = np.diff(kept), len(y), y.shape[1]
    if len(kept) < 2 or steps[0] > 1 or steps.max() > GAP + 1 or kept[0] > END or n - 1 - kept[-1] > END:
        return np.inf
    skips = [steps[0] - 1, kept[0], n - 1 - kept[-1], *(steps[1:] - 1)]
    cost = sum(ENTRY + EACH * skip for skip in skips if skip)
    for i, j, k in zip(kept[:-2], kept[1:-1], kept[2:], strict=True):
        before, after = j - i, k - j
        turn = (y[k] - y[j]) / after - (y[j] - y[i]) / before
        spread = 1 / before**2 + 1 / after**2 + (1 / before + 1 / after) ** 2
        z = (turn**2 / (0.01 * spread + 0.05 * ((before + after) / 2) ** 2)).sum()
        cost += min(CAP, 0.5 * max(0.0, z - channels))
    return cost


@settings(max_examples=40)
@given(st.integers(0, 2**32), st.integers(5, 9), st.integers(1, 2))
def test_no_path_is_cheaper(seed: int, n: int, channels: int) -> None:
    rng = np.random.default_rng(seed)
    y = np.cumsum(rng.normal(0, 0.2, (n, channels)), axis=0) + rng.normal(0, 4, (n, 1)) * (rng.random((n, 1)) < 0.25)
    chosen = [np.flatnonzero([bits >> i & 1 for i in range(n)]) for bits in range(1, 2**n)]
    least = min(price(y, kept) for kept in chosen)
    assert price(y, np.flatnonzero(~marked(y))) == pytest.approx(least)


@pytest.mark.parametrize("frames", [[0], [0, 1], [19], [18, 19], [7], [7, 8, 9], [3, 12, 13]])
def test_spikes_on_a_line_are_left_out_anywhere(frames: list[int]) -> None:
    y = np.stack([np.arange(20.0), -0.5 * np.arange(20.0)], axis=1)
    y[frames, 0] += 10.0
    assert np.flatnonzero(marked(y)).tolist() == frames


def test_a_part_of_a_clip_is_searched_alone_and_keeps_its_ends() -> None:
    y = np.zeros((30, 1))
    y[[2, 10, 14, 20]] = 9.0
    assert np.flatnonzero(marked(y, 5, 17)).tolist() == [10, 14]


def away(y: np.ndarray, impossible: list[int], longest: int = 20) -> list[int]:
    marks, turns = np.zeros(len(y), bool), np.zeros((1, len(y)), bool)
    turns[0, impossible] = True
    _paths.excursions(y[None], turns, longest, marks)
    return np.flatnonzero(marks).tolist()


def test_an_excursion_is_what_lies_between_two_impossible_turns() -> None:
    y = np.zeros(60)
    y[10:20] = 50.0
    turns = [9, 10, 19, 20]
    assert away(y, turns) == list(range(10, 20))
    assert away(y, turns, longest=8) == []  # away for too long
    y[10:20] = np.linspace(50, 0, 10)
    assert away(y, [9, 10]) == []  # it came back as bodies do
    y[10:20] = 0.0
    y[10:12] = 50.0
    assert away(y, [9, 10, 11, 12]) == []  # too short: the path finds it


def test_an_excursion_is_over_where_it_is_back_by_three_quarters() -> None:
    y = np.zeros(60)
    y[10:20] = 50.0
    y[20:] = 12.0
    assert away(y, [9, 10, 19, 20]) == list(range(10, 20))
    y[20:] = 13.0
    assert away(y, [9, 10, 19, 20]) == []


def test_the_core_of_a_run_is_its_largest_deviation() -> None:
    off, candidate, out = np.zeros((2, 40)), np.zeros(40, bool), np.zeros(40, bool)
    candidate[[8, 9, 10, 11, 12, 25, 26, 27, 28]] = True
    off[0, 8:13] = [1.0, 2.0, 20.0, 15.0, -3.0]
    off[1, 25:29] = [20.0, 19.0, 18.0, 17.0]  # too long for a core
    _verdict.core(off, np.zeros((2, 40)), np.ones(2), candidate, out)
    assert np.flatnonzero(out).tolist() == [10, 11]
