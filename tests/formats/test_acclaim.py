"""Acclaim pairs: the clips of CMU equal their BVH conversions, and any degrees of freedom mean what the format says."""

from __future__ import annotations

import importlib.util
from functools import partial

import numpy as np
import pytest
from acclaim_pair import ASF, read, refused, write_pair

import mocurve as mc
from mocurve import kinematics, rotation


@pytest.fixture
def pair(tmp_path):
    """pair(old, new, ..., amc=(old, new, ...)) writes the small files with every `old` changed to `new`."""
    return partial(write_pair, tmp_path)


# -- CMU -----------------------------------------------------------------------------------------
@pytest.fixture(scope="module")
def bench(repository):
    spec = importlib.util.spec_from_file_location("bench_acclaim", repository / "benchmarks" / "acclaim.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize("name", ["cmu_01_01.amc", "cmu_02_03.amc", "cmu_05_20.amc"])
def test_cmu_clips_equal_their_bvh_conversions(clips, bench, name):
    conversion, t_poses = bench.PAIRS[name]
    motion, other = read(clips / "cmu" / name), mc.read(clips / "cmu" / conversion)[t_poses:]
    assert motion.frames == other.frames
    away = bench.apart(motion, other)
    assert away[0] < 1e-4
    assert away.max() < 1e-3


def test_channels_about_the_axes_of_the_body_are_the_numbers_of_the_file(clips):
    motion, other = read(clips / "cmu/cmu_01_01.amc"), mc.read(clips / "cmu/cmu_01_01_jump.bvh")[1:]
    for joint, name in (("root", "Hips"), ("lowerback", "LowerBack"), ("head", "Head")):
        for kind in other.skeleton.channels[other.skeleton.joint(name)]:
            ours = motion.values[:, motion.skeleton.channel(f"{joint}.{kind}")]
            theirs = other.values[:, other.skeleton.channel(f"{name}.{kind}")]
            assert np.abs(ours - theirs).max() < 5.01e-5


def test_the_clip_saved_by_blender_is_on_another_body_its_root_scaled(clips):
    motion, other = read(clips / "cmu/cmu_02_01.amc"), mc.read(clips / "cmu/cmu_02_01_walk_blender.bvh")
    assert np.abs(1.06311794 * motion.values[:, :3] - other.values[:, :3]).max() < 1e-4
    turned = [
        kinematics.rotations(clip)[:, clip.skeleton.joint(name)] for clip, name in ((motion, "head"), (other, "Head"))
    ]
    assert rotation.angle(*turned).max() < 1e-3  # what was fitted anew is not all of it
    converted = mc.read(clips / "cmu/cmu_01_01_jump.bvh").skeleton
    inner = ~converted.end_sites
    assert np.abs(other.skeleton.offsets - converted.offsets)[inner].max() < 1e-5  # the body of subject 1, not of 2


def test_the_length_unit_of_cmu_is_known_and_no_other(pair):
    assert read(pair()).skeleton.unit == 0.0254 / 0.45
    assert read(pair("length 0.45", "length 1.0")).skeleton.unit is None
    assert read(pair(":units\n  mass 1.0\n  length 0.45\n  angle deg\n", "")).skeleton.unit is None


# -- what the numbers mean -------------------------------------------------------------------------
def turn(axis: str, degrees: float) -> np.ndarray:
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return np.array({
        "x": [[1, 0, 0], [0, c, -s], [0, s, c]],
        "y": [[c, 0, s], [0, 1, 0], [-s, 0, c]],
        "z": [[c, -s, 0], [s, c, 0], [0, 0, 1]],
    }[axis])  # fmt: skip


def product(order: str, degrees) -> np.ndarray:
    """The first axis turns first."""
    matrix = np.eye(3)
    for axis, angle in zip(order, degrees, strict=True):
        matrix = turn(axis, angle) @ matrix
    return matrix


def joint_place(motion: mc.Motion, name: str, frame: int) -> np.ndarray:
    return kinematics.world(motion)[frame, motion.skeleton.joint(name)]


@pytest.mark.parametrize(
    "axis", ["10 20 30 XYZ", "10 20 30 zyx", "180 -30 -90 YXZ", "-90 1e-16 20 XYZ", "0 90 180 XYZ"]
)
@pytest.mark.parametrize("dof", ["rx ry rz", "rz ry rx", "ry rx", "rz", "rx rz ry"])
def test_a_bone_turns_about_its_own_axes_in_the_order_of_its_dof(pair, axis, dof):
    degrees = [25.0, -50.0, 75.0][: len(dof.split())]
    path = pair(
        "axis 10 20 30 XYZ", f"axis {axis}", "dof rz rx", f"dof {dof}",
        amc=("arm 40 50", "arm " + " ".join(map(str, degrees)), "arm 41 51", "arm " + "0 " * len(degrees)),
    )  # fmt: skip
    *angles, order = axis.split()
    own = product(order.lower(), [dict(zip("xyz", map(float, angles), strict=True))[a] for a in order.lower()])
    back = product("xyz", [10, 20, 30])
    arm = own @ product(dof.replace("r", "").replace(" ", ""), degrees) @ own.T
    start = np.array([1, 2, 3]) + back @ [0, 3, 0]
    motion = read(path)
    assert joint_place(motion, "arm", 0) == pytest.approx(start, abs=1e-12)
    assert joint_place(motion, "arm_End", 0) == pytest.approx(start + back @ arm @ [5, 0, 0], abs=1e-12)


def test_aligned_axes_keep_the_numbers_as_they_are_and_oblique_ones_take_three_channels(pair):
    motion = read(pair())
    channels = dict(zip(motion.skeleton.names, motion.skeleton.channels, strict=True))
    assert channels["back"] == ("Zrotation", "Yrotation", "Xrotation")
    assert channels["arm"] == ("Zrotation", "Yrotation", "Xrotation")
    assert channels["head"] == ("Xrotation", "Zrotation")  # its y is the body's z
    assert motion.values[:, motion.skeleton.channel("head.Zrotation")].tolist() == [5, -7]
    assert motion.values[:, motion.skeleton.channel("head.Xrotation")].tolist() == [6, 8]
    assert motion.values[:, motion.skeleton.channel("back.Yrotation")].tolist() == [20, -0.25]
    assert motion.values[1, :6].tolist() == [1.5, 2.5, 3.5, 30, 20, 10]


def test_bones_that_shift_and_stretch_have_position_channels(pair):
    path = pair(
        "dof rx ry rz\n", "dof l rx tz\n", "    limits (-20.0, 45.0)\n           (-inf inf)\n           (-30.0 30.0)\n",
        "", "dof rz rx", "dof tx l", amc=("back 10 20 30", "back 0.5 90 0.25", "arm 40 50", "arm 2 3"),
    )  # fmt: skip
    motion = read(path)
    way = product("xyz", [10, 20, 30]) @ [1, 0, 0]  # the arm's own x axis
    start = np.array([1, 2, 3.25])
    arm = start + turn("x", 90) @ ([0, 3.5, 0] + 2 * way)
    assert joint_place(motion, "back", 0) == pytest.approx(start, abs=1e-12)
    assert joint_place(motion, "head", 0) == pytest.approx(start + turn("x", 90) @ [0, 3.5, 0], abs=1e-12)
    assert joint_place(motion, "arm", 0) == pytest.approx(arm, abs=1e-12)
    assert joint_place(motion, "arm_End", 0) == pytest.approx(arm + turn("x", 90) @ [8, 0, 0], abs=1e-12)
    assert motion.skeleton.channels[motion.skeleton.joint("arm_End")] == ("Xposition",)
    assert not motion.skeleton.end_sites[motion.skeleton.joint("arm_End")]


@pytest.mark.parametrize("order", ["RZ RY RX TX TY TZ", "TZ TY TX RX RZ RY", "TX RX TY RY TZ RZ"])
def test_the_root_takes_its_numbers_in_any_order(pair, order):
    motion = read(pair("TX TY TZ RX RY RZ", order))
    values = dict(zip(order.lower().split(), [1.5, 2.5, 3.5, 10, 20, 30], strict=True))
    turns = [name for name in order.lower().split() if name[0] == "r"]
    root = product("".join(t[1] for t in turns), [values[t] for t in turns])
    place = np.array([values["tx"], values["ty"], values["tz"]])
    assert joint_place(motion, "root", 1) == pytest.approx(place, abs=1e-12)
    assert joint_place(motion, "arm", 1) == pytest.approx(
        place + root @ product("xyz", [10, -0.25, 30]) @ [0, 3, 0], abs=1e-12
    )


def test_the_place_of_the_root_is_added_and_its_orientation_turns_all_with_a_warning(pair):
    moved = read(pair("position 0 0 0", "position 1 2 3"))
    assert joint_place(moved, "root", 0).tolist() == [2, 4, 6]
    with pytest.warns(UserWarning, match="the root has an orientation, which programs take in different ways"):
        turned = read(pair("orientation 0 0 0", "orientation 0 90 0"))
    straight = kinematics.world(read(pair()))
    assert kinematics.world(turned) == pytest.approx(straight @ turn("y", 90).T, abs=1e-12)


def test_radians_and_degrees_are_told_apart(pair):
    rad = np.radians
    expected = kinematics.world(read(pair()))
    skeleton = (
        "angle deg",
        "angle rad",
        "axis 10 20 30",
        "axis {} {} {}".format(*rad([10, 20, 30])),
        "axis 90",
        f"axis {rad(90)}",
    )
    assert kinematics.world(read(pair(*skeleton))) == pytest.approx(expected, abs=1e-12)  # AMC says degrees
    motion = (
        ":DEGREES\n",
        "",
        "1 2 3 0 0 0",
        "1 2 3 0 0 0",
        "back 10 20 30",
        "back {} {} {}".format(*rad([10, 20, 30])),
    )
    assert kinematics.world(read(pair(*skeleton, amc=motion)))[0, :3] == pytest.approx(expected[0, :3], abs=1e-12)
    said = (":DEGREES", ":radians", "back 10 20 30", "back {} {} {}".format(*rad([10, 20, 30])))
    assert kinematics.world(read(pair(amc=said)))[0, :3] == pytest.approx(expected[0, :3], abs=1e-12)


# -- which skeleton ------------------------------------------------------------------------------
def test_the_skeleton_is_named_or_found(pair, tmp_path, monkeypatch):
    path = pair()
    expected = read(path).values.tolist()
    (tmp_path / "else").mkdir()
    (tmp_path / "small.asf").rename(tmp_path / "else/Body.ASF")
    assert read(path, skeleton=tmp_path / "else/Body.ASF").values.tolist() == expected
    assert read(f"{tmp_path}/else/Body.ASF+{path}").values.tolist() == expected
    path.rename(tmp_path / "else/small.amc")
    assert read(f"{tmp_path}/else/Body.ASF+small.amc").values.tolist() == expected  # in the folder of the first
    monkeypatch.chdir(tmp_path / "else")
    assert read("Body.ASF+small.amc").values.tolist() == expected
    assert read("small.amc").values.tolist() == expected  # the only one there


@pytest.mark.parametrize(
    ("motion", "others", "chosen"),
    [
        ("cmu_01_01", ["cmu", "cmu_01", "cmu_01_0", "cmu_010"], "cmu_01"),
        ("walk", ["walk", "wal", "walk_1"], "walk"),
        ("Walk_2", ["WALK", "other"], "WALK"),
    ],
)
def test_the_longest_name_that_the_motion_begins_with_is_taken(pair, tmp_path, motion, others, chosen):
    path = pair().rename(tmp_path / f"{motion}.amc")
    (tmp_path / "small.asf").unlink()
    for name in others:
        (tmp_path / f"{name}.asf").write_text(ASF if name == chosen else "no skeleton")
    assert read(path).frames == 2


def test_a_motion_without_its_skeleton_says_how_to_name_it(pair, tmp_path):
    path = pair().rename(tmp_path / "run.amc")
    (tmp_path / "walk.asf").write_text(ASF)
    assert "none of the 2 .asf files beside it is called like it: give skeleton=, or both names" in refused(path)
    (tmp_path / "walk.asf").unlink()
    (tmp_path / "small.asf").unlink()
    assert refused(path).endswith("no .asf file is there: give skeleton=, or both names as x.asf+x.amc")


def test_a_skeleton_named_twice_is_refused(pair, tmp_path):
    path = pair()
    for name in (f"{tmp_path}/small.asf+small.amc", tmp_path / "small.asf"):
        with pytest.raises(mc.OptionError, match="names a skeleton already"):
            mc.read(name, skeleton=path)


def test_a_skeleton_alone_is_a_body_without_frames(pair, tmp_path):
    whole = read(pair())
    alone = mc.read(tmp_path / "small.asf")
    assert alone.frames == 0
    assert alone.skeleton.names == ("root", "back", "arm", "arm_End", "head", "head_End")
    assert alone.skeleton.channel_names == whole.skeleton.channel_names
    assert kinematics.rest_height(alone) == 5.0


@pytest.mark.parametrize("name", ["a.amc", "a.asf"])
def test_acclaim_files_are_not_written(tmp_path, small, name):
    with pytest.raises(mc.FileError, match="Acclaim files are only read"):
        mc.write(tmp_path / name, small)
    assert not list(tmp_path.iterdir())
