"""Blending, displacements, warps and retimes of real clips: how exact the laws are, and what a verb takes.

    python benchmarks/edit.py [--rounds 5]

Laws on captured clips, each with itself some frames later. Retime: the root of walks on splines with
knots every 0.2 s, a speed that changes smoothly by 12 %, told to `retime` in 5, 9 and 17 pairs, against the bent curve
itself at 4000 times, in centimetres. Times: medians of processor times on one core.
"""

from __future__ import annotations

import warnings
from argparse import ArgumentParser
from collections.abc import Callable
from statistics import median
from time import process_time

import clips
import numpy as np

import mocurve as mc
from mocurve import bspline, bspline_fit, kinematics, rotation
from mocurve.edit.retime import time_map
from mocurve.spline import SplineMotion

CMU_CENTIMETRES = 2.54 / 0.45
NAMES = ["cmu_12_01_walk", "cmu_02_01_walk_blender", "cmu_02_03_run", "cmu_01_01_jump", "cmu_135_04_martial_daz"]
WALKS = NAMES[:3]
SPACING, SWING = 0.2, 0.12


def apart(a: mc.Motion, b: mc.Motion) -> float:
    """Largest turn between the same joints (degrees), or difference of a position (units)."""
    turned = rotation.angle(kinematics.rotations(a), kinematics.rotations(b)).max()
    return float(max(turned, np.abs((a.values - b.values)[:, ~a.skeleton.rotation_channels]).max()))


def laws(motion: mc.Motion) -> dict[str, float]:
    """How far each law is from holding on a clip and the same one some frames later."""
    later = motion.frames // 3
    a, b = motion[: motion.frames - later], motion[later:]
    middle = a.frames // 2 * a.frame_time
    pose = motion[-1:]
    warped = mc.warp(a, middle, pose=pose, support=0.3)
    frame = round(middle / a.frame_time)
    outside = np.abs(np.arange(a.frames) - frame) > 0.3 / a.frame_time + 1
    return {
        "blend(a, a)": apart(mc.blend(a, a, 0.3), a),
        "blend at 0 and 1": float(
            max(np.abs(mc.blend(a, b, w).values - clip.values).max() for w, clip in ((0, a), (1, b)))
        ),
        "add(difference(a, b), b) = a": apart(mc.add(mc.difference(a, b), b), a),
        "pose met": apart(warped[frame : frame + 1], pose),
        "outside the support": float(np.abs(warped.values - a.values)[outside].max(initial=0.0)),
        "warp undone": apart(mc.warp(warped, middle, pose=a[frame : frame + 1], support=0.3), a),
        "even retime": even(a),
    }


def even(a: mc.Motion) -> float:
    """Largest difference of frames that half the speed leaves in place."""
    made = mc.retime(a, {a.duration: 2 * a.duration})
    every = made.values[::2]
    return apart(mc.Motion(a.skeleton, every, a.frame_time), a[: len(every)])


def retimed(walk: mc.Motion, count: int) -> tuple[float, float]:
    """Centimetres that the root is off, at most, with moved knots and with a refit."""
    at, end = np.arange(walk.frames) * walk.frame_time, walk.duration
    knots = bspline.clamped(np.linspace(0, end, round(end / SPACING) + 1))
    values = bspline_fit.least_squares(knots, 3, at, walk.values)
    clip = SplineMotion(walk.skeleton, knots, values, 3, walk.frame_time, walk.frames)
    old = np.linspace(0, end, count)
    pairs = list(zip(old, old + SWING * end / (2 * np.pi) * np.sin(2 * np.pi * old / end), strict=True))
    fine = np.linspace(0, end, 4001)
    truth = clip.at(time_map(clip, pairs).back(fine))[:, :3]
    moved, refit = (mc.retime(clip, pairs, mode=mode).at(fine)[:, :3] for mode in ("knots", "refit"))
    by_knots, by_fit = (float(np.abs(made - truth).max()) * CMU_CENTIMETRES for made in (moved, refit))
    return by_knots, by_fit


def seconds(work: Callable[[], object], rounds: int) -> float:
    """Median processor time."""
    times = []
    for _ in range(rounds):
        start = process_time()
        work()
        times.append(process_time() - start)
    return median(times)


def main() -> None:
    parser = ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rounds", type=int, default=5)
    rounds = parser.parse_args().rounds
    warnings.simplefilter("ignore")  # of speeds and moved knots: they are what is measured
    motions = {name: mc.read(clips.folder() / "cmu" / f"{name}.bvh")[1:] for name in NAMES}
    worst: dict[str, float] = {}
    for motion in motions.values():
        for law, off in laws(motion).items():
            worst[law] = max(worst.get(law, 0.0), off)
    print("law                            worst, degrees or units")
    for law, off in worst.items():
        print(f"{law:30} {off:.1e}")
    print("\nroot of a walk, cm             pairs  knots moved  refit")
    for name in WALKS:
        for count in (5, 9, 17):
            moved, refit = retimed(motions[name], count)
            print(f"{name:30} {count:5}  {moved:11.3f}  {refit:.4f}")
    walk = motions["cmu_12_01_walk"]
    a, b = walk[:350], walk[-350:]
    by = mc.difference(a, b)
    verbs = {
        "blend": lambda: mc.blend(a, b, 0.5),
        "mix of three": lambda: mc.mix([a, b, walk[80:430]], [1, 1, 1]),
        "difference": lambda: mc.difference(a, b),
        "add": lambda: mc.add(by, b),
        "warp to a pose": lambda: mc.warp(a, 1.0, pose=walk[400:401]),
        "warp of one channel": lambda: mc.warp(a, 1.0, {"LeftArm.Zrotation": 30}),
        "retime": lambda: mc.retime(a, {1.0: 1.2}),
    }
    print(f"\nverb, {a.frames} frames x {a.skeleton.channel_count} channels   ms")
    for name, work in verbs.items():
        print(f"{name:30} {1000 * seconds(work, rounds):.1f}")


if __name__ == "__main__":
    main()
