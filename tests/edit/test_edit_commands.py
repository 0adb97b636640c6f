"""The commands that change clips, file to file."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from commands import refused, run
from turning import apart

import mocurve as mc
from mocurve import cli
from mocurve.edit import VERBS


@pytest.fixture
def files(jump: Path, tmp_path: Path) -> Path:
    """A folder with two pieces of the shipped capture, a.npz and b.npz, and keys of the first, a.curves.json."""
    motion = mc.read(jump)
    mc.write(tmp_path / "a.npz", motion[:120])
    mc.write(tmp_path / "b.npz", motion[200:320])
    mc.write(tmp_path / "a.curves.json", mc.reduce(motion[:120], tolerance="3deg"))
    return tmp_path


def test_blend_writes_what_the_verb_makes_and_tells_its_numbers(
    files: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    a, b, out = files / "a.npz", files / "b.npz", files / "out.npz"
    told = run(capsys, "blend", a, b, "-o", out, "--weight", "0.3")
    assert (told["verb"], told["weight"], told["frames"], told["kind"]) == ("blend", 0.3, 120, "Motion")
    made = mc.blend(mc.read(a), mc.read(b), 0.3)
    assert apart(mc.read(out), made) < 1e-12
    assert mc.read(out).history[-1]["weight"] == 0.3
    assert told["from_first"]["turned"]["by"] > 1
    told = run(capsys, "blend", a, b, "-o", out, "--weight", "0:0", "--weight", "0.9:1", "--weight", "*Arm=0")
    assert told["weight"] == ["0.0:0.0,0.9:1.0", "*Arm=0.0"]
    run(capsys, "blend", a, b, a, "-o", out, "--weights", "1,2,1")
    assert apart(mc.read(out), mc.blend(mc.read(a), mc.read(b), 0.5)) < 1e-9


def test_a_displacement_goes_through_files(files: Path, capsys: pytest.CaptureFixture[str]) -> None:
    a, b, by, half, out = (files / name for name in ("a.npz", "b.npz", "by.npz", "half.npz", "out.npz"))
    told = run(capsys, "difference", a, b, "-o", by)
    run(capsys, "add", by, b, "-o", out)
    assert apart(mc.read(out), mc.read(a)) < 1e-9
    scaled = run(capsys, "scale", by, "-o", half, "--factor", "0.5")
    assert 0 < scaled["largest"]["turned"]["by"] < told["largest"]["turned"]["by"]
    run(capsys, "scale", by, "-o", half, "--factor=-1")


def test_warp_reads_times_and_values(files: Path, capsys: pytest.CaptureFixture[str]) -> None:
    a, out = files / "a.npz", files / "out.npz"
    words = ["--at", "0.5", "LeftArm.Zrotation=30", "Hips.Yposition=-2.5", "--at", "0.7", "LeftArm.Zrotation=-20"]
    told = run(capsys, "warp", a, "-o", out, *words, "--support", "0.2", "--no-overshoot")
    made = mc.read(out)
    left, hips = made.skeleton.channel("LeftArm.Zrotation"), made.skeleton.channel("Hips.Yposition")
    assert [made.values[60, left], made.values[60, hips], made.values[84, left]] == [30.0, -2.5, -20.0]
    assert told["overshoot"] is False
    assert [(row["channel"], row["time"], row["after"]) for row in told["met"]] == [
        ("LeftArm.Zrotation", 0.5, 30.0),
        ("LeftArm.Zrotation", 0.7, -20.0),
        ("Hips.Yposition", 0.5, -2.5),
    ]
    keys = files / "out.curves.json"
    told = run(capsys, "warp", files / "a.curves.json", "-o", keys, "--at", "0.5", "LeftArm.Zrotation=30")
    assert told["kind"] == "KeyedMotion"
    assert mc.read(keys).curves[left].at(np.array([0.5]))[0] == pytest.approx(30, abs=1e-9)


def test_warp_takes_a_moment_of_another_clip_as_a_pose(files: Path, capsys: pytest.CaptureFixture[str]) -> None:
    a, b, out = files / "a.npz", files / "b.npz", files / "out.npz"
    run(capsys, "warp", a, "-o", out, "--at", "0.5", "--pose", b, "--pose-at", "0.25")
    assert apart(mc.read(out)[60:61], mc.read(b)[30:31]) < 1e-9


def test_retime_moves_moments_and_tells_speeds(files: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = files / "out.npz"
    told = run(capsys, "retime", files / "a.npz", "-o", out, "--map", "0.5:0.6", "--map", "0.75:0.8")
    assert apart(mc.read(out)[72:73], mc.read(files / "a.npz")[60:61]) < 1e-9
    assert told["map"][:3] == [[0.0, 0.0], [0.5, 0.6], [0.75, 0.8]]
    assert run(capsys, "retime", files / "a.npz", "-o", out, "--map", "0.5:0.6", "0.75:0.8")["map"] == told["map"]
    assert told["speed"]["least"] < 0.9 < 1.1 < told["speed"]["greatest"]


def test_without_json_it_is_told_in_words(files: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = files / "out.npz"
    assert cli.main(["warp", str(files / "a.npz"), "-o", str(out), "--at", "0.5", "LeftArm.Zrotation=30"]) == 0
    told = capsys.readouterr().out.splitlines()
    assert told[0] == "Motion 120 frames, 0.99 s, 31 joints, 96 channels"
    assert told[1].startswith("LeftArm.Zrotation at 0.5 s: ")
    assert told[1].endswith(" -> 30")
    assert told[-1] == f"wrote {out}"


def test_wrong_words_are_one_line_and_write_nothing(files: Path, capsys: pytest.CaptureFixture[str]) -> None:
    a, b, out = files / "a.npz", files / "b.npz", files / "out.npz"
    for words, text in [
        (["blend", a, b, a, "-o", out], "several with --weights, a number for each"),
        (["blend", a, b, "-o", out, "--weights", "1,2", "--weight", "0.5"], "two clips are blended with --weight"),
        (["blend", a, b, "-o", out, "--weights", "1,x"], "weights are numbers, one for each clip, like 1,1,2; not 'x'"),
        (["blend", a, b, "-o", a], "is the file that is read"),
        (["blend", a, b, "-o", out, "--weight", "x"], "a weight is a number"),
        (["warp", a, "-o", out, "--at", "LeftArm.Zrotation=3"], "--at takes a time first"),
        (["warp", a, "-o", out, "--at", "soon"], "--at takes a time, then CHANNEL=VALUE"),
        (["warp", a, "-o", out, "--at", "0.5", "Hips.Yposition=1", "Hips.Yposition=2"], "two values of Hips.Yposition"),
        (["warp", a, "-o", out, "--at", "0.5", "--pose", b], "--pose-at says which moment is the pose"),
        (["warp", a, "-o", out, "--at", "0.5", "--pose", b, "--pose-at", "7"], "lies outside of"),
        (["retime", a, "-o", out, "--map", "0.5:0.6", "--map", "0.6:0.5"], "time cannot stand or run backwards"),
        (["difference", a, b, "-o", files / "out.walk"], "no format known"),
    ]:
        assert text in refused(capsys, *words), words
        assert not out.exists()


def test_the_table_of_verbs_leads_to_functions_that_are_public() -> None:
    from importlib import import_module

    for name, module in VERBS.items():
        assert getattr(import_module(f"mocurve.edit.{module}"), name) is getattr(mc, name)
