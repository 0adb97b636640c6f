"""loop: what repeats itself is continued exactly, other ends are closed, and no seam shows on real walks."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from walks import BODY, PERIOD, PLACE, STEP, drifting, walk

import mocurve as mc
from mocurve import Mismatch, Motion, OptionError, Skeleton, SplineMotion, UnknownName, bspline, cli, planar
from mocurve.bspline_fit import least_squares
from mocurve.edit._closings import CLOSINGS
from mocurve.edit._poses import motion_of, poses_of
from mocurve.edit._seams import bends
from mocurve.edit.loop import WAYS, Loop
from mocurve.kinematics import world


def measured(motion: Motion) -> Loop:
    return Loop(**motion.history[-1]["measured"])


# -- laws ----------------------------------------------------------------------------------------------
@pytest.mark.parametrize("close", CLOSINGS)
@pytest.mark.parametrize("turn", [0.0, 0.6])
def test_what_is_periodic_goes_on_as_it_would_have(close: str, turn: float) -> None:
    made = mc.loop(walk(180, turn), start=40 * STEP, end=(40 + PERIOD) * STEP, cycles=4, close=close)
    truth = walk(40 + 4 * PERIOD + 1, turn)[40:]
    np.testing.assert_allclose(world(made), world(truth), atol=1e-8)
    assert measured(made).turn == pytest.approx(np.degrees(turn))


@pytest.mark.parametrize("turn", [0.0, -0.9])
def test_the_period_is_found(turn: float) -> None:
    found = measured(mc.loop(walk(200, turn)))
    assert found.frames == PERIOD
    assert found.distance < 1e-6
    assert mc.loop(walk(200, turn), start=0.5).frames == PERIOD + 1


@pytest.mark.parametrize("close", WAYS)
def test_the_last_pose_is_the_first_one_carried_on(close: str) -> None:
    made = mc.loop(drifting(walk(200, 0.3)), start=0.6, cycles=3, close=close)
    places, frames = world(made), measured(made).frames
    step = planar.align(places[frames], places[0])
    assert made.frames == 3 * frames + 1
    np.testing.assert_allclose(places[-1], planar.move(planar.power(step, 3), places[0]), atol=1e-6)
    np.testing.assert_allclose(places[frames:], planar.move(step, places[:-frames]), atol=1e-6)


@pytest.mark.filterwarnings("ignore:the seam shows")
def test_each_way_to_close_meets_better_than_the_one_before() -> None:
    clip = drifting(walk(200), 6.0)
    natural = bends(world(clip)).max()
    cut = {"start": 40 * STEP, "end": (40 + PERIOD) * STEP, "cycles": 2}
    linear, cubic, fade = (
        bends(world(mc.loop(clip, close=close, **cut))).max() for close in ("linear", "cubic", "crossfade")
    )
    joined = world(clip)[40 : 40 + PERIOD]
    raw = bends(np.concatenate([joined, planar.move(np.array([0.0, 0.0, 120.0]), joined)])).max()
    assert raw > 10 * natural
    assert linear < 0.2 * raw
    assert cubic < 1.1 * natural
    assert fade < 1.2 * natural


def test_a_clip_that_is_just_one_cycle_is_closed_by_a_cubic() -> None:
    clip = drifting(walk(PERIOD + 1, 0.4))
    made = mc.loop(clip, start=0.0, end=clip.duration, cycles=3, close="cubic")
    assert made.frames == 3 * PERIOD + 1
    assert bends(world(made)).max() < 1.2 * bends(world(walk(200, 0.4))).max()


def test_what_needs_no_closing_stays_to_the_last_digit() -> None:
    still = replace(walk(200), values=walk(200).values * (BODY.channel_joints != 5))
    made = mc.loop(still, start=0.6, cycles=2)
    np.testing.assert_array_equal(made.values[:, BODY.channel_joints == 5], 0.0)


def test_a_joint_with_two_axes_is_closed_with_what_it_can_express() -> None:
    made = mc.loop(drifting(walk(200), 5.0), start=0.6, cycles=2)  # the head has two
    assert bends(world(made)).max() < 1.2 * bends(world(walk(200))).max()


def test_markers_without_rotations_walk_in_a_curve_too() -> None:
    clip = walk(200, 0.5)
    places, names = world(clip), clip.skeleton.names
    body = Skeleton(names, [-1] * len(names), np.zeros((len(names), 3)), (PLACE,) * len(names), unit=0.01)
    markers = Motion(body, places.reshape(clip.frames, -1), STEP)
    cut = {"start": 40 * STEP, "end": (40 + PERIOD) * STEP, "cycles": 3}
    np.testing.assert_allclose(world(mc.loop(markers, **cut)), world(mc.loop(clip, **cut)), atol=1e-6)


def test_a_t_pose_in_front_is_no_part_of_it() -> None:
    plain = walk(200)
    posed = replace(plain, values=np.vstack([[[0, 90, 0] + [0.0] * 17], plain.values]))
    made, found = mc.loop(plain), measured(mc.loop(posed))
    np.testing.assert_array_equal(mc.loop(posed).values, made.values)
    assert found.start == pytest.approx(measured(made).start + STEP)
    with pytest.raises(OptionError, match="its first frame is a T-pose"):
        mc.loop(posed, start=0.0)


def test_the_history_tells_the_step_and_what_was_found() -> None:
    first = replace(walk(200), history=({"verb": "denoise"},))
    made = mc.loop(first, cycles=2)
    assert made.history[0] == {"verb": "denoise"}
    told = json.loads(json.dumps(made.history[1]))
    assert {key: told[key] for key in ("verb", "start", "end", "cycles", "close")} == {
        "verb": "loop",
        "start": None,
        "end": None,
        "cycles": 2,
        "close": "crossfade",
    }
    assert told["measured"]["unit"] == "cm"
    assert told["measured"]["travel"] == pytest.approx(120.0, rel=0.01)


# -- splines -------------------------------------------------------------------------------------------
YXZ = replace(BODY, channels=((*PLACE, "Yrotation", "Xrotation", "Zrotation"), *BODY.channels[1:]))


def as_spline(clip: Motion, spacing: int = 6, degree: int = 3) -> SplineMotion:
    """A spline near the clip with a knot every so many frames."""
    knots = bspline.clamped(STEP * np.append(np.arange(0.0, clip.frames - 1, spacing), clip.frames - 1), degree)
    values = least_squares(knots, degree, np.arange(clip.frames) * STEP, clip.values)
    return SplineMotion(clip.skeleton, knots, values, degree, STEP, clip.frames)


def rewritten(clip: Motion, body: Skeleton) -> Motion:
    return motion_of(poses_of(clip), Motion(body, np.zeros((clip.frames, body.channel_count)), STEP))


@pytest.mark.parametrize("turn", [0.0, 0.6])
def test_samples_come_near_to_what_is_periodic(turn: float) -> None:
    made = mc.loop(walk(180, turn), start=40 * STEP, end=(40 + PERIOD) * STEP, cycles=3, close="spline")
    truth = walk(40 + 3 * PERIOD + 1, turn)[40:]
    assert np.linalg.norm(world(made) - world(truth), axis=-1).max() <= measured(made).off + 1e-9
    assert measured(made).off < 1.0  # cm


@pytest.mark.parametrize("degree", [2, 3, 5])
@pytest.mark.parametrize("turn", [0.0, 0.8])
def test_a_spline_closes_with_its_derivatives_by_construction(degree: int, turn: float) -> None:
    clip = as_spline(rewritten(drifting(walk(200, turn), 6.0), YXZ), degree=degree)
    made = mc.loop(clip, start=40 * STEP, end=(40 + PERIOD) * STEP, cycles=2, close="spline")
    assert isinstance(made, SplineMotion)
    assert made.degree == degree
    assert made.frames == 2 * PERIOD + 1
    period = PERIOD * STEP
    assert made.domain == (0.0, pytest.approx(2 * period))
    spans = (len(made.values) - degree) // 2
    g = planar.align(*(np.asarray(world(made.sample()))[[PERIOD, 0]]))
    np.testing.assert_allclose(made.values[spans : 2 * spans, 6:], made.values[:spans, 6:], atol=1e-9)
    np.testing.assert_allclose(
        made.values[spans : 2 * spans, :3], planar.move(g, made.values[:spans, :3]), atol=1e-6
    )  # so that the curve and all its derivatives are carried by g
    np.testing.assert_allclose(made.values[spans:, 3] - made.values[:-spans, 3], np.degrees(g[0]), atol=1e-6)
    inner = made.knots[(made.knots > 0.5 * period) & (made.knots < 1.5 * period)]
    assert (np.diff(inner) > 0).all()  # single knots: derivatives up to degree - 1 do not jump
    assert measured(made).turn == pytest.approx(np.degrees(g[0]), abs=1e-6)


def test_a_spline_that_is_periodic_already_stays() -> None:
    breaks = np.linspace(0.0, PERIOD * STEP, 12)
    whole = np.concatenate([breaks[:-1], breaks[:-1] + breaks[-1], breaks + 2 * breaks[-1]])
    knots = bspline.periodic(whole)
    once = np.array(as_spline(walk(PERIOD), 6).values)[:11]
    once[:, [0, 2, 3, 4, 5]] = 0.0
    clip = SplineMotion(BODY, knots, np.tile(once, (4, 1))[: len(knots) - 4], 3, STEP, 3 * PERIOD + 1)
    made = mc.loop(clip, start=PERIOD * STEP, end=2 * PERIOD * STEP, cycles=3, close="spline")
    np.testing.assert_allclose(made.sample().values, clip.sample().values, atol=1e-7)
    assert measured(made).off < 1e-7


def test_a_root_that_does_not_turn_first_about_the_vertical_is_fitted() -> None:
    made = mc.loop(as_spline(walk(200, 0.8)), start=40 * STEP, end=(40 + PERIOD) * STEP, cycles=3, close="spline")
    places = world(made.sample())
    g = planar.align(places[PERIOD], places[0])
    np.testing.assert_allclose(places[PERIOD:], planar.move(g, places[:-PERIOD]), atol=0.1)  # cm
    assert bends(places).max() < 1.1 * bends(world(walk(200, 0.8))).max()


def test_a_spline_of_just_one_cycle_closes_too() -> None:
    clip = as_spline(drifting(walk(PERIOD + 1, 0.4)))
    made = mc.loop(clip, start=0.0, end=clip.duration, cycles=3, close="spline")
    assert bends(world(made.sample())).max() < 1.2 * bends(world(walk(200, 0.4))).max()
    assert measured(made).off < 1.0


def test_a_wheel_that_turns_round_goes_on_turning() -> None:
    clip = walk(200)
    values = np.array(clip.values)
    values[:, BODY.channel_names.index("Head.Yrotation")] = np.arange(200) * 360.0 / PERIOD
    made = mc.loop(replace(clip, values=values), start=0.6, end=0.6 + PERIOD * STEP, cycles=3, close="spline")
    turned = made.values[:, BODY.channel_names.index("Head.Yrotation")]
    np.testing.assert_allclose(np.diff(turned), 360.0 / PERIOD, atol=0.2)


def test_other_ways_to_close_tell_that_splines_become_samples() -> None:
    with pytest.warns(UserWarning, match="splines become samples: .* close spline makes a spline"):
        mc.loop(as_spline(walk(200)), start=0.6)


# -- real walks ----------------------------------------------------------------------------------------
@pytest.mark.parametrize("close", ["crossfade", "spline"])
@pytest.mark.parametrize("name", ["12_01_walk.bvh", "02_01_walk_blender.bvh", "walk_daz19.bvh", "16_15.amc"])
@pytest.mark.filterwarnings("ignore:.*no frame rate")
def test_no_seam_shows_on_a_captured_walk(name: str, close: str, clips: Path) -> None:
    path = clips / "cmu" / f"cmu_{name}"
    clip = mc.read(path, **({"skeleton": clips / "cmu" / "cmu_16.asf"} if name.endswith("amc") else {}))
    found = measured(mc.loop(clip, cycles=2, close=close))
    assert 0.9 < found.end - found.start < 1.4  # two steps of a person
    assert found.jump <= 0.2
    assert found.acceleration <= 0.7


# -- refusals ------------------------------------------------------------------------------------------
@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"cycles": 0}, "cycles is a whole number"),
        ({"end": 1.0}, "end is given without start"),
        ({"start": 1.0, "end": 0.5}, "ends at 0.5 s, not after its start"),
        ({"start": 9.0}, "9 s is not in the clip"),
        ({"start": -0.1}, "-0.1 s is not in the clip"),
        ({"start": float("nan")}, "nan s is not in the clip"),
        ({"start": 0.5, "end": 0.5 + STEP}, "at least two frames"),
        ({"start": 0.0, "end": 1.1}, "the clip must begin before the cycle"),
        ({"start": 2.9}, "no cycle is found: no pose returns after 2.9 s"),
    ],
)
def test_options_that_make_no_cycle_are_refused(options: dict[str, float], words: str) -> None:
    with pytest.raises(OptionError, match=words):
        mc.loop(walk(200), **options)


def test_more_cycles_than_fit_into_memory_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("mocurve.edit.loop.NUMBERS", 100_000)
    with pytest.raises(OptionError, match="10000 cycles are 660001 frames: too many to hold"):
        mc.loop(walk(200), cycles=10_000)


def test_an_unknown_way_to_close_is_told_the_nearest() -> None:
    with pytest.raises(UnknownName, match="Did you mean 'crossfade'"):
        mc.loop(walk(200), close="crosfade")


@pytest.mark.parametrize("frames", [0, 1, 5, 30])
def test_what_does_not_return_has_no_cycle(frames: int) -> None:
    with pytest.raises(OptionError, match="no cycle is found"):
        mc.loop(walk(frames))


def test_standing_still_is_no_cycle() -> None:
    still = np.tile(walk(1).values, (200, 1))
    for values in (still, still + 0.01 * np.sin(np.arange(200) / 10.0)[:, None]):
        with pytest.raises(OptionError, match="no cycle is found"):
            mc.loop(replace(walk(200), values=values))


def test_a_seam_that_shows_is_told() -> None:
    with pytest.warns(UserWarning, match=r"the seam shows, .* cm apart"):
        mc.loop(walk(200), start=0.6, end=1.1, close="linear")


def test_a_missing_sample_is_refused_and_keys_are_told_to_be_sampled() -> None:
    values = np.array(walk(200).values)
    values[3, 4] = np.nan
    with pytest.raises(Mismatch, match="has no value at frame 3"):
        mc.loop(replace(walk(200), values=values))
    with pytest.warns(UserWarning, match="keys become samples: a loop is made of frames"):
        mc.loop(mc.reduce(walk(200), tolerance="0.1deg"), start=0.6)


def test_a_root_that_cannot_turn_does_not_walk_in_a_curve() -> None:
    body = replace(BODY, channels=(BODY.channels[0][:3], *BODY.channels[1:]))
    circling = mc.loop(walk(200, 0.5), cycles=3)
    columns = [channel for channel in range(BODY.channel_count) if channel not in (3, 4, 5)]
    stiff = Motion(body, circling.values[:, columns], STEP)
    with pytest.raises(Mismatch, match="'Hips'"):
        mc.loop(stiff, start=0.6, end=0.6 + PERIOD * STEP)


# -- the command ---------------------------------------------------------------------------------------
def test_the_command_writes_the_loop_and_tells_its_numbers(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    mc.write(tmp_path / "walk.bvh", walk(200))
    goal = tmp_path / "tour.bvh"
    assert cli.main(["loop", str(tmp_path / "walk.bvh"), "-o", str(goal), "--cycles", "3", "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["frames"] == PERIOD
    assert mc.read(goal).frames == 3 * PERIOD + 1
    assert cli.main(["loop", str(tmp_path / "walk.bvh"), "-o", str(goal), "--start", "0.5"]) == 0
    assert "seam: " in capsys.readouterr().out
