"""Which moment of a motion is shown where on a path: how distances map, and what happens where the path ends.

Gleicher 2001, section 3: a frame keeps its distance along the path, so that the body keeps its speed.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from .. import hermite
from ..errors import Mismatch, OptionError
from ..motion import Motion
from ..path import Path
from ..path_fit import roots
from ..path_length import LengthTable

SETTLE = 0.5  # seconds in which a motion comes to rest
STRIDES = (0.6, 1.15)  # times the source's: beyond, more of a span's new length goes into time
MOST_FRAMES = 200_000  # of a result, where more are made than the clip has
SAME = 1e-9  # of a length: control points as near have not been moved, and ends as near are reached


@dataclass(frozen=True, eq=False)
class Course:
    """A path, where along it the frames of a motion are: distances (F,), which do not fall; the places
    (F, 2 or 3) and headings (F,) there; and how far the root is from them, root mean square."""

    path: Path
    table: LengthTable
    distance: np.ndarray
    place: np.ndarray
    heading: np.ndarray
    residual: float

    @classmethod
    def of(cls, body: Motion, path: Path, table: LengthTable, distance: np.ndarray) -> Course:
        """The course of a body along its path."""
        place, heading = path.at(distance, table)
        away = roots(body)[:, [0, 2]] - place[:, [0, -1]]
        return cls(path, table, distance, place, heading, float(np.sqrt(np.mean((away**2).sum(axis=1)))))

    def at(self, frames: np.ndarray, distance: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Places (G, 2 or 3) and headings (G,) at distances (G,) of frames (G,), which may be between two."""
        whole = frames.astype(np.int64)
        if np.array_equal(self.distance[whole], distance):
            return self.place[whole], self.heading[whole]
        return self.path.at(distance, self.table)


@dataclass(frozen=True, eq=False)
class Way:
    """What every frame (G,) of the result shows, and where.

    frame:    of the motion; a fraction where time is stretched.
    cycle:    how often the motion has begun again before.
    own:      distance along the motion's own path.
    distance: along the new path.
    kept:     whether the frame stays as it is.
    stride:   times the source's, where a path is filled or only a span is edited. slower: times as long it takes.
    """

    frame: np.ndarray
    cycle: np.ndarray
    own: np.ndarray
    distance: np.ndarray
    kept: np.ndarray
    stride: float = 1.0
    slower: float = 1.0


def way(course: Course, path: Path, table: LengthTable, mode: str, at_end: str, frame_time: float) -> Way:
    """The way of a motion along a new path."""
    count = len(course.distance)
    if mode == "span":
        return _span(course, path, table)
    own, nothing = course.distance, np.zeros(count, bool)
    plain = Way(np.arange(count, dtype=float), np.zeros(count, np.int64), own, own, nothing)
    if mode == "time":
        return replace(plain, distance=table.distance(course.table.parameter(course.distance)))
    if mode == "scaled":
        return _scaled(course, plain, table.length)
    return ENDS[at_end](course, plain, table.length, frame_time)


# -- in call order ---------------------------------------------------------------------------------


def _span(course: Course, path: Path, table: LengthTable) -> Way:
    """Only where control points were moved is anything done; distances within grow evenly from one end to the other."""
    own, distance = course.path, course.distance
    if not (own.kind == path.kind == "spline" and own.points.shape == path.points.shape and own.degree == path.degree):
        raise Mismatch(
            f"mode span takes a path that is an edit of the clip's own, {own!r}, with points moved; this is {path!r}"
        )
    if not np.array_equal(own.knots, path.knots):
        raise Mismatch("mode span takes a path that is an edit of the clip's own: its knots are others")
    off = np.abs(own.points - path.points).max(axis=1)
    moved = np.flatnonzero(off > SAME * (1.0 + np.ptp(own.points, axis=0).max()))
    frames = np.arange(len(distance))
    if not len(moved):
        whole = np.ones(len(frames), bool)
        return Way(frames.astype(float), np.zeros(len(frames), np.int64), distance, distance, whole)
    low, high = own.knots[moved[0]], own.knots[moved[-1] + own.degree + 1]
    (start, end), (new_start, new_end) = (t.distance(np.array([low, high])).tolist() for t in (course.table, table))
    if not end - start > SAME * course.table.length:
        raise OptionError("the clip stands still where the path was edited: take another mode")
    before = distance <= start if moved[0] > 0 else np.zeros(len(frames), bool)
    after = distance >= end if moved[-1] < len(own.points) - 1 else np.zeros(len(frames), bool)
    stride = (new_end - new_start) / (end - start)
    slower = stride / float(np.clip(stride, *STRIDES))
    first, last = max(int(before.sum()) - 1, 0), min(len(frames) - int(after.sum()), len(frames) - 1)
    shown = _stretched(frames, first, last, slower)
    gone = at_frames(distance, shown)
    kept = (shown <= first if before.any() else shown < 0) | (shown >= last if after.any() else shown < 0)
    inside = new_start + (gone - start) * stride
    there = np.where(gone <= start, gone, np.where(gone >= end, gone - end + new_end, inside))
    return Way(shown, np.zeros(len(shown), np.int64), gone, there, kept, stride, slower)


def _stretched(frames: np.ndarray, first: int, last: int, slower: float) -> np.ndarray:
    """Frames (G,), those between two of them taken so many times as slowly."""
    if slower == 1.0 or last <= first:
        return frames.astype(float)
    most = max(MOST_FRAMES, 2 * len(frames))
    if not (last - first) * slower <= most:
        raise OptionError(f"the path is so long that the clip takes {slower:.3g} times its time, over {most} frames")
    count = max(round((last - first) * slower), 1)
    between = first + (last - first) * np.arange(count) / count
    return np.concatenate([frames[:first], between, frames[last:]])


def at_frames(values: np.ndarray, frames: np.ndarray) -> np.ndarray:
    """Values (F,) of frames at fractions of frames (G,), smooth in between; those at frames are exact."""
    whole = frames.astype(np.int64)
    if (frames == whole).all() or len(values) < 2:
        return values[whole]
    between = hermite.evaluate(np.arange(len(values), dtype=float), values, np.gradient(values), frames)
    return np.where(frames == whole, values[whole], between)


def _scaled(course: Course, way: Way, length: float) -> Way:
    """The path filled: by longer or shorter strides within STRIDES, and the rest by more or less time."""
    own = course.table.length
    if not (own > 0 and length > 0):
        return replace(way, distance=0.0 * course.distance)
    stride = length / own
    slower = stride / float(np.clip(stride, *STRIDES))
    shown = _stretched(np.arange(len(course.distance)), 0, len(course.distance) - 1, slower)
    gone = at_frames(course.distance, shown)
    count = len(shown)
    nothing = np.zeros(count, np.int64), np.zeros(count, bool)
    return Way(shown, nothing[0], gone, gone * stride, nothing[1], stride, slower)


def _beyond(way: Way, length: float) -> int:
    """The first frame that has not room on the path; as many as there are where all have."""
    over = way.distance > length * (1.0 + SAME)
    return int(np.argmax(over)) if over.any() else len(over)


def _extend(course: Course, way: Way, length: float, frame_time: float) -> Way:
    return way


def _truncate(course: Course, way: Way, length: float, frame_time: float) -> Way:
    end = max(_beyond(way, length), 1)
    return replace(
        way, frame=way.frame[:end], cycle=way.cycle[:end], own=way.own[:end], distance=way.distance[:end],
        kept=way.kept[:end],
    )  # fmt: skip


def _reset(course: Course, way: Way, length: float, frame_time: float) -> Way:
    """From the first frame and the beginning of the path again, as often as it takes."""
    room = max(_beyond(way, length), 1)
    cycle, frame = np.divmod(np.arange(len(way.frame)), room)
    return replace(way, frame=way.frame[frame], cycle=cycle, own=way.own[frame], distance=way.distance[frame])


def _scale(course: Course, way: Way, length: float, frame_time: float) -> Way:
    return way if course.table.length <= length else _scaled(course, way, length)


def _stop(course: Course, way: Way, length: float, frame_time: float) -> Way:
    """Time runs slower and slower over half a second, and stands when the end is reached."""
    reached = _beyond(way, length)
    if reached == len(way.frame):
        return way
    behind, ahead = way.distance[reached - 1] if reached else 0.0, way.distance[reached]
    end = reached - 1 + (length - behind) / (ahead - behind) if reached else 0.0
    settling = min(SETTLE / frame_time, 2.0 * end)  # frames; half as many of the motion are shown in them
    start = end - 0.5 * settling
    x = np.clip((np.arange(len(way.frame)) - start) / max(settling, 1e-12), 0.0, 1.0)
    slowed = start + settling * (x - x**3 + 0.5 * x**4)  # its speed is 1 - (3 x^2 - 2 x^3)
    frame = np.where(way.frame <= start, way.frame, np.minimum(slowed, end))
    gone = np.minimum(at_frames(course.distance, frame), length)
    return replace(way, frame=frame, own=gone, distance=gone)


ENDS: dict[str, Callable[[Course, Way, float, float], Way]] = {
    "extend": _extend,
    "truncate": _truncate,
    "stop": _stop,
    "reset": _reset,
    "scale": _scale,
    "cycle": _truncate,  # of a motion that has been repeated
}
