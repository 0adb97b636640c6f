"""A proven lower bound of the number of keys: a greedy partition into cubics that need not even join.

A cubic that fits a run of frames fits every part of it, so taking the longest run each time needs the fewest pieces.
Whether a cubic fits is decided by Remez' exchange: five frames whose levelled error exceeds their half-widths prove
that none does (de la Vallée Poussin).
"""

from __future__ import annotations

import numpy as np

from .._jit import kernel

CERTAIN = (
    1.0 + 1e-9
)  # levelled error, in half-widths, from which a contradiction is believed: rounding may only weaken the bound
EXCHANGES = 60  # more for one frame are rounding, and the frame is let pass


@kernel(fastmath=True)
def level(at: np.ndarray, y: np.ndarray, half: np.ndarray, base: float, newton: np.ndarray) -> float:
    """Cubic of equal errors, signs alternating, on five frames, in Newton's form. Returns the first, in half-widths."""
    total = weight = 0.0
    for k in range(5):
        w = 1.0
        for m in range(5):
            if m != k:
                w *= at[k] - at[m]
        total += (y[at[k]] - base) / w
        weight += half[at[k]] / abs(w)
    error = total / weight
    for k in range(4):
        newton[k] = y[at[k]] - base - (error if k % 2 == 0 else -error) * half[at[k]]
    for order in range(1, 4):
        for k in range(3, order - 1, -1):
            newton[k] = (newton[k] - newton[k - 1]) / (at[k] - at[k - order])
    return error


@kernel(fastmath=True)
def newton_error(f: int, at: np.ndarray, y: np.ndarray, base: float, newton: np.ndarray) -> float:
    """y - cubic at frame f."""
    return y[f] - base - newton[0] - (f - at[0]) * (newton[1] + (f - at[1]) * (newton[2] + (f - at[2]) * newton[3]))


@kernel
def exchange(at: np.ndarray, f: int, sign: float, first_sign: float) -> bool:
    """Put frame f, where the error has `sign`, among the five, signs still alternating. False if it is one of them."""
    if f < at[0]:
        if sign != first_sign:
            for k in range(4, 0, -1):
                at[k] = at[k - 1]
        at[0] = f
        return True
    if f > at[4]:
        if sign != first_sign:  # the fifth frame has the sign of the first
            for k in range(4):
                at[k] = at[k + 1]
        at[4] = f
        return True
    k = 0
    while at[k + 1] < f:
        k += 1
    if f == at[k] or f == at[k + 1]:
        return False
    at[k if sign == (first_sign if k % 2 == 0 else -first_sign) else k + 1] = f
    return True


@kernel(fastmath=True)
def piece_end(y: np.ndarray, half: np.ndarray, i: int, last: int) -> int:
    """Last frame <= `last` up to which one cubic fits from frame i."""
    if i + 4 > last:
        return last
    base = y[i]
    at, newton = np.arange(i, i + 5), np.empty(4)
    error = level(at, y, half, base, newton)
    if abs(error) > CERTAIN:
        return i + 3
    end = i + 4  # the cubic fits up to here
    while end < last:
        end += 1
        f, e = end, newton_error(end, at, y, base, newton)
        if abs(e) <= half[end]:
            continue
        for _ in range(EXCHANGES):
            if not exchange(at, f, 1.0 if e > 0.0 else -1.0, 1.0 if error >= 0.0 else -1.0):
                break
            error = level(at, y, half, base, newton)
            if abs(error) > CERTAIN:
                return end - 1
            worst, f = 0.0, -1
            for g in range(i, end + 1):
                over = abs(newton_error(g, at, y, base, newton)) - half[g]
                if over > worst:
                    worst, f = over, g
            if f < 0:
                break
            e = newton_error(f, at, y, base, newton)
    return last


@kernel
def constant_fits(y: np.ndarray, half: np.ndarray) -> bool:
    """Is there a value within half of y at every frame?"""
    low, high = -np.inf, np.inf
    for f in range(len(y)):
        low, high = max(low, y[f] - half[f]), min(high, y[f] + half[f])
    return low <= high


@kernel
def pieces(middle: np.ndarray, half: np.ndarray) -> int:
    """Fewest runs of frames, neighbours sharing a frame, each of which has a fitting cubic for every member."""
    i, count, last = 0, 0, middle.shape[1] - 1
    while i < last:
        end = last
        for m in range(middle.shape[0]):
            end = piece_end(middle[m], half[m], i, end)
        i = end
        count += 1
    return count


@kernel
def bound(middle: np.ndarray, half: np.ndarray) -> int:
    """The bound for C-order float64 arrays."""
    constant = True
    for m in range(middle.shape[0]):
        constant = constant and constant_fits(middle[m], half[m])
    return 1 if constant else pieces(middle, half) + 1


def lower_bound(middle: np.ndarray, half: np.ndarray) -> int:
    """Fewest keys, of one member, of any piecewise cubic with |curve - middle| <= half (M, F) and keys on frames."""
    return int(bound(np.ascontiguousarray(middle), np.ascontiguousarray(half)))
