"""What became of a clip's own path: the numbers that the verb `follow` records, and what it warns of."""

from __future__ import annotations

import warnings
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from ..motion import Motion
from ..path_length import LengthTable
from . import _bearing
from ._along import STRIDES, Course, Way
from ._seams import centimetres
from ._steps import Steps


@dataclass(frozen=True)
class Following:
    """What became of the clip's own path.

    unit:        of the lengths that follow: "cm", or "units" of the file where nobody knows how long these are.
    own_length:  of the clip's own path; length: of the new one. cycle: how far the cycle goes that is repeated; None
                 where none is.
    travelled:   along the new path, from the first frame to the last.
    beyond:      how much of that lies straight on behind an end of the path.
    residual:    how far the root is from the clip's own path, root mean square.
    frames:      of the result; cycles: how often the motion begins in it.
    stride:      how long strides are in modes scaled and span, times the source's; slower: how many times as long the
                 clip, or its edited span, takes, because strides stay within 0.6 and 1.15, or because of bends.
    first, last: frame from which and to which the result differs from the clip; None where it does not.
    turned:      the most that a frame is turned, degrees.
    feet:        the numbers of `Steps`; None where no feet were held.
    """

    unit: str
    own_length: float
    length: float
    travelled: float
    beyond: float
    residual: float
    frames: int
    cycles: int
    stride: float
    slower: float
    first: int | None
    last: int | None
    turned: float
    feet: dict[str, Any] | None = None
    cycle: float | None = None

    def __str__(self) -> str:
        each = "" if self.cycle is None else f" of {self.cycle:.4g} {self.unit}"
        again = f", {self.cycles} cycles{each}" if self.cycles > 1 else ""
        lines = [
            f"own path: {self.own_length:.4g} {self.unit}, the root {self.residual:.3g} {self.unit} away from it",
            f"new path: {self.length:.4g} {self.unit}, {self.travelled:.4g} {self.unit} of it gone along in "
            f"{self.frames} frames{again}",
        ]
        if self.beyond > 0.001 * self.length:
            lines.append(f"the path is shorter than that: {self.beyond:.4g} {self.unit} lie straight on behind its end")
        if self.stride != 1.0:
            time = "" if self.slower == 1.0 else f" and takes {self.slower:.3g} times the time"
            lines.append(f"the way that strides make is {self.stride:.3g} times as long{time}")
        elif self.slower != 1.0:
            lines.append(f"bends are taken more slowly: in all {self.slower:.3g} times the time")
        changed = "nothing" if self.first is None else f"frames {self.first} to {self.last}"
        lines.append(f"changed: {changed}, turned by up to {self.turned:.3g} degrees")
        if self.feet is not None and self.feet["contacts"]:
            lines.append(str(Steps(**self.feet)))
        return "\n".join(lines)

    def to_json(self) -> dict[str, Any]:
        """The same as plain numbers and texts."""
        return asdict(self)


def measured(
    base: Motion,
    made: Motion,
    course: Course,
    table: LengthTable,
    found: Way,
    by: np.ndarray,
    cycles: tuple[int, float | None],
) -> Following:
    """What became of a base that was laid along a path (`made`, with a T-pose in front or not). course: the clip's.
    cycles: how often the motion begins, and how far one goes where it was repeated, file units."""
    length = centimetres(base)
    scale = length or 1.0
    ahead = made.frames - base.frames
    moved = ahead + np.flatnonzero(_differ(made.values[ahead:], base.values))
    return Following(
        unit="cm" if length else "units",
        own_length=scale * course.table.length,
        length=scale * table.length,
        travelled=scale * sum(float(np.abs(np.diff(found.distance[run])).sum()) for run in _bearing.runs(found.cycle)),
        beyond=scale * float(np.ptp(found.distance) - np.ptp(np.clip(found.distance, 0.0, table.length))),
        residual=scale * course.residual,
        frames=made.frames,
        cycles=cycles[0],
        stride=found.stride,
        slower=found.slower,
        first=int(moved[0]) if len(moved) else None,
        last=int(moved[-1]) if len(moved) else None,
        turned=float(np.degrees(np.abs(by[:, 0]).max(initial=0.0))),
        cycle=None if cycles[1] is None else scale * cycles[1],
    )


def tell(measured: Following) -> None:
    """Warnings of a clip that goes nowhere and of strides that nobody takes."""
    if measured.own_length <= 0.0 < measured.length:
        warnings.warn("the clip goes nowhere: it is put where the path begins, facing as it does", stacklevel=3)
    if not STRIDES[0] <= measured.stride <= STRIDES[1]:
        warnings.warn(
            f"the edit makes strides {measured.stride:.3g} times as long, beyond {STRIDES[0]} to {STRIDES[1]}: "
            f"the rest goes into time, {measured.slower:.3g} times as much",
            stacklevel=3,
        )


def _differ(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """(F,) frames in which values (F, C) are not the same; channel after channel, as they are stored."""
    found = np.zeros(len(a), bool)
    for mine, other in zip(a.T, b.T, strict=True):
        found |= mine != other
    return found
