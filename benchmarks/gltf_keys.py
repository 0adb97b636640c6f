"""Keys and bytes of a glTF linear animation: ours, glTF-Transform's `resample` and ozz's optimizer rule, at one error.

    python benchmarks/gltf_keys.py [--percent 0.1 0.5] [--frames 300] [--clips walk]

Ours holds the tolerance (planted feet like the rest). Each peer's own tolerance is then swept, by bisection and a look
around, for the fewest keys whose largest error in space (any joint or end site, any frame, slerp as players do it) is
not above ours: so all three move things by the same amount.

resample (node; npm install --no-package-lock in this folder): a key is kept where the slerp from the last kept key to
the next sample is off by more than the tolerance in any component.
ozz: its AnimationOptimizer by its published rule, not its code: Douglas-Peucker per track; a rotation's error is
2 r sin(angle / 2) at r, the longest way down to an end site plus 0.1 m; keys on samples; constant tracks one key.

bytes: of times and values in single precision, times not shared.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import warnings
from collections.abc import Callable
from pathlib import Path
from statistics import geometric_mean
from time import process_time

import numpy as np
from clips import folder

import mocurve as mc
from mocurve import rotation
from mocurve.data import example
from mocurve.info import unit_of
from mocurve.kinematics import rest_offsets
from mocurve.motion import Motion
from mocurve.reduction.slerp import Track, joint_keys, local_states, places_in_world, states_at

CLIPS = {
    "cmu/cmu_12_01_walk.bvh": 1,  # first frames that are a T-pose are left out
    "cmu/cmu_01_01_jump.bvh": 1,
    "cmu/cmu_02_03_run.bvh": 1,
    "cmu/cmu_05_20_dance_motionbuilder.bvh": 1,
    "cmu/cmu_135_04_martial_daz.bvh": 1,
    "other/rokoko_dance_fingers.bvh": 0,
}
LEAST, MOST = 1e-7, 0.3  # the peers' tolerances
BISECTIONS = 12
NEARBY = 6  # more tolerances that are tried
OZZ_DISTANCE = 0.1  # metres, ozz's default: where on a joint its error counts
GOALS = "fewer keys than both, by a stated ratio"

Tracks = list[Track]
Peer = Callable[[float], Tracks]


class Body:
    """A clip's tracks, a key a frame, and the error in space of other tracks."""

    def __init__(self, motion: Motion) -> None:
        self.motion = motion
        skeleton = motion.skeleton
        self.turned, self.placed = local_states(motion)
        self.places = places_in_world(skeleton, self.turned, self.placed)
        rotates = skeleton.rotation_channels
        kinds = [(j, False) for j in np.unique(skeleton.channel_joints[~rotates])]
        self.ways = kinds + [(j, True) for j in np.unique(skeleton.channel_joints[rotates])]

    def states(self, way: tuple[int, bool]) -> np.ndarray:
        return self.turned[way[0]] if way[1] else self.placed[way[0]]

    def error(self, tracks: Tracks) -> float:
        turned, placed = self.turned.copy(), self.placed.copy()
        for (joint, turns), track in zip(self.ways, tracks, strict=True):
            wide = track if turns else Track(track.frames, np.pad(track.values[:, :3], ((0, 0), (0, 1))))
            now = states_at(turns, wide, self.motion.frames)
            (turned if turns else placed)[joint] = now
        return float(np.linalg.norm(places_in_world(self.motion.skeleton, turned, placed) - self.places, axis=-1).max())

    def on_samples(self, frames: list[np.ndarray]) -> Tracks:
        return [Track(at, self.states(way)[at]) for way, at in zip(self.ways, frames, strict=True)]

    def size(self, tracks: Tracks) -> tuple[int, int]:
        """Keys and bytes."""
        counts = [len(track.frames) for track in tracks]
        return sum(counts), sum(
            n * (4 + (16 if turns else 12)) for n, (_, turns) in zip(counts, self.ways, strict=True)
        )


def swept(peer: Peer, body: Body, error: float) -> Tracks:
    """The peer's tracks with the fewest keys whose error in space is not above `error`."""
    best = peer(LEAST)

    def fits(tolerance: float) -> bool:
        nonlocal best
        tracks = peer(tolerance)
        holds = body.error(tracks) <= error
        if holds and body.size(tracks)[0] < body.size(best)[0]:
            best = tracks
        return holds

    low, high = LEAST, MOST
    for _ in range(BISECTIONS):
        middle = float(np.sqrt(low * high))
        low, high = (middle, high) if fits(middle) else (low, middle)
    for tolerance in low * np.geomspace(0.8, 2.0, NEARBY):  # the error does not rise evenly
        fits(float(tolerance))
    return best


# -- the peers ---------------------------------------------------------------------------------------------------------


class Resample:
    """glTF-Transform's resample, in a process of its own."""

    def __init__(self, body: Body, metres: float) -> None:
        self.body = body
        here = Path(__file__).parent
        self.node = subprocess.Popen(
            ["node", "gltf_resample.mjs"], cwd=here, text=True, stdin=subprocess.PIPE, stdout=subprocess.PIPE
        )
        tracks = []
        for way in body.ways:
            values = body.states(way)[:, [1, 2, 3, 0]] if way[1] else body.states(way)[:, :3] * metres
            tracks.append({"path": "rotation" if way[1] else "translation", "values": values.ravel().tolist()})
        self._say({"frameTime": body.motion.frame_time, "tracks": tracks})

    def __call__(self, tolerance: float) -> Tracks:
        self._say({"tolerance": tolerance})
        assert self.node.stdout is not None
        answer = self.node.stdout.readline()
        if not answer:
            sys.exit("glTF-Transform is not there: npm install --no-package-lock in this folder")
        return self.body.on_samples([np.array(frames) for frames in json.loads(answer)["frames"]])

    def _say(self, what: dict) -> None:
        assert self.node.stdin is not None
        self.node.stdin.write(json.dumps(what) + "\n")
        self.node.stdin.flush()

    def close(self) -> None:
        assert self.node.stdin is not None
        self.node.stdin.close()
        self.node.wait()


def ozz(body: Body, metres: float, tolerance: float) -> Tracks:
    """ozz's rule. tolerance: metres."""
    skeleton = body.motion.skeleton
    bones = np.maximum(np.linalg.norm(rest_offsets(body.motion), axis=1), 0.0)
    moved = np.linalg.norm(body.placed[:, :, :3], axis=2).max(axis=1)
    lengths = np.full(len(bones), OZZ_DISTANCE / metres)
    for joint in range(len(bones) - 1, 0, -1):
        parent = skeleton.parents[joint]
        if parent >= 0:
            lengths[parent] = max(lengths[parent], lengths[joint] + moved[joint])
    return body.on_samples([split(body.states(way), way[1], lengths[way[0]], tolerance / metres) for way in body.ways])


def split(states: np.ndarray, turns: bool, length: float, tolerance: float) -> np.ndarray:
    """Douglas-Peucker on samples."""
    last = len(states) - 1
    if off(states, np.repeat(states[:1], len(states), axis=0), turns, length).max() <= tolerance:
        return np.array([0])
    keep, spans = {0, last}, [(0, last)]
    while spans:
        a, b = spans.pop()
        if b - a < 2:
            continue
        part = np.arange(1, b - a) / (b - a)
        if turns:
            chord = rotation.slerp(states[a], states[b], part)
        else:
            chord = states[a] + part[:, None] * (states[b] - states[a])
        error = off(states[a + 1 : b], chord, turns, length)
        if error.max() > tolerance:
            middle = a + 1 + int(error.argmax())
            keep.add(middle)
            spans += [(a, middle), (middle, b)]
    return np.array(sorted(keep))


def off(a: np.ndarray, b: np.ndarray, turns: bool, length: float) -> np.ndarray:
    if not turns:
        return np.linalg.norm(a - b, axis=-1)
    return 2.0 * length * np.sin(0.5 * np.radians(rotation.angle(a, b)))


# -- side by side ------------------------------------------------------------------------------------------------------


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--percent", type=float, nargs="*", default=[0.1, 0.5], help="of the rest height")
    parser.add_argument("--frames", type=int, default=300, help="of each clip (default 300)")
    parser.add_argument("--clips", default="", help="only clips with this in their name")
    asked = parser.parse_args()
    warnings.simplefilter("ignore")
    joint_keys(mc.read(example())[:5])  # compiles
    print(f"{'clip':34}{'%height':>8}{'error':>9} |{'keys':>7}{'bytes':>8}{'s':>6} |", end="")
    print(f"{'resample':>9}{'bytes':>8}{'error':>9}{'ratio':>7} |{'ozz':>7}{'bytes':>8}{'error':>9}{'ratio':>7}")
    ratios: dict[float, list[tuple[float, float]]] = {}
    for name, first in CLIPS.items():
        if asked.clips not in name:
            continue
        motion = mc.read(folder() / name)[first : first + asked.frames]
        metres = unit_of(motion).metres
        body = Body(motion)
        resample = Resample(body, metres)
        for percent in asked.percent:
            start = process_time()
            keys = joint_keys(motion, f"{percent}%height", feet=1.0)
            seconds = process_time() - start
            ours = [(keys.rotations if turns else keys.positions)[joint] for joint, turns in body.ways]
            error = body.error(ours)
            count, size = body.size(ours)
            print(f"{name:34}{percent:8g}{1000 * metres * error:8.3f}  |{count:7}{size:8}{seconds:6.1f} |", end="")
            pair = []
            for peer in (resample, lambda tolerance, b=body, m=metres: ozz(b, m, tolerance)):
                theirs = swept(peer, body, error)
                keys_of, bytes_of = body.size(theirs)
                pair.append(count / keys_of)
                print(f"{keys_of:8}{bytes_of:8}{1000 * metres * body.error(theirs):9.3f}{pair[-1]:7.3f} |", end="")
            print(flush=True)
            ratios.setdefault(percent, []).append((pair[0], pair[1]))
        resample.close()
    for percent, pairs in ratios.items():
        means = [geometric_mean(column) for column in zip(*pairs, strict=True)]
        print(f"{percent:g} %: keys ours / resample {means[0]:.3f}, ours / ozz {means[1]:.3f} (geometric means)")
    print(f"errors in mm; goal: {GOALS}")


if __name__ == "__main__":
    main()
