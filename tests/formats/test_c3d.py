"""C3D: markers of every kind of file become position channels; files that lie are refused."""

from __future__ import annotations

import random
import struct
import tracemalloc
import warnings

import numpy as np
import pytest

import mocurve as mc
from mocurve import kinematics
from mocurve.formats import c3d

INTEL, VAX, SGI = 84, 85, 86
PLACES = np.array([[[1, 2, 3], [-4, 5.5, 6]], [[2, 2, 3], [-5, 5.5, 6]], [[3, 2, 3.25], [-6, 5.5, 6]]])


def floats(values, processor: int) -> bytes:
    numbers = np.asarray(values, np.float32).reshape(-1)
    if processor != VAX:
        return numbers.astype(">f4" if processor == SGI else "<f4").tobytes()
    bits = (numbers * 4).astype("<f4").view("<u4")
    return np.where(numbers == 0, 0, bits >> 16 | bits << 16).astype("<u4").tobytes()


def integers(values, processor: int) -> bytes:
    return np.asarray(values).astype(">i2" if processor == SGI else "<i2").tobytes()


def texts(rows: list[str]) -> tuple[int, list[int], bytes]:
    width = max(map(len, rows))
    return -1, [width, len(rows)], b"".join(row.ljust(width).encode() for row in rows)


def made(places=PLACES, processor=INTEL, scale=-1.0, analog=0, residuals=None, first=1, rate=50, **more) -> bytes:
    """A C3D file of places (F, P, 3); `more` are parameters "POINT_RATE" as (type, sizes, bytes), None for none."""
    frames, points = np.shape(places)[:2]
    parameters = {
        "POINT_USED": (2, [], integers(points, processor)),
        "POINT_SCALE": (4, [], floats(scale, processor)),
        "POINT_FRAMES": (2, [], integers(frames % 65536 - 65536 * (frames > 32767), processor)),
        "POINT_LABELS": texts([f"M{k}" for k in range(points)]),
        "POINT_UNITS": texts(["mm"]),
        "POINT_RATE": (4, [], floats(100, processor)),
        **more,
    }
    section, groups = b"\x01P\x00" + bytes([processor]), {}
    for name, parameter in parameters.items():
        group, _, name = name.partition("_")
        if group not in groups:
            groups[group] = len(groups) + 1
            section += struct.pack("bb", len(group), -groups[group]) + group.encode() + integers(3, processor) + b"\0"
        if parameter is not None:
            kind, sizes, value = parameter
            body = struct.pack("bB", kind, len(sizes)) + bytes(sizes) + value + b"\0"
            head = struct.pack("bb", len(name), groups[group]) + name.encode()
            section += head + integers(2 + len(body), processor) + body
    section += bytes(2 + -(len(section) + 2) % 512)
    start = 2 + len(section) // 512
    header = integers([points, analog, first, first + frames - 1, 0], processor) + floats(scale, processor)
    header += integers([start, 0], processor) + floats(rate, processor)
    rows = np.zeros((frames, points, 4))
    rows[..., :3] = np.divide(places, scale if scale > 0 else 1)
    rows[..., 3] = 0 if residuals is None else residuals
    rows = np.column_stack([rows.reshape(frames, -1), np.full((frames, analog), 7)])
    stored = (integers if scale > 0 else floats)(rows, processor)
    return (b"\x02P" + header).ljust(512, b"\0") + section + stored


@pytest.fixture
def path(tmp_path):
    return tmp_path / "a.c3d"


@pytest.mark.parametrize("analog", [0, 3])
@pytest.mark.parametrize("scale", [-1.0, 0.25])
@pytest.mark.parametrize("processor", [INTEL, VAX, SGI])
def test_every_kind_of_number_is_read(path, processor, scale, analog):
    path.write_bytes(made(processor=processor, scale=scale, analog=analog))
    motion = mc.read(path)
    assert motion.values.reshape(3, 2, 3).tolist() == PLACES.tolist()
    assert motion.skeleton.names == ("M0", "M1")
    assert motion.skeleton.channel_names[:4] == ("M0.Xposition", "M0.Yposition", "M0.Zposition", "M1.Xposition")
    assert (motion.frame_time, motion.skeleton.unit) == (1 / 100, 0.001)
    assert kinematics.world(motion).tolist() == PLACES.tolist()


@pytest.mark.parametrize("processor", [INTEL, VAX])
@pytest.mark.parametrize("scale", [-1.0, 0.25])
def test_ezc3d_reads_the_same(path, processor, scale):
    ezc3d = pytest.importorskip("ezc3d")
    residuals = [[0, 0], [-1, 0], [0, -1]]
    path.write_bytes(made(processor=processor, scale=scale, residuals=residuals))
    theirs = ezc3d.c3d(str(path))["data"]["points"][:3].transpose(2, 1, 0)
    assert np.array_equal(mc.read(path).values.reshape(3, 2, 3), theirs, equal_nan=True)


def test_a_real_file_is_what_ezc3d_reads_of_it(clips):
    ezc3d = pytest.importorskip("ezc3d")
    path = clips / "other" / "walking_optitrack.c3d"
    theirs = ezc3d.c3d(str(path))
    motion = mc.read(path)
    assert repr(motion) == "<Motion 3361 frames, 21.00 s, 12 joints, 36 channels>"
    assert motion.skeleton.names == tuple(theirs["parameters"]["POINT"]["LABELS"]["value"])
    assert motion.frame_time == 1 / theirs["parameters"]["POINT"]["RATE"]["value"][0]
    places = theirs["data"]["points"][:3].transpose(2, 1, 0).reshape(3361, 36)
    assert np.array_equal(motion.values, places, equal_nan=True)
    assert np.isnan(places).sum() == 8988


def test_what_ezc3d_writes_is_read(path):
    ezc3d = pytest.importorskip("ezc3d")
    file = ezc3d.c3d()
    file["parameters"]["POINT"]["RATE"]["value"] = [119.88012]
    file["parameters"]["POINT"]["LABELS"]["value"] = [f"m{k}" for k in range(300)]
    file["parameters"]["POINT"]["UNITS"]["value"] = ["m"]
    points = np.random.default_rng(1).normal(size=(4, 300, 5)).astype(np.float32)
    points[3] = 1
    file["data"]["points"] = points
    file.write(str(path))
    motion = mc.read(path)
    assert motion.frame_time == 1001 / 120_000
    assert motion.skeleton.names == tuple(f"m{k}" for k in range(300))
    assert motion.values.tolist() == points[:3].transpose(2, 1, 0).reshape(5, 900).tolist()


def test_markers_that_were_not_seen_are_gaps(path):
    places = PLACES.copy()
    places[0, 1] = 0.0
    path.write_bytes(made(places, residuals=[[0, 0], [-1, 0], [0, 0]]))
    values = mc.read(path).values.reshape(3, 2, 3)
    assert np.isnan(values).all(axis=2).tolist() == [[False, True], [True, False], [False, False]]
    assert np.isnan(values).any(axis=2).tolist() == np.isnan(values).all(axis=2).tolist()


def test_markers_never_seen_and_points_that_are_angles_are_left_out(path):
    places = np.repeat(PLACES, 2, axis=1)
    path.write_bytes(made(places, residuals=[[0, -1, 0, 0]] * 3, POINT_ANGLES=texts(["M3"])))
    with (
        pytest.warns(UserWarning, match="1 of its points are seen in no frame and are left out: M1"),
        pytest.warns(UserWarning, match="1 of its points are no places but angles or forces .*: M3"),
    ):
        assert mc.read(path).skeleton.names == ("M0", "M2")


def test_names_go_on_in_labels2_and_are_numbers_where_missing(path):
    places = np.repeat(PLACES, 2, axis=1)
    path.write_bytes(made(places, POINT_LABELS=texts(["a", ""]), POINT_LABELS2=texts(["c"])))
    assert mc.read(path).skeleton.names == ("a", "Marker2", "c", "Marker4")


def test_the_rate_of_the_first_block_is_the_second_choice(path):
    path.write_bytes(made(POINT_RATE=None, POINT_UNITS=None))
    motion = mc.read(path)
    assert (motion.frame_time, motion.skeleton.unit) == (1 / 50, None)


def test_an_unknown_unit_is_told(path):
    path.write_bytes(made(POINT_UNITS=texts(["furlong"])))
    with pytest.warns(UserWarning, match="the length unit 'furlong' is not known"):
        assert mc.read(path).skeleton.unit is None


def test_more_frames_than_the_first_block_can_count(path):
    places = np.tile(PLACES[:1, :1] + 0.0, (70_000, 1, 1))
    data = bytearray(made(places[:65_534], POINT_FRAMES=(4, [], floats(70_000, INTEL))))
    data[8:10] = b"\xff\xff"
    path.write_bytes(bytes(data) + floats(np.ones((70_000 - 65_534, 4)), INTEL))
    assert mc.read(path).frames == 70_000
    fields = {
        "TRIAL_ACTUAL_START_FIELD": (2, [2], integers([1, 0], INTEL)),
        "TRIAL_ACTUAL_END_FIELD": (2, [2], integers([70_000 - 131_072 + 65_536, 1], INTEL)),
    }
    data = bytearray(made(places[:65_534], **fields))
    data[8:10] = b"\xff\xff"
    path.write_bytes(bytes(data) + floats(np.ones((70_000 - 65_534, 4)), INTEL))
    assert mc.read(path).frames == 70_000


def test_two_counts_of_frames_are_told(path):
    path.write_bytes(made(POINT_FRAMES=(2, [], integers(2, INTEL))))
    with pytest.warns(UserWarning, match="3 frames by the first block, 2 by POINT:FRAMES: the first are read"):
        assert mc.read(path).frames == 3


def test_markers_without_gaps_are_reduced_within_the_tolerance(clips):
    motion = mc.read(clips / "other" / "walking_optitrack.c3d")[:300]
    assert np.isfinite(motion.values).all()
    keys = mc.reduce(motion, tolerance="2mm")
    away = np.linalg.norm((keys.sample().values - motion.values).reshape(300, 12, 3), axis=2)
    assert away.max() <= 2.0
    assert keys.keys < motion.values.size / 5


def test_c3d_is_not_written(path, small):
    with pytest.raises(mc.FileError, match=r"C3D files are only read; \.csv keeps markers and their gaps"):
        mc.write(path, small)


# -- broken files --------------------------------------------------------------------------------


def refused(path) -> str:
    tracemalloc.start()
    try:
        with pytest.raises(mc.FileError) as caught:
            c3d.read(path)
        assert tracemalloc.get_traced_memory()[1] < 5e6
    finally:
        tracemalloc.stop()
    return str(caught.value)


def changed(at: int, value: bytes, **more) -> bytes:
    data = bytearray(made(**more))
    data[at : at + len(value)] = value
    return bytes(data)


@pytest.mark.parametrize(
    ("data", "words"),
    [
        (b"", "0 bytes, its first block has 512"),
        (bytes(600), "its second byte is not 50"),
        (changed(0, b"\0"), "the parameters begin at block 0, which is not there"),
        (changed(0, b"\xff"), "the parameters begin at block 255, which is not there"),
        (changed(515, b"\x10"), "processor 84, 85 or 86 expected at block 2, 16 found"),
        (changed(2, b"\xff\xff"), "3 frames of 65535 points end at byte"),
        (changed(2, b"\0\0"), "0 points in 3 frames: there is nothing to read"),
        (changed(8, b"\0\x80", POINT_FRAMES=None), "32768 frames of 2 points end at byte"),
        (changed(8, b"\0\0", POINT_FRAMES=None), "2 points in 0 frames: there is nothing to read"),
        (changed(16, b"\xff\xff"), "3 frames of 2 points end at byte"),
        (changed(16, b"\0\0"), "3 frames of 2 points end at byte"),
        (changed(12, b"\0\0\x80\x7f"), "a scale of inf"),
        (changed(4, b"\xff\xff"), "3 frames of 2 points end at byte"),
        (changed(523, b"\xff\xff"), "parameters, byte 11: 'POINT' points back by 1 bytes"),
        (changed(523, b"\0\x7f"), "bytes expected, 0 are there"),
        (made(POINT_RATE=(4, [], floats(np.nan, INTEL)), rate=0), "a rate of 0 frames a second"),
        (made(POINT_LABELS=(3, [2], b"ab")), "'LABELS' has type 3 and 1 dimensions"),
        (made(POINT_LABELS=(-1, [255] * 7, b"ab")), "bytes expected"),
        (made()[:-1], "3 frames of 2 points end at byte"),
    ],
)  # fmt: skip
def test_what_is_wrong_is_told(path, data, words):
    path.write_bytes(data)
    assert words in refused(path)


def test_every_cut_of_a_file_is_refused(path):
    data = made()
    for length in range(0, len(data), 7):
        path.write_bytes(data[:length])
        with pytest.raises(mc.FileError):
            c3d.read(path)


def test_files_changed_at_random_are_refused_or_read_as_a_motion(path):
    sources = [made(processor=processor, scale=scale) for processor in (INTEL, VAX, SGI) for scale in (-1.0, 0.25)]
    read = 0
    for seed in range(600):
        rng = random.Random(seed)
        data = bytearray(sources[seed % len(sources)])
        for _ in range(rng.choice([1, 2, 5, 20])):
            data[
                rng.randrange(len(data))
                if rng.random() < 0.2
                else rng.choice([rng.randrange(24), 512 + rng.randrange(90)])
            ] = rng.choice([0, 1, 0x7F, 0x80, 0xFF, rng.randrange(256)])
        path.write_bytes(data)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", UserWarning)
            try:
                motion = c3d.read(path)
            except mc.FileError:
                continue
        assert not np.isinf(motion.values).any()
        read += 1
    assert read
