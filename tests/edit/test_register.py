"""register: a known warp is found again, whatever kind of clip, wherever and on whichever body."""

from __future__ import annotations

import json
import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from walks import STEP, walk

import mocurve as mc
from mocurve import KeyedMotion, Mismatch, Motion, OptionError, UnknownName, cli
from mocurve.edit._poses import motion_of, moved, poses_of
from mocurve.edit.register import Registration
from mocurve.edit.retime import time_map
from mocurve.kinematics import world

WARP = [(0.5, 0.7), (1.5, 1.6), (2.2, 2.6)]


def measured(clip: mc.Clip) -> Registration:
    return Registration(**clip.history[-1]["measured"])


def frames_off(clip: Motion, found: Registration, warp: list[tuple[float, float]]) -> float:
    """The largest difference of the map that was found from the known one, in frames."""
    at = np.linspace(0.0, clip.duration, 300)
    pairs = [(old, new) for old, new in found.pairs]
    return float(np.abs(time_map(clip, pairs).at(at) - time_map(clip, warp).at(at)).max() / clip.frame_time)


# -- laws ----------------------------------------------------------------------------------------------
@pytest.mark.parametrize("place", [None, (2.0, 500.0, -30.0)])
def test_a_known_warp_is_found_within_a_frame(place: tuple[float, float, float] | None) -> None:
    clip = walk(200, 0.3)
    reference = mc.retime(clip, WARP)
    if place is not None:
        reference = motion_of(moved(poses_of(reference), clip.skeleton, np.array(place)), reference)
    found = measured(mc.register(clip, reference))
    assert frames_off(clip, found, WARP) < 1.0
    assert found.distance < 0.2 * found.even_distance
    assert 1.0 < found.slowest < 2.0
    assert 0.5 < found.fastest < 1.0


def test_the_clip_runs_with_the_reference_then() -> None:
    clip = walk(200)
    reference = mc.retime(clip, WARP)
    made = mc.register(clip, reference)
    assert made.frames == reference.frames
    assert np.linalg.norm(world(made) - world(reference), axis=-1).max() < 3.0  # cm
    assert np.linalg.norm(world(mc.retime(clip, [(clip.duration, reference.duration)])) - world(reference)).max() > 30


def test_a_clip_in_step_with_itself_stays() -> None:
    clip = walk(200)
    made = mc.register(clip, clip)
    np.testing.assert_allclose(made.values, clip.values, atol=1e-6)
    assert measured(made).cost == pytest.approx(0.0, abs=1e-4)


def test_keys_stay_keys() -> None:
    clip = walk(200)
    keys = mc.reduce(clip, tolerance="0.1deg")
    made = mc.register(keys, mc.retime(clip, WARP))
    assert isinstance(made, KeyedMotion)
    assert made.keys == keys.keys
    assert frames_off(clip, measured(made), WARP) < 1.0


def test_bodies_and_rates_may_differ_by_name() -> None:
    clip = walk(200)
    reference = mc.retime(clip, WARP).sample(STEP / 2)
    cut = replace(reference.skeleton, names=(*clip.skeleton.names[:5], "Skull"))
    with pytest.raises(Mismatch, match="'Head' in the first, 'Skull' in the second"):
        mc.register(clip, replace(reference, skeleton=cut))
    made = mc.register(clip, replace(reference, skeleton=cut), match="names")
    assert made.frame_time == clip.frame_time
    assert frames_off(clip, measured(made), WARP) < 1.0


def test_long_clips_are_matched_on_fewer_frames(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("mocurve.edit.register.MOST", 100)
    clip = walk(200)
    assert frames_off(clip, measured(mc.register(clip, mc.retime(clip, WARP))), WARP) < 2.0


def test_the_history_tells_one_step() -> None:
    first, second = (replace(walk(200), history=({"verb": verb},)) for verb in ("denoise", "reduce"))
    made = mc.register(first, second, band=0.2)
    told = json.loads(json.dumps(made.history))
    assert [step["verb"] for step in told] == ["denoise", "register"]
    assert (told[1]["slope"], told[1]["band"], told[1]["match"]) == (3, 0.2, "exact")
    assert told[1]["with"] == [{"verb": "reduce"}]


def test_a_t_pose_in_front_is_no_moment_of_its_own() -> None:
    clip = walk(200)
    posed = replace(walk(201), values=np.vstack([[[0, 90, 0] + [0.0] * 17], clip.values]))
    found = measured(mc.register(posed, posed.sample()))
    assert found.slowest == pytest.approx(1.0, abs=1e-6)
    assert frames_off(posed, measured(mc.register(posed, mc.retime(posed, WARP))), WARP) < 1.0


@pytest.mark.parametrize("name", ["12_01_walk", "01_01_jump", "94_01_dance_max"])
def test_a_known_warp_of_a_capture_is_found_within_a_frame(name: str, clips: Path) -> None:
    clip = mc.read(clips / "cmu" / f"cmu_{name}.bvh")[1:600]
    assert frames_off(clip, measured(mc.register(clip, mc.retime(clip, WARP))), WARP) < 1.0


def test_two_walks_come_nearer(clips: Path) -> None:
    first, second = (mc.read(clips / "cmu" / f"cmu_{name}.bvh") for name in ("02_01_walk_blender", "12_01_walk"))
    with warnings.catch_warnings(action="ignore"):  # other bones, and up to four times slower
        found = measured(mc.register(first, second[1:]))
    assert found.distance < found.even_distance


# -- refusals ------------------------------------------------------------------------------------------
@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"slope": 0}, "slope is a whole number"),
        ({"slope": 2.5}, "slope is a whole number"),
        ({"band": 0.0}, "band is a positive number"),
        ({"band": float("nan")}, "band is a positive number"),
        ({"band": 1e-9}, "do not match with a slope of 3 and a band of 1e-09 s"),
    ],
)
def test_options_are_refused(options: dict[str, float], words: str) -> None:
    with pytest.raises(OptionError, match=words):
        mc.register(walk(200), walk(150), **options)


def test_clips_of_very_different_length_are_refused() -> None:
    with pytest.raises(OptionError, match=r"clips of 3\.317 and 0\.15 s do not match"):
        mc.register(walk(200), walk(10))
    for frames in (0, 1):
        with pytest.raises(OptionError, match="fewer than two frames"):
            mc.register(walk(200), walk(frames))


def test_an_unknown_match_is_told_the_nearest() -> None:
    with pytest.raises(UnknownName, match="Did you mean 'names'"):
        mc.register(walk(20), walk(20), match="name")


# -- the command ---------------------------------------------------------------------------------------
def test_the_command_writes_the_clip_and_tells_its_numbers(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    clip = walk(200)
    paths = [str(tmp_path / f"{name}.bvh") for name in ("clip", "reference", "made")]
    mc.write(paths[0], clip)
    mc.write(paths[1], mc.retime(clip, WARP))
    assert cli.main(["register", *paths[:2], "-o", paths[2], "--json"]) == 0
    found = Registration(**json.loads(capsys.readouterr().out))
    assert frames_off(clip, found, WARP) < 1.0
    assert mc.read(paths[2]).frames == mc.read(paths[1]).frames
    assert cli.main(["register", *paths[:2], "-o", paths[2]]) == 0
    assert "times slower" in capsys.readouterr().out
