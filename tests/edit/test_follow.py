"""follow: its own path laid back changes nothing, a path moved as a whole moves the motion so, and it can be undone."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path as File
from typing import Any

import numpy as np
import pytest
from paths import MOVED, bent, edges, laid, measured, off, table, walking
from turning import heading

import mocurve as mc
from mocurve import planar
from mocurve.kinematics import world
from mocurve.path import Path
from mocurve.path_fit import gone

MODES = ["arclength", "time", "scaled", "span"]
FITS: dict[str, dict[str, Any]] = {
    "usual": {},
    "smooth": {"points": 9, "degree": 4, "track": "smooth"},
    "feet": {"track": "support"},
    "heights": {"height": True},
    "polynomial": {"kind": "polynomial", "degree": 12},
}
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


@pytest.mark.parametrize("mode", MODES)
def test_the_way_back_restores_the_motion(mode: str) -> None:
    clip = walking()
    path = Path.of(clip)
    there = laid(clip, bent(path, 8.0), mode=mode)
    assert off(there, clip) > 5
    assert off(laid(there, path, mode=mode), clip) < 1e-9


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
    own, new = Path.of(clip), mc.Path([(0, 0), (0, 400), (300, 900), (800, 900)])
    scaled, timed = (table(laid(clip, new, mode=mode))["distance"] for mode in ("scaled", "time"))
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
