"""The promise in space against the plain way to keep it: keys and time.

Baseline: every rotation channel within c * tolerance / reach, every position channel within c * tolerance, the one
factor c bisected until the same promise holds (same points, same limits, same method for each channel). Run: python
benchmarks/world.py [--frames N]
"""

from __future__ import annotations

import argparse
import warnings
from collections.abc import Callable
from functools import partial
from time import process_time

import numpy as np
from clips import folder

import mocurve as mc
from mocurve.kinematics import reach, rest_height
from mocurve.motion import Motion, unroll
from mocurve.reduction import optimal, world
from mocurve.reduction.problem import Problem, problem

CLIPS = {
    "cmu/cmu_12_01_walk.bvh": 1,  # first frames that are a T-pose are left out
    "cmu/cmu_01_01_jump.bvh": 1,
    "cmu/cmu_02_03_run.bvh": 1,
    "cmu/cmu_run_filtered.bvh": 1,
    "cmu/cmu_walk_daz19.bvh": 1,
    "cmu/cmu_05_20_dance_motionbuilder.bvh": 1,
    "cmu/cmu_94_01_dance_max.bvh": 1,
    "cmu/cmu_135_04_martial_daz.bvh": 1,
    "other/rokoko_dance_fingers.bvh": 0,
}
PERCENT = (0.1, 0.2, 0.5, 1.0)
BISECTIONS = 9


def one_factor(motion: Motion, asked: Problem, length: float) -> int:
    """Keys of the baseline."""
    scene, _, _ = world.problem(motion, asked.limits)
    turns = motion.skeleton.rotation_channels
    arms = (reach(motion) + world.SHELL * rest_height(motion))[motion.skeleton.channel_joints]
    base = np.where(turns, np.degrees(length / arms), length)
    low, high, best = 0.02, 4.0, 0
    for _ in range(BISECTIONS):
        c = float(np.sqrt(low * high))
        half = np.repeat((c * base)[:, None], motion.frames, axis=1)
        keys = [world.group_keys(scene.original[g], half[g], optimal.solve, "default") for g in asked.groups]
        if world.take(scene, asked.groups, keys) <= 1.0:
            low, best = c, sum(len(k.frames) for k in keys)
        else:
            high = c
    return best


def seconds(work: Callable[[], object]) -> float:
    """Median processor time of three runs."""
    taken = []
    for _ in range(3):
        start = process_time()
        work()
        taken.append(process_time() - start)
    return float(np.median(taken))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--frames", type=int, default=500, help="of each clip (default 500)")
    parser.add_argument("--quality", nargs="*", default=["fast", "default"])
    parser.add_argument("--feet", type=float, default=1.0, help="part of the tolerance for planted feet, on both sides")
    parser.add_argument("--clips", default="", help="only clips with this in their name")
    parser.add_argument("--percent", type=float, nargs="*", default=PERCENT)
    asked = parser.parse_args()
    warnings.simplefilter("ignore")
    print(f"{'clip':34}{'%height':>8}{'baseline':>9}" + "".join(f"{q:>10}{'x plain':>8}" for q in asked.quality))
    ratios: dict[str, list[float]] = {q: [] for q in asked.quality}
    times: dict[str, list[float]] = {q: [] for q in asked.quality}
    worst: dict[str, dict[str, list[float]]] = {q: {} for q in asked.quality}
    for name, first in CLIPS.items():
        if asked.clips not in name:
            continue
        motion = unroll(mc.read(folder() / name)[first : first + asked.frames])
        for percent in asked.percent:
            tolerance = f"{percent}%height"
            asked_of_us = problem(motion, [tolerance], "channel", asked.feet)
            length = percent / 100 * rest_height(motion)
            base = one_factor(motion, asked_of_us, length)
            middle = np.degrees(length / (np.median(reach(motion)) + world.SHELL * rest_height(motion)))
            plain = seconds(partial(mc.reduce, motion, tolerance=f"{middle}deg"))
            row = f"{name:34}{percent:8}{base:9}"
            for quality in asked.quality:
                work = partial(mc.reduce, motion, tolerance=tolerance, quality=quality, feet=asked.feet)
                ratio, slower = work().keys / base, seconds(work) / plain
                ratios[quality].append(ratio)
                times[quality].append(slower)
                worst[quality].setdefault(name, []).append(ratio)
                row += f"{ratio:10.3f}{slower:8.1f}"
            print(row, flush=True)
    for quality in asked.quality:
        clips = {name: np.exp(np.mean(np.log(r))) for name, r in worst[quality].items()}
        at = max(clips, key=lambda name: clips[name])
        mean = np.exp(np.mean(np.log(ratios[quality])))
        print(f"{quality}: keys / baseline {mean:.3f} (geometric mean), worst clip {clips[at]:.3f} ({at})")
        slow = f"median {np.median(times[quality]):.1f}, at most {max(times[quality]):.1f}"
        print(f"    worst row {max(ratios[quality]):.3f}; time in plain reductions: {slow}")


if __name__ == "__main__":
    main()
