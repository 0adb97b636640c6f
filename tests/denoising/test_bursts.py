"""Runs that leap out of the motion and back are foreign, kicks are not."""

from __future__ import annotations

import numpy as np
import pytest
from gestures import jitter, swing

from mocurve.denoising import clean
from mocurve.denoising._bursts import odds, pairs

SIGMA, FPS, SMOOTHING = 0.3, 30.0, 0.5


def channel(seed: int = 0) -> np.ndarray:
    return jitter(swing(240, FPS, 3, seed), SIGMA, seed)[:, 0].copy()


def asked(y: np.ndarray, first: int, last: int) -> float:
    return odds(y, SIGMA, SMOOTHING, first, last, np.zeros(len(y), bool), 1.0)


@pytest.mark.parametrize("length", [3, 6, 10])
def test_the_evidence_is_for_a_plateau_and_against_plain_motion(length: int) -> None:
    y = channel()
    assert asked(y, 100, 100 + length) < 0
    y[100 : 100 + length] += 25.0
    assert asked(y, 100, 100 + length) > 0


def test_the_evidence_does_not_depend_on_unit_or_level() -> None:
    y = channel()
    y[100:106] -= 20.0
    given = np.zeros(len(y), bool)
    plain = odds(y, SIGMA, SMOOTHING, 100, 106, given, 1.0)
    scaled = odds(7 * y + 1000, 7 * SIGMA, SMOOTHING, 100, 106, given, 7.0)
    assert scaled == pytest.approx(plain, abs=1e-5)
    assert odds(y[::-1].copy(), SIGMA, SMOOTHING, len(y) - 106, len(y) - 100, given, 1.0) == pytest.approx(
        plain, abs=1e-5
    )


def test_runs_lie_between_leaps_and_leave_out_what_is_known() -> None:
    y, known = channel(), np.zeros(240, bool)
    y[100:106] += 30.0
    starts, ends = pairs(y, 15.0, known)
    assert (100, 106) in set(zip(starts.tolist(), ends.tolist(), strict=True))
    known[102] = True
    starts, ends = pairs(y, 15.0, known)
    assert not any(a <= 102 < b for a, b in zip(starts, ends, strict=True))


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_bursts_at_30_fps_are_found_to_the_frame(seed: int) -> None:
    truth = swing(240, FPS, 3, seed)
    values, bad = jitter(truth, SIGMA, seed), np.zeros(truth.shape, bool)
    for first, length, where, off in ((40, 4, 0, 25.0), (90, 7, 1, -20.0), (150, 10, 2, 30.0), (200, 3, 0, -25.0)):
        values[first : first + length, where] += off
        bad[first : first + length, where] = True
    np.testing.assert_array_equal(clean(values, FPS, [np.arange(3)]).masked, bad)
