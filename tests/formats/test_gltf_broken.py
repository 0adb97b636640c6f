"""Broken glTF files: refused with the place that is wrong, soon, and without much memory."""

from __future__ import annotations

import json
import os
import random
import tracemalloc
import warnings

import numpy as np
import pytest
from gltf_files import Scene, chain, glb, turn

import mocurve as mc
from mocurve.formats import _gltf_read_tracks as tracks
from mocurve.formats import gltf

TIMES = np.arange(4) / 30


@pytest.fixture
def path(tmp_path):
    return tmp_path / "a.glb"


@pytest.fixture
def scene() -> Scene:
    """Accessors: 0, 1 times and turns of the second joint; 2, 3 times and places of the first."""
    made = Scene(chain((0, 1, 0), (0, 2, 0)), [0, 1])
    made.animate(1, "rotation", TIMES, [turn(10 * k) for k in range(4)])
    made.animate(0, "translation", TIMES, np.arange(12).reshape(4, 3))
    return made


def refused(path) -> str:
    """The refusal's text; the memory of it has to stay small beside the file's."""
    tracemalloc.start()
    try:
        with pytest.raises(mc.FileError) as caught:
            gltf.read(path)
        assert tracemalloc.get_traced_memory()[1] < 20e6 + 12 * os.path.getsize(path)
    finally:
        tracemalloc.stop()
    assert str(caught.value).startswith(str(path)) or "no such file" in str(caught.value)
    return str(caught.value)


def put(target: dict, where: str, value: object) -> None:
    """Set what a dotted place in the JSON means; a value of ... takes it out."""
    *way, last = [int(step) if step.isdigit() else step for step in where.split(".")]
    for step in way:
        target = target[step]
    if value is ...:
        del target[last]
    else:
        target[last] = value


SAMPLER, CHANNEL = "animations.0.samplers.0", "animations.0.channels.0"


@pytest.mark.parametrize(
    ("where", "value", "words"),
    [
        ("asset", ..., "asset: an object expected"),
        ("asset.version", "1.0", "asset.version: '2.0' expected, '1.0' found"),
        ("nodes", {}, "nodes: a list of objects expected"),
        ("nodes.0", 5, "nodes: a list of objects expected"),
        ("nodes.0.name", 5, "nodes[0].name: a string"),
        ("nodes.0.children", 1, "nodes[0].children: a list of nodes expected"),
        ("nodes.0.children", [2], "nodes[0].children[0]: the index of one of 2 nodes expected, 2 found"),
        ("nodes.0.children", [-1], "nodes[0].children[0]: the index"),
        ("nodes.0.children", [True], "nodes[0].children[0]: the index"),
        ("nodes.0.children", [1.0], "nodes[0].children[0]: the index"),
        ("nodes.0.children", [1, 1], "nodes[0].children: nodes[1] already hangs on nodes[0]"),
        ("nodes.0.children", [0], "nodes[0]: its parents go round in a circle"),
        ("nodes.1.children", [0], "nodes[0]: its parents go round in a circle"),
        ("nodes.1.children", [1], "nodes[1].children: nodes[1] already hangs on nodes[0]"),
        ("nodes.0.translation", [1, 2], "nodes[0].translation: 3 finite numbers expected"),
        ("nodes.0.translation", [1, 2, "3"], "nodes[0].translation: 3 finite numbers expected"),
        ("nodes.0.translation", [1, 2, 10**400], "nodes[0].translation: 3 finite numbers expected"),
        ("nodes.0.rotation", [0, 0, 0, 0], "nodes[0].rotation: a quaternion of length 1 expected, 0 found"),
        ("nodes.0.matrix", [1] * 15, "nodes[0].matrix: 16 finite numbers expected"),
        ("skins.0.joints", ..., "skins[0].joints: a list of nodes expected"),
        ("skins.0.joints", [7], "skins[0].joints[0]: the index of one of 2 nodes expected, 7 found"),
        ("animations", [], "animations: none in this file"),
        ("animations", ..., "animations: none in this file"),
        ("animations.0.name", [], "animations[0].name: a string"),
        ("animations.0.channels", [], "animations: none that moves a node"),
        ("animations.0.samplers", ..., "channels[0].sampler: the index of one of 0 samplers expected, 0 found"),
        (CHANNEL + ".sampler", 9, "channels[0].sampler: the index of one of 2 samplers expected, 9 found"),
        (CHANNEL + ".target", ..., "animations[0].channels[0].target: an object expected"),
        (CHANNEL + ".target.path", "colour", "channels[0].target.path: translation, rotation, scale or weights"),
        (CHANNEL + ".target.node", 2, "channels[0].target.node: the index of one of 2 nodes expected, 2 found"),
        (CHANNEL + ".target", {"node": 0, "path": "translation"}, "the translation of nodes[0] is animated twice"),
        (SAMPLER + ".interpolation", "BEZIER", "samplers[0].interpolation: LINEAR, STEP or CUBICSPLINE expected"),
        (SAMPLER + ".interpolation", "CUBICSPLINE", "accessors[1].count: 12 expected, 4 found"),
        (SAMPLER + ".input", 99, "animations[0].samplers[0].input: the index of one of 4 accessors expected, 99 found"),
        (SAMPLER + ".output", None, "animations[0].samplers[0].output: the index of one of 4 accessors"),
        (SAMPLER + ".output", 3, "accessors[3].type: VEC4 expected, VEC3 found"),
        ("accessors.0.count", 1_000_000_000, "accessors[0]: 1000000000 elements end at byte 4000000000 of"),
        ("accessors.0.count", 0, "accessors[0].count: a whole number from 1"),
        ("accessors.0.count", -4, "accessors[0].count: a whole number from 1"),
        ("accessors.0.count", 4.0, "accessors[0].count: a whole number from 1"),
        ("accessors.0.count", 10**30, "accessors[0].count: a whole number from 1"),
        ("accessors.0.bufferView", ..., "accessors[0].bufferView: expected, there is none"),
        ("accessors.0.bufferView", 44, "accessors[0].bufferView: the index of one of 4 bufferViews expected, 44 found"),
        ("accessors.0.byteOffset", 4, "accessors[0]: 4 elements end at byte 20 of bufferViews[0], which has 16"),
        ("accessors.0.byteOffset", -4, "accessors[0].byteOffset: a whole number from 0"),
        ("accessors.0.componentType", 5123, "accessors[0].componentType: 5126 (float) expected, 5123 found"),
        ("accessors.1.componentType", 5122, "accessors[1].componentType: 5126 (float) or normalized integers expected"),
        ("accessors.1.componentType", [], "accessors[1].componentType: 5126 (float) or normalized integers expected"),
        ("accessors.1.type", "MAT4", "accessors[1].type: VEC4 expected, MAT4 found"),
        ("accessors.1.count", 3, "accessors[1].count: 4 expected, 3 found"),
        ("accessors.1.sparse", {}, "accessors[1].sparse.count: a whole number from 1 to 4 expected"),
        ("bufferViews.0.buffer", 1, "bufferViews[0].buffer: the index of one of 1 buffers expected, 1 found"),
        ("bufferViews.0.byteOffset", 1 << 40, "bufferViews[0]: ends at byte 1099511627792 of buffers[0], which has"),
        ("bufferViews.0.byteLength", 1 << 40, "bufferViews[0]: ends at byte 1099511627776 of buffers[0], which has"),
        ("bufferViews.0.byteStride", 2, "bufferViews[0].byteStride: a whole number from 4 to 255 expected, 2 found"),
        ("bufferViews.0.byteStride", 8, "accessors[0]: 4 elements end at byte 28 of bufferViews[0], which has 16"),
        ("buffers.0.byteLength", 1_000_000_000, "buffers[0]: 1000000000 bytes announced,"),
        ("buffers.0.byteLength", "1", "buffers[0].byteLength: a whole number"),
        ("buffers.0.uri", 5, "buffers[0].uri: a string expected"),
    ],
)  # fmt: skip
def test_the_place_that_is_wrong_is_told(scene, path, where, value, words):
    scene.json["buffers"][0]["byteLength"] = len(scene.bytes)
    put(scene.json, where, value)
    assert words in refused(scene.glb(path))


@pytest.mark.parametrize(
    ("indices", "component", "words"),
    [
        ([1, 9], 5123, "sparse.indices: rising indices below 4 expected"),
        ([2, 1], 5123, "sparse.indices: rising indices below 4 expected"),
        ([1, 2], 5122, "sparse.indices.componentType: 5121, 5123 or 5125 expected"),
        ([1, 2], 5125, "sparse.indices: 2 elements end at byte 8 of bufferViews[4], which has 4"),
    ],
)
def test_sparse_elements_have_to_be_there(scene, path, indices, component, words):
    scene.json["accessors"][3]["sparse"] = {
        "count": 2,
        "indices": {"bufferView": scene.view(np.array(indices, "<u2").tobytes()), "componentType": component},
        "values": {"bufferView": scene.view(np.zeros((2, 3), "<f4").tobytes())},
    }
    assert words in refused(scene.glb(path))


@pytest.mark.parametrize(
    ("times", "turns", "words"),
    [
        ([0, 1, 1, 2], None, "accessors[4]: key times have to rise, element 2 does not"),
        ([0, 2, 1, 3], None, "accessors[4]: key times have to rise, element 2 does not"),
        ([0, np.nan, 1, 3], None, "accessors[4]: finite numbers expected, [nan] found in element 1"),
        ([0, 1, 2, np.inf], None, "accessors[4]: finite numbers expected, [inf] found in element 3"),
        ([0, 1, 2, 3], np.full((4, 4), np.nan), "accessors[5]: finite numbers expected"),
        ([0, 1, 2, 3], np.zeros((4, 4)), "accessors[5]: unit quaternions expected, one of length 0 found"),
        ([0, 1, 2, 1e30], None, "frames of 9 channels in a file of"),
        ([0, 1, 2, 3e6], None, "frames of 9 channels in a file of"),
    ],
)
def test_numbers_that_are_no_motion_are_told(scene, path, times, turns, words):
    scene.json["animations"][0].update(channels=[], samplers=[])
    scene.animate(1, "rotation", times, [turn(k) for k in range(4)] if turns is None else turns)
    assert words in refused(scene.glb(path))


def test_the_same_numbers_may_not_be_used_without_end(path, monkeypatch):
    monkeypatch.setattr(tracks, "MAX_NUMBERS", 10_000)
    scene = Scene([{} for _ in range(1000)])
    times = scene.accessor(np.arange(100) / 30)
    turns = scene.accessor([turn(k) for k in range(100)])
    for node in range(1000):
        scene.animate(node, "rotation", times, turns)
    assert "samplers use the same numbers again and again" in refused(scene.glb(path))


def test_more_joints_than_any_body_are_refused(path):
    scene = Scene([{} for _ in range(20_001)], list(range(20_001)))
    scene.animate(0, "rotation", TIMES, [turn(k) for k in range(4)])
    assert "at most 20000 joints expected, 20001 found" in refused(scene.glb(path))


def test_joints_hanging_on_one_another_very_deep_are_read(path):
    scene = Scene(chain(*[(0, 1, 0)] * 5000), [4999])
    scene.animate(4999, "rotation", TIMES, [turn(k) for k in range(4)])
    assert len(gltf.read(scene.glb(path)).skeleton.names) == 5000


# -- the container -------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("data", "words"),
    [
        (b"", "not JSON"),
        (b"glTF", "ends within its header"),
        (b"glTF\x01\0\0\0\x0c\0\0\0", "GLB version 2 expected, 1 found"),
        (b"glTF\x02\0\0\0\x0c\0\0\0", "the first chunk of a GLB is JSON, here it is not"),
        (b"glTF\x02\0\0\0\xff\0\0\0", "cut: the header announces 255 bytes, 12 are there"),
        (b"glTF\x02\0\0\0\x14\0\0\0\x10\0\0\0JSON", "chunk 0 announces 16 bytes, 0 are there"),
        (b"glTF\x02\0\0\0\x14\0\0\0\0\0\0\0BIN\0", "the first chunk of a GLB is JSON, here it is not"),
        (b"[]", "glTF: an object expected"),
        (b'{"asset": ', "column 11: not JSON"),
        (b'{"asset": NaN}', "not JSON: NaN is no number of JSON"),
        (b'{"asset": ' + b"9" * 5000 + b"}", "not JSON"),
        (b"\xff\xfe\xfd", "not JSON"),
        (b"[" * 200_000, "nested too deep"),
    ],
)
def test_what_is_no_gltf_is_told(path, data, words):
    path.write_bytes(data)
    assert words in refused(path)


def test_every_cut_of_a_file_is_refused(scene, path):
    data = scene.glb(path).read_bytes()
    for length in range(0, len(data), 11):
        path.write_bytes(data[:length])
        with pytest.raises(mc.FileError):
            gltf.read(path)


def test_bytes_behind_the_end_are_told(scene, path):
    path.write_bytes(scene.glb(path).read_bytes() + b"more")
    with pytest.warns(UserWarning, match="4 bytes after the end of the GLB are left aside"):
        gltf.read(path)


def test_a_glb_without_its_binary_chunk_is_refused(scene, path):
    scene.json["buffers"][0]["byteLength"] = len(scene.bytes)
    path.write_text(json.dumps(scene.json))
    assert "buffers[0]: neither a uri nor a binary chunk" in refused(path)


def test_compressed_animations_are_refused(scene, path):
    scene.json.update(buffers=[{}, {"byteLength": 1000}], extensionsUsed=["EXT_meshopt_compression"])
    scene.json["bufferViews"][0]["buffer"] = 1
    assert "buffers[1]: packed with EXT_meshopt_compression, which is not read" in refused(scene.glb(path))


# -- buffers in other files ----------------------------------------------------------------------


@pytest.mark.parametrize(
    "uri",
    ["../b.bin", "/etc/passwd", "deep/../../b.bin", "%2e%2e/b.bin", "http://host/b.bin", "file:///b.bin", "C:\\b.bin",
     "a\\b.bin", "C%3Ab.bin", "//host/b.bin", "b.bin/", "b%00.bin"],
)  # fmt: skip
def test_buffers_lie_in_the_folder_of_the_file(scene, tmp_path, uri):
    (tmp_path / "b.bin").write_bytes(scene.bytes)
    (tmp_path / "inner").mkdir()
    path = scene.gltf(tmp_path / "inner" / "a.gltf", uri=uri)
    assert "buffers[0].uri: a file in the folder of this one expected" in refused(path)


def test_a_link_out_of_the_folder_is_refused(scene, tmp_path):
    (tmp_path / "b.bin").write_bytes(scene.bytes)
    (tmp_path / "inner").mkdir()
    (tmp_path / "inner" / "b.bin").symlink_to(tmp_path / "b.bin")
    path = scene.gltf(tmp_path / "inner" / "a.gltf", uri="b.bin")
    assert "'b.bin' lies outside of the folder of this file" in refused(path)


def test_buffers_that_are_missing_or_short_are_told(scene, tmp_path):
    path = scene.gltf(tmp_path / "a.gltf", uri="b.bin")
    assert "b.bin: no such file" in refused(path)
    (tmp_path / "b.bin").write_bytes(scene.bytes[:-1])
    assert f"buffers[0]: {len(scene.bytes)} bytes announced, {len(scene.bytes) - 1} there" in refused(path)
    os.remove(tmp_path / "b.bin")
    os.mkfifo(tmp_path / "b.bin")
    with pytest.raises(mc.FileError, match="not a regular file"):
        gltf.read(path)


@pytest.mark.parametrize(
    ("uri", "words"),
    [
        ("data:application/octet-stream;base64,AAAA*", "buffers[0].uri: not base64"),
        ("data:application/octet-stream;base64,AAAAé", "buffers[0].uri: not base64"),
        ("data:application/octet-stream;base64,AAAA", "bytes announced, 3 there"),
        ("data:text/plain,AAAA", "buffers[0].uri: data that is base64 expected"),
        ("data:" + "x" * 100_000, "buffers[0].uri: data that is base64 expected"),
    ],
)
def test_data_in_the_json_has_to_be_whole(scene, tmp_path, uri, words):
    assert words in refused(scene.gltf(tmp_path / "a.gltf", uri=uri))


# -- files changed at random ---------------------------------------------------------------------


def mutated(data: bytes, rng: random.Random) -> bytes:
    changed = bytearray(data)
    for _ in range(rng.choice([1, 2, 5, 20])):
        at = rng.randrange(len(changed)) if rng.random() < 0.5 else rng.randrange(min(len(changed), 1500))
        how = rng.random()
        if how < 0.6:
            changed[at] = rng.choice([0, 1, 0x7F, 0x80, 0xFF, 0x30, 0x39, 0x2D, rng.randrange(256)])
        elif how < 0.8:
            changed[at : at + rng.randrange(1, 9)] = b""
        else:
            changed[at:at] = rng.choice([b"9", b"-", b"999999999", b"e9", b"null", b"[", b'"'])
    return bytes(changed[: rng.randrange(len(changed))] if rng.random() < 0.1 else changed)


def with_json_mutated(data: bytes, rng: random.Random) -> bytes:
    """All lengths fit again, so that what is behind the parser is reached."""
    size = int.from_bytes(data[12:16], "little")
    return glb(mutated(data[20 : 20 + size], rng), data[20 + size + 8 :])


@pytest.fixture(params=["small", "of ours", "foreign"])
def source(request, scene, jump, tmp_path) -> bytes:
    """The bytes of a GLB."""
    if request.param == "foreign":
        return (request.getfixturevalue("clips") / "other" / "Fox.glb").read_bytes()
    if request.param == "small":
        scene.glb(tmp_path / "source.glb")
    else:
        mc.write(tmp_path / "source.glb", mc.read(jump, unit="inch")[100:110], profile="baked")
    return (tmp_path / "source.glb").read_bytes()


@pytest.mark.parametrize("change", [mutated, with_json_mutated])
def test_files_changed_at_random_are_refused_or_read_as_a_motion(source, path, monkeypatch, change):
    monkeypatch.setattr(tracks, "MAX_NUMBERS", 200_000)  # no frame rate and length that take seconds
    read = 0
    for seed in range(100):
        path.write_bytes(change(source, random.Random(seed)))
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", UserWarning)
            try:
                motion = gltf.read(path)
            except mc.FileError:
                continue
        assert np.isfinite(motion.values).all()
        read += 1
    assert read
