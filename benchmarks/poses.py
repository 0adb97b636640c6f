"""Whole poses: what each way to choose key frames leaves in space, at as many keys, and what it takes.

    python benchmarks/poses.py [--quality default] [--long]

Six captured clips of up to 500 frames. Errors are the largest distance of any joint or end site from where it was, at
any frame, in percent of the rest height. First with the same curves for all: C1, one least-squares fit of all values
and slopes (quality fast); then with the curves that `reduce` gives them (weights a frame, channels made up for one
another). `optimal` is told as it comes. Then broken tangents, poses held: the same curves for both. Then the papers'
own thresholds; the thesis's table 2.1 with what can be measured of it; times and memory, with --long those of 2000
frames, each in a process of its own.
"""

from __future__ import annotations

import subprocess
import sys
import warnings
from argparse import ArgumentParser
from statistics import geometric_mean
from time import perf_counter, process_time

import numpy as np
from clips import folder

import mocurve as mc
from mocurve.kinematics import rest_height
from mocurve.reduction import CHOOSERS, broken, optimal, world
from mocurve.reduction.choices import astray, stances
from mocurve.reduction.inbetweens import centred, fitted, stage_of
from mocurve.reduction.problem import problem
from mocurve.reduction.whole_poses import evenly

CLIPS = {  # frames from, to: a T-pose in front is left out
    "walk 12_01": ("cmu/cmu_12_01_walk.bvh", 1, 501),
    "jump 01_01": ("cmu/cmu_01_01_jump.bvh", 300, 800),
    "run 02_03": ("cmu/cmu_02_03_run.bvh", 1, 173),
    "martial arts 135_04": ("cmu/cmu_135_04_martial_daz.bvh", 300, 800),
    "dance 05_20": ("cmu/cmu_05_20_dance_motionbuilder.bvh", 1, 501),
    "dance with fingers": ("other/rokoko_dance_fingers.bvh", 0, 500),
}
PARTS = (0.05, 0.1, 0.2)
FROM_ONE_CHORD = ("salient", "posture", "probe", "cluster")


def clip(name: str) -> mc.Motion:
    path, first, last = CLIPS[name]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return mc.unroll(mc.read(folder() / path)[first:last], triples=False)


def percent(motion: mc.Motion, keys: mc.KeyedMotion) -> float:
    return 100.0 * mc.compare(motion, keys).max_error_world / rest_height(motion)


def pinned(motion: mc.Motion) -> np.ndarray:
    ends = np.zeros(motion.frames, bool)
    ends[[0, -1]] = True
    return ends


def errors(quality: str) -> None:
    ratios: dict[float, list[float]] = {part: [] for part in PARTS}
    better: list[float] = []
    print(
        "| clip, keys | even | posture | probe | cluster | salient | the same five, curves of `reduce` | **optimal** |",
        end="",
    )
    print(" / salient, least squares | / the best other | seconds |\n|" + "---|" * 10)
    for name in CLIPS:
        motion = clip(name)
        stage, ends, height = stage_of(motion), pinned(motion), rest_height(motion) / 100.0
        ranges = {method: mc.poses(motion, method=method) for method in FROM_ONE_CHORD}
        for part in PARTS:
            keys = round(part * motion.frames)
            at = {"even": evenly(motion.frames, keys, ends)}
            at |= {method: ranges[method].frames(keys) for method in ("posture", "probe", "cluster", "salient")}
            plain = {method: fitted(stage, ends, frames, sweeps=0).worst / height for method, frames in at.items()}
            full = {method: centred(fitted(stage, ends, frames)).worst / height for method, frames in at.items()}
            started = perf_counter()
            ours = percent(motion, mc.reduce(motion, keys=keys, quality=quality))
            took = perf_counter() - started
            ratios[part].append(ours / plain["salient"])
            better.append(ours / min(*plain.values(), *full.values()))
            row = [f"{name}, {keys}", *(f"{error:.2f}" for error in plain.values())]
            row += [" ".join(f"{error:.2f}" for error in full.values()), f"**{ours:.3f}**"]
            print(
                "| " + " | ".join([*row, f"{ratios[part][-1]:.2f}", f"{better[-1]:.2f}", f"{took:.1f}"]) + " |",
                flush=True,
            )
    for part, found in ratios.items():
        print(
            f"{part:.0%} of the frames: optimal / salient with least squares, mean {geometric_mean(found):.3f}, ",
            end="",
        )
        print(f"worst {max(found):.3f}")
    print(f"optimal / the best of all others: at most {max(better):.3f}\n", flush=True)


def broken_tangents() -> None:
    print("| clip | keys | salient | broken | ratio |\n|" + "---|" * 5)
    worst = 0.0
    for name in CLIPS:
        motion = clip(name)
        stage, height, chosen = stage_of(motion), rest_height(motion) / 100.0, mc.poses(motion)
        for part in PARTS:
            keys = round(part * motion.frames)
            theirs = broken.error_of(stage, chosen.frames(keys)) / height
            ours = percent(motion, mc.reduce(motion, method="broken", keys=keys))
            worst = max(worst, ours / theirs)
            print(f"| {name} | {keys} | {theirs:.3f} | {ours:.3f} | {ours / theirs:.2f} |", flush=True)
    print(f"broken / salient: at most {worst:.3f}\n")


def thresholds() -> None:
    print("| clip, frames | method | epsilon | keys | worst posture | in space, % |\n|" + "---|" * 6)
    for name in CLIPS:
        motion = clip(name)
        size = np.linalg.norm(stances(motion), axis=1)
        for method in ("probe", "cluster"):
            for epsilon in (2, 5):
                made = mc.reduce(motion, method=method, tolerance=f"{epsilon}%span")
                assert made.report is not None
                at = np.array(made.report.key_frames)
                off = 100.0 * float((astray(stances(motion), at) / size).max())
                row = f"{name}, {motion.frames} | {method} | {epsilon} % | {len(at)} | {off:.2f} %"
                print(f"| {row} | {percent(motion, made):.2f} |", flush=True)
    print()


def table() -> None:
    """Table 2.1 of the thesis with what can be measured of it, at a key for every tenth frame, means over the clips."""
    print(
        "| method | stay when one is added | found again in the result | error, %: least squares, `reduce` | seconds |"
    )
    print("|" + "---|" * 5)
    motions = [clip(name) for name in CLIPS]
    for method in ("posture", "probe", "cluster", "salient", "broken", "optimal"):
        stay, again, plain, full, took = [], [], [], [], 0.0
        for motion in motions:
            keys = round(0.1 * motion.frames)
            started = process_time()
            made = mc.reduce(motion, method=method, keys=keys)
            took += process_time() - started
            at = _frames(made)
            more = mc.reduce(motion, method=method, keys=keys + 1, quality="fast" if method != "optimal" else "default")
            stay.append(len(at & _frames(more)) / keys)
            again.append(len(at & _frames(mc.reduce(made, method=method, keys=keys))) / keys)
            full.append(percent(motion, made))
            frames = np.array(sorted(at))
            plain.append(fitted(stage_of(motion), pinned(motion), frames, sweeps=0).worst / rest_height(motion) * 100.0)
        left = f"{geometric_mean(plain):.2f}, {geometric_mean(full):.2f}"
        print(
            f"| {method} | {np.mean(stay):.2f} | {np.mean(again):.2f} | {left} | {took / len(motions):.2f} |",
            flush=True,
        )
    print()


def tolerances() -> None:
    """How many poses keep a tolerance in space, feet at a quarter: by the curves alone, and as `reduce` has them."""
    print("| clip, frames | tolerance | curves alone | reduce | ratio |\n|" + "---|" * 5)
    ratios = []
    for name in CLIPS:
        motion = clip(name)
        for percent_of_height in (0.2, 1.0):
            text = f"{percent_of_height:g}%height"
            asked = problem(motion, [text], "pose", 0.25)
            alone, _ = world.fit(asked.motion, asked.groups, asked.limits, optimal.solve, True, "default")
            before, after = len(alone[0].frames), len(_frames(mc.reduce(motion, tolerance=text, align="pose")))
            ratios.append(after / before)
            print(f"| {name}, {motion.frames} | {text} | {before} | {after} | {ratios[-1]:.2f} |", flush=True)
    print(f"mean {geometric_mean(ratios):.3f}, at most {max(ratios):.2f}\n")


def _frames(made: mc.KeyedMotion) -> set[int]:
    assert made.report is not None
    return set(made.report.key_frames or ())


def one_long(method: str) -> None:
    """2000 frames x 96 channels by one method, in this process: seconds, and the most memory it had."""
    import resource

    motion = mc.unroll(mc.read(folder() / "cmu" / "cmu_01_01_jump.bvh")[300:2300], triples=False)
    mc.reduce(motion[:60], method=method, keys=9)  # compiles
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    started = process_time()
    made = mc.reduce(motion, method=method, keys=200)
    most = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    print(
        f"| {method} | {process_time() - started:.1f} s | {(most - before) / 1024:.0f} MB, {most / 1024:.0f} MB", end=""
    )
    print(f" | {percent(motion, made):.2f} |", flush=True)


def times(long: bool) -> None:
    motion = clip("jump 01_01")
    for method in CHOOSERS:
        mc.poses(motion[:60], method=method)
    mc.reduce(motion[:60], keys=9)
    print(f"{motion.frames} frames x {motion.values.shape[1]} channels, processor time of all cores")
    started = process_time()
    mc.reduce(motion, keys=50)
    single = process_time() - started
    print(f"optimal, 50 keys: {single:.2f} s")
    for method in CHOOSERS:
        started = process_time()
        found = mc.poses(motion, method=method)
        took = process_time() - started
        print(f"{method}, {found.fewest} to {found.most} keys: {took:.2f} s, {took / single:.2f} x optimal", flush=True)
    if long:
        print(
            "\n2000 frames x 96 channels, 200 keys\n\n| method | time | memory for it, in all | error, % |\n|"
            + "---|" * 4
        )
        sys.stdout.flush()
        for method in ("optimal", *CHOOSERS):
            subprocess.run([sys.executable, __file__, "--one", method], check=True)


PARTS_ALONE = (broken_tangents, thresholds, table, tolerances)


def main() -> None:
    asked = ArgumentParser()
    asked.add_argument("--quality", default="default")
    asked.add_argument("--long", action="store_true")
    asked.add_argument("--only", choices=[work.__name__ for work in PARTS_ALONE], help="one part")
    asked.add_argument("--one", help="one method on 2000 frames, as --long does")
    options = asked.parse_args()
    if options.one:
        one_long(options.one)
        return
    if options.only:
        globals()[options.only]()
        return
    errors(options.quality)
    broken_tangents()
    thresholds()
    table()
    tolerances()
    times(options.long)


if __name__ == "__main__":
    main()
