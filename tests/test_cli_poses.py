"""`mocurve poses`, and whole poses by `mocurve reduce`: what they print, draw and refuse."""

from __future__ import annotations

import csv
import json
import shutil
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import mocurve as mc
from mocurve import OptionError, cli
from mocurve.reduction import CHOOSERS


@pytest.fixture
def short(jump: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with 60 frames of the capture, short.bvh; it is the working folder."""
    monkeypatch.chdir(tmp_path)
    shutil.copy(jump, "jump.bvh")
    mc.write("short.bvh", mc.read("jump.bvh")[100:160])
    return tmp_path


@pytest.mark.parametrize("method", ["optimal", *CHOOSERS])
def test_reduce_makes_so_many_poses_and_tells_their_frames(
    short: Path, capsys: pytest.CaptureFixture[str], method: str
) -> None:
    words = ["reduce", "short.bvh", "-o", "out.curves.json", "--method", method, "--align", "pose", "--keys", "8"]
    assert cli.main([*words, "--pin", "20", "0.25s", "--quality", "fast", "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert len(told["key_frames"]) == 8
    assert {0, 20, 30, 59} <= set(told["key_frames"])
    made = mc.read("out.curves.json")
    assert isinstance(made, mc.KeyedMotion)
    assert made.keys == 8 * len(made.curves)
    assert made.history[-1]["pin"] == ["20", "0.25s"]


def test_poses_draws_a_sheet_and_tells_the_frames(short: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["poses", "short.bvh", "--keys", "12", "--sheet", "out.png", "--quality", "fast", "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert (told["keys"], len(told["key_frames"]), told["method"]) == (12, 12, "optimal")
    with Image.open("out.png") as image:
        assert image.width == 1200
        assert image.height > 400  # two lines of six
        assert len(image.convert("RGB").resize((60, 60)).getcolors(3600)) > 20


def test_without_a_number_every_number_is_told(short: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["poses", "short.bvh", "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["keys"] == list(range(2, 61))
    assert (np.diff(told["errors"]) <= 0).all()
    assert cli.main(["poses", "short.bvh", "--method", "probe"]) == 0
    text = capsys.readouterr().out
    assert text.startswith("probe: largest part of a posture that no combination of the keys makes")
    assert text.splitlines()[2].split()[0] == "2"
    assert text.splitlines()[-1].split()[0] == "60"


def test_the_plot_has_all_methods(short: Path) -> None:
    assert cli.main(["poses", "short.bvh", "--plot", "errors.png", "--quality", "fast"]) == 0
    with Image.open("errors.png") as image:
        colours = {colour for _, colour in image.getcolors(1 << 20)}  # type: ignore[union-attr]
    for name in ("d1495b", "1b497d", "e8a33d", "0c6e5c", "7b5ea7", "9aa5b1", "3aa6b9"):
        assert tuple(bytes.fromhex(name)) in colours


def test_the_weights_are_written_a_row_a_frame(short: Path) -> None:
    words = ["poses", "short.bvh", "--keys", "9", "--method", "probe", "--weights", "w.csv", "--quality", "fast"]
    assert cli.main(words) == 0
    with Path("w.csv").open() as file:
        rows = list(csv.reader(file))
    found = mc.poses(mc.read("short.bvh"), method="probe")
    assert rows[0] == ["frame", *map(str, found.frames(9))]
    np.testing.assert_allclose(np.array(rows[1:], float)[:, 1:], found.weights(9), atol=1e-5)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--sheet", "out.png"], "a sheet and weights are of some poses: say how many with --keys"),
        (["--keys", "1"], "keys stand on the first and the last frame: at least 2 are needed, not 1"),
        (["--keys", "5", "--method", "salent"], "no method 'salent'. Did you mean 'salient'?"),
        (["--method", "optimal"], "no method 'optimal'. There is: salient, broken, posture, probe, cluster"),
        (["--keys", "5", "--pin", "60"], "the pin '60' lies outside the clip, whose last frame is 59"),
        (["--keys", "5", "--sheet", "out.jpg"], "out.jpg: the extension of this picture is .png, not '.jpg'"),
        (["--plot", "out.svg"], "out.svg: the extension of this picture is .png, not '.svg'"),
        (["--keys", "5", "--sheet", "gone/out.png"], "gone/out.png: there is no folder gone"),
    ],
)
def test_what_cannot_be_is_one_line(
    short: Path, capsys: pytest.CaptureFixture[str], words: list[str], message: str
) -> None:
    assert cli.main(["poses", "short.bvh", *words]) == cli.REFUSED
    told = capsys.readouterr()
    assert told.err.startswith(f"mocurve: {message}")
    assert (told.err.count("\n"), told.out) == (1, "")
    assert not list(short.glob("out.*"))


def test_a_sheet_shows_frames_that_are_there(short: Path) -> None:
    clip = mc.read("short.bvh")
    mc.sheet(clip, "one.png", [7], width=300)
    with Image.open("one.png") as image:
        assert image.width == 300
    with pytest.raises(OptionError, match="there is no frame 60: the clip has frames 0 to 59"):
        mc.sheet(clip, "two.png", [0, 60])
    with pytest.raises(OptionError, match=r"two.jpg: the extension of a sheet is .png, not '.jpg'"):
        mc.sheet(clip, "two.jpg", [0])
    with pytest.raises(OptionError, match="a sheet shows 1 to 600 poses, not 0"):
        mc.sheet(clip, "two.png", [])
    with pytest.raises(OptionError, match="the clip has no frames to draw"):
        mc.sheet(clip[:0], "two.png", [0])
    assert not Path("two.png").exists()
