"""Motions laid along paths: distances along curves beside forward stepping, the laws of `follow` on captured walks and
runs, and how long it takes to move one control point.

    python benchmarks/follow.py [--rounds 15]

Distances are compared with an integral on 4096 intervals a span. Forward stepping sums chords of steps of 0.001 of the
curve until the distance is reached. Laws are the largest distance of a joint, by forward kinematics, from where it has
to be; the way back also with the history forgotten and the path named (--of), and so through a BVH file. What follows
is the worst of the five paths: the largest step and second difference of a joint, times the clip's; how fast the balls
of the feet slide in contact in the clip and carried (cm/s); then held, the contacts let go, and how far the hips go
down for it (cm), the worst of four paths, and on the slalom, whose bends have a radius of 17 cm.
Slopes: how far balls in contact are from the slope at most, beside their height over the floor of the clip, each foot
on it and the body lifted (cm); how far heels are; how fast balls slide (cm/s), contacts let go, how far the hips go
down and aside for it, and down because the slope asks for it (cm), and the knees' angular acceleration, largest and
99th percentile, times the clip's. Times are medians of processor times of a clip made ready once; they hold the edit
and the places of all joints at the frames that changed.
"""

from __future__ import annotations

import warnings
from argparse import ArgumentParser
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from itertools import pairwise
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory
from time import process_time

import numpy as np
from clips import folder

import mocurve as mc
from mocurve import planar, rotation
from mocurve.feet.legs import Leg, legs, tracks
from mocurve.kinematics import rotations, world
from mocurve.path_fit import gone
from mocurve.path_length import NODES

CLIPS = ["12_01", "02_01", "16_15", "02_03", "16_41", "09_12"]
BVH = {"12_01": "cmu_12_01_walk.bvh", "02_01": "cmu_02_01_walk_blender.bvh"}
CM = 5.6444  # a unit of these clips
WAY = 4.0  # metres of the drawn paths
STEP = 1e-3
MOVED = np.array([2.0, 30.0, -70.0])
LIMITS = {"span": 16.0, "whole": 60.0}  # ms: a frame of a screen, and what still feels direct
FRAMES = 5000
DEGREES = (2, 4, 13, 45)
SLOPES = (0.1, 0.2, -0.05, -0.1, -0.2)


def clip(name: str) -> mc.Motion:
    """A clip, without a T-pose in front."""
    if name in BVH:
        found = mc.read(folder() / "cmu" / BVH[name])
        return found[1:] if name == "12_01" else found
    return mc.read(folder() / "cmu" / f"cmu_{name}.amc", skeleton=folder() / "cmu" / f"cmu_{name[:2]}.asf")


def drawn() -> dict[str, mc.Path]:
    """Five paths of 4 metres, control points in the clips' unit."""
    ahead = np.linspace(0.0, WAY, 40)
    around = np.linspace(0.0, 0.5 * np.pi, 8)
    straight = np.linspace(0.0, 0.5 * WAY - 0.5, 8)
    turn = [np.stack([0 * straight[:-1], straight[:-1]], axis=1)]
    turn += [np.stack([0.5 - 0.5 * np.cos(around), straight[-1] + 0.5 * np.sin(around)], axis=1)]
    turn += [np.stack([0.5 + straight[1:], 0 * straight[1:] + straight[-1] + 0.5], axis=1)]
    shapes = {
        "straight": np.stack([0 * ahead, ahead], axis=1),
        "arc of 3 m": arc(3.0),
        "arc of 1 m": arc(1.0),
        "slalom": np.stack([0.6 * np.sin(np.pi * ahead), ahead], axis=1),
        "turn of 90 degrees": np.concatenate(turn),
    }
    return {name: mc.Path(100.0 / CM * points) for name, points in shapes.items()}


def arc(radius: float) -> np.ndarray:
    around = np.linspace(0.0, WAY / radius, 24)
    return radius * np.stack([1.0 - np.cos(around), np.sin(around)], axis=1)


def integrated(path: mc.Path) -> tuple[np.ndarray, np.ndarray]:
    """Parameters and distances, far finer than need be."""
    breaks = np.unique(path.knots)
    edges = np.unique(np.concatenate([np.linspace(a, b, 4097) for a, b in pairwise(breaks)]))
    at = edges[:-1, None] + np.diff(edges)[:, None] * NODES
    speed = np.linalg.norm(path.velocity(at.reshape(-1)), axis=1).reshape(at.shape)
    weights = 0.5 * np.polynomial.legendre.leggauss(5)[1]
    return edges, np.concatenate([[0.0], np.cumsum(np.diff(edges) * (speed @ weights))])


def stepped(path: mc.Path, distances: np.ndarray) -> np.ndarray:
    """Places at distances by forward stepping."""
    places = path.place(np.arange(0.0, 1.0 + STEP, STEP))
    gone = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(places, axis=0), axis=1))])
    return places[np.minimum(np.searchsorted(gone, distances), len(places) - 1)]


def speeds(places: np.ndarray, step: float) -> float:
    """How far a speed is off from 1 at most."""
    return float(np.abs(np.linalg.norm(np.diff(places, axis=0), axis=1) / step - 1.0).max())


def lengths(paths: dict[str, mc.Path]) -> None:
    print(f"{'distances':20}{'place cm':>10}{'speed':>10}{'stepped cm':>12}{'speed':>8}{'times better':>14}")
    for name, path in paths.items():
        edges, exact = integrated(path)
        distances = np.linspace(0.0, exact[-1], 2000)
        wanted = path.place(np.interp(distances, exact, edges))
        found, step = path.at(distances)[0], stepped(path, distances)
        off, old = (CM * float(np.linalg.norm(p - wanted, axis=1).max()) for p in (found, step))
        told = f"{off:10.1e}{speeds(found, distances[1]):10.1e}{old:12.2f}{speeds(step, distances[1]):8.2f}"
        print(f"{name:20}{told}{old / max(off, 1e-12):14.0f}", flush=True)


def degrees() -> None:
    """How far the root is from polynomials of some degrees, and from those in the power basis."""
    print(f"\n{'polynomials':12}" + "".join(f"{f'degree {degree}':>22}" for degree in DEGREES))
    for name in ("12_01", "16_41", "09_12"):
        motion = clip(name)
        told = ""
        for degree in DEGREES:
            path = mc.Path.of(motion, kind="polynomial", degree=degree)
            away = CM * path.residuals(motion)
            at = gone(motion)
            track = motion.values[:, [0, 2]]
            powers = np.linalg.solve(*normal(np.vander(at, degree + 1), track))
            plain = CM * np.linalg.norm(np.vander(at, degree + 1) @ powers - track, axis=1)
            told += f"{np.sqrt(np.mean(away**2)):7.2f}{away.max():7.2f}{np.sqrt(np.mean(plain**2)):8.2f}"
        print(f"{name:12}{told}", flush=True)
    print("root mean square, largest, root mean square in the power basis by normal equations; cm")


def normal(basis: np.ndarray, track: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    return basis.T @ basis, basis.T @ track


def laws(paths: dict[str, mc.Path]) -> None:
    heads = "".join(f"{head:>10}" for head in ("residual", "own path", "moved", "way back", "by --of", "file"))
    heads += f"{'step':>10}{'bend':>10}"
    heads += f"{'slide':>8}{'carried':>8}{'held':>8}{'let go':>8}{'drop':>6}  slalom{'held':>6}{'let go':>8}{'drop':>6}"
    print(f"\n{'laws, cm':10}{heads}")
    for name, heading in [*((name, "tangent") for name in CLIPS), ("09_12", "facing")]:
        motion = clip(name)
        own, places = mc.Path.of(motion), world(motion)
        moved = mc.follow(motion, own.moved(MOVED))
        worst = [off(mc.follow(motion, own), places), off(moved, planar.move(MOVED, places)), 0.0, 0.0, 0.0]
        feet = []
        rough = np.zeros(2)
        for path in paths.values():
            held = mc.follow(motion, path, heading=heading)
            feet.append(held.history[-1]["measured"]["feet"])
            made = mc.follow(motion, path, heading=heading, lock_feet=False)
            rough = np.maximum(rough, jumps(world(made)) / jumps(places))
            if heading == "tangent":
                worst[2] = max(worst[2], off(mc.follow(made, own, lock_feet=False), places))
                for place, there in ((3, replace(made, history=())), (4, through_bvh(made))):
                    worst[place] = max(worst[place], off(mc.follow(there, own, of=path, lock_feet=False), places))
        away = CM * float(np.sqrt(np.mean(own.residuals(motion) ** 2)))
        told = "".join(f"{value:10.1e}" for value in worst) + "".join(f"{value:10.2f}" for value in rough)
        for part in ("speed_own", "speed_slid"):
            told += f"{max(found[part] for found in feet):8.1f}"
        others = [found for name, found in zip(paths, feet, strict=True) if name != "slalom"]
        for some, wide in ((others, 8), ([feet[list(paths).index("slalom")]], 14)):
            told += f"{max(found['speed'] for found in some):{wide}.1f}{max(found['released'] for found in some):8}"
            told += f"{max(found['drop'] for found in some):6.1f}"
        print(f"{name:10}{away:10.2f}{told}{'  facing' if heading == 'facing' else ''}", flush=True)


def through_bvh(motion: mc.Motion) -> mc.Motion:
    """As a BVH file keeps it: six decimals, and not how it was made."""
    with TemporaryDirectory() as folder_of:
        file = Path(folder_of) / "there.bvh"
        mc.write(file, motion)
        return mc.read(file).sample()


def off(made: mc.Motion, wanted: np.ndarray) -> float:
    return CM * float(np.linalg.norm(world(made) - wanted, axis=-1).max())


def jumps(places: np.ndarray) -> np.ndarray:
    """The largest step of a joint, and how far one is from where it was going."""
    first = np.diff(places, axis=0)
    return np.array([np.linalg.norm(part, axis=-1).max() for part in (first, np.diff(first, axis=0))])


def slopes() -> None:
    """A walk or run on straight ramps: each foot on them, and lifted as a whole."""
    told = ("off", "lifted", "heels", "lifted", "slide", "let go", "drop", "aside", "sunk", "knee", "p99")
    heads = "".join(f"{head:>9}" for head in told)
    print(f"\n{'slopes, cm':20}{heads}")
    for name in CLIPS[:5]:
        motion = clip(name)
        edit, both = mc.PathEdit.of(motion), legs(motion)
        calm = knees(motion, both)
        for slope in SLOPES:
            ramp = mc.Path([(0.0, 0.0, 0.0), (0.0, 100.0 * slope, 100.0)])
            made, lifted = edit.laid(ramp), edit.laid(ramp, posture="lift")
            away = [over(part, motion, both, slope) for part in (made, lifted)]
            feet = made.history[-1]["measured"]["feet"]
            told = f"{away[0][0]:9.3f}{away[1][0]:9.2f}{away[0][1]:9.2f}{away[1][1]:9.2f}"
            told += (
                f"{feet['speed']:9.2f}{feet['released']:9}{feet['drop']:9.2f}{feet['shift']:9.2f}{feet['sunk']:9.2f}"
            )
            told += "".join(f"{part:9.2f}" for part in knees(made, both) / calm)
            print(f"{name:10}{100 * slope:8.0f} %{told}", flush=True)


def over(made: mc.Motion, motion: mc.Motion, both: tuple[Leg, ...], slope: float) -> list[float]:
    """How far balls, and heels, in contact are from a slope at most, beside how high they are in the clip."""
    worst, listed, names = [0.0, 0.0], mc.contacts(motion), motion.skeleton.names
    for part, (ways, own_ways) in enumerate(zip(tracks(made, both), tracks(motion, both), strict=True)):
        for leg, now, own in zip(both, ways, own_ways, strict=True):
            for contact in listed:
                if contact.joint == names[leg.ankle if part else leg.ball]:
                    span = slice(contact.first, contact.last + 1)
                    away = np.abs(now[span, 1] - slope * now[span, 2] - own[span, 1])
                    worst[part] = max(worst[part], CM * float(away.max()))
    return worst


def knees(motion: mc.Motion, both: tuple[Leg, ...]) -> np.ndarray:
    """Largest and 99th percentile of the knees' angular acceleration."""
    turned, found = rotations(motion), []
    for leg in both:
        turns = turned[:, leg.knee]
        steps = rotation.log(rotation.mul(rotation.inv(turns[:-1]), turns[1:]))
        found.append(np.linalg.norm(np.diff(steps, axis=0), axis=1))
    return np.array([np.max(found), np.percentile(found, 99)])


def latency(rounds: int) -> None:
    walk = clip("12_01")
    ring = 40.0 * np.array([(np.sin(a), np.cos(a)) for a in np.linspace(0.0, 6 * np.pi, 60)])
    motion = mc.follow(walk, mc.Path(ring * 4.0), at_end="cycle")[:FRAMES]
    motion = replace(motion, history=())
    own = mc.Path.of(motion)
    points = np.array(own.points)
    points[len(points) // 2] += (5.0, 3.0)
    edit = replace(own, points=points)
    ready = {feet: mc.PathEdit.of(motion, own, lock_feet=feet) for feet in (False, True)}

    def moved(mode: str, lock_feet: bool) -> np.ndarray:
        made = ready[lock_feet].laid(edit, mode=mode)
        found = made.history[-1]["measured"]
        return world(made[found["first"] : found["last"] + 1])

    print(f"\none control point of {len(points)} moved, {motion.frames} frames")
    for name, mode in {"span": "span", "whole": "arclength"}.items():
        for lock_feet in (False, True):
            work = partial(moved, mode, lock_feet)
            times = [1e3 * timed(work) for _ in range(rounds + 1)][1:]
            feet = "feet held, " if lock_feet else ""
            told = f"{name:10}{len(work()):6} frames{median(times):8.1f} ms, {feet}limit {LIMITS[name]:g}"
            print(told, flush=True)


def timed(work: Callable[[], object]) -> float:
    start = process_time()
    work()
    return process_time() - start


def main() -> None:
    parser = ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rounds", type=int, default=15)
    rounds = parser.parse_args().rounds
    warnings.simplefilter("ignore")  # no frame rate in Acclaim files
    paths = drawn()
    lengths(paths)
    degrees()
    laws(paths)
    slopes()
    latency(rounds)


if __name__ == "__main__":
    main()
