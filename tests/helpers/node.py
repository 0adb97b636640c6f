"""The Khronos validator, three.js and glTF-Transform, run by node; `npm install` in tests/formats/gltf gets them."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest

SCRIPTS = Path(__file__).resolve().parent.parent / "formats" / "gltf"


class Played(NamedTuple):
    """What three.js shows: places (T, J, 3) in metres and rotations (T, J, 4) wxyz against the parents.

    joints, animations: names; bones: how many joints are bones to three.js; figures: how many skinned meshes.
    """

    places: np.ndarray
    wxyz: np.ndarray
    joints: list[str]
    bones: int
    figures: int
    animations: list[str]


def missing() -> str | None:
    """What is not installed of node and its modules, None where all is there."""
    if shutil.which("node") is None:
        return "node is not installed"
    if not all((SCRIPTS / "node_modules" / name).is_dir() for name in ("three", "@gltf-transform")):
        return "run npm install in tests/formats/gltf"
    return None


def require() -> None:
    """Skip a test where node or its modules are missing; fail it there if MOCURVE_REQUIRE_NODE is set."""
    reason = missing()
    if reason is not None and os.environ.get("MOCURVE_REQUIRE_NODE"):
        pytest.fail(reason)
    if reason is not None:
        pytest.skip(reason)


def validate(paths: Sequence[Path]) -> list[dict[str, Any]]:
    """Per file how many errors, warnings and infos the validator finds, and the first messages."""
    return _run("validate.mjs", [str(path) for path in paths])


def rewrite(jobs: Sequence[tuple[Path, Path, str]]) -> None:
    """(file, new file, how): files written again by glTF-Transform, in the ways that transform.mjs knows."""
    _run("transform.mjs", [{"path": str(path), "output": str(new), "how": how} for path, new, how in jobs])


def play(jobs: Sequence[tuple[Path, str | None, np.ndarray]]) -> list[Played]:
    """What three.js shows of (file, name of the animation or None for the first, times in seconds)."""
    with tempfile.TemporaryDirectory() as folder:
        outputs = [Path(folder) / f"{place}.f64" for place in range(len(jobs))]
        told = _run(
            "evaluate.mjs",
            [
                {"path": str(path), "animation": name, "times": times.tolist(), "output": str(output)}
                for (path, name, times), output in zip(jobs, outputs, strict=True)
            ],
        )
        numbers = [np.fromfile(output) for output in outputs]
    return [
        Played(shown[..., :3], shown[..., [6, 3, 4, 5]], **more)
        for (_, _, times), more, flat in zip(jobs, told, numbers, strict=True)
        for shown in [flat.reshape(len(times), len(more["joints"]), 7)]
    ]


def _run(script: str, task: Any) -> Any:
    done = subprocess.run(
        ["node", script], cwd=SCRIPTS, input=json.dumps(task), capture_output=True, text=True, check=False
    )
    if done.returncode:
        raise RuntimeError(f"{script}: {done.stderr[-2000:]}")
    return json.loads(done.stdout)
