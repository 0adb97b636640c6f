"""The pelvis: the banded least squares is the dense one, nothing asked shifts nothing."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import mocurve as mc
from mocurve.edit._hinge import Hinge, hinge_of
from mocurve.edit._pelvis import (
    BENDS,
    FROM,
    HURRIES,
    JERKS,
    QUICKENS,
    SIDEWAYS,
    UP,
    Legs,
    around,
    beyond_reach,
    shifted,
    spared,
)
from mocurve.edit._reach import LIMITS
from mocurve.feet.legs import centimetres, legs
from mocurve.kinematics import world, world_rotations

DT = 1 / 120


@pytest.fixture(scope="module")
def hinges(jump: Path) -> list[Hinge]:
    return hinged(jump, slice(100, 140))


def hinged(jump: Path, span: slice) -> list[Hinge]:
    motion = mc.read(jump)
    assert isinstance(motion, mc.Motion)
    motion = motion[span]
    parents, both = motion.skeleton.parents, legs(motion)
    places = centimetres(motion) * world(motion)
    return [
        hinge_of(motion, leg, places, world_rotations(motion, [leg.hip, parents[leg.knee], leg.knee, leg.ankle]))
        for leg in both
    ]


def pulling(hinges: list[Hinge]) -> list[tuple[Legs, np.ndarray]]:
    weight = np.linspace(0.0, 1.0, len(hinges[0].hip))
    return [
        (Legs(hinge, hinge.hip, np.abs(hinge.flexion), weight), hinge.ankle + np.array([1.0, -2.0, 0.5 * side]))
        for side, hinge in enumerate(hinges)
    ]


@pytest.mark.parametrize("hardest", [np.inf, JERKS])
def test_the_band_is_the_dense_least_squares(hinges: list[Hinge], hardest: float) -> None:
    pulls, frames = pulling(hinges), len(hinges[0].hip)
    at = 0.1 * np.sin(np.arange(3.0 * frames)).reshape(frames, 3)
    none = np.zeros(frames, bool)
    unit, rows, right = np.eye(3 * frames).reshape(3 * frames, frames, 3), [], []

    def add(row: np.ndarray, value: float, tolerance: float) -> None:
        rows.append(row / tolerance)
        right.append(value / tolerance)

    for f in range(frames):
        for axis, size in enumerate((SIDEWAYS, UP, SIDEWAYS)):
            add(unit[:, f, axis], 0.0, size)
            if 0 < f < frames - 1:
                second = unit[:, f - 1, axis] - 2 * unit[:, f, axis] + unit[:, f + 1, axis]
                add(second, 0.0, HURRIES * DT**2)
    for leg, target in pulls:
        to = leg.hip + at - target
        length = np.linalg.norm(to, axis=1)
        bend, slope = leg.hinge.bend(length)
        lines = np.einsum("kfa,fa->fk", unit, to * (slope / length)[:, None])
        off, now = leg.wanted - bend + lines @ at.ravel(), bend - leg.wanted
        for f in range(frames):
            if leg.weight[f] > 0:
                add(lines[f], off[f], BENDS / np.sqrt(leg.weight[f]))
            if 0 < f < frames - 1:
                jerk = abs(now[f - 1] - 2 * now[f] + now[f + 1]) / (QUICKENS * DT**2)
                weight = leg.weight[f] * min(1.0, hardest / jerk)
                tolerance = QUICKENS * DT**2 / np.sqrt(weight) if weight else np.inf
                add(lines[f - 1] - 2 * lines[f] + lines[f + 1], off[f - 1] - 2 * off[f] + off[f + 1], tolerance)
    expected = np.linalg.lstsq(np.array(rows), np.array(right), rcond=None)[0].reshape(frames, 3)
    found = shifted(pulls, at, none, DT, np.full(frames, hardest))
    assert np.abs(expected).max() > 0.1
    np.testing.assert_allclose(found, expected, atol=1e-8)


def test_what_shakes_for_a_frame_does_not_pull_the_hips_away(hinges: list[Hinge]) -> None:
    calm = pulling(hinges)
    none = np.zeros(len(hinges[0].hip), bool)
    hardest = np.full(len(none), JERKS)
    usual = shifted(calm, np.zeros_like(hinges[0].hip), none, DT, hardest)
    away = []
    for size in (1.0, 4.0):
        for _, target in (shaken := [(leg, target.copy()) for leg, target in calm]):
            target[20, 1] += size
        away.append(np.abs(shifted(shaken, np.zeros_like(hinges[0].hip), none, DT, hardest) - usual).max())
    assert 0.1 < away[1] < 2.0 * away[0]  # far less than in proportion


def test_feet_where_they_are_shift_nothing(hinges: list[Hinge]) -> None:
    frames = len(hinges[0].hip)
    still = [
        (Legs(h, h.hip, h.bend(np.linalg.norm(h.hip - h.ankle, axis=1))[0], np.ones(frames)), h.ankle) for h in hinges
    ]
    found = shifted(still, np.zeros((frames, 3)), np.zeros(frames, bool), DT)
    np.testing.assert_allclose(found, 0.0, atol=1e-9)


def test_where_it_is_fixed_the_pelvis_stays(hinges: list[Hinge]) -> None:
    frames = len(hinges[0].hip)
    fixed = np.arange(frames) < 12
    found = shifted(pulling(hinges), np.zeros((frames, 3)), fixed, DT)
    assert not found[fixed].any()
    assert np.abs(found[~fixed]).max() > 0.1
    assert np.abs(found[12]).max() < 0.1 * np.abs(found).max()


@pytest.mark.parametrize(("way", "limit"), [((0.0, 0.0, 1.0), "shift"), ((0.0, -1.0, 0.0), "drop")])
def test_hips_near_their_end_are_kept_within_it_and_only_there(
    jump: Path, way: tuple[float, float, float], limit: str
) -> None:
    hinges = hinged(jump, slice(0, 420))
    frames, fixed = 420, np.zeros(420, bool)
    bump = np.exp(-(((np.arange(420) - 210) / 20.0) ** 2))[:, None]

    def settled(size: float) -> tuple[list[tuple[Legs, np.ndarray]], np.ndarray]:
        one = np.ones(frames)
        pulls = [(Legs(h, h.hip, np.abs(h.flexion), one), h.ankle + size * bump * np.array(way)) for h in hinges]
        found = np.zeros((frames, 3))
        for _ in range(6):
            found = shifted(pulls, found, fixed, DT)
        return pulls, found

    def size(found: np.ndarray) -> np.ndarray:
        return np.linalg.norm(found[:, [0, 2]], axis=1) if limit == "shift" else -found[:, 1]

    asked = 1.0
    pulls, much = settled(asked)
    assert size(much).max() < FROM * LIMITS[limit]
    assert spared(pulls, much, fixed, DT) is much
    while size(much).max() <= LIMITS[limit]:
        asked *= 1.05
        pulls, much = settled(asked)
    kept = spared(pulls, much, fixed, DT)
    assert FROM * LIMITS[limit] < size(kept).max() < LIMITS[limit]
    far = np.abs(np.arange(frames) - 210) > 190
    assert np.abs(kept - much)[far].max() < 0.005
    assert np.abs(np.diff(kept, 2, axis=0)).max() < 2.0 * np.abs(np.diff(much, 2, axis=0)).max()  # without a jerk


def test_hips_are_lowered_smoothly_and_only_as_far_as_a_leg_is_too_short(hinges: list[Hinge]) -> None:
    frames = len(hinges[0].hip)
    stands, none = np.ones((2, frames), bool), np.zeros((frames, 3))
    pulls = [(Legs(h, h.hip, np.abs(h.flexion), np.ones(frames)), h.ankle.copy()) for h in hinges]
    assert not beyond_reach(pulls, none, stands, DT).any()  # as they are they reach
    pulls[1][1][20:24, 1] -= 40.0
    lower = beyond_reach(pulls, none, stands, DT)
    assert lower.min() >= 0.0 < lower[20:24].min()
    assert np.abs(np.diff(lower, 3)).max() < 0.02 * lower.max()
    assert not lower[20 + 3 + 36 :].any()
    for leg, ankle in pulls:
        straight = leg.hinge.length(np.zeros(frames))
        assert (np.linalg.norm(leg.hip - lower[:, None] * [0, 1, 0] - ankle, axis=1) <= straight + 1e-9).all()
    assert not beyond_reach(pulls, none, np.zeros((2, frames), bool), DT).any()  # no foot stands there


def test_around_is_above_every_need_and_nothing_far_away() -> None:
    need = np.zeros(200)
    need[[90, 100]] = 2.0, -1.0
    found = around(need, 20)
    assert (found >= need - 1e-12).all()
    assert found.min() >= 0.0
    assert found[90] == pytest.approx(2.0)
    assert found.max() <= 2.0 + 1e-12
    assert not found[:50].any()
    assert not found[131:].any()
