"""What is known while a foot stands, carried smoothly through its swings: places, speeds and accelerations meet (C2).

At both edges of a contact the speed and the acceleration are those of the quadratic that fits 40 ms of the contact and
goes through its edge. Over a swing they are carried by quintic Hermite polynomials.
"""

from __future__ import annotations

import numpy as np

EDGE = 0.04  # seconds of a contact that tell its speed and acceleration at the edge
REACH = 0.6  # seconds after which what a contact asks for is over, at the ends of a clip and in long flights


def filled(known: np.ndarray, spans: np.ndarray, frame_time: float, die: float | None = None) -> np.ndarray:
    """Values (F, M) for all frames, from those known in the contacts `spans` (N, 2), first frame and frame after.

    Before the first and after the last contact, and in gaps longer than twice REACH, they go to zero within REACH.
    die: seconds within which speeds and accelerations die out, so that only the values themselves cross the swing; by
    default they cross it too. Where a contact slides, one polynomial for all of it overshoots by centimetres.
    """
    result = known.copy()
    if not len(spans):
        result[:] = 0.0
        return result
    frames = np.arange(len(known))
    gap = np.searchsorted(spans[:, 0], frames, side="right")  # contacts that have begun
    inside = (gap > 0) & (frames < spans[gap - 1, 1])
    frames, gap = frames[~inside], gap[~inside]
    before, after = gap > 0, gap < len(spans)
    left, right = np.maximum(gap - 1, 0), np.minimum(gap, len(spans) - 1)
    since, until = frames - (spans[left, 1] - 1), spans[right, 0] - frames
    whole = since + until
    crossing = before & after & (whole <= 2 * int(REACH / frame_time))
    ends = _edges(known, spans[:, 1] - 1, -1, spans, frame_time)
    starts = _edges(known, spans[:, 0], 1, spans, frame_time)
    from_left, from_right = (part[left] for part in ends), (part[right] for part in starts)
    (c0, v0, a0), (c1, v1, a1) = from_left, from_right
    made = np.zeros((len(frames), known.shape[1]))
    if die is not None:
        short = np.full(len(frames), max(1, round(die / frame_time)))
        short = np.where(before & after, np.minimum(short, np.maximum(whole // 2, 1)), short)
        made += _dying(since, short, before, frame_time, 0.0 * c0, v0, a0)
        made += _dying(until, short, after, frame_time, 0.0 * c1, -v1, a1)
        v0, a0, v1, a1 = (0.0 * part for part in (v0, a0, v1, a1))
    fade = np.full(len(frames), max(1, int(REACH / frame_time)))
    made += _dying(since, fade, before & ~crossing, frame_time, c0, v0, a0)
    made += _dying(until, fade, after & ~crossing, frame_time, c1, -v1, a1)
    u, seconds = (since / np.maximum(whole, 1))[:, None], (whole * frame_time)[:, None]
    over = _leaving(u, seconds, c0, v0, a0) + _leaving(1.0 - u, seconds, c1, -v1, a1)
    result[frames] = made + np.where(crossing[:, None], over, 0.0)
    return result


# -- in call order ---------------------------------------------------------------------------------


def _edges(
    known: np.ndarray, at: np.ndarray, sense: int, spans: np.ndarray, frame_time: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Values, speeds and accelerations (N, M) at one edge of each contact; no speed where it is a frame or two."""
    count = max(2, round(EDGE / frame_time))
    steps = np.arange(1, count + 1)
    used = (steps <= (spans[:, 1] - spans[:, 0] - 1)[:, None]).astype(float)  # (N, K)
    rise = known[np.clip(at[:, None] + sense * steps, 0, len(known) - 1)] - known[at][:, None]
    s = sense * steps * frame_time
    h = 0.5 * s * s
    s2, s3, s4 = ((used * part).sum(axis=1)[:, None] for part in (s * s, s * h, h * h))
    y1, y2 = (np.einsum("nk,nkm->nm", used * part, rise) for part in (s, h))
    size = s2 * s4 - s3 * s3
    few = used.sum(axis=1)[:, None] < 2
    safe = np.where(few, 1.0, size)
    speed, acceleration = (np.where(few, 0.0, part / safe) for part in (s4 * y1 - s3 * y2, s2 * y2 - s3 * y1))
    return known[at], speed, acceleration


def _leaving(
    u: np.ndarray, seconds: np.ndarray, value: np.ndarray, speed: np.ndarray, acceleration: np.ndarray
) -> np.ndarray:
    """The quintic that leaves u = 0 with these and arrives at u = 1 with nothing."""
    u2 = u * u
    u3 = u2 * u
    return (
        value * (1.0 - u3 * (10.0 - 15.0 * u + 6.0 * u2))
        + speed * seconds * (u - u3 * (6.0 - 8.0 * u + 3.0 * u2))
        + acceleration * seconds * seconds * (0.5 * u2 - u3 * (1.5 - 1.5 * u + 0.5 * u2))
    )


def _dying(
    away: np.ndarray, within: np.ndarray, there: np.ndarray, frame_time: float, *state: np.ndarray
) -> np.ndarray:
    """The same, frames `away` from an edge, over so many frames; zero after that and where there is no contact."""
    u = np.minimum(away / within, 1.0)[:, None]
    return np.where(there[:, None], _leaving(u, (within * frame_time)[:, None], *state), 0.0)
