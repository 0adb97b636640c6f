"""Compiled kernels of slerp.py: the pose that all ways make together, and what it leaves to each of them.

Places of points are (F, P, 3), states of joints (J, F, 4).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .._jit import kernel
from ._slerp import allows, along, apart, between, matrix, product
from ._slerp_fit import measure, move, solve3
from ._tubes import Body

SWEEPS = 5  # towards the midst of what a frame allows
TRIALS = 8  # to find how far the edge is from the midst


class Scene(NamedTuple):
    """The clip as its ways make it now."""

    body: Body
    last_joint: np.ndarray  # (J,) one past the last joint at or below a joint
    turned: np.ndarray  # (J, F, 4) rotations against the parent
    placed: np.ndarray  # (J, F, 4) places in the parent's frame, x y z 0
    heading: np.ndarray  # (J, F, 4) rotations in the world
    points: np.ndarray  # (F, P, 3) where the points are now
    target: np.ndarray  # (F, P, 3) where they were
    limits: np.ndarray  # (F, P) how far they may be from there


@kernel
def turn_back(q, m):
    """Matrix (3, 3) of the rotation back."""
    matrix(q, m)
    for a in range(3):
        for b in range(a):
            m[a, b], m[b, a] = m[b, a], m[a, b]


@kernel
def pose(scene, begin, end):
    """Forward kinematics of joints begin to end at all frames: their headings and points."""
    body, m = scene.body, np.empty((3, 3))
    for j in range(begin, end):
        parent = body.parents[j]
        own = body.first_point[j]
        for f in range(len(scene.points)):
            x, y, z = scene.placed[j, f, 0], scene.placed[j, f, 1], scene.placed[j, f, 2]
            if parent < 0:
                scene.heading[j, f] = scene.turned[j, f]
                scene.points[f, own, 0], scene.points[f, own, 1], scene.points[f, own, 2] = x, y, z
            else:
                matrix(scene.heading[parent, f], m)
                above = body.first_point[parent]
                for a in range(3):
                    scene.points[f, own, a] = scene.points[f, above, a] + m[a, 0] * x + m[a, 1] * y + m[a, 2] * z
                product(scene.heading[parent, f], scene.turned[j, f], scene.heading[j, f])
            if own + 1 == body.first_point[j + 1]:
                continue
            matrix(scene.heading[j, f], m)
            for p in range(own + 1, body.first_point[j + 1]):
                x, y, z = body.shell[p]
                for a in range(3):
                    scene.points[f, p, a] = scene.points[f, own, a] + m[a, 0] * x + m[a, 1] * y + m[a, 2] * z


@kernel
def worst(scene):
    """Largest distance of any point from its target, in its limits; a limit of 0 holds only exactly."""
    most = 0.0
    for f in range(scene.points.shape[0]):
        for p in range(scene.points.shape[1]):
            off = 0.0
            for a in range(3):
                off += (scene.points[f, p, a] - scene.target[f, p, a]) ** 2
            if off > 0.0:
                most = max(most, np.sqrt(off) / scene.limits[f, p])
    return most


@kernel
def furnish(scene, joint, room):
    """Fill the room of a joint's rotation or place: its arms, targets and limits."""
    body, m = scene.body, np.empty((3, 3))
    own, parent = body.first_point[joint], body.parents[joint]
    first = own + 1 if room.turns else own
    start = np.zeros(3)
    for f in range(len(scene.points)):
        if room.turns:
            turn_back(scene.heading[joint, f], m)
        elif parent >= 0:
            turn_back(scene.heading[parent, f], m)
        else:
            m[:] = np.eye(3)
        for i in range(room.arms.shape[1]):
            x, y, z = (
                scene.points[f, first + i, 0] - scene.points[f, own, 0],
                scene.points[f, first + i, 1] - scene.points[f, own, 1],
                scene.points[f, first + i, 2] - scene.points[f, own, 2],
            )
            for a in range(3):
                room.arms[f, i, a] = m[a, 0] * x + m[a, 1] * y + m[a, 2] * z
        if parent >= 0:
            turn_back(scene.heading[parent, f], m)
        else:
            m[:] = np.eye(3)
        for a in range(3):
            if room.turns:
                start[a] = scene.points[f, own, a]
            elif parent >= 0:
                start[a] = scene.points[f, body.first_point[parent], a]
        for i in range(room.arms.shape[1]):
            x, y, z = (
                scene.target[f, first + i, 0] - start[0],
                scene.target[f, first + i, 1] - start[1],
                scene.target[f, first + i, 2] - start[2],
            )
            for a in range(3):
                room.targets[f, i, a] = m[a, 0] * x + m[a, 1] * y + m[a, 2] * z
            room.limits[f, i] = scene.limits[f, first + i]


@kernel
def find_centre(room, states):
    """Fill the room's centre and inner from the states (F, 4) as they are now, frame by frame: the state whose worst
    point is furthest inside, by reweighted Newton steps."""
    hessian, pull = np.empty((3, 3)), np.empty(3)
    m, y = np.empty((4, 3)), np.empty(4)
    for f in range(len(states)):
        best = np.inf
        y[:] = states[f]
        for sweep in range(SWEEPS + 1):
            ratio = measure(room, f, y, hessian, pull, m)
            if ratio < best:
                best = ratio
                room.centre[f] = y
            if sweep == SWEEPS or not solve3(hessian, pull):
                break
            move(room.turns, y, pull)
        room.inner[f] = free_about(room, f, m)


@kernel
def free_about(room, f, m):
    """How far the four numbers may be from the centre, whichever way."""
    c = room.centre[f]
    if room.turns:
        least = room.stray[f, 0] - apart(c, room.origin[f])
        matrix(c, m)
    else:
        least = np.inf
        for a in range(3):
            least = min(least, room.stray[f, a] - abs(c[a] - room.origin[f, a]))
    for p in range(room.arms.shape[1]):
        off, arm = 0.0, 0.0
        for a in range(3):
            x = room.arms[f, p, a] + c[a]
            if room.turns:
                x = m[a, 0] * room.arms[f, p, 0] + m[a, 1] * room.arms[f, p, 1] + m[a, 2] * room.arms[f, p, 2]
            off += (x - room.targets[f, p, a]) ** 2
            arm += room.arms[f, p, a] ** 2
        # a turn by t is 2 sin(t / 4) away and moves a point by 2 sin(t / 2) of its arm
        reach = 2.0 * np.sqrt(arm) if room.turns else 1.0
        if reach > 0.0:
            least = min(least, (room.limits[f, p] - np.sqrt(off)) / reach)
    return max(least, 0.0)


@kernel
def offer(room, frames, states):
    """Fill states (F, M, 4), from choice 2 on: from the centre outward, against the way it bends over the span of its
    keys (frames), half way and nearly all the way to the edge: there a chain of chords has its corners."""
    count, choices = states.shape[0], states.shape[1]
    way, y, m, out = np.empty(4), np.empty(4), np.empty((3, 3)), np.empty(3)
    q = 0
    for f in range(count if choices > 2 else 0):
        while q + 2 < len(frames) and frames[q + 1] <= f:
            q += 1
        wide = max(1, (frames[min(q + 1, len(frames) - 1)] - frames[q]) // 2)
        a, b = max(0, f - wide), min(count - 1, f + wide)
        for c in range(2, choices):
            states[f, c] = room.centre[f]
        if a == f or b == f:
            continue
        between(room.turns, room.centre[a], room.centre[b], way)
        along(room.turns, room.centre[a], way, (f - a) / (b - a), y)
        between(room.turns, y, room.centre[f], way)
        size = np.sqrt(way[1] ** 2 + way[2] ** 2 + way[3] ** 2)
        if size < 1e-12 or (room.turns and way[0] < 1e-12):
            continue
        for k in range(3):
            out[k] = way[k + 1] / size
        low, high, beyond = 0.0, max(room.inner[f], 1e-12), False
        for _ in range(TRIALS):
            far = 0.5 * (low + high) if beyond else 2.0 * high
            y[:] = room.centre[f]
            move(room.turns, y, out * far)
            fits = allows(room, f, y, m)
            beyond = beyond or not fits
            if fits:
                low = far
            if beyond != fits:
                high = far
        for c in range(2, choices):
            states[f, c] = room.centre[f]
            move(room.turns, states[f, c], out * (low * (c - 1.0) / (choices - 2.0) * 0.95))
