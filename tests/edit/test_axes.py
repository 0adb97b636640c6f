"""axes: every place is turned by a quarter, the way back gives every digit back, and nothing is computed but signs."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from walks import STEP, walk

import mocurve as mc
from mocurve import UnknownName, cli, rotation
from mocurve.kinematics import rest_height, rotations, world
from mocurve.skeleton import AXES, JointLimits

PAIRS = [(up, to) for up in "xyz" for to in "xyz"]
MIXED = (
    ("Zposition", "Xposition", "Yposition", "Yrotation", "Xrotation", "Zrotation"),
    ("Xrotation",),
    ("Zrotation", "Yrotation"),
    ("Yposition", "Zrotation", "Xrotation", "Yrotation"),
    ("Xrotation", "Zrotation", "Xrotation"),
    (),
)


def mixed() -> mc.Motion:
    """A body with joints of all kinds of channels."""
    body = replace(walk(2).skeleton, channels=MIXED)
    values = 40.0 * np.random.default_rng(2).normal(size=(30, body.channel_count))
    return mc.Motion(body, values, STEP)


def turned(places: np.ndarray, up: str, to: str) -> np.ndarray:
    """Places (..., 3) after the quarter that takes one axis to another."""
    a, b = "xyz".index(up), "xyz".index(to)
    made = places.copy()
    if a != b:
        made[..., b], made[..., a] = places[..., a], -places[..., b]
    return made


@pytest.mark.parametrize(("up", "to"), PAIRS)
@pytest.mark.parametrize("clip", [mixed(), walk(40, 0.3)], ids=["mixed", "walk"])
def test_every_place_is_turned_and_comes_back(clip: mc.Motion, up: str, to: str) -> None:
    made = mc.axes(clip, up=up, to=to)
    np.testing.assert_allclose(world(made), turned(world(clip), up, to), atol=1e-9)
    assert np.array_equal(np.sort(np.abs(made.values)), np.sort(np.abs(clip.values)))  # nothing but signs
    back = mc.axes(made, up=to, to=up)
    assert back.values.tobytes() == clip.values.tobytes()
    assert np.array_equal(back.skeleton.offsets, clip.skeleton.offsets)
    assert back.skeleton.channels == clip.skeleton.channels
    assert made.history[-1] == {"verb": "axes", "up": up, "to": to}
    if up == to:
        assert made.values.tobytes() == clip.values.tobytes()


def test_keys_and_splines_stay_what_they_are() -> None:
    clip = walk(80, 0.3)
    for curves in (mc.reduce(clip, tolerance="2deg"), mc.fit(clip, tolerance="5deg")):
        made = mc.axes(curves)
        assert type(made) is type(curves)
        assert made.keys == curves.keys
        np.testing.assert_allclose(world(made.sample()), turned(world(curves.sample()), "z", "y"), atol=1e-9)
        back = mc.axes(made, up="y", to="z")
        assert back.sample().values.tobytes() == curves.sample().values.tobytes()


def test_broken_tangents_stay_broken() -> None:
    clip = walk(8)
    curves = [mc.HermiteCurve([0, 1], [k, k + 2], [1, 2], [-1, -k]) for k in range(clip.values.shape[1])]
    keys = mc.KeyedMotion(clip.skeleton, tuple(curves), STEP, 8)
    made = mc.axes(mc.axes(keys), up="y", to="z")
    assert all(curve.broken for curve in made.curves)
    for name in ("values", "slopes", "in_slopes"):
        assert [getattr(c, name).tolist() for c in made.curves] == [getattr(c, name).tolist() for c in curves]


@pytest.mark.parametrize("askew", [[1.0, 0.0, 0.0, 0.0], [0.8, 0.0, 0.6, 0.0]], ids=["channels", "askew"])
@pytest.mark.parametrize(("up", "to"), PAIRS)
def test_joint_limits_turn_with_the_body(up: str, to: str, askew: list[float]) -> None:
    clip, about = walk(60), np.array(askew)
    own = rotation.mul(rotation.mul(rotation.inv(about), rotations(clip)[:, 1]), about)
    low, high = np.percentile(rotation.to_euler(own, "ZXY"), [11, 93], axis=0)
    limits = JointLimits(1, about, "ZXY", low, high)
    limited = replace(clip, skeleton=replace(clip.skeleton, limits=(limits,)))
    there, here = mc.axes(mc.limit(limited), up=up, to=to), mc.limit(mc.axes(limited, up=up, to=to))
    np.testing.assert_allclose(world(here), world(there), atol=1e-4)
    assert np.abs(world(there) - world(mc.axes(clip, up=up, to=to))).max() > 1


def test_a_capture_with_z_up_is_laid_along_a_path(jump: Path, tmp_path: Path) -> None:
    clip = mc.read(jump).sample()
    mc.write(tmp_path / "z_up.bvh", mc.axes(clip, up="y", to="z"), lossless=True)
    z_up = mc.read(tmp_path / "z_up.bvh")
    path = mc.Path([(0, 10), (28, 25), (40, 40)])
    with pytest.warns(UserWarning, match="seems to stand along z: .* if z is up here, axes turns it"):
        mc.follow(z_up, path, lock_feet=False)
    again = mc.axes(z_up).sample()
    assert rest_height(again) == rest_height(clip)
    assert again.values.tobytes() == clip.values.tobytes()
    assert mc.follow(again, path).values.tobytes() == mc.follow(clip, path).values.tobytes()


@pytest.mark.parametrize("verb", [mc.contacts, mc.lock_feet])
def test_who_looks_for_feet_tells_that_z_may_be_up(verb: Callable[[mc.Motion], object], jump: Path) -> None:
    clip = mc.read(jump).sample()
    with pytest.warns(UserWarning, match="seems to stand along z: feet stand on the ground .* axes turns it"):
        verb(mc.axes(clip, up="y", to="z").sample())


def test_markers_are_turned_too() -> None:
    places = np.random.default_rng(1).normal(size=(5, 3, 3))
    kinds = (("Xposition", "Yposition", "Zposition"),) * 3
    markers = mc.Motion(mc.Skeleton(("A", "B", "C"), [-1] * 3, np.zeros((3, 3)), kinds), places.reshape(5, 9), STEP)
    made = mc.axes(markers)
    np.testing.assert_array_equal(world(made), turned(places, "z", "y"))
    assert made.skeleton.channels == kinds


def test_an_axis_that_is_none_is_told() -> None:
    for options in ({"up": "Z"}, {"to": "up"}):
        with pytest.raises(UnknownName, match="axis"):
            mc.axes(walk(3), **options)
    assert AXES.lower() == "xyz"


def test_the_command_turns_a_file(
    jump: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert cli.main(["axes", str(jump), "-o", "z_up.bvh", "--up", "y", "--to", "z", "--lossless"]) == 0
    assert cli.main(["axes", "z_up.bvh", "-o", "again.bvh", "--lossless", "--json"]) == 0
    assert '"to": "y"' in capsys.readouterr().out
    assert mc.read("again.bvh").values.tobytes() == mc.read(jump).values.tobytes()
