"""What stands in a .glb or .gltf file that is written, and what is told of it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from glb import Glb

import mocurve as mc
from mocurve import kinematics, rotation

TIGHT = {"baked": {}, "linear": {"tolerance": "0.001deg"}}
R3, P3 = ("Zrotation", "Xrotation", "Yrotation"), ("Xposition", "Yposition", "Zposition")


@pytest.fixture
def said(small: mc.Motion) -> mc.Motion:
    """The small motion in centimetres."""
    return replace(small, skeleton=replace(small.skeleton, unit=0.01))


def body(
    *joints: tuple[str, int, tuple[float, float, float], tuple[str, ...]], unit: float | None = 0.01
) -> mc.Skeleton:
    names, parents, offsets, channels = zip(*joints, strict=True)
    return mc.Skeleton(names, parents, offsets, channels, unit=unit)


def written(path, clip, **options) -> Glb:
    mc.write(path, clip, **options)
    return Glb(path)


@pytest.mark.parametrize("name", ["walk.glb", "walk.gltf", "Walk.GLB"])
def test_joints_are_nodes_in_metres_below_an_armature_and_the_skin_lists_all(tmp_path, said, name):
    path = tmp_path / name
    mc.write(path, said, profile="baked")
    file = Glb(path.rename(path.with_suffix(path.suffix.lower())))
    nodes = file.parts["nodes"]
    assert list(file.joints) == ["Hips", "Knee", "Knee_End"]
    armature = nodes[file.parts["scenes"][0]["nodes"][0]]
    assert armature == {"name": path.stem, "children": [file.joints["Hips"]]}
    assert nodes[file.joints["Hips"]]["children"] == [file.joints["Knee"]]
    assert nodes[file.joints["Knee_End"]]["translation"] == [0, pytest.approx(-0.0225), 0]
    assert not any("rotation" in node or "scale" in node for node in nodes)
    assert file.parts["animations"][0]["name"] == path.stem
    assert file.parts["asset"] == {"version": "2.0", "generator": f"mocurve {mc.__version__}"}


def test_inverse_bind_matrices_undo_the_rest_pose(tmp_path, said):
    file = written(tmp_path / "a.glb", said, profile="baked")
    matrices = file.array(file.parts["skins"][0]["inverseBindMatrices"]).reshape(-1, 4, 4).transpose(0, 2, 1)
    rest = 0.01 * np.cumsum(said.skeleton.offsets, axis=0)
    assert matrices @ np.append(rest, np.ones((3, 1)), axis=1)[..., None] == pytest.approx(
        np.tile([[0.0], [0], [0], [1]], (3, 1, 1)), abs=1e-9
    )


def test_extras_keep_what_gltf_has_no_place_for(tmp_path, said):
    history = ({"verb": "clean", "é": [1, None]},)
    file = written(tmp_path / "a.glb", replace(said, history=history), profile="baked")
    assert file.parts["skins"][0]["extras"]["mocurve"] == {
        "version": 1,
        "names": ["Hips", "Knee", "Knee_End"],
        "channels": [["Xposition", "Zrotation", "Yrotation"], ["Xrotation"], []],
        "offsets": said.skeleton.offsets.tolist(),
        "end_sites": [2],
        "unit": 0.01,
        "scale": 0.01,
    }
    assert file.parts["animations"][0]["extras"]["mocurve"] == {
        "frame_time": 1 / 120,
        "frames": 3,
        "start": said.values[0].tolist(),
        "history": list(history),
    }


def test_baked_has_every_frame_on_times_that_are_stored_once(tmp_path, said):
    file = written(tmp_path / "a.glb", said, profile="baked")
    animation = file.animation()
    assert set(animation) == {("Hips", "rotation"), ("Hips", "translation"), ("Knee", "rotation")}
    assert len({sampler["input"] for sampler in file.parts["animations"][0]["samplers"]}) == 1
    for keys in animation.values():
        assert keys.interpolation == "LINEAR"
        assert keys.times.tolist() == np.float32([0, 1 / 120, 2 / 120]).tolist()
    turned = kinematics.rotations(said)[:, 1]
    assert rotation.angle(animation["Knee", "rotation"].values[:, [3, 0, 1, 2]], turned) == pytest.approx(0, abs=1e-5)
    places = animation["Hips", "translation"].values
    assert places == pytest.approx(0.01 * np.column_stack([said.values[:, 0], *np.tile([[1.5], [0.0]], 3)]), abs=1e-9)


def test_quaternions_have_length_1_and_do_not_change_sides(tmp_path):
    turning = body(("A", -1, (0, 0, 0), R3), ("B", 0, (0, 1, 0), ()))
    clip = mc.Motion(turning, np.outer(np.arange(200), [7.0, 3.0, -5.0]) % 360, 1 / 60)
    values = written(tmp_path / "a.glb", clip, profile="baked").animation()["A", "rotation"].values
    assert np.linalg.norm(values.astype(float), axis=1) == pytest.approx(1, abs=1e-7)
    assert (np.sum(values[1:] * values[:-1], axis=1) > 0.9).all()


@pytest.mark.parametrize("profile", ["baked", "linear"])
def test_players_find_fast_joints_at_the_true_times_of_frames_that_32_bits_miss(tmp_path, profile):
    shaking = body(("A", -1, (0, 0, 0), (*P3, *R3)), ("B", 0, (0, 1, 0), ()))
    away = np.arange(3000) % 2
    clip = mc.Motion(shaking, np.outer(away, [50.0, -20, 0, 90, 0, 20]), 1 / 30)
    animation = written(tmp_path / "a.glb", clip, profile=profile, **TIGHT[profile]).animation()
    times = np.arange(3000) / 30
    turned, moved = animation["A", "rotation"], animation["A", "translation"]
    assert np.abs(turned.times - times).max() > 1e-6
    k = np.clip(np.searchsorted(turned.times, times, side="right") - 1, 0, 2998)
    u = (times - turned.times[k]) / np.diff(turned.times.astype(float))[k]
    wxyz = turned.values[:, [3, 0, 1, 2]].astype(float)
    seen = rotation.slerp(wxyz[k], wxyz[k + 1], u)
    assert rotation.angle(seen, kinematics.rotations(clip)[:, 0]).max() < 1e-4
    x = np.interp(times, moved.times.astype(float), moved.values[:, 0].astype(float))
    assert x == pytest.approx(0.5 * away, abs=1e-6)


def test_what_does_not_move_has_one_key_and_what_stays_at_rest_has_none(tmp_path):
    still = body(("A", -1, (1, 2, 3), (*P3, *R3)), ("B", 0, (0, 1, 0), R3), ("C", 1, (0, 1, 0), R3))
    values = np.zeros((9, 12))
    values[:, :3] = 1, 2, 3
    values[:, 3] = np.arange(9)
    values[:, 9] = 20
    animation = written(tmp_path / "a.glb", mc.Motion(still, values, 0.1), profile="baked").animation()
    assert {target: len(keys.times) for target, keys in animation.items()} == {
        ("A", "rotation"): 9,
        ("C", "rotation"): 1,
    }
    assert animation["C", "rotation"].times == [0]


@pytest.mark.parametrize("frames", [1, 7])
@pytest.mark.parametrize("profile", ["linear", "cubic", "baked"])
@pytest.mark.parametrize("value", [0.0, 12.0])
def test_an_animation_lasts_as_long_as_the_clip_also_where_nothing_moves(tmp_path, said, frames, profile, value):
    clip = mc.Motion(said.skeleton, np.full((frames, 4), value), 0.1)
    given = mc.reduce(clip, tolerance="1deg") if profile == "cubic" else clip
    options = {"tolerance": "1deg"} if profile == "linear" else {}
    animation = written(tmp_path / "a.glb", given, profile=profile, **options).animation()
    assert max(keys.times[-1] for keys in animation.values()) == np.float32(0.1 * (frames - 1))


def test_a_position_channel_replaces_its_axis_and_bones_rest_where_constant_channels_put_them(tmp_path):
    inner = body(("A", -1, (0, 0, 0), R3), ("B", 0, (5, 6, 7), ("Yposition",)), ("C", 1, (1, 0, 0), ()))
    values = np.column_stack([np.arange(5.0), np.zeros((5, 2)), [8, 8, 8, 8, 9]])
    file = written(tmp_path / "a.glb", mc.Motion(inner, values, 0.1), profile="baked")
    assert file.animation()["B", "translation"].values == pytest.approx(
        0.01 * np.column_stack([np.full(5, 5), values[:, 3], np.full(5, 7)])
    )
    assert file.parts["nodes"][file.joints["B"]]["translation"] == pytest.approx([0.05, 0.08, 0.07])
    assert file.parts["skins"][0]["extras"]["mocurve"]["offsets"][1] == [5, 6, 7]


def test_several_clips_of_one_body_are_animations_of_one_file(tmp_path, said):
    file = written(tmp_path / "a.glb", {"Walk": said, "Run": said[:2]}, profile="baked")
    assert [animation["name"] for animation in file.parts["animations"]] == ["Walk", "Run"]
    assert len(file.animation("Walk")["Hips", "rotation"].times) == 3
    assert len(file.animation("Run")["Hips", "rotation"].times) == 2
    assert len(file.parts["skins"]) == 1


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ({"names": ("Hips", "Ankle", "Knee_End")}, "joint 1 is 'Knee' in one, 'Ankle' in the other"),
        ({"offsets": np.ones((3, 3))}, "'Hips' has the offsets"),
        ({"parents": [-1, 0, 0]}, "'Knee_End' hangs on another joint"),
        ({"channels": (("Xposition", "Zrotation", "Yrotation"), ("Yrotation",), ())}, "'Knee' has the channels"),
        ({"unit": None}, "a length unit is 0.01 m in one, None m in the other"),
    ],
)
def test_clips_of_two_bodies_are_refused_with_the_first_difference(tmp_path, said, change, told):
    other = replace(said, skeleton=replace(said.skeleton, **change))
    with pytest.raises(mc.Mismatch, match=f"the clips 'a' and 'b' have different bodies: {told}"):
        mc.write(tmp_path / "a.glb", {"a": said, "b": other}, profile="baked")
    assert not list(tmp_path.iterdir())


def test_names_that_stand_twice_or_are_missing_get_names_of_their_own(tmp_path):
    named = body(
        *[(name, joint - 1, (0, 1, 0), R3) for joint, name in enumerate(["A", "A", "", "A2", "脚", "A", "Figure"])]
    )
    clip = mc.Motion(named, np.ones((2, 21)), 0.1)
    with pytest.warns(
        UserWarning, match=r"names of their own in glTF: 'A' is 'A2', '' is 'joint2', 'A2' is 'A22' and 1"
    ):
        file = written(tmp_path / "Figure.glb", clip, profile="baked")
    assert list(file.joints) == ["A", "A2", "joint2", "A22", "脚", "A3", "Figure"]
    assert len({node["name"] for node in file.parts["nodes"]}) == len(file.parts["nodes"])
    assert file.parts["skins"][0]["extras"]["mocurve"]["names"] == list(named.names)


@pytest.mark.parametrize(
    ("clip", "profile", "tolerance", "losses"),
    [
        ("motion", "linear", None, "only the keys that hold the clip within 0.1%height are written"),
        ("motion", "linear", "1deg", None),
        ("motion", "baked", None, None),
        ("keys", "linear", "1deg", "tangents are lost, the profile cubic keeps them"),
        ("keys", "cubic", None, None),
    ],
)
def test_what_is_lost_is_told_and_nothing_else(tmp_path, said, recwarn, clip, profile, tolerance, losses):
    given = mc.reduce(said, tolerance="1deg") if clip == "keys" else said
    mc.write(tmp_path / "a.glb", given, profile=profile, tolerance=tolerance)
    told = [str(warning.message) for warning in recwarn]
    assert len(told) == (losses is not None)
    assert losses is None or losses in told[0]


@pytest.mark.parametrize(("height", "metres", "name"), [(170.0, 0.01, "cm"), (1.8, 1.0, "m"), (0.0, 1.0, "m")])
def test_a_guess_of_the_length_unit_is_told(tmp_path, height, metres, name):
    tall = body(("A", -1, (0, 0, 0), R3), ("B", 0, (0, height, 0), ()), unit=None)
    with pytest.warns(UserWarning, match=rf"nobody has said the clip's length unit: taken for {name}\b") as caught:
        file = written(tmp_path / "a.glb", mc.Motion(tall, np.ones((2, 3)), 0.1), profile="baked")
    assert caught[0].filename == __file__  # of the one who called write
    told = file.parts["skins"][0]["extras"]["mocurve"]
    assert (told["unit"], told["scale"]) == (None, metres)


def test_a_file_name_that_is_no_text_is_written_too(tmp_path, said):
    file = written(tmp_path / "w\udce9.glb", said, profile="baked")  # a byte that is no UTF-8, as Python has it
    assert file.parts["animations"][0]["name"] == "w?"


def test_a_clip_without_frames_is_a_body_alone(tmp_path, said):
    with pytest.warns(UserWarning, match="'a' has no frames: an animation of glTF cannot be empty, it is left out"):
        file = written(tmp_path / "a.glb", said[:0], profile="baked")
    assert "animations" not in file.parts
    assert list(file.joints) == list(said.skeleton.names)


def test_what_cannot_be_written_is_refused_and_the_old_file_stays(tmp_path, said):
    path = tmp_path / "a.glb"
    path.write_bytes(b"old")
    values = said.values.copy()
    values[1, 3] = np.nan
    empty = mc.Motion(mc.Skeleton((), (), np.zeros((0, 3)), ()), np.zeros((3, 0)), 0.1)
    refused = [
        (replace(said, values=values), mc.Mismatch, r"^Knee\.Xrotation of 'a' is nan at frame 1$"),
        (
            replace(said, values=1e41 * said.values),
            mc.OptionError,
            r"translation of joint 'Hips': 2\.5e\+39 is too large",
        ),
        (replace(said, frame_time=1e-50), mc.OptionError, "frames of 1e-50 s are too short for the 32-bit key times"),
        (replace(said, history=({"a": float("nan")},)), mc.OptionError, "cannot be written as JSON"),
        (
            replace(said, skeleton=replace(said.skeleton, names=("A", "\ud800", "C"))),
            mc.FileError,
            "which UTF-8 has not",
        ),
        (empty, mc.OptionError, "a skeleton without joints cannot be written"),
        ({}, mc.OptionError, "no clip is given to write"),
    ]
    for clip, error, told in refused:
        with pytest.raises(error, match=told):
            mc.write(path, clip, profile="baked")
    assert path.read_bytes() == b"old"
    assert len(list(tmp_path.iterdir())) == 1


def test_options_that_do_not_fit_are_refused(tmp_path, said):
    with pytest.raises(
        mc.OptionError, match="the cubic profile writes the tangents of keys, a Motion has none: reduce it"
    ):
        mc.write(tmp_path / "a.glb", said, profile="cubic")
    with pytest.raises(
        mc.OptionError, match="the baked profile chooses no keys of its own and has no use for a tolerance"
    ):
        mc.write(tmp_path / "a.glb", said, profile="baked", tolerance="2mm")
    with pytest.raises(mc.UnknownName, match=r"no profile of \.glb 'bakd'\. Did you mean 'baked'\?"):
        mc.write(tmp_path / "a.glb", said, profile="bakd")
