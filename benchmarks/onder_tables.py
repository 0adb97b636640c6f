"""Tables 4.1 to 4.3 of Önder 2007 and the data of its figures 4.5 to 4.7, computed on real clips.

    python benchmarks/onder_tables.py [--check]

Writes them into docs/papers/onder-2007.md between its markers; with --check it only prints them. A channel counts
where it moves by more than 0.02 (degrees or file units); the rotation fix of B.1 (`unroll`) comes first. Errors are
over the rotation channels in degrees, and in space by forward kinematics over all joints and end sites, in percent of
the rest height.
"""

from __future__ import annotations

import re
from argparse import ArgumentParser
from collections.abc import Callable
from dataclasses import replace
from itertools import product
from pathlib import Path
from statistics import median
from time import process_time
from typing import NamedTuple

import numpy as np
from clips import folder

import mocurve as mc
from mocurve import hermite
from mocurve.kinematics import rest_height, world
from mocurve.reduction import dynamic, optimal, split
from mocurve.reduction.keys import Keys

PAGE = Path(__file__).resolve().parents[1] / "docs" / "papers" / "onder-2007.md"
RATIOS = (0.001, 0.005, 0.01, 0.02, 0.03, 0.1)
THESIS = {0.001: (20, 608), 0.005: (16, 246), 0.01: (13, 85), 0.02: (8, 11), 0.03: (6, 3), 0.1: (2, 2)}
Method = Callable[[np.ndarray], Keys]


class Result(NamedTuple):
    """What a method did to a clip: keys a channel, part of the frames, errors, seconds."""

    keys: float
    part: float
    rms: float  # degrees
    largest: float  # degrees
    of_range: float  # mean over the rotation channels of RMS error / range, in %
    worst_of_range: float  # mean over them of largest error / range, in %
    moved: float  # furthest any joint or end site moves, % of the rest height
    seconds: float


def clips() -> dict[str, mc.Motion]:
    """The run at every eighth frame (22 frames, as the thesis's), the run, and a longer clip, without their T-poses."""
    run = mc.unroll(mc.read(folder() / "cmu" / "cmu_02_03_run.bvh"))[1:]
    sparse = replace(run, values=run.values[::8], frame_time=8 / 120)
    long = mc.unroll(mc.read(folder() / "cmu" / "cmu_94_01_dance_max.bvh"))[1:1410]
    return {"run, 22 frames": sparse, "run, 172 frames": run, "dance, 1409 frames": long}


def live(motion: mc.Motion) -> np.ndarray:
    """Indices of the channels that move."""
    return np.flatnonzero(np.ptp(motion.values, axis=0) > 0.02)


def measured(motion: mc.Motion, method: Method, rounds: int = 3) -> Result:
    """Run the method on every live channel and measure what became of the motion."""
    chosen = live(motion)
    channels = [np.ascontiguousarray(motion.values[:, c]) for c in chosen]
    took = []
    for _ in range(rounds):
        started = process_time()
        found = [method(y) for y in channels]
        took.append(process_time() - started)
    values, at = motion.values.copy(), np.arange(motion.frames)
    for c, keys in zip(chosen, found, strict=True):
        values[:, c] = hermite.evaluate(keys.frames, keys.values[0], keys.slopes[0], at)
    turning = motion.skeleton.rotation_channels[chosen]
    error = np.abs(values - motion.values)[:, chosen[turning]]
    spread = np.ptp(motion.values, axis=0)[chosen[turning]]
    moved = np.linalg.norm(world(replace(motion, values=values)) - world(motion), axis=2).max()
    keys = float(np.mean([len(k.frames) for k in found]))
    return Result(
        keys,
        keys / motion.frames,
        float(np.sqrt((error**2).mean())),
        float(error.max()),
        100 * float((np.sqrt((error**2).mean(axis=0)) / spread).mean()),
        100 * float((error.max(axis=0) / spread).mean()),
        100 * float(moved / rest_height(motion)),
        median(took),
    )


def by_ratio(ratio: float) -> Method:
    return lambda y: split.with_ratio(y, ratio)


def within(part: float) -> Method:
    """*optimal* at a part of the channel's range."""
    return lambda y: optimal.solve(y[None], np.full((1, len(y)), part * np.ptp(y)), "default")


def table(head: list[str], rows: list[list[str]]) -> str:
    lines = ["| " + " | ".join(row) + " |" for row in [head, ["---"] * len(head), *rows]]
    return "\n".join(lines)


def table_1(motions: dict[str, mc.Motion]) -> str:
    """Threshold against keys per channel (also figure 4.5), with what it costs; as height / base and as B.2's code
    counts."""
    head = [
        "threshold",
        "taken as",
        "thesis, running / drinking",
        *(f"{name}: keys, RMS, max, space" for name in motions),
    ]
    rows = []
    for threshold, (taken, ratio) in product(RATIOS, (("height / base", 1), ("area / base² (B.2)", 2))):
        row = [f"{threshold:g}", taken, " / ".join(map(str, THESIS[threshold])) if ratio == 2 else ""]
        for motion in motions.values():
            r = measured(motion, by_ratio(ratio * threshold), 1)
            row.append(f"**{r.keys:.1f}**, {r.rms:.3f}°, {r.largest:.2f}°, {r.moved:.1f} %")
        rows.append(row)
    return table(head, rows)


def alike(motion: mc.Motion, rms: float) -> float:
    """The ratio at which the curve simplification has this RMS error (degrees), by bisection."""
    low, high = 1e-6, 1.0
    for _ in range(18):
        middle = (low * high) ** 0.5
        low, high = (middle, high) if measured(motion, by_ratio(middle), 1).rms < rms else (low, middle)
    return low


def compared(motions: dict[str, mc.Motion]) -> dict[str, tuple[Result, float, Result]]:
    """Per clip: dynamic programming, the ratio of like quality, curve simplification at it."""
    found = {}
    for name, motion in motions.items():
        fitted = measured(motion, dynamic.thesis_keys)
        ratio = alike(motion, fitted.rms)
        found[name] = fitted, ratio, measured(motion, by_ratio(ratio))
    return found


def table_2(motions: dict[str, mc.Motion], found: dict[str, tuple[Result, float, Result]]) -> str:
    """Summary of the two approaches."""
    head = ["", *(f"{name}: {kind}" for name in motions for kind in ("dynamic", "split"))]
    pairs = [(motions[name], result) for name, (a, _, b) in found.items() for result in (a, b)]
    lines: list[tuple[str, Callable[[mc.Motion, Result], str]]] = [
        ("frames", lambda m, r: str(m.frames)),
        ("channels that move", lambda m, r: str(len(live(m)))),
        ("keys a channel", lambda m, r: f"{r.keys:.1f}"),
        ("part of the frames", lambda m, r: f"{100 * r.part:.0f} %"),
        ("RMS, degrees", lambda m, r: f"{r.rms:.3f}"),
        ("largest, degrees", lambda m, r: f"{r.largest:.2f}"),
        ("in space, % of height", lambda m, r: f"{r.moved:.2f}"),
    ]
    rows = [[label, *(cell(m, r) for m, r in pairs)] for label, cell in lines]
    ratios = [text for _, ratio, _ in found.values() for text in ("", f"{ratio:.2g}")]
    return table(head, [*rows, ["ratio of like RMS", *ratios]])


def table_3(found: dict[str, tuple[Result, float, Result]]) -> str:
    """Execution times."""
    rows = [
        [name, f"{a.seconds * 1000:.1f} ms", f"{b.seconds * 1000:.1f} ms", f"{a.seconds / b.seconds:.0f}x"]
        for name, (a, _, b) in found.items()
    ]
    return table(["clip", "dynamic", "split", "dynamic / split"], rows)


def figure_6(motion: mc.Motion) -> str:
    """Movie length against execution time."""
    rows = []
    for frames in (50, 100, 200, 400, 800, motion.frames):
        part = motion[:frames]
        one, other = measured(part, dynamic.thesis_keys), measured(part, by_ratio(0.01))
        each = 1e9 / frames / len(live(part))
        cells = [f"{r.seconds * 1000:.1f} ms, {r.seconds * each:.0f} ns" for r in (one, other)]
        rows.append([str(frames), *cells])
    return table(["frames", "dynamic: all, a channel-frame", "split, ratio 0.01: all, a channel-frame"], rows)


def figure_7(motion: mc.Motion) -> str:
    """Error percent against frame reduction ratio."""
    methods: dict[str, Method] = {f"split, ratio {ratio:g}": by_ratio(ratio) for ratio in RATIOS}
    methods["dynamic"] = dynamic.thesis_keys
    methods |= {f"optimal, {100 * part:g} % of range": within(part) for part in (0.0025, 0.005, 0.01, 0.02)}
    rows = []
    for name, method in methods.items():
        r = measured(motion, method, 1)
        cells = [f"{100 * r.part:.1f} %", f"{r.of_range:.3f} %", f"{r.worst_of_range:.2f} %", f"{r.moved:.2f} %"]
        rows.append([name, *cells])
    head = ["method", "keys / frames", "RMS error / range", "largest error / range", "in space, of height"]
    return table(head, rows)


def claim(motions: dict[str, mc.Motion]) -> str:
    """What a fifth of the frames as keys costs, and what half a percent of error needs."""
    rows = []
    for name, motion in motions.items():
        for label, wanted in (
            ("20 % of the frames", lambda r: r.part > 0.2),
            ("RMS 0.5 % of range", lambda r: r.of_range < 0.5),
            ("largest error 0.5 % of range", lambda r: r.worst_of_range < 0.5),
        ):
            low, high = 1e-7, 1.0
            for _ in range(18):
                middle = (low * high) ** 0.5
                low, high = (middle, high) if wanted(measured(motion, by_ratio(middle), 1)) else (low, middle)
            r = measured(motion, by_ratio(low), 1)
            cells = [f"{100 * r.part:.0f} %", f"{r.of_range:.2f} %", f"{r.worst_of_range:.2f} %", f"{r.moved:.2f} %"]
            rows.append([name, label, f"{low:.2g}", *cells])
    head = ["clip", "split at", "ratio", "keys / frames", "RMS / range", "largest / range", "in space, of height"]
    return table(head, rows)


def main() -> None:
    asked = ArgumentParser()
    asked.add_argument("--check", action="store_true", help="print the tables, write nothing")
    options = asked.parse_args()
    motions = clips()
    for method in (dynamic.thesis_keys, by_ratio(0.01), within(0.01)):  # compiles
        measured(motions["run, 22 frames"], method, 1)
    found = compared(motions)
    longest = motions["dance, 1409 frames"]
    tables = {
        "table 4.1": table_1(motions),
        "table 4.2": table_2(motions, found),
        "table 4.3": table_3(found),
        "figure 4.6": figure_6(longest),
        "figure 4.7": figure_7(longest),
        "the claim": claim(motions),
    }
    page = PAGE.read_text(encoding="utf-8") if PAGE.exists() else ""
    for name, text in tables.items():
        print(f"\n{name}\n{text}")
        marked = re.compile(f"(<!-- {name} -->\n).*?(<!-- end -->)", re.DOTALL)
        page = marked.sub(lambda found, text=text: f"{found[1]}{text}\n{found[2]}", page)
    if not options.check:
        PAGE.write_text(page, encoding="utf-8")


if __name__ == "__main__":
    main()
