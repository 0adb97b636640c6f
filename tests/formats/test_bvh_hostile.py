"""Files made to hurt: refused, soon, and without much memory."""

from __future__ import annotations

import os
import tracemalloc

import numpy as np
import pytest

import mocurve as mc
from mocurve.formats import _bvh_rows

pytestmark = pytest.mark.usefixtures("both_ways")

JOINT = "JOINT a\n{\nOFFSET 0 1 0\nCHANNELS 0\n"


def refused(path) -> str:
    """The refusal's text; the memory of it has to stay small beside the file's."""
    tracemalloc.start()
    try:
        with pytest.raises(mc.FileError) as caught:
            mc.read(path)
        assert tracemalloc.get_traced_memory()[1] < 20e6 + 12 * os.path.getsize(path)
    finally:
        tracemalloc.stop()
    return str(caught.value)


def test_joints_nested_very_deep_are_read(bvh):
    deep = 15_000
    path = bvh("  JOINT Knee\n", JOINT * deep + "JOINT Knee\n", "MOTION", "}\n" * deep + "MOTION")
    skeleton = mc.read(path).skeleton
    assert len(skeleton.names) == deep + 3
    assert skeleton.parents[-1] == deep + 1


def test_more_joints_than_any_body_are_refused(bvh):
    with pytest.raises(mc.FileError, match="at most 20000 joints expected"):
        mc.read(bvh("  JOINT Knee\n", JOINT * 20_001 + "JOINT Knee\n"))


@pytest.mark.parametrize("count", ["1000000000", "-1", "3.0", "0x3", "03", "9" * 5000])
def test_odd_channel_counts_are_refused(bvh, count):
    assert "a number of channels from 0 to 6 expected" in refused(bvh("CHANNELS 1", f"CHANNELS {count}"))


def test_a_huge_name_is_refused(bvh):
    assert "a name of at most 1000 characters" in refused(bvh("Knee", "K" * 3_000_000))


def test_a_huge_word_is_refused(bvh):
    assert "a word of at most 100000 characters" in refused(bvh("OFFSET 0 1.5", "OFFSET 0 " + "1" * 3_000_000))
    assert "HIERARCHY expected" in refused(bvh(data=b"x" * 90_000))


def test_a_frame_count_that_no_memory_holds_is_bounded_by_the_file(bvh, values):
    path = bvh("Frames: 3", "Frames: 1000000000000000000")
    tracemalloc.start()
    with pytest.warns(UserWarning, match="1000000000000000000 frames announced, 3 found"):
        motion = mc.read(path)
    assert tracemalloc.get_traced_memory()[1] < 5e6
    tracemalloc.stop()
    assert motion.values.tolist() == values.tolist()


def test_a_frame_count_of_too_many_digits_is_refused(bvh):
    assert "a number of frames expected" in refused(bvh("Frames: 3", "Frames: " + "9" * 10_000))


def test_one_long_line_of_numbers_is_read(bvh, values):
    rows = "0.5 -1.25 2 0.1\n1.5 -2.25 3 0.2\n2.5 -3.25 4 -0.0\n"
    count = 20_000
    path = bvh("Frames: 3", f"Frames: {3 * count}", rows, rows.replace("\n", " ") * count)
    assert mc.read(path).values.tobytes() == np.tile(values, (count, 1)).tobytes()


def test_a_line_without_any_blank_is_refused(bvh):
    assert "a number expected, '1111" in refused(bvh("0.5 -1.25", "1" * 2_000_000))


def test_a_hierarchy_that_never_ends_is_refused(bvh):
    assert "the end of the file found" in refused(bvh(data=b"HIERARCHY\nROOT a\n{" + b" " * 3_000_000))


@pytest.mark.parametrize(
    "data", [b"", b"\xef\xbb\xbf", b"\xff\xfe", b"\xff\xfe\0\0", b"\0" * 5000, b"\xff\xfeH", b"\xfe\xff\xd8\x00" * 3]
)
def test_files_without_text_are_refused(bvh, data):
    refused(bvh(data=data))


def test_utf_16_without_its_mark_is_refused_with_a_hint(bvh):
    assert "UTF-16 without its byte order mark" in refused(bvh(data=bvh().read_text().encode("utf-16-le")))


def test_what_is_no_file_is_told(tmp_path):
    (tmp_path / "folder.bvh").mkdir()
    assert "is a directory" in refused_path(tmp_path / "folder.bvh")
    assert "no such file" in refused_path(tmp_path / "missing.bvh")
    assert "embedded null" in refused_path("a\0b.bvh")
    os.mkfifo(tmp_path / "pipe.bvh")
    assert "not a regular file" in refused_path(tmp_path / "pipe.bvh")


def refused_path(path) -> str:
    with pytest.raises(mc.FileError) as caught:
        mc.read(path)
    return str(caught.value)


@pytest.mark.skipif(os.name == "nt" or os.geteuid() == 0, reason="the superuser may read everything")
def test_a_file_that_may_not_be_read_is_told(bvh):
    path = bvh()
    path.chmod(0)
    assert "permission denied" in refused(path)


@pytest.mark.parametrize("chunk", [20, 33, 64, 1000])
def test_the_size_of_chunks_changes_nothing(bvh, monkeypatch, chunk):
    rng = np.random.default_rng(chunk)
    rows = "\n".join(" ".join(f"{x:.{k}f}" for k, x in enumerate(row, 2)) for row in rng.normal(0, 300, (200, 4)))
    head = bvh("Frames: 3", "Frames: 200").read_text().partition("0.5 -1")[0]
    files = [
        head + rows + "\n",
        head + rows.replace("\n", " \r\n\r\n"),
        head + rows.replace("\n", " "),
        head + rows[:-30],
    ]
    files += [head + rows[:3000] + "x" + rows[3000:]]
    usual = _bvh_rows.CHUNK
    for text in files:
        path = bvh(data=text.encode())
        whole = outcome(path)
        monkeypatch.setattr(_bvh_rows, "CHUNK", chunk)
        assert outcome(path) == whole
        monkeypatch.setattr(_bvh_rows, "CHUNK", usual)


def outcome(path) -> bytes | str:
    try:
        return mc.read(path).values.tobytes()
    except mc.FileError as error:
        return str(error)
