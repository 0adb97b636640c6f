"""Splines as JSON come back exactly; anything else is refused with its place."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

import mocurve as mc
from mocurve import bspline, spline


@pytest.fixture
def splines(keys) -> mc.SplineMotion:
    values = np.random.default_rng(3).normal(size=(6, 4)) / 3
    knots = bspline.clamped(np.array([0.0, 1 / 3, 0.5, 2 / 3]))
    return mc.SplineMotion(keys.skeleton, knots, values, 3, 0.1, 8, ({"verb": "fit", "tolerance": ["1deg"]},))


def test_splines_come_back_to_the_last_bit(tmp_path, splines):
    path = tmp_path / "a.spline.json"
    mc.write(path, splines)
    back = mc.read(path)
    assert isinstance(back, mc.SplineMotion)
    assert back.values.tobytes() == splines.values.tobytes()
    assert back.knots.tobytes() == splines.knots.tobytes()
    assert (back.degree, back.frame_time, back.frames, back.history) == (3, 0.1, 8, splines.history)
    assert back.skeleton.names == splines.skeleton.names
    assert back.skeleton.channels == splines.skeleton.channels
    assert back.report is None


def test_the_report_comes_back(tmp_path, splines):
    made = replace(splines, report=mc.compare(splines.sample(), splines))
    mc.write(tmp_path / "a.spline.json", made)
    back = mc.read(tmp_path / "a.spline.json")
    assert repr(back) == repr(made)
    assert "24 coefficients for 32 samples" in repr(back)
    assert back.report.knots == 10


def test_periodic_knots_come_back(tmp_path, splines):
    knots = bspline.periodic(np.arange(6.0))
    closed = replace(splines, knots=knots, values=np.ones((8, 4)))
    mc.write(tmp_path / "a.spline.json", closed)
    assert mc.read(tmp_path / "a.spline.json").knots.tolist() == knots.tolist()


def test_keys_are_written_as_the_same_curves_and_splines_as_the_same_keys(tmp_path, keys, splines):
    mc.write(tmp_path / "a.spline.json", keys)
    np.testing.assert_allclose(mc.read(tmp_path / "a.spline.json").sample().values, keys.sample().values, atol=1e-10)
    mc.write(tmp_path / "a.curves.json", splines)
    np.testing.assert_allclose(mc.read(tmp_path / "a.curves.json").sample().values, splines.sample().values, atol=1e-10)
    with pytest.raises(mc.Mismatch, match="degree 4 has no Hermite keys"):
        mc.write(tmp_path / "b.curves.json", spline.raised(splines, 4))


@pytest.mark.parametrize("extension", [".blend.py", ".curves.json"])
def test_formats_of_keys_get_the_same_curves_as_keys(tmp_path, splines, extension):
    mc.write(tmp_path / f"a{extension}", splines)
    back = mc.read(tmp_path / f"a{extension}")
    assert [len(curve) for curve in back.curves] == [4, 4, 4, 4]
    np.testing.assert_allclose(back.sample().values, splines.sample().values, atol=1e-10)


def test_other_formats_get_samples_and_say_so(tmp_path, splines):
    with pytest.warns(UserWarning, match="splines become samples"):
        mc.write(tmp_path / "a.bvh", splines)
    np.testing.assert_allclose(mc.read(tmp_path / "a.bvh").values, splines.sample().values, atol=1e-6)


def test_samples_are_not_written_as_splines(tmp_path, small):
    with pytest.raises(mc.OptionError, match="a Motion has none: fit it first"):
        mc.write(tmp_path / "a.spline.json", small)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("place", "value", "words"),
    [
        (("format",), "mocurve curves", "format: an object with 'mocurve splines' expected"),
        (("version",), 2, "version: 1, not 2, expected"),
        (("frames",), 10**18, "frames: a whole number"),
        (("degree",), 0, "degree: a whole number from 1 to 5"),
        (("degree",), 10**9, "degree: a whole number from 1 to 5"),
        (("degree",), 2, "curves[0].values: 7 numbers"),
        (("knots",), None, "knots: finite numbers"),
        (("knots",), [], "curves[0].values: 0 numbers"),
        (("knots", 4), 1e400, "not JSON"),
        (("knots", 4), 10**400, "knots: finite numbers"),
        (("knots", 4), -1.0, "knots: the knots of a spline are numbers that do not fall"),
        (("joints", 1, "parent"), 1, "joints[1].parent: a whole number from -1 to 0"),
        (("curves",), [], "curves: one for each of the 4 channels"),
        (("curves", 2, "channel"), "x", "curves[2].channel: 'Hips.Yrotation' expected"),
        (("curves", 2, "values"), [1, 2, "3"], "curves[2].values: finite numbers"),
        (("curves", 2, "values"), [1, 2], "curves[2].values: 6 numbers"),
        (("history",), [1], "history: a list of objects"),
        (("report",), 5, "report: "),
    ],
)
def test_what_is_wrong_is_told_by_its_place(tmp_path, splines, place, value, words):
    path = tmp_path / "a.spline.json"
    mc.write(path, splines)
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


@pytest.mark.parametrize(
    "missing", ["format", "version", "frame_time", "frames", "joints", "degree", "knots", "curves"]
)
def test_a_missing_part_is_told(tmp_path, splines, missing):
    path = tmp_path / "a.spline.json"
    mc.write(path, splines)
    data = json.loads(path.read_text())
    del data[missing]
    path.write_text(json.dumps(data))
    with pytest.raises(mc.FileError, match=f"{missing}: "):
        mc.read(path)


def test_cut_files_are_refused(tmp_path, splines):
    path = tmp_path / "a.spline.json"
    mc.write(path, splines)
    whole = path.read_bytes()
    for length in range(0, len(whole) - 2, 97):
        path.write_bytes(whole[:length])
        with pytest.raises(mc.FileError, match="not JSON"):
            mc.read(path)


def test_the_example_of_the_documentation_is_read(tmp_path, repository):
    text = (repository / "docs" / "formats.md").read_text("utf-8").partition("\n## `.spline.json`")[2]
    path = tmp_path / "a.spline.json"
    path.write_text(text.partition("```json\n")[2].partition("```")[0])
    assert repr(mc.read(path)) == "<SplineMotion 5 coefficients of degree 3 for 121 frames x 1 channels>"
    mc.write(tmp_path / "b.spline.json", mc.read(path))
    assert (tmp_path / "b.spline.json").read_text() == path.read_text()
