"""Loops of captured walks, joins between them, and warps found again from the motion and from a performance.

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
from mocurve.edit import join as joining
from mocurve.edit._couple import at_rate, paired
from mocurve.edit._seams import centimetres
from mocurve.edit._transitions import MODES, Cut, alignments, joined
from mocurve.edit.loop import WAYS
from mocurve.edit.retime import time_map
from mocurve.feet.planted import planted
from mocurve.kinematics import world

WALKS = {
    "12_01": "cmu_12_01_walk.bvh",
    "02_01": "cmu_02_01_walk_blender.bvh",
    "daz19": "cmu_walk_daz19.bvh",
    "16_15": "cmu_16_15.amc",
}
JOINS = [("02_01", "12_01"), ("12_01", "02_01")]
SHAKING = (0.0, 0.01, 0.03)  # of the range, white
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


def loops() -> None:
    told = f"{'apart cm':>10}{'jump cm':>9}{'accel / p95':>13}{'off cm':>8}{'time s':>8}"
    print(f"{'loop':18}{'close':12}{'seconds':>9}{told}")
    for name in WALKS:
        clip = walk(name)
        for close in WAYS:
            found, spent = timed(lambda clip=clip, close=close: mc.loop(clip, cycles=2, close=close))
            numbers = f"{found['end'] - found['start']:9.3f}{found['distance']:10.2f}{found['jump']:9.3f}"
            numbers += f"{found['acceleration']:13.2f}{found['off']:8.2f}"
            print(f"{name:18}{close:12}{numbers}{spent:8.2f}", flush=True)


def joins() -> None:
    print(f"\n{'join':18}{'mode':12}{'apart cm':>9}{'step':>7}{'accel':>7}{'feet cm/s':>11}{'time s':>8}")
    for names in JOINS:
        a, b = (walk(name) for name in names)
        for mode in MODES:
            found, spent = timed(lambda a=a, b=b, mode=mode: mc.join(a, b, mode=mode))
            numbers = f"{found['distance']:9.2f}{found['step']:7.2f}{found['acceleration']:7.2f}"
            print(f"{' to '.join(names):18}{mode:12}{numbers}{found['foot_speed'] or 0:11.1f}{spent:8.2f}", flush=True)
    print(f"\n{'feet that rest, cm/s':30}{'by all joints':>14}{'by the feet':>13}{'cuts':>6}{'the clips own':>15}")
    for names in JOINS:
        a, b = (walk(name) for name in names)
        for mode in MODES:
            by_all, by_feet, count = by_alignment(a, b, mode)
            own = np.mean([own_feet(clip) for clip in (a, b)])
            print(f"{' to '.join(names):18}{mode:12}{by_all:14.1f}{by_feet:13.1f}{count:6}{own:15.1f}", flush=True)


def by_alignment(a: mc.Motion, b: mc.Motion, mode: str) -> tuple[float, float, int]:
    """Mean speed of feet that rest, the second clip placed by all joints and by the feet, over the best cuts at which
    a foot rests in both; and how many these are."""
    pair, count = paired(a, at_rate(b, a.frame_time)), round(0.4 / a.frame_time)
    speeds = []
    for i, j in joining._cuts_of(pair, count, mode, (None, None)):
        placed = pair.holding(i)
        steps = alignments(a, placed, (i, j), count, mode, pair.both_rest(i, j, count))
        if len(steps) == 2:
            cuts = [Cut(i, j, count, step) for step in steps]
            found = [joining._measured(pair, joined(a, placed, cut, mode, after=3), cut) for cut in cuts]
            speeds.append([one.foot_speed or 0.0 for one in found])
    by_all, by_feet = np.mean(speeds, axis=0)
    return float(by_all), float(by_feet), len(speeds)


def own_feet(clip: mc.Motion) -> float:
    """The same of a clip itself."""
    speed = np.linalg.norm(np.gradient(world(clip), axis=0), axis=-1).T / clip.frame_time
    return float(speed[planted(clip)].mean()) * (centimetres(clip) or 1.0)


def warps() -> None:
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
    print(f"\n{'act_out, the height':30}{'shaking':>8}{'matched':>9}{'left out':>10}{'frames off':>11}{'time s':>8}")
    for name, joint in (("12_01", "LeftFoot"), ("12_01", "LeftHand"), ("02_01", "LeftFoot"), ("02_01", "LeftHand")):
        clip = walk(name)[1:]
        warp = [pair for pair in WARP if pair[0] < clip.duration]
        reference = mc.retime(clip, warp)
        heights = world(reference)[:, clip.skeleton.joint(joint), 1]
        for shaking in SHAKING:
            hand = heights + np.random.default_rng(0).normal(0.0, shaking * np.ptp(heights), len(heights))
            rows = np.column_stack([np.arange(len(hand)) * clip.frame_time, hand])
            found, spent = timed(lambda clip=clip, rows=rows, joint=joint: mc.act_out(clip, rows, joint=joint))
            bent = time_map(clip, warp)
            off = max(abs(float(bent.at(np.array(row["old"]))) - row["new"]) for row in found["matched"])
            numbers = f"{len(found['matched']):9}{len(found['skipped']) + len(found['extra']):10}"
            print(f"{name:8}{joint:22}{shaking:8.0%}{numbers}{off / clip.frame_time:11.2f}{spent:8.2f}", flush=True)


def main() -> None:
    warnings.simplefilter("ignore")  # bones of other lengths, no frame rate in Acclaim files
    loops()
    joins()
    warps()


if __name__ == "__main__":
    main()
