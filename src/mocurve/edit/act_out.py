"""The verb `act_out`: a clip gets the timing with which somebody performs it.

Sources: Terra and Metoyer 2004, Performance timing for keyframe animation (and 2007, Graphical Models 69): features of
the performance are those of the motion, in order; Önder 2007, section 2.2.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from ..errors import OptionError, UnknownName
from ..info import first_frame_is_t_pose
from ..keyed import KeyedMotion
from ..kinematics import world
from ..motion import Clip, Motion, complete, unroll
from ..spline import SplineMotion
from . import _features
from ._features import Features
from ._pair import check_mode, recorded
from .retime import retime, time_map

KINDS = {"turns": (1, -1), "highs": (1,), "lows": (-1,)}
MEASURES = ("height", "speed")
MOST, LONGEST = 100_000, 100_000.0  # rows and seconds of a performance

Performance = Clip | np.ndarray | Sequence[float] | Sequence[Sequence[float]]


@dataclass(frozen=True)
class ActedOut:
    """Which moments of a clip were found in a performance, and what that did to its time.

    matched:          {"old", "new", "kind"} of each pair, seconds in the clip and in the result; kind: start, high,
                      low, tap or end.
    skipped:          seconds in the clip of what the performance does not have.
    extra:            seconds in the performance of what the clip does not have.
    slowest, fastest: new seconds per old one, at most and at least.
    """

    matched: list[dict[str, Any]]
    skipped: list[float]
    extra: list[float]
    slowest: float
    fastest: float

    def __str__(self) -> str:
        left = [f"{len(times)} {whose}" for times, whose in ((self.skipped, "of the clip"), (self.extra, "performed"))]
        rows = "\n".join(f"{row['old']:8.3f} s -> {row['new']:8.3f} s  {row['kind']}" for row in self.matched)
        return (
            f"{rows}\nleft out: {' and '.join(left)}; up to {self.slowest:.3g} times slower and "
            f"{1.0 / self.fastest:.3g} times faster"
        )

    def to_json(self) -> dict[str, Any]:
        """The same as plain numbers, texts and lists."""
        return asdict(self)


def act_out(
    clip: Clip,
    performance: Performance,
    *,
    channel: str | None = None,
    joint: str | None = None,
    of: str = "height",
    features: str = "turns",
    ends: bool = True,
) -> Clip:
    """The clip with the timing of a performance: what turns in both does so at the performed time.

    Parameters
    ----------
    channel
        Channel of the clip that is performed, as LeftArm.Zrotation.
    joint
        Or joint, as LeftHand.
    of
        What of the joint: height, or speed (the performance is then a way, in any number of dimensions, and its speed
        is taken).
    features
        turns (highs and lows), highs or lows: the moments that are matched. Movement by less than a tenth of the range
        does not count.
    ends
        The performance begins and ends with the clip. Else only the moments that it has are matched, and what comes
        before the first keeps its speed.

    performance: rows (N, 2) of seconds and a value, as a hand moved a mouse; or seconds (N,) of taps; or a clip that
    does the same with the same channel or joint. Its size and where its zero lies do not matter. The clip is changed as
    by `retime`: keys move with their slopes and stay keys. The last step of its `history` has the numbers of `ActedOut`
    under "measured". Errors: UnknownName for a channel or joint, OptionError where there is nothing to match.

    >>> wave = mc.act_out(wave, [(0, 0), (0.4, 1), (0.7, 0), (1.6, 1), (2, 0)], joint="LeftHand")
    """
    if (channel is None) == (joint is None):
        raise OptionError("say what is performed: either a channel or a joint of the clip")
    check_mode(of, MEASURES)
    of = of if joint else "height"  # of a channel, its value
    if features not in KINDS:
        raise UnknownName("kind of features", features, KINDS)
    rows, own_rows = _rows(performance, channel, joint, of), _of_clip(clip, channel, joint, of)
    taps = rows.shape[1] == 1
    own, performed = _turning(own_rows, rows, of, features)
    for found, whose in ((own, channel or f"the {of} of {joint}"), (performed, "the performance")):
        if not len(found):
            wanted = "highs or lows" if features == "turns" else features
            raise OptionError(f"{whose} has no {wanted} that could be matched: it moves one way or not at all")
    pairs, told = _matched(clip, own, performed, ends and not taps, (own_rows, rows))
    made = retime(clip, pairs)
    step = {"verb": "act_out", "performance": (rows[:, 0] if taps else rows).tolist(), "channel": channel}
    step |= {"joint": joint, "of": of, "features": features, "ends": ends, "measured": told.to_json()}
    return recorded(made, (*clip.history, step))


# -- in call order ---------------------------------------------------------------------------------


def _rows(performance: Performance, channel: str | None, joint: str | None, of: str) -> np.ndarray:
    """(N, 1 + C) seconds from 0 on, rising, and values; (N, 1) of taps."""
    if isinstance(performance, Motion | KeyedMotion | SplineMotion):
        return _of_clip(performance, channel, joint, of)
    try:
        rows = np.asarray(performance, np.float64)
    except (TypeError, ValueError):
        raise OptionError("a performance is rows of seconds and values, all equally long, or seconds of taps") from None
    taps = rows.ndim == 1
    rows = rows[:, None] if taps else rows
    if rows.ndim != 2 or not rows.shape[1]:
        raise OptionError(f"a performance is rows of seconds and values, or seconds of taps, not shape {rows.shape}")
    if not 2 <= len(rows) <= MOST:
        raise OptionError(f"a performance has 2 to {MOST} rows, not {len(rows)}")
    if not np.isfinite(rows).all():
        row = int(np.argmax(~np.isfinite(rows).all(axis=1)))
        raise OptionError(f"row {row + 1} of the performance is not all numbers")
    fallen = np.flatnonzero(np.diff(rows[:, 0]) < 0)
    if len(fallen):
        row = int(fallen[0])
        raise OptionError(
            f"the times of a performance rise; row {row + 2} is at {rows[row + 1, 0]:g} s, after {rows[row, 0]:g} s"
        )
    if rows[-1, 0] > LONGEST + rows[0, 0]:
        raise OptionError(f"a performance lasts {LONGEST:g} s at most, not {rows[-1, 0] - rows[0, 0]:g}")
    rows = rows[np.append(np.diff(rows[:, 0]) > 0, True)]  # of rows at one time the last counts
    if len(rows) < 2:
        raise OptionError("all rows of the performance are at one time")
    if not taps and rows.shape[1] > 2 and of != "speed":
        raise OptionError(f"the performance has {rows.shape[1] - 1} values a row: take one of them, or match speeds")
    return rows - np.eye(rows.shape[1])[0] * rows[0, 0] if not taps else rows


def _of_clip(clip: Clip, channel: str | None, joint: str | None, of: str) -> np.ndarray:
    """The same of a clip: of a channel, a joint's height or its places."""
    motion = complete(clip.sample())
    if motion.frames < 2:
        raise OptionError("a clip of one frame has no time to change")
    times = np.arange(motion.frames) * motion.frame_time
    if channel is not None:
        values = unroll(motion).values[:, [motion.skeleton.channel(channel)]]
    else:
        places = world(motion)[:, motion.skeleton.joint(joint or "")]
        values = np.array(places if of == "speed" else places[:, 1:2])
    if first_frame_is_t_pose(motion):
        values = np.vstack([values[1:2], values[1:]])
    return np.column_stack([times, values])


def _turning(own: np.ndarray, rows: np.ndarray, of: str, features: str) -> list[Features]:
    """Where the clip (N, 1 + C) turns, and the performance; both are looked at alike."""
    taps = rows.shape[1] == 1
    signals = [_signal(part, of) for part in ([own] if taps else [own, rows])]
    flat = _features.JITTERED if of == "speed" else max(_features.flat(values) for _, values in signals)
    found = [_features.turns(times, values, flat).only(KINDS[features]) for times, values in signals]
    return [found[0], _features.taps(rows[:, 0])] if taps else found


def _signal(rows: np.ndarray, of: str) -> tuple[np.ndarray, np.ndarray]:
    """Times (N,) and values (N,): the one value there is, or the speed along a way; 1 is the largest value."""
    rows = rows / np.append(1.0, np.full(rows.shape[1] - 1, np.abs(rows[:, 1:]).max() or 1.0))
    if of == "height":
        return rows[:, 0], rows[:, 1]
    times, places = _features.smoothed(rows[:, 0], rows[:, 1:])
    return times, np.linalg.norm(np.gradient(places, times, axis=0), axis=1)


def _matched(
    clip: Clip, own: Features, performed: Features, ends: bool, rows: tuple[np.ndarray, np.ndarray]
) -> tuple[list[tuple[float, float]], ActedOut]:
    """Old and new seconds, and what is told of them."""
    lasts = (float(rows[0][-1, 0]), float(rows[1][-1, 0]))
    own, performed, pairs = _features.matched(own, performed, lasts if ends else None)
    least = 3 if ends else 2
    if len(pairs) < least:
        raise OptionError(
            f"the performance turns {_count(performed)}, the clip {_count(own)}, and too few of these can be the same"
        )
    old, new = own.times[pairs[:, 0]], performed.times[pairs[:, 1]]
    later = 0.0 if ends else float(old[0] - new[0])
    names = {1: "high", -1: "low", 0: "tap", 2: "start", 3: "end"}
    kinds = performed.kinds[pairs[:, 1]]
    given = [(float(before), float(after)) for before, after in zip(old, new + later, strict=True)]
    bent = time_map(clip, given)
    rates = bent.speeds(np.linspace(bent.old[0], bent.old[-1], 1000))
    found = ActedOut(
        matched=[{"old": a, "new": b, "kind": names[int(kind)]} for (a, b), kind in zip(given, kinds, strict=True)],
        skipped=np.delete(own.times, pairs[:, 0]).tolist(),
        extra=np.delete(performed.times, pairs[:, 1]).tolist(),
        slowest=float(rates.max()),
        fastest=float(rates.min()),
    )
    return given, found


def _count(features: Features) -> str:
    count = int((features.kinds < 2).sum())
    return "once" if count == 1 else f"{count} times"
