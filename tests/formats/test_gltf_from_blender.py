"""glTF files that Blender exports are read as Blender itself shows them.

MOCURVE_BPY names a Python that has Blender as a module (`pip install bpy`, 4.5 or later); without one these tests skip.
"""

from __future__ import annotations

import importlib.util
import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import mocurve as mc
from mocurve import kinematics

LIMIT = 1e-6  # of the size: float32
FRAMES = 71


@pytest.fixture(scope="module")
def exported(jump, tmp_path_factory) -> Path:
    """A folder of files that export_in_blender.py made of a piece of the shipped clip."""
    python = os.environ.get("MOCURVE_BPY") or (sys.executable if importlib.util.find_spec("bpy") else None)
    if not python:
        pytest.skip("no Blender: set MOCURVE_BPY to a Python that has bpy")
    folder = tmp_path_factory.mktemp("blender")
    mc.write(folder / "clip.bvh", mc.read(jump)[100 : 100 + FRAMES])
    script = Path(__file__).with_name("export_in_blender.py")
    command = [python, str(script), str(folder / "clip.bvh"), str(folder)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr[-2000:]
    return folder


@pytest.mark.parametrize("name", ["sampled.glb", "keys.glb", "beside.gltf", "scaled.glb"])
def test_joints_are_where_blender_has_them(exported, name):
    told = json.loads((exported / "places.json").read_text())[name]
    motion = mc.read(exported / name)
    assert motion.frame_time == 1 / 120
    assert motion.frames == FRAMES
    places = kinematics.world(motion)[:, [motion.skeleton.joint(joint) for joint in told["names"]]]
    theirs = np.array(told["places"])[:FRAMES]  # the scene may be longer
    # Between keys it takes components for curves, where glTF keeps signs next to one another: another motion
    frames = slice(None, None, 7 if name == "keys.glb" else 1)
    assert np.abs(places - theirs)[frames].max() <= LIMIT * np.ptp(theirs.reshape(-1, 3), axis=0).max()
