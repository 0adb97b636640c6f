"""What is known while a foot stands, carried smoothly through its swings: places, speeds and accelerations meet (C2).

At both edges of a contact the speed and the acceleration are those of the quadratic that fits 40 ms of the contact and
goes through its edge. Over a swing they are carried by quintic Hermite polynomials. Compiled: every edit asks for
it eight times, and NumPy takes twenty times as long.
"""

from __future__ import annotations

import numpy as np

from .._jit import kernel

EDGE = 0.04  # seconds of a contact that tell its speed and acceleration at the edge
REACH = 0.6  # seconds after which what a contact asks for is over, at the ends of a clip and in long flights


def filled(known: np.ndarray, spans: np.ndarray, frame_time: float, die: float | None = None) -> np.ndarray:
    """Values (F, M) for all frames, from those known in the contacts `spans` (N, 2), first frame and frame after.

    Before the first and after the last contact, and in gaps longer than twice REACH, they go to zero within REACH.
    die: seconds within which speeds and accelerations die out, so that only the values themselves cross the swing; by
    default they cross it too. Where a contact slides, one polynomial for all of it overshoots by centimetres.
    """
    result = np.array(known, np.float64)
    if not len(spans):
        result[:] = 0.0
        return result
    last, count = spans[:, 1] - 1, max(2, round(EDGE / frame_time))
    edges = np.array(spans, np.int64)
    ends, starts = (_edges(result, at, sense, edges, frame_time, count) for at, sense in ((last, -1), (edges[:, 0], 1)))
    dying = 0 if die is None else max(1, round(die / frame_time))
    _fill(result, edges, ends, starts, frame_time, int(REACH / frame_time), dying)
    return result


# -- in call order ---------------------------------------------------------------------------------


@kernel
def _edges(
    known: np.ndarray, at: np.ndarray, sense: int, spans: np.ndarray, frame_time: float, count: int
) -> np.ndarray:
    """Values, speeds and accelerations (N, 3, M) at one edge of each contact; no speed where it is a frame or two."""
    result = np.zeros((len(at), 3, known.shape[1]))
    for i in range(len(at)):
        used = min(count, spans[i, 1] - spans[i, 0] - 1)
        s2, s3, s4 = 0.0, 0.0, 0.0
        for k in range(1, used + 1):
            s = sense * k * frame_time
            h = 0.5 * s * s
            s2, s3, s4 = s2 + s * s, s3 + s * h, s4 + h * h
        for m in range(known.shape[1]):
            result[i, 0, m] = known[at[i], m]
            if used < 2:
                continue
            y1, y2 = 0.0, 0.0
            for k in range(1, used + 1):
                s = sense * k * frame_time
                rise = known[at[i] + sense * k, m] - known[at[i], m]
                y1, y2 = y1 + s * rise, y2 + 0.5 * s * s * rise
            size = s2 * s4 - s3 * s3
            result[i, 1, m] = (s4 * y1 - s3 * y2) / size
            result[i, 2, m] = (s2 * y2 - s3 * y1) / size
    return result


@kernel
def _fill(
    result: np.ndarray,
    spans: np.ndarray,
    ends: np.ndarray,
    starts: np.ndarray,
    frame_time: float,
    reach: int,
    dying: int,
) -> None:
    """Fill the gaps between the spans in place; dying: frames within which speeds die out, 0 where they do not."""
    frames, wide = result.shape
    keeps = 0.0 if dying else 1.0  # speeds that cross the gap
    for gap in range(len(spans) + 1):
        before, after = gap > 0, gap < len(spans)
        first = spans[gap - 1, 1] if before else 0
        end = spans[gap, 0] if after else frames
        whole = end - first + 1
        crossing = before and after and whole <= 2 * reach
        short = min(dying, max(whole // 2, 1)) if before and after else dying
        for f in range(first, end):
            since, until = f - first + 1, end - f
            for m in range(wide):
                made = 0.0
                for side in range(2):
                    there, away = (before, since) if side == 0 else (after, until)
                    if not there:
                        continue
                    edge = ends[gap - 1] if side == 0 else starts[gap]
                    sense = 1.0 if side == 0 else -1.0
                    value, speed, haste = edge[0, m], sense * edge[1, m], edge[2, m]
                    if dying:
                        made += _leaving(min(away / short, 1.0), short * frame_time, 0.0, speed, haste)
                    over = whole if crossing else reach
                    made += _leaving(min(away / over, 1.0), over * frame_time, value, keeps * speed, keeps * haste)
                result[f, m] = made


@kernel
def _leaving(u: float, seconds: float, value: float, speed: float, acceleration: float) -> float:
    """The quintic that leaves u = 0 with these and arrives at u = 1 with nothing."""
    u2 = u * u
    u3 = u2 * u
    return (
        value * (1.0 - u3 * (10.0 - 15.0 * u + 6.0 * u2))
        + speed * seconds * (u - u3 * (6.0 - 8.0 * u + 3.0 * u2))
        + acceleration * seconds * seconds * (0.5 * u2 - u3 * (1.5 - 1.5 * u + 0.5 * u2))
    )
