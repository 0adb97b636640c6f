"""A clip as animation programs have it: joints with three positions and three rotations, moved by curves or not."""

from __future__ import annotations

import os
import re
import unicodedata
import warnings
from collections.abc import Collection, Sequence
from typing import NamedTuple

import numpy as np

from ..errors import Mismatch
from ..info import unit_of
from ..keyed import KeyedMotion
from ..motion import Clip, unroll
from ..skeleton import AXES
from ._files import Path

_EMPTY = "joint"  # the name of a joint that has none


class Curve(NamedTuple):
    """What moves one of a joint's six values.

    times: (K,) seconds, rising. values: (K,) degrees or file length. slopes, in_slopes: (K,) per second, leaving and
    arriving; empty: straight lines from key to key.
    """

    times: np.ndarray
    values: np.ndarray
    slopes: np.ndarray = np.zeros(0)
    in_slopes: np.ndarray = np.zeros(0)

    @property
    def straight(self) -> bool:
        return not len(self.slopes)


class Joint(NamedTuple):
    """parent: index, -1 for a root. offset: what the positions rest at, file length. order: three axes as a BVH file
    lists them, "ZYX"; an axis without a channel stands at the end. curves: by channel kind, "Xposition"; no two frames
    means no curve."""

    name: str
    parent: int
    offset: tuple[float, float, float]
    order: str
    curves: dict[str, Curve]

    @property
    def moves(self) -> list[str]:
        """Which of "position" and "rotation" have a curve."""
        return [kind for kind in ("position", "rotation") if any(name.endswith(kind) for name in self.curves)]

    def rest(self, kind: str) -> tuple[float, float, float]:
        """Values at X, Y, Z where no curve moves them."""
        return self.offset if kind == "position" else (0.0, 0.0, 0.0)


class Rig(NamedTuple):
    """metres: of a file length unit. end: seconds from first to last frame. keyed: whether the curves have slopes."""

    joints: list[Joint]
    metres: float
    frame_time: float
    frames: int
    end: float
    keyed: bool


def rig(clip: Clip, names: Sequence[str], *, sampled: bool = False) -> Rig:
    """The clip under these joint names: keys as they are; samples, or `sampled` keys, unrolled and straight between.

    Warns where the length unit is a guess; OptionError where there is nothing to guess it from. Mismatch where a number
    is not finite, or where a joint has a channel twice.
    """
    body = clip.skeleton
    keyed = isinstance(clip, KeyedMotion) and not sampled
    if isinstance(clip, KeyedMotion) and keyed:
        curves = [Curve(c.times, c.values, c.slopes, c.in_slopes) for c in clip.curves]
    else:
        motion = clip.sample()
        _finite(body.channel_names, motion.values.T)
        times = np.arange(motion.frames) * motion.frame_time
        curves = [Curve(times, column) for column in unroll(motion).values.T]
    for part in range(len(Curve._fields)):
        _finite(body.channel_names, [curve[part] for curve in curves])
    _finite(body.names, body.offsets)
    metres = _metres(clip)
    joints, first = [], 0
    for name, kinds, parent, offset in zip(
        names, body.channels, body.parents.tolist(), body.offsets.tolist(), strict=True
    ):
        if len(set(kinds)) < len(kinds):
            raise Mismatch(f"joint {name!r} has a channel twice")
        moved = dict(zip(kinds, curves[first : first + len(kinds)], strict=True))
        first += len(kinds)
        moved = {kind: curve for kind, curve in moved.items() if len(curve.times)}
        joints.append(Joint(name, parent, tuple(offset), _order(kinds), moved))
    return Rig(joints, metres, clip.frame_time, clip.frames, clip.duration, keyed)


def _metres(clip: Clip) -> float:
    if clip.skeleton.unit is not None:
        return clip.skeleton.unit
    unit = unit_of(clip.sample())
    warnings.warn(
        f"no length unit was said: the body's height suggests the {unit.name}; say it with the option unit",
        stacklevel=5,
    )
    return unit.metres


def _order(kinds: Sequence[str]) -> str:
    turning = "".join(kind[0] for kind in kinds if kind.endswith("rotation"))
    return turning + "".join(axis for axis in AXES if axis not in turning)


def _finite(names: Sequence[str], rows: Sequence[np.ndarray] | np.ndarray) -> None:
    for name, row in zip(names, rows, strict=True):
        odd = ~np.isfinite(row)
        if odd.any():
            place = int(np.argmax(odd))
            raise Mismatch(f"number {place} of {name!r} is {row[place]}, which cannot be written")


def identifiers(names: Sequence[str], program: str, reserved: Collection[str] = ()) -> list[str]:
    """Names of ASCII letters, digits and underscores, each only once; warns of those that had to change."""
    return _renamed(names, [identifier(name) for name in names], program, reserved)


def different(names: Sequence[str], program: str) -> list[str]:
    """Names each only once and without control characters; warns of those that had to change."""
    return _renamed(names, [re.sub(r"[\0-\x1f]", "_", name) or _EMPTY for name in names], program, ())


def identifier(name: str) -> str:
    """The name in ASCII letters, digits and underscores, no digit first; letters lose their accents."""
    plain = "".join(c for c in unicodedata.normalize("NFKD", name) if not unicodedata.combining(c))
    plain = re.sub(r"[^0-9A-Za-z_]", "_", plain)
    return "_" + plain if plain[:1].isdigit() else plain or _EMPTY


def _renamed(names: Sequence[str], wanted: list[str], program: str, reserved: Collection[str]) -> list[str]:
    taken = {*wanted, *reserved}
    seen = dict.fromkeys(reserved, 1)  # how often a name was asked for, or the last number that was put after it
    result = []
    for name in wanted:
        seen[name] = seen.get(name, 0) + 1
        free = name
        while seen[name] > 1 and free in taken:
            free = f"{name}_{seen[name]}"
            seen[name] += free in taken
        taken.add(free)
        result.append(free)
    changed = [f"{old!r} is {new!r}" for old, new in zip(names, result, strict=True) if old != new]
    if changed:
        more = f" and {len(changed) - 3} more" if len(changed) > 3 else ""
        warnings.warn(f"joint names changed for {program}: {', '.join(changed[:3])}{more}", stacklevel=5)
    return result


def single(values: np.ndarray, program: str) -> np.ndarray:
    """The values in single precision; Mismatch where one is more than that can hold."""
    with np.errstate(over="ignore"):
        short = values.astype(np.float32)
    if not np.isfinite(short).all():
        raise Mismatch(f"{values[~np.isfinite(short)][0]:g} is more than the single precision of {program} can hold")
    return short


def scaled(values: np.ndarray, factor: float) -> np.ndarray:
    """The values times a factor; Mismatch where that is more than a number can hold."""
    with np.errstate(over="ignore"):
        product = factor * values
    if not np.isfinite(product).all():
        raise Mismatch(f"{values[~np.isfinite(product)][0]:g} times {factor:g} is more than a number can hold")
    return product


def frame_numbers(times: np.ndarray, frame_time: float) -> np.ndarray:
    """Times in frames; whole numbers where they are frames but for rounding."""
    frames = times / frame_time
    whole = np.rint(frames)
    return np.where(np.abs(frames - whole) <= 1e-12 * np.maximum(np.abs(whole), 1.0), whole, frames)


def stem(path: Path) -> str:
    """The file's name without folder and extension: what the animation is called."""
    return os.path.splitext(os.path.basename(os.fsdecode(path)))[0] or "clip"
