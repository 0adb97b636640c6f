"""What a Maya scene says, read back by a reader of our own. It was not opened in Maya."""

from __future__ import annotations

import chains
import maya_scenes
import numpy as np
import pytest

import mocurve as mc
from mocurve import kinematics


def scene_of(folder, clip) -> maya_scenes.Scene:
    mc.write(folder / "a.ma", clip)
    return maya_scenes.read(folder / "a.ma")


def plug(channel: str) -> str:
    joint, kind = channel.split(".")
    return f"{joint}.{'t' if kind.endswith('position') else 'r'}{kind[0].lower()}"


def test_keys_come_back_with_their_times_values_and_slopes(tmp_path):
    clip = chains.keys()
    scene = scene_of(tmp_path, clip)
    assert list(scene.curves) == [plug(name) for name in clip.skeleton.channel_names]
    for name, curve in zip(clip.skeleton.channel_names, clip.curves, strict=True):
        found = scene.curves[plug(name)]
        assert np.allclose(found.frames, np.rint(2 * 60 * curve.times) / 2, rtol=1e-15, atol=0)
        assert np.allclose(found.times, curve.times, rtol=1e-15, atol=0)
        assert found.values.tolist() == curve.values.tolist()
        assert np.allclose(found.slopes, curve.slopes, rtol=1e-12, atol=0)
        assert np.allclose(found.arriving, curve.in_slopes, rtol=1e-12, atol=0)
        assert found.locked == (["no"] * len(curve) if curve.broken else [])


def test_steep_and_flat_slopes_come_back(tmp_path):
    slopes = np.array([1e12, -1e-12, 0.0, 1e-300, 720.0])
    body = mc.Skeleton(("a",), [-1], [[1, 0, 0]], (("Xrotation", "Yposition"),), unit=0.01)
    curve = mc.HermiteCurve(np.arange(5) / 30, np.arange(5), slopes)
    scene = scene_of(tmp_path, mc.KeyedMotion(body, (curve, curve), 1 / 30, 5))
    for found in scene.curves.values():
        assert np.allclose(found.slopes, slopes, rtol=1e-12, atol=0)


@pytest.mark.parametrize(
    ("kind", "before", "after", "direction"),
    [("Xrotation", 61.638, 109.592, (0.28620, 0.95817)), ("Zposition", 8.968, 16.708, (0.032283, 0.99948))],
)
def test_tangents_are_the_directions_that_maya_saves(tmp_path, kind, before, after, direction):
    """Maya's own automatic tangents in a scene of 24 fps that it saved: as steep as the line through the keys on both
    sides, 6 frames apart; the one in centimetres was limited, to 7.74 in 6 frames."""
    slope = (after - before) / 6 * 24
    body = mc.Skeleton(("a",), [-1], [[1, 0, 0]], ((kind,),), unit=0.01)
    curve = mc.HermiteCurve(np.array([43, 46, 49]) / 24, [before, 70.0, after], [0.0, slope, 0.0])
    mc.write(tmp_path / "a.ma", mc.KeyedMotion(body, (curve,), 1 / 24, 50))
    (node,) = (node for node in maya_scenes.read(tmp_path / "a.ma").nodes.values() if node[0].startswith("animCurve"))
    assert [float(node[2][f".ko{axis}"][1]) for axis in "xy"] == pytest.approx(direction, rel=1e-4)


@pytest.mark.parametrize("unit", [0.01, 1.0, 0.0254])
def test_the_scene_evaluates_to_the_clip_in_centimetres(tmp_path, unit):
    for clip in (chains.keys(unit=unit), chains.samples(unit=unit)):
        times = np.arange(clip.frames) * clip.frame_time
        found = maya_scenes.places(scene_of(tmp_path, clip), times)
        assert np.abs(found / (100 * unit) - kinematics.world(clip.sample())).max() < 1e-9


def test_joints_have_their_parents_and_no_more_turns_than_the_clip(tmp_path):
    clip = chains.samples()
    nodes = scene_of(tmp_path, clip).nodes
    joints = {name: parent for name, (kind, parent, _) in nodes.items() if kind == "joint"}
    body = clip.skeleton
    assert joints == {n: body.names[p] if p >= 0 else "" for n, p in zip(body.names, body.parents, strict=True)}
    assert set(nodes["Joint"][2]) == {".t", ".ro", ".ssc"}


def test_samples_are_keys_at_every_frame_without_jumps_of_a_turn(tmp_path):
    body = mc.Skeleton(("a",), [-1], [[1, 0, 0]], (("Xrotation",),), unit=0.01)
    curve = scene_of(tmp_path, mc.Motion(body, [[170.0], [179.0], [-172.0]], 1 / 24)).curves["a.rx"]
    assert curve.frames.tolist() == [0, 1, 2]
    assert curve.values.tolist() == [170, 179, 188]
    assert curve.slopes is None


@pytest.mark.parametrize(
    ("frame_time", "unit"),
    [
        (1 / 24, "film"),
        (1 / 25, "pal"),
        (1 / 30, "ntsc"),
        (1 / 60, "ntscf"),
        (1 / 120, "120fps"),
        (1 / 240, "240fps"),
        (1001 / 30000, "29.97fps"),
        (1001 / 24000, "23.976fps"),
        (1 / 1000, "millisec"),
    ],
)
def test_the_time_unit_and_the_range_are_those_of_the_clip(tmp_path, frame_time, unit):
    scene = scene_of(tmp_path, mc.Motion(chains.skeleton(), chains.samples().values, frame_time))
    assert scene.units == ["-l", "centimeter", "-a", "degree", "-t", unit]
    assert scene.curves["JointX.rx"].frames.tolist() == list(range(7))
    kind, _, attributes = scene.nodes["sceneConfigurationScriptNode"]
    assert kind == "script"
    assert attributes[".b"] == ["playbackOptions -min 0 -max 6 -ast 0 -aet 6 "]


@pytest.mark.parametrize(
    ("fps", "unit", "words"),
    [(90, "100fps", "at parts of frames"), (15.625, "125fps", "8 frames apart"), (1 / 7, "2fps", "14 frames apart")],
)
def test_a_rate_that_maya_does_not_know_keeps_its_seconds(tmp_path, fps, unit, words):
    clip = mc.Motion(chains.skeleton(), chains.samples().values, 1 / fps)
    with pytest.warns(
        UserWarning, match=rf"Maya has no time unit of {fps:.6g} frames .* in its {unit} the keys lie {words}"
    ):
        scene = scene_of(tmp_path, clip)
    assert np.allclose(scene.curves["JointX.rx"].times, np.arange(7) / fps, rtol=1e-14, atol=0)


def test_names_become_names_of_maya_with_a_warning(tmp_path):
    names = ("mixamorig:Hips", "Hüfte links", "9", "", "front", "a_rotateX", "a", "a", "骨")
    body = mc.Skeleton(names, np.arange(9) - 1, np.ones((9, 3)), (("Xrotation",),) * 9, unit=0.01)
    told = "joint names changed for Maya: 'mixamorig:Hips' is 'mixamorig_Hips', 'Hüfte links' is 'Hufte_links', '9' is"
    with pytest.warns(UserWarning, match=f"{told} '_9' and 4 more"):
        scene = scene_of(tmp_path, mc.Motion(body, np.zeros((2, 9)), 1 / 30))
    joints = [name for name, (kind, *_) in scene.nodes.items() if kind == "joint"]
    assert joints == ["mixamorig_Hips", "Hufte_links", "_9", "joint", "front_2", "a_rotateX", "a", "a_2", "_"]
    assert set(scene.curves) == {f"{name}.rx" for name in joints}


@pytest.mark.parametrize("frames", [0, 1])
def test_no_frames_are_joints_and_one_frame_is_a_pose(tmp_path, frames):
    scene = scene_of(tmp_path, chains.samples(frames))
    assert len(scene.curves) == 42 * frames
    assert all(len(curve.frames) == 1 for curve in scene.curves.values())


def test_numbers_that_are_none_are_refused_and_leave_nothing(tmp_path):
    clip = chains.samples()
    values = clip.values.copy()
    values[1, 2] = np.nan
    with pytest.raises(mc.Mismatch, match=r"number 1 of 'Joint\.Zposition' is nan, which cannot be written"):
        mc.write(tmp_path / "a.ma", mc.Motion(clip.skeleton, values, 0.1))
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(("value", "slope", "offset"), [(1e308, 0, 1), (0, -1e308, 1), (0, 0, 1e308)])
def test_what_is_too_long_in_centimetres_is_refused_and_leaves_nothing(tmp_path, value, slope, offset):
    body = mc.Skeleton(("a",), [-1], [[offset, 0, 0]], (("Xposition",),), unit=1.0)
    clip = mc.KeyedMotion(body, (mc.HermiteCurve([0.0], [value], [slope]),), 0.1, 1)
    with pytest.raises(mc.Mismatch, match=r"1e\+308 times 100 is more than a number can hold"):
        mc.write(tmp_path / "a.ma", clip)
    assert list(tmp_path.iterdir()) == []


def test_huge_values_stay(tmp_path):
    values = np.array([[1e300, -1e-300]])
    body = mc.Skeleton(("a",), [-1], [[1, 0, 0]], (("Xposition", "Xrotation"),), unit=0.01)
    curves = scene_of(tmp_path, mc.Motion(body, values, 1 / 30)).curves
    assert [curve.values[0] for curve in curves.values()] == values[0].tolist()


def test_maya_scenes_are_not_read(tmp_path):
    mc.write(tmp_path / "a.ma", chains.samples())
    with pytest.raises(mc.FileError, match=r"a\.ma: Maya scenes are only written"):
        mc.read(tmp_path / "a.ma")
