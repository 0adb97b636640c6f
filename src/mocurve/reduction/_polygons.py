"""Convex polygons of key states (value, slope), counterclockwise, in the first rows of arrays (CORNERS, 2)."""

from __future__ import annotations

import numpy as np

from .._jit import kernel

CORNERS = 16  # room of a polygon
KEPT = 14  # corners kept after a clip: long flat channels pile up nearly equal ones


@kernel(fastmath=True)
def area(polygon: np.ndarray, size: int) -> float:
    """Area, by triangles from the first corner."""
    total = 0.0
    for k in range(1, size - 1):
        total += (polygon[k, 0] - polygon[0, 0]) * (polygon[k + 1, 1] - polygon[0, 1])
        total -= (polygon[k, 1] - polygon[0, 1]) * (polygon[k + 1, 0] - polygon[0, 0])
    return 0.5 * total


@kernel(fastmath=True)
def centre(polygon: np.ndarray, size: int) -> tuple[float, float]:
    """Mean of the corners: inside, away from all edges."""
    x = y = 0.0
    for k in range(size):
        x += polygon[k, 0]
        y += polygon[k, 1]
    return x / size, y / size


@kernel
def copy(polygon: np.ndarray, size: int, out: np.ndarray) -> None:
    """Copy the corners."""
    for k in range(size):
        out[k, 0], out[k, 1] = polygon[k, 0], polygon[k, 1]


@kernel(fastmath=True)
def drop_corner(polygon: np.ndarray, size: int) -> int:
    """Leave out the corner that costs least area. Returns the corners left."""
    least, at = np.inf, 0
    for a in range(size):
        b, c = (a if a > 0 else size) - 1, a + 1 if a + 1 < size else 0
        dx, dy = polygon[a, 0] - polygon[b, 0], polygon[a, 1] - polygon[b, 1]
        lost = abs(dx * (polygon[c, 1] - polygon[b, 1]) - dy * (polygon[c, 0] - polygon[b, 0]))
        if lost < least:
            least, at = lost, a
    for a in range(at, size - 1):
        polygon[a, 0], polygon[a, 1] = polygon[a + 1, 0], polygon[a + 1, 1]
    return size - 1


@kernel(fastmath=True)
def clip(polygon: np.ndarray, size: int, base: float, p: float, q: float, half: float, spare: np.ndarray) -> int:
    """Clip in place to |base + p value + q slope| <= half. Returns the corners left; spare (2 CORNERS, 2)."""
    low, high = np.inf, -np.inf
    for k in range(size):
        w = base + p * polygon[k, 0] + q * polygon[k, 1]
        low, high = min(low, w), max(high, w)
    if high <= half and low >= -half:
        return size
    for sign in (1.0, -1.0):
        n = 0
        x, y = polygon[size - 1, 0], polygon[size - 1, 1]
        before = sign * (base + p * x + q * y)
        for k in range(size):
            w = sign * (base + p * polygon[k, 0] + q * polygon[k, 1])
            if (w <= half) != (before <= half):
                t = (half - before) / (w - before)
                spare[n, 0], spare[n, 1] = x + (polygon[k, 0] - x) * t, y + (polygon[k, 1] - y) * t
                n += 1
            x, y, before = polygon[k, 0], polygon[k, 1], w
            if w <= half:
                spare[n, 0], spare[n, 1] = x, y
                n += 1
        while n > KEPT:
            n = drop_corner(spare, n)
        for k in range(n):
            polygon[k, 0], polygon[k, 1] = spare[k, 0], spare[k, 1]
        size = n
        if size == 0:
            break
    return size
