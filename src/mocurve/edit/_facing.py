"""Backing up: where a body goes against the way it mostly goes, as it looks itself, it goes back along a path too."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from .. import kinematics
from ..motion import Motion
from ..path import Path
from ..path_length import LengthTable
from ._along import Course
from ._bearing import runs

EDGE = 0.2  # seconds of going before and after a pause that are compared


def progress(
    motion: Motion, course: Course, path: Path, table: LengthTable, least: float
) -> tuple[np.ndarray, np.ndarray]:
    """Distances (F,) along a new path that fall where the body backs up, and whether (F,) they do.

    least: units a second; a slower body goes on as it did. Where the new path turns about in the same place as the
    motion's own, following it is no going back.
    """
    ways = _ways(motion, course, least)
    distance, back = course.distance.copy(), np.zeros(len(ways), bool)
    sign = 1.0
    for frame in (np.flatnonzero(np.diff(ways)) + 1).tolist():
        first, last = _stall(course.distance, frame, least * motion.frame_time)
        around = distance[[first, frame, last]]
        if not _turns_about(path, table, distance[frame] + sign * (around - distance[frame])):
            sign = -sign
            distance[frame:] = distance[frame] + sign * (course.distance[frame:] - course.distance[frame])
            back[frame:] = sign < 0
    return distance, back


# -- in call order ---------------------------------------------------------------------------------


def _ways(motion: Motion, course: Course, least: float) -> np.ndarray:
    """(F,) 1 where the body goes as it mostly does, -1 where it goes the other way, both as it looks itself.

    Only where it slows down can the one change into the other: whoever turns about without, walks a bend.
    """
    root = int(np.argmax(motion.skeleton.parents < 0))
    columns, order = motion.skeleton.eulers[root]
    turn = kinematics.rotation.from_euler(motion.values[:, columns], order)
    looks = 2.0 * np.arctan2(turn[:, 2], turn[:, 0])  # the part of its turning that is about the vertical
    apart = np.exp(1j * (course.path.heading(course.table.parameter(course.distance)) - looks))
    fast = np.gradient(course.distance) > least * motion.frame_time if len(looks) > 1 else np.zeros(1, bool)
    goes = [run for run in runs(fast) if fast[run.start]]
    ways, sign = np.ones(len(looks)), 1.0
    near = max(1, round(EDGE / motion.frame_time))
    for before, after in pairwise(goes):
        leaves, comes = apart[before][-near:].sum(), apart[after][:near].sum()
        if (leaves * np.conj(comes)).real < 0:
            sign = -sign
        ways[(before.stop + after.start) // 2 :] = sign
    mostly = np.sign((ways * np.gradient(course.distance)).sum()) if len(goes) > 1 else 1.0
    return ways * (mostly or 1.0)


def _stall(distance: np.ndarray, frame: int, least: float) -> tuple[int, int]:
    """The frames around one between which the body is slow, and as far again on both sides."""
    slow = np.gradient(distance) <= least
    first, last = frame, frame
    while first > 0 and (slow[first] or first == frame):
        first -= 1
    while last < len(slow) - 1 and (slow[last] or last == frame):
        last += 1
    wide = max(last - first, 4)
    return max(first - wide, 0), min(last + wide, len(slow) - 1)


def _turns_about(path: Path, table: LengthTable, around: np.ndarray) -> bool:
    """Whether a path goes the other way at the last of three distances than at the first."""
    first, last = path.heading(table.parameter(around))[[0, 2]]
    return bool(np.cos(last - first) < 0.0)
