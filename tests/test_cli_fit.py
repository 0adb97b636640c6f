"""`mocurve fit` as a person meets it."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import mocurve
from mocurve import cli


@pytest.fixture
def clip(jump: Path, tmp_path: Path) -> Path:
    path = tmp_path / "clip.bvh"
    mocurve.write(path, mocurve.read(jump)[100:220])
    return path


def test_it_writes_splines_that_keep_the_promise_and_tells_what_they_cost(
    clip: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    target = clip.with_name("clip.spline.json")
    assert cli.main(["fit", str(clip), "-o", str(target), "--tolerance", "1%height", "--tolerance", "5deg"]) == 0
    out, err = capsys.readouterr()
    assert out.startswith("splines    coefficients ")
    assert "shared by all channels" in out
    assert f"wrote {target}" in out
    assert err == ""
    told = mocurve.compare(mocurve.read(clip), mocurve.read(target))
    assert told.max_error_degrees <= 5.0
    assert told.tolerance == "1%height, 5deg"


def test_json_is_one_object_with_knots_and_errors(clip: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["fit", str(clip), "--knots", "uniform", "--spans", "12", "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert (told["knots"], told["keys"], told["samples"]) == (19, 15 * 96, 120 * 96)
    assert told["tolerance"] is None
    assert 0 < told["rms_error_world"] < told["max_error_world"]


def test_other_formats_get_keys_or_samples(clip: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for name in ("a.curves.json", "a.bvh"):
        assert cli.main(["fit", str(clip), "-o", str(clip.with_name(name)), "--tolerance", "2deg"]) == 0
    assert "splines become samples" in capsys.readouterr().err
    assert isinstance(mocurve.read(clip.with_name("a.curves.json")), mocurve.KeyedMotion)
    assert mocurve.read(clip.with_name("a.bvh")).frames == 120


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--degree", "9"], "a whole number from 1 to 5, not 9"),
        (["--spans", "9"], "goes with knots 'curvature' or 'uniform'"),
        (["--knots", "unifrom"], "Did you mean 'uniform'?"),
        (["--tolerance", "5"], "a number and a unit"),
        (["-o", "x.splines"], "no format known"),
    ],
)
def test_what_cannot_be_is_one_line_and_ends_with_2(
    clip: Path, capsys: pytest.CaptureFixture[str], arguments: list[str], words: str
) -> None:
    assert cli.main(["fit", str(clip), *arguments]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert words in err
    assert err.count("\n") == 1
