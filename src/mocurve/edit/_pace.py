"""Bends taken more slowly: time on a path as people take it.

The speed of a hand or of a walker falls with the cube root of the curvature (the one-third power law: Lacquaniti,
Terzuolo and Viviani 1983; of walking, Vieilledent et al. 2001). What the clip does on its own path counts as it is.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from .. import hermite
from ..errors import OptionError
from ..motion import Motion
from ..path import Path
from ..path_length import LengthTable
from ..whittaker import smoothed
from . import _bearing
from ._along import Course, Way, at_frames
from ._seams import centimetres

WIDE = 250.0  # cm: in bends of a larger radius nobody slows down
NEAR = 25.0  # cm ahead and behind, between which a path's curvature is taken: about a step
WIDTH = 0.25  # seconds over which a body slows down and speeds up again
NONE = 1e-6  # slower by less is as fast


def paced(way: Way, body: Motion, course: Course, path: Path, table: LengthTable) -> Way:
    """The same way with more time in bends that are narrower than those of the clip's own path there."""
    length = centimetres(body)
    if not length:
        raise OptionError("mode paced asks how narrow bends are, and nobody knows how long the clip's unit is: say it")
    near = NEAR / length
    own = np.maximum(_curvature(course.path, course.table, way.own, near), length / WIDE)
    now = np.maximum(_curvature(path, table, way.distance, near), length / WIDE)
    more = np.maximum(np.cbrt(now / own) - 1.0, 0.0)
    runs = [_slowed(more[run], WIDTH / body.frame_time) for run in _bearing.runs(way.cycle)]
    if all(shown is None for shown in runs):
        return way
    parts = []
    for run, shown in zip(_bearing.runs(way.cycle), runs, strict=True):
        at = np.arange(run.stop - run.start, dtype=float) if shown is None else shown
        values = [at_frames(part[run], at) for part in (way.frame, way.own, way.distance)]
        whole = at.astype(np.int64)
        parts.append((*values, way.cycle[run][whole], way.kept[run][whole]))
    frame, gone, distance, cycle, kept = (np.concatenate(part) for part in zip(*parts, strict=True))
    slower = len(frame) / len(way.frame)
    return replace(way, frame=frame, own=gone, distance=distance, cycle=cycle, kept=kept, slower=slower)


# -- in call order ---------------------------------------------------------------------------------


def _curvature(path: Path, table: LengthTable, distance: np.ndarray, near: float) -> np.ndarray:
    """How much (G,) a path turns around distances (G,), radians a unit: a mean, so that corners have one too."""
    ends = np.stack([distance - near, distance + near], axis=1)
    _, heading = path.at(ends.reshape(-1), table)
    apart = np.diff(heading.reshape(-1, 2), axis=1)[:, 0]
    return np.abs(np.angle(np.exp(1j * apart))) / (2.0 * near)


def _slowed(more: np.ndarray, width: float) -> np.ndarray | None:
    """Fractions of frames (G,) that are shown where each of the frames (F,) takes so much more time than one; None
    where none does."""
    if len(more) < 3 or not (more > NONE).any():
        return None
    takes = 1.0 + np.maximum(smoothed(more[:, None], np.ones(len(more)), width)[:, 0], 0.0)
    time = np.concatenate([[0.0], np.cumsum(0.5 * (takes[1:] + takes[:-1]))])
    shown = hermite.evaluate(time, np.arange(len(more), dtype=float), 1.0 / takes, np.arange(int(time[-1]) + 1.0))
    return np.minimum(shown, len(more) - 1.0)
