"""Does reduction alone filter? Önder's claim, measured on real clips with noise added, beside filters made for it.

    python benchmarks/filters.py [--check]

Writes its table into docs/papers/onder-2007.md; with --check it only prints it. The clips are the held-out real ones
of `noise.py`, unfiltered, at 120 and 30 fps, with white noise of 0.2, 0.5 and 1 degree; nine rotation channels each.
"knowing the truth" means that the setting is the best for each channel, of a list, by its error to the truth.
"""

from __future__ import annotations

import re
from argparse import ArgumentParser
from collections.abc import Callable, Iterable
from typing import NamedTuple

import numpy as np
from denoise import kept, peaks, rmse
from denoise_reduce import motion_of
from noise import JITTER, SIGMAS, Case, butterworth, cases, oracle
from onder_tables import PAGE, table
from scipy.signal import savgol_filter

import mocurve as mc
from mocurve import hermite
from mocurve.reduction import dynamic, linear, optimal, split
from mocurve.reduction.keys import Keys

RATES = (120, 30)
TIMES_SIGMA = (1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0)
RATIOS = (0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5)
WINDOWS = (1, 5, 7, 9, 11, 15, 21, 31, 41, 61, 81)


class Filtered(NamedTuple):
    """Values (F, C) and keys a frame and channel."""

    values: np.ndarray
    keys: float


Filter = Callable[[Case], Filtered]


def every_frame(work: Callable[[Case], np.ndarray]) -> Filter:
    return lambda case: Filtered(work(case), 1.0)


def reduced(case: Case, method: Callable[[np.ndarray], Keys], samples: np.ndarray | None = None) -> Filtered:
    """Every channel as keys, sampled at the frames again."""
    samples = case.noisy if samples is None else samples
    at = np.arange(len(samples))
    found = [method(np.ascontiguousarray(channel)) for channel in samples.T]
    arriving = [None if k.in_slopes is None else k.in_slopes[0] for k in found]
    values = [
        hermite.evaluate(k.frames, k.values[0], k.slopes[0], at, slopes)
        for k, slopes in zip(found, arriving, strict=True)
    ]
    return Filtered(np.stack(values, axis=1), sum(len(k.frames) for k in found) / samples.size)


def within(solve: Callable[..., Keys], times: float) -> Filter:
    """A method at a tolerance of some sigmas."""
    return lambda case: reduced(case, lambda y: solve(y[None], np.full((1, len(y)), times * case.sigma), "default"))


def by_ratio(ratio: float) -> Filter:
    return lambda case: reduced(case, lambda y: split.with_ratio(y, ratio))


def best(filters: Iterable[Filter]) -> Filter:
    """For each channel the filter that comes nearest to the truth."""
    tried = list(filters)

    def work(case: Case) -> Filtered:
        values, keys = np.empty_like(case.truth), 0.0
        for channel in range(case.truth.shape[1]):
            one = case._replace(truth=case.truth[:, [channel]], noisy=case.noisy[:, [channel]])
            found = min((run(one) for run in tried), key=lambda result: rmse(result.values, one.truth))
            values[:, channel] = found.values[:, 0]
            keys += found.keys / case.truth.shape[1]
        return Filtered(values, keys)

    return work


def savitzky_golay(window: int) -> Filter:
    """Cubic, over a window of frames, or of all there are; a window of 1 does nothing."""
    if window == 1:
        return every_frame(lambda case: case.noisy)
    return every_frame(lambda case: savgol_filter(case.noisy, min(window, (len(case.noisy) - 1) | 1), 3, axis=0))


def as_keys(case: Case) -> Filtered:
    keys = mc.reduce(motion_of(case), denoise=True)
    return Filtered(keys.sample().values, keys.keys / case.noisy.size)


def filters() -> dict[str, Filter]:
    """The rows of the table."""
    rows: dict[str, Filter] = {"the noisy samples": every_frame(lambda case: case.noisy)}
    rows |= {f"split, ratio {ratio:g}": by_ratio(ratio) for ratio in (0.001, 0.01, 0.1)}
    rows["split, ratio knowing the truth"] = best(map(by_ratio, RATIOS))
    rows["dynamic, as in the thesis"] = lambda case: reduced(case, dynamic.thesis_keys)
    for name, solve in {"split": split, "dynamic": dynamic, "linear": linear, "optimal": optimal}.items():
        rows[f"{name}, 2 sigma"] = within(solve.solve, 2.0)
        rows[f"{name}, tolerance knowing the truth"] = best(within(solve.solve, times) for times in TIMES_SIGMA)
    rows["Savitzky-Golay, 11 frames"] = savitzky_golay(11)
    rows["Savitzky-Golay, window knowing the truth"] = best(map(savitzky_golay, WINDOWS))
    rows["Butterworth, 6 Hz"] = every_frame(lambda case: butterworth(case.noisy, 6.0, case.fps))
    rows["Butterworth, cut-off knowing the truth"] = every_frame(lambda case: oracle(case.truth, case.noisy, case.fps))
    rows["`mc.denoise`"] = every_frame(lambda case: mc.denoise(motion_of(case)).values)
    rows["`mc.reduce(clip, denoise=True)`"] = as_keys
    return rows


def measured(run: Filter, chosen: list[Case]) -> list[str]:
    """A row: error / noise by rate and sigma; peaks and keys by rate at the middle sigma."""
    results = [(case, run(case)) for case in chosen]
    errors, keys, sharp = [], [], []
    for rate in RATES:
        for sigma in SIGMAS:
            mine = [(c, r) for c, r in results if c.rate == rate and c.sigma == sigma]
            errors.append(f"{np.mean([rmse(r.values, c.truth) / sigma for c, r in mine]):.2f}")
        mine = [(c, r) for c, r in results if c.rate == rate and c.sigma == SIGMAS[1]]
        keys.append(f"{np.mean([r.keys for _, r in mine]):.2f}")
        found = [{"peaks": peaks(r.values, r.values, c.truth, c.sigma)} for c, r in mine]
        sharp.append(kept(found).split()[0])
    per_rate = len(SIGMAS)
    return [*(" ".join(errors[k * per_rate : (k + 1) * per_rate]) for k in range(len(RATES))), *sharp, *keys]


def chosen_cases() -> list[Case]:
    """Held-out raw clips, their nine rotation channels."""
    found = [case for case in cases("held", kinds=(JITTER,)) if case.shape == "raw" and case.rate in RATES]
    return [
        case._replace(truth=case.truth[:, :9], noisy=case.noisy[:, :9], groups=case.groups[:3])
        for case in found
        if case.name.endswith("/0")
    ]


def main() -> None:
    asked = ArgumentParser()
    asked.add_argument("--check", action="store_true", help="print the table, write nothing")
    options = asked.parse_args()
    chosen = chosen_cases()
    rows = []
    for name, run in filters().items():
        rows.append([name, *measured(run, chosen)])
        print(" | ".join(rows[-1]), flush=True)
    sigmas = ", ".join(f"{sigma:g}" for sigma in SIGMAS)
    head = ["method", *(f"error / noise, {rate} fps, noise {sigmas} deg" for rate in RATES)]
    head += [f"peaks, {rate} fps" for rate in RATES] + [f"keys / frames, {rate} fps" for rate in RATES]
    text = table(head, rows)
    page = PAGE.read_text(encoding="utf-8")
    marked = re.compile("(<!-- noise -->\n).*?(<!-- end -->)", re.DOTALL)
    if not options.check:
        PAGE.write_text(marked.sub(lambda found: f"{found[1]}{text}\n{found[2]}", page), encoding="utf-8")


if __name__ == "__main__":
    main()
