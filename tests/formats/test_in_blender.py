"""What Blender makes of the files: scripts, BVH, glTF and FBX, looked at by Blender itself.

MOCURVE_BPY names a Python that has Blender as a module (`pip install bpy`, 4.5 or later); without one these tests skip.
All jobs are done by one run of in_blender.py.
"""

from __future__ import annotations

import importlib.util
import json
import os
import subprocess
import sys
import warnings
from pathlib import Path

import numpy as np
import pytest

import mocurve as mc
from mocurve import rotation
from mocurve.formats._blender_maths import bone_names
from mocurve.kinematics import rotations, world

CLIPS = [
    "cmu/cmu_12_01_walk.bvh",
    "cmu/cmu_02_03_run.bvh",
    "cmu/cmu_walk_daz19.bvh",
    "cmu/cmu_135_04_martial_daz.bvh",
    "other/mixed_rotation_orders.bvh",
    "other/hands_60_joints.bvh",
    "other/rokoko_dance_fingers.bvh",
    "awkward/euler_beyond_360.bvh",
    "awkward/frame_time_ntsc_long.bvh",
    "awkward/frames_0.bvh",
    "awkward/gimbal_lock_x90.bvh",
    "awkward/joint_2_channels.bvh",
    "awkward/joint_position_and_1_rotation.bvh",
    "awkward/leaf_joint_without_end_site.bvh",
    "awkward/names_duplicate.bvh",
    "awkward/names_unicode.bvh",
    "awkward/root_rotation_before_position.bvh",
    "awkward/six_channels_every_joint.bvh",
    "awkward/two_roots.bvh",
    "awkward/zero_length_bones.bvh",
]
FRAMES = 120  # of the longer clips
LIMIT = 1e-3  # degrees, and units of the clip
IMPORTED = [("bvh", None), ("glb", "baked"), ("fbx", "baked")]


@pytest.fixture(scope="module")
def blender() -> str:
    """A Python that has bpy."""
    python = os.environ.get("MOCURVE_BPY") or (sys.executable if importlib.util.find_spec("bpy") else None)
    if not python:
        pytest.skip("no Blender: set MOCURVE_BPY to a Python that has bpy")
    return python


def run(blender: str, folder: Path, jobs: list[dict]) -> list[dict]:
    """The answers to jobs for in_blender.py."""
    (folder / "jobs.json").write_text(json.dumps(jobs), "utf-8")
    script = Path(__file__).with_name("in_blender.py")
    done = subprocess.run([blender, script, folder / "jobs.json"], capture_output=True, text=True, check=False)
    assert not done.returncode, done.stderr
    answers = json.loads((folder / "jobs.answers.json").read_text("utf-8"))
    assert not [answer["error"] for answer in answers if "error" in answer]
    return answers


def matrices(wxyz: np.ndarray) -> np.ndarray:
    """Rotation matrices (..., 3, 3)."""
    return np.stack([rotation.rotate(wxyz, np.broadcast_to(axis, (*wxyz.shape[:-1], 3))) for axis in np.eye(3)], -1)


def say(clip: mc.Clip, path: Path, step: float = 0.5) -> dict:
    """Write where the joints of the clip are every `step` frames, for in_blender.py to compare."""
    seen = clip.sample(clip.frame_time * step) if clip.frames > 1 else clip.sample()
    turns = rotations(seen)
    for joint, parent in enumerate(seen.skeleton.parents):
        if parent >= 0:
            turns[:, joint] = rotation.mul(turns[:, parent], turns[:, joint])
    real = ~seen.skeleton.end_sites
    frames = np.arange(seen.frames) * step
    np.savez(path, frames=frames, turns=matrices(turns[:, real]), places=world(seen)[:, real])
    names = [name for name, end in zip(seen.skeleton.names, seen.skeleton.end_sites, strict=True) if not end]
    return {"reference": str(path), "bones": bone_names(names)}


def keyed(motion: mc.Motion) -> mc.KeyedMotion:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # units that are guessed
        return mc.reduce(motion, tolerance="0.3deg")


@pytest.fixture(scope="module")
def native(blender, clips, tmp_path_factory) -> dict[tuple[str, str], tuple[mc.Clip, dict]]:
    """Of each clip and profile what was written and what Blender says of it."""
    folder = tmp_path_factory.mktemp("native")
    jobs, labels, written = [], [], []
    for name in CLIPS:
        motion = mc.read(clips / name)[-FRAMES:]
        keys = keyed(motion)
        for profile in ("euler", "quaternion", "samples"):
            clip = mc.unroll(motion[:20]) if profile == "samples" else keys
            script = folder / f"{len(jobs)}.blend.py"
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                mc.write(script, clip, profile="euler" if profile == "samples" else profile)
            jobs.append({"do": "native", "script": str(script), **say(clip, script.with_suffix(".npz"))})
            labels.append((name, profile))
            written.append(clip)
    answers = run(blender, folder, jobs)
    return {
        label: (clip, {**job, **answer}) for label, clip, job, answer in zip(labels, written, jobs, answers, strict=True)
    }


@pytest.mark.parametrize("profile", ["euler", "quaternion", "samples"])
@pytest.mark.parametrize("name", CLIPS)
def test_the_action_is_the_clip_at_every_frame_and_half_frame(native, name, profile):
    clip, answer = native[name, profile]
    assert answer["bones"] == int((~clip.skeleton.end_sites).sum())
    assert answer["degrees"] <= LIMIT
    assert answer["units"] <= LIMIT
    assert answer["fps"] == pytest.approx(1 / clip.frame_time, rel=1e-6)
    assert answer["range"] == ([0, clip.frames - 1] if clip.frames else [1, 250])


@pytest.mark.parametrize("name", CLIPS)
def test_euler_keys_are_the_clips_own(native, name):
    keys, answer = native[name, "euler"]
    assert answer["keys"] == keys.keys
    assert set(answer["kinds"]) <= {"BEZIER"}
    assert set(native[name, "samples"][1]["kinds"]) <= {"LINEAR"}
    assert set(native[name, "quaternion"][1]["modes"]) == {"QUATERNION"}


@pytest.mark.parametrize("profile", ["euler", "quaternion", "samples"])
@pytest.mark.parametrize("name", CLIPS)
def test_what_nobody_edited_comes_back_to_the_last_bit(native, name, profile):
    clip, answer = native[name, profile]
    script = Path(answer["script"])
    back = mc.read(f"{script}.curves.json")
    assert mc.read(script).sample().values.tobytes() == clip.sample().values.tobytes()
    mc.write(script.with_suffix(".curves.json"), back)
    text = script.with_suffix(".curves.json").read_text()
    assert text in script.read_text()


def test_the_figure_stands_upright_in_metres(native):
    clip, answer = native["cmu/cmu_12_01_walk.bvh", "euler"]
    last = world(clip.sample())[-1, ~clip.skeleton.end_sites]
    assert np.array(answer["world"]) == pytest.approx(last[:, [0, 2, 1]] * [1, -1, 1] * 0.056444, abs=1e-4)
