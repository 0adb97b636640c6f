"""`mocurve clean` as a person meets it."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import mocurve
from mocurve import cli

SPIKE, FIRST, LAST = 40, 60, 67


@pytest.fixture
def noisy(jump: Path, tmp_path: Path) -> Path:
    """150 frames of the shipped capture that shake by 0.3 degrees, with a spike and a run that is off."""
    motion = mocurve.read(jump)[:150]
    values = np.array(motion.values)
    turns = motion.skeleton.rotation_channels & (np.ptp(values, axis=0) > 0)
    values[:, turns] += np.random.default_rng(4).normal(0, 0.3, (len(values), turns.sum()))
    values[SPIKE, motion.skeleton.channel("LeftLeg.Xrotation")] += 25
    values[FIRST : LAST + 1, motion.skeleton.channel("RightForeArm.Zrotation")] += 30
    path = tmp_path / "noisy.bvh"
    mocurve.write(path, replace(motion, values=values))
    return path


def run(*arguments: str | Path) -> int:
    return cli.main(["clean", *(str(a) for a in arguments)])


def error(path: Path, jump: Path) -> float:
    """RMS degrees that the middle one of the moving channels is away from the capture."""
    rows = mocurve.compare(mocurve.read(jump)[:150], mocurve.read(path)).channels
    return float(np.median([row.rms for row in rows if row.unit == "degrees" and row.rms > 1e-4]))


def test_it_writes_the_clean_clip_and_tells_what_it_found(
    noisy: Path, jump: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    target = noisy.with_name("clean.bvh")
    assert run(noisy, "-o", target) == 0
    out, err = capsys.readouterr()
    assert error(target, jump) < 0.7 * error(noisy, jump)
    assert " degrees (median of " in out
    assert ["RightForeArm", "Zrotation", "run", f"{FIRST}-{LAST}"] in [line.split()[:4] for line in out.splitlines()]
    assert f"wrote {target}" in out
    assert err == ""


def test_without_an_output_it_only_tells(noisy: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(noisy) == 0
    assert capsys.readouterr().out.startswith("noise ")
    assert list(noisy.parent.iterdir()) == [noisy]


def test_json_is_one_object_with_all_findings(noisy: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(noisy, "--json", "--only", "LeftLeg.*", "--only", "Hips.Yposition") == 0
    told = json.loads(capsys.readouterr().out)["noise"]
    assert {row["name"].split(".")[0] for row in told["channels"]} == {"LeftLeg", "Hips"}
    assert {row["unit"] for row in told["channels"] if row["name"] == "Hips.Yposition"} == {"units"}
    assert [row["first"] for row in told["artefacts"] if row["kind"] == "spike"] == [SPIKE]


def test_marked_artefacts_are_kept(noisy: Path) -> None:
    kept, cleaned = noisy.with_name("kept.npz"), noisy.with_name("cleaned.npz")
    assert run(noisy, "-o", kept, "--mark") == run(noisy, "-o", cleaned) == 0
    before, marked, filled = (mocurve.read(path) for path in (noisy, kept, cleaned))
    channel = before.skeleton.channel("LeftLeg.Xrotation")
    assert marked.values[SPIKE, channel] == before.values[SPIKE, channel]
    assert abs(filled.values[SPIKE, channel] - before.values[SPIKE, channel]) > 20


def test_strength_and_limit_take_more_out(noisy: Path) -> None:
    rough = {}
    for name, options in {"usual": [], "strong": ["--strength", "3"], "limit": ["--limit", "2"]}.items():
        target = noisy.with_name(f"{name}.npz")
        assert run(noisy, "-o", target, *options) == 0
        rough[name] = float(np.abs(np.diff(mocurve.read(target).values, 3, axis=0)).mean())
    assert rough["strong"] < rough["usual"]
    assert rough["limit"] < 0.5 * rough["usual"]


@pytest.mark.parametrize("extension", [".bvh", ".csv", ".npz", ".glb"])
def test_it_writes_formats_that_take_samples(noisy: Path, extension: str) -> None:
    target = noisy.with_name("clean" + extension)
    assert run(noisy, "-o", target, "--only", "Hips") == 0
    assert target.stat().st_size > 0


def test_the_page_is_written(noisy: Path, capsys: pytest.CaptureFixture[str]) -> None:
    page = noisy.with_name("clean.html")
    assert run(noisy, "--html", page) == 0
    assert f"wrote {page}" in capsys.readouterr().out
    assert '"kind": "spike"' in page.read_text(encoding="utf-8")


def test_its_progress_is_told(noisy: Path) -> None:
    heard: list[tuple[str, int, int]] = []
    with mocurve.progress.listening(lambda *step: heard.append(step)):
        mocurve.denoise(mocurve.read(noisy))
    assert heard[-1][0] == "cleaning"
    assert heard[-1][1] == heard[-1][2]


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (["--strength", "0"], "strength is a number from"),
        (["--limit", "60"], "half the frame rate"),
        (["--only", "LeftHnd"], "Did you mean 'LeftHand'?"),
        (["-o", "clean.pdf"], "no format known"),
        (["--html", "gone/page.html"], "there is no folder gone"),
    ],
)
def test_a_wrong_option_is_one_line(
    arguments: list[str], told: str, noisy: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(noisy, *arguments) == cli.REFUSED
    out, err = capsys.readouterr()
    assert out == ""
    assert err.count("\n") == 1
    assert told in err


def test_the_input_is_never_written_over(noisy: Path, capsys: pytest.CaptureFixture[str]) -> None:
    before = noisy.read_bytes()
    assert run(noisy, "-o", noisy) == cli.REFUSED
    assert "is the file that is read" in capsys.readouterr().err
    assert noisy.read_bytes() == before
