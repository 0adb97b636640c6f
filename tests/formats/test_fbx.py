"""What an FBX file says: taken apart by our own reader, played by three.js, and asked of ufbx."""

from __future__ import annotations

import struct

import chains
import fbx_files
import numpy as np
import pytest

import mocurve as mc
from mocurve import kinematics, rotation
from mocurve.formats import fbx

GUESSED = r"no length unit was said: the body's height suggests the"


def file_of(folder, clip, **options) -> fbx_files.Fbx:
    mc.write(folder / "a.fbx", clip, **options)
    return fbx_files.read(folder / "a.fbx")


@pytest.fixture(scope="module")
def reduced(jump) -> mc.KeyedMotion:
    return mc.reduce(mc.read(jump, unit=0.056444), tolerance="1deg")


def test_the_skeleton_is_one_limb_node_a_joint(tmp_path):
    clip = chains.samples()
    models = file_of(tmp_path, clip).models
    body = clip.skeleton
    assert tuple(models) == body.names
    for name, parent, offset, kinds in zip(body.names, body.parents, body.offsets, body.channels, strict=True):
        above, properties = models[name]
        assert above == (body.names[parent] if parent >= 0 else None)
        assert properties["Lcl Translation"] == offset.tolist()
        assert properties["Lcl Rotation"] == [0, 0, 0]
        assert properties["RotationActive"] == [1]
        turning = "".join(kind[0] for kind in kinds if kind.endswith("rotation"))
        order = fbx.ORDERS[properties["RotationOrder"][0]][::-1]
        assert "".join(axis for axis in order if axis in turning) == turning


def test_key_times_are_exact_and_values_and_slopes_are_those_of_the_curves(tmp_path):
    clip = chains.keys()
    curves = file_of(tmp_path, clip, profile="keys").curves
    body = clip.skeleton
    assert len(curves) == body.channel_count
    for joint, name, curve in zip(body.channel_joints, body.channel_names, clip.curves, strict=True):
        kind = name.rsplit(".")[-1]
        attribute = "Lcl Translation" if kind.endswith("position") else "Lcl Rotation"
        found = curves[body.names[joint], attribute, f"d|{kind[0]}"]
        assert found.ticks.tolist() == [round(time * fbx_files.SECOND) for time in curve.times.tolist()]
        assert np.allclose(found.values, curve.values, rtol=1e-7, atol=0)
        assert np.allclose(found.data[:, 0], curve.slopes, rtol=1e-7, atol=0)
        assert np.allclose(found.data[:-1, 1], curve.in_slopes[1:], rtol=1e-7, atol=0)
        assert found.data[:, 2].tobytes() == struct.pack("<hh", 3333, 3333) * len(curve)
        assert found.flags.tolist() == [0xC08 if curve.broken else 0x408] * len(curve)


def test_samples_are_a_straight_key_at_every_frame_for_all_three_axes(tmp_path):
    clip = chains.samples()
    curves = file_of(tmp_path, clip).curves
    moved = {(name.split(".")[0], name.split(".")[1][1:]) for name in clip.skeleton.channel_names}
    assert len(curves) == 3 * len(moved)
    columns = dict(zip(clip.skeleton.channel_names, clip.values.T, strict=True))
    for (joint, attribute, axis), curve in curves.items():
        kind = "position" if attribute == "Lcl Translation" else "rotation"
        still = clip.skeleton.offsets[clip.skeleton.joint(joint)]["XYZ".index(axis[-1])] if kind == "position" else 0.0
        values = columns.get(f"{joint}.{axis[-1]}{kind}", np.full(clip.frames, still))
        assert curve.ticks.tolist() == [round(frame * clip.frame_time * fbx_files.SECOND) for frame in range(7)]
        assert np.allclose(curve.values, values, rtol=1e-7, atol=1e-12)
        assert set(curve.flags.tolist()) == {4}


def test_keys_become_samples_with_a_warning(tmp_path):
    clip = chains.keys()
    with pytest.warns(UserWarning, match="123 keys become samples at every frame: the profile keys keeps them"):
        mc.write(tmp_path / "a.fbx", clip)
    mc.write(tmp_path / "b.fbx", clip.sample())
    first, second = (fbx_files.read(tmp_path / name) for name in ("a.fbx", "b.fbx"))
    assert {place: curve.values.tobytes() for place, curve in first.curves.items()} == {
        place: curve.values.tobytes() for place, curve in second.curves.items()
    }


def test_the_profile_keys_needs_keys(tmp_path):
    with pytest.raises(mc.OptionError, match=r"^the profile keys of \.fbx holds keys, a Motion has none"):
        mc.write(tmp_path / "a.fbx", chains.samples(), profile="keys")


@pytest.mark.parametrize("frames", [1, 2, 31])
def test_three_plays_every_rotation_order_and_inner_positions(tmp_path, frames):
    clip = chains.samples(frames)
    mc.write(tmp_path / "walk.fbx", clip)
    places, wxyz, animations = fbx_files.played(tmp_path / "walk.fbx", clip.frame_time, frames)
    assert animations == ["walk"]
    assert np.abs(places - kinematics.world(clip)).max() < 1e-3
    assert rotation.angle(wxyz, kinematics.rotations(clip)).max() < 1e-3


def test_three_plays_real_clips(tmp_path, jump, clips):
    orders = clips / "other" / "mixed_rotation_orders.bvh"
    for path in (jump, orders):
        clip = mc.read(path, unit="cm")
        mc.write(tmp_path / "a.fbx", clip)
        places, wxyz, _ = fbx_files.played(tmp_path / "a.fbx", clip.frame_time, clip.frames)
        assert np.abs(places - kinematics.world(clip)).max() < 1e-3
        assert rotation.angle(wxyz, kinematics.rotations(clip)).max() < 1e-3


def test_ufbx_has_nothing_to_say_against_it(tmp_path, reduced):
    for profile, clip in (("baked", chains.samples()), ("keys", chains.keys()), ("keys", reduced)):
        mc.write(tmp_path / "a.fbx", clip, profile=profile)
        told = fbx_files.told_by_ufbx(tmp_path / "a.fbx")
        assert told["warnings"] == 0
        assert told["bones"] == list(clip.skeleton.names)
        assert told["fps"] == pytest.approx(1 / clip.frame_time)
        assert told["metres"] == pytest.approx(clip.skeleton.unit)


def test_ufbx_finds_times_slopes_and_values_between_the_frames(tmp_path, reduced):
    mc.write(tmp_path / "a.fbx", reduced, profile="keys")
    half_frames = np.arange(0, 2 * reduced.frames - 1) * reduced.frame_time / 2
    told = fbx_files.told_by_ufbx(tmp_path / "a.fbx", half_frames)
    kinds = [kind for kinds in reduced.skeleton.channels for kind in kinds]
    joints = reduced.skeleton.channel_joints
    in_file = sorted(range(len(kinds)), key=lambda c: (joints[c], kinds[c][1:], kinds[c][0]))
    for found, channel in zip(told["curves"], in_file, strict=True):
        curve = reduced.curves[channel]
        assert found["times"] == pytest.approx(curve.times.tolist(), abs=1e-10)
        assert found["slopes"] == pytest.approx(curve.slopes[:-1].tolist(), rel=1e-4, abs=1e-4)
        assert np.abs(found["values"] - curve.at(half_frames)).max() < 1e-3


@pytest.mark.parametrize(
    ("frame_time", "mode"),
    [(1 / 120, 1), (1 / 60, 3), (1 / 30, 6), (1001 / 30000, 9), (1001 / 24000, 13), (1 / 90, 14), (0.0123, 14)],
)
def test_unit_axes_and_rate_are_told(tmp_path, frame_time, mode):
    clip = mc.Motion(chains.skeleton(0.0254), chains.samples().values, frame_time)
    settings = file_of(tmp_path, clip).root.one("GlobalSettings").properties
    assert settings["UnitScaleFactor"] == [pytest.approx(2.54)]
    assert (settings["UpAxis"], settings["FrontAxis"], settings["CoordAxis"]) == ([1], [2], [0])
    assert settings["TimeMode"] == [mode]
    assert settings["CustomFrameRate"] == [pytest.approx(1 / frame_time)]
    assert settings["TimeSpanStop"] == [round(clip.duration * fbx_files.SECOND)]


def test_a_clip_without_frames_is_a_skeleton(tmp_path):
    for clip in (chains.samples(0), mc.KeyedMotion(chains.skeleton(), (mc.HermiteCurve([], [], []),) * 42, 1 / 60, 0)):
        found = file_of(tmp_path, clip, profile="keys" if isinstance(clip, mc.KeyedMotion) else "baked")
        assert len(found.models) == 18
        assert found.curves == {}
        assert found.root.one("Takes").one("Current").values == [""]


def test_odd_names_stay_and_equal_names_become_different_with_a_warning(tmp_path):
    names = ("Hüfte", "a:b c", "a:b c", "", "骨\0\1", "a:b c_2")
    body = mc.Skeleton(names, [-1, 0, 0, 0, 0, 0], np.ones((6, 3)), ((),) * 6, unit=1.0)
    told = r"joint names changed for FBX: 'a:b c' is 'a:b c_3', '' is 'joint', '骨\\x00\\x01' is '骨__'$"
    with pytest.warns(UserWarning, match=told):
        found = file_of(tmp_path, mc.Motion(body, np.zeros((1, 0)), 0.1))
    assert list(found.models) == ["Hüfte", "a:b c", "a:b c_3", "joint", "骨__", "a:b c_2"]


def test_a_unit_that_nobody_said_is_guessed_with_a_warning(tmp_path):
    with pytest.warns(UserWarning, match=GUESSED):
        mc.write(tmp_path / "a.fbx", chains.samples(unit=None))
    point = mc.Skeleton(("a",), [-1], [[0, 0, 0]], (("Xposition",),))
    with pytest.raises(mc.OptionError, match="say it with the option unit"):
        mc.write(tmp_path / "b.fbx", mc.Motion(point, [[1.0]], 0.1))


def test_values_that_single_precision_rounds_are_told(tmp_path):
    clip = chains.samples(size=1e6)
    with pytest.warns(
        UserWarning, match=r"FBX keeps single precision: values are off by up to 0\.0\d+ degrees or units"
    ):
        mc.write(tmp_path / "a.fbx", clip)


def one(values=(1.0, 2.0), slopes=(0.0, 0.0), times=(0.0, 1.0), offset=1.0) -> mc.KeyedMotion:
    body = mc.Skeleton(("a",), [-1], [[offset, 0, 0]], (("Xposition",),), unit=1.0)
    return mc.KeyedMotion(body, (mc.HermiteCurve(times, values, slopes),), 0.1, 11)


@pytest.mark.parametrize(
    ("clip", "words"),
    [
        (one(values=(1.0, np.nan)), r"number 1 of 'a\.Xposition' is nan"),
        (one(slopes=(np.inf, 0.0)), r"number 0 of 'a\.Xposition' is inf"),
        (one(offset=np.nan), "number 0 of 'a' is nan"),
        (one(values=(1e300, 0.0)), r"1e\+300 is more than the single precision of FBX can hold"),
        (one(slopes=(0.0, -1e300)), r"-1e\+300 is more than the single precision"),
        (one(times=(0.0, 1e12)), r"a time of 1e\+12 s is more than FBX can hold"),
        (one(times=(0.0, 1e-12)), r"two keys of a curve are less than FBX's 1/46186158000 s apart"),
    ],
)
def test_what_fbx_cannot_hold_is_refused_and_leaves_nothing(tmp_path, clip, words):
    with pytest.raises(mc.Mismatch, match=words):
        mc.write(tmp_path / "a.fbx", clip, profile="keys")
    assert list(tmp_path.iterdir()) == []


def test_a_channel_twice_and_half_a_character_are_refused(tmp_path):
    twice = mc.Skeleton(("a",), [-1], [[1, 0, 0]], (("Xrotation", "Xrotation"),), unit=1.0)
    with pytest.raises(mc.Mismatch, match="joint 'a' has a channel twice"):
        mc.write(tmp_path / "a.fbx", mc.Motion(twice, [[1.0, 2.0]], 0.1))
    half = mc.Skeleton(("\ud800",), [-1], [[1, 0, 0]], ((),), unit=1.0)
    with pytest.raises(mc.FileError, match=r"a name holds '\\ud800', which UTF-8 has not"):
        mc.write(tmp_path / "a.fbx", mc.Motion(half, np.zeros((1, 0)), 0.1))


def test_fbx_is_not_read(tmp_path):
    mc.write(tmp_path / "a.fbx", chains.samples())
    with pytest.raises(
        mc.FileError, match=r"a\.fbx: FBX is only written; \.bvh, \.glb and \.curves\.json are read back"
    ):
        mc.read(tmp_path / "a.fbx")
