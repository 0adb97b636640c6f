"""What the commands that change clips share: where the result goes, and what is told of it."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from cyclopts import Parameter

from .. import kinematics, rotation
from ..formats import format_of, write
from ..keyed import KeyedMotion
from ..motion import Clip, Motion
from ..spline import SplineMotion
from ._options import check_outputs, tell

Output = Annotated[
    Path, Parameter(name=("--output", "-o"), help="Where the result goes; the extension says which format.")
]
Lossless = Annotated[
    bool, Parameter(help="Numbers with all their digits, where the format otherwise rounds (BVH, CSV: six decimals).")
]


SHOWN = 1e-12  # degrees or units: an angle between two equal rotations is not quite 0


@dataclass(frozen=True)
class Edited:
    """What a verb made: the numbers of it, and a sentence or more."""

    clip: Clip
    numbers: dict[str, Any] = field(default_factory=dict)
    sentences: tuple[str, ...] = ()

    def __str__(self) -> str:
        return "\n".join([repr(self.clip).strip("<>"), *self.sentences])

    def to_json(self) -> dict[str, Any]:
        """The same as plain numbers, texts and lists."""
        size: dict[str, Any] = {"kind": type(self.clip).__name__, "frames": self.clip.frames}
        size |= {"frame_time": self.clip.frame_time, "duration": self.clip.duration}
        if isinstance(self.clip, KeyedMotion):
            size["keys"] = self.clip.keys
        if isinstance(self.clip, SplineMotion):
            size["coefficients"] = len(self.clip.values)
        step = {k: v for k, v in self.clip.history[-1].items() if k not in ("with", "performance")}
        return {**step, **size, **self.numbers}


def check_files(output: Path, *sources: Path) -> None:
    """Refused before work is done: a format that nobody knows, a missing folder, a file over itself."""
    format_of(output)
    for source in sources:
        check_outputs(source, output)


def finish(made: Edited, output: Path, profile: str | None, lossless: bool, json: bool, *also: Path | None) -> None:
    """Write the result and tell the numbers, and what else was written."""
    write(output, made.clip, profile=profile, lossless=lossless)
    tell(made, json, output, *also)


def changed(before: Clip, after: Clip) -> dict[str, Any]:
    """How far two clips of one body are apart over the frames of both: the joint that is turned most, degrees, and the
    position channel that is moved most, file units; each with its time, seconds."""
    first = before.sample(after.frame_time)
    second = after.sample()
    if first.skeleton.channel_names != second.skeleton.channel_names:
        return {}
    frames = min(first.frames, second.frames)
    first, second = first[:frames], second[:frames]
    turned = rotation.angle(kinematics.rotations(first), kinematics.rotations(second))
    names = np.array(first.skeleton.channel_names)
    moves = ~first.skeleton.rotation_channels
    told: dict[str, Any] = {}
    if turned.size:
        told["turned"] = _most(turned, list(first.skeleton.names), "degrees", after.frame_time)
    if moves.any() and frames:
        apart = np.abs(second.values - first.values)[:, moves]
        told["moved"] = _most(apart, names[moves].tolist(), "units", after.frame_time)
    return told


def nothing(clip: Clip) -> Motion:
    """A displacement of as many frames that does nothing."""
    return Motion(clip.skeleton, np.zeros((clip.frames, clip.skeleton.channel_count)), clip.frame_time)


def sentence(told: dict[str, Any], of: str) -> str:
    """What `changed` found, in words."""
    parts = [
        f"{row['name']} by {row['by']:.3g} {row['unit']} at {row['time']:.3g} s"
        for row in told.values()
        if row["by"] > SHOWN
    ]
    return f"{of}: {', '.join(parts) or 'nothing'}"


def _most(apart: np.ndarray, names: list[str], unit: str, frame_time: float) -> dict[str, Any]:
    frame, place = (int(found) for found in np.unravel_index(np.argmax(apart), apart.shape))
    return {"name": names[place], "by": float(apart[frame, place]), "unit": unit, "time": frame * frame_time}
