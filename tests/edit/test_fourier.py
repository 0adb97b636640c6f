"""interpolate, fourier: cycles as series that close, and what lies between them and beyond."""

from __future__ import annotations

import json
import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from turning import apart, widest_step
from walks import BODY, PERIOD, STEP, walk

import mocurve as mc
from mocurve import Mismatch, Motion, OptionError, cli, planar
from mocurve.edit._pair import at_times
from mocurve.edit.interpolate import Interpolation
from mocurve.kinematics import world


def measured(made: mc.Clip) -> Interpolation:
    return Interpolation(**made.history[-1]["measured"])


def between(clips: list[Motion], weights: list[float] | None = None, **options: object) -> Motion:
    return mc.interpolate(clips, weights, method="fourier", **options)  # type: ignore[arg-type]


def strided(size: float, lift: float = 0.0) -> Motion:
    """The walk with legs that swing so much more, and hips so much higher."""
    values = np.array(walk(200).values)
    legs = np.isin(BODY.channel_joints, [1, 2, 3, 4])
    values[:, legs] *= size
    values[:, BODY.channel("Hips.Yposition")] += lift
    return Motion(BODY, values, STEP)


def in_place(made: Motion, clip: Motion) -> float:
    """How far the joints are apart, at most, where the clip's phase (to 1/10 of a frame) and place fit best: cm."""
    own = world(made)

    def off(start: float) -> float:
        piece = world(at_times(clip, start * STEP + np.arange(made.frames) * made.frame_time, made.frame_time))
        step = planar.align(piece.reshape(-1, 3), own.reshape(-1, 3))
        return float(np.linalg.norm(planar.move(step, own) - piece, axis=-1).max())

    coarse = min(np.arange(1.0, (clip.duration - made.duration) / STEP - 1.0), key=off)
    return min(off(start) for start in coarse + np.linspace(-1.0, 1.0, 21))


# -- laws ----------------------------------------------------------------------------------------------
@pytest.mark.parametrize("turn", [0.0, 0.4])
def test_a_clip_with_all_the_weight_gives_its_own_cycle_where_it_is(turn: float) -> None:
    clip, other = walk(200, turn), mc.retime(strided(1.3), [(3.3, 4.0)])
    made = between([clip, other], [1.0, 0.0])
    assert made.frames == PERIOD + 1
    start = measured(made).clips[0]["start"]
    assert start is not None
    begun = start + np.arange(0.0, PERIOD * STEP, 0.1 * STEP)  # its phase is that of the other clip
    places = world(at_times(clip, begun, STEP))
    assert np.linalg.norm(places - world(made)[0], axis=-1).max(axis=1).min() < 0.3  # cm
    assert in_place(made, clip) < 0.3


@pytest.mark.parametrize("cycles", [1, 3])
def test_the_last_pose_is_the_first_one_carried_on(cycles: int) -> None:
    made = between([walk(200, 0.3), strided(1.3)], cycles=cycles)
    below = made.skeleton.channel_joints > 0
    np.testing.assert_allclose(made.values[-1, below], made.values[0, below], atol=1e-9)
    ends = world(made)[[0, -1]]
    step = planar.align(ends[1], ends[0])
    np.testing.assert_allclose(planar.move(step, ends[0]), ends[1], atol=1e-9)
    assert (made.frames - 1) % cycles == 0


def test_equal_clips_give_their_cycle_whatever_their_phase_and_place() -> None:
    first = walk(200, 0.2)
    for other in (first, walk(200, 0.2, phase=2.0), walk(230, 0.2, phase=-1.0)):
        for weights in ([0.5, 0.5], [0.3, 0.7], [-0.5, 1.5]):
            assert in_place(between([first, other], weights), first) < 0.5


def test_the_order_of_the_clips_does_not_matter() -> None:
    clips = [walk(200), mc.retime(strided(1.3), [(3.3, 4.0)]), walk(210, 0.3, phase=0.5)]
    first = between(clips, [0.5, 0.3, 0.2])
    made = between([clips[2], clips[0], clips[1]], [0.2, 0.5, 0.3])
    assert np.linalg.norm(world(made) - world(first), axis=-1).max() < 1e-9


def test_the_period_is_the_geometric_mean() -> None:
    quick, slow = walk(200), mc.retime(walk(200), [(199 * STEP, 1.5 * 199 * STEP)])
    found = measured(between([quick, slow], [0.25, 0.75]))
    assert found.period == pytest.approx(PERIOD * STEP * 1.5**0.75, abs=STEP)
    assert [clip["period"] for clip in found.clips] == pytest.approx([PERIOD * STEP, 1.5 * PERIOD * STEP], abs=STEP)


def test_travel_and_turn_of_a_cycle_are_between() -> None:
    made = between([walk(200, 0.5), walk(200, -0.1)], [0.5, 0.5])
    ends = world(made)[[0, -1]]
    step = planar.align(ends[1], ends[0])
    assert step[0] == pytest.approx(0.2, abs=1e-3)
    assert np.linalg.norm(ends[1, 0] - ends[0, 0]) == pytest.approx(120.0, abs=2.0)


def test_beyond_a_clip_its_style_is_exaggerated_and_can_be_given_to_another_gait() -> None:
    plain, styled, slow = walk(200), strided(1.4, 3.0), mc.retime(walk(200), [(199 * STEP, 4.5)])
    assert in_place(between([plain, styled], [-1.0, 2.0]), strided(1.8, 6.0)) < 5.0
    made = between([plain, styled, slow], [-1.0, 1.0, 1.0])
    expected = mc.retime(styled, [(199 * STEP, 4.5)])
    assert in_place(made, expected) < 2.0
    assert measured(made).period == pytest.approx(measured(between([slow])).period or 0.0, abs=STEP)


def test_limbs_out_of_phase_do_not_cancel() -> None:
    first = walk(200)
    values = np.array(first.values)
    head = BODY.channel("Head.Xrotation")
    turn = 2.0 * np.pi * np.arange(200) / PERIOD
    values[:, head] = 20.0 * np.sin(turn)
    ahead = Motion(BODY, values.copy(), STEP)
    values[:, head] = 20.0 * np.sin(turn + 2.5)
    made = between([ahead, Motion(BODY, values, STEP)])
    assert np.ptp(made.values[:, head]) == pytest.approx(40.0, abs=1.0)


def test_a_clip_of_one_cycle_is_taken_whole() -> None:
    once = mc.loop(walk(200), start=0.3, end=0.3 + PERIOD * STEP)
    made = between([once])
    assert measured(made).clips[0]["period"] == pytest.approx(PERIOD * STEP)
    assert in_place(made, walk(200)) < 0.5


def test_few_harmonics_are_smoother_and_their_error_is_told(jump: Path) -> None:
    clip = mc.read(jump)
    errors = [measured(between([clip], harmonics=count)).clips[0]["error"] or 0.0 for count in (1, 3, 12, 64)]
    assert errors == sorted(errors, reverse=True)
    assert errors[-1] < 0.1 * errors[0]


def test_places_choose_cycles_too() -> None:
    clips = [strided(size) for size in (0.6, 1.0, 1.6)]
    made = between(clips, None, places=[0.6, 1.0, 1.6], at=1.3)
    assert in_place(made, strided(1.3)) < 0.5


def test_joints_that_a_body_lacks_move_as_in_the_first() -> None:
    first = walk(200)
    renamed = replace(first.skeleton, names=(*first.skeleton.names[:5], "Skull"))
    made = between([first, replace(strided(1.3), skeleton=renamed)], [0.2, 0.8], match="names")
    head = BODY.channel("Head.Xrotation")
    assert np.ptp(made.values[:, head]) == pytest.approx(np.ptp(first.values[:, head]), abs=0.2)


# -- promises on real clips ----------------------------------------------------------------------------
def test_planted_feet_go_no_faster_than_in_the_clips(clips: Path) -> None:
    walks = [mc.read(clips / "cmu" / f"cmu_{name}.bvh") for name in ("12_01_walk", "02_01_walk_blender")]
    with warnings.catch_warnings(action="ignore"):  # other bones
        made = between(walks, [0.5, 0.5], cycles=2)
    found = measured(made)
    own = [clip["foot_speed"] for clip in found.clips]
    assert found.foot_speed is not None
    assert found.foot_speed < 1.1 * max(speed for speed in own if speed is not None)
    assert max(clip["error"] or 0.0 for clip in found.clips) < 0.2  # cm
    assert found.acceleration < 1.0
    assert widest_step(made) < max(widest_step(clip[1:]) for clip in walks)


# -- refusals ------------------------------------------------------------------------------------------
def test_a_clip_that_is_not_cyclic_is_refused() -> None:
    ramp = replace(walk(200), values=np.outer(np.linspace(0.0, 1.0, 200), np.full(BODY.channel_count, 40.0)))
    with pytest.raises(OptionError, match="clip 2 is not cyclic: no cycle is found"):
        between([walk(200), ramp])
    for frames in (1, 2, 5):
        with pytest.raises(OptionError, match="clip 1 is not cyclic"):
            between([walk(frames)])


def test_a_clip_that_hardly_comes_back_is_told(clips: Path) -> None:
    with warnings.catch_warnings(action="ignore"):  # no frame rate in the file
        run = mc.read(clips / "cmu" / "cmu_16_41.amc", skeleton=clips / "cmu" / "cmu_16.asf")
    with pytest.warns(UserWarning, match=r"clip 1 is hardly cyclic: the ends of its cycle are 0\.4\d of"):
        between([run])


def test_weights_that_change_are_refused() -> None:
    with pytest.raises(OptionError, match="with fourier the weights do not change in time"):
        between([walk(200), walk(200)], ["0:0,1:1", 1])  # type: ignore[list-item]


def test_a_joint_that_turns_round_is_refused() -> None:
    values = np.array(walk(200).values)
    values[:, BODY.channel("Head.Xrotation")] = 360.0 * np.arange(200) / PERIOD
    with pytest.raises(OptionError, match="joint 'Head' turns round within a cycle"):
        between([Motion(BODY, values, STEP)])


def test_more_frames_than_anybody_needs_are_refused() -> None:
    slow = mc.retime(walk(200), [(199 * STEP, 6.6)])
    with pytest.raises(OptionError, match=r"the result would have .* frames, more than 1000000"):
        between([walk(200), slow], [-9.0, 10.0], cycles=10_000)


def test_a_body_without_channels_to_go_by_is_refused() -> None:
    lame = replace(BODY, channels=(("Zrotation", "Xrotation", "Yrotation"), *BODY.channels[1:]))
    with pytest.raises(Mismatch, match="'Hips' has to be moved, and has no channel"):
        between([Motion(lame, walk(200).values[:, 3:], STEP)])


# -- the command ---------------------------------------------------------------------------------------
def test_the_command_writes_what_the_verb_makes(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    clips = [walk(200), strided(1.3)]
    sources = [str(tmp_path / f"{name}.npz") for name in "ab"]
    for source, clip in zip(sources, clips, strict=True):
        mc.write(source, clip)
    out = str(tmp_path / "out.npz")
    words = ["interpolate", *sources, "-o", out, "--weights=-0.5,1.5", "--method", "fourier", "--cycles", "2"]
    assert cli.main([*words, "--harmonics", "8", "--json"]) == 0
    made = between(clips, [-0.5, 1.5], cycles=2, harmonics=8)
    assert Interpolation(**json.loads(capsys.readouterr().out)) == measured(made)
    assert apart(mc.read(out), made) < 1e-9
    assert cli.main(words) == 0
    assert "s a cycle" in capsys.readouterr().out
