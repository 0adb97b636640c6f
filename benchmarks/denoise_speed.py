"""Speed of denoising beside scipy's filters, 99 channels x 5000 frames, one core.

    python benchmarks/denoise_speed.py [--rounds 5]

The channels are live rotations of a dance (CMU 94_01, 120 fps, forwards and backwards, some joints twice) with 0.5
degree of noise, without artefacts and with 1 % spikes. All take turns in every round, after one that compiles; medians
of processor time. A filter needs its cut-off or window told; `make_smoothing_spline` finds its own, on a small part.
"""

from __future__ import annotations

from argparse import ArgumentParser
from collections.abc import Callable
from statistics import median
from time import process_time

import numpy as np
from artefacts import KINDS
from clips import folder
from noise import butterworth, seeded
from scipy.interpolate import make_smoothing_spline
from scipy.signal import savgol_filter

import mocurve as mc
from mocurve.denoising import clean

JOINTS, FRAMES, FPS = 33, 5000, 120.0
SMALL = (500, 3)  # frames and channels for the spline


def samples() -> tuple[np.ndarray, np.ndarray, list[np.ndarray]]:
    """(5000, 99) with jitter, the same with spikes too, and the joints' columns."""
    motion = mc.unroll(mc.read(folder() / "cmu" / "cmu_94_01_dance_max.bvh")[1:])
    turning = motion.skeleton.rotation_channels
    live = [k for k in range(3, motion.skeleton.channel_count, 3) if turning[k] and np.ptp(motion.values[:, k]) > 1]
    chosen = [column for k in range(JOINTS) for column in range(live[k % len(live)], live[k % len(live)] + 3)]
    there_and_back = np.concatenate([motion.values, motion.values[::-1]])[:FRAMES, chosen]
    rng = seeded("speed")
    jittery = there_and_back + 0.5 * rng.standard_normal(there_and_back.shape)
    groups = [np.arange(k, k + 3) for k in range(0, 3 * JOINTS, 3)]
    return jittery, KINDS["spikes"](rng, jittery, groups)[0], groups


def splines(values: np.ndarray) -> None:
    frames = np.arange(len(values), dtype=float)
    for channel in values.T:
        make_smoothing_spline(frames, channel)


def main() -> None:
    asked = ArgumentParser()
    asked.add_argument("--rounds", type=int, default=5)
    options = asked.parse_args()
    jittery, spiky, groups = samples()
    small = jittery[: SMALL[0], : SMALL[1]]
    work: dict[str, tuple[Callable[[], object], int]] = {
        "denoise": (lambda: clean(jittery, FPS, groups), jittery.size),
        "denoise, 1 % spikes": (lambda: clean(spiky, FPS, groups), spiky.size),
        "Butterworth, both ways": (lambda: butterworth(jittery, 6.0, FPS), jittery.size),
        "Savitzky-Golay, 11": (lambda: savgol_filter(jittery, 11, 3, axis=0), jittery.size),
        "make_smoothing_spline": (lambda: splines(small), small.size),
    }
    took: dict[str, list[float]] = {name: [] for name in work}
    for turn in range(options.rounds + 1):
        for name, (run, _) in work.items():
            started = process_time()
            run()
            if turn:
                took[name].append(process_time() - started)
    print(f"{jittery.shape[1]} channels x {len(jittery)} frames, median of {options.rounds}")
    for name, (_, size) in work.items():
        print(f"{name:<24}{size / median(took[name]) / 1e6:9.3f} M channel-frames/s")
    print("least: 0.5 M without artefacts, 0.2 M with spikes (aims 1 and 0.5)")


if __name__ == "__main__":
    main()
