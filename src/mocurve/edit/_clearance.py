"""A swinging foot that passes the standing one keeps the distance that the source has: compiled, because every swing is
tried several times.

A bump 64 u^3 (1 - u)^3 over the swing (C2) is added to the ground plan of the swinging foot, along the line between the
feet where they pass closest in the source: the smallest that keeps most of their distance, or else the one that keeps
the two feet farthest apart. Where a path turns sharply a foot would pass on the wrong side of the other; it then goes
around it.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from .._jit import kernel
from ._footprints import Targets
from ._stances import Stances
from ._swings import REACH

STEP, MOST = 1.0, 25.0  # cm that a foot goes around the other: tried in steps of, and at most
HURRY = 75.0  # cm that it goes around at most in a swing of a second, four times less in half of that
ENOUGH = 0.75  # of the distance that the feet have in the source
LEAST = 0.2  # cm that a larger bump has to win
ALONE = 40.0  # cm: feet that are never nearer do not pass


def cleared(
    own: Targets,
    other: Targets,
    before: tuple[Targets, Targets],
    stances: tuple[Stances, Stances],
    heading: np.ndarray,
    frame_time: float,
) -> Targets:
    """Targets of one leg that keep away from those of the other. before: both feet in the source; stances: of both
    legs; heading: (F,) by how much the body is turned."""
    ball, ankle = own.ball.copy(), own.ankle.copy()
    feet = (ankle, ball, other.ankle, other.ball)
    source = (before[0].ankle, before[0].ball, before[1].ankle, before[1].ball)
    longest, hurry = int(2.0 * REACH / frame_time), HURRY * frame_time**2
    _clear(heading, feet, source, stances[0].spans, stances[1].of, longest, hurry)
    return replace(own, ball=ball, ankle=ankle)


# -- in call order ---------------------------------------------------------------------------------


@kernel
def _clear(heading, feet, source, spans, standing, longest, hurry):
    """Move the own foot in place. feet, source: ankle and ball of it and of the other (F, 3); standing (F,): at least 0
    where the other stands; longest: frames of a swing; hurry: cm a frame squared."""
    level = np.zeros(len(heading))
    for i in range(len(spans) + 1 if len(spans) else 0):
        low, high, at, distance = _passing(i, source, spans, standing, longest)
        if at < 0:
            continue
        x, z, missing = _missing(heading, feet, source, at, distance)
        if missing <= 1e-6:
            continue
        u = (at - low) / (high - low)
        enough = min(ENOUGH * distance, _apart(level, source, low, high, 0.0, 0.0))
        most = min(MOST, hurry * (high - low) ** 2)
        back = max(0.0, missing - distance) / (64.0 * (u * (1.0 - u)) ** 3)  # from the wrong side of the other foot
        best, chosen = _widest(heading, feet, low, high, x, z, back, most, enough)
        if best < enough and back > 0.0:
            there, size = _widest(heading, feet, low, high, x, z, 0.0, most, enough)
            chosen = size if there > best else chosen
        if chosen > 0.0:
            _go_around(heading, feet, low, high, chosen * x, chosen * z)


@kernel
def _widest(heading, feet, low, high, x, z, size, most, enough):
    """How far apart the feet can be kept in a swing by the smallest bump, from this size on, that is enough or else
    best; and its size."""
    best, chosen = 0.0, 0.0
    while size <= most:
        apart = _apart(heading, feet, low, high, size * x, size * z)
        if apart > best + LEAST:
            best, chosen = apart, size
        if best >= enough:
            break
        size += STEP
    return best, chosen


@kernel
def _passing(i, source, spans, standing, longest):
    """The swing before stance i, first frame and frame after it, and in which frame the foot passes the other how near
    in the source; the frame is -1 where it does not. The first and the last swing of a clip are even about the
    passing."""
    frames, count = len(standing), len(spans)
    low = spans[i - 1, 1] - 1 if i > 0 else -1
    high = spans[i, 0] if i < count else frames
    long = high - low
    if long < 8 or (0 < i < count and long > longest):
        return low, high, -1, 0.0
    start, end = low + long // 5, high - long // 5
    if i == 0:
        start, end = max(0, high - longest // 2), high - 4
    if i == count:
        start, end = low + 4, min(frames, low + longest // 2)
    nearest, at = 1e18, -1
    for f in range(start, end):
        x, z = _between(source, f)
        if standing[f] >= 0 and x * x + z * z < nearest:
            nearest, at = x * x + z * z, f
    distance = np.sqrt(nearest)
    if at < 0 or distance < 1e-6 or distance > ALONE:
        return low, high, -1, 0.0
    if i == 0:
        low = 2 * at - high
    elif i == count:
        high = 2 * at - low
    return low, high, at, distance


@kernel
def _missing(heading, feet, source, at, distance):
    """The direction (x, z) from the other foot in the source as it passes, and by how much the feet are nearer now."""
    x, z = _between(source, at)
    x, z = x / distance, z / distance
    cosine, sine = np.cos(heading[at]), np.sin(heading[at])
    across, along = _between(feet, at)
    return x, z, distance - (across * (cosine * x + sine * z) + along * (cosine * z - sine * x))


@kernel
def _between(feet, f):
    """From the middle of the other foot to that of the own, over the ground."""
    ankle, ball, other_ankle, other_ball = feet
    x = 0.5 * (ball[f, 0] + ankle[f, 0] - other_ball[f, 0] - other_ankle[f, 0])
    return x, 0.5 * (ball[f, 2] + ankle[f, 2] - other_ball[f, 2] - other_ankle[f, 2])


@kernel
def _go_around(heading, feet, low, high, x, z):
    """Add the bump (x, z), as the body sees it, to a swing."""
    for f in range(max(low + 1, 0), min(high, len(heading))):
        u = (f - low) / (high - low)
        bump = 64.0 * (u * (1.0 - u)) ** 3
        cosine, sine = np.cos(heading[f]), np.sin(heading[f])
        for place in feet[:2]:
            place[f, 0] += bump * (cosine * x + sine * z)
            place[f, 2] += bump * (cosine * z - sine * x)


@kernel
def _apart(heading, feet, low, high, x, z):
    """The least distance over the ground between the two feet, heel to ball, during a swing with a bump (x, z)."""
    ankle, ball, other_ankle, other_ball = feet
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
