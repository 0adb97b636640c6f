"""join: like goes over into like without a trace, other bodies follow by name, and nothing shows on real walks."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from walks import BODY, PERIOD, STEP, walk

import mocurve as mc
from mocurve import Mismatch, Motion, OptionError, SplineMotion, UnknownName, bspline, cli, planar
from mocurve.bspline_fit import least_squares
from mocurve.edit import _cuts
from mocurve.edit._poses import motion_of, moved, poses_of
from mocurve.edit._seams import bends
from mocurve.edit.join import MODES, Join
from mocurve.kinematics import rotations, world


def measured(motion: Motion) -> Join:
    return Join(**motion.history[-1]["measured"])


def elsewhere(motion: Motion, by: tuple[float, float, float] = (1.2, 300.0, -80.0)) -> Motion:
    return motion_of(moved(poses_of(motion), motion.skeleton, np.array(by)), motion)


def resized(motion: Motion, factor: float) -> Motion:
    """The same motion of a larger body."""
    values = motion.values * np.where(motion.skeleton.rotation_channels, 1.0, factor)
    return replace(
        motion, values=values, skeleton=replace(motion.skeleton, offsets=motion.skeleton.offsets * factor, unit=None)
    )


# -- laws ----------------------------------------------------------------------------------------------
@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("turn", [0.0, 0.5])
def test_what_is_one_motion_stays_one(mode: str, turn: float) -> None:
    whole = walk(260, turn)
    made = mc.join(whole[:170], elsewhere(whole[100:]), leave=120 * STEP, enter=20 * STEP, mode=mode)
    np.testing.assert_allclose(world(made), world(whole), atol=1e-6)


@pytest.mark.parametrize("mode", MODES)
def test_the_best_cut_is_found(mode: str) -> None:
    a, b = walk(200), elsewhere(walk(200, phase=1.0))
    found = measured(mc.join(a, b, mode=mode))
    ahead = 1.0 / (2.0 * np.pi) * PERIOD  # frames by which b is ahead
    off = (found.leave / STEP - found.enter / STEP - ahead + PERIOD / 2) % PERIOD - PERIOD / 2
    assert abs(off) <= 0.5 + 1e-6
    assert found.leave >= 100 * STEP
    assert found.step < 1.05
    assert found.acceleration < 1.05


@pytest.mark.parametrize("mode", MODES)
def test_the_first_stays_to_the_last_digit_and_the_second_is_only_moved(mode: str) -> None:
    a, b = walk(200), elsewhere(walk(180, phase=2.0))
    made = mc.join(a, b, mode=mode)
    found = measured(made)
    leave, enter = round(found.leave / STEP), round(found.enter / STEP)
    np.testing.assert_array_equal(made.values[:leave], a.values[:leave])
    assert made.frames == leave + b.frames - enter
    rest, own = world(made)[leave + found.frames :], world(b)[enter + found.frames :]
    step = planar.align(rest[0], own[0])
    np.testing.assert_allclose(rest, planar.move(step, own), atol=1e-6)
    assert np.degrees(step[0]) == pytest.approx(found.turn, abs=1e-6)


@pytest.mark.parametrize("mode", MODES)
def test_a_bad_cut_is_still_smooth(mode: str) -> None:
    a, b = walk(200), walk(200, phase=2.5)
    made = mc.join(a, b, leave=2.0, enter=0.5, mode=mode)
    around = bends(world(made))[100:160]
    raw = np.concatenate([world(a)[:120], planar.move(planar.align(world(a)[120], world(b)[30]), world(b)[30:])])
    assert around.max() < 0.25 * bends(raw)[100:140].max()
    assert measured(made).leave == 2.0
    assert measured(made).enter == 0.5


@pytest.mark.parametrize("mode", MODES)
def test_a_clip_after_itself_is_not_that_clip_once(mode: str) -> None:
    clip = walk(200)
    made = mc.join(clip, clip, mode=mode)
    assert made.frames >= clip.frames + PERIOD - 1
    assert measured(made).acceleration < 1.05


def test_channels_do_not_jump_by_whole_turns() -> None:
    a, b = walk(200, 3.0), walk(200, -2.0)
    b = replace(b, values=b.values + 360.0 * BODY.rotation_channels)
    assert np.abs(np.diff(mc.join(a, b).values[:, BODY.rotation_channels], axis=0)).max() < 30.0


# -- other bodies, other rates ---------------------------------------------------------------------------
def test_a_larger_body_walks_as_the_first_one() -> None:
    a, b = walk(200), walk(200, phase=1.0)
    with pytest.warns(UserWarning, match="bones have other lengths"):
        made = mc.join(a, resized(b, 1.3), leave=2.0, enter=0.5)
    same = mc.join(a, b, leave=2.0, enter=0.5)
    np.testing.assert_allclose(world(made), world(same), atol=0.5)  # both stand on the floor of the first
    np.testing.assert_allclose(world(made)[..., [0, 2]], world(same)[..., [0, 2]], atol=1e-6)


def test_by_name_the_second_turns_the_joints_that_it_has() -> None:
    a, b = walk(200), walk(200, phase=1.0)
    order = (0, 3, 4, 1, 2)  # the other leg first, no head
    parents = {0: -1, 3: 0, 4: 1, 1: 0, 2: 3}
    body = replace(
        BODY,
        names=tuple(BODY.names[joint] for joint in order),
        parents=np.array([parents[joint] for joint in order]),
        offsets=BODY.offsets[list(order)],
        channels=tuple(BODY.channels[joint] for joint in order),
        end_sites=np.zeros(5, bool),
    )
    columns = np.concatenate([np.flatnonzero(BODY.channel_joints == joint) for joint in order])
    other = Motion(body, b.values[:, columns], STEP)
    with pytest.raises(Mismatch, match="'LeftLeg' in the first, 'RightLeg' in the second"):
        mc.join(a, other)
    made = mc.join(a, other, match="names")
    found = measured(made)
    leave, enter = round(found.leave / STEP), round(found.enter / STEP)
    turned, own = rotations(made)[leave + found.frames :], rotations(b)[enter + found.frames :]
    np.testing.assert_allclose(np.abs((turned * own)[:, 1:5].sum(axis=-1)), 1.0, atol=1e-9)
    head = BODY.channel_joints == 5
    held = made.values[leave + found.frames :, head]
    np.testing.assert_allclose(held, np.broadcast_to(a.values[leave, head], held.shape), atol=1e-9)


def test_another_frame_rate_is_taken_to_that_of_the_first() -> None:
    a, b = walk(200), walk(200, phase=1.0)
    made = mc.join(a, b.sample(STEP / 2), leave=2.0, enter=0.5)
    assert made.frame_time == a.frame_time
    np.testing.assert_allclose(world(made), world(mc.join(a, b, leave=2.0, enter=0.5)), atol=0.2)


def test_the_history_tells_the_step_and_what_was_found() -> None:
    told = json.loads(
        json.dumps(mc.join(walk(200), replace(walk(200), history=({"verb": "denoise"},)), seconds=0.3).history[-1])
    )
    assert told["verb"] == "join"
    assert told["with"] == [{"verb": "denoise"}]
    assert (told["leave"], told["enter"], told["seconds"], told["mode"], told["match"]) == (
        None,
        None,
        0.3,
        "overlap",
        "exact",
    )
    assert told["measured"]["frames"] == round(0.3 / STEP)
    assert told["measured"]["unit"] == "cm"


# -- splines ---------------------------------------------------------------------------------------------
def splines(*phases: float) -> list[SplineMotion]:
    made = []
    for number, phase in enumerate(phases):
        clip = walk(200 + 10 * number, phase=phase)
        knots = bspline.clamped(np.linspace(0.0, clip.duration, 25 + number))
        values = least_squares(knots, 3, np.arange(clip.frames) * STEP, clip.values)
        made.append(SplineMotion(clip.skeleton, knots, values, 3, STEP, clip.frames))
    return made


def test_two_splines_stay_one_exactly_outside_of_the_transition() -> None:
    a, b = splines(0.0, 1.0)
    made = mc.join(a, b, mode="spline")
    assert isinstance(made, SplineMotion)
    found = measured(made)
    at = np.linspace(0.0, found.leave, 50)
    np.testing.assert_allclose(made.at(at), a.at(at), atol=1e-9)
    end = found.leave + found.frames * STEP
    rest = np.arange(round(end / STEP), made.frames) * STEP
    after = Motion(made.skeleton, made.at(rest), STEP)
    own = Motion(b.skeleton, b.at(rest - found.leave + found.enter), STEP)
    step = planar.align(world(after).reshape(-1, 3), world(own).reshape(-1, 3))
    np.testing.assert_allclose(world(after), planar.move(step, world(own)), atol=0.05)
    np.testing.assert_allclose(after.values[:, 6:] - own.values[:, 6:], 0.0, atol=1e-9)  # only the root is moved
    assert found.off <= 0.01
    assert np.degrees(step[0]) == pytest.approx(found.turn, abs=0.01)
    assert made.frames == round(found.leave / STEP) + b.frames - round(found.enter / STEP)
    assert found.acceleration < 1.05


def test_the_seam_of_splines_has_no_jump_in_speed_or_acceleration() -> None:
    made = mc.join(*splines(0.0, 2.5), leave=2.0, enter=0.5, mode="spline")
    assert isinstance(made, SplineMotion)
    inner = made.knots[(made.knots > 1.5) & (made.knots < 3.0)]
    assert (np.diff(inner) > 0).all()  # single knots of a cubic: C2
    assert bends(world(made.sample())).max() < 2.0 * bends(world(walk(200))).max()


def test_samples_are_joined_as_the_splines_through_them() -> None:
    a, b = walk(200), walk(180, phase=2.5)
    made = mc.join(a, b, leave=2.0, enter=0.5, mode="spline")
    fine = bends(world(made))
    assert type(made) is Motion
    np.testing.assert_array_equal(made.values[:120], a.values[:120])
    assert fine[115:150].max() < 1.5 * bends(world(mc.join(a, b, leave=2.0, enter=0.5)))[115:150].max()


def test_keys_and_other_modes_are_told_to_be_sampled() -> None:
    a, b = splines(0.0, 1.0)
    with pytest.warns(UserWarning, match="splines become samples: .* mode spline makes a spline"):
        mc.join(a, b, leave=2.0, enter=0.5)
    keys = mc.reduce(walk(200), tolerance="0.1deg")
    with pytest.warns(UserWarning, match="keys become samples"):
        mc.join(keys, b, leave=2.0, enter=0.5, mode="spline")


# -- feet ------------------------------------------------------------------------------------------------
def standing(shift: float, lean: float) -> Motion:
    """A body that stands on both feet, the left leg turned sideways by so much and more and more bent."""
    values = np.tile(walk(1).values * 0.0, (120, 1))
    values[:, 0], values[:, 1] = shift, 90.0
    values[:, BODY.channel_names.index("LeftLeg.Zrotation")] = lean
    values[:, BODY.channel_names.index("Head.Xrotation")] = np.linspace(0.0, 20.0, 120)
    return replace(walk(120), values=values)


@pytest.mark.parametrize("mode", MODES)
def test_feet_that_rest_in_both_are_what_is_brought_together(mode: str) -> None:
    a, b = standing(0.0, 0.0), standing(40.0, 8.0)
    lifted = np.array(b.values)
    lifted[:, BODY.channel_names.index("RightLeg.Zrotation")] = np.linspace(
        -30.0, 30.0, 120
    )  # only the left foot rests
    made = mc.join(a, replace(b, values=lifted), leave=1.0, enter=0.5, mode=mode)
    foot = world(made)[:, BODY.names.index("LeftFoot")]
    assert np.abs(foot[:, [0, 2]] - foot[0, [0, 2]]).max() < 0.5  # cm; all joints together would leave it 10 away
    assert measured(made).foot_speed is not None


def test_cuts_are_where_the_feet_do_the_same() -> None:
    places = np.zeros((200, 3, 3))
    places[:, 1, 0], places[:, 2, 1] = 10.0, 20.0
    places[:, 2, 0] = 0.1 * np.sin(np.arange(200) / 9.0)
    others = places + np.array([[0, 0, 0], [0, 0, 0], [0, 5, 0]])  # never quite alike
    rests = (np.arange(200) % 40 < 20)[:, None]
    cost = {"window": 8, "ahead": 0.0, "rough": np.ones(200)}
    of = _cuts.Candidates(places, others, rests, ~rests, **cost)
    blind = _cuts.Candidates(places, others, rests[:, :0], rests[:, :0], **cost)
    (i, j), *_ = _cuts.find(of, range(100, 190), range(90), 4, 3)
    assert (rests[i : i + 8] == ~rests[j : j + 8]).all()
    (i, j), *_ = _cuts.find(blind, range(100, 190), range(90), 4, 3)
    assert not (rests[i : i + 8] == ~rests[j : j + 8]).all()


def test_long_clips_are_searched_in_bounded_memory(monkeypatch: pytest.MonkeyPatch) -> None:
    held: list[int] = []
    distances = planar.frame_distances

    def seen(first: np.ndarray, second: np.ndarray) -> np.ndarray:
        held.append(first.size + second.size + len(first) * len(second))
        return distances(first, second)

    monkeypatch.setattr(planar, "frame_distances", seen)
    places = np.random.default_rng(0).random((20000, 20, 3))
    of = _cuts.Candidates(
        places, places, np.zeros((20000, 0), bool), np.zeros((20000, 0), bool), 48, 0.0, np.ones(20000)
    )
    for rows in (range(10000, 19900), range(7, 8)):
        (i, j), *_ = _cuts.find(of, rows, range(9000), 12, 2)
        assert i in rows
        assert j in range(9000)
    assert max(held) <= 2 * _cuts.PAIRS + 2 * _cuts.NUMBERS


# -- real walks ----------------------------------------------------------------------------------------
@pytest.mark.parametrize("mode", MODES)
def test_nothing_shows_where_one_captured_walk_becomes_another(clips: Path, mode: str) -> None:
    first, second = (mc.read(clips / "cmu" / f"cmu_{name}.bvh") for name in ("02_01_walk_blender", "12_01_walk"))
    with pytest.warns(UserWarning, match="bones have other lengths"):
        found = measured(mc.join(first, second, mode=mode))
    assert found.step <= 1.0
    assert found.acceleration <= 1.0
    assert found.foot_speed is not None
    assert found.foot_speed < 20.0  # cm/s; feet that rest in the clips themselves go 12


@pytest.mark.parametrize("mode", MODES)
def test_a_t_pose_is_not_gone_into(mode: str) -> None:
    posed = replace(walk(201), values=np.vstack([[[0, 90, 0] + [0.0] * 17], walk(200).values]))
    made = mc.join(posed, posed, mode=mode)
    np.testing.assert_array_equal(made.values[0], posed.values[0])  # the first clip's own stays
    assert measured(made).enter >= STEP
    with pytest.raises(OptionError, match="cannot be entered at 0 s: its first frame is a T-pose"):
        mc.join(posed, posed, enter=0.0, mode=mode)


def test_a_body_of_unknown_size_is_measured_in_units() -> None:
    flat = replace(BODY, offsets=BODY.offsets * 0.0, unit=None)
    a, b = (replace(walk(200, phase=phase), skeleton=flat) for phase in (0.0, 1.0))
    assert measured(mc.join(a, b)).unit == "units"


# -- refusals ------------------------------------------------------------------------------------------
@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"leave": 9.0}, "9 s is not in the first clip"),
        ({"enter": float("nan")}, "nan s is not in the second clip"),
        ({"leave": 3.2}, "the first clip is too short for a transition of 24 frames"),
        ({"enter": 3.2}, "the second clip is too short for a transition of 24 frames"),
        ({"seconds": 30.0}, "the first clip is too short for a transition of 1800 frames"),
        ({"seconds": 0.0}, "positive number of seconds"),
        ({"seconds": float("inf")}, "positive number of seconds"),
    ],
)
def test_times_that_make_no_transition_are_refused(options: dict[str, float], words: str) -> None:
    with pytest.raises(OptionError, match=words):
        mc.join(walk(200), walk(200), **options)


@pytest.mark.parametrize(("options", "near"), [({"mode": "overlp"}, "overlap"), ({"match": "name"}, "names")])
def test_an_unknown_way_is_told_the_nearest(options: dict[str, str], near: str) -> None:
    with pytest.raises(UnknownName, match=f"Did you mean '{near}'"):
        mc.join(walk(200), walk(200), **options)


@pytest.mark.parametrize("frames", [0, 1, 5])
def test_short_clips_are_refused(frames: int) -> None:
    for clips in ((walk(frames), walk(200)), (walk(200), walk(frames))):
        with pytest.raises(OptionError, match=r"too short|without frames"):
            mc.join(*clips)


def test_a_missing_sample_is_refused() -> None:
    values = np.array(walk(200).values)
    values[3, 4] = np.nan
    with pytest.raises(Mismatch, match="has no value at frame 3"):
        mc.join(walk(200), replace(walk(200), values=values))


# -- the command ---------------------------------------------------------------------------------------
def test_the_command_writes_both_and_tells_its_numbers(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for name, phase in (("a", 0.0), ("b", 1.0)):
        mc.write(tmp_path / f"{name}.bvh", walk(200, phase=phase))
    paths = [str(tmp_path / f"{name}.bvh") for name in ("a", "b", "both")]
    assert cli.main(["join", *paths[:2], "-o", paths[2], "--mode", "inertial", "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert mc.read(paths[2]).frames == round(told["leave"] / STEP) + 200 - round(told["enter"] / STEP)
    assert cli.main(["join", *paths[:2], "-o", paths[2], "--leave", "2", "--enter", "0.5"]) == 0
    assert "largest step" in capsys.readouterr().out
