"""A curve taken apart into bands an octave wide, and put together again (Bruderlin and Williams 1995; here
without decimation: Burt and Adelson's kernel, spread by powers of two).

Band 0 is the finest: what the first smoothing takes away. Band k is what the next one takes away, whose kernel is twice
as wide; what is left after the last is the slow rest. All bands and the rest add up to the curve.
"""

from __future__ import annotations

import numpy as np

from .. import rotation
from ._turns import told_axis

KERNEL = np.array([1.0, 4.0, 6.0, 4.0, 1.0]) / 16.0
LONG = np.radians(150.0)  # a joint that turns further away from its first pose may turn on and on
UNTOLD = 0.1  # a body that turns on about all axes has no twist to count
NARROW = 1e-6  # of a mean of rotations: shorter means that they point everywhere


def count(frames: int) -> int:
    """How many bands so many frames have: the widest kernel reaches no further than the clip is long."""
    return int(np.floor(np.log2((frames - 1) / 2.0))) + 1 if frames >= 3 else 0


def edges(bands: int, frame_time: float) -> np.ndarray:
    """(bands + 1,) Hz: band k lies between edges k + 1 and k. At an edge the smoothing has halved what swings there."""
    low, high = np.zeros(bands), np.full(bands, 0.25 / frame_time)
    for _ in range(60):  # halving: what passes falls with the frequency
        middle = 0.5 * (low + high)
        passes = np.array([_passes(f, k + 1, frame_time) for k, f in enumerate(middle)])
        low, high = np.where(passes > 0.5, middle, low), np.where(passes > 0.5, high, middle)
    return np.concatenate([[0.5 / frame_time], low])


def shaped(values: np.ndarray, gains: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Curves (F, n) with each band times its gain (K,), and the bands (K, F, n). Where all gains are 1, as they are."""
    bands = np.empty((len(gains), *values.shape))
    result = smooth = values
    for k, gain in enumerate(gains):
        smoother = _smoothed(_mirrored(smooth, 2 << k), k)
        bands[k] = smooth - smoother
        result = result + (gain - 1.0) * bands[k]
        smooth = smoother
    return result, bands


def turned(wxyz: np.ndarray, gains: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Rotations (F, 4) with the turn of each band times its gain, and the bands (K, F, 3), radians.

    A band is the rotation vector from the smoother track to the finer one, so that a gain multiplies angles. What
    turns on and on is counted as an angle about a coordinate axis, the one that the rest of it is least turned away
    from (the vertical of a body that walks in circles); that rest is a track of its own.
    """
    track = rotation.unroll(wxyz)
    away = rotation.mul(rotation.inv(track[:1]), track)
    far = 2.0 * np.arccos(np.clip(away[:, 0].min(initial=1.0), -1.0, 1.0)) > LONG
    axis = told_axis(track)
    least = (track[:, 1 + axis] ** 2 + track[:, 0] ** 2).min(initial=1.0)  # where it is 0 a twist is not defined
    if not far or least < UNTOLD:
        return _of_track(track, gains)
    twist = 2.0 * np.unwrap(np.arctan2(track[:, 1 + axis], track[:, 0]))[:, None]
    about = np.eye(3)[axis]
    angle, by_angle = shaped(twist, gains)
    rest = rotation.mul(rotation.inv(rotation.exp(twist * about)), track)
    made, bands = _of_track(rotation.unroll(rest), gains)
    return rotation.mul(rotation.exp(angle * about), made), bands + by_angle * about


# -- in call order ---------------------------------------------------------------------------------


def _passes(hertz: float, smoothings: int, frame_time: float) -> float:
    """What is left of a swing of this frequency after so many smoothings."""
    return float(np.prod([np.cos(np.pi * hertz * frame_time * (1 << k)) ** 4 for k in range(smoothings)]))


def _mirrored(values: np.ndarray, reach: int) -> np.ndarray:
    """With `reach` rows more at both ends, turned about the end itself: a straight line goes on straight."""
    before = 2.0 * values[:1] - values[reach:0:-1]
    after = 2.0 * values[-1:] - values[-2 : -2 - reach : -1]
    return np.concatenate([before, values, after])


def _mirrored_turns(track: np.ndarray, reach: int) -> np.ndarray:
    """The same of rotations: beyond the end each is as far on the other side of it."""

    def beyond(end: np.ndarray, inside: np.ndarray) -> np.ndarray:
        return 2.0 * (inside @ end)[:, None] * end - inside  # q p^-1 q of unit quaternions, on the same side

    before = beyond(track[0], track[reach:0:-1])
    after = beyond(track[-1], track[-2 : -2 - reach : -1])
    return np.concatenate([before, track, after])


def _smoothed(padded: np.ndarray, k: int) -> np.ndarray:
    """The kernel with its weights 2^k rows apart, over rows with 2^(k + 1) more at both ends."""
    step, size = 1 << k, len(padded) - (4 << k)
    return np.sum([weight * padded[i * step : i * step + size] for i, weight in enumerate(KERNEL)], axis=0)


def _of_track(track: np.ndarray, gains: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    bands = np.empty((len(gains), len(track), 3))
    finer = track
    for k in range(len(gains)):
        mean = _smoothed(_mirrored_turns(finer, 2 << k), k)
        size = np.linalg.norm(mean, axis=1, keepdims=True)
        smoother = np.where(size > NARROW, mean / np.maximum(size, NARROW), finer)
        bands[k] = rotation.log(rotation.mul(rotation.inv(smoother), finer))
        finer = rotation.unroll(smoother)
    made = finer
    for k in range(len(gains) - 1, -1, -1):
        made = rotation.mul(made, rotation.exp(gains[k] * bands[k]))
    return made, bands
