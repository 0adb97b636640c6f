"""interpolate, multitarget: clips themselves at the ends; between them poses, timing and ways that belong together."""

from __future__ import annotations

import json
import warnings
from collections.abc import Sequence
from dataclasses import replace
from itertools import permutations
from pathlib import Path

import numpy as np
import pytest
from turning import ALONG, apart, heading, turning, widest_step
from walks import BODY, STEP, walk

import mocurve as mc
from mocurve import Mismatch, Motion, OptionError, UnknownName, cli
from mocurve.edit._in_step import in_step, moments, registered
from mocurve.edit._poses import motion_of, moved, poses_of
from mocurve.edit._shares import shares_of
from mocurve.edit.interpolate import Interpolation
from mocurve.kinematics import world

WARP = [(0.5, 0.7), (1.5, 1.6), (2.2, 2.6)]


def measured(made: mc.Clip) -> Interpolation:
    return Interpolation(**made.history[-1]["measured"])


def rigidly(clip: Motion, angle: float, x: float, z: float) -> Motion:
    return motion_of(moved(poses_of(clip), clip.skeleton, np.array([angle, x, z])), clip)


def changed(clip: Motion, channel: str, by: float) -> Motion:
    values = np.array(clip.values)
    values[:, clip.skeleton.channel(channel)] += by
    return replace(clip, values=values)


def places_apart(a: Motion, b: Motion) -> float:
    return float(np.linalg.norm(world(a) - world(b), axis=-1).max())


def limping(frames: int = 180) -> Motion:
    """The same walk with one leg bent more, lower hips and a longer step."""
    values = np.array(walk(frames).values)
    skeleton = BODY
    values[:, skeleton.channel("LeftLeg.Xrotation")] *= 1.6
    values[:, skeleton.channel("Hips.Yposition")] -= 4.0
    values[:, skeleton.channel("Hips.Zposition")] *= 1.2
    return Motion(skeleton, values, STEP)


@pytest.fixture
def family() -> list[Motion]:
    """Three cycles of walks: straight, limping and slower, turning and quicker."""
    return [
        walk(200),
        mc.retime(limping(200), [(1.5, 1.9), (199 * STEP, 3.9)]),
        mc.retime(walk(200, 0.5), [(3.3, 2.9)]),
    ]


# -- laws ----------------------------------------------------------------------------------------------
@pytest.mark.parametrize("place", range(3))
def test_a_clip_with_all_the_weight_comes_back_to_the_last_digit(family: list[Motion], place: int) -> None:
    weights = [0.0, 0.0, 0.0]
    weights[place] = 0.7
    assert mc.interpolate(family, weights).values.tobytes() == family[place].values.tobytes()
    at = mc.interpolate(family, places=[0, 1, 3], at=[0, 1, 3][place])
    assert at.values.tobytes() == family[place].values.tobytes()


@pytest.mark.parametrize("place", range(3))
def test_the_way_there_ends_in_the_clip(family: list[Motion], place: int) -> None:
    """Without the short cut for a clip that has all the weight: the general way leads there too."""
    weights = [1e-13] * 3
    weights[place] = 1.0
    assert places_apart(mc.interpolate(family, weights), family[place]) < 1e-6


def test_equal_clips_give_that_clip(family: list[Motion], jump: Path) -> None:
    for clip in (*family, mc.read(jump)[:200]):
        made = mc.interpolate([clip, clip, clip], [0.2, 0.5, 0.3])
        assert apart(made, clip) < 1e-9
        assert measured(made).clips[0].get("distance", 0.0) < 1e-4


@pytest.mark.parametrize("angle", [0.7, 2.0, np.pi])
def test_a_clip_and_itself_elsewhere_give_the_clip(angle: float, jump: Path) -> None:
    for clip in (walk(200, 0.4), mc.read(jump)[:200]):
        other = rigidly(clip, angle, 300.0, -50.0)
        assert places_apart(mc.interpolate([clip, other]), clip) < 1e-6
        assert places_apart(mc.interpolate([clip, other], [0.3, 0.7]), other) < 1e-6


@pytest.mark.parametrize("weight", [0.25, 0.5])
def test_a_warped_copy_gives_the_same_poses_with_the_mean_timing(weight: float) -> None:
    clip = walk(200, 0.2)
    made = mc.interpolate([clip, mc.retime(clip, WARP)], [1.0 - weight, weight])
    mean = [(old, old + weight * (new - old)) for old, new in WARP]
    expected = mc.retime(clip, mean)
    frames = min(made.frames, expected.frames)
    assert abs(made.frames - expected.frames) <= 1
    assert (
        np.linalg.norm(world(made[:frames]) - world(expected[:frames]), axis=-1).max() < 2.0
    )  # cm; it goes 120 a cycle


def test_the_order_of_the_clips_does_not_matter(family: list[Motion]) -> None:
    weights = [0.5, 0.2, 0.3]
    first = mc.interpolate(family, weights)
    for order in permutations(range(3)):
        made = mc.interpolate([family[place] for place in order], [weights[place] for place in order])
        assert made.frames == first.frames
        assert places_apart(made, first) < 1e-6


def test_which_clip_the_others_are_registered_with_matters_little(family: list[Motion]) -> None:
    shares = shares_of(3, [0.5, 0.2, 0.3], None, None)
    made = [in_step(one, moments(one, shares)) for one in (registered(family, place) for place in range(3))]
    for other in made[1:]:
        assert other.frames == made[0].frames
        assert places_apart(other, made[0]) < 4.0  # cm


def test_it_lasts_as_long_between_as_the_weights_say(family: list[Motion]) -> None:
    lengths = [clip.duration for clip in family]
    for weights in ([1, 1, 1], [0.7, 0.2, 0.1], [0.1, 0.8, 0.1]):
        length = np.dot(weights, lengths) / np.sum(weights)
        assert mc.interpolate(family, weights).duration == pytest.approx(length, abs=STEP)


def test_it_goes_as_far_between(family: list[Motion]) -> None:
    straight, longer = walk(200), limping(200)
    way = [np.linalg.norm(clip.values[-1, [0, 2]] - clip.values[0, [0, 2]]) for clip in (straight, longer)]
    made = mc.interpolate([straight, longer], [0.5, 0.5])
    assert np.linalg.norm(made.values[-1, [0, 2]] - made.values[0, [0, 2]]) == pytest.approx(np.mean(way), abs=1.0)


def test_ways_that_turn_differently_are_mixed_in_the_direction_of_the_body() -> None:
    left, right = walk(200, turn=0.6), rigidly(walk(200, turn=-0.6), 1.0, 50.0, 0.0)
    made = world(mc.interpolate([left, right]))[:, 0]
    ahead = 120.0 * 0.3 / np.tan(0.3) * np.arange(200) / 66  # of the speed of both, the part that goes ahead
    assert np.abs(made[:, 2] - made[0, 2] - ahead).max() < 1.0  # cm, over 350
    assert np.abs(made[:, 0] - made[0, 0]).max() < 1.0
    mixed = world(mc.mix([left, right], [1, 1]))[:, 0]
    assert np.linalg.norm(mixed[-1] - mixed[0]) < ahead[-1] - 30.0


def test_roots_that_turned_several_times_do_not_flip() -> None:
    spun, still = turning(720.0 * ALONG, 10.0), turning(0.0 * ALONG, 10.0)
    made = mc.interpolate([spun, still], [0.5, 0.5])
    assert widest_step(made) < 5.0
    assert abs(np.ptp(heading(made)) - 360.0) < 2.0


@pytest.mark.parametrize("angle", [170.0, 179.0, 190.0])
def test_poses_nearly_opposite_do_not_flip(angle: float) -> None:
    clip = walk(200)
    made = mc.interpolate([clip, changed(clip, "Head.Xrotation", angle), changed(clip, "LeftFoot.Zrotation", angle)])
    assert widest_step(made) < 1.5 * widest_step(clip)


def test_weights_may_change_in_time(family: list[Motion]) -> None:
    first, second = family[:2]
    made = mc.interpolate([first, second], [[(0, 1), (first.duration, 0)], f"0:0,{first.duration}:1"])
    np.testing.assert_allclose(made.values[0], first.values[0], atol=1e-9)
    last = made.skeleton.rotation_channels & (made.skeleton.channel_joints > 0)
    np.testing.assert_allclose(made.values[-1, last], second.values[-1, last], atol=1.5)  # within half a frame
    assert first.duration - STEP < made.duration < second.duration + STEP
    assert widest_step(made) < 1.5 * max(widest_step(first), widest_step(second))


def test_weights_of_a_joint_change_only_this_joint(family: list[Motion]) -> None:
    first = walk(200)
    nodding = changed(mc.retime(first, WARP), "Head.Xrotation", 20.0)
    made = mc.interpolate([first, nodding], [["1", "Head=0"], {"Head": 1}])
    head = made.skeleton.channel("Head.Xrotation")
    others = np.arange(made.skeleton.channel_count) != head
    np.testing.assert_allclose(made.values[:, others][:, 3:-1], first.values[:, others][:, 3:-1], atol=1e-9)
    assert np.abs(made.values[:, head] - first.values[:, head] - 20.0).max() < 3.0


def test_between_examples_what_is_linear_in_the_adverbs_is_linear() -> None:
    spots = [(0.0, 0.0), (1.0, 0.0), (0.0, 2.0), (1.5, 1.5)]

    def example(bend: float, low: float) -> Motion:
        return changed(changed(walk(120), "Head.Xrotation", 8.0 * bend), "Hips.Yposition", -3.0 * low)

    clips = [example(*spot) for spot in spots]
    for spot in ((0.4, 0.7), (1.2, 0.1), (-0.3, 0.5)):
        made = mc.interpolate(clips, places=spots, at=spot)
        np.testing.assert_allclose(made.values, example(*spot).values, atol=1e-7)


def test_time_runs_between_examples_too() -> None:
    clips = [mc.retime(walk(120), [(walk(120).duration, length)]) for length in (2.0, 2.4, 3.2)]
    lengths = [clip.duration for clip in clips]
    for at in (0.5, 1.5, 2.0):
        made = mc.interpolate(clips, places=[0, 1, 3], at=at)
        assert made.duration == pytest.approx(2.0 + 0.4 * at, abs=2 * STEP), lengths


def test_beyond_a_clip_is_away_from_the_other() -> None:
    low, high = changed(walk(120), "Hips.Yposition", -5.0), walk(120)
    made = mc.interpolate([low, high], [-0.5, 1.5])
    np.testing.assert_allclose(made.values, changed(high, "Hips.Yposition", 2.5).values, atol=1e-9)


def test_keys_become_samples_and_that_is_said() -> None:
    clip = walk(120)
    keys = mc.reduce(clip, tolerance="0.1deg")
    with pytest.warns(UserWarning, match="keys become samples: motions are interpolated frame by frame"):
        made = mc.interpolate([keys, clip])
    assert isinstance(made, Motion)
    assert apart(made, clip) < 0.5


def test_a_t_pose_stays_in_front(jump: Path) -> None:
    clip = mc.read(jump)[:150]
    posed = replace(clip, values=np.vstack([np.zeros_like(clip.values[:1]), clip.values]))
    assert apart(mc.interpolate([posed, posed]), posed) < 1e-9
    assert mc.interpolate([posed, clip], [1, 0]).values.tobytes() == posed.values.tobytes()
    with pytest.warns(UserWarning, match="the T-pose in front of clip 2 is left out"):
        assert apart(mc.interpolate([clip, posed]), clip) < 1e-9


def test_bodies_rates_and_orders_may_differ_by_name(family: list[Motion]) -> None:
    first = family[0]
    other = mc.retime(first, WARP).sample(STEP / 2)
    renamed = replace(other, skeleton=replace(other.skeleton, names=(*other.skeleton.names[:5], "Skull")))
    with pytest.raises(Mismatch, match="'Head' in the first, 'Skull' in the second"):
        mc.interpolate([first, renamed])
    made = mc.interpolate([first, renamed], match="names")
    assert made.frame_time == first.frame_time
    assert made.skeleton is first.skeleton
    assert made.duration == pytest.approx(0.5 * (first.duration + renamed.duration), abs=STEP)


def test_roots_belong_together_whatever_they_are_called(family: list[Motion]) -> None:
    first, other = family[:2]
    renamed = replace(other, skeleton=replace(other.skeleton, names=("Pelvis", *other.skeleton.names[1:])))
    made = mc.interpolate([first, renamed], [0.3, 0.7], match="names")
    assert apart(made, mc.interpolate([first, other], [0.3, 0.7])) < 1e-9


def test_on_other_bones_the_feet_stay_on_the_floor() -> None:
    first = walk(200)
    taller = replace(first.skeleton, offsets=1.3 * first.skeleton.offsets)
    values = np.array(first.values)
    values[:, :3] *= 1.3
    with pytest.warns(UserWarning, match="bones have other lengths"):
        made = mc.interpolate([first, Motion(taller, values, STEP)], [0.3, 0.7])
    assert places_apart(made, first) < 1e-6


def test_the_history_runs_again(family: list[Motion]) -> None:
    first = replace(family[0], history=({"verb": "denoise"},))
    made = mc.interpolate([first, *family[1:]], ["0:1,1:0", 1, 1], match="names")
    steps = json.loads(json.dumps(made.history))
    assert [step["verb"] for step in steps] == ["denoise", "interpolate"]
    told = steps[-1]
    names = ("weights", "places", "at", "method", "cycles", "harmonics", "match")
    again = mc.interpolate([first, *family[1:]], **{name: told[name] for name in names})
    assert again.values.tobytes() == made.values.tobytes()


# -- promises on real clips ----------------------------------------------------------------------------
@pytest.mark.parametrize("weight", [0.25, 0.5, 0.75])
def test_planted_feet_go_no_faster_than_in_the_clips(weight: float, clips: Path) -> None:
    walks = [mc.read(clips / "cmu" / f"cmu_{name}.bvh") for name in ("12_01_walk", "02_01_walk_blender")]
    walks = [walks[0][44:198], walks[1][91:224]]  # a cycle of each, from the same pose on
    with warnings.catch_warnings(action="ignore"):  # other bones
        found = measured(mc.interpolate(walks, [1.0 - weight, weight]))
    own = [clip["foot_speed"] for clip in found.clips]
    assert found.foot_speed is not None
    assert found.foot_speed < max(speed for speed in own if speed is not None)
    assert found.acceleration < 1.0


# -- refusals ------------------------------------------------------------------------------------------
@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"weights": [1, 2, 3]}, "weights: 3 given, for 2 clips"),
        ({"weights": [0, 0]}, "the weights add up to 0, and not to a number above 0"),
        ({"weights": [1, -1]}, "the weights add up to 0, and not to a number above 0"),
        ({"weights": ["0:1,0.5:0", 0]}, "the weights add up to 0 at 0.5"),
        ({"weights": [1, {"Head": -1}]}, "the weights of 'Head' add up to 0, and not"),
        ({"weights": [100, -99]}, "a clip would count 100 times, more than 10"),
        ({"weights": [1e308, 1e308]}, "the weights add up to inf"),
        ({"places": [0, 1], "at": 1e308}, "times, more than 10"),
        ({"weights": [1, float("nan")]}, "a weight is a number"),
        ({"weights": "1,x"}, "a weight is a number"),
        ({"weights": object()}, "weights: 1 given, for 2 clips"),
        ({"places": [0, 1]}, "both are needed, or neither"),
        ({"at": 1}, "both are needed, or neither"),
        ({"places": [0, 1], "at": 1, "weights": [1, 1]}, "weights are given, and places too"),
        ({"places": [1, 1], "at": 1}, r"clips 1 and 2 stand at the same place, \[1.0\]"),
        ({"places": [0, 1], "at": [1, 2]}, "at: 2 given, for places of 1 numbers"),
        ({"places": [(0, 1), (1,)], "at": 1}, "all places have as many numbers"),
        ({"places": [0, "x"], "at": 1}, "places are numbers"),
        ({"places": [0, float("inf")], "at": 1}, "places are finite"),
        ({"places": [0, 1], "at": 1e9}, "times, more than 10"),
        ({"places": [0, 1], "at": ["Head=1"]}, "without names of joints"),
        ({"cycles": 2}, "cycles are repeated with the method fourier"),
        ({"cycles": 0}, "cycles is a whole number"),
        ({"harmonics": 0}, "harmonics is a whole number"),
        ({"harmonics": True}, "harmonics is a whole number"),
    ],
)
def test_options_are_refused(options: dict[str, object], words: str) -> None:
    with pytest.raises(OptionError, match=words):
        mc.interpolate([walk(60), walk(50)], **options)  # type: ignore[arg-type]


def test_time_that_would_run_backwards_is_refused() -> None:
    quick, slow = walk(60), mc.retime(walk(60), [(walk(60).duration, 1.9)])
    with pytest.raises(OptionError, match="time would run backwards"):
        mc.interpolate([slow, quick], [-2, 3])


@pytest.mark.parametrize(
    ("clips", "error", "words"),
    [
        ([], OptionError, "no clip is given"),
        ([walk(60), walk(0)], Mismatch, "not a clip with none"),
        ([walk(60), walk(1)], OptionError, "fewer than two frames"),
        ([walk(200), walk(10)], OptionError, "do not match with a slope of 3"),
    ],
)
def test_clips_are_refused(clips: Sequence[Motion], error: type[Exception], words: str) -> None:
    with pytest.raises(error, match=words):
        mc.interpolate(clips)


def test_a_missing_sample_and_unknown_names_are_told() -> None:
    with pytest.raises(Mismatch, match=r"channel 'Head.Xrotation' has no value at frame"):
        mc.interpolate([walk(60), changed(walk(60), "Head.Xrotation", np.nan)])
    with pytest.raises(UnknownName, match="Did you mean 'fourier'"):
        mc.interpolate([walk(60), walk(50)], method="furier")
    with pytest.raises(UnknownName, match="no joint 'Hed'"):
        mc.interpolate([walk(60), walk(50)], [1, {"Hed": 1}])
    with pytest.raises(UnknownName, match="Did you mean 'names'"):
        mc.interpolate([walk(60), walk(50)], match="name")


def test_clips_that_do_not_go_together_are_told(jump: Path) -> None:
    clip = mc.read(jump)
    with pytest.warns(UserWarning, match="clips 2 and 1 do not go together: in step their poses still are"):
        mc.interpolate([clip[:120], clip[250:400]])


# -- the command ---------------------------------------------------------------------------------------
def test_the_command_writes_what_the_verb_makes_and_tells_its_numbers(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], family: list[Motion]
) -> None:
    sources = [str(tmp_path / f"{name}.npz") for name in "abc"]
    for source, clip in zip(sources, family, strict=True):
        mc.write(source, clip)
    out = str(tmp_path / "out.npz")
    for words, options in [
        (["--weights", "0.5,0.2,0.3"], {"weights": [0.5, 0.2, 0.3]}),
        (["--weights", "0:1,2:0", "0:0,2:1", "0.5"], {"weights": ["0:1,2:0", "0:0,2:1", 0.5]}),
        (["--places", "0", "1", "2", "--at", "0.5"], {"places": [0, 1, 2], "at": 0.5}),
        (["--places", "0,0", "1,0", "0,1", "--at", "0.5,0.2"], {"places": [(0, 0), (1, 0), (0, 1)], "at": (0.5, 0.2)}),
        ([], {}),
    ]:
        assert cli.main(["interpolate", *sources, "-o", out, *words, "--json"]) == 0
        found = Interpolation(**json.loads(capsys.readouterr().out))
        made = mc.interpolate(family, **options)  # type: ignore[arg-type]
        assert apart(mc.read(out), made) < 1e-9
        assert found == measured(made)
        assert [set(clip) >= {"share", "duration", "foot_speed"} for clip in found.clips] == [True] * 3
    assert cli.main(["interpolate", *sources, "-o", out]) == 0
    assert "the others in step with it" in capsys.readouterr().out
    assert cli.main(["interpolate", *sources, "-o", sources[1]]) == cli.REFUSED
    assert "is the file that is read" in capsys.readouterr().err
