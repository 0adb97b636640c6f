"""Linear programs over the cubics of one segment: how far can they go, and in which states can they end?

A cubic that leaves frame i is p = c0 + c1 t + c2 t² + c3 t³ with t = (frame - i) / span, counted from y[i]. Every
demand on it is a strip |row . c - centre| <= half: one per frame, and one per edge of the polygon of states in which it
may start (across the polygon's width).

A dual simplex keeps four strips as its basis. As every strip has two sides, the sign of its multiplier tells on which
side it lies: any four independent strips are dual feasible for any objective. So there is no first phase, and the basis
stays when the objective turns or frames are added.
"""

from __future__ import annotations

import numpy as np

from .._jit import kernel

PIVOTS = 60  # an objective that takes more is given up: counted as out of reach, which costs keys but breaks nothing
SLACK = 1e-9  # a strip may be exceeded by this part of its half-width

# Rows of a program (one array, as unpacking several costs more than the arithmetic). Of the four strips in the basis:
ID = 0  # frame, or -1 - edge
SIDE = 1  # +1 upper, -1 lower
MULTIPLIER = 2
CENTRE = 3
HALF = 4
CUBIC = 5  # where the four strips meet
INVERSE = 6  # 4 rows: the inverse of the matrix of their rows
ROUNDING = 10  # what rounding may add to an error
EDGES = 11  # from here, one row for each edge of the start polygon: normal, centre, half


@kernel
def new_program(corners: int, rounding: float) -> np.ndarray:
    """Room for a program that starts from polygons of up to `corners` corners."""
    lp = np.empty((EDGES + corners, 4))
    lp[ROUNDING, 0] = rounding
    return lp


@kernel(fastmath=True)
def start_strips(lp: np.ndarray, polygon: np.ndarray, count: int, span: float) -> None:
    """Strips of the edges of a polygon of states (value from y[i], slope per frame); theirs have slopes per span."""
    for a in range(count):
        b = a + 1 if a + 1 < count else 0
        nx = (polygon[b, 1] - polygon[a, 1]) * span
        ny = polygon[a, 0] - polygon[b, 0]
        scale = 1.0 / (abs(nx) + abs(ny))
        nx, ny = nx * scale, ny * scale
        low = high = nx * polygon[a, 0] + ny * polygon[a, 1] * span
        for c in range(count):
            w = nx * polygon[c, 0] + ny * polygon[c, 1] * span
            low = min(low, w)
            high = max(high, w)
        lp[EDGES + a, 0], lp[EDGES + a, 1] = nx, ny
        lp[EDGES + a, 2], lp[EDGES + a, 3] = 0.5 * (low + high), 0.5 * (high - low)


@kernel(fastmath=True)
def start_basis(lp: np.ndarray, count: int, y: np.ndarray, half: np.ndarray, i: int, j: int, span: float) -> None:
    """First basis: edge 0, the edge least parallel to it, the frames half way to j and j."""
    other, most = 1, 0.0
    for a in range(1, count):
        cross = abs(lp[EDGES, 0] * lp[EDGES + a, 1] - lp[EDGES, 1] * lp[EDGES + a, 0])
        if cross > most:
            other, most = a, cross
    mid = (i + j) // 2
    lp[ID, 0], lp[ID, 1], lp[ID, 2], lp[ID, 3] = -1, -1 - other, mid, j
    lp[CENTRE, 0], lp[CENTRE, 1], lp[CENTRE, 2], lp[CENTRE, 3] = (
        lp[EDGES, 2],
        lp[EDGES + other, 2],
        y[mid] - y[i],
        y[j] - y[i],
    )
    lp[HALF, 0], lp[HALF, 1], lp[HALF, 2], lp[HALF, 3] = lp[EDGES, 3], lp[EDGES + other, 3], half[mid], half[j]
    a, b, c, d = lp[EDGES, 0], lp[EDGES, 1], lp[EDGES + other, 0], lp[EDGES + other, 1]
    det = 1.0 / (a * d - b * c)
    a, b, c, d = d * det, -b * det, -c * det, a * det  # inverse of the edges' rows
    p, q = (mid - i) / span, (j - i) / span
    det = 1.0 / (p * p * q * q * (q - p))
    e, f, g, h = q * q * q * det, -p * p * p * det, -q * q * det, p * p * det  # inverse of ((p², p³), (q², q³))
    lp[INVERSE, 0], lp[INVERSE, 1], lp[INVERSE, 2], lp[INVERSE, 3] = a, b, 0.0, 0.0
    lp[INVERSE + 1, 0], lp[INVERSE + 1, 1], lp[INVERSE + 1, 2], lp[INVERSE + 1, 3] = c, d, 0.0, 0.0
    s, t, u, v = a + p * c, b + p * d, a + q * c, b + q * d
    lp[INVERSE + 2, 0], lp[INVERSE + 2, 1], lp[INVERSE + 2, 2], lp[INVERSE + 2, 3] = (
        -e * s - f * u,
        -e * t - f * v,
        e,
        f,
    )
    lp[INVERSE + 3, 0], lp[INVERSE + 3, 1], lp[INVERSE + 3, 2], lp[INVERSE + 3, 3] = (
        -g * s - h * u,
        -g * t - h * v,
        g,
        h,
    )


@kernel(fastmath=True)
def place(lp: np.ndarray) -> None:
    """The cubic in which the four strips of the basis meet, each at its side."""
    b0 = lp[CENTRE, 0] + lp[SIDE, 0] * lp[HALF, 0]
    b1 = lp[CENTRE, 1] + lp[SIDE, 1] * lp[HALF, 1]
    b2 = lp[CENTRE, 2] + lp[SIDE, 2] * lp[HALF, 2]
    b3 = lp[CENTRE, 3] + lp[SIDE, 3] * lp[HALF, 3]
    for r in range(4):
        a = INVERSE + r
        lp[CUBIC, r] = lp[a, 0] * b0 + lp[a, 1] * b1 + lp[a, 2] * b2 + lp[a, 3] * b3


@kernel(fastmath=True)
def most_broken(
    lp: np.ndarray, count: int, y: np.ndarray, half: np.ndarray, i: int, j: int, per_span: float
) -> tuple[int, float]:
    """The strip that the cubic exceeds most (in value), and its signed error there; 0.0 if all hold."""
    x0, x1, x2, x3 = lp[CUBIC, 0], lp[CUBIC, 1], lp[CUBIC, 2], lp[CUBIC, 3]
    base = x0 + y[i]
    worst, at, error = lp[ROUNDING, 0], 0, 0.0
    for f in range(i + 1, j + 1):
        t = (f - i) * per_span
        e = base - y[f] + t * (x1 + t * (x2 + t * x3))
        over = abs(e) - half[f] * (1.0 + SLACK)
        if over > worst:
            worst, at, error = over, f, e
    for a in range(count):
        e = lp[EDGES + a, 0] * x0 + lp[EDGES + a, 1] * x1 - lp[EDGES + a, 2]
        over = abs(e) - lp[EDGES + a, 3] * (1.0 + SLACK)
        if over > worst:
            worst, at, error = over, -1 - a, e
    return at, 0.0 if error == 0.0 else worst if error > 0.0 else -worst


@kernel(fastmath=True)
def exchange(lp: np.ndarray, k: int, excess: float, y: np.ndarray, half: np.ndarray, i: int, per_span: float) -> bool:
    """Bring strip k into the basis (long-step ratio test). False: no cubic satisfies it and the four."""
    if k < 0:
        r0, r1, r2, r3 = lp[EDGES - 1 - k, 0], lp[EDGES - 1 - k, 1], 0.0, 0.0
        centre, width = lp[EDGES - 1 - k, 2], lp[EDGES - 1 - k, 3]
    else:
        t = (k - i) * per_span
        r0, r1, r2, r3 = 1.0, t, t * t, t * t * t
        centre, width = y[k] - y[i], half[k]
    sign = 1.0 if excess > 0.0 else -1.0
    left = abs(excess)
    alpha = lp[CUBIC]  # the row of k = sum of alpha x rows of the basis; kept where the cubic was, which is placed anew
    for a in range(4):
        alpha[a] = r0 * lp[INVERSE, a] + r1 * lp[INVERSE + 1, a] + r2 * lp[INVERSE + 2, a] + r3 * lp[INVERSE + 3, a]
    while True:  # the next strip whose multiplier comes to zero leaves; those that the step may pass change sides
        out, step = -1, 1e300
        for a in range(4):
            if sign * alpha[a] * lp[SIDE, a] > 1e-12:
                ratio = abs(lp[MULTIPLIER, a] / alpha[a])
                if ratio < step:
                    out, step = a, ratio
        if out < 0:
            return False
        left -= 2.0 * lp[HALF, out] * abs(alpha[out])
        if left <= 0.0:
            break
        lp[SIDE, out] = -lp[SIDE, out]
    pivot = 1.0 / alpha[out]
    for a in range(4):
        lp[MULTIPLIER, a] -= sign * step * alpha[a]
    for r in range(INVERSE, INVERSE + 4):
        w = lp[r, out] * pivot
        for a in range(4):
            lp[r, a] -= w * alpha[a]
        lp[r, out] = w
    lp[ID, out], lp[SIDE, out], lp[MULTIPLIER, out], lp[CENTRE, out], lp[HALF, out] = (
        k,
        sign,
        sign * step,
        centre,
        width,
    )
    return True


@kernel(fastmath=True)
def aim(lp: np.ndarray, t: float, dv: float, dm: float) -> None:
    """Turn to the objective dv * value + dm * slope (per span) at the time t (in spans)."""
    c0, c1, c2, c3 = dv, dv * t + dm, t * (dv * t + 2.0 * dm), t * t * (dv * t + 3.0 * dm)
    for a in range(4):
        w = c0 * lp[INVERSE, a] + c1 * lp[INVERSE + 1, a] + c2 * lp[INVERSE + 2, a] + c3 * lp[INVERSE + 3, a]
        lp[MULTIPLIER, a] = w
        lp[SIDE, a] = 1.0 if w >= 0.0 else -1.0


@kernel(fastmath=True)
def solve(lp: np.ndarray, count: int, y: np.ndarray, half: np.ndarray, i: int, j: int, per_span: float) -> int:
    """Pivot until all frames to j hold. Returns 0, or a frame that no cubic from the start polygon can reach."""
    for _ in range(PIVOTS):
        place(lp)
        k, excess = most_broken(lp, count, y, half, i, j, per_span)
        if excess == 0.0:
            return 0
        if not exchange(lp, k, excess, y, half, i, per_span):
            return max(k, int(max(max(lp[ID, 0], lp[ID, 1]), max(lp[ID, 2], lp[ID, 3]))))
    return j


@kernel(fastmath=True)
def furthest(
    lp: np.ndarray,
    polygon: np.ndarray,
    count: int,
    y: np.ndarray,
    half: np.ndarray,
    i: int,
    known: int,
    last: int,
    guess: int,
) -> int:
    """Last frame <= `last` that a cubic from the polygon at frame i can reach; `known` if that is no further."""
    step = 2
    j = max(i + 2, max(known + 1, min(guess, last)))
    end = last + 1
    span = 0.0
    while known + 1 < end:
        if j - i > 3.0 * span:
            span = float(j - i)
            start_strips(lp, polygon, count, span)
            start_basis(lp, count, y, half, i, j, span)
            aim(lp, 1.0, 1.0, 0.0)
        stop = solve(lp, count, y, half, i, j, 1.0 / span)
        if stop > 0:
            end = min(j, stop)
            span = 0.0
            j = (known + end) // 2
        else:
            known = j
            while known + 1 < end:  # the same cubic may hold for more frames
                t = (known + 1 - i) / span
                p = lp[CUBIC, 0] + t * (lp[CUBIC, 1] + t * (lp[CUBIC, 2] + t * lp[CUBIC, 3]))
                if abs(p + y[i] - y[known + 1]) > half[known + 1]:
                    break
                known += 1
            j = min(known + step, (known + end) // 2)
            step *= 2
        j = max(j, max(known + 1, i + 2))
    return known
