"""Legs: found by name and shape in the skeletons that there are, with joints in between and without toes."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from legged import with_twist, without

import mocurve as mc
from mocurve import Mismatch, OptionError, UnknownName
from mocurve.feet.legs import legs, tracks
from mocurve.kinematics import world


def told(clip: mc.Motion, feet: list[str] | None = None) -> list[tuple[str, ...]]:
    names = clip.skeleton.names
    return [tuple(names[joint] for joint in leg[:4]) for leg in legs(clip, feet)]


def renamed(clip: mc.Motion, *pairs: tuple[str, str]) -> mc.Motion:
    names = list(clip.skeleton.names)
    for old, new in pairs:
        names = [name.replace(old, new) for name in names]
    return replace(clip, skeleton=replace(clip.skeleton, names=tuple(names)))


@pytest.fixture(scope="module")
def clip(jump: Path) -> mc.Motion:
    motion = mc.read(jump)
    assert isinstance(motion, mc.Motion)
    return motion


CMU = ("LeftUpLeg", "LeftLeg", "LeftFoot", "LeftToeBase")


def test_the_thigh_begins_below_short_bones_of_the_pelvis(clip: mc.Motion) -> None:
    assert told(clip) == [CMU, tuple(name.replace("Left", "Right") for name in CMU)]


@pytest.mark.parametrize(
    ("pairs", "expected"),
    [
        ([("UpLeg", "Thigh"), ("Leg", "Calf"), ("ToeBase", "Ball")], ("LeftThigh", "LeftCalf", "LeftFoot", "LeftBall")),
        ([("Foot", "Ankle"), ("UpLeg", "Hip"), ("Leg", "Knee")], ("LeftHip", "LeftKnee", "LeftAnkle", "LeftToeBase")),
    ],
)
def test_other_names_are_known(clip: mc.Motion, pairs: list[tuple[str, str]], expected: tuple[str, ...]) -> None:
    assert told(renamed(clip, *pairs))[0] == expected


def test_legs_without_names_are_found_once_their_toes_are_named(clip: mc.Motion) -> None:
    nameless = renamed(clip, ("Foot", "C"), ("ToeBase", "D"), ("UpLeg", "A"), ("Leg", "B"))
    with pytest.raises(Mismatch, match="two feet are needed, and 0 were found"):
        legs(nameless)
    assert told(nameless, ["LeftD", "RightD"])[0] == ("LeftA", "LeftB", "LeftC", "LeftD")


def test_joints_between_do_not_mislead(clip: mc.Motion) -> None:
    twisted = with_twist(with_twist(clip, "LeftUpLeg", "LeftLeg", 0.5), "LeftLeg", "LeftFoot", 0.5)
    assert told(twisted)[0] == CMU


def test_without_toes_the_end_site_or_the_ankle_is_the_ball(clip: mc.Motion) -> None:
    bare = without(clip, "LeftToeBase", "RightToeBase")
    assert told(bare)[0] == (*CMU[:3], "LeftFoot")
    balls, heels = tracks(bare, legs(bare))
    np.testing.assert_allclose(balls[0], world(bare)[:, bare.skeleton.joint("LeftFoot")])
    np.testing.assert_allclose(heels, balls, atol=1e-12)


def test_the_heel_is_on_the_floor_behind_the_ankle(clip: mc.Motion) -> None:
    both = legs(clip)
    balls, heels = tracks(clip, both)
    lowest = int(np.argmin((balls[0] + world(clip)[:, both[0].ankle])[:, 1]))
    ankle = world(clip)[lowest, both[0].ankle]
    assert heels[0, lowest, 1] == pytest.approx(min(ankle[1], balls[0, lowest, 1]))
    forward = (balls[0, lowest] - ankle)[[0, 2]]
    np.testing.assert_allclose((heels[0, lowest] - ankle)[[0, 2]], -0.25 * forward, atol=1e-9)
    apart = np.linalg.norm(heels[0] - world(clip)[:, both[0].ankle], axis=1)
    np.testing.assert_allclose(apart, apart[0])


@pytest.mark.parametrize(
    ("feet", "error", "words"),
    [
        (["LeftToeBase"], Mismatch, "two feet are needed, and 1 were found"),
        (["LeftToeBase", "LeftFoot"], Mismatch, "two feet are needed"),
        (["LeftToeBase", "RightToBase"], UnknownName, "Did you mean 'RightToeBase'"),
        (["LeftHand", "RightToeBase"], None, ""),
        (["Hips", "RightToeBase"], Mismatch, "hangs on no leg"),
        ([5, 6], OptionError, "two names of joints"),
        (5, OptionError, "two names of joints"),
    ],
)
def test_feet_that_cannot_be_are_refused(clip: mc.Motion, feet: Any, error: type[Exception] | None, words: str) -> None:
    if error is None:
        assert told(clip, feet)[0][2] == "LeftForeArm"  # whoever asks for hands to stand on gets them
        return
    with pytest.raises(error, match=words):
        legs(clip, feet)


def test_a_body_without_knees_is_refused() -> None:
    skeleton = mc.Skeleton(
        ("Hips", "LeftHip", "LeftFoot", "RightHip", "RightFoot"),
        [-1, 0, 1, 0, 3],
        np.ones((5, 3)),
        [("Xposition",), (), (), (), ()],
    )
    with pytest.raises(Mismatch, match="two feet are needed"):
        legs(mc.Motion(skeleton, np.zeros((3, 1)), 0.01))
    with pytest.raises(Mismatch, match="there is no knee"):
        legs(mc.Motion(skeleton, np.zeros((3, 1)), 0.01), ["LeftFoot", "RightFoot"])


def test_feet_of_one_name_are_refused(clip: mc.Motion) -> None:
    with pytest.raises(Mismatch, match="several joints of the feet are called 'ToeBase'"):
        legs(renamed(clip, ("LeftToeBase", "ToeBase"), ("RightToeBase", "ToeBase")))


def test_legs_of_all_clips_are_found(clips: Path) -> None:
    expected = {
        "other/rokoko_dance_fingers.bvh": "LeftUpLeg LeftLeg LeftFoot LeftToeBase",
        "other/hands_60_joints.bvh": "RightUpLeg RightLeg RightFoot RightForeFoot",
        "cmu/cmu_135_04_martial_daz.bvh": "rThigh rShin rFoot rFoot_End",
        "cmu/cmu_walk_daz19.bvh": "RightHip RightKnee RightAnkle RightAnkle_End",
        "cmu/cmu_02_03_run.bvh": "lfemur ltibia lfoot ltoes",
    }
    for name, joints in expected.items():
        motion = mc.read(clips / name)
        assert isinstance(motion, mc.Motion)
        assert told(motion)[0] == tuple(joints.split()), name
