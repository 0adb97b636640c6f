"""B-spline fits beside SciPy's: the same knots, and the knots that each chooses for the same largest error.

    python benchmarks/fit.py [--rounds 9] [--channels 4] [--tolerance 0.5]

Same knots: 5000 frames x 66 channels, 333 coefficients, beside make_lsq_spline; medians of processor times and of
the ratios within a round, on one core. Knots: the channels with the widest range of each clip, one at a time. SciPy's
make_splrep and FITPACK (splrep) choose their own knots for a sum of squares; the largest sum that keeps the largest
error within the tolerance is found by bisection. Last, whole clips: each way to
choose knots, and that its promise holds.
"""

from __future__ import annotations

from argparse import ArgumentParser
from collections.abc import Callable
from statistics import median
from time import process_time

import clips
import numpy as np
from scipy.interpolate import BSpline, make_lsq_spline, make_splrep, splev, splrep

from mocurve import Motion, Skeleton, bspline, bspline_fit, fitting, kinematics, read, unroll

SAME, FASTER, FEWER = 1e-9, 0.5, 0.8
STEPS = 12  # of the bisection: sums of squares within a third of a percent
FRAMES = 800  # of each clip, at most: make_splrep takes seconds a curve
CLIPS = ["cmu/cmu_01_01_jump", "cmu/cmu_12_01_walk", "cmu/cmu_02_03_run", "other/rokoko_dance_fingers"]
ALONE = Skeleton(("A",), [-1], np.zeros((1, 3)), [("Zrotation",)])


def seconds(work: Callable[[], object]) -> float:
    start = process_time()
    work()
    return process_time() - start


def same_knots(rounds: int) -> tuple[float, float]:
    """The median ratio of times and the largest difference of coefficients over the largest sample."""
    rng = np.random.default_rng(0)
    at = np.arange(5000) / 120.0
    samples = np.asfortranarray(np.cumsum(rng.normal(size=(5000, 66)), axis=0))
    knots = bspline.clamped(np.linspace(0.0, at[-1], 331))
    ours, theirs = bspline_fit.least_squares(knots, 3, at, samples), make_lsq_spline(at, samples, knots, 3).c
    off = float(np.abs(ours - theirs).max() / np.abs(samples).max())
    works = [lambda: bspline_fit.least_squares(knots, 3, at, samples), lambda: make_lsq_spline(at, samples, knots, 3)]
    times = np.array([[seconds(work) for work in works] for _ in range(rounds)])
    mine, peer = np.median(times, axis=0) * 1000.0
    ratio = median(times[:, 0] / times[:, 1])
    print(
        f"same knots, 5000 x 66, {len(ours)} coefficients: {mine:.2f} ms, make_lsq_spline {peer:.2f} ms: {ratio:.3f}x"
    )
    print(f"largest difference: {off:.1e} of the largest sample")
    return ratio, off


def make_splrep_knots(at: np.ndarray, samples: np.ndarray, squares: float) -> tuple[int, float]:
    found = make_splrep(at, samples, s=squares)
    return len(found.c), float(np.abs(found(at) - samples).max())


def fitpack_knots(at: np.ndarray, samples: np.ndarray, squares: float) -> tuple[int, float]:
    knots, values, degree = splrep(at, samples, s=squares)
    return len(knots) - degree - 1, float(np.abs(splev(at, (knots, values, degree)) - samples).max())


def least(
    choose: Callable[[np.ndarray, np.ndarray, float], tuple[int, float]],
    at: np.ndarray,
    samples: np.ndarray,
    tolerance: float,
) -> int:
    """Fewest coefficients seen with the largest error within the tolerance, over sums of squares by bisection."""
    low, high = np.log(len(at) * tolerance**2 * 1e-6), np.log(len(at) * tolerance**2 * 4.0)
    best = len(at)
    for _ in range(STEPS):
        middle = 0.5 * (low + high)
        count, off = choose(at, samples, float(np.exp(middle)))
        if off <= tolerance:
            best, low = min(best, count), middle
        else:
            high = middle
    return best


PEERS = (make_splrep_knots, fitpack_knots)


def chosen_knots(tolerance: float, channels: int) -> list[float]:
    """Print a row a clip; the ratios of all coefficients to those of the better peer."""
    print(f"\n{'clip':<24} channels  mocurve  make_splrep  FITPACK  ratio to the better   ({tolerance:g} degrees)")
    ratios = []
    for name in CLIPS:
        motion = unroll(read(clips.folder() / f"{name}.bvh"))[:FRAMES]
        turning = np.flatnonzero(motion.skeleton.rotation_channels)
        widest = turning[np.argsort(-np.ptp(motion.values[:, turning], axis=0))][:channels]
        at, counts = np.arange(motion.frames) * motion.frame_time, np.zeros(3, int)
        for channel in widest:
            samples = motion.values[:, channel]
            fit = fitting.fit(Motion(ALONE, samples[:, None], motion.frame_time), tolerance=f"{tolerance}deg")
            off = np.abs(BSpline(fit.knots, fit.values[:, 0], 3)(at) - samples).max()
            assert off <= tolerance, off
            peers = [least(choose, at, samples, tolerance) for choose in PEERS]
            counts += [len(fit.values), *peers]
        ratios.append(counts[0] / min(counts[1:]))
        print(f"{name.split('/')[1]:<24} {len(widest):8} {counts[0]:8} {counts[1]:12} {counts[2]:8} {ratios[-1]:8.3f}")
    return ratios


def all_channels() -> None:
    """Print a row a clip and tolerance: coefficients a channel of each way to choose knots, the promise checked."""
    head = "".join(f"{name:>20}" for name in fitting.KNOTS)
    print(f"\n{'all channels on the same knots':<32} frames{head}   (coefficients a channel, seconds)")
    for name in CLIPS:
        motion = read(clips.folder() / f"{name}.bvh")[:FRAMES]
        plain, height = unroll(motion, triples=False), kinematics.rest_height(motion)
        for tolerance, most in (("0.5%height", 0.005 * height), ("1deg", 1.0)):
            row = f"{name.split('/')[1]:<21} {tolerance:<10} {motion.frames:6}"
            for knots in fitting.KNOTS:
                start = process_time()
                made = fitting.fit(motion, tolerance=tolerance, knots=knots, feet=1.0)
                took, samples = process_time() - start, made.sample()
                if tolerance == "1deg":
                    off = np.abs(samples.values - plain.values)[:, motion.skeleton.rotation_channels].max()
                else:
                    off = np.linalg.norm(kinematics.world(samples) - kinematics.world(motion), axis=2).max()
                assert off <= most, (name, tolerance, knots, off)
                row += f"{len(made.values):12} {took:6.2f}s"
            print(row)


def main() -> None:
    asked = ArgumentParser()
    asked.add_argument("--rounds", type=int, default=9)
    asked.add_argument("--channels", type=int, default=4)
    asked.add_argument("--tolerance", type=float, default=0.5)
    options = asked.parse_args()
    ratio, off = same_knots(options.rounds)
    ratios = chosen_knots(options.tolerance, options.channels)
    all_channels()
    print(f"\ntime {ratio:.3f}x   least {FASTER:g}x; difference {off:.1e}   least {SAME:g}")
    print(f"coefficients {median(ratios):.3f}x ({min(ratios):.3f} to {max(ratios):.3f})   least {FEWER:g}x")


if __name__ == "__main__":
    main()
