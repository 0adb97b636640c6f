"""What the tests of the formats share: a small BVH file to make odd, and small motions."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import mocurve as mc
from mocurve.formats import _bvh_rows

TEXT = """HIERARCHY
ROOT Hips
{
  OFFSET 0 1.5 0
  CHANNELS 3 Xposition Zrotation Yrotation
  JOINT Knee
  {
    OFFSET 0 -1 0
    CHANNELS 1 Xrotation
    End Site
    {
      OFFSET 0 -2.25 0
    }
  }
}
MOTION
Frames: 3
Frame Time: 0.0083333
0.5 -1.25 2 0.1
1.5 -2.25 3 0.2
2.5 -3.25 4 -0.0
"""
VALUES = [[0.5, -1.25, 2, 0.1], [1.5, -2.25, 3, 0.2], [2.5, -3.25, 4, -0.0]]


@pytest.fixture
def bvh(tmp_path: Path) -> Callable[..., Path]:
    """bvh(old, new, ...) is a small BVH file with every `old` changed to `new`; bvh(data=bytes) has these bytes."""

    def make(*changes: str, data: bytes | None = None) -> Path:
        text = TEXT
        for old, new in zip(changes[::2], changes[1::2], strict=True):
            assert old in text
            text = text.replace(old, new)
        path = tmp_path / "clip.bvh"
        path.write_bytes(text.encode() if data is None else data)
        return path

    return make


@pytest.fixture(params=["plain", "compiled"])
def both_ways(request, monkeypatch: pytest.MonkeyPatch) -> None:
    """Rows of any size are read first without, then with compiled code."""
    monkeypatch.setattr(_bvh_rows, "COMPILED_FROM", 1 << 62 if request.param == "plain" else 0)


@pytest.fixture
def values() -> np.ndarray:
    """The numbers of the small file."""
    return np.array(VALUES)


@pytest.fixture
def small() -> mc.Motion:
    """The motion that the small file is of."""
    body = mc.Skeleton(
        ("Hips", "Knee", "Knee_End"),
        [-1, 0, 1],
        [[0, 1.5, 0], [0, -1, 0], [0, -2.25, 0]],
        (("Xposition", "Zrotation", "Yrotation"), ("Xrotation",), ()),
        [False, False, True],
    )
    return mc.Motion(body, np.array(VALUES), 1 / 120)


@pytest.fixture
def keys(small: mc.Motion) -> mc.KeyedMotion:
    """Keys of many kinds: one key, several, broken tangents, numbers with all their digits."""
    curves = (
        mc.HermiteCurve([0.0, 1 / 60], [1 / 3, -2 / 7], [0.1, 1e-300]),
        mc.HermiteCurve([0.0], [5.0], [0.0]),
        mc.HermiteCurve([0.0, 1 / 120, 1 / 60], [1, 2, 3], [0.1, 0.2, 0.3], [0.4, 0.5, 0.6]),
        mc.HermiteCurve([0.0, 1 / 60], [1e22, -0.0], [0.0, 0.0]),
    )
    history = ({"verb": "reduce", "tolerance": "2mm", "deep": [1, {"é": None}]},)
    return mc.KeyedMotion(small.skeleton, curves, small.frame_time, small.frames, history)
