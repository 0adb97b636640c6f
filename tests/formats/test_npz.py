"""NPZ holds everything of a motion; files made to hurt are refused before they are unpacked."""

from __future__ import annotations

import io
import zipfile
from dataclasses import replace

import numpy as np
import pytest

import mocurve as mc


@pytest.fixture
def path(tmp_path, small):
    mc.write(tmp_path / "a.npz", small)
    return tmp_path / "a.npz"


def with_array(path, name: str, array: np.ndarray | bytes | None) -> None:
    """Replace one member of the file, or take it out."""
    with zipfile.ZipFile(path) as archive:
        members = {member: archive.read(member) for member in archive.namelist()}
    del members[f"{name}.npy"]
    if isinstance(array, np.ndarray):
        stream = io.BytesIO()
        np.lib.format.write_array(stream, array)
        array = stream.getvalue()
    if array is not None:
        members[f"{name}.npy"] = array
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for member, data in members.items():
            archive.writestr(member, data)


def test_unit_and_history_come_back(tmp_path, small):
    motion = replace(small, skeleton=replace(small.skeleton, unit=0.0254), history=({"verb": "unroll"},))
    mc.write(tmp_path / "a.npz", motion)
    back = mc.read(tmp_path / "a.npz")
    assert back.skeleton.unit == 0.0254
    assert back.history == motion.history
    assert back.values.flags.f_contiguous


def test_numpy_reads_it_without_pickle(path, small):
    with np.load(path, allow_pickle=False) as data:
        assert data["values"].tolist() == small.values.tolist()
        assert data["joint_names"].tolist() == ["Hips", "Knee", "Knee_End"]
        assert data["joint_channels"].tolist() == ["Xposition Zrotation Yrotation", "Xrotation", ""]


def test_gaps_of_positions_come_back_and_nothing_else_may_be_unknown(tmp_path, small):
    values = small.values.copy()
    values[1, 0] = np.nan
    mc.write(tmp_path / "a.npz", replace(small, values=values))
    assert np.array_equal(mc.read(tmp_path / "a.npz").values, values, equal_nan=True)
    for column, number in ((0, np.inf), (3, np.nan)):
        values[2, column] = number
        with pytest.raises(mc.Mismatch, match=r"rotation is nan at frame 2|position is inf at frame 2: only positions"):
            mc.write(tmp_path / "a.npz", replace(small, values=values))
        values[2, column] = 0.0


@pytest.mark.parametrize(
    ("name", "array", "words"),
    [
        ("values", None, "the array 'values' is not in it"),
        ("values", np.zeros(3), "values: 2 dimensions"),
        ("values", np.zeros((3, 4), int), "values: 2 dimensions of kind 'f' expected, 2 of int64 found"),
        ("values", np.full((3, 4), np.nan), "finite numbers expected"),
        ("values", np.zeros((3, 5)), "its arrays make no motion: the skeleton has 4 channels"),
        ("values", np.array([[{}]], object), "of object found"),
        ("values", b"\x93NUMPY\x01\x00", "not an NPZ file of a motion"),
        ("values", b"garbage", "not an NPZ file of a motion"),
        ("frame_time", np.array(-1.0), "its arrays make no motion: a frame time is a positive number"),
        ("version", np.array(2), "version 1 expected, 2 found"),
        ("parents", np.array([0, 1, 2]), "its arrays make no motion"),
        ("parents", np.array([-1, 0]), "its arrays make no motion"),
        ("joint_channels", np.array(["a", "b", "c"]), "its arrays make no motion: no channel kind"),
        ("history", np.array("["), "not an NPZ file of a motion"),
        ("history", np.array("[1]"), "history: a list of objects expected"),
    ],
)
def test_what_is_wrong_is_told(path, name, array, words):
    with_array(path, name, array) if not (isinstance(array, np.ndarray) and array.dtype == object) else pickled(
        path, name, array
    )
    with pytest.raises(mc.FileError) as caught:
        mc.read(path)
    assert words in str(caught.value)


def pickled(path, name, array) -> None:
    stream = io.BytesIO()
    np.lib.format.write_array(stream, array, allow_pickle=True)
    with_array(path, name, stream.getvalue())


def test_an_array_that_says_more_than_is_there_is_refused(path):
    header = b"\x93NUMPY\x01\x00v\x00{'descr': '<f8', 'fortran_order': False, 'shape': (1000000000, 1000000), }"
    with_array(path, "values", header.ljust(127) + b"\n" + b"\0" * 64)
    with pytest.raises(mc.FileError, match=r"values: says 8000000000000000 bytes, 192 are there"):
        mc.read(path)


def test_a_zip_bomb_is_refused_unread(path):
    with zipfile.ZipFile(path, "a", zipfile.ZIP_DEFLATED) as archive, archive.open("bomb.npy", "w") as member:
        for _ in range(300):
            member.write(b"\0" * (1 << 20))
    with pytest.raises(mc.FileError, match="unpacks to 3145"):
        mc.read(path)


@pytest.mark.parametrize("data", [b"", b"PK", b"PK\x05\x06" + b"\0" * 18, b"\x93NUMPY" * 10])
def test_what_is_no_npz_is_told(tmp_path, data):
    (tmp_path / "a.npz").write_bytes(data)
    with pytest.raises(mc.FileError, match="NPZ"):
        mc.read(tmp_path / "a.npz")


def test_every_cut_of_a_file_is_refused(path):
    data = path.read_bytes()
    for length in range(0, len(data), 7):
        path.write_bytes(data[:length])
        with pytest.raises(mc.FileError):
            mc.read(path)
