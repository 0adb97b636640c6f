"""Skeletal animations of glTF files: what the curves, the tree, scales and rates of other programs become."""

from __future__ import annotations

import numpy as np
import pytest
from gltf_files import Scene, chain, turn

import mocurve as mc
from mocurve import kinematics, rotation
from mocurve.formats import gltf

FPS30 = np.arange(4) / 30


@pytest.fixture
def path(tmp_path):
    return tmp_path / "a.glb"


def two(joints: list[int] | None = None) -> Scene:
    return Scene(chain((0, 1, 0), (0, 2, 0)), [0, 1] if joints is None else joints)


def test_straight_turns_go_at_constant_speed_the_shorter_way(path):
    scene = two()
    scene.animate(1, "rotation", [0, 0.1], [turn(-170), [-x for x in turn(-110)]])
    motion = gltf.read(scene.glb(path))
    assert motion.frame_time == 1 / 30
    np.testing.assert_allclose(motion.values[:, 6], [-170, -150, -130, -110], atol=1e-4)


def test_steps_are_held_until_the_frame_of_the_next_key(path):
    scene = two()
    scene.animate(1, "rotation", np.array([0, 2, 3]) / 30, [turn(10), turn(20), turn(30)], "STEP")
    scene.animate(0, "translation", np.array([0, 1, 3]) / 30, [[1, 0, 0], [2, 0, 0], [3, 0, 0]], "STEP")
    motion = gltf.read(scene.glb(path))
    np.testing.assert_allclose(motion.values[:, 6], [10, 10, 20, 30], atol=1e-5)
    assert motion.values[:, 0].tolist() == [1, 2, 2, 3]


def test_cubic_curves_have_tangents_by_the_second_and_unit_length(path):
    scene = two()
    flat, up = [[0, 0, 0]] * 3, [[9, 9, 9], [1, 0, 0], [0, 30, 0]]  # tangent in, value, tangent out
    scene.animate(0, "translation", [0, 0.1], np.reshape([up, flat], (6, 3)), "CUBICSPLINE")
    keys = [np.zeros(4), 2 * np.array(turn(0)), np.zeros(4), np.zeros(4), 2 * np.array(turn(90)), np.zeros(4)]
    scene.animate(1, "rotation", [0, 0.1], keys, "CUBICSPLINE")
    motion = gltf.read(scene.glb(path))
    u = np.arange(4) / 3
    np.testing.assert_allclose(motion.values[:, 0], 1 - u * u * (3 - 2 * u), atol=1e-7)
    np.testing.assert_allclose(motion.values[:, 1], 3 * u * (1 - u) ** 2, atol=1e-6)
    share = u * u * (3 - 2 * u)
    angle = 2 * np.degrees(np.arctan2(share * np.sin(np.pi / 4), 1 - share + share * np.cos(np.pi / 4)))
    np.testing.assert_allclose(motion.values[:, 6], angle, atol=1e-5)


def test_before_the_first_key_and_after_the_last_the_value_is_held(path):
    scene = two()
    scene.animate(1, "rotation", [1 / 30, 2 / 30], [turn(10), turn(20)])
    scene.animate(0, "translation", FPS30, np.arange(12).reshape(4, 3))
    np.testing.assert_allclose(gltf.read(scene.glb(path)).values[:, 6], [10, 10, 20, 20], atol=1e-5)


def test_angles_go_on_beyond_half_a_turn(path):
    scene = two()
    scene.animate(1, "rotation", np.arange(31) / 30, [turn(24 * k) for k in range(31)])
    np.testing.assert_allclose(gltf.read(scene.glb(path)).values[:, 6], 24 * np.arange(31), atol=1e-4)


def test_a_rest_rotation_is_in_the_channels_and_offsets_stay_in_the_parents_frame(path):
    nodes = chain((0, 1, 0), (0, 2, 0), (3, 0, 0), rotation=turn(90, 0))
    scene = Scene(nodes, [0, 1, 2])
    scene.animate(1, "rotation", FPS30, [turn(5 * k) for k in range(4)])
    motion = gltf.read(scene.glb(path))
    assert motion.skeleton.offsets.tolist() == [[0, 1, 0], [0, 2, 0], [3, 0, 0]]
    np.testing.assert_allclose(motion.values[:, 3:6], [[0, 0, 90]] * 4, atol=1e-5)
    np.testing.assert_allclose(kinematics.world(motion)[0, 1:], [[0, 1, 2], [3, 1, 2]], atol=1e-6)
    assert motion.skeleton.unit == 1.0


def test_joints_come_depth_first_with_all_that_they_hang_on(path):
    nodes = [
        {"name": "hand", "translation": [1, 0, 0]},
        {"name": "mesh"},
        {"name": "arm", "children": [0]},
        {"name": "world", "children": [1, 5, 4]},
        {"name": "leg"},
        {"name": "hips", "children": [2]},
    ]
    scene = Scene(nodes, [0, 4])
    scene.animate(0, "rotation", FPS30, [turn(k) for k in range(4)])
    body = gltf.read(scene.glb(path)).skeleton
    assert body.names == ("world", "hips", "arm", "hand", "leg")
    assert body.parents.tolist() == [-1, 0, 1, 2, 0]


def test_several_skins_make_one_body_with_several_roots(path):
    scene = Scene([*chain((0, 1, 0), (0, 2, 0)), {"name": "other"}, {"translation": [0, 0, 0]}], [0, 1])
    scene.json["skins"].append({"joints": [1, 2]})
    scene.animate(2, "rotation", FPS30, [turn(k) for k in range(4)])
    body = gltf.read(scene.glb(path)).skeleton
    assert body.names == ("n0", "n1", "other")
    assert body.parents.tolist() == [-1, 0, -1]


def test_without_a_skin_the_animated_nodes_and_their_parents_are_the_joints(path):
    scene = Scene([*chain((0, 1, 0), (0, 2, 0), (0, 3, 0)), {}])
    scene.animate(1, "rotation", FPS30, [turn(k) for k in range(4)])
    assert gltf.read(scene.glb(path)).skeleton.names == ("n0", "n1")


def test_what_is_animated_beside_the_skin_is_dropped_with_a_warning(path):
    scene = Scene([*chain((0, 1, 0), (0, 2, 0)), {"name": "camera"}], [0, 1])
    scene.animate(1, "rotation", FPS30, [turn(k) for k in range(4)])
    scene.animate(2, "translation", FPS30, np.zeros((4, 3)))
    scene.animate(0, "weights", FPS30, np.zeros(4))
    with (
        pytest.warns(UserWarning, match="no joints are dropped: camera"),
        pytest.warns(UserWarning, match="weights of morph"),
    ):
        assert gltf.read(scene.glb(path)).skeleton.names == ("n0", "n1")


def test_only_what_moves_against_its_parent_has_position_channels(path):
    scene = Scene(chain((0, 1, 0), (0, 2, 0), (0, 3, 0)), [0, 1, 2])
    scene.animate(1, "translation", FPS30, [[0, 5, 0]] * 4)
    scene.animate(2, "translation", FPS30, [[0, k, 0] for k in range(4)])
    motion = gltf.read(scene.glb(path))
    assert [len(kinds) for kinds in motion.skeleton.channels] == [6, 3, 6]
    assert motion.skeleton.offsets.tolist()[:2] == [[0, 1, 0], [0, 5, 0]]
    assert motion.values[:, 10].tolist() == [0, 1, 2, 3]


def test_nodes_without_a_name_are_called_by_their_place(path):
    scene = Scene([{"children": [1]}, {"name": ""}], [0, 1])
    scene.animate(1, "rotation", FPS30, [turn(k) for k in range(4)])
    assert gltf.read(scene.glb(path)).skeleton.names == ("nodes[0]", "nodes[1]")


# -- scale and matrices --------------------------------------------------------------------------


def test_an_even_scale_is_worked_into_all_offsets_below(path):
    nodes = chain((1, 0, 0), (0, 2, 0), (0, 3, 0), scale=[0.5, 0.5, 0.5])
    nodes[1]["scale"] = [-4, -4, -4]
    scene = Scene(nodes, [0, 1, 2])
    scene.animate(1, "translation", FPS30, [[0, k, 0] for k in range(4)])
    motion = gltf.read(scene.glb(path))
    np.testing.assert_allclose(motion.skeleton.offsets, [[1, 0, 0], [0, 0, 0], [0, -6, 0]])
    np.testing.assert_allclose(motion.values[:, 7], [0, 0.5, 1, 1.5])


def test_an_even_scale_that_changes_moves_the_joints_below(path):
    scene = Scene(chain((1, 0, 0), (0, 2, 0)), [0, 1])
    scene.animate(0, "scale", [0, 0.1], [[1, 1, 1], [4, 4, 4]])
    motion = gltf.read(scene.glb(path))
    np.testing.assert_allclose(motion.values[:, 7], [2, 4, 6, 8], rtol=1e-6)


def test_an_uneven_scale_holds_only_right_below_and_says_so(path):
    scene = Scene(chain((1, 0, 0), (0, 2, 0), (0, 3, 0), scale=[1, 8, 1]), [0, 1, 2])
    scene.animate(2, "rotation", FPS30, [turn(k) for k in range(4)])
    with pytest.warns(UserWarning, match="scale that differs between the axes is kept only .* right below: n0"):
        motion = gltf.read(scene.glb(path))
    np.testing.assert_allclose(motion.skeleton.offsets, [[1, 0, 0], [0, 16, 0], [0, 6, 0]])


@pytest.mark.parametrize("degrees", [0, 50, 120, 180])
@pytest.mark.parametrize("axis", [0, 1, 2])
def test_a_matrix_is_taken_apart(path, degrees, axis):
    xyzw = np.array(turn(degrees, axis))
    columns = [2 * rotation.rotate(np.roll(xyzw, 1), unit) for unit in np.eye(3)]
    matrix = [[*column, 0] for column in columns] + [[5, 6, 7, 1]]
    nodes = chain((0, 0, 0), (0, 3, 0))
    nodes[0] = {"matrix": np.ravel(matrix).tolist(), "children": [1]}
    scene = Scene(nodes, [0, 1])
    scene.animate(1, "rotation", FPS30, [turn(k) for k in range(4)])
    motion = gltf.read(scene.glb(path))
    np.testing.assert_allclose(
        kinematics.world(motion)[0], [[5, 6, 7], np.array([5, 6, 7]) + 3 * columns[1]], atol=1e-6
    )


def test_a_sheared_matrix_is_told(path):
    nodes = chain((0, 0, 0), (0, 3, 0))
    nodes[0] = {"matrix": [1, 0, 0, 0, 0.5, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1], "children": [1]}
    scene = Scene(nodes, [0, 1])
    scene.animate(1, "rotation", FPS30, [turn(k) for k in range(4)])
    with pytest.warns(UserWarning, match=r"shear is dropped: nodes\[0\]"), pytest.warns(UserWarning, match="differs"):
        gltf.read(scene.glb(path))


# -- how numbers are stored ----------------------------------------------------------------------


@pytest.mark.parametrize(("dtype", "one"), [("i1", 127), ("i2", 32767), ("u1", 255), ("u2", 65535)])
def test_normalized_integers_are_numbers_up_to_1(path, dtype, one):
    scene = two()
    stored = np.rint(np.array([turn(10 * k) for k in range(4)]) * one)
    scene.animate(1, "rotation", FPS30, scene.accessor(stored, dtype, normalized=True))
    np.testing.assert_allclose(gltf.read(scene.glb(path)).values[:, 6], [0, 10, 20, 30], atol=100 / one)


def test_the_smallest_integer_is_minus_1_too(path):
    scene = two()
    scene.animate(1, "rotation", FPS30, scene.accessor([[0, 0, -128, 0]] * 4, "i1", normalized=True))
    np.testing.assert_allclose(np.abs(gltf.read(scene.glb(path)).values[:, 6]), 180)


def test_numbers_may_stand_in_turns_with_others(path):
    scene = two()
    both = np.zeros((4, 12), "<f4")
    both[:, 1:4], both[:, 5:9] = np.arange(12).reshape(4, 3), [turn(10 * k) for k in range(4)]
    view = scene.view(both.tobytes(), byteStride=48)
    for start, kind in ((4, "VEC3"), (20, "VEC4")):
        told = {"bufferView": view, "byteOffset": start, "componentType": 5126, "count": 4, "type": kind}
        scene.json["accessors"].append(told)
    scene.animate(0, "translation", FPS30, 0)
    scene.animate(1, "rotation", FPS30, 1)
    motion = gltf.read(scene.glb(path))
    assert motion.values[:, :3].tolist() == np.arange(12).reshape(4, 3).tolist()
    np.testing.assert_allclose(motion.values[:, 6], [0, 10, 20, 30], atol=1e-5)


@pytest.mark.parametrize("base", [True, False])
def test_sparse_accessors_change_some_elements(path, base):
    scene = two()
    places = scene.accessor(np.ones((4, 3)))
    scene.json["accessors"][places]["sparse"] = {
        "count": 2,
        "indices": {"bufferView": scene.view(np.array([1, 3], "<u2").tobytes()), "componentType": 5123},
        "values": {"bufferView": scene.view(np.array([[5, 6, 7], [8, 9, 10]], "<f4").tobytes())},
    }
    if not base:
        del scene.json["accessors"][places]["bufferView"]
    scene.animate(0, "translation", FPS30, places)
    rest = [1, 1, 1] if base else [0, 0, 0]
    assert gltf.read(scene.glb(path)).values[:, :3].tolist() == [rest, [5, 6, 7], rest, [8, 9, 10]]


@pytest.mark.parametrize(("beside", "uri"), [(None, None), ("b.bin", None), ("deep/b ü.bin", "deep/b%20%C3%BC.bin")])
def test_buffers_stand_in_the_file_or_beside_it(tmp_path, beside, uri):
    scene = two()
    scene.animate(1, "rotation", FPS30, [turn(10 * k) for k in range(4)])
    motion = gltf.read(scene.gltf(tmp_path / "a.gltf", beside, uri))
    np.testing.assert_allclose(motion.values[:, 6], [0, 10, 20, 30], atol=1e-5)


# -- animations and rates ------------------------------------------------------------------------


def test_an_animation_is_asked_for_by_name(path):
    scene = two()
    for name, degrees in (("run", 1), ("jump", 2)):
        scene.animate(1, "rotation", FPS30, [turn(degrees * k) for k in range(4)])
        scene.json["animations"].append({"name": name, "channels": [], "samplers": []})
    scene.json["animations"].pop()
    scene.glb(path)
    np.testing.assert_allclose(gltf.read(path, animation="run").values[-1, 6], 6, atol=1e-5)
    with pytest.warns(UserWarning, match="2 animations: 'move' is read, not 'run'"):
        np.testing.assert_allclose(gltf.read(path).values[-1, 6], 3, atol=1e-5)
    with pytest.raises(mc.UnknownName, match=r"no animation 'ran'\. Did you mean 'run'\?"):
        gltf.read(path, animation="ran")


@pytest.mark.parametrize("fps", [24, 25, 30, 48, 60, 100, 119.88011988011988, 120, 29.97002997002997, 37, 1000])
@pytest.mark.parametrize("start", [0, 1, 1000])
def test_the_rate_is_the_one_that_all_keys_fit(path, fps, start):
    scene = two()
    scene.animate(1, "rotation", (start + np.arange(60)) / fps, [turn(k) for k in range(60)])
    if start > 1:
        with pytest.warns(UserWarning, match="the first key is at second .*: frame 0 is there"):
            motion = gltf.read(scene.glb(path))
    else:
        motion = gltf.read(scene.glb(path))
    assert motion.frame_time == pytest.approx(1 / fps, rel=1e-12)
    np.testing.assert_allclose(motion.values[:, 6], np.arange(60), atol=1e-4)


def test_keys_of_several_tracks_share_a_rate(path):
    scene = two()
    scene.animate(1, "rotation", [0, 2 / 60, 1], [turn(k) for k in range(3)])
    scene.animate(0, "rotation", [0, 5 / 60, 2], [turn(k) for k in range(3)])
    motion = gltf.read(scene.glb(path))
    assert (motion.frame_time, motion.frames) == (1 / 60, 121)


@pytest.mark.parametrize("keys", [range(3000), [0, 7, 30, 31, 100, 900, 2999]])
def test_a_rate_that_a_program_rounded_is_the_one_it_means(path, keys):
    """Blender makes a frame time of 0.033333 s a rate of 30.0003; the last key is then 0.03 frames early."""
    scene = two()
    scene.animate(1, "rotation", 0.033333 * np.array(keys), [turn(k % 50) for k in keys])
    motion = gltf.read(scene.glb(path))
    assert (motion.frame_time, motion.frames) == (1 / 30, 3000)
    np.testing.assert_allclose(motion.values[list(keys), 6], [k % 50 for k in keys], atol=1e-5)


@pytest.mark.parametrize(("step", "rate"), [(0.0501234, 30), (0.0101234, 60)])
def test_keys_that_fit_no_rate_are_told(path, step, rate):
    scene = two()
    scene.animate(1, "rotation", np.cumsum([0, step, step, step * np.pi]), [turn(k) for k in range(4)])
    with pytest.warns(UserWarning, match=f"its keys fit no frame rate: read at {rate} frames a second"):
        motion = gltf.read(scene.glb(path))
    assert motion.frame_time == 1 / rate
    assert motion.duration <= step * (2 + np.pi) < motion.duration + motion.frame_time


def test_a_single_key_is_a_single_frame(path):
    scene = two()
    scene.animate(1, "rotation", [0], [turn(7)])
    motion = gltf.read(scene.glb(path))
    assert motion.frames == 1
    np.testing.assert_allclose(motion.values[:, 6], 7, atol=1e-5)
