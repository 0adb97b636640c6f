"""One cycle of a motion again and again, until it is as long as a path, and the path that such a motion is on."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .. import bspline, planar
from ..errors import OptionError
from ..kinematics import world
from ..motion import Motion
from ..path import Path
from ..path_fit import gone, moving, roots
from . import _cycles
from ._along import MOST_FRAMES, Course
from .loop import loop

CLOSED = 0.01  # of the body's size: a clip whose ends are no further apart is one cycle
MOVED = 0.01  # of the body's size in a cycle: less is standing
TRIED = 4  # cycles, to see how one goes that others surround
DEGREE = 3


@dataclass(frozen=True, eq=False)
class Cycles:
    """A cycle repeated. motion: all of it; course: its own path, in which every cycle is the one before, carried on;
    start: the frame of the clip where the cycle begins; frames: of a cycle; goes: how far it goes, file units."""

    motion: Motion
    course: Course
    start: int
    frames: int
    goes: float

    @property
    def shown(self) -> np.ndarray:
        """(F,) the frame of the clip that each frame shows."""
        return self.start + np.arange(self.motion.frames) % self.frames


def repeated(motion: Motion, length: float) -> Cycles:
    """The clearest cycle of a motion as often as a path of this length takes."""
    start, end = _whole(motion)
    close = "linear" if end is not None else "crossfade"
    try:
        several = loop(motion, start=start, end=end, cycles=TRIED, close=close)
    except OptionError as error:
        reason = str(error).removesuffix("; say start and end")
        raise OptionError(f"{reason}: make a cycle with loop, and let that follow the path") from error
    assert isinstance(several, Motion)  # of samples
    told = several.history[-1]["measured"]
    frames = int(told["frames"])
    shares, step, points = _cycle(several, frames)
    goes = _path(points, step, TRIED).length / TRIED
    if not goes > MOVED * _size(world(motion)):
        raise OptionError("a cycle of the clip stays where it is: it cannot be repeated to the end of the path")
    needed = length / goes
    if needed * frames > MOST_FRAMES:
        raise OptionError(f"the clip would have to be repeated {needed:.3g} times, over {MOST_FRAMES} frames")
    cycles = int(np.ceil(needed)) + 1
    long = loop(motion, start=told["start"], end=told["end"], cycles=cycles, close=close)
    assert isinstance(long, Motion)
    cycle, within = np.divmod(np.arange(long.frames), frames)
    own = _path(points, step, cycles)
    table = own.table()
    course = Course.of(long, own, table, table.distance((cycle + shares[within]) / cycles))
    return Cycles(long, course, round(told["start"] / motion.frame_time), frames, goes)


# -- in call order ---------------------------------------------------------------------------------


def _whole(motion: Motion) -> tuple[float | None, float | None]:
    """Start and end, seconds, of a clip that is a cycle itself; else None."""
    places = world(motion)
    last = motion.frames - 1
    if last > 1 and _cycles.apart(places, 0, last, motion.frame_time) <= CLOSED * _size(places):
        return 0.0, last * motion.frame_time
    return None, None


def _size(places: np.ndarray) -> float:
    """The deviation of the joints (F, J, 3) from their middle, root mean square."""
    return float(np.sqrt(places.var(axis=1).sum(axis=-1).mean()))


def _cycle(several: Motion, frames: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """How much of a cycle's path is gone at its frames (F,), the planar transform (3,) of a cycle, and the control
    points (K, 2) of its path, of which those of the next cycle are the image.

    About a control point a second, as in any fit, and the same for every cycle: the body's heading along its own path
    comes back with each, and does not drift along another.
    """
    places = world(several)
    step = planar.align(places[frames], places[0])
    inside = gone(several)[frames : 2 * frames + 1]  # the others around it, so that no end shows
    shares = (inside - inside[0]) / (inside[-1] - inside[0])
    spans = min(max(1, round(moving(shares, several.frame_time))), max(frames // 2, 1))
    first, weights = bspline.basis(_knots(spans), DEGREE, shares[:-1])
    index = first[:, None] + np.arange(DEGREE + 1)
    # a planar transform is w -> e^(i angle) w + shift of the complex number w = z + i x
    whole = planar.power(step, index // spans)
    design = np.zeros((frames, spans), complex)
    for column in range(DEGREE + 1):
        design[np.arange(frames), index[:, column] % spans] += weights[:, column] * np.exp(1j * whole[:, column, 0])
    track = roots(several)[:frames]
    known = (weights * (whole[..., 2] + 1j * whole[..., 1])).sum(axis=1)
    found = np.linalg.lstsq(design, track[:, 2] + 1j * track[:, 0] - known, rcond=None)[0]
    return shares[:-1], step, np.stack([found.imag, found.real], axis=1)


def _knots(spans: int) -> np.ndarray:
    """Even ones over a cycle, 0 to 1, and beyond it."""
    return np.arange(-DEGREE, spans + DEGREE + 1) / spans


def _path(points: np.ndarray, step: np.ndarray, cycles: int) -> Path:
    """The path of so many cycles."""
    spans = len(points)
    cycle, within = np.divmod(np.arange(cycles * spans + DEGREE), spans)
    all_points = planar.move(planar.power(step, cycle), np.insert(points, 1, 0.0, axis=1)[within])
    _, clamped = bspline.clamp(_knots(cycles * spans), all_points[:, [0, 2]], DEGREE)
    return Path(clamped, DEGREE)
