"""`mocurve warp`: curves bent to given values."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import numpy as np
from cyclopts import Parameter

from ..edit import warp as verb
from ..edit._pair import at_times
from ..edit.trim import trim
from ..errors import OptionError
from ..formats import read
from ..motion import Clip
from ._edits import Edited, Lossless, Output, changed, check_files, finish, sentence
from ._options import Json, Profile, Source, with_options_of
from ._terminal import told_when_compiling

At = Annotated[
    list[str],
    Parameter(
        help="When (seconds), and what channels are then: --at 1.2 LeftArm.Zrotation=30. Give it as often as needed.",
        consume_multiple=True,
    ),
]
Pose = Annotated[Path | None, Parameter(help="A clip with the pose to go through instead of values: one frame.")]
PoseAt = Annotated[float | None, Parameter(help="Which moment of that clip, seconds, where it has more frames.")]


@with_options_of(verb.warp)
@told_when_compiling()
def warp(
    file: Source,
    /,
    *,
    output: Output,
    at: At,
    pose: Pose = None,
    pose_at: PoseAt = None,
    profile: Profile = None,
    lossless: Lossless = False,
    json: Json = False,
    **options: Any,
) -> None:
    """A clip bent smoothly so that channels have given values at given times.

    Nothing changes outside --support. Keys stay keys.

    For example:
      mocurve warp jump.bvh -o raised.bvh --at 1.2 LeftArm.Zrotation=30
      mocurve warp jump.bvh -o low.bvh --at 1 Hips.Yposition=16 --support 0.3
      mocurve warp walk.bvh -o posed.bvh --at 1.2 --pose run.bvh --pose-at 0.8
    """
    check_files(output, file, *([] if pose is None else [pose]))
    clip = read(file)
    times, values = _asked(at)
    shown = None if pose is None else _moment(read(pose), pose_at, pose)
    made = verb.warp(clip, times, values or None, pose=shown, **options)
    told = changed(clip, made)
    rows = _met(clip, made)
    numbers = {"changed": told, "met": rows}
    lines = [f"{row['channel']} at {row['time']:.6g} s: {row['before']:.6g} -> {row['after']:.6g}" for row in rows]
    finish(Edited(made, numbers, (*lines, sentence(told, "changed"))), output, profile, lossless, json)


def _asked(tokens: list[str]) -> tuple[list[float], dict[str, list[float | None]]]:
    """Times, and for each channel its value at each of them, from "1.2 LeftArm.Zrotation=30 ..."."""
    times: list[float] = []
    rows: list[tuple[int, str, float]] = []
    for token in tokens:
        name, equals, number = token.rpartition("=")
        try:
            value = float(number)
        except ValueError:
            raise OptionError(f"--at takes a time, then CHANNEL=VALUE for that time; not {token!r}") from None
        if not equals:
            times.append(value)
        elif not times:
            raise OptionError(f"--at takes a time first, then CHANNEL=VALUE for that time; not {token!r}")
        else:
            rows.append((len(times) - 1, name, value))
    values: dict[str, list[float | None]] = {}
    for place, name, value in rows:
        each = values.setdefault(name, [None] * len(times))
        if each[place] is not None:
            raise OptionError(f"two values of {name} are asked for at {times[place]:g} s")
        each[place] = value
    return times, values


def _moment(clip: Clip, at: float | None, path: Path) -> Clip:
    if at is None:
        if clip.frames != 1:
            raise OptionError(f"{path} has {clip.frames} frames; --pose-at says which moment is the pose")
        return clip
    if not 0 <= at <= clip.duration + 0.5 * clip.frame_time:
        raise OptionError(f"--pose-at {at:g} s lies outside of {path}, which goes from 0 to {clip.duration:g} s")
    return trim(clip, start=at, end=at)


def _met(before: Clip, after: Clip) -> list[dict[str, Any]]:
    """What was asked and what came of it, a row a constraint."""
    step = after.history[-1]
    asked = [
        (name, time, value)
        for name, values in step.get("values", {}).items()
        for time, value in zip(step["at"], values, strict=True)
        if value is not None
    ]
    times = np.array([time for _, time, _ in asked])
    old, new = (at_times(clip, times, clip.frame_time).values for clip in (before, after))
    places = [before.skeleton.channel(name) for name, _, _ in asked]
    return [
        {
            "channel": name,
            "time": time,
            "before": float(old[row, place]),
            "asked": value,
            "after": float(new[row, place]),
        }
        for row, ((name, time, value), place) in enumerate(zip(asked, places, strict=True))
    ]
