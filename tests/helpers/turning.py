"""Bodies that turn: what the tests of blending, displacements and warps share."""

from __future__ import annotations

import numpy as np

import mocurve as mc
from mocurve import kinematics, rotation
from mocurve.motion import Clip
from mocurve.spline import SplineMotion

FRAMES, FRAME_TIME = 201, 1 / 100
CHANNELS = ("Xposition", "Yposition", "Zposition", "Zrotation", "Xrotation", "Yrotation")
ALONG = np.linspace(0.0, 1.0, FRAMES)


def turning(heading: np.ndarray, tilt: float) -> mc.Motion:
    """Hips that turn about the vertical by `heading` (F,), degrees, and sway by `tilt` degrees while they do."""
    sway = tilt * np.stack([np.sin(9 * ALONG), np.cos(5 * ALONG)], axis=1)
    about = np.radians(heading)[:, None] * [0.0, 1.0, 0.0]
    angles = rotation.to_euler(rotation.mul(rotation.exp(about), rotation.from_euler(sway, "ZX")), "ZXY")
    body = mc.Skeleton(("Hips",), np.array([-1]), np.zeros((1, 3)), (CHANNELS,))
    return mc.Motion(body, np.hstack([np.outer(ALONG, [1.0, 2.0, 3.0]), angles]), FRAME_TIME)


def heading(motion: mc.Motion) -> np.ndarray:
    """Degrees (F,), whole turns counted, that the hips look away from +z."""
    ahead = rotation.rotate(kinematics.rotations(motion)[:, 0], np.array([0.0, 0.0, 1.0]))
    return np.degrees(np.unwrap(np.arctan2(ahead[:, 0], ahead[:, 2])))


def widest_step(motion: mc.Motion) -> float:
    """Degrees that some joint turns from one frame to the next, at most."""
    turned = kinematics.rotations(motion)
    return float(rotation.angle(turned[1:], turned[:-1]).max())


def apart(a: Clip, b: Clip) -> float:
    """How far two clips are apart: degrees that a joint is turned, units or degrees that another channel is off."""
    first, second = a.sample(), b.sample()
    moved = np.abs(first.values - second.values)[:, ~first.skeleton.rotation_channels]
    turned = rotation.angle(kinematics.rotations(first), kinematics.rotations(second))
    return float(max(turned.max(initial=0.0), moved.max(initial=0.0)))


def spline(skeleton: mc.Skeleton, count: int, degree: int, seed: int, duration: float = 2.0) -> SplineMotion:
    """Curves with random coefficients on even, clamped knots."""
    dice = np.random.default_rng(seed)
    knots = np.concatenate([np.zeros(degree), np.linspace(0, duration, count - degree + 1), np.full(degree, duration)])
    values = dice.normal(0, 20, (count, skeleton.channel_count))
    return SplineMotion(skeleton, knots, values, degree, FRAME_TIME, round(duration / FRAME_TIME) + 1)
