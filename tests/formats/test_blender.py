"""The script for Blender, without Blender: what is in the file, and the mathematics of its parts."""

from __future__ import annotations

import ast
import math
import warnings
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import mocurve as mc
from mocurve import rotation
from mocurve.formats import _blender_keys as blender_keys
from mocurve.formats import _blender_maths as maths
from mocurve.formats.blender import PARTS, PROFILES

ORDERS = ["XYZ", "XZY", "YXZ", "YZX", "ZXY", "ZYX"]


@pytest.fixture
def script(tmp_path, keys):
    mc.write(tmp_path / "walk.blend.py", keys)
    return tmp_path / "walk.blend.py"


# -- the file --------------------------------------------------------------------------------------
@pytest.mark.parametrize("profile", PROFILES)
def test_the_clip_comes_back_to_the_last_bit(tmp_path, keys, profile):
    mc.write(tmp_path / "a.blend.py", keys, profile=profile)
    back = mc.read(tmp_path / "a.blend.py")
    mc.write(tmp_path / "a.curves.json", keys)
    mc.write(tmp_path / "b.curves.json", back)
    assert (tmp_path / "a.curves.json").read_bytes() == (tmp_path / "b.curves.json").read_bytes()


def test_samples_come_back_as_samples_and_are_told(tmp_path, small):
    with pytest.warns(
        UserWarning, match="samples have no keys: Blender gets one at every frame; reduce the clip first"
    ):
        mc.write(tmp_path / "a.blend.py", small)
    back = mc.read(tmp_path / "a.blend.py")
    assert isinstance(back, mc.Motion)
    assert back.values.tolist() == small.values.tolist()
    assert back.frame_time == small.frame_time


def test_samples_are_unrolled_since_blender_draws_lines_between_them(tmp_path, small):
    values = np.array(small.values)
    values[:, 3] = [170, -170, -150]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        mc.write(tmp_path / "a.blend.py", replace(small, values=values))
    assert mc.read(tmp_path / "a.blend.py").values[:, 3].tolist() == [170, 190, 210]


@pytest.mark.parametrize("frames", [0, 1])
def test_no_frame_and_one_frame_come_back_without_a_word(tmp_path, small, frames):
    mc.write(tmp_path / "a.blend.py", small[:frames])
    assert mc.read(tmp_path / "a.blend.py").values.tolist() == small[:frames].values.tolist()


@pytest.mark.parametrize("name", ["walk", 'a"b', "a'''b\"\"\"", "läuft 走", "x\\", "a\nimport os", "{braces}", "😀"])
def test_the_script_is_python_of_one_file_whatever_its_name(tmp_path, keys, name):
    path = tmp_path / f"{name}.blend.py"
    mc.write(path, keys)
    tree = ast.parse(path.read_bytes())
    named = {node.targets[0].id: node.value for node in tree.body if isinstance(node, ast.Assign)}
    assert ast.literal_eval(named["NAME"]) == name
    assert not [node for node in ast.walk(tree) if isinstance(node, ast.ImportFrom) and node.level]


@pytest.mark.parametrize("name", ['"""', "'''", '\\"', "\\", '"', "\n", "é\ud800", '""" + __import__("os") + """'])
def test_no_name_of_a_joint_ends_the_keys(tmp_path, keys, name):
    odd = replace(keys, skeleton=replace(keys.skeleton, names=(name, f"{name}\\", "End")))
    mc.write(tmp_path / "a.blend.py", odd)
    tree = ast.parse((tmp_path / "a.blend.py").read_bytes())
    assert sum(isinstance(node, ast.If) for node in tree.body) == 1
    assert mc.read(tmp_path / "a.blend.py").skeleton.names == odd.skeleton.names


def test_everything_that_the_script_uses_is_in_it(script):
    tree = ast.parse(script.read_bytes())
    made = {node.name for node in tree.body if isinstance(node, ast.FunctionDef | ast.ClassDef)}
    imported = {a.asname or a.name for n in tree.body if isinstance(n, ast.Import | ast.ImportFrom) for a in n.names}
    given_names = {node.targets[0].id for node in tree.body if isinstance(node, ast.Assign)}
    used = {node.id for node in ast.walk(tree) if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Load)}
    inner = {n.id for n in ast.walk(tree) if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store)}
    inner |= {n.arg for n in ast.walk(tree) if isinstance(n, ast.arg)}
    inner |= {n.name for n in ast.walk(tree) if isinstance(n, ast.ExceptHandler) and n.name}
    inner |= {n.name for n in ast.walk(tree) if isinstance(n, ast.FunctionDef)}
    builtin = set(dir(__builtins__) if not isinstance(__builtins__, dict) else __builtins__)
    assert not used - made - imported - given_names - inner - builtin - {"__name__"}
    assert not imported - used - {"annotations"}


def test_the_licence_is_told_in_the_script_and_in_its_sources(script, repository):
    assert script.read_text().startswith("# SPDX-License-Identifier: MIT\n")
    assert "Permission is hereby granted" in script.read_text()
    for part in PARTS:
        assert "SPDX-License-Identifier: MIT" in (repository / "src/mocurve/formats" / f"{part}.py").read_text()


def test_nothing_of_a_script_is_run_when_it_is_read(tmp_path, script):
    text = script.read_text()
    script.write_text(f"open({str(tmp_path / 'ran')!r}, 'w')\n" + text + "\nraise SystemExit\n")
    assert mc.read(script).keys == 8
    assert not (tmp_path / "ran").exists()


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('PAYLOAD = r"""', "PAYLOAD = '''", "not a script that mocurve wrote: it holds no keys"),
        ('\n"""\n', "\n", "not a script that mocurve wrote: it holds no keys"),
        ('"version": 1', '"version": 2', "the keys in the script: version: 1, not 2, expected"),
        ('"times": [0.0,', '"times": [NaN,', "the keys in the script: not JSON: NaN is no number of JSON"),
        ('"frames": 3', '"frames": 999999999999', "the keys in the script: frames: a whole number"),
    ],
)
def test_a_broken_script_is_refused(script, old, new, words):
    head, _, tail = script.read_text().rpartition(old)
    script.write_text(head + new + tail)
    with pytest.raises(mc.FileError, match=words):
        mc.read(script)


def test_line_ends_of_windows_do_no_harm(script, keys):
    script.write_bytes(script.read_bytes().replace(b"\n", b"\r\n"))
    assert mc.read(script).keys == keys.keys


def test_what_blender_cannot_hold_is_refused(tmp_path, keys):
    huge = replace(keys, curves=(mc.HermiteCurve([0], [1e31], [0]), *keys.curves[1:]))
    with pytest.raises(mc.OptionError, match=r"channel Hips\.Xposition has numbers above 1e\+30"):
        mc.write(tmp_path / "a.blend.py", huge)
    kinds = (("Zrotation", "Xrotation", "Zrotation"), ("Xrotation",), ())
    with pytest.raises(mc.OptionError, match=r"joint 'Hips' has a channel twice \(Zrotation Xrotation Zrotation\)"):
        mc.write(tmp_path / "a.blend.py", replace(keys, skeleton=replace(keys.skeleton, channels=kinds)))
    assert not list(tmp_path.iterdir())


# -- rotations and bones -----------------------------------------------------------------------------
def test_there_are_24_turns_of_the_axes_and_the_first_is_none():
    assert len({m.tobytes() for m in maths.PERMUTATIONS}) == 24
    assert all(np.linalg.det(m) == 1 for m in maths.PERMUTATIONS)
    assert (maths.PERMUTATIONS[0] == np.eye(3)).all()


@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize("turn", range(24))
def test_euler_angles_seen_from_a_turned_bone_are_the_same_angles(turn, order):
    basis = maths.PERMUTATIONS[turn]
    angles = np.radians([[31.0, -47.0, 110.0], [-170.0, 80.0, 12.0]])
    axes = ["XYZ".index(axis) for axis in order]
    seen = [maths.axes_of(basis)[axis] for axis in axes]
    flat = np.zeros_like(angles)
    q = maths.turned(angles, flat, axes)[0]
    assert q == pytest.approx(rotation.from_euler(np.degrees(angles), order))
    signed = angles * [sign for _, sign in seen]
    assert maths.in_basis(q, basis) == pytest.approx(maths.turned(signed, flat, [axis for axis, _ in seen])[0])


@pytest.mark.parametrize("order", ORDERS)
@given(first=st.floats(-720, 720), middle=st.floats(-90, 90), last=st.floats(-720, 720))
def test_angles_come_back_from_quaternions(order, first, middle, last):
    axes = ["XYZ".index(axis) for axis in order]
    q = rotation.from_euler(np.array([[first, middle, last]]), order)
    angles = maths.as_angles(q, axes, np.radians([first, middle, last]))
    assert rotation.angle(rotation.from_euler(np.degrees(angles), order), q) == pytest.approx(0, abs=1e-5)
    if abs(middle) < 89:
        assert np.degrees(angles[0]) == pytest.approx([first, middle, last], abs=1e-5)


def test_quaternion_keys_stay_within_their_tolerance_also_where_tangents_break():
    rng = np.random.default_rng(3)
    curves = [maths.Curve(np.arange(0, 50, 10.0), *rng.normal(0, [[1.5], [0.3], [0.3]], (3, 5))) for _ in range(3)]
    basis = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    basis *= np.linalg.det(basis)
    made = maths.as_quaternions(curves, [2, 0, 1], basis)
    at = np.linspace(0, 40, 1601)
    angles = np.column_stack([maths.sampled(curve, at, at)[0] for curve in curves])
    true = maths.in_basis(maths.turned(angles, 0 * angles, [2, 0, 1])[0], basis)
    seen = np.column_stack([maths.sampled(curve, at, at)[0] for curve in made])
    assert np.degrees(maths.turn_between(seen, true)).max() < 1.1e-4
    assert len(made[0].frames) < 400


@given(st.lists(st.floats(-1, 1), min_size=3, max_size=3).filter(lambda v: np.linalg.norm(v) > 0.1))
def test_a_bone_lies_along_the_axis_nearest_to_it(vector):
    unit = np.array(vector) / np.linalg.norm(vector)
    assert maths.straight(unit)[:, 1] @ unit == pytest.approx(np.abs(unit).max(), abs=1e-8)


def test_bones_get_names_of_their_own_that_fit():
    given_names = ["Leg", "Leg", "", "", "x" * 70, "x" * 70, "é" * 40, "a\0b", "\ud800"]
    names = maths.bone_names(given_names)
    assert names[:4] == ["Leg", "Leg.001", "bone", "bone.001"]
    assert len(set(names)) == len(names)
    assert all(0 < len(name.encode()) <= 63 for name in names)
    assert names[6] == "é" * 31


def test_bones_point_at_their_children_and_have_a_length():
    offsets = np.array([[0, 0, 0], [0, 10, 0], [4, 0, 0], [0, 0, 0], [0, 0, 5.0]])
    vectors = maths.bone_vectors([-1, 0, 0, 2, 3], offsets)
    assert vectors[0].tolist() == [2, 5, 0]
    assert vectors[3].tolist() == [0, 0, 5]
    assert (np.linalg.norm(vectors, axis=1) > 0.5).all()
    assert maths.bone_vectors([-1], np.zeros((1, 3))).tolist() == [[0, pytest.approx(0.3), 0]]


@pytest.mark.parametrize("turn", range(24))
def test_axes_and_size_of_another_armature_are_found(turn):
    ours = np.array([[0, 10, 0], [4, 0, 1], [-4, 0, 1], [0, 7, 2.0]])
    found, scale, left = maths.alignment(ours, 2.5 * ours @ maths.PERMUTATIONS[turn].T)
    assert (found == maths.PERMUTATIONS[turn]).all()
    assert scale == pytest.approx(2.5, rel=1e-5)
    assert left < 1e-5
    assert maths.alignment(np.zeros((0, 3)), np.zeros((0, 3)))[1:] == (1.0, 0.0)


# -- keys ------------------------------------------------------------------------------------------
def curve(seed: int = 0, broken: bool = True) -> maths.Curve:
    values, leaving, arriving = np.random.default_rng(seed).normal(0, [[1], [0.2], [0.2]], (3, 6))
    return maths.Curve(np.array([0, 3, 11, 12, 40, 90.0]), values, leaving, arriving if broken else leaving)


def test_keys_of_a_curve_give_the_curve_back():
    keys = blender_keys.keys_of(curve(), "BEZIER")
    back, source = blender_keys.curve_of(keys, 1e-6)
    assert source.tolist() == list(range(6))
    assert np.column_stack(back) == pytest.approx(np.column_stack(curve()), abs=1e-5)
    assert blender_keys.same_keys(keys, keys)
    whole = blender_keys.restored(back, source, keys, keys, curve())
    assert [part.tobytes() for part in whole] == [part.tobytes() for part in curve()]


def test_a_weighted_sum_of_curves_is_exact():
    one, other = curve(1), maths.Curve(*(part[:4] for part in curve(2)))
    made = maths.mixed([one, other], np.array([2.0, -3.0]), 5.0)
    at = np.linspace(-5, 95, 401)
    total = 2 * maths.sampled(one, at, at)[0] - 3 * maths.sampled(other, at, at)[0] + 5
    assert maths.sampled(made, at, at)[0] == pytest.approx(total, abs=1e-12)


@pytest.mark.parametrize("reach", [0.0, 0.2, 0.9, 1.0, 1.7])
def test_handles_moved_in_time_keep_the_shape_of_the_curve(reach):
    points = np.array([[[-1, 0], [0, 0], [10 * reach, 2]], [[7, -3], [10, 1], [11, 1]]], np.float32)
    made, source = blender_keys.curve_of(blender_keys.Keys(points, ["BEZIER"] * 2, np.zeros(2, bool)), 1e-4)
    b = points.reshape(6, 2)[1:5].astype(float)
    if reach > 1:  # as Blender does it
        b[1] /= reach
    s = np.linspace(0, 1, 1001)[:, None]
    x, y = ((1 - s) ** 3 * b[0] + 3 * s * (1 - s) ** 2 * b[1] + 3 * s * s * (1 - s) * b[2] + s**3 * b[3]).T
    near_a_steep_end = (x < 0.02) | (x > 9.98)
    error = np.abs(maths.sampled(made, x, x)[0] - y)
    assert error[~near_a_steep_end].max() < 3e-4
    assert source[[0, -1]].tolist() == [0, 1]
    assert (source[1:-1] == -1).all()


def test_lines_and_steps_become_hermite_curves():
    points = blender_keys.keys_of(curve(), "BEZIER").points
    kinds = ["LINEAR", "CONSTANT", "LINEAR", "CONSTANT", "LINEAR", "BEZIER"]
    made, _ = blender_keys.curve_of(blender_keys.Keys(points, kinds, np.zeros(6, bool)), 1e-6)
    values = curve().values
    assert maths.sampled(made, np.array([1.5, 10.5, 39.5, 65.0]), np.array([1.5, 10.5, 39.5, 65.0]))[
        0
    ] == pytest.approx([(values[0] + values[1]) / 2, values[1], values[3], (values[4] + values[5]) / 2], abs=1e-6)


def test_only_edited_numbers_lose_digits():
    given_keys = blender_keys.keys_of(curve(broken=False), "BEZIER")
    points = given_keys.points.copy()
    points[2, :, 1] += np.float32(0.5)
    keys = given_keys._replace(points=points)
    back, source = blender_keys.curve_of(keys, 1e-6)
    whole = blender_keys.restored(back, source, keys, given_keys, curve(broken=False))
    assert np.flatnonzero(whole.values != curve().values).tolist() == [2]
    assert whole.values[2] == float(points[2, 1, 1])
    assert whole.leaving.tobytes() == curve().leaving.tobytes()
    assert whole.arriving.tobytes() == curve().leaving.tobytes()
    assert math.isclose(whole.frames[2], 11)
