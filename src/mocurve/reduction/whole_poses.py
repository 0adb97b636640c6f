"""The method *optimal* for whole poses: key frames that all channels share, chosen for what they leave in space.

For a number of keys, the least largest error: `spread` moves all keys at once until each segment has its share of the
error (as de Boor chooses knots), from several starts; `moved` then goes where the error is largest, shifts keys there,
or brings one from where it is missed least. For a tolerance, the fewest keys: `fewest` looks for the number.

Own method; equal shares of a power of the error after de Boor 1973, Good approximation by splines with variable knots.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np

from .. import progress
from ._whole import Stage
from .inbetweens import REACH, Change, Inbetweens, centred, changed, fitted, settled, take

POWERS = (0.15, 0.25, 0.5)  # of a segment's error: what is shared out evenly; a cubic's error goes with the length to 4
LEAST_SHARE = 0.02  # of the largest error: a segment with less counts as if it had so much
ROUNDS = 12  # of sharing out
SPREAD_SWEEPS = 4  # of Lawson's weights, while keys are shared out
SHIFTS = (-1, 1, -2, 2, -4, 4)  # frames
ENOUGH = 0.995  # of the largest error: a move that leaves more is none
WITHIN_REACH = 2.0  # of the limit: from so far `centred` may still bring the error to it
TRIALS = 60  # fits of windows a key, at most


class Effort(NamedTuple):
    """What a quality spends."""

    powers: tuple[float, ...]  # that every start is spread with
    moved: int  # of the spread ones, how many are moved on
    again: int  # times the best is spread and moved once more
    shared: int  # times the error that is left at the end is shared out once more


EFFORTS = {
    "fast": Effort(POWERS[1:], 0, 0, 0),
    "default": Effort(POWERS, 2, 0, 2),
    "good": Effort(POWERS, 4, 1, 4),
    "best": Effort((0.1, *POWERS, 0.75), 10, 3, 8),
}


def best_poses(
    stage: Stage, pinned: np.ndarray, starts: list[np.ndarray], others: list[np.ndarray], quality: str
) -> Inbetweens:
    """The keys with the least largest error that the effort finds, from starts with equally many keys (K,) each; never
    more than starts and others leave as they are."""
    effort = EFFORTS[quality]
    found = [spread(stage, pinned, start, power) for start in starts for power in effort.powers]
    found.sort(key=_worst)
    steps = effort.moved + 1
    for number, one in enumerate(found[: effort.moved]):
        progress.advance("moving poses", number, steps)
        moved(one)
    for _ in range(effort.again):
        found.sort(key=_worst)
        again = [spread(stage, pinned, found[0].frames, power) for power in effort.powers]
        for one in (*again, fitted(stage, pinned, found[0].frames)):
            moved(one)
            found.append(one)
    progress.advance("moving poses", steps, steps)
    found.sort(key=_worst)
    last = [*found[: max(1, effort.moved)], *(fitted(stage, pinned, one) for one in (*starts, *others))]
    best = min([centred(one) for one in last], key=_worst)
    for power in effort.powers:
        now = best
        for _ in range(effort.shared):
            now = centred(fitted(stage, pinned, _shared_out(now, power)))
            best = min(best, now, key=_worst)
    for _ in range(effort.shared):
        before = best.worst
        moved(best)
        best = centred(best)
        if best.worst > ENOUGH * before:
            break
    return best


def fewer(best: Inbetweens, quality: str) -> Inbetweens:
    """Fewer keys whose largest error is at most 1, as far as the effort finds them; `best` is such already, or else as
    good as is known."""
    stage, pinned, effort = best.stage, best.pinned, EFFORTS[quality]

    def tried(keys: int, *further: np.ndarray) -> Inbetweens:
        starts = (evenly(len(pinned), keys, pinned), *further)
        return min((spread(stage, pinned, s, p, 1.0) for s in starts for p in effort.powers[-2:]), key=_worst)

    least, most = int(pinned.sum()), len(best.frames)
    while least < most:
        now = tried((least + most) // 2)
        if now.worst <= 1.0:
            most, best = len(now.frames), now
        else:
            least = len(now.frames) + 1
        progress.advance("looking for the number of poses", len(pinned) - (most - least), len(pinned))
    return best if effort.moved == 0 else _taken_away(best, tried)


def spread(stage: Stage, pinned: np.ndarray, start: np.ndarray, power: float, good: float = 0.0) -> Inbetweens:
    """The keys moved, all at once, until every segment has an equal share of the error to a power, pins kept; ends
    where the largest error is at most `good`."""
    best = now = fitted(stage, pinned, start, SPREAD_SWEEPS)
    for _ in range(ROUNDS):
        if best.worst <= good:
            break
        frames = _shared_out(now, power)
        if np.array_equal(frames, now.frames):
            break
        now = fitted(stage, pinned, frames, SPREAD_SWEEPS)
        best = min(best, now, key=_worst)
    return best


def moved(now: Inbetweens, good: float = 0.0) -> None:
    """Keys shifted or brought to where the error is largest, while that helps; ends where the error is at most
    `good`."""
    settled(now)
    trials = TRIALS * len(now.frames)
    while trials > 0 and now.worst > good:
        step = _Step(now)
        change, moving = step.best()
        trials -= 1 + step.trials
        if change is None:
            before = now.worst
            if not settled(now) or now.worst > ENOUGH * before:
                return
            continue
        take(now, change)
        if moving is not None:
            take(now, _without(now, moving))


def evenly(frames: int, keys: int, pinned: np.ndarray) -> np.ndarray:
    """Keys (K,) spread evenly over the frames, the pins among them."""
    return _with_pins(np.linspace(0, frames - 1, keys), np.flatnonzero(pinned))


# -- in call order ---------------------------------------------------------------------------------


def _taken_away(best: Inbetweens, tried: Callable[..., Inbetweens]) -> Inbetweens:
    """Keys taken away, more at a time as long as that works, and the rest moved until the error is at most 1 again."""
    step = max(1, len(best.frames) // 16)
    while step > 0 and len(best.frames) > best.pinned.sum():
        keys = max(len(best.frames) - step, int(best.pinned.sum()))
        at = np.interp(np.linspace(0, len(best.frames) - 1, keys), np.arange(len(best.frames)), best.frames)
        now = tried(keys, _with_pins(at, np.flatnonzero(best.pinned)))
        moved(now, 1.0)
        if 1.0 < now.worst < WITHIN_REACH:
            now = centred(now, 1.0)
        if now.worst <= 1.0:
            best = now
        else:
            step //= 2
    return best


def _worst(one: Inbetweens) -> float:
    return one.worst


def _shared_out(now: Inbetweens, power: float) -> np.ndarray:
    """Frames (K,) that cut the error to a power, taken as even within each segment, into equal shares."""
    share = np.maximum.reduceat(now.errors, now.frames[:-1])
    if not 0.0 < share.max() < np.inf:
        return now.frames
    sums = np.concatenate([[0.0], np.cumsum(np.maximum(share, LEAST_SHARE * share.max()) ** power)])
    wanted = np.interp(np.linspace(0.0, sums[-1], len(now.frames)), sums, now.frames)
    return _with_pins(wanted, np.flatnonzero(now.pinned))


def _with_pins(wanted: np.ndarray, pins: np.ndarray) -> np.ndarray:
    """Whole frames near the wanted ones (K,), rising, all different, with every pin (P,) among them; first and last are
    pins."""
    keys = len(wanted)
    # the key that becomes a pin: the nearest that leaves the other pins their keys and all keys their frames
    order = np.arange(len(pins))
    low = np.maximum(order, keys - 1 - (pins[-1] - pins))
    high = np.minimum(keys - len(pins) + order, pins)
    owner = np.zeros(len(pins), np.int64)
    for p in range(1, len(pins)):
        least = max(low[p], owner[p - 1] + 1)
        most = min(high[p], owner[p - 1] + pins[p] - pins[p - 1])
        owner[p] = min(max(int(np.argmin(np.abs(wanted - pins[p]))), least), most)
    frames = np.rint(wanted).astype(np.int64)
    for p in range(len(pins) - 1):
        a, b = owner[p], owner[p + 1]
        frames[a], frames[b] = pins[p], pins[p + 1]
        rank = np.arange(b - a + 1)
        inside = np.maximum.accumulate(np.clip(frames[a : b + 1], pins[p], pins[p + 1]) - rank) + rank
        frames[a : b + 1] = np.minimum(inside, pins[p + 1] - rank[::-1])
    return frames


class _Step:
    """One step of `moved`: the best change of the keys around the frame that is furthest off."""

    def __init__(self, now: Inbetweens) -> None:
        self.now, self.trials = now, 0
        keys = len(now.frames)
        after = int(np.searchsorted(now.frames, np.argmax(now.errors), side="right"))
        self.segment = min(max(after - 1, 0), keys - 2)

    def best(self) -> tuple[Change | None, int | None]:
        """The change, and the key (its frame) that is to go for it; None where there is none."""
        limit, found, moving = ENOUGH * self.now.worst, None, None
        for change in self._shifts():
            if change.worst < limit:
                limit, found = change.worst, change
        cheapest = self._cheapest()
        if cheapest is not None and cheapest[0] < limit:
            for change in self._insertions():
                if max(change.worst, cheapest[0]) < limit:
                    limit, found, moving = max(change.worst, cheapest[0]), change, cheapest[1]
        return found, moving

    def _shifts(self) -> Iterator[Change]:
        frames = self.now.frames
        for key in range(max(1, self.segment - 1), min(len(frames) - 1, self.segment + 3)):
            if self.now.pinned[frames[key]]:
                continue
            lo, hi = max(0, key - REACH), min(len(frames) - 1, key + REACH)
            for by in SHIFTS:
                if frames[key - 1] < frames[key] + by < frames[key + 1]:
                    between = frames[lo + 1 : hi].copy()
                    between[key - lo - 1] += by
                    self.trials += 1
                    yield changed(self.now, lo, hi, between)

    def _insertions(self) -> Iterator[Change]:
        frames, q = self.now.frames, self.segment
        a, b = int(frames[q]), int(frames[q + 1])
        if b - a < 2:
            return
        lo, hi = max(0, q - REACH), min(len(frames) - 1, q + 1 + REACH)
        quarter = max(1, (b - a) // 4)
        at = a + int(np.argmax(self.now.errors[a : b + 1]))
        for frame in dict.fromkeys((min(max(at, a + quarter), b - quarter), (a + b) // 2)):
            self.trials += 1
            yield changed(self.now, lo, hi, np.sort(np.append(frames[lo + 1 : hi], frame)))

    def _cheapest(self) -> tuple[float, int] | None:
        """Of the keys far enough from here the one that is missed least: the error then, its frame."""
        now, beside = self.now, 2 * REACH + 1
        costs = []
        for key in range(1, len(now.frames) - 1):
            frame = int(now.frames[key])
            if now.pinned[frame] or self.segment - beside < key < self.segment + 1 + beside:
                continue
            if frame not in now.costs:
                gone = _without(now, frame)
                self.trials += 1
                now.costs[frame] = (gone.worst, int(gone.frames[0]), int(gone.frames[-1]))
            costs.append((now.costs[frame][0], frame))
        return min(costs, default=None)


def _without(now: Inbetweens, frame: int) -> Change:
    key = int(np.searchsorted(now.frames, frame))
    lo, hi = max(0, key - REACH), min(len(now.frames) - 1, key + REACH)
    return changed(now, lo, hi, np.delete(now.frames[lo + 1 : hi], key - lo - 1))
