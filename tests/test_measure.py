"""Comparing two clips: what counts as an error, what does not, and what is refused."""

import json
import warnings
from dataclasses import replace

import numpy as np
import pytest

from mocurve.errors import Mismatch
from mocurve.keyed import HermiteCurve, KeyedMotion
from mocurve.measure import ChannelError, JointError, Report, compare, side_by_side
from mocurve.motion import Motion
from mocurve.skeleton import Skeleton

TURNS = ("Zrotation", "Yrotation", "Xrotation")
PLACES = ("Xposition", "Yposition", "Zposition")


def arm(**changes):
    """A root, an elbow 10 units along X, a hand end site 10 further."""
    body = Skeleton(
        names=("Root", "Elbow", "Elbow_End"),
        parents=[-1, 0, 1],
        offsets=[[0, 0, 0], [10, 0, 0], [10, 0, 0]],
        channels=(PLACES + TURNS, TURNS, ()),
        end_sites=[False, False, True],
    )
    return replace(body, **changes)


def swing(frames=60, seed=1, skeleton=None, frame_time=1 / 60):
    """Smooth random motion of the arm, degrees within about +-60."""
    rng = np.random.default_rng(seed)
    times = np.arange(frames)[:, None] * frame_time
    values = sum(20 * np.sin(rng.uniform(1, 8, 9) * times + rng.uniform(0, 6, 9)) for _ in range(3))
    return Motion(skeleton or arm(), values, frame_time)


def every_frame_a_key(motion):
    times = np.arange(motion.frames) * motion.frame_time
    slopes = np.gradient(motion.values, motion.frame_time, axis=0)
    curves = [HermiteCurve(times, motion.values[:, c], slopes[:, c]) for c in range(motion.values.shape[1])]
    return KeyedMotion(motion.skeleton, tuple(curves), motion.frame_time, motion.frames)


def moved(motion, channel, by):
    values = np.array(motion.values)
    values[:, channel] += by
    return replace(motion, values=values)


def test_a_clip_is_nothing_away_from_itself_and_costs_its_samples():
    report = compare(swing(), swing())
    assert report.max_error_world == report.max_error_degrees == report.max_error_length == 0
    assert report.keys == report.samples == 60 * 9
    assert report.ratio == 1
    assert report.bytes == 60 * 9 * 8


def test_keys_on_every_frame_are_nothing_away_and_are_counted():
    report = compare(swing(), every_frame_a_key(swing()))
    assert report.max_error_world < 1e-9
    assert report.keys == 540
    assert report.bytes == 540 * 24
    assert [row.keys for row in report.channels] == [60] * 9


def test_a_shift_of_one_channel_is_found_in_its_own_unit_and_in_space():
    report = compare(swing(), moved(swing(), 1, 0.25))
    assert report.max_error_length == pytest.approx(0.25)
    assert report.rms_error_length == pytest.approx(0.25 / np.sqrt(3))
    assert report.max_error_degrees == 0
    assert [row.max for row in report.joints] == pytest.approx([0.25] * 3)
    assert [row.rms for row in report.joints] == pytest.approx([0.25] * 3)


def test_a_turned_elbow_moves_the_end_site_and_nothing_above_it():
    report = compare(swing(), moved(swing(), 6, 2.0))
    assert report.max_error_degrees == pytest.approx(2.0)
    row = next(row for row in report.channels if row.max > 0)
    assert (row.name, row.unit) == ("Elbow.Zrotation", "degrees")
    assert [row.max > 0 for row in report.joints] == [False, False, True]
    assert report.max_error_world <= 2 * 10 * np.sin(np.radians(1.0)) + 1e-9


def test_the_furthest_frame_counts_not_the_average():
    values = np.array(swing().values)
    values[37, 7] += 5.0
    report = compare(swing(), Motion(arm(), values, 1 / 60))
    assert report.max_error_degrees == pytest.approx(5.0)
    assert report.channels[7].rms == pytest.approx(5.0 / np.sqrt(60))


def test_whole_turns_are_no_error():
    values = np.array(swing().values)
    values[20:, 4] += 720
    values[40:, 8] -= 360
    report = compare(Motion(arm(), values, 1 / 60), swing())
    assert report.max_error_degrees == pytest.approx(0, abs=1e-9)
    assert report.max_error_world == pytest.approx(0, abs=1e-9)


def test_the_equivalent_euler_triple_is_no_error():
    values = np.array(swing().values)
    values[10:30, 6:9] = values[10:30, 6:9] * (1, -1, 1) + (180, 180, -180)
    for pair in [(Motion(arm(), values, 1 / 60), swing()), (swing(), Motion(arm(), values, 1 / 60))]:
        assert compare(*pair).max_error_degrees == pytest.approx(0, abs=1e-9)


def test_the_first_of_the_two_is_written_like_the_second():
    values = np.array(swing().values)
    values[20:, 4] += 360
    first, second = side_by_side(Motion(arm(), values, 1 / 60), swing())
    assert np.allclose(first.values, second.values)


def test_another_frame_rate_is_compared_at_the_frames_of_the_first():
    keyed = every_frame_a_key(swing(61))
    half_rate = keyed.sample(1 / 30)
    report = compare(half_rate, keyed)
    assert report.frames == 31
    assert report.max_error_degrees < 1e-9
    assert report.keys == 61 * 9
    assert compare(swing(61), half_rate).max_error_degrees < 1.0


def test_a_clip_that_lasts_shorter_is_compared_as_far_as_it_goes_with_a_warning():
    with pytest.warns(UserWarning, match=r"the clips last 0\.983 s and 0\.650 s: the first 40 frames are compared"):
        report = compare(swing(60), swing(60)[:40])
    assert report.max_error_world == 0


def test_a_clip_without_frames_is_compared_with_itself():
    report = compare(swing(60)[:0], swing(60)[:0])
    assert (report.keys, report.samples, report.max_error_world, report.ratio) == (0, 0, 0, 0)
    assert "0 for 0 samples" in str(report)


def test_another_rotation_order_is_compared_in_space_with_a_warning():
    other = arm(channels=(PLACES + TURNS, TURNS[::-1], ()))
    still = replace(swing(), values=np.zeros((60, 9)))
    with pytest.warns(
        UserWarning, match=r"number 7 is 'Elbow\.Zrotation' in the first, 'Elbow\.Xrotation' in the second"
    ):
        report = compare(still, replace(still, skeleton=other))
    assert report.max_error_world == 0
    assert report.max_error_degrees is None
    assert report.channels == ()
    json.dumps(report.to_json())
    assert "degrees" not in str(report)


def test_a_different_skeleton_is_refused_with_the_first_difference():
    renamed = arm(names=("Root", "Knee", "Elbow_End"))
    with pytest.raises(Mismatch, match=r"number 2 is 'Elbow' in the first, 'Knee' in the second"):
        compare(swing(), swing(skeleton=renamed))
    with pytest.raises(Mismatch, match=r"'Elbow_End' hangs on 'Elbow' in the first, on 'Root' in the second"):
        compare(swing(), swing(skeleton=arm(parents=[-1, 0, 0])))
    shorter = Skeleton(("Root", "Elbow"), [-1, 0], [[0, 0, 0], [10, 0, 0]], (PLACES + TURNS, TURNS))
    with pytest.raises(Mismatch, match="only the first has 'Elbow_End'"):
        compare(swing(), swing(skeleton=shorter))
    with pytest.raises(Mismatch, match=r"the length units differ: 0\.01 m in the first, 0\.001 m in the second"):
        compare(swing(skeleton=arm(unit=0.01)), swing(skeleton=arm(unit=0.001)))


def made():
    report = compare(swing(skeleton=arm(unit=0.01)), moved(swing(), 6, 2.0))
    settings = {"lower_bound": 400, "seconds": 1.25, "tolerance": "2mm", "method": "optimal", "align": "channel"}
    channels = tuple(replace(row, lower_bound=44, tolerance=2.5) for row in report.channels)
    return replace(report, quality="best", channels=channels, **settings)


def test_the_json_has_the_promised_keys_and_reads_back_the_same():
    data = json.loads(json.dumps(made().to_json()))
    promised = "keys samples ratio lower_bound over_bound max_error_degrees max_error_length max_error_world seconds"
    assert set(promised.split()) <= set(data)
    assert data["over_bound"] == pytest.approx(540 / 400)
    assert Report.from_json(data) == made()
    assert Report.from_json({**data, "something_newer": 1}) == made()


def test_the_sentence_and_the_table_say_every_number_with_its_unit():
    assert made().sentence() == (
        "540 keys for 540 samples (1 for 1.0), 1.35x the proven least; at most 2 degrees and 0.349 units (3.49 mm) off"
    )
    table = str(made())
    for piece in (
        "tolerance 2mm",
        "1.25 s",
        "1.35x",
        "max 2 degrees",
        "0.349 units (3.49 mm)",
        "Elbow.Zrotation",
        "Elbow_End",
    ):
        assert piece in table
    assert len(table.splitlines()) < 20


def test_a_unit_that_nobody_said_is_guessed_and_called_a_guess():
    tall = arm(offsets=[[0, 0, 0], [800, 0, 0], [900, 0, 0]])
    report = compare(swing(skeleton=tall), moved(swing(skeleton=tall), 1, 2.5))
    assert report.unit is None
    assert report.unit_guess == 0.001
    assert "2.5 units (about 2.5 mm) off" in report.sentence()
    flat = swing(skeleton=arm(offsets=np.zeros((3, 3))))
    assert compare(flat, flat).unit_guess is None


def test_what_the_keys_know_of_their_making_is_kept():
    keyed = replace(every_frame_a_key(swing()), report=made())
    report = compare(swing(), keyed)
    assert (report.lower_bound, report.seconds, report.tolerance, report.quality) == (400, 1.25, "2mm", "best")
    assert report.channels[0].lower_bound == 44
    assert report.max_error_degrees < 1e-9


def test_rows_say_what_they_are():
    report = compare(swing(), swing())
    assert report.channels[3] == ChannelError("Root.Zrotation", "degrees", 60, 0.0, 0.0)
    assert report.joints[2] == JointError("Elbow_End", 0.0, 0.0)


def test_equal_clips_are_compared_without_a_warning():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        compare(swing(), every_frame_a_key(swing()))
