"""Contacts: a foot that comes, stands and leaves is found where it does, whatever unit, rate or floor; what is given
back by hand is checked."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from legged import FPS, stepping, still_body, walk_left

import mocurve as mc
from mocurve import Contact, Mismatch, OptionError, UnknownName
from mocurve.feet.contacts import RUNNING, WALKING, contacts, read_contacts, slowness
from mocurve.feet.legs import legs


def left(found: tuple[Contact, ...]) -> list[tuple[int, int]]:
    return [(contact.first, contact.last) for contact in found if contact.joint == "LToe"]


# -- what is found -------------------------------------------------------------------------------
def test_a_step_is_between_two_contacts_and_the_other_foot_stands() -> None:
    found = contacts(walk_left())
    (first, end), (start, last) = left(found)
    assert (first, last) == (0, 150)
    assert 46 <= end <= 55
    assert 95 <= start <= 104
    assert [(c.first, c.last) for c in found if c.joint == "RToe"] == [(0, 150)]
    assert {c.joint for c in found} == {"LToe", "LFoot", "RToe", "RFoot"}


def test_the_place_is_where_the_ball_stands_and_under_the_heel() -> None:
    found = contacts(walk_left())
    before, after = (c for c in found if c.joint == "LToe")
    np.testing.assert_allclose(before.place, [10, 0, 12], atol=0.5)
    np.testing.assert_allclose(after.place, [70, 0, 12], atol=0.5)
    heel = next(c for c in found if c.joint == "RFoot")
    np.testing.assert_allclose(heel.place, [-10, 0, -3], atol=1e-9)


@pytest.mark.parametrize(("fps", "scale"), [(60, 1.0), (240, 1.0), (100, 0.01), (100, 10.0)])
def test_neither_unit_nor_frame_rate_changes_a_contact(fps: float, scale: float) -> None:
    usual = [(a / FPS, b / FPS) for a, b in left(contacts(walk_left()))]
    found = [(a / fps, b / fps) for a, b in left(contacts(walk_left(fps, scale)))]
    np.testing.assert_allclose(found, usual, atol=2.0 / min(fps, FPS))


def test_where_the_clip_is_put_changes_nothing() -> None:
    clip = walk_left()
    values = clip.values.copy()
    values[:, :3] += [500.0, -300.0, 40.0]
    assert left(contacts(replace(clip, values=values))) == left(contacts(clip))


def test_on_a_slope_every_stance_is_found_and_a_held_up_foot_is_not() -> None:
    u = np.arange(600) / 100.0
    steps = np.floor(u) + np.clip(2.0 * (u % 1.0) - 0.5, 0.0, 1.0)
    ahead = 60.0 * steps
    up = 0.15 * ahead + 15.0 * np.sin(np.pi * np.clip(2.0 * (u % 1.0) - 0.5, 0.0, 1.0)) ** 2
    assert len(left(contacts(stepping(ahead, up)))) == 7
    level = walk_left()
    held = replace(level, values=np.concatenate([level.values, level.values[-1:].repeat(200, axis=0)]))
    lifted = held.values.copy()
    lifted[200:, 7] += 15.0
    assert left(contacts(replace(held, values=lifted)))[-1][1] in range(195, 203)


def test_hysteresis_short_gaps_are_closed_and_short_contacts_dropped() -> None:
    slow, between, fast = 10.0, 20.0, 60.0  # cm/s; stands below 15, leaves above 30

    def found(*spans: tuple[float, int]) -> list[tuple[int, int]]:
        pace = np.concatenate([[fast] * 40, *[[v] * n for v, n in spans], [fast] * 40])
        ahead = np.concatenate([[0.0], np.cumsum(pace)]) / FPS
        return left(contacts(stepping(ahead, 0.0 * ahead)))

    assert len(found((slow, 30), (between, 30))) == 1
    assert found((between, 60)) == []
    (whole,) = found((slow, 30), (between, 30))
    assert whole[1] - whole[0] > 55
    assert len(found((slow, 30), (fast, 2), (slow, 30))) == 1
    assert len(found((slow, 30), (fast, 15), (slow, 30))) == 2
    assert found((slow, 7)) == []


def test_a_foot_that_shakes_as_it_lands_does_not_stand_yet() -> None:
    wobble = 3.0 * (np.arange(151) % 2)  # cm, there and back: on the mean it goes nowhere
    clip = walk_left()
    shaken = clip.values.copy()
    shaken[100:110, 6] += wobble[100:110]
    usual, found = left(contacts(clip)), left(contacts(replace(clip, values=shaken)))
    assert usual[1][0] < 104
    assert found == [usual[0], (110, 150)]
    assert left(contacts(stepping(wobble, 0.0 * wobble))) == [(0, 150)]  # one that always shakes has no better part


def test_what_is_held_still_tells_its_own_contact() -> None:
    pace = np.concatenate([[12.0] * 30, [0.0] * 40, [12.0] * 30])
    ahead = np.concatenate([[0.0], np.cumsum(pace)]) / FPS
    assert left(contacts(stepping(ahead, 0.0 * ahead))) == [(30, 70)]


def test_a_jump_lands_on_both_feet(jump: Path) -> None:
    clip = mc.read(jump)
    found = contacts(clip)
    balls = [c for c in found if c.joint.endswith("ToeBase")]
    assert len(balls) == 6
    flying = np.ones(clip.frames, bool)
    for contact in found:
        flying[contact.first : contact.last + 1] = False
    assert flying.mean() > 0.2
    assert [c.first for c in found] == sorted(c.first for c in found)


@pytest.mark.parametrize("frames", [0, 1])
def test_a_single_frame_has_no_contacts(frames: int, jump: Path) -> None:
    assert contacts(mc.read(jump)[:frames]) == ()


def test_a_body_that_runs_has_faster_feet() -> None:
    body = still_body(200)
    for pace, slow in ((190.0, WALKING), (210.0, RUNNING)):
        values = body.values.copy()
        values[:, 2] += pace * np.arange(200) / FPS
        assert slowness(replace(body, values=values)) == slow
    assert slowness(body[:1]) == WALKING


def test_runs_and_walks_of_real_clips_are_told_apart(clips: Path) -> None:
    for name, slow in (("cmu_02_01_walk_blender", WALKING), ("cmu_12_01_walk", WALKING), ("cmu_run_filtered", RUNNING)):
        motion = mc.read(clips / "cmu" / f"{name}.bvh")
        assert isinstance(motion, mc.Motion)
        assert slowness(motion) == slow
        assert mc.contacts(motion) == mc.contacts(motion, speed=slow)


# -- refusals --------------------------------------------------------------------------------------
@pytest.mark.parametrize("option", [{"speed": 0.0}, {"speed": np.nan}, {"height": -1.0}, {"height": "low"}])
def test_a_threshold_is_a_positive_number(option: dict[str, Any], jump: Path) -> None:
    (name,) = option
    with pytest.raises(OptionError, match=f"{name} is a positive number"):
        contacts(mc.read(jump), **option)


def test_missing_samples_are_named() -> None:
    body = still_body(50)
    values = body.values.copy()
    values[7, 3] = np.nan
    with pytest.raises(Mismatch, match=r"'Hips\.Xrotation' has no value at frame 7"):
        contacts(replace(body, values=values))


WHOLE = {"joint": "LToe", "first": 3, "last": 9, "place": [1, 2, 3]}


@pytest.mark.parametrize(
    ("changed", "error", "told"),
    [
        ({"joint": "LToes"}, UnknownName, "Did you mean 'LToe'"),
        ({"joint": "Hips"}, UnknownName, "ball or ankle of a leg"),
        ({"first": -1}, OptionError, "the clip has frames 0 to 49"),
        ({"last": 50}, OptionError, "the frame 50"),
        ({"last": 2}, OptionError, "ends at frame 2, before its first, 3"),
        ({"first": 3.5}, OptionError, "3.5"),
        ({"first": True}, OptionError, "True"),
        ({"place": [1, 2]}, OptionError, "three numbers"),
        ({"place": [1, 2, np.inf]}, OptionError, "three numbers"),
        ({"place": "here"}, OptionError, "three numbers"),
        ({"place": None}, OptionError, "three numbers"),
    ],
)
def test_a_contact_that_cannot_be_is_refused(changed: dict[str, Any], error: type[Exception], told: str) -> None:
    body = still_body(50)
    with pytest.raises(error, match=told):
        read_contacts([WHOLE | changed], body, legs(body))


def test_contacts_are_objects_with_all_parts_that_do_not_overlap() -> None:
    body = still_body(50)
    both = legs(body)
    with pytest.raises(OptionError, match="has no 'place'"):
        read_contacts([{"joint": "LToe", "first": 3, "last": 9}], body, both)
    with pytest.raises(OptionError, match="is an object with joint"):
        read_contacts(["LToe"], body, both)  # type: ignore[list-item]
    for odd in (5, "LToe", {"contacts": []}):
        with pytest.raises(OptionError, match="contacts are a list of them, not"):
            read_contacts(odd, body, both)  # type: ignore[arg-type]
    with pytest.raises(OptionError, match="two contacts of 'LToe' share frame 9"):
        read_contacts([WHOLE, WHOLE | {"first": 9, "last": 12}], body, both)
    assert len(read_contacts([WHOLE, WHOLE | {"joint": "LFoot"}, WHOLE | {"first": 10, "last": 12}], body, both)) == 3


def test_contacts_come_back_from_json() -> None:
    clip = walk_left()
    found = contacts(clip)
    assert read_contacts([contact.to_json() for contact in found], clip, legs(clip)) == found
    numbers = [WHOLE | {"first": np.int64(3), "place": np.array([1.0, 2.0, 3.0])}]
    (contact,) = read_contacts(numbers, clip, legs(clip))
    assert contact == Contact("LToe", 3, 9, (1.0, 2.0, 3.0))
    assert type(contact.first) is int
