"""Where knots go: evenly, by curvature, or as few as hold the tolerance.

Inner knots are frames; a fit that is asked for a number of spans gets it, else the number is the least that holds.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from .. import progress
from .task import Fit, Task, fitted

SMOOTH = 2  # frames to either side that a second difference is averaged over
FLOOR = 0.05  # of the mean density of knots: what a part without curvature gets
SPARE = 0.6  # of the tolerance: the search for few knots starts from more than it needs
TURNS = 6  # at most, of taking out more
BATCH = 0.1  # of the knots that are tried to be taken out at once


def uniform(task: Task, spans: int | None) -> Fit:
    """Knots as far apart as one another."""
    last = task.motion.frames - 1
    return _with_spans(task, spans, lambda count: np.linspace(0.0, last, count + 1)[1:-1])


def by_curvature(task: Task, spans: int | None) -> Fit:
    """Knots that share the curvature equally: the integral of |y''|^(1/(p+1)), as de Boor's newknot.

    y'' is a smoothed second difference, in what each channel may be off: a lever arm counts by its length.
    """
    share = _shares(task)
    frames = np.arange(len(share))

    def knots(count: int) -> np.ndarray:
        return _spread(task, np.interp(np.linspace(0.0, 1.0, count + 1)[1:-1], share, frames))

    return _with_spans(task, spans, knots)


def bisected(task: Task, spans: int | None = None) -> Fit:
    """From a knot about every 24 frames on, every span in which the promise breaks is halved until none is left.

    It takes no number of spans, as `fewest`."""
    return halved(task, _start(task), 1.0)


def fewest(task: Task, spans: int | None = None) -> Fit:
    """The worst spans are halved until the promise holds with room to spare; then the knots that matter least go.

    Removal is ranked as by Lyche and Morken 1988 and checked by a new fit."""
    plenty = halved(task, _start(task), SPARE)
    return thinned(task, plenty if plenty.holds else halved(task, plenty.inner, 1.0))


def halved(task: Task, inner: np.ndarray, aim: float) -> Fit:
    """Every span with an error above `aim` limits gets a knot in its middle, until there is none, or no room for one.

    The result may lack the promise only where a knot at every frame does not bring it."""
    last = task.motion.frames - 1
    inner = np.unique(_rounded(task, inner)) if task.motion.frames > task.degree + 1 else inner[:0]
    while True:
        found = fitted(task, inner, weighted=0)
        if found.worst <= aim:
            return found
        more = _middles(task, np.concatenate([[0], inner, [last]]), found.over > aim)
        if not len(more):
            return found
        inner = np.union1d(inner, more)


def thinned(task: Task, start: Fit) -> Fit:
    """Knots taken out while the promise holds, the least significant first; then, in turns, with their neighbours
    moved a third of the way into the gap, which may hold where a gap alone does not."""
    now = _taken_out(task, start, spread=False) if start.holds else start
    for turn in range(TURNS if now.holds else 0):
        before = len(now.inner)
        now = _taken_out(task, now, spread=turn % 2 == 0)
        if len(now.inner) == before:
            break
    return now


# -- in call order ---------------------------------------------------------------------------------


def _with_spans(task: Task, spans: int | None, knots: Callable[[int], np.ndarray]) -> Fit:
    """With this many spans, or else the least number found that holds the promise; last, the worst spans are halved."""
    if spans is not None:
        return fitted(task, knots(spans), weighted=0)
    most = max(task.motion.frames - task.degree, 1)  # as many coefficients as frames
    low, high = 0, 1
    tried = fitted(task, knots(high))
    while not tried.holds and high < most:
        low, high = high, min(2 * high, most)
        tried = fitted(task, knots(high))
    found = tried if tried.holds else None
    while high - low > 1:
        middle = (low + high) // 2
        tried = fitted(task, knots(middle))
        if tried.holds:
            high, found = middle, tried
        elif np.isinf(tried.worst):  # more spans than samples settle well
            high = middle
        else:
            low = middle
    return halved(task, knots(low), 1.0) if found is None else found


def _shares(task: Task) -> np.ndarray:
    """(F,) the part of all curvature up to each frame, from 0 to 1, rising."""
    values = task.motion.values
    if len(values) < 3:
        return np.linspace(0.0, 1.0, len(values))
    bend = np.zeros(values.shape)
    bend[1:-1] = np.diff(values, n=2, axis=0)
    bend[[0, -1]] = bend[[1, -2]]
    padded = np.pad(bend, ((SMOOTH + 1, SMOOTH), (0, 0)), mode="edge").cumsum(axis=0)
    smooth = (padded[2 * SMOOTH + 1 :] - padded[: -2 * SMOOTH - 1]) / (2 * SMOOTH + 1)
    with np.errstate(over="ignore"):
        size = np.linalg.norm(smooth / task.allowed, axis=1)
    density = np.minimum(size, 1e100) ** (1.0 / (task.degree + 1))
    density = density + max(FLOOR * float(density.mean()), 1e-12)
    share = np.concatenate([[0.0], np.cumsum(0.5 * (density[1:] + density[:-1]))])
    return share / share[-1]


def _start(task: Task) -> np.ndarray:
    """A knot about every 24 frames, by curvature."""
    share = _shares(task)
    spread = np.linspace(0.0, 1.0, 2 + len(share) // 24)[1:-1]
    return _spread(task, np.interp(spread, share, np.arange(len(share))))


def _rounded(task: Task, inner: np.ndarray) -> np.ndarray:
    """The nearest of the places where knots are well settled by samples: as many coefficients as frames at most.

    Frames for an odd degree, else half-way between them, and none that would leave the ends more coefficients than
    samples ("not a knot")."""
    lowest = 0.5 * (task.degree + 1)
    most = task.motion.frames - 1 - lowest
    return np.clip(np.rint(inner - lowest) + lowest, lowest, max(most, lowest))


def _spread(task: Task, inner: np.ndarray) -> np.ndarray:
    """The same for rising knots, each on a place of its own."""
    places = np.arange(len(inner))
    inner = np.maximum.accumulate(_rounded(task, inner) - places) + places
    return np.minimum(inner, task.motion.frames - 1 - 0.5 * (task.degree + 1) - places[::-1])


def _middles(task: Task, breaks: np.ndarray, bad: np.ndarray) -> np.ndarray:
    """Knots in the middle of the spans with bad frames (F,); of their neighbours where those have no place left."""
    left, right = breaks[:-1], breaks[1:]
    middle = _rounded(task, 0.5 * (left + right))
    room = (left < middle) & (middle < right)
    span = np.clip(np.searchsorted(breaks, np.arange(len(bad)), "right") - 1, 0, len(left) - 1)
    wanted = np.zeros(len(left), bool)
    wanted[span[bad]] = True
    if not room.any():
        return np.zeros(0)
    while not (wanted & room).any():
        wanted = wanted | np.append(wanted[1:], False) | np.append(False, wanted[:-1])
    return np.asarray(middle[wanted & room])


def _significance(task: Task, now: Fit) -> np.ndarray:
    """(K,) how far coefficients have to move, in what their channels may be off, for each inner knot to be nothing.

    Inserting knot j makes c[i] = a[i] b[i] + (1 - a[i]) b[i - 1]; coefficients with n'c = 0 for the one direction n
    that no b reaches need no knot, and the others are |n'c| / |n| from such ones in the largest norm.
    """
    p, knots = task.degree, now.knots
    j = np.arange(p + 1, len(knots) - p - 1)
    parts = [np.ones(len(j))]  # a of coefficient j - 1 - p
    for i in range(-p, 0):
        left, right = knots[j + i], knots[j + i + p + 1]
        parts.append((knots[j] - left) / (right - left))
    parts.append(np.zeros(len(j)))
    direction = [np.ones(len(j))]
    for i in range(p + 1):
        direction.append(-direction[-1] * parts[i] / (1.0 - parts[i + 1]))
    lengths = np.abs(direction).sum(axis=0)
    apart = sum(n[:, None] * now.values[j - 1 - p + i] for i, n in enumerate(direction))
    at = np.clip(np.rint(now.inner).astype(np.int64), 0, len(task.times) - 1)
    return np.asarray(np.max(np.abs(apart) / lengths[:, None] / task.allowed[at], axis=1, initial=0.0))


def _taken_out(task: Task, now: Fit, spread: bool) -> Fit:
    """Every knot tried once, many at the same time."""
    needed, total = np.zeros(0), max(len(now.inner), 1)
    while True:
        free = np.flatnonzero(~np.isin(now.inner, needed))
        progress.advance("taking out knots", total - len(free), total)
        if not len(free):
            return now
        order = free[np.argsort(_significance(task, now)[free], kind="stable")]
        chosen = _apart(order, max(1, int(BATCH * len(order))), 3 if spread else 1)
        now, kept = _without(task, now, chosen, spread)
        needed = np.union1d(needed, kept)


def _apart(order: np.ndarray, most: int, between: int) -> np.ndarray:
    """The first of these numbers, at most so many, with as many others or more between any two."""
    taken: list[int] = []
    blocked: set[int] = set()
    for number in order.tolist():
        if number not in blocked:
            taken.append(number)
            blocked.update(range(number - between, number + between + 1))
        if len(taken) == most:
            break
    return np.array(sorted(taken))


def _without(task: Task, now: Fit, chosen: np.ndarray, spread: bool) -> tuple[Fit, np.ndarray]:
    """The fit without the chosen knots, or without those of them that the promise can spare; and the knots it cannot.

    Where the promise breaks the chosen knots next to the broken frames are put back."""
    put_back: list[float] = []
    while len(chosen):
        inner = now.inner.copy()
        if spread:
            ends = np.concatenate([[0.0], inner, [task.motion.frames - 1.0]])
            before, after = chosen[chosen > 0], chosen[chosen < len(inner) - 1]
            inner[before - 1] += (ends[before + 1] - ends[before]) / 3.0
            inner[after + 1] -= (ends[after + 2] - ends[after + 1]) / 3.0
        inner = np.delete(inner, chosen)
        tried = fitted(task, np.unique(_rounded(task, inner)) if spread else inner)
        if tried.holds:
            return tried, np.array(put_back)
        places = np.searchsorted(now.inner, np.flatnonzero(tried.over > 1.0))
        near = np.abs(chosen[:, None] - places[None, :]).min(axis=1)
        back = near <= max(task.degree - 1, int(near.min()))
        put_back += now.inner[chosen[back]].tolist()
        chosen = chosen[~back]
    return now, np.array(put_back)
