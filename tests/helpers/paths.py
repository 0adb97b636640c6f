"""A walk along a bend, and what tests of paths ask of motions laid along others."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
from walks import PERIOD, walk

import mocurve as mc
from mocurve.kinematics import world
from mocurve.path import Path

MOVED = np.array([2.0, 130.0, -70.0])
SHORT = [(0, 0), (100, 50), (100, 250)]
laid = partial(mc.follow, lock_feet=False)  # the walk has no knees
LONG = [(0, 0), (500, 0), (500, 700), (1500, 800), (1500, 0)]
FITS: dict[str, dict[str, Any]] = {
    "usual": {},
    "smooth": {"points": 9, "degree": 4, "track": "smooth"},
    "feet": {"track": "support"},
    "heights": {"height": True},
    "polynomial": {"kind": "polynomial", "degree": 12},
}


def walking(cycles: float = 4, turn: float = 0.3) -> mc.Motion:
    return walk(round(cycles * PERIOD), turn)


def off(a: mc.Motion, b: mc.Motion) -> float:
    """How far a joint of one is from that of the other, at most."""
    return float(np.abs(world(a) - world(b)).max())


def table(made: mc.Motion) -> dict[str, np.ndarray]:
    return {name: np.array(row) for name, row in made.history[-1]["table"].items()}


def measured(made: mc.Motion) -> dict[str, Any]:
    return made.history[-1]["measured"]


def bent(path: Path, by: float = 25.0, seed: int = 0) -> Path:
    """The same with its control points moved over the ground."""
    away = np.random.default_rng(seed).normal(0, by, path.points.shape)
    if path.points.shape[1] == 3:
        away[:, 1] = 0
    return replace(path, points=path.points + away)


def edges(motion: mc.Motion) -> float:
    """How far a joint is at most from where it was going."""
    return float(np.linalg.norm(np.diff(world(motion), 2, axis=0), axis=-1).max())
