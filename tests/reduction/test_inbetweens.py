"""Curves through whole poses: the fit against a dense least squares, what it says it leaves, steps that never lose."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import mocurve as mc
from mocurve import KeyedMotion, Motion
from mocurve.reduction import inbetweens, whole_poses
from mocurve.reduction.problem import curves, problem, with_pins
from mocurve.reduction.whole_poses import _with_pins

KEYS = [0, 7, 11, 12, 30, 44, 59]


@pytest.fixture(scope="session")
def cut(jump: Path) -> Motion:
    """Sixty frames of a jump, from the ground into the air."""
    return mc.unroll(mc.read(jump)[100:160], triples=False)


def ends(frames: int) -> np.ndarray:
    pinned = np.zeros(frames, bool)
    pinned[[0, -1]] = True
    return pinned


def rows(frames: list[int], count: int) -> np.ndarray:
    """(count, 2 K) the weights of values and slopes at every frame."""
    result = np.zeros((count, 2 * len(frames)))
    for q, (a, b) in enumerate(pairwise(frames)):
        at, h = np.arange(a, b + 1), b - a
        s = (at - a) / h
        result[a : b + 1] = 0.0
        result[at, 2 * q], result[at, 2 * q + 1] = (1 + 2 * s) * (1 - s) ** 2, h * s * (1 - s) ** 2
        result[at, 2 * q + 2], result[at, 2 * q + 3] = s * s * (3 - 2 * s), h * s * s * (s - 1)
    return result


def test_one_fit_is_least_squares(cut: Motion) -> None:
    found = inbetweens.fitted(inbetweens.stage_of(cut), ends(60), KEYS, sweeps=0)
    table = rows(KEYS, 60)
    best = np.linalg.lstsq(table, cut.values, rcond=None)[0]
    mine = table @ np.stack([found.values, found.slopes], axis=1).reshape(-1, cut.values.shape[1])
    # a slope is drawn to its chord by a millionth: seen where frames hardly settle it
    np.testing.assert_allclose(mine, table @ best, atol=1e-3)
    left, least = (((now - cut.values) ** 2).sum() for now in (mine, table @ best))
    assert least * (1 - 1e-12) <= left <= least * (1 + 1e-5)


def test_what_is_left_is_what_is_measured(cut: Motion) -> None:
    asked = problem(cut, None, "pose", 1.0)
    stage = inbetweens.stage_of(cut)
    for found in (
        inbetweens.fitted(stage, ends(60), KEYS),
        inbetweens.centred(inbetweens.fitted(stage, ends(60), KEYS)),
        whole_poses.spread(stage, ends(60), np.array(KEYS), 0.25),
    ):
        keyed = KeyedMotion(cut.skeleton, curves(asked, [inbetweens.keys_of(found)]), cut.frame_time, cut.frames)
        assert mc.compare(cut, keyed).max_error_world == pytest.approx(found.worst, abs=1e-9)


def test_each_step_leaves_no_more_than_the_one_before(cut: Motion) -> None:
    stage, pinned = inbetweens.stage_of(cut), ends(60)
    plain = inbetweens.fitted(stage, pinned, KEYS, sweeps=0)
    weighted = inbetweens.fitted(stage, pinned, KEYS)
    assert weighted.worst < plain.worst
    assert inbetweens.centred(weighted).worst <= weighted.worst
    spread = whole_poses.spread(stage, pinned, np.array(KEYS), 0.25)
    assert spread.worst < weighted.worst
    before = spread.worst
    whole_poses.moved(spread)
    assert spread.worst < before
    assert len(spread.frames) == len(KEYS)


def test_pins_are_not_moved(cut: Motion) -> None:
    pinned = ends(60)
    pinned[[11, 12, 44]] = True
    stage = inbetweens.stage_of(cut)
    for power in whole_poses.POWERS:
        found = whole_poses.spread(stage, pinned, np.array(KEYS), power)
        whole_poses.moved(found)
        assert {0, 11, 12, 44, 59} <= set(found.frames.tolist())
        assert len(found.frames) == len(KEYS)


@given(st.data())
def test_whole_frames_near_the_wanted_ones_with_every_pin(data: st.DataObject) -> None:
    frames = data.draw(st.integers(2, 60))
    pins = np.array(sorted({0, frames - 1} | data.draw(st.sets(st.integers(0, frames - 1)))))
    keys = data.draw(st.integers(len(pins), frames))
    inner = data.draw(st.lists(st.floats(0, frames - 1), min_size=keys - 2, max_size=keys - 2))
    wanted = np.array([0.0, *sorted(inner), frames - 1.0])
    found = _with_pins(wanted, pins)
    assert len(found) == keys
    assert (np.diff(found) > 0).all()
    assert (found[0], found[-1]) == (0, frames - 1)
    assert set(pins.tolist()) <= set(found.tolist())


def test_frames_that_fit_as_they_are_stay() -> None:
    wanted = np.array([0.0, 7.2, 12.4, 20.0, 33.0])
    assert _with_pins(wanted, np.array([0, 12, 33])).tolist() == [0, 7, 12, 20, 33]
    assert whole_poses.evenly(34, 4, ends(34)).tolist() == [0, 11, 22, 33]


@pytest.mark.parametrize("method", ["optimal", "linear"])
def test_a_key_that_is_put_in_leaves_the_curves(cut: Motion, method: str) -> None:
    before = mc.reduce(cut, tolerance="1deg", method=method)
    after = mc.reduce(cut, tolerance="1deg", method=method, pin=[20, 33])
    fine = before.frame_time / 7
    np.testing.assert_allclose(after.sample(fine).values, before.sample(fine).values, atol=1e-9)
    for old, new in zip(before.curves, after.curves, strict=True):
        assert {20, 33} <= set(np.rint(new.times / cut.frame_time).astype(int))
        assert set(old.times) <= set(new.times)
        assert not new.broken or old.broken


def test_no_pin_leaves_the_keys_themselves(cut: Motion) -> None:
    asked = problem(cut, None, "pose", 1.0)
    keys = inbetweens.keys_of(inbetweens.fitted(inbetweens.stage_of(cut), ends(60), KEYS))
    assert with_pins(keys, ends(60)) is keys
    assert len(asked.groups) == 1


def test_room_for_channels_counts_as_distances_do(cut: Motion, astray: Callable) -> None:
    limits = problem(cut, ["1%height", "2deg"], "pose", 1.0).limits
    stage = inbetweens.stage_of(cut, limits)
    keys = mc.reduce(cut, tolerance=["1%height", "2deg"], align="pose", feet=1.0)
    assert keys.report is not None
    frames = np.array(keys.report.key_frames)
    state = [np.array([getattr(c, part) for c in keys.curves]) for part in ("values", "slopes")]
    found = inbetweens.given(stage, ends(60), inbetweens.Keys(frames, state[0], state[1] * cut.frame_time))
    assert 0.5 < found.worst <= 1.0
    turning = cut.skeleton.rotation_channels
    assert np.abs(keys.sample().values - cut.values)[:, turning].max() <= 2.0
