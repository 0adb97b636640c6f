"""The way back: what was edited in Blender comes back as keys, and what was not to the last bit."""

from __future__ import annotations

import math
import subprocess
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from blender_jobs import blender_python, run

import mocurve as mc
from mocurve.formats._blender_maths import axes_of, straight

FRAMES, STEP = 100, 0.01
LIMIT = math.radians(1e-3) * 1.5  # of the export, and a little for Blender's own 32 bits


@pytest.fixture(scope="module")
def blender() -> str:
    return blender_python()


@pytest.fixture(scope="module")
def keys() -> mc.KeyedMotion:
    """A body of two bones, one along Y and one along -X; keys of all 64 bits, some tangents broken."""
    body = mc.Skeleton(
        ("Hips", "Arm", "Arm_End"),
        [-1, 0, 1],
        [[0, 0, 0], [0, 10, 0], [-8, 1, 0]],
        (
            ("Xposition", "Yposition", "Zposition", "Zrotation", "Xrotation", "Yrotation"),
            ("Zrotation", "Yrotation", "Xrotation"),
            (),
        ),
        [False, False, True],
    )
    rng = np.random.default_rng(7)
    curves = []
    for channel in range(9):
        frames = np.array([0, 7, 16, 30, 41, 60, 75, 88, 99])
        values, slopes, arriving = rng.normal(0, [[30], [300], [300]], (3, len(frames)))
        curves.append(mc.HermiteCurve(frames * STEP, values, slopes, arriving if channel == 4 else None))
    return mc.KeyedMotion(body, tuple(curves), STEP, FRAMES, ({"verb": "reduce"},))


def bone_curve(name: str, axis: int) -> tuple[str, int, float]:
    """F-curve and factor of a rotation channel."""
    basis = straight(np.array({"Hips": [0.0, 1.0, 0.0], "Arm": [-1.0, 0.0, 0.0]}[name]))
    index, sign = axes_of(basis)[axis]
    return f'pose.bones["{name}"].rotation_euler', index, sign * math.pi / 180


ARM, AXIS = bone_curve("Arm", 2)[0], bone_curve("Arm", 2)[1]  # Arm.Zrotation, channel 6
EDITS = {
    "value": ["move", 3, 0.0, 0.25],
    "time": ["move", 3, 1.5, 0.0],
    "both": ["move", 0, 2.25, -0.5],
    "late": ["move", 8, 7.0, 0.1],
    "far": ["move", 4, 11.0, 0.0],
    "linear": ["kind", 3, "LINEAR"],
    "held": ["kind", 3, "CONSTANT"],
    "eased": ["kind", 3, "BOUNCE"],
    "longer": ["lengthen", 3, 2.0],
    "too long": ["lengthen", 3, 7.0],
    "flat": ["lengthen", 3, 0.0],
    "removed": ["remove", 3],
    "noisy": ["noise"],
}


@pytest.fixture(scope="module")
def answers(blender, keys, tmp_path_factory):
    """Of each edit the curve in Blender at every half frame, and the clip that came back."""
    folder = tmp_path_factory.mktemp("edits")
    mc.write(folder / "clip.blend.py", keys)
    jobs = []
    for number, edit in enumerate(EDITS.values()):
        out = str(folder / f"{number}.curves.json")
        edits = [[ARM, AXIS, *edit]]
        jobs.append(
            {"do": "edited", "script": str(folder / "clip.blend.py"), "edits": edits, "out": out, "frames": 106}
        )
    found = run(blender, folder, jobs)
    return {
        name: (np.array(answer["values"][0]), mc.read(job["out"]))
        for name, job, answer in zip(EDITS, jobs, found, strict=True)
    }


def bits(curve: mc.HermiteCurve) -> list[bytes]:
    return [part.tobytes() for part in (curve.times, curve.values, curve.slopes, curve.in_slopes)]


@pytest.mark.parametrize("edit", EDITS)
def test_an_edited_curve_comes_back_as_blender_shows_it(answers, edit):
    shown, back = answers[edit]
    factor = bone_curve("Arm", 2)[2]
    times = np.arange(len(shown)) * 0.5 * STEP
    seen = back.curves[6].at(times) * factor
    compared = slice(0, 2 * FRAMES - 1, 2) if edit in ("noisy", "eased") else slice(None)  # these are a key a frame
    assert np.abs(seen - shown)[compared].max() < LIMIT


@pytest.mark.parametrize("edit", EDITS)
def test_other_curves_come_back_to_the_last_bit(answers, keys, edit):
    _, back = answers[edit]
    for channel, (now, before) in enumerate(zip(back.curves, keys.curves, strict=True)):
        assert (bits(now) == bits(before)) == (channel != 6)
    assert back.skeleton.channel_names == keys.skeleton.channel_names
    assert back.frames == (107 if edit == "late" else FRAMES)
    assert back.history == (*keys.history, {"verb": "blender", "action": "clip", "curves": 1})


def test_a_moved_key_is_exact_and_its_neighbours_are_untouched(answers, keys):
    _, back = answers["value"]
    now, before = back.curves[6], keys.curves[6]
    factor = bone_curve("Arm", 2)[2]
    expected = np.float32(np.float32(before.values[3] * factor) + np.float32(0.25)).astype(float) / factor
    assert now.values[3] == pytest.approx(expected, abs=1e-13)
    rest = [k for k in range(9) if k != 3]
    assert now.values[rest].tobytes() == before.values[rest].tobytes()
    assert now.times.tobytes() == before.times.tobytes()
    assert now.slopes.tobytes() == before.slopes.tobytes()


def test_a_removed_key_takes_no_other_with_it(answers, keys):
    _, back = answers["removed"]
    rest = [k for k in range(9) if k != 3]
    for part in ("values", "times", "slopes"):
        assert set(getattr(keys.curves[6], part)[rest]) <= set(getattr(back.curves[6], part))


def test_a_key_moved_in_time_stays_a_key(answers, keys):
    _, back = answers["time"]
    at = np.flatnonzero(np.isclose(back.curves[6].times, 31.5 * STEP, rtol=0, atol=1e-9))
    assert back.curves[6].values[at] == pytest.approx(keys.curves[6].values[3], abs=1e-5)
    assert len(back.curves[6]) < 40


# -- commands ----------------------------------------------------------------------------------------
@pytest.fixture(scope="module")
def script(keys, tmp_path_factory) -> Path:
    path = tmp_path_factory.mktemp("commands") / "héro 1.blend.py"
    mc.write(path, keys)
    return path


def command(blender: str, script: Path, *words: str) -> subprocess.CompletedProcess:
    return subprocess.run(
        [blender, script.name, *words], cwd=script.parent, capture_output=True, text=True, check=False
    )


def test_commands_save_open_and_export(blender, script, keys):
    made = command(blender, script, "--save", "rig.blend")
    assert made.returncode == 0, made.stderr
    assert (
        "made the action 'héro 1' of the armature 'héro 1': 81 keys, 100 frames at 100 frames a second" in made.stdout
    )
    again = command(blender, script, "--open", "rig.blend", "--armature", "héro 1", "--save", "twice.blend")
    assert "made the action 'héro 1.001' of the armature 'héro 1'" in again.stdout
    out = command(blender, script, "--open", "twice.blend", "--action", "héro 1", "--export", "back.curves.json")
    assert "81 keys; 0 of 9 curves differ from the clip's" in out.stdout
    mc.write(script.parent / "as written.curves.json", keys)
    assert (script.parent / "back.curves.json").read_bytes() == (script.parent / "as written.curves.json").read_bytes()


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["--armature", "Rog"], "no armature 'Rog' here; there is none"),
        (["--export", "x.curves.json"], "no armature here has the bones of 'héro 1'"),
        (["--open", "missing.blend"], "missing.blend"),
        (["--colour"], "unrecognized arguments: --colour"),
        (["--save", "no/folder/x.blend"], "x.blend"),
    ],
)
def test_mistakes_are_told_in_one_line(blender, script, words, told):
    done = command(blender, script, *words)
    assert done.returncode == 2
    lines = [line for line in done.stderr.splitlines() if line.startswith("mocurve: ")]
    assert len(lines) == 1
    assert told in lines[0]
    assert "Traceback" not in done.stderr


def test_names_that_blender_cuts_and_doubles_come_back_whole(blender, keys, tmp_path):
    names = ("骨" * 40, "骨" * 40, "End")
    odd = replace(keys, skeleton=replace(keys.skeleton, names=names))
    mc.write(tmp_path / "odd.blend.py", odd)
    done = command(blender, tmp_path / "odd.blend.py", "--save", "odd.blend")
    back = command(blender, tmp_path / "odd.blend.py", "--open", "odd.blend", "--export", "odd.curves.json")
    assert "0 of 9 curves differ" in back.stdout, done.stderr + back.stderr
    assert mc.read(tmp_path / "odd.curves.json").skeleton.names == names


def test_run_twice_from_the_text_editor_it_has_two_actions_and_one_menu_entry(blender, keys, tmp_path):
    mc.write(tmp_path / "walk.blend.py", keys)
    job = {"do": "menu", "script": str(tmp_path / "walk.blend.py"), "out": str(tmp_path / "menu.curves.json")}
    answer = run(blender, tmp_path, [job])[0]
    assert answer["armatures"] == ["walk"]
    assert answer["actions"] == ["walk", "walk.001"]
    assert answer["menu"] == 1
    assert answer["done"] == ["FINISHED"]
    assert "cannot write" in answer["refused"]
    assert answer["locks"]["Arm"] == [[True] * 3, [False] * 3, [True] * 3]
    assert answer["locks"]["Hips"][0] == [False] * 3
    mc.write(tmp_path / "as written.curves.json", keys)
    assert (tmp_path / "menu.curves.json").read_bytes() == (tmp_path / "as written.curves.json").read_bytes()
