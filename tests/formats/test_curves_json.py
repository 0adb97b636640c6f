"""Keys as JSON come back exactly; anything else is refused with its place."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

import mocurve as mc


def same(a: mc.KeyedMotion, b: mc.KeyedMotion) -> bool:
    bits = [
        x.tobytes() == y.tobytes()
        for one, other in zip(a.curves, b.curves, strict=True)
        for x, y in zip(
            (one.times, one.values, one.slopes, one.in_slopes),
            (other.times, other.values, other.slopes, other.in_slopes),
            strict=True,
        )
    ]
    return all(bits) and (a.frame_time, a.frames, a.history) == (b.frame_time, b.frames, b.history)


def test_keys_come_back_to_the_last_bit(tmp_path, keys):
    path = tmp_path / "a.curves.json"
    mc.write(path, keys)
    back = mc.read(path)
    assert same(back, keys)
    assert [curve.broken for curve in back.curves] == [False, False, True, False]
    assert back.skeleton.names == keys.skeleton.names
    assert back.skeleton.channels == keys.skeleton.channels
    assert back.skeleton.end_sites.tolist() == keys.skeleton.end_sites.tolist()
    assert back.skeleton.offsets.tolist() == keys.skeleton.offsets.tolist()
    assert back.skeleton.unit is None
    assert back.report is None


def test_unit_and_report_come_back(tmp_path, keys):
    body = replace(keys.skeleton, unit=0.01)
    keys = replace(keys, skeleton=body)
    keys = replace(keys, report=mc.compare(keys.sample(), keys))
    mc.write(tmp_path / "a.curves.json", keys)
    back = mc.read(tmp_path / "a.curves.json")
    assert back.skeleton.unit == 0.01
    assert repr(back) == repr(keys)
    assert back.report.to_json() == json.loads(json.dumps(keys.report.to_json()))


def test_a_file_has_a_line_for_each_joint_and_curve(tmp_path, keys):
    mc.write(tmp_path / "a.curves.json", keys)
    lines = (tmp_path / "a.curves.json").read_text().splitlines()
    assert sum(line.startswith('{"name"') for line in lines) == 3
    assert sum(line.startswith('{"channel"') for line in lines) == 4
    assert '"version": 1,' in lines


def test_keys_of_nothing_come_back(tmp_path):
    body = mc.Skeleton(("a",), [-1], np.zeros((1, 3)), (("Xrotation",),))
    none = mc.KeyedMotion(body, (mc.HermiteCurve([], [], []),), 0.1, 0)
    mc.write(tmp_path / "a.curves.json", none)
    assert mc.read(tmp_path / "a.curves.json").keys == 0


def test_samples_are_not_written_as_keys(tmp_path, small):
    with pytest.raises(mc.OptionError, match="a Motion has none: reduce it first"):
        mc.write(tmp_path / "a.curves.json", small)


def test_a_history_that_is_no_json_is_refused_and_leaves_nothing(tmp_path, keys):
    with pytest.raises(mc.OptionError, match="cannot be written as JSON"):
        mc.write(tmp_path / "a.curves.json", replace(keys, history=({"verb": object()},)))
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("place", "value", "words"),
    [
        (("format",), "x", "format: an object with 'mocurve curves' expected"),
        (("version",), 2, "version: 1, not 2, expected"),
        (("version",), True, "version: 1, not True, expected"),
        (("frame_time",), 0, "frame_time: seconds above 0"),
        (("frame_time",), "0.1", "frame_time: finite numbers"),
        (("frames",), -1, "frames: a whole number from 0"),
        (("frames",), 10**18, "frames: a whole number"),
        (("frames",), 3.0, "frames: a whole number"),
        (("unit",), -1, "joints: unit must be a positive number"),
        (("unit",), [], "unit: finite numbers"),
        (("joints",), {}, "joints: a list of objects"),
        (("joints", 1), 3, "joints: a list of objects"),
        (("joints", 1, "name"), None, "joints[1].name: a string"),
        (("joints", 1, "parent"), 1, "joints[1].parent: a whole number from -1 to 0"),
        (("joints", 1, "parent"), 10**30, "joints[1].parent"),
        (("joints", 1, "parent"), False, "joints[1].parent"),
        (("joints", 1, "offset"), [0, 0], "joints[1].offset: three numbers"),
        (("joints", 1, "offset"), [0, 0, True], "joints[1].offset: finite numbers"),
        (("joints", 1, "channels"), "Xrotation", "joints[1].channels: a list of strings"),
        (("joints", 1, "channels"), ["Xscale"], "no channel kind (joint 'Knee') 'Xscale'"),
        (("joints", 1, "end_site"), 1, "joints[1].end_site: true or false"),
        (("curves",), [], "curves: one for each of the 4 channels"),
        (("curves", 2, "channel"), "x", "curves[2].channel: 'Hips.Yrotation' expected"),
        (("curves", 2, "times"), None, "curves[2].times: finite numbers"),
        (("curves", 2, "times"), [], "curves[2].times: at least one key"),
        (("curves", 2, "times"), [0, 1, 1], "curves[2]: the key times of a curve must rise"),
        (("curves", 2, "values"), [1, 2, "3"], "curves[2].values: finite numbers"),
        (("curves", 2, "values"), [1, 2], "curves[2]: times, values and slopes of a curve differ in length"),
        (("curves", 2, "slopes"), [1, 2, 10**400], "curves[2].slopes: finite numbers"),
        (("curves", 2, "in_slopes"), [1, 2], "curves[2]: "),
        (("history",), [1], "history: a list of objects"),
        (("report",), 5, "report: "),
        (("report",), {"keys": "many"}, "report: "),
    ],
)
def test_what_is_wrong_is_told_by_its_place(tmp_path, keys, place, value, words):
    path = tmp_path / "a.curves.json"
    mc.write(path, keys)
    data = json.loads(path.read_text())
    inner = data
    for step in place[:-1]:
        inner = inner[step]
    inner[place[-1]] = value
    path.write_text(json.dumps(data))
    with pytest.raises(mc.FileError) as caught:
        mc.read(path)
    assert words in str(caught.value)
    assert str(caught.value).startswith(str(path))


@pytest.mark.parametrize("missing", ["format", "version", "frame_time", "frames", "joints", "curves"])
def test_a_missing_part_is_told(tmp_path, keys, missing):
    path = tmp_path / "a.curves.json"
    mc.write(path, keys)
    data = json.loads(path.read_text())
    del data[missing]
    path.write_text(json.dumps(data))
    with pytest.raises(mc.FileError, match=f"{missing}: "):
        mc.read(path)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (b"", "not JSON"),
        (b"{", ":1: column 2: not JSON"),
        (b'{"format":\n nope}', ":2: column 2: not JSON"),
        (b"[" * 200_000, "nested too deep"),
        (b'{"format": "mocurve curves", "version": 1, "frame_time": NaN}', "NaN is no number"),
        (b'{"version": ' + b"9" * 5000 + b"}", "not JSON"),
        (b"\xff\xfe\x00", "not JSON"),
        (b"[]", "format: "),
        (b"null", "format: "),
    ],
)
def test_what_is_no_json_is_told(tmp_path, text, words):
    path = tmp_path / "a.curves.json"
    path.write_bytes(text)
    with pytest.raises(mc.FileError) as caught:
        mc.read(path)
    assert words in str(caught.value)


def test_the_example_of_the_documentation_is_read(tmp_path, repository):
    text = (repository / "docs" / "formats.md").read_text("utf-8")
    path = tmp_path / "a.curves.json"
    path.write_text(text.partition("```json\n")[2].partition("```")[0])
    assert repr(mc.read(path)) == "<KeyedMotion 2 keys for 121 frames x 1 channels>"
    mc.write(tmp_path / "b.curves.json", mc.read(path))
    assert (tmp_path / "b.curves.json").read_text() == path.read_text()
