"""follow: where paths end, where bodies pause or back up, heights, other kinds of clips, and what is refused."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path as File
from typing import Any

import numpy as np
import pytest
from paths import LONG, MOVED, SHORT, bent, edges, laid, measured, table, walking
from turning import heading
from walks import BODY, PERIOD, STEP, walk

import mocurve as mc
from mocurve import Mismatch, OptionError, UnknownName, planar
from mocurve.kinematics import world
from mocurve.path import Path

ROWS = [list(point) for point in SHORT]


# -- ends ----------------------------------------------------------------------------------------
@pytest.mark.parametrize("at_end", ["extend", "truncate", "stop", "reset", "scale"])
def test_where_the_path_is_long_enough_all_ends_are_alike(at_end: str) -> None:
    clip = walking()
    plain, made = laid(clip, mc.Path(LONG)), laid(clip, mc.Path(LONG), at_end=at_end)
    assert made.values.tobytes() == plain.values.tobytes()
    assert measured(made)["cycles"] == 1


def test_extend_goes_straight_on() -> None:
    clip, path = walking(), mc.Path(SHORT)
    made = laid(clip, path)
    assert made.frames == clip.frames
    assert measured(made)["beyond"] == pytest.approx(table(made)["distance"][-1] - path.length)
    assert edges(made) < 1.3 * edges(clip)


def test_truncate_ends_with_the_path() -> None:
    clip, path = walking(), mc.Path(SHORT)
    made = laid(clip, path, at_end="truncate")
    step = np.diff(table(made)["distance"]).max()
    assert path.length - step <= table(made)["distance"][-1] <= path.length * (1 + 1e-9)
    assert made.values.tobytes() != clip.values[: made.frames].tobytes()
    assert measured(made)["frames"] == made.frames


def test_stop_comes_to_rest_at_the_end_of_the_path() -> None:
    clip, path = walking(), mc.Path(SHORT)
    made = laid(clip, path, at_end="stop")
    rows = table(made)
    assert made.frames == clip.frames
    assert rows["distance"][-1] == pytest.approx(path.length, abs=0.01)
    still = np.flatnonzero(np.diff(rows["frame"]) == 0)
    assert len(still) > 10
    assert np.abs(world(made)[still[0] :] - world(made)[-1]).max() < 0.3  # what is left of the turn settles too
    assert np.abs(world(made)[still[0] + 60 :] - world(made)[-1]).max() < 0.03
    assert (np.diff(rows["frame"]) >= 0).all()
    assert np.abs(np.diff(rows["frame"], 2)).max() < 0.1  # time slows down evenly
    assert edges(made) < 1.5 * edges(clip)


def test_reset_begins_again() -> None:
    clip, path = walking(), mc.Path(SHORT)
    made = laid(clip, path, at_end="reset")
    rows = table(made)
    assert made.frames == clip.frames
    assert rows["distance"].max() <= path.length * (1 + 1e-9)
    again = int(np.argmax(rows["cycle"] == 1))
    assert rows["frame"][again] == 0
    assert rows["distance"][again] == 0
    np.testing.assert_allclose(world(made)[again], world(made)[0], atol=1e-2)


def test_scale_shortens_strides_to_fit() -> None:
    clip = walking()
    path = mc.Path([(0, 0), (0, 0.7 * Path.of(clip).length)])
    made = laid(clip, path, at_end="scale")
    assert table(made)["distance"][-1] == pytest.approx(path.length)
    assert made.frames == clip.frames
    assert measured(made)["stride"] == pytest.approx(0.7)
    assert made.values.tobytes() == laid(clip, path, mode="scaled").values.tobytes()


def test_a_cycle_fills_the_path_without_a_seam() -> None:
    clip, path = walking(4), mc.Path(LONG)
    made = laid(clip, path, at_end="cycle")
    rows = table(made)
    assert path.length - 3 <= rows["distance"][-1] <= path.length * (1 + 1e-9)
    assert measured(made)["cycles"] > 10
    assert edges(made) < 1.3 * edges(clip)
    first = rows["frame"].min()
    assert rows["frame"].max() - first == PERIOD - 1
    assert rows["cycle"][PERIOD] == 1
    shown = made.values[:, made.skeleton.channel_joints > 0]
    there = clip.values[rows["frame"].astype(int)][:, made.skeleton.channel_joints > 0]
    assert np.abs(shown - there).max() < 0.1  # the walk is exactly periodic


def test_one_loop_is_repeated_whole() -> None:
    loop = mc.loop(walking(4))
    made = laid(loop, mc.Path(LONG), at_end="cycle")
    assert np.ptp(table(made)["frame"]) == loop.frames - 2
    assert table(made)["frame"].min() == 0


# -- headings ------------------------------------------------------------------------------------
def there_and_back() -> mc.Motion:
    ahead = walk(4 * PERIOD)
    return replace(ahead, values=np.vstack([ahead.values, np.repeat(ahead.values[-1:], 20, 0), ahead.values[::-1]]))


def test_who_backs_up_goes_back_along_the_path_or_turns_about() -> None:
    clip = there_and_back()
    quarter = np.linspace(0, 2.5, 12)
    bend = mc.Path(np.stack([300 - 300 * np.cos(quarter), 300 * np.sin(quarter)], axis=1))
    facing, tangent = (laid(clip, bend, heading=way) for way in ("facing", "tangent"))
    along = table(facing)["distance"]
    assert along.max() == pytest.approx(0.5 * Path.of(clip).length, rel=0.02)
    assert along[-1] < 2
    np.testing.assert_allclose(world(facing)[-1], world(facing)[0], atol=3)
    assert np.abs(np.diff(heading(facing))).max() < 4
    assert np.abs(np.diff(heading(tangent) - heading(clip))).max() < 10  # it turns about, but does not flip
    assert table(tangent)["distance"][-1] == pytest.approx(Path.of(clip).length)


def test_backing_up_on_the_own_path_changes_nothing() -> None:
    clip = there_and_back()
    for points in (None, 5, 12):
        path = Path.of(clip, points=points)
        assert laid(clip, path, heading="facing").values.tobytes() == clip.values.tobytes()
        moved = laid(clip, path.moved(MOVED), heading="facing")
        np.testing.assert_allclose(world(moved), planar.move(MOVED, world(clip)), atol=1e-9)


def test_a_body_that_pauses_keeps_its_heading_while_it_does() -> None:
    ahead = walk(2 * PERIOD)
    clip = replace(ahead, values=np.vstack([ahead.values, np.repeat(ahead.values[-1:], 200, 0)]))
    made = laid(clip, mc.Path([(0, 0), (0, 100), (100, 250), (300, 250), (600, 250)]))
    turned = heading(made) - heading(clip)
    assert np.ptp(turned[-150:]) < 5
    assert np.ptp(turned) > 30


# -- heights -------------------------------------------------------------------------------------
def test_on_a_slope_the_body_is_lifted_and_stays_upright() -> None:
    clip = walking()
    own = Path.of(clip)
    ramp = np.insert(own.points, 1, np.linspace(0, 100, len(own.points)), axis=1)
    hill = mc.Path(ramp)
    made = laid(clip, hill, of=own)
    up = world(made)[..., 1] - world(clip)[..., 1]
    np.testing.assert_allclose(up, np.broadcast_to(up[:, :1], up.shape), atol=1e-9)
    np.testing.assert_allclose(up[:, 0], hill.at(table(made)["distance"])[0][:, 1], atol=1e-9)
    leaning = laid(clip, hill, of=own, posture="tangent")
    over = world(leaning)[:, 5] - world(leaning)[:, 0]  # head over hips
    upright = world(made)[:, 5] - world(made)[:, 0]
    angle = np.degrees(
        np.arccos((over * upright).sum(1) / np.linalg.norm(over, axis=1) / np.linalg.norm(upright, axis=1))
    )
    slope = np.degrees(np.arctan2(100, own.length))
    assert np.median(angle) == pytest.approx(slope, rel=0.15)
    flat = hill.at(table(made)["distance"])[1]
    ahead = np.stack([np.sin(flat), np.cos(flat)], axis=1)
    assert ((over - upright)[:, [0, 2]] * ahead).sum(1).max() < 0  # back, uphill


def test_a_path_straight_up_is_followed() -> None:
    clip = walking()
    made = laid(clip, mc.Path([(0, 0, 0), (0, 0, 100), (0, 200, 100), (0, 200, 900)], degree=1))
    assert np.isfinite(made.values).all()
    assert np.ptp(made.values[:, 1]) == pytest.approx(200, abs=10)


# -- kinds of clips and histories ----------------------------------------------------------------
def test_a_step_can_be_run_again_from_its_history() -> None:
    clip = walking()
    path = bent(Path.of(clip, points=9, track="smooth"))
    made = laid(clip, path, at_end="stop", of=Path.of(clip))
    step = json.loads(json.dumps(made.history[-1]))
    options = {name: step[name] for name in ("mode", "at_end", "heading", "posture", "of", "lock_feet")}
    assert step["verb"] == "follow"
    assert mc.follow(clip, step["path"], **options).values.tobytes() == made.values.tobytes()


def test_points_alone_are_a_path() -> None:
    clip = walking()
    assert laid(clip, SHORT).values.tobytes() == laid(clip, mc.Path(SHORT)).values.tobytes()


def test_keys_and_splines_become_samples_and_that_is_said() -> None:
    clip = walking(2)
    keys, spline = mc.reduce(clip, tolerance="5deg"), mc.fit(clip, tolerance="5deg")
    for curves in (keys, spline):
        with pytest.warns(UserWarning, match="become samples: a body is moved along a path frame by frame"):
            made = laid(curves, mc.Path(SHORT))
        assert made.values.tobytes() == laid(curves.sample(), mc.Path(SHORT)).values.tobytes()


def test_a_clip_that_goes_nowhere_stands_where_the_path_begins() -> None:
    clip = walk(60)
    standing = replace(clip, values=np.repeat(clip.values[:1], 60, axis=0))
    with pytest.warns(UserWarning, match="the clip goes nowhere: it is put where the path begins"):
        made = laid(standing, mc.Path([(50, 60), (300, 60)]))
    shift = np.array([50, 0, 60]) - standing.values[0, :3] * [1, 0, 1]
    np.testing.assert_allclose(world(made), world(standing) + shift, atol=1e-9)


def test_a_body_that_sways_on_the_spot_is_not_spun() -> None:
    clip = walk(600)
    values = np.repeat(clip.values[:1], 600, axis=0)
    values[:, [0, 2]] += np.random.default_rng(3).normal(0, 0.02, (600, 2)).cumsum(axis=0)
    made = laid(replace(clip, values=values), mc.Path([(0, 0), (300, 300)]))
    assert np.ptp(heading(made)) < 1


@pytest.mark.parametrize("frames", [2, 3])
def test_few_frames(frames: int) -> None:
    clip = walk(frames)
    assert laid(clip, Path.of(clip)).values.tobytes() == clip.values.tobytes()
    made = laid(clip, SHORT)
    assert made.frames == frames
    assert np.isfinite(made.values).all()


def test_one_frame_stands_where_the_path_begins() -> None:
    with pytest.warns(UserWarning, match="the clip goes nowhere"):
        made = laid(walk(1), [(5, 7), (100, 7)])
    np.testing.assert_allclose(made.values[0, [0, 2]], [5, 7], atol=1e-9)


def test_markers_follow_too() -> None:
    clip = walking(2)
    places = world(clip)[:, :4]
    names, kinds = ("A", "B", "C", "D"), ("Xposition", "Yposition", "Zposition")
    markers = mc.Motion(
        mc.Skeleton(names, np.full(4, -1), np.zeros((4, 3)), (kinds,) * 4), places.reshape(len(places), -1), STEP
    )
    made = laid(markers, Path.of(markers).moved(MOVED))
    np.testing.assert_allclose(world(made), planar.move(MOVED, places), atol=1e-9)


# -- refusals ------------------------------------------------------------------------------------
@pytest.mark.parametrize(
    ("error", "path", "options", "told"),
    [
        (UnknownName, SHORT, {"mode": "arclen"}, "Did you mean 'arclength'?"),
        (UnknownName, SHORT, {"at_end": "cicle"}, "Did you mean 'cycle'?"),
        (UnknownName, SHORT, {"heading": "tangnt"}, "Did you mean 'tangent'?"),
        (UnknownName, SHORT, {"posture": "up"}, "There is: upright, lift, tangent"),
        (OptionError, SHORT, {"mode": "time", "at_end": "stop"}, "at_end stop is for modes arclength and paced"),
        (OptionError, SHORT, {"mode": "time", "heading": "facing"}, "heading facing is for modes arclength and paced"),
        (OptionError, SHORT, {"at_end": "cycle", "of": mc.Path(LONG)}, "leave `of` out"),
        (OptionError, {"points": ROWS, "degree": 5}, {}, "3 control points make a curve of degree 2 at most, not 5"),
        (OptionError, {"points": ROWS, "degree": 5, "kind": "polynomial"}, {}, "of degree 5 has 6 points, not 3"),
        (OptionError, [(5, 5), (5, 5)], {}, "all points are in one place: the path has no length"),
        (OptionError, [(5, 0, 5), (5, 9, 5)], {}, "the path goes straight up: it has no way over the ground"),
        (OptionError, [(0, 0)], {}, "a path has 2 to 100000 points"),
        (OptionError, [(0, 0), (0, np.nan)], {}, "point 2 of the path"),
        (OptionError, {"points": "none"}, {}, 'a path is {"points"'),
        (OptionError, 5, {}, "two columns"),
        (Mismatch, SHORT, {"mode": "span"}, "mode span takes a path that is an edit of the clip's own"),
    ],
)
def test_what_does_not_fit_is_refused(error: type[Exception], path: Any, options: dict, told: str) -> None:
    with pytest.raises(error) as raised:
        laid(walking(), path, **options)
    assert told in str(raised.value)


def test_gaps_and_empty_clips_are_refused() -> None:
    clip = walking()
    values = np.array(clip.values, order="F")
    values[3, 9] = np.nan
    with pytest.raises(Mismatch, match="has no value at frame 3"):
        laid(replace(clip, values=values), SHORT)
    with pytest.raises(Mismatch, match="a clip without frames follows no path"):
        laid(clip[:0], SHORT)


def test_a_root_that_cannot_turn_is_refused_and_one_that_goes_straight_is_not() -> None:
    kinds = (("Xposition", "Yposition", "Zposition"), *BODY.channels[1:])
    clip = walking()
    kept = np.delete(np.arange(clip.values.shape[1]), [3, 4, 5])
    stiff = mc.Motion(replace(BODY, channels=kinds), clip.values[:, kept], STEP)
    assert laid(stiff, Path.of(stiff)).values.tobytes() == stiff.values.tobytes()
    with pytest.raises(Mismatch, match="'Hips'"):
        laid(stiff, SHORT)


@pytest.mark.parametrize("options", [{"mode": "scaled"}, {"at_end": "cycle"}])
def test_paths_too_long_to_be_filled_are_refused(options: dict[str, str]) -> None:
    told = {"mode": r"the clip takes .* times its time, over 200000 frames", "at_end": "would have to be repeated"}
    for length in (1e7, 1e11):
        with pytest.raises(OptionError, match=told[next(iter(options))]):
            laid(walking(), mc.Path([(0, 0), (0, length)]), **options)


def test_a_span_that_takes_too_much_time_is_refused() -> None:
    clip = walking()
    path = Path.of(clip, points=8)
    points = np.array(path.points)
    points[4] += 1e7
    with pytest.raises(OptionError, match=r"the clip takes .* times its time, over 200000 frames"):
        laid(clip, replace(path, points=points), mode="span")


def test_on_a_path_however_long_a_clip_goes_as_it_would_on_a_short_one() -> None:
    clip = walking()
    short, long = (laid(clip, mc.Path([(0, 0), (length, 0)])) for length in (1e3, 1e11))
    np.testing.assert_allclose(world(long), world(short), atol=1e-3)


def test_a_path_stretch_straight_up_is_followed_and_that_in_a_file_is_told(tmp_path: File) -> None:
    points = [(0, 0, 0), (0, 0, 50), (0, 60, 50), (0, 120, 50), (0, 120, 300)]
    assert np.isfinite(laid(walking(), points).values).all()
    (tmp_path / "p.csv").write_text("\n".join(",".join(map(str, point)) for point in points))
    with pytest.warns(UserWarning, match=r"p\.csv:3: the point is straight above or below the one before it"):
        Path.read(tmp_path / "p.csv")


def test_a_body_that_stands_along_z_is_told() -> None:
    clip = walking()
    turned = replace(clip.skeleton, offsets=clip.skeleton.offsets[:, [0, 2, 1]])
    lying = replace(clip, skeleton=turned, values=np.where(clip.skeleton.rotation_channels, 0.0, clip.values))
    with pytest.warns(UserWarning, match="the body seems to stand along z: a path lies on the ground x, z"):
        laid(lying, SHORT)


def test_clips_of_odd_rates_and_sizes_are_followed_or_refused() -> None:
    clip = walking()
    path = Path([(0, 0), (50, 300)])
    for seconds in (1e-9, 1e-6, 1e3, 1e9):
        assert mc.follow(replace(clip, frame_time=seconds), path, lock_feet=False).frames == clip.frames
    with pytest.raises(Mismatch, match=r"the root is .*e\+30[01] units away at frame 0"):
        mc.follow(replace(clip, values=clip.values * 1e300 + 1e300), path)
