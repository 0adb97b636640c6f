"""The cubic profile: what a player makes of it stays on the curves, wherever one looks."""

from __future__ import annotations

import numpy as np
import pytest
from glb import Glb, Keys
from hypothesis import given, settings
from hypothesis import strategies as st

import mocurve as mc
from mocurve import kinematics, rotation
from mocurve.formats._gltf_buffer import key_times

R3, P3 = ("Zrotation", "Xrotation", "Yrotation"), ("Xposition", "Yposition", "Zposition")
BODY = mc.Skeleton(("A", "B", "C"), [-1, 0, 1], np.eye(3), ((*P3, *R3), R3[:2], ()), [False, False, True], 1.0)
STEP = 1 / 30


def play(keys: Keys, times: np.ndarray) -> np.ndarray:
    """Values (N, n) as the specification has them (appendix C.5), quaternions wxyz of length 1."""
    if keys.interpolation == "LINEAR":
        assert len(keys.times) == 1
        result = np.repeat(keys.values, len(times), axis=0)
    else:
        at = keys.times.astype(float)
        k = np.clip(np.searchsorted(at, times, side="right") - 1, 0, len(at) - 2)
        h = (at[k + 1] - at[k])[:, None]
        u = np.clip((times - at[k])[:, None] / h, 0, 1)
        arriving, values, leaving = keys.values.astype(float).transpose(1, 0, 2)
        result = (
            (2 * u**3 - 3 * u**2 + 1) * values[k]
            + h * (u**3 - 2 * u**2 + u) * leaving[k]
            + (3 * u**2 - 2 * u**3) * values[k + 1]
            + h * (u**3 - u**2) * arriving[k + 1]
        )
    if result.shape[1] == 3:
        return result
    result = result[:, [3, 0, 1, 2]]
    return result / np.linalg.norm(result, axis=1, keepdims=True)


def curve(times, values, slopes=None, in_slopes=None) -> mc.HermiteCurve:
    return mc.HermiteCurve(times, values, np.zeros(len(times)) if slopes is None else slopes, in_slopes)


def keyed(curves: dict[str, mc.HermiteCurve], frames: int = 31) -> mc.KeyedMotion:
    """Those curves, and a still one for every other channel."""
    return mc.KeyedMotion(BODY, [curves.get(name, curve([0], [0])) for name in BODY.channel_names], STEP, frames)


def off(path, keys: mc.KeyedMotion, times: np.ndarray) -> tuple[float, float]:
    """Degrees and length units that the written file is off, at most, at these times."""
    mc.write(path, keys, profile="cubic")
    file = Glb(path).animation()
    values = np.column_stack([each.at(times) for each in keys.curves])
    meant = mc.Motion(BODY, values, STEP)
    turned = kinematics.rotations(meant)
    degrees = [
        rotation.angle(play(each, times), turned[:, BODY.joint(joint)]).max()
        for (joint, path), each in file.items()
        if path == "rotation"
    ]
    places = play(file["A", "translation"], times) if ("A", "translation") in file else np.zeros((len(times), 3))
    return max(degrees), float(np.abs(places - values[:, :3]).max())


FRAMES = np.arange(31 * 4 - 3) * STEP / 4


@pytest.mark.parametrize(
    "curves",
    {
        "keys of its own on every axis": {
            "A.Zrotation": curve([0, 0.3, 1], [0, 50, -20], [100, 50, 10]),
            "A.Xrotation": curve([0, 0.55, 1], [0, -80, 120], [0, -300, 0]),
            "A.Yrotation": curve([0, 0.1, 1], [10, 20, 40]),
            "A.Xposition": curve([0, 0.2, 1], [0, 3, 1], [10, -5, 2]),
            "A.Zposition": curve([0.25, 0.9], [0, -3], [10, -5]),
        },
        "many turns": {"A.Zrotation": curve([0, 1], [0, 3600]), "B.Xrotation": curve([0, 1], [0, -720], [700, 700])},
        "turns that samples do not see": {"A.Zrotation": curve([0, 1], [0, 5760], [5760, 5760])},
        "broken tangents": {
            "A.Zrotation": curve([0, 0.5, 1], [0, 90, 0], [90, -400, 0], [0, 300, 200]),
            "A.Yrotation": curve([0, 0.2, 1], [0, 30, 0], [0, 0, 10], [0, 200, 0]),
        },
        "keys between frames": {"A.Zrotation": curve([0.011, 0.512, 0.517, 0.98], [0, 90, 85, 0], [0, 99, 9, 0])},
        "keys before and after the clip": {"A.Zrotation": curve([-1, 0.5, 7], [0, 90, 0], [0, 200, 0])},
        "gimbal lock": {
            "A.Zrotation": curve([0, 1], [0, 170]),
            "A.Xrotation": curve([0, 0.5, 1], [60, 90, 60]),
            "A.Yrotation": curve([0, 1], [0, -160]),
        },
    }.items(),
    ids=lambda pair: pair[0],
)
def test_the_file_is_on_the_curves_everywhere(tmp_path, curves):
    degrees, length = off(tmp_path / "a.glb", keyed(curves[1]), FRAMES)
    assert degrees < 2e-3
    assert length < 1e-5


@settings(max_examples=25)
@given(seed=st.integers(0, 2**32 - 1), size=st.floats(1.0, 300.0))
def test_the_file_is_on_any_curves(tmp_path_factory, seed, size):
    random = np.random.default_rng(seed)
    curves = {}
    for name in BODY.channel_names:
        times = np.unique(np.append(random.integers(0, 30, 5), 30)) * STEP
        values, slopes, arriving = random.normal(size=(3, len(times))) * size
        curves[name] = curve(times, values, 5 * slopes, 5 * arriving)
    degrees, length = off(tmp_path_factory.mktemp("any") / "a.glb", keyed(curves), FRAMES)
    assert degrees < 2e-3
    assert length < 1e-6 * size * 5


def test_keys_stand_where_curves_have_theirs_and_more_only_where_they_are_needed(tmp_path):
    gentle = {"A.Zrotation": curve([0, 0.5, 1], [0, 1, 0]), "A.Xposition": curve([0, 1 / 3, 1], [0, 100, 50])}
    mc.write(tmp_path / "a.glb", keyed(gentle), profile="cubic")
    file = Glb(tmp_path / "a.glb").animation()
    assert file["A", "rotation"].times.tolist() == [0, 0.5, 1]
    assert file["A", "translation"].times.tolist() == np.float32([0, 1 / 3, 1]).tolist()
    assert file["A", "translation"].interpolation == "CUBICSPLINE"


def test_key_times_that_differ_by_rounding_are_one_key(tmp_path):
    tenth = curve([0, 0.1, 1], [0, 0.1, 0])
    near = curve([-0.0, 0.1 + 1e-12, 1], [0, 0.2, 0])
    mc.write(tmp_path / "a.glb", keyed({"A.Zrotation": tenth, "A.Xrotation": near}), profile="cubic")
    assert Glb(tmp_path / "a.glb").animation()["A", "rotation"].times.tolist() == np.float32([0, 0.1, 1]).tolist()


@pytest.mark.parametrize("width", [1e-9, 1e-6, 1e-3])
@pytest.mark.parametrize("steep", [False, True])
@pytest.mark.parametrize("start", [0.5, 0.1, 0.7])
def test_a_step_stays_a_step(tmp_path, width, steep, start):
    slopes = [0, 190 / width, 0, 0] if steep else [0] * 4
    arriving = [0, 0, 190 / width, 0] if steep else [0] * 4
    step = curve([0, start, start + width, 1], [10, 10, 200, 200], slopes, arriving)
    away = FRAMES[np.abs(FRAMES - start) > 2 * width + 1e-6]
    degrees, _ = off(tmp_path / "a.glb", keyed({"A.Zrotation": step, "A.Xrotation": curve([0, 1], [0, 9])}), away)
    assert degrees < 2e-3


def test_a_broken_tangent_is_met_at_its_frame_however_late(tmp_path):
    corners = curve(np.arange(90, 110) + STEP, np.arange(20) % 2 * 5.0, 3000.0 * np.cos(np.arange(20)), np.zeros(20))
    degrees, _ = off(tmp_path / "a.glb", keyed({"A.Zrotation": corners}, 3331), np.arange(91, 109) + STEP)
    assert degrees < 1e-4


def test_joints_on_long_levers_are_held_closer_so_that_none_is_further_off_in_space(tmp_path):
    names = [f"J{joint}" for joint in range(5)]
    arm = mc.Skeleton(names, np.arange(5) - 1, np.tile([0.0, 300, 0], (5, 1)), [R3] * 5, unit=0.001)
    random = np.random.default_rng(4)
    curves = [curve(np.arange(5) / 4, *random.normal(size=(2, 5)) * 60) for _ in arm.channel_names]
    keys = mc.KeyedMotion(arm, curves, STEP, 31)
    mc.write(tmp_path / "a.glb", keys, profile="cubic")
    file = Glb(tmp_path / "a.glb").animation()
    halves = keys.sample(STEP / 2)
    seen = np.stack([play(file[name, "rotation"], np.arange(61) * STEP / 2) for name in names], axis=1)
    meant = kinematics.world(halves)
    off = np.linalg.norm(kinematics.world(kinematics.with_rotations(halves, seen)) - meant, axis=2)
    assert 1e-4 < off.max() < 1e-3


def test_a_single_frame_has_a_key_without_tangents(tmp_path):
    mc.write(tmp_path / "a.glb", keyed({"A.Zrotation": curve([0, 1], [20, 30], [5, 5])}, 1), profile="cubic")
    keys = Glb(tmp_path / "a.glb").animation()["A", "rotation"]
    assert (keys.interpolation, keys.times.tolist()) == ("LINEAR", [0])


def test_key_times_rise_from_0_also_where_32_bits_cannot_tell_them_apart():
    times = key_times(np.array([-0.0, 1e-9, 20.0, 20.0 + 1e-9, 20.0 + 2e-9]), STEP)
    assert times.dtype == np.float32
    assert times[0] == 0
    assert (np.diff(times) > 0).all()
    assert times[2:] == pytest.approx(20, abs=1e-5)


def test_long_clips_lose_nothing_to_the_rounding_of_their_times(tmp_path):
    shaking = curve(100 + np.arange(31) * STEP, np.arange(31) % 2 * 90.0)
    times = 100 + FRAMES
    degrees, _ = off(tmp_path / "a.glb", keyed({"A.Zrotation": shaking}, 3031), times)
    assert degrees < 2e-3


def test_tangents_too_large_for_32_bits_are_refused(tmp_path):
    steep = keyed({"A.Zrotation": curve([0, 1], [0, 0], [1e300, 0])})
    with pytest.raises(
        mc.OptionError, match=r"tangents, rotation of joint 'A': .* is too large for the 32-bit numbers"
    ):
        mc.write(tmp_path / "a.glb", steep, profile="cubic")


def test_curves_that_run_wild_get_eight_keys_a_frame_and_no_more(tmp_path):
    wild = {"A.Zrotation": curve([0, 1], [0, 1e9])}
    mc.write(tmp_path / "a.glb", keyed(wild), profile="cubic")
    assert len(Glb(tmp_path / "a.glb").animation()["A", "rotation"].times) == 8 * 30 + 1
