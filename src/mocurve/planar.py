"""Planar rigid transforms: a turn about the vertical and a shift on the ground, as arrays (..., 3) of angle, x, z.

The angle is in radians and turns +z towards +x; y is up. Places are (..., 3) x, y, z; their heights never change. A
clip may begin anywhere and face anywhere, so two poses are compared after the planar transform that brings them
nearest (Kovar, Gleicher and Pighin 2002, Motion graphs, section 3.1).
"""

from __future__ import annotations

import numpy as np

from .errors import Mismatch, OptionError

CHUNK = 4_000_000  # pairs of frames at once: 32 MB an array


def compose(outer: np.ndarray, inner: np.ndarray) -> np.ndarray:
    """First inner, then outer (..., 3)."""
    x, z = _turned(outer[..., 0], inner[..., 1], inner[..., 2])
    return np.stack([outer[..., 0] + inner[..., 0], outer[..., 1] + x, outer[..., 2] + z], axis=-1)


def inverse(planar: np.ndarray) -> np.ndarray:
    """The way back (..., 3)."""
    x, z = _turned(-planar[..., 0], -planar[..., 1], -planar[..., 2])
    return np.stack([-planar[..., 0], x, z], axis=-1)


def power(planar: np.ndarray, exponent: float | np.ndarray) -> np.ndarray:
    """The transform done `exponent` times, also a fraction or less than none: a screw about one fixed centre.

    power(g, a + b) is compose(power(g, a), power(g, b)).
    """
    return exp(np.asarray(exponent, np.float64)[..., None] * log(planar))


def log(planar: np.ndarray) -> np.ndarray:
    """(..., 3) the turn and the constant velocity x, z of the screw that is done in one unit of time.

    The shift is S(angle) v, S(angle) = [[sin, 1 - cos], [cos - 1, sin]] / angle; for a straight walk (angle 0) it is 1,
    and no exception.
    """
    sine, versine = _screw(np.asarray(planar[..., 0]))
    size = sine * sine + versine * versine  # 0 only at whole turns, which have no screw unless they do not shift
    if np.any((size < 1e-20) & (np.hypot(planar[..., 1], planar[..., 2]) > 0)):
        raise OptionError("a whole turn that also shifts has no centre, and so no fractional power")
    size = np.where(size < 1e-20, 1.0, size)
    vx = (sine * planar[..., 1] - versine * planar[..., 2]) / size
    vz = (versine * planar[..., 1] + sine * planar[..., 2]) / size
    return np.stack([planar[..., 0], vx, vz], axis=-1)


def exp(screw: np.ndarray) -> np.ndarray:
    """The transform (..., 3) after one unit of time of such a screw."""
    angle, vx, vz = screw[..., 0], screw[..., 1], screw[..., 2]
    sine, versine = _screw(angle)
    return np.stack([angle, sine * vx + versine * vz, sine * vz - versine * vx], axis=-1)


def move(planar: np.ndarray, places: np.ndarray) -> np.ndarray:
    """Places (..., 3) turned and shifted; planar (..., 3) broadcasts against them."""
    x, z = _turned(planar[..., 0], places[..., 0], places[..., 2])
    return np.stack(np.broadcast_arrays(x + planar[..., 1], places[..., 1], z + planar[..., 2]), axis=-1)


def quaternion(planar: np.ndarray) -> np.ndarray:
    """The turn as quaternion (..., 4) wxyz."""
    half = 0.5 * planar[..., 0]
    none = np.zeros_like(half)
    return np.stack([np.cos(half), none, np.sin(half), none], axis=-1)


def align(target: np.ndarray, places: np.ndarray, weights: np.ndarray | None = None) -> np.ndarray:
    """The transform (..., 3) that brings places (..., N, 3) nearest to target (..., N, 3), with weights (N,) or none.

    Least squares in closed form: Kovar 2002, equations 2 to 4.
    """
    shares = _shares(weights, target.shape[-2])
    middle, own = ((points * shares[:, None]).sum(axis=-2, keepdims=True) for points in (target, places))
    to, of = target - middle, places - own
    along = (shares * (to[..., 0] * of[..., 0] + to[..., 2] * of[..., 2])).sum(axis=-1)
    across = (shares * (to[..., 0] * of[..., 2] - to[..., 2] * of[..., 0])).sum(axis=-1)
    angle = np.arctan2(across, along)
    x, z = _turned(angle, own[..., 0, 0], own[..., 0, 2])
    return np.stack([angle, middle[..., 0, 0] - x, middle[..., 0, 2] - z], axis=-1)


def frame_distances(
    first: np.ndarray, second: np.ndarray, window: int = 1, weights: np.ndarray | None = None
) -> np.ndarray:
    """How far the windows of two clips are apart, each pair after its best planar alignment: (A - w + 1, B - w + 1).

    first:   places (A, J, 3); second: (B, J, 3), of the same joints.
    window:  frames: entry [i, j] compares frames i ... i + window - 1 of the first with j ... of the second.
    weights: (J,), by default all the same.

    Entries are root mean squares in the places' own unit. No pair is looked at alone: with every window centred,
    the least squared distance is |p|^2 + |q|^2 - 2 (Y + |C + iS|), where Y, C and S, the products of heights, the dot
    and the cross products on the ground, are matrix products over all pairs (the solution of `align`, put in).
    """
    if first.ndim != 3 or first.shape[1:] != second.shape[1:]:
        raise Mismatch(f"places of shape {first.shape} and {second.shape} are not of the same joints")
    if not 1 <= window <= min(len(first), len(second)):
        raise OptionError(f"a window of {window} frames does not fit clips of {len(first)} and {len(second)} frames")
    shares = _shares(weights, first.shape[1])
    level = float(first[..., 1].mean())  # any height that both share: near 0 the squares keep their digits
    (ground, height, size), (others, heights, sizes) = (
        _windows(places, window, shares, level) for places in (first, second)
    )
    half = ground.shape[1] // 2
    crossed = np.concatenate([others[:, half:], -others[:, :half]], axis=1)
    result = np.empty((len(ground), len(others)))
    rows = max(1, CHUNK // len(others))
    for start in range(0, len(ground), rows):
        part = slice(start, start + rows)
        near = np.hypot(ground[part] @ others.T, ground[part] @ crossed.T)
        near += height[part] @ heights.T
        result[part] = np.sqrt(np.maximum(size[part, None] + sizes - 2.0 * near, 0.0))
    return result


def _turned(angle: np.ndarray, x: np.ndarray, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    cosine, sine = np.cos(angle), np.sin(angle)
    return cosine * x + sine * z, cosine * z - sine * x


def _screw(angle: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """sin(a) / a and (1 - cos(a)) / a, exact also near 0."""
    half = np.sinc(0.5 * angle / np.pi)  # sin(a / 2) / (a / 2)
    return np.sinc(angle / np.pi), 0.5 * angle * half * half


def _shares(weights: np.ndarray | None, count: int) -> np.ndarray:
    """Weights (count,) that add up to 1."""
    given = np.ones(count) if weights is None else np.asarray(weights, np.float64)
    if given.shape != (count,) or not (given >= 0).all() or not 0 < given.sum() < np.inf:
        raise OptionError(f"weights are {count} numbers, none negative and not all zero")
    return given / given.sum()


def _windows(
    places: np.ndarray, window: int, shares: np.ndarray, level: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Per window, centred on the ground and weighted: x then z (W, 2 w J), heights (W, w J), mean square size (W,)."""
    stacked = np.lib.stride_tricks.sliding_window_view(places, window, axis=0)  # (W, J, 3, w)
    x, y, z = (stacked[:, :, axis].transpose(0, 2, 1) for axis in range(3))  # each (W, w, J)
    root = np.sqrt(shares / window)
    parts = [(part - (part * shares).sum(axis=(1, 2), keepdims=True) / window) * root for part in (x, z)]
    ground = np.concatenate([part.reshape(len(x), -1) for part in parts], axis=1)
    height = ((y - level) * root).reshape(len(x), -1)
    return ground, height, np.einsum("wk,wk->w", ground, ground) + np.einsum("wk,wk->w", height, height)
