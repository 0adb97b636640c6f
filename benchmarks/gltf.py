"""What others find in glTF files: the Khronos validator, and three.js at every frame (cubic: and between), per profile.

    (cd tests/formats/gltf && npm install); python benchmarks/gltf.py [--frames 600] [--tolerance 2mm]

Baked and linear are held against the capture, cubic against the curves of its reduced keys, linear to the tolerance.
Key columns count the keys of joints; bytes are of the animation's data alone and of the whole file with its figure.
"""

from __future__ import annotations

import sys
import tempfile
import warnings
from argparse import ArgumentParser
from pathlib import Path
from time import process_time

import numpy as np
from clips import folder

import mocurve as mc
from mocurve import kinematics, rotation
from mocurve.data import example

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "tests" / "helpers"))
import node  # shared with the tests
from glb import Glb

CLIPS = {  # metres that a unit is; None: the clip that ships with the package
    None: 0.056444,
    "cmu/cmu_12_01_walk.bvh": 0.056444,
    "cmu/cmu_02_03_run.bvh": 0.056444,
    "cmu/cmu_94_01_dance_max.bvh": 0.056444,
    "cmu/cmu_135_04_martial_daz.bvh": 0.01,
    "other/rokoko_dance_fingers.bvh": 0.01,
    "other/mixed_rotation_orders.bvh": 0.01,
    "other/hands_60_joints.bvh": 0.01,
}


def main() -> None:
    asked = ArgumentParser()
    asked.add_argument("--frames", type=int, default=600, help="at most so many of each clip")
    asked.add_argument("--tolerance", default="2mm")
    options = asked.parse_args()
    if node.missing():
        sys.exit(node.missing())
    print(
        f"{'clip':24} {'profile':8} {'errors':>6} {'warnings':>8} {'infos':>5} {'max deg':>9} {'max units':>10}", end=""
    )
    print(f" {'max mm':>9} {'keys':>7} {'bytes':>9} {'file':>9} {'write s':>8}")
    for name, unit in CLIPS.items():
        source = example() if name is None else folder() / name
        clip = mc.read(source, unit=unit)[: options.frames]
        keys = mc.reduce(clip, tolerance=options.tolerance, quality="fast")
        for profile in ("baked", "cubic", "linear"):
            row(source.stem, profile, keys if profile == "cubic" else clip, options.tolerance)


def row(name: str, profile: str, clip: mc.Motion | mc.KeyedMotion, tolerance: str) -> None:
    """Write the clip in that profile and tell what is found."""
    step = clip.frame_time / (2 if profile == "cubic" else 1)
    meant = clip.sample(step)
    with tempfile.TemporaryDirectory() as scratch:
        path = Path(scratch) / "clip.glb"
        start = process_time()
        mc.write(path, clip, profile=profile, tolerance=tolerance if profile == "linear" else None)
        seconds = process_time() - start
        (report,) = node.validate([path])
        (played,) = node.play([(path, None, np.arange(meant.frames) * step)])
        file, whole = Glb(path), path.stat().st_size
    animation = file.parts["animations"][0]["samplers"]
    used = {sampler[end] for sampler in animation for end in ("input", "output")}
    size = sum(file.array(accessor).nbytes for accessor in used)
    keys = sum(len(track.times) for track in file.animation().values())
    scale = clip.skeleton.unit or 1.0
    degrees = rotation.angle(played.wxyz, kinematics.rotations(meant)).max()
    units = np.linalg.norm(played.places / scale - kinematics.world(meant), axis=2).max()
    print(
        f"{name:24.24} {profile:8} {report['errors']:6} {report['warnings']:8} {report['infos']:5} {degrees:9.2g}",
        end="",
    )
    print(f" {units:10.2g} {1000 * scale * units:9.3g} {keys:7,} {size:9,} {whole:9,} {seconds:8.2f}", flush=True)


if __name__ == "__main__":
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # what a profile loses is in the table
        main()
