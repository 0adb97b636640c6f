"""Channels that break things, and the samples of keys: what the tests of the reduction methods share."""

from __future__ import annotations

import numpy as np

from mocurve import hermite

KINDS = ("noise", "walk", "steps", "constant", "line", "spikes", "smooth")


def signal(kind, count, rng):
    """One channel (F,) of a kind that breaks things."""
    at = np.arange(count)
    return {
        "noise": rng.normal(size=count),
        "walk": np.cumsum(rng.normal(size=count)),
        "steps": np.repeat(rng.normal(size=count), 7)[:count],
        "constant": np.full(count, rng.normal()),
        "line": rng.normal() * at,
        "spikes": np.where(rng.random(count) < 0.1, 1e4, 0.0),
        "smooth": np.sin(at / 7) * 5 + np.cos(at / 31) * 20,
    }[kind]


def sampled(keys, count):
    """Values (M, F) of the keys at every frame."""
    arriving = keys.slopes if keys.in_slopes is None else keys.in_slopes
    rows = zip(keys.values, keys.slopes, arriving, strict=True)
    return np.stack([hermite.evaluate(keys.frames, v, m, np.arange(count), into) for v, m, into in rows])
