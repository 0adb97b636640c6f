"""Runs that leap out of the motion and back are foreign, kicks are not; what else a clip holds settles doubt."""

from __future__ import annotations

import numpy as np
import pytest
from gestures import jitter, swing

from mocurve.denoising import clean
from mocurve.denoising._bursts import pairs, pursue
from mocurve.denoising._evidence import LONGEST, evidence, root
from mocurve.denoising.bursts import FIRST, usual_odds

SIGMA, FPS, SMOOTHING = 0.3, 30.0, 0.5


def channel(seed: int = 0) -> np.ndarray:
    return jitter(swing(240, FPS, 3, seed), SIGMA, seed)[:, 0].copy()


def asked(y: np.ndarray, first: int, last: int, unit: float = 1.0) -> float:
    none, off = np.zeros(len(y), bool), np.empty(LONGEST)
    return float(evidence(y, unit * SIGMA, root(SMOOTHING), first, last, none, unit, off))


def left_out(y: np.ndarray, found: np.ndarray) -> np.ndarray:
    out = np.zeros(len(y), bool)
    usual = 0.5 * 1.4826 * float(np.median(np.abs(np.diff(y, 3))))
    pursue(y, SIGMA, SMOOTHING, usual, 1.0, FIRST, found, out)
    return out


@pytest.mark.parametrize("length", [3, 6, 10])
def test_the_evidence_is_for_a_plateau_and_against_plain_motion(length: int) -> None:
    y = channel()
    assert asked(y, 100, 100 + length) < 0
    y[100 : 100 + length] += 25.0
    assert asked(y, 100, 100 + length) > 0


def test_the_evidence_does_not_depend_on_unit_level_or_direction() -> None:
    y = channel()
    y[100:106] -= 20.0
    plain = asked(y, 100, 106)
    assert asked(7 * y + 1000, 100, 106, 7.0) == pytest.approx(plain, abs=1e-5)
    assert asked(y[::-1].copy(), len(y) - 106, len(y) - 100) == pytest.approx(plain, abs=1e-5)


def test_runs_lie_between_leaps_and_leave_out_what_is_given() -> None:
    y, given, none = channel(), np.zeros(240, bool), np.zeros(240, bool)
    y[100:106] += 30.0
    starts, ends = pairs(y, 15.0, none, given)
    assert (100, 106) in set(zip(starts.tolist(), ends.tolist(), strict=True))
    given[102] = True
    starts, ends = pairs(y, 15.0, none, given)
    assert not any(a <= 102 < b for a, b in zip(starts, ends, strict=True))


@pytest.mark.parametrize("sign", [-1, 1])
def test_what_a_search_found_is_given_back_where_it_hardly_leaps(sign: int) -> None:
    y, found = np.random.default_rng(0).normal(0.0, SIGMA, 240), np.zeros(240, bool)
    found[60:64] = True
    y[found] += 2.5 * sign
    assert -50.0 < asked(y, 60, 64) < -3.0
    assert not left_out(y, found).any()


@pytest.mark.parametrize("runs", [(100, 102, 107, 112), (100, 105, 113, 118), (100, 103, 104, 114)])
def test_two_runs_that_hide_each_other_stay(runs: tuple[int, int, int, int]) -> None:
    y, found = channel(), np.zeros(240, bool)
    found[runs[0] : runs[1]], found[runs[2] : runs[3]] = True, True
    y[found] += 180.0
    np.testing.assert_array_equal(left_out(y, found), found)


@pytest.mark.parametrize("last", [False, True])
def test_what_a_search_found_stays_where_it_is_foreign_also_at_the_ends_of_a_clip(last: bool) -> None:
    y, found = channel(), np.zeros(240, bool)
    found[[60, 61, 239 if last else 0]] = True
    y[found] += 25.0
    np.testing.assert_array_equal(left_out(y, found), found)


def test_a_search_that_took_the_motion_beside_a_run_for_foreign_is_put_right() -> None:
    y, run, found = channel(), np.zeros(240, bool), np.zeros(240, bool)
    run[100:110], found[110:116] = True, True
    y[run] += 25.0
    np.testing.assert_array_equal(left_out(y, found), run)


def test_a_run_too_long_to_be_weighed_stays_as_the_search_says() -> None:
    y, found = channel(), np.zeros(240, bool)
    found[100 : 100 + LONGEST + 1] = True
    np.testing.assert_array_equal(left_out(y, found), found)


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_bursts_at_30_fps_are_found_to_the_frame(seed: int) -> None:
    truth = swing(240, FPS, 3, seed)
    values, bad = jitter(truth, SIGMA, seed), np.zeros(truth.shape, bool)
    for first, length, where, off in ((40, 4, 0, 25.0), (90, 7, 1, -20.0), (150, 10, 2, 30.0), (200, 3, 0, -25.0)):
        values[first : first + length, where] += off
        bad[first : first + length, where] = True
    np.testing.assert_array_equal(clean(values, FPS, [np.arange(3)]).masked, bad)


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_a_doubtful_run_stays_where_it_is_alone_and_goes_among_others(seed: int) -> None:
    values, bad = jitter(swing(300, FPS, 3, seed), SIGMA, seed), np.zeros((300, 3), bool)
    values[150:152, 1] += 7.0
    assert not clean(values, FPS, [np.arange(3)]).masked.any()
    others = np.array([30, 60, 90, 210, 240, 270]), np.array([0, 2, 1, 0, 2, 1])
    values[others] += 40.0
    bad[others] = bad[150:152, 1] = True
    np.testing.assert_array_equal(clean(values, FPS, [np.arange(3)]).masked, bad)


def test_weak_odds_alone_make_nothing_usual_and_certain_ones_do() -> None:
    nothing = usual_odds(np.zeros(0), 0)
    assert nothing < -4
    for count in (1, 5, 100):
        assert usual_odds(np.full(count, 1.0), 0) < -2
        assert usual_odds(np.full(count, -9.0), 0) <= nothing
    assert usual_odds(np.full(30, 10.0), 0) > 2
    assert usual_odds(np.full(30, 10.0), 0) > usual_odds(np.r_[np.full(30, 10.0), np.full(30, -5.0)], 0) > -1
    assert usual_odds(np.zeros(2), 30) > 2
