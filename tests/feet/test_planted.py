"""Where feet are planted: slow all around, on joints of a foot and all below, nowhere else."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mocurve import Motion, Skeleton, read
from mocurve.feet.planted import SPEED, WINDOW, planted
from mocurve.kinematics import rest_height, world

STEP = 0.01
HEIGHT = 100.0
NAMES = ("Hips", "LeftFoot", "Tip", "Hand", "Head")


def walker(speeds: np.ndarray, names: tuple[str, ...] = NAMES) -> Motion:
    """Hips that go along X with these speeds (F - 1,), rest heights a second; hand, foot and its tip go with them."""
    skeleton = Skeleton(
        names,
        [-1, 0, 1, 0, 0],
        [[0, 0, 0], [0, -90, 0], [0, 0, 10], [0, -50, 0], [0, 10, 0]],
        [("Xposition",), (), (), (), ()],
    )
    path = np.concatenate([[0.0], np.cumsum(speeds)]) * HEIGHT * STEP
    return Motion(skeleton, path[:, None], STEP)


@given(st.lists(st.sampled_from([0.0, 0.1, 0.9, 2.0]), min_size=1, max_size=40))
def test_planted_is_slow_at_every_frame_of_the_window(speeds: list[float]) -> None:
    clip = walker(np.array(speeds))
    pace = np.abs(np.gradient(clip.values[:, 0])) / STEP
    slow = pace < SPEED * HEIGHT
    expected = [slow[max(0, f - WINDOW // 2) : f + WINDOW // 2 + 1].all() for f in range(clip.frames)]
    found = planted(clip)
    np.testing.assert_array_equal(found[1], expected)
    np.testing.assert_array_equal(found[2], expected)
    assert not found[[0, 3, 4]].any()


@pytest.mark.parametrize(("factor", "rests"), [(0.99, True), (1.01, False)])
def test_the_threshold_is_a_quarter_of_the_rest_height_a_second(factor: float, rests: bool) -> None:
    assert SPEED == 0.25
    clip = walker(np.full(20, factor * SPEED))
    assert rest_height(clip) == HEIGHT
    assert planted(clip)[1].all() == rests
    assert planted(clip)[1].any() == rests


def test_what_rests_does_not_depend_on_unit_or_frame_rate() -> None:
    clip = walker(np.repeat([0.1, 1.0, 0.1], 30))
    larger = replace(
        clip, values=clip.values * 25.4, skeleton=replace(clip.skeleton, offsets=clip.skeleton.offsets * 25.4)
    )
    np.testing.assert_array_equal(planted(larger), planted(clip))
    assert not planted(replace(clip, frame_time=STEP / 3))[1].any()
    assert planted(replace(clip, frame_time=STEP * 5))[1].all()


@pytest.mark.parametrize(
    ("name", "foot"),
    [
        *[(name, True) for name in ("LeftToeBase", "r_ankle", "Heel_L", "lBall", "RIGHT_FOOT", "foot.R")],
        *[(name, False) for name in ("balloon", "LeftKnee", "Hand", "Fuß", "fo ot", "")],
    ],
)
def test_feet_are_known_by_their_names(name: str, foot: bool) -> None:
    found = planted(walker(np.zeros(9), ("Hips", name, "Tip", "Hand", "Head")))
    assert found[1:3].all() == foot
    assert found[1:3].any() == foot


@pytest.mark.parametrize("frames", [0, 1])
def test_a_single_frame_does_not_rest(frames: int) -> None:
    found = planted(walker(np.zeros(3))[:frames])
    assert found.shape == (5, frames)
    assert not found.any()


def test_a_body_without_height_plants_nothing() -> None:
    point = Motion(Skeleton(("Foot",), [-1], np.zeros((1, 3)), [("Xposition",)]), np.zeros((9, 1)), STEP)
    assert not planted(point).any()


def test_feet_of_a_real_jump_rest_before_and_after_it_and_fly_between(jump: Path) -> None:
    clip = read(jump)
    skeleton, found = clip.skeleton, planted(clip)
    feet = [skeleton.joint(name) for name in ("LeftFoot", "LeftToeBase", "RightFoot", "RightToeBase")]
    resting, flying = found[feet].all(axis=0), ~found[feet].any(axis=0)
    assert resting.mean() > 0.1
    assert flying.mean() > 0.1
    height = world(clip)[:, feet, 1].min(axis=1)
    assert height[flying].max() > height[resting].max() + 0.05 * rest_height(clip)
    assert not found[skeleton.joint("Hips")].any()
