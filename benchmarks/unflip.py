"""Euler flips taken out: how many rewritten frames come back to the curve that they were taken from.

    python benchmarks/unflip.py [--set tune|held]

All live joints of the clips with three rotations about three axes, at 120, 60 and 30 fps, unrolled once: the truth,
with jitter or spikes added as said. Then random runs of frames (1 to 40, about a tenth of all) are written with the
other Euler triple of the same rotation, and as many with whole turns in one angle. Told: frames that were rewritten
and came back, frames that were not and left, joints wholly right, and frames off by more than 90 degrees in any angle.
"""

from __future__ import annotations

import warnings
from argparse import ArgumentParser
from collections.abc import Callable, Iterator

import numpy as np
from artefacts import KINDS
from clips import folder
from noise import FRAMES, RATES, SETS, seeded

import mocurve as mc
from mocurve.rotation import unroll_euler

METHODS: dict[str, Callable[[np.ndarray, str], np.ndarray]] = {
    "whole turns only": lambda degrees, _: np.unwrap(degrees, period=360.0, axis=0),
    "mocurve.unroll": unroll_euler,
}
NOISES = {"clean": 0.0, "jitter 0.5": 0.5, "jitter 1": 1.0, "jitter 0.5, spikes": 0.5}


def joints(which: str, rate: int) -> Iterator[tuple[str, np.ndarray, str]]:
    """Name, angles (F, 3) and order of every live joint."""
    for clip, source in SETS[which].items():
        motion = mc.unroll(mc.read(folder() / source.path)[source.first :])
        start = 0
        for name, kinds in zip(motion.skeleton.names, motion.skeleton.channels, strict=True):
            turning = [start + k for k, kind in enumerate(kinds) if kind.endswith("rotation")]
            order = "".join(kinds[k - start][0] for k in turning)
            start += len(kinds)
            if len(set(order)) == 3 and len(order) == 3 and np.ptp(motion.values[:, turning], axis=0).max() > 2:
                yield f"{clip} {name} {rate}", motion.values[:, turning][:: RATES[0] // rate][:FRAMES], order


def rewritten(rng: np.random.Generator, degrees: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The same rotations (F, 3) in other words, and the frames (F,) where."""
    result, touched = degrees.copy(), np.zeros(len(degrees), bool)
    for twin in (True, False):
        while touched.mean() < (0.1 if twin else 0.2):
            length = 1 if rng.random() < 0.5 else int(rng.integers(2, 41))
            first = int(rng.integers(1, max(2, len(degrees) - length)))
            run = slice(first, first + length)
            if twin:
                a, b, c = result[run].T
                result[run] = np.stack([a + 180, 180 - b, c + 180], axis=1)
            else:
                result[run, rng.integers(3)] += rng.choice([-360.0, 360.0])
            touched[run] = True
    touched = (np.abs(result - degrees) > 1.0).any(axis=1)  # twice rewritten may be once more the same
    return result, touched


def main() -> None:
    asked = ArgumentParser()
    asked.add_argument("--set", choices=["tune", "held"], default="held")
    options = asked.parse_args()
    warnings.simplefilter("ignore")
    print(f"{'':36}{'came back':>12}{'left':>10}{'right joints':>14}{'of':>6}{'frames off':>12}")
    for noise, sigma in NOISES.items():
        told = {name: np.zeros(6) for name in METHODS}
        for rate in RATES:
            for name, truth, order in joints(options.set, rate):
                rng = seeded(f"{name} {noise}")
                samples = truth + sigma * rng.standard_normal(truth.shape)
                if "spikes" in noise:
                    samples, _ = KINDS["spikes"](rng, samples, [np.arange(3)])
                asked_of, touched = rewritten(rng, samples)
                for method, work in METHODS.items():
                    off = (np.abs(work(asked_of, order) - samples) > 90).any(axis=1)
                    counts = touched & ~off, touched, off & ~touched, ~touched, off
                    told[method] += [*(count.sum() for count in counts), not off.any()]
        number = sum(1 for rate in RATES for _ in joints(options.set, rate))
        for method, (back, of, left, others, off, right) in told.items():
            shares = f"{100 * back / of:11.2f}%{100 * left / others:9.2f}%"
            label = f"{noise}: {method}"
            print(f"{label:<36}{shares}{int(right):8}{number:6}{100 * off / (of + others):11.2f}%")


if __name__ == "__main__":
    main()
