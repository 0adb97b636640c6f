"""follow: its own path laid back changes nothing, a path moved as a whole moves the motion so, and it can be undone."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path as File
from typing import Any

import numpy as np
import pytest
from turning import heading
from walks import BODY, PERIOD, STEP, walk

import mocurve as mc
from mocurve import Mismatch, OptionError, UnknownName, planar
from mocurve.kinematics import world
from mocurve.path import Path
from mocurve.path_fit import gone

MOVED = np.array([2.0, 130.0, -70.0])
MODES = ["arclength", "time", "scaled", "span"]
FITS: dict[str, dict[str, Any]] = {
    "usual": {},
    "smooth": {"points": 9, "degree": 4, "track": "smooth"},
    "feet": {"track": "support"},
    "heights": {"height": True},
    "polynomial": {"kind": "polynomial", "degree": 12},
}


def walking(cycles: float = 4, turn: float = 0.3) -> mc.Motion:
    return walk(round(cycles * PERIOD), turn)


def off(a: mc.Motion, b: mc.Motion) -> float:
    """How far a joint of one is from that of the other, at most."""
    return float(np.abs(world(a) - world(b)).max())


def table(made: mc.Motion) -> dict[str, np.ndarray]:
    return {name: np.array(row) for name, row in made.history[-1]["table"].items()}


def measured(made: mc.Motion) -> dict[str, Any]:
    return made.history[-1]["measured"]


def bent(path: Path, by: float = 25.0, seed: int = 0) -> Path:
    """The same with its control points moved over the ground."""
    away = np.random.default_rng(seed).normal(0, by, path.points.shape)
    if path.points.shape[1] == 3:
        away[:, 1] = 0
    return replace(path, points=path.points + away)


def edges(motion: mc.Motion) -> float:
    """How far a joint is at most from where it was going."""
    return float(np.linalg.norm(np.diff(world(motion), 2, axis=0), axis=-1).max())


# -- laws ----------------------------------------------------------------------------------------
@pytest.mark.parametrize("fit", FITS)
@pytest.mark.parametrize("mode", MODES)
def test_the_own_path_laid_back_changes_nothing(fit: str, mode: str) -> None:
    if (fit, mode) == ("polynomial", "span"):
        pytest.skip("a polynomial has no spans")
    clip = walking()
    made = mc.follow(clip, Path.of(clip, **FITS[fit]), mode=mode)
    assert made.values.tobytes() == clip.values.tobytes()
    assert measured(made)["first"] is None


@pytest.mark.parametrize("fit", FITS)
@pytest.mark.parametrize("mode", MODES)
def test_a_path_moved_as_a_whole_moves_the_motion_so(fit: str, mode: str) -> None:
    if (fit, mode) == ("polynomial", "span"):
        pytest.skip("a polynomial has no spans")
    clip = walking()
    made = mc.follow(clip, Path.of(clip, **FITS[fit]).moved(MOVED), mode=mode)
    np.testing.assert_allclose(world(made), planar.move(MOVED, world(clip)), atol=1e-9)


@pytest.mark.parametrize("mode", MODES)
def test_the_way_back_restores_the_motion(mode: str) -> None:
    clip = walking()
    path = Path.of(clip)
    there = mc.follow(clip, bent(path, 8.0), mode=mode)
    assert off(there, clip) > 5
    assert off(mc.follow(there, path, mode=mode), clip) < 1e-9


def test_every_frame_stays_as_far_along_the_path_as_it_was() -> None:
    clip = walking()
    own, new = Path.of(clip), bent(Path.of(clip))
    along = table(mc.follow(clip, new))["distance"]
    np.testing.assert_allclose(along, own.table().distance(gone(clip)), atol=1e-9)


def test_the_root_is_beside_the_new_path_as_it_was_beside_the_old_one() -> None:
    clip = walking()
    own, new = Path.of(clip), mc.Path([(0, 0), (300, 100), (300, 400), (0, 500)])
    made = mc.follow(clip, new)
    away = np.linalg.norm(made.values[:, [0, 2]] - new.at(table(made)["distance"])[0], axis=1)
    np.testing.assert_allclose(away, own.residuals(clip), atol=1e-9)
    turned = np.diff(heading(made) - heading(clip))
    assert np.abs(turned).max() < 2  # degrees a frame: it turns smoothly


def test_only_the_root_is_changed() -> None:
    clip = walking()
    made = mc.follow(clip, bent(Path.of(clip)))
    others = clip.skeleton.channel_joints > 0
    assert made.values[:, others].tobytes() == clip.values[:, others].tobytes()
    assert np.abs(np.diff(made.values, axis=0)).max() < 90  # degrees: channels do not wrap


# -- modes ---------------------------------------------------------------------------------------
def test_scaled_fills_the_path_and_time_keeps_the_parameter() -> None:
    clip = walking()
    own, new = Path.of(clip), mc.Path([(0, 0), (0, 400), (300, 900), (800, 900)])
    scaled, timed = (table(mc.follow(clip, new, mode=mode))["distance"] for mode in ("scaled", "time"))
    assert scaled[-1] == pytest.approx(new.length)
    lengths = own.table().distance(gone(clip))
    np.testing.assert_allclose(scaled, lengths * new.length / own.length, atol=1e-9)
    np.testing.assert_allclose(timed, new.table().distance(gone(clip)), atol=1e-6)


def spanned(by: tuple[float, float], points: int = 14) -> tuple[mc.Motion, mc.Motion, Path]:
    """A walk, the same with the sixth control point of its path moved, and its path."""
    clip = walking(10)
    path = Path.of(clip, points=points)
    moved = np.array(path.points)
    moved[5] += by
    return clip, mc.follow(clip, replace(path, points=moved), mode="span"), path


def test_outside_of_an_edited_span_not_a_digit_changes() -> None:
    clip, made, path = spanned((15, 5))
    first, last = measured(made)["first"], measured(made)["last"]
    touched = np.searchsorted(gone(clip), [path.knots[5], path.knots[9]])  # four spans of a cubic
    assert touched[0] <= first < last <= touched[1]
    assert made.frames == clip.frames
    assert made.values[:first].tobytes() == clip.values[:first].tobytes()
    assert made.values[last + 1 :].tobytes() == clip.values[last + 1 :].tobytes()
    assert edges(made) < 1.3 * edges(clip)
    assert off(mc.follow(made, path, mode="span"), clip) < 1e-9


def test_a_span_much_longer_takes_more_time_and_that_is_said() -> None:
    with pytest.warns(UserWarning, match=r"strides 1\.\d+ times as long, beyond 0.6 to 1.15: the rest goes into time"):
        clip, made, _ = spanned((300, 0))
    told = measured(made)
    assert told["stride"] == pytest.approx(1.15 * told["slower"])
    more = made.frames - clip.frames
    assert more > 10
    first, last = told["first"], told["last"]
    assert made.values[:first].tobytes() == clip.values[:first].tobytes()
    assert made.values[last + 1 :].tobytes() == clip.values[last + 1 - more :].tobytes()
    steps = np.diff(table(made)["distance"])
    usual = np.diff(Path.of(clip, points=14).table().distance(gone(clip)))
    assert steps.max() < 1.2 * usual.max()


def test_a_span_at_either_end_and_none_at_all() -> None:
    clip = walking(10)
    path = Path.of(clip, points=14)
    for place in (0, 13):
        points = np.array(path.points)
        points[place] += (20, 10)
        made = mc.follow(clip, replace(path, points=points), mode="span")
        same = (made.values == clip.values).all(axis=1)
        assert same[-1] == (place == 0)
        assert same[0] == (place == 13)
        assert 0.5 < same.mean() < 0.95


# -- ends ----------------------------------------------------------------------------------------
SHORT = [(0, 0), (100, 50), (100, 250)]
LONG = [(0, 0), (500, 0), (500, 700), (1500, 800), (1500, 0)]


@pytest.mark.parametrize("at_end", ["extend", "truncate", "stop", "reset", "scale"])
def test_where_the_path_is_long_enough_all_ends_are_alike(at_end: str) -> None:
    clip = walking()
    plain, made = mc.follow(clip, mc.Path(LONG)), mc.follow(clip, mc.Path(LONG), at_end=at_end)
    assert made.values.tobytes() == plain.values.tobytes()
    assert measured(made)["cycles"] == 1


def test_extend_goes_straight_on() -> None:
    clip, path = walking(), mc.Path(SHORT)
    made = mc.follow(clip, path)
    assert made.frames == clip.frames
    assert measured(made)["beyond"] == pytest.approx(table(made)["distance"][-1] - path.length)
    assert edges(made) < 1.3 * edges(clip)


def test_truncate_ends_with_the_path() -> None:
    clip, path = walking(), mc.Path(SHORT)
    made = mc.follow(clip, path, at_end="truncate")
    step = np.diff(table(made)["distance"]).max()
    assert path.length - step <= table(made)["distance"][-1] <= path.length * (1 + 1e-9)
    assert made.values.tobytes() != clip.values[: made.frames].tobytes()
    assert measured(made)["frames"] == made.frames


def test_stop_comes_to_rest_at_the_end_of_the_path() -> None:
    clip, path = walking(), mc.Path(SHORT)
    made = mc.follow(clip, path, at_end="stop")
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
    made = mc.follow(clip, path, at_end="reset")
    rows = table(made)
    assert made.frames == clip.frames
    assert rows["distance"].max() <= path.length * (1 + 1e-9)
    again = int(np.argmax(rows["cycle"] == 1))
    assert rows["frame"][again] == 0
    assert rows["distance"][again] == 0
    np.testing.assert_allclose(world(made)[again], world(made)[0], atol=1e-2)


def test_scale_shortens_strides_to_fit() -> None:
    clip, path = walking(), mc.Path(SHORT)
    made = mc.follow(clip, path, at_end="scale")
    assert table(made)["distance"][-1] == pytest.approx(path.length)
    assert made.values.tobytes() == mc.follow(clip, path, mode="scaled").values.tobytes()


def test_a_cycle_fills_the_path_without_a_seam() -> None:
    clip, path = walking(4), mc.Path(LONG)
    made = mc.follow(clip, path, at_end="cycle")
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
    made = mc.follow(loop, mc.Path(LONG), at_end="cycle")
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
    facing, tangent = (mc.follow(clip, bend, heading=way) for way in ("facing", "tangent"))
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
        assert mc.follow(clip, path, heading="facing").values.tobytes() == clip.values.tobytes()
        moved = mc.follow(clip, path.moved(MOVED), heading="facing")
        np.testing.assert_allclose(world(moved), planar.move(MOVED, world(clip)), atol=1e-9)


def test_a_body_that_pauses_keeps_its_heading_while_it_does() -> None:
    ahead = walk(2 * PERIOD)
    clip = replace(ahead, values=np.vstack([ahead.values, np.repeat(ahead.values[-1:], 200, 0)]))
    made = mc.follow(clip, mc.Path([(0, 0), (0, 100), (100, 250), (300, 250), (600, 250)]))
    turned = heading(made) - heading(clip)
    assert np.ptp(turned[-150:]) < 5
    assert np.ptp(turned) > 30


# -- heights -------------------------------------------------------------------------------------
def test_on_a_slope_the_body_is_lifted_and_stays_upright() -> None:
    clip = walking()
    own = Path.of(clip)
    ramp = np.insert(own.points, 1, np.linspace(0, 100, len(own.points)), axis=1)
    hill = mc.Path(ramp)
    made = mc.follow(clip, hill, of=own)
    up = world(made)[..., 1] - world(clip)[..., 1]
    np.testing.assert_allclose(up, np.broadcast_to(up[:, :1], up.shape), atol=1e-9)
    np.testing.assert_allclose(up[:, 0], hill.at(table(made)["distance"])[0][:, 1], atol=1e-9)
    leaning = mc.follow(clip, hill, of=own, posture="tangent")
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
    made = mc.follow(clip, mc.Path([(0, 0, 0), (0, 0, 100), (0, 200, 100), (0, 200, 900)], degree=1))
    assert np.isfinite(made.values).all()
    assert np.ptp(made.values[:, 1]) == pytest.approx(200, abs=10)


# -- kinds of clips and histories ----------------------------------------------------------------
def test_a_step_can_be_run_again_from_its_history() -> None:
    clip = walking()
    path = bent(Path.of(clip, points=9, track="smooth"))
    made = mc.follow(clip, path, at_end="stop", of=Path.of(clip))
    step = json.loads(json.dumps(made.history[-1]))
    options = {name: step[name] for name in ("mode", "at_end", "heading", "posture", "of")}
    assert step["verb"] == "follow"
    assert mc.follow(clip, step["path"], **options).values.tobytes() == made.values.tobytes()


def test_points_alone_are_a_path() -> None:
    clip = walking()
    assert mc.follow(clip, SHORT).values.tobytes() == mc.follow(clip, mc.Path(SHORT)).values.tobytes()


def test_keys_and_splines_become_samples_and_that_is_said() -> None:
    clip = walking(2)
    keys, spline = mc.reduce(clip, tolerance="5deg"), mc.fit(clip, tolerance="5deg")
    for curves in (keys, spline):
        with pytest.warns(UserWarning, match="become samples: a body is moved along a path frame by frame"):
            made = mc.follow(curves, mc.Path(SHORT))
        assert made.values.tobytes() == mc.follow(curves.sample(), mc.Path(SHORT)).values.tobytes()


def test_a_clip_that_goes_nowhere_stands_where_the_path_begins() -> None:
    clip = walk(60)
    standing = replace(clip, values=np.repeat(clip.values[:1], 60, axis=0))
    with pytest.warns(UserWarning, match="the clip goes nowhere: it is put where the path begins"):
        made = mc.follow(standing, mc.Path([(50, 60), (300, 60)]))
    shift = np.array([50, 0, 60]) - standing.values[0, :3] * [1, 0, 1]
    np.testing.assert_allclose(world(made), world(standing) + shift, atol=1e-9)
    assert mc.follow(standing, Path.of(standing)).values.tobytes() == standing.values.tobytes()


def test_a_body_that_sways_on_the_spot_is_not_spun() -> None:
    clip = walk(600)
    values = np.repeat(clip.values[:1], 600, axis=0)
    values[:, [0, 2]] += np.random.default_rng(3).normal(0, 0.02, (600, 2)).cumsum(axis=0)
    made = mc.follow(replace(clip, values=values), mc.Path([(0, 0), (300, 300)]))
    assert np.ptp(heading(made)) < 1


def test_a_path_without_length_is_a_place_to_stand() -> None:
    clip = walking()
    made = mc.follow(clip, mc.Path([(5, 5), (5, 5)]), mode="scaled")
    assert np.isfinite(made.values).all()
    assert np.ptp(made.values[:, [0, 2]], axis=0).max() < 60


@pytest.mark.parametrize("frames", [1, 2, 3])
def test_few_frames(frames: int) -> None:
    clip = walk(frames)
    made = mc.follow(clip, Path.of(clip)) if frames > 1 else mc.follow(clip, mc.Path([(0, 0), (0, 0)]))
    assert made.frames == frames
    assert np.isfinite(made.values).all()


def test_markers_follow_too() -> None:
    clip = walking(2)
    places = world(clip)[:, :4]
    names, kinds = ("A", "B", "C", "D"), ("Xposition", "Yposition", "Zposition")
    markers = mc.Motion(
        mc.Skeleton(names, np.full(4, -1), np.zeros((4, 3)), (kinds,) * 4), places.reshape(len(places), -1), STEP
    )
    made = mc.follow(markers, Path.of(markers).moved(MOVED))
    np.testing.assert_allclose(world(made), planar.move(MOVED, places), atol=1e-9)


# -- refusals ------------------------------------------------------------------------------------
@pytest.mark.parametrize(
    ("error", "path", "options", "told"),
    [
        (UnknownName, SHORT, {"mode": "arclen"}, "Did you mean 'arclength'?"),
        (UnknownName, SHORT, {"at_end": "cicle"}, "Did you mean 'cycle'?"),
        (UnknownName, SHORT, {"heading": "tangnt"}, "Did you mean 'tangent'?"),
        (UnknownName, SHORT, {"posture": "up"}, "There is: upright, tangent"),
        (OptionError, SHORT, {"mode": "time", "at_end": "stop"}, "at_end stop is for mode arclength"),
        (OptionError, SHORT, {"mode": "time", "heading": "facing"}, "heading facing is for mode arclength"),
        (OptionError, SHORT, {"at_end": "cycle", "of": mc.Path(LONG)}, "leave `of` out"),
        (OptionError, [(0, 0)], {}, "a path has 2 to 100000 points"),
        (OptionError, [(0, 0), (0, np.nan)], {}, "point 2 of the path"),
        (OptionError, {"points": "none"}, {}, 'a path is {"points"'),
        (OptionError, 5, {}, "two columns"),
        (Mismatch, SHORT, {"mode": "span"}, "mode span takes a path that is an edit of the clip's own"),
    ],
)
def test_what_does_not_fit_is_refused(error: type[Exception], path: Any, options: dict, told: str) -> None:
    with pytest.raises(error) as raised:
        mc.follow(walking(), path, **options)
    assert told in str(raised.value)


def test_gaps_and_empty_clips_are_refused() -> None:
    clip = walking()
    values = np.array(clip.values, order="F")
    values[3, 9] = np.nan
    with pytest.raises(Mismatch, match="has no value at frame 3"):
        mc.follow(replace(clip, values=values), SHORT)
    with pytest.raises(Mismatch, match="a clip without frames follows no path"):
        mc.follow(clip[:0], SHORT)


def test_a_root_that_cannot_turn_is_refused_and_one_that_goes_straight_is_not() -> None:
    kinds = (("Xposition", "Yposition", "Zposition"), *BODY.channels[1:])
    clip = walking()
    kept = np.delete(np.arange(clip.values.shape[1]), [3, 4, 5])
    stiff = mc.Motion(replace(BODY, channels=kinds), clip.values[:, kept], STEP)
    assert mc.follow(stiff, Path.of(stiff)).values.tobytes() == stiff.values.tobytes()
    with pytest.raises(Mismatch, match="'Hips'"):
        mc.follow(stiff, SHORT)


def test_paths_too_long_to_be_filled_are_refused() -> None:
    with pytest.raises(OptionError, match="the clip would have to be repeated"):
        mc.follow(walking(), mc.Path([(0, 0), (0, 1e9)]), at_end="cycle")


def test_a_body_that_stands_along_z_is_told() -> None:
    clip = walking()
    turned = replace(clip.skeleton, offsets=clip.skeleton.offsets[:, [0, 2, 1]])
    lying = replace(clip, skeleton=turned, values=np.where(clip.skeleton.rotation_channels, 0.0, clip.values))
    with pytest.warns(UserWarning, match="the body seems to stand along z: a path lies on the ground x, z"):
        mc.follow(lying, SHORT)


# -- promises on captures ------------------------------------------------------------------------
@pytest.fixture(scope="module")
def captured(clips: File) -> Callable[[str], mc.Motion]:
    def load(name: str) -> mc.Motion:
        clip = mc.read(clips / "cmu" / f"cmu_{name}.bvh")
        assert isinstance(clip, mc.Motion)
        return clip

    return load


@pytest.mark.parametrize("name", ["12_01_walk", "02_01_walk_blender"])
def test_captured_walks_keep_their_laws(name: str, captured: Callable[[str], mc.Motion]) -> None:
    clip = captured(name)
    path = Path.of(clip)
    assert mc.follow(clip, path).values.tobytes() == clip.values.tobytes()
    moved = mc.follow(clip, path.moved(MOVED))
    np.testing.assert_allclose(world(moved), planar.move(MOVED, world(clip)), atol=1e-9)
    there = mc.follow(clip, bent(path, 3.0))
    assert off(mc.follow(there, path), clip) < 1e-9


def test_a_t_pose_in_front_stays_in_front_and_is_no_part_of_a_cycle(captured: Callable[[str], mc.Motion]) -> None:
    clip = captured("12_01_walk")
    made = mc.follow(clip, mc.Path([(0, 0), (30, 30), (30, 60)]))
    turned = made.skeleton.rotation_channels & (made.skeleton.channel_joints > 0)
    assert made.values[0, turned].tobytes() == clip.values[0, turned].tobytes()
    assert table(made)["frame"][:3].tolist() == [0, 1, 2]
    cycled = mc.follow(clip, mc.Path([(0, 0), (100, 100), (100, 400)]), at_end="cycle")
    assert table(cycled)["frame"].min() > 1
    assert edges(cycled) < 1.1 * edges(clip[1:])


@pytest.mark.parametrize("name", ["12_01_walk", "02_01_walk_blender"])
def test_on_bends_of_a_metre_bodies_turn_without_a_jerk(name: str, captured: Callable[[str], mc.Motion]) -> None:
    clip = captured(name)[1:]
    around = np.linspace(0, 4, 24)
    bend = mc.Path(100 / 5.6444 * np.stack([1 - np.cos(around), np.sin(around)], axis=1))
    made = mc.follow(clip, bend)
    assert edges(made) < 1.1 * edges(clip)
    assert 100 < measured(made)["turned"] < 360
