"""Hips and ankles: their angles are those of the pose, whatever the clip does is allowed, and what is more is told."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from legged import still_body

import mocurve as mc
from mocurve import planar, rotation
from mocurve.edit import _joints
from mocurve.edit._joints import PEOPLE, Joints
from mocurve.edit._locking import locked, source_of
from mocurve.feet.contacts import contacts
from mocurve.feet.legs import legs

LEFT, UP, _ = np.eye(3)


def joints(motion: mc.Motion) -> tuple[Joints, ...]:
    return tuple(side.joints for side in source_of(motion, [], legs(motion)).sides)


def posed(**turns: tuple[float, float, float]) -> mc.Motion:
    """A straight body that stands for a while, bends its knees once in the air, so that their axis is known, and then,
    in the air too, has some joints turned about X, Y and Z."""
    body = still_body(30)
    values = body.values.copy()
    values[6:, 1] += 50.0
    for side in "LR":
        values[6:15, body.skeleton.channel(f"{side}Shin.Xrotation")] = 40.0 * np.sin(np.linspace(0.0, np.pi, 9)) ** 2
    for joint, angles in turns.items():
        for axis, angle in zip("XYZ", angles, strict=True):
            values[15:, body.skeleton.channel(f"{joint}.{axis}rotation")] = angle
    return replace(body, values=values)


def angles(found: Joints) -> np.ndarray:
    made = np.zeros((len(found.vectors), 4))
    _joints._angles(found.vectors, made)
    return made


@pytest.mark.parametrize(
    ("turns", "left", "right"),
    [
        ({}, (45, 0, 0, 0), (45, 0, 0, 0)),
        ({"LThigh": (-45, 0, 0), "RThigh": (-90, 0, 0)}, (0, 0, 0, 0), (45, 0, 0, 0)),
        ({"LThigh": (0, 30, 0), "RThigh": (0, 30, 0)}, (45, 30, 0, 0), (45, 30, 0, 0)),
        ({"LFoot": (0, 25, 0), "RFoot": (0, -25, 0)}, (45, 0, 0, 25), (45, 0, 0, -25)),
        ({"LFoot": (-20, 0, 0), "RFoot": (35, 0, 0)}, (45, 0, 20, 0), (45, 0, -35, 0)),
    ],
)
def test_angles_are_those_of_the_pose(
    turns: dict[str, tuple[float, float, float]], left: tuple[float, ...], right: tuple[float, ...]
) -> None:
    for found, expected in zip(joints(posed(**turns)), (left, right), strict=True):
        np.testing.assert_allclose(angles(found)[-1], expected, atol=1e-6)


def test_angles_do_not_hang_on_where_the_body_is_or_faces() -> None:
    body = posed(LThigh=(-20, 15, 5), LFoot=(10, 20, 0), RThigh=(10, -10, 0))
    values = body.values.copy()
    values[:, 4] = 130.0
    values[:, 0] += 70.0
    for here, there in zip(joints(body), joints(replace(body, values=values)), strict=True):
        np.testing.assert_allclose(angles(there), angles(here), atol=1e-6)
        np.testing.assert_allclose(there.turned, here.turned, atol=1e-9)


def test_where_nothing_is_turned_nothing_is_beyond(clips: Path) -> None:
    dance = mc.read(clips / "cmu" / "cmu_05_20_dance_motionbuilder.bvh")
    assert isinstance(dance, mc.Motion)
    for found in joints(dance):
        none = np.tile([1.0, 0.0, 0.0, 0.0], (len(found.vectors), 1))
        assert (np.abs(found.ends) > np.abs(PEOPLE)).any()  # a dancer does more than most
        assert max(over.max() for over in found.beyond(none, none, none)) == 0.0


@pytest.mark.parametrize(
    ("axis", "angle", "hip", "ankle"),
    [(UP, 55.0, 0.0, 0.0), (UP, 75.0, 15.0, 0.0), (-UP, 75.0, 15.0, 0.0), (LEFT, 55.0, 10.0, 0.0)],
)
def test_a_thigh_turned_too_far_is_told_by_how_much(axis: np.ndarray, angle: float, hip: float, ankle: float) -> None:
    found = joints(posed())[0]
    turned = np.tile(rotation.exp(np.radians(angle) * axis), (30, 1))
    over = found.beyond(turned, turned, turned)
    assert over[0][-1] == pytest.approx(hip, abs=1e-6)
    assert over[1][-1] == pytest.approx(ankle, abs=1e-6)


@pytest.mark.parametrize(
    ("axis", "angle", "ankle"),
    [(UP, 48.0, 0.0), (UP, 62.0, 12.0), (-UP, 62.0, 12.0), (-LEFT, 70.0, 15.0), (LEFT, 60.0, 0.0), (LEFT, 70.0, 5.0)],
)
def test_a_foot_turned_too_far_is_told_by_how_much(axis: np.ndarray, angle: float, ankle: float) -> None:
    found = joints(posed())[0]
    none, turned = (np.tile(rotation.exp(np.radians(by) * axis), (30, 1)) for by in (0.0, angle))
    over = found.beyond(none, none, turned)
    assert over[0][-1] == 0.0
    assert over[1][-1] == pytest.approx(ankle, abs=1e-6)


@given(st.floats(-3.0, 3.0), st.floats(0.1, 1.0), st.floats(0.1, 1.0))
def test_hip_and_ankle_share_a_turn_and_neither_goes_beyond_its_end_alone(
    turn: float, hip: float, ankle: float
) -> None:
    found = replace(joints(posed())[0], rooms=np.tile([[[hip, hip], [ankle, ankle]]], (30, 1, 1)))
    part = found.share(np.full(30, turn))[0]
    own, other = part * abs(turn), (1.0 - part) * abs(turn)
    if abs(turn) <= min(hip, ankle):
        assert part == 0.5
    if abs(turn) <= 0.5 * (hip + ankle):
        assert own <= hip + 1e-9
        assert other <= ankle + 1e-9
    assert found.share(np.full(30, turn + 1e-6))[0] == pytest.approx(part, abs=1e-4)


def test_what_a_joint_cannot_do_is_refused(jump: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    clip = mc.read(jump)
    assert isinstance(clip, mc.Motion)
    both, listed = legs(clip), contacts(clip)
    carry = np.zeros((clip.frames, 3))
    carry[:, 0] = np.radians(50.0) * np.clip((np.arange(clip.frames) - 150) / 60.0, 0.0, 1.0)
    carry[:, 1:] = -planar.move(carry, np.tile(clip.values[180, [0, 1, 2]], (clip.frames, 1)))[:, [0, 2]]
    assert {"hip", "ankle"}.isdisjoint(problem.kind for problem in locked(clip, carry, listed, both)[1].problems)
    monkeypatch.setattr(_joints, "PEOPLE", np.zeros((4, 2)))  # then a leg may do what it does in the clip alone
    strain = locked(clip, carry, listed, both)[1]
    told = next(problem for problem in strain.problems if problem.kind in ("hip", "ankle"))
    assert told.value > 5.0
    assert told.stride is None
    assert "degrees further than it can be (most 5) at frames" in told.sentence(clip.frame_time)
