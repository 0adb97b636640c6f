"""Small clips that ask much of a format: all rotation orders, positions on inner joints, two roots, broken tangents."""

from __future__ import annotations

from itertools import permutations

import numpy as np

import mocurve as mc

ORDERS = ["".join(axes) for count in range(4) for axes in permutations("XYZ", count)]  # "", "X", ..., "ZYX"
FRAME_TIME = 1 / 60


def skeleton(unit: float | None = 0.01) -> mc.Skeleton:
    """Two chains that have each rotation order once, some joints with position channels, an end site on each."""
    names, parents, channels, ends = [], [], [], []
    for i, order in enumerate(ORDERS):
        root = i in (0, 7)
        if i == 7:
            _end(names, parents, channels, ends)
        places = [f"{axis}position" for axis in {0: "XYZ", 3: "Y", 7: "ZX", 10: "ZYX"}.get(i, "")]
        turns = [f"{axis}rotation" for axis in order]
        parents.append(-1 if root else len(names) - 1)
        names.append(f"Joint{order}")
        channels.append(tuple(turns + places if i == 10 else places + turns))
        ends.append(False)
    _end(names, parents, channels, ends)
    offsets = np.random.default_rng(4).normal(0, 10, (len(names), 3))
    return mc.Skeleton(tuple(names), parents, offsets, tuple(channels), ends, unit)


def _end(names: list, parents: list, channels: list, ends: list) -> None:
    parents.append(len(names) - 1)
    names.append(f"{names[-1]}_End")
    channels.append(())
    ends.append(True)


def samples(frames: int = 7, unit: float | None = 0.01, size: float = 100.0) -> mc.Motion:
    """Smooth values up to `size`, degrees and length units."""
    body = skeleton(unit)
    values = size * np.sin(0.3 * np.arange(frames)[:, None] + 1.7 * np.arange(body.channel_count))
    return mc.Motion(body, values, FRAME_TIME)


def keys(frames: int = 31, unit: float | None = 0.01) -> mc.KeyedMotion:
    """One to five keys a channel, some between frames, every third curve with broken tangents."""
    body = skeleton(unit)
    dice = np.random.default_rng(6)
    curves = []
    for channel in range(body.channel_count):
        at = np.sort(dice.choice(np.arange(2 * frames - 1), 1 + channel % 5, replace=False)) / 2 * FRAME_TIME
        values, slopes, arriving = dice.normal(0, 40, (3, len(at)))
        curves.append(mc.HermiteCurve(at, values, 9 * slopes, 9 * (arriving if channel % 3 == 0 else slopes)))
    return mc.KeyedMotion(body, tuple(curves), FRAME_TIME, frames)
