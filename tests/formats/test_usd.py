"""What a USD file says, read back by USD's own library; what needs no library is read as text."""

from __future__ import annotations

import chains
import numpy as np
import pytest

import mocurve as mc
from mocurve import kinematics


@pytest.fixture
def usd():
    """OpenUSD's modules Usd, UsdGeom, UsdSkel."""
    pxr = pytest.importorskip("pxr", reason="needs usd-core: pip install 'mocurve[usd]'")
    from pxr import Usd, UsdGeom, UsdSkel

    assert pxr
    return Usd, UsdGeom, UsdSkel


def joints_of(stage) -> dict:
    """The transforms below the first one, by name, in file order."""
    return {prim.GetName(): prim for prim in list(stage.Traverse())[1:]}


def places(usd, stage, frames: np.ndarray) -> np.ndarray:
    """(T, J, 3) of all joints at these time codes."""
    prims = list(joints_of(stage).values())
    rows = []
    for frame in frames.tolist():
        cache = usd[1].XformCache(frame)
        rows.append([cache.GetLocalToWorldTransform(prim).ExtractTranslation() for prim in prims])
    return np.array(rows)


def at_rest(body: mc.Skeleton) -> mc.Motion:
    """One frame of the body as its offsets have it."""
    return mc.Motion(mc.Skeleton(body.names, body.parents, body.offsets, ((),) * len(body.names)), [[]], 1.0)


def test_splines_are_the_curves_at_all_frames_and_half_frames(tmp_path, usd):
    clip = chains.keys()
    mc.write(tmp_path / "a.usda", clip)
    stage = usd[0].Stage.Open(str(tmp_path / "a.usda"))
    joints = joints_of(stage)
    frames = np.arange(0, 2 * clip.frames - 1) / 2
    for name, curve in zip(clip.skeleton.channel_names, clip.curves, strict=True):
        joint, kind = name.split(".")
        operation = f"xformOp:{'translate' if kind.endswith('position') else 'rotate'}{kind[0]}"
        attribute = joints[joint].GetAttribute(operation)
        found = np.array([attribute.Get(frame) for frame in frames.tolist()])
        assert np.abs(found - curve.at(frames * clip.frame_time)).max() < 1e-9


def test_knots_have_the_keys_times_values_and_slopes(tmp_path, usd):
    clip = chains.keys()
    mc.write(tmp_path / "a.usda", clip)
    stage = usd[0].Stage.Open(str(tmp_path / "a.usda"))
    joints = joints_of(stage)
    for name, curve in zip(clip.skeleton.channel_names, clip.curves, strict=True):
        joint, kind = name.split(".")
        operation = f"xformOp:{'translate' if kind.endswith('position') else 'rotate'}{kind[0]}"
        knots = list(joints[joint].GetAttribute(operation).GetSpline().GetKnots().values())
        assert np.allclose([knot.GetTime() for knot in knots], np.rint(120 * curve.times) / 2, rtol=1e-15, atol=0)
        assert [knot.GetValue() for knot in knots] == curve.values.tolist()
        leaving = [60 * knot.GetPostTanSlope() for knot in knots[:-1]]
        arriving = [60 * knot.GetPreTanSlope() for knot in knots[1:]]
        assert leaving == pytest.approx(curve.slopes[:-1].tolist(), rel=1e-12)
        assert arriving == pytest.approx(curve.in_slopes[1:].tolist(), rel=1e-12)


def test_joints_stand_where_the_clip_has_them(tmp_path, usd, jump):
    motion = mc.read(jump, unit="cm")[:40]
    for clip in (chains.keys(), chains.samples(), motion):
        mc.write(tmp_path / "a.usda", clip)
        stage = usd[0].Stage.Open(str(tmp_path / "a.usda"))
        found = places(usd, stage, np.arange(clip.frames))
        assert np.abs(found - kinematics.world(clip.sample())).max() < 1e-9
        assert list(joints_of(stage)) == list(clip.skeleton.names)
        stage = None  # USD keeps a file that is open


def test_the_skeleton_of_usdskel_stands_where_the_clip_has_it(tmp_path, usd):
    clip = chains.samples(12)
    mc.write(tmp_path / "a.usda", clip, profile="skel")
    stage = usd[0].Stage.Open(str(tmp_path / "a.usda"))
    skeleton = usd[2].Skeleton(stage.GetPrimAtPath("/a/skeleton"))
    assert skeleton.GetJointNamesAttr().Get() == list(clip.skeleton.names)
    valid, reason = usd[2].Topology(skeleton.GetJointsAttr().Get()).Validate()
    assert valid, reason
    query = usd[2].Cache().GetSkelQuery(skeleton)
    found = [[matrix.ExtractTranslation() for matrix in query.ComputeJointSkelTransforms(f)] for f in range(12)]
    assert np.abs(np.array(found) - kinematics.world(clip)).max() < 1e-4
    bound = [matrix.ExtractTranslation() for matrix in query.GetJointWorldBindTransforms()]
    assert np.abs(np.array(bound) - kinematics.world(at_rest(clip.skeleton))[0]).max() < 1e-9


@pytest.mark.parametrize("profile", ["splines", "skel"])
def test_between_frames_nothing_turns_the_long_way(tmp_path, usd, profile):
    body = mc.Skeleton(("a",), [-1], [[1, 0, 0]], (("Xrotation",),), unit=0.01)
    mc.write(tmp_path / "a.usda", mc.Motion(body, [[170.0], [179.0], [-172.0]], 1 / 24), profile=profile)
    stage = usd[0].Stage.Open(str(tmp_path / "a.usda"))
    if profile == "splines":
        assert stage.GetPrimAtPath("/a/a").GetAttribute("xformOp:rotateX").Get(1.5) == pytest.approx(183.5)
    else:
        turns = usd[2].Animation(stage.GetPrimAtPath("/a/animation")).GetRotationsAttr()
        parts = [(turn.GetReal(), *turn.GetImaginary()) for frame in range(3) for turn in turns.Get(frame)]
        assert np.dot(parts[0], parts[1]) > 0.9
        assert np.dot(parts[1], parts[2]) > 0.9


@pytest.mark.parametrize("profile", ["splines", "skel"])
def test_the_stage_says_unit_axis_and_rate(tmp_path, usd, profile):
    clip = mc.Motion(chains.skeleton(0.0254), chains.samples().values, 1001 / 30000)
    mc.write(tmp_path / "my walk.usda", clip, profile=profile)
    stage = usd[0].Stage.Open(str(tmp_path / "my walk.usda"))
    assert usd[1].GetStageMetersPerUnit(stage) == 0.0254
    assert usd[1].GetStageUpAxis(stage) == "Y"
    assert stage.GetTimeCodesPerSecond() == stage.GetFramesPerSecond() == pytest.approx(30000 / 1001, rel=1e-15)
    assert (stage.GetStartTimeCode(), stage.GetEndTimeCode()) == (0, 6)
    assert stage.GetDefaultPrim().GetName() == "my_walk"


def test_keys_become_samples_in_usdskel_with_a_warning(tmp_path):
    with pytest.warns(UserWarning, match="123 keys become samples at every frame: the profile splines keeps them"):
        mc.write(tmp_path / "a.usda", chains.keys(), profile="skel")


@pytest.mark.parametrize("profile", ["splines", "skel"])
def test_names_become_identifiers_and_the_names_themselves_are_kept(tmp_path, usd, profile):
    names = ("mixamorig:Hips", "a\\b", 'a"b\n', "", "9", "骨", "骨")
    body = mc.Skeleton(names, np.arange(7) - 1, np.ones((7, 3)), ((),) * 7, unit=0.01)
    with pytest.warns(UserWarning, match="joint names changed for USD: 'mixamorig:Hips' is 'mixamorig_Hips', "):
        mc.write(tmp_path / "a.usda", mc.Motion(body, np.zeros((1, 0)), 0.1), profile=profile)
    stage = usd[0].Stage.Open(str(tmp_path / "a.usda"))
    valid = ["mixamorig_Hips", "a_b", "a_b_", "joint", "_9", "_", "__2"]
    if profile == "skel":
        skeleton = usd[2].Skeleton(stage.GetPrimAtPath("/a/skeleton"))
        assert [path.split("/")[-1] for path in skeleton.GetJointsAttr().Get()] == valid
        assert skeleton.GetJointNamesAttr().Get() == list(names)
    else:
        assert list(joints_of(stage)) == valid
        assert [prim.GetCustomDataByKey("name") for prim in joints_of(stage).values()] == list(names)


@pytest.mark.parametrize("frames", [0, 1])
@pytest.mark.parametrize("profile", ["splines", "skel"])
def test_no_frames_are_the_rest_pose_and_one_frame_is_a_pose(tmp_path, usd, profile, frames):
    clip = chains.samples(frames)
    mc.write(tmp_path / "a.usda", clip, profile=profile)
    stage = usd[0].Stage.Open(str(tmp_path / "a.usda"))
    if profile == "splines" and frames:
        assert np.abs(places(usd, stage, np.array([0, 5])) - kinematics.world(clip)).max() < 1e-9
    if profile == "splines" and not frames:
        found = places(usd, stage, np.array([0]))
        assert np.abs(found - kinematics.world(at_rest(clip.skeleton))).max() < 1e-9
    assert stage.GetEndTimeCode() == 0


def test_a_chain_that_would_break_readers_is_refused(tmp_path):
    body = mc.Skeleton(("a",) * 1001, np.arange(1001) - 1, np.ones((1001, 3)), ((),) * 1001, unit=0.01)
    with (
        pytest.warns(UserWarning, match="joint names changed"),
        pytest.raises(
            mc.Mismatch, match="a chain of 1001 joints: USD files are written with at most 1000 below one another"
        ),
    ):
        mc.write(tmp_path / "a.usda", mc.Motion(body, np.zeros((1, 0)), 0.1))
    assert list(tmp_path.iterdir()) == []


def test_numbers_that_are_none_and_half_characters_are_refused(tmp_path):
    clip = chains.samples()
    values = clip.values.copy()
    values[1, 2] = np.inf
    with pytest.raises(mc.Mismatch, match=r"number 1 of 'Joint\.Zposition' is inf, which cannot be written"):
        mc.write(tmp_path / "a.usda", mc.Motion(clip.skeleton, values, 0.1))
    half = mc.Skeleton(("\ud800",), [-1], [[1, 0, 0]], ((),), unit=1.0)
    with (
        pytest.warns(UserWarning, match="joint names changed"),
        pytest.raises(mc.FileError, match=r"a name holds '\\ud800', which UTF-8 has not"),
    ):
        mc.write(tmp_path / "a.usda", mc.Motion(half, np.zeros((1, 0)), 0.1))
    assert list(tmp_path.iterdir()) == []


def test_what_is_too_large_is_refused_and_leaves_nothing(tmp_path):
    body = mc.Skeleton(("a", "b"), [-1, 0], [[1, 0, 0]] * 2, (("Xposition",), ()), unit=0.01)
    steep = mc.KeyedMotion(body, (mc.HermiteCurve([0, 50], [0, 0], [1e308, 0]),), 50.0, 2)
    with pytest.raises(mc.Mismatch, match=r"1e\+308 times 50 is more than a number can hold"):
        mc.write(tmp_path / "a.usda", steep)
    far = mc.Skeleton(("a", "b"), [-1, 0], [[1.5e308, 0, 0]] * 2, ((), ()), unit=0.01)
    for clip, words in ((mc.Motion(body, [[1e300]], 0.1), r"1e\+300"), (mc.Motion(far, [[]], 0.1), r"1\.5e\+308")):
        with pytest.raises(mc.Mismatch, match=f"^{words} is more than the single precision of UsdSkel can hold"):
            mc.write(tmp_path / "a.usda", clip, profile="skel")
    assert list(tmp_path.iterdir()) == []


def test_huge_values_stay(tmp_path, usd):
    body = mc.Skeleton(("a",), [-1], [[1, 0, 0]], (("Xposition",),), unit=0.01)
    mc.write(tmp_path / "a.usda", mc.Motion(body, [[1e300]], 0.1))
    stage = usd[0].Stage.Open(str(tmp_path / "a.usda"))
    assert stage.GetPrimAtPath("/a/a").GetAttribute("xformOp:translateX").Get(0) == 1e300


def test_usd_is_not_read(tmp_path):
    mc.write(tmp_path / "a.usda", chains.samples())
    with pytest.raises(mc.FileError, match=r"a\.usda: USD is only written"):
        mc.read(tmp_path / "a.usda")
