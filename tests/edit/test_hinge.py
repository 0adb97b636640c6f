"""The leg as a hinge: lengths and bends are inverse, targets are reached, a straight knee does not flip."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from legged import still_body

import mocurve as mc
from mocurve import rotation
from mocurve.edit._hinge import STRAIGHT, Hinge, hinge_of, reached
from mocurve.feet.legs import legs
from mocurve.kinematics import world, world_rotations


@pytest.fixture(scope="module")
def hinge(jump: Path) -> Hinge:
    motion = mc.read(jump)
    assert isinstance(motion, mc.Motion)
    leg = legs(motion)[0]
    parents = motion.skeleton.parents
    turned = world_rotations(motion, [leg.hip, parents[leg.knee], leg.knee, leg.ankle])
    return hinge_of(motion, leg, world(motion), turned)


def leg_of(hinge: Hinge, whole: np.ndarray, knee: np.ndarray) -> np.ndarray:
    """From hip to ankle (F, 3) for a turn of the whole leg and one of the knee."""
    inner = rotation.rotate(knee, hinge.q) - hinge.p
    return rotation.rotate(rotation.mul(whole, hinge.knee), inner)


def test_the_length_is_that_of_the_flexion_and_back(hinge: Hinge) -> None:
    length = np.linalg.norm(hinge.ankle - hinge.hip, axis=1)
    np.testing.assert_allclose(hinge.length(np.abs(hinge.flexion)), length, atol=1e-9)
    bent = np.abs(hinge.flexion) > STRAIGHT
    assert bent.any()
    np.testing.assert_allclose(hinge.bend(length)[0][bent], np.abs(hinge.flexion)[bent], atol=1e-9)


def test_the_slope_of_the_bend_is_its_derivative_also_out_of_reach(hinge: Hinge) -> None:
    longest = hinge.length(np.zeros(len(hinge.flexion)))
    for part in (0.6, 0.9, 0.999, 1.02):
        step = 1e-6 * longest
        before, after = (hinge.bend(part * longest + sign * step)[0] for sign in (-1, 1))
        np.testing.assert_allclose((after - before) / (2 * step), hinge.bend(part * longest)[1], rtol=1e-4)
    assert (hinge.bend(1.02 * longest)[0] < 0).all()


def test_what_is_in_reach_is_reached_and_nothing_asked_changes_nothing(hinge: Hinge) -> None:
    none, one = np.zeros(len(hinge.flexion)), np.ones(len(hinge.flexion))
    to = hinge.ankle - hinge.hip
    whole, knee, short = reached(hinge, hinge.hip, hinge.ankle, none, none, hinge.flexion, none)
    np.testing.assert_allclose(rotation.angle(whole, rotation.exp(np.zeros(3))), 0.0, atol=1e-5)
    np.testing.assert_allclose(leg_of(hinge, whole, knee), to, atol=1e-9)
    target = hinge.hip + 0.93 * rotation.rotate(rotation.exp(np.array([0.3, 0.2, -0.1])), to)
    whole, knee, short = reached(hinge, hinge.hip, target, 0.4 * one, 0.1 * one, hinge.flexion, one)
    np.testing.assert_allclose(leg_of(hinge, whole, knee), target - hinge.hip, atol=1e-9)
    np.testing.assert_allclose(short, 0.0, atol=1e-9)


def test_out_of_reach_the_leg_points_there_and_says_how_much_is_missing(hinge: Hinge) -> None:
    one = np.ones(len(hinge.flexion))
    to = 1.3 * (hinge.ankle - hinge.hip) * (hinge.length(0.0 * one) / hinge.length(hinge.flexion))[:, None]
    whole, knee, short = reached(hinge, hinge.hip, hinge.hip + to, 0.0 * one, 0.0 * one, hinge.flexion, one)
    leg = leg_of(hinge, whole, knee)
    np.testing.assert_allclose(np.cross(leg, to), 0.0, atol=1e-8)
    np.testing.assert_allclose(np.linalg.norm(to, axis=1) - np.linalg.norm(leg, axis=1), short, atol=1e-9)
    assert (short > 0).all()


def test_a_swinging_knee_is_damped_where_a_standing_one_snaps(hinge: Hinge) -> None:
    one = np.ones(len(hinge.flexion))
    lengths = np.linspace(0.98, 1.0, 40)
    frame = int(np.argmin(np.abs(hinge.flexion)))
    straight = hinge.hip[frame] + (hinge.ankle - hinge.hip)[frame] / hinge.length(hinge.flexion)[frame] * 1.0
    direction = straight - hinge.hip[frame]
    longest = hinge.length(0.0 * one)[frame]
    bends = []
    for exact in (1.0, 0.0):
        row = []
        for part in lengths:
            target = hinge.hip + part * longest * direction
            _, knee, _ = reached(hinge, hinge.hip, target, 0 * one, 0 * one, hinge.flexion, exact * one)
            row.append(2.0 * np.arctan2(np.linalg.norm(knee[frame, 1:]), knee[frame, 0]))
        bends.append(np.abs(np.diff(row)).max())
    assert bends[1] < 0.5 * bends[0]


def test_a_leg_that_is_always_straight_bends_backwards() -> None:
    body = still_body(20)
    leg = legs(body)[0]
    turned = world_rotations(body, [leg.hip, leg.hip, leg.knee, leg.ankle])
    hinge = hinge_of(body, leg, world(body), turned)
    np.testing.assert_allclose(np.abs(hinge.axis), [1, 0, 0], atol=1e-12)
    none, one = np.zeros(20), np.ones(20)
    target = hinge.ankle + np.array([0.0, 5.0, 0.0])
    _, knee, short = reached(hinge, hinge.hip, target, none, none, none, one)
    assert (rotation.rotate(knee, hinge.q)[:, 2] < -1.0).all()  # the foot, which points along z, goes back
    np.testing.assert_allclose(short, 0.0, atol=1e-9)
