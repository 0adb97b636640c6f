"""follow in mode paced: slower in narrow bends, never faster; elsewhere it is mode arclength to the last digit."""

from __future__ import annotations

from pathlib import Path as File

import numpy as np
import pytest
from paths import FITS, MOVED, edges, laid, measured, table, walking

import mocurve as mc
from mocurve import OptionError, planar
from mocurve.edit._following import Following
from mocurve.kinematics import world
from mocurve.path import Path

TURN = mc.Path([(0, 0), (0, 100), (0, 180), (0, 199), (1, 200), (20, 200), (100, 200), (400, 200)], 3)


def arc(radius: float, length: float = 600.0) -> mc.Path:
    angle = np.linspace(0, length / radius, max(24, round(length / 20)))
    return mc.Path(radius * np.stack([1 - np.cos(angle), np.sin(angle)], axis=1))


@pytest.mark.parametrize("fit", FITS)
def test_the_own_path_and_one_that_is_moved_as_a_whole_are_taken_as_they_are(fit: str) -> None:
    clip = walking(4, 0.9)
    path = Path.of(clip, **FITS[fit])
    assert laid(clip, path, mode="paced").values.tobytes() == clip.values.tobytes()
    moved = laid(clip, path.moved(MOVED), mode="paced")
    np.testing.assert_allclose(world(moved), planar.move(MOVED, world(clip)), atol=1e-9)


@pytest.mark.parametrize("path", [mc.Path([(0, 0), (300, 800)]), arc(300), arc(260)], ids=["straight", "3 m", "2.6 m"])
def test_where_no_bend_is_narrow_it_is_arclength(path: mc.Path) -> None:
    clip = walking(4, 0.0)
    assert laid(clip, path, mode="paced").values.tobytes() == laid(clip, path).values.tobytes()


@pytest.mark.parametrize("radius", [50.0, 100.0, 200.0])
def test_on_an_arc_the_speed_falls_with_the_cube_root_of_its_curvature(radius: float) -> None:
    clip = walking(4, 0.0)
    plain, made = (laid(clip, arc(radius), mode=mode) for mode in ("arclength", "paced"))
    slower = (250.0 / radius) ** (1 / 3)
    steps = [np.median(np.diff(table(one)["distance"])) for one in (plain, made)]
    assert steps[0] / steps[1] == pytest.approx(slower, rel=0.01)
    assert measured(made)["slower"] == pytest.approx(slower, rel=0.03)
    assert measured(made)["stride"] == 1.0
    assert f"{measured(made)['slower']:.3g} times the time" in str(Following(**measured(made)))


@pytest.mark.parametrize(
    "options", [{}, {"at_end": "cycle"}, {"at_end": "stop"}, {"heading": "facing"}, {"heading": "kept"}]
)
def test_the_order_of_frames_is_kept_and_nobody_gets_faster(options: dict[str, str]) -> None:
    clip = walking(4, 0.0)
    plain, made = (laid(clip, TURN, mode=mode, **options) for mode in ("arclength", "paced"))
    rows, before = table(made), table(plain)
    frames = rows["frame"] + 66 * rows["cycle"]
    assert made.frames > 1.03 * plain.frames
    assert (np.diff(frames) >= -1e-9).all()
    assert np.diff(frames).max() <= 1 + 1e-9
    assert frames[0] == before["frame"][0]
    assert np.diff(rows["distance"]).max() <= np.diff(before["distance"]).max() * (1 + 1e-6)
    assert edges(made) <= edges(plain)


def test_a_corner_and_a_clip_of_few_frames_are_no_exception() -> None:
    corner = mc.Path([(0, 0), (0, 100), (300, 100)], 1)
    made = laid(walking(4, 0.0), corner, mode="paced")
    assert np.isfinite(made.values).all()
    assert 1.05 < measured(made)["slower"] < 2
    for frames in (2, 3):
        assert laid(walking(4, 0.0)[:frames], arc(50), mode="paced").frames == frames


def test_markers_of_an_unknown_size_are_refused() -> None:
    places = world(walking(2))[:, :4].reshape(-1, 12)
    kinds = (("Xposition", "Yposition", "Zposition"),) * 4
    markers = mc.Motion(mc.Skeleton(("A", "B", "C", "D"), [-1] * 4, np.zeros((4, 3)), kinds), places, 1 / 60)
    with pytest.raises(OptionError, match="mode paced asks how narrow bends are"):
        laid(markers, arc(50), mode="paced")


def test_feet_of_a_captured_walk_are_held_in_a_bend_that_is_taken_slowly(clips: File) -> None:
    clip = mc.read(clips / "cmu" / "cmu_12_01_walk.bvh")[1:]
    turn = mc.Path(np.array([(0, 0), (0, 100), (0, 140), (0, 200), (60, 200), (100, 200), (400, 200)]) / 5.6444)
    plain, made = (mc.follow(clip, turn, mode=mode) for mode in ("arclength", "paced"))
    feet = measured(made)["feet"]
    assert feet["speed"] < 0.01
    assert feet["released"] == 0
    assert measured(made)["slower"] > 1.05
    assert feet["contacts"] == measured(plain)["feet"]["contacts"]
