"""When feet stand on the floor, and where: spans that can be read, changed by hand and given back.

Source: Kovar, Schreiner and Gleicher 2002, Footskate cleanup for motion capture editing, section 3, for what a contact
is; two thresholds instead of one (hysteresis), so that a contact does not flicker.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from ..errors import OptionError, UnknownName
from ..info import tell_up
from ..kinematics import world
from ..motion import Clip, Motion, complete
from .floors import floors
from .legs import Leg, centimetres, legs, tracks

WALKING, RUNNING = 15.0, 45.0  # cm/s: slower feet come to stand
RUNS, PACE = 200.0, 0.25  # cm/s, over so many seconds: where people who go faster begin to run
HEIGHT = 4.0  # cm above the floor that a standing foot may be
LEAVING = 2.0  # times the speed at which a contact begins: where it ends
SMOOTH = 0.04  # seconds over which speeds are taken
SHAKES, NOISE = 8.0, 4.0  # times the speed, and the usual one of a contact, that no foot is fast in a frame as it comes
GAP, LEAST = 0.05, 0.1  # seconds: gaps that are closed, contacts that are too short
HELD = 0.05  # cm/s: no captured foot is so still for the least time; one that is has been locked


@dataclass(frozen=True)
class Contact:
    """A span in which a foot stands.

    joint: name of the ball of the foot, or of the ankle for its heel.
    first, last: frames, both in contact.
    place: x, y, z of the ball, or of the point of the heel on the floor, file units: the mean over the contact.
    """

    joint: str
    first: int
    last: int
    place: tuple[float, float, float]

    def to_json(self) -> dict[str, Any]:
        """The same as plain numbers and texts."""
        return {**asdict(self), "place": list(self.place)}


def contacts(
    clip: Clip, *, feet: str | Sequence[str] | None = None, speed: float | None = None, height: float = HEIGHT
) -> tuple[Contact, ...]:
    """When and where the balls and heels of both feet stand on the floor, in the order of their first frames.

    Parameters
    ----------
    feet
        The ball (toe base) of each foot; by default found by name and shape.
    speed
        Centimetres a second: slower than this, averaged over 40 ms, a foot comes to stand; it leaves at twice the
        speed. By default 15, or 45 where the body runs (half the time faster than 200).
    height
        Centimetres above the joint's own floor that a standing foot may be. The floor is a plane through the places
        where the joint is slow and low; it may slope, and is a ramp where both feet stand on one. On stairs more than
        their rise.

    Gaps shorter than 50 ms are closed, contacts shorter than 100 ms left out. Where a foot is held perfectly still, as
    after `lock_feet`, the contact is exactly that. Errors: Mismatch where there are no two legs or samples are missing,
    OptionError for a speed or height that is not above zero.

    >>> [(c.joint, c.first, c.last) for c in mc.contacts(mc.read("walk.bvh"))]
    """
    positive(speed=speed, height=height)
    motion = complete(clip.sample())
    both = legs(motion, feet)
    tell_up(motion, "feet stand")
    return found(motion, both, slowness(motion) if speed is None else speed, height)


def slowness(motion: Motion) -> float:
    """Centimetres a second below which a foot of this motion comes to stand: more where the body runs."""
    if motion.frames < 2:
        return WALKING
    middle = centimetres(motion) * world(motion)[..., [0, 2]].mean(axis=1)
    ahead = min(max(1, round(PACE / motion.frame_time)), motion.frames - 1)
    ways = np.linalg.norm(middle[ahead:] - middle[:-ahead], axis=1) / (ahead * motion.frame_time)
    return RUNNING if np.median(ways) > RUNS else WALKING


def found(motion: Motion, both: Sequence[Leg], speed: float, height: float, held: bool = True) -> tuple[Contact, ...]:
    """The contacts of legs that are known. held: whether a foot that is perfectly still for a while tells its own."""
    if motion.frames < 2:
        return ()
    scale, names = centimetres(motion), motion.skeleton.names
    balls, heels = tracks(motion, both)
    ways = [(leg.ball, ball) for leg, ball in zip(both, balls, strict=True)]
    ways += [(leg.ankle, heel) for leg, heel in zip(both, heels, strict=True) if leg.ball != leg.ankle]
    points = [scale * way for _, way in ways]
    paces = [_pace(point, motion.frame_time) for point in points]
    slow = [point[pace < speed] for point, pace in zip(points, paces, strict=True)]
    levels = floors(points, slow, height, len(both))
    listed = []
    for (joint, way), point, pace, floor in zip(ways, points, paces, levels, strict=True):
        for first, last in _standing(point, pace, point[:, 1] - floor, motion.frame_time, speed, height, held):
            x, y, z = (float(mean) for mean in way[first : last + 1].mean(axis=0))
            listed.append(Contact(names[joint], first, last, (x, y, z)))
    return tuple(sorted(listed, key=lambda contact: (contact.first, contact.joint)))


def read_contacts(
    given: Sequence[Contact | Mapping[str, Any]], motion: Motion, both: Sequence[Leg]
) -> tuple[Contact, ...]:
    """Contacts from what was given, checked against a clip: OptionError, UnknownName or Mismatch for what cannot be."""
    if isinstance(given, str | Mapping) or not isinstance(given, Iterable):
        raise OptionError(f"contacts are a list of them, not {given!r}")
    names = motion.skeleton.names
    known = sorted({names[joint] for leg in both for joint in (leg.ball, leg.ankle)})
    listed = [_read(one, motion.frames, known) for one in given]
    listed.sort(key=lambda contact: (contact.joint, contact.first))
    for one, after in pairwise(listed):
        if one.joint == after.joint and after.first <= one.last:
            raise OptionError(f"two contacts of {one.joint!r} share frame {after.first}")
    return tuple(sorted(listed, key=lambda contact: (contact.first, contact.joint)))


def positive(**numbers: float | None) -> None:
    """OptionError for a number that is not above zero; none is fine."""
    for name, value in numbers.items():
        if value is None:
            continue
        if isinstance(value, bool) or not isinstance(value, int | float) or not (np.isfinite(value) and value > 0):
            raise OptionError(f"{name} is a positive number, not {value!r}")


def runs(mask: np.ndarray) -> np.ndarray:
    """First frames, and frames after the last (N, 2), of the runs of True."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], mask, [False]])))
    return edges.reshape(-1, 2)


# -- in call order ---------------------------------------------------------------------------------


def _pace(track: np.ndarray, frame_time: float) -> np.ndarray:
    """Speed (F,) of a point (F, 3), averaged."""
    half = max(1, round(0.5 * SMOOTH / frame_time))
    ahead = np.minimum(np.arange(len(track)) + half, len(track) - 1)
    behind = np.maximum(np.arange(len(track)) - half, 0)
    pace: np.ndarray = np.linalg.norm(track[ahead] - track[behind], axis=1) / ((ahead - behind) * frame_time)
    return pace


def _standing(
    track: np.ndarray,
    pace: np.ndarray,
    above: np.ndarray,
    frame_time: float,
    speed: float,
    height: float,
    held: bool,
) -> list[tuple[int, int]]:
    """(first, last) frames in which a point (F, 3), cm, stands. pace: how fast it goes; above: how far it is above the
    floor, (F,)."""
    comes, goes = (pace < speed) & (above < height), (pace > LEAVING * speed) | (above > LEAVING * height)
    # the last of both that happened decides; before any, the foot does not stand
    last = np.maximum.accumulate(np.where(comes | goes, np.arange(len(track)), -1))
    down = comes[last] & (last >= 0) & ~goes[last]
    spans = [[int(first), int(end)] for first, end in runs(down)]
    joined: list[list[int]] = []
    for span in spans:
        if joined and (span[0] - joined[-1][1]) * frame_time < GAP:
            joined[-1][1] = span[1]
        else:
            joined.append(span)
    joined = [_settled(track, span, frame_time, speed) for span in joined]
    return [
        (first, end - 1)
        for span in joined
        for first, end in (_held(track, span, frame_time) if held else [span])
        if (end - first) * frame_time >= LEAST
    ]


def _settled(track: np.ndarray, span: list[int], frame_time: float, speed: float) -> list[int]:
    """The part of a span that begins after the point has come to rest and ends before it leaves: one that shakes goes
    nowhere on the mean, but does not stand. A clip that shakes throughout has no better part."""
    first, end = span
    near = round(LEAST / frame_time)
    steps = np.linalg.norm(np.diff(track[first:end], axis=0), axis=1) / frame_time
    shakes = steps > max(SHAKES * speed, NOISE * float(np.median(steps)) if len(steps) else 0.0)
    early, late = np.flatnonzero(shakes[:near]), np.flatnonzero(shakes[-near:][::-1])
    if len(early):
        first += int(early[-1]) + 1
    if len(late):
        end -= int(late[-1]) + 1
    return [first, max(end, first)]


def _held(track: np.ndarray, span: list[int], frame_time: float) -> list[list[int]]:
    """The parts of a span in which the point does not move at all over the ground, or the span if there are none."""
    step = np.linalg.norm(np.diff(track[span[0] : span[1], ::2], axis=0), axis=1)
    still = [[span[0] + int(a), span[0] + int(b) + 1] for a, b in runs(step < HELD * frame_time)]
    return [part for part in still if (part[1] - part[0]) * frame_time >= LEAST] or [span]


def _read(one: Contact | Mapping[str, Any], frames: int, known: Sequence[str]) -> Contact:
    row = one.to_json() if isinstance(one, Contact) else one
    if not isinstance(row, Mapping):
        raise OptionError(f"a contact is an object with joint, first, last and place, not {row!r}")
    missing = [name for name in ("joint", "first", "last", "place") if name not in row]
    if missing:
        raise OptionError(f"a contact has no {missing[0]!r}: it needs joint, first, last and place")
    joint, first, last = row["joint"], row["first"], row["last"]
    if joint not in known:
        raise UnknownName("ball or ankle of a leg", str(joint), known)
    for frame in (first, last):
        if isinstance(frame, bool) or not isinstance(frame, int | np.integer) or not 0 <= frame < frames:
            raise OptionError(f"a contact of {joint!r} has the frame {frame!r}: the clip has frames 0 to {frames - 1}")
    if last < first:
        raise OptionError(f"a contact of {joint!r} ends at frame {last}, before its first, {first}")
    try:
        x, y, z = (float(number) for number in row["place"])
    except (TypeError, ValueError):
        raise OptionError(f"the place of a contact is three numbers, not {row['place']!r}") from None
    if not np.isfinite([x, y, z]).all() or max(abs(x), abs(y), abs(z)) > 1e12:
        raise OptionError(f"the place of a contact is three numbers, not {row['place']!r}")
    return Contact(joint, int(first), int(last), (x, y, z))
