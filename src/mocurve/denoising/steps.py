"""Offsets that last: a channel leaps in one frame and stays there, as where two markers are taken for each other."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ._quantiles import median_of_windows, quantile

ISOLATED = 0.3  # of a leap: what the frame steps around it may be
UNUSUAL = 4.0  # times what nearly all frame steps of the channel stay below
OPPOSITE = 0.2  # of a leap: how much a leap back may differ
STRANGE = 0.5  # of the frames outside a single leap: where the rest of the clip never is
PART = 0.4  # of a clip: what is longer is not taken for the displaced part
FAST = 2.0  # times what is never called an artefact
CERTAIN = 12.0  # standard deviations of noise


class Offset(NamedTuple):
    """Frames first ... last - 1 of a channel are off by so much."""

    channel: int
    first: int
    last: int
    by: float


def offsets(y: np.ndarray, sigma: np.ndarray, sharpest: np.ndarray, leap: np.ndarray, shortest: int) -> list[Offset]:
    """Displaced parts of the channels y (C, n), of over `shortest` frames, or of few at an end of the clip.

    sharpest (C,): a leap that no motion makes; leap (C,): one worth a look where it is unusual for the channel."""
    found: list[Offset] = []
    if y.shape[1] < 4 * shortest:
        return found
    step = np.diff(y, axis=1)
    usual = quantile(np.abs(step), 0.98)
    least = np.maximum(np.minimum(sharpest, np.maximum(FAST * leap, UNUSUAL * usual)), CERTAIN * sigma)
    for channel in np.flatnonzero((np.abs(step) > least[:, None]).any(1)):
        leaps = _leaps(step[channel], least[channel], shortest)
        found += [Offset(int(channel), first, last, by) for first, last, by in _displaced(leaps, y[channel], shortest)]
    return found


def _leaps(step: np.ndarray, least: float, shortest: int) -> list[tuple[int, float]]:
    """(first frame after it, size) of every leap with no other near it: such are the ends of short artefacts."""
    reach = shortest + 3
    at = np.flatnonzero(np.abs(step) > least)
    window = np.delete(np.arange(2 * reach + 1), reach)  # all of it but the leap
    around = np.pad(step, reach, constant_values=np.nan)[at[:, None] + window]
    slope = median_of_windows(around)
    size, spread = step[at] - slope, np.nanmax(np.abs(around - slope[:, None]), axis=1, initial=0.0)
    alone = spread <= ISOLATED * np.abs(size)
    return list(zip((at[alone] + 1).tolist(), size[alone].tolist(), strict=True))


def _displaced(leaps: list[tuple[int, float]], y: np.ndarray, shortest: int) -> list[tuple[int, int, float]]:
    """What lies between a leap and the leap back, and what lies outside one that is not taken back, if that is where
    the rest of the clip never is: a toe that strikes the ground leaps too, and nothing else says which side is right.

    A leap near an end of the clip has nothing to do with others."""
    frames = len(y)
    found = [(0, at, -size) for at, size in leaps if at <= shortest]
    found += [(at, frames, size) for at, size in leaps if at >= frames - shortest]
    leaps = [leap for leap in leaps if shortest < leap[0] < frames - shortest]
    alone = []
    while leaps:
        (first, size), *rest = leaps
        back = next((k for k, (_, other) in enumerate(rest) if abs(size + other) <= OPPOSITE * abs(size)), None)
        if back is None:
            alone.append((first, size))
            leaps = rest
            continue
        last, other = rest[back]
        if PART * frames > last - first > shortest:
            found.append((first, last, (size - other) / 2))
        leaps = rest[:back] + rest[back + 1 :]
    if len(alone) == 1:
        at, size = alone[0]
        first, last, by = (0, at, -size) if at <= frames / 2 else (at, frames, size)
        others = np.delete(y, np.s_[first:last])
        lost, moved = (
            ((part < others.min()) | (part > others.max())).mean() for part in (y[first:last], y[first:last] - by)
        )
        if last - first <= PART * frames and lost > STRANGE and moved < lost / 2:
            found.append((first, last, by))
    return found
