"""Compiled kernels of slerp.py: keys of one way drawn to where the worst point is furthest inside its limit, and keys
taken out.

Gauss-Newton steps on the keys' states, for slerp between them; the squares of all distances, each over its limit, are
weighted towards their worst point and, from step to step, towards the worst frames (Lawson 1961).
"""

from __future__ import annotations

import numpy as np

from .._jit import kernel
from ._slerp import HALF_TURN, along, apart, between, matrix

SPAN = 3  # keys to either side of a key that is taken out, whose states may move
FOCUS = 0.02  # weight of a point far inside its limit against one at the limit
LONGEST = 0.5  # radians: a Newton step of a rotation goes no further


@kernel
def move(turns, y, by):
    """Move a state by a rotation vector in the parent's frame (radians), or a shift."""
    if not turns:
        for k in range(3):
            y[k] += by[k]
        return
    angle = np.sqrt(by[0] * by[0] + by[1] * by[1] + by[2] * by[2])
    part = min(1.0, LONGEST / angle) if angle > 0.0 else 1.0
    half = 0.5 * angle * part
    sine = np.sin(half) / angle if angle > 1e-300 else 0.5
    c, i, j, k = np.cos(half), sine * by[0], sine * by[1], sine * by[2]
    q0, q1, q2, q3 = y
    y[0] = c * q0 - i * q1 - j * q2 - k * q3
    y[1] = c * q1 + i * q0 + j * q3 - k * q2
    y[2] = c * q2 - i * q3 + j * q0 + k * q1
    y[3] = c * q3 + i * q2 - j * q1 + k * q0
    size = np.sqrt(y[0] * y[0] + y[1] * y[1] + y[2] * y[2] + y[3] * y[3])
    for a in range(4):
        y[a] /= size


@kernel
def solve3(h, g):
    """Solve h x = g for a symmetric positive h (3, 3) into g; False where it is singular."""
    a, b, c, d, e, f = h[0, 0], h[0, 1], h[0, 2], h[1, 1], h[1, 2], h[2, 2]
    A, B, C = d * f - e * e, c * e - b * f, b * e - c * d
    det = a * A + b * B + c * C
    if not det > 1e-300:
        return False
    x, y, z = g[0], g[1], g[2]
    g[0] = (A * x + B * y + C * z) / det
    g[1] = (B * x + (a * f - c * c) * y + (b * c - a * e) * z) / det
    g[2] = (C * x + (b * c - a * e) * y + (a * d - b * b) * z) / det
    return True


@kernel
def measure(room, f, y, hessian, pull, m):
    """The worst distance of state y at frame f in its limits; fills the quadratic (hessian (3, 3), pull (3,)) of the
    weighted squares of all distances over a small move of y. m (4, 3): scratch."""
    points, turns = room.arms.shape[1], room.turns
    arms, targets, limits = room.arms[f], room.targets[f], room.limits[f]
    carry(turns, y, m)
    worst = 0.0  # squared, in limits
    for p in range(points):
        a0, a1, a2 = arms[p, 0], arms[p, 1], arms[p, 2]
        d0 = m[0, 0] * a0 + m[0, 1] * a1 + m[0, 2] * a2 + m[3, 0] - targets[p, 0]
        d1 = m[1, 0] * a0 + m[1, 1] * a1 + m[1, 2] * a2 + m[3, 1] - targets[p, 1]
        d2 = m[2, 0] * a0 + m[2, 1] * a1 + m[2, 2] * a2 + m[3, 2] - targets[p, 2]
        off = d0 * d0 + d1 * d1 + d2 * d2
        if off > worst * limits[p] * limits[p]:
            worst = off / (limits[p] * limits[p])
    gone = apart(y, room.origin[f]) if turns else 0.0
    for a in range(1 if turns else 3):
        away = gone if turns else abs(room.origin[f, a] - y[a])
        if away > 0.0:
            worst = max(worst, (away / room.stray[f, a]) ** 2)
    focus = 1.0 / worst if 0.0 < worst < np.inf else 0.0
    h00, h01, h02, h11, h12, h22, g0, g1, g2 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for p in range(points):
        if limits[p] == np.inf or limits[p] == 0.0:
            continue
        a0, a1, a2 = arms[p, 0], arms[p, 1], arms[p, 2]
        x0 = m[0, 0] * a0 + m[0, 1] * a1 + m[0, 2] * a2
        x1 = m[1, 0] * a0 + m[1, 1] * a1 + m[1, 2] * a2
        x2 = m[2, 0] * a0 + m[2, 1] * a1 + m[2, 2] * a2
        d0, d1, d2 = targets[p, 0] - x0 - m[3, 0], targets[p, 1] - x1 - m[3, 1], targets[p, 2] - x2 - m[3, 2]
        per_limit = 1.0 / (limits[p] * limits[p])
        share = (d0 * d0 + d1 * d1 + d2 * d2) * per_limit * focus
        weight = (FOCUS + share * share) * per_limit
        if turns:
            g0 += weight * (x1 * d2 - x2 * d1)
            g1 += weight * (x2 * d0 - x0 * d2)
            g2 += weight * (x0 * d1 - x1 * d0)
            h00 += weight * (x1 * x1 + x2 * x2)
            h11 += weight * (x0 * x0 + x2 * x2)
            h22 += weight * (x0 * x0 + x1 * x1)
            h01 -= weight * x0 * x1
            h02 -= weight * x0 * x2
            h12 -= weight * x1 * x2
        else:
            g0, g1, g2 = g0 + weight * d0, g1 + weight * d1, g2 + weight * d2
            h00, h11, h22 = h00 + weight, h11 + weight, h22 + weight
    hessian[0, 0], hessian[1, 1], hessian[2, 2] = h00, h11, h22
    hessian[0, 1] = hessian[1, 0] = h01
    hessian[0, 2] = hessian[2, 0] = h02
    hessian[1, 2] = hessian[2, 1] = h12
    pull[0], pull[1], pull[2] = g0, g1, g2
    draw_back(room, f, y, gone, focus, hessian, pull, m[0])
    return np.sqrt(worst)


@kernel
def carry(turns, y, m):
    """What the state y does to its points: matrix m[:3] and shift m[3]."""
    if turns:
        matrix(y, m)
        m[3, 0], m[3, 1], m[3, 2] = 0.0, 0.0, 0.0
    else:
        m[0, 0], m[0, 1], m[0, 2] = 1.0, 0.0, 0.0
        m[1, 0], m[1, 1], m[1, 2] = 0.0, 1.0, 0.0
        m[2, 0], m[2, 1], m[2, 2] = 0.0, 0.0, 1.0
        m[3, 0], m[3, 1], m[3, 2] = y[0], y[1], y[2]


@kernel
def draw_back(room, f, y, gone, focus, hessian, pull, rotation):
    """Add to the quadratic what draws a state back to its original. gone: how far a rotation is from there, as its
    chord; rotation (3,): scratch."""
    if room.turns:
        turn_to(y, room.origin[f], rotation)
    for a in range(3):
        limit = room.stray[f, 0] if room.turns else room.stray[f, a]
        if limit == np.inf or limit == 0.0:
            continue
        away = rotation[a] if room.turns else room.origin[f, a] - y[a]
        share = (gone * gone if room.turns else away * away) * focus / (limit * limit)
        # a small turn is twice its chord
        weight = (FOCUS + share * share) / (limit * limit * (4.0 if room.turns else 1.0))
        hessian[a, a] += weight
        pull[a] += weight * away
    small = 1e-9 * (hessian[0, 0] + hessian[1, 1] + hessian[2, 2])
    for a in range(3):
        hessian[a, a] += small


@kernel
def turn_to(a, b, out):
    """Rotation vector (3,), in the parent's frame, of a small turn from a to b; of a large one its direction."""
    dot = a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3]
    side = 2.0 if dot >= 0.0 else -2.0
    out[0] = side * (a[0] * b[1] - a[1] * b[0] + a[2] * b[3] - a[3] * b[2])
    out[1] = side * (a[0] * b[2] - a[2] * b[0] + a[3] * b[1] - a[1] * b[3])
    out[2] = side * (a[0] * b[3] - a[3] * b[0] + a[1] * b[2] - a[2] * b[1])


@kernel
def refit(room, frames, values, hold_first, hold_last, sweeps, enough):
    """Draw the states of keys (K, 4) to where the worst point at any frame between them is furthest inside its limit.

    The first and last may be held; a single key at frame 0 is a constant. Stops where all is within `enough` limits,
    or where that is out of reach. Returns the worst that is left, in limits, with the best values found."""
    keys, start = len(frames), frames[0]
    alone = keys == 1
    count = len(room.inner) if alone else frames[-1] - start + 1
    lawson = np.ones(count)
    ratios = np.empty(count)
    best, kept = np.inf, values.copy()
    diagonal, beside, right = np.empty((keys, 3, 3)), np.empty((keys, 3, 3)), np.empty((keys, 3))
    hessian, pull, m = np.empty((3, 3)), np.empty(3), np.empty((4, 3))
    way, y = np.empty(4), np.empty(4)
    for sweep in range(sweeps + 1):
        diagonal[:], beside[:], right[:] = 0.0, 0.0, 0.0
        most = 0.0
        for q in range(max(keys - 1, 1)):
            a = frames[q]
            n = count if alone else frames[q + 1] - a
            if not alone and between(room.turns, values[q], values[q + 1], way) < HALF_TURN and n > 1:
                most = np.inf
            for i in range(n + 1 if q == keys - 2 else n):
                s = 0.0 if alone else i / n
                if s == 0.0:
                    y[:] = values[q]
                else:
                    along(room.turns, values[q], way, s, y)
                f = a + i
                ratio = measure(room, f, y, hessian, pull, m)
                ratios[f - start] = ratio
                most = max(most, ratio)
                weight = lawson[f - start]
                for c in range(3):
                    right[q, c] += weight * (1.0 - s) * pull[c]
                    for d in range(3):
                        diagonal[q, c, d] += weight * (1.0 - s) * (1.0 - s) * hessian[c, d]
                if s > 0.0:
                    for c in range(3):
                        right[q + 1, c] += weight * s * pull[c]
                        for d in range(3):
                            diagonal[q + 1, c, d] += weight * s * s * hessian[c, d]
                            beside[q, c, d] += weight * s * (1.0 - s) * hessian[c, d]
        if most < best:
            best = most
            kept[:] = values
        hopeless = enough > 0.0 and sweep > 0 and best > enough * (1.1 + 0.9 / sweep)
        if best <= enough or hopeless or sweep == sweeps or not most < np.inf:
            break
        mean = 0.0
        for t in range(count):
            lawson[t] *= 0.05 + ratios[t] / most
            mean += lawson[t] / count
        for t in range(count):
            lawson[t] = max(lawson[t] / mean, 1e-6)
        if hold_first:
            pin(diagonal, beside, right, 0)
        if hold_last:
            pin(diagonal, beside, right, keys - 1)
        if not solve_chain(diagonal, beside, right):
            break
        for q in range(keys):
            if not ((hold_first and q == 0) or (hold_last and q == keys - 1)):
                move(room.turns, values[q], right[q])
    values[:] = kept
    return best


@kernel
def pin(diagonal, beside, right, q):
    """Let key q stay where it is."""
    diagonal[q] = np.eye(3)
    right[q] = 0.0
    beside[q] = 0.0
    if q > 0:
        beside[q - 1] = 0.0


@kernel
def solve_chain(diagonal, beside, right):
    """Solve the block tridiagonal system in place (right (K, 3)); beside[q] joins q and q + 1. False: singular."""
    keys = len(diagonal)
    column, x = np.empty(3), np.empty(3)
    for q in range(keys - 1):
        x[:] = right[q]
        if not solve3(diagonal[q], x):
            return False
        for c in range(3):
            for d in range(3):
                right[q + 1, c] -= beside[q, d, c] * x[d]
        for c in range(3):
            column[:] = beside[q, :, c]
            solve3(diagonal[q], column)
            for d in range(3):
                for e in range(3):
                    diagonal[q + 1, d, c] -= beside[q, e, d] * column[e]
    if not solve3(diagonal[keys - 1], right[keys - 1]):
        return False
    for q in range(keys - 2, -1, -1):
        for c in range(3):
            for d in range(3):
                right[q, c] -= beside[q, c, d] * right[q + 1, d]
        if not solve3(diagonal[q], right[q]):
            return False
    return True


@kernel
def prune(room, frames, values, sweeps):
    """Take out keys that the way can do without, or put one in the middle for two. Works in frames (K,) and values
    (K, 4); returns how many keys are left at their start."""
    count, q = len(frames), 1
    kept, states, way = np.empty(2 * SPAN + 2, np.int64), np.empty((2 * SPAN + 2, 4)), np.empty(4)
    while q < count - 1:
        done = False
        for merge in range(2):
            if done or q + merge >= count - 1:
                continue
            lo, hi = max(0, q - SPAN), min(count - 1, q + merge + SPAN)
            c = 0
            for r in range(lo, hi + 1):
                if r == q and merge == 1:
                    kept[c] = (frames[q] + frames[q + 1]) // 2
                    between(room.turns, values[q], values[q + 1], way)
                    along(room.turns, values[q], way, 0.5, states[c])
                    c += 1
                elif r != q and not (merge == 1 and r == q + 1):
                    kept[c] = frames[r]
                    states[c] = values[r]
                    c += 1
            done = refit(room, kept[:c], states[:c], lo > 0, hi < count - 1, sweeps, 1.0) <= 1.0
            if not done:
                continue
            for r in range(lo, count - 1):
                if r < lo + c:
                    frames[r] = kept[r - lo]
                    values[r] = states[r - lo]
                else:
                    frames[r] = frames[r + 1]
                    values[r] = values[r + 1]
            count -= 1
        q = max(1, q - 1) if done else q + 1
    return count
