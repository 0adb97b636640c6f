"""Feet that turn on the spot: the ball stays, the foot is turned against the body by no more than is comfortable, and
comes to rest and leaves without a jerk; a foot that need not turn does not."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import mocurve as mc
from mocurve import planar
from mocurve.edit._joints import COMFORT, Joints
from mocurve.edit._locking import held, locked, source_of
from mocurve.edit._pivots import pivots
from mocurve.edit._poses import smooth
from mocurve.edit._stances import Stances
from mocurve.feet.contacts import Contact, contacts
from mocurve.feet.legs import centimetres, legs, tracks
from mocurve.info import first_frame_is_t_pose
from mocurve.kinematics import rotations, world
from mocurve.rotation import inv, log, mul

STEP = 0.01


def stood(spans: Sequence[Sequence[int]], frames: int) -> Stances:
    of = np.full(frames, -1)
    for i, (first, end) in enumerate(spans):
        of[first:end] = i
    few, none = np.zeros(len(spans), bool), np.zeros((frames, 3))
    ends = np.array(spans)
    return Stances(ends, of, none[: len(spans)], few, few, none, none, none[:, 0], none[:, 0], ends)


def free(frames: int) -> Joints:
    """Joints with room for anything, of a foot that points where the body faces."""
    none, most = np.zeros(frames), np.full(frames, COMFORT)
    rooms = np.full((frames, 2, 2), 3.0)
    return Joints(np.zeros((frames, 6, 3)), np.zeros((4, 2)), rooms, none, np.zeros(2), -most, most)


def captured(clips: Path, name: str) -> mc.Motion:
    motion = mc.read(clips / "cmu" / f"cmu_{name}.bvh")
    assert isinstance(motion, mc.Motion)
    return motion[int(first_frame_is_t_pose(motion)) :]


def balls(motion: mc.Motion) -> list[Contact]:
    names = {motion.skeleton.names[leg.ball] for leg in legs(motion)}
    return [contact for contact in contacts(motion) if contact.joint in names]


def spun(motion: mc.Motion, listed: Sequence[Contact], degrees: Sequence[float]) -> np.ndarray:
    """The carry (F, 3) that turns the body by so much over each of these contacts, about where the foot stands."""
    carry = np.zeros((motion.frames, 3))
    for contact, angle in zip(listed, degrees, strict=True):
        place = planar.move(carry[(contact.first + contact.last) // 2], np.array(contact.place))
        u = np.clip((np.arange(motion.frames) - contact.first) / (contact.last - contact.first), 0.0, 1.0)
        turn = np.column_stack([np.radians(angle) * smooth(u), 0.0 * u, 0.0 * u])
        away = place - planar.move(turn, place)
        carry = planar.compose(np.column_stack([turn[:, 0], away[:, 0], away[:, 2]]), carry)
    return carry


def yaws(motion: mc.Motion, contact: Contact) -> np.ndarray:
    """Which way (F,) the foot of a contact points, radians."""
    both = legs(motion)
    at = [motion.skeleton.names[leg.ball] for leg in both].index(contact.joint)
    ball, heel = (points[at] for points in tracks(motion, both))
    return np.unwrap(np.arctan2(*(ball - heel)[:, [0, 2]].T))


def slides(motion: mc.Motion, contact: Contact) -> float:
    """The fastest step, cm/s, over the ground of the ball, or the heel, that a contact is of."""
    both, names = legs(motion), motion.skeleton.names
    points = dict(
        zip(
            [names[joint] for leg in both for joint in (leg.ball, leg.ankle)],
            np.stack(tracks(motion, both), axis=1).reshape(4, -1, 3),
            strict=True,
        )
    )
    steps = np.diff(points[contact.joint][contact.first : contact.last + 1, ::2], axis=0)
    return float(np.linalg.norm(steps, axis=1).max() * centimetres(motion) / motion.frame_time)


def calm(motion: mc.Motion) -> tuple[float, float]:
    """Largest and 99th percentile of the knees' angular acceleration."""
    turned = rotations(motion)[:, [leg.knee for leg in legs(motion)]]
    steps = np.diff(log(mul(inv(turned[:-1]), turned[1:])), axis=0)
    sizes = np.linalg.norm(steps, axis=-1)
    return float(sizes.max()), float(np.percentile(sizes, 99))


# -- laws ------------------------------------------------------------------------------------------
@given(st.floats(-3.0, 3.0), st.integers(0, 60), st.integers(20, 100))
def test_a_foot_is_turned_against_the_body_by_what_is_comfortable(turn: float, start: int, frames: int) -> None:
    heading = turn * smooth(np.clip((np.arange(160) - start) / frames, 0.0, 1.0))
    stances = stood([[20, 140]], 160)
    angle = np.array([heading[20:140].mean()])
    made = pivots(stances, angle, heading, free(160), STEP)
    away = angle + made.angle[20:140] - heading[20:140]
    before = np.abs(angle - heading[20:140]).max()
    if before <= COMFORT:
        assert not made.angle.any()
    assert np.abs(away).max() <= max(COMFORT, before) + 1e-9
    if start >= 30 and start + frames <= 130:  # not while the foot lands or leaves
        assert np.abs(away).max() <= COMFORT + 1e-9
    assert not np.delete(made.angle, np.arange(20, 140)).any()
    assert made.whole[0] == pytest.approx(np.ptp(made.angle))


@pytest.mark.parametrize("turn", [90.0, -120.0, 360.0])
def test_a_foot_turns_by_the_rest_and_comes_and_goes_without_a_jerk(turn: float) -> None:
    heading = np.radians(turn) * smooth(np.clip((np.arange(400) - 50) / 300.0, 0.0, 1.0))
    stances = stood([[0, 400]], 400)
    made = pivots(stances, np.array([heading.mean()]), heading, free(400), STEP / 4)
    assert np.degrees(made.whole[0]) == pytest.approx(abs(turn) - 60.0, abs=0.1 * abs(turn))
    rate = np.diff(made.angle)
    assert (rate * np.sign(turn) >= 0).all()
    bends = np.abs(np.diff(rate))
    assert np.abs(rate[[0, -1]]).max() < 1e-6
    assert bends.max() <= 1.05 * np.abs(np.diff(heading, 2)).max()
    assert np.abs(np.diff(bends)).max() < 0.1 * bends.max()


def test_a_body_that_turns_all_the_time_does_not_turn_a_foot_that_lands_or_leaves() -> None:
    heading = np.radians(np.linspace(0.0, 360.0, 300))
    stances = stood([[100, 200]], 300)
    made = pivots(stances, np.array([heading[100:200].mean()]), heading, free(300), STEP)
    rate = np.diff(made.angle[100:200])
    assert made.whole[0] > np.radians(50.0)
    assert np.abs(rate[[0, -1]]).max() < 0.02 * rate.max()
    assert np.abs(np.diff(rate)).max() < 0.25 * rate.max()


def test_a_joint_at_its_end_turns_the_foot_sooner() -> None:
    heading = np.radians(40.0) * smooth(np.linspace(0.0, 1.0, 200))
    stances, angle = stood([[0, 200]], 200), np.array([heading.mean()])
    assert not pivots(stances, angle, heading, free(200), STEP).whole.any()
    tight = free(200)
    tight.high[:] = np.radians(10.0)
    made = pivots(stances, angle, heading, tight, STEP)
    assert (angle + made.angle - heading).max() <= np.radians(10.0) + 1e-9


# -- promises --------------------------------------------------------------------------------------
@pytest.mark.parametrize("angle", [90.0, -135.0])
@pytest.mark.parametrize("name", ["12_01_walk", "02_01_walk_blender"])
def test_a_walk_that_turns_on_one_foot(name: str, angle: float, clips: Path) -> None:
    motion = captured(clips, name)
    both, listed = legs(motion), contacts(motion)
    contact = balls(motion)[2]
    carry = spun(motion, [contact], [angle])
    made, strain = locked(motion, carry, listed, both)
    assert strain.problems == ()
    assert strain.pivots == 1
    assert abs(angle) - 120.0 < strain.pivoted < abs(angle)
    assert strain.twist <= 30.0 + 1e-6
    assert strain.pivot < 540.0
    assert max(slides(made, c) for c in balls(motion)) < 1e-6
    span = slice(contact.first, contact.last + 1)
    still = yaws(motion, contact)[span].mean() - yaws(motion, contact)[span]
    turned = yaws(made, contact)[span] + still
    assert np.degrees(np.ptp(turned)) == pytest.approx(strain.pivoted, abs=15.0)  # what the capture itself turns
    before, after = calm(motion), calm(made)
    assert after[0] <= 1.25 * before[0]
    assert after[1] <= 1.15 * before[1]


def test_feet_that_need_not_turn_do_not(clips: Path) -> None:
    motion = captured(clips, "12_01_walk")
    both, listed = legs(motion), contacts(motion)
    contact = balls(motion)[2]
    made, strain = locked(motion, spun(motion, [contact], [45.0]), listed, both)
    assert strain.pivots == strain.pivoted == 0
    assert 10.0 < strain.twist < 30.0
    for c in balls(motion):
        span = slice(c.first, c.last + 1)
        turned = yaws(made, c)[span] - yaws(motion, c)[span]
        np.testing.assert_allclose(turned, turned[0], atol=1e-9)


@pytest.mark.parametrize("by", [(90.0, 90.0), (60.0, 60.0, 60.0), (180.0,)])
def test_there_and_back_laid_on_a_straight_path_goes_straight_on(by: tuple[float, ...], clips: Path) -> None:
    motion = captured(clips, "12_01_walk")
    own = balls(motion)[3 : 3 + len(by)]
    turned, strain = locked(motion, spun(motion, own, by), contacts(motion), legs(motion))
    assert strain.problems == ()
    way = mc.Path([(0, 0), (0, mc.Path.of(turned).length)])
    for heading in ("tangent", "facing"):
        made = mc.follow(turned, way, heading=heading)
        feet = made.history[-1]["measured"]["feet"]
        assert feet["released"] == 0
        assert feet["speed_slid"] > 10.0
        assert feet["speed"] < 0.01
        assert max(slides(made, c) for c in balls(turned)) < 0.02  # of what is still already, 0.01 is left
        assert np.ptp(world(made)[:, 0, 2]) > 2.0 * np.ptp(world(turned)[:, 0, ::2], axis=0).max() - 40.0
        assert calm(made)[0] <= 1.25 * calm(turned)[0]
        assert calm(made)[1] <= 1.15 * calm(turned)[1]


def test_a_whole_clip_with_turns_on_the_spot_on_a_straight_path(clips: Path) -> None:
    motion = captured(clips, "01_01_jump")
    way = mc.Path([(0, 0), (0, mc.Path.of(motion).length)])
    feet = mc.follow(motion, way).history[-1]["measured"]["feet"]
    assert feet["released"] == 0
    assert feet["speed_slid"] > 10.0
    assert feet["speed"] < 0.01
    assert feet["pivots"] == 3
    assert 45.0 < feet["pivoted"] < 90.0


def test_a_heel_that_stands_alone_is_held(clips: Path) -> None:
    motion = captured(clips, "94_01_dance_max")[330:480]
    alone = [c for c in contacts(motion) if c.joint == "LeftAnkle"]
    assert len(alone) == 1
    (heel,) = alone
    assert not any(c.joint == "LeftToe" and c.first <= heel.last and heel.first <= c.last for c in balls(motion))
    made = mc.lock_feet(motion)
    assert slides(motion, heel) > 1.0
    assert slides(made, heel) < 1e-6
    own, now = (yaws(clip, replace(heel, joint="LeftToe"))[heel.first : heel.last + 1] for clip in (motion, made))
    np.testing.assert_allclose(now - own, 0.0, atol=1e-9)  # about it the foot turns as it did


# -- refusals --------------------------------------------------------------------------------------
def test_a_foot_that_would_have_to_turn_too_fast_is_told(clips: Path) -> None:
    motion = captured(clips, "12_01_walk")
    both, listed = legs(motion), contacts(motion)
    _, strain = held(source_of(motion, listed, both), spun(motion, [balls(motion)[2]], [330.0]))
    told = next(problem for problem in strain.problems if problem.kind == "pivot")
    assert told.value == strain.pivot > 540.0
    assert told.stride == pytest.approx(0.8 * 540.0 / told.value)
    assert "turns on the spot at" in told.sentence(motion.frame_time)
    assert "degrees a second (most 540)" in told.sentence(motion.frame_time)
