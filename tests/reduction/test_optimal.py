"""The method optimal: the promise on everything that breaks things, the bound, the optimum, and the laws of
symmetry.
"""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import linprog

from mocurve import hermite
from mocurve.reduction.bound import lower_bound
from mocurve.reduction.keys import Keys
from mocurve.reduction.optimal import SETTINGS, mended, search, solve

KINDS = ("noise", "walk", "constant", "line", "step", "spikes", "rounded", "offset", "smooth")
BANDS = ("even", "wild", "needles", "waves")


def signal(kind, count, rng):
    """One channel (F,) of a kind that breaks things."""
    at = np.arange(count)
    return {
        "noise": rng.normal(size=count),
        "walk": np.cumsum(rng.normal(size=count)),
        "constant": np.full(count, 3.3),
        "line": 0.37 * at - 5,
        "step": np.where(at > count / 2, 10.0, 0.0),
        "spikes": np.where(rng.random(count) < 0.05, 1e4, 0.0),
        "rounded": np.round(np.cumsum(rng.normal(size=count))),
        "offset": 30 * np.sin(0.1 * at) + 1e6,
        "smooth": np.cumsum(np.cumsum(rng.normal(size=count))) * 0.1,
    }[kind]


def band(kind, count, width, rng):
    """Half-widths (F,): even, varying by a million from frame to frame, pinched to nothing at frames, slowly
    varying.
    """
    return {
        "even": np.full(count, width),
        "wild": width * 10 ** rng.uniform(-3, 3, count),
        "needles": np.where(rng.random(count) < 0.1, min(width, 1e-9), width),
        "waves": width * (1 + 0.99 * np.sin(0.2 * np.arange(count))),
    }[kind]


def curve(keys, member=0):
    return hermite.evaluate(
        keys.frames.astype(float), keys.values[member], keys.slopes[member], np.arange(keys.frames[-1] + 1.0)
    )


def clip(seed, count=400, members=1):
    """A smooth walk with noise that looks like capture."""
    rng = np.random.default_rng(seed)
    steps = rng.normal(size=(members, count + 60))
    smooth = np.apply_along_axis(np.convolve, 1, steps, np.hanning(30), "valid")[:, :count]
    return np.cumsum(smooth, axis=1) * 0.5 + 0.02 * rng.normal(size=(members, count))


@settings(deadline=None, max_examples=150)
@given(
    st.integers(0, 10**6),
    st.sampled_from([1, 2, 3, 4, 5, 8, 13, 40, 200]),
    st.integers(1, 3),
    st.sampled_from(KINDS),
    st.sampled_from(BANDS),
    st.floats(-6, 1),
    st.sampled_from(sorted(SETTINGS)),
)
def test_the_promise_holds_at_every_frame_of_every_member(seed, count, members, kind, width, size, quality):
    rng = np.random.default_rng(seed)
    middle = np.array([signal(kind, count, rng) for _ in range(members)])
    half = np.array([band(width, count, 10.0**size, rng) for _ in range(members)])
    rounding = 4e-16 * np.abs(middle).max()
    keys = solve(middle, np.maximum(half, 100 * rounding), quality)
    assert keys.frames[0] == 0
    assert keys.frames[-1] == count - 1
    assert (np.diff(keys.frames) > 0).all()
    assert keys.in_slopes is None  # C1: one slope a key
    assert len(keys.frames) >= lower_bound(middle, half)
    for m in range(members):
        assert (np.abs(curve(keys, m) - middle[m]) <= np.maximum(half[m], 100 * rounding) + 4 * rounding).all()


def test_no_segment_needs_mending():
    rng = np.random.default_rng(5)
    for kind in KINDS:
        for width in BANDS:
            middle, half = signal(kind, 300, rng)[None], band(width, 300, 0.3, rng)[None]
            half = np.maximum(half, 1e-8 if kind == "offset" else 0.0)
            assert not search(middle, half, *SETTINGS["default"])[3].any()


def test_a_segment_that_failed_gets_exact_keys_on_its_frames():
    middle = np.random.default_rng(6).normal(size=(2, 9))
    half = np.full_like(middle, 0.5)
    held = middle[:, [0, 3, 6, 8]]
    held[1, 1] += 1.0  # outside its band
    broken = Keys(np.array([0, 3, 6, 8]), held, np.zeros((2, 4)))
    keys = mended(middle, half, broken, np.array([False, True, False]))
    np.testing.assert_array_equal(keys.frames, [0, 3, 4, 5, 6, 8])
    np.testing.assert_array_equal(keys.values, middle[:, keys.frames])


@pytest.mark.parametrize("quality", sorted(SETTINGS))
def test_a_cubic_needs_two_keys(quality):
    t = np.linspace(-1, 1, 500)
    y = (40 * t**3 - 20 * t + 5)[None]
    assert len(solve(y, np.full_like(y, 1e-3), quality).frames) == 2


def fewest_keys(y, half):
    """The optimum by trying all sets of keys, with a linear program for each."""
    count = len(y)
    for inside in range(count - 1):
        for chosen in combinations(range(1, count - 1), inside):
            frames = np.array([0, *chosen, count - 1], float)
            columns = []
            for k in range(2 * len(frames)):
                unit = np.zeros(2 * len(frames))
                unit[k] = 1.0
                columns.append(hermite.evaluate(frames, unit[0::2], unit[1::2], np.arange(float(count))))
            rows = np.column_stack(columns)
            sides = np.concatenate([half + y, half - y])
            answer = linprog(np.zeros(rows.shape[1]), np.vstack([rows, -rows]), sides, bounds=(None, None))
            if answer.status == 0:
                return len(frames)
    raise AssertionError("keys at all frames are always possible")


def test_the_optimum_is_never_beaten_and_nearly_always_found():
    found = best = 0
    for seed in range(15):
        rng = np.random.default_rng(seed)
        y = np.cumsum(rng.normal(size=9))
        half = 10 ** rng.uniform(-0.8, 0.2, 9)
        keys, optimum = len(solve(y[None], half[None], "best").frames), fewest_keys(y, half)
        assert keys >= optimum
        found, best = found + keys, best + optimum
    assert found <= 1.05 * best


@settings(deadline=None, max_examples=30)
@given(st.integers(0, 10**6), st.integers(-20, 20), st.integers(-1000, 1000))
def test_scale_and_shift_change_nothing(seed, power, shift):
    y = np.round(clip(seed, 150) * 1024) / 1024  # sums with whole numbers are exact
    half = np.full_like(y, 0.25)
    plain, moved = solve(y, half, "default"), solve(2.0**power * (y + shift), 2.0**power * half, "default")
    assert abs(len(plain.frames) - len(moved.frames)) <= 1


@pytest.mark.parametrize("seed", range(5))
def test_time_backwards_needs_about_as_many_keys(seed):
    y = clip(seed)
    half = np.full_like(y, 0.25)
    forth, back = (len(solve(x, half, "good").frames) for x in (y, y[:, ::-1]))
    assert abs(forth - back) <= 0.12 * forth + 1


def test_identical_members_get_the_keys_of_one():
    y = clip(3)
    half = np.full_like(y, 0.1)
    one, three = solve(y, half, "default"), solve(np.repeat(y, 3, 0), np.repeat(half, 3, 0), "default")
    assert abs(len(one.frames) - len(three.frames)) <= 0.03 * len(one.frames) + 1
    assert three.values.shape == three.slopes.shape == (3, len(three.frames))


def test_a_group_needs_more_than_each_member_and_less_than_all():
    y = clip(4, members=3)
    half = np.full_like(y, 0.1)
    alone = [len(solve(y[m : m + 1], half[m : m + 1], "default").frames) for m in range(3)]
    group = len(solve(y, half, "default").frames)
    assert max(alone) <= group <= sum(alone)


def test_more_time_gives_fewer_keys_near_the_bound():
    clips = [clip(seed) for seed in range(6)]
    half = np.full((1, 400), 0.1)
    bound = sum(lower_bound(y, half) for y in clips)
    counts = {quality: sum(len(solve(y, half, quality).frames) for y in clips) for quality in SETTINGS}
    assert counts["best"] <= 1.01 * counts["good"]  # on so few keys, one may go astray
    assert counts["good"] <= counts["default"] <= counts["fast"]
    assert counts["default"] <= 1.40 * bound
    assert counts["best"] <= 1.33 * bound


def test_noise_is_kept_without_wild_swings_between_the_frames():
    y = np.random.default_rng(0).normal(size=(1, 500))
    half = np.full_like(y, 0.1)
    keys = solve(y, half, "default")
    between = hermite.evaluate(keys.frames * 1.0, keys.values[0], keys.slopes[0], np.arange(0, 499, 0.25))
    assert len(keys.frames) <= 1.55 * lower_bound(y, half)
    assert np.abs(between).max() <= 1.5 * np.abs(y).max()


def test_read_only_and_strided_arrays_are_welcome():
    y = np.asfortranarray(clip(1, members=2))
    y.flags.writeable = False
    half = np.broadcast_to(0.3, y.shape)
    assert (np.abs(curve(solve(y, half, "fast"), 1) - y[1]) <= 0.3).all()


def test_a_long_channel_and_a_short_one_share_the_way_they_begin():
    y = clip(2, 3000)
    half = np.full_like(y, 0.3)
    whole, part = solve(y, half, "default"), solve(y[:, :1000], half[:, :1000], "default")
    same = len(part.frames) * 2 // 3
    assert (np.abs(whole.frames[:same] - part.frames[:same]) <= 40).all()
