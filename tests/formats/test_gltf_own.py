"""What was written to glTF comes back with its own channels, unit and frames, until another program has changed it."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
from gltf_files import glb

import mocurve as mc
from mocurve import kinematics
from mocurve.motion import unroll

OTHER = ["mixed_rotation_orders", "rotation_before_position_root", "spec_example_wisc", "hands_60_joints"]


def parts(path) -> tuple[dict, bytes]:
    data = path.read_bytes()
    size = int.from_bytes(data[12:16], "little")
    return json.loads(data[20 : 20 + size]), data[28 + size :]


@pytest.fixture
def written(tmp_path, jump):
    """An inner piece of the shipped clip, in inches, as a GLB of all frames."""
    motion = mc.read(jump, unit="inch")[100:160]
    motion = replace(motion, history=({"verb": "slice", "first": 100},))
    mc.write(tmp_path / "a.glb", motion, profile="baked")
    return motion, tmp_path / "a.glb"


def test_all_comes_back(written):
    motion, path = written
    back = mc.read(path)
    assert back.skeleton.names == motion.skeleton.names
    assert back.skeleton.channels == motion.skeleton.channels
    assert back.skeleton.end_sites.tolist() == motion.skeleton.end_sites.tolist()
    assert back.skeleton.parents.tolist() == motion.skeleton.parents.tolist()
    assert back.skeleton.offsets.tolist() == motion.skeleton.offsets.tolist()
    assert (back.skeleton.unit, back.frame_time, back.history) == (0.0254, motion.frame_time, motion.history)
    np.testing.assert_allclose(back.values, motion.values, atol=2e-5)


@pytest.mark.parametrize("name", OTHER)
def test_odd_orders_and_turns_come_back(tmp_path, clips, name):
    motion = unroll(mc.read(clips / "other" / f"{name}.bvh", unit="cm"))
    mc.write(tmp_path / "a.gltf", motion, profile="baked", mesh=False)
    back = mc.read(tmp_path / "a.gltf")
    assert back.skeleton.channel_names == motion.skeleton.channel_names
    assert back.frame_time == motion.frame_time
    np.testing.assert_allclose(back.values, motion.values, atol=2e-4)  # near gimbal lock float32 is that coarse


def test_whole_turns_of_the_start_come_back(tmp_path, written):
    motion, _ = written
    turned = np.array(motion.values)
    turned[:, motion.skeleton.channel("Hips.Yrotation")] += 720
    mc.write(tmp_path / "b.glb", replace(motion, values=turned), profile="baked")
    np.testing.assert_allclose(mc.read(tmp_path / "b.glb").values, turned, atol=2e-5)


def put(target: dict, where: str, value: object) -> None:
    *way, last = [int(step) if step.isdigit() else step for step in where.split(".")]
    for step in way:
        target = target[step]
    target[last] = value


SKIN, CLIP = "skins.0.extras.mocurve", "animations.0.extras.mocurve"


@pytest.mark.parametrize(
    ("where", "value", "words"),
    [
        (f"{SKIN}.version", 2, "version: a whole number from 1 to 1 expected, 2 found"),
        (f"{SKIN}.names", ["a"], "1 joint names but"),
        (f"{SKIN}.names", 5, "names: a list of strings expected"),
        (f"{SKIN}.channels", [["Xrotation"]], "38 joint names but 1 channels"),
        (f"{SKIN}.channels.1", ["Wrotation"], "no channel kind"),
        (f"{SKIN}.offsets.0", [1, 2], "offsets: 3 finite numbers expected"),
        (f"{SKIN}.end_sites", [1000], "end_sites: a whole number from 0 to 37 expected, 1000 found"),
        (f"{SKIN}.unit", -1, "unit: a number above 0 expected"),
        (f"{SKIN}.scale", 0, "scale: a number above 0 expected"),
        (f"{SKIN}.scale", 1.0, "rests elsewhere than it was written"),
        (f"{CLIP}.frames", 1_000_000_000, "frames of 96 channels in a file of"),
        (f"{CLIP}.frames", 30, "30 said, but there is a key at second 0.491667"),
        (f"{CLIP}.frame_time", None, "frame_time: 1 finite numbers expected"),
        (f"{CLIP}.start", [0], "start: 96 finite numbers expected"),
        (f"{CLIP}.history", [1], "history: a list of objects expected"),
        ("nodes.5.translation", [1, 2, 3], "rests elsewhere than it was written"),
        ("nodes.5.scale", [1, 2, 1], "moved, turned or scaled since it was written"),
        ("nodes.5.scale", [2, 2, 2], "moved, turned or scaled since it was written"),
    ],
)
@pytest.mark.filterwarnings("ignore:.*scale that differs:UserWarning")
def test_a_file_that_was_changed_is_read_as_any_other(written, where, value, words):
    motion, path = written
    told, binary = parts(path)
    put(told, where, value)
    path.write_bytes(glb(json.dumps(told).encode(), binary))
    with pytest.warns(UserWarning, match="extras.mocurve does not fit the file and is left aside") as caught:
        back = mc.read(path)
    assert words in "".join(str(one.message) for one in caught)
    assert back.skeleton.unit == 1.0
    assert back.frames == motion.frames
    if not where.startswith("nodes"):
        np.testing.assert_allclose(kinematics.world(back)[:, 1:], kinematics.world(motion) * 0.0254, atol=1e-5)


@pytest.mark.parametrize("extras", [None, 5, {}, {"mocurve": 5}, {"other": {}}])
def test_other_extras_are_left_aside(written, extras):
    _, path = written
    told, binary = parts(path)
    told["skins"][0]["extras"] = extras
    path.write_bytes(glb(json.dumps(told).encode(), binary))
    assert mc.read(path).skeleton.unit == 1.0


def test_a_node_put_above_the_root_that_moves_it_is_seen(written):
    motion, path = written
    told, binary = parts(path)
    told["nodes"].append({"name": "above", "scale": [2, 2, 2], "children": [told["skins"][0]["joints"][0]]})
    for node in told["nodes"][:-1]:
        node["children"] = [child for child in node.get("children", []) if child != told["nodes"][-1]["children"][0]]
    told["nodes"] = [{k: v for k, v in node.items() if k != "children" or v} for node in told["nodes"]]
    path.write_bytes(glb(json.dumps(told).encode(), binary))
    with pytest.warns(UserWarning, match="moved, turned or scaled since it was written"):
        back = mc.read(path)
    assert back.skeleton.names[0] == "above"
    np.testing.assert_allclose(kinematics.world(back)[:, 1:], kinematics.world(motion) * 0.0508, atol=1e-5)
