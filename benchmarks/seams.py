"""Loops of captured walks, joins between them and warps found again: how much their seams show.

python seams.py
"""

from __future__ import annotations

import time
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from clips import folder

import mocurve as mc
from mocurve.edit.retime import time_map

WALKS = {
    "12_01": "cmu_12_01_walk.bvh",
    "02_01": "cmu_02_01_walk_blender.bvh",
    "daz19": "cmu_walk_daz19.bvh",
    "16_15": "cmu_16_15.amc",
}
JOINS = [("02_01", "12_01"), ("12_01", "02_01")]
WARP = [(0.5, 0.7), (1.5, 1.6), (2.2, 2.6)]


def walk(name: str) -> mc.Motion:
    path = folder() / "cmu" / WALKS[name]
    body: dict[str, Path] = {"skeleton": folder() / "cmu" / "cmu_16.asf"} if path.suffix == ".amc" else {}
    clip = mc.read(path, **body)
    assert isinstance(clip, mc.Motion)
    return clip


def timed(work: Callable[[], mc.Clip]) -> tuple[dict[str, Any], float]:
    """The numbers of the last step, and the median of three processor times after one that compiles."""
    work()
    times = []
    for _ in range(3):
        start = time.process_time()
        found = work().history[-1]["measured"]
        times.append(time.process_time() - start)
    return found, float(np.median(times))


def main() -> None:
    warnings.simplefilter("ignore")  # bones of other lengths, no frame rate in Acclaim files
    print(f"{'loop':18}{'close':12}{'seconds':>9}{'apart cm':>10}{'jump cm':>9}{'accel / p95':>13}{'time s':>8}")
    for name in WALKS:
        clip = walk(name)
        for close in ("linear", "cubic", "crossfade"):
            found, spent = timed(lambda clip=clip, close=close: mc.loop(clip, cycles=2, close=close))
            numbers = f"{found['end'] - found['start']:9.3f}{found['distance']:10.2f}{found['jump']:9.3f}"
            print(f"{name:18}{close:12}{numbers}{found['acceleration']:13.2f}{spent:8.2f}", flush=True)
    print(f"\n{'join':18}{'mode':12}{'apart cm':>9}{'step':>7}{'accel':>7}{'feet cm/s':>11}{'time s':>8}")
    for names in JOINS:
        a, b = (walk(name) for name in names)
        for mode in ("overlap", "inertial", "spline"):
            found, spent = timed(lambda a=a, b=b, mode=mode: mc.join(a, b, mode=mode))
            numbers = f"{found['distance']:9.2f}{found['step']:7.2f}{found['acceleration']:7.2f}"
            print(f"{' to '.join(names):18}{mode:12}{numbers}{found['foot_speed'] or 0:11.1f}{spent:8.2f}", flush=True)
    print(f"\n{'register':18}{'frames off':>11}{'apart cm':>10}{'stretched':>11}{'time s':>8}")
    for name in WALKS:
        clip = walk(name)[1:]
        warp = [pair for pair in WARP if pair[0] < clip.duration]
        reference = mc.retime(clip, warp)
        found, spent = timed(lambda clip=clip, reference=reference: mc.register(clip, reference))
        at = np.linspace(0.0, clip.duration, 500)
        off = np.abs(time_map(clip, [tuple(pair) for pair in found["pairs"]]).at(at) - time_map(clip, warp).at(at))
        numbers = f"{off.max() / clip.frame_time:11.2f}{found['distance']:10.2f}{found['even_distance']:11.2f}"
        print(f"{name:18}{numbers}{spent:8.2f}", flush=True)


if __name__ == "__main__":
    main()
