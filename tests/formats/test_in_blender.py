"""What Blender makes of the files: scripts, BVH, glTF and FBX, looked at by Blender itself.

MOCURVE_BPY names a Python that has Blender as a module (`pip install bpy`, 4.5 or later); without one these tests skip.
All jobs are done by one run of in_blender.py.
"""

from __future__ import annotations

import warnings
from pathlib import Path

import numpy as np
import pytest
from blender_jobs import blender_python, run, say

import mocurve as mc
from mocurve.kinematics import world

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
FRAMES = 80  # of the longer clips
LIMIT = 1e-3  # degrees, and units of the clip
IMPORTED = [("bvh", None), ("glb", "baked"), ("fbx", "baked")]


@pytest.fixture(scope="module")
def blender() -> str:
    return blender_python()


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
        label: (clip, {**job, **answer})
        for label, clip, job, answer in zip(labels, written, jobs, answers, strict=True)
    }


@pytest.mark.parametrize("profile", ["euler", "quaternion", "samples"])
@pytest.mark.parametrize("name", CLIPS)
def test_the_action_is_the_clip_at_every_frame_and_half_frame(native, name, profile):
    clip, answer = native[name, profile]
    assert answer["compared"] == int((~clip.skeleton.end_sites).sum())
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


# -- other formats, through Blender's own importers ------------------------------------------------------
UNREADABLE = {  # Blender's reader of BVH wants three rotations, that of FBX connects bones that touch
    "bvh": ["joint_2_channels"],
    "glb": [],
    "fbx": ["six_channels_every_joint"],
}
ODD = ["joint_2_channels", "names_unicode", "six_channels_every_joint", "two_roots", "zero_length_bones"]
FILES = [
    (name, extension, profile)
    for name in [*CLIPS[:7], *(f"awkward/{stem}.bvh" for stem in ODD)]
    for extension, profile in IMPORTED
    if Path(name).stem not in UNREADABLE[extension]
]


@pytest.fixture(scope="module")
def imported(blender, clips, tmp_path_factory) -> dict[tuple[str, str], dict]:
    """What Blender's importers make of samples, and of cubic glTF."""
    folder = tmp_path_factory.mktemp("imported")
    jobs, labels = [], []
    for name, extension, profile in [*FILES, (CLIPS[1], "glb", "cubic")]:
        motion = mc.unroll(mc.read(clips / name, unit=0.01)[-40:])
        clip = keyed(motion) if profile == "cubic" else motion
        file = folder / f"{len(jobs)}.{extension}"
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            mc.write(file, clip, profile=profile)
        fps = round(1 / motion.frame_time)
        job = {"do": "imported", "format": extension, "file": str(file), "fps": [fps, fps * motion.frame_time]}
        job["metres"] = 1.0 if extension == "bvh" else 0.01
        jobs.append({**job, **say(clip, file.with_suffix(".npz"), step=1.0)})
        labels.append((name, extension) if profile != "cubic" else (name, "cubic"))
    return {
        label: {**job, **answer} for label, job, answer in zip(labels, jobs, run(blender, folder, jobs), strict=True)
    }


@pytest.mark.parametrize(("name", "extension"), [file[:2] for file in FILES])
def test_blender_imports_samples_as_they_are(imported, name, extension):
    answer = imported[name, extension]
    assert len(answer["bones"]) == answer["compared"]
    assert answer["degrees"] <= LIMIT
    assert answer["units"] <= LIMIT


def test_blender_still_drops_the_tangents_of_cubic_gltf(imported):
    assert imported[CLIPS[1], "cubic"]["degrees"] > 0.1, "cubic could be Blender's default now"


# -- armatures that were there before ---------------------------------------------------------------------
RIGS = [
    ("cmu/cmu_12_01_walk.bvh", "glb"),
    ("cmu/cmu_walk_daz19.bvh", "bvh"),
    ("other/mixed_rotation_orders.bvh", "bvh"),
]


@pytest.fixture(scope="module")
def rigged(blender, clips, tmp_path_factory) -> dict[tuple[str, str], dict]:
    """Keys on the armature that another importer made of the same body: Z up, bones along the body, half the size."""
    folder = tmp_path_factory.mktemp("rigged")
    jobs = []
    for name, extension in RIGS:
        motion = mc.unroll(mc.read(clips / name, unit=0.01)[-40:])
        keys, file = keyed(motion), folder / f"{len(jobs)}.{extension}"
        mc.write(file, motion, **({"profile": "baked"} if extension == "glb" else {}))
        mc.write(file.with_suffix(".blend.py"), keys)
        job = {"do": "existing", "format": extension, "file": str(file), "script": str(file.with_suffix(".blend.py"))}
        jobs.append({**job, "size": 0.5, **say(keys, file.with_suffix(".npz"))})
    return {label: {**job, **answer} for label, job, answer in zip(RIGS, jobs, run(blender, folder, jobs), strict=True)}


@pytest.mark.parametrize("rig", RIGS)
def test_an_armature_of_other_axes_and_size_gets_the_same_poses(rigged, rig):
    answer = rigged[rig]
    assert answer["compared"] == len(answer["bones"])
    assert answer["degrees"] <= LIMIT
    assert answer["units"] <= LIMIT
    assert answer["actions"] == 2


@pytest.mark.parametrize("rig", RIGS)
def test_keys_come_back_from_another_armature_to_the_last_bit(rigged, rig):
    script = Path(rigged[rig]["script"])
    mc.write(script.with_suffix(".curves.json"), mc.read(script))
    assert Path(rigged[rig]["out"]).read_text() == script.with_suffix(".curves.json").read_text()


@pytest.mark.parametrize("rig", RIGS)
def test_an_edit_on_another_armature_comes_back_as_blender_shows_it(rigged, rig):
    """A turned and moved root: where it turns by a quaternion, a key a frame, for angles are no sums of its curves."""
    answer = rigged[rig]
    back = mc.read(answer["edited"])
    said = say(back.sample(), Path(answer["edited"]).with_suffix(".npz"), step=1.0)
    shown = np.load(answer["shown"])
    seen = np.load(said["reference"])
    assert np.abs(seen["turns"] - shown["turns"]).max() < 2e-5
    assert np.abs(seen["places"] - shown["places"]).max() < LIMIT
    before = mc.read(answer["script"])
    changed = [a.values.tobytes() != b.values.tobytes() for a, b in zip(before.curves, back.curves, strict=True)]
    assert sum(changed) == (6 if answer["mode"] == "QUATERNION" else 2)
