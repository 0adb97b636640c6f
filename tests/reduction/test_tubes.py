"""Tubes: poses against matrices, turns against fresh poses, and intervals whose ends are exactly on a limit."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from mocurve import Motion, Skeleton, kinematics
from mocurve.reduction import world
from mocurve.reduction._tubes import Body, narrow, pose, reach_of_limits, sine_versine, turn, worst_of_limits
from mocurve.skeleton import CHANNEL_KINDS

Places = Callable[[Skeleton, np.ndarray], np.ndarray]


@st.composite
def bodies(draw: st.DrawFn) -> tuple[Motion, np.random.Generator]:
    """Up to five joints under some roots, up to six channels each in any order, ordinary angles and offsets."""
    count = draw(st.integers(1, 5))
    parents, branch = [-1], [-1, 0]
    for joint in range(1, count):
        parents.append(draw(st.sampled_from(branch)))
        branch = [*branch[: branch.index(parents[-1]) + 1], joint]
    channels = [tuple(draw(st.lists(st.sampled_from(CHANNEL_KINDS), max_size=6))) for _ in range(count)]
    rng = np.random.default_rng(draw(st.integers(0, 2**32)))
    width = sum(map(len, channels))
    offsets = rng.choice([0.0, 1.0], (count, 3), p=[0.2, 0.8]) * rng.normal(0, 10, (count, 3))
    values = rng.normal(0, 60, (4, width))
    return Motion(Skeleton([f"J{j}" for j in range(count)], parents, offsets, channels), values, 0.01), rng


def posed(body: Body, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    points, axes = np.empty((len(values), 3, len(body.shell))), np.zeros((len(values), 3, len(body.joint)))
    pose(body, np.ascontiguousarray(values), points, axes)
    return points, axes


def shelled(motion: Motion, body: Body) -> tuple[Skeleton, np.ndarray]:
    """The skeleton with a joint of its own for every shell point, and where each point of the body stands in it."""
    skeleton = motion.skeleton
    names, parents, offsets, channels, place = [], [], [], [], []
    new: dict[int, int] = {-1: -1}
    for joint in range(len(skeleton.names)):
        new[joint] = len(names)
        for point in range(body.first_point[joint], body.first_point[joint + 1]):
            own = point == body.first_point[joint]
            place.append(len(names))
            names.append(f"P{point}")
            parents.append(new[skeleton.parents[joint]] if own else new[joint])
            offsets.append(skeleton.offsets[joint] if own else body.shell[point])
            channels.append(skeleton.channels[joint] if own else ())
    return Skeleton(names, parents, np.array(offsets), channels), np.array(place)


@given(bodies())
def test_points_are_where_a_product_of_matrices_puts_them(places: Places, drawn: tuple) -> None:
    motion, _ = drawn
    body = world.body_of(motion)
    points, _ = posed(body, motion.values)
    skeleton, at = shelled(motion, body)
    np.testing.assert_allclose(points.transpose(0, 2, 1), places(skeleton, motion.values)[:, at], atol=1e-9)
    own = points[:, :, body.first_point[:-1]].transpose(0, 2, 1)
    np.testing.assert_allclose(own, kinematics.world(motion), atol=1e-9)


@given(bodies())
def test_an_axis_is_the_direction_in_which_its_channel_moves(drawn: tuple) -> None:
    motion, _ = drawn
    body, step = world.body_of(motion), 1e-4
    points, axes = posed(body, motion.values)
    for k in range(len(body.joint)):
        moved = np.array(motion.values)
        moved[:, k] += step
        other, _ = posed(body, moved)
        first, last = body.first_point[body.joint[k]] + body.rotates[k], body.last_point[body.joint[k]]
        own = points[:, :, body.first_point[body.joint[k]]]
        if body.rotates[k]:
            arm = points[:, :, first:last] - own[:, :, None]
            expected = np.cross(axes[:, :, k][:, :, None], arm, axis=1) * np.radians(step)
        else:
            # of two channels for the same axis only the last one moves the joint
            later = [q for q in range(k + 1, len(body.joint)) if body.joint[q] == body.joint[k]]
            hidden = any(not body.rotates[q] and body.axis[q] == body.axis[k] for q in later)
            expected = np.zeros(3)[:, None] if hidden else axes[:, :, k][:, :, None] * step
        off = (other - points)[:, :, first:last] - expected
        assert np.abs(off).max(initial=0.0) < 1e-8
        still = np.delete(other - points, np.s_[first:last], axis=2)
        assert not still.any()


@given(bodies(), st.floats(0.0, 300.0))
def test_turned_channel_after_channel_it_is_a_fresh_pose(drawn: tuple, size: float) -> None:
    motion, rng = drawn
    skeleton = motion.skeleton
    assume(all(len(set(kinds)) == len(kinds) or "position" not in "".join(kinds) for kinds in skeleton.channels))
    body = world.body_of(motion)
    points, axes = posed(body, motion.values)
    changes = rng.uniform(-size, size, motion.values.shape) * rng.integers(0, 2, motion.values.shape)
    for k in rng.permutation(len(body.joint)):
        turn(body, k, np.ascontiguousarray(changes[:, k]), 1, 4, points, axes)
    changes[0] = 0.0
    fresh, fresh_axes = posed(body, motion.values + changes)
    np.testing.assert_allclose(points, fresh, atol=1e-8)
    np.testing.assert_allclose(axes, fresh_axes, atol=1e-10)


@settings(max_examples=40)
@given(bodies(), st.sampled_from([0.01, 0.1, 3.0]), st.floats(0.0, 0.99))
def test_the_ends_of_a_tube_are_exactly_on_a_limit(places: Places, drawn: tuple, limit: float, away: float) -> None:
    motion, rng = drawn
    body = world.body_of(motion)
    skeleton, at = shelled(motion, body)
    assume(all(len(set(kinds)) == len(kinds) or "position" not in "".join(kinds) for kinds in skeleton.channels))
    target, _ = posed(body, motion.values)
    limits = limit * rng.uniform(0.5, 2.0, (4, len(body.shell)))
    limits[rng.random(limits.shape) < 0.2] = np.inf
    now = away_from(motion.values, body, target, limits, away, rng)
    points, axes = posed(body, now)
    for k in range(len(body.joint)):
        low, high = np.full(4, -50.0), np.full(4, 50.0)
        narrow(body, k, points, target, axes, limits, 0, 4, low, high)
        for ends in (low, high):
            for part, worst in ((1.0, 1.0), (0.6, None)):
                moved = now.copy()
                moved[:, k] += part * ends
                off = np.linalg.norm(places(skeleton, moved)[:, at].transpose(0, 2, 1) - target, axis=1)
                over = (off / limits).max(axis=1)
                assert (over <= 1.0 + 1e-9).all()
                cut = np.abs(ends) < 50.0
                if worst:
                    np.testing.assert_allclose(over[cut], worst, rtol=0, atol=1e-8)


def away_from(
    values: np.ndarray, body: Body, target: np.ndarray, limits: np.ndarray, part: float, rng: np.random.Generator
) -> np.ndarray:
    """Other values, whose worst point is so large a part of its limit away."""
    direction, low, high = rng.normal(size=values.shape), 0.0, 10.0
    for _ in range(50):
        middle = 0.5 * (low + high)
        points, _ = posed(body, values + middle * direction)
        low, high = (middle, high) if worst_of_limits(points, target, limits) <= part else (low, middle)
    return values + low * direction


def swing(*limits: float) -> tuple[Body, np.ndarray, np.ndarray, np.ndarray]:
    """A rod of 10 along X that turns about Z, one frame for each limit of its tip."""
    skeleton = Skeleton(("A", "Tip"), [-1, 0], [[0, 0, 0], [10, 0, 0]], [("Zrotation",), ()])
    body = world.body_of(Motion(skeleton, np.zeros((len(limits), 1)), 0.01))
    points, axes = posed(body, np.zeros((len(limits), 1)))
    allowed = np.full((len(limits), len(body.shell)), np.inf)
    allowed[:, body.first_point[1]] = limits
    return body, points, axes, allowed


def test_the_tube_of_a_rod_is_the_angle_of_its_chord() -> None:
    chords = np.array([0.0, 1e-9, 0.01, 1.0, 10.0])
    body, points, axes, limits = swing(*chords)
    low, high = np.full(5, -360.0), np.full(5, 360.0)
    narrow(body, 0, points, points, axes, limits, 0, 5, low, high)
    np.testing.assert_allclose(high, np.degrees(2 * np.arcsin(chords / 20)), rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(low, -high, rtol=1e-9, atol=1e-12)


@pytest.mark.parametrize("limit", [20.0, 25.0, 1e150, np.inf])
def test_a_limit_that_no_turn_reaches_leaves_all_of_a_quarter_turn(limit: float) -> None:
    body, points, axes, limits = swing(limit)
    low, high = np.full(1, -360.0), np.full(1, 360.0)
    narrow(body, 0, points, points, axes, limits, 0, 1, low, high)
    assert (low[0], high[0]) == pytest.approx((-89.0, 89.0))


def test_a_tube_never_leaves_out_where_the_channel_is() -> None:
    body, points, axes, limits = swing(0.1)
    target = points + 5.0
    low, high = np.full(1, -3.0), np.full(1, 3.0)
    narrow(body, 0, points, target, axes, limits, 0, 1, low, high)
    assert low[0] <= 0.0 <= high[0]


def test_only_the_frames_asked_for_are_cut() -> None:
    body, points, axes, limits = swing(*[1.0] * 5)
    low, high = np.full(5, -50.0), np.full(5, 50.0)
    narrow(body, 0, points, points, axes, limits, 1, 3, low, high)
    assert (high == 50.0).tolist() == [True, False, False, True, True]


@given(bodies())
def test_the_reach_of_limits_is_the_slope_of_the_tube(drawn: tuple) -> None:
    motion, rng = drawn
    body = world.body_of(motion)
    points, axes = posed(body, motion.values)
    limits = 1e-3 * rng.uniform(0.5, 2.0, (4, len(body.shell)))
    for k in range(len(body.joint)):
        reach, low, high = np.empty(4), np.full(4, -80.0), np.full(4, 80.0)
        reach_of_limits(body, k, points, axes, limits, 0.0, reach)
        narrow(body, k, points, points, axes, limits, 0, 4, low, high)
        near = reach < 0.1  # degrees, or length
        np.testing.assert_allclose(high[near], reach[near], rtol=2e-3)
        np.testing.assert_allclose(low[near], -reach[near], rtol=2e-3)


def test_without_a_point_to_move_a_channel_reaches_anywhere() -> None:
    body, points, axes, limits = swing(1.0)
    out = np.empty(1)
    reach_of_limits(body, 0, points, axes, np.full_like(limits, np.inf), 0.0, out)
    assert out[0] == np.inf


@given(st.floats(-400.0, 400.0))
def test_sine_and_versine_are_those_of_numpy(x: float) -> None:
    exact = np.sin(x), 2.0 * np.sin(0.5 * x) ** 2
    np.testing.assert_allclose(sine_versine(x), exact, rtol=1e-15, atol=1e-300 if abs(x) <= 0.35 else 3e-16)


def test_the_worst_of_limits_is_the_largest_distance_over_limit() -> None:
    target = np.zeros((2, 3, 2))
    points = target.copy()
    points[1, :, 1] = [3.0, 4.0, 12.0]
    assert worst_of_limits(points, target, np.full((2, 2), 26.0)) == 0.5
    assert worst_of_limits(target, target, np.zeros((2, 2))) == 0.0
    assert worst_of_limits(points, target, np.zeros((2, 2))) == np.inf
    assert worst_of_limits(points, target, np.full((2, 2), np.inf)) == 0.0


# -- the body as arrays ------------------------------------------------------------------------------
@given(bodies())
def test_the_points_and_channels_below_a_joint_are_one_run(drawn: tuple) -> None:
    motion, _ = drawn
    body, skeleton = world.body_of(motion), motion.skeleton
    owner = np.repeat(np.arange(len(skeleton.names)), np.diff(body.first_point))
    for joint in range(len(skeleton.names)):
        inside = skeleton.below(joint)
        assert np.flatnonzero(inside[owner]).tolist() == list(range(body.first_point[joint], body.last_point[joint]))
        channels = np.flatnonzero(inside[body.joint])
        assert channels.tolist() == list(range(body.first_channel[joint], body.last_channel[joint]))


@given(bodies())
def test_shell_points_lie_square_to_the_bone_and_as_far_as_said(drawn: tuple) -> None:
    motion, _ = drawn
    skeleton, body = motion.skeleton, world.body_of(motion)
    offsets, radius = kinematics.rest_offsets(motion), world.SHELL * kinematics.rest_height(motion)
    for joint in range(len(skeleton.names)):
        shell = body.shell[body.first_point[joint] + 1 : body.first_point[joint + 1]]
        turning = any(kind.endswith("rotation") for kind in skeleton.channels[joint])
        assert len(shell) in ((1, 2) if turning and radius > 0 else (0,))
        np.testing.assert_allclose(np.linalg.norm(shell, axis=1), radius)
        bone = offsets[skeleton.parents == joint].sum(axis=0)
        np.testing.assert_allclose(shell @ bone, 0.0, atol=1e-9 * (1 + np.abs(bone).max()) * (1 + radius))


def test_a_joint_that_does_not_turn_has_no_shell() -> None:
    skeleton = Skeleton(("A", "B"), [-1, 0], [[0, 0, 0], [0, 9, 0]], [("Zrotation",), ()])
    still = Motion(skeleton, np.full((5, 1), 30.0), 0.01)
    assert len(world.body_of(still).shell) == 2
    assert len(world.body_of(replace(still, values=np.arange(5.0)[:, None])).shell) == 3
