"""A swinging foot that passes the standing one keeps the distance that the source has: compiled, because every swing is
tried several times.

A bump 64 u^3 (1 - u)^3 over the swing (C2) is added to the ground plan of the swinging foot, along the line between the
feet where they pass closest in the source: the smallest that keeps most of their distance, or else the one that keeps
the two feet farthest apart. Where a path turns sharply a foot would pass on the wrong side of the other; it then goes
around it.
"""

from __future__ import annotations

import numpy as np

from .._jit import kernel
from ._footprints import Targets
from ._stances import Stances
from ._swings import REACH

STEP, MOST = 1.0, 20.0  # cm that a foot goes around the other: tried in steps of, and at most
ENOUGH = 0.75  # of the distance that the feet have in the source
LEAST = 0.2  # cm that a larger bump has to win
ALONE = 40.0  # cm: feet that are never nearer do not pass


def cleared(
    own: Targets,
    other: Targets,
    middles: tuple[np.ndarray, np.ndarray],
    stances: tuple[Stances, Stances],
    heading: np.ndarray,
    frame_time: float,
) -> Targets:
    """Targets of one leg that keep away from those of the other. middles: of both feet in the source (F, 3), cm;
    stances: of both legs; heading: (F,) by how much the body is turned."""
    ball, ankle = own.ball.copy(), own.ankle.copy()
    mine, others = middles
    longest = int(2.0 * REACH / frame_time)
    _clear(heading, ankle, ball, other.ankle, other.ball, mine, others, stances[0].spans, stances[1].of, longest)
    return Targets(ball, ankle, own.yaw)


# -- in call order ---------------------------------------------------------------------------------


@kernel
def _clear(heading, ankle, ball, other_ankle, other_ball, mine, others, spans, standing, longest):  # type: ignore[no-untyped-def]
    """Move ankle and ball (F, 3) in place. standing (F,): at least 0 where the other foot stands."""
    frames, count = len(heading), len(spans)
    for i in range(count + 1 if count else 0):
        low = spans[i - 1, 1] - 1 if i > 0 else -1
        high = spans[i, 0] if i < count else frames
        long = high - low
        if long < 8 or (0 < i < count and long > longest):
            continue
        start, end = low + long // 5, high - long // 5
        if i == 0:
            start, end = max(0, high - longest // 2), high - 4
        if i == count:
            start, end = low + 4, min(frames, low + longest // 2)
        nearest, at = 1e18, -1
        for f in range(start, end):
            if standing[f] < 0:
                continue
            square = (mine[f, 0] - others[f, 0]) ** 2 + (mine[f, 2] - others[f, 2]) ** 2
            if square < nearest:
                nearest, at = square, f
        distance = np.sqrt(nearest)
        if at < 0 or distance < 1e-6 or distance > ALONE:
            continue
        if i == 0:  # the first and the last swing are cut: the bump is even on both sides of the passing
            low = 2 * at - high
        elif i == count:
            high = 2 * at - low
        x, z = (mine[at, 0] - others[at, 0]) / distance, (mine[at, 2] - others[at, 2]) / distance
        cosine, sine = np.cos(heading[at]), np.sin(heading[at])
        across = 0.5 * (ball[at, 0] + ankle[at, 0] - other_ball[at, 0] - other_ankle[at, 0])
        along = 0.5 * (ball[at, 2] + ankle[at, 2] - other_ball[at, 2] - other_ankle[at, 2])
        missing = distance - (across * (cosine * x + sine * z) + along * (cosine * z - sine * x))
        if missing <= 1e-6:
            continue
        best, chosen = _apart(heading, ankle, ball, other_ankle, other_ball, low, high, 0.0, 0.0), 0.0
        enough = ENOUGH * distance
        size = 0.0
        while best < enough and size < MOST:
            size += STEP
            apart = _apart(heading, ankle, ball, other_ankle, other_ball, low, high, size * x, size * z)
            if apart > best + LEAST:
                best, chosen = apart, size
        if chosen == 0.0:
            continue
        for f in range(max(low + 1, 0), min(high, frames)):
            u = (f - low) / (high - low)
            bump = chosen * 64.0 * (u * (1.0 - u)) ** 3
            cosine, sine = np.cos(heading[f]), np.sin(heading[f])
            for place in (ankle, ball):
                place[f, 0] += bump * (cosine * x + sine * z)
                place[f, 2] += bump * (cosine * z - sine * x)


@kernel
def _apart(heading, ankle, ball, other_ankle, other_ball, low, high, x, z):  # type: ignore[no-untyped-def]
    """The least distance over the ground between the two feet, heel to ball, during a swing with a bump (x, z)."""
    nearest = 1e18
    for f in range(max(low + 1, 0), min(high, len(heading))):
        u = (f - low) / (high - low)
        bump = 64.0 * (u * (1.0 - u)) ** 3
        cosine, sine = np.cos(heading[f]), np.sin(heading[f])
        dx, dz = bump * (cosine * x + sine * z), bump * (cosine * z - sine * x)
        for i in range(4):
            px = ball[f, 0] + 0.42 * i * (ankle[f, 0] - ball[f, 0]) + dx
            pz = ball[f, 2] + 0.42 * i * (ankle[f, 2] - ball[f, 2]) + dz
            for j in range(4):
                qx = other_ball[f, 0] + 0.42 * j * (other_ankle[f, 0] - other_ball[f, 0])
                qz = other_ball[f, 2] + 0.42 * j * (other_ankle[f, 2] - other_ball[f, 2])
                nearest = min(nearest, (px - qx) ** 2 + (pz - qz) ** 2)
    return np.sqrt(nearest)
