"""lock_feet: standing feet stand, everything far from them stays to the last digit, and what cannot be is refused."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import mocurve as mc
from mocurve import Contact, Mismatch, OptionError, UnknownName
from mocurve.edit.lock_feet import Locked
from mocurve.feet.legs import centimetres, legs, tracks
from mocurve.kinematics import world

LEG = ("UpLeg", "Leg", "Foot")


@pytest.fixture(scope="module")
def clip(jump: Path) -> mc.Motion:
    motion = mc.read(jump)
    assert isinstance(motion, mc.Motion)
    return motion


@pytest.fixture(scope="module")
def made(clip: mc.Motion) -> mc.Motion:
    return mc.lock_feet(clip)


def changed_frames(before: mc.Motion, after: mc.Motion) -> np.ndarray:
    return np.flatnonzero((before.values != after.values).any(axis=1))


def speeds(motion: mc.Motion, listed: list[Contact]) -> list[float]:
    """The fastest step, cm/s, of the ball over the ground in each contact."""
    both = legs(motion)
    place = {motion.skeleton.names[leg.ball]: track for leg, track in zip(both, tracks(motion, both)[0], strict=True)}
    return [
        float(np.linalg.norm(np.diff(place[c.joint][c.first : c.last + 1, ::2], axis=0), axis=1).max())
        * centimetres(motion)
        / motion.frame_time
        for c in listed
    ]


def balls(motion: mc.Motion) -> list[Contact]:
    return [c for c in mc.contacts(motion) if c.joint.endswith("ToeBase")]


# -- laws ------------------------------------------------------------------------------------------
def test_without_contacts_nothing_changes(clip: mc.Motion) -> None:
    assert mc.lock_feet(clip, []).values.tobytes() == clip.values.tobytes()


def test_standing_feet_stand_and_keep_their_height(clip: mc.Motion, made: mc.Motion) -> None:
    listed = balls(clip)
    assert min(speeds(clip, listed)) > 5.0
    assert max(speeds(made, listed)) < 0.01
    for leg in legs(clip):
        for c in listed:
            if c.joint == clip.skeleton.names[leg.ball]:
                heights = [world(motion)[c.first : c.last + 1, leg.ball, 1] for motion in (clip, made)]
                np.testing.assert_allclose(heights[1], heights[0], atol=1e-9)


def test_a_locked_clip_stays_to_the_last_digit(made: mc.Motion) -> None:
    assert mc.lock_feet(made).values.tobytes() == made.values.tobytes()


def test_a_locked_clip_stays_also_by_way_of_a_file(made: mc.Motion, tmp_path: Path) -> None:
    mc.write(tmp_path / "locked.bvh", made)
    read = mc.read(tmp_path / "locked.bvh")
    assert isinstance(read, mc.Motion)
    again = mc.lock_feet(read)
    assert centimetres(read) * np.abs(world(again) - world(read)).max() < 1e-6
    assert again.history[-1]["measured"]["changed"] == 0


def test_only_legs_and_the_place_of_the_body_change(clip: mc.Motion, made: mc.Motion) -> None:
    skeleton = clip.skeleton
    changed = {skeleton.channel_names[c] for c in np.flatnonzero((clip.values != made.values).any(axis=0))}
    allowed = {f"{side}{part}.{axis}rotation" for side in ("Left", "Right") for part in LEG for axis in "XYZ"}
    assert changed <= allowed | {f"Hips.{axis}position" for axis in "XYZ"}
    assert len(changed) == 21


def test_frames_far_from_a_contact_stay_to_the_last_digit(clip: mc.Motion) -> None:
    (contact,) = (c for c in balls(clip) if c.joint == "LeftToeBase" and c.first == 128)
    short = replace(contact, first=180, last=200)
    frames = changed_frames(clip, mc.lock_feet(clip, [short]))
    reach = round(0.6 / clip.frame_time)
    assert frames.min() >= 180 - reach
    assert frames.max() <= 200 + reach
    assert {180, 190, 200} <= set(frames.tolist())


def test_a_foot_goes_where_its_contact_says(clip: mc.Motion) -> None:
    listed = list(mc.contacts(clip))
    at = next(i for i, c in enumerate(listed) if c.joint == "LeftToeBase" and c.first == 320)
    x, y, z = listed[at].place
    listed[at] = replace(listed[at], place=(x + 0.4, y + 0.1, z - 0.2))
    made = mc.lock_feet(clip, listed)
    foot = clip.skeleton.joint("LeftToeBase")
    there = world(made)[330:410, foot]
    np.testing.assert_allclose(there[:, ::2], np.tile([x + 0.4, z - 0.2], (80, 1)), atol=1e-9)
    np.testing.assert_allclose(there[:, 1] - world(clip)[330:410, foot, 1], 0.1, atol=1e-9)


def test_the_history_holds_the_contacts_to_be_changed_and_given_again(clip: mc.Motion, made: mc.Motion) -> None:
    listed = made.history[-1]["measured"]["contacts"]
    assert listed == [contact.to_json() for contact in mc.contacts(clip)]
    assert mc.lock_feet(clip, listed).values.tobytes() == made.values.tobytes()
    right = [contact for contact in listed if contact["joint"].startswith("Right")]
    fewer = mc.lock_feet(clip, right)
    assert fewer.history[-1]["measured"]["contacts"] == right
    assert fewer.values.tobytes() != made.values.tobytes()


def test_contacts_may_be_given_as_they_were_printed(clip: mc.Motion, made: mc.Motion) -> None:
    listed = [c.to_json() | {"seconds": [0.0, 1.0]} for c in mc.contacts(clip)]
    given = mc.lock_feet(clip, listed)
    assert given.values.tobytes() == made.values.tobytes()
    step = given.history[-1]
    options = {name: step[name] for name in ("feet", "speed", "height", "release")}
    again = mc.lock_feet(clip, step["contacts"], **options)
    assert again.values.tobytes() == made.values.tobytes()


@pytest.mark.parametrize("scale", [0.01, 100.0])
def test_the_unit_of_length_does_not_matter(clip: mc.Motion, made: mc.Motion, scale: float) -> None:
    moves = ~clip.skeleton.rotation_channels
    body = replace(clip.skeleton, offsets=clip.skeleton.offsets * scale, unit=centimetres(clip) / 100.0 / scale)
    values = clip.values.copy()
    values[:, moves] *= scale
    other = mc.lock_feet(replace(clip, skeleton=body, values=values))
    np.testing.assert_allclose(other.values[:, ~moves], made.values[:, ~moves], atol=1e-7)


@pytest.mark.parametrize("fps", [30, 60])
def test_at_other_frame_rates_feet_stand_too(clip: mc.Motion, fps: int) -> None:
    slower = clip.sample(1.0 / fps)
    made = mc.lock_feet(slower)
    assert max(speeds(made, balls(slower))) < 0.01
    assert made.history[-1]["measured"]["drop"] < 1.0


def test_the_history_tells_the_numbers(clip: mc.Motion, made: mc.Motion) -> None:
    step = made.history[-1]
    assert step["verb"] == "lock_feet"
    measured = Locked(**step["measured"])
    assert measured.changed == measured.stances == 6
    assert measured.speed_before == pytest.approx(8.35, abs=0.2)
    assert measured.speed < 1e-6
    assert measured.drift < 1e-6
    assert measured.kept == 1.0
    assert 0.1 < measured.drop < 1.0
    assert 0.1 < measured.shift < 1.0
    assert "6 stances, 6 of them held anew" in str(measured)


def test_keys_become_samples_and_that_is_told(clip: mc.Motion, made: mc.Motion) -> None:
    keys = mc.reduce(clip[:200], tolerance="1deg", method="linear")
    with pytest.warns(UserWarning, match="keys become samples: feet are locked frame by frame"):
        locked = mc.lock_feet(keys)
    assert max(speeds(locked, balls(keys.sample()))) < 0.01
    assert [step["verb"] for step in locked.history][-1] == "lock_feet"


def test_what_other_verbs_made_is_locked(clip: mc.Motion) -> None:
    joined = mc.join(clip, clip, leave=2.9, enter=0.1)
    assert max(speeds(joined, balls(joined))) > 5.0
    assert max(speeds(mc.lock_feet(joined), balls(joined))) < 0.01
    mixed = mc.blend(clip[:300], clip[10:310], 0.5)
    assert max(speeds(mc.lock_feet(mixed), balls(mixed))) < 0.01


# -- refusals --------------------------------------------------------------------------------------
def far(clip: mc.Motion, away: float) -> list[Contact]:
    listed = list(mc.contacts(clip))
    at = next(i for i, c in enumerate(listed) if c.joint == "RightToeBase" and c.first == 128)
    x, y, z = listed[at].place
    listed[at] = replace(listed[at], place=(x - away / centimetres(clip), y, z))
    return listed


@pytest.mark.parametrize(("name", "body"), [("cmu_09_12.amc", "cmu_09.asf"), ("cmu_135_04_martial_daz.bvh", None)])
@pytest.mark.filterwarnings("ignore:.*no frame rate")
def test_feet_that_shake_as_they_land_do_not_pull_the_hips_aside(clips: Path, name: str, body: str | None) -> None:
    motion = mc.read(clips / "cmu" / name, skeleton=body and clips / "cmu" / body)
    measured = mc.lock_feet(motion).history[-1]["measured"]
    assert measured["kept"] >= 0.99
    assert measured["speed"] < 0.01
    assert measured["drop"] < 2.0
    assert measured["shift"] < 3.5


def test_a_foot_out_of_reach_is_refused_with_its_frames(clip: mc.Motion) -> None:
    with pytest.raises(
        OptionError, match=r"feet cannot be held: .* at frames \d+ to \d+, .* s.* with the option release"
    ):
        mc.lock_feet(clip, far(clip, 60.0))
    assert mc.lock_feet(clip, far(clip, 2.0)).history[-1]["measured"]["changed"] == 6


def test_what_is_let_go_is_told(clip: mc.Motion) -> None:
    listed = far(clip, 60.0)
    with pytest.warns(UserWarning, match=r"of 12 contacts cannot be held and are let go, the first of '\w+' at frame"):
        made = mc.lock_feet(clip, listed, release=True)
    gone = made.history[-1]["measured"]["released"]
    assert {"RightToeBase"} <= {row["joint"] for row in gone}
    kept = [c for c in listed if c.to_json() not in gone and c.joint.endswith("ToeBase")]
    assert len(kept) >= 3
    assert max(speeds(made, kept)) < 0.01


def test_release_changes_nothing_where_all_can_be_held(clip: mc.Motion, made: mc.Motion) -> None:
    assert mc.lock_feet(clip, release=True).values.tobytes() == made.values.tobytes()


def test_a_clip_in_which_no_foot_stands_is_told(clip: mc.Motion) -> None:
    flying = clip[270:310]
    with pytest.warns(UserWarning, match="no foot stands anywhere"):
        made = mc.lock_feet(flying)
    assert made.values.tobytes() == flying.values.tobytes()


@pytest.mark.parametrize("frames", [0, 1, 2])
def test_clips_of_hardly_any_frames(clip: mc.Motion, frames: int) -> None:
    assert mc.lock_feet(clip[:frames], []).frames == frames
    if frames:
        one = {"joint": "LeftToeBase", "first": 0, "last": frames - 1, "place": world(clip)[0, 5].tolist()}
        assert mc.lock_feet(clip[:frames], [one]).frames == frames


@pytest.mark.parametrize(
    ("given", "options", "error", "told"),
    [
        ([{"joint": "Hips", "first": 0, "last": 3, "place": [0, 0, 0]}], {}, UnknownName, "ball or ankle of a leg"),
        ([{"joint": "LeftFoot", "first": 0, "last": 420, "place": [0, 0, 0]}], {}, OptionError, "frames 0 to 419"),
        (None, {"speed": 0}, OptionError, "speed is a positive number"),
        (None, {"height": np.inf}, OptionError, "height is a positive number"),
        (None, {"feet": ["LeftToe", "RightToeBase"]}, UnknownName, "Did you mean 'LeftToeBase'"),
        (None, {"feet": "LeftToeBase"}, Mismatch, "two feet are needed, and 1 were found"),
    ],
)
def test_what_cannot_be_is_refused(
    given: list[Any] | None, options: dict[str, Any], error: type[Exception], told: str, clip: mc.Motion
) -> None:
    with pytest.raises(error, match=told):
        mc.lock_feet(clip, given, **options)


def test_missing_samples_and_bodies_without_legs_are_refused(clip: mc.Motion) -> None:
    values = clip.values.copy()
    values[5, 1] = np.nan
    with pytest.raises(Mismatch, match="'Hips\\.Yposition' has no value at frame 5"):
        mc.lock_feet(replace(clip, values=values))
    point = mc.Motion(mc.Skeleton(("Ball",), [-1], np.zeros((1, 3)), [("Xposition",)]), np.zeros((9, 1)), 0.01)
    with pytest.raises(Mismatch, match="two feet are needed, and 0 were found"):
        mc.lock_feet(point)
