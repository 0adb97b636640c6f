"""Figures on their paths as cameras see them: what is drawn where, for how long, and what is refused."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path as File

import numpy as np
import pytest
from paths import laid
from PIL import Image
from walks import PERIOD, walk

from mocurve import OptionError, draw_path, draw_views
from mocurve.path import Path

RED, GREEN, BLUE = (192, 57, 43), (30, 132, 73), (27, 73, 125)
BEND = Path([(0, 0), (200, 0), (200, 200)])


def amount(image: Image.Image, colour: tuple[int, int, int]) -> int:
    """Pixels of about this colour."""
    return int((np.abs(np.asarray(image.convert("RGB")).astype(int) - colour).max(axis=2) < 40).sum())


def followed(path: Path = BEND) -> list[draw_views.Laid]:
    clip = walk(2 * PERIOD)
    return draw_views.laid(clip, Path.of(clip), laid(clip, path), path)


@pytest.mark.parametrize("name", draw_views.VIEWS)
def test_both_figures_and_the_control_points_are_in_every_view(name: str) -> None:
    image = draw_views.view(followed(), name, 400)
    assert min(amount(image, RED), amount(image, GREEN)) > 200
    assert amount(image, BLUE) > 5
    assert image.size == (400, round(400 * draw_views.RATIO))


def test_blocks_are_where_the_history_says_that_the_body_is() -> None:
    clip = walk(2 * PERIOD)
    made = laid(clip, BEND)
    new = draw_views.laid(clip, Path.of(clip), made, BEND)[1]
    np.testing.assert_allclose(
        new.tracker[:, [0, 2]], BEND.at(np.array(made.history[-1]["table"]["distance"]))[0], atol=1e-9
    )
    away = np.linalg.norm((new.tracker - new.figure.places[:, 0])[:, [0, 2]], axis=1)
    assert away.max() < 30  # the body is near its block: units of a body of 160


def test_without_a_history_blocks_are_as_far_as_the_body_has_gone() -> None:
    clip = walk(2 * PERIOD)
    made = replace(laid(clip, BEND), history=())
    new = draw_views.laid(clip, Path.of(clip), made, BEND)[1]
    assert np.linalg.norm((new.tracker - new.figure.places[:, 0])[:, [0, 2]], axis=1).max() < 60


def test_heights_are_counted_from_the_floor_of_the_clip() -> None:
    clip, hill = walk(2 * PERIOD), Path([(0, 0, 0), (0, 80, 100), (0, 0, 200)])
    own, new = draw_views.laid(clip, Path.of(clip), laid(clip, hill), hill)
    floor = own.figure.places[..., 1].min()
    assert (own.path[:, 1] == floor).all()
    np.testing.assert_allclose(new.points[:, 1], floor + np.array([0, 80, 0]))


def test_a_gif_plays_as_long_as_the_longer_clip(tmp_path: File) -> None:
    clip, far = walk(PERIOD // 2), Path([(0, 0), (0, 150)])
    made = laid(walk(PERIOD), far)
    draw_path.save(tmp_path / "a.gif", clip, Path.of(clip), made, far, width=200)
    with Image.open(tmp_path / "a.gif") as image:
        shown = 0
        for frame in range(image.n_frames):
            image.seek(frame)
            shown += image.info["duration"]
    assert made.frames > clip.frames
    assert shown == pytest.approx(1000 * made.duration, abs=80)


def test_a_clip_with_gaps_is_refused() -> None:
    clip = walk(PERIOD)
    values = np.array(clip.values)
    values[5, 7] = np.nan
    with pytest.raises(OptionError, match="not finite numbers; they cannot be drawn"):
        draw_views.laid(replace(clip, values=values), Path.of(clip))
