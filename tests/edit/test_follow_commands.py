"""The commands path and follow, file to file."""

from __future__ import annotations

import json
import shutil
from dataclasses import replace
from pathlib import Path as File

import numpy as np
import pytest
from commands import refused

import mocurve as mc
from mocurve import cli
from mocurve.kinematics import world
from mocurve.path import Path


@pytest.fixture
def folder(jump: File, tmp_path: File, monkeypatch: pytest.MonkeyPatch) -> File:
    """A folder with jump.bvh in it, to run in."""
    shutil.copy(jump, tmp_path / "jump.bvh")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def run(capsys: pytest.CaptureFixture[str], line: str) -> dict:
    """What a command tells with --json."""
    assert cli.main([*line.split(), "--json"]) == 0
    out, err = capsys.readouterr()
    assert err == ""
    return json.loads(out)


@pytest.mark.parametrize("options", ["", "--points 6", "--points 8 --degree 5 --track smooth", "--height"])
@pytest.mark.parametrize("extension", ["csv", "json"])
def test_the_fitted_path_followed_back_is_the_clip(
    options: str, extension: str, folder: File, capsys: pytest.CaptureFixture[str]
) -> None:
    told = run(capsys, f"path jump.bvh -o p.{extension} {options}")
    assert told["points"] == Path.read(folder / f"p.{extension}").points.tolist()
    assert 0 < told["rms"] < told["largest"] < 40
    assert (told["unit"], told["degree"]) == ("cm", 5 if "degree" in options else 3)
    assert 150 < told["length"] < 400
    run(capsys, f"follow jump.bvh --path p.{extension} -o same.bvh --lossless")
    assert mc.read("same.bvh").values.tobytes() == mc.read("jump.bvh").values.tobytes()


def test_a_polynomial_is_followed_back_too(folder: File, capsys: pytest.CaptureFixture[str]) -> None:
    told = run(capsys, "path jump.bvh -o p.csv --kind polynomial --degree 45")
    assert len(told["points"]) == 46
    assert told["rms"] < 0.5
    run(capsys, "follow jump.bvh --path p.csv -o same.bvh")
    assert np.abs(mc.read("same.bvh").values - mc.read("jump.bvh").values).max() < 1e-5


def test_points_moved_in_the_file_move_the_clip(folder: File, capsys: pytest.CaptureFixture[str]) -> None:
    run(capsys, "path jump.bvh -o p.csv --points 6")
    lines = (folder / "p.csv").read_text().splitlines()
    rows = [",".join(str(float(cell) + 10) for cell in line.split(",")) for line in lines[2:]]
    (folder / "p.csv").write_text("\n".join([*lines[:2], *rows]))
    told = run(capsys, "follow jump.bvh --path p.csv -o moved.npz")
    assert told["measured"]["turned"] < 1e-6
    clip = mc.read("jump.bvh")
    np.testing.assert_allclose(world(mc.read("moved.npz")), world(clip) + np.array([10, 0, 10]), atol=1e-6)
    back = run(capsys, "path jump.bvh -o own.csv --points 6")
    assert back["kind"] == "spline"
    run(capsys, "follow moved.npz --path own.csv -o back.npz")  # the file knows which path it is on
    np.testing.assert_allclose(mc.read("back.npz").values, clip.values, atol=1e-9)


def test_a_clip_that_goes_nowhere_is_told(folder: File, capsys: pytest.CaptureFixture[str]) -> None:
    clip = mc.read("jump.bvh")
    values = np.array(clip.values)
    values[:, :3] = values[0, :3]
    mc.write("stands.bvh", replace(clip, values=values))
    assert cli.main(["path", "stands.bvh", "-o", "p.csv"]) == 0
    assert "the clip goes nowhere: its path has no length" in capsys.readouterr().err
    assert "all points are in one place" in refused(capsys, *["follow", "stands.bvh", "--path", "p.csv", "-o", "a.bvh"])


def test_bare_points_of_the_own_path_are_known(folder: File, capsys: pytest.CaptureFixture[str]) -> None:
    run(capsys, "path jump.bvh -o p.csv --points 7 --degree 5")
    rows = (folder / "p.csv").read_text().splitlines()[2:]
    (folder / "bare.csv").write_text("\n".join(rows))
    assert run(capsys, "follow jump.bvh --path bare.csv -o same.bvh")["measured"]["first"] is None
    shifted = [",".join(str(float(cell) + 10) for cell in row.split(",")) for row in rows]
    (folder / "shifted.csv").write_text("\n".join(shifted))
    run(capsys, "follow jump.bvh --path shifted.csv -o moved.npz")
    there = world(mc.read("jump.bvh")) + np.array([10, 0, 10])
    np.testing.assert_allclose(world(mc.read("moved.npz")), there, atol=1e-9)
    run(capsys, "follow jump.bvh --path bare.csv -o span.bvh --mode span")


def test_a_drawing_is_filled_with_cycles_and_shown(folder: File, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "tour.svg").write_text('<svg><path d="M 0 0 C 40 0 40 60 0 60 S -40 120 0 120"/></svg>')
    told = run(capsys, "follow jump.bvh --path tour.svg -o tour.bvh --at-end cycle --html a.html --picture a.png")
    assert told["measured"]["cycles"] > 3
    assert len(told["table"]["frame"]) == told["frames"]
    assert (folder / "a.png").read_bytes().startswith(b"\x89PNG")
    assert b"cycles" in (folder / "a.html").read_bytes()


def test_bends_taken_slowly_and_a_heading_that_is_kept(folder: File, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "p.csv").write_text("0,0\n0,20\n20,20\n")
    told = run(capsys, "follow jump.bvh --path p.csv -o a.bvh --mode paced --heading kept --no-lock-feet")
    assert told["measured"]["turned"] == 0
    assert told["measured"]["slower"] > 1.05
    assert told["frames"] == mc.read("a.bvh").frames > mc.read("jump.bvh").frames


def test_without_json_it_says_what_it_did(folder: File, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["path", "jump.bvh", "-o", "p.csv", "--html", "p.html"]) == 0
    out = capsys.readouterr().out
    assert "cm long, spline of degree 3" in out
    assert "wrote p.csv" in out
    assert "wrote p.html" in out
    (folder / "short.csv").write_text("0,0\n0,10\n")
    assert cli.main(["follow", "jump.bvh", "--path", "short.csv", "-o", "far.bvh", "--picture", "far.png"]) == 0
    out = capsys.readouterr().out
    assert "wrote far.png" in out
    assert "lie straight on behind its end" in out
    assert "changed: frames 0 to 419" in out


def test_of_says_which_path_a_clip_is_on(folder: File, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "a.csv").write_text("5,10\n5,30\n15,50\n")
    told = run(capsys, "follow jump.bvh --path a.csv --of a.csv -o same.bvh")
    assert told["measured"]["first"] is None
    assert told["of"]["points"] == [[5, 10], [5, 30], [15, 50]]


@pytest.mark.parametrize(
    ("line", "told"),
    [
        ("path jump.bvh -o p.txt", "a path is in a file .csv, .json, .svg, not '.txt'"),
        ("path jump.bvh -o none/p.csv", "there is no folder none"),
        ("path jump.bvh -o p.csv --points 1000", "a path of 1000 control points takes as many frames"),
        ("path jump.bvh -o p.csv --track rot", "Did you mean 'root'?"),
        ("path jump.bvh -o p.svg --degree 5 --points 8", "an .svg has curves up to degree 3, not 5"),
        ("path jump.bvh -o p.csv --picture p.jpg", "the extension of a picture is .png or .gif, not '.jpg'"),
        ("follow jump.bvh --path good.csv -o a.bvh --html a.png", "the extension of a page is .html, not '.png'"),
        ("follow jump.bvh --path none.csv -o a.bvh", "none.csv: no such file"),
        ("follow jump.bvh --path bad.csv -o a.bvh", "bad.csv:2: column 2: a number expected, 'x' found"),
        ("follow jump.bvh --path good.csv -o jump.bvh", "is the file that is read"),
        ("follow jump.bvh --path good.csv -o a.bvh --at-end cicle", "Did you mean 'cycle'?"),
        ("follow jump.bvh --path good.csv -o a.bvh --mode span", "mode span takes a path that is an edit"),
        ("follow jump.bvh -o a.bvh", "--path"),
    ],
)
def test_what_is_wrong_is_one_line(line: str, told: str, folder: File, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "bad.csv").write_text("1,2\n3,x\n")
    (folder / "good.csv").write_text("1,2\n3,4\n3,9\n")
    assert told in refused(capsys, *line.split())
    assert not (folder / "a.bvh").exists()
    assert not (folder / "p.csv").exists()
