"""The part of the Blender script that turns Hermite curves into the keys of an F-curve, and edited keys back. It needs
no Blender.

SPDX-License-Identifier: MIT
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ._blender_maths import SHORTEST, STEP, Curve

# --- part of the script ---
KINDS = ("CONSTANT", "LINEAR", "BEZIER")  # of the piece that follows a key


class Keys(NamedTuple):
    """Keys of an F-curve: points (K, 3, 2) float32, left handle, key and right handle, each (frame, value); the kind of
    the piece after each key; smooth (K,): its two handles are held in line."""

    points: np.ndarray
    kinds: list[str]
    smooth: np.ndarray


def keys_of(curve: Curve, kind: str) -> Keys:
    """Handles at a third of the interval: there a Bézier curve is the Hermite curve."""
    third = np.diff(curve.frames) / 3.0 if len(curve.frames) > 1 else np.ones(1)
    key, ones = np.column_stack([curve.frames, curve.values]), np.ones(len(curve.frames))
    before = key - np.column_stack([ones, curve.arriving]) * np.append(third[0], third)[: len(key), None]
    after = key + np.column_stack([ones, curve.leaving]) * np.append(third, third[-1])[: len(key), None]
    if len(key) > 1:
        _take_back_rounding(curve, after[:-1], before[1:])
    apart = np.abs(curve.leaving - curve.arriving) > 1e-6 * (np.abs(curve.leaving) + np.abs(curve.arriving)) + 1e-12
    return Keys(np.stack([before, key, after], axis=1).astype(np.float32), [kind] * len(key), ~apart)


def _take_back_rounding(curve: Curve, first: np.ndarray, second: np.ndarray) -> None:
    """Change the values of handles (K-1, 2), the two of each piece, since their frames will be rounded to 32 bits.

    A handle that moves by d in time moves the curve by its rate times d times the handle's weight, one that moves by v
    in value moves it by v times the weight: these v are the least squares over the piece.
    """
    s = np.arange(1, 16) / 16.0
    weights = 3.0 * s * (1.0 - s) * np.stack([1.0 - s, s])  # (2, 15)
    h = np.diff(curve.frames)
    start, end = curve.leaving[:-1], curve.arriving[1:]
    middle = 3.0 * np.diff(curve.values) / h - start - end
    rates = start[:, None] * (1.0 - s) ** 2 + middle[:, None] * 2.0 * s * (1.0 - s) + end[:, None] * s * s
    moved = [handle[:, :1].astype(np.float32) - handle[:, :1] for handle in (first, second)]
    back = (rates * (moved[0] * weights[0] + moved[1] * weights[1])) @ np.linalg.pinv(weights)
    first[:, 1] += back[:, 0]
    second[:, 1] += back[:, 1]


def same_keys(a: Keys, b: Keys) -> bool:
    """The same but for the last digits of handles, which Blender rounds when it puts them in line."""
    return (
        a.points.shape == b.points.shape
        and a.kinds == b.kinds
        and np.array_equal(a.points[:, 1], b.points[:, 1])
        and bool(_same_handles(a.points, b.points).all())
    )


def curve_of(keys: Keys, tolerance: float) -> tuple[Curve, np.ndarray]:
    """The Hermite curve of an F-curve, within `tolerance` of it, and the number (K',) of the key that each of its keys
    was, -1 where one was put in: a piece whose handles were moved in time is no cubic function of it."""
    points = keys.points.astype(np.float64)
    knots = [[*points[0, 1], _rate(points[0, 1], points[0, 2]), _rate(points[0, 0], points[0, 1]), 0.0]]
    for k in range(len(points) - 1):
        here, there = points[k], points[k + 1]
        leaving, inner, arriving = _piece(here, there, keys.kinds[k], tolerance)
        knots[-1][2] = leaving
        knots += [[*knot, -1.0] for knot in inner]
        knots.append([*there[1], _rate(there[1], there[2]), arriving, k + 1.0])
    frames, values, rates, arrivals, source = np.array(knots).T
    return Curve(frames, values, rates, arrivals), source.astype(int)


Knot = tuple[float, float, float, float]  # frame, value, rates leaving and arriving


def _piece(here: np.ndarray, there: np.ndarray, kind: str, tolerance: float) -> tuple[float, list[Knot], float]:
    """Rate at its start, knots within, rate at its end, of a piece between two keys (3, 2)."""
    (x0, y0), (x1, y1) = here[1], there[1]
    if kind == "LINEAR" or x1 <= x0:
        slope = (y1 - y0) / (x1 - x0) if x1 > x0 else 0.0
        return slope, [], slope
    if kind == "CONSTANT":
        last = x1 - min(STEP, 0.5 * (x1 - x0))
        slope = (y1 - y0) / (x1 - last)
        return 0.0, [(last, y0, slope, 0.0)], slope
    parts = _split(_bezier(here, there), tolerance)
    ends = [_end_rates(part) for part in parts]
    inner = [
        (float(part[0, 0]), float(part[0, 1]), after[0], before[1])
        for part, before, after in zip(parts[1:], ends, ends[1:], strict=False)
    ]
    return ends[0][0], inner, ends[-1][1]


def _bezier(here: np.ndarray, there: np.ndarray) -> np.ndarray:
    """The four points (4, 2) that Blender evaluates: no handle reaches beyond the other key in time. A handle that is
    at a third but for the rounding to 32 bits is put there."""
    b = np.array([here[1], here[2], there[0], there[1]])
    span = b[3, 0] - b[0, 0]
    rounding = 2.0 * float(np.spacing(np.float32(np.abs(b[:, 0]).max())))
    for end, handle, side in ((0, 1, 1.0), (3, 2, -1.0)):
        reach = side * (b[handle, 0] - b[end, 0])
        if reach > span:
            b[handle] = b[end] + (b[handle] - b[end]) * (span / reach)
        elif reach < 0:
            b[handle, 0] = b[end, 0]
        elif abs(reach - span / 3.0) <= rounding:
            b[handle] = b[end] + (b[handle] - b[end]) * (span / 3.0 / reach)
    return b


def _split(b: np.ndarray, tolerance: float) -> list[np.ndarray]:
    """Pieces (4, 2) of a Bézier curve, each near enough to the Hermite curve of its end points and end rates."""
    if b[3, 0] - b[0, 0] < 2.0 * SHORTEST or _misfit(b) <= tolerance:
        return [b]
    halves: list[list[np.ndarray]] = [[b[0]], [b[3]]]
    level = b
    for _ in range(3):  # de Casteljau
        level = 0.5 * (level[:-1] + level[1:])
        halves[0].append(level[0])
        halves[1].insert(0, level[-1])
    return [part for half in halves for part in _split(np.array(half), tolerance)]


def _misfit(b: np.ndarray) -> float:
    s = np.arange(1, 16)[:, None] / 16.0
    x, y = ((1 - s) ** 3 * b[0] + 3 * s * (1 - s) ** 2 * b[1] + 3 * s * s * (1 - s) * b[2] + s**3 * b[3]).T
    span, (m0, m1) = b[3, 0] - b[0, 0], _end_rates(b)
    u = (x - b[0, 0]) / span
    made = b[0, 1] + (b[3, 1] - b[0, 1]) * u * u * (3 - 2 * u) + span * u * (1 - u) * ((1 - u) * m0 - u * m1)
    return float(np.abs(made - y).max())


def _end_rates(b: np.ndarray) -> tuple[float, float]:
    """A handle of no length leaves the direction to the next point."""
    start = next((p for p in b[1:] if np.abs(p - b[0]).max() > 0), b[3])
    end = next((p for p in b[2::-1] if np.abs(p - b[3]).max() > 0), b[0])
    return _rate(b[0], start, b[3, 0] - b[0, 0]), _rate(end, b[3], b[3, 0] - b[0, 0])


def _rate(a: np.ndarray, b: np.ndarray, span: float = 1.0) -> float:
    """Value per frame from a to b; steep, but finite, where both are at the same frame."""
    return float((b[1] - a[1]) / max(b[0] - a[0], 1e-4 * span))


# -- keys that nobody touched ------------------------------------------------------------------------
def restored(curve: Curve, source: np.ndarray, keys: Keys, given: Keys, original: Curve) -> Curve:
    """The curve with the numbers of the original, all 64 bits of them, wherever the keys are still those `given`.

    curve, source: what curve_of makes of the keys. given: the keys as the script had made them of `original`.
    """
    at = {frame: k for k, frame in enumerate(given.points[:, 1, 0].tolist())}
    frames, values, leaving, arriving = (np.array(part) for part in curve)
    handles = _Handles(keys, given)
    for row, k in enumerate(source.tolist()):
        old = at.get(float(keys.points[k, 1, 0])) if k >= 0 else None
        if old is not None:
            frames[row] = original.frames[old]
            if keys.points[k, 1, 1] == given.points[old, 1, 1]:
                values[row] = original.values[old]
            kept = [handles.same(k, old, side) for side in (1, -1)]
            leaving[row] = original.leaving[old] if kept[0] else leaving[row]
            arriving[row] = original.arriving[old] if kept[1] else arriving[row]
            if all(kept):
                continue
        if k >= 0 and keys.smooth[k] and _close(leaving[row], arriving[row]):
            arriving[row] = leaving[row]
    return Curve(frames, values, leaving, arriving)


class _Handles(NamedTuple):
    """Compares the slope at key k of `keys` with the one at key old of `given`; side 1 leaves the key, -1 arrives."""

    keys: Keys
    given: Keys

    def same(self, k: int, old: int, side: int) -> bool:
        kind, before = self._kind(self.keys, k, side), self._kind(self.given, old, side)
        if kind != before:
            return False
        a, b = self.keys.points, self.given.points
        if kind == "BEZIER":
            return bool(_same_handles(a[k : k + 1], b[old : old + 1])[0, (1 + side) // 2])
        return kind == "CONSTANT" or bool((a[k, 1] == b[old, 1]).all() and (a[k + side, 1] == b[old + side, 1]).all())

    @staticmethod
    def _kind(keys: Keys, k: int, side: int) -> str:
        if not 0 <= k + side < len(keys.kinds):
            return "BEZIER"  # beyond the last key there is only its handle
        return keys.kinds[k if side > 0 else k - 1]


def _same_handles(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """(K, 2) whether the left and the right handle of keys (K, 3, 2) lie as they lay from their key.

    Both are rounded to 32 bits, and then Blender holds one in line with the other: that carries the rounding of a short
    handle on to a long one.
    """
    rounding = np.spacing(np.maximum(np.abs(a), np.abs(b)).max(axis=1, keepdims=True)).astype(np.float64)
    away, were = (np.diff(part.astype(np.float64), axis=1) for part in (a, b))  # (K, 2, 2)
    reach = np.maximum(np.abs(were[..., 0]), 1e-12)
    slopes = np.abs(were[..., 1]) / reach
    carried = np.maximum(reach / reach[:, ::-1], 1.0)
    least_x, least_y = 4.0 * rounding[..., 0], 4.0 * (rounding[..., 1] + slopes * rounding[..., 0]) * carried
    return np.asarray((np.abs(away - were) <= np.stack([least_x + 0.0 * least_y, least_y], axis=-1)).all(axis=-1))


def _close(a: float, b: float) -> bool:
    return bool(abs(a - b) <= 1e-4 * (abs(a) + abs(b)) + 1e-9)
