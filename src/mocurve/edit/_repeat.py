"""One cycle of a motion again and again, until it is as long as a path."""

from __future__ import annotations

import numpy as np

from ..errors import OptionError
from ..kinematics import world
from ..motion import Motion
from ..path import Fit
from ..path_fit import fitted
from . import _cycles
from .loop import loop

CLOSED = 0.01  # of the body's size: a clip whose ends are no further apart is one cycle
MOVED = 0.01  # of the body's size in a cycle: less is standing
MOST_FRAMES = 1_000_000
TRIED = 4  # cycles, to see how far one goes


def repeated(motion: Motion, length: float) -> tuple[Motion, int, int]:
    """The motion as often as a path of this length takes, the frame where its cycle begins, and the cycle's frames."""
    start, end = _whole(motion)
    close = "linear" if end is not None else "crossfade"
    try:
        several = loop(motion, start=start, end=end, cycles=TRIED, close=close)
    except OptionError as error:
        reason = str(error).removesuffix("; say start and end")
        raise OptionError(f"{reason}: make a cycle with loop, and let that follow the path") from error
    told = several.history[-1]["measured"]
    goes = fitted(several, Fit()).length / TRIED
    if not goes > MOVED * _size(world(motion)):
        raise OptionError("a cycle of the clip stays where it is: it cannot be repeated to the end of the path")
    cycles = int(np.ceil(1.02 * length / goes)) + 1
    if cycles * told["frames"] > MOST_FRAMES:
        raise OptionError(f"the clip would have to be repeated {cycles} times, over {MOST_FRAMES} frames")
    long = loop(motion, start=told["start"], end=told["end"], cycles=cycles, close=close)
    assert isinstance(long, Motion)  # of samples
    return long, round(told["start"] / motion.frame_time), told["frames"]


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
