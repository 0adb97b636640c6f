"""Keys and speed of `optimal`: keys / proven lower bound, live channel-frames a second on one core, for every quality.

    python benchmarks/optimal.py [--step 1] [--frames 1000] [--rounds 3] [--peer FILE.py]

Channels: every `step`-th live rotation channel (range > 0.02 deg) of all BVH clips in cmu and other, unrolled, the
first `frames` frames. Processor time, median of the rounds; all take turns in every round, after a call that compiles.
The peer is a Python file with `reduce_channel(y, tolerance, 3, 1, 15, 6)`, such as the prototype
reduction_kernels.py beside the clips, taken if there. "long / short" is the cost of a frame at 8000 frames to that at
500, on random walks.
"""

from __future__ import annotations

import sys
import warnings
from argparse import ArgumentParser
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from statistics import median
from time import process_time
from typing import Any

import numpy as np
from clips import folder

import mocurve as mc
from mocurve.reduction.bound import lower_bound
from mocurve.reduction.optimal import SETTINGS, search, solve

TOLERANCES = (0.1, 0.25, 0.5, 1.0)  # degrees
GOALS = "keys / bound: default least 1.39, aim 1.32; best least 1.29, aim 1.26; default / peer least 1, aim 2"


def live_channels(frames: int, step: int) -> list[np.ndarray]:
    """Channels (1, F)."""
    found = []
    for path in sorted([*folder().glob("cmu/*.bvh"), *folder().glob("other/*.bvh")]):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            motion = mc.unroll(mc.read(path))
        values = motion.values[:frames, motion.skeleton.rotation_channels]
        found += [
            np.ascontiguousarray(v)[None]
            for v in values[:, np.ptp(motion.values[:, motion.skeleton.rotation_channels], axis=0) > 0.02].T
        ]
    return found[::step]


def peer(path: Path) -> Callable[..., Any] | None:
    """The peer's reduce_channel, if its file is there."""
    if not path.is_file():
        return None
    sys.path.insert(0, str(path.parent))  # a kernel that was cached finds its module by name
    return import_module(path.stem).reduce_channel


def timed(reduce: Callable[[np.ndarray], int], channels: list[np.ndarray]) -> tuple[float, int]:
    """Processor seconds, and keys of all channels."""
    start = process_time()
    keys = sum(reduce(y) for y in channels)
    return process_time() - start, keys


def walks(count: int, frames: int) -> list[np.ndarray]:
    """Smooth random walks (1, F)."""
    rng = np.random.default_rng(0)
    steps = (np.convolve(rng.normal(size=frames + 59), np.hanning(30), "valid")[:frames] for _ in range(count))
    return [np.cumsum(step)[None] * 0.5 for step in steps]


def main() -> None:
    asked = ArgumentParser()
    asked.add_argument("--step", type=int, default=1)
    asked.add_argument("--frames", type=int, default=1_000_000)
    asked.add_argument("--rounds", type=int, default=3)
    asked.add_argument("--peer", type=Path, default=folder().parent / "prototypes" / "reduction_kernels.py")
    options = asked.parse_args()
    clip = [y for y in live_channels(options.frames, options.step) if y.shape[1] > 2]
    cells = sum(y.size for y in clip)
    other = peer(options.peer)
    print(f"{len(clip)} channels, {cells} channel-frames\n{GOALS}")
    for tolerance in TOLERANCES:
        methods: dict[str, Callable[[np.ndarray], int]] = {
            quality: lambda y, q=quality, t=tolerance: len(solve(y, np.full_like(y, t), q).frames)
            for quality in SETTINGS
        }
        if other:
            methods = {"peer": lambda y, t=tolerance: len(other(y[0], t, 3, 1, 15, 6)[0]), **methods}
        methods["bound"] = lambda y, t=tolerance: lower_bound(y, np.full_like(y, t))
        for reduce in methods.values():
            timed(reduce, clip[:1])
        rounds = [{name: timed(reduce, clip) for name, reduce in methods.items()} for _ in range(options.rounds)]
        bound = rounds[0]["bound"][1]
        mended = sum(search(y, np.full_like(y, tolerance), *SETTINGS["default"])[3].sum() for y in clip)
        print(f"{tolerance:g} deg: bound {bound / cells:.4f} keys a frame, {mended} segments mended")
        for name in methods:
            speed = cells / median(r[name][0] for r in rounds) / 1000
            ratio = f"{median(r['peer'][0] / r[name][0] for r in rounds):5.2f} x the peer" if other else ""
            print(f"    {name:8} {rounds[0][name][1] / bound:.4f}  {speed:8.0f} k/s  {ratio}")
    short, long = walks(64, 500), walks(4, 8000)
    for quality in SETTINGS:
        costs = [
            [timed(lambda y, q=quality: len(solve(y, np.full_like(y, 0.3), q).frames), c)[0] for c in (long, short)]
            for _ in range(options.rounds)
        ]
        print(f"long / short, {quality:8} {median(a / b for a, b in costs):.2f}")


if __name__ == "__main__":
    main()
