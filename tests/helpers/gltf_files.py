"""Small glTF files for tests: a scene of nodes, a skin, one animation, put together in a few lines."""

from __future__ import annotations

import base64
import json
import struct
from pathlib import Path
from typing import Any

import numpy as np

COMPONENTS = {"i1": 5120, "u1": 5121, "i2": 5122, "u2": 5123, "u4": 5125, "f4": 5126}
KINDS = {1: "SCALAR", 3: "VEC3", 4: "VEC4"}


class Scene:
    """`json` is the file's JSON, to be changed at will before it is written."""

    def __init__(self, nodes: list[dict[str, Any]], joints: list[int] | None = None):
        self.bytes = b""
        self.json: dict[str, Any] = {
            "asset": {"version": "2.0"},
            "scene": 0,
            "scenes": [{"nodes": [0]}],
            "nodes": nodes,
            "buffers": [{}],
            "bufferViews": [],
            "accessors": [],
            "animations": [{"name": "move", "channels": [], "samplers": []}],
        }
        if joints is not None:
            self.json["skins"] = [{"joints": joints}]

    def view(self, data: bytes, **more: Any) -> int:
        self.bytes += b"\0" * (-len(self.bytes) % 4)
        self.json["bufferViews"].append({"buffer": 0, "byteOffset": len(self.bytes), "byteLength": len(data), **more})
        self.bytes += data
        return len(self.json["bufferViews"]) - 1

    def accessor(self, values: Any, dtype: str = "f4", **more: Any) -> int:
        """Values (N,) or (N, width) as they are stored."""
        array = np.asarray(values, f"<{dtype}")
        table = array.reshape(len(array), -1)
        told = {"bufferView": self.view(table.tobytes()), "componentType": COMPONENTS[dtype]}
        self.json["accessors"].append({**told, "count": len(table), "type": KINDS[table.shape[1]], **more})
        return len(self.json["accessors"]) - 1

    def animate(self, node: int, path: str, times: Any, values: Any, form: str | None = None, **more: Any) -> None:
        """Times and values are accessors, or what is to become one."""
        animation = self.json["animations"][-1]
        sampler = {
            "input": times if isinstance(times, int) else self.accessor(times),
            "output": values if isinstance(values, int) else self.accessor(values, **more),
        }
        animation["samplers"].append(sampler | ({"interpolation": form} if form else {}))
        target = {"node": node, "path": path}
        animation["channels"].append({"sampler": len(animation["samplers"]) - 1, "target": target})

    def glb(self, path: Path) -> Path:
        self.json["buffers"][0].setdefault("byteLength", len(self.bytes))
        path.write_bytes(glb(json.dumps(self.json).encode(), self.bytes))
        return path

    def gltf(self, path: Path, beside: str | None = None, uri: str | None = None) -> Path:
        """With a data URI, or with its bytes in a file `beside` it."""
        if beside is not None:
            (path.parent / beside).parent.mkdir(exist_ok=True)
            (path.parent / beside).write_bytes(self.bytes)
        inside = "data:application/octet-stream;base64," + base64.b64encode(self.bytes).decode()
        self.json["buffers"][0] = {"byteLength": len(self.bytes), "uri": uri or beside or inside}
        path.write_text(json.dumps(self.json))
        return path


def glb(text: bytes, binary: bytes) -> bytes:
    """A GLB of JSON and a binary chunk."""
    text += b" " * (-len(text) % 4)
    binary += b"\0" * (-len(binary) % 4)
    chunks = struct.pack("<II", len(text), 0x4E4F534A) + text + struct.pack("<II", len(binary), 0x004E4942) + binary
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks


def turn(degrees: float, axis: int = 2) -> list[float]:
    """The quaternion xyzw of a turn about an axis."""
    half = np.radians(degrees) / 2
    return [*(np.sin(half) * np.eye(3)[axis]).tolist(), float(np.cos(half))]


def chain(*translations: Any, **root: Any) -> list[dict[str, Any]]:
    """Nodes that hang on one another, "n0", "n1" ..."""
    nodes = [{"name": f"n{i}", "translation": list(place), "children": [i + 1]} for i, place in enumerate(translations)]
    del nodes[-1]["children"]
    nodes[0].update(root)
    return nodes
