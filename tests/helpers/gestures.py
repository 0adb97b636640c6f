"""Movements whose truth is known, in degrees: what the tests of denoising share."""

from __future__ import annotations

import numpy as np

import mocurve as mc

TURNS = ("Zrotation", "Xrotation", "Yrotation")
PLACES = ("Xposition", "Yposition", "Zposition")


def swing(frames: int, fps: float, channels: int = 3, seed: int = 0) -> np.ndarray:
    """(F, C) smooth degrees: three harmonics of about 0.8 Hz, some 20 degrees wide."""
    rng = np.random.default_rng(seed)
    t = np.arange(frames)[:, None] / fps
    base = rng.uniform(0.6, 1.0, channels)
    parts = [
        rng.uniform(8, 24, channels) / k**1.5 * np.sin(2 * np.pi * k * base * t + rng.uniform(0, 6, channels))
        for k in (1, 2, 3)
    ]
    return np.sum(parts, axis=0)


def kick(frames: int, fps: float, at: float = 2.0, size: float = 50.0, half: float = 0.13) -> np.ndarray:
    """(F,) degrees: there and back within 2 * half seconds about the time `at`."""
    t = np.arange(frames) / fps - at
    return size * np.where(np.abs(t) < half, np.cos(np.pi * t / (2 * half)) ** 2, 0.0)


def heel_strike(frames: int, fps: float, at: float = 2.0, speed: float = 250.0) -> np.ndarray:
    """(F,) degrees: the velocity changes by `speed` degrees/s at once and fades."""
    t = np.maximum(np.arange(frames) / fps - at, 0.0)
    return speed * t * np.exp(-t / 0.15)


def jitter(values: np.ndarray, sigma: float, seed: int = 1) -> np.ndarray:
    return values + sigma * np.random.default_rng(seed).standard_normal(values.shape)


def rmse(values: np.ndarray, truth: np.ndarray) -> float:
    return float(np.sqrt(((values - truth) ** 2).mean()))


def legged(unit: float | None = 0.01, height: float = 40.0) -> mc.Skeleton:
    """Hips that move and turn, a knee and a foot that turn: 12 channels."""
    offsets = [[0, 2 * height, 0], [0, -height, 0], [0, -height, 0]]
    return mc.Skeleton(("Hips", "Knee", "Foot"), [-1, 0, 1], offsets, ((*PLACES, *TURNS), TURNS, TURNS), unit=unit)


def walk(frames: int, fps: float, seed: int = 0) -> mc.Motion:
    """A clip of `legged`, without noise: the hips move by some centimetres, all joints swing."""
    values = swing(frames, fps, 12, seed)
    values[:, :3] *= 0.3
    values[:, 1] += 90.0
    return mc.Motion(legged(), values, 1 / fps)
