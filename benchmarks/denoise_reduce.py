"""Denoise and reduce in one step against denoising alone, and against reducing the noisy clip.

    python benchmarks/denoise_reduce.py [--set tune|held|fresh|last] [--quick]

`mc.reduce(clip, denoise=True)` has its tolerance from the noise. Told: RMSE to the truth as a ratio to the oracle's
and to that of `mc.denoise`; keys a frame and channel; the least RMSE that plain `mc.reduce` on the noisy clip reaches
at any tolerance in degrees, as a ratio to this; and the keys of both at an equal error, the larger of the two: each
with the largest tolerance whose error is within it.
"""

from __future__ import annotations

import warnings
from argparse import ArgumentParser

import numpy as np
from denoise import SHAPES, rmse
from noise import JITTER, RATES, SETS, Case, cases, oracle

import mocurve as mc
from mocurve.skeleton import Skeleton

TIMES_SIGMA = np.geomspace(0.3, 8.0, 14)


def motion_of(case: Case) -> mc.Motion:
    """The noisy channels as a chain of joints that turn."""
    count = len(case.groups)
    skeleton = Skeleton(
        tuple(f"joint{k}" for k in range(count)),
        np.arange(count) - 1,
        np.tile([0.0, 10.0, 0.0], (count, 1)),
        (("Zrotation", "Yrotation", "Xrotation"),) * count,
    )
    return mc.Motion(skeleton, case.noisy, 1 / case.fps)


def tried(case: Case, motion: mc.Motion, denoise: bool) -> list[tuple[float, float]]:
    """RMSE to the truth and keys a sample, by tolerance."""
    found = []
    for times in TIMES_SIGMA:
        keys = mc.reduce(motion, tolerance=f"{times * case.sigma}deg", denoise=denoise)
        found.append((rmse(keys.sample().values, case.truth), keys.keys / case.truth.size))
    return found


def row(case: Case) -> tuple[float, ...]:
    """RMSE denoised and as keys / the oracle's, as keys / denoised; keys; least plain error / ours; keys at an equal
    error / plain keys."""
    motion = motion_of(case)
    best = rmse(oracle(case.truth, case.noisy, case.fps), case.truth)
    alone = rmse(mc.denoise(motion).values, case.truth)
    made = mc.reduce(motion, denoise=True)
    error, keys = rmse(made.sample().values, case.truth), made.keys / case.truth.size
    plain, ours = tried(case, motion, False), [(error, keys), *tried(case, motion, True)]
    least = min(plain)[0]
    equal = max(error, least)
    mine, others = (min(k for e, k in side if e <= equal) for side in (ours, plain))
    return alone / best, error / best, error / alone, keys, least / error, mine / others


def main() -> None:
    asked = ArgumentParser()
    asked.add_argument("--set", choices=list(SETS), default="held")
    asked.add_argument("--quick", action="store_true")
    options = asked.parse_args()
    warnings.simplefilter("ignore")
    found: dict[tuple[str, int], list[tuple[float, ...]]] = {}
    for case in cases(options.set, options.quick, (JITTER,)):
        if case.name.endswith("/0"):
            found.setdefault((case.shape, case.rate), []).append(row(case))
    print(f"{'':12}{'RMSE / oracle':>18}{'as keys / denoised':>24}{'keys':>8}{'least plain':>13}{'keys / plain':>14}")
    print(
        f"{'':12}{'denoised':>10}{'keys':>8}{'mean':>10}{'q90':>7}{'worst':>7}{'/ frame':>8}{'error':>13}{'':>14}    n"
    )
    for shape in (*SHAPES, "all"):
        for rate in RATES if shape != "all" else (None,):
            cell = [one for key, rows in found.items() if rate is None or key == (shape, rate) for one in rows]
            if cell:
                alone, keyed, ratio, keys, least, fewer = np.array(cell).T
                text = f"{shape:8}{rate or '':>4}{alone.mean():10.3f}{keyed.mean():8.3f}{ratio.mean():10.3f}"
                text += f"{np.quantile(ratio, 0.9):7.3f}{ratio.max():7.3f}{keys.mean():8.3f}{least.mean():13.2f}"
                print(f"{text}{np.exp(np.log(fewer).mean()):14.2f}{len(cell):5}")
    print("least: as keys at most 1.02 of denoised")


if __name__ == "__main__":
    main()
