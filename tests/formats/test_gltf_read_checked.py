"""What is read of glTF files is what three.js plays of them, also once glTF-Transform has written them anew."""

from __future__ import annotations

from pathlib import Path

import node
import numpy as np
import pytest
from gltf_files import Scene, chain, turn

from mocurve import kinematics, rotation
from mocurve.formats import gltf

NAMES = {
    "Fox.glb": ["Survey", "Walk", "Run"],
    "bird_animations.glb": ["Flap", "Glide", "Idle", "Rest Pose", "Walk"],
}
FIRST = {"Fox.glb": 0.0, "bird_animations.glb": 1 / 24}  # second of the first key
DEGREES, LENGTHS = 2e-3, 2e-5  # lengths as a part of the size
TOO_LONG = 1e-4  # the same for quaternions of integers, which three.js does not bring to length 1


def differences(jobs: list[tuple[Path, str, float]], late: float = 0.0) -> list[tuple[float, float]]:
    """Largest difference from three.js of (file, animation, second of the first frame): degrees, part of the size.

    late: seconds that three.js looks after the frame.
    """
    motions = [gltf.read(path, animation=name) for path, name, _ in jobs]
    times = [first + np.arange(m.frames) * m.frame_time + late for m, (_, _, first) in zip(motions, jobs, strict=True)]
    shown = node.play([(path, name, when) for (path, name, _), when in zip(jobs, times, strict=True)])
    result = []
    for motion, played in zip(motions, shown, strict=True):
        joints = [motion.skeleton.joint(name) for name in played.joints]
        places = kinematics.world(motion)[:, joints]
        wxyz = played.wxyz / np.linalg.norm(played.wxyz, axis=-1, keepdims=True)
        away = float(np.abs(places - played.places).max() / np.ptp(places.reshape(-1, 3), axis=0).max())
        result.append((float(rotation.angle(kinematics.rotations(motion)[:, joints], wxyz).max()), away))
    return result


@pytest.mark.parametrize("how", ["as it is", "resample", "integers"])
def test_three_plays_what_is_read(clips, tmp_path, how):
    node.require()
    jobs = []
    for name, animations in NAMES.items():
        path = clips / "other" / name
        if how != "as it is":
            node.rewrite([(path, tmp_path / name, how)])
            path = tmp_path / name
        jobs += [(path, animation, FIRST[name]) for animation in animations]
    for (path, animation, _), (degrees, part) in zip(jobs, differences(jobs), strict=True):
        assert degrees <= DEGREES, (path.name, animation)
        assert part <= (TOO_LONG if how == "integers" else LENGTHS), (path.name, animation)


def test_sparse_accessors_of_gltf_transform_are_read(tmp_path):
    node.require()
    scene = Scene(chain((0, 1, 0), (0, 2, 0)), [0, 1])
    places = np.zeros((100, 3))
    places[[7, 50, 51]] = [[1, 2, 3], [4, 5, 6], [0, 0, 7]]
    scene.animate(0, "translation", np.arange(100) / 30, places)
    scene.animate(1, "rotation", np.arange(100) / 30, [turn(3 * k) for k in range(100)])
    node.rewrite([(scene.glb(tmp_path / "a.glb"), tmp_path / "b.glb", "sparse")])
    assert b'"sparse":{' in (tmp_path / "b.glb").read_bytes()
    assert gltf.read(tmp_path / "b.glb").values[:, :3].tolist() == places.tolist()


def test_gltf_transform_stores_turns_as_integers(clips, tmp_path):
    node.require()
    node.rewrite([(clips / "other" / "Fox.glb", tmp_path / "a.glb", "integers")])
    assert b'"normalized":true' in (tmp_path / "a.glb").read_bytes()


def test_the_same_is_read_with_buffers_beside_the_file(clips, tmp_path):
    node.require()
    source = clips / "other" / "Fox.glb"
    node.rewrite([(source, tmp_path / "fox.gltf", "beside")])
    assert len(list(tmp_path.glob("*.bin"))) == 1
    ours, theirs = (gltf.read(path, animation="Run") for path in (source, tmp_path / "fox.gltf"))
    assert ours.values.tobytes() == theirs.values.tobytes()
    assert ours.skeleton.names == theirs.skeleton.names


@pytest.mark.parametrize("form", ["LINEAR", "STEP", "CUBICSPLINE"])
def test_three_plays_every_kind_of_curve_alike(tmp_path, form):
    node.require()
    rng = np.random.default_rng(5)
    scene = Scene(chain((0, 1, 0), (0, 2, 0), (1, 1, 1), (0, 0, 3), rotation=turn(40, 1)), [0, 1, 2, 3])
    times = np.array([0, 3, 4, 9, 20]) / 30
    parts = 3 if form == "CUBICSPLINE" else 1
    for joint in range(3):
        keys = rng.normal(size=(5, parts, 4))
        keys[:, parts // 2] /= np.linalg.norm(keys[:, parts // 2], axis=1, keepdims=True)
        scene.animate(joint, "rotation", times, keys.reshape(-1, 4), form)
    scene.animate(0, "translation", times, rng.normal(size=(5 * parts, 3)), form)
    scene.animate(1, "scale", times, np.repeat(rng.uniform(0.5, 2, 5 * parts), 3).reshape(-1, 3), form)
    late = 1e-6 if form == "STEP" else 0.0  # a key rounded to float32 may stand right behind its frame
    [(degrees, part)] = differences([(scene.glb(tmp_path / "a.glb"), "move", 0.0)], late)
    assert degrees <= DEGREES
    assert part <= LENGTHS
