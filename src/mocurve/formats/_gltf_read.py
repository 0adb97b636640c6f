"""A skeletal animation of a GLB or glTF file as a Motion: metres, a joint a node.

A node's rotation replaces its rest, and so does a Motion's: what a joint has as channels is its whole rotation against
its parent, and its offset is the translation of the node. Scale is worked into the translations below it.
"""

from __future__ import annotations

import os
import warnings
from collections.abc import Sequence

import numpy as np

from .. import rotation
from ..motion import Motion
from ..skeleton import AXES, Skeleton
from . import _gltf_read_own as own
from . import _gltf_read_rate as rate
from . import _gltf_read_tracks as tracks
from ._files import Path
from ._gltf_read_json import Document
from ._gltf_read_tracks import Animation, Frames
from ._gltf_read_tree import MAX_JOINTS, Tree, joints, tree

ORDER = "ZYX"
_POSITIONS, _ROTATIONS = tuple(f"{axis}position" for axis in AXES), tuple(f"{axis}rotation" for axis in ORDER)
_STILL = 1e-6  # of the body's largest coordinate: a translation that moves less does not move
_LARGEST = 1e60  # metres or scale: far from what a number holds, so that nothing overflows
_SAME = 1e-4  # relative: scales that differ less between the axes are one


def read(path: Path, *, animation: str | None = None) -> Motion:
    """The animation of that name, else the first, of the joints of all skins and of what they hang on.

    Without a skin (or where none of its joints moves) of all animated nodes and what they hang on. Joints of other
    programs' files get rotation channels ZYX, and position channels where they move against their parents; what
    `mc.write` has written gets its own channels, unit and frames back. FileError names the place that is wrong,
    UnknownName lists the animations.
    """
    document = Document(path)
    nodes = tree(document)
    found = tracks.animation(document, animation)
    mine = own.motion(nodes, found)
    motion = _motion(nodes, found) if mine is None else mine
    for text in document.odd:
        warnings.warn(f"{os.fsdecode(path)}: {text}", stacklevel=4)
    return motion


def _motion(nodes: Tree, animation: Animation) -> Motion:
    document = animation.document
    if not animation.tracks:
        document.fail("animations", "none that moves a node: there is no motion to read")
    body = _body(nodes, animation)
    frames, frame_time = rate.guessed(list(animation.times.values()), document.odd)
    tracks.check_size(document, frames, 3 * len(body) + 3)
    places = _places(nodes, animation, body, frames)
    index = {node: joint for joint, node in enumerate(body)}
    parents = [index.get(nodes.parents[node], -1) for node in body]
    still = _STILL * max(float(np.abs(place).max()) for place in places)
    moved = [
        parent < 0 or bool(np.ptp(place, axis=0).max() > still) for parent, place in zip(parents, places, strict=True)
    ]
    skeleton = Skeleton(
        tuple(nodes.names[node] for node in body),
        np.array(parents),
        np.array([place[0] for place in places]),
        tuple((*_POSITIONS, *_ROTATIONS) if moves else _ROTATIONS for moves in moved),
        unit=1.0,
    )
    values = np.empty((frames.total, skeleton.channel_count), order="F")
    at = 0
    for node, place, moves in zip(body, places, moved, strict=True):
        if moves:
            values[:, at : at + 3] = place
            at += 3
        turned = rotation.to_euler(tracks.play(animation, nodes, node, "rotation", frames), ORDER)
        values[:, at : at + 3] = rotation.unroll_euler(turned, ORDER)
        at += 3
    return Motion(skeleton, values, frame_time)


def _body(nodes: Tree, animation: Animation) -> list[int]:
    """The nodes that become joints, depth first."""
    document = animation.document
    animated = {node for node, _ in animation.tracks}
    body = nodes.with_ancestors(set(joints(document)))
    if animated.isdisjoint(body):
        body = nodes.with_ancestors(animated)
    _tell(document.odd, "animated nodes that are no joints are dropped", nodes, sorted(animated.difference(body)))
    _tell(document.odd, "shear is dropped", nodes, [node for node in body if node in nodes.sheared])
    if len(body) > MAX_JOINTS:
        document.fail("nodes", f"at most {MAX_JOINTS} joints expected, {len(body)} found")
    return body


def _places(nodes: Tree, animation: Animation, body: list[int], frames: Frames) -> list[np.ndarray]:
    """Translations against the parents with all scales worked in: (F, 3), or (1, 3) where nothing moves.

    A scale that is the same along all axes goes down to all that hangs on the node, also where it changes. One that
    is not would shear what turns below it: the nodes right below are put where it puts them, further down goes the
    scale that keeps the volume.
    """
    whole: dict[int, np.ndarray] = {-1: np.ones((1, 1))}  # what reaches the nodes below, from all above
    right_below: dict[int, np.ndarray] = {-1: np.ones((1, 3))}
    places, uneven = [], []
    for node in body:
        parent = nodes.parents[node]
        places.append(tracks.play(animation, nodes, node, "translation", frames) * right_below[parent])
        scale = tracks.play(animation, nodes, node, "scale", frames)
        even = np.cbrt(np.prod(scale, axis=1, keepdims=True))
        if (np.abs(scale - even) > _SAME * np.abs(scale).max(axis=1, keepdims=True)).any():
            uneven.append(node)
        else:
            scale = even
        right_below[node], whole[node] = whole[parent] * scale, whole[parent] * even
        if max(np.abs(places[-1]).max(), np.abs(whole[node]).max()) > _LARGEST:
            animation.document.fail(f"nodes[{node}]", "scaled to more than any length")
    parents = {nodes.parents[node] for node in body}
    told = "scale that differs between the axes is kept only for the joints right below"
    _tell(animation.document.odd, told, nodes, [node for node in uneven if node in parents])
    return places


def _tell(odd: list[str], what: str, nodes: Tree, which: Sequence[int]) -> None:
    if which:
        names = ", ".join(nodes.names[node] for node in which[:5]) + (" …" if len(which) > 5 else "")
        odd.append(f"{what}: {names}")
