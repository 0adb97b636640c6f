"""Foot skate: slides of known speed are measured as that by every measure, always where the first clip stands."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from legged import FPS, stepping, walk_left

import mocurve as mc
from mocurve import Contact
from mocurve.feet.legs import legs
from mocurve.feet.skate import Skate, skate
from mocurve.measure import Report

WHOLE = [Contact("LToe", 0, 119, (0.0, 0.0, 0.0))]


def sliding(speed: float, up: float = 0.0, fps: float = FPS, source_up: float = 0.0) -> Skate:
    """A left foot that goes ahead at so many cm/s, so many cm up; the right one stands."""
    still = np.zeros(120)
    clip = stepping(speed * np.arange(120) / fps, still + up, scale=0.01, fps=fps)
    source = stepping(still, still + source_up, scale=0.01, fps=fps)
    found = skate(clip, WHOLE, legs(source), source)
    assert found is not None
    return found


@pytest.mark.parametrize("fps", [30.0, 60.0, 120.0])
def test_an_even_slide_is_the_same_by_every_measure(fps: float) -> None:
    found = sliding(12.0, fps=fps)
    assert found.speed == pytest.approx(12.0)
    assert found.speed_p95 == pytest.approx(12.0)
    assert found.step == pytest.approx(120.0 / fps)
    assert found.weighed == pytest.approx(6.0)  # the other foot stands
    assert found.touching == pytest.approx(60.0 / fps)
    assert found.sole == pytest.approx(6.0)


def test_the_95th_percentile_tells_a_short_slip() -> None:
    ahead = np.concatenate([np.zeros(108), 20.0 * np.arange(1, 13) / FPS])
    found = skate(stepping(ahead, np.zeros(120)), WHOLE, legs(stepping(ahead, np.zeros(120))))
    assert found is not None
    assert found.speed_p95 == pytest.approx(20.0)
    assert found.speed == pytest.approx(20.0 * 12 / 119)


@pytest.mark.parametrize("fps", [20.0, 30.0, 120.0])
def test_the_ratio_counts_low_feet_that_are_fast(fps: float) -> None:
    assert sliding(0.0, fps=fps).ratio == 0.0
    assert sliding(45.0, fps=fps).ratio == 0.0  # not fast enough
    assert sliding(60.0, up=6.0, fps=fps).ratio == 0.0  # not low enough
    fast = sliding(60.0, fps=fps)
    steps = int(119 / fps * 20.0 + 1e-9)
    assert fast.ratio == pytest.approx(
        (steps - 4) / steps
    )  # less two at each end, where a mean of five frames lacks some


def test_the_weight_falls_with_the_height_above_the_floor_of_the_source() -> None:
    heights = (0.0, 0.5, 1.25, 2.0, 2.5, 9.0)
    found = [sliding(10.0, up=height).weighed for height in heights]
    assert found == pytest.approx([5.0 * (2.0 - 2.0 ** min(height / 2.5, 1.0)) for height in heights])


def test_a_lifted_foot_touches_nothing_and_has_no_sole() -> None:
    up = np.full(120, 9.0)
    clip, source = stepping(np.zeros(120), up), stepping(np.zeros(120), 0.0 * up)
    both = [leg for leg in legs(source) if source.skeleton.names[leg.ball] == "LToe"]
    found = skate(clip, WHOLE, both, source)
    assert found is not None
    assert found.touching is None
    assert found.sole is None
    assert found.kept == 0.0  # lifting hides nothing


def test_a_clip_of_few_frames_a_second_is_measured_as_it_is_and_takes_no_memory() -> None:
    slow = sliding(60.0, fps=0.5)
    assert slow.ratio == pytest.approx(115 / 119)  # less two at each end, as above
    assert sliding(60.0, fps=1e-12).ratio == pytest.approx(115 / 119)


def test_compare_tells_the_feet_of_both_clips_where_the_first_stands() -> None:
    step = walk_left()
    same = mc.compare(step, step).feet
    assert same is not None
    assert same.before == same.after
    slid = stepping(0.25 * np.arange(step.frames), np.zeros(step.frames))
    worse = mc.compare(step, slid).feet
    assert worse is not None
    assert worse.before == same.before
    assert worse.after.speed > worse.before.speed
    assert str(worse) in str(mc.compare(step, slid))


def test_the_numbers_go_through_json() -> None:
    report = mc.compare(walk_left(), walk_left())
    told = json.loads(json.dumps(report.to_json()))
    assert told["feet"]["before"]["speed"] == 0.0
    assert Report.from_json(told).feet == report.feet
    older = {name: value for name, value in told.items() if name != "feet"}
    assert Report.from_json(older).feet is None


def test_a_body_without_legs_or_contacts_has_no_foot_skate(jump: Path) -> None:
    arm = mc.Motion(mc.Skeleton(("Arm",), [-1], [[0, 9, 0]], (("Yrotation",),)), np.zeros((30, 1)), 1 / 50)
    told = mc.compare(arm, arm)
    assert told.feet is None
    assert "feet  " not in str(told)
    for clip in (mc.read(jump)[:1], mc.read(jump)[:0]):
        assert mc.compare(clip, clip).feet is None


def test_feet_of_a_real_capture_are_held_by_lock_feet(jump: Path) -> None:
    clip = mc.read(jump)
    found = mc.compare(clip, mc.lock_feet(clip)).feet
    assert found is not None
    assert found.before.speed > 3.0
    assert found.after.speed < 0.01
    assert found.after.speed_p95 < 0.01
    assert found.after.weighed < found.before.weighed
