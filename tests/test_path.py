"""Path: a curve that knows the distance along it, however it was drawn or fitted."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path as File

import numpy as np
import pytest
from walks import PERIOD, STEP, walk

import mocurve as mc
from mocurve import Mismatch, OptionError, UnknownName, planar
from mocurve.path import Fit, Path, chebyshev_places
from mocurve.path_fit import gone, of_track
from mocurve.path_length import NODES

SHAPES = [
    ([(0, 0), (200, 80), (400, -80), (600, 0)], {}),
    ([(0, 0), (0, 300)], {}),
    ([(0, 0), (100, 0), (100, 100), (0, 100), (0, 50)], {"degree": 1}),
    ([(0, 0, 0), (0, 30, 100), (90, 60, 150), (200, 0, 150), (200, -20, 0), (90, 5, 5)], {"degree": 5}),
    ([(0, 0), (80, 10), (100, 90), (20, 120), (0, 40), (150, 60), (200, 0)], {"kind": "polynomial"}),
]


@pytest.fixture(params=SHAPES, ids=["cubic", "straight", "corners", "heights", "polynomial"])
def path(request: pytest.FixtureRequest) -> Path:
    points, options = request.param
    return mc.Path(points, **options)


def exact_lengths(path: Path, parameters: np.ndarray) -> np.ndarray:
    """Distances (M,) at parameters (M,) that rise, by quadrature on intervals a hundred times as short as needed."""
    edges = np.unique(np.concatenate([np.linspace(0, 1, 5001), parameters, path.knots]))
    at = (edges[:-1, None] + np.diff(edges)[:, None] * NODES).reshape(-1)
    speed = np.linalg.norm(path.velocity(at), axis=1).reshape(-1, 5)
    weights = np.polynomial.legendre.leggauss(5)[1] / 2
    return np.interp(parameters, edges, np.concatenate([[0], np.cumsum(np.diff(edges) * (speed @ weights))]))


# -- distances -----------------------------------------------------------------------------------
def test_distances_are_those_of_the_curve_and_lead_back(path: Path) -> None:
    at = np.linspace(0, 1, 997)
    table = path.table()
    lengths = exact_lengths(path, at)
    np.testing.assert_allclose(table.distance(at), lengths, atol=1e-7 * path.length)
    np.testing.assert_allclose(table.parameter(table.distance(at)), at, atol=1e-12)
    assert abs(path.length - lengths[-1]) < 1e-9 * path.length


def test_even_distances_are_even_steps(path: Path) -> None:
    distances = np.linspace(0, path.length, 4001)
    places, _ = path.at(distances)
    steps = np.linalg.norm(np.diff(places, axis=0), axis=1) / np.diff(distances)
    assert steps.max() < 1 + 1e-4
    assert np.median(steps) > 1 - 1e-4


def test_the_velocity_is_the_slope_of_the_place(path: Path) -> None:
    at, step = np.linspace(0.013, 0.987, 211), 1e-6
    at = at[np.abs(at[:, None] - path.knots).min(axis=1, initial=1) > 2 * step]
    slope = (path.place(at + step) - path.place(at - step)) / (2 * step)
    np.testing.assert_allclose(path.velocity(at), slope, atol=1e-5 * path.length)


def test_a_path_begins_and_ends_at_its_end_points_and_goes_straight_on(path: Path) -> None:
    (first, before, last, after), headings = path.at(np.array([0, -7, path.length, path.length + 5]))
    np.testing.assert_allclose([first, last], path.points[[0, -1]], atol=1e-9)
    assert np.linalg.norm(before - first) == pytest.approx(7)
    assert np.linalg.norm(after - last) == pytest.approx(5)
    assert headings[0] == headings[1]
    assert headings[2] == headings[3]


def test_one_distance_gives_one_place() -> None:
    place, heading = mc.Path([(0, 0), (0, 300)]).at(100.0)
    np.testing.assert_allclose(place, [0, 100], atol=1e-9)
    assert heading == 0
    assert mc.Path([(0, 0), (300, 0)]).at(1)[1] == pytest.approx(np.pi / 2)  # from +z towards +x


def test_a_cusp_is_passed_and_a_pause_costs_no_distance() -> None:
    back = mc.Path([(0, 0), (0, 100), (0, 100), (0, 100), (0, 0)])  # comes to a stop, turns and goes back
    assert back.length == pytest.approx(200, abs=1e-4)
    places, headings = back.at(np.array([50, 99.99, 100.01, 150]))
    np.testing.assert_allclose(places[:, 1], [50, 99.99, 99.99, 50], atol=1e-3)
    np.testing.assert_allclose(np.abs(headings - headings[0]), [0, 0, np.pi, np.pi], atol=1e-9)


def test_headings_do_not_jump_by_whole_turns() -> None:
    turns = np.linspace(0, 6 * np.pi, 200)
    circle = mc.Path(np.stack([-np.cos(turns), np.sin(turns)], axis=1) * 50)
    headings = circle.at(np.linspace(0, circle.length, 500))[1]
    assert np.abs(np.diff(headings)).max() < 0.1
    assert headings[-1] - headings[0] == pytest.approx(6 * np.pi, abs=0.1)


def test_straight_up_there_is_a_heading_and_a_distance() -> None:
    stairs = mc.Path([(0, 0, 0), (0, 0, 10), (0, 50, 10), (0, 50, 30)], degree=1)
    assert stairs.length == pytest.approx(80)
    places, headings = stairs.at(np.array([5, 35, 75]))
    np.testing.assert_allclose(places, [[0, 0, 5], [0, 25, 10], [0, 50, 25]], atol=1e-9)
    assert headings.tolist() == [0, 0, 0]
    np.testing.assert_allclose(
        stairs.slope(stairs.table().parameter(np.array([5, 35, 75]))), [0, np.pi / 2, 0], atol=1e-12
    )


def test_a_path_without_length_is_a_place() -> None:
    place = mc.Path([(3, 4), (3, 4), (3, 4)])
    assert place.length == 0
    assert place.at(0)[0].tolist() == [3, 4]


# -- the curve -----------------------------------------------------------------------------------
def test_a_high_polynomial_goes_through_its_points_and_is_computed_without_loss() -> None:
    at = chebyshev_places(46)
    wave = np.stack([1e4 + np.sin(9 * at), 1e4 + np.cos(7 * at)], axis=1)
    path = mc.Path(wave, kind="polynomial")
    assert path.degree == 45
    fine = np.linspace(0, 1, 999)
    np.testing.assert_allclose(path.place(at), wave, atol=1e-9)
    np.testing.assert_allclose(path.place(fine)[:, 0], 1e4 + np.sin(9 * fine), atol=1e-9)
    np.testing.assert_allclose(path.velocity(fine)[:, 1], -7 * np.sin(7 * fine), atol=1e-6)


def test_few_points_are_a_curve_of_lower_degree() -> None:
    assert mc.Path([(0, 0), (5, 5)], degree=3).degree == 1
    assert mc.Path([(0, 0), (5, 5), (9, 0)], degree=3).degree == 2


@pytest.mark.parametrize("degree", [1, 2, 4, 7, 40])
def test_any_degree_and_any_number_of_points(degree: int) -> None:
    points = np.random.default_rng(degree).normal(0, 50, (60, 2)).cumsum(axis=0)
    path = mc.Path(points, degree)
    low, high = points.min(axis=0), points.max(axis=0)
    places = path.place(np.linspace(0, 1, 500))
    assert (places >= low - 1e-9).all()
    assert (places <= high + 1e-9).all()  # within the control points
    assert 0 < path.length <= np.linalg.norm(np.diff(points, axis=0), axis=1).sum() + 1e-6


def test_a_path_moved_as_a_whole_has_the_same_distances(path: Path) -> None:
    by = np.array([2.1, 30, -70])
    moved = path.moved(by)
    at = np.linspace(0, path.length, 50)
    places, headings = path.at(at)
    flat = np.insert(places, 1, 0, axis=1) if places.shape[1] == 2 else places
    np.testing.assert_allclose(moved.at(at)[0][:, [0, -1]], planar.move(by, flat)[:, [0, 2]], atol=1e-8)
    turned = moved.at(at)[1] - headings
    np.testing.assert_allclose(np.cos(turned - 2.1), 1, atol=1e-9)


# -- fits ----------------------------------------------------------------------------------------
@pytest.mark.parametrize(("kind", "degree"), [("spline", 3), ("spline", 5), ("polynomial", 20), ("polynomial", 45)])
def test_a_curve_of_its_kind_is_found_again(kind: str, degree: int) -> None:
    points = np.random.default_rng(1).normal(0, 30, (degree + 1 if kind == "polynomial" else 12, 2))
    drawn = mc.Path(points, degree, kind)
    at = np.linspace(0, 1, 400) ** 1.2
    track = np.insert(drawn.place(at), 1, 0, axis=1)
    found = of_track(track, at, Fit(len(points), degree, kind), STEP)
    np.testing.assert_allclose(found.points, points, atol=1e-6)
    assert (found.kind, found.degree) == (kind, degree)


def test_residuals_of_a_polynomial_shrink_with_its_degree(jump: File) -> None:
    clip = mc.read(jump)
    away = [Path.of(clip, kind="polynomial", degree=degree).residuals(clip) for degree in (2, 4, 13, 45)]
    rms = [float(np.sqrt(np.mean(part**2))) for part in away]
    assert rms[0] > rms[1] > rms[2] > 4 * rms[3]
    assert len(away[0]) == clip.frames


def test_a_control_point_a_second_leaves_the_sway_to_the_motion() -> None:
    clip = walk(400)
    values = np.array(clip.values, order="F")
    values[:, 0] += 3 * np.sin(2 * np.pi * np.arange(400) / PERIOD)
    clip = replace(clip, values=values)
    path = Path.of(clip)
    assert len(path.points) == 8
    assert path.fit == Fit(8)
    assert np.abs(path.points[2:-2, 0]).max() < 1  # of a sway of 3
    straight = Path.of(clip, track="smooth", points=30)
    swaying = Path.of(clip, points=30)
    bends = [np.abs(np.diff(p.at(np.linspace(0, p.length, 300))[1], 2)).max() for p in (straight, swaying)]
    assert bends[0] < 0.5 * bends[1]


def test_the_feet_and_the_height_can_be_followed() -> None:
    clip = walk(200)
    assert Path.of(clip, height=True).points.shape[1] == 3
    support, root = Path.of(clip, track="support"), Path.of(clip)
    assert support.length == pytest.approx(root.length, rel=0.1)
    assert np.abs(support.points - root.points).max() > 1e-3


def test_real_walks_stay_within_centimetres(clips: File) -> None:
    found = {}
    for name in ("12_01_walk", "02_01_walk_blender"):
        clip = mc.read(clips / "cmu" / f"cmu_{name}.bvh")
        away = 5.6444 * Path.of(clip).residuals(clip)
        found[name] = float(np.sqrt(np.mean(away**2)))
    assert all(0.5 < rms < 3 for rms in found.values()), found


def test_a_t_pose_in_front_is_no_part_of_the_path(clips: File) -> None:
    clip = mc.read(clips / "cmu" / "cmu_12_01_walk.bvh")
    np.testing.assert_array_equal(Path.of(clip, points=6).points, Path.of(clip[1:], points=6).points)


def test_pauses_take_no_part_of_a_path_and_make_it_no_longer() -> None:
    ahead = walk(3 * PERIOD)
    paused = replace(ahead, values=np.vstack([ahead.values, np.repeat(ahead.values[-1:], 300, 0)]))
    at = gone(paused)
    assert at[len(ahead.values) + 20] > 0.95
    assert (np.diff(at) >= 0).all()
    assert Path.of(paused).length == pytest.approx(360, rel=0.04)
    assert len(Path.of(paused).points) <= len(Path.of(ahead).points) + 1


def test_one_frame_and_two_have_a_path() -> None:
    clip = walk(30)
    assert Path.of(clip[:1]).length == 0
    np.testing.assert_allclose(Path.of(clip[:2]).points, clip.values[:2][:, [0, 2]], atol=1e-9)


# -- refusals ------------------------------------------------------------------------------------
@pytest.mark.parametrize(
    ("points", "options", "told"),
    [
        ([(0, 0)], {}, "a path has 2 to 100000 points, not 1"),
        ([], {}, "two columns x, z or three x, y, z, not shape (0,)"),
        ([(0, 0), (1, np.nan)], {}, "point 2 of the path is (1.0, nan)"),
        ([(0, 0), (1, 1e13)], {}, "numbers up to 1e+12"),
        ([(0, 0, 0, 0), (1, 1, 1, 1)], {}, "not shape (2, 4)"),
        ([(0, 0), (1,)], {}, "rows of numbers"),
        ("here", {}, "rows of numbers"),
        ([(0, 0), (1, 1)], {"degree": 0}, "a whole number from 1 to 200, not 0"),
        ([(0, 0), (1, 1)], {"degree": 2.5}, "not 2.5"),
        ([(0, 0), (1, 1)], {"degree": True}, "not True"),
        (np.zeros((202, 2)), {"kind": "polynomial"}, "201 points at most, not 202"),
        ([(0, 0), (1, 1)], {"knots": np.zeros(3)}, "2 control points of degree 1 have 4 knots"),
        ([(0, 0), (1, 1)], {"knots": np.array([0, 0, 2, 2])}, "rise from 2 times 0 to 2 times 1"),
    ],
)
def test_points_and_degrees_are_checked(points: object, options: dict, told: str) -> None:
    with pytest.raises(OptionError) as error:
        mc.Path(points, **options)
    assert told in str(error.value)


@pytest.mark.parametrize(
    ("asked", "told"),
    [
        (lambda path: path.at(np.nan), "a distance along a path is a number"),
        (lambda path: path.at("x"), "a distance along a path is a number, not 'x'"),
        (lambda path: path.moved((1, 2)), "moved by three numbers: an angle, x and z"),
        (lambda path: path.moved((1, 2, np.inf)), "moved by three numbers: an angle, x and z"),
    ],
)
def test_what_is_asked_of_a_path_is_checked(asked: Callable[[Path], object], told: str) -> None:
    with pytest.raises(OptionError) as error:
        asked(mc.Path([(0, 0), (1, 1)]))
    assert told in str(error.value)


@pytest.mark.parametrize(
    ("options", "told"),
    [
        ({"points": 500}, "a path of 500 control points takes as many frames, and the clip has 90"),
        ({"points": 2}, "2 control points make a curve of degree 1 at most, not 3: take more points, or degree 1"),
        ({"points": 5, "degree": 7}, "5 control points make a curve of degree 4 at most, not 7"),
        ({"points": 1}, "a path has 2 to 100000 points, not 1"),
        ({"kind": "polynomial", "degree": 90}, "the degree of a polynomial through 90 frames is 89 at most, not 90"),
        ({"kind": "polynomial", "points": 9}, "a polynomial of degree 3 has 4 points, not 9"),
        ({"height": 3}, "height is true or false, not 3"),
    ],
)
def test_what_a_clip_cannot_give_is_refused(options: dict, told: str) -> None:
    with pytest.raises(OptionError) as error:
        Path.of(walk(90), **options)
    assert told in str(error.value)


def test_unknown_names_are_answered_with_the_nearest() -> None:
    with pytest.raises(UnknownName, match="Did you mean 'smooth'"):
        Path.of(walk(90), track="smoth")
    with pytest.raises(UnknownName, match="Did you mean 'spline'"):
        mc.Path([(0, 0), (1, 1)], kind="splin")


def test_clips_without_places_are_refused() -> None:
    clip = walk(90)
    values = np.array(clip.values, order="F")
    values[7, 0] = np.nan
    with pytest.raises(Mismatch, match="the root has no place at frame 7"):
        Path.of(replace(clip, values=values))
    with pytest.raises(Mismatch, match="a clip without frames has no path"):
        Path.of(clip[:0])


def test_a_fit_that_frames_hardly_settle_is_refused_and_never_wild() -> None:
    whole = walk(4 * PERIOD)
    jerks = np.unique((np.linspace(0.0, 1.0, 40) ** 3 * (whole.frames - 1)).astype(int))
    slow = replace(whole, values=whole.values[jerks])
    extent, refused = np.ptp(slow.values[:, [0, 2]], axis=0).max(), 0
    for degree in (1, 2, 3, 7, 9):
        for points in range(slow.frames // 2, slow.frames + 1):
            try:
                path = Path.of(slow, points=points, degree=degree)
            except OptionError as error:
                refused += "swing far out" in str(error)
            else:
                assert np.ptp(path.points, axis=0).max() < 20.0 * extent
    assert refused
