"""The animation of a glTF file as tracks, one a node and path, and their values at frames (section 3.11 and appendix C
of the specification)."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from .. import hermite, rotation
from ..errors import UnknownName
from . import _gltf_read_accessors as accessors
from ._gltf_read_json import Document
from ._gltf_read_tree import Tree

PATHS = {"translation": "VEC3", "rotation": "VEC4", "scale": "VEC3"}
MAX_NUMBERS = 50_000_000  # that keys or frames may have; more only where the file itself is as large
_NEAR = 1e-3  # frames that a key, rounded to float32, may be from the frame that it is meant for


class Track(NamedTuple):
    times: int  # the accessor with the K times of its keys
    values: Any  # the accessor with as many values, or three times as many: tangent in, value, tangent out
    form: str  # LINEAR, STEP, CUBICSPLINE
    place: str


class Animation(NamedTuple):
    document: Document
    tracks: dict[tuple[int, str], Track]  # by node and path
    times: dict[int, np.ndarray]  # (K,) seconds, rising, by accessor
    told: dict[str, Any]  # its JSON


class Frames(NamedTuple):
    """Where the frames lie in time: `total` of them, `frame_time` seconds apart, the first at second `first`.

    at_keys: keys that all but lie at a frame, as far as float32 can say, are meant for it.
    """

    frame_time: float
    total: int
    first: float = 0.0
    at_keys: bool = True


def animation(document: Document, name: str | None) -> Animation:
    """The animation of that name; None is the first, with a warning where there are more."""
    known = document.all("animations")
    if not known:
        document.fail("animations", "none in this file: it has no motion to read")
    names = [document.name(one, f"animations[{i}]") for i, one in enumerate(known)]
    if name is None and len(names) > 1:
        others = ", ".join(map(repr, names[1:11])) + (" …" if len(names) > 11 else "")
        document.odd.append(f"{len(names)} animations: {names[0]!r} is read, not {others}")
    if name is not None and name not in names:
        raise UnknownName("animation", name, names)
    index = 0 if name is None else names.index(name)
    return _Reader(document, known[index], f"animations[{index}]").animation()


class _Reader:
    def __init__(self, document: Document, told: dict[str, Any], place: str):
        self.document, self.told, self.place = document, told, place
        self.samplers = document.objects(told.get("samplers"), f"{place}.samplers")
        self.times: dict[int, np.ndarray] = {}
        self.numbers = 0

    def animation(self) -> Animation:
        tracks: dict[tuple[int, str], Track] = {}
        dropped: set[str] = set()
        for i, channel in enumerate(self.document.objects(self.told.get("channels"), f"{self.place}.channels")):
            place = f"{self.place}.channels[{i}]"
            target = self.document.object(channel.get("target"), f"{place}.target")
            path = target.get("path")
            if path not in ("translation", "rotation", "scale", "weights", "pointer"):
                self.document.fail(
                    f"{place}.target.path", f"{', '.join(PATHS)} or weights expected, {str(path)[:40]} found"
                )
            if path not in PATHS:
                dropped.add(path)
            elif "node" in target:
                node = target["node"]
                self.document.one("nodes", node, f"{place}.target.node")
                if (node, path) in tracks:
                    self.document.fail(f"{place}.target", f"the {path} of nodes[{node}] is animated twice")
                tracks[node, path] = self.track(channel.get("sampler"), f"{place}.sampler", path)
        for path in sorted(dropped):
            what = "the weights of morph targets" if path == "weights" else "animations of other things than nodes"
            self.document.odd.append(f"{what} are dropped")
        return Animation(self.document, tracks, self.times, self.told)

    def track(self, index: Any, place: str, path: str) -> Track:
        document = self.document
        if type(index) is not int or not 0 <= index < len(self.samplers):
            document.fail(place, f"the index of one of {len(self.samplers)} samplers expected, {str(index)[:40]} found")
        sampler, place = self.samplers[index], f"{self.place}.samplers[{index}]"
        form = sampler.get("interpolation", "LINEAR")
        if form not in ("LINEAR", "STEP", "CUBICSPLINE"):
            document.fail(f"{place}.interpolation", f"LINEAR, STEP or CUBICSPLINE expected, {str(form)[:40]} found")
        document.one("accessors", sampler.get("input"), f"{place}.input")
        document.one("accessors", sampler.get("output"), f"{place}.output")
        times = self.key_times(sampler["input"], f"{place}.input")
        self.numbers += len(times) * (12 if form == "CUBICSPLINE" else 4)
        if self.numbers > max(MAX_NUMBERS, document.size):
            document.fail(
                self.place, f"its samplers use the same numbers again and again, more than {MAX_NUMBERS} in all"
            )
        return Track(sampler["input"], sampler["output"], form, place)

    def key_times(self, index: int, place: str) -> np.ndarray:
        if index not in self.times:
            times = accessors.floats(self.document, index, place, "SCALAR")[:, 0]
            falls = np.diff(times) <= 0
            if falls.any():
                at = int(np.argmax(falls)) + 1
                self.document.fail(f"accessors[{index}]", f"key times have to rise, element {at} does not")
            self.times[index] = times
        return self.times[index]


def check_size(document: Document, frames: Frames, channels: int) -> None:
    """FileError where the frames would take far more memory than the file itself."""
    if frames.total * max(channels, 1) > max(MAX_NUMBERS, document.size):
        document.fail("animations", f"{frames.total} frames of {channels} channels in a file of {document.size} bytes")


def play(animation: Animation, nodes: Tree, node: int, path: str, frames: Frames) -> np.ndarray:
    """A path of a node at all frames: (F, 3), for a rotation (F, 4) wxyz; one row only where it does not change."""
    track = animation.tracks.get((node, path))
    if track is None:
        return nodes.rest[path][node : node + 1]
    values = _played(animation, track, path, frames)
    return values if np.ptp(values, axis=0).any() else values[:1]


def _played(animation: Animation, track: Track, path: str, frames: Frames) -> np.ndarray:
    document = animation.document
    keys = _in_frames(animation.times[track.times], frames)
    cubic = track.form == "CUBICSPLINE"
    count = len(keys) * (3 if cubic else 1)
    values = accessors.floats(document, track.values, f"{track.place}.output", PATHS[path], count)
    if path == "rotation":
        values = np.roll(values, 1, axis=1)
        if not cubic:
            values = _unit(document, values, f"accessors[{track.values}]")
    if not cubic:
        return _between(keys, values, frames.total, track.form, path == "rotation")
    arriving, at_keys, leaving = values.reshape(len(keys), 3, -1).transpose(1, 2, 0)
    seconds = frames.frame_time
    at = np.arange(frames.total, dtype=np.float64)
    curves = [
        hermite.evaluate(keys, value, seconds * out, at, seconds * into)
        for into, value, out in zip(arriving, at_keys, leaving, strict=True)
    ]
    result = np.stack(curves, axis=1)
    return _unit(document, result, f"accessors[{track.values}]") if path == "rotation" else result


def _in_frames(times: np.ndarray, frames: Frames) -> np.ndarray:
    """Key times counted in frames; whole where they all but are, so that a frame gets what its key says."""
    exact = (times - frames.first) / frames.frame_time
    if not frames.at_keys:
        return exact
    whole = np.rint(exact)
    slack = _NEAR + 4.0 * 2.0**-24 * np.abs(times) / frames.frame_time
    near = np.where(np.abs(exact - whole) < slack, whole, exact)
    return near if (np.diff(near) > 0).all() else exact


def _unit(document: Document, wxyz: np.ndarray, place: str) -> np.ndarray:
    lengths = np.linalg.norm(wxyz, axis=1, keepdims=True)
    if (lengths < 1e-6).any():
        document.fail(place, "unit quaternions expected, one of length 0 found")
    return wxyz / lengths


def _between(keys: np.ndarray, values: np.ndarray, frames: int, form: str, turning: bool) -> np.ndarray:
    """Values at frames 0, 1, ...: held from key to key, or straight (for quaternions: slerp) between them."""
    at = np.arange(frames, dtype=np.float64)
    last = len(keys) - 1
    before = np.clip(np.searchsorted(keys, at, side="right") - 1, 0, last)
    if form == "STEP" or last == 0:
        return values[before]
    before = np.minimum(before, last - 1)
    share = np.clip((at - keys[before]) / np.diff(keys)[before], 0.0, 1.0)
    if turning:
        return rotation.slerp(values[before], values[before + 1], share)
    share = share[:, None]
    return (1.0 - share) * values[before] + share * values[before + 1]
