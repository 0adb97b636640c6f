"""Compiled kernels of slerp.py: straight ways through what each frame allows a joint.

A *way* is a joint's rotation (unit quaternions wxyz, slerp between keys) or its place in the parent's frame (x y z and
a 0, straight lines between keys): states are rows of four numbers in both cases. What a frame allows is told by a Room.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .._jit import kernel

REACH = 512  # frames that a chord may span: a long rest would cost the square of its length
PATIENCE = 4  # frames in a row that no chord reaches before a start is given up
HALF_TURN = 0.1  # dot of two keys with frames between: below, rounding could send the slerp the other way round
SINGULAR = 1e-30


class Room(NamedTuple):
    """What each frame allows one way, all others as they are."""

    turns: bool  # rotation, or place
    origin: np.ndarray  # (F, 4) the state that was given
    stray: np.ndarray  # (F, 4) how far it may be from there: an angle's chord in column 0, or one length an axis
    arms: np.ndarray  # (F, P, 3) points that it carries, in its own frame; of a place in the parent's, from the joint
    targets: np.ndarray  # (F, P, 3) where they must be near, in the parent's frame, from the joint (or the parent)
    limits: np.ndarray  # (F, P) how near
    centre: np.ndarray  # (F, 4) a state in the midst of what is allowed
    inner: np.ndarray  # (F,) whatever is no further from the centre is allowed: distance of the four numbers


@kernel
def product(a, b, out):
    """Hamilton product of two quaternions."""
    w = a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3]
    x = a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2]
    y = a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1]
    z = a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0]
    out[0], out[1], out[2], out[3] = w, x, y, z


@kernel
def matrix(q, m):
    """Rotation matrix (3, 3) of a unit quaternion."""
    w, x, y, z = q
    m[0, 0], m[0, 1], m[0, 2] = 1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)
    m[1, 0], m[1, 1], m[1, 2] = 2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)
    m[2, 0], m[2, 1], m[2, 2] = 2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)


@kernel
def between(turns, a, b, out):
    """What leads from a to b: into out the axis (or the difference) as 1 to 3, and the half angle it takes as 0.

    Returns the dot of two rotations, 1 for places."""
    if not turns:
        for k in range(3):
            out[k + 1] = b[k] - a[k]
        out[0] = 0.0
        return 1.0
    dot = a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3]
    side = 1.0 if dot >= 0.0 else -1.0
    x = side * (a[0] * b[1] - a[1] * b[0] + a[2] * b[3] - a[3] * b[2])
    y = side * (a[0] * b[2] - a[2] * b[0] + a[3] * b[1] - a[1] * b[3])
    z = side * (a[0] * b[3] - a[3] * b[0] + a[1] * b[2] - a[2] * b[1])
    sine = np.sqrt(x * x + y * y + z * z)
    out[0] = np.arctan2(sine, abs(dot))
    safe = sine if sine > SINGULAR else 1.0
    out[1], out[2], out[3] = x / safe, y / safe, z / safe
    return abs(dot)


@kernel
def along(turns, a, way, part, out):
    """The state at a part (0 to 1) of the way from a."""
    if not turns:
        for k in range(3):
            out[k] = a[k] + part * way[k + 1]
        out[3] = 0.0
        return
    s, c = np.sin(part * way[0]), np.cos(part * way[0])
    x, y, z = s * way[1], s * way[2], s * way[3]
    q0 = c * a[0] - x * a[1] - y * a[2] - z * a[3]
    q1 = c * a[1] + x * a[0] + y * a[3] - z * a[2]
    q2 = c * a[2] - x * a[3] + y * a[0] + z * a[1]
    q3 = c * a[3] + x * a[2] - y * a[1] + z * a[0]
    out[0], out[1], out[2], out[3] = q0, q1, q2, q3


@kernel
def sampled(turns, frames, values, out):
    """States (F, 4) at every frame from the first key to the last; a single key is a constant."""
    if len(frames) == 1:
        for f in range(len(out)):
            out[f] = values[0]
    way = np.empty(4)
    for q in range(len(frames) - 1):
        a, n = frames[q], frames[q + 1] - frames[q]
        out[a] = values[q]
        between(turns, values[q], values[q + 1], way)
        for i in range(1, n):
            along(turns, values[q], way, i / n, out[a + i])
        out[a + n] = values[q + 1]


@kernel
def apart(a, b):
    """Distance of four numbers, of two rotations whatever their signs."""
    plus, minus = 0.0, 0.0
    for k in range(4):
        plus += (a[k] - b[k]) ** 2
        minus += (a[k] + b[k]) ** 2
    return np.sqrt(min(plus, minus))


@kernel
def allows(room, f, y, m):
    """Whether frame f allows the state y. m (3, 3): scratch."""
    gone = 0.0
    for k in range(4):
        gone += (y[k] - room.centre[f, k]) ** 2
    if gone <= room.inner[f] * room.inner[f]:
        return True
    if room.turns:
        if apart(y, room.origin[f]) > room.stray[f, 0]:
            return False
        matrix(y, m)
    else:
        for k in range(3):
            if abs(y[k] - room.origin[f, k]) > room.stray[f, k]:
                return False
    for p in range(room.arms.shape[1] - 1, -1, -1):
        x0, x1, x2 = room.arms[f, p, 0], room.arms[f, p, 1], room.arms[f, p, 2]
        if room.turns:
            x0, x1, x2 = (
                m[0, 0] * x0 + m[0, 1] * x1 + m[0, 2] * x2,
                m[1, 0] * x0 + m[1, 1] * x1 + m[1, 2] * x2,
                m[2, 0] * x0 + m[2, 1] * x1 + m[2, 2] * x2,
            )
        else:
            x0, x1, x2 = x0 + y[0], x1 + y[1], x2 + y[2]
        x0, x1, x2 = x0 - room.targets[f, p, 0], x1 - room.targets[f, p, 1], x2 - room.targets[f, p, 2]
        if x0 * x0 + x1 * x1 + x2 * x2 > room.limits[f, p] * room.limits[f, p]:
            return False
    return True


@kernel
def chord_fits(room, i, a, j, b, first, way, y, m):
    """-1 where the chord from state a at frame i to b at frame j is allowed at every frame between, else a frame where
    it is not; looked at first is frame `first`."""
    if between(room.turns, a, b, way) < HALF_TURN and j - i > 1:
        return j - 1
    if i < first < j:
        along(room.turns, a, way, (first - i) / (j - i), y)
        if not allows(room, first, y, m):
            return first
    # a whole step of the way at a time: no sines
    for k in range(4):
        y[k] = a[k]
    part = 1.0 / (j - i)
    s, c = np.sin(part * way[0]), np.cos(part * way[0])
    for k in range(1, 4):
        way[k] *= s if room.turns else part
    way[0] = c
    for t in range(i + 1, j):
        if room.turns:
            product(way, y, y)
        else:
            for k in range(3):
                y[k] += way[k + 1]
        if not allows(room, t, y, m):
            return t
    return -1


@kernel
def fewest(room, states):
    """The fewest chords, none over more than REACH frames, from the first frame to the last between the states
    (F, M, 4) that frames offer: the numbers f * M + m of the chosen states, in order.

    Breadth first: level c holds the states that c chords reach and c - 1 do not. What a frame does not allow is left
    out, and there is always a way: state 0 of each frame counts as allowed."""
    count, choices = states.shape[0], states.shape[1]
    came_from = np.full(count * choices, -1, np.int64)
    level, following = np.empty(count * choices, np.int64), np.empty(count * choices, np.int64)
    way, y, m = np.empty(4), np.empty(4), np.empty((3, 3))
    is_open = np.zeros(count * choices, np.bool_)
    left = np.zeros(count, np.int64)  # states of a frame that no chord has reached yet
    for f in range(count):
        for c in range(choices):
            if c == 0 or allows(room, f, states[f, c], m):
                is_open[f * choices + c] = True
                left[f] += 1
    skip = np.arange(count + 1)  # leads to the next frame with open states
    size = 0
    for c in range(choices):
        if is_open[c]:
            level[size], is_open[c] = c, False
            size += 1
    goal = 0 if count == 1 else -1
    while goal < 0:
        reached = 0
        for at in range(size):
            node = level[at]
            i = node // choices
            a = states[i, node - i * choices]
            failed, patience = -1, PATIENCE
            j = i + 1
            while j < min(count, i + REACH + 1) and patience > 0:
                if left[j] == 0:  # paths are shortened on the way
                    root = j
                    while root < count and left[root] == 0:
                        root = max(skip[root], root + 1)
                    while j < root:
                        after = max(skip[j], j + 1)
                        skip[j] = root
                        j = after
                    j = root
                    continue
                hit = False
                for c in range(choices):
                    other = j * choices + c
                    if not is_open[other]:
                        continue
                    bad = chord_fits(room, i, a, j, states[j, c], failed, way, y, m)
                    if bad >= 0:
                        failed = bad
                        continue
                    hit = True
                    is_open[other], came_from[other] = False, node
                    left[j] -= 1
                    following[reached] = other
                    reached += 1
                    if j == count - 1:
                        goal = other
                        break
                if goal >= 0:
                    break
                patience = PATIENCE if hit else patience - 1
                j += 1
            if goal >= 0:
                break
        level[:reached] = np.sort(following[:reached])[::-1]
        size = reached
    chain = [goal]
    while chain[-1] >= choices:
        chain.append(came_from[chain[-1]])
    return np.array(chain[::-1])
