"""The promise in space: limits hold after every step of the way, where they are tight and where they are wide."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest

import mocurve as mc
from mocurve import KeyedMotion, Motion
from mocurve.feet.planted import planted
from mocurve.kinematics import rest_height
from mocurve.reduction import METHODS, optimal, world
from mocurve.reduction._scene import put, tube
from mocurve.reduction._tubes import pose, worst_of_limits
from mocurve.reduction.keys import Keys
from mocurve.reduction.problem import problem

Astray = Callable[[Motion, KeyedMotion], np.ndarray]
Samples = Callable[[KeyedMotion], np.ndarray]


@pytest.fixture(scope="session")
def cut(jump: Path) -> Motion:
    """Sixty frames of a jump, from the ground into the air."""
    return mc.read(jump)[100:160]


def fresh_worst(scene: world.Scene) -> float:
    """The worst point over its limit, posed anew from the samples."""
    points, axes = np.empty_like(scene.points), np.empty_like(scene.axes)
    pose(scene.body, np.ascontiguousarray(scene.samples.T), points, axes)
    np.testing.assert_allclose(points, scene.points, atol=1e-9)
    return float(worst_of_limits(points, scene.target, scene.limits))


# -- every step on the way ---------------------------------------------------------------------------
@pytest.mark.parametrize("align", ["channel", "joint", "pose"])
@pytest.mark.parametrize("percent", [0.05, 0.5])
@pytest.mark.parametrize("again", [True, False], ids=["searched", "pruned"])
def test_limits_hold_after_every_step(
    cut: Motion, align: str, percent: float, again: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    worst: dict[str, list[float]] = {}
    counts: list[tuple[int, int]] = []

    def watched(name: str, step: Callable[..., Keys | None]) -> Callable[..., Keys | None]:
        def run(scene: world.Scene, *rest: object) -> Keys | None:
            result = step(scene, *rest)
            worst.setdefault(name, []).append(fresh_worst(scene))
            if isinstance(result, Keys):
                counts.append((len(result.frames), len(rest[1].frames)))  # type: ignore[attr-defined]
                assert_samples_are_those_of(scene, rest[0], result)
            return result

        return run

    for name in ("_centre", "_search", "_prune"):
        monkeypatch.setattr(world, name, watched(name, getattr(world, name)))
    monkeypatch.setattr(world, "cores", lambda: 1)
    asked = problem(cut[:30], [f"{percent}%height"], align, 0.25)
    world.fit(asked.motion, asked.groups, asked.limits, optimal.solve, again, "good")
    searched, pruned = {"_search"} if again else set(), set() if again and align == "channel" else {"_prune"}
    assert set(worst) == {"_centre"} | searched | pruned
    assert max(max(values) for values in worst.values()) <= 1.0 + world.RESERVE
    assert all(after <= before for after, before in counts)
    assert any(after < before for after, before in counts)


def assert_samples_are_those_of(scene: world.Scene, group: object, keys: Keys) -> None:
    for member, k in enumerate(group):  # type: ignore[arg-type]
        curve = world.samples_of(keys, member, scene.samples.shape[1])
        np.testing.assert_allclose(scene.samples[k], curve, rtol=0, atol=1e-9)


def test_a_curve_anywhere_in_its_tube_breaks_no_limit(cut: Motion) -> None:
    asked = problem(cut, ["0.2%height"], "channel", 0.25)
    scene, alone, cap = world.problem(asked.motion, asked.limits)
    rng = np.random.default_rng(0)
    frames = cut.frames
    for k in rng.permutation(len(scene.original)):
        if not np.isfinite(alone[k]).all():
            continue
        middle, half = np.empty(frames), np.empty(frames)
        tube(scene, k, np.minimum(2.0 * alone, cap), 0, frames, middle, half)
        assert (np.abs(scene.samples[k] - middle) <= half + 1e-9).all()
        put(scene, k, middle + half * rng.choice([-1.0, 1.0, 0.3], frames), 0, frames)
    assert 0.9 < fresh_worst(scene) <= 1.0 + world.RESERVE


def test_a_tube_is_cut_to_how_far_a_channel_may_stray(cut: Motion) -> None:
    asked = problem(cut, ["1%height"], "channel", 0.25)
    scene, _, cap = world.problem(asked.motion, asked.limits)
    near = np.full_like(cap, 0.01)
    for k in (0, 3, 40):
        middle, half = world.tubes(scene, np.array([k]), near)
        assert (middle + half <= scene.original[k] + 0.01 + 1e-9).all()
        assert (middle - half >= scene.original[k] - 0.01 - 1e-9).all()


def test_samples_put_back_leave_no_trace(cut: Motion) -> None:
    asked = problem(cut, ["1%height"], "channel", 0.25)
    scene, _, _ = world.problem(asked.motion, asked.limits)
    before, points = scene.samples.copy(), scene.points.copy()
    for k in range(10):
        put(scene, k, before[k] + 20.0, 10, 50)
    assert np.abs(scene.points - points)[10:50].max() > 1.0
    np.testing.assert_array_equal(scene.points[:10], points[:10])
    for k in range(10):
        put(scene, k, before[k], 10, 50)
    np.testing.assert_allclose(scene.points, points, atol=1e-9)
    np.testing.assert_array_equal(scene.samples, before)


def test_limbs_share_no_point_and_hold_all_groups_once(cut: Motion) -> None:
    for align in ("channel", "joint", "pose"):
        groups = problem(cut, ["1u"], align, 1.0).groups
        parts = world.limbs(cut, groups)
        assert sorted(g for part in parts for g in part) == list(range(len(groups)))
        body = world.body_of(cut)
        runs = [
            {
                p
                for g in part
                for k in groups[g]
                for p in range(body.first_point[body.joint[k]], body.last_point[body.joint[k]])
            }
            for part in parts[:-1]
        ]
        assert sum(map(len, runs)) == len(set().union(*runs))
        assert all(part == sorted(part, reverse=True) for part in parts)


# -- what was asked holds, and the room is used ------------------------------------------------------
@pytest.mark.parametrize("method", METHODS)
def test_planted_feet_stay_within_a_quarter(cut: Motion, astray: Astray, method: str) -> None:
    limit = 0.002 * rest_height(cut)
    resting = planted(cut).T
    assert 0.05 < resting.mean() < 0.5
    off = astray(cut, mc.reduce(cut, tolerance="0.2%height", method=method))
    assert off[resting].max() <= 0.25 * limit
    assert off.max() <= limit
    free = astray(cut, mc.reduce(cut, tolerance="0.2%height", method=method, feet=1.0))
    assert free[resting].max() > 0.25 * limit


def test_feet_that_are_held_cost_keys(cut: Motion) -> None:
    counts = [mc.reduce(cut, tolerance="0.5%height", feet=feet).keys for feet in (0.1, 0.25, 1.0)]
    assert counts[0] > counts[1] > counts[2]


def test_most_of_the_room_is_used(cut: Motion, astray: Astray) -> None:
    keys = mc.reduce(cut, tolerance="0.5%height", feet=1.0)
    worst = astray(cut, keys).max(axis=1) / (0.005 * rest_height(cut))
    assert worst.max() <= 1.0
    assert np.median(worst) > 0.6


def test_a_joint_with_less_room_keeps_to_it_and_the_rest_is_loose(cut: Motion, astray: Astray) -> None:
    hand = cut.skeleton.joint("LeftHand")
    loose = mc.reduce(cut, tolerance="1%height", feet=1.0)
    strict = mc.reduce(cut, tolerance=["1%height", "LeftHand=0.05%height"], feet=1.0)
    limit = 0.0005 * rest_height(cut)
    assert astray(cut, loose)[:, hand].max() > limit
    off = astray(cut, strict)
    assert off[:, hand].max() <= limit
    assert off.max() > 10 * limit
    assert loose.keys < strict.keys < mc.reduce(cut, tolerance="0.05%height", feet=1.0).keys


def test_an_interval_with_more_room_is_left_with_fewer_keys(cut: Motion, astray: Astray) -> None:
    times = np.arange(cut.frames) * cut.frame_time
    inside = (times >= 0.2) & (times <= 0.4)
    even = mc.reduce(cut, tolerance="0.1%height", feet=1.0)
    mixed = mc.reduce(cut, tolerance=["0.1%height", "@0.2..0.4=2%height"], feet=1.0)
    off = astray(cut, mixed) / rest_height(cut)
    assert off[~inside].max() <= 0.001
    assert 0.001 < off[inside].max() <= 0.02
    assert mixed.keys < 0.9 * even.keys


@pytest.mark.parametrize("cap", [0.2, 1.0])
@pytest.mark.parametrize("align", ["channel", "joint"])
def test_the_twist_is_capped_in_degrees(cut: Motion, samples: Samples, astray: Astray, cap: float, align: str) -> None:
    turning = cut.skeleton.rotation_channels

    def off(keys: KeyedMotion) -> np.ndarray:
        apart = samples(keys) - cut.values
        return np.abs(apart - 360.0 * np.rint(apart / 360.0))[:, turning]

    free = mc.reduce(cut, tolerance="1%height", align=align, feet=1.0)
    capped = mc.reduce(cut, tolerance=["1%height", f"{cap}deg"], align=align, feet=1.0)
    assert off(free).max() > 2.0
    assert off(capped).max() <= cap
    assert astray(cut, capped).max() <= 0.01 * rest_height(cut)
    assert capped.keys > free.keys


def test_twist_alone_is_bounded_by_shell_points(cut: Motion, samples: Samples) -> None:
    keys = mc.reduce(cut, tolerance="0.1%height")
    # a shell point and its joint may each be off by the tolerance: the joint's turn in the world is off by this angle
    angle = np.degrees(2 * np.arcsin(0.001 / world.SHELL))
    apart = (samples(keys) - cut.values)[:, cut.skeleton.rotation_channels]
    # so is its parent's, to the other side; and angles about three crooked axes may each be somewhat more
    assert np.abs(apart - 360.0 * np.rint(apart / 360.0)).max() < 1.5 * 2 * angle


# -- what does not matter ----------------------------------------------------------------------------
def test_the_unit_of_length_changes_nothing(cut: Motion) -> None:
    factor = 1024.0  # a power of two: every length keeps its digits
    skeleton = replace(cut.skeleton, offsets=cut.skeleton.offsets * factor)
    values = np.where(cut.skeleton.rotation_channels, cut.values, cut.values * factor)
    small, large = (mc.reduce(clip, quality="fast") for clip in (cut, replace(cut, skeleton=skeleton, values=values)))
    assert large.keys == pytest.approx(small.keys, rel=0.02)


def test_where_the_clip_stands_changes_little(cut: Motion, astray: Astray) -> None:
    place = np.zeros(cut.values.shape[1])
    place[[0, 2]] = 1e5
    there = replace(cut, values=cut.values + place)
    here_keys, there_keys = (mc.reduce(clip, quality="fast") for clip in (cut, there))
    assert there_keys.keys == pytest.approx(here_keys.keys, rel=0.05)
    assert astray(there, there_keys).max() <= 0.001 * rest_height(cut)


def test_a_file_written_with_six_decimals_keeps_the_promise(cut: Motion, astray: Astray, tmp_path: Path) -> None:
    keys = mc.reduce(cut, tolerance="0.1%height")
    mc.write(tmp_path / "out.bvh", keys.sample())
    again = mc.read(tmp_path / "out.bvh")
    flat = partial(mc.HermiteCurve, np.arange(cut.frames) * cut.frame_time)
    sampled = replace(keys, curves=tuple(flat(column, np.zeros(cut.frames)) for column in again.values.T))
    assert astray(cut, sampled).max() <= 0.001 * rest_height(cut)
