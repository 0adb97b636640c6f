"""Laws of `clean`."""

from __future__ import annotations

import numpy as np
import pytest
from gestures import jitter, rmse, swing

from mocurve.denoising import clean
from mocurve.denoising.artefacts import Body
from mocurve.denoising.cleaning import SHORTEST, bridged

FPS, FRAMES = 120.0, 400
JOINTS = [np.arange(3), np.arange(3, 6)]


@pytest.fixture(scope="module")
def truth() -> np.ndarray:
    return swing(FRAMES, FPS, 6)


@pytest.fixture(scope="module")
def noisy(truth: np.ndarray) -> np.ndarray:
    """Jitter, spikes, a burst, a dropout, a gap."""
    values = jitter(truth, 0.5)
    values[[40, 90, 170], [0, 1, 4]] += [20.0, -20.0, 30.0]
    values[230:236, 2] += 30.0
    values[280:286, 3:] = values[279, 3:]
    values[330:340, :3] = np.nan
    return values


def test_all_artefacts_of_a_clip_are_found_and_told_apart(truth: np.ndarray, noisy: np.ndarray) -> None:
    result = clean(noisy, FPS, JOINTS)
    np.testing.assert_array_equal(result.lost, np.isnan(noisy))
    np.testing.assert_array_equal(result.masked, ~(np.abs(noisy - jitter(truth, 0.5)) == 0))
    assert result.frozen.sum() == 18
    assert rmse(result.values, truth) < 0.5 * 0.5
    np.testing.assert_allclose(result.sigma, 0.5, rtol=0.2)
    assert result.floor.all()
    assert (result.cutoff > 0.5 / FPS).all()
    assert (result.cutoff < 15 / FPS).all()


def test_the_same_comes_out_twice_and_the_input_stays(noisy: np.ndarray) -> None:
    before = noisy.copy()
    one, other = (clean(noisy, FPS, JOINTS) for _ in range(2))
    for mine, same in zip(one, other, strict=True):
        np.testing.assert_array_equal(mine, same)
    np.testing.assert_array_equal(noisy, before)


def test_the_order_of_channels_and_joints_does_not_matter(noisy: np.ndarray) -> None:
    order = np.array([4, 3, 5, 1, 2, 0])
    one, other = clean(noisy, FPS, JOINTS), clean(noisy[:, order], FPS, JOINTS)
    np.testing.assert_array_equal(other.masked, one.masked[:, order])
    np.testing.assert_allclose(other.values, one.values[:, order], atol=1e-9)


def test_a_joint_of_another_pool_changes_nothing(noisy: np.ndarray) -> None:
    alone = clean(noisy[:, :3], FPS, JOINTS[:1])
    both = clean(noisy, FPS, JOINTS, pools=[np.arange(3), np.arange(3, 6)])
    np.testing.assert_array_equal(both.masked[:, :3], alone.masked)
    np.testing.assert_array_equal(both.values[:, :3], alone.values)


@pytest.mark.parametrize("times", [0.125, -4.0, 0.01])
def test_the_unit_does_not_matter_where_the_body_is_told_in_it(noisy: np.ndarray, times: float) -> None:
    body = Body.of_degrees(6, FPS)
    larger = Body(*(abs(times) * limit for limit in body))
    one, other = clean(noisy, FPS, JOINTS, body=body), clean(times * noisy, FPS, JOINTS, body=larger)
    np.testing.assert_array_equal(other.masked, one.masked)
    np.testing.assert_allclose(other.values, times * one.values, rtol=1e-5, atol=1e-6 * abs(times))
    np.testing.assert_allclose(other.sigma, abs(times) * one.sigma, rtol=1e-6)


@pytest.mark.parametrize("by", [-90.0, 1000.0])
def test_a_constant_may_be_added(noisy: np.ndarray, by: float) -> None:
    one, other = clean(noisy, FPS, JOINTS), clean(noisy + by, FPS, JOINTS)
    np.testing.assert_array_equal(other.masked, one.masked)
    np.testing.assert_allclose(other.values, one.values + by, atol=1e-8)


def test_time_may_run_backwards(truth: np.ndarray, noisy: np.ndarray) -> None:
    values = noisy.copy()
    values[280:286, 3:] = jitter(truth, 0.5)[280:286, 3:]  # a frozen run repeats the frame before: it has a direction
    one, other = clean(values, FPS, JOINTS), clean(values[::-1], FPS, JOINTS)
    np.testing.assert_array_equal(other.masked[::-1], one.masked)
    np.testing.assert_allclose(other.values[::-1], one.values, atol=1e-6)


def test_noise_and_cut_off_are_of_frames_not_of_seconds(truth: np.ndarray) -> None:
    values = jitter(truth, 0.5)
    one, other = clean(values, 120.0, JOINTS), clean(values, 90.0, JOINTS)
    np.testing.assert_array_equal(other.sigma, one.sigma)
    np.testing.assert_array_equal(other.cutoff, one.cutoff)


def test_known_frames_are_left_out_whatever_they_say(truth: np.ndarray) -> None:
    values, known = jitter(truth, 0.5), np.zeros(truth.shape, bool)
    known[50:56, 1] = known[300, 4] = known[:2, 0] = True
    one = clean(values, FPS, JOINTS, known=known)
    other = clean(np.where(known, -40.0, values), FPS, JOINTS, known=known)
    np.testing.assert_array_equal(one.masked, known)
    np.testing.assert_allclose(other.values, one.values, atol=1e-7)
    missing = clean(np.where(known, np.nan, values), FPS, JOINTS, known=known)
    np.testing.assert_allclose(missing.values, one.values, atol=1e-7)


def test_noise_alone_becomes_about_its_mean() -> None:
    noise = np.random.default_rng(0).normal(size=(600, 6))
    result = clean(noise, FPS)
    assert not result.masked.any()
    assert np.abs(result.values - noise.mean(0)).max() < 0.75
    assert rmse(result.values, noise.mean(0)) < 0.2


def test_motion_without_noise_stays(truth: np.ndarray) -> None:
    result = clean(truth, FPS, JOINTS)
    assert not result.masked.any()
    assert rmse(result.values, truth) < 2e-3


def test_a_limit_takes_a_shake_out(truth: np.ndarray) -> None:
    """Of 2 degrees at 20 Hz: motion, as far as cross-validation can tell."""
    t = np.arange(FRAMES)[:, None] / FPS
    shaking = truth + 2.0 * np.sin(2 * np.pi * 20 * t)
    free, limited = clean(shaking, FPS, JOINTS), clean(shaking, FPS, JOINTS, limit=6.0)
    inner = slice(20, -20)
    assert rmse(free.values[inner], truth[inner]) > 1.0
    assert rmse(limited.values[inner], truth[inner]) < 0.1
    assert limited.cutoff.max() * FPS <= 6.0 + 1e-9


def test_a_limit_above_all_motion_changes_nothing(noisy: np.ndarray) -> None:
    np.testing.assert_array_equal(clean(noisy, FPS, JOINTS, limit=59.0).values, clean(noisy, FPS, JOINTS).values)


def test_more_strength_leaves_no_more_noise(truth: np.ndarray) -> None:
    """The residual grows with strength, and what shakes from frame to frame shrinks."""
    values = jitter(truth, 0.5)
    made = [clean(values, FPS, JOINTS, strength=strength).values for strength in (0.5, 1.0, 1.4, 1.8, 4.0)]
    left = [rmse(x, values) for x in made]
    shaking = [np.linalg.norm(np.diff(x, 3, axis=0)) for x in made]
    assert (np.diff(left) > -1e-9).all()
    assert (np.diff(shaking) < 1e-9).all()


@pytest.mark.parametrize("rho", [0.6, 0.8])
def test_strength_helps_where_noise_is_not_white(truth: np.ndarray, rho: float) -> None:
    rng, noise = np.random.default_rng(7), np.zeros((FRAMES, 6))
    for frame in range(1, FRAMES):
        noise[frame] = rho * noise[frame - 1] + 0.5 * np.sqrt(1 - rho**2) * rng.standard_normal(6)
    usual, more = (rmse(clean(truth + noise, FPS, JOINTS, strength=s).values, truth) for s in (1.0, 1.8))
    assert more < usual


@pytest.mark.parametrize("frames", [SHORTEST, 9, 10, 13, 20, 31])
@pytest.mark.parametrize("fps", [25.0, 120.0, 1000.0])
def test_short_clips_stay_near_their_samples(frames: int, fps: float) -> None:
    values = jitter(swing(frames, fps, 6), 0.3)
    result = clean(values, fps, JOINTS)
    assert np.isfinite(result.values).all()
    assert rmse(result.values, values) < 0.6


def test_the_rate_of_a_fast_camera_is_fine() -> None:
    truth = swing(1500, 1000.0)
    result = clean(jitter(truth, 0.5), 1000.0, JOINTS[:1])
    assert not result.masked.any()
    assert rmse(result.values, truth) < 0.15


def test_frames_missing_at_an_end_go_on_from_there_and_come_to_rest(truth: np.ndarray) -> None:
    values = jitter(truth, 0.2)
    values[:40, 0] = values[-30:, 1] = np.nan
    result = clean(values, FPS, JOINTS)
    assert np.abs(result.values[:40, 0] - result.values[40, 0]).max() < 15.0
    assert np.abs(np.diff(result.values[-4:, 1])).max() < 0.2
    assert np.abs(np.diff(result.values, 2, axis=0)).max() < 1.5


def test_a_bridge_is_a_straight_line_and_ends_are_held() -> None:
    y, bad = np.array([[9.0, 1.0, 9.0, 9.0, 4.0, 9.0], [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]]), np.zeros((2, 6), bool)
    bad[0, [0, 2, 3, 5]] = True
    bad[1] = True
    np.testing.assert_array_equal(bridged(y, bad), [[1, 1, 2, 3, 4, 4], [1, 2, 3, 4, 5, 6]])


def test_spikes_near_each_other_do_not_take_what_lies_between(truth: np.ndarray) -> None:
    values = jitter(truth, 0.5)
    spikes = [103, 106, 132]
    values[spikes, 1] += 20.0
    result = clean(values, FPS, JOINTS)
    np.testing.assert_array_equal(np.flatnonzero(result.masked[:, 1]), spikes)
