"""warp: through the values asked for, nothing outside the support, undone exactly."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from turning import ALONG, apart, spline, turning

import mocurve as mc
from mocurve import Mismatch, OptionError, UnknownName, kinematics, rotation

ARM = "LeftArm.Zrotation"
FPS = 120


@pytest.fixture(scope="module")
def motion(jump: Path) -> mc.Motion:
    return mc.read(jump)


@pytest.fixture(scope="module")
def keyed(motion: mc.Motion) -> mc.KeyedMotion:
    return mc.reduce(motion[:240], tolerance="3deg")


def changed_frames(before: mc.Motion, after: mc.Motion) -> np.ndarray:
    return np.flatnonzero((before.values != after.values).any(axis=1))


@pytest.mark.parametrize("mode", ["offset", "scale"])
@pytest.mark.parametrize("overshoot", [True, False])
def test_values_are_met_nothing_changes_outside_and_it_is_undone(motion: mc.Motion, mode: str, overshoot: bool) -> None:
    channel = motion.skeleton.channel(ARM)
    at, frames = [1.0, 1.25, 2.5], [120, 150, 300]
    before = motion.values[frames, channel]
    wanted = before * [1.5, 0.7, 1.2]
    options = {"support": 0.3, "mode": mode, "overshoot": overshoot}
    made = mc.warp(motion, at, {ARM: wanted}, **options)
    np.testing.assert_allclose(made.values[frames, channel], wanted, atol=1e-9)
    others = np.arange(motion.values.shape[1]) != channel
    assert made.values[:, others].tobytes() == motion.values[:, others].tobytes()
    frames = changed_frames(motion, made)
    assert frames.min() >= 0.7 * FPS
    assert frames.max() <= 2.8 * FPS
    assert not ((frames > 1.55 * FPS) & (frames < 2.2 * FPS)).any()  # between two runs of times
    np.testing.assert_allclose(mc.warp(made, at, {ARM: before}, **options).values, motion.values, atol=1e-9)


def test_a_value_that_is_there_changes_nothing(motion: mc.Motion) -> None:
    there = motion.values[120, motion.skeleton.channel(ARM)]
    assert mc.warp(motion, 1.0, {ARM: there}).values.tobytes() == motion.values.tobytes()


def test_without_overshoot_the_change_stays_between_the_changes_asked_for() -> None:
    still = turning(0 * ALONG, 0.0)
    asked = ([0.8, 0.9, 1.0, 1.1], {"Hips.Xrotation": [5.0, 30.0, 30.0, 4.0]})
    free, kept = (mc.warp(still, *asked, support=0.4, overshoot=way).values[:, 4] for way in (True, False))
    assert free.max() > 30.5
    assert kept.max() == 30.0
    assert kept.min() >= 0.0
    assert (np.diff(kept[40:90]) >= 0).all()  # rises to the first 30, falls after the last
    assert np.abs(np.diff(free, 2)).max() < 0.8 * np.abs(np.diff(kept, 2)).max()  # the smooth way is the smoother one


def test_a_pose_is_reached_by_rotations_and_undone(motion: mc.Motion) -> None:
    pose = motion[300:301]
    made = mc.warp(motion, 1.0, pose=pose, support=0.4)
    assert apart(made[120:121], pose) < 1e-9
    frames = changed_frames(motion, made)
    assert frames.min() > 0.6 * FPS - 1
    assert frames.max() < 1.4 * FPS + 1
    assert apart(mc.warp(made, 1.0, pose=motion[120:121], support=0.4), motion) < 1e-9
    # on the way each joint turns about one axis
    way = rotation.log(rotation.mul(rotation.inv(kinematics.rotations(motion)), kinematics.rotations(made)))[100:140]
    assert np.abs(np.cross(way, way[20])).max() < 1e-9


def test_some_joints_take_a_pose_and_several_poses_at_several_times(motion: mc.Motion) -> None:
    made = mc.warp(motion, [1.0, 1.2], pose=motion[300:302], only="*Arm")
    joints = np.array(motion.skeleton.names)[motion.skeleton.channel_joints]
    arms = np.char.endswith(joints, "Arm")
    assert made.values[:, ~arms].tobytes() == motion.values[:, ~arms].tobytes()
    turned, goal = kinematics.rotations(made), kinematics.rotations(motion)
    own = np.char.endswith(np.array(motion.skeleton.names), "Arm")
    assert rotation.angle(turned[[120, 144]][:, own], goal[[300, 301]][:, own]).max() < 1e-9


def test_a_pose_beyond_a_whole_turn_leaves_no_jump_in_the_channels() -> None:
    turned = turning(300 * ALONG, 5.0)
    made = mc.warp(turned, 1.0, pose=turning(320 + 0 * ALONG, 5.0)[:1], support=0.5)
    assert np.abs(np.diff(made.values, axis=0)).max() < 20
    assert apart(made[160:], turned[160:]) < 1e-9


def test_keys_stay_keys_with_one_at_each_time(keyed: mc.KeyedMotion) -> None:
    channel = keyed.skeleton.channel(ARM)
    at = np.array([0.1, 1.003, 1.2])
    made = mc.warp(keyed, at, {ARM: [-30.0, 50.0, None]}, support=0.2)
    np.testing.assert_allclose(made.curves[channel].at(at[:2]), [-30, 50], atol=1e-9)
    assert np.isin([0.1, 1.003], made.curves[channel].times).all()
    assert all(new is old for c, (new, old) in enumerate(zip(made.curves, keyed.curves, strict=True)) if c != channel)
    fine = np.linspace(0, keyed.duration, 3001)
    off = made.curves[channel].at(fine) - keyed.curves[channel].at(fine)
    assert np.abs(off[((fine > 0.3) & (fine < 0.803)) | (fine > 1.203)]).max() < 1e-10
    before = [*keyed.curves[channel].at(at[:2]), None]
    undone = mc.warp(made, at, {ARM: before}, support=0.2)
    assert np.abs(undone.curves[channel].at(fine) - keyed.curves[channel].at(fine)).max() < 1e-9


@pytest.mark.parametrize("degree", [1, 2, 3, 4, 5])
def test_splines_get_the_displacement_added_to_their_coefficients(degree: int) -> None:
    clip = spline(turning(0 * ALONG, 1.0).skeleton, 40, degree, degree)
    at = np.array([0.503, 0.7])
    made = mc.warp(clip, at, {"Hips.Xrotation": [50, 20]}, support=0.3)
    assert made.degree == max(degree, 3)
    np.testing.assert_allclose(made.at(at)[:, 4], [50, 20], atol=1e-9)
    off = made.sample().values - clip.sample().values
    assert np.abs(np.delete(off, 4, axis=1)).max() < 1e-10
    assert np.abs(np.delete(off, np.s_[20:101], axis=0)).max() < 1e-10
    before = clip.at(at)[:, 4]
    assert apart(mc.warp(made, at, {"Hips.Xrotation": before}, support=0.3), clip) < 1e-9


def test_keys_become_samples_for_a_pose_and_that_is_said(keyed: mc.KeyedMotion) -> None:
    pose = keyed.sample()[200:201]
    with pytest.warns(UserWarning, match="keys become samples: a pose, or mode scale, is reached frame by frame"):
        made = mc.warp(keyed, 1.0, pose=pose)
    assert apart(made[120:121], pose) < 1e-9


@pytest.mark.parametrize(
    ("at", "values", "options", "text"),
    [
        (9.0, {ARM: 1}, {}, "9 s lies outside of the clip, which goes from 0 to 3.49167 s"),
        (-0.1, {ARM: 1}, {}, "-0.1 s lies outside of the clip"),
        ([1.0, 1.0], {ARM: [1, 2]}, {}, "two values are asked for at 1 s"),
        ([1.0, 1.001], {ARM: [1, 2]}, {}, "a time between frames counts as the nearer frame"),
        ([1.0, 1.5], {ARM: [1, 2, 3]}, {}, "LeftArm.Zrotation: 3 values are given for 2 times"),
        (1.0, {ARM: float("nan")}, {}, "LeftArm.Zrotation: a value is a number, not nan"),
        (1.0, None, {}, "warp takes values of channels, or a pose; one of them"),
        (1.0, {ARM: 1}, {"support": 0}, "support is a number of seconds above 0, not 0"),
        (1.0, {ARM: 50}, {"mode": "scale"}, "is -79.8726 at 1 s and cannot be multiplied to 50; use mode offset"),
        (1.0, {ARM: 1}, {"only": "*Arm"}, "only says which joints take a pose"),
        ("soon", {ARM: 1}, {}, "at is a time in seconds, or several, not 'soon'"),
        (1.0, 30, {}, "values are given by channel, like LeftArm.Zrotation=30, not as 30"),
    ],
)
def test_wrong_input_is_refused(motion: mc.Motion, at: object, values: object, options: dict, text: str) -> None:
    with pytest.raises(OptionError, match=text):
        mc.warp(motion, at, values, **options)


def test_wrong_names_and_poses_are_refused(motion: mc.Motion) -> None:
    with pytest.raises(UnknownName, match=r"no channel 'LeftArm.Zrotaton'. Did you mean 'LeftArm.Zrotation'"):
        mc.warp(motion, 1.0, {"LeftArm.Zrotaton": 1})
    with pytest.raises(OptionError, match="the pose has 2 frames: one is needed, or one for each of the 1 times"):
        mc.warp(motion, 1.0, pose=motion[:2])
    with pytest.raises(Mismatch, match="joint 1 is 'Hips' in the first"):
        mc.warp(motion, 1.0, pose=mc.Motion(mc.Skeleton(("A",), [-1], [[0, 0, 0]], ((),)), np.zeros((1, 0)), 1.0))
