"""The figure that viewers show: an octahedron around every bone, fixed to the joint that the bone hangs on."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

GIRDLE = 0.2  # where an octahedron is thickest, and
RADIUS = 0.1  # how far it goes out there, in lengths of the bone
LEAST = 1e-6  # of the longest bone; shorter ones are no bones
# corners: the two ends of the bone, then around the girdle; seen from outside a face goes anticlockwise
CORNERS = np.array(
    [[0, 0, 0], [1, 0, 0], *([GIRDLE, RADIUS * y, RADIUS * z] for y, z in ((1, 0), (0, 1), (-1, 0), (0, -1)))]
)
FACES = np.array([face for k in range(4) for face in ([0, 2 + (k + 1) % 4, 2 + k], [1, 2 + k, 2 + (k + 1) % 4])])


class Figure(NamedTuple):
    """Triangles, three corners each: positions and normals (V, 3), and the joint (V,) that a corner moves with."""

    positions: np.ndarray
    normals: np.ndarray
    joints: np.ndarray


def figure(parents: np.ndarray, places: np.ndarray) -> Figure | None:
    """The figure of joints at places (J, 3) at rest, None where no bone has a length."""
    below = np.flatnonzero(parents >= 0)
    above = parents[below]
    bones = places[below] - places[above]
    lengths = np.linalg.norm(bones, axis=1)
    long = lengths > LEAST * lengths.max(initial=0.0)
    if not long.any():
        return None
    above, bones, lengths = above[long], bones[long], lengths[long]
    frames = _frames(bones / lengths[:, None])
    corners = CORNERS[FACES].reshape(-1, 3)
    triangles = CORNERS[FACES]
    faced = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    faced /= np.linalg.norm(faced, axis=1, keepdims=True)
    positions = places[above][:, None] + lengths[:, None, None] * (corners @ frames)
    normals = np.repeat(faced, 3, axis=0) @ frames
    return Figure(positions.reshape(-1, 3), normals.reshape(-1, 3), np.repeat(above, len(corners)))


def _frames(along: np.ndarray) -> np.ndarray:
    """(N, 3, 3): rows are the directions (N, 3) of length 1 and two others square to them, right-handed."""
    least = np.eye(3)[np.argmin(np.abs(along), axis=1)]
    side = np.cross(along, least)
    side /= np.linalg.norm(side, axis=1, keepdims=True)
    return np.stack([along, side, np.cross(along, side)], axis=1)
