"""Captured walks and runs laid on other paths with their feet locked: how still the feet stand, how calm knees, ankles
and pelvis stay, and what it took. Then the body turned about the ball of a standing foot, over every contact but the
first and the last, either way: of those that are not refused the worst. Then whole clips with turns on the spot laid on
a straight path by `follow`; and how far feet turn in captures while they stand, and how fast.

python feet.py [--only 12_01] [--picture footprints.png [--turn 135]]
"""

from __future__ import annotations

import argparse
import time
import warnings
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
from clips import folder
from PIL import Image, ImageDraw
from scipy.linalg import solveh_banded

import mocurve as mc
from mocurve import kinematics, planar, rotation
from mocurve.edit._body import carried
from mocurve.edit._locking import held, locked, source_of
from mocurve.edit._reach import Strain
from mocurve.feet.contacts import contacts, found, slowness
from mocurve.feet.legs import Leg, centimetres, legs, tracks
from mocurve.feet.skate import skate
from mocurve.formats._files import replacing
from mocurve.info import first_frame_is_t_pose

CLIPS = {
    "12_01": "cmu_12_01_walk.bvh",
    "16_15": "cmu_16_15.amc",
    "02_01": "cmu_02_01_walk_blender.bvh",
    "09_12": "cmu_09_12.amc",
    "16_41": "cmu_16_41.amc",
    "02_03": "cmu_02_03.amc",
}
WHOLE = {  # jumps forth and back with turns on the spot; dances; fighting; a walk forwards, backwards and sideways
    "01_01": "cmu_01_01_jump.bvh",
    "05_20": "cmu_05_20_dance_motionbuilder.bvh",
    "94_01": "cmu_94_01_dance_max.bvh",
    "135_04": "cmu_135_04_martial_daz.bvh",
    "09_12": "cmu_09_12.amc",
}
SPINS = (45.0, 90.0, 135.0)  # degrees
STALL = 20.0  # cm/s: slower, the way has no heading of its own
COLUMNS = (
    "skate re-det    tip  ankle   heel kept% | knee  p99   rot   lin  pelv | "
    "drop shift twist  miss short  hip ankle   gap  pivot   deg/s"
)


def clip(name: str) -> mc.Motion:
    path = folder() / "cmu" / (CLIPS | WHOLE)[name]
    body: dict[str, Path] = {"skeleton": folder() / "cmu" / f"cmu_{name[:2]}.asf"} if path.suffix == ".amc" else {}
    motion = mc.read(path, **body)
    assert isinstance(motion, mc.Motion)
    return motion[int(first_frame_is_t_pose(motion)) :]


# -- paths -----------------------------------------------------------------------------------------
def smoothed(values: np.ndarray, weights: np.ndarray, frames: float) -> np.ndarray:
    """Whittaker's smoother: least weighted squares of what changes and of second differences, over so many frames."""
    count = len(values)
    band = np.zeros((3, count))
    band[0] = weights
    for first, a in enumerate((1.0, -2.0, 1.0)):
        for second, b in enumerate((1.0, -2.0, 1.0)[first:]):
            band[second, first : count - 2 + first] += frames**4 * a * b
    return solveh_banded(band, (values.T * weights).T, lower=True)


def slalom(s: np.ndarray) -> np.ndarray:
    return np.radians(45.0) * np.sin(s / (50.0 * np.radians(45.0)))  # least radius 50 cm


PATHS: dict[str, Callable[[np.ndarray], np.ndarray]] = {  # heading, radians, after so many cm
    "straight": lambda s: 0.0 * s,
    "arc 3 m": lambda s: s / 300.0,
    "arc 1 m": lambda s: s / 100.0,
    "slalom": slalom,
    "turn 90": lambda s: np.clip((s - 0.4 * s[-1]) / 50.0, 0.0, np.pi / 2.0),
}


def carry_onto(motion: mc.Motion, heading: Callable[[np.ndarray], np.ndarray], stride: float = 1.0) -> np.ndarray:
    """The planar transforms (F, 3) that lay the way of the root on a path of this heading, as long as it is."""
    scale, rate = centimetres(motion), 1.0 / motion.frame_time
    root = scale * kinematics.world(motion)[:, 0][:, [0, 2]]
    way = smoothed(root, np.ones(len(root)), 0.4 * rate)
    steps = np.gradient(way, axis=0)
    s = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(way, axis=0), axis=1))]) * stride
    own = np.unwrap(np.arctan2(steps[:, 0], steps[:, 1]))
    new = heading(s) + np.arctan2(*(way[-1] - way[0]))
    between = 0.5 * (new[1:] + new[:-1])
    over = np.diff(s)[:, None] * np.stack([np.sin(between), np.cos(between)], axis=1)
    place = way[0] + np.concatenate([np.zeros((1, 2)), np.cumsum(over, axis=0)])
    speed = np.linalg.norm(steps, axis=1) * rate
    weight = speed**2 / (speed**2 + STALL**2) + 1e-6
    turn = smoothed(np.stack([np.cos(new - own), np.sin(new - own)], axis=1), weight, 0.15 * rate)
    angle = np.unwrap(np.arctan2(turn[:, 1], turn[:, 0]))
    none = 0.0 * angle
    turned = planar.move(np.stack([angle, none, none], axis=1), np.stack([way[:, 0], none, way[:, 1]], axis=1))
    return np.column_stack([angle, (place - turned[:, [0, 2]]) / scale])


def carry_around(motion: mc.Motion, contact: mc.Contact, degrees: float) -> np.ndarray:
    """The planar transforms (F, 3) that turn a body about the place of a contact, while that lasts."""
    u = np.clip((np.arange(motion.frames) - contact.first) / max(contact.last - contact.first, 1), 0.0, 1.0)
    turn = np.column_stack([np.radians(degrees) * u**3 * (10.0 + u * (6.0 * u - 15.0)), 0.0 * u, 0.0 * u])
    turn[:, 1:] = (np.array(contact.place) - planar.move(turn, np.array(contact.place)))[:, [0, 2]]
    return turn


# -- numbers ---------------------------------------------------------------------------------------
def quickening(turns: np.ndarray) -> np.ndarray:
    """Angular acceleration (F - 2,) of rotations (F, 4), radians a frame a frame."""
    steps = rotation.log(rotation.mul(rotation.inv(turns[:-1]), turns[1:]))
    return np.linalg.norm(np.diff(steps, axis=0), axis=1)


def joints_calm(motion: mc.Motion, both: tuple[Leg, ...]) -> np.ndarray:
    """Largest and 99th percentile of the knees' angular acceleration, largest of the ankles', and of the ankles' and
    the root's linear one."""
    turned, places = kinematics.rotations(motion), kinematics.world(motion)
    knees = np.concatenate([quickening(turned[:, leg.knee]) for leg in both])
    ankles = np.concatenate([quickening(turned[:, leg.ankle]) for leg in both])
    linear = [np.linalg.norm(np.diff(places[:, leg.ankle], 2, axis=0), axis=1).max() for leg in both]
    root = np.linalg.norm(np.diff(places[:, 0], 2, axis=0), axis=1).max()
    return np.array([knees.max(), np.percentile(knees, 99), ankles.max(), max(linear), root])


def gap(motion: mc.Motion, both: tuple[Leg, ...]) -> float:
    """The least distance over the ground, cm, of the two lines from heel to ball."""
    balls, heels = (centimetres(motion) * points[..., [0, 2]] for points in tracks(motion, both))
    along = np.linspace(0.0, 1.0, 6)[None, :, None]
    lines = [heel[:, None] + along * (ball - heel)[:, None] for ball, heel in zip(balls, heels, strict=True)]
    return float(np.linalg.norm(lines[0][:, :, None] - lines[1][:, None], axis=-1).min())


def sliding(motion: mc.Motion, source: mc.Motion, listed: tuple, both: tuple[Leg, ...], speed: float) -> list[float]:
    """Mean speeds, cm/s: of the ball, of ball contacts found anew, of toe tip and ankle while the ball stands, of the
    heel while it stands; and the part of the contact that is kept, percent."""
    names = motion.skeleton.names
    balls = [c for c in listed if c.joint in {names[leg.ball] for leg in both}]
    heels = [c for c in listed if c.joint not in {names[leg.ball] for leg in both}]
    anew = [c for c in found(motion, both, speed, 4.0, held=False) if c.joint in {names[leg.ball] for leg in both}]
    own = skate(motion, balls, both, source, speed)
    again, heel = skate(motion, anew, both, motion, speed), skate(motion, heels, both, source, speed)
    places, others = centimetres(motion) * kinematics.world(motion), []
    for joint in ("tip", "ankle"):
        steps = []
        for contact in balls:
            leg = next(leg for leg in both if names[leg.ball] == contact.joint)
            end = np.flatnonzero(motion.skeleton.parents == leg.ball)
            place = leg.ankle if joint == "ankle" or not len(end) else int(end[0])
            track = places[contact.first : contact.last + 1, place][:, [0, 2]]
            steps.append(np.linalg.norm(np.diff(track, axis=0), axis=1) / motion.frame_time)
        others.append(float(np.concatenate(steps).mean()))
    assert own is not None
    anew_speed = again.speed if again else 0.0
    return [own.speed, anew_speed, *others, heel.speed if heel else 0.0, 100.0 * own.kept]


def row(name: str, path: str, slide: np.ndarray, calm: np.ndarray, took: np.ndarray) -> str:
    first = f"{slide[0]:6.3f}{slide[1]:7.2f}{slide[2]:7.2f}{slide[3]:7.2f}{slide[4]:7.2f}{slide[5]:6.1f}"
    second = "".join(f"{value:6.2f}" for value in calm)
    third = f"{took[0]:6.2f}{took[1]:6.2f}{took[2]:6.1f}{took[3]:6.3f}{took[4]:6.2f}{took[5]:5.1f}{took[6]:6.1f}"
    return f"{name:7}{path:10}{first} |{second} |{third}{took[7]:6.1f}{took[8]:7.1f}{took[9]:8.0f}"


def taken(strain: Strain, between: float) -> np.ndarray:
    names = ("drop", "shift", "twist", "miss", "short", "hip", "ankle")
    return np.array([*(getattr(strain, name) for name in names), between, strain.pivoted, strain.pivot])


def picture(file: Path, turn: float | None) -> None:
    """Footprints from above: a walk laid on a slalom, or turned by so many degrees over one foot, its feet carried
    along with it, and held."""
    source = clip("16_15")
    both, listed = legs(source), contacts(source)
    names = source.skeleton.names
    balls = [contact for contact in listed if contact.joint in {names[leg.ball] for leg in both}]
    carry = carry_onto(source, PATHS["slalom"]) if turn is None else carry_around(source, balls[3], turn)
    shown = range(60, 360, 2) if turn is None else range(balls[3].first - 55, balls[3].last + 65, 2)
    tall = 1500 if turn is None else 840
    image = Image.new("RGB", (1240, tall), "white")
    pen, colours = ImageDraw.Draw(image), (((214, 102, 88), (246, 222, 218)), ((27, 73, 125), (214, 226, 240)))
    for panel, motion in enumerate((carried(source, carry), locked(source, carry, listed, both)[0])):
        tops, heels = (centimetres(motion) * points[..., [0, 2]] for points in tracks(motion, both))
        low = tops[:, shown].reshape(-1, 2).min(axis=0) - 25.0
        for leg, ball, heel, (dark, light) in zip(both, tops, heels, colours, strict=True):
            stands = np.zeros(motion.frames, bool)
            for contact in listed:
                if contact.joint == names[leg.ball]:
                    stands[contact.first : contact.last + 1] = True
            for frame in sorted(shown, key=lambda frame: stands[frame]):
                ends = [
                    (620 * panel + 5.2 * (x - low[0]), tall - 20 - 5.2 * (z - low[1]))
                    for x, z in (ball[frame], heel[frame])
                ]
                pen.line(ends, fill=dark if stands[frame] else light, width=4)
    with replacing(file) as stream:
        image.resize((620, tall // 2), Image.Resampling.LANCZOS).save(stream, "PNG", optimize=True)


def main() -> None:
    asked = argparse.ArgumentParser()
    asked.add_argument("--only", default="")
    asked.add_argument("--picture", type=Path)
    asked.add_argument("--turn", type=float)
    given = asked.parse_args()
    only = given.only
    if given.picture is not None:
        picture(given.picture, given.turn)
        return
    warnings.simplefilter("ignore")  # no frame rate in Acclaim files
    print(f"{'clip':7}{'path':10}{COLUMNS}")
    for name in CLIPS:
        if only not in name:
            continue
        source = clip(name)
        both, listed, speed = legs(source), contacts(source), slowness(source)
        own, ankles = joints_calm(source, both), sliding(source, source, listed, both, speed)
        nothing = taken(Strain.none(0), gap(source, both))
        print(row(name, "source", np.array(ankles), own / own, nothing), flush=True)
        for path, heading in {"still": None, **PATHS}.items():
            carry = np.zeros((source.frames, 3)) if heading is None else carry_onto(source, heading)
            made, strain = locked(source, carry, listed, both)
            print(row(name, path, *numbers(source, made, carry, strain)), flush=True)
            for problem in strain.problems:
                print(f"{'':17}{problem.sentence(made.frame_time)}")
        for degrees in SPINS:
            print(*spun(name, source, degrees), flush=True)
    wholes(only)
    turning(only)
    timed(clip("09_12"))


def numbers(source: mc.Motion, made: mc.Motion, carry: np.ndarray, strain: Strain) -> tuple[np.ndarray, ...]:
    both, listed, speed = legs(source), contacts(source), slowness(source)
    own, unlocked = joints_calm(source, both), joints_calm(carried(source, carry), both)
    calm = joints_calm(made, both) / own
    calm[4] *= own[4] / unlocked[4]  # the pelvis as it was laid on the path
    return np.array(sliding(made, source, listed, both, speed)), calm, taken(strain, gap(made, both))


def spun(name: str, source: mc.Motion, degrees: float) -> tuple[str, str]:
    """A row of the worst of all turns by so much over one foot that are held, and how many are."""
    both, listed = legs(source), contacts(source)
    balls = [c for c in listed if c.joint in {source.skeleton.names[leg.ball] for leg in both}]
    ready, found, tried = source_of(source, listed, both), [], 0
    usual = {problem.kind for problem in held(ready, np.zeros((source.frames, 3)))[1].problems}
    for contact in balls[1:-1]:
        for angle in (degrees, -degrees):
            carry, tried = carry_around(source, contact, angle), tried + 1
            made, strain = held(ready, carry)
            if {problem.kind for problem in strain.problems} <= usual:
                found.append(numbers(source, made, carry, strain))
    if not found:
        return f"{name:7}spin {degrees:3.0f}", f"  0 of {tried} held"
    slide, calm, took = (np.array(part) for part in zip(*found, strict=True))
    worst, least = slide.max(axis=0), took.max(axis=0)
    worst[5], least[7] = slide[:, 5].min(), took[:, 7].min()
    return row(name, f"spin {degrees:3.0f}", worst, calm.max(axis=0), least), f"{len(found)} of {tried} held"


def wholes(only: str) -> None:
    """Whole clips with turns on the spot on a straight path."""
    heads = "".join(f"{head:>9}" for head in ("contacts", "let go", "slide", "carried", "held", "pivots", "degrees"))
    print(f"\n{'':17}{heads}{'drop':>7}{'shift':>7}{'knee':>7}{'p99':>6}")
    for name in WHOLE:
        if only not in name:
            continue
        motion = clip(name)
        both, way = legs(motion), mc.Path([(0, 0), (0, mc.Path.of(motion).length)])
        for heading in ("tangent", "facing"):
            made = mc.follow(motion, way, heading=heading)
            feet = made.history[-1]["measured"]["feet"]
            calm = joints_calm(made, both) / joints_calm(motion, both)
            told = f"{feet['contacts']:9}{feet['released']:9}{feet['speed_own']:9.1f}{feet['speed_slid']:9.1f}"
            told += (
                f"{feet['speed']:9.2f}{feet['pivots']:9}{feet['pivoted']:9.0f}{feet['drop']:7.2f}{feet['shift']:7.2f}"
            )
            print(f"{name:7}{heading:10}{told}{calm[0]:7.2f}{calm[1]:6.2f}", flush=True)


def turning(only: str) -> None:
    """How far feet turn in one contact of the ball, over the ground and against the body, and how fast, over 40 ms."""
    print(f"\n{'':17}{'contacts':>9}{'over the ground, median, most':>32}{'deg/s':>7}{'against the body':>22}")
    for name in CLIPS | WHOLE:
        if only not in name:
            continue
        motion = clip(name)
        both, step = legs(motion), max(1, round(0.04 / motion.frame_time))
        places, (balls, heels) = kinematics.world(motion), tracks(motion, both)
        across = places[:, both[0].hip] - places[:, both[1].hip]
        body = np.unwrap(np.arctan2(across[:, 0], across[:, 2]))
        found = []
        for leg, way in zip(both, balls - heels, strict=True):
            foot = np.unwrap(np.arctan2(way[:, 0], way[:, 2]))
            for contact in contacts(motion):
                if contact.joint == motion.skeleton.names[leg.ball]:
                    span = slice(contact.first, contact.last + 1)
                    speed = np.abs(foot[span][step:] - foot[span][:-step]).max(initial=0.0) / (step * motion.frame_time)
                    found.append((np.ptp(foot[span]), speed, np.ptp((foot - body)[span])))
        turn, speed, against = np.degrees(np.array(found)).T
        told = f"{len(found):9}{np.median(turn):25.0f}{turn.max():7.0f}{speed.max():7.0f}"
        print(f"{name:17}{told}{np.median(against):15.0f}{against.max():7.0f}", flush=True)


def timed(motion: mc.Motion) -> None:
    """Processor time of 5000 frames, milliseconds, median of nine."""
    long = replace(motion, values=np.vstack([motion.values] * 3)[:5000])
    both, listed = legs(long), contacts(long)
    carry = carry_onto(long, PATHS["arc 3 m"])
    source = source_of(long, listed, both)
    still, _ = locked(long, 0.0 * carry, listed, both)
    done = source_of(still, contacts(still), both)
    pushed = np.sin(np.pi * np.clip((np.arange(5000) - 2600) / 200.0, 0.0, 1.0))[:, None] ** 2 * [0.0, 2.0, 1.0]
    for label, work in (
        ("contacts found", lambda: contacts(long)),
        ("made ready once", lambda: source_of(long, listed, both)),
        ("carried and locked, with forward kinematics", lambda: held(source, carry)),
        ("locked already, 200 of them carried elsewhere", lambda: held(done, pushed)),
        ("forward kinematics alone", lambda: kinematics.world(long)),
    ):
        work()
        spent = []
        for _ in range(9):
            start = time.process_time()
            work()
            spent.append(time.process_time() - start)
        print(f"5000 frames, {label}: {1000 * np.median(spent):.0f} ms")


if __name__ == "__main__":
    main()
