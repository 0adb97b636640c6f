"""limit, of joints: angles that hang on no rest pose, put back exactly; limits of files and of people."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from acclaim_pair import read, write_pair
from people import ELBOWS, KNEES, STEP, askew, person
from turning import apart

import mocurve as mc
from mocurve import OptionError, kinematics, rotation
from mocurve.edit import _anatomy
from mocurve.edit._limits_of import sought
from mocurve.edit._ranges import Ball, Eulers, Hinge
from mocurve.skeleton import JointLimits

GENERAL = (
    "the limits are ranges of people .AAOS 1965, and 15 degrees more., not those of this body: limits .--limit. says"
)
CLIPS = ["cmu_12_01_walk", "cmu_135_04_martial_daz", "cmu_05_20_dance_motionbuilder", "cmu_run_filtered"]


def bending(frames: int = 200) -> np.ndarray:
    """Degrees that a knee bends, 3 backwards at the worst."""
    return 28.0 - 31.0 * np.cos(2 * np.pi * np.arange(frames) * STEP)


def told(made: mc.Clip) -> dict[str, dict]:
    return {row["angle"]: row for row in made.history[-1]["measured"]["angles"]}


def angles(motion: mc.Motion) -> dict[str, np.ndarray]:
    """Every angle of people in a clip."""
    found, _ = _anatomy.of_people(motion)
    return {name: kind.angles(motion.values)[:, k] for kind in found for k, name in enumerate(kind.names)}


# -- angles --------------------------------------------------------------------------------------------
def test_a_knee_that_bends_backwards_is_told_and_mended() -> None:
    clip = person(knee=bending())
    np.testing.assert_allclose(angles(clip)["LeftLeg.flexion"], bending(), atol=1e-9)
    with pytest.warns(UserWarning, match=GENERAL):
        made = mc.limit(clip)
    np.testing.assert_allclose(told(made)["LeftLeg.flexion"]["before"], 3.0, atol=1e-9)
    assert {name for name, row in told(made).items() if row["runs"]} == {"LeftLeg.flexion"}
    after = angles(made)["LeftLeg.flexion"]
    assert after.min() >= -1e-9
    assert told(made)["LeftLeg.flexion"]["acceleration"][1] < 1.05 * told(made)["LeftLeg.flexion"]["acceleration"][0]
    others = clip.skeleton.channel_joints != clip.skeleton.joint("LeftLeg")
    assert made.values[:, others].tobytes() == clip.values[:, others].tobytes()


def test_elbows_and_knees_bend_and_arms_and_legs_hang_where_people_have_them() -> None:
    clip = person()
    found = angles(clip)
    assert len(found) == 12
    for name in (*KNEES, *ELBOWS):
        bend = np.abs(clip.values[:, clip.skeleton.channel(f"{name}.Xrotation")])
        np.testing.assert_allclose(found[f"{name}.flexion"], bend, atol=1e-9)
    for limb in ("LeftArm", "RightArm", "LeftUpLeg", "RightUpLeg"):
        assert np.abs(found[f"{limb}.twist"]).max() < 35
    assert np.abs(found["LeftUpLeg.swing"] - 45).max() < 15  # hanging down is 45 degrees from the middle of its cone
    outside, inside = person(), person()
    column = clip.skeleton.channel("LeftArm.Zrotation")
    for turned, degrees in ((outside, 80), (inside, -60)):  # about ahead: the left arm to its own side, or across
        values = np.array(turned.values)
        values[:, column] = degrees
        swung = angles(replace(turned, values=values))["LeftArm.swing"].mean()
        assert (swung < found["LeftArm.swing"].mean()) == (degrees > 0)


def test_no_angle_hangs_on_the_axes_of_the_joints_or_their_rest_pose() -> None:
    clip = person(knee=bending())
    other = askew(clip)
    assert np.abs(kinematics.world(other) - kinematics.world(clip)).max() < 1e-9
    ours, theirs = angles(clip), angles(other)
    assert ours.keys() == theirs.keys()
    for name, values in ours.items():
        np.testing.assert_allclose(theirs[name], values, atol=1e-8)
    with pytest.warns(UserWarning, match=GENERAL):
        made, mended = mc.limit(clip), mc.limit(other)
    assert np.abs(kinematics.world(mended) - kinematics.world(made)).max() < 1e-6


@pytest.mark.parametrize("kind", [Hinge, Ball, Eulers])
def test_angles_that_are_put_back_are_read_again(kind: type) -> None:
    dice = np.random.default_rng(3)
    clip = person()
    if kind is Eulers:
        axes = rotation.exp(np.array([0.3, -0.5, 0.2]))
        limits = JointLimits(clip.skeleton.joint("LeftArm"), axes, "ZYX", -np.full(3, 60.0), np.full(3, 60.0))
        clip = replace(clip, skeleton=replace(clip.skeleton, limits=(limits,)))
        found, _, _ = sought(clip, None, ())
    else:
        found, _ = _anatomy.of_people(askew(clip))
    own = [one for one in found if isinstance(one, kind)]
    assert own
    for one in own:
        wxyz = dice.normal(size=(50, 4))
        wxyz = rotation.slerp(np.array([1.0, 0, 0, 0]), wxyz / np.linalg.norm(wxyz, axis=1, keepdims=True), 0.4)
        before = one.read(wxyz)
        after = before + dice.uniform(-5, 5, before.shape)
        if kind is Ball:  # where the limb is far from the middle of its cone it swings by all that is asked for
            one = replace(one, high=np.full(2, before[:, 0].min()))
        again = one.read(one.moved(wxyz, before, after))
        np.testing.assert_allclose(np.sin(np.radians(again - after)), 0, atol=1e-9)


def test_a_limb_that_swings_through_the_middle_of_its_cone_does_not_jump() -> None:
    clip = person(100)
    (left,) = (k for k in _anatomy.of_people(clip)[0] if "LeftUpLeg.swing" in k.names)
    swing = np.linspace(-60, 60, 101)  # through the middle, and out again on the other side
    about = np.cross(left.centre, [0.0, 1.0, 0.0])
    start = rotation.from_euler(np.zeros((1, 3)), "ZXY")
    start = left.moved(start, left.read(start), np.zeros((1, 2)))
    turned = rotation.mul(rotation.exp(np.radians(swing)[:, None] * about / np.linalg.norm(about)), start)
    before = left.read(turned)
    made = left.moved(turned, before, before - [20.0, 0.0])
    steps = rotation.angle(made[1:], made[:-1])
    assert steps.max() < 4 * rotation.angle(turned[1:], turned[:-1]).max()


# -- clips -----------------------------------------------------------------------------------------------
@pytest.mark.parametrize("name", CLIPS)
@pytest.mark.filterwarnings("ignore:the limits are ranges of people", "ignore:.* a spike")
def test_after_it_no_frame_of_a_capture_is_beyond_and_a_second_time_changes_nothing(clips: Path, name: str) -> None:
    clip = mc.read(clips / "cmu" / f"{name}.bvh")
    made = mc.limit(clip)
    for angle, row in told(made).items():
        assert row["after"] <= 1e-6, angle
        if row["runs"]:
            assert row["acceleration"][1] < 1.2 * row["acceleration"][0], angle
    found, _ = _anatomy.of_people(clip)
    beyond = np.zeros(clip.frames, bool)
    for kind in found:
        values = kind.angles(clip.values)
        beyond |= ((values > kind.high + 1e-6) | (values < kind.low - 1e-6)).any(axis=1)
    reach = int(0.2 / clip.frame_time)
    near = np.convolve(beyond, np.ones(2 * reach + 1), "same") > 0
    assert made.values[~near].tobytes() == clip.values[~near].tobytes()
    again = mc.limit(made)
    assert again.values.tobytes() == made.values.tobytes()


def test_a_capture_of_a_jump_is_within_what_people_can_do(jump: Path) -> None:
    clip = mc.read(jump)
    made = mc.limit(clip)  # without a warning
    assert made.values is clip.values
    assert len(told(made)) == 12


def test_only_some_joints_and_limits_of_angles_by_name(jump: Path) -> None:
    clip = mc.read(jump)
    assert set(told(mc.limit(clip, only="*Leg"))) == {
        *(f"{side}Leg.flexion" for side in ("Left", "Right")),
        *(f"{side}UpLeg.{angle}" for side in ("Left", "Right") for angle in ("swing", "twist")),
    }
    made = mc.limit(clip, {"*Leg.flexion": (30, None), "LeftArm.twist": (-5, 5), "LeftUpLeg.swing": (None, 40)})
    after = angles(made)
    assert min(after[f"{side}Leg.flexion"].min() for side in ("Left", "Right")) >= 30 - 1e-6
    assert np.abs(after["LeftArm.twist"]).max() <= 5 + 1e-6
    assert after["LeftUpLeg.swing"].max() <= 40 + 1e-6
    assert np.abs(after["LeftArm.swing"] - angles(clip)["LeftArm.swing"]).max() < 1e-9
    assert mc.limit(made, made.history[-1]["limits"]).values.tobytes() == made.values.tobytes()


def test_keys_become_samples_for_angles_and_only_where_something_changes(jump: Path) -> None:
    keys = mc.reduce(mc.read(jump)[:120], tolerance="3deg")
    assert mc.limit(keys).curves == keys.curves
    with pytest.warns(UserWarning, match="keys become samples: they are kept within limits frame by frame"):
        made = mc.limit(keys, {"LeftLeg.flexion": (40, None)})
    assert angles(made)["LeftLeg.flexion"].min() >= 40 - 1e-6


def test_a_knee_of_one_channel_is_limited_in_it() -> None:
    clip = person(knee=bending())
    body = clip.skeleton
    kinds = tuple(("Xrotation",) if name in KNEES else own for name, own in zip(body.names, body.channels, strict=True))
    kept = [c for c, name in enumerate(body.channel_names) if name.split(".")[0] not in KNEES or "Xrot" in name]
    thin = mc.Motion(replace(body, channels=kinds), clip.values[:, kept], STEP)
    with pytest.warns(UserWarning, match=GENERAL):
        made = mc.limit(thin)
    assert made.values[:, made.skeleton.channel("LeftLeg.Xrotation")].min() >= -1e-9


def test_what_is_not_limited_is_told() -> None:
    stiff = person(knee=np.zeros(200))
    lost = mc.limit(stiff).history[-1]["measured"]["not_limited"]
    assert lost[0] == "LeftLeg: bends too little in this clip to tell about which axis"
    assert any(line.startswith("LeftUpLeg: ") for line in lost)
    with pytest.raises(OptionError, match=r"LeftLeg.flexion cannot be limited: LeftLeg: bends too little in this clip"):
        mc.limit(stiff, {"LeftLeg.flexion": (0, 90)})
    loose = person(knee=15 + 60 * np.sin(np.arange(200) / 9))
    assert "LeftLeg: bends now one way, now another: no hinge" in mc.limit(loose).history[-1]["measured"]["not_limited"]


@pytest.mark.parametrize(
    ("upper", "lower"),
    [
        ("LeftUpLeg", "LeftLeg"),
        ("mixamorig:LeftUpLeg", "mixamorig:LeftLeg"),
        ("lfemur", "ltibia"),
        ("lThigh", "lShin"),
        ("LeftHip", "LeftKnee"),
        ("left_hip", "left_knee"),
        ("L_Hip", "L_Knee"),
        ("thigh.L", "shin.L"),
        ("thigh_l", "calf_l"),
        ("Bip01 L Thigh", "Bip01 L Calf"),
        ("LeftUpperLeg", "LeftLowerLeg"),
        ("RightUpLeg", "RightLeg"),
        ("rfemur", "rtibia"),
        ("rThigh", "rShin"),
        ("R_Hip", "R_Knee"),
    ],
)
def test_joints_are_known_by_many_names(upper: str, lower: str) -> None:
    side = -1 if "r" in upper[:1].lower() else 1
    assert _anatomy.hinges(("Hips", upper, lower), np.array([-1, 0, 1])) == {2: ("knee", side)}


@pytest.mark.parametrize("name", ["LeftArm", "LeftLeg", "Spine", "wing_2_L", "LeftHand", "Elbow", "LeftKneeTwist"])
def test_other_joints_are_not(name: str) -> None:
    assert _anatomy.hinges(("Hips", name), np.array([-1, 0])) == {}


# -- limits of files ---------------------------------------------------------------------------------------
def test_acclaim_limits_come_with_the_skeleton_and_stay_with_it_in_our_own_files(tmp_path: Path) -> None:
    clip = read(write_pair(tmp_path, "dof rz rx", "dof rz rx\n    limits (-30 30) (0 45.5)"))
    back, arm = clip.skeleton.limits
    assert (clip.skeleton.names[back.joint], back.order) == ("back", "ZYX")
    assert back.low.tolist() == [-30, -np.inf, -20]
    assert back.high.tolist() == [30, np.inf, 45]
    assert (arm.order, arm.low.tolist(), arm.high.tolist()) == ("XZ", [0, -30], [45.5, 30])
    np.testing.assert_allclose(arm.axes, rotation.from_euler(np.array([30.0, 20.0, 10.0]), "ZYX"), atol=1e-12)
    keys = mc.reduce(clip, tolerance="1deg")
    for name, one in (("a.npz", clip), ("a.curves.json", keys), ("a.spline.json", keys)):
        mc.write(tmp_path / name, one)
        again = mc.read(tmp_path / name).skeleton.limits
        assert [own.joint for own in again] == [back.joint, arm.joint]
        for own, other in zip(again, (back, arm), strict=True):
            assert own.order == other.order
            for part in ("axes", "low", "high"):
                assert getattr(own, part).tobytes() == getattr(other, part).tobytes()


def test_limits_of_a_file_hold_about_the_axes_of_its_bones(tmp_path: Path) -> None:
    path = write_pair(tmp_path, "dof rz rx", "dof rz rx\n    limits (-30 40.5) (0 60)")  # 40 and 41 about z
    clip = replace(read(path), frame_time=0.1)
    more = replace(clip, values=np.vstack([np.repeat(clip.values[:1], 6, axis=0), clip.values[1:]]))
    made = mc.limit(more, support=0.1)
    rows = told(made)
    assert made.history[-1]["measured"]["source"] == "the file"
    assert rows["arm.rz"]["before"] == pytest.approx(0.5, abs=1e-9)
    assert rows["arm.rz"]["after"] <= 1e-6
    assert rows["arm.rx"]["runs"] == 0
    assert {"back.Zrotation", "back.Xrotation"} <= set(rows)
    assert "back.Yrotation" not in rows  # infinite
    (kind,) = (k for k in sought(made, None, ())[0] if "arm.rz" in k.names)
    np.testing.assert_allclose(kind.angles(made.values)[-1], [51, 40.5], atol=1e-5)
    assert mc.limit(made, support=0.1).values.tobytes() == made.values.tobytes()


def test_a_limit_that_the_files_own_motion_breaks_all_the_time_is_not_taken(tmp_path: Path) -> None:
    clip = read(write_pair(tmp_path, "dof rz rx", "dof rz rx\n    limits (-30 30) (0 60)"))
    made = mc.limit(clip)
    assert made.values is clip.values
    assert made.history[-1]["measured"]["not_limited"] == [
        "arm.rz: the file says -30 to 30, and 100 % of its frames are beyond"
    ]
    assert told(mc.limit(clip, {"arm.rz": (-30, 30)}))["arm.rz"]["after"] <= 1e-6  # unless it is asked for


def test_odd_limits_of_a_file_are_left_aside_with_a_warning(tmp_path: Path) -> None:
    path = write_pair(tmp_path, "limits (-20.0, 45.0)", "limits (45.0, -20.0)").with_name("small.asf")
    with pytest.warns(UserWarning, match="the limits of bone 'back' are left aside: a lower one is above the higher"):
        assert mc.read(path).skeleton.limits == ()


def test_limits_of_a_file_in_radians_are_degrees(tmp_path: Path) -> None:
    clip = read(write_pair(tmp_path, "angle deg", "angle rad", "(-20.0, 45.0)", "(-0.5 1)"))
    (back,) = clip.skeleton.limits
    np.testing.assert_allclose([back.low[2], back.high[2]], np.degrees([-0.5, 1]))


@pytest.mark.parametrize("name", ["cmu_16_15.amc", "cmu_09_12.amc"])
@pytest.mark.filterwarnings("ignore:.* a spike")
def test_limits_of_cmu_hold_in_its_captures(clips: Path, name: str) -> None:
    path = clips / "cmu" / name
    clip = read(path, skeleton=path.with_name(f"{name[:6]}.asf"))
    made = mc.limit(clip)
    assert max(row["after"] for row in told(made).values()) <= 1e-6
    assert any(row["runs"] for row in told(made).values())
    assert mc.limit(made).values.tobytes() == made.values.tobytes()


@pytest.mark.parametrize(
    ("change", "text"),
    [
        ({"joint": 99}, "joint limits are of the joints 0 to 14, each once, not of"),
        ({"low": [50.0]}, r"joint limits from \[50.0\] to \[40.0\]: the lower is above the higher"),
        ({"low": [np.nan]}, "joint limits about 'X' have 1 low, not"),
        ({"order": "W"}, "joint limits are about one to three axes of XYZ, not 'W'"),
        ({"axes": [1.0, 1.0, 0.0, 0.0]}, "the axes of joint limits are a quaternion of length 1"),
    ],
)
def test_wrong_limits_of_joints_are_refused(change: dict, text: str) -> None:
    fine = {"joint": 3, "axes": [1.0, 0.0, 0.0, 0.0], "order": "X", "low": [-40.0], "high": [40.0]}
    body = person(1).skeleton
    assert replace(body, limits=(JointLimits(**fine),)).limits[0].joint == 3
    with pytest.raises((mc.Mismatch, OptionError), match=text):
        replace(body, limits=(JointLimits(**(fine | change)),))


def test_a_file_with_broken_limits_is_refused(tmp_path: Path) -> None:
    clip = person(2)
    limits = (JointLimits(3, np.array([1.0, 0, 0, 0]), "X", np.array([-40.0]), np.array([np.inf])),)
    keys = mc.reduce(replace(clip, skeleton=replace(clip.skeleton, limits=limits)), tolerance="1deg")
    path = tmp_path / "a.curves.json"
    mc.write(path, keys)
    text = path.read_text()
    assert '"high": [null]' in text
    for old, new in (('"order": "X"', '"order": "Q"'), ('"low": [-40.0]', '"low": 3'), ('"low": [-40.0], ', "")):
        assert old in text
        path.write_text(text.replace(old, new))
        with pytest.raises(mc.FileError, match=r"joints\[3\].limits: "):
            mc.read(path)


def test_apart_is_nothing_where_nothing_was_to_be_done(jump: Path) -> None:
    clip = mc.read(jump)
    assert apart(mc.limit(clip), clip) < 1e-12


@pytest.mark.parametrize(
    ("part", "ahead", "aside"),  # degrees that a hanging limb is raised ahead, then turned to its own side
    [("knee", 120, 0), ("knee", -30, 0), ("elbow", 180, 0), ("elbow", -60, 0), ("elbow", 90, -40)],
)
def test_the_cones_hold_what_is_normal_and_no_more_than_the_allowance(part: str, ahead: float, aside: float) -> None:
    middle, wide = _anatomy.CONES[part]
    up, out = np.radians([ahead, aside])
    limb = np.array([np.sin(up) * np.sin(out), -np.cos(up), np.sin(up) * np.cos(out)])
    away = np.degrees(np.arccos(limb @ np.array(middle) / np.linalg.norm(middle)))
    assert away == pytest.approx(wide - _anatomy.ALLOWANCE, abs=0.2)
