"""Truths, jitter and artefacts for the benchmarks of denoising, and the best Butterworth filter that knows the truth.

Truths: *lp6*, real clips low-passed at 6 Hz; *raw*, the same clips as they are (decimated without a filter); *impact*,
synthetic joints with velocity kinks, ringing of 10-16 Hz and kicks of 120-160 ms. Four sets of different joints or
windows: parameters are chosen on `tune` and `fresh`, results are told for `held` and `last` too, the latter looked at
once. Joints that come near gimbal lock or leap (a second difference over 18 degrees at the clip's own rate) are not
taken, nor the arms of the rokoko clip, which jump by 20 degrees and back within a few frames: the truth is to be a
motion. All follows from the names and a seed.
"""

from __future__ import annotations

import warnings
import zlib
from collections.abc import Iterator
from functools import lru_cache
from typing import NamedTuple

import artefacts
import numpy as np
from clips import folder
from scipy.signal import butter, sosfiltfilt

import mocurve as mc
from mocurve.info import unit_of

FRAMES = 600  # most frames of a case
SIGMAS = (0.2, 0.5, 1.0)  # degrees (or centimetres) of white noise
RATES = (120, 60, 30)  # the clip's rate, a half and a quarter of it; named after those of CMU clips
JITTER = "jitter"  # the kind of a case without artefacts
CUTOFFS = 21
IMPACTS = 8


class Source(NamedTuple):
    """Joints of a clip from some frame on; fps where the file's frame time is wrong. "Hips at" are its positions."""

    path: str
    first: int
    joints: tuple[str, ...]
    fps: float | None = None


TUNE = {
    "walk": Source("cmu/cmu_12_01_walk.bvh", 1, ("RightLeg", "LeftUpLeg", "RightArm")),
    "jump": Source("cmu/cmu_01_01_jump.bvh", 60, ("LeftForeArm", "RightUpLeg", "LeftFoot")),
    "martial": Source("cmu/cmu_135_04_martial_daz.bvh", 30, ("rThigh", "rForeArm", "lFoot")),
    "dance": Source("cmu/cmu_05_20_dance_motionbuilder.bvh", 60, ("RightLeg", "LeftForeArm", "RightUpLeg")),
    "run": Source("cmu/cmu_02_03_run.bvh", 1, ("ltibia", "rhumerus", "lfoot"), 120.0),
}
HELD = {
    "indian": Source("cmu/cmu_94_01_dance_max.bvh", 1200, ("RightElbow", "LeftKnee", "RightAnkle", "Hips at")),
    "walk19": Source("cmu/cmu_walk_daz19.bvh", 8, ("RightShoulder", "LeftHip", "RightAnkle", "Hip at")),
    "run19": Source("cmu/cmu_run_filtered.bvh", 8, ("lShldr", "rThigh", "lForeArm")),
    "stroll": Source("cmu/cmu_02_01_walk_blender.bvh", 1, ("RightArm", "LeftLeg", "LeftFoot")),
    "rokoko": Source("other/rokoko_dance_fingers.bvh", 200, ("Hips", "LeftLeg", "RightLeg", "Hips at")),
    "hands": Source("other/hands_60_joints.bvh", 0, ("RightHandPinky2", "RightArm", "RightHandIndex1")),
    "jump, later": Source("cmu/cmu_01_01_jump.bvh", 1500, ("RightArm", "LeftUpLeg", "Head")),
    "walk 16": Source("cmu/cmu_16_15.amc", 0, ("lfemur", "rhumerus", "thorax", "root at")),
    "run 16": Source("cmu/cmu_16_41.amc", 0, ("rfemur", "lhumerus", "head")),
    "run 9": Source("cmu/cmu_09_01.amc", 0, ("lfemur", "rhumerus", "root")),
    "sideways": Source("cmu/cmu_09_12.amc", 400, ("upperneck", "rfoot", "thorax")),
    "martial, later": Source("cmu/cmu_135_04_martial_daz.bvh", 700, ("lThigh", "lShldr", "rFoot")),
}
FRESH = {
    "jump, middle": Source("cmu/cmu_01_01_jump.bvh", 660, ("RightFoot", "LeftLeg", "Neck1")),
    "walk, other side": Source("cmu/cmu_12_01_walk.bvh", 1, ("RightUpLeg", "LeftLeg", "RightForeArm")),
    "martial, middle": Source("cmu/cmu_135_04_martial_daz.bvh", 330, ("rShldr", "lForeArm", "hip")),
    "dance, end": Source("cmu/cmu_05_20_dance_motionbuilder.bvh", 496, ("LeftLeg", "RightForeArm", "Neck1")),
    "indian, start": Source("cmu/cmu_94_01_dance_max.bvh", 200, ("LeftElbow", "RightHip", "LeftAnkle")),
    "indian, end": Source("cmu/cmu_94_01_dance_max.bvh", 3000, ("RightKnee", "LeftHip", "Neck")),
    "stroll, other side": Source("cmu/cmu_02_01.amc", 0, ("lfemur", "rtibia", "lradius")),
    "run, other side": Source("cmu/cmu_02_03.amc", 0, ("rfemur", "lhumerus", "rradius")),
    "walk 16, other side": Source("cmu/cmu_16_15.amc", 60, ("rfemur", "ltibia", "lradius")),
    "run 16, other side": Source("cmu/cmu_16_41.amc", 0, ("lfemur", "rhumerus", "rfoot")),
    "run 9, other side": Source("cmu/cmu_09_01.amc", 0, ("rfemur", "ltibia", "lradius")),
    "sideways, end": Source("cmu/cmu_09_12.amc", 1300, ("lfemur", "rtibia", "rradius")),
    "walk19, other side": Source("cmu/cmu_walk_daz19.bvh", 8, ("LeftShoulder", "RightHip", "LeftElbow")),
    "rokoko, end": Source("other/rokoko_dance_fingers.bvh", 400, ("Head", "LeftToeBase")),
}
LAST = {
    "jump, end": Source("cmu/cmu_01_01_jump.bvh", 2150, ("RightForeArm", "LeftUpLeg", "Neck")),
    "walk, feet": Source("cmu/cmu_12_01_walk.bvh", 1, ("LeftFoot", "RightFoot", "LeftArm")),
    "martial, start": Source("cmu/cmu_135_04_martial_daz.bvh", 60, ("lThigh", "rFoot", "abdomen")),
    "martial, end": Source("cmu/cmu_135_04_martial_daz.bvh", 717, ("rThigh", "lFoot", "head")),
    "dance, other side": Source("cmu/cmu_05_20_dance_motionbuilder.bvh", 60, ("LeftLeg", "RightForeArm", "Head")),
    "dance, end": Source("cmu/cmu_05_20_dance_motionbuilder.bvh", 496, ("RightLeg", "LeftForeArm", "Neck")),
    "indian, middle": Source("cmu/cmu_94_01_dance_max.bvh", 1900, ("LeftElbow", "RightKnee", "LeftHip")),
    "indian, late": Source("cmu/cmu_94_01_dance_max.bvh", 2450, ("RightElbow", "LeftAnkle", "RightHip")),
    "stroll, third": Source("cmu/cmu_02_01.amc", 0, ("rfemur", "rfoot", "lhumerus")),
    "run, third": Source("cmu/cmu_02_03.amc", 0, ("lfemur", "rtibia", "lradius")),
    "walk 16, third": Source("cmu/cmu_16_15.amc", 0, ("rtibia", "lfoot", "rfoot")),
    "run 16, third": Source("cmu/cmu_16_41.amc", 0, ("ltibia", "lradius", "lfoot")),
    "run 9, third": Source("cmu/cmu_09_01.amc", 0, ("lhumerus", "rtibia", "rradius")),
    "sideways, middle": Source("cmu/cmu_09_12.amc", 850, ("ltibia", "lradius", "root at")),
    "walk19, third": Source("cmu/cmu_walk_daz19.bvh", 8, ("RightElbow", "RightKnee", "LeftAnkle")),
    "run19, other side": Source("cmu/cmu_run_filtered.bvh", 8, ("rShldr", "lThigh", "rFoot")),
    "rokoko, start": Source("other/rokoko_dance_fingers.bvh", 0, ("Head",)),
}
SETS = {"tune": TUNE, "held": HELD, "fresh": FRESH, "last": LAST}


class Case(NamedTuple):
    """One clip with noise.

    name:    truth/clip/rate/sigma/kind/seed.
    truth:   (F, C) degrees.
    noisy:   (F, C) truth + jitter + artefacts; NaN where samples are missing.
    bad:     (F, C) bool, where an artefact was put.
    jittery: (F, C) truth + jitter, the same jitter.
    fps:     frames a second; rate is the rate's name, 120, 60 or 30.
    groups:  columns of each joint.
    sigma:   degrees of the jitter.
    """

    name: str
    truth: np.ndarray
    noisy: np.ndarray
    bad: np.ndarray
    fps: float
    groups: list[np.ndarray]
    sigma: float
    jittery: np.ndarray
    rate: int
    shape: str
    kind: str


def seeded(name: str) -> np.random.Generator:
    return np.random.default_rng(zlib.crc32(name.encode()))


@lru_cache(maxsize=64)
def real(path: str, first: int, joints: tuple[str, ...], smooth: bool, fps: float | None) -> tuple[np.ndarray, float]:
    """Channels (F, 3 joints) of a clip at its own rate, degrees and centimetres, and that rate."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # a file without a frame rate, or with a T-pose
        motion = mc.unroll(mc.read(folder() / path)[first:])
    rate = fps or 1 / motion.frame_time
    metres, columns, start = unit_of(motion).metres, {}, 0
    for name, kinds in zip(motion.skeleton.names, motion.skeleton.channels, strict=True):
        columns[name] = [(start + k, 1.0) for k, kind in enumerate(kinds) if kind.endswith("rotation")]
        columns[f"{name} at"] = [(start + k, 100 * metres) for k, kind in enumerate(kinds) if kind.endswith("position")]
        start += len(kinds)
    chosen, scale = zip(*(column for joint in joints for column in columns[joint]), strict=True)
    values = motion.values[:, list(chosen)] * scale
    return (butterworth(values, 6.0, rate) if smooth else values), rate


def impact(rng: np.random.Generator, fps: float) -> np.ndarray:
    """(F, 3) degrees, 10 s at most: harmonics, velocity kinks, ringing after an impact, kicks."""
    t = np.arange(min(FRAMES, int(10 * fps))) / fps
    values = np.zeros((len(t), 3))
    for channel in range(3):
        base = rng.uniform(0.6, 1.2)
        for harmonic in range(1, 4):
            size = rng.uniform(5, 30) / harmonic**1.5
            values[:, channel] += size * np.sin(2 * np.pi * harmonic * base * t + rng.uniform(0, 2 * np.pi))
    for at in np.arange(rng.uniform(0.4, 1.0), t[-1] - 0.3, 1.1):
        share = rng.uniform(0.2, 1.0, 3) * rng.choice([-1, 1], 3)
        at += rng.uniform(-0.2, 0.2)
        values += share * _event(rng, t - at)[:, None]
    return values


def _event(rng: np.random.Generator, t: np.ndarray) -> np.ndarray:
    """One of the three events at t = 0."""
    which = rng.integers(3)
    if which == 0:  # the velocity changes by up to 250 deg/s at once and comes back within half a second
        return rng.uniform(80, 250) * np.where(t > 0, t * np.exp(-np.maximum(t, 0) / 0.15), 0.0)
    if which == 1:
        ring = np.exp(-np.maximum(t, 0) / 0.06) * np.sin(2 * np.pi * rng.uniform(10, 16) * t)
        return rng.uniform(2, 6) * np.where(t > 0, ring, 0.0)
    half = rng.uniform(0.12, 0.16)  # seconds at half height; with its size at most 800 deg/s
    return rng.uniform(25, 60) * np.where(np.abs(t) < half, np.cos(np.pi * t / (2 * half)) ** 2, 0.0)


def truths(which: str) -> Iterator[tuple[str, str, int, float, np.ndarray]]:
    """Shape, clip, rate's name, fps and (F, C) of every truth of a set, at all rates."""
    for rate in RATES:
        step = RATES[0] // rate
        for shape in ("lp6", "raw"):
            for clip, source in SETS[which].items():
                values, fps = real(source.path, source.first, source.joints, shape == "lp6", source.fps)
                yield shape, clip, rate, fps / step, np.ascontiguousarray(values[::step][:FRAMES])
        for number in range(IMPACTS):
            yield "impact", str(number), rate, float(rate), impact(seeded(f"{which} impact {number}"), rate)


def with_noise(which: str, shape: str, clip: str, rate: int, fps: float, truth: np.ndarray, rest: tuple) -> Case:
    """A case; rest: sigma, kind, seed."""
    sigma, kind, seed = rest
    name = f"{shape}/{clip}/{rate}/{sigma:g}/{kind}/{seed}"
    groups = [np.arange(first, first + 3) for first in range(0, truth.shape[1], 3)]
    rng = seeded(f"{which} {name}")
    white = sigma * rng.standard_normal(truth.shape)
    jittery = truth + (artefacts.correlated(rng, white) if kind == "correlated" else white)
    noisy, bad = artefacts.KINDS[kind](rng, jittery, groups) if kind in artefacts.KINDS else (jittery, None)
    bad = np.zeros(truth.shape, bool) if bad is None else bad
    return Case(name, truth, noisy, bad, fps, groups, sigma, jittery, rate, shape, kind)


def cases(which: str = "tune", quick: bool = False, kinds: tuple[str, ...] | None = None) -> Iterator[Case]:
    """Every case of a set: jitter, and each kind of artefact (all kinds, or those named).

    quick: about a tenth of them.
    """
    wanted = (JITTER, *artefacts.KINDS, "correlated") if kinds is None else kinds
    for shape, clip, rate, fps, truth in truths(which):
        for kind in wanted:
            sigmas = SIGMAS if kind == JITTER else (SIGMAS[0], SIGMAS[-1])
            for sigma in sigmas:
                for seed in range(2 if kind == JITTER else 1):
                    rest = (sigma, kind, seed)
                    rare = zlib.crc32(f"{shape}{clip}{rate}{rest}".encode()) % 10
                    if not quick or (rare == 0 and seed == 0):
                        yield with_noise(which, shape, clip, rate, fps, truth, rest)


def butterworth(values: np.ndarray, cutoff: float, fps: float) -> np.ndarray:
    """Second order, forwards and backwards: (F, C) -> (F, C)."""
    return sosfiltfilt(butter(2, cutoff / (fps / 2), output="sos"), values, axis=0)


def oracle(truth: np.ndarray, noisy: np.ndarray, fps: float) -> np.ndarray:
    """(F, C): each channel filtered by `butterworth` with the cut-off of 21 that is best for it, knowing the truth.

    61 cut-offs, or longer padding at the ends, would lower its error by another 0.3 to 0.8 %.
    """
    best = np.full(truth.shape[1], np.inf)
    found = np.empty_like(truth)
    for cutoff in np.geomspace(0.4, 0.48 * fps, CUTOFFS):
        filtered = butterworth(noisy, cutoff, fps)
        off = ((filtered - truth) ** 2).mean(axis=0)
        better = off < best
        best[better], found[:, better] = off[better], filtered[:, better]
    return found
