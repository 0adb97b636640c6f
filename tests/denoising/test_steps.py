"""Offsets that last."""

from __future__ import annotations

import numpy as np
import pytest
from gestures import heel_strike, jitter, kick, rmse, swing

from mocurve.denoising import clean
from mocurve.denoising.artefacts import GAP, Body, noise_level
from mocurve.denoising.steps import Offset, offsets

FPS = 120.0


def found(values: np.ndarray, fps: float = FPS) -> list[Offset]:
    y = np.ascontiguousarray(values.T)
    body = Body.of_degrees(len(y), fps)
    return offsets(y, noise_level(y), body.sharpest, body.leap, GAP)


ENDS = [(0, 120, 90.0), (480, 600, -90.0)]  # so far that the channel is nowhere else there


@pytest.mark.parametrize(
    ("first", "last", "by"), [(200, 290, -35.0), (200, 290, 20.0), (300, 320, 20.0), (300, 320, 60.0), *ENDS]
)
def test_a_displaced_part_is_found_and_its_size(first: int, last: int, by: float) -> None:
    values = jitter(swing(600, FPS), 0.3)
    values[first:last, 1] += by
    (one,) = found(values)
    assert one[:3] == (1, first, last)
    assert one.by == pytest.approx(by, abs=1.5)


@pytest.mark.parametrize(("first", "last", "by"), [(200, 290, 30.0), *ENDS])
def test_a_displaced_part_is_moved_back_within_a_degree(first: int, last: int, by: float) -> None:
    truth = swing(600, FPS)
    values = jitter(truth, 0.3)
    values[first:last, 1] += by
    result = clean(values, FPS, [np.arange(3)])
    assert [offset[:3] for offset in result.offsets] == [(1, first, last)]
    assert np.abs(result.values - truth)[first + 5 : last - 5, 1].max() < 1.5
    assert abs((result.values - truth)[first:last, 1].mean()) < 1.0
    untouched = clean(jitter(truth, 0.3), FPS, [np.arange(3)])
    assert rmse(result.values[:, [0, 2]], truth[:, [0, 2]]) < 1.1 * rmse(untouched.values[:, [0, 2]], truth[:, [0, 2]])


def test_motion_has_no_offsets() -> None:
    values = jitter(swing(600, FPS), 0.3)
    values[:, 0] += kick(600, FPS)
    values[:, 1] += heel_strike(600, FPS)
    values[:, 2] += 70 / (1 + np.exp(-(np.arange(600) - 300) / 8.0))  # a turn of 70 degrees in a third of a second
    assert not found(values)


@pytest.mark.parametrize("length", [1, 5, GAP])
def test_short_parts_are_left_to_the_search_for_artefacts(length: int) -> None:
    values = jitter(swing(600, FPS), 0.3)
    values[300 : 300 + length, 1] += 40.0
    assert not found(values)


def test_most_of_a_clip_is_not_the_displaced_part() -> None:
    values = jitter(swing(600, FPS), 0.3)
    values[100:500, 1] += 40.0
    assert not found(values)


def test_two_leaps_the_same_way_are_left() -> None:
    values = jitter(swing(600, FPS), 0.3)
    values[200:, 1] += 40.0
    values[400:, 1] += 40.0
    assert not found(values)


def test_offsets_one_after_the_other_are_each_found() -> None:
    values = jitter(swing(900, FPS), 0.3)
    values[100:180, 1] += 40.0
    values[400:460, 1] -= 25.0
    values[600:700, 2] += 25.0
    assert [(o.channel, o.first, o.last) for o in found(values)] == [(1, 100, 180), (1, 400, 460), (2, 600, 700)]


def test_a_channel_of_steps_is_left() -> None:
    """Values of 30 frames a second that are stored at 120 leap everywhere: no leap stands out."""
    assert not found(np.repeat(jitter(swing(150, 30.0), 1.0), 4, axis=0))


def test_clips_of_few_frames_have_none() -> None:
    values = jitter(swing(4 * GAP - 1, FPS), 0.3)
    values[20:, 1] += 40.0
    assert not found(values)
