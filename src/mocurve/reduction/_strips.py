"""Linear programs over the cubics of one segment: how far can they go, and in which states can they end?

A cubic that leaves frame i is p = c0 + c1 t + c2 t^2 + c3 t^3 with t = (frame - i) / span, counted from middle[i]. Every demand on it is a strip
|row . c - centre| <= half: one strip per frame, and one per edge of the polygon of states in which it may start (across the polygon's width).

A dual simplex keeps four strips as its basis; as every strip has two sides, the sign of its multiplier tells on which side it lies, so any
four independent strips are a dual feasible start, for any objective: no first phase, and turning the objective keeps the basis.
"""

from __future__ import annotations

import numpy as np

from .._jit import kernel

PIVOTS = 60  # an objective that takes more is given up: counted as out of reach, which costs keys but breaks nothing
SLACK = 1e-9  # a strip may be exceeded by this part of its half-width


@kernel
def new_program(corners):
    """Room for one program: strips in the basis (frame, or -1 - edge), their sides, multipliers, the inverse of their rows, the cubic; edges."""
    ids, side, multiplier = np.empty(4, np.int64), np.empty(4), np.empty(4)
    return ids, side, multiplier, np.empty((4, 4)), np.empty(4), np.empty((corners, 4))


@kernel(fastmath=True)
def start_strips(polygon, count, span, edges):
    """Strips (normal, centre, half) of the edges of a polygon of states (value, slope per frame), slopes counted per span."""
    for a in range(count):
        b = a + 1 if a + 1 < count else 0
        nx = (polygon[b, 1] - polygon[a, 1]) * span
        ny = polygon[a, 0] - polygon[b, 0]
        low = high = nx * polygon[a, 0] + ny * polygon[a, 1] * span
        for c in range(count):
            w = nx * polygon[c, 0] + ny * polygon[c, 1] * span
            low = min(low, w)
            high = max(high, w)
        scale = 1.0 / (abs(nx) + abs(ny))
        edges[a, 0] = nx * scale
        edges[a, 1] = ny * scale
        edges[a, 2] = 0.5 * (low + high) * scale
        edges[a, 3] = 0.5 * (high - low) * scale


@kernel(fastmath=True)
def start_basis(program, count, i, j, span):
    """First basis: two edges of the start polygon, the least parallel pair with edge 0, and the frames half way to j and j."""
    ids, _, _, inverse, _, edges = program
    other, most = 1, 0.0
    for a in range(1, count):
        cross = abs(edges[0, 0] * edges[a, 1] - edges[0, 1] * edges[a, 0])
        if cross > most:
            other, most = a, cross
    ids[0], ids[1], ids[2], ids[3] = -1, -1 - other, (i + j) // 2, j
    a, b, c, d = edges[0, 0], edges[0, 1], edges[other, 0], edges[other, 1]
    det = a * d - b * c
    a, b, c, d = d / det, -b / det, -c / det, a / det  # inverse of the two edges
    p, q = (ids[2] - i) / span, (j - i) / span
    det = 1.0 / (p * p * q * q * (q - p))
    e, f, g, h = q * q * q * det, -p * p * p * det, -q * q * det, p * p * det  # inverse of ((p², p³), (q², q³))
    inverse[0, 0], inverse[0, 1], inverse[0, 2], inverse[0, 3] = a, b, 0.0, 0.0
    inverse[1, 0], inverse[1, 1], inverse[1, 2], inverse[1, 3] = c, d, 0.0, 0.0
    s, t, u, v = a + p * c, b + p * d, a + q * c, b + q * d
    inverse[2, 0], inverse[2, 1], inverse[2, 2], inverse[2, 3] = -e * s - f * u, -e * t - f * v, e, f
    inverse[3, 0], inverse[3, 1], inverse[3, 2], inverse[3, 3] = -g * s - h * u, -g * t - h * v, g, h


@kernel(fastmath=True)
def strip(k, edges, y, half, i, per_span):
    """Row, centre and half-width of strip k."""
    if k < 0:
        return edges[-1 - k, 0], edges[-1 - k, 1], 0.0, 0.0, edges[-1 - k, 2], edges[-1 - k, 3]
    t = (k - i) * per_span
    return 1.0, t, t * t, t * t * t, y[k] - y[i], half[k]


@kernel(fastmath=True)
def place(program, y, half, i, per_span):
    """The cubic in which the four strips of the basis meet, each at its side."""
    ids, side, _, inverse, x, edges = program
    x0 = x1 = x2 = x3 = 0.0
    for k in range(4):
        _, _, _, _, centre, width = strip(ids[k], edges, y, half, i, per_span)
        b = centre + side[k] * width
        x0 += inverse[0, k] * b
        x1 += inverse[1, k] * b
        x2 += inverse[2, k] * b
        x3 += inverse[3, k] * b
    x[0], x[1], x[2], x[3] = x0, x1, x2, x3


@kernel(fastmath=True)
def most_broken(program, count, y, half, i, j, per_span):
    """The strip that the cubic exceeds most (in value), and by how much: above if positive, below if negative; 0.0 if all hold."""
    x, edges = program[4], program[5]
    x0, x1, x2, x3 = x[0], x[1], x[2], x[3]
    base = x0 + y[i]
    worst, at, excess = 0.0, 0, 0.0
    for f in range(i + 1, j + 1):
        t = (f - i) * per_span
        e = base - y[f] + t * (x1 + t * (x2 + t * x3))
        over = abs(e) - half[f] * (1.0 + SLACK)
        if over > worst:
            worst, at, excess = over, f, e
    for a in range(count):
        e = edges[a, 0] * x0 + edges[a, 1] * x1 - edges[a, 2]
        over = abs(e) - edges[a, 3] * (1.0 + SLACK)
        if over > worst:
            worst, at, excess = over, -1 - a, e
    return at, worst if excess > 0.0 else -worst


@kernel(fastmath=True)
def exchange(program, k, excess, y, half, i, per_span):
    """Bring strip k into the basis (long-step ratio test). False: the basis and k contradict each other, so no cubic satisfies all five."""
    ids, side, multiplier, inverse, _, edges = program
    r0, r1, r2, r3, _, _ = strip(k, edges, y, half, i, per_span)
    a0 = r0 * inverse[0, 0] + r1 * inverse[1, 0] + r2 * inverse[2, 0] + r3 * inverse[3, 0]
    a1 = r0 * inverse[0, 1] + r1 * inverse[1, 1] + r2 * inverse[2, 1] + r3 * inverse[3, 1]
    a2 = r0 * inverse[0, 2] + r1 * inverse[1, 2] + r2 * inverse[2, 2] + r3 * inverse[3, 2]
    a3 = r0 * inverse[0, 3] + r1 * inverse[1, 3] + r2 * inverse[2, 3] + r3 * inverse[3, 3]
    alpha = (a0, a1, a2, a3)  # the strip's row = sum of alpha x rows of the basis
    sign = 1.0 if excess > 0.0 else -1.0
    left = abs(excess)
    passed = -1.0
    while True:
        # The next strip whose multiplier comes to zero; strips passed on the way change sides.
        out, ratio = -1, 1e300
        for a in range(4):
            if sign * alpha[a] * side[a] > 1e-12:
                r = abs(multiplier[a] / alpha[a])
                if r < ratio:
                    out, ratio = a, r
        if out < 0:
            return False
        passed = max(passed, ratio)
        _, _, _, _, _, width = strip(ids[out], edges, y, half, i, per_span)
        left -= 2.0 * width * abs(alpha[out])
        if left <= 0.0:
            break
        side[out] = -side[out]
    for a in range(4):
        multiplier[a] -= sign * passed * alpha[a]
    pivot = 1.0 / alpha[out]
    for r in range(4):
        w = inverse[r, out] * pivot
        for a in range(4):
            inverse[r, a] -= w * alpha[a]
        inverse[r, out] = w
    ids[out], side[out], multiplier[out] = k, sign, sign * passed
    return True


@kernel(fastmath=True)
def maximise(program, count, y, half, i, j, per_span, dv, dm):
    """Turn to the objective dv * end value + dm * end slope at frame j and solve. Returns 0 if solved, else a frame that cannot be reached."""
    ids, side, multiplier, inverse, _, _ = program
    t = (j - i) * per_span
    c0, c1, c2, c3 = dv, dv * t + dm, t * (dv * t + 2.0 * dm), t * t * (dv * t + 3.0 * dm)
    for a in range(4):
        w = c0 * inverse[0, a] + c1 * inverse[1, a] + c2 * inverse[2, a] + c3 * inverse[3, a]
        multiplier[a] = w
        side[a] = 1.0 if w >= 0.0 else -1.0
    for _ in range(PIVOTS):
        place(program, y, half, i, per_span)
        k, excess = most_broken(program, count, y, half, i, j, per_span)
        if excess == 0.0:
            return 0
        if not exchange(program, k, excess, y, half, i, per_span):
            return max(max(ids[0], ids[1]), max(ids[2], max(ids[3], k)))
    return j


@kernel(fastmath=True)
def furthest(program, polygon, count, y, half, i, known, last, guess):
    """Last frame <= `last` that a cubic from the polygon at frame i can reach; `known` if that is no further."""
    edges, x = program[5], program[4]
    step = 2
    j = max(i + 2, max(known + 1, min(guess, last)))
    end = last + 1
    span = 0.0
    while known + 1 < end:
        if j - i > 3.0 * span:
            span = float(j - i)
            start_strips(polygon, count, span, edges)
            start_basis(program, count, i, j, span)
        stop = maximise(program, count, y, half, i, j, 1.0 / span, 1.0, 0.0)
        if stop > 0:
            end = min(j, stop)
            span = 0.0
            j = (known + end) // 2
        else:
            known = j
            while known + 1 < end:  # the same cubic may hold for more frames
                t = (known + 1 - i) / span
                if abs(x[0] + t * (x[1] + t * (x[2] + t * x[3])) + y[i] - y[known + 1]) > half[known + 1]:
                    break
                known += 1
            j = min(known + step, (known + end) // 2)
            step *= 2
        j = max(j, max(known + 1, i + 2))
    return known
