"""Feet held while the body is carried elsewhere: a rigid carry moves the result rigidly, a bent one leaves knees calm,
and what is asked too much is told."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from legged import with_twist, without

import mocurve as mc
from mocurve import Contact, Mismatch, planar, rotation
from mocurve.edit import _locking
from mocurve.edit._locking import held, locked, source_of
from mocurve.feet.contacts import contacts
from mocurve.feet.legs import centimetres, legs
from mocurve.feet.skate import skate
from mocurve.info import first_frame_is_t_pose
from mocurve.kinematics import rotations, world


@pytest.fixture(scope="module")
def clip(jump: Path) -> mc.Motion:
    motion = mc.read(jump)
    assert isinstance(motion, mc.Motion)
    return motion


def walk(clips: Path, name: str = "cmu_02_01_walk_blender.bvh") -> mc.Motion:
    motion = mc.read(clips / "cmu" / name)
    assert isinstance(motion, mc.Motion)
    return motion[int(first_frame_is_t_pose(motion)) :]


def bent(motion: mc.Motion, radius: float) -> np.ndarray:
    """The carry (F, 3) that lays a straight way along the axis it goes along most on a circle, radius in cm."""
    scale = centimetres(motion)
    root = world(motion)[:, 0]
    first, last = root[0, [0, 2]], root[-1, [0, 2]]
    way = (last - first) / np.linalg.norm(last - first)
    s = (root[:, [0, 2]] - first) @ way
    angle = scale * s / radius
    turned = np.column_stack([angle, np.zeros((len(s), 2))])
    on_way = first + s[:, None] * way
    across = np.array([way[1], -way[0]])
    there = first + radius / scale * (np.sin(angle)[:, None] * way + (1.0 - np.cos(angle))[:, None] * across)
    flat = np.column_stack([on_way[:, 0], np.zeros(len(s)), on_way[:, 1]])
    return np.column_stack([angle, there - planar.move(turned, flat)[:, [0, 2]]])


def quickening(motion: mc.Motion, joint: int) -> np.ndarray:
    turned = rotations(motion)[:, joint]
    steps = rotation.log(rotation.mul(rotation.inv(turned[:-1]), turned[1:]))
    return np.linalg.norm(np.diff(steps, axis=0), axis=1)


# -- laws ------------------------------------------------------------------------------------------
@pytest.mark.parametrize("rigid", [(0.0, 0.0, 0.0), (2.5, 30.0, -700.0), (-9.0, 0.0, 4.0)])
def test_a_rigid_carry_moves_the_result_rigidly(clip: mc.Motion, rigid: tuple[float, float, float]) -> None:
    both, listed = legs(clip), contacts(clip)
    still, _ = locked(clip, np.zeros((clip.frames, 3)), listed, both)
    moved, strain = locked(clip, np.tile(rigid, (clip.frames, 1)), listed, both)
    expected = planar.move(np.array(rigid), world(still))
    np.testing.assert_allclose(world(moved), expected, atol=1e-9 * (1 + np.abs(expected).max()))
    assert strain.changed == strain.stances == 6


def test_without_contacts_the_body_is_only_carried(clip: mc.Motion) -> None:
    carry = bent(clip, 200.0)
    made, strain = locked(clip, carry, [], legs(clip))
    np.testing.assert_allclose(world(made), planar.move(carry[:, None], world(clip)), atol=1e-9)
    assert strain.stances == 0
    unmoved, _ = locked(clip, np.zeros((clip.frames, 3)), [], legs(clip))
    assert unmoved.values.tobytes() == clip.values.tobytes()


def test_where_nothing_is_carried_unevenly_and_no_foot_slides_nothing_changes(clip: mc.Motion) -> None:
    both = legs(clip)
    still, _ = locked(clip, np.zeros((clip.frames, 3)), contacts(clip), both)
    carry = np.zeros((clip.frames, 3))
    carry[300:] = [0.3, 5.0, -9.0]  # between the second and the third stance, in flight
    carry[270:300] = np.linspace(0, 1, 30)[:, None] * carry[300]
    made, strain = locked(still, carry, contacts(still), both)
    assert strain.changed == 0
    assert made.values[:270].tobytes() == still.values[:270].tobytes()
    others = ~np.isin(still.skeleton.channel_joints, [0])
    assert made.values[:, others].tobytes() == still.values[:, others].tobytes()


def test_a_local_edit_leaves_the_rest_as_it_was(clip: mc.Motion) -> None:
    both = legs(clip)
    still, _ = locked(clip, np.zeros((clip.frames, 3)), contacts(clip), both)
    carry = np.zeros((clip.frames, 3))
    u = np.clip((np.arange(clip.frames) - 330) / 60.0, 0.0, 1.0)
    carry[:, 1] = 0.4 * u * u * (3.0 - 2.0 * u)  # in the last stance alone
    made, strain = locked(still, carry, contacts(still), both)
    assert strain.changed == 2
    reach = 320 - 73  # 0.6 s before it, and its swing
    assert made.values[: reach - 1].tobytes() == still.values[: reach - 1].tobytes()
    assert not np.array_equal(made.values, still.values)


def test_what_is_looked_at_is_enough(clips: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    motion = walk(clips, "cmu_12_01_walk.bvh")
    both = legs(motion)
    still, _ = locked(motion, np.zeros((motion.frames, 3)), contacts(motion), both)
    source = source_of(still, contacts(still), both)
    for first in (40, 180, 330):
        u = np.clip((np.arange(motion.frames) - first) / 60.0, 0.0, 1.0)
        carry = (u * u * (3.0 - 2.0 * u))[:, None] * [0.2, 1.0, -0.5]
        made, strain = held(source, carry)
        monkeypatch.setattr(_locking, "_context", lambda sides, active: slice(0, len(active)))
        whole, same = held(source, carry)
        monkeypatch.undo()
        assert 1 <= strain.changed == same.changed < strain.stances == same.stances
        np.testing.assert_allclose(made.values, whole.values, atol=1e-7)
        assert strain.drop == pytest.approx(same.drop, abs=1e-9)


def test_the_same_source_is_carried_again_and_again(clip: mc.Motion) -> None:
    both, listed, carry = legs(clip), contacts(clip), bent(clip, 150.0)
    source = source_of(clip, listed, both)
    held(source, np.zeros((clip.frames, 3)))
    assert held(source, carry)[0].values.tobytes() == locked(clip, carry, listed, both)[0].values.tobytes()


def test_a_t_pose_in_front_is_carried_and_else_left_alone(clips: Path) -> None:
    motion = mc.read(clips / "cmu" / "cmu_12_01_walk.bvh")
    assert isinstance(motion, mc.Motion)
    assert first_frame_is_t_pose(motion)
    both, listed = legs(motion), contacts(motion)
    zero = np.zeros((motion.frames, 3))
    made, _ = locked(motion, zero, listed, both)
    assert made.values[0].tobytes() == motion.values[0].tobytes()
    inner = [replace(c, first=max(c.first - 1, 0), last=c.last - 1) for c in listed]
    alone, _ = locked(motion[1:], zero[1:], inner, both)
    np.testing.assert_array_equal(made.values[1:], alone.values)


# -- promises on real clips ------------------------------------------------------------------------
@pytest.mark.parametrize(
    ("name", "speed"),
    [("cmu_02_01_walk_blender.bvh", 15.0), ("cmu_12_01_walk.bvh", 15.0), ("cmu_run_filtered.bvh", 45.0)],
)
@pytest.mark.parametrize("radius", [300.0, -100.0])
def test_on_an_arc_feet_stand_and_knees_stay_calm(clips: Path, name: str, speed: float, radius: float) -> None:
    motion = walk(clips, name)
    both, listed = legs(motion), contacts(motion, speed=speed)
    made, strain = locked(motion, bent(motion, radius), listed, both)
    assert strain.problems == ()
    assert strain.changed == strain.stances >= 3
    assert strain.miss < 1e-6
    balls = [c for c in listed if c.joint in {motion.skeleton.names[leg.ball] for leg in both}]
    before, after = skate(motion, balls, both, None, speed), skate(made, balls, both, motion, speed)
    assert before is not None
    assert after is not None
    assert before.speed > 5.0
    assert after.speed < 1e-6
    assert after.kept == 1.0
    knees = [np.concatenate([quickening(m, leg.knee) for leg in both]) for m in (motion, made)]
    assert knees[1].max() < 1.25 * knees[0].max()
    assert np.percentile(knees[1], 99) < 1.15 * np.percentile(knees[0], 99)
    ankles = [max(quickening(m, leg.ankle).max() for leg in both) for m in (motion, made)]
    assert ankles[1] < 1.15 * ankles[0]
    np.testing.assert_allclose(
        np.linalg.norm(np.diff(world(made)[:, [both[0].hip, both[0].knee]], axis=1), axis=-1),
        np.linalg.norm(np.diff(world(motion)[:, [both[0].hip, both[0].knee]], axis=1), axis=-1),
    )


def test_too_long_strides_and_too_tight_turns_are_told_with_a_stride_that_mends_them(clips: Path) -> None:
    motion = walk(clips)
    both, listed = legs(motion), contacts(motion)
    stretched = np.zeros((motion.frames, 3))
    root = world(motion)[:, 0]

    def stretch(factor: float) -> np.ndarray:
        stretched[:, 1:] = (factor - 1.0) * (root[:, [0, 2]] - root[0, [0, 2]])
        return stretched

    assert locked(motion, stretch(1.05), listed, both)[1].problems == ()
    _, strain = locked(motion, stretch(1.35), listed, both)
    worst = strain.problems[0]
    assert worst.kind in ("drop", "shift")
    assert worst.stride is not None
    assert 0.7 < worst.stride < 0.95
    least = min(problem.stride or 1.0 for problem in strain.problems)
    assert locked(motion, stretch(1.35 * least), listed, both)[1].problems == ()
    _, strain = locked(motion, bent(motion, 30.0), listed, both)
    assert strain.pivots > 2
    assert strain.twist < 31.0
    aside = next(problem for problem in strain.problems if problem.kind == "shift")
    assert aside.stride is not None
    assert 0.4 <= aside.stride < 1.0
    assert "aside" in aside.sentence(motion.frame_time)
    assert f"frames {aside.first} to {aside.last}" in aside.sentence(motion.frame_time)


def test_a_body_that_turns_before_its_foot_is_free_to_is_told(clip: mc.Motion) -> None:
    both, listed = legs(clip), [c for c in contacts(clip) if c.first < 150]
    ball, heel = (next(c for c in listed if c.joint == joint) for joint in ("LeftToeBase", "LeftFoot"))
    short = [replace(ball, first=ball.last - 11), replace(heel, first=ball.first, last=ball.last - 4)]
    u = np.clip((np.arange(clip.frames) - ball.first) / (ball.last - ball.first), 0.0, 1.0)
    turn = np.column_stack([2.0 * u, 0.0 * u, 0.0 * u])
    away = planar.move(turn, np.array(ball.place)) - ball.place
    _, strain = locked(clip, np.column_stack([turn[:, 0], -away[:, 0], -away[:, 2]]), short, both)
    twisted = next(problem for problem in strain.problems if problem.kind == "twist")
    assert twisted.stride == pytest.approx(max(0.4, 0.8 * 45.0 / twisted.value))
    assert "the body turns" in twisted.sentence(clip.frame_time)


# -- other bodies ----------------------------------------------------------------------------------
def slides(motion: mc.Motion, made: mc.Motion, listed: tuple[Contact, ...]) -> float:
    both = legs(motion)
    balls = [c for c in listed if c.joint in {motion.skeleton.names[leg.ball] for leg in both}]
    found = skate(made, balls, both, motion)
    assert found is not None
    return found.speed


def test_joints_between_hip_knee_and_ankle_are_carried_along(clip: mc.Motion) -> None:
    body = with_twist(with_twist(clip, "LeftUpLeg", "LeftLeg", 0.5), "LeftLeg", "LeftFoot", 0.4)
    values = body.values.copy()
    values[:, body.skeleton.channel("LeftUpLegTwist.Yrotation")] = 7.0
    values[:, body.skeleton.channel("LeftLegTwist.Yrotation")] = np.linspace(-9.0, 9.0, body.frames)
    body = replace(body, values=values)
    listed = contacts(body)
    made, strain = locked(body, bent(body, 300.0), listed, legs(body))
    assert strain.miss < 1e-6
    assert slides(body, made, listed) < 1e-6
    for name in ("LeftUpLegTwist.Yrotation", "LeftLegTwist.Yrotation"):
        column = body.skeleton.channel(name)
        np.testing.assert_array_equal(made.values[:, column], body.values[:, column])


def test_without_toes_the_ankle_stands(clip: mc.Motion) -> None:
    body = without(clip, "LeftToeBase", "RightToeBase")
    listed = contacts(body, height=8.0)
    assert {c.joint for c in listed} == {"LeftFoot", "RightFoot"}
    made, strain = locked(body, np.zeros((body.frames, 3)), listed, legs(body))
    assert strain.miss < 1e-6
    assert slides(body, made, listed) < 1e-6


def under(clip: mc.Motion, channels: tuple[str, ...]) -> mc.Motion:
    """The clip with a root more above it, turned by 90 degrees about X, and the body turned back."""
    skeleton = clip.skeleton
    body = mc.Skeleton(
        ("Root", *skeleton.names),
        [-1, *(skeleton.parents + 1).tolist()],
        np.vstack([np.zeros((1, 3)), skeleton.offsets]),
        (channels, *skeleton.channels),
        np.concatenate([[False], skeleton.end_sites]),
    )
    turn = rotation.exp(np.array([0.5 * np.pi, 0.0, 0.0]))
    (columns, order) = skeleton.eulers[0]
    values = clip.values.copy()
    values[:, :3] = rotation.rotate(rotation.inv(turn), clip.values[:, :3])
    own = rotation.mul(rotation.inv(turn), rotation.from_euler(clip.values[:, columns], order))
    values[:, columns] = rotation.to_euler(own, order)
    above = np.zeros((clip.frames, len(channels)))
    above[:, channels.index("Xrotation")] = 90.0
    return replace(clip, skeleton=body, values=np.hstack([above, values]))


def test_a_body_under_a_turned_root_is_moved_where_it_has_channels(clip: mc.Motion) -> None:
    body = under(clip, ("Xrotation", "Yrotation", "Zrotation"))
    np.testing.assert_allclose(world(body)[:, 1:], world(clip), atol=1e-9)
    zero = np.zeros((clip.frames, 3))
    listed, own = contacts(body), contacts(clip)
    made, _ = locked(body, zero, listed, legs(body))
    expected, _ = locked(clip, zero, own, legs(clip))
    np.testing.assert_allclose(world(made)[:, 1:], world(expected), atol=1e-6)
    with pytest.raises(Mismatch, match="the root 'Root' lacks position channels"):
        locked(body, bent(clip, 300.0), listed, legs(body))
    free = under(clip, tuple(f"{axis}{kind}" for kind in ("position", "rotation") for axis in "XYZ"))
    made, _ = locked(free, bent(clip, 300.0), listed, legs(free))
    expected, _ = locked(clip, bent(clip, 300.0), own, legs(clip))
    np.testing.assert_allclose(world(made)[:, 1:], world(expected), atol=1e-6)


def test_a_body_that_cannot_be_moved_is_refused(clip: mc.Motion) -> None:
    fixed = mc.Skeleton(
        clip.skeleton.names,
        clip.skeleton.parents,
        clip.skeleton.offsets,
        (clip.skeleton.channels[0][3:], *clip.skeleton.channels[1:]),
        clip.skeleton.end_sites,
    )
    body = replace(clip, skeleton=fixed, values=clip.values[:, 3:])
    with pytest.raises(Mismatch, match="no joint above 'Hips' has position channels"):
        locked(body, np.zeros((clip.frames, 3)), contacts(body), legs(body))


def hinged(clip: mc.Motion, joints: tuple[str, ...]) -> mc.Motion:
    """The clip with some joints that turn about X alone."""
    skeleton = clip.skeleton
    places = [skeleton.joint(name) for name in joints]
    channels = [("Xrotation",) if joint in places else own for joint, own in enumerate(skeleton.channels)]
    kept = [not (joint in places and name[-9:] != "Xrotation") for joint, name in _channels(clip)]
    body = mc.Skeleton(skeleton.names, skeleton.parents, skeleton.offsets, tuple(channels), skeleton.end_sites)
    return replace(clip, skeleton=body, values=clip.values[:, kept])


def _channels(clip: mc.Motion) -> list[tuple[int, str]]:
    return list(zip(clip.skeleton.channel_joints.tolist(), clip.skeleton.channel_names, strict=True))


def test_knees_with_one_channel_are_bent_by_that(clip: mc.Motion) -> None:
    body = hinged(clip, ("LeftLeg", "RightLeg"))
    listed = contacts(body)
    assert listed
    made, strain = locked(body, bent(body, 300.0), listed, legs(body))
    assert strain.miss < 1e-6
    assert slides(body, made, listed) < 1e-6


def test_what_ankles_of_one_channel_cannot_do_is_measured(clip: mc.Motion) -> None:
    body = hinged(clip, ("LeftFoot", "RightFoot"))
    _, strain = locked(body, bent(body, 100.0), contacts(body), legs(body))
    assert strain.miss > 0.1
    assert "miss" in {problem.kind for problem in strain.problems}
