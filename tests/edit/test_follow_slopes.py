"""follow on paths with heights: every held foot and its sole stand on the path beside it, knees stay calm, hips sink as
far as a leg must reach."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from paths import edges, measured, off

import mocurve as mc
from mocurve import rotation
from mocurve.edit.path_edit import PathEdit
from mocurve.feet.legs import legs, tracks
from mocurve.kinematics import rotations, world


def ramp(length: float, slope: float) -> mc.Path:
    return mc.Path([(0, 0, 0), (0, slope * length, length)])


@pytest.mark.parametrize("height", [0.0, 12.0])
def test_on_a_level_path_with_heights_feet_are_lifted_as_the_body_is(
    height: float, captured: Callable[[str], mc.Motion]
) -> None:
    clip = captured("02_01_walk_blender")
    edit = PathEdit.of(clip)
    level = mc.Path([(0, height, 0), (0, height, 100)])
    each, lifted, flat = edit.laid(level), edit.laid(level, posture="lift"), edit.laid(mc.Path([(0, 0), (0, 100)]))
    assert off(each, lifted) < 1e-9
    np.testing.assert_allclose(world(each), world(flat) + np.array([0, height, 0]), atol=1e-9)


@pytest.mark.parametrize(("name", "slope"), [("12_01_walk", 0.2), ("02_01_walk_blender", 0.1), ("12_01_walk", -0.2)])
def test_on_a_slope_every_foot_stands_on_it(name: str, slope: float, captured: Callable[[str], mc.Motion]) -> None:
    clip = captured(name)[1:]
    hill = ramp(100, slope)
    edit = PathEdit.of(clip)
    made, lifted = edit.laid(hill), edit.laid(hill, posture="lift")
    told = measured(made)["feet"]
    assert told["released"] == 0
    assert told["speed"] < 0.01
    both, scale = legs(clip), 5.6444
    own, now, level = (tracks(motion, both)[0] for motion in (clip, made, lifted))
    for leg, before, after, rode in zip(both, own, now, level, strict=True):
        for contact in mc.contacts(clip):
            span = slice(contact.first, contact.last + 1)
            if contact.joint != clip.skeleton.names[leg.ball]:
                continue
            over = after[span, 1] - slope * after[span, 2]
            assert scale * np.abs(over - before[span, 1]).max() < 0.01
            floats = rode[span, 1] - slope * rode[span, 2]
            assert scale * np.abs(floats - before[span, 1]).max() > 40 * abs(slope) * 0.3  # a body that is lifted
    assert edges(made) < 1.1 * edges(clip)


def soles(motion: mc.Motion, source: mc.Motion, slope: float) -> float:
    """How far heels in contact are from a slope at most, cm, beside their height over the floor of the source."""
    both, away = legs(source), [0.0]
    for leg, now, own in zip(both, tracks(motion, both)[1], tracks(source, both)[1], strict=True):
        for contact in mc.contacts(source):
            span = slice(contact.first, contact.last + 1)
            if contact.joint == source.skeleton.names[leg.ankle]:
                away.append(float(np.abs(now[span, 1] - slope * now[span, 2] - own[span, 1]).max()))
    return 5.6444 * max(away)


@pytest.mark.parametrize("slope", [0.1, -0.1])
def test_soles_lie_along_the_slope_that_they_stand_on(slope: float, captured: Callable[[str], mc.Motion]) -> None:
    clip = captured("02_01_walk_blender")
    made = PathEdit.of(clip).laid(ramp(100, slope))
    assert soles(made, clip, slope) < 0.4
    found = {(contact.joint, contact.first // 30) for contact in mc.contacts(made)}
    assert found >= {(contact.joint, contact.first // 30) for contact in mc.contacts(clip)}  # all stand on one ramp
    assert soles(mc.follow(clip, ramp(100, slope), posture="lift"), clip, slope) > 1.0
    level = mc.follow(made, ramp(100, 0.0))
    assert soles(level, clip, 0.0) < 0.4  # off the slope again they lie on the floor


@pytest.mark.parametrize("slope", [0.1, -0.1])
@pytest.mark.parametrize("name", ["12_01_walk", "02_01_walk_blender"])
def test_on_slopes_knees_stay_calm(name: str, slope: float, captured: Callable[[str], mc.Motion]) -> None:
    clip = captured(name)[1:]
    made = mc.follow(clip, ramp(100, slope))
    assert measured(made)["feet"]["released"] == 0
    knees = [leg.knee for leg in legs(clip)]
    own, now = (np.array([quickening(motion, knee) for knee in knees]) for motion in (clip, made))
    assert now.max() < 1.25 * own.max()
    assert np.percentile(now, 99) < 1.15 * np.percentile(own, 99)


def quickening(motion: mc.Motion, joint: int) -> np.ndarray:
    turned = rotations(motion)[:, joint]
    steps = rotation.log(rotation.mul(rotation.inv(turned[:-1]), turned[1:]))
    return np.linalg.norm(np.diff(steps, axis=0), axis=1)


def test_over_a_hill_of_twenty_degrees_every_foot_is_held(captured: Callable[[str], mc.Motion]) -> None:
    clip = captured("12_01_walk")[1:]
    hill = mc.Path([(0, 0, 0), (0, 0, 10), (0, 0, 20), (0, 13, 40), (0, 0, 60), (0, 0, 70), (0, 0, 80)])
    assert np.degrees(np.abs(hill.slope(np.linspace(0, 1, 200))).max()) > 18
    made = measured(mc.follow(clip, hill))["feet"]
    assert made["released"] == 0
    assert made["speed"] < 0.01


def test_a_path_too_steep_to_stand_on_lifts_the_body_and_says_so(captured: Callable[[str], mc.Motion]) -> None:
    clip = captured("02_01_walk_blender")
    with pytest.warns(UserWarning, match="steeper than 45 degrees: feet are lifted as the body is"):
        made = mc.follow(clip, ramp(100, 1.2))
    lifted = mc.follow(clip, ramp(100, 1.2), posture="lift")
    np.testing.assert_allclose(world(made), world(lifted), atol=1e-9)
