"""Motions that `mc.write` put into a glTF file come back with their own channels, unit and frames.

What the file says of them stands in `extras.mocurve` (see gltf.py). Where it no longer fits the nodes, because another
program has changed them, the file is read as any other.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from .. import rotation
from ..errors import FileError, MocurveError
from ..motion import History, Motion
from ..skeleton import AXES, Skeleton
from . import _gltf_read_tracks as tracks
from ._gltf_read_json import Document
from ._gltf_read_tracks import Animation, Frames
from ._gltf_read_tree import Tree, indices

VERSION = 1
_SAME = 1e-4  # of the body's size: how far a node may rest from where it was written
_SKIN, _CLIP = "skins[0].extras.mocurve", "animations.extras.mocurve"


class _Written(NamedTuple):
    """What was written."""

    joints: list[int]  # (J,) their nodes
    body: Skeleton
    scale: float  # metres that a length unit was written as
    frames: Frames
    start: np.ndarray  # (C,) values at the first frame
    history: History


def motion(nodes: Tree, animation: Animation) -> Motion | None:
    """The motion as it was written; None for a file of another program, and with a warning for one that has changed."""
    skins = animation.document.all("skins")
    said = _extras(skins[0]) if skins else None
    timing = _extras(animation.told)
    if said is None or timing is None:
        return None
    try:
        written = _written(nodes, animation, said, timing)
        _check(nodes, animation, written)
        values = _values(nodes, animation, written)
    except FileError as error:
        animation.document.odd.append(f"extras.mocurve does not fit the file and is left aside: {error.message}")
        return None
    return Motion(written.body, values, written.frames.frame_time, written.history)


def _extras(told: dict[str, Any]) -> dict[str, Any] | None:
    extras = told.get("extras")
    mine = extras.get("mocurve") if isinstance(extras, dict) else None
    return mine if isinstance(mine, dict) else None


def _written(nodes: Tree, animation: Animation, said: dict[str, Any], timing: dict[str, Any]) -> _Written:
    document = animation.document
    document.whole(said.get("version"), f"{_SKIN}.version", VERSION, VERSION)
    joints = indices(document, document.all("skins")[0].get("joints"), "skins[0].joints")
    body = _skeleton(document, nodes, joints, said)
    scale = _above_0(document, said.get("scale"), f"{_SKIN}.scale")
    count = document.whole(timing.get("frames"), f"{_CLIP}.frames", 1, 1 << 53)
    frame_time = _above_0(document, timing.get("frame_time"), f"{_CLIP}.frame_time")
    frames = Frames(frame_time, count, at_keys=False)  # the writer has moved the values to where float32 has the keys
    start = document.numbers(timing.get("start"), f"{_CLIP}.start", body.channel_count)
    history = tuple(document.objects(timing.get("history"), f"{_CLIP}.history"))
    return _Written(joints, body, scale, frames, np.array(start), history)


def _above_0(document: Document, value: Any, place: str) -> float:
    number = document.numbers([value], place, 1)[0]
    return number if number > 1e-30 else document.fail(place, f"a number above 0 expected, {number} found")


def _skeleton(document: Document, nodes: Tree, joints: list[int], said: dict[str, Any]) -> Skeleton:
    names = _texts(document, said.get("names"), f"{_SKIN}.names")
    channels = [_texts(document, kinds, f"{_SKIN}.channels") for kinds in _list(document, said, "channels")]
    offsets = [document.numbers(row, f"{_SKIN}.offsets", 3) for row in _list(document, said, "offsets")]
    ends = [document.whole(k, f"{_SKIN}.end_sites", 0, len(joints) - 1) for k in _list(document, said, "end_sites")]
    unit = said.get("unit")
    index = {node: joint for joint, node in enumerate(joints)}
    parents = [index.get(nodes.parents[node], -1) for node in joints]
    try:
        return Skeleton(
            names,
            np.array(parents),
            np.array(offsets),
            tuple(channels),
            np.isin(np.arange(len(joints)), ends),
            None if unit is None else _above_0(document, unit, f"{_SKIN}.unit"),
        )
    except FileError:
        raise
    except MocurveError as error:
        document.fail(_SKIN, str(error))


def _list(document: Document, said: dict[str, Any], name: str) -> list[Any]:
    value = said.get(name)
    return value if isinstance(value, list) else document.fail(f"{_SKIN}.{name}", "a list expected")


def _texts(document: Document, value: Any, place: str) -> tuple[str, ...]:
    if not isinstance(value, list) or not all(isinstance(text, str) for text in value):
        document.fail(place, "a list of strings expected")
    return tuple(value)


def _check(nodes: Tree, animation: Animation, written: _Written) -> None:
    """FileError where nodes or keys are not those that were written."""
    document, joints, body = animation.document, written.joints, written.body
    tracks.check_size(document, written.frames, body.channel_count)
    last = max((float(times[-1]) for times in animation.times.values()), default=0.0)
    if last > written.frames.frame_time * (written.frames.total - 0.5):
        document.fail(f"{_CLIP}.frames", f"{written.frames.total} said, but there is a key at second {last:.6g}")
    places, rest = body.offsets * written.scale, nodes.rest["translation"][joints]
    moves = np.zeros((len(joints), 3), bool)
    positions = ~body.rotation_channels
    moves[body.channel_joints[positions], body.channel_axes[positions]] = True
    slack = _SAME * max(np.abs(places).max(initial=0.0), np.abs(rest).max(initial=0.0))
    wrong = ((np.abs(rest - places) > slack) & ~moves).any(axis=1)
    if wrong.any():
        document.fail(f"nodes[{joints[int(np.argmax(wrong))]}]", "rests elsewhere than it was written")
    still = set(nodes.with_ancestors(set(joints))).difference(joints)
    changed = [node for node in still if not _at_rest(nodes, animation, node, *tracks.PATHS)]
    changed += [node for node in joints if not _at_rest(nodes, animation, node, "scale")]
    if changed:
        document.fail(f"nodes[{changed[0]}]", "moved, turned or scaled since it was written")


def _at_rest(nodes: Tree, animation: Animation, node: int, *paths: str) -> bool:
    """Whether nothing moves these paths of a node away from nothing."""
    nothing = {"translation": (0.0, 0.0, 0.0), "rotation": (1.0, 0.0, 0.0, 0.0), "scale": (1.0, 1.0, 1.0)}
    return node not in nodes.sheared and not any(
        (node, path) in animation.tracks or np.abs(nodes.rest[path][node] - nothing[path]).max() > _SAME
        for path in paths
    )


def _values(nodes: Tree, animation: Animation, written: _Written) -> np.ndarray:
    """The channels (F, C) in their own order; rotations go on from the triple that they started with."""
    values = np.empty((written.frames.total, written.body.channel_count), order="F")
    at = 0
    body = written.body
    for node, kinds, (turning, order) in zip(written.joints, body.channels, body.eulers, strict=True):
        if turning:
            angles = rotation.to_euler(tracks.play(animation, nodes, node, "rotation", written.frames), order)
            near = rotation.unroll_euler(np.vstack([written.start[None, turning], angles]), order)
            values[:, turning] = near[1:]
        if len(turning) < len(kinds):
            places = tracks.play(animation, nodes, node, "translation", written.frames) / written.scale
            for column, kind in enumerate(kinds, at):
                if kind.endswith("position"):
                    values[:, column] = places[:, AXES.index(kind[0])]
        at += len(kinds)
    return values
