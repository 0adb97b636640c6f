"""HermiteCurve and KeyedMotion: frozen keys that sample as they should."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.interpolate import CubicHermiteSpline

from mocurve import HermiteCurve, KeyedMotion, Mismatch, OptionError, Skeleton

SKELETON = Skeleton(("A",), [-1], np.zeros((1, 3)), [("Xposition", "Zrotation")])


def keyed(*curves: HermiteCurve, frames: int = 11, frame_time: float = 0.1) -> KeyedMotion:
    return KeyedMotion(SKELETON, curves, frame_time, frames)


STILL = HermiteCurve([0.0], [5.0], [0.0])
RAMP = HermiteCurve([0.0, 1.0], [0.0, 10.0], [10.0, 10.0])


@given(st.integers(2, 8), st.integers(0, 1000))
def test_samples_are_those_of_the_cubic(count: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    times = np.cumsum(rng.uniform(0.05, 1.0, count))
    values, slopes = rng.normal(size=(2, count))
    curve = HermiteCurve(times, values, slopes)
    at = rng.uniform(times[0], times[-1], 20)
    np.testing.assert_allclose(curve.at(at), CubicHermiteSpline(times, values, slopes)(at), atol=1e-9)
    np.testing.assert_array_equal(curve.at(times), values)


def test_before_the_first_and_after_the_last_key_a_curve_is_constant() -> None:
    curve = HermiteCurve([1.0, 2.0], [3.0, 4.0], [50.0, 50.0])
    np.testing.assert_array_equal(curve.at([-9.0, 0.0, 1.0, 2.0, 9.0]), [3, 3, 3, 4, 4])
    np.testing.assert_array_equal(STILL.at([-1.0, 0.0, 7.0]), 5.0)


def test_a_broken_tangent_arrives_with_its_own_slope() -> None:
    corner = HermiteCurve([0.0, 1.0, 2.0], [0.0, 1.0, 0.0], [1.0, -1.0, -1.0], [1.0, 1.0, -1.0])
    np.testing.assert_allclose(corner.at([0.25, 0.5, 1.0, 1.5]), [0.25, 0.5, 1.0, 0.5])
    assert corner.broken
    assert not RAMP.broken
    assert "broken tangents" in repr(corner)
    assert "broken" not in repr(RAMP)


@pytest.mark.parametrize("times", [[0.0, 0.0], [1.0, 0.0], [0.0, np.nan]])
def test_key_times_must_rise(times: list[float]) -> None:
    with pytest.raises(Mismatch, match="the key times of a curve must rise"):
        HermiteCurve(times, [0.0, 0.0], [0.0, 0.0])


def test_parts_of_different_length_are_refused() -> None:
    with pytest.raises(Mismatch, match="times, values and slopes of a curve differ in length"):
        HermiteCurve([0.0, 1.0], [0.0], [0.0, 0.0])
    with pytest.raises(Mismatch, match="times, values and slopes of a curve differ in length"):
        HermiteCurve([0.0, 1.0], [0.0, 0.0], [0.0, 0.0], [0.0])


def test_what_a_curve_holds_cannot_be_written_and_is_its_own() -> None:
    times = np.array([0.0, 1.0])
    curve = HermiteCurve(times, [0.0, 1.0], [0.0, 0.0])
    times[0] = -5.0
    assert curve.times[0] == 0.0
    for array in (curve.times, curve.values, curve.slopes, curve.in_slopes):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 9.0


def test_a_keyed_motion_counts_and_samples() -> None:
    keys = keyed(STILL, RAMP)
    assert keys.keys == 3
    assert keys.duration == pytest.approx(1.0)
    motion = keys.sample()
    assert motion.frames == 11
    np.testing.assert_array_equal(motion.values[:, 0], 5.0)
    np.testing.assert_allclose(motion.values[:, 1], np.arange(11.0))
    assert keys.sample(0.25).frames == 5
    np.testing.assert_allclose(keys.sample(0.25).values[:, 1], [0, 2.5, 5, 7.5, 10])
    assert repr(keys) == "<KeyedMotion 3 keys for 11 frames x 2 channels>"


def test_as_many_samples_come_back_as_there_were_frames() -> None:
    for rate in (24, 29.97, 30, 59.94, 60, 100, 120, 1000):
        for frames in (1, 2, 3, 1000, 9999):
            assert keyed(STILL, STILL, frames=frames, frame_time=1 / rate).sample().frames == frames


def test_without_frames_there_are_no_keys_and_no_samples() -> None:
    nothing = HermiteCurve([], [], [])
    assert keyed(nothing, nothing, frames=0).sample().values.shape == (0, 2)
    assert repr(nothing) == "<HermiteCurve 0 keys>"


def test_a_curve_too_few_and_a_frame_time_of_nothing_are_refused() -> None:
    with pytest.raises(Mismatch, match="the skeleton has 2 channels, 1 curves are given"):
        keyed(STILL)
    with pytest.raises(OptionError, match="a frame time is a positive number of seconds"):
        keyed(STILL, STILL, frame_time=0.0)
    with pytest.raises(OptionError, match="a frame time is a positive number of seconds"):
        keyed(STILL, STILL).sample(-1.0)
