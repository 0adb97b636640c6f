"""retime: even speeds exactly, bent ones nearly, time always forward."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from chains import keys
from hypothesis import given
from hypothesis import strategies as st
from turning import ALONG, apart, spline, turning

import mocurve as mc
from mocurve import OptionError, bspline, bspline_fit
from mocurve.edit.retime import departure, time_map
from mocurve.spline import SplineMotion, refined

BENT = {0.5: 0.6, 1.0: 1.0, 1.5: 1.7}


def two_seconds() -> mc.Motion:
    return turning(90 * ALONG, 12.0)


def test_the_same_times_change_nothing(jump: Path) -> None:
    motion = mc.read(jump)
    assert mc.retime(motion, [(0, 0), (1, 1), (2, 2)]).values.tobytes() == motion.values.tobytes()
    given = keys()
    assert mc.retime(given, {0.2: 0.2}).sample().values.tobytes() == given.sample().values.tobytes()


@pytest.mark.parametrize("factor", [2.0, 4.0])
def test_an_even_speed_is_exact(factor: float) -> None:
    body = two_seconds().skeleton
    for clip in (two_seconds(), keys(), spline(body, 30, 3, 1), spline(body, 30, 4, 1)):
        end = clip.duration
        with pytest.warns(UserWarning, match="slower") if factor > 2 else _nothing():
            made = mc.retime(clip, {end: factor * end}, mode="knots")
        assert type(made) is type(clip)
        assert made.duration == pytest.approx(factor * end)
        np.testing.assert_allclose(made.sample().values[:: int(factor)], clip.sample().values, atol=1e-10)


def _nothing() -> object:
    from contextlib import nullcontext

    return nullcontext()


def test_moments_are_where_they_are_asked_to_be() -> None:
    motion, made = two_seconds(), mc.retime(two_seconds(), BENT)
    for old, new in BENT.items():
        np.testing.assert_allclose(made.values[round(new * 100)], motion.values[round(old * 100)], atol=1e-9)
    assert made.duration == pytest.approx(2.2)  # after the last pair the clip keeps its speed


@given(st.lists(st.floats(0.02, 3.0), min_size=2, max_size=9), st.lists(st.floats(0.02, 3.0), min_size=9, max_size=9))
def test_time_goes_forward_and_back_again(old_steps: list[float], new_steps: list[float]) -> None:
    old, new = (np.concatenate([[0.0], np.cumsum(steps)]) for steps in (old_steps, new_steps[: len(old_steps)]))
    clip = mc.Motion(two_seconds().skeleton, np.zeros((round(old[-1] * 100) + 1, 6)), old[-1] / round(old[-1] * 100))
    bent = time_map(clip, list(zip(old, new, strict=True)))
    at = np.linspace(0.0, bent.old[-1], 301)
    assert (np.diff(bent.at(at)) > 0).all()
    assert bent.speeds(at).min() > 0
    np.testing.assert_allclose(bent.back(bent.at(at)), at, atol=1e-9)
    slopes = (bent.at(at[1:-1] + 1e-6) - bent.at(at[1:-1] - 1e-6)) / 2e-6
    np.testing.assert_allclose(bent.speeds(at[1:-1]), slopes, rtol=1e-3, atol=1e-4 * slopes.max())


def test_keys_move_with_their_slopes() -> None:
    given = mc.KeyedMotion(
        mc.Skeleton(("A",), np.array([-1]), np.zeros((1, 3)), (("Xposition",),)),
        (mc.HermiteCurve([0.0, 1.0, 2.0], [0.0, 5.0, 1.0], [1.0, 2.0, 3.0], [4.0, 2.0, 3.0]),),
        0.01,
        201,
    )
    made = mc.retime(given, {1.0: 1.4}).curves[0]
    bent = time_map(given, {1.0: 1.4})
    np.testing.assert_allclose(made.times, [0.0, 1.4, 2.4])
    np.testing.assert_allclose(made.slopes * bent.speeds(given.curves[0].times), [1.0, 2.0, 3.0])
    assert made.in_slopes[0] * bent.speeds(np.zeros(1))[0] == pytest.approx(4.0)
    np.testing.assert_array_equal(made.values, [0.0, 5.0, 1.0])


def test_knots_moved_are_near_and_a_refit_is_nearer_and_the_error_is_told() -> None:
    clip = spline(two_seconds().skeleton, 40, 3, 3)
    bent = time_map(clip, BENT)
    with pytest.warns(UserWarning, match=r"knots were moved: the curves are off by up to .* degrees and .* units"):
        moved = mc.retime(clip, BENT, mode="knots")
    refit = mc.retime(clip, BENT)
    assert np.isin([0.6, 1.0, 1.7], np.round(moved.knots, 12)).all()
    off, nearer = (departure(clip, made, bent)["degrees"] for made in (moved, refit))
    assert 0 < nearer < 0.5 * off


@pytest.mark.parametrize("degree", [2, 3, 4, 5])
def test_moved_coefficients_are_nearer_than_kept_ones(degree: int) -> None:
    at = np.linspace(0, 2, 201)
    knots = bspline.clamped(np.linspace(0, 2, 11), degree)
    values = bspline_fit.least_squares(knots, degree, at, 30 * np.sin(2.5 * at[:, None] + np.arange(6)))
    clip = SplineMotion(two_seconds().skeleton, knots, values, degree, 0.01, 201)
    old = np.linspace(0, 2, 41)
    pairs = list(zip(old, old + 0.05 * np.sin(np.pi * old), strict=True))
    bent = time_map(clip, pairs)
    with pytest.warns(UserWarning, match="knots were moved"):
        moved = mc.retime(clip, pairs, mode="knots")
    finer = refined(clip, bspline.union(knots, bspline.snapped(old[1:-1], knots)))
    kept = replace(finer, knots=bent.at(finer.knots))  # as Sudarsky and House move them
    off, plain = (departure(clip, made, bent)["degrees"] for made in (moved, kept))
    assert off < 0.2 * plain


def test_a_walk_of_knots_every_fifth_of_a_second_keeps_its_root_within_millimetres(clips: Path) -> None:
    walk = mc.read(clips / "cmu" / "cmu_12_01_walk.bvh")[1:]
    at = np.arange(walk.frames) * walk.frame_time
    knots = bspline.clamped(np.linspace(0, walk.duration, round(walk.duration / 0.2) + 1))
    fitted = SplineMotion(
        walk.skeleton, knots, bspline_fit.least_squares(knots, 3, at, walk.values), 3, walk.frame_time, walk.frames
    )
    end = walk.duration
    old = np.linspace(0, end, 9)  # a smooth change of speed by 12 %
    pairs = list(zip(old, old + 0.12 * end / (2 * np.pi) * np.sin(2 * np.pi * old / end), strict=True))
    root = slice(0, 3)
    fine = np.linspace(0, end, 4001)
    bent = time_map(fitted, pairs)
    truth = fitted.at(bent.back(fine))[:, root]
    with pytest.warns(UserWarning, match="knots were moved"):
        moved = mc.retime(fitted, pairs, mode="knots")
    centimetres = 2.54 / 0.45  # the length unit of CMU's clips
    off = [np.abs(made.at(fine)[:, root] - truth).max() * centimetres for made in (moved, mc.retime(fitted, pairs))]
    assert off[0] < 0.05
    assert off[1] < 0.02


@pytest.mark.parametrize(
    ("pairs", "text"),
    [
        ({9.0: 9.0}, "the time 9 s lies outside of the clip, which goes from 0 to 2 s"),
        ({1.0: 1.2, 1.5: 1.1}, "time cannot stand or run backwards: 1 s goes to 1.2 s, 1.5 s to 1.1 s"),
        ({1.0: 0.0}, "time cannot stand"),
        ([(1.0, 1.2), (1.0, 1.3)], "two new times are given for 1 s"),
        ({0.0: 0.5}, "the start of the clip stays at 0 s, it cannot go to 0.5 s"),
        ("1.0-1.2", r"a pair of times is old:new in seconds, like 1.2:1.5, not '1.0-1.2'"),
        ([1.0], "a pair of times is old:new"),
        ({1.0: float("inf")}, "a pair of times is old:new"),
        ([], "no pair of times is given"),
        ({2.0: 1e9}, r"the clip would last 1e\+09 s"),
    ],
)
def test_wrong_times_are_refused(pairs: object, text: str) -> None:
    with pytest.raises(OptionError, match=text):
        mc.retime(two_seconds(), pairs)


def test_one_frame_has_no_time_and_extreme_speeds_are_told() -> None:
    with pytest.raises(OptionError, match="a clip of one frame has no time to change"):
        mc.retime(two_seconds()[:1], {0.0: 0.0})
    with pytest.warns(UserWarning, match=r"the clip runs 4 times slower at 0 s"):
        mc.retime(two_seconds(), {2.0: 8.0})
    with pytest.warns(UserWarning, match=r"the clip runs 4 times faster at 0 s"):
        made = mc.retime(two_seconds(), {2.0: 0.5})
    assert apart(made[-1:], two_seconds()[-1:]) < 1e-9
