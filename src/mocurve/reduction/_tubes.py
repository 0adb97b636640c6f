"""Compiled kernels of the promise in space: points of the body, and how far one channel may turn before any of them
leaves.

Places are kept frame by frame, each coordinate of all points in one row, (F, 3, P): a channel moves one contiguous run
of every row, which the compiler turns into vector instructions. Axes of the channels, (F, 3, C), likewise. No fast
maths here: compiled anew it differed in the last digit from the same kernel out of the cache, and with it the keys.
"""

from __future__ import annotations

from math import factorial
from typing import NamedTuple

import numpy as np

from .._jit import kernel

# Taylor's coefficients of sin x and 1 - cos x
S3, S5, S7, S9, S11, S13 = ((-1.0) ** k / factorial(2 * k + 1) for k in range(1, 7))
C4, C6, C8, C10, C12, C14 = ((-1.0) ** (k + 1) / factorial(2 * k) for k in range(2, 8))


class Body(NamedTuple):
    """A skeleton as flat arrays. Joints in depth-first order, so that all that hangs on a joint is one run of points
    and channels."""

    parents: np.ndarray  # (J,) -1 for a root
    offsets: np.ndarray  # (J, 3) used on axes without a position channel
    first_channel: np.ndarray  # (J + 1,) channels of joint j: first_channel[j] to first_channel[j + 1]
    last_channel: np.ndarray  # (J,) one past the last channel at or below joint j
    first_point: np.ndarray  # (J + 1,) points of joint j: its own place, then its shell points
    last_point: np.ndarray  # (J,) one past the last point at or below joint j
    shell: np.ndarray  # (P, 3) place of a point in its joint's turned frame; 0 for the joint's own place
    joint: np.ndarray  # (C,) joint of a channel
    rotates: np.ndarray  # (C,) True for a rotation channel
    axis: np.ndarray  # (C,) 0, 1, 2


@kernel
def pose(body, values, points, axes):
    """Forward kinematics of all frames: fills points (F, 3, P) and each channel's axis in the world, axes (F, 3, C)."""
    frames = values.shape[0]
    joints = len(body.parents)
    turned = np.empty((joints, 3, 3))
    place = np.empty(3)
    for f in range(frames):
        for j in range(joints):
            parent = body.parents[j]
            turn = turned[j]
            for a in range(3):
                place[a] = body.offsets[j, a]
                for b in range(3):
                    turn[a, b] = turned[parent, a, b] if parent >= 0 else (1.0 if a == b else 0.0)
            for k in range(body.first_channel[j], body.first_channel[j + 1]):
                if not body.rotates[k]:
                    place[body.axis[k]] = values[f, k]
                    for a in range(3):
                        axes[f, a, k] = turn[a, body.axis[k]]
            own = body.first_point[j]
            for a in range(3):
                points[f, a, own] = turn[a, 0] * place[0] + turn[a, 1] * place[1] + turn[a, 2] * place[2]
                if parent >= 0:
                    points[f, a, own] += points[f, a, body.first_point[parent]]
            for k in range(body.first_channel[j], body.first_channel[j + 1]):
                if body.rotates[k]:
                    angle = np.radians(values[f, k])
                    s, c = np.sin(angle), np.cos(angle)
                    u = body.axis[k]
                    v, w = (u + 1) % 3, (u + 2) % 3
                    for a in range(3):
                        axes[f, a, k] = turn[a, u]
                        x = turn[a, v] * c + turn[a, w] * s
                        turn[a, w] = turn[a, w] * c - turn[a, v] * s
                        turn[a, v] = x
            for p in range(own + 1, body.first_point[j + 1]):
                for a in range(3):
                    points[f, a, p] = points[f, a, own] + (
                        turn[a, 0] * body.shell[p, 0] + turn[a, 1] * body.shell[p, 1] + turn[a, 2] * body.shell[p, 2]
                    )


@kernel
def moved_points(body, k):
    """First and one past the last of the points that channel k moves. Unsigned: an index that cannot be negative lets
    loops be vectorised."""
    j = body.joint[k]
    return np.uintp(body.first_point[j] + (1 if body.rotates[k] else 0)), np.uintp(body.last_point[j])


@kernel
def reach_of_limits(body, k, points, axes, limits, floor, out):
    """How far channel k alone may go from where it is, to first order: 1 / the largest movement a unit of it makes, in
    limits.

    limits (F, P): how far each point may move (inf: anywhere). floor: least lever arm (length). out (F,): degrees or
    length."""
    first, last = moved_points(body, k)
    own = body.first_point[body.joint[k]]
    for f in range(len(points)):
        u0, u1, u2 = axes[f, 0, k], axes[f, 1, k], axes[f, 2, k]
        most = 0.0
        for p in range(first, last):
            arm = 1.0
            if body.rotates[k]:
                x, y, z = (
                    points[f, 0, p] - points[f, 0, own],
                    points[f, 1, p] - points[f, 1, own],
                    points[f, 2, p] - points[f, 2, own],
                )
                c0, c1, c2 = u1 * z - u2 * y, u2 * x - u0 * z, u0 * y - u1 * x
                arm = max(np.sqrt(c0 * c0 + c1 * c1 + c2 * c2), floor) * (np.pi / 180.0)
            most = max(most, arm / limits[f, p])
        out[f] = 1.0 / most if most > 0.0 else np.inf


@kernel
def sine_versine(x):
    """sin x and 1 - cos x (radians): by their series where it is exact to the last digit, which is faster too."""
    if abs(x) > 0.35:
        return np.sin(x), 1.0 - np.cos(x)
    q = x * x
    sine = x + x * q * (S3 + q * (S5 + q * (S7 + q * (S9 + q * (S11 + q * S13)))))
    versine = q * (0.5 + q * (C4 + q * (C6 + q * (C8 + q * (C10 + q * (C12 + q * C14))))))
    return sine, versine


@kernel(inline="always")
def arcs(first, last, own, k, f, points, target, axes, limits, B, C, E):
    """What changes d the points below rotation channel k allow at frame f: C sin d - B (1 - cos d) + E >= 0.

    That is |rot(u, d) a + o - p*| <= limit, with a from the joint to the point and b to its target, written so that
    nothing cancels where limits are small against bones. Into B, C, E (P,)."""
    o0, o1, o2 = points[f, 0, own], points[f, 1, own], points[f, 2, own]
    u0, u1, u2 = axes[f, 0, k], axes[f, 1, k], axes[f, 2, k]
    for p in range(first, last):
        a0, a1, a2 = points[f, 0, p] - o0, points[f, 1, p] - o1, points[f, 2, p] - o2
        b0, b1, b2 = target[f, 0, p] - o0, target[f, 1, p] - o1, target[f, 2, p] - o2
        d0, d1, d2 = a0 - b0, a1 - b1, a2 - b2
        B[p] = a0 * b0 + a1 * b1 + a2 * b2 - (u0 * a0 + u1 * a1 + u2 * a2) * (u0 * b0 + u1 * b1 + u2 * b2)
        C[p] = (u1 * a2 - u2 * a1) * b0 + (u2 * a0 - u0 * a2) * b1 + (u0 * a1 - u1 * a0) * b2
        E[p] = 0.5 * (limits[f, p] * limits[f, p] - d0 * d0 - d1 * d1 - d2 * d2)


@kernel
def shift_room(first, last, k, f, points, target, axes, limits, lo, hi):
    """[lo, hi] cut to the changes of position channel k at frame f that keep every point within its limit."""
    u0, u1, u2 = axes[f, 0, k], axes[f, 1, k], axes[f, 2, k]
    for p in range(first, last):
        limit = limits[f, p]
        if limit == np.inf:
            continue
        r0 = points[f, 0, p] - target[f, 0, p]
        r1 = points[f, 1, p] - target[f, 1, p]
        r2 = points[f, 2, p] - target[f, 2, p]
        along = r0 * u0 + r1 * u1 + r2 * u2
        reach = np.sqrt(max(0.0, along * along - (r0 * r0 + r1 * r1 + r2 * r2) + limit * limit))
        lo, hi = max(lo, -along - reach), min(hi, -along + reach)
    return lo, hi


@kernel
def narrow(body, k, points, target, axes, limits, begin, end, low, high):
    """The tube of channel k: cuts [low, high] (F,), changes of the channel from where it is, to what keeps every point
    within its limit.

    Exact: the changes that a point allows are an arc about atan2(C, B). Frames begin to end; degrees or length."""
    first, last = moved_points(body, k)
    own = body.first_point[body.joint[k]]
    rotates = body.rotates[k]
    room = points.shape[2]
    B, C, E = np.empty(room), np.empty(room), np.empty(room)
    degrees = 180.0 / np.pi
    for f in range(begin, end):
        if not rotates:
            lo, hi = shift_room(first, last, k, f, points, target, axes, limits, low[f], high[f])
            low[f], high[f] = min(lo, 0.0), max(hi, 0.0)
            continue
        # within a quarter turn the two ends of an interval tell all of it
        lo, hi = max(low[f], -89.0) / degrees, min(high[f], 89.0) / degrees
        arcs(first, last, own, k, f, points, target, axes, limits, B, C, E)
        (sin_lo, up_lo), (sin_hi, up_hi) = sine_versine(lo), sine_versine(hi)
        for back in range(first, last):
            p = (
                first + last - back - 1
            )  # the far ends of limbs first: they are tightest, and spare the others trigonometry
            b, c, e = B[p], C[p], E[p]
            if b > 0.0 and c * sin_lo - b * up_lo + e >= 0.0 and c * sin_hi - b * up_hi + e >= 0.0:
                continue
            size = np.sqrt(b * b + c * c)
            if b - e <= -size or size < 1e-300:
                continue
            rest = c * c / (size + b) if b > 0.0 else size - b
            middle = np.arctan2(c, b)
            half = 2.0 * np.arcsin(np.sqrt(min(max(0.5 * (rest + e) / size, 0.0), 1.0)))
            if middle - half > lo:
                lo = middle - half
                sin_lo, up_lo = sine_versine(lo)
            if middle + half < hi:
                hi = middle + half
                sin_hi, up_hi = sine_versine(hi)
        low[f], high[f] = min(lo * degrees, 0.0), max(hi * degrees, 0.0)


@kernel
def turn(body, k, delta, begin, end, points, axes):
    """Change channel k by delta (F,) degrees or length at frames begin to end: moves the points and axes below it,
    exactly."""
    first, last = moved_points(body, k)
    j = body.joint[k]
    own = body.first_point[j]
    for f in range(begin, end):
        d = delta[f]
        if d == 0.0:
            continue
        u0, u1, u2 = axes[f, 0, k], axes[f, 1, k], axes[f, 2, k]
        if not body.rotates[k]:
            for p in range(first, last):
                points[f, 0, p] += d * u0
                points[f, 1, p] += d * u1
                points[f, 2, p] += d * u2
            continue
        s, v = sine_versine(np.radians(d))
        c = 1.0 - v
        m00, m01, m02 = c + u0 * u0 * v, u0 * u1 * v - u2 * s, u0 * u2 * v + u1 * s
        m10, m11, m12 = u1 * u0 * v + u2 * s, c + u1 * u1 * v, u1 * u2 * v - u0 * s
        m20, m21, m22 = u2 * u0 * v - u1 * s, u2 * u1 * v + u0 * s, c + u2 * u2 * v
        o0, o1, o2 = points[f, 0, own], points[f, 1, own], points[f, 2, own]
        for p in range(first, last):
            x, y, z = points[f, 0, p] - o0, points[f, 1, p] - o1, points[f, 2, p] - o2
            points[f, 0, p] = o0 + m00 * x + m01 * y + m02 * z
            points[f, 1, p] = o1 + m10 * x + m11 * y + m12 * z
            points[f, 2, p] = o2 + m20 * x + m21 * y + m22 * z
        for q in range(np.uintp(k + 1), np.uintp(body.last_channel[j])):
            if body.joint[q] == j and not body.rotates[q]:
                continue  # a joint's own position is in its parent's frame
            x, y, z = axes[f, 0, q], axes[f, 1, q], axes[f, 2, q]
            axes[f, 0, q] = m00 * x + m01 * y + m02 * z
            axes[f, 1, q] = m10 * x + m11 * y + m12 * z
            axes[f, 2, q] = m20 * x + m21 * y + m22 * z


@kernel
def worst_of_limits(points, target, limits):
    """Largest distance of any point from its target at any frame, in its limits; a limit of 0 holds only exactly."""
    worst = 0.0
    for f in range(points.shape[0]):
        for p in range(points.shape[2]):
            x = points[f, 0, p] - target[f, 0, p]
            y = points[f, 1, p] - target[f, 1, p]
            z = points[f, 2, p] - target[f, 2, p]
            off = np.sqrt(x * x + y * y + z * z)
            if off > 0.0:
                worst = max(worst, off / limits[f, p])
    return worst
