"""Speed of split, linear and dynamic beside `optimal`, on the thesis's longer size: 1409 frames x 84 channels, one
core.

    python benchmarks/methods.py [--rounds 5] [--tolerance 0.5]

The channels are the 84 with the largest range of the first 1409 frames of a dance (CMU 94_01, 120 fps, frame 0 left
out, unrolled). All methods take turns in every round, after one round that compiles; medians of processor time are
told. "no tolerance" is the full search with 81 states a key from the thesis's initial keys; keys and error at the end
are told for each.
"""

from __future__ import annotations

from argparse import ArgumentParser
from collections.abc import Callable
from statistics import median
from time import process_time

import numpy as np
from clips import folder

import mocurve as mc
from mocurve import hermite
from mocurve.reduction import dynamic, linear, optimal, split
from mocurve.reduction.keys import Keys

FRAMES, CHANNELS = 1409, 84


def channels() -> list[np.ndarray]:
    """84 channels (1, 1409)."""
    motion = mc.unroll(mc.read(folder() / "cmu" / "cmu_94_01_dance_max.bvh")[1 : FRAMES + 1])
    values = motion.values[:, motion.skeleton.rotation_channels]
    lively = np.sort(np.argsort(np.ptp(values, axis=0))[-CHANNELS:])
    return [np.ascontiguousarray(values[:, channel])[None] for channel in lively]


def error(y: np.ndarray, keys: Keys) -> np.ndarray:
    """Curve - samples (F,)."""
    arriving = None if keys.in_slopes is None else keys.in_slopes[0]
    return hermite.evaluate(keys.frames, keys.values[0], keys.slopes[0], np.arange(y.shape[1]), arriving) - y[0]


def main() -> None:
    asked = ArgumentParser()
    asked.add_argument("--rounds", type=int, default=5)
    asked.add_argument("--tolerance", type=float, default=0.5, help="degrees")
    options = asked.parse_args()
    clip = channels()
    half = np.full((1, clip[0].shape[1]), options.tolerance)
    at = f"{options.tolerance:g} deg"
    methods: dict[str, Callable[[np.ndarray], Keys]] = {
        f"optimal, {at}": lambda y: optimal.solve(y, half, "default"),
        "split, ratio 0.01": lambda y: split.with_ratio(y[0], 0.01),
        f"split, {at}": lambda y: split.solve(y, half),
        f"linear, {at}": lambda y: linear.solve(y, half),
        "dynamic, no tolerance": lambda y: dynamic.thesis_keys(y[0]),
        f"dynamic, {at}": lambda y: dynamic.solve(y, half),
    }
    took: dict[str, list[float]] = {name: [] for name in methods}
    for turn in range(options.rounds + 1):
        for name, method in methods.items():
            started = process_time()
            for y in clip if turn else clip[:2]:
                method(y)
            if turn:
                took[name].append(process_time() - started)
    base = median(took[next(iter(methods))])
    print(f"{len(clip)} channels x {clip[0].shape[1]} frames, median of {options.rounds}")
    for name, method in methods.items():
        found = [method(y) for y in clip]
        errors = np.concatenate([error(y, keys) for y, keys in zip(clip, found, strict=True)])
        seconds, keys = median(took[name]), np.mean([len(k.frames) for k in found])
        speed = f"{seconds * 1000:7.1f} ms  {seconds / base:6.2f} x optimal  {errors.size / seconds / 1e6:6.2f} M/s"
        off = f"rms {np.sqrt((errors**2).mean()):.3f}  max {np.abs(errors).max():.3f}"
        print(f"{name:<24} {speed}  {keys:6.1f} keys a channel  {off}")
    print("bars: split with ratio and linear at least 5 M/s; dynamic at most 20 x optimal (aim 5)")


if __name__ == "__main__":
    main()
