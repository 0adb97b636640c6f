"""Forward kinematics against the plainest form of itself, rotations there and back, measures of the rest pose."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mocurve import Mismatch, Motion, Skeleton, kinematics, read, rotation
from mocurve.skeleton import AXES

KINDS = {
    "X": np.array([1.0, 0.0, 0.0]),
    "Y": np.array([0.0, 1.0, 0.0]),
    "Z": np.array([0.0, 0.0, 1.0]),
}
POSITIONS, ROTATIONS = ("Xposition", "Yposition", "Zposition"), ("Zrotation", "Yrotation", "Xrotation")


def plain_world(motion: Motion) -> np.ndarray:
    """One frame, one joint, one 3x3 matrix at a time: Rodrigues' formula and a matrix product."""
    skeleton = motion.skeleton
    places = np.zeros((motion.frames, len(skeleton.names), 3))
    for f in range(motion.frames):
        matrices: list[np.ndarray] = []
        row = iter(motion.values[f])
        for j, (parent, kinds) in enumerate(zip(skeleton.parents, skeleton.channels, strict=True)):
            offset, turn = skeleton.offsets[j].copy(), np.eye(3)
            for kind in kinds:
                value = next(row)
                if kind.endswith("position"):
                    offset[AXES.index(kind[0])] = value
                else:
                    x, y, z = KINDS[kind[0]]
                    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
                    angle = np.radians(value)
                    turn = turn @ (np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross)
            above = matrices[parent] if parent >= 0 else np.eye(3)
            places[f, j] = (places[f, parent] if parent >= 0 else 0.0) + above @ offset
            matrices.append(above @ turn)
    return places


def chain(*channels: tuple[str, ...], values: object, offset: float = 10.0) -> Motion:
    """A chain of joints along Y, with an end site, and one row of values a frame."""
    count = len(channels) + 1
    offsets = [[0.0, offset if j else 0.0, 0.0] for j in range(count)]
    names = [*(f"J{j}" for j in range(count - 1)), "End"]
    ends = [False] * (count - 1) + [True]
    return Motion(Skeleton(names, range(-1, count - 1), offsets, (*channels, ()), ends), np.array(values, float), 0.01)


@st.composite
def motions(draw: st.DrawFn) -> Motion:
    """Up to six joints under some roots, each with any channels in any order, some angles multiples of 90 degrees."""
    count = draw(st.integers(1, 6))
    parents, branch = [-1], [-1, 0]  # depth first: a joint hangs on the one before it or on one above that
    for j in range(1, count):
        parents.append(draw(st.sampled_from(branch)))
        branch = [*branch[: branch.index(parents[-1]) + 1], j]
    kinds = st.lists(st.sampled_from([*POSITIONS, *ROTATIONS]), max_size=6)
    channels = [tuple(draw(kinds)) for _ in range(count)]
    number = st.floats(-400, 400) | st.integers(-4, 4).map(lambda turns: 90.0 * turns)
    offsets = [[draw(number) for _ in range(3)] for _ in range(count)]
    frames, width = draw(st.integers(0, 4)), sum(map(len, channels))
    values = np.array([[draw(number) for _ in range(width)] for _ in range(frames)]).reshape(frames, width)
    return Motion(Skeleton([f"J{j}" for j in range(count)], parents, offsets, channels), values, 0.01)


# -- places ------------------------------------------------------------------------------------------
@settings(deadline=None)  # the first one compiles
@given(motions())
def test_places_are_those_of_the_plain_product_of_matrices(motion: Motion) -> None:
    places = kinematics.world(motion)
    assert places.shape == (motion.frames, len(motion.skeleton.names), 3)
    np.testing.assert_allclose(places, plain_world(motion), rtol=0, atol=1e-9)


@pytest.mark.parametrize("frames", [255, 256, 257, 700])
def test_places_do_not_depend_on_how_many_frames_are_walked_at_once(frames: int) -> None:
    values = np.random.default_rng(0).uniform(-180, 180, (frames, 9))
    motion = chain((*POSITIONS, *ROTATIONS), ROTATIONS, values=values)
    np.testing.assert_allclose(kinematics.world(motion), plain_world(motion), rtol=0, atol=1e-9)


def test_a_position_channel_replaces_its_axis_of_the_offset_and_leaves_the_others() -> None:
    motion = chain((), ("Xposition",), values=[[3.0], [0.0]])
    np.testing.assert_array_equal(kinematics.world(motion)[:, 1], [[3.0, 10.0, 0.0], [0.0, 10.0, 0.0]])


def test_a_root_stands_where_its_channels_say_to_the_last_digit() -> None:
    values = np.random.default_rng(0).normal(0.1, 1e3, (50, 6))
    motion = chain((*POSITIONS, *ROTATIONS), values=values)
    np.testing.assert_array_equal(kinematics.world(motion)[:, 0], values[:, :3])


def test_a_turn_moves_what_hangs_below_and_not_the_joint_itself() -> None:
    motion = chain(("Zrotation",), ("Xrotation", "Zrotation"), values=[[90.0, 90.0, 0.0], [0.0, 90.0, 90.0]])
    expected = [[[0, 0, 0], [-10, 0, 0], [-10, 0, 10]], [[0, 0, 0], [0, 10, 0], [-10, 10, 0]]]
    np.testing.assert_allclose(kinematics.world(motion), expected, atol=1e-14)


@pytest.mark.parametrize("name", ["cmu/cmu_01_01_jump", "cmu/cmu_135_04_martial_daz", "other/rokoko_dance_fingers"])
def test_places_of_real_clips_are_right_to_nine_digits(clips: Path, name: str) -> None:
    motion = read(clips / f"{name}.bvh")[300:310]
    expected = plain_world(motion)
    np.testing.assert_allclose(kinematics.world(motion), expected, rtol=0, atol=1e-9 * np.abs(expected).max())


# -- rotations there and back ------------------------------------------------------------------------
@settings(deadline=None)
@given(motions())
def test_rotations_written_back_change_no_digit(motion: Motion) -> None:
    again = kinematics.with_rotations(motion, kinematics.rotations(motion))
    np.testing.assert_array_equal(again.values, motion.values)


@settings(deadline=None)
@given(motions(), st.integers(0, 5))
def test_rotations_that_channels_express_are_expressed(motion: Motion, seed: int) -> None:
    angles = np.random.default_rng(seed).uniform(-400, 400, motion.values.shape)
    turned = replace(motion, values=np.where(motion.skeleton.rotation_channels, angles, motion.values))
    wanted = kinematics.rotations(turned)
    written = kinematics.with_rotations(motion, wanted)
    assert rotation.angle(kinematics.rotations(written), wanted).max(initial=0.0) < 1e-9
    np.testing.assert_allclose(kinematics.world(written), kinematics.world(turned), rtol=0, atol=1e-8)
    kept = ~motion.skeleton.rotation_channels
    np.testing.assert_array_equal(written.values[:, kept], motion.values[:, kept])


def test_only_joints_that_turn_otherwise_are_written_anew(jump: Path) -> None:
    motion = read(jump)
    wanted = kinematics.rotations(motion)
    knee = motion.skeleton.joint("LeftLeg")
    wanted[:, knee] = rotation.mul(wanted[:, knee], rotation.from_euler(np.array([5.0]), "X"))
    changed = np.any(kinematics.with_rotations(motion, wanted).values != motion.values, axis=0)
    assert set(motion.skeleton.channel_joints[changed]) == {knee}


def test_angles_written_back_start_near_those_of_the_first_frame_and_do_not_jump() -> None:
    turning = np.linspace(700.0, 1100.0, 30)[:, None] + [0.0, 20.0, 0.0]
    motion = chain(ROTATIONS, values=turning)
    wanted = rotation.mul(kinematics.rotations(motion), rotation.from_euler(np.array([0.0, 0.0, 1.0]), "ZYX"))
    wanted[:, 1] = kinematics.rotations(motion)[:, 1]
    written = kinematics.with_rotations(motion, wanted).values
    assert np.abs(written - turning).max() < 30.0
    assert np.abs(np.diff(written, axis=0)).max() < 30.0


@pytest.mark.parametrize(
    ("joint", "turn", "message"),
    [
        (0, "Z", r"the rotation of joint 'J0' \(Xrotation Yrotation\) at frame 1 cannot be expressed by the channels"),
        (1, "X", r"the rotation of joint 'J1' \(no channels\) at frame 1 cannot be expressed by the channels"),
        (2, "X", r"the rotation of joint 'End' \(no channels\) at frame 1 cannot be expressed"),
    ],
)
def test_a_rotation_that_the_channels_cannot_express_is_refused(joint: int, turn: str, message: str) -> None:
    motion = chain(("Xrotation", "Yrotation"), (), values=np.zeros((3, 2)))
    wanted = kinematics.rotations(motion)
    wanted[1, joint] = rotation.from_euler(np.array([0.01]), turn)
    with pytest.raises(Mismatch, match=message):
        kinematics.with_rotations(motion, wanted)


@pytest.mark.parametrize("spoilt", [0.0, 1.1, np.nan])
def test_what_is_no_unit_quaternion_is_refused(spoilt: float) -> None:
    motion = chain(ROTATIONS, values=np.zeros((3, 3)))
    wanted = kinematics.rotations(motion)
    wanted[2, 0] *= spoilt
    with pytest.raises(Mismatch, match=r"joint 'J0' .* at frame 2 is no quaternion of length 1"):
        kinematics.with_rotations(motion, wanted)


def test_rotations_of_another_shape_are_refused() -> None:
    motion = chain(ROTATIONS, values=np.zeros((3, 3)))
    with pytest.raises(Mismatch, match=r"shape \(2, 2, 4\), the motion needs \(frames, joints, 4\) = \(3, 2, 4\)"):
        kinematics.with_rotations(motion, kinematics.rotations(motion)[:2])


# -- the body at rest --------------------------------------------------------------------------------
def test_bone_lengths_kept_in_position_channels_count_at_rest() -> None:
    motion = chain(POSITIONS, POSITIONS, values=[[5.0, 90.0, 5.0, 0.0, 30.0, 4.0]] * 3, offset=0.0)
    np.testing.assert_array_equal(kinematics.rest_offsets(motion)[:2], [[0.0, 0.0, 0.0], [0.0, 30.0, 4.0]])
    assert kinematics.rest_height(motion) == 30.0
    assert kinematics.rest_height(motion[:0]) == 0.0
    np.testing.assert_array_equal(motion.skeleton.offsets, 0.0)


def test_the_rest_height_is_the_largest_extent_whichever_axis_is_up() -> None:
    parents, offsets = [-1, 0, 1, 0, 3], [[7, 7, 7], [0, 0, 50], [0, 0, 5], [0, 1, -40], [3, 0, 0]]
    skeleton = Skeleton("abcde", parents, offsets, [()] * 5, [0, 0, 1, 0, 1])
    motion = Motion(skeleton, np.zeros((1, 0)), 0.01)
    assert kinematics.rest_height(motion) == 95.0
    np.testing.assert_allclose(kinematics.reach(motion), [55.0, 5.0, 0.0, 3.0, 0.0])


def test_the_rest_height_is_the_extent_of_the_clip_without_rotations(jump: Path) -> None:
    motion = read(jump)
    rest = kinematics.world(replace(motion, values=np.zeros_like(motion.values)))[0]
    assert kinematics.rest_height(motion) == pytest.approx(np.ptp(rest, axis=0).max(), rel=1e-12)


def test_no_place_is_farther_from_a_joint_than_its_reach(jump: Path) -> None:
    motion = read(jump)
    places, reach = kinematics.world(motion), kinematics.reach(motion)
    for joint in range(len(reach)):
        below = motion.skeleton.below(joint)
        distance = np.linalg.norm(places[:, below] - places[:, joint : joint + 1], axis=2).max()
        assert distance <= reach[joint] * (1 + 1e-12)
    assert reach[motion.skeleton.joint("LeftLeg")] > 0


def test_asking_for_the_rest_pose_loads_no_compiler() -> None:
    code = "import sys, mocurve.kinematics, mocurve.info; sys.exit('numba' in sys.modules or 'scipy' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
