"""The parts of a glTF file that is written: nodes, skin, figure, animations, and what stands in `extras`."""

from __future__ import annotations

import base64
import json
import struct
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from .. import __version__
from ..errors import OptionError
from ..kinematics import rest_offsets
from ..motion import Motion
from ..skeleton import Skeleton
from ._files import Path, encoded
from ._gltf_buffer import Buffer, float32, key_times
from ._gltf_mesh import figure
from ._gltf_write_tracks import JointTracks, Track

UNTURNED = np.array([0, 0, 0, 1], np.float32)  # xyzw
MATERIAL = {"baseColorFactor": [0.35, 0.55, 0.8, 1.0], "metallicFactor": 0.0, "roughnessFactor": 0.7}
MOST_JOINTS = 1 << 16
MOST_BYTES = 1 << 32


class Keys(NamedTuple):
    """A track as it is written, float32: seconds (K,), xyzw or metres (K, n), slopes (2, K, n) or None."""

    times: np.ndarray
    values: np.ndarray
    slopes: np.ndarray | None = None


class Document:
    """A file with one body and any number of animations; lengths go in as file units and are written in metres."""

    def __init__(self, title: str, motion: Motion, names: Sequence[str], scale: float, mesh: bool):
        """names: of the armature, of the figure and of the J joints, no two the same; scale: metres a file unit."""
        self.skeleton, self.scale = motion.skeleton, scale
        self.buffer = Buffer()
        rest = scale * rest_offsets(motion)
        self.rest = float32(rest, "bones in metres")
        places = rest.copy()
        for joint, parent in enumerate(self.skeleton.parents):
            places[joint] += places[parent] if parent >= 0 else 0.0
        self.parts: dict[str, Any] = {
            "asset": {"version": "2.0", "generator": f"mocurve {__version__}"},
            "scene": 0,
            "scenes": [{"name": title, "nodes": [0]}],
            "nodes": self._nodes(names),
            "skins": [self._skin(names[0], places)],
        }
        if mesh:
            self._add_figure(names[1], places)

    def animate(self, name: str, tracks: JointTracks, motion: Motion) -> None:
        """Add an animation; `motion` is the clip's sampling, with at least one frame."""
        found: dict[tuple[str, int], Keys] = {}
        for path, joints in (("rotation", tracks.rotations), ("translation", tracks.positions)):
            for joint, track in enumerate(joints):
                keys = None if track is None else self._keys(track, joint, path, motion.frame_time)
                if keys is not None:
                    found[path, joint] = keys
        ends = key_times(np.unique([0.0, motion.duration]), motion.frame_time)
        if max((keys.times[-1] for keys in found.values()), default=-1.0) < ends[-1]:
            first = found.get(("rotation", 0), Keys(ends, UNTURNED[None]))  # some track has to last as long as the clip
            found["rotation", 0] = Keys(ends, np.repeat(first.values[:1], len(ends), axis=0))
        targets = [{"node": 1 + joint, "path": path} for path, joint in found]
        self.parts.setdefault("animations", []).append(
            {
                "name": name,
                "channels": [{"sampler": i, "target": target} for i, target in enumerate(targets)],
                "samplers": [self._sampler(keys) for keys in found.values()],
                "extras": {"mocurve": _told_of_clip(motion)},
            }
        )

    def text(self, uri: str | None = None) -> str:
        """The file as JSON; `uri`: where the buffer is, None for the other part of a .glb."""
        data = self.buffer.data
        buffer = {"byteLength": len(data)} if uri is None else {"byteLength": len(data), "uri": uri}
        parts = {
            **self.parts,
            "buffers": [buffer],
            "bufferViews": self.buffer.views,
            "accessors": self.buffer.accessors,
        }
        try:
            return json.dumps(parts, ensure_ascii=False, allow_nan=False, separators=(",", ":"))
        except (TypeError, ValueError) as error:
            raise OptionError(f"cannot be written as JSON: {error}") from error

    def _nodes(self, names: Sequence[str]) -> list[dict[str, Any]]:
        nodes: list[dict[str, Any]] = [{"name": names[0]}]
        for joint, parent in enumerate(self.skeleton.parents.tolist()):
            node: dict[str, Any] = {"name": names[2 + joint]}
            if self.rest[joint].any():
                node["translation"] = self.rest[joint].tolist()
            nodes.append(node)
            nodes[1 + parent].setdefault("children", []).append(1 + joint)  # a root's parent is -1: the armature
        return nodes

    def _skin(self, name: str, places: np.ndarray) -> dict[str, Any]:
        count = len(places)
        back = np.tile(np.eye(4, dtype=np.float32), (count, 1, 1))
        back[:, 3, :3] = float32(-places, "bones in metres")  # by columns
        return {
            "name": name,
            "inverseBindMatrices": self.buffer.add(back.reshape(count, 16)),
            "joints": list(range(1, 1 + count)),
            "extras": {"mocurve": _told_of_body(self.skeleton, self.scale)},
        }

    def _add_figure(self, name: str, places: np.ndarray) -> None:
        shape = figure(self.skeleton.parents, places)
        if shape is None:
            return
        if len(places) > MOST_JOINTS:
            raise OptionError(
                f"a figure of glTF has at most {MOST_JOINTS} joints, not {len(places)}: leave out the mesh"
            )
        add = self.buffer.add
        joints = np.zeros((len(shape.joints), 4), np.uint8 if len(places) <= 256 else np.uint16)
        joints[:, 0] = shape.joints
        weights = np.tile(np.array([255, 0, 0, 0], np.uint8), (len(joints), 1))
        attributes = {
            "POSITION": add(float32(shape.positions, "bones in metres"), bounds=True, vertices=True),
            "NORMAL": add(shape.normals.astype(np.float32), vertices=True),
            "JOINTS_0": add(joints, vertices=True),
            "WEIGHTS_0": add(weights, vertices=True, normalized=True),
        }
        self.parts["materials"] = [{"name": name, "pbrMetallicRoughness": MATERIAL}]
        self.parts["meshes"] = [{"name": name, "primitives": [{"attributes": attributes, "material": 0}]}]
        self.parts["scenes"][0]["nodes"].append(len(self.parts["nodes"]))
        self.parts["nodes"].append({"name": name, "mesh": 0, "skin": 0})

    def _keys(self, track: Track, joint: int, path: str, frame_time: float) -> Keys | None:
        """The track in 32 bits; one key where nothing moves, None where it stays at rest."""
        what = f"{path} of joint {self.skeleton.names[joint]!r}"
        if path == "rotation":
            values = float32(track.values[:, [1, 2, 3, 0]], what)
        else:
            values = float32(self.scale * track.values, what)
        rest = UNTURNED if path == "rotation" else self.rest[joint]
        alone = track.slopes is None or len(values) == 1 or not track.slopes.any()
        if alone and (values == values[0]).all():
            return None if (values[0] == rest).all() else Keys(np.zeros(1, np.float32), values[:1])
        times = key_times(track.times, frame_time)
        if track.slopes is None:
            return Keys(times, values)
        slopes = track.slopes[..., [1, 2, 3, 0]] if path == "rotation" else self.scale * track.slopes
        return Keys(times, values, float32(slopes, f"tangents, {what}"))

    def _sampler(self, keys: Keys) -> dict[str, Any]:
        times = self.buffer.add(keys.times, bounds=True)
        if keys.slopes is None:
            return {"input": times, "output": self.buffer.add(keys.values), "interpolation": "LINEAR"}
        arriving, leaving = keys.slopes
        triples = np.stack([arriving, keys.values, leaving], axis=1).reshape(-1, keys.values.shape[1])
        return {"input": times, "output": self.buffer.add(triples), "interpolation": "CUBICSPLINE"}


def glb(document: Document, path: Path) -> bytes:
    """The file in its binary form."""
    text = encoded(document.text(), path)
    chunks = [(b"JSON", text + b" " * (-len(text) % 4)), (b"BIN\0", bytes(document.buffer.data))]
    size = 12 + sum(8 + len(data) for _, data in chunks)
    if size >= MOST_BYTES:
        raise OptionError(f"a .glb file has less than 4 GB, this clip takes {size} bytes")
    parts = [struct.pack("<4sII", b"glTF", 2, size)]
    for kind, data in chunks:
        parts += [struct.pack("<I4s", len(data), kind), data]
    return b"".join(parts)


def embedded(document: Document, path: Path) -> bytes:
    """The file as JSON alone, its buffer inside."""
    data = base64.b64encode(document.buffer.data).decode()
    return encoded(document.text(f"data:application/octet-stream;base64,{data}"), path)


def _told_of_body(skeleton: Skeleton, scale: float) -> dict[str, Any]:
    return {
        "version": 1,
        "names": list(skeleton.names),
        "channels": [list(kinds) for kinds in skeleton.channels],
        "offsets": skeleton.offsets.tolist(),
        "end_sites": np.flatnonzero(skeleton.end_sites).tolist(),
        "unit": skeleton.unit,
        "scale": scale,
    }


def _told_of_clip(motion: Motion) -> dict[str, Any]:
    return {
        "frame_time": motion.frame_time,
        "frames": motion.frames,
        "start": motion.values[0].tolist(),
        "history": list(motion.history),
    }
