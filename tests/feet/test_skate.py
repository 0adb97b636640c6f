"""Skate: a slide of known speed is measured as that, and a foot that is lifted has not kept its contact."""

from __future__ import annotations

import numpy as np
import pytest
from legged import FPS, stepping

from mocurve import Contact
from mocurve.feet.legs import legs
from mocurve.feet.skate import skate

SPAN = Contact("LToe", 10, 60, (0.0, 0.0, 0.0))


def test_a_slide_is_measured_in_centimetres_a_second() -> None:
    clip = stepping(7.0 * np.arange(100) / FPS, np.zeros(100), scale=0.01)
    found = skate(clip, [SPAN], legs(clip))
    assert found is not None
    assert found.speed == pytest.approx(7.0)
    assert found.drift == pytest.approx(7.0 * 25 / FPS)
    assert found.kept == 1.0
    assert found.penetration == pytest.approx(0.0, abs=1e-9)


def test_a_lifted_foot_is_told_by_the_source() -> None:
    source = stepping(np.zeros(100), np.zeros(100))
    up = np.where(np.arange(100) < 35, 0.0, 2.0)
    lifted = stepping(np.zeros(100), up)
    found = skate(lifted, [SPAN], legs(source), source)
    assert found is not None
    assert found.kept == pytest.approx(25 / 51)
    assert found.floating == pytest.approx(2.0 * 26 / 51)
    assert found.penetration == 0.0
    sunk = skate(stepping(np.zeros(100), -up), [SPAN], legs(source), source)
    assert sunk is not None
    assert sunk.penetration == pytest.approx(2.0 * 26 / 51)


def test_a_fast_foot_has_left() -> None:
    clip = stepping(np.concatenate([np.zeros(35), 40.0 * np.arange(65) / FPS]), np.zeros(100))
    found = skate(clip, [SPAN], legs(clip))
    assert found is not None
    assert found.kept == pytest.approx(25 / 51)
    quick = skate(clip, [SPAN], legs(clip), speed=45.0)
    assert quick is not None
    assert quick.kept == 1.0


def test_no_contact_no_numbers() -> None:
    clip = stepping(np.zeros(20), np.zeros(20))
    assert skate(clip, [], legs(clip)) is None
    assert skate(clip, [Contact("LToe", 3, 3, (0.0, 0.0, 0.0))], legs(clip)) is None
