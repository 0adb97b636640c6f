"""What is no motion is found, and what is motion stays."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest
from gestures import heel_strike, jitter, kick, rmse, swing

from mocurve.denoising import clean
from mocurve.denoising.artefacts import Body, believed, noise_level, repeats, runs

JOINT = [np.arange(3)]
SECONDS, SIGMA = 5, 0.5
FAST_RATES = [120.0, 60.0]


def seldom(frames: int, rng: np.random.Generator, lengths: tuple[int, int], count: int) -> Iterator[slice]:
    """Runs of that many frames, well apart."""
    for first in np.linspace(20, frames - 30, count).astype(int):
        yield slice(first, first + int(rng.integers(lengths[0], lengths[1] + 1)))


def with_artefacts(fps: float, seed: int, kind: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Truth, noisy values and the mask of the artefacts, (F, 3)."""
    rng, frames = np.random.default_rng(seed), round(SECONDS * fps)
    truth = swing(frames, fps, 3, seed)
    values = jitter(truth, SIGMA, seed)
    bad = np.zeros(values.shape, bool)
    lengths = {"spikes": (1, 1), "bursts": (3, 10), "flips": (1, 6), "frozen": (4, 8), "zeroed": (4, 8)}[kind]
    for some in seldom(frames, rng, lengths, 8):
        where = (some, slice(None) if kind in ("frozen", "zeroed") else int(rng.integers(3)))
        off = rng.choice([-1, 1]) * {"spikes": 20.0, "bursts": 25.0, "flips": 180.0}.get(kind, np.nan)
        values[where] = {"frozen": values[some.start - 1], "zeroed": 0.0}.get(kind, values[where] + off)
        bad[where] = True
    return truth, values, bad


@pytest.mark.parametrize("seed", [0, 1])
@pytest.mark.parametrize("fps", FAST_RATES)
@pytest.mark.parametrize("kind", ["spikes", "bursts", "flips", "frozen", "zeroed"])
def test_artefacts_are_found_to_the_frame_and_filled_in(kind: str, fps: float, seed: int) -> None:
    truth, values, bad = with_artefacts(fps, seed, kind)
    result = clean(values, fps, JOINT)
    np.testing.assert_array_equal(result.masked, bad)
    assert rmse(result.values, truth) < 0.6 * SIGMA
    assert np.abs(result.values - truth)[bad].max() < (4 if kind in ("spikes", "flips") else 10) * SIGMA
    if kind in ("frozen", "zeroed"):
        np.testing.assert_array_equal(result.frozen, bad)


@pytest.mark.parametrize("fps", FAST_RATES)
def test_a_spike_at_an_end_goes(fps: float) -> None:
    truth = swing(round(SECONDS * fps), fps)
    values, bad = jitter(truth, SIGMA), np.zeros(truth.shape, bool)
    for frame, channel in ((0, 0), (-1, 1), (1, 2), (-2, 2)):
        values[frame, channel] += 20.0
        bad[frame, channel] = True
    result = clean(values, fps, JOINT)
    np.testing.assert_array_equal(result.masked, bad)
    assert not result.offsets
    assert np.abs(result.values - truth)[bad].max() < 4.0


@pytest.mark.parametrize("seed", [0, 1, 2])
@pytest.mark.parametrize("fps", [*FAST_RATES, 30.0])
@pytest.mark.parametrize("event", [kick, heel_strike])
def test_a_kick_and_a_heel_strike_stay(event, fps: float, seed: int) -> None:
    frames = round(SECONDS * fps)
    calm, sharp = swing(frames, fps, 3, seed), event(frames, fps)
    truth = calm + np.outer(sharp, [0.0, 1.0, 0.3])
    result = clean(jitter(truth, SIGMA, seed), fps, JOINT)
    assert not result.masked.any()
    assert (result.values - calm)[:, 1].max() > 0.9 * sharp.max()
    assert rmse(result.values, truth) < 0.9 * SIGMA


@pytest.mark.parametrize(("fps", "least"), [(120.0, 0.8), (60.0, 0.8)])
def test_the_acceleration_of_a_kick_stays(fps: float, least: float) -> None:
    frames = round(SECONDS * fps)
    truth = swing(frames, fps) + kick(frames, fps)[:, None]
    kept = np.abs(np.diff(clean(jitter(truth, 0.2), fps, JOINT).values, 2, axis=0)).max(0)
    assert (kept > least * np.abs(np.diff(truth, 2, axis=0)).max(0)).all()


@pytest.mark.parametrize("seed", [0, 1, 2])
@pytest.mark.parametrize("last", [False, True])
def test_a_motion_that_speeds_up_to_an_end_stays(last: bool, seed: int) -> None:
    truth = swing(150, 30.0, 3, seed)
    truth[:, 1] += 50 * np.exp(np.arange(-149, 1) / 1.4)
    values = jitter(truth, 0.2, seed)
    assert not clean(values if last else values[::-1], 30.0, JOINT).masked.any()


def test_spikes_hide_no_frozen_run() -> None:
    truth = 0.1 * swing(600, 120.0)
    values, bad = jitter(truth, 0.2), np.zeros(truth.shape, bool)
    bad[100:110] = bad[300:310] = True
    values[100:110], values[300:310] = values[99], values[299]
    values[20::60, 1] += 180.0
    bad[20::60, 1] = True
    np.testing.assert_array_equal(clean(values, 120.0, JOINT).masked, bad)


@pytest.mark.parametrize("seed", [0, 2])
def test_rest_that_is_stored_in_coarse_steps_is_no_dropout(seed: int) -> None:
    rest = np.minimum(np.arange(600), 40)[:, None] * [0.2, 0.1, 0.3]  # it moves, then it stands
    values = np.round(jitter(rest, 0.04, seed), 1)
    assert len(runs(repeats(values.T))) > 20
    assert not clean(values, 120.0, JOINT).frozen.any()


@pytest.mark.parametrize("sigma", [0.0, 0.3])
@pytest.mark.parametrize("fps", FAST_RATES)
def test_a_knee_that_is_stopped_for_long_is_no_dropout(fps: float, sigma: float) -> None:
    t = np.arange(round(SECONDS * fps)) / fps
    knee = np.maximum(0.0, 40 * np.sin(2 * np.pi * 0.9 * t) + 20)[:, None]
    result = clean(np.where(knee > 0, jitter(knee, sigma), 0.0), fps)
    assert not result.masked.any()
    assert rmse(result.values, knee) < 0.2


def test_a_calm_clip_and_a_wild_one_lose_no_frame() -> None:
    for width in (0.0, 1.0, 4.0):
        assert not clean(jitter(width * swing(1200, 120.0, 12), SIGMA), 120.0).masked.any()


def test_an_artefact_of_one_channel_leaves_the_others_of_its_joint() -> None:
    truth = swing(400, 120.0)
    values = jitter(truth, SIGMA)
    clear = clean(values, 120.0, JOINT)
    values[200, 1] += 30.0
    spiky = clean(values, 120.0, JOINT)
    np.testing.assert_allclose(spiky.values[:, [0, 2]], clear.values[:, [0, 2]], atol=0.05)


@pytest.mark.parametrize("sigma", [0.05, 1.0])
def test_the_noise_level_sees_noise_and_not_motion_nor_spikes(sigma: float) -> None:
    y = jitter(swing(2000, 120.0, 4), sigma)
    y[::100] += 40.0
    np.testing.assert_allclose(noise_level(y.T), sigma, rtol=0.15)


def test_the_noise_level_of_few_frames_is_0() -> None:
    assert (noise_level(np.random.default_rng(0).normal(size=(3, 9))) == 0).all()


def test_runs_are_first_and_one_after_last() -> None:
    assert runs(np.array([1, 1, 0, 0, 1, 0, 1], bool)) == [(0, 2), (4, 5), (6, 7)]
    assert runs(np.zeros(4, bool)) == []
    assert runs(np.zeros(0, bool)) == []


def joint_that(rng: np.random.Generator, *frozen: tuple[int, int]) -> np.ndarray:
    y = rng.normal(size=(3, 200))
    y[2] = 5.0  # a channel that never moves says nothing
    for first, last in frozen:
        y[:, first:last] = y[:, first - 1, None]
    return y


def test_repeats_are_frames_at_which_all_of_a_joint_stands_still() -> None:
    y = joint_that(np.random.default_rng(0), (20, 23), (60, 75))
    y[0, 100:110] = y[0, 99]  # only one channel of two
    marked = np.zeros(200, bool)
    marked[20:23] = marked[60:75] = True
    np.testing.assert_array_equal(repeats(y), marked)


def test_a_frame_stored_twice_is_no_dropout() -> None:
    assert not repeats(joint_that(np.random.default_rng(0), (20, 21))).any()


def test_a_zeroed_run_begins_with_its_first_zero() -> None:
    y = joint_that(np.random.default_rng(0))
    y[:, 50:55] = 0.0
    y[2] = 5.0
    assert runs(repeats(y)) == [(50, 55)]


def test_a_joint_at_rest_and_one_of_held_samples_have_no_dropouts() -> None:
    rng = np.random.default_rng(0)
    assert not repeats(np.full((3, 100), 7.0)).any()
    assert not repeats(np.repeat(rng.normal(size=(3, 50)), 4, axis=1)).any()
    assert not repeats(joint_that(rng, (50, 120))).any()  # over 30 frames: at rest


def test_a_repeated_run_is_believed_where_the_curve_across_is_simpler() -> None:
    t = np.arange(60.0)
    y, frozen = np.array([t, t]), np.zeros((2, 60), bool)
    frozen[:, 20:26] = True
    y[:, 20:26] = y[:, 19, None]
    groups = [np.array([0]), np.array([1])]
    curves = np.array([t, t])
    curves[1, 20:26] += 50.0
    np.testing.assert_array_equal(believed(frozen, y, curves, np.zeros(2), frozen, groups), frozen & [[True], [False]])
    np.testing.assert_array_equal(believed(frozen, y, curves, np.zeros(2), ~frozen, groups), frozen)


def test_limits_of_lengths_follow_the_unit() -> None:
    body = Body.of_degrees(2, 100.0)
    metres, centimetres = (body.in_lengths(np.array([False, True]), unit) for unit in (1.0, 0.01))
    assert metres.sharpest[0] == centimetres.sharpest[0] == 10.0
    assert metres.sharpest[1] == pytest.approx(0.5 * np.radians(10.0))
    assert centimetres.leap[1] == pytest.approx(100 * metres.leap[1])
    assert np.isinf(body.in_lengths(np.array([False, True]), None).sharpest[1])
