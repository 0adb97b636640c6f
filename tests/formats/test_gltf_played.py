"""What others make of the files: the Khronos validator finds nothing, and three.js plays what was written."""

from __future__ import annotations

from pathlib import Path
from typing import Any, NamedTuple

import node
import numpy as np
import pytest

import mocurve as mc
from mocurve import kinematics, rotation
from mocurve.reduction import slerp

CLIPS = {  # metres that a unit is
    "jump": 0.056444,  # the one that ships with the package
    "cmu/cmu_12_01_walk.bvh": 0.056444,
    "cmu/cmu_135_04_martial_daz.bvh": 0.01,
    "other/rokoko_dance_fingers.bvh": 0.01,
    "other/mixed_rotation_orders.bvh": 0.01,
    "other/hands_60_joints.bvh": 0.01,
}
FRAMES = 60
WAYS = ("baked", "cubic", "linear 1deg", "linear 4mm")


class File(NamedTuple):
    """A clip that was written, what the validator says of the file, and what three.js plays at frames and halves."""

    clip: mc.Motion | mc.KeyedMotion
    report: dict[str, Any]
    played: node.Played


@pytest.fixture(scope="module", params=CLIPS)
def files(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> dict[str, File]:
    """A clip in every profile."""
    node.require()
    shipped = request.param == "jump"
    source = request.getfixturevalue("jump") if shipped else request.getfixturevalue("clips") / request.param
    clip = mc.read(source, unit=CLIPS[request.param])[:FRAMES]
    keys = mc.reduce(clip, tolerance="4mm", quality="fast")
    written: list[tuple[mc.Motion | mc.KeyedMotion, Path]] = []
    for way in WAYS:
        profile, _, tolerance = way.partition(" ")
        given = keys if profile == "cubic" else clip
        path = tmp_path_factory.mktemp("gltf") / f"{way}.glb"
        mc.write(path, given, profile=profile, tolerance=tolerance or None)
        written.append((given, path))
    reports = node.validate([path for _, path in written])
    played = node.play([(path, None, halves(given)) for given, path in written])
    return {way: File(g, r, p) for way, (g, _), r, p in zip(WAYS, written, reports, played, strict=True)}


def halves(clip: mc.Motion | mc.KeyedMotion) -> np.ndarray:
    """Times of the frames and halfway between them: 2 F - 1."""
    return np.arange(2 * clip.frames - 1) * clip.frame_time / 2


def off(file: File, places: np.ndarray, wxyz: np.ndarray, every: slice = slice(None)) -> tuple[float, float]:
    """Degrees, and units of the clip, that three.js is off at most."""
    scale = file.clip.skeleton.unit
    away = np.linalg.norm(file.played.places[every] / scale - places, axis=2)
    return float(rotation.angle(file.played.wxyz[every], wxyz).max()), float(away.max())


@pytest.mark.parametrize("way", WAYS)
def test_the_validator_finds_nothing(files, way):
    report = files[way].report
    assert (report["errors"], report["warnings"], report["infos"]) == (0, 0, 0), report["messages"]


@pytest.mark.parametrize("way", WAYS)
def test_joints_are_bones_and_the_figure_hangs_on_them(files, way):
    clip, _, played = files[way]
    assert played.joints == list(clip.skeleton.names)
    assert played.bones == len(clip.skeleton.names)
    assert played.figures == 1
    assert played.animations == [way]


def test_three_plays_every_frame_that_was_baked(files):
    file = files["baked"]
    degrees, length = off(file, kinematics.world(file.clip), kinematics.rotations(file.clip), slice(None, None, 2))
    assert degrees < 1e-4
    assert length < 1e-3


def test_three_plays_the_curves_of_cubic_keys_at_frames_and_between(files):
    file = files["cubic"]
    meant = file.clip.sample(file.clip.frame_time / 2)
    degrees, length = off(file, kinematics.world(meant), kinematics.rotations(meant))
    assert degrees < 2e-3
    assert length < 1e-3


@pytest.mark.parametrize("tolerance", ["1deg", "4mm"])
def test_three_plays_linear_keys_within_the_tolerance_at_every_frame(files, tolerance):
    file = files[f"linear {tolerance}"]
    clip = file.clip
    degrees, length = off(file, kinematics.world(clip), kinematics.rotations(clip), slice(None, None, 2))
    if tolerance == "1deg":
        assert 0.1 < degrees <= 1
    else:
        assert 0.4 < 1000 * length * clip.skeleton.unit <= 4


def test_three_plays_what_the_linear_keys_say_also_between_frames(files):
    file = files["linear 1deg"]
    times = np.arange(2 * file.clip.frames - 1) / 2
    meant = np.tile([1.0, 0, 0, 0], (len(times), len(file.clip.skeleton.names), 1))
    for joint, track in enumerate(slerp.joint_keys(file.clip, "1deg").rotations):
        if track is not None and len(track.frames) > 1:
            first = np.clip(np.searchsorted(track.frames, times, side="right") - 1, 0, len(track.frames) - 2)
            u = (times - track.frames[first]) / np.diff(track.frames)[first]
            meant[:, joint] = rotation.slerp(track.values[first], track.values[first + 1], u)
        elif track is not None:
            meant[:, joint] = track.values
    assert rotation.angle(file.played.wxyz, meant).max() < 2e-3


def test_several_animations_and_text_files_are_played_too(tmp_path, jump):
    node.require()
    clip = mc.read(jump, unit="inch")
    paths = [tmp_path / "a.glb", tmp_path / "a.gltf", tmp_path / "bare.glb"]
    parts = {"First": clip[:9], "Second": clip[50:90]}
    mc.write(paths[0], parts, profile="baked")
    mc.write(paths[1], parts, profile="baked")
    mc.write(paths[2], parts, profile="baked", mesh=False)
    for report in node.validate(paths):
        assert (report["errors"], report["warnings"]) == (0, 0), report["messages"]
    times = np.arange(40) * clip.frame_time
    for played in node.play([(path, "Second", times) for path in paths]):
        assert played.animations == ["First", "Second"]
        assert played.bones == len(clip.skeleton.names)
        assert played.places / 0.0254 == pytest.approx(kinematics.world(parts["Second"]), abs=1e-3)


@pytest.mark.filterwarnings("ignore")  # each of these is odd in its own way, and told so
def test_clips_with_the_oddities_of_real_files_are_played_as_they_are(tmp_path, clips):
    node.require()
    odd = [mc.read(path, unit=1.0) for path in sorted((clips / "awkward").glob("*.bvh"))]
    odd = [clip for clip in odd if clip.frames and clip.skeleton.names]
    paths = [tmp_path / f"{number}.glb" for number in range(len(odd))]
    for path, clip in zip(paths, odd, strict=True):
        mc.write(path, clip, profile="baked")
    reports = node.validate(paths)
    played = node.play([(path, None, halves(clip)[::2]) for path, clip in zip(paths, odd, strict=True)])
    for clip, report, shown in zip(odd, reports, played, strict=True):
        assert (report["errors"], report["warnings"]) == (0, 0), report["messages"]
        degrees, length = off(File(clip, report, shown), kinematics.world(clip), kinematics.rotations(clip))
        assert degrees < 1e-3
        assert length < 1e-5 * max(np.abs(kinematics.world(clip)).max(), 1.0)
