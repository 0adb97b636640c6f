"""A .glb or .gltf file taken apart as the specification says, by code of its own."""

from __future__ import annotations

import base64
import json
import struct
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

TYPES = {5126: np.dtype("<f4"), 5121: np.dtype("u1"), 5123: np.dtype("<u2")}
WIDTHS = {"SCALAR": 1, "VEC3": 3, "VEC4": 4, "MAT4": 16}


class Keys(NamedTuple):
    """What an animation channel does: seconds (K,), and xyzw or metres (K, n), or with tangents (K, 3, n)."""

    times: np.ndarray
    values: np.ndarray
    interpolation: str


class Glb:
    """parts: the JSON; data: the buffer; joints: {name of the node: its index}."""

    def __init__(self, path: Path):
        raw = path.read_bytes()
        if path.suffix == ".gltf":
            self.parts: dict[str, Any] = json.loads(raw)
            kind, encoded = self.parts["buffers"][0]["uri"].split(",")
            assert kind == "data:application/octet-stream;base64"
            self.data = base64.b64decode(encoded)
        else:
            magic, version, size, length, chunk = struct.unpack_from("<4sII I4s", raw)
            assert (magic, version, size, chunk) == (b"glTF", 2, len(raw), b"JSON")
            self.parts = json.loads(raw[20 : 20 + length])
            size, chunk = struct.unpack_from("<I4s", raw, 20 + length)
            assert chunk == b"BIN\0"
            assert 28 + length + size == len(raw)
            self.data = raw[28 + length :]
        self.joints = {self.parts["nodes"][node]["name"]: node for node in self.parts["skins"][0]["joints"]}

    def array(self, accessor: int) -> np.ndarray:
        """(N,) or (N, n) numbers of an accessor, its bounds checked."""
        told = self.parts["accessors"][accessor]
        view, width = self.parts["bufferViews"][told["bufferView"]], WIDTHS[told["type"]]
        array = np.frombuffer(
            self.data,
            TYPES[told["componentType"]],
            told["count"] * width,
            view["byteOffset"] + told.get("byteOffset", 0),
        ).reshape(-1, width)
        if "min" in told:
            assert (told["min"], told["max"]) == (array.min(axis=0).tolist(), array.max(axis=0).tolist())
        return array[:, 0] if width == 1 else array

    def animation(self, name: str | None = None) -> dict[tuple[str, str], Keys]:
        """{(name of the joint, path): keys} of an animation, the first or by name."""
        found = next(each for each in self.parts["animations"] if name in (None, each["name"]))
        names = {node: name for name, node in self.joints.items()}
        result = {}
        for channel in found["channels"]:
            sampler = found["samplers"][channel["sampler"]]
            times, values = self.array(sampler["input"]), self.array(sampler["output"])
            cubic = sampler["interpolation"] == "CUBICSPLINE"
            shaped = values.reshape(len(times), 3, -1) if cubic else values
            target = channel["target"]
            result[names[target["node"]], target["path"]] = Keys(times, shaped, sampler["interpolation"])
        return result
