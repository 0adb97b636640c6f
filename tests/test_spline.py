"""SplineMotion: frozen curves on one basis, exact between keys and splines, aligned without change."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mocurve import HermiteCurve, KeyedMotion, Mismatch, Motion, OptionError, Skeleton, bspline, spline
from mocurve.spline import SplineMotion, align

SKELETON = Skeleton(("A",), [-1], np.zeros((1, 3)), [("Xposition", "Zrotation")])
OTHER = Skeleton(("A",), [-1], np.zeros((1, 3)), [("Xposition", "Yrotation")])
SEEDS = st.integers(0, 10_000)


def curves(seed: int, degree: int = 3, spans: int = 6) -> SplineMotion:
    rng = np.random.default_rng(seed)
    breaks = np.concatenate([[0.0], np.sort(rng.uniform(0.01, 0.99, spans - 1)), [1.0]])
    return SplineMotion(
        SKELETON, bspline.clamped(breaks, degree), rng.normal(size=(spans + degree, 2)), degree, 0.05, 21
    )


def keyed(seed: int, broken: bool = False) -> KeyedMotion:
    """Keys at frames; the first channel begins late and ends early."""
    rng = np.random.default_rng(seed)
    made = []
    for first, last in ((3, 17), (0, 20)):
        frames = np.concatenate([[first], np.sort(rng.choice(np.arange(first + 1, last), 4, replace=False)), [last]])
        values, slopes, arriving = rng.normal(size=(3, 6))
        made.append(HermiteCurve(frames * 0.05, values, slopes, arriving if broken else None))
    return KeyedMotion(SKELETON, tuple(made), 0.05, 21)


AT = np.linspace(-0.1, 1.1, 241)


def keyed_at(keys: KeyedMotion) -> np.ndarray:
    return np.stack([curve.at(AT) for curve in keys.curves], axis=1)


# -- the noun --------------------------------------------------------------------------------------
def test_it_counts_samples_and_says_what_it_is() -> None:
    clip = curves(1)
    assert clip.keys == 18
    assert clip.duration == pytest.approx(1.0)
    assert clip.domain == (0.0, 1.0)
    motion = clip.sample()
    assert (motion.frames, motion.frame_time) == (21, 0.05)
    np.testing.assert_allclose(motion.values, clip.at(np.arange(21) * 0.05))
    assert clip.sample(0.25).frames == 5
    assert repr(clip) == "<SplineMotion 9 coefficients of degree 3 for 21 frames x 2 channels>"


def test_what_it_holds_cannot_be_written_and_is_its_own() -> None:
    knots = bspline.clamped(np.array([0.0, 1.0]))
    clip = SplineMotion(SKELETON, knots, np.zeros((4, 2)), 3, 0.1, 11)
    knots[0] = -5.0
    assert clip.knots[0] == 0.0
    for array in (clip.knots, clip.values):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 9.0


def test_a_clip_of_one_frame_is_sampled() -> None:
    clip = SplineMotion(SKELETON, bspline.clamped(np.array([0.0, 0.1])), np.ones((4, 2)), 3, 0.1, 1)
    np.testing.assert_array_equal(clip.sample().values, [[1.0, 1.0]])
    assert clip.duration == 0.0


def test_what_is_no_spline_is_refused() -> None:
    with pytest.raises(Mismatch, match=r"2 channels, the coefficients have shape \(9, 1\)"):
        replace(curves(1), values=np.zeros((9, 1)))
    with pytest.raises(Mismatch, match="8 coefficients of degree 3 have 12 knots, not 13"):
        replace(curves(1), values=np.zeros((8, 2)))
    with pytest.raises(OptionError, match="frame time"):
        replace(curves(1), frame_time=0.0)


def test_samples_are_a_spline_of_degree_1() -> None:
    values = np.random.default_rng(0).normal(size=(21, 2))
    clip = SplineMotion(SKELETON, bspline.clamped(np.arange(21) * 0.05, 1), values, 1, 0.05, 21)
    np.testing.assert_array_equal(clip.sample().values, values)


# -- keys ------------------------------------------------------------------------------------------
@given(SEEDS, st.booleans())
def test_keys_become_a_spline_and_the_spline_keys_and_nothing_moves(seed: int, broken: bool) -> None:
    keys = keyed(seed, broken)
    clip = spline.of_keys(keys)
    np.testing.assert_allclose(clip.at(AT), keyed_at(keys), atol=1e-10)
    np.testing.assert_allclose(keyed_at(spline.to_keys(clip)), keyed_at(keys), atol=1e-10)


@given(SEEDS, st.integers(1, 3))
def test_a_spline_up_to_degree_3_has_the_same_curves_as_keys(seed: int, degree: int) -> None:
    clip = curves(seed, degree)
    keys = spline.to_keys(clip)
    np.testing.assert_allclose(keyed_at(keys), clip.at(AT), atol=1e-10)
    assert any(curve.broken for curve in keys.curves) == (degree == 1)


def test_a_degree_that_keys_do_not_have_is_refused() -> None:
    with pytest.raises(Mismatch, match="degree 4 has no Hermite keys"):
        spline.to_keys(curves(1, 4))


def test_single_keys_and_none_become_constants() -> None:
    one, none = HermiteCurve([0.0], [5.0], [1.0]), HermiteCurve([], [], [])
    np.testing.assert_array_equal(
        spline.of_keys(KeyedMotion(SKELETON, (one, none), 0.1, 3)).sample().values, [[5, 0]] * 3
    )


# -- a common basis --------------------------------------------------------------------------------
@given(SEEDS, st.integers(1, 5), st.integers(1, 5))
def test_aligned_splines_share_their_basis_and_nothing_moves(seed: int, p: int, q: int) -> None:
    a, b = curves(seed, p), curves(seed + 1, q, spans=9)
    one, two = align(a, b)
    np.testing.assert_array_equal(one.knots, two.knots)
    assert one.degree == two.degree == max(p, q)
    np.testing.assert_allclose(one.at(AT), a.at(AT), atol=1e-11)
    np.testing.assert_allclose(two.at(AT), b.at(AT), atol=1e-11)


def test_aligning_what_is_aligned_changes_nothing() -> None:
    a = curves(1)
    one, two = align(a, replace(a, values=2 * a.values))
    assert one is a
    np.testing.assert_array_equal(two.values, 2 * a.values)
    again, _ = align(*align(a, curves(2)))
    assert len(again.values) == len(align(a, curves(2))[0].values)


@given(SEEDS)
def test_knots_apart_by_rounding_are_one(seed: int) -> None:
    a = curves(seed)
    inner = a.knots.copy()
    inner[4:-4] *= 1 + 1e-14
    one, _ = align(a, replace(a, knots=inner))
    assert len(one.values) == len(a.values)


@given(SEEDS, st.booleans())
def test_aligned_keys_share_their_times_and_nothing_moves(seed: int, broken: bool) -> None:
    a, b = keyed(seed, broken), keyed(seed + 1, broken)
    one, two = align(a, b)
    for mine, others in zip(one.curves, two.curves, strict=True):
        np.testing.assert_array_equal(mine.times, others.times)
    np.testing.assert_allclose(keyed_at(one), keyed_at(a), atol=1e-10)
    np.testing.assert_allclose(keyed_at(two), keyed_at(b), atol=1e-10)
    kept = np.isin(one.curves[1].times, a.curves[1].times)
    np.testing.assert_array_equal(one.curves[1].values[kept], a.curves[1].values)


def test_aligned_motions_have_the_finer_frame_time() -> None:
    coarse = Motion(SKELETON, np.arange(22.0).reshape(11, 2), 0.1)
    fine = Motion(SKELETON, np.zeros((21, 2)), 0.05)
    one, two = align(coarse, fine)
    assert one.values.shape == two.values.shape == (21, 2)
    np.testing.assert_array_equal(two.values, fine.values)
    np.testing.assert_allclose(one.values[::2], coarse.values)


def test_what_shares_no_basis_is_refused() -> None:
    a = curves(1)
    with pytest.raises(Mismatch, match=r"the first has 'A.Zrotation' where the second has 'A.Yrotation'"):
        align(a, replace(a, skeleton=OTHER))
    with pytest.raises(Mismatch, match="a SplineMotion and a Motion share no basis"):
        align(a, a.sample())
    with pytest.raises(Mismatch, match=r"last 1 and 0\.5 s"):
        align(a, replace(a, frames=11))
    with pytest.raises(Mismatch, match="the splines lie from 0 to 1 s and 0 to 2 s"):
        align(a, replace(a, knots=a.knots * 2))
    with pytest.raises(Mismatch, match="raised from 3 on, not lowered to 2"):
        spline.raised(a, 2)
