"""bands, waveshape and limit on the command line."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import mocurve as mc
from mocurve import cli

ARM = "LeftArm.Zrotation"


@pytest.fixture
def files(jump: Path, tmp_path: Path) -> Path:
    motion = mc.read(jump)
    mc.write(tmp_path / "a.npz", motion[:120])
    mc.write(tmp_path / "a.curves.json", mc.reduce(motion[:120], tolerance="3deg"))
    return tmp_path


def run(capsys: pytest.CaptureFixture[str], *words: str | Path) -> dict:
    """What a command tells with --json, and nothing else."""
    assert cli.main([*(str(word) for word in words), "--json"]) == 0
    return json.loads(capsys.readouterr().out)


def said(capsys: pytest.CaptureFixture[str], *words: str | Path) -> list[str]:
    assert cli.main([str(word) for word in words]) == 0
    return capsys.readouterr().out.splitlines()


def test_bands_are_told_without_an_output_and_then_chosen(files: Path, capsys: pytest.CaptureFixture[str]) -> None:
    a, out = files / "a.npz", files / "out.npz"
    lines = said(capsys, "bands", a)
    assert len([line for line in lines if line.endswith("gain 1")]) == 6
    assert "21.8 to 60     Hz" in lines[2]
    assert lines[-1] == "changed: nothing"
    told = run(capsys, "bands", a)
    assert told["bands"][0].keys() == {"band", "from_hertz", "to_hertz", "degrees", "units", "gain"}
    told = run(capsys, "bands", a, "-o", out, "--gains", "0=0", "3Hz=1.5", "--only", "*Arm")
    assert [row["gain"] for row in told["bands"]] == [0, 1, 1, 1.5, 1, 1]
    made = mc.bands(mc.read(a), {0: 0, 3: 1.5}, only="*Arm")
    assert mc.read(out).values.tobytes() == made.values.tobytes()
    assert run(capsys, "bands", a, "-o", out, "--gains", "0,1,1,1.5", "--only", "*Arm")["bands"] == told["bands"]


def test_waveshape_takes_limits_and_pairs(files: Path, capsys: pytest.CaptureFixture[str]) -> None:
    a, out = files / "a.npz", files / "out.npz"
    words = ["--soft", f"{ARM}=:-78", "--map", "Hips.Yposition=15:15.5,17:17,20:18"]
    told = run(capsys, "waveshape", a, "-o", out, *words, "--margin", "1")
    assert [row["channel"] for row in told["channels"]] == ["Hips.Yposition", ARM]
    assert told["channels"][1]["after"][1] <= -78
    made = mc.waveshape(mc.read(a), {ARM: (None, -78)}, {"Hips.Yposition": [(15, 15.5), (17, 17), (20, 18)]}, margin=1)
    assert mc.read(out).values.tobytes() == made.values.tobytes()
    assert f"{ARM}: " in said(capsys, "waveshape", a, "-o", out, *words, "--margin", "1")[2]


def test_limit_works_with_no_option(files: Path, capsys: pytest.CaptureFixture[str]) -> None:
    a, out = files / "a.npz", files / "out.npz"
    lines = said(capsys, "limit", a, "-o", out)
    assert lines[1] == "limits: ranges of people (AAOS 1965, and 15 degrees more)"
    assert lines[2].startswith("within: LeftLeg.flexion (0 to 150), ")
    assert lines[3] == "0 frames changed; largest violation 0, now 0"
    told = run(capsys, "limit", a, "-o", out)
    assert len(told["measured"]["angles"]) == 12
    assert mc.read(out).values.tobytes() == mc.read(a).values.tobytes()


def test_limit_takes_channels_and_angles(files: Path, capsys: pytest.CaptureFixture[str]) -> None:
    keys, out = files / "a.curves.json", files / "out.curves.json"
    values = mc.read(keys).sample().values[:, mc.read(keys).skeleton.channel(ARM)]
    high = float(np.median(values))
    told = run(capsys, "limit", keys, "-o", out, "--limit", f"{ARM}=:{high}")
    assert told["kind"] == "KeyedMotion"
    assert told["measured"]["after"] <= 1e-6 < told["measured"]["before"]
    npz = files / "out.npz"
    words = ["--limit", f"{ARM}=-90:45", "--limit", "*Leg.flexion=25:", "--only", "*Leg"]
    lines = said(capsys, "limit", files / "a.npz", "-o", npz, *words)
    assert any(line.startswith("LeftLeg.flexion (25 and more): beyond by ") for line in lines)
    assert not any(ARM in line for line in lines)


def test_wrong_words_are_one_line_and_write_nothing(files: Path, capsys: pytest.CaptureFixture[str]) -> None:
    a, out = files / "a.npz", files / "out.npz"
    for words, text in [
        (["bands", a, "-o", out, "--gains", "9=0"], "there is no band 9: a clip of 120 frames has bands 0 to 5"),
        (["bands", a, "-o", a], "is the file that is read"),
        (["waveshape", a, "-o", out, "--soft", "5:9"], "a soft limit is NAME=LOW:HIGH"),
        (["waveshape", a, "-o", out], "waveshape takes --soft NAME=LOW:HIGH or --map"),
        (["waveshape", a, "-o", out, "--map", f"{ARM}=0:1"], "a map has two pairs or more"),
        (["limit", a, "-o", out, "--limit", f"{ARM}=9:5"], "a limit is LOW:HIGH, the lower first"),
        (["limit", a, "-o", out, "--limit", "LeftArm=5:9"], "no channel or angle 'LeftArm'. Did you mean 'LeftArm."),
        (["limit", a, "-o", out, "--only", "Hips"], "none of the joints that Hips names has limits here"),
    ]:
        assert cli.main([str(word) for word in words]) == cli.REFUSED
        printed, err = capsys.readouterr()
        assert printed == ""
        assert err.count("\n") == 1
        assert text in err, words
        assert not out.exists()
