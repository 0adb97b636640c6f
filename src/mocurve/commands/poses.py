"""`mocurve poses`: whole poses to look at."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from cyclopts import Parameter

from .. import draw, reduction
from ..errors import OptionError
from ..formats import read
from ..formats._files import replacing
from ..kinematics import rest_height
from ..measure import Report
from ..motion import Clip
from ..reduction.poses import by_number
from ..reduction.poses import pins as pinned_frames
from ..reduction.probe import weights as combinations
from ._options import Json, Source, check_outputs, tell
from ._terminal import told_when_compiling

Number = Annotated[
    int | None, Parameter(help="How many poses. Without it: what every number of keys leaves, in the method's measure.")
]
Method = Annotated[
    str | None,
    Parameter(
        help="How they are chosen: optimal, broken, salient, posture, probe or cluster; docs/poses.md tells them."
    ),
]
Pin = Annotated[
    list[str] | None,
    Parameter(
        help="Where a key has to be: a frame (40), a time (1.2s), or contacts, where a foot comes to stand and where "
        "it stands last.",
        consume_multiple=True,
    ),
]
Quality = Annotated[str, Parameter(help="fast, default, good or best: less error for more time.")]
Sheet = Annotated[Path | None, Parameter(help="Draw the poses with their times here, a contact sheet (.png).")]
Plot = Annotated[
    Path | None, Parameter(help="Draw the error against the number of keys here (.png), all methods in one picture.")
]
Weights = Annotated[
    Path | None,
    Parameter(help="Write W here (.csv): each frame as a combination of the key poses, a column a key."),
]
PLOTTED = 8  # numbers of keys on the plot
PLOTTED_PARTS = (0.02, 0.3)  # of the frames, as keys: from, to


@dataclass(frozen=True)
class Chosen:
    """So many poses, and how far the curves through them are off."""

    frames: tuple[int, ...]
    frame_time: float
    report: Report

    def __str__(self) -> str:
        times = "  ".join(f"{frame * self.frame_time:.3g} s ({frame})" for frame in self.frames)
        return f"poses      {times}\n{self.report}"

    def to_json(self) -> dict[str, Any]:
        return {"keys": len(self.frames), "key_frames": list(self.frames), "frame_time": self.frame_time} | {
            name: getattr(self.report, name) for name in ("method", "max_error_world", "rms_error_world", "seconds")
        }


@dataclass(frozen=True)
class Range:
    """What every number of keys leaves."""

    poses: reduction.Poses

    def __str__(self) -> str:
        found = self.poses
        powers = {round(found.fewest * 1.25**power) for power in range(60)}
        shown = sorted(keys for keys in {found.fewest, *powers, found.most} if found.fewest <= keys <= found.most)
        rows = [f"{keys:7d}  {found.error(keys):.4g}" for keys in shown]
        return "\n".join([f"{found.method}: {found.measure}", "   keys  error", *rows])

    def to_json(self) -> dict[str, Any]:
        found = self.poses
        numbers = list(range(found.fewest, found.most + 1)) if found.choices else []
        return {"method": found.method, "measure": found.measure, "keys": numbers, "errors": found.errors.tolist()}


@told_when_compiling()
def poses(
    file: Source,
    /,
    *,
    keys: Number = None,
    method: Method = None,
    pin: Pin = None,
    quality: Quality = "default",
    sheet: Sheet = None,
    plot: Plot = None,
    weights: Weights = None,
    json: Json = False,
) -> None:
    """The frames that say most of a clip, as an animator would block it.

    With --keys the best so many poses, and a contact sheet of them. Without, what
    every number of keys leaves: slide from few to all. `mocurve reduce --keys`
    makes the curves.

    For example:
      mocurve poses jump.bvh --keys 12 --sheet poses.png
      mocurve poses jump.bvh --keys 12 --pin 0.8s --pin contacts --json
      mocurve poses jump.bvh --method salient --plot errors.png
    """
    check_outputs(file, sheet, plot, weights)
    for picture in (sheet, plot):
        if picture is not None and picture.suffix.lower() != ".png":
            raise OptionError(f"{picture.name}: the extension of this picture is .png, not {picture.suffix.lower()!r}")
    if keys is None and (sheet is not None or weights is not None):
        raise OptionError("a sheet and weights are of some poses: say how many with --keys")
    clip = read(file)
    pins = pin or []
    if keys is None:
        found: Range | Chosen = Range(reduction.poses(clip, method=method or "salient", pin=pins))
    else:
        made = reduction.reduce(clip, keys=keys, method=method or "optimal", pin=pins, quality=quality)
        assert made.report is not None  # reduce always measures
        found = Chosen(made.report.key_frames or (), clip.frame_time, made.report)
        if sheet is not None:
            draw.sheet(clip, sheet, found.frames)
        if weights is not None:
            _write_weights(clip, found.frames, weights)
    if plot is not None:
        _plot(clip, pins, quality, plot)
    tell(found, json, sheet, plot, weights)


def _write_weights(clip: Clip, frames: tuple[int, ...], path: Path) -> None:
    table = combinations(clip.sample(), np.array(frames, np.int64))
    with replacing(path) as file:
        file.write((",".join(["frame", *map(str, frames)]) + "\n").encode())
        for frame, row in enumerate(table):
            file.write((",".join([str(frame), *(f"{weight:.6g}" for weight in row)]) + "\n").encode())


def _plot(clip: Clip, pins: list[str], quality: str, path: Path) -> None:
    least = int(pinned_frames(pins, clip.sample()).sum())
    first, last = (max(part * clip.frames, least + 1) for part in PLOTTED_PARTS)
    along = sorted({round(keys) for keys in np.geomspace(first, max(last, first + 1), PLOTTED)})
    along = [keys for keys in along if keys < clip.frames]
    if len(along) < 2:
        raise OptionError(f"a clip of {clip.frames} frames has too few numbers of keys for a plot")
    height = rest_height(clip.sample())
    told = by_number(clip, along, pin=pins, quality=quality)
    percent = {name: [100.0 * error / height if height else error for error in row] for name, row in told.items()}
    unit = "% of the rest height" if height else "length units"
    draw.lines(along, percent, path, titles=("whole poses", f"largest error in space, {unit}"))
