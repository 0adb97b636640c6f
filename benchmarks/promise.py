"""The promise on real clips: every method, alignment and kind of tolerance, the largest error over tolerance of each.

    python benchmarks/promise.py [--frames 120] [--quality default] [CLIP ...]

Frames are cut from the middle of every BVH of the shared clips. Errors are measured here from the curves themselves:
channels against the numbers of the file up to whole turns, joints and end sites by forward kinematics against
those of the file, planted feet against a quarter of the tolerance. Ends with 1 where any error exceeds its tolerance.
"""

from __future__ import annotations

import sys
import warnings
from argparse import ArgumentParser
from pathlib import Path
from time import process_time

import clips
import numpy as np

from mocurve import KeyedMotion, MocurveError, Motion, read, reduce
from mocurve.feet.planted import planted
from mocurve.kinematics import rest_height, world
from mocurve.reduction import ALIGNMENTS, METHODS

DEGREES, PERCENT = (0.1, 0.5, 1.0), (0.05, 0.1, 0.5)
FEET = 0.25


def cut(path: Path, frames: int) -> Motion:
    """So many frames from the middle of a file."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        motion = read(path)
    first = max(0, (motion.frames - frames) // 2)
    return motion[first : first + frames]


def in_degrees(clip: Motion, keys: KeyedMotion, degrees: float) -> float:
    """Largest error over tolerance of any channel; a length may be off by what the angle spans at one rest height."""
    turning = clip.skeleton.rotation_channels
    off = keys.sample().values - clip.values
    off[:, turning] -= 360.0 * np.rint(off[:, turning] / 360.0)
    limits = np.where(turning, degrees, np.radians(degrees) * (rest_height(clip) or 1.0))
    return float((np.abs(off) / limits).max(initial=0.0))


def in_space(clip: Motion, keys: KeyedMotion, percent: float) -> tuple[float, float]:
    """Largest error over tolerance of any joint or end site; that of planted feet, a quarter of it."""
    off = np.linalg.norm(world(keys.sample()) - world(clip), axis=-1).T
    over = off / (percent / 100.0 * rest_height(clip))
    return float(over.max(initial=0.0)), float(over[planted(clip)].max(initial=0.0)) / FEET


def measure(clip: Motion, method: str, align: str, quality: str, amount: float, unit: str) -> tuple[list[float], int]:
    """Errors over tolerance, and keys."""
    keys = reduce(clip, tolerance=f"{amount}{unit}", method=method, align=align, quality=quality, feet=FEET)
    if unit == "deg":
        return [in_degrees(clip, keys, amount)], keys.keys
    return [*in_space(clip, keys, amount)], keys.keys


def main() -> None:
    asked = ArgumentParser()
    asked.add_argument("clips", nargs="*", type=Path)
    asked.add_argument("--frames", type=int, default=120)
    asked.add_argument("--quality", default="default")
    options = asked.parse_args()
    folder = clips.folder()
    paths = options.clips or [path for part in ("cmu", "other") for path in sorted((folder / part).glob("*.bvh"))]
    motions = {path.stem: cut(path, options.frames) for path in paths}
    print(f"{len(motions)} clips, up to {options.frames} frames each, quality {options.quality}")
    print("method    align    tolerance     keys  largest error/tolerance     feet  clip              cpu s")
    failures: list[str] = []
    for method in METHODS:
        for align in ALIGNMENTS:
            for amount, unit in [*((d, "deg") for d in DEGREES), *((p, "%height") for p in PERCENT)]:
                started, keys, worst = process_time(), 0, ([0.0, 0.0], "")
                for name, clip in motions.items():
                    case = f"{name} {method} {align} {amount:g}{unit}"
                    try:
                        over, count = measure(clip, method, align, options.quality, amount, unit)
                    except MocurveError as error:
                        failures.append(f"{case}: {error}")
                        continue
                    keys += count
                    worst = max(worst, ([*over, 0.0][:2], name), key=lambda found: max(found[0]))
                    failures += [f"{case}: {value!r}" for value in over if not value <= 1.0]
                feet = f"{worst[0][1]:8.6f}" if unit == "%height" else " " * 8
                print(
                    f"{method:<9} {align:<8} {amount:>5g}{unit:<8} {keys:6} {worst[0][0]:24.6f} {feet}  {worst[1]:<24}"
                    f" {process_time() - started:6.1f}",
                    flush=True,
                )
    print(*(failures or ["every promise kept"]), sep="\n")
    sys.exit(1 if failures else 0)


if __name__ == "__main__":
    main()
