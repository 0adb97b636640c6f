"""Motion: exactly the file's numbers, cut, resampled, unrolled."""

from __future__ import annotations

from itertools import permutations
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mocurve import Mismatch, Motion, OptionError, Skeleton, kinematics, read, rotation, unroll
from mocurve.motion import frame_count


def joint(*kinds: str, values: object, frame_time: float = 0.1) -> Motion:
    return Motion(Skeleton(("A",), [-1], np.zeros((1, 3)), [kinds]), np.array(values, float), frame_time)


def line(frames: int, frame_time: float = 0.1) -> Motion:
    return joint("Xposition", values=np.arange(float(frames))[:, None], frame_time=frame_time)


def test_values_are_those_given_and_cannot_be_written() -> None:
    given_values = np.array([[1.0, 2.0], [3.0, 4.0]], order="F")
    motion = joint("Xposition", "Xrotation", values=given_values)
    np.testing.assert_array_equal(motion.values, [[1, 2], [3, 4]])
    assert motion.values.flags.f_contiguous
    with pytest.raises(ValueError, match="read-only"):
        motion.values[0, 0] = 7.0


@pytest.mark.parametrize("shape", [(3, 1), (3, 3), (6,), (3, 2, 1)])
def test_values_of_another_shape_are_refused(shape: tuple[int, ...]) -> None:
    with pytest.raises(Mismatch, match=r"the skeleton has 2 channels, the values have shape \("):
        joint("Xposition", "Xrotation", values=np.zeros(shape))


@pytest.mark.parametrize("frame_time", [0.0, -0.1, np.nan, np.inf])
def test_a_frame_time_that_is_no_time_is_refused(frame_time: float) -> None:
    with pytest.raises(OptionError, match="a frame time is a positive number of seconds, not "):
        line(3, frame_time)
    with pytest.raises(OptionError, match="a frame time is a positive number of seconds, not "):
        line(3).sample(frame_time)


@pytest.mark.parametrize(("frames", "duration"), [(0, 0.0), (1, 0.0), (2, 0.1), (11, 1.0)])
def test_the_duration_is_from_the_first_frame_to_the_last(frames: int, duration: float) -> None:
    assert line(frames).duration == pytest.approx(duration)


def test_a_cut_has_the_frames_asked_for() -> None:
    motion = line(10)
    assert motion[2:5].values[:, 0].tolist() == [2, 3, 4]
    assert motion[-3:].values[:, 0].tolist() == [7, 8, 9]
    assert motion[20:].frames == 0
    assert motion[2:5].frame_time == motion.frame_time
    for odd in (3, slice(0, 9, 2), slice(None, None, -1)):
        with pytest.raises(OptionError, match=r"frames are cut with a plain slice, motion\[first:last\]"):
            motion[odd]  # type: ignore[index]


def test_the_representation_says_what_there_is() -> None:
    assert repr(line(11)) == "<Motion 11 frames, 1.00 s, 1 joints, 1 channels>"


# -- sampling ----------------------------------------------------------------------------------------
def test_sampled_at_its_own_frame_time_it_is_itself() -> None:
    motion = line(10)
    assert motion.sample() is motion
    np.testing.assert_array_equal(motion.sample(0.1).values, motion.values)


@given(st.integers(2, 40), st.floats(0.01, 1.0))
def test_a_straight_line_stays_one_at_any_frame_time(frames: int, frame_time: float) -> None:
    again = line(frames).sample(frame_time)
    assert again.frame_time == frame_time
    np.testing.assert_allclose(again.values[:, 0], np.arange(again.frames) * frame_time / 0.1, atol=1e-9)
    assert again.duration <= line(frames).duration + 1e-6 * frame_time
    assert again.duration > line(frames).duration - frame_time


def test_sampling_goes_the_short_way_through_the_half_turn() -> None:
    turning = joint("Zrotation", values=[[170.0], [-170.0], [-150.0]])
    np.testing.assert_allclose(turning.sample(0.05).values[:, 0], [170, 180, 190, 200, 210])


@given(st.integers(1, 5000), st.integers(1, 1000))
def test_rounding_costs_no_frame(frames: int, rate: int) -> None:
    assert frame_count((frames - 1) * (1 / rate), 1 / rate) == frames


@pytest.mark.parametrize("duration", [1e12, float("inf"), float("nan")])
def test_no_clip_has_so_many_frames(duration: float) -> None:
    with pytest.raises(OptionError, match="more than 100,000,000 frames"):
        frame_count(duration, 0.01)


# -- unrolling ---------------------------------------------------------------------------------------
@given(st.permutations("XYZ"), st.integers(0, 1000), st.integers(2, 30))
def test_unrolled_rotations_are_the_same_rotations(order: list[str], seed: int, frames: int) -> None:
    angles = np.random.default_rng(seed).uniform(-400, 400, (frames, 3))
    motion = joint(*(f"{axis}rotation" for axis in order), values=angles)
    again = unroll(motion)
    apart = rotation.angle(kinematics.rotations(motion), kinematics.rotations(again))
    assert apart.max() < 1e-6
    np.testing.assert_array_equal(again.values[0], angles[0])
    np.testing.assert_allclose(unroll(again).values, again.values, atol=1e-9)


@pytest.mark.parametrize("order", ["".join(p) for p in permutations("XYZ")])
def test_a_smooth_turn_written_with_jumps_is_smooth_again(order: str) -> None:
    at = np.linspace(0, 1, 60)[:, None]
    smooth = at * [500.0, 60.0, -800.0] + [10.0, -30.0, 5.0]
    torn = (smooth + 180) % 360 - 180
    other = torn * [1, -1, 1] + [180.0, 180.0, 180.0]
    torn = np.where(np.arange(60)[:, None] % 7 == 3, (other + 180) % 360 - 180, torn)
    motion = joint(*(f"{axis}rotation" for axis in order), values=torn)
    np.testing.assert_allclose(unroll(motion).values, smooth, atol=1e-9)


def test_one_or_two_rotations_lose_whole_turns_and_positions_stay() -> None:
    values = [[350.0, 359.0, 0.0], [720.0, 1.0, 500.0], [1090.0, 3.0, 900.0]]
    again = unroll(joint("Xposition", "Xrotation", "Yrotation", values=values)).values
    np.testing.assert_array_equal(again[:, 0], [350, 720, 1090])
    np.testing.assert_allclose(again[:, 1:], [[359, 0], [361, 140], [363, 180]])


@pytest.mark.parametrize("frames", [0, 1])
def test_nothing_is_to_unroll_in_a_single_frame(frames: int) -> None:
    motion = joint("Xrotation", values=np.full((frames, 1), 900.0))
    assert unroll(motion) is motion


def test_a_real_clip_unrolled_is_at_the_same_places(jump: Path) -> None:
    motion = read(jump)
    np.testing.assert_allclose(kinematics.world(unroll(motion)), kinematics.world(motion), atol=1e-9)
