"""What is written is read back the same."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import mocurve as mc
from mocurve.skeleton import CHANNEL_KINDS

names = st.text(st.characters(codec="utf-8", exclude_characters="{}\r\n\0"), max_size=12).map(
    lambda s: s.strip(" \t\f\v")
)
awkward_names = st.one_of(names, st.sampled_from(["ROOT", "End Site", "a b", "MOTION", "a:b", ""]))
numbers = st.floats(allow_nan=False, allow_infinity=False)
kinds = st.lists(st.sampled_from(CHANNEL_KINDS), max_size=6, unique=True).map(tuple)


@st.composite
def motions(draw) -> mc.Motion:
    """Depth-first skeletons with one or several roots, any channels, end sites, and 0 to 4 frames."""
    body, parents, channels, ends = [], [], [], []
    chain: list[int] = []
    for joint in range(draw(st.integers(1, 9))):
        depth = draw(st.integers(0, len(chain)))
        parents.append(chain[depth - 1] if depth else -1)
        ends.append(depth > 0 and draw(st.booleans()))
        sites = sum(end for end, parent in zip(ends[:-1], parents[:-1], strict=True) if parent == parents[-1])
        usual = "" if depth == 0 else body[parents[-1]] + (f"_End{sites + 1}" if sites else "_End")
        body.append((draw(st.one_of(st.just(usual), names)) or usual) if ends[-1] else draw(awkward_names))
        channels.append(() if ends[-1] else draw(kinds))
        chain = chain[:depth] + ([] if ends[-1] else [joint])
    offsets = draw(st.lists(st.tuples(numbers, numbers, numbers), min_size=len(body), max_size=len(body)))
    skeleton = mc.Skeleton(tuple(body), parents, offsets, tuple(channels), ends)
    frames = draw(st.integers(0, 4))
    values = draw(st.lists(numbers, min_size=frames * skeleton.channel_count, max_size=frames * skeleton.channel_count))
    frame_time = draw(st.one_of(st.floats(1e-5, 10), st.sampled_from([1 / 120, 1 / 30, 1001 / 30000, 0.033333])))
    return mc.Motion(skeleton, np.array(values).reshape(frames, skeleton.channel_count), frame_time)


def written_and_read(motion: mc.Motion, extension: str, lossless: bool = True):
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"clip{extension}"
        mc.write(path, motion, lossless=lossless)
        return mc.read(path)


def assert_same(a: mc.Motion, b: mc.Motion) -> None:
    assert a.skeleton.names == b.skeleton.names
    assert a.skeleton.channels == b.skeleton.channels
    assert a.skeleton.parents.tolist() == b.skeleton.parents.tolist()
    assert a.skeleton.end_sites.tolist() == b.skeleton.end_sites.tolist()
    assert a.skeleton.offsets.tobytes() == b.skeleton.offsets.tobytes()
    assert a.values.shape == b.values.shape
    assert a.values.tobytes() == b.values.tobytes()
    assert a.frame_time == b.frame_time


@settings(max_examples=150, deadline=None)
@given(motions())
def test_lossless_writing_and_reading_gives_the_same(motion):
    assert_same(written_and_read(motion, ".bvh"), motion)


@settings(max_examples=60, deadline=None)
@given(motions())
def test_npz_gives_the_same(motion):
    assert_same(written_and_read(motion, ".npz"), motion)


def test_real_clips_come_back_the_same(clips):
    for path in [*sorted(clips.glob("awkward/*.bvh")), clips / "cmu" / "cmu_12_01_walk.bvh"]:
        motion = mc.read(path)
        assert_same(written_and_read(motion, ".bvh"), motion)
        rounded = written_and_read(motion, ".bvh", lossless=False)
        assert np.allclose(rounded.values, motion.values, rtol=0, atol=5e-7)


def test_six_decimals_are_the_rule(tmp_path, small):
    mc.write(tmp_path / "a.bvh", small)
    assert (tmp_path / "a.bvh").read_text() == (
        "HIERARCHY\nROOT Hips\n{\n\tOFFSET 0.000000 1.500000 0.000000\n\tCHANNELS 3 Xposition Zrotation Yrotation\n"
        "\tJOINT Knee\n\t{\n\t\tOFFSET 0.000000 -1.000000 0.000000\n\t\tCHANNELS 1 Xrotation\n"
        "\t\tEnd Site\n\t\t{\n\t\t\tOFFSET 0.000000 -2.250000 0.000000\n\t\t}\n\t}\n}\n"
        "MOTION\nFrames: 3\nFrame Time: 0.008333333333333333\n"
        "0.500000 -1.250000 2.000000 0.100000\n1.500000 -2.250000 3.000000 0.200000\n"
        "2.500000 -3.250000 4.000000 -0.000000\n"
    )


def test_keys_are_written_as_their_samples(tmp_path, keys):
    with pytest.warns(UserWarning, match=r"^keys become samples: \.bvh files have one at every frame$"):
        mc.write(tmp_path / "a.bvh", keys, lossless=True)
    assert_same(mc.read(tmp_path / "a.bvh"), keys.sample())


def test_a_chain_of_thousands_of_joints_is_no_giant_file(tmp_path):
    count = 5000
    body = mc.Skeleton(("a",) * count, np.arange(count) - 1, np.zeros((count, 3)), ((),) * count)
    mc.write(tmp_path / "a.bvh", mc.Motion(body, np.empty((1, 0)), 0.1))
    assert (tmp_path / "a.bvh").stat().st_size < 2e6
    assert mc.read(tmp_path / "a.bvh").skeleton.parents.tolist() == body.parents.tolist()


def body_with(**changes) -> mc.Skeleton:
    parts = {
        "names": ("a", "b", "c"),
        "parents": [-1, 0, 0],
        "offsets": np.zeros((3, 3)),
        "channels": (("Xrotation",), (), ()),
        "end_sites": [False, False, True],
    }
    return mc.Skeleton(**{**parts, **changes})


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"names": ("a", "b{", "c")}, "cannot hold the joint name 'b{'"),
        ({"names": ("a", " b", "c")}, "cannot hold the joint name ' b'"),
        ({"names": ("a", "b\n", "c")}, r"cannot hold the joint name 'b\\n'"),
        ({"names": ("a", "b" * 1001, "c")}, "cannot hold the joint name"),
        ({"names": ("a", "b", "\ud800")}, "a name holds '\\\\ud800'"),
        ({"channels": (("Xrotation", "Xrotation"), (), ())}, "joint 'a' has a channel twice"),
        ({"channels": ((), ("Xrotation",), ("Xrotation",))}, "end site 'c' has channels"),
        ({"end_sites": [True, False, False]}, "end site 'a' has channels or no parent"),
        ({"end_sites": [False, True, False], "parents": [-1, 0, 1]}, "joint 'c' hangs on an end site"),
        ({"offsets": [[0, np.nan, 0]] * 3}, "offset of 'a' is not finite"),
    ],
)
def test_skeletons_that_a_bvh_file_cannot_hold_are_refused_and_leave_nothing(tmp_path, changes, words):
    body = body_with(**changes)
    motion = mc.Motion(body, np.zeros((1, body.channel_count)), 0.1)
    with pytest.raises(mc.MocurveError, match=words):
        mc.write(tmp_path / "a.bvh", motion)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(("extension", "value"), [(".bvh", np.nan), (".bvh", np.inf), (".csv", -np.inf)])
def test_values_that_are_not_finite_leave_the_old_file(tmp_path, small, extension, value):
    path = tmp_path / f"a{extension}"
    path.write_text("old")
    values = small.values.copy()
    values[1, 2] = value
    with pytest.raises(mc.Mismatch, match=rf"frame 1.* is {value}"):
        mc.write(path, mc.Motion(small.skeleton, values, 0.1))
    assert path.read_text() == "old"
    assert os.listdir(tmp_path) == [path.name]


def test_places_that_cannot_be_written_are_told(tmp_path, small):
    (tmp_path / "folder.bvh").mkdir()
    with pytest.raises(mc.FileError, match=r"folder\.bvh: is a directory"):
        mc.write(tmp_path / "folder.bvh", small)
    with pytest.raises(mc.FileError, match="cannot write: no such file or directory"):
        mc.write(tmp_path / "missing" / "a.bvh", small)


def test_a_link_stays_a_link(tmp_path, small):
    (tmp_path / "a.bvh").write_text("old")
    (tmp_path / "link.bvh").symlink_to(tmp_path / "a.bvh")
    mc.write(tmp_path / "link.bvh", small)
    assert (tmp_path / "link.bvh").is_symlink()
    assert mc.read(tmp_path / "a.bvh").frames == 3
