"""Odd but valid files read right; files that are not surely right are refused with their line."""

from __future__ import annotations

import re
import warnings
from pathlib import Path

import numpy as np
import pytest

import mocurve as mc

pytestmark = pytest.mark.usefixtures("both_ways")

AWKWARD = (
    "all_frames_on_one_line braces_same_line constant_channels crlf end_site_lowercase_s euler_beyond_360 "
    "euler_wraps_180 frame_time_1000fps frame_time_240fps frame_time_many_spaces frame_time_ntsc_long "
    "frame_time_tabs frames_0 frames_2 gimbal_lock_x90 joint_0_channels joint_2_channels "
    "joint_position_and_1_rotation leaf_joint_without_end_site name_missing_on_root names_duplicate "
    "names_like_keywords names_unicode no_final_newline order_XZY order_YZX order_ZYX root_channels_interleaved "
    "root_position_only root_rotation_before_position six_channels_every_joint tabs trailing_blank_lines "
    "two_roots zero_length_bones"
)
BROKEN = {  # file: line and words of the refusal
    "binary_garbage": (1, "HIERARCHY expected"),
    "channel_count_not_a_number": (5, "0 to 6 expected, 'six' found"),
    "channel_count_too_small": (5, "expected, 'Yrotation' found"),
    "channel_scale": (9, "'Xscale' found"),
    "decimal_commas": (23, "'0,0333333' found (decimal points"),
    "extra_closing_brace": (21, "ROOT or MOTION expected, '}' found"),
    "frame_time_comma": (23, "'0,0333333' found"),
    "frame_time_missing": (23, "Frame Time: expected, '0.000000' found"),
    "frame_time_negative": (23, "above 0, expected, '-0.033' found"),
    "frame_time_zero": (23, "above 0, expected, '0' found"),
    "frames_negative": (22, "number of frames expected, '-5' found"),
    "git_lfs_pointer": (1, "Git LFS pointer"),
    "hierarchy_only": (21, "MOTION expected, the end of the file found"),
    "joint_before_root": (2, "ROOT expected, 'JOINT' found"),
    "missing_closing_brace": (20, "} expected, 'MOTION' found"),
    "motion_ends_after_keyword": (22, "Frames: expected, the end of the file found"),
    "motion_only": (1, "HIERARCHY expected, 'MOTION' found"),
    "nul_bytes": (21, "NUL bytes"),
    "offset_nan": (8, "a number expected, 'nan' found"),
    "only_whitespace": (3, "HIERARCHY expected, the end of the file found"),
    "row_too_short": (27, "12 numbers expected, 11 found"),
    "truncated_mid_number": (28, "the file ends within a number: 6 decimals expected, '-7.16' found"),
    "two_motion_sections": (29, "column 1: a number expected, 'MOTION' found"),
    "value_0x10": (26, "column 49: a number expected, '0x10' found"),
    "value_1comma5": (26, "column 49: a number expected, '1,5' found"),
    "value_1phQNAN": (26, "column 49: a number expected, '1.#QNAN' found"),
    "value_abc": (26, "column 49: a number expected, 'abc' found"),
    "value_m1phIND": (26, "column 49: a number expected, '-1.#IND' found"),
    "value_nan": (26, "column 49: a number expected, 'nan' found"),
}


def plain_numbers(path: Path) -> list[float]:
    text = path.read_bytes().decode("utf-8", "replace")
    return [float(word) for word in re.split(r"(?i)frame\s+time\s*:\s*\S+", text)[1].split()]


def same_bits(a: np.ndarray, b: np.ndarray) -> bool:
    return a.shape == b.shape and a.tobytes() == b.tobytes()


@pytest.mark.parametrize("name", AWKWARD.split())
def test_awkward_files_read_bit_for_bit(clips, name):
    path = clips / "awkward" / f"{name}.bvh"
    motion = mc.read(path)
    assert same_bits(motion.values, np.array(plain_numbers(path)).reshape(motion.values.shape))
    assert motion.frames == int(re.search(rb"(?i)frames\s*:\s*(\d+)", path.read_bytes())[1])


def test_real_clips_read_bit_for_bit_without_a_warning(clips):
    for path in sorted(clips.glob("cmu/*.bvh")) + sorted(clips.glob("other/*.bvh")):
        motion = mc.read(path)
        assert same_bits(motion.values.ravel(), np.array(plain_numbers(path))), path
        assert motion.values.flags.f_contiguous


@pytest.mark.parametrize("name", BROKEN)
def test_broken_files_are_refused_with_line_and_reason(clips, name):
    line, words = BROKEN[name]
    with pytest.raises(mc.FileError) as caught:
        mc.read(clips / "broken" / f"{name}.bvh")
    assert caught.value.line == line
    assert words in str(caught.value)


def test_no_broken_file_is_forgotten(clips):
    assert {path.stem for path in clips.glob("broken/*.bvh")} == {*BROKEN, "frames_huge"}


def test_a_hugely_announced_frame_count_is_warned_of(clips):
    with pytest.warns(UserWarning, match="999999999999 frames announced, 5 found and read"):
        assert mc.read(clips / "broken" / "frames_huge.bvh").frames == 5


def test_the_small_file_reads_as_it_is(bvh, small):
    motion = mc.read(bvh())
    assert repr(motion) == "<Motion 3 frames, 0.02 s, 2 joints, 4 channels>"
    assert same_bits(motion.values, small.values)
    assert motion.skeleton.names == small.skeleton.names
    assert motion.skeleton.channels == small.skeleton.channels
    assert motion.skeleton.parents.tolist() == [-1, 0, 1]
    assert motion.skeleton.end_sites.tolist() == [False, False, True]
    assert motion.skeleton.offsets.tolist() == small.skeleton.offsets.tolist()
    assert motion.frame_time == 1 / 120


@pytest.mark.parametrize(
    "changes",
    [
        ("Frame Time: 0.0083333", "Frame Time:0.0083333"),
        ("Frame Time: 0.0083333", "Frame Time : .0083333"),
        ("Frame Time: 0.0083333", "Frame Time :8.3333e-3"),
        ("Frame Time: 0.0083333", "frame time 0.0083333"),
        ("Frames: 3", "Frames : 3"),
        ("Frames: 3", "Frames :3"),
        ("Frames: 3", "FRAMES:\t03"),
        ("Frames: 3\n", "Frames: 3 "),
        ("HIERARCHY", "hierarchy", "ROOT", "root", "JOINT", "Joint", "OFFSET", "Offset", "CHANNELS", "channels"),
        ("End Site", "END SITE", "MOTION", "Motion"),
        ("Xposition", "XPOSITION", "Zrotation", "zrotation"),
        ("\n", "\r\n"),
        ("\n", "\r"),
        ("\n", "\n\n"),
        ("\n", " \t\n"),
        (" ", "\t"),
        (" ", "   "),
        ("\n{", " {"),
        ("{\n", "{ "),
        ("}\n", "} "),
        ("-2.25 0\n", "-2.25 0"),
        ("HIERARCHY", "\n\n  HIERARCHY"),
        (
            "OFFSET 0 1.5 0\n  CHANNELS 3 Xposition Zrotation Yrotation",
            "CHANNELS 3 Xposition Zrotation Yrotation OFFSET 0 1.5 0",
        ),
        ("0.5 -1.25 2 0.1\n", "5e-1 -125E-2 +2. .1\n"),
        ("0.5 -1.25 2 0.1\n", "0.5 -1.25\n2 0.1\n"),
        ("0.5 -1.25 2 0.1\n1.5 ", "0.5 -1.25 2 0.1 1.5 "),
        ("0.1\n1.5", "0.1 1.5", "0.2\n2.5", "0.2 2.5"),
        (" 2 0.1\n1.5 -2.25 3 ", " 2\n0.1 1.5\n-2.25 3\n", "0.2\n", "0.2 ", "3.25 4", "3.25\n4"),
        ("0.5 -1.25 2 0.1", "00.50000000000000000000000 -1.250 2 0.1"),
        ("Frame Time: 0.0083333\n", "Frame Time: 0.0083333\n\n \n"),
    ],
)
def test_ways_to_write_the_same_file_read_the_same(bvh, small, changes):
    motion = mc.read(bvh(*changes))
    assert same_bits(motion.values, small.values)
    assert motion.frame_time == small.frame_time
    assert motion.skeleton.names == small.skeleton.names
    assert motion.skeleton.channels == small.skeleton.channels


@pytest.mark.parametrize("end", ["", " ", "\n", "\r\n", "\n\n \t\n"])
def test_any_end_of_the_file_will_do(bvh, small, end):
    assert same_bits(mc.read(bvh("-0.0\n", "-0.0" + end)).values, small.values)


@pytest.mark.parametrize(
    "name", ["Left Foot", "mixamorig:Hips", "ROOT", "End Site", "Frame Time: 1", "脊椎", "Hüfte", "a\tb", ""]
)
def test_names_are_kept_as_they_are(bvh, name):
    assert mc.read(bvh("JOINT Knee", f"JOINT {name}  ")).skeleton.names[1:] == (name, f"{name}_End")


def test_several_end_sites_of_a_joint_have_names_of_their_own(bvh):
    sites = "End Site\n{ OFFSET 1 0 0 }\n End Site { OFFSET 2 0 0 }\nEnd Site Toe\n{ OFFSET 3 0 0 }\nEnd Site\n"
    skeleton = mc.read(bvh("End Site\n", sites)).skeleton
    assert skeleton.names[2:] == ("Knee_End", "Knee_End2", "Toe", "Knee_End4")
    assert skeleton.parents[2:].tolist() == [1, 1, 1, 1]


def test_a_joint_without_channels_has_none(bvh):
    skeleton = mc.read(bvh("    CHANNELS 1 Xrotation\n", "", " 0.1\n", "\n", " 0.2\n", "\n", " -0.0\n", "\n")).skeleton
    assert skeleton.channels[1] == ()


@pytest.mark.parametrize(
    ("coding", "mark"), [("utf-8", b"\xef\xbb\xbf"), ("utf-16-le", b"\xff\xfe"), ("utf-16-be", b"\xfe\xff")]
)
def test_files_with_a_byte_order_mark_are_read_as_it_says(bvh, values, coding, mark):
    text = bvh("Knee", "膝").read_text("utf-8")
    motion = mc.read(bvh(data=mark + text.encode(coding)))
    assert motion.skeleton.names[1] == "膝"
    assert same_bits(motion.values, values)


@pytest.mark.parametrize(
    ("coding", "name", "told"), [("latin-1", "Hüfte", "Latin-1"), ("cp932", "ボーン膝", "Shift-JIS")]
)
def test_old_encodings_are_read_with_a_warning(bvh, values, coding, name, told):
    text = bvh("Knee", name).read_text("utf-8")
    with pytest.warns(UserWarning, match=f"not UTF-8; they are read as {told}"):
        motion = mc.read(bvh(data=text.encode(coding)))
    assert motion.skeleton.names[1] == name
    assert same_bits(motion.values, values)


@pytest.mark.parametrize(
    ("changes", "line", "words"),
    [
        (("0.1\n", "0.1 7\n"), 19, "4 numbers expected, 5 found"),
        (("0.5 -1", "-1"), 19, "4 numbers expected, 3 found"),
        (("3 0.2", "3"), 20, "4 numbers expected, 3 found"),
        (("4 -0.0", "4"), 21, "4 numbers expected, 3 found"),
        (("0.1\n1.5 -2.25", "0.1\n1.5\n-2.25", "4 -0.0", "4"), 22, "4 numbers expected, 3 found"),
        (("2 0.1\n", "2\n", "0.2\n", "0.2 0.3\n"), 19, "4 numbers expected, 3 found"),
        (("2 0.1\n", "2\n0.1\n", "Frames: 3", "Frames: 2"), 22, "2 frames of 4 numbers announced, 12 numbers found"),
        (("2.25 3", "1e400 3"), 20, "column 5: a number expected, '-1e400' found (too large)"),
        (("1.25", "1_25"), 19, "column 5: a number expected, '-1_25' found"),
        (("1.5 -2.25", "1.5-2.25"), 20, "column 1: a number expected, '1.5-2.25' found"),
        (("2.25 3", "inf 3"), 20, "column 5: a number expected, '-inf' found"),
        (("2.25 3", "2.2.5 3"), 20, "column 5: a number expected, '-2.2.5' found"),
        (("-2.25 3", "--2.25 3"), 20, "'--2.25' found"),
        (("-2.25 3", "- 3"), 20, "'-' found"),
        (("-2.25 3", ". 3"), 20, "'.' found"),
        (("-2.25 3", "1e 3"), 20, "'1e' found"),
        (("-2.25 3", "2\0 3"), 20, "NUL bytes"),
        (("-2.25 3", "2\x01 3"), 20, "'2\\x01' found"),
        (("-2.25 3", "٣ 3"), 20, "'٣' found"),
        (("Frames: 3", "Frames: 3.0"), 17, "a number of frames expected, '3.0' found"),
        (("Frames: 3", "Frames:"), 18, "a number of frames expected, 'Frame' found"),
        (("Frames: 3\n", ""), 17, "Frames: expected, 'Frame' found"),
        (("0.0083333", "0.0083333 s"), 18, "end of the line expected after the frame time, 's' found"),
        (("Frame Time", "Time"), 18, "Frame Time: expected, 'Time:' found"),
        (("    OFFSET 0 -1 0\n", "", "    }\n", "    }\n    OFFSET 0 -1 0\n"), 13, "expected, 'OFFSET' found"),
        (("0.0083333", "nan"), 18, "'nan' found"),
        (("0.0083333", "1e-400"), 18, "'1e-400' found"),
        (("CHANNELS 1", "CHANNELS 7"), 9, "0 to 6 expected, '7' found"),
        (("CHANNELS 1", "CHANNELS 2"), 10, "'End' found"),
        (("CHANNELS 1 Xrotation", "CHANNELS 2 Xrotation Xrotation"), 9, "each channel once expected"),
        (("CHANNELS 1 Xrotation", "CHANNELS 1 Xrotation CHANNELS 0"), 9, "'CHANNELS' found"),
        (("OFFSET 0 -1 0", "OFFSET 0 -1"), 9, "a number expected, 'CHANNELS' found"),
        (("OFFSET 0 -1 0", "OFFSET 0 -1 0 0"), 8, "JOINT, End Site or } expected, '0' found"),
        (("OFFSET 0 -1 0", "OFFSET 0 -1 1e999"), 8, "(too large)"),
        (("    OFFSET 0 -1 0\n", ""), 13, "an OFFSET for 'Knee' expected before }"),
        (("      OFFSET 0 -2.25 0\n", ""), 12, "an OFFSET for 'Knee_End' expected before }"),
        (("-2.25 0", "-2.25 0 CHANNELS 0"), 12, "} expected in an End Site, 'CHANNELS' found"),
        (("End Site", "End"), 11, "Site expected, '{' found"),
        (("JOINT Knee", "ROOT Knee"), 6, "JOINT, End Site or } expected, 'ROOT' found"),
        (("  {\n    OFFSET", "    OFFSET"), 7, "{ expected, 'OFFSET' found"),
        (("MOTION", "HIERARCHY"), 16, "ROOT or MOTION expected, 'HIERARCHY' found"),
    ],
)
def test_what_is_wrong_is_told_with_its_line(bvh, changes, line, words):
    path = bvh(*changes)
    with pytest.raises(mc.FileError) as caught:
        mc.read(path)
    assert words in str(caught.value)
    assert str(caught.value).startswith(f"{path}:{line}: ")


@pytest.mark.parametrize(("said", "found"), [("2", 3), ("4", 3), ("0", 3), ("10000000000000000000", 3)])
def test_another_number_of_frames_is_read_with_a_warning_that_says_both(bvh, values, said, found):
    path = bvh("Frames: 3", f"Frames: {said}")
    with pytest.warns(UserWarning, match=f"{said} frames announced, {found} found and read"):
        motion = mc.read(path)
    assert same_bits(motion.values, values)


def test_no_frames_and_one_frame_are_motions_too(bvh, values):
    rows = "0.5 -1.25 2 0.1\n1.5 -2.25 3 0.2\n2.5 -3.25 4 -0.0\n"
    assert mc.read(bvh("Frames: 3", "Frames: 0", rows, "")).values.shape == (0, 4)
    one = mc.read(bvh("Frames: 3", "Frames: 1", rows, rows[:16]))
    assert same_bits(one.values, values[:1])


def test_a_skeleton_without_channels_has_a_frame_a_line(bvh):
    text = bvh(
        "CHANNELS 3 Xposition Zrotation Yrotation", "CHANNELS 0", "CHANNELS 1 Xrotation", "CHANNELS 0"
    ).read_text()
    head = text[: text.index("0.5 -1")]
    assert mc.read(bvh(data=(head + "\n\n\n").encode())).values.shape == (3, 0)
    with pytest.raises(mc.FileError, match="no numbers expected"):
        mc.read(bvh(data=(head + "\n1\n\n").encode()))


def test_every_cut_of_a_file_is_refused_or_warned_of(bvh, values):
    data = bvh().read_bytes()
    first = data.index(b"0.5 -1")
    for length in range(len(data) - 1):
        path = bvh(data=data[:length])
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            try:
                motion = mc.read(path)
            except mc.FileError:
                continue
        assert length >= first
        told = any("3 frames announced" in str(warning.message) for warning in caught)
        assert told or length >= len(data) - 3  # "-0" and "-0.": the last number may be whole
        assert same_bits(motion.values, values[: motion.frames])
