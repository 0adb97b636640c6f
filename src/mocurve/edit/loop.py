"""The verb `loop`: one cycle of a motion, repeated without a seam.

Source: Sudarsky and House 1998, Motion capture data manipulation and reuse via B-splines (cyclification); the travel
of a cycle is a planar rigid motion, so that a walk in a curve goes on along its circle.
"""

from __future__ import annotations

import warnings
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from .. import planar
from ..errors import OptionError, UnknownName
from ..feet.planted import planted
from ..info import first_frame_is_t_pose
from ..kinematics import world
from ..motion import Clip, Motion, complete
from ..spline import SplineMotion
from . import _cycles, _periodic
from ._closings import CLOSINGS, FADE, beside
from ._pair import recorded, tell_sampled
from ._poses import Poses, motion_of, moved, poses_of
from ._seams import bends, centimetres

WAYS = (*CLOSINGS, "spline")
MOST, NUMBERS = 10_000, 50_000_000  # cycles; frames times channels
ROUGH = 1.1  # times the largest acceleration of the clip: a seam beyond shows
FINER = 4  # samples a frame, of a spline that becomes a periodic one
SAME_TIME = 1e-6  # seconds: times are given in decimal digits


@dataclass(frozen=True)
class Loop:
    """The cycle that was taken, and how well its end meets its beginning.

    start, end:   seconds in the clip; the pose at the end is the one at the start again.
    frames:       of one cycle.
    unit:         of the lengths that follow: "cm", or "units" of the file where nobody knows how long these are.
    travel, turn: how far the body goes in a cycle, and how many degrees it turns.
    distance:     between the poses around start and end in the clip, root mean square over joints, after alignment.
    jump:         how far, where the cycles meet, some joint is from where it was going.
    acceleration: the same as a part of the clip's: of what 95 % of its frames stay below.
    off:          by way of a spline, how far at most a joint is from the frames that the spline was fitted to.
    """

    start: float
    end: float
    frames: int
    unit: str
    travel: float
    turn: float
    distance: float
    jump: float
    acceleration: float
    off: float = 0.0

    def __str__(self) -> str:
        off = f"\nthe spline is within {self.off:.2g} {self.unit} of the closed frames" if self.off else ""
        return (
            f"cycle: {self.start:.3f} to {self.end:.3f} s, {self.frames} frames\n"
            f"it travels {self.travel:.4g} {self.unit} and turns {self.turn:.3g} degrees\n"
            f"its ends in the clip are {self.distance:.3g} {self.unit} apart\n"
            f"seam: {self.jump:.3g} {self.unit} beyond where it was going, {self.acceleration:.2f} of the clip's "
            f"largest accelerations{off}"
        )

    def to_json(self) -> dict[str, Any]:
        """The same as plain numbers and texts."""
        return asdict(self)


def loop(
    clip: Clip,
    *,
    start: float | None = None,
    end: float | None = None,
    cycles: int = 1,
    close: str = "crossfade",
) -> Clip:
    """One cycle of a motion, closed and repeated.

    Parameters
    ----------
    start
        Second at which the cycle begins; by default the clearest cycle is found.
    end
        Second at which the pose of the start has come back; by default found.
    cycles
        How many; each goes on from where the one before has arrived, also in a curve.
    close
        What is done about the difference between the two ends: crossfade (what surrounds one fades into what
        surrounds the other), cubic (it is spread over the cycle, so that places and speeds meet), linear (so that
        places meet), spline (periodic splines are fitted to a crossfade or, where nothing surrounds the cycle, to the
        cubic: curves on few knots that close with their derivatives; a spline stays one).

    The result has cycles x frames of a cycle + 1 frames: the last pose is the first one, carried on. The last step of
    its `history` has the numbers of `Loop` under "measured". Errors: OptionError where no cycle is found or the times
    do not lie in the clip, Mismatch where samples are missing or the root has no channels to travel or turn by.
    A warning where the seam shows.

    >>> walk = mc.loop(mc.read("walk.bvh"), cycles=4)
    """
    _check(start, end, cycles, close)
    motion = complete(clip.sample())
    if not (close == "spline" and isinstance(clip, SplineMotion)):
        tell_sampled([clip], "a loop is made of frames (of a spline, close spline makes a spline)")
    dropped = int(first_frame_is_t_pose(motion))
    motion = motion[dropped:]
    places = world(motion)
    bend = bends(places)
    first, last = _ends(motion, places, *(_frame(time, motion, dropped) for time in (start, end)))
    frames = cycles * (last - first) + 1
    if frames * motion.values.shape[1] > NUMBERS:
        raise OptionError(f"{cycles} cycles are {frames} frames: too many to hold, ask for fewer")
    step = _cycles.step(places, first, last, motion.frame_time)
    if close == "spline":
        made, twice, off = _of_splines(clip, motion, (first, last, dropped), step, cycles)
    else:
        closed = _closed(motion, first, last, step, close)
        made, off = _repeated(closed, motion, first, step, cycles), 0.0
        twice = _repeated(closed, motion, first, step, 2)
    found = _measured(motion, places, bend, (first, last, dropped), step, world(twice), off)
    _tell_seam(found, bend)
    told = {"verb": "loop", "start": start, "end": end, "cycles": cycles, "close": close, "measured": found.to_json()}
    return recorded(made, (*clip.history, told))


# -- in call order ---------------------------------------------------------------------------------


def _check(start: float | None, end: float | None, cycles: int, close: str) -> None:
    if close not in WAYS:
        raise UnknownName("way to close a loop", close, WAYS)
    if not (isinstance(cycles, int) and 1 <= cycles <= MOST):
        raise OptionError(f"cycles is a whole number from 1 to {MOST}, not {cycles!r}")
    if start is None and end is not None:
        raise OptionError("end is given without start: say start too, or neither")
    if start is not None and end is not None and not end > start:
        raise OptionError(f"the cycle ends at {end:g} s, not after its start at {start:g} s")


def _frame(time: float | None, motion: Motion, dropped: int) -> int | None:
    """The frame at a second of the clip as it was given, with a T-pose in front."""
    if time is None:
        return None
    last = (motion.frames - 1 + dropped) * motion.frame_time
    if not dropped * motion.frame_time - SAME_TIME <= time <= last + SAME_TIME:
        lead = ", and its first frame is a T-pose" if dropped else ""
        raise OptionError(f"{time:g} s is not in the clip: it ends at {last:g} s{lead}")
    return round(time / motion.frame_time) - dropped


def _ends(motion: Motion, places: np.ndarray, start: int | None, end: int | None) -> tuple[int, int]:
    """First and last frame of the cycle, looked for as far as they are not given."""
    if start is not None and end is not None:
        if end - start < 2:
            raise OptionError("a cycle has at least two frames")
        return start, end
    room = min(round(0.5 * FADE / motion.frame_time), motion.frames // 8)
    resting = planted(motion)
    return _cycles.find(places, motion.frame_time, room, resting[resting.any(axis=1)].T, start)


def _closed(motion: Motion, first: int, last: int, step: np.ndarray, close: str) -> Poses:
    """The poses of the cycle's frames, looking no further than the closing does."""
    start = max(first - round(FADE / motion.frame_time), 0)
    near = motion[start : last + round(FADE / motion.frame_time)]
    return CLOSINGS[close](poses_of(near), near, first - start, last - start, step)


def _of_splines(
    clip: Clip, motion: Motion, cut: tuple[int, int, int], step: np.ndarray, cycles: int
) -> tuple[Clip, Motion, float]:
    """The cycles, two of them as samples, and how far the splines are from the closed frames."""
    first, last, dropped = cut
    count = last - first
    if not isinstance(clip, SplineMotion):
        closed = _closed(motion, first, last, step, _way(motion, first, last))
        frames, off = _periodic.as_frames(closed, motion[first:last], step)
        return _repeated(frames, motion, first, step, cycles), _repeated(frames, motion, first, step, 2), off
    fine = clip.sample(clip.frame_time / FINER)[dropped * FINER :]
    start = (first + dropped) * clip.frame_time
    own = clip.knots[(clip.knots > start) & (clip.knots < start + count * clip.frame_time)] - start
    breaks = np.concatenate([[0.0], np.unique(own), [count * clip.frame_time]])
    first, last = FINER * first, FINER * last
    closed = _closed(fine, first, last, step, _way(fine, first, last))
    spline, off = _periodic.as_spline(closed, fine[first:last], step, breaks, clip.degree)
    made, twice = (spline(n, clip.frame_time, n * count + 1) for n in (cycles, 2))
    return made, twice.sample(), off


def _way(motion: Motion, first: int, last: int) -> str:
    """A crossfade where the clip goes on on both sides of the cycle, else the cubic."""
    return "crossfade" if beside(first, last, motion.frames, motion.frame_time) >= 2 else "cubic"


def _repeated(closed: Poses, motion: Motion, first: int, step: np.ndarray, cycles: int) -> Motion:
    """The cycles one after the other, each carried on by the planar motion of one, and the first pose once more."""
    frames = np.arange(cycles * len(closed) + 1)
    cycle, within = np.divmod(frames, len(closed))
    base = replace(motion, values=motion.values[first + within], report=None)
    return motion_of(moved(closed[within], motion.skeleton, planar.power(step, cycle)), base)


def _measured(
    motion: Motion,
    places: np.ndarray,
    bend: np.ndarray,
    cut: tuple[int, int, int],
    step: np.ndarray,
    made: np.ndarray,
    off: float,
) -> Loop:
    """The numbers of a cut (first, last, frames dropped before) and of the places of at least two cycles made of it."""
    first, last, dropped = cut
    jump = float(bends(made)[last - first - 1 : last - first + 1].max())
    usual = float(np.percentile(bend, 95))
    length = centimetres(motion)
    scale = length or 1.0
    return Loop(
        start=(first + dropped) * motion.frame_time,
        end=(last + dropped) * motion.frame_time,
        frames=last - first,
        unit="cm" if length else "units",
        travel=scale * float(np.linalg.norm((places[last] - places[first]).mean(axis=0)[[0, 2]])),
        turn=float(np.degrees(step[0])),
        distance=scale * _cycles.apart(places, first, last, motion.frame_time),
        jump=scale * jump,
        acceleration=jump / usual if usual > 0 else 0.0,
        off=scale * off,
    )


def _tell_seam(found: Loop, bend: np.ndarray) -> None:
    """A warning where the seam is rougher than anything in the clip."""
    usual = float(np.percentile(bend, 95))
    if found.acceleration * usual > ROUGH * bend.max():
        warnings.warn(
            f"the seam shows, its acceleration is {found.acceleration:.2g} times the usual largest: the ends of the "
            f"cycle are {found.distance:.3g} {found.unit} apart",
            stacklevel=3,
        )
