"""The part of the Blender script that needs no Blender: curves, rotations, bones. `blender.write` puts what stands
below the marker into each file.

SPDX-License-Identifier: MIT
"""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import permutations, product
from typing import NamedTuple

import numpy as np

# --- part of the script ---
TURN_TOLERANCE = math.radians(1e-4)  # of quaternion keys made from Euler keys; radians
SHORTEST = 1.0 / 64.0  # frames; no key is put in where pieces would become shorter
STEP = 1.0 / 64.0  # frames; a curve that jumps does it within this time
NAME_BYTES = 63  # of a bone's name in UTF-8


class Curve(NamedTuple):
    """A cubic Hermite curve: frames (K,) rising, values, and their rates (per frame) leaving and arriving at the keys.
    Constant before the first key and after the last."""

    frames: np.ndarray
    values: np.ndarray
    leaving: np.ndarray
    arriving: np.ndarray


def constant(value: float) -> Curve:
    return Curve(np.zeros(1), np.full(1, value), np.zeros(1), np.zeros(1))


def scaled(curve: Curve, factor: float, shift: float = 0.0) -> Curve:
    """The curve whose value is factor * value + shift."""
    return Curve(curve.frames, factor * curve.values + shift, factor * curve.leaving, factor * curve.arriving)


def sampled(curve: Curve, frames: np.ndarray, inside: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Values and rates (N,) at `frames` (N,) of the pieces that `inside` (N,) lies in: at a key, two pieces meet."""
    if len(curve.frames) < 2:
        return np.full(len(frames), curve.values[0]), np.zeros(len(frames))
    k = np.clip(np.searchsorted(curve.frames, inside, side="right") - 1, 0, len(curve.frames) - 2)
    h = curve.frames[k + 1] - curve.frames[k]
    u = np.clip((frames - curve.frames[k]) / h, 0.0, 1.0)
    v = 1.0 - u
    rise, m0, m1 = curve.values[k + 1] - curve.values[k], h * curve.leaving[k], h * curve.arriving[k + 1]
    values = curve.values[k] + rise * u * u * (3.0 - 2.0 * u) + u * v * (v * m0 - u * m1)
    rates = (6.0 * rise * u * v + m0 * v * (1.0 - 3.0 * u) + m1 * u * (3.0 * u - 2.0)) / h
    outside = (inside < curve.frames[0]) | (inside > curve.frames[-1])
    return values, np.where(outside, 0.0, rates)


def mixed(curves: list[Curve], weights: np.ndarray, shift: float) -> Curve:
    """The exact curve of a weighted sum of curves, plus `shift`: it has the keys of all of them."""

    def sample(frames: np.ndarray, inside: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        both = [sampled(curve, frames, inside) for curve in curves]
        sums = [sum(w * part[i] for w, part in zip(weights, both, strict=True)) for i in (0, 1)]
        return (sums[0] + shift)[:, None], sums[1][:, None]

    return fitted(sample, _union(curves), lambda a, b: np.zeros(len(a)), 0.0)[0]


Sample = Callable[[np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray]]


def fitted(
    sample: Sample, frames: np.ndarray, error: Callable[[np.ndarray, np.ndarray], np.ndarray], tolerance: float
) -> list[Curve]:
    """Hermite curves through `frames` (K,) and through more, until the error stays within the tolerance.

    sample(frames, inside) are values and rates (N, n); error(a, b) compares values (N, n) and gives (N,).
    """
    if len(frames) < 2:
        values, _ = sample(frames, frames)
        return [constant(value) for value in values[0]] if len(values) else []
    starts, ends = frames[:-1], frames[1:]
    done: list[tuple[np.ndarray, ...]] = []
    while len(starts):
        middle, h = 0.5 * (starts + ends), ends - starts
        v0, r0 = sample(starts, middle)
        v1, r1 = sample(ends, middle)
        worst = np.zeros(len(starts))
        for u in np.arange(1, 8) / 8.0:
            m0, m1 = h[:, None] * r0, h[:, None] * r1
            made = v0 + (v1 - v0) * u * u * (3.0 - 2.0 * u) + u * (1.0 - u) * ((1.0 - u) * m0 - u * m1)
            worst = np.maximum(worst, error(made, sample(starts + u * h, middle)[0]))
        good = (worst <= tolerance) | (h < 2.0 * SHORTEST)
        done.append(tuple(array[good] for array in (starts, ends, v0, r0, v1, r1)))
        bad = ~good
        starts, ends = np.append(starts[bad], middle[bad]), np.append(middle[bad], ends[bad])
    parts = [np.concatenate(arrays) for arrays in zip(*done, strict=True)]
    starts, ends, v0, r0, v1, r1 = (part[np.argsort(parts[0])] for part in parts)
    keys = np.append(starts, ends[-1])
    return [
        Curve(keys, np.append(v0[:, i], v1[-1, i]), np.append(r0[:, i], r1[-1, i]), np.append(r0[0, i], r1[:, i]))
        for i in range(v0.shape[1])
    ]


def _union(curves: list[Curve]) -> np.ndarray:
    """The frames of all keys; keys that 32 bits cannot tell apart are one."""
    frames = np.unique(np.concatenate([curve.frames for curve in curves if len(curve.frames) > 1] or [np.zeros(1)]))
    return frames[np.append(True, np.diff(frames.astype(np.float32)) > 0)]


# -- rotations ------------------------------------------------------------------------------------
def product_of(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Quaternions (N, 4) wxyz: first b, then a."""
    w = a[:, 0] * b[:, 0] - np.einsum("ni,ni->n", a[:, 1:], b[:, 1:])
    xyz = a[:, :1] * b[:, 1:] + b[:, :1] * a[:, 1:] + np.cross(a[:, 1:], b[:, 1:])
    return np.column_stack([w, xyz])


def turned(angles: np.ndarray, rates: np.ndarray, axes: list[int]) -> tuple[np.ndarray, np.ndarray]:
    """Quaternions (N, 4) of angles (N, n), radians, about axes that the earlier turns have moved; and their rates."""
    q, dq = np.tile([1.0, 0.0, 0.0, 0.0], (len(angles), 1)), np.zeros((len(angles), 4))
    for i, axis in enumerate(axes):
        half, step, change = 0.5 * angles[:, i], np.zeros_like(q), np.zeros_like(q)
        step[:, 0], step[:, 1 + axis] = np.cos(half), np.sin(half)
        change[:, 0], change[:, 1 + axis] = -0.5 * rates[:, i] * step[:, 1 + axis], 0.5 * rates[:, i] * step[:, 0]
        q, dq = product_of(q, step), product_of(dq, step) + product_of(q, change)
    return q, dq


def turn_between(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Radians (N,) between rotations, quaternions (N, 4) of any length."""
    a, b = (q / np.linalg.norm(q, axis=1, keepdims=True) for q in (a, b))
    return 4.0 * np.arcsin(np.clip(0.5 * np.minimum(_length(a - b), _length(a + b)), 0.0, 1.0))


def _length(vectors: np.ndarray) -> np.ndarray:
    return np.linalg.norm(vectors, axis=1)


def as_quaternions(angles: list[Curve], axes: list[int], basis: np.ndarray) -> list[Curve]:
    """Four curves wxyz of Euler curves (radians), seen from a bone that rests as `basis` (3, 3) within 1e-4 degrees."""

    def sample(frames: np.ndarray, inside: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        values, rates = zip(*(sampled(curve, frames, inside) for curve in angles), strict=True)
        q, dq = turned(np.column_stack(values), np.column_stack(rates), axes)
        return in_basis(q, basis), in_basis(dq, basis)

    return fitted(sample, _union(angles), turn_between, TURN_TOLERANCE)


def in_basis(q: np.ndarray, basis: np.ndarray) -> np.ndarray:
    """b^-1 q b: only the axis of the rotation turns."""
    return np.column_stack([q[:, 0], q[:, 1:] @ basis])


def as_angles(q: np.ndarray, axes: list[int], near: np.ndarray) -> np.ndarray:
    """Angles (N, 3), radians, about three different axes of quaternions (N, 4), each row the nearest to the one before
    it; the first to `near` (3,)."""
    w, xyz = q[:, 0] / _length(q), q[:, 1:] / _length(q)[:, None]
    m = 2.0 * (xyz[:, :, None] * xyz[:, None, :]) + np.eye(3) * (2.0 * w * w - 1.0)[:, None, None]
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        m[:, i, j] -= 2.0 * w * xyz[:, k]
        m[:, j, i] += 2.0 * w * xyz[:, k]
    a, b, c = axes
    e = 1.0 if (b - a) % 3 == 1 else -1.0  # a mirror changes the sign of every angle
    cosine = np.hypot(m[:, a, a], m[:, a, b])
    locked = cosine < 1e-9
    middle = np.arctan2(e * m[:, a, c], cosine)
    first = np.where(locked, np.arctan2(e * m[:, c, b], m[:, b, b]), np.arctan2(-e * m[:, b, c], m[:, c, c]))
    last = np.where(locked, 0.0, np.arctan2(-e * m[:, a, b], m[:, a, a]))
    result = np.column_stack([first, middle, last])
    for row in result:
        ways = [row, np.array([row[0] + math.pi, math.pi - row[1], row[2] + math.pi])]
        ways = [way + 2.0 * math.pi * np.rint((near - way) / (2.0 * math.pi)) for way in ways]
        row[:] = near = min(ways, key=lambda way: float(np.abs(way - near).sum()))
    return result


# -- bones ----------------------------------------------------------------------------------------
PERMUTATIONS = [
    matrix
    for order in permutations(range(3))
    for signs in product((1.0, -1.0), repeat=3)
    if np.linalg.det(matrix := np.eye(3)[list(order)] * np.array(signs)[:, None]) > 0
]  # the 24 turns that carry axes to axes; the first is no turn


def axes_of(matrix: np.ndarray) -> list[tuple[int, float]] | None:
    """For each axis the column of the only entry in its row (3, 3), and the entry; None where a row has several."""
    largest = np.abs(matrix).max()
    rows = [(int(np.argmax(np.abs(row))), float(row[np.argmax(np.abs(row))])) for row in matrix]
    made = np.zeros((3, 3))
    for i, (k, entry) in enumerate(rows):
        made[i, k] = math.copysign(largest, entry)
    if not largest > 0 or np.abs(matrix - made).max() > 1e-5 * largest or len({k for k, _ in rows}) < 3:
        return None
    return [(k, math.copysign(largest, entry)) for k, entry in rows]


def straight(vector: np.ndarray) -> np.ndarray:
    """The turn among PERMUTATIONS whose Y axis is nearest to a vector, and that turns least."""
    return max(PERMUTATIONS, key=lambda m: (round(float(m[:, 1] @ vector), 9), np.trace(m)))


def bone_names(names: list[str]) -> list[str]:
    """Names that Blender takes: not empty, at most 63 bytes of UTF-8, each only once ("Leg", "Leg.001")."""
    taken: set[str] = set()
    result = []
    for given in names:
        text = given.replace("\0", "?").encode("utf-8", "replace") or b"bone"
        name, count = text[:NAME_BYTES].decode("utf-8", "ignore"), 0
        while name in taken:
            count += 1
            ending = f".{count:03d}"
            name = text[: NAME_BYTES - len(ending)].decode("utf-8", "ignore") + ending
        taken.add(name)
        result.append(name)
    return result


def bone_vectors(parents: list[int], offsets: np.ndarray) -> np.ndarray:
    """From head to tail (J, 3): to the child, to the middle of several, or a short way on where there is none."""
    lengths = _length(offsets)[[parent >= 0 for parent in parents]]
    usual = float(np.median(lengths[lengths > 0])) if (lengths > 0).any() else 1.0
    vectors = np.zeros((len(parents), 3))
    for joint, parent in enumerate(parents):
        below = [offsets[k] for k, other in enumerate(parents) if other == joint and offsets[k].any()]
        middle = np.mean(below, axis=0) if below else np.zeros(3)
        if np.linalg.norm(middle) > 0.05 * usual:
            vectors[joint] = middle
        else:
            on = vectors[parent] if parent >= 0 else np.array([0.0, 1.0, 0.0])
            vectors[joint] = on * (0.3 * usual / np.linalg.norm(on))
    return vectors


def alignment(ours: np.ndarray, theirs: np.ndarray) -> tuple[np.ndarray, float, float]:
    """The turn among PERMUTATIONS and the scale that carry our bones (N, 3) to theirs, and what is left, 0 to 1."""
    size, whole = float((ours * ours).sum()), float((theirs * theirs).sum())
    if size == 0 or whole == 0:
        return PERMUTATIONS[0], 1.0, 0.0
    fits = [round(float((ours @ turn.T * theirs).sum()) / math.sqrt(size * whole), 6) for turn in PERMUTATIONS]
    best = int(np.argmax(fits))
    scale = max(fits[best], 0.0) * math.sqrt(whole / size) or 1.0
    if abs(scale - 1.0) < 1e-5:
        scale = 1.0
    left = theirs - scale * (ours @ PERMUTATIONS[best].T)
    return PERMUTATIONS[best], scale, math.sqrt(float((left * left).sum()) / whole)
