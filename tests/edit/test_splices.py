"""Splines put together on their coefficients: exact outside of the overlap, smooth in it, carried as a body is."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from walks import ALL, BODY, PLACE, STEP, walk

from mocurve import Mismatch, Motion, SplineMotion, bspline, planar
from mocurve.bspline_fit import least_squares
from mocurve.edit._poses import motion_of, moved, poses_of
from mocurve.edit._splices import NEAR_DEGREES, SPANS, carried, spliced
from mocurve.kinematics import world


def through(motion: Motion, spans: int, degree: int = 3) -> SplineMotion:
    """Some spline near the motion, on uneven knots."""
    end = motion.duration
    knots = bspline.clamped(end * np.linspace(0.0, 1.0, spans + 1) ** 1.1, degree)
    values = least_squares(knots, degree, np.arange(motion.frames) * STEP, motion.values)
    return SplineMotion(motion.skeleton, knots, values, degree, STEP, motion.frames)


def turning_first(order: tuple[str, ...]) -> Motion:
    """The walk on a body whose root turns in this order."""
    body = replace(BODY, channels=(PLACE + order, *BODY.channels[1:]))
    plain = walk(150)
    return replace(plain, skeleton=body, values=plain.values * np.where(BODY.rotation_channels, 0.5, 1.0))


def slopes(clip: SplineMotion, times: np.ndarray, count: int) -> np.ndarray:
    """The derivative of this order just left and right of times: (2, M, C)."""
    knots, values, degree = clip.knots, clip.values, clip.degree
    for _ in range(count):
        knots, values, degree = bspline.derivative(knots, values, degree)
    return np.stack([bspline.evaluate(knots, values, degree, times + side * 1e-9) for side in (-1, 1)])


# -- laws ----------------------------------------------------------------------------------------------
@given(st.floats(0.4, 1.2), st.floats(0.15, 0.9), st.integers(1, 4), st.integers(1, 4), st.integers(4, 30))
def test_outside_of_the_overlap_both_stay_exactly(
    start: float, length: float, degree: int, other: int, spans: int
) -> None:
    a, b = through(walk(150), 13, degree), through(walk(150, phase=1.0), spans, other)
    made = spliced(a, b, start, start + length)
    ends = (made.domain[0], made.domain[1])
    assert ends == (a.domain[0], b.domain[1])
    before, after = np.linspace(0.0, start, 40), np.linspace(start + length, b.domain[1], 40)
    np.testing.assert_allclose(made.at(before), a.at(before), atol=1e-9)
    np.testing.assert_allclose(made.at(after), b.at(after), atol=1e-9)


@pytest.mark.parametrize("degree", [2, 3, 4])
def test_inside_it_is_as_smooth_as_its_degree_says(degree: int) -> None:
    made = spliced(through(walk(150), 13, degree), through(walk(150, phase=1.0), 17, degree), 0.8, 1.3)
    inner = made.knots[(made.knots > 0.5) & (made.knots < 1.6)]
    assert (np.diff(inner) > 0).all()
    assert np.count_nonzero((inner >= 0.8) & (inner <= 1.3)) > SPANS
    for count in range(degree):
        left, right = slopes(made, inner, count)
        np.testing.assert_allclose(left, right, atol=1e-4 * 40.0**count)


def test_like_goes_over_into_like_exactly() -> None:
    clip = through(walk(150), 13)
    at = np.linspace(0.0, clip.domain[1], 200)
    np.testing.assert_allclose(spliced(clip, clip, 0.7, 1.2).at(at), clip.at(at), atol=1e-9)


def test_between_the_two_lies_what_is_between_their_coefficients() -> None:
    a, b = through(walk(150), 13), through(walk(150), 13)
    low, high = (replace(clip, values=np.full_like(clip.values, value)) for clip, value in ((a, 0.0), (b, 1.0)))
    made = spliced(low, high, 0.7, 1.2).at(np.linspace(0.6, 1.3, 100))
    assert (np.diff(made, axis=0) > -1e-12).all()
    assert made.min() >= 0.0
    assert made.max() <= 1.0 + 1e-12


def test_whole_turns_and_the_other_triple_do_not_count() -> None:
    a = through(walk(150), 13)
    columns = BODY.channel_joints == 1
    values = np.array(a.values)
    values[:, columns] = values[:, columns] * [1.0, -1.0, 1.0] + 180.0 + [360.0, 0.0, -720.0]
    made = spliced(a, replace(a, values=values), 0.7, 1.2)
    at = np.linspace(0.0, a.domain[1], 200)
    np.testing.assert_allclose(made.at(at), a.at(at), atol=1e-9)


def test_one_that_ends_with_the_overlap_and_one_that_begins_with_it() -> None:
    a, b = through(walk(60), 7), through(walk(90, phase=1.0), 9)
    start = a.domain[1] - 0.3
    later = replace(b, knots=b.knots + start)
    made = spliced(a, later, start, a.domain[1])
    assert made.domain == (0.0, later.domain[1])
    for clip, at in ((a, np.linspace(0.0, start, 30)), (later, np.linspace(a.domain[1], later.domain[1], 30))):
        np.testing.assert_allclose(made.at(at), clip.at(at), atol=1e-9)


# -- carried --------------------------------------------------------------------------------------------
@pytest.mark.parametrize(
    "order", [("Yrotation", "Xrotation", "Zrotation"), ALL, ("Zrotation", "Yrotation", "Xrotation")]
)
def test_a_body_is_carried_as_its_frames_are(order: tuple[str, ...]) -> None:
    clip, step = through(turning_first(order), 13), np.array([2.0, 300.0, -80.0])
    made, off = carried(clip, step)
    assert off == 0.0 if order[0] == "Yrotation" else 0.0 < off <= NEAR_DEGREES
    truth = motion_of(moved(poses_of(clip.sample()), clip.skeleton, step), clip.sample())
    np.testing.assert_allclose(world(made.sample()), world(truth), atol=1e-9 if off == 0 else 0.05)


def test_going_without_turning_is_exact_in_any_order() -> None:
    clip = through(walk(150), 13)
    made, off = carried(clip, np.array([0.0, 5.0, -3.0]))
    assert off == 0.0
    np.testing.assert_allclose(
        made.values - clip.values, np.broadcast_to([5.0, 0.0, -3.0] + [0.0] * 17, made.values.shape), atol=1e-12
    )


def test_coefficients_carried_along_a_screw_repeat_with_it() -> None:
    clip, period = through(turning_first(("Yrotation", "Xrotation", "Zrotation")), 10), 1.0
    knots = bspline.periodic(np.linspace(0.0, 2.0 * period, 21))
    values = np.tile(clip.values[:10], (3, 1))[: len(knots) - 4]
    screw = np.array([0.7, 30.0, 120.0])
    turned = replace(clip, knots=knots, values=values, frames=121)
    made, _ = carried(turned, planar.power(screw, bspline.greville(knots, 3) / period))
    at = np.linspace(0.0, period, 20)
    first, second = (Motion(made.skeleton, made.at(times), STEP) for times in (at, at + period))
    np.testing.assert_allclose(world(second), planar.move(screw, world(first)), atol=1e-9)


def test_a_root_that_lacks_a_channel_is_named() -> None:
    body = replace(BODY, channels=(("Xposition", "Yposition", *ALL), *BODY.channels[1:]))
    plain = walk(150)
    clip = through(replace(plain, skeleton=body, values=np.delete(plain.values, 2, axis=1)), 13)
    with pytest.raises(Mismatch, match="'Hips' has to be moved, and has no channel Zposition"):
        carried(clip, np.array([0.0, 0.0, 4.0]))
    stiff = replace(BODY, channels=(PLACE, *BODY.channels[1:]))
    clip = through(replace(plain, skeleton=stiff, values=np.delete(plain.values, [3, 4, 5], axis=1)), 13)
    with pytest.raises(Mismatch, match="channels of 'Hips' cannot express the turning"):
        carried(clip, np.array([0.5, 0.0, 0.0]))
