"""What a joint may do: angles of it that have a least and a largest value, read from its rotations and put back.

Each kind has `names` of its angles, `low` and `high` (n,) in degrees, `angles(values)` (F, n), of each frame for
itself, and `put(values, before, after, frames)`, which writes changed angles at some frames into the channels. An
angle is put back exactly, whatever the others are.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from .. import rotation
from ..errors import OptionError
from ._poses import smooth

End = tuple[float | None, float | None]  # low and high, None where open


class Limit(Protocol):
    """What all kinds have."""

    @property
    def names(self) -> tuple[str, ...]: ...
    @property
    def low(self) -> np.ndarray: ...
    @property
    def high(self) -> np.ndarray: ...
    def angles(self, values: np.ndarray) -> np.ndarray: ...
    def put(self, values: np.ndarray, before: np.ndarray, after: np.ndarray, frames: np.ndarray) -> None: ...


@dataclass(frozen=True, eq=False)
class OfChannel:
    """The values of one channel (its column), whole turns included."""

    names: tuple[str]
    column: int
    low: np.ndarray
    high: np.ndarray

    def angles(self, values: np.ndarray) -> np.ndarray:
        return values[:, [self.column]]

    def put(self, values: np.ndarray, before: np.ndarray, after: np.ndarray, frames: np.ndarray) -> None:
        values[frames, self.column] = after[frames, 0]


@dataclass(frozen=True, eq=False)
class OfJoint:
    """What kinds have in common that read the rotation of a joint, whose channels stand in `columns`."""

    names: tuple[str, ...]
    columns: list[int]
    order: str
    low: np.ndarray
    high: np.ndarray

    def angles(self, values: np.ndarray) -> np.ndarray:
        return self.read(rotation.from_euler(values[:, self.columns], self.order))

    def put(self, values: np.ndarray, before: np.ndarray, after: np.ndarray, frames: np.ndarray) -> None:
        own = values[frames[:, None], self.columns]
        turned = self.moved(rotation.from_euler(own, self.order), before[frames], after[frames])
        values[frames[:, None], self.columns] = nearest_euler(turned, self.order, own)

    def read(self, wxyz: np.ndarray) -> np.ndarray:
        """Angles (F, n) of rotations (F, 4)."""
        raise NotImplementedError

    def moved(self, wxyz: np.ndarray, before: np.ndarray, after: np.ndarray) -> np.ndarray:
        """The rotations (F, 4) with these angles (F, n) in place of those they have."""
        raise NotImplementedError


@dataclass(frozen=True, eq=False)
class Eulers(OfJoint):
    """Euler angles about axes of the joint's own, which `axes` (4,) makes of those of the body (Acclaim)."""

    axes: np.ndarray
    turns: str  # their order, as a rotation order

    def read(self, wxyz: np.ndarray) -> np.ndarray:
        own = rotation.mul(rotation.mul(rotation.inv(self.axes), wxyz), self.axes)
        middle = 0.5 * (np.maximum(self.low, -180.0) + np.minimum(self.high, 180.0))
        ways = _ways(own, self.turns, middle)
        over = np.maximum(np.maximum(ways - self.high, self.low - ways), 0.0).sum(axis=-1)
        return ways[np.argmin(over, axis=0), np.arange(len(own))]

    def moved(self, wxyz: np.ndarray, before: np.ndarray, after: np.ndarray) -> np.ndarray:
        was, now = (rotation.from_euler(angles, self.turns) for angles in (before, after))
        own = rotation.mul(rotation.mul(rotation.inv(self.axes), wxyz), self.axes)
        left = rotation.mul(rotation.inv(was), own)  # nothing, unless the angles cannot say the rotation
        return rotation.mul(rotation.mul(self.axes, rotation.mul(now, left)), rotation.inv(self.axes))


@dataclass(frozen=True, eq=False)
class Hinge(OfJoint):
    """How far the bone below (`tip`, in the joint's frame) is bent away from going straight on along the bone above.

    bone: (3,) where that one points, in the frame above the joint; axis: (3,) about which positive angles bend.
    """

    bone: np.ndarray
    tip: np.ndarray
    axis: np.ndarray

    def read(self, wxyz: np.ndarray) -> np.ndarray:
        below = rotation.rotate(wxyz, self.tip)
        across = np.cross(self.axis, self.bone)
        ahead = self.bone - (self.bone @ self.axis) * self.axis
        angle = np.degrees(np.arctan2(below @ across, below @ ahead))  # both seen along the axis
        return np.where(angle < -90.0, angle + 360.0, angle)[:, None]  # no knee passes there

    def moved(self, wxyz: np.ndarray, before: np.ndarray, after: np.ndarray) -> np.ndarray:
        return rotation.mul(rotation.exp(np.radians(after - before) * self.axis), wxyz)


@dataclass(frozen=True, eq=False)
class Ball(OfJoint):
    """How far a limb has swung away from the middle of a cone, and how far it is twisted about itself.

    limb: (3,) where it points, and hinge: (3,) the axis of the joint below it, both in the joint's frame.
    centre: (3,) the middle of the cone, and zero: (3,) where that axis points there without twist, both in the frame
    above. Zero twist elsewhere is what the shortest way from the middle makes of it, so that swing and twist do not
    touch each other; they are singular only right opposite to the middle.
    """

    limb: np.ndarray
    hinge: np.ndarray
    centre: np.ndarray
    zero: np.ndarray

    def read(self, wxyz: np.ndarray) -> np.ndarray:
        limb, hinge = (rotation.rotate(wxyz, vector) for vector in (self.limb, self.hinge))
        swing = np.arctan2(np.linalg.norm(np.cross(self.centre, limb), axis=-1), limb @ self.centre)
        zero = rotation.rotate(_arc(self.centre, limb), self.zero)
        twist = np.arctan2((limb * np.cross(zero, hinge)).sum(axis=-1), (zero * hinge).sum(axis=-1))
        return np.degrees(np.stack([swing, twist], axis=1))

    def moved(self, wxyz: np.ndarray, before: np.ndarray, after: np.ndarray) -> np.ndarray:
        swung, twisted = np.radians(after - before).T
        limb = rotation.rotate(wxyz, self.limb)
        about = np.cross(self.centre, limb)
        size = np.linalg.norm(about, axis=-1, keepdims=True)
        about = np.where(size < 1e-9, self.zero, about / np.maximum(size, 1e-9))  # right opposite any way is as good
        near = smooth(np.clip(before[:, 0] / self.high[0], 0.0, 1.0))  # at the middle no way leads back to it
        made = rotation.mul(rotation.exp((swung * near)[:, None] * about), wxyz)
        return rotation.mul(rotation.exp(twisted[:, None] * rotation.rotate(made, self.limb)), made)


def nearest_euler(wxyz: np.ndarray, order: str, near: np.ndarray) -> np.ndarray:
    """Euler angles (F, n) of rotations (F, 4), of all that say the same those nearest to the angles `near` (F, n)."""
    ways = _ways(wxyz, order, near)
    off = np.abs(ways - near).max(axis=-1, initial=0.0)
    return ways[np.argmin(off, axis=0), np.arange(len(near))]


def parse(given: Any, what: str) -> dict[str, End]:
    """{name: (low, high)} from a mapping or from texts "LeftArm.Zrotation=-90:45"; None for a side left open."""
    found = {}
    for name, ends in by_name(given, f"a {what} is NAME=LOW:HIGH, like LeftArm.Zrotation=-90:45"):
        ends = ends.split(":") if isinstance(ends, str) else ends
        try:
            low, high = (None if end is None or end == "" else float(end) for end in ends)
        except (TypeError, ValueError):
            low = high = None
        told = [end for end in (low, high) if end is not None]
        if not told or not np.isfinite(told).all() or told != sorted(told):
            shown = (
                ":".join("" if end is None else str(end) for end in ends) if isinstance(ends, list | tuple) else ends
            )
            raise OptionError(
                f"{name}: a {what} is LOW:HIGH, the lower first, one of them may be left out; not {shown}"
            )
        found[str(name)] = (low, high)
    return found


def by_name(given: Any, form: str) -> list[tuple[str, Any]]:
    """Names and what is said of each, from a mapping or from texts NAME=...; OptionError says the form."""
    if isinstance(given, Mapping):
        return list(given.items())
    entries = []
    for item in [given] if isinstance(given, str) else given:
        name, equals, text = item.rpartition("=") if isinstance(item, str) else ("", "", "")
        if not equals or not name.strip():
            raise OptionError(f"{form}; not {item!r}")
        entries.append((name.strip(), text))
    return entries


def _ways(wxyz: np.ndarray, order: str, near: np.ndarray) -> np.ndarray:
    """(W, F, n) the Euler angles that say rotations (F, 4), whole turns away from `near` taken out; one way or two."""
    angles = rotation.to_euler(wxyz, order)
    ways = [angles]
    if len(order) == 3 and order[1] not in (order[0], order[2]):
        other = angles + 180.0
        other[:, 1] = 180.0 - angles[:, 1]
        ways.append(other)
    return np.stack([way + 360.0 * np.rint((near - way) / 360.0) for way in ways])


def _arc(start: np.ndarray, ends: np.ndarray) -> np.ndarray:
    """(F, 4) the shortest rotation from one direction (3,) to others (F, 3); all of length 1."""
    q = np.concatenate([1.0 + ends @ start[:, None], np.cross(start, ends)], axis=1)
    size = np.linalg.norm(q, axis=1, keepdims=True)
    return np.where(size > 1e-12, q / np.maximum(size, 1e-12), [0.0, 1.0, 0.0, 0.0])
