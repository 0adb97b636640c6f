"""blend and mix: clips themselves at the ends, no flips between, curves exact where the maths is."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from chains import keys, samples
from turning import ALONG, FRAME_TIME, FRAMES, apart, heading, spline, turning, widest_step

import mocurve as mc
from mocurve import Mismatch, OptionError, UnknownName, kinematics, rotation

TIMES = ALONG * 2.0
PAIRS = {  # headings of the first and the second, degrees
    "both turned three times": (1080 * ALONG, 1080 * ALONG + 60),
    "one turned three times, one not": (1080 * ALONG, 0 * ALONG),
    "turned three and two times the other way": (1080 * ALONG, 20 - 720 * ALONG),
    "170 degrees apart": (90 * ALONG, 90 * ALONG + 170),
    "now below, now above 180 apart": (0 * ALONG, 178 + 4 * np.sin(9 * ALONG)),
}


@pytest.fixture
def jump_and_later(jump: Path) -> tuple[mc.Motion, mc.Motion]:
    motion = mc.read(jump)
    return motion[:300], motion[120:]


# -- identity ------------------------------------------------------------------------------------
def test_weight_0_is_the_first_and_weight_1_the_second(jump_and_later: tuple[mc.Motion, mc.Motion]) -> None:
    a, b = jump_and_later
    for first, second in [(a, b), (a[:100], b), (samples(), samples(9, size=40.0)), (keys(), keys(21))]:
        assert mc.blend(first, second, 0).sample().values.tobytes() == first.sample().values.tobytes()
        assert mc.blend(first, second, 1).sample().values.tobytes() == second.sample().values.tobytes()


def test_equal_clips_blend_to_themselves(jump: Path) -> None:
    motion = mc.read(jump)
    for weight in (0.3, "0:0,3:1", {"Left*": 0.7}, 1.4):
        assert apart(mc.blend(motion, motion, weight), motion) < 1e-10


def test_a_weight_that_goes_from_0_to_1_starts_in_one_clip_and_ends_in_the_other() -> None:
    a, b = (turning(heading, tilt) for heading, tilt in zip(PAIRS["170 degrees apart"], (8.0, -12.0), strict=True))
    made = mc.blend(a, b, [(0.0, 0.0), (2.0, 1.0)])
    assert apart(made[:1], a[:1]) < 1e-12
    assert apart(made[-1:], b[-1:]) < 1e-12


# -- rotations -----------------------------------------------------------------------------------
@pytest.mark.parametrize("name", PAIRS)
def test_nothing_flips(name: str) -> None:
    first, second = PAIRS[name]
    a, b = turning(first, 8.0), turning(second, -12.0)
    made = mc.blend(a, b, 0.5)
    assert widest_step(made) < 1.02 * max(widest_step(a), widest_step(b))
    np.testing.assert_allclose(
        heading(made), (first + second) / 2, atol=1.5
    )  # tilts blend too: not a heading's exact mean
    assert np.abs(np.diff(made.values, axis=0)).max() < 7.0  # nor do the channels


@pytest.mark.parametrize("lean", [20.0, 45.0, 70.0])
@pytest.mark.parametrize("turned", [430.0, 1330.0])
def test_a_body_that_spins_while_it_leans_does_not_flip(lean: float, turned: float) -> None:
    spin = rotation.from_euler(turned * ALONG[:, None], "Y")
    leaning = rotation.mul(rotation.from_euler(np.full((FRAMES, 1), lean), "X"), spin)
    angles = rotation.to_euler(leaning, "ZXY")
    a = turning(0 * ALONG, 0.0)
    b = replace(a, values=np.hstack([a.values[:, :3], angles]))
    for weight in (0.25, 0.5, 0.75):
        assert widest_step(mc.blend(a, b, weight)) < 1.05 * widest_step(b)


def test_between_is_on_the_shorter_arc_at_even_speed(jump_and_later: tuple[mc.Motion, mc.Motion]) -> None:
    a, b = jump_and_later
    made = mc.blend(a, b, 0.25)
    before, after, between = (kinematics.rotations(clip) for clip in (a, b, made))
    whole = rotation.angle(before, after)
    small = whole.max(axis=0) < 170  # joints that never come near to the opposite
    assert small.sum() > 20
    np.testing.assert_allclose(rotation.angle(before, between)[:, small], 0.25 * whole[:, small], atol=1e-9)
    np.testing.assert_allclose(rotation.angle(after, between)[:, small], 0.75 * whole[:, small], atol=1e-9)


def test_weights_per_joint_leave_the_others_as_they_are(jump_and_later: tuple[mc.Motion, mc.Motion]) -> None:
    a, b = jump_and_later
    assert mc.blend(a, b[:200], {"LeftArm": 0.5}).values[:, :6].tobytes() == a.values[:, :6].tobytes()
    made = mc.blend(a, b, ["*Arm=1", "LeftArm=0.5"])
    joints = np.array(a.skeleton.names)[a.skeleton.channel_joints]
    arms = np.char.endswith(joints, "Arm")
    assert made.values[:, ~arms].tobytes() == a.values[:, ~arms].tobytes()
    other = arms & (joints != "LeftArm")
    assert made.values[:, other].tobytes() == b.values[:, other].tobytes()
    assert (made.values[:, joints == "LeftArm"] != a.values[:, joints == "LeftArm"]).any()


def test_clips_of_different_length_meet_in_between(jump_and_later: tuple[mc.Motion, mc.Motion]) -> None:
    a, b = jump_and_later[0][:101], jump_and_later[1][:201]
    made = mc.blend(a, b, 0.5)
    assert made.frames == 151
    middle = [clip.values[(clip.frames - 1) // 2, :3] for clip in (a, b, made)]
    np.testing.assert_allclose(middle[2], (middle[0] + middle[1]) / 2, atol=1e-12)


# -- curves --------------------------------------------------------------------------------------
def test_keys_blend_channel_by_channel_to_keys() -> None:
    a, b = keys(), replace(keys(), curves=tuple(replace(c, values=-0.3 * c.values) for c in keys().curves[::-1]))
    made = mc.blend(a, b, 0.3, mode="curves")
    assert isinstance(made, mc.KeyedMotion)
    off = (
        made.sample(FRAME_TIME / 3).values
        - 0.7 * a.sample(FRAME_TIME / 3).values
        - 0.3 * b.sample(FRAME_TIME / 3).values
    )
    turns = np.where(a.skeleton.rotation_channels, 0.3 * 360.0, 1e9)  # whole turns between the channels do not count
    assert np.abs(off - turns * np.rint(off / turns)).max() < 1e-10


def test_splines_blend_coefficient_by_coefficient() -> None:
    body = turning(0 * ALONG, 1.0).skeleton
    a, b = spline(body, 30, 3, 1), spline(body, 44, 3, 2)
    made = mc.blend(a, b, 0.3, mode="curves")
    assert type(made) is type(a)
    np.testing.assert_allclose(made.sample().values, 0.7 * a.sample().values + 0.3 * b.sample().values, atol=1e-10)


def test_the_product_with_a_weight_that_changes_is_exact_and_told_apart_from_the_coefficients() -> None:
    body = turning(0 * ALONG, 1.0).skeleton
    a, b = spline(body, 30, 3, 1), spline(body, 44, 3, 2)
    points = [(0.0, 0.0), (0.7, 0.2), (2.0, 1.0)]
    weight = np.interp(TIMES, *zip(*points, strict=True))[:, None]
    truth = (1 - weight) * a.sample().values + weight * b.sample().values
    exact, near = (mc.blend(a, b, points, mode=mode) for mode in ("curves", "coefficients"))
    assert (exact.degree, near.degree) == (4, 3)
    np.testing.assert_allclose(exact.sample().values, truth, atol=1e-10)
    assert 1e-3 < np.abs(near.sample().values - truth).max() < 2.0
    with pytest.raises(OptionError, match="5 is the highest: use mode coefficients"):
        mc.blend(spline(body, 30, 5, 1), spline(body, 44, 5, 2), points, mode="curves")


def test_keys_become_samples_where_joints_are_turned_and_that_is_said() -> None:
    with pytest.warns(UserWarning, match="keys become samples: joints turn frame by frame"):
        made = mc.blend(keys(), keys(21), 0.5)
    assert isinstance(made, mc.Motion)
    with pytest.warns(UserWarning, match="a weight that changes in time makes no Hermite curves"):
        mc.blend(keys(), keys(21), "0:0,1:1", mode="curves")


# -- several -------------------------------------------------------------------------------------
def test_a_mix_of_two_is_their_blend_and_its_order_does_not_matter(jump: Path) -> None:
    motion = mc.read(jump)
    a, b, c = motion[:200], motion[100:300], motion[220:420]
    assert apart(mc.mix([a, b], [0.7, 0.3]), mc.blend(a, b, 0.3)) < 1e-10
    assert apart(mc.mix([a, b, c], [1, 2, 3]), mc.mix([c, a, b], [3, 1, 2])) < 1e-10
    assert mc.mix([a, b, c], [0, 1, 0]).values.tobytes() == b.values.tobytes()


def test_in_a_mix_the_turns_to_all_clips_cancel(jump: Path) -> None:
    motion = mc.read(jump)
    clips, weights = [motion[200:240], motion[210:250], motion[225:265]], np.array([0.5, 0.2, 0.3])
    mean = kinematics.rotations(mc.mix(clips, weights))
    turns = [rotation.log(rotation.mul(kinematics.rotations(clip), rotation.inv(mean))) for clip in clips]
    assert np.abs(np.tensordot(weights, turns, 1)).max() < 1e-10


def test_a_mix_of_splines_is_a_spline() -> None:
    body = turning(0 * ALONG, 1.0).skeleton
    clips = [spline(body, count, 3, count) for count in (20, 30, 37)]
    made = mc.mix(clips, [1, 2, 1], mode="curves")
    truth = sum(w * clip.sample().values for w, clip in zip((0.25, 0.5, 0.25), clips, strict=True))
    np.testing.assert_allclose(made.sample().values, truth, atol=1e-10)


# -- bodies and refusals -------------------------------------------------------------------------
def test_joints_are_matched_by_name_in_whatever_order_they_turn() -> None:
    a = turning(40 * ALONG, 8.0)
    other = mc.Skeleton(("Tail", "Hips"), np.array([-1, 0]), np.zeros((2, 3)), (("Xrotation",), (*CHANNELS_XYZ,)))
    q = kinematics.rotations(turning(70 * ALONG, 2.0))[:, 0]
    values = np.hstack([np.zeros((len(q), 1)), np.outer(ALONG, [5.0, 5.0]), rotation.to_euler(q, "XYZ")])
    made = mc.blend(a, mc.Motion(other, values, FRAME_TIME), 1.0, match="names")
    assert rotation.angle(kinematics.rotations(made)[:, 0], q).max() < 1e-10
    np.testing.assert_allclose(made.values[:, 0], 5.0 * ALONG)
    assert made.values[:, 1].tobytes() == a.values[:, 1].tobytes()  # the second says nothing of Yposition


CHANNELS_XYZ = ("Xposition", "Zposition", "Xrotation", "Yrotation", "Zrotation")


@pytest.mark.parametrize(
    ("change", "text"),
    [
        ({"names": ("Pelvis",)}, "joint 1 is 'Hips' in the first, 'Pelvis' in the second"),
        ({"channels": (CHANNELS_XYZ,)}, "'Hips' has Xposition .* in the first, Xposition Zposition .* in the second"),
        ({"unit": 1.0}, "length units differ: 0.01 m in the first, 1 m in the second"),
    ],
)
def test_bodies_that_differ_are_refused_with_the_first_difference(change: dict, text: str) -> None:
    a = turning(0 * ALONG, 1.0)
    a = replace(a, skeleton=replace(a.skeleton, unit=0.01))
    body = replace(a.skeleton, **change)
    b = mc.Motion(body, np.zeros((a.frames, body.channel_count)), FRAME_TIME)
    with pytest.raises(Mismatch, match=text):
        mc.blend(a, b, 0.5)


def test_other_bones_are_told() -> None:
    a = turning(0 * ALONG, 1.0)
    b = replace(a, skeleton=replace(a.skeleton, offsets=np.ones((1, 3))))
    with pytest.warns(UserWarning, match=r"other lengths in the second clip \('Hips'\): the body of the first is kept"):
        mc.blend(a, b, 0.5)


@pytest.mark.parametrize("weight", ["much", "0:0,0:1", [0.2, 0.3], "=0.5", float("nan"), "1:2:3", []])
def test_what_is_no_weight_is_refused(weight: object) -> None:
    a = turning(0 * ALONG, 1.0)
    with pytest.raises(OptionError, match="weight"):
        mc.blend(a, a, weight)


def test_other_wrong_input_is_refused() -> None:
    a = turning(0 * ALONG, 1.0)
    with pytest.raises(UnknownName, match=r"no joint 'Hip'. Did you mean 'Hips'"):
        mc.blend(a, a, "Hip=0.4")
    with pytest.raises(UnknownName, match="no mode 'rotation'"):
        mc.blend(a, a, mode="rotation")
    with pytest.raises(Mismatch, match="not a clip with none"):
        mc.blend(a, a[:0])
    for weight in (1e7, 1e300, -100):
        with pytest.raises(Mismatch, match=r"the clip would last .* s; retime one of the clips first"):
            mc.blend(a, a[:50], weight)
    with pytest.raises(OptionError, match="2 weights are given for 3 clips"):
        mc.mix([a, a, a], [1, 2])
    with pytest.raises(OptionError, match="from 0 up"):
        mc.mix([a, a], [1, -1])
    gap = np.array(a.values)
    gap[7, 3] = np.nan
    with pytest.raises(Mismatch, match=r"'Hips.Zrotation' has no value at frame 7: fill the gaps first, with denoise"):
        mc.blend(a, replace(a, values=gap))
