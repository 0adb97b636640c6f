"""follow: its own path laid back changes nothing, a path moved as a whole moves the motion so, and it can be undone."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from paths import FITS, MOVED, bent, edges, laid, measured, off, table, walking
from turning import heading

import mocurve as mc
from mocurve import planar
from mocurve.edit._locking import Source
from mocurve.edit.path_edit import PathEdit
from mocurve.feet.legs import legs
from mocurve.feet.skate import skate
from mocurve.kinematics import world
from mocurve.path import Path
from mocurve.path_fit import gone

MODES = ["arclength", "time", "scaled", "span"]
AROUND = np.linspace(0, 4, 24)
CASES = [(fit, mode) for fit in FITS for mode in MODES if (fit, mode) != ("polynomial", "span")]


# -- laws ----------------------------------------------------------------------------------------
@pytest.mark.parametrize(("fit", "mode"), CASES)
def test_the_own_path_laid_back_changes_nothing(fit: str, mode: str) -> None:
    clip = walking()
    made = laid(clip, Path.of(clip, **FITS[fit]), mode=mode)
    assert made.values.tobytes() == clip.values.tobytes()
    assert measured(made)["first"] is None


@pytest.mark.parametrize(("fit", "mode"), CASES)
def test_a_path_moved_as_a_whole_moves_the_motion_so(fit: str, mode: str) -> None:
    clip = walking()
    made = laid(clip, Path.of(clip, **FITS[fit]).moved(MOVED), mode=mode)
    np.testing.assert_allclose(world(made), planar.move(MOVED, world(clip)), atol=1e-9)


def test_every_frame_stays_as_far_along_the_path_as_it_was() -> None:
    clip = walking()
    own, new = Path.of(clip), bent(Path.of(clip))
    along = table(laid(clip, new))["distance"]
    np.testing.assert_allclose(along, own.table().distance(gone(clip)), atol=1e-9)


def test_the_root_is_beside_the_new_path_as_it_was_beside_the_old_one() -> None:
    clip = walking()
    own, new = Path.of(clip), mc.Path([(0, 0), (300, 100), (300, 400), (0, 500)])
    made = laid(clip, new)
    away = np.linalg.norm(made.values[:, [0, 2]] - new.at(table(made)["distance"])[0], axis=1)
    np.testing.assert_allclose(away, own.residuals(clip), atol=1e-9)
    turned = np.diff(heading(made) - heading(clip))
    assert np.abs(turned).max() < 2  # degrees a frame: it turns smoothly


def test_only_the_root_is_changed() -> None:
    clip = walking()
    made = laid(clip, bent(Path.of(clip)))
    others = clip.skeleton.channel_joints > 0
    assert made.values[:, others].tobytes() == clip.values[:, others].tobytes()
    assert np.abs(np.diff(made.values, axis=0)).max() < 90  # degrees: channels do not wrap


# -- modes ---------------------------------------------------------------------------------------
def test_scaled_fills_the_path_and_time_keeps_the_parameter() -> None:
    clip = walking()
    own = Path.of(clip)
    lengths = own.table().distance(gone(clip))
    new = mc.Path([(0, 0), (0, 1.1 * own.length)])
    scaled, timed = (table(laid(clip, new, mode=mode))["distance"] for mode in ("scaled", "time"))
    assert scaled[-1] == pytest.approx(new.length)
    np.testing.assert_allclose(scaled, lengths * new.length / own.length, atol=1e-9)
    np.testing.assert_allclose(timed, new.table().distance(gone(clip)), atol=1e-6)


@pytest.mark.parametrize(("times", "stride"), [(2.3, 1.15), (0.3, 0.6)])
def test_strides_that_nobody_takes_become_time(times: float, stride: float) -> None:
    clip = walking()
    own = Path.of(clip)
    with pytest.warns(UserWarning, match=r"beyond 0.6 to 1.15: the rest goes into time"):
        made = laid(clip, mc.Path([(0, 0), (0, times * own.length)]), mode="scaled")
    told = measured(made)
    assert told["stride"] == pytest.approx(times)
    assert told["slower"] == pytest.approx(times / stride)
    assert made.frames == pytest.approx(clip.frames * times / stride, abs=2)
    assert table(made)["frame"][[0, -1]].tolist() == [0, clip.frames - 1]
    usual, steps = np.diff(own.table().distance(gone(clip))), np.diff(table(made)["distance"])
    assert np.median(steps) == pytest.approx(stride * np.median(usual), rel=0.05)
    assert edges(made) < 1.5 * edges(clip) * max(1.0, stride / times) ** 2


def spanned(by: tuple[float, float], points: int = 14) -> tuple[mc.Motion, mc.Motion, Path]:
    """A walk, the same with the sixth control point of its path moved, and its path."""
    clip = walking(10)
    path = Path.of(clip, points=points)
    moved = np.array(path.points)
    moved[5] += by
    return clip, laid(clip, replace(path, points=moved), mode="span"), path


def test_outside_of_an_edited_span_not_a_digit_changes() -> None:
    clip, made, path = spanned((15, 5))
    first, last = measured(made)["first"], measured(made)["last"]
    touched = np.searchsorted(gone(clip), [path.knots[5], path.knots[9]])  # four spans of a cubic
    assert touched[0] <= first < last <= touched[1]
    assert made.frames == clip.frames
    assert made.values[:first].tobytes() == clip.values[:first].tobytes()
    assert made.values[last + 1 :].tobytes() == clip.values[last + 1 :].tobytes()
    assert edges(made) < 1.3 * edges(clip)
    assert off(laid(made, path, mode="span"), clip) < 1e-9


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
        made = laid(clip, replace(path, points=points), mode="span")
        same = (made.values == clip.values).all(axis=1)
        assert same[-1] == (place == 0)
        assert same[0] == (place == 13)
        assert 0.5 < same.mean() < 0.95


def test_bare_control_points_of_the_own_path_are_known() -> None:
    clip = walking()
    own = Path.of(clip, points=5)
    bare = own.points.tolist()
    np.testing.assert_allclose(laid(clip, bare).values, clip.values, atol=1e-9)
    moved = planar.move(MOVED, np.insert(own.points, 1, 0.0, axis=1))[:, [0, 2]].tolist()
    np.testing.assert_allclose(world(laid(clip, moved)), planar.move(MOVED, world(clip)), atol=1e-9)


# -- promises on captures ------------------------------------------------------------------------
@pytest.mark.parametrize("name", ["12_01_walk", "02_01_walk_blender"])
def test_captured_walks_keep_their_laws(name: str, captured: Callable[[str], mc.Motion]) -> None:
    clip = captured(name)
    path = Path.of(clip)
    assert laid(clip, path).values.tobytes() == clip.values.tobytes()
    moved = laid(clip, path.moved(MOVED))
    np.testing.assert_allclose(world(moved), planar.move(MOVED, world(clip)), atol=1e-9)
    there = laid(clip, bent(path, 3.0))
    assert off(laid(there, path), clip) < 1e-9


def test_a_t_pose_in_front_stays_in_front_and_is_no_part_of_a_cycle(captured: Callable[[str], mc.Motion]) -> None:
    clip = captured("12_01_walk")
    made = laid(clip, mc.Path([(0, 0), (30, 30), (30, 60)]))
    turned = made.skeleton.rotation_channels & (made.skeleton.channel_joints > 0)
    assert made.values[0, turned].tobytes() == clip.values[0, turned].tobytes()
    assert table(made)["frame"][:3].tolist() == [0, 1, 2]
    cycled = laid(clip, mc.Path([(0, 0), (100, 100), (100, 400)]), at_end="cycle")
    assert table(cycled)["frame"].min() > 1
    assert edges(cycled) < 1.1 * edges(clip[1:])


@pytest.mark.parametrize("name", ["12_01_walk", "02_01_walk_blender"])
def test_on_bends_of_a_metre_bodies_turn_without_a_jerk(name: str, captured: Callable[[str], mc.Motion]) -> None:
    clip = captured(name)[1:]
    around = np.linspace(0, 4, 24)
    bend = mc.Path(100 / 5.6444 * np.stack([1 - np.cos(around), np.sin(around)], axis=1))
    made = laid(clip, bend)
    assert edges(made) < 1.1 * edges(clip)
    assert 100 < measured(made)["turned"] < 360


# -- feet ----------------------------------------------------------------------------------------
def test_where_nothing_is_moved_unevenly_feet_are_left_alone(captured: Callable[[str], mc.Motion]) -> None:
    clip = captured("02_01_walk_blender")
    path = Path.of(clip)
    assert mc.follow(clip, path).values.tobytes() == clip.values.tobytes()
    moved = mc.follow(clip, path.moved(MOVED))
    np.testing.assert_allclose(world(moved), planar.move(MOVED, world(clip)), atol=1e-9)
    assert measured(moved)["feet"] is None


@pytest.mark.parametrize("name", ["12_01_walk", "02_01_walk_blender"])
def test_feet_that_stand_do_not_slide_along_another_path(name: str, captured: Callable[[str], mc.Motion]) -> None:
    clip = captured(name)
    bend = mc.Path(100 / 5.6444 * np.stack([1 - np.cos(AROUND), np.sin(AROUND)], axis=1))
    made = mc.follow(clip, bend)
    feet = measured(made)["feet"]
    assert feet["speed_slid"] > 14 > feet["speed_own"] > 7  # cm/s: the clip slides, the bend doubles it
    assert feet["speed"] < 0.01
    assert feet["released"] == 0
    assert feet["drop"] < 2.5
    stood = mc.contacts(made)
    own = [contact for contact in mc.contacts(clip) if contact.last - contact.first > 30]
    assert sum(any(a.first <= c.last and c.first <= a.last for a in stood) for c in own) == len(own)
    assert edges(made) < 1.1 * edges(clip)


def test_feet_of_a_local_edit_change_only_what_is_near(captured: Callable[[str], mc.Motion]) -> None:
    clip = captured("12_01_walk")
    path = Path.of(clip, points=16)
    points = np.array(path.points)
    points[4] += (4, 1)
    edit = replace(path, points=points)
    plain, held = (mc.follow(clip, edit, mode="span", lock_feet=lock) for lock in (False, True))
    near = round(1.5 / clip.frame_time)
    assert measured(held)["first"] >= measured(plain)["first"] - near
    last = measured(held)["last"]
    assert last <= measured(plain)["last"] + near
    assert held.values[last + 1 :].tobytes() == clip.values[last + 1 :].tobytes()
    assert measured(held)["feet"]["speed"] < measured(held)["feet"]["speed_slid"]
    assert edges(held) < 1.1 * edges(clip)


def test_what_asks_too_much_of_the_legs_is_let_go_and_told(captured: Callable[[str], mc.Motion]) -> None:
    clip = captured("02_01_walk_blender")
    ahead = np.linspace(0, 70, 40)
    told = r"the path asks too much of the legs: .*at frames \d+ to \d+.*steps about 0.\d+ times as long would do"
    with pytest.warns(UserWarning, match=told + r".*; \d of 10 contacts are let go, and slide"):
        made = mc.follow(clip, mc.Path(np.stack([24 * np.sin(ahead / 4), ahead], axis=1)))
    feet = measured(made)["feet"]
    assert 0 < feet["released"] < 10
    assert feet["drop"] <= 2.5
    assert feet["shift"] <= 4.0
    assert 0.4 <= feet["stride"] < 1
    assert min(problem["stride"] for problem in feet["asked"]) == feet["stride"]
    for problem in feet["asked"]:
        assert problem["value"] > problem["limit"]
        assert 0 <= problem["first"] <= problem["last"] < made.frames
    assert np.isfinite(made.values).all()


def test_a_span_is_what_the_whole_clip_would_be(captured: Callable[[str], mc.Motion]) -> None:
    clip = captured("12_01_walk")
    path = Path.of(clip, points=16)
    points = np.array(path.points)
    points[6] += (3, 0.5)
    edit = PathEdit.of(clip, path)
    made = edit.laid(replace(path, points=points), mode="span")
    near, Source.near = Source.near, lambda self, touched: slice(0, len(touched))  # type: ignore[method-assign]
    try:
        whole = edit.laid(replace(path, points=points), mode="span")
    finally:
        Source.near = near  # type: ignore[method-assign]
    scale = 5.6444  # cm a unit
    assert measured(made)["feet"]["contacts"] < 16
    assert scale * off(made, whole) < 0.02


@pytest.mark.parametrize("posture", ["lift", "tangent"])
def test_the_slide_that_is_told_is_that_of_the_result(posture: str, captured: Callable[[str], mc.Motion]) -> None:
    clip = captured("12_01_walk")[1:]
    hill = mc.Path([(0, 0, 0), (0, 0, 10), (0, 8, 30), (0, 8, 40), (0, 0, 60), (0, 0, 70)])
    made = mc.follow(clip, hill, posture=posture)
    both = legs(clip)
    balls = {clip.skeleton.names[leg.ball] for leg in both}
    slides = skate(made, [contact for contact in mc.contacts(clip) if contact.joint in balls], both)
    assert slides is not None
    assert measured(made)["feet"]["speed"] == pytest.approx(slides.speed, abs=1e-6)
    assert (slides.speed > 1) == (posture == "tangent")  # a body that leans takes its feet along


# -- made ready ----------------------------------------------------------------------------------
@pytest.mark.parametrize("options", [{}, {"mode": "span"}, {"mode": "scaled"}, {"at_end": "stop"}, {"at_end": "reset"}])
def test_a_clip_made_ready_is_laid_as_follow_lays_it(
    options: dict[str, str], captured: Callable[[str], mc.Motion]
) -> None:
    clip = captured("02_01_walk_blender")
    path = Path.of(clip, points=8)
    points = np.array(path.points)
    points[3] += (2, 1)
    edit = PathEdit.of(clip, path)
    first = edit.laid(path.moved(MOVED))
    for points_of in (points, np.array(path.points) + np.array([0.5, 0.0])):
        new = replace(path, points=points_of)
        made, again = edit.laid(new, **options), mc.follow(clip, new, of=path, **options)
        assert made.values.tobytes() == again.values.tobytes()
        assert made.history == again.history
    assert edit.laid(path.moved(MOVED)).values.tobytes() == first.values.tobytes()
    assert edit.laid(path).values.tobytes() == clip.values.tobytes()


def test_what_was_laid_by_a_clip_made_ready_can_be_run_again() -> None:
    clip = walking()
    edit = PathEdit.of(clip, lock_feet=False)
    points = np.array(edit.path.points)
    points[2] += (30, 10)
    for path in (replace(edit.path, points=points), mc.Path([(0, 0), (100, 200), (0, 500)])):
        made = edit.laid(path)
        (again,) = [mc.run(clip, [step]) for step in made.history[-1:]]
        assert again.sample().values.tobytes() == made.values.tobytes()


# -- bodies --------------------------------------------------------------------------------------
def test_a_body_without_knees_is_carried_and_that_is_said() -> None:
    clip = walking()
    with pytest.warns(UserWarning, match="feet are not held: "):
        made = mc.follow(clip, bent(Path.of(clip)))
    assert made.values.tobytes() == laid(clip, bent(Path.of(clip))).values.tobytes()
