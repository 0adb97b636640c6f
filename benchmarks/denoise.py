"""Denoising without settings beside the best Butterworth filter that knows the truth: jitter, then artefacts.

    python benchmarks/denoise.py [--set tune|held|fresh|last] [--quick] [--kinds jitter ...] [--json FILE] [--workers N]

Every error is an RMSE over a case's channels, told as a ratio to the *oracle*: a second-order Butterworth filter, both
ways, for each channel the best of 21 cut-offs knowing the truth, on the data without artefacts. *known* is the same
method told the true artefact frames (for lasting offsets, their sizes): the bound for any detector in front of it. The
peer is a Hampel filter (11 frames, 3 deviations) in front of the Butterworth filter that knows the truth.
Recall counts the samples that are off by over 5 sigma; precision and recall are over frames x channels. *Peaks* are the
largest second differences near the three largest of the truth, where these exceed 5 sigma, as a part of the truth's.
Parameters were chosen on `tune`, with an eye on `held`, later ones on `fresh` too; `last` was run once all were
settled. *leaps* are the *bursts* without frozen ones.
"""

from __future__ import annotations

import json
from argparse import ArgumentParser
from collections.abc import Callable, Iterable
from functools import partial
from multiprocessing import get_context
from pathlib import Path
from time import process_time
from typing import Any

import numpy as np
from artefacts import KINDS
from noise import JITTER, RATES, SIGMAS, Case, cases, oracle
from scipy.ndimage import median_filter

Row = dict[str, Any]
Clean = Callable[..., Any]  # (values, fps, groups, *, known=None) -> .values, .masked
SHAPES = ("lp6", "raw", "impact")
FREE = (JITTER, "correlated")  # kinds without artefacts
HEAD = f"{'median':>9}{'mean':>7}{'q90':>7}{'worst':>7}"


def rmse(values: np.ndarray, truth: np.ndarray) -> float:
    return float(np.sqrt(((values - truth) ** 2).mean()))


def peaks(values: np.ndarray, best: np.ndarray, truth: np.ndarray, sigma: float) -> list[tuple[float, float, float]]:
    """Of each peak of the truth's second difference above 5 sigma: its size / sigma, and the parts of it that the
    values and the oracle keep."""
    found = []
    sizes, mine, others = (np.abs(np.diff(v, 2, axis=0)) for v in (truth, values, best))
    for channel in range(truth.shape[1]):
        left = sizes[:, channel].copy()
        for _ in range(3):
            at = int(left.argmax())
            size = sizes[at, channel]
            if left[at] <= 5 * sigma:
                break
            near = slice(max(0, at - 2), at + 3)
            kept = mine[near, channel].max() / size, others[near, channel].max() / size
            found.append((float(size / sigma), float(kept[0]), float(kept[1])))
            left[max(0, at - 6) : at + 7] = 0.0
    return found


def hampel(values: np.ndarray) -> np.ndarray:
    """(F, C): samples that are over 3 deviations off the median of 11 frames are replaced by it; straight lines over
    missing ones first."""
    frames, filled = np.arange(len(values)), values.copy()
    for channel in filled.T:
        there = ~np.isnan(channel)
        channel[:] = np.interp(frames, frames[there], channel[there])
    middle = median_filter(filled, (11, 1))
    away = np.abs(filled - middle)
    deviation = 1.4826 * median_filter(away, (11, 1))
    return np.where(away > 3 * deviation, middle, filled)


def scored(clean: Clean, case: Case) -> Row:
    """The numbers of one case."""
    best = oracle(case.truth, case.jittery, case.fps)
    started = process_time()
    result = clean(case.noisy, case.fps, case.groups)
    row: Row = {
        "name": case.name,
        "shape": case.shape,
        "kind": case.kind,
        "rate": case.rate,
        "sigma": case.sigma,
        "seconds": process_time() - started,
        "samples": case.truth.size,
        "oracle": rmse(best, case.truth),
        "rmse": rmse(result.values, case.truth),
        "masked": int(result.masked.sum()),
        "hits": int((result.masked & case.bad).sum()),
    }
    if case.kind in FREE:
        row["peaks"] = peaks(result.values, best, case.truth, case.sigma)
    else:
        lasts = case.kind == "lasting"  # so long that only its size, not its frames, helps
        given, told = (case.jittery, np.zeros_like(case.bad)) if lasts else (case.noisy, case.bad)
        known = clean(given, case.fps, case.groups, known=told)
        visible = case.bad & ~(np.abs(case.noisy - case.jittery) <= 5 * case.sigma)  # NaN is visible
        row["known"] = rmse(known.values, case.truth)
        row["peer"] = rmse(oracle(case.truth, hampel(case.noisy), case.fps), case.truth)
        row["visible"], row["seen"] = int(visible.sum()), int((visible & result.masked).sum())
    return row


def ratios(rows: Iterable[Row], by: str = "oracle") -> np.ndarray:
    return np.array([row["rmse"] / row[by] for row in rows])


def spread(ratio: np.ndarray) -> str:
    if not len(ratio):
        return f"{'-':>9}{'-':>7}{'-':>7}{'-':>7}"
    return f"{np.median(ratio):9.3f}{ratio.mean():7.3f}{np.quantile(ratio, 0.9):7.3f}{ratio.max():7.3f}"


def part(some: float, of: float) -> float:
    return some / of if of else float("nan")


def kept(rows: list[Row], least: float = 5.0) -> str:
    """Mean part of the peaks that the method and the oracle keep, and how many there are."""
    found = [peak for row in rows for peak in row["peaks"] if peak[0] > least]
    if not found:
        return f"{'-':>8}{'-':>8}{0:6}"
    mine, best = np.mean([peak[1:] for peak in found], axis=0)
    return f"{mine:8.2f}{best:8.2f}{len(found):6}"


def cut(rows: list[Row]) -> float:
    """Samples wrongly masked, in percent."""
    return 100 * part(sum(row["masked"] - row["hits"] for row in rows), sum(row["samples"] for row in rows))


def recall(rows: list[Row]) -> float:
    return part(sum(row["seen"] for row in rows), sum(row["visible"] for row in rows))


def precision(rows: list[Row]) -> float:
    return part(sum(row["hits"] for row in rows), sum(row["masked"] for row in rows))


def tell_jitter(rows: list[Row], kind: str) -> None:
    """RMSE / oracle where there are no artefacts."""
    mine = [row for row in rows if row["kind"] == kind]
    sigmas = [sigma for sigma in SIGMAS if any(row["sigma"] == sigma for row in mine)]
    print(f"\n{kind}: RMSE / oracle, medians by sigma, then pooled; parts of peaks kept, the oracle's, peaks; cut")
    print(
        f"{'':11}" + "".join(f"{sigma:>7} deg" for sigma in sigmas) + HEAD + f"{'peaks':>8}{'oracle':>8}{'n':>6}    cut"
    )
    for shape in SHAPES:
        for rate in RATES:
            cell = [row for row in mine if row["shape"] == shape and row["rate"] == rate]
            by_sigma = [ratios(row for row in cell if row["sigma"] == sigma) for sigma in sigmas]
            medians = "".join(f"{np.median(r) if len(r) else np.nan:11.3f}" for r in by_sigma)
            print(f"{shape:7}{rate:4}{medians}{spread(ratios(cell))}{kept(cell)}{cut(cell):6.3f}%")
    for sigma in sigmas:
        cell = [row for row in mine if row["sigma"] == sigma]
        label = f"{sigma:g} deg"
        print(f"{label:11}{'':{11 * len(sigmas)}}{spread(ratios(cell))}{kept(cell)}{cut(cell):6.3f}%")
    print(f"{'all':11}{'':{11 * len(sigmas)}}{spread(ratios(mine))}{kept(mine)}{cut(mine):6.3f}%")
    print(f"{len(mine)} cases; of the peaks above 20 sigma, parts kept:{kept(mine, 20.0)}")
    tell_worst(mine, "oracle")


def tell_worst(rows: list[Row], by: str) -> None:
    for row in sorted(rows, key=lambda row: -row["rmse"] / row[by])[:4]:
        masks = f"wrongly masked {row['masked'] - row['hits']}"
        if "visible" in row:
            masks += f", missed {row['visible'] - row['seen']} of {row['visible']}"
        print(f"    worst: {row['rmse'] / row[by]:7.3f} of {by}  {row['name']}, {masks}")


def tell_artefacts(rows: list[Row], kinds: list[str]) -> None:
    """RMSE / oracle and / known where there are."""
    print("\nartefacts: RMSE as a ratio to the oracle without artefacts, and to the method told the true frames")
    pair = f"{'mean':>9}{'median':>7}"
    print(f"{'':15}{'peer/oracle':>16}{'known/oracle':>16}{'method/oracle':>16}{'method/known':>16}")
    print(f"{'':15}{pair * 4}{'worst':>8}{'recall':>8}{'precision':>11}{'n':>5}")
    for kind in kinds:
        mine = [row for row in rows if row["kind"] == kind]
        for rate in (*RATES, None):
            cell = [row for row in mine if rate in (None, row["rate"])]
            if not cell:
                continue
            bounds = (np.array([row[name] / row["oracle"] for row in cell]) for name in ("peer", "known"))
            columns = *bounds, ratios(cell), ratios(cell, "known")
            numbers = "".join(f"{r.mean():9.3f}{np.median(r):7.3f}" for r in columns)
            found = f"{recall(cell):8.3f}{precision(cell):11.3f}"
            print(f"{kind:11}{rate or 'all':>4}{numbers}{columns[3].max():8.2f}{found}{len(cell):5}")
        tell_worst(mine, "known")


def tell_goals(rows: list[Row]) -> None:
    """What the project set itself, least, and whether it is reached."""

    def tell(what: str, value: float, least: float, below: bool = True) -> None:
        reached = value <= least if below else value >= least
        print(f"    {what:46}{value:8.3f}  least {least:<6g} {'' if reached else '  MISSED'}")

    def mine(*kinds: str) -> list[Row]:
        return [row for row in rows if row["kind"] in kinds]

    print("\ngoals")
    if jitter := mine(JITTER):
        ratio = ratios(jitter)
        for what, value, least in (
            ("median", np.median(ratio), 1.0),
            ("90 % quantile", np.quantile(ratio, 0.9), 1.1),
            ("worst", ratio.max(), 1.5),
        ):
            tell(f"jitter, of the oracle: {what}", float(value), least)
        tell("frames cut, %", cut(jitter), 0.03)
        cells = [[r for r in jitter if (r["shape"], r["rate"]) == (s, rate)] for s in SHAPES for rate in RATES]
        pairs = [kept(cell).split() for cell in cells if cell]
        more = min((float(a) - float(b) for a, b, count in pairs if count != "0"), default=0.0)
        tell("peaks kept more than by the oracle, least cell", more, 0.0, False)
    for rate, least in zip(RATES, (1.05, 1.25, 1.4), strict=True):
        if cell := [row for row in mine("spikes") if row["rate"] == rate]:
            tell(f"1 % spikes, {rate} fps, of the oracle: mean", float(ratios(cell).mean()), least)
    for kind in ("bursts", "flips", "dropouts"):
        if cell := mine(kind):
            tell(f"{kind}, of known: mean", float(ratios(cell, "known").mean()), 1.15)
            tell(f"{kind}: recall", recall(cell), 0.97, False)
            tell(f"{kind}: precision", precision(cell), 0.95, False)


def measured(clean: Clean, which: str, quick: bool, kinds: tuple[str, ...] | None, workers: int) -> list[Row]:
    wanted = cases(which, quick, kinds)
    if workers == 1:
        return [scored(clean, case) for case in wanted]
    with get_context("fork").Pool(workers) as pool:
        return list(pool.imap(partial(scored, clean), wanted, chunksize=8))


def main(clean: Clean | None = None) -> None:
    """Measure a method: `mocurve.denoising.clean`, or another function of its form."""
    asked = ArgumentParser()
    asked.add_argument("--set", choices=["tune", "held", "fresh", "last"], default="tune")
    asked.add_argument("--quick", action="store_true", help="about a tenth of the cases")
    asked.add_argument("--kinds", nargs="*", help="jitter, correlated, " + ", ".join(KINDS))
    asked.add_argument("--json", type=Path, help="write the numbers of every case")
    asked.add_argument("--workers", type=int, default=1)
    options = asked.parse_args()
    if clean is None:
        from mocurve.denoising import clean as ours

        clean = ours
    kinds = tuple(options.kinds) if options.kinds else None
    rows = measured(clean, options.set, options.quick, kinds, options.workers)
    found = list(dict.fromkeys(row["kind"] for row in rows))
    for kind in FREE:
        if kind in found:
            tell_jitter(rows, kind)
    if set(found) - set(FREE):
        tell_artefacts(rows, [kind for kind in KINDS if kind in found])
    tell_goals(rows)
    speed = sum(row["samples"] for row in rows) / max(sum(row["seconds"] for row in rows), 1e-9)
    print(f"\n{len(rows)} cases of the set {options.set}; {speed / 1e6:.3f} M channel-frames/s (unknown frames)")
    if options.json:
        options.json.write_text(json.dumps(rows), encoding="utf-8")


if __name__ == "__main__":
    main()
