"""Rotations as arrays: unit quaternions (..., 4) wxyz, Euler angles (..., n) in degrees, rotation vectors in radians.

An order such as "ZYX" lists the axes as a BVH file lists its channels: R = Rz @ Ry @ Rx, on column vectors. Angles
are turned about the axes that the earlier ones have moved. Any number of axes is allowed, also "XZ" or "ZXZ".
"""

from __future__ import annotations

import numpy as np

from .errors import OptionError

AXES = "XYZ"
CYCLIC = ("XYZ", "YZX", "ZXY")
REAL_JUMP_DEGREES = (
    90.0  # between two frames; gimbal passages of real clips are below 20, lost markers and T-poses above 120
)


def mul(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Hamilton product (..., 4): first b, then a, seen from outside."""
    aw, ax, ay, az = _parts(a)
    bw, bx, by, bz = _parts(b)
    return np.stack(
        [
            aw * bw - ax * bx - ay * by - az * bz,
            aw * bx + ax * bw + ay * bz - az * by,
            aw * by - ax * bz + ay * bw + az * bx,
            aw * bz + ax * by - ay * bx + az * bw,
        ],
        axis=-1,
    )


def inv(q: np.ndarray) -> np.ndarray:
    """The rotation back (..., 4)."""
    return q * np.array([1.0, -1.0, -1.0, -1.0])


def rotate(q: np.ndarray, vectors: np.ndarray) -> np.ndarray:
    """Vectors (..., 3) turned by q (..., 4)."""
    twice = 2.0 * np.cross(q[..., 1:], vectors)
    return vectors + q[..., :1] * twice + np.cross(q[..., 1:], twice)


def exp(vectors: np.ndarray) -> np.ndarray:
    """Quaternion (..., 4) of rotation vectors (..., 3): axis times angle, radians."""
    half = 0.5 * np.asarray(vectors, np.float64)
    angle = np.linalg.norm(half, axis=-1, keepdims=True)
    return np.concatenate([np.cos(angle), half * np.sinc(angle / np.pi)], axis=-1)  # np.sinc(x) is sin(pi x) / (pi x)


def log(q: np.ndarray) -> np.ndarray:
    """Rotation vector (..., 3), radians, of the shorter way: its length is 0 to pi. exp(log(q)) is q or -q."""
    q = np.where(q[..., :1] < 0, -q, q)
    sine = np.linalg.norm(q[..., 1:], axis=-1, keepdims=True)
    near_zero = sine < 1e-12  # there the angle is twice the sine, to the last digit
    safe_sine = np.where(near_zero, 1.0, sine)
    return q[..., 1:] * np.where(near_zero, 2.0, 2.0 * np.arctan2(safe_sine, q[..., :1]) / safe_sine)


def angle(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Degrees (...) that lie between two rotations (..., 4), 0 to 180; exact also where they are nearly the same."""
    turn = mul(inv(a), b)
    return np.degrees(2.0 * np.arctan2(np.linalg.norm(turn[..., 1:], axis=-1), np.abs(turn[..., 0])))


def slerp(a: np.ndarray, b: np.ndarray, t: float | np.ndarray) -> np.ndarray:
    """From a (t = 0) to b (t = 1) the shorter way at constant speed, (..., 4); t broadcasts over the leading axes."""
    b = np.where(np.sum(a * b, axis=-1, keepdims=True) < 0, -b, b)
    t = np.asarray(t, np.float64)[..., None]
    # the angle on the 3-sphere, 0 to 90 degrees, from chords: arccos of the dot would lose half the digits near 0
    arc = 2.0 * np.arctan2(np.linalg.norm(a - b, axis=-1, keepdims=True), np.linalg.norm(a + b, axis=-1, keepdims=True))
    near_zero = arc < 1e-8
    safe_sine = np.where(near_zero, 1.0, np.sin(arc))
    first = np.where(near_zero, 1.0 - t, np.sin((1.0 - t) * arc) / safe_sine)
    return first * a + np.where(near_zero, t, np.sin(t * arc) / safe_sine) * b


def from_euler(degrees: np.ndarray, order: str) -> np.ndarray:
    """Quaternion (..., 4) of Euler angles (..., n) about the n axes of `order`."""
    degrees = _checked(degrees, order)
    half = np.radians(0.5 * degrees)
    w, q = np.ones(degrees.shape[:-1]), [np.zeros(degrees.shape[:-1])] * 3
    for angle, name in enumerate(order):  # times (cos + sin i), where i is the axis and j, k follow it cyclically
        i, j, k = (AXES.index(name) + np.arange(3)) % 3
        c, s = np.cos(half[..., angle]), np.sin(half[..., angle])
        w, q[i], q[j], q[k] = w * c - q[i] * s, q[i] * c + w * s, q[j] * c + q[k] * s, q[k] * c - q[j] * s
    return np.stack([w, *q], axis=-1)


def to_euler(q: np.ndarray, order: str) -> np.ndarray:
    """Euler angles (..., n), degrees, of quaternions (..., 4).

    Three different axes give the middle angle in -90..90, the outer ones in -180..180; in gimbal lock the last angle
    is 0. Where the axes of `order` cannot express the rotation ("XZ", "Y", ""), the angles of the nearest rotation
    that they can. An axis that repeats the one before it, and all after the third, get 0. Source: Bernardes and
    Viollet 2022, Quaternion to Euler angles conversion, PLOS ONE 17(11), which is exact to rounding near gimbal lock
    too.
    """
    q = np.asarray(q, np.float64)
    used = [k for k in range(len(order)) if k == 0 or order[k] != order[k - 1]][:3]
    angles = _checked(np.zeros((*q.shape[:-1], len(order))), order)
    angles[..., used] = np.degrees(_angles(q, "".join(order[k] for k in used)))
    return angles


def unroll(q: np.ndarray) -> np.ndarray:
    """The same rotations (F, ..., 4) with the sign of each quaternion next to the one of the frame before."""
    against = np.sum(q[1:] * q[:-1], axis=-1, keepdims=True) < 0
    odd = np.cumsum(against, axis=0) % 2 == 1
    return np.concatenate([q[:1], np.where(odd, -q[1:], q[1:])])


def unroll_euler(degrees: np.ndarray, order: str) -> np.ndarray:
    """The same rotations (F, n), degrees, written so that no angle jumps more than it must. The first frame is kept.

    Each frame keeps its angles plus whole turns, or takes the other Euler triple of the same rotation, (a+180, 180-b,
    c+180) (for "ZXZ" and its like (a+180, -b, c+180)), where its largest jump from the frame before is smaller.
    Angles that do not jump come back unchanged, and so does a jump of the rotation itself (a T-pose, a lost marker):
    there no triple is the right one.

    Taking the other triple is an isometry and its own inverse, so the jump between two frames depends only on whether
    just one of them is exchanged: the smallest jump frame by frame is also the shortest path over all frames, and
    needs no loop.
    """
    degrees = _checked(degrees, order)
    result = degrees
    if len(order) == 3 and order[1] not in (order[0], order[2]):
        other = degrees + 180.0
        other[:, 1] = (0.0 if order[0] == order[2] else 180.0) - degrees[:, 1]
        exchange = _jump(degrees[:-1], other[1:]) < _jump(degrees[:-1], degrees[1:]) - 1e-9
        at = np.flatnonzero(exchange)  # few
        exchange[at] = angle(from_euler(degrees[at], order), from_euler(degrees[at + 1], order)) < REAL_JUMP_DEGREES
        if exchange.any():
            exchanged = np.concatenate([[False], np.cumsum(exchange) % 2 == 1])
            result = np.where(exchanged[:, None], other, degrees)
    turns = np.zeros_like(result)
    turns[1:] = np.cumsum(np.rint((result[:-1] - result[1:]) / 360.0), axis=0)
    return result + 360.0 * turns


def near_euler(degrees: np.ndarray, order: str, to: np.ndarray) -> np.ndarray:
    """The same rotations (F, n), degrees, each written as near as it can be to other angles (F, n): with whole turns,
    and as the other Euler triple where that is nearer."""
    degrees, to = _checked(degrees, order), _checked(to, order)
    near = degrees - 360.0 * np.rint((degrees - to) / 360.0)
    if len(order) != 3 or order[1] in (order[0], order[2]):
        return near
    other = degrees + 180.0
    other[:, 1] = 180.0 - degrees[:, 1]
    other -= 360.0 * np.rint((other - to) / 360.0)
    nearer = np.abs(other - to).max(axis=1) < np.abs(near - to).max(axis=1)
    return np.where(nearer[:, None], other, near)


def _parts(q: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    return q[..., 0], q[..., 1], q[..., 2], q[..., 3]


def _checked(degrees: np.ndarray, order: str) -> np.ndarray:
    degrees = np.asarray(degrees, np.float64)
    if any(name not in AXES for name in order) or degrees.shape[-1:] != (len(order),):
        raise OptionError(
            f"a rotation order lists one axis of XYZ for each of the {degrees.shape[-1:]} angles, not {order!r}"
        )
    return degrees


def _jump(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Largest difference (F,) of angles (F, 3), not counting whole turns."""
    away = b - a
    away -= 360.0 * np.rint(away / 360.0)
    return np.abs(away).max(axis=1)


def _angles(q: np.ndarray, order: str) -> np.ndarray:
    """Radians (..., n) about up to three axes, no two neighbours the same."""
    if not order:
        return np.zeros((*q.shape[:-1], 0))
    w, i = q[..., 0], q[..., 1 + AXES.index(order[0])]
    if len(order) == 1:
        return 2.0 * np.arctan2(i, w)[..., None]
    missing = next(name for name in AXES if name not in order[:2])
    mirror = (
        1.0 if order[:2] + missing in CYCLIC else -1.0
    )  # seen in a mirror every order is cyclic, and angles change sign
    i = mirror * i
    j, k = (mirror * q[..., 1 + AXES.index(name)] for name in (order[1], missing))
    if len(order) == 2:  # the largest product with q is the largest singular value of [[w, j], [i, k]]
        total, apart = np.arctan2(i + j, w - k), np.arctan2(i - j, w + k)
        return mirror * np.stack([total + apart, total - apart], axis=-1)
    proper = order[0] == order[2]
    a, b, c, d = (w, i, j, k) if proper else (w + j, i + k, w - j, i - k)
    plus, minus = np.hypot(a, b), np.hypot(c, d)
    total, apart = np.arctan2(b, a), np.arctan2(d, c)  # half the sum and half the difference of the outer angles
    middle = 2.0 * np.arctan2(minus, plus) if proper else 2.0 * np.arctan2(plus, minus) - 0.5 * np.pi
    locked = 1e-12  # in gimbal lock one of them is free: the last angle is made 0
    apart, total = np.where(minus < locked, total, apart), np.where(plus < locked, apart, total)
    first, last = (np.remainder(x + np.pi, 2.0 * np.pi) - np.pi for x in (total + apart, total - apart))
    return mirror * np.stack([first, middle, last], axis=-1)
