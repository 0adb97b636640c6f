"""The nodes of a glTF file as a tree: depth first, each with its rest translation, rotation and scale."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ._gltf_read_json import Document

MAX_JOINTS = 20_000
_SHEAR = 1e-4  # of the matrix's largest number: what a product of float32 matrices may have


class Tree(NamedTuple):
    """All N nodes, as they are numbered in the file."""

    names: list[str]
    parents: list[int]  # -1 for a node that hangs on none
    order: list[int]  # depth first, children in the order of the file
    rest: dict[str, np.ndarray]  # translation (N, 3) metres, rotation (N, 4) wxyz, scale (N, 3), against the parent
    sheared: set[int]  # nodes with a matrix that is more than these three

    def with_ancestors(self, nodes: set[int]) -> list[int]:
        """These nodes and all that they hang on, depth first."""
        wanted = set(nodes)
        for node in nodes:
            parent = self.parents[node]
            while parent >= 0 and parent not in wanted:
                wanted.add(parent)
                parent = self.parents[parent]
        return [node for node in self.order if node in wanted]


def tree(document: Document) -> Tree:
    """The nodes of a file; FileError where they are no tree."""
    nodes = document.all("nodes")
    names = [document.name(node, f"nodes[{i}]") for i, node in enumerate(nodes)]
    parents = _parents(document, nodes)
    count = len(nodes)
    rest = {
        "translation": np.zeros((count, 3)),
        "rotation": np.tile([1.0, 0.0, 0.0, 0.0], (count, 1)),
        "scale": np.ones((count, 3)),
    }
    sheared: set[int] = set()
    for i, node in enumerate(nodes):
        if "matrix" in node:
            if _put_matrix(document, node["matrix"], i, rest):
                sheared.add(i)
            continue
        for path, values in rest.items():
            if path in node:
                numbers = document.numbers(node[path], f"nodes[{i}].{path}", values.shape[1])
                values[i] = np.roll(numbers, 1) if path == "rotation" else numbers  # xyzw in the file
    lengths = np.linalg.norm(rest["rotation"], axis=1, keepdims=True)
    if (lengths < 1e-6).any():
        document.fail(f"nodes[{int(np.argmin(lengths))}].rotation", "a quaternion of length 1 expected, 0 found")
    rest["rotation"] /= lengths
    return Tree(names, parents, _depth_first(document, nodes, parents), rest, sheared)


def joints(document: Document) -> list[int]:
    """The joints of all skins, each once, in the order of the file."""
    found: dict[int, None] = {}
    for i, skin in enumerate(document.all("skins")):
        found.update(dict.fromkeys(indices(document, skin.get("joints"), f"skins[{i}].joints")))
    return list(found)


def indices(document: Document, value: Any, place: str) -> list[int]:
    """A list of indices of nodes."""
    if not isinstance(value, list):
        document.fail(place, "a list of nodes expected")
    for k, node in enumerate(value):
        document.one("nodes", node, f"{place}[{k}]")
    return value


def _parents(document: Document, nodes: list[dict[str, Any]]) -> list[int]:
    parents = [-1] * len(nodes)
    for i, node in enumerate(nodes):
        for child in indices(document, node.get("children", []), f"nodes[{i}].children"):
            if parents[child] >= 0:
                document.fail(f"nodes[{i}].children", f"nodes[{child}] already hangs on nodes[{parents[child]}]")
            parents[child] = i
    return parents


def _depth_first(document: Document, nodes: list[dict[str, Any]], parents: list[int]) -> list[int]:
    order: list[int] = []
    waiting = [i for i in range(len(nodes) - 1, -1, -1) if parents[i] < 0]
    while waiting:
        order.append(waiting.pop())
        waiting += reversed(nodes[order[-1]].get("children", []))
    if len(order) < len(nodes):
        lost = min(set(range(len(nodes))) - set(order))
        document.fail(f"nodes[{lost}]", "its parents go round in a circle")
    return order


def _put_matrix(document: Document, value: Any, node: int, rest: dict[str, np.ndarray]) -> bool:
    """Take a matrix (columns one after the other) apart; a mirroring one gets a negative scale on X. True: sheared."""
    matrix = np.array(document.numbers(value, f"nodes[{node}].matrix", 16)).reshape(4, 4).T
    rest["translation"][node] = matrix[:3, 3]
    scale = np.linalg.norm(matrix[:3, :3], axis=0)
    rest["scale"][node] = scale
    if scale.min() <= 1e-12 * scale.max():  # flat: there is no rotation to be had from it
        return False
    if np.linalg.det(matrix[:3, :3] / scale) < 0:
        scale[0] = -scale[0]
    left, _, right = np.linalg.svd(matrix[:3, :3] / scale)
    turn = left @ right
    rest["rotation"][node], rest["scale"][node] = _quaternion(turn), scale
    return bool(np.abs(turn * scale - matrix[:3, :3]).max() > _SHEAR * np.abs(scale).max())


def _quaternion(matrix: np.ndarray) -> np.ndarray:
    """wxyz of a rotation matrix: the longest row of 4 q q^T, which is well away from 0."""
    (xx, xy, xz), (yx, yy, yz), (zx, zy, zz) = matrix.tolist()
    rows = np.array(
        [
            [1 + xx + yy + zz, zy - yz, xz - zx, yx - xy],
            [zy - yz, 1 + xx - yy - zz, xy + yx, xz + zx],
            [xz - zx, xy + yx, 1 - xx + yy - zz, yz + zy],
            [yx - xy, xz + zx, yz + zy, 1 - xx - yy + zz],
        ]
    )
    return rows[np.argmax(rows.diagonal())]
