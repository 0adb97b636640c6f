"""Bands, waveshaping and limits of real clips: how exact the laws are, what limits change, and how fast it goes.

    python benchmarks/shape.py [--rounds 5]

Identity: all bands with gain 1, taken apart and put together. Limits: of people, of the file for Acclaim clips; and
the knees of each BVH clip bent back by 3 degrees more than they are straightest, as a capture does that has them wrong.
Accelerations are the largest of an angle where it was changed, after as a part of before: the worst angle of the clip.
Speed: processor time on one core, median.
"""

from __future__ import annotations

import warnings
from argparse import ArgumentParser
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from statistics import median
from time import process_time
from typing import Any

import clips
import numpy as np

import mocurve as mc
from mocurve import kinematics, rotation
from mocurve.edit import _bank
from mocurve.edit._anatomy import of_people
from mocurve.edit._ranges import Hinge

BVH = [
    "cmu/cmu_12_01_walk",
    "cmu/cmu_01_01_jump",
    "cmu/cmu_02_03_run",
    "cmu/cmu_05_20_dance_motionbuilder",
    "cmu/cmu_94_01_dance_max",
    "cmu/cmu_135_04_martial_daz",
    "other/rokoko_dance_fingers",
]
AMC = [("cmu/cmu_16", "16_15"), ("cmu/cmu_16", "16_41"), ("cmu/cmu_09", "09_01"), ("cmu/cmu_09", "09_12")]
BACK = 3.0  # degrees


def captures() -> dict[str, mc.Motion]:
    found = {name.split("/")[1]: mc.read(clips.folder() / f"{name}.bvh")[1:] for name in BVH}
    for body, clip in AMC:
        path: Path = clips.folder() / "cmu" / f"cmu_{clip}.amc"
        found[f"cmu_{clip}.amc"] = mc.read(path, skeleton=clips.folder() / f"{body}.asf")
    return {name: clip.sample() for name, clip in found.items()}


def identity(motion: mc.Motion) -> tuple[float, float]:
    """Degrees and units that taking apart and putting together is off, at most."""
    gains = np.ones(_bank.count(motion.frames))
    turned = kinematics.rotations(motion)
    tracks = [_bank.turned(turned[:, joint], gains)[0] for joint in range(turned.shape[1])]
    off = max(rotation.angle(track, turned[:, joint]).max() for joint, track in enumerate(tracks))
    places = motion.values[:, ~motion.skeleton.rotation_channels]
    rest, bands = _bank.shaped(places, np.zeros(len(gains)))
    return float(off), float(np.abs(rest + bands.sum(axis=0) - places).max())


def hyperextended(motion: mc.Motion) -> mc.Motion:
    """The clip with its knees and elbows bent back, so that the straightest frame of each is 3 degrees beyond."""
    values = np.array(motion.values, order="F")
    for kind in of_people(motion)[0]:
        if isinstance(kind, Hinge):
            angles = kind.angles(values)
            kind.put(values, angles, angles - angles.min() - BACK, np.arange(len(values)))
    return replace(motion, values=values)


def limited(motion: mc.Motion) -> dict[str, Any]:
    made = mc.limit(motion)
    told: dict[str, Any] = dict(made.history[-1]["measured"])
    changed = [row for row in told["angles"] if row["runs"]]
    told["ratio"] = max((row["acceleration"][1] / max(row["acceleration"][0], 1e-12) for row in changed), default=1.0)
    told["again"] = float(np.abs(mc.limit(made).sample().values - made.sample().values).max())
    return told


def speed(work: Callable[[], object], samples: int, rounds: int) -> float:
    """Channel-frames a second."""
    work()
    times = []
    for _ in range(rounds):
        start = process_time()
        work()
        times.append(process_time() - start)
    return samples / median(times)


def main() -> None:
    parser = ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rounds", type=int, default=5)
    rounds = parser.parse_args().rounds
    warnings.simplefilter("ignore")  # of frame rates and general limits
    motions = captures()
    worst = np.max([identity(motion) for motion in motions.values()], axis=0)
    print(f"bands with gain 1, worst of {len(motions)} clips: {worst[0]:.1e} degrees, {worst[1]:.1e} units\n")
    print(f"{'limits':34}{'joints':>7}{'runs':>6}{'frames':>12}{'before':>8}{'after':>9}{'accel':>7}{'again':>9}")
    rows = [(name, motion) for name, motion in motions.items()]
    rows += [(f"{name}, {BACK:g} back", hyperextended(m)) for name, m in motions.items() if not m.skeleton.limits]
    for name, motion in rows:
        told = limited(motion)
        frames = f"{told['frames']} / {motion.frames}"
        size = f"{told['joints']:7}{told['runs']:6}{frames:>12}{told['before']:8.2f}{told['after']:9.0e}"
        print(f"{name:34}{size}{told['ratio']:7.2f}{told['again']:9.0e}", flush=True)
    motion = motions["cmu_94_01_dance_max"]
    keys = mc.reduce(motion[:600], tolerance="1deg")
    middle = {"LeftShoulder.Zrotation": (-30.0, 30.0)}
    verbs: dict[str, tuple[Callable[[], object], mc.Motion]] = {
        "bands": (lambda: mc.bands(motion, {0: 0}), motion),
        "waveshape of all channels": (lambda: mc.waveshape(motion, {"*rotation": (-100, 100)}), motion),
        "limit of all rotation channels": (lambda: mc.limit(motion, {"*rotation": (-100, 100)}), motion),
        "limit of people": (lambda: mc.limit(motion), motion),
        "limit of keys": (lambda: mc.limit(keys, middle), motion[:600]),
    }
    print(f"\n{motion.frames} frames x {motion.skeleton.channel_count} channels; million channel-frames a second")
    for name, (work, clip) in verbs.items():
        print(f"{name:34}{speed(work, clip.values.size, rounds) / 1e6:8.2f}")


if __name__ == "__main__":
    main()
