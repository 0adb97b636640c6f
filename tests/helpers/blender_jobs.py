"""Blender as a Python module, for the tests that ask it: MOCURVE_BPY names a Python that has bpy."""

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
from mocurve import rotation
from mocurve.formats._blender_maths import bone_names
from mocurve.kinematics import rotations, world

SCRIPT = Path(__file__).parent.parent / "formats" / "in_blender.py"


def blender_python() -> str:
    """The interpreter; skips where there is none."""
    python = os.environ.get("MOCURVE_BPY") or (sys.executable if importlib.util.find_spec("bpy") else None)
    if not python:
        pytest.skip("no Blender: set MOCURVE_BPY to a Python that has bpy")
    return python


def run(blender: str, folder: Path, jobs: list[dict]) -> list[dict]:
    """The answers to jobs for in_blender.py."""
    (folder / "jobs.json").write_text(json.dumps(jobs), "utf-8")
    done = subprocess.run(
        [blender, SCRIPT, folder / "jobs.json"], capture_output=True, text=True, check=False, timeout=400
    )
    assert not done.returncode, done.stderr
    answers = json.loads((folder / "jobs.answers.json").read_text("utf-8"))
    errors = [answer["error"] for answer in answers if "error" in answer]
    assert not errors
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
