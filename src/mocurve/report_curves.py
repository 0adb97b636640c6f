"""Curves for the report's page: thinned to what can be drawn, and packed to be embedded."""

from __future__ import annotations

import base64
from dataclasses import replace

import numpy as np

from .motion import Motion


def bridged(motion: Motion) -> Motion:
    """Straight lines over missing samples, so that a figure can be drawn; a channel without any stands still."""
    missing = np.isnan(motion.values)
    if not missing.any():
        return motion
    values, frames = np.nan_to_num(motion.values), np.arange(motion.frames)
    for channel in np.flatnonzero(missing.any(axis=0) & ~missing.all(axis=0)):
        there = ~missing[:, channel]
        values[:, channel] = np.interp(frames, frames[there], motion.values[there, channel])
    return replace(motion, values=values)


def thinned(a: np.ndarray, b: np.ndarray, stride: int) -> tuple[np.ndarray, np.ndarray]:
    """Of each run of `stride` frames of a and b (F, C), each channel's samples where the two are furthest apart."""
    if stride == 1:
        return a, b
    frames, channels = a.shape
    count = -(-frames // stride)
    apart = np.full((count * stride, channels), -1.0)
    apart[:frames] = np.abs(np.nan_to_num(b - a))
    at = apart.reshape(count, stride, channels).argmax(axis=1) + stride * np.arange(count)[:, None]
    return np.take_along_axis(a, at, axis=0), np.take_along_axis(b, at, axis=0)


def packed(values: np.ndarray) -> str:
    """Values as 32-bit floats in base64, in C order."""
    return base64.b64encode(np.ascontiguousarray(values, "<f4").tobytes()).decode("ascii")
