"""Bare control points are known as those of a clip's own path where they are an edit of one, and only there."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from walks import PERIOD, walk

from mocurve.path import Path
from mocurve.path_edits import recognised

CLIP = walk(3 * PERIOD, turn=0.4)
MOVED = np.array([0.7, 30.0, -50.0])


def bare(path: Path, decimals: int | None = None) -> Path:
    """As a file with nothing but numbers has it."""
    return Path(path.points if decimals is None else np.round(path.points, decimals))


@pytest.mark.parametrize("height", [False, True])
@pytest.mark.parametrize(("points", "degree"), [(2, 1), (4, 3), (7, 3), (9, 5), (6, 2)])
def test_a_fit_is_known_by_its_points_also_moved_as_one(points: int, degree: int, height: bool) -> None:
    own = Path.of(CLIP, points=points, degree=degree, height=height)
    for path in (own, own.moved(MOVED)):
        found = recognised(bare(path), CLIP)
        assert found.fit == own.fit
        assert found.degree == degree
        assert (found.points == path.points).all()
    assert recognised(bare(own, 2), CLIP).fit == own.fit


def test_a_fit_with_some_points_moved_is_known() -> None:
    own = Path.of(CLIP, points=8)
    points = np.array(own.points)
    points[2:5] += (20.0, -30.0)
    assert recognised(Path(points), CLIP).fit == own.fit


def test_a_path_that_was_drawn_stays_what_it_is() -> None:
    own = Path.of(CLIP, points=8)
    stretched = Path(own.points * 1.01 + [3.0, 4.0])
    mirrored = Path(own.points * [-1.0, 1.0])
    many = Path(np.random.default_rng(2).normal(size=(5000, 2)))
    for drawn in (stretched, mirrored, many, Path([(0, 0), (50, 20)]), Path(own.points, kind="polynomial")):
        assert recognised(drawn, CLIP) is drawn


def test_a_drawn_path_of_nearly_as_many_points_as_frames_is_no_edit() -> None:
    jerks = np.unique((np.linspace(0.0, 1.0, 40) ** 3 * (CLIP.frames - 1)).astype(int))
    short = replace(CLIP, values=CLIP.values[jerks])
    for count in range(short.frames // 2, short.frames + 1):  # fits to so few frames swing far out, or are not settled
        drawn = Path(np.stack([np.zeros(count), np.linspace(0.0, 380.0, count)], axis=1))
        assert recognised(drawn, short) is drawn


def test_what_a_path_says_of_itself_holds() -> None:
    own = Path.of(CLIP, points=8)
    other = replace(own, fit=Path.of(CLIP, points=5).fit)
    assert recognised(other, CLIP) is other
