"""act_out: the own performance changes nothing, a known timing comes back, jitter and size do not matter, keys stay."""

from __future__ import annotations

import json
import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from walks import BODY, STEP, walk

import mocurve as mc
from mocurve import KeyedMotion, Motion, OptionError, SplineMotion, UnknownName, cli
from mocurve.edit import _features
from mocurve.edit.act_out import ActedOut
from mocurve.edit.retime import time_map
from mocurve.kinematics import world

WARP = [(0.5, 0.7), (1.5, 1.6), (2.2, 2.6)]
FOOT = {"joint": "LeftFoot"}
CHANNEL = {"channel": "LeftLeg.Zrotation"}


def measured(clip: mc.Clip) -> ActedOut:
    return ActedOut(**clip.history[-1]["measured"])


def heights(clip: Motion, joint: str = "LeftFoot") -> np.ndarray:
    return np.column_stack([np.arange(clip.frames) * clip.frame_time, world(clip)[:, BODY.names.index(joint), 1]])


def frames_off(clip: Motion, found: ActedOut, warp: list[tuple[float, float]]) -> float:
    """How far the pairs are from a known map, at most, in frames."""
    bent = time_map(clip, warp)
    return max(abs(float(bent.at(np.array(row["old"]))) - row["new"]) for row in found.matched) / clip.frame_time


# -- laws ----------------------------------------------------------------------------------------------
@pytest.mark.parametrize(
    "options", [FOOT, CHANNEL, {**FOOT, "of": "speed"}, {**FOOT, "features": "lows"}, {**FOOT, "ends": False}]
)
def test_the_clip_itself_as_performance_changes_nothing(options: dict[str, object]) -> None:
    clip = walk(200)
    made = mc.act_out(clip, clip, **options)
    np.testing.assert_allclose(made.values, clip.values, atol=1e-9)
    found = measured(made)
    assert all(row["old"] == pytest.approx(row["new"], abs=1e-12) for row in found.matched)
    assert found.skipped == found.extra == []


@pytest.mark.parametrize("options", [FOOT, CHANNEL, {**FOOT, "features": "highs"}])
def test_a_known_timing_comes_back_within_a_frame(options: dict[str, str]) -> None:
    clip = walk(200)
    reference = mc.retime(clip, WARP)
    made = mc.act_out(clip, reference, **options)
    found = measured(made)
    assert found.skipped == []
    assert len(found.extra) <= 1  # a small turn at the very beginning
    assert frames_off(clip, found, WARP) < 1.0
    assert made.frames == reference.frames


@given(st.floats(0.01, 1000.0), st.floats(-1e4, 1e4), st.floats(-100.0, 100.0))
def test_size_and_offset_of_the_performance_do_not_matter(size: float, offset: float, later: float) -> None:
    clip = walk(200)
    rows = heights(mc.retime(clip, WARP))
    plain = measured(mc.act_out(clip, rows, **FOOT)).matched
    other = measured(mc.act_out(clip, rows * [1.0, size] + [later, offset], **FOOT)).matched
    np.testing.assert_allclose([row["new"] for row in other], [row["new"] for row in plain], atol=5e-3)


@pytest.mark.parametrize("seed", range(5))
def test_a_hand_that_shakes_is_followed(seed: int) -> None:
    clip = walk(200)
    rows = heights(mc.retime(clip, WARP))
    rows[:, 1] += np.random.default_rng(seed).normal(0.0, 0.03 * np.ptp(rows[:, 1]), len(rows))
    found = measured(mc.act_out(clip, rows, **FOOT))
    assert len(found.skipped) <= 1
    assert frames_off(clip, found, WARP) < 3.0


def test_neither_huge_nor_tiny_values_are_too_much() -> None:
    clip = walk(200)
    rows = heights(mc.retime(clip, WARP))
    plain = [row["new"] for row in measured(mc.act_out(clip, rows, **FOOT)).matched]
    for size in (1e-300, 1e300):
        found = measured(mc.act_out(clip, rows * [1.0, size], **FOOT)).matched
        np.testing.assert_allclose([row["new"] for row in found], plain, atol=1e-6)


def test_keys_move_with_their_slopes_and_stay_keys() -> None:
    clip = walk(200)
    keys = mc.reduce(clip, tolerance="0.1deg")
    made = mc.act_out(keys, heights(mc.retime(clip, WARP)), **FOOT)
    assert isinstance(made, KeyedMotion)
    assert made.keys == keys.keys
    pairs = [(row["old"], row["new"]) for row in measured(made).matched]
    bent = time_map(keys, pairs)
    for curve, before in zip(made.curves, keys.curves, strict=True):
        np.testing.assert_allclose(curve.times, bent.at(before.times), atol=1e-12)
        np.testing.assert_array_equal(curve.values, before.values)
        np.testing.assert_allclose(curve.slopes * bent.speeds(before.times), before.slopes, atol=1e-9)
    assert isinstance(mc.act_out(mc.fit(clip, tolerance="0.5deg"), clip, **CHANNEL), SplineMotion)


# -- what only one of the two has ------------------------------------------------------------------------
@pytest.mark.filterwarnings("ignore:the clip runs")
def test_what_only_one_of_the_two_has_is_left_out_and_told() -> None:
    clip = walk(200)
    own = measured(mc.act_out(clip, clip, **FOOT)).matched
    times = np.array([row["old"] for row in own])
    levels = np.interp(times, *heights(clip).T)
    short = np.delete(np.column_stack([times, levels]), [3, 4], axis=0)  # one high and one low fewer
    found = measured(mc.act_out(clip, short, **FOOT))
    assert all(np.abs(np.array(found.skipped) - time).min() < 1e-3 for time in times[[3, 4]])
    assert len(found.skipped) <= 3  # a small turn at the very beginning
    assert found.extra == []
    assert all(np.abs(short[:, 0] - row["new"]).min() < 1e-3 for row in found.matched)
    found = measured(mc.act_out(mc.retime(clip, {clip.duration: clip.duration}), clip, **FOOT))
    assert found.skipped == []


@pytest.mark.filterwarnings("ignore:the clip runs")
def test_taps_set_a_beat() -> None:
    clip = walk(200)
    lows = [row["old"] for row in measured(mc.act_out(clip, clip, **FOOT, features="lows")).matched[1:-1]]
    beat = 10.0 + 1.3 * np.arange(len(lows))  # when the recording began does not matter
    made = mc.act_out(clip, beat, **FOOT, features="lows")
    found = measured(made)
    assert [row["kind"] for row in found.matched] == ["tap"] * len(lows)
    np.testing.assert_allclose([row["old"] for row in found.matched], lows)
    np.testing.assert_allclose(np.diff([row["new"] for row in found.matched]), 1.3)
    assert found.matched[0]["new"] == pytest.approx(found.matched[0]["old"])


def test_a_few_rows_drawn_by_hand_are_a_performance() -> None:
    clip = walk(34)  # half a cycle
    rows = heights(clip)
    turns = measured(mc.act_out(clip, clip, **FOOT)).matched[1:-1]
    drawn = [(0.0, rows[0, 1]), *((1.2 * row["old"], np.interp(row["old"], *rows.T)) for row in turns)]
    drawn.append((1.2 * clip.duration, rows[-1, 1]))
    found = measured(mc.act_out(clip, drawn, **FOOT))
    np.testing.assert_allclose([row["new"] / row["old"] for row in found.matched[1:]], 1.2, rtol=0.02)


def test_a_way_on_a_pad_is_matched_by_its_speed() -> None:
    clip = walk(200)
    reference = mc.retime(clip, [(1.0, 1.2), (2.0, 2.3)])
    places = world(reference)[:, BODY.names.index("LeftFoot")]
    pad = np.column_stack([np.arange(reference.frames) * STEP, places[:, [2, 1, 0]] * 0.01 - 7.0])
    found = measured(mc.act_out(clip, pad, **FOOT, of="speed"))
    assert frames_off(clip, found, [(1.0, 1.2), (2.0, 2.3)]) < 1.0


def test_a_t_pose_in_front_is_no_turn() -> None:
    posed = replace(walk(201), values=np.vstack([[[0, 90, 0] + [0.0] * 17], walk(200).values]))
    plain, other = (measured(mc.act_out(clip, clip, **FOOT)) for clip in (walk(200), posed))
    assert len(plain.matched) == len(other.matched)


# -- the step --------------------------------------------------------------------------------------------
@pytest.mark.filterwarnings("ignore:the clip runs")
def test_the_step_can_be_run_again_from_json() -> None:
    clip = replace(walk(200), history=({"verb": "denoise"},))
    for performance in (heights(mc.retime(clip, WARP)), mc.retime(clip, WARP), [0.5, 1.7, 2.9]):
        made = mc.act_out(clip, performance, **FOOT, features="lows")
        first, step = json.loads(json.dumps(made.history))
        assert first == {"verb": "denoise"}
        assert step.pop("verb") == "act_out"
        step.pop("measured")
        again = mc.act_out(clip, step.pop("performance"), **step)
        np.testing.assert_array_equal(again.values, made.values)


@pytest.mark.filterwarnings("ignore:the clip runs .* times faster")
def test_a_leap_of_the_speed_is_told() -> None:
    clip = walk(200)
    with pytest.warns(UserWarning, match="the clip runs .* times slower"):
        mc.act_out(clip, heights(_slow(clip)), **FOOT)


def _slow(clip: Motion) -> Motion:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return mc.retime(clip, [(1.0, 1.0), (2.0, 4.0)])  # type: ignore[return-value]


# -- real clips -------------------------------------------------------------------------------------------
@pytest.mark.parametrize("joint", ["LeftFoot", "LeftHand"])
def test_the_timing_of_a_captured_walk_comes_back(joint: str, clips: Path) -> None:
    clip = mc.read(clips / "cmu" / "cmu_12_01_walk.bvh")
    found = measured(mc.act_out(clip, mc.retime(clip, WARP), joint=joint))
    assert found.skipped == []
    assert frames_off(clip, found, WARP) < 1.0  # of 1/120 s


# -- refusals ------------------------------------------------------------------------------------------
@pytest.mark.parametrize(
    ("performance", "options", "words"),
    [
        (walk(200), {}, "either a channel or a joint"),
        (walk(200), {**FOOT, **CHANNEL}, "either a channel or a joint"),
        ([(0, 0), (1, 1), (2, 2)], FOOT, "the performance has no highs or lows"),
        ([(0, 5), (1, 5), (2, 5)], FOOT, "the performance has no highs or lows"),
        ([(0, 0), (1, 1), (2, 0)], {**FOOT, "features": "lows"}, "the performance has no lows"),
        (walk(200), {"channel": "Hips.Zposition"}, "Hips.Zposition has no highs or lows .*: it moves one way"),
        ([0.5], FOOT, "a performance has 2 to 100000 rows, not 1"),
        ([], FOOT, "a performance has 2 to 100000 rows, not 0"),
        ([(0, 0), (1,)], FOOT, "rows of seconds and values, all equally long"),
        ("mouse", FOOT, "rows of seconds and values, all equally long"),
        ([(0, 0), (1, float("nan")), (2, 0)], FOOT, "row 2 of the performance is not all numbers"),
        ([(0, 0), (2, 1), (1, 0)], FOOT, "the times of a performance rise; row 3 is at 1 s, after 2 s"),
        ([(1, 0), (1, 1), (1, 0)], FOOT, "all rows of the performance are at one time"),
        ([(0, 0, 0), (1, 1, 1), (2, 0, 0)], FOOT, "2 values a row: take one of them, or match speeds"),
        (np.zeros((3, 2, 2)), FOOT, r"not shape \(3, 2, 2\)"),
        (np.zeros((3, 0)), FOOT, r"not shape \(3, 0\)"),
        ([(0, 0), (1e300, 1), (1.7e308, 0)], FOOT, r"a performance lasts 100000 s at most, not 1.7e\+308"),
        ([(0, 0), (1e-9, 1), (2e-9, 0)], FOOT, "the performance has no highs or lows"),
        (np.zeros((100_001, 2)), FOOT, "a performance has 2 to 100000 rows"),
        (np.column_stack([np.arange(1000), np.arange(1000) % 2]), FOOT, "turns 99. times; at most 200"),
    ],
)
def test_what_is_no_performance_is_refused(performance: object, options: dict[str, str], words: str) -> None:
    with pytest.raises(OptionError, match=words):
        mc.act_out(walk(200), performance, **options)  # type: ignore[arg-type]


def test_names_are_told_the_nearest() -> None:
    for options, near in (
        ({"joint": "LeftFot"}, "LeftFoot"),
        ({"channel": "LeftLeg.Zrotatoin"}, "LeftLeg.Zrotation"),
        ({**FOOT, "of": "hight"}, "height"),
        ({**FOOT, "features": "turn"}, "turns"),
    ):
        with pytest.raises(UnknownName, match=near):
            mc.act_out(walk(200), walk(200), **options)


@pytest.mark.parametrize("frames", [0, 1, 2, 5])
def test_short_clips_are_refused(frames: int) -> None:
    with pytest.raises(OptionError, match=r"no time to change|no highs or lows"):
        mc.act_out(walk(frames), walk(200), **FOOT)


# -- features ------------------------------------------------------------------------------------------
@given(st.lists(st.floats(0.3, 1.0), min_size=3, max_size=12), st.integers(0, 2**32 - 1))
def test_turns_are_where_the_signal_turns(gaps: list[float], seed: int) -> None:
    times = np.concatenate([[0.0], np.cumsum(gaps)])
    levels = np.where(np.arange(len(times)) % 2, 1.0, 0.0) + 0.2 * np.random.default_rng(seed).random(len(times))
    at = np.arange(0.0, times[-1], 0.005)
    k = np.minimum(np.searchsorted(times, at, "right") - 1, len(times) - 2)  # the last time may be reached by rounding
    u = (at - times[k]) / np.diff(times)[k]
    values = levels[k] + np.diff(levels)[k] * 0.5 * (1.0 - np.cos(np.pi * u))
    found = _features.turns(at, values)
    np.testing.assert_allclose(found.times, times[1:-1], atol=0.03)
    np.testing.assert_array_equal(found.kinds, np.where(np.arange(1, len(times) - 1) % 2, 1, -1))


# -- the command ---------------------------------------------------------------------------------------
@pytest.mark.filterwarnings("ignore:the clip runs")
def test_the_command_takes_tables_taps_and_clips(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    clip = walk(200)
    reference = mc.retime(clip, WARP)
    mc.write(tmp_path / "walk.bvh", clip)
    mc.write(tmp_path / "she.bvh", reference)
    rows = heights(reference)
    lines = "\n".join(f"{k},{t:.6f},{y:.6f}" for k, (t, y) in enumerate(rows))
    (tmp_path / "mouse.csv").write_text(f"frame,time,y\n{lines}\n")
    (tmp_path / "bare.csv").write_text("\n".join(f"{y:.6f}" for y in rows[:, 1]) + "\n")
    (tmp_path / "taps.csv").write_text("seconds\n0.5\n1.6\n2.8\n")
    walked, goal = str(tmp_path / "walk.bvh"), str(tmp_path / "timed.bvh")

    def run(performance: str, *more: str) -> int:
        given = ["--performance", str(tmp_path / performance), "--joint", "LeftFoot"]
        return cli.main(["act-out", walked, "-o", goal, *given, *more])

    for name, more in (
        ("mouse.csv", ("--column", "y")),
        ("bare.csv", ("--fps", "60")),
        ("she.bvh", ()),
        ("taps.csv", ("--features", "lows", "--no-ends")),
    ):
        assert run(name, *more, "--json") == 0
        told = json.loads(capsys.readouterr().out)
        assert told["measured"]["matched"]
        assert mc.read(goal).frames == told["frames"]
        if name != "taps.csv":
            assert mc.read(goal).frames == reference.frames
    assert run("she.bvh") == 0
    assert "high" in capsys.readouterr().out
    for words, name, more in (
        ("has the columns frame, y: --column says which", "mouse.csv", ()),
        ("no column 'x'", "mouse.csv", ("--column", "x")),
        ("are of tables", "she.bvh", ("--fps", "60")),
        ("--fps is a positive number", "bare.csv", ("--fps", "0")),
    ):
        assert run(name, *more) == 2
        assert words in capsys.readouterr().err
    (tmp_path / "bad.csv").write_text("time,y\n0,1\n1,one\n")
    assert run("bad.csv") == 2
    assert "bad.csv:3: column 2 (y): a number expected, 'one' found" in capsys.readouterr().err
    (tmp_path / "two.csv").write_text("0,1\n1,2\n2,3\n")
    assert run("two.csv", "--column", "2") == 2
    assert "has no column 'time': --fps says" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("table", "words"),
    [
        (b"", "the table is empty"),
        (b"\n\n", "the table is empty"),
        (b"time", "a performance has 2 to 100000 rows, not 0"),
        (b"time,y\n0,1\n", "a performance has 2 to 100000 rows, not 1"),
        (b"time,y\n0,1\n1,\n2,1\n", "row 2 of the performance is not all numbers"),
        (b"time,time\n0,1\n1,2\n", "two columns are called 'time'"),
        (b"time,y\n0,1\n1,2,3\n", "2 cells expected, 3 found"),
        (b"\x00\xff\xfe\x01", "bad.csv"),
        (b"\x80\x81,\x82\n1,2\n", "bad.csv"),
        (b'"time,y\n0,1\n1,2\n', "rows, not 0"),
        (b"1e999,2\n1,2\n", "bad.csv"),
        (b"nan\nnan\nnan\n", "row 1 of the performance is not all numbers"),
    ],
)
def test_broken_tables_are_one_sentence(
    table: bytes, words: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    mc.write(tmp_path / "walk.bvh", walk(60))
    (tmp_path / "bad.csv").write_bytes(table)
    given = ["--performance", str(tmp_path / "bad.csv"), "--joint", "LeftFoot", "-o", str(tmp_path / "made.bvh")]
    assert cli.main(["act-out", str(tmp_path / "walk.bvh"), *given]) == 2
    told = capsys.readouterr().err
    assert words in told
    assert told.count("\n") == 1
    assert not (tmp_path / "made.bvh").exists()
