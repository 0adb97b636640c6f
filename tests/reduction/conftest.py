"""What tests of the promise share: a measure of it that uses nothing of the code that keeps it, and hostile clips."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import strategies as st
from scipy.interpolate import CubicHermiteSpline

from mocurve import KeyedMotion, Motion, Skeleton
from mocurve.skeleton import AXES, CHANNEL_KINDS

SIGNALS = ("noise", "walk", "constant", "line", "step", "spikes", "wraps", "gimbal", "offset", "smooth", "tiny", "zero")


def turned(degrees: np.ndarray, axis: int) -> np.ndarray:
    """Matrices (F, 3, 3) of turns (F,) about one axis."""
    s, c = np.sin(np.radians(degrees)), np.cos(np.radians(degrees))
    a, b = (axis + 1) % 3, (axis + 2) % 3
    turn = np.zeros((len(degrees), 3, 3))
    turn[:, axis, axis] = 1.0
    turn[:, a, a] = turn[:, b, b] = c
    turn[:, a, b], turn[:, b, a] = -s, s
    return turn


def places_of(skeleton: Skeleton, values: np.ndarray) -> np.ndarray:
    """Places (F, J, 3) of joints and end sites, by a product of matrices; values (F, C)."""
    frames = len(values)
    places, turns = np.zeros((frames, len(skeleton.names), 3)), []
    columns = iter(values.T)
    for joint, (parent, kinds) in enumerate(zip(skeleton.parents, skeleton.channels, strict=True)):
        offset, turn = np.tile(skeleton.offsets[joint], (frames, 1)), np.tile(np.eye(3), (frames, 1, 1))
        for kind in kinds:
            axis, column = AXES.index(kind[0]), next(columns)
            if kind.endswith("position"):
                offset[:, axis] = column
            else:
                turn = turn @ turned(column, axis)
        places[:, joint] = offset
        if parent >= 0:
            places[:, joint] = places[:, parent] + np.einsum("fab,fb->fa", turns[parent], offset)
            turn = turns[parent] @ turn
        turns.append(turn)
    return places


def samples_of(keys: KeyedMotion) -> np.ndarray:
    """Values (F, C) of the curves at the source's frames, segment by segment by scipy."""
    times = np.arange(keys.frames) * keys.frame_time
    values = np.empty((keys.frames, len(keys.curves)))
    for channel, curve in enumerate(keys.curves):
        values[:, channel] = curve.values[0] if len(curve) else np.nan
        for q in range(len(curve) - 1):
            span = slice(q, q + 2)
            slopes = [curve.slopes[q], curve.in_slopes[q + 1]]
            inside = (times >= curve.times[q] - 1e-9) & (times <= curve.times[q + 1] + 1e-9)
            values[inside, channel] = CubicHermiteSpline(curve.times[span], curve.values[span], slopes)(times[inside])
    return values


@pytest.fixture(scope="session")
def places() -> Callable[[Skeleton, np.ndarray], np.ndarray]:
    return places_of


@pytest.fixture(scope="session")
def samples() -> Callable[[KeyedMotion], np.ndarray]:
    return samples_of


@pytest.fixture(scope="session")
def astray() -> Callable[[Motion, KeyedMotion], np.ndarray]:
    """astray(clip, keys): how far every joint and end site is from where it was, (F, J) file units."""

    def off(clip: Motion, keys: KeyedMotion) -> np.ndarray:
        return np.linalg.norm(
            places_of(keys.skeleton, samples_of(keys)) - places_of(clip.skeleton, clip.values), axis=2
        )

    return off


def signal(kind: str, frames: int, rotates: bool, rng: np.random.Generator) -> np.ndarray:
    """One channel (F,) that breaks things."""
    at = np.arange(frames)
    return {
        "noise": rng.normal(0, 5, frames),
        "walk": np.cumsum(rng.normal(size=frames)),
        "constant": np.full(frames, rng.normal(0, 50)),
        "line": 0.37 * at - 5,
        "step": np.where(at > frames / 2, 40.0, 0.0),
        "spikes": np.where(rng.random(frames) < 0.1, 80.0, 0.0),
        "wraps": (170 + 7 * at + 180) % 360 - 180,
        "gimbal": 90 + rng.choice([-1e-7, 0.0, 1e-7], frames),
        "offset": (720.0 if rotates else 1e6) + 20 * np.sin(0.2 * at),
        "smooth": 20 * np.sin(0.15 * at + rng.uniform(0, 6)),
        "tiny": 1e-9 * rng.normal(size=frames),
        "zero": np.zeros(frames),
    }[kind]


@st.composite
def hostile_clips(draw: st.DrawFn, least_frames: int = 0) -> Motion:
    """Up to four joints under some roots, up to six channels each in any order, each a signal of its own kind."""
    count = draw(st.integers(1, 4))
    parents, branch = [-1], [-1, 0]
    for joint in range(1, count):
        parents.append(draw(st.sampled_from(branch)))
        branch = [*branch[: branch.index(parents[-1]) + 1], joint]
    names = draw(st.permutations(["Hips", "LeftFoot", "Knee", "Toe_End"]))[:count]
    channels = [tuple(draw(st.lists(st.sampled_from(CHANNEL_KINDS), max_size=6, unique=True))) for _ in range(count)]
    rng = np.random.default_rng(draw(st.integers(0, 2**32)))
    offsets = rng.choice([0.0, 1.0, 30.0], (count, 3)) * rng.normal(size=(count, 3))
    frames = draw(st.sampled_from([f for f in (0, 1, 2, 3, 5, 12, 60) if f >= least_frames]))
    kinds = [kind for names in channels for kind in names]
    values = np.zeros((frames, len(kinds)))
    for column, kind in enumerate(kinds):
        chosen = draw(st.sampled_from(SIGNALS))
        values[:, column] = signal(chosen, frames, kind.endswith("rotation"), rng)
    return Motion(Skeleton(names, parents, offsets, channels), values, draw(st.sampled_from([1 / 120, 1 / 30, 0.033])))


@pytest.fixture(scope="session")
def hostile() -> Callable[..., st.SearchStrategy[Motion]]:
    return hostile_clips
