"""Distances of all pairs of frames of two clips, after planar alignment: pairs a second on one core, and equality with
one pair at a time.

OPENBLAS_NUM_THREADS=1 python frame_pairs.py
"""

from __future__ import annotations

import time

import numpy as np
from clips import folder

import mocurve as mc
from mocurve import planar
from mocurve.kinematics import world

WINDOW = 10
PAIRS = [
    ("cmu/cmu_01_01_jump.bvh", "cmu/cmu_05_20_dance_motionbuilder.bvh"),
    ("cmu/cmu_12_01_walk.bvh", "cmu/cmu_01_01_jump.bvh"),
    ("cmu/cmu_94_01_dance_max.bvh", "cmu/cmu_94_01_dance_max.bvh"),
]


def one_by_one(first: np.ndarray, second: np.ndarray, picks: np.ndarray) -> np.ndarray:
    """The distances of some pairs, each aligned by itself."""
    found = []
    for i, j in picks:
        p, q = (places[k : k + WINDOW].reshape(-1, 3) for places, k in ((first, i), (second, j)))
        apart = p - planar.move(planar.align(p, q), q)
        found.append(np.sqrt((apart**2).sum(axis=1).mean()))
    return np.array(found)


def main() -> None:
    print(f"windows of {WINDOW} frames\n{'clips':44}{'joints':>8}{'M pairs':>9}{'M pairs/s':>11}{'difference':>12}")
    for names in PAIRS:
        motions = [mc.read(folder() / name) for name in names]
        common = [name for name in motions[0].skeleton.names if name in motions[1].skeleton.names]
        first, second = (world(m)[:, [m.skeleton.joint(name) for name in common]] for m in motions)
        times = []
        for _ in range(3):
            start = time.process_time()
            found = planar.frame_distances(first, second, WINDOW)
            times.append(time.process_time() - start)
        picks = np.random.default_rng(0).integers(0, found.shape, (300, 2))
        off = np.abs(found[tuple(picks.T)] - one_by_one(first, second, picks)).max()
        name = " x ".join(n.split("/")[-1].removeprefix("cmu_").removesuffix(".bvh") for n in names)
        rate = found.size / np.median(times) / 1e6
        print(f"{name:44}{len(common):8}{found.size / 1e6:9.1f}{rate:11.1f}{off:12.1e}")


if __name__ == "__main__":
    main()
