"""difference, add and scale: what was taken apart goes together again, and half of it is half-way."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from chains import keys, samples
from hypothesis import example, given
from hypothesis import strategies as st
from turning import ALONG, apart, spline, turning

import mocurve as mc
from mocurve import Mismatch, OptionError, UnknownName, kinematics, rotation

HEADINGS = st.floats(-400, 400)


@given(HEADINGS, HEADINGS, st.floats(-1500, 1500), st.floats(-60, 60), st.floats(-60, 60))
@example(0.0, 1e-9, 0.0, 0.0, 0.0)
def test_the_difference_added_to_the_second_is_the_first(
    start: float, other: float, turned: float, tilt: float, sway: float
) -> None:
    a, b = turning(start + turned * ALONG, tilt), turning(other - 0.3 * turned * ALONG, sway)
    assert apart(mc.add(mc.difference(a, b), b), a) < 1e-10


def test_it_is_so_for_real_clips_and_for_joints_of_any_axes(jump: Path) -> None:
    motion = mc.read(jump)
    for a, b in [(motion[:300], motion[120:]), (samples(40), samples(40, size=30.0))]:
        assert apart(mc.add(mc.difference(a, b), b), a) < 1e-10


def test_of_equal_clips_nothing_is_left_and_adding_nothing_changes_nothing(jump: Path) -> None:
    motion = mc.read(jump)
    left = mc.difference(motion, motion)
    assert np.abs(left.values).max() < 1e-10
    nothing = replace(left, values=np.zeros(left.values.shape))
    assert mc.add(nothing, motion).values.tobytes() == motion.values.tobytes()


def test_a_displacement_turns_each_joint_in_its_own_frame(jump: Path) -> None:
    a, b = mc.read(jump)[:100], mc.read(jump)[200:300]
    by, first, second = (kinematics.rotations(clip) for clip in (mc.difference(a, b), a, b))
    assert rotation.angle(rotation.mul(second, by), first).max() < 1e-10


def test_scaled_by_0_1_and_minus_1_it_is_nothing_itself_and_the_way_back(jump: Path) -> None:
    a, b = mc.read(jump)[:300], mc.read(jump)[120:]
    by = mc.difference(a, b)
    assert not mc.scale(by, 0).values.any()
    assert mc.scale(by, 1).values.tobytes() == by.values.tobytes()
    back = rotation.mul(kinematics.rotations(by), kinematics.rotations(mc.scale(by, -1)))
    assert rotation.angle(back, np.array([1.0, 0.0, 0.0, 0.0])).max() < 1e-10


def test_half_of_it_added_is_the_blend_half_way(jump: Path) -> None:
    a, b = mc.read(jump)[:300], mc.read(jump)[120:]
    half = mc.add(mc.scale(mc.difference(a, b), 0.5), b)
    assert apart(half, mc.blend(b, a, 0.5)) < 1e-10


def test_factors_are_for_some_joints_and_change_in_time(jump: Path) -> None:
    a, b = mc.read(jump)[:300], mc.read(jump)[120:]
    by = mc.difference(a, b)
    joints = np.array(by.skeleton.names)[by.skeleton.channel_joints]
    arms = np.char.endswith(joints, "Arm")
    made = mc.scale(by, "*Arm=0")
    assert not made.values[:, arms].any()
    assert made.values[:, ~arms].tobytes() == by.values[:, ~arms].tobytes()
    rising = mc.scale(by, "0:0,2:1")
    assert not rising.values[0].any()
    assert apart(rising[240:], by[240:]) < 1e-10


def test_keys_and_splines_stay_what_they_are_channel_by_channel() -> None:
    body = turning(0 * ALONG, 1.0).skeleton
    a_keys = keys()
    b_keys = replace(a_keys, curves=tuple(replace(c, values=-0.3 * c.values) for c in a_keys.curves[::-1]))
    for a, b in [(a_keys, b_keys), (spline(body, 30, 3, 1), spline(body, 44, 2, 2))]:
        by = mc.difference(a, b, mode="curves")
        assert type(by) is type(a)
        np.testing.assert_allclose(by.sample().values, a.sample().values - b.sample().values, atol=1e-10)
        again = mc.add(by, b)  # as it was made: its history says how
        assert type(again) is type(a)
        np.testing.assert_allclose(again.sample().values, a.sample().values, atol=1e-10)
        np.testing.assert_allclose(mc.scale(by, -0.4).sample().values, -0.4 * by.sample().values, atol=1e-10)


def test_wrong_input_is_refused(jump: Path) -> None:
    motion = mc.read(jump)
    with pytest.raises(
        Mismatch, match=r"difference needs clips of one length, not 0.825 and 1.65833 s: cut or retime one"
    ):
        mc.difference(motion[:100], motion[:200])
    with pytest.raises(Mismatch, match="the skeletons differ: joint 1 is 'Hips' in the first, 'Joint' in the second"):
        mc.add(samples(420), motion)
    with pytest.raises(OptionError, match="a factor is a number"):
        mc.scale(motion, "half")
    with pytest.raises(UnknownName, match=r"no mode 'curve'. Did you mean 'curves'"):
        mc.difference(motion, motion, mode="curve")
