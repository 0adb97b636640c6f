"""follow with at_end cycle: every cycle is the one before further on, no seam shows, no heading drifts, feet stand."""

from __future__ import annotations

from pathlib import Path as File

import numpy as np
import pytest
from paths import laid, measured, table, walking
from turning import heading
from walks import PERIOD, walk

import mocurve as mc
from mocurve.edit._following import Following
from mocurve.edit.path_edit import PathEdit
from mocurve.kinematics import world
from mocurve.path import Path

LENGTHS = 4
RUNS = {"12_01": "cmu_12_01_walk.bvh", "16_15": "cmu_16_15.amc", "02_03": "cmu_02_03.amc"}
CM = 5.6444  # a unit of these clips


@pytest.mark.parametrize("turn", [0.0, 0.3])
def test_along_a_straight_path_every_cycle_is_the_one_before_further_on(turn: float) -> None:
    clip, path = walking(4, turn), mc.Path([(50, 0), (1050, 1500)])
    made = laid(clip, path, at_end="cycle")
    goes = measured(made)["cycle"]
    further = goes * np.diff(path.points, axis=0)[0] / path.length
    places = world(made)
    away = places[PERIOD:] - places[:-PERIOD]
    wanted = np.broadcast_to([further[0], 0.0, further[1]], away.shape)
    np.testing.assert_allclose(away[PERIOD:-PERIOD], wanted[PERIOD:-PERIOD], atol=1e-5)
    np.testing.assert_allclose(away, wanted, atol=5e-3)  # a turn is smoothed up to the ends
    along = table(made)["distance"]
    np.testing.assert_allclose(along[PERIOD:] - along[:-PERIOD], goes, atol=1e-9)


def test_a_clip_that_is_one_cycle_of_several_bends_has_a_path_with_these() -> None:
    """Its path has as many control points a cycle as any other, not one."""
    ahead = walk(8 * PERIOD)
    sway = 60.0 * np.sin(2.0 * np.pi * np.arange(ahead.frames) / (4 * PERIOD))
    values = np.array(ahead.values)
    values[:, 0] += sway
    clip = mc.loop(mc.Motion(ahead.skeleton, values, ahead.frame_time), start=PERIOD / 60, end=5 * PERIOD / 60)
    path = mc.Path([(0, 0), (0, 4000)])
    made = laid(clip, path, at_end="cycle")
    np.testing.assert_allclose(made.values[:, 0], 0.0, atol=12)  # the sway is in the path, and the new one is straight
    assert measured(made)["cycle"] > 4 * 122


def test_the_numbers_tell_the_clips_own_path_and_the_cycles() -> None:
    clip = walking(4, 0.0)
    made = laid(clip, mc.Path([(0, 0), (0, 2000)]), at_end="cycle")
    told = measured(made)
    assert told["own_length"] == pytest.approx(Path.of(clip).length)
    assert told["cycle"] == pytest.approx(120, rel=0.01)
    assert f"{told['cycles']} cycles of 120 cm" in str(Following(**told))
    plain = measured(laid(clip, mc.Path([(0, 0), (0, 200)]), at_end="cycle"))
    assert plain["cycle"] is None
    assert "cycles" not in str(Following(**plain))


def test_a_tour_of_cycles_knows_its_path() -> None:
    tour = mc.Path([(0, 0), (300, 400), (900, 400), (1500, 1200)])
    made = laid(walking(4), tour, at_end="cycle")
    edit = PathEdit.of(made, lock_feet=False)
    np.testing.assert_array_equal(edit.path.points, tour.points)
    assert laid(made, tour).values.tobytes() == made.values.tobytes()


def test_cycles_of_a_clip_made_ready_are_those_of_follow() -> None:
    clip, tour = walking(4), mc.Path([(0, 0), (300, 400), (900, 400)])
    edit = PathEdit.of(clip, lock_feet=False)
    edit.laid(edit.path.moved((0.1, 2, 3)))
    assert edit.laid(tour, at_end="cycle").history == laid(clip, tour, at_end="cycle").history


# -- promises on captures ------------------------------------------------------------------------
def tours(length: float) -> dict[str, mc.Path]:
    """A straight path, an arc of 3 m and a slalom, in the clips' unit."""
    ahead = np.linspace(0.0, length * CM / 100.0, 200)
    slalom = np.cumsum(np.sin(0.6 * np.cos(0.5 * np.pi * ahead))) * ahead[1]
    shapes = {
        "straight": np.stack([0.0 * ahead, ahead], axis=1),
        "arc": 3.0 * np.stack([1.0 - np.cos(ahead / 3.0), np.sin(ahead / 3.0)], axis=1),
        "slalom": np.stack([slalom, ahead], axis=1),
    }
    return {name: mc.Path(100.0 / CM * points) for name, points in shapes.items()}


@pytest.fixture(scope="module", params=RUNS)
def clip(request: pytest.FixtureRequest, clips: File) -> mc.Motion:
    file = clips / "cmu" / RUNS[request.param]
    if file.suffix == ".bvh":
        return mc.read(file)[1:].sample()
    with pytest.warns(UserWarning, match="frame rate"):
        return mc.read(file, skeleton=file.with_name(f"cmu_{request.param[:2]}.asf")).sample()


@pytest.mark.parametrize("shape", ["straight", "arc", "slalom"])
def test_over_four_lengths_no_seam_shows_and_no_heading_drifts(shape: str, clip: mc.Motion) -> None:
    path = tours(LENGTHS * Path.of(clip).length)[shape]
    made = mc.follow(clip, path, at_end="cycle")
    cycle, places = table(made)["cycle"], world(made)
    for order in (1, 2):
        change = np.linalg.norm(np.diff(places, order, axis=0), axis=-1).max(axis=1)
        across = np.array([len(set(cycle[max(k - 2, 0) : k + order + 3])) > 1 for k in range(len(change))])
        assert across.sum() >= 5 * cycle[-1] > 25
        assert change[across].max() < np.percentile(change[~across], 99.5)
    looks = np.unwrap(np.radians(heading(made)) - path.at(table(made)["distance"])[1])
    means = [np.degrees(looks[cycle == k].mean()) for k in range(cycle[-1])]
    assert abs(np.polyfit(np.arange(len(means)), means, 1)[0]) < (0.1 if shape == "slalom" else 0.02)  # degrees
    feet = measured(made)["feet"]
    assert feet["speed"] < 0.01
    assert feet["released"] == 0
    assert feet["speed_own"] > 5


def test_a_foot_that_stands_at_the_seam_stands_through_it(clips: File) -> None:
    clip = mc.read(clips / "cmu" / RUNS["12_01"])[1:].sample()
    loop = mc.loop(clip).history[-1]["measured"]
    start = round(loop["start"] / clip.frame_time)
    first, last = (
        [c.joint for c in mc.contacts(clip) if c.first < edge <= c.last] for edge in (start, start + loop["frames"])
    )
    assert set(first) & set(last)
    made = mc.follow(clip, tours(300.0)["arc"], at_end="cycle")
    told = measured(made)["feet"]
    inside = [c for c in mc.contacts(clip) if start <= c.first < start + loop["frames"]]
    assert (
        len(inside) * (measured(made)["cycles"] - 1) <= told["contacts"] <= len(inside) * measured(made)["cycles"] + 2
    )
    seam = int(np.argmax(np.diff(table(made)["cycle"]) > 0))
    joint = made.skeleton.joint((set(first) & set(last)).pop())
    near = world(made)[seam - 3 : seam + 4, joint][:, [0, 2]]
    assert CM * np.linalg.norm(near - near.mean(axis=0), axis=1).max() < 2.0
