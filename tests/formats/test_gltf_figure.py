"""The figure of octahedra that viewers show."""

from __future__ import annotations

import numpy as np
import pytest
from glb import Glb

import mocurve as mc
from mocurve.formats._gltf_mesh import GIRDLE, RADIUS, figure


def tree(offsets: np.ndarray, parents: list[int]) -> tuple[np.ndarray, np.ndarray]:
    places = np.array(offsets, float)
    for joint, parent in enumerate(parents):
        places[joint] += places[parent] if parent >= 0 else 0.0
    return np.array(parents), places


@pytest.mark.parametrize("bone", [(0, 2, 0), (0, -1e-12, 0), (3e5, 0, 0), (1, -1, 1), (0, 1e-9, -1)])
def test_an_octahedron_runs_along_its_bone_and_faces_outward(bone):
    parents, places = tree([(0, 0, 0), bone], [-1, 0])
    along = places[1]
    length = np.linalg.norm(along)
    shape = figure(parents, places)
    assert shape.positions.shape == shape.normals.shape == (24, 3)
    assert (shape.joints == 0).all()
    assert np.linalg.norm(shape.normals, axis=1) == pytest.approx(1)
    out = shape.positions / length
    at = out @ (along / length)
    assert sorted({round(x, 3) for x in at.tolist()}) == [0, GIRDLE, 1]
    away = np.linalg.norm(out - at[:, None] * (along / length), axis=1)
    assert away == pytest.approx(np.where(np.abs(at - GIRDLE) < 1e-3, RADIUS, 0), abs=1e-3)
    corners = out.reshape(8, 3, 3)
    faced = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    faced /= np.linalg.norm(faced, axis=1, keepdims=True)
    assert np.repeat(faced, 3, axis=0) == pytest.approx(shape.normals, abs=1e-6)  # anticlockwise from outside
    middle = GIRDLE * along / length
    assert (np.sum((corners.mean(axis=1) - middle) * faced, axis=1) > 0).all()


def test_every_bone_moves_with_the_joint_that_it_hangs_on_and_none_of_no_length_is_drawn():
    parents, places = tree([(0, 0, 0), (0, 1, 0), (0, 0, 0), (1, 0, 0), (0, 0, 1e-9), (5, 5, 5)], [-1, 0, 1, 2, 0, -1])
    shape = figure(parents, places)
    assert shape.joints.tolist() == [0] * 24 + [2] * 24
    assert figure(parents[:1], places[:1]) is None


def test_the_figure_is_one_skinned_primitive_with_its_bounds(tmp_path, jump):
    clip = mc.read(jump, unit=0.056444)
    mc.write(tmp_path / "a.glb", clip, profile="baked")
    file = Glb(tmp_path / "a.glb")
    (mesh,) = file.parts["meshes"]
    (primitive,) = mesh["primitives"]
    arrays = {name: file.array(accessor) for name, accessor in primitive["attributes"].items()}
    bones = np.count_nonzero(np.linalg.norm(clip.skeleton.offsets, axis=1)[clip.skeleton.parents >= 0])
    assert {name: array.shape for name, array in arrays.items()} == {
        "POSITION": (24 * bones, 3),
        "NORMAL": (24 * bones, 3),
        "JOINTS_0": (24 * bones, 4),
        "WEIGHTS_0": (24 * bones, 4),
    }
    assert (arrays["WEIGHTS_0"] == [255, 0, 0, 0]).all()
    assert "min" in file.parts["accessors"][primitive["attributes"]["POSITION"]]
    figure_node = file.parts["nodes"][file.parts["scenes"][0]["nodes"][1]]
    assert figure_node == {"name": "Figure", "mesh": 0, "skin": 0}


def test_the_figure_can_be_left_out(tmp_path, jump):
    mc.write(tmp_path / "a.glb", mc.read(jump, unit="cm"), profile="baked", mesh=False)
    file = Glb(tmp_path / "a.glb")
    assert not file.parts.keys() & {"meshes", "materials"}
    assert len(file.parts["scenes"][0]["nodes"]) == 1
    assert len(file.joints) == len(mc.read(jump).skeleton.names)


@pytest.mark.parametrize(("joints", "width"), [(256, "u1"), (257, "<u2")])
def test_many_joints_are_counted_with_wider_numbers(tmp_path, joints, width):
    body = mc.Skeleton(
        [f"J{joint}" for joint in range(joints)],
        np.arange(joints) - 1,
        np.tile([0.0, 1, 0], (joints, 1)),
        [("Xrotation",)] * joints,
        unit=0.01,
    )
    mc.write(tmp_path / "a.glb", mc.Motion(body, np.ones((2, joints)), 0.1), profile="baked")
    file = Glb(tmp_path / "a.glb")
    owners = file.array(file.parts["meshes"][0]["primitives"][0]["attributes"]["JOINTS_0"])
    assert owners.dtype == np.dtype(width)
    assert owners[:, 0].max() == joints - 2
