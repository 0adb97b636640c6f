"""The binary part of a glTF file: accessors over one buffer."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..errors import OptionError

COMPONENTS = {"f4": 5126, "u1": 5121, "u2": 5123}
SHAPES = {(): "SCALAR", (3,): "VEC3", (4,): "VEC4", (16,): "MAT4"}
VERTICES = 34962  # bufferView.target ARRAY_BUFFER


class Buffer:
    """Arrays one after the other; one that is there already, such as key times, is not stored again."""

    def __init__(self) -> None:
        self.data = bytearray()
        self.views: list[dict[str, Any]] = []
        self.accessors: list[dict[str, Any]] = []
        self._known: dict[tuple[Any, ...], int] = {}

    def add(self, array: np.ndarray, *, bounds: bool = False, vertices: bool = False, normalized: bool = False) -> int:
        """The accessor of an array (N,), (N, 3), (N, 4) or (N, 16) of float32, uint8 or uint16.

        bounds: with its least and largest values; vertices: numbers of a mesh; normalized: integers that stand
        for 0 to 1.
        """
        data = np.ascontiguousarray(array, array.dtype.newbyteorder("<"))
        raw = data.tobytes()
        key = (raw, data.dtype.str, data.shape, bounds, vertices, normalized)
        if key not in self._known:
            self._known[key] = len(self.accessors)
            view: dict[str, Any] = {"buffer": 0, "byteOffset": len(self.data), "byteLength": len(raw)}
            self.views.append({**view, "target": VERTICES} if vertices else view)
            self.data += raw + bytes(-len(raw) % 4)
            self.accessors.append(self._accessor(data, bounds, normalized))
        return self._known[key]

    def _accessor(self, data: np.ndarray, bounds: bool, normalized: bool) -> dict[str, Any]:
        accessor: dict[str, Any] = {
            "bufferView": len(self.views) - 1,
            "componentType": COMPONENTS[data.dtype.str[1:]],
            "count": len(data),
            "type": SHAPES[data.shape[1:]],
        }
        if normalized:
            accessor["normalized"] = True
        if bounds:
            accessor["min"], accessor["max"] = (np.atleast_1d(f(data, axis=0)).tolist() for f in (np.min, np.max))
        return accessor


def float32(array: np.ndarray, what: str) -> np.ndarray:
    """The array in 32 bits; OptionError that says what it is of where a number is too large for that."""
    with np.errstate(over="ignore"):
        small = np.asarray(array, np.float32)
    if not np.isfinite(small).all():
        worst = float(np.abs(array).max())
        raise OptionError(f"{what}: {worst:.3g} is too large for the 32-bit numbers of glTF")
    return small


def key_times(times: np.ndarray, frame_time: float) -> np.ndarray:
    """Seconds (K,) in 32 bits and still rising; OptionError where 32 bits do not tell the frames apart.

    Two keys that stand nearer than that, as a step has them, come to stand on neighbouring numbers.
    """
    bits = float32(times, "key times").view(np.int32).astype(np.int64)  # of floats from 0: they rise as these do
    order = np.arange(len(bits))
    rising = (np.maximum.accumulate(bits - order) + order).astype(np.int32).view(np.float32)
    if np.abs(rising - times).max(initial=0.0) > 0.25 * frame_time:
        raise OptionError(f"frames of {frame_time:g} s are too short for the 32-bit key times of glTF")
    return rising
