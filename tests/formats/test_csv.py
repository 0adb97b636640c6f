"""CSV: what is written comes back, tables of markers are read, and what is wrong is told with line and column."""

from __future__ import annotations

import csv
import random
import tracemalloc
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import mocurve as mc

TABLE = """time,A.X,A.Y,A.Z,B.X,B.Y,B.Z
0.00,1,2,3,,,
0.01,1.5,2,3,4,nan,6
0.02,2,2,3,4,5,6
"""


@pytest.fixture
def table(tmp_path):
    """table(old, new, ...) is a small table of markers with every `old` changed to `new`."""

    def make(*changes: str, text: str = TABLE, encoding: str = "utf-8"):
        for old, new in zip(changes[::2], changes[1::2], strict=True):
            assert old in text
            text = text.replace(old, new)
        (tmp_path / "a.csv").write_bytes(text.encode(encoding))
        return tmp_path / "a.csv"

    return make


def test_it_is_a_table_with_time_and_channel_names(tmp_path, small):
    mc.write(tmp_path / "a.csv", small, lossless=True)
    with open(tmp_path / "a.csv", newline="") as file:
        head, *rows = list(csv.reader(file))
    assert head == ["time", "Hips.Xposition", "Hips.Zrotation", "Hips.Yrotation", "Knee.Xrotation"]
    assert np.array(rows, float).tolist() == np.column_stack((np.arange(3) / 120, small.values)).tolist()


# -- back with a body ----------------------------------------------------------------------------


@pytest.mark.parametrize("lossless", [True, False])
def test_with_its_body_all_comes_back(tmp_path, jump, lossless):
    motion = mc.read(jump)
    mc.write(tmp_path / "a.csv", motion, lossless=lossless)
    back = mc.read(tmp_path / "a.csv", skeleton=jump)
    assert back.frame_time == motion.frame_time
    assert back.skeleton.names == motion.skeleton.names
    assert back.skeleton.parents.tolist() == motion.skeleton.parents.tolist()
    if lossless:
        assert back.values.tobytes() == motion.values.tobytes()
    np.testing.assert_allclose(back.values, motion.values, atol=6e-7)


@given(fps=st.floats(1.0, 1000.0), frames=st.integers(2, 300))
def test_any_frame_time_comes_back_to_the_last_digit(tmp_path_factory, fps, frames):
    body = mc.Skeleton(("a",), [-1], [[0, 0, 0]], (("Xposition",),))
    path = tmp_path_factory.mktemp("csv") / "a.csv"
    mc.write(path, mc.Motion(body, np.zeros((frames, 1)), 1 / fps), lossless=True)
    back = mc.read(path)
    assert back.frames == frames
    assert back.frame_time == 1 / fps or abs(back.frame_time * fps - 1) < 1e-9  # 59.999999 is 60


@pytest.mark.parametrize("fps", [24, 29.97002997002997, 30, 50, 59.94005994005994, 60, 100, 120, 144, 240, 1000])
@pytest.mark.parametrize("frames", [2, 3, 10, 1000])
def test_usual_rates_come_back_from_six_decimals(tmp_path, fps, frames):
    body = mc.Skeleton(("a",), [-1], [[0, 0, 0]], (("Xposition",),))
    mc.write(tmp_path / "a.csv", mc.Motion(body, np.zeros((frames, 1)), 1 / fps))
    assert mc.read(tmp_path / "a.csv").frame_time == pytest.approx(1 / fps, rel=1e-14)


def test_columns_may_come_in_another_order(tmp_path, small, bvh):
    mc.write(tmp_path / "a.csv", small, lossless=True)
    rows = [line.split(",") for line in (tmp_path / "a.csv").read_text().splitlines()]
    (tmp_path / "a.csv").write_text("\n".join(",".join(row[k] for k in (4, 2, 0, 1, 3)) for row in rows))
    back = mc.read(tmp_path / "a.csv", skeleton=bvh())
    assert back.values.tolist() == small.values.tolist()


def test_joints_of_one_name_come_back_in_their_order(tmp_path, small, bvh):
    twice = bvh("JOINT Knee", "JOINT Hips")
    mc.write(tmp_path / "a.csv", replace(small, skeleton=mc.read(twice).skeleton), lossless=True)
    assert mc.read(tmp_path / "a.csv", skeleton=twice).values.tolist() == small.values.tolist()


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("Knee.X", "Toe.X", "the table has no column 'Knee.Xrotation'"),
        (",Knee.Xrotation", ",Knee.Xrotation,Toe.Xrotation", "the skeleton has no channel 'Toe.Xrotation'"),
        ("Hips.Zrotation", "Hips.Zrotation,Hips.Zrotation", "the skeleton has 4 channels, the table 5 of 4 names"),
    ],
)
def test_a_body_that_does_not_fit_is_told(tmp_path, small, bvh, old, new, words):
    mc.write(tmp_path / "a.csv", small)
    lines = (tmp_path / "a.csv").read_text().splitlines()
    more = lines[0].replace(old, new).count(",") - lines[0].count(",")
    text = "\n".join([lines[0].replace(old, new), *(line + ",0" * more for line in lines[1:])])
    (tmp_path / "a.csv").write_text(text)
    with pytest.raises(mc.Mismatch, match=words):
        mc.read(tmp_path / "a.csv", skeleton=bvh())


def test_a_body_that_cannot_be_read_is_told(table, tmp_path):
    with pytest.raises(mc.FileError, match=r"body\.bvh: no such file"):
        mc.read(table(), skeleton=tmp_path / "body.bvh")


# -- without a body ------------------------------------------------------------------------------


def test_without_a_body_each_joint_stands_for_itself(tmp_path, small):
    mc.write(tmp_path / "a.csv", small, lossless=True)
    with pytest.warns(UserWarning, match="does not say how its 2 joints hang together.*the option skeleton"):
        back = mc.read(tmp_path / "a.csv")
    assert back.values.tolist() == small.values.tolist()
    assert back.skeleton.parents.tolist() == [-1, -1]
    assert back.skeleton.channel_names == small.skeleton.channel_names
    assert back.skeleton.offsets.tolist() == [[0, 0, 0], [0, 0, 0]]


@pytest.mark.parametrize("mark", [".", ":", "_", " "])
def test_markers_are_roots_with_gaps(table, mark):
    motion = mc.read(table("A.", f"A{mark}", "B.", f"B{mark}"))
    assert motion.skeleton.names == ("A", "B")
    assert motion.skeleton.channel_names[3:] == ("B.Xposition", "B.Yposition", "B.Zposition")
    expected = [[1, 2, 3, *[np.nan] * 3], [1.5, 2, 3, 4, np.nan, 6], [2, 2, 3, 4, 5, 6]]
    assert np.array_equal(motion.values, expected, equal_nan=True)
    assert motion.frame_time == 0.01
    assert motion.skeleton.offsets.tolist() == [[1.5, 2, 3], [4, 5, 6]]


def test_axes_of_a_marker_need_not_stand_side_by_side(table):
    motion = mc.read(table("A.X,A.Y,A.Z,B.X,B.Y,B.Z", "B.y,A.x,B.x,A.z,B.z,A.y"))
    assert motion.skeleton.channel_names[:4] == ("B.Yposition", "B.Xposition", "B.Zposition", "A.Xposition")
    assert motion.values[2].tolist() == [2, 3, 5, 2, 4, 6]


def test_gaps_are_written_as_empty_cells_and_come_back(table, tmp_path):
    motion = mc.read(table())
    for lossless in (True, False):
        mc.write(tmp_path / "b.csv", motion, lossless=lossless)
        assert "nan" not in (tmp_path / "b.csv").read_text()
        assert np.array_equal(mc.read(tmp_path / "b.csv").values, motion.values, equal_nan=True)


def test_markers_of_a_c3d_file_come_back(clips, tmp_path):
    motion = mc.read(clips / "other" / "walking_optitrack.c3d")
    mc.write(tmp_path / "a.csv", motion, lossless=True)
    back = mc.read(tmp_path / "a.csv", unit="mm")
    assert np.array_equal(back.values, motion.values, equal_nan=True)
    assert back.skeleton.channel_names == motion.skeleton.channel_names
    assert back.frame_time == motion.frame_time


# -- how tables look -----------------------------------------------------------------------------


@pytest.mark.parametrize(
    "changes",
    [
        (",", ";"),
        (",", "\t"),
        (",", " , "),
        ("\n", "\r\n"),
        ("\n", "\r"),
        ("\n", "\n\n"),
        ("time", "Time (s)"),
        ("time", '"time"', "1.5", '"1.5"'),
        ("A.X", '"A.X"'),
        ("time,", "time,Frame,", "\n0.", "\n0.0,0."),
        ("time", "T"),
        ("2,3,4,5,6\n", "2,3,4,5,6"),
        ("nan", "NaN", "1.5", "+.15e1"),
        ("nan", ""),
        ("nan", " \t "),
    ],
)
@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16"])
def test_tables_look_in_many_ways(table, changes, encoding):
    plain = mc.read(table())
    if "Frame," in changes[-3:] or "time,Frame," in changes:
        path = table("time,", "time,Frame,", "0.00,", "0.00,1,", "0.01,", "0.01,2,", "0.02,", "0.02,3,")
    else:
        path = table(*changes, encoding=encoding)
    motion = mc.read(path)
    assert np.array_equal(motion.values, plain.values, equal_nan=True)
    assert motion.skeleton.channel_names == plain.skeleton.channel_names
    assert motion.frame_time == plain.frame_time


def test_names_hold_what_they_like(tmp_path):
    body = mc.Skeleton(('a,"b;', "x.y", "Ü é"), [-1] * 3, np.zeros((3, 3)), (("Xposition",),) * 3)
    mc.write(tmp_path / "a.csv", mc.Motion(body, np.arange(6.0).reshape(2, 3), 0.5))
    back = mc.read(tmp_path / "a.csv")
    assert back.skeleton.names == body.names
    assert back.values.tolist() == [[0, 1, 2], [3, 4, 5]]


@pytest.mark.parametrize("rows", [0, 1])
def test_too_few_rows_to_tell_a_frame_time_are_told(table, rows):
    text = "".join(TABLE.splitlines(keepends=True)[: 1 + rows])
    with pytest.warns(UserWarning, match=f"{rows} rows tell no frame time, 1/30 s is taken"):
        motion = mc.read(table(text=text))
    assert (motion.frames, motion.frame_time) == (rows, 1 / 30)


# -- what is refused -----------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        (("time", "when"), "a.csv:1: one column 'time' expected in the first line, 0 found"),
        (("A.X", "time"), "a.csv:1: one column 'time' expected in the first line, 2 found"),
        (("A.X", "A.W"), "a.csv:1: column 2: a channel (Hips.Xrotation), a marker's axis (LASI.X) or time expected"),
        (("B.X", "A.X"), "a.csv:1: two columns are the Xposition of 'A'"),
        (("1.5", "abc"), "a.csv:3: column 2 (A.X): a number expected, 'abc' found"),
        (("1.5", "1_5"), "a.csv:3: column 2 (A.X): a number expected, '1_5' found"),
        (("1.5", "0x1"), "a.csv:3: column 2 (A.X): a number expected, '0x1' found"),
        (("1.5", "inf"), "a.csv:3: column 2 (A.X): a number expected, 'inf' found"),
        (("1.5", "1e400"), "a.csv:3: column 2 (A.X): a number expected, '1e400' found"),
        (("1.5", '"1,5"'), "a.csv:3: column 2 (A.X): a number with a decimal point, not a comma, expected"),
        (("1.5", "1,5"), "a.csv:3: 7 cells expected, 8 found; numbers have decimal points, not commas"),
        (("1.5,", ""), "a.csv:3: 7 cells expected, 6 found"),
        (("1.5,", '"1.5,'), "a.csv:3: no row of a table: unexpected end of data"),
        ((",", ";", "1.5", "1,5"), "column 2 (A.X): a number with a decimal point, not a comma, expected, '1,5' found"),
        (("0.01", ""), "a.csv:3: column 1 (time): a time expected, the cell is empty"),
        (("0.01", "0.00"), "a.csv:3: column 1 (time): 0 s, 0 s after the row before, where 0.01 s are usual"),
        (("0.02", "0.04"), "column 1 (time): 0.01 s, 0.01 s after the row before, where 0.02 s are usual"),
        (("0.01", "0.0103"), "a.csv:3: column 1 (time): 0.0103 s, 0.0103 s after the row before"),
        (("0.00", "0.03"), "after the row before"),
    ],
)  # fmt: skip
def test_what_is_wrong_is_told_with_line_and_column(table, changes, words):
    with pytest.raises(mc.FileError) as caught:
        mc.read(table(*changes))
    assert words in str(caught.value)


def test_a_row_that_is_missing_is_seen_among_many(table):
    rows = [f"{k / 120:.6f},{k}" for k in range(1000) if k != 700]
    with pytest.raises(mc.FileError, match=r"a\.csv:702: column 1 \(time\): 5\.841667 s, 0\.016667 s after"):
        mc.read(table(text="time,a.X\n" + "\n".join(rows)))


def test_times_that_drift_are_seen(table):
    rows = [f"{(k + 1e-7 * k * k) / 100:.9f},{k}" for k in range(1000)]
    with pytest.raises(mc.FileError, match=r"column 1 \(time\)"):
        mc.read(table(text="time,a.X\n" + "\n".join(rows)))


@pytest.mark.parametrize(
    "data",
    [b"", b"\0" * 100, b"time", b"time\n0\n1\n", b"\xff\xfeab\xd8", b"\xff\xff", b'"' * 200_000, b"time," * 50_000],
)  # fmt: skip
def test_what_is_no_table_is_refused(tmp_path, data):
    (tmp_path / "a.csv").write_bytes(data)
    tracemalloc.start()
    try:
        with pytest.raises(mc.FileError, match=r"a\.csv"):
            mc.read(tmp_path / "a.csv")
        assert tracemalloc.get_traced_memory()[1] < 2e7
    finally:
        tracemalloc.stop()


@pytest.mark.filterwarnings("ignore:.*(hang together|tell no frame time):UserWarning")
def test_files_changed_at_random_are_refused_or_read_as_a_motion(tmp_path):
    read = 0
    for seed in range(500):
        rng = random.Random(seed)
        data = bytearray(TABLE.encode())
        for _ in range(rng.choice([1, 2, 5])):
            at = rng.randrange(len(data))
            data[at : at + rng.randrange(2)] = rng.choice(
                [b",", b"\n", b'"', b"9", b"", b"e", b"\0", b"\xff", b";", b"-"]
            )
        (tmp_path / "a.csv").write_bytes(data)
        try:
            motion = mc.read(tmp_path / "a.csv")
        except mc.FileError:
            continue
        assert not np.isinf(motion.values).any()
        read += 1
    assert read
