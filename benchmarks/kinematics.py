"""Forward kinematics of real clips, all joints and end sites, beside pybvh's and beside the same steps in NumPy.

    pip install mocurve[bench]
    python benchmarks/kinematics.py [--rounds 15] [CLIP ...]


The three take turns, each on one core; the files are read before, and pybvh's cache is not asked. Medians of the
processor times (other programs disturb them least) and of the ratios within a round are told, and the largest
difference of any place to pybvh's, against the clip's size. pybvh knows one root, three rotations a joint and no
position channels below the root: clips with others cannot be compared.
"""

from __future__ import annotations

from argparse import ArgumentParser
from collections.abc import Callable
from pathlib import Path
from statistics import median
from time import process_time

import clips
import numpy as np
import pybvh
from pybvh.spatial_coord import frames_to_node_positions

from mocurve import Motion, kinematics, read

LEAST, AIM, SAME = 10.0, 30.0, 1e-9
CLIPS = ["cmu/cmu_01_01_jump", "cmu/cmu_94_01_dance_max", "cmu/cmu_135_04_martial_daz", "other/rokoko_dance_fingers"]


def in_numpy(motion: Motion) -> np.ndarray:
    """The steps of the compiled walk, frame-wise in NumPy on (axis, component, frame) arrays, 512 frames at once."""
    skeleton = motion.skeleton
    places = np.empty((len(skeleton.names), 3, motion.frames))
    for start in range(0, motion.frames, 512):
        span = slice(start, start + 512)
        values = motion.values[span].T
        radians = np.radians(values)
        cosines, sines = np.cos(radians), np.sin(radians)
        images: list[np.ndarray] = []
        k = 0
        for joint, parent in enumerate(skeleton.parents):
            above = images[parent] if parent >= 0 else np.broadcast_to(np.eye(3)[:, :, None], (3, 3, values.shape[1]))
            local, mine = list(skeleton.offsets[joint]), above
            for kind in skeleton.channels[joint]:
                a, b, c = (("XYZ".index(kind[0]) + i) % 3 for i in range(3))
                if kind.endswith("position"):
                    local[a] = values[k]
                elif values[k].any():
                    turned = np.empty_like(mine)
                    turned[a] = mine[a]
                    turned[b] = mine[b] * cosines[k] + mine[c] * sines[k]
                    turned[c] = mine[c] * cosines[k] - mine[b] * sines[k]
                    mine = turned
                k += 1
            images.append(mine)
            places[joint, :, span] = sum(above[axis] * local[axis] for axis in range(3))
            if parent >= 0:
                places[joint, :, span] += places[parent, :, span]
    return places.transpose(2, 0, 1)


def milliseconds(work: Callable[[], object]) -> float:
    start = process_time()
    work()
    return (process_time() - start) * 1000.0


def compare(path: Path, rounds: int) -> tuple[float, float]:
    """Print one row; the median ratio to pybvh and the largest relative difference."""
    motion, other = read(path), pybvh.read_bvh_file(path)
    ours, theirs = kinematics.world(motion), frames_to_node_positions(other)
    off = float(np.abs(ours - theirs).max() / np.abs(theirs).max())
    works = [
        lambda: kinematics.world(motion),
        lambda: frames_to_node_positions(other),
        lambda: in_numpy(motion),
    ]
    times = np.array([[milliseconds(work) for work in works] for _ in range(rounds)])
    mine, pybvh_time, numpy_time = np.median(times, axis=0)
    ratio, compiled = (median(times[:, i] / times[:, 0]) for i in (1, 2))
    print(
        f"{path.stem:<28} {motion.frames:5} x {len(motion.skeleton.names):<3} {mine:8.2f} {pybvh_time:8.2f}"
        f" {ratio:6.1f}x {numpy_time:9.2f} {compiled:6.1f}x {off:11.1e}"
    )
    return ratio, off


def main() -> None:
    asked = ArgumentParser()
    asked.add_argument("clips", nargs="*", type=Path)
    asked.add_argument("--rounds", type=int, default=15)
    options = asked.parse_args()
    paths = options.clips or [clips.folder() / f"{name}.bvh" for name in CLIPS]
    head = f"{'clip':<28} frames x sites  mocurve    pybvh   ratio     NumPy   ratio  difference"
    print(f"{head}   (ms, median of {options.rounds})")
    found = [compare(path, options.rounds) for path in paths]
    worst = max(off for _, off in found)
    print(f"pybvh / mocurve: {median(r for r, _ in found):.1f}x   least {LEAST:g}x, aim {AIM:g}x")
    print(f"largest difference: {worst:.1e} of the clip's size   least {SAME:g}")


if __name__ == "__main__":
    main()
