"""Acclaim files that are cut, twisted, huge or no such files: refused with the line, or read with a warning."""

from __future__ import annotations

import tracemalloc
import warnings
from functools import partial
from itertools import pairwise

import numpy as np
import pytest
from acclaim_pair import AMC, ASF, read, refused, write_pair
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import mocurve as mc

ODD_WORDS = [
    b"",
    b" nan",
    b"1e308 ",
    b"\nbegin\n",
    b"\nend\n",
    b" root ",
    b" l tx ",
    b"\0",
    b"\n",
    b"#",
    b" arm head",
    b"\n2\n",
]


@pytest.fixture
def pair(tmp_path):
    """pair(old, new, ..., amc=(old, new, ...)) writes the small files with every `old` changed to `new`."""
    return partial(write_pair, tmp_path)


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("# a comment\n:version", "version", "small.asf:1: a keyword such as :version expected, 'version' found"),
        (":bonedata", ":bones", ":bonedata expected, the end of the file found"),
        (":hierarchy", ":units", "small.asf:44: :units expected once, found again"),
        (":root\n", ":root\n begin\n order TX TX\n", "small.asf:12: each of tx ty tz rx ry rz at most once expected"),
        ("order TX TY TZ RX RY RZ", "axis XYZ", "the order of the root's numbers expected in :root"),
        ("order TX TY TZ", "order TX TY L", "each of tx ty tz rx ry rz at most once expected, 'l' found"),
        ("axis XYZ\n  pos", "axis XYY\n  pos", "an order of axes such as XYZ expected, 'XYY' found"),
        ("position 0 0 0", "position 0 0", "small.asf:13: 3 numbers expected, 2 found"),
        ("position 0 0 0", "position 0 0 nan", "small.asf:13: a number expected, 'nan' found"),
        ("length 0.45", "length 0", "a length above 0 expected, '0' found"),
        ("angle deg", "angle grad", "deg or rad or degrees or radians expected, 'grad' found"),
        ("length 3", "length 1e999", "a number expected, '1e999' found (too large)"),
        ("length 3", "length -3", "a length of at least 0 and a direction that is not zero expected"),
        ("direction 0 2 0", "direction 0 0 0", "a direction that is not zero expected"),
        ("direction 0 2 0", "direction 0 1e200 0", "small.asf:19: a number expected, '1e200' found"),
        ("length 3\n", "", "small.asf:16: name, direction and length expected in the bone 'back'"),
        ("name back", "name", "a name of one word that is no number expected, the end of the file found"),
        ("name back", "name 12", "a name of one word that is no number expected, '12' found"),
        ("name back", "name " + "b" * 2000, "a name of one word that is no number expected, 'bbbb"),
        ("name arm", "name back", "small.asf:28: bone 'back' again"),
        ("name arm", "name root", "bone 'root' again"),
        ("dof rx ry rz", "dof rx rw", "each of rx ry rz tx ty tz l at most once expected, 'rw' found"),
        ("dof rx ry rz", "dof rx rx", "at most once expected, 'rx' found"),
        ("(-inf inf)", "(-inf none)", "a number or inf expected in limits, 'none' found"),
        ("(-inf inf)\n", "", "two limits for each of 3 dof expected in the bone 'back', 4 numbers found"),
        ("axis 0 0 0 XYZ", "axis 0 0 XYZ", "a number expected, 'XYZ' found"),
        ("  end\n  begin\n    id 2", "  begin\n    id 2", "small.asf:27: end expected, 'begin' found"),
        ("  begin\n    id 2", "    id 2", "small.asf:28: begin expected, 'id' found"),
        ("back arm head", "back arm head hand", "small.asf:47: no bone 'hand'. Did you mean 'head'?"),
        ("back arm head", "back arm", "small.asf:36: bone 'head' does not hang on the root in :hierarchy"),
        ("back arm head", "back arm\n arm head head", "bone 'head' hangs on 'arm' already"),
        ("back arm head", "back arm head\n arm root", "root is no child"),
        ("root back\n    back arm head", "root back\n arm head\n head arm", "bone 'arm' does not hang on the root"),
        ("back arm head\n  end", "back arm head", "end expected, the end of the section found"),
        ("  begin\n    root back", "  begin\n  end\n  begin\n    root back", "one begin and one end expected"),
        ("name back", "name ba\0ck", "NUL bytes in a name: this is no text file"),
    ],
)
def test_a_wrong_skeleton_is_refused_with_the_line(pair, old, new, told):
    text = refused(pair(old, new))
    assert text.startswith("small.asf")
    assert told in text


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("back 10 20 30", "bakc 10 20 30", "small.amc:6: no bone 'bakc'. Did you mean 'back'?"),
        ("back 10 20 30", "back 10 20", "small.amc:6: 3 numbers for 'back' expected, 2 found"),
        ("back 10 20 30", "back 10 20 30 40", "3 numbers for 'back' expected, more found"),
        ("back 10 20 30", "back", "3 numbers for 'back' expected, 0 found"),
        ("back 10 20 30", "back 10 20 nan", "small.amc:6: a number expected, 'nan' found"),
        ("back 10 20 30", "back 10 20 1_0", "a number expected, '1_0' found"),
        ("back 10 20 30", "back 10 20 1e400", "a number expected, '1e400' found (too large)"),
        (
            ":DEGREES\n1\nroot 1 2 3 0 0 0",
            ":RADIANS\n1\nroot 1 2 3 0 0 1e308",
            "small.amc: its numbers are too large for a motion",
        ),
        ("back 10 20 30", "back 10 20 1-2", "a number expected, '1-2' found"),
        ("back 10 20 30", "back 10,5 20 30", "'10,5' found (decimal points, not commas, are read)"),
        ("arm 40 50", "back 10 20 30", "small.amc:7: 'back' again in frame 1"),
        ("arm 41 51\n", "", "small.amc:12: 'arm' is missing in frame 2"),
        ("arm 40 50\n", "", "small.amc:11: 'arm' is in frame 2, but not in the first"),
        ("\n2\n", "\n1\n", "small.amc:9: a frame number above 1 expected, 1 found"),
        ("\n2\n", "\n-2\n", "the number of a frame expected, '-2' found"),
        ("\n2\n", "\n" + "9" * 30 + "\n", "the number of a frame expected, '9999"),
        ("\n2\n", "\n2 3\n", "no bone '2'"),
        ("\n1\n", "\n", "small.amc:4: the number of a frame expected, 'root' found"),
        ("\n2\n", "\n:RADIANS\n", "the number of a frame expected, ':RADIANS' found"),
        (AMC, "", "small.amc:1: the number of a frame expected, the end of the file found"),
        (AMC, "# nothing\n", "small.amc:1: the number of a frame expected, the end of the file found"),
        (AMC, "version https://git-lfs.github.com/spec/v1\n", "the number of a frame expected, 'version https"),
        (AMC, "1\0\n\0", "(NUL bytes: no text"),
    ],
)
def test_a_wrong_motion_is_refused_with_the_line(pair, old, new, told):
    assert told in refused(pair(amc=(old, new)))


@settings(max_examples=100, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.data())
def test_mutated_files_are_read_or_refused(pair, data):
    path = pair()
    for file in data.draw(st.sampled_from([[path], [path.with_suffix(".asf")], [path, path.with_suffix(".asf")]])):
        text = bytearray(file.read_bytes())
        for _ in range(data.draw(st.integers(1, 3))):
            at, end = sorted(data.draw(st.tuples(st.integers(0, len(text)), st.integers(0, len(text)))))
            text[at : min(end, at + 20)] = data.draw(st.sampled_from(ODD_WORDS) | st.binary(max_size=3))
        file.write_bytes(bytes(text))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)
        try:
            motion = mc.read(path)
        except mc.FileError:
            return
    assert np.isfinite(motion.values).all()
    assert np.isfinite(motion.skeleton.offsets).all()


def test_every_cut_of_a_motion_is_refused_or_warned_of(pair):
    path = pair()
    whole, ends = read(path).values.tolist(), {len(AMC), AMC.index("2\nroot")}
    for length in range(len(AMC)):
        path.write_text(AMC[:length])
        if length in ends:
            assert read(path).values.tolist() == whole[:1]
            continue
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            try:
                mc.read(path)
            except mc.FileError:
                continue
        told = " ".join(str(warning.message) for warning in caught)  # of the first frame some bones may be missing
        assert "without a line end; its last number may be cut" in told or "at rest" in told, length


def test_every_cut_of_a_skeleton_is_refused(pair, tmp_path):
    path = pair()
    for length in range(0, len(ASF) - 1, 3):
        (tmp_path / "small.asf").write_text(ASF[:length])
        refused(path)


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("\n", "\r\n"),
        ("\n", "\r"),
        ("\n", "\n\n  \n"),
        (" ", "\t  "),
        ("arm 40 50", "arm 40 50 # a comment"),
        ("\n2\n", "\n# between\n2\n"),
        (":FULLY-SPECIFIED\n:DEGREES\n", ""),
        ("#!OML:ASF small.asf", ":fully-specified"),
        ("#!OML", "\ufeff#!OML"),
    ],
)
def test_odd_but_right_motions_are_read(pair, old, new):
    expected = read(pair()).values.tolist()
    assert read(pair(amc=(old, new))).values.tolist() == expected


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("\n", "\r\n"),
        ("\n", "\n\n"),
        (":documentation\n  anything: goes here (and, here)\n", ""),
        (":documentation\n", ":SKIN\n"),
        ("# a comment", "\ufeff# a comment"),
        ("dof rx ry rz", "DOF RX ry RZ"),
        ("position 0 0 0\n  orientation 0 0 0\n", ""),
        ("axis 0 0 0 XYZ", "axis (0, 0, 0) XYZ"),
        ("axis 0 0 0 XYZ", ""),
        ("axis 10 20 30 XYZ", "axis 10 20 30"),
        ("    bodymass 10\n", ""),
    ],
)
def test_odd_but_right_skeletons_are_read(pair, old, new):
    expected = read(pair())
    motion = read(pair(old, new))
    assert motion.values.tolist() == expected.values.tolist()
    assert motion.skeleton.offsets.tolist() == expected.skeleton.offsets.tolist()


def test_bones_may_stand_in_another_order_in_each_frame(pair):
    expected = read(pair()).values.tolist()
    swapped = pair(amc=("arm 41 51\nhead -7 8\n", "head -7 8\narm 41 51\n"))
    assert read(swapped).values.tolist() == expected


def test_a_bone_that_the_motion_does_not_have_stays_at_rest_with_a_warning(pair):
    path = pair(amc=("arm 40 50\n", "", "arm 41 51\n", ""))
    with pytest.warns(UserWarning, match="no numbers for 'arm': at rest"):
        motion = mc.read(path)
    assert not motion.values[:, motion.skeleton.channel_joints == motion.skeleton.joint("arm")].any()


def test_left_out_frame_numbers_are_warned_of(pair):
    with pytest.warns(UserWarning, match="3 frame numbers are left out"):
        assert read(pair(amc=("\n2\n", "\n5\n"))).frames == 2
    assert read(pair(amc=("\n1\n", "\n7\n", "\n2\n", "\n8\n"))).frames == 2


def test_unknown_words_are_left_aside_with_a_warning(pair):
    with pytest.warns(UserWarning, match=r"small\.asf:26: 'torque' is not known and left aside"):
        read(pair("bodymass 10", "torque 10"))
    with pytest.warns(UserWarning, match="':WORLD' in line 3 is not known and left aside"):
        read(pair(amc=(":DEGREES", ":WORLD")))


def test_names_in_latin_1_are_read_with_a_warning(pair, tmp_path):
    path = pair("arm", "ärm", amc=("arm", "ärm"))
    for file in (path, tmp_path / "small.asf"):
        file.write_bytes(file.read_text(encoding="utf-8").encode("latin-1"))
    with pytest.warns(UserWarning, match="the names are not UTF-8; they are read as Latin-1"):
        assert "ärm" in read(path).skeleton.names


def test_a_deep_chain_of_bones_is_read_and_too_many_are_refused(pair):
    bone = "begin\nname b{0}\ndirection 0 1 0\nlength 1\nend\n"
    for count in (2_000, 20_001):
        names = ["head", *(f"b{i}" for i in range(count))]
        bones = "".join(bone.format(i) for i in range(count))
        chain = "".join(f"{above} {below}\n" for above, below in pairwise(names))
        path = pair(":hierarchy", bones + ":hierarchy", "back arm head\n", "back arm head\n" + chain)
        if count == 2_000:
            assert len(read(path).skeleton.names) == count + 6
        else:
            assert "at most 20000 bones expected" in refused(path)


def test_many_bones_that_the_motion_says_nothing_of_take_no_memory(pair):
    bones = "".join(f"begin\nname b{i}\ndirection 0 1 0\nlength 1\ndof rx ry rz\nend\n" for i in range(2000))
    names = " ".join(f"b{i}" for i in range(2000))
    frames = "".join(f"{i}\nroot 0 0 0 0 0 0\n" for i in range(3, 20_000))
    start = AMC[: AMC.index("1\nroot")]
    path = pair(
        ":hierarchy", bones + ":hierarchy", "back arm head\n", f"back arm head {names}\n", amc=(AMC, start + frames)
    )
    assert "19997 frames of 4006 joints, most of which it says nothing of" in refused(path)


def test_very_many_unknown_words_are_refused_soon(pair):
    assert "is not known, and neither are 20 words before it" in refused(
        pair("bodymass 10", "\n".join(f"key{i} 1" for i in range(100_000)))
    )
    long = "".join(f"begin\nname {'b' * 900}{i}\ndirection 0 1 0\nlength 1\nend\n" for i in range(2000))
    assert "no bone 'bbb" in refused(pair(":hierarchy", long + ":hierarchy", "back arm head\n", f"back {'b' * 899}x\n"))


def test_memory_is_bounded_by_the_file(pair):
    path = pair(amc=("head -7 8\n", "head -7 8\n3\nroot " + "1 " * 2_000_000))
    tracemalloc.start()
    assert "6 numbers for 'root' expected, more found" in refused(path)
    assert tracemalloc.get_traced_memory()[1] < 2e6 + 4 * path.stat().st_size
    tracemalloc.stop()
    (path.parent / "small.asf").write_bytes(b"# " + b"x" * (17 << 20))
    assert "a skeleton of at most 16 MB expected" in refused(path)
