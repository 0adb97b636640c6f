"""Keys for slerp and straight lines: the promise at every frame, measured by code of its own."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from math import atan2, sin, sqrt
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import mocurve as mc
from mocurve import Motion, OptionError, Skeleton
from mocurve.feet.planted import planted
from mocurve.kinematics import rest_height
from mocurve.reduction import linear, slerp_search
from mocurve.reduction.slerp import JointTracks, Track, joint_keys

Places = Callable[[Skeleton, np.ndarray], np.ndarray]
TURNS = ("Zrotation", "Xrotation", "Yrotation")


def shown(track: Track, frames: int, frame_time: float, single: bool = False) -> np.ndarray:
    """(F, n) what three.js shows at every frame: its slerp for quaternions, scalar by scalar. single: as files keep
    times and values."""
    kind = np.float32 if single else np.float64
    times, values = (track.frames * frame_time).astype(kind).astype(float), track.values.astype(kind).astype(float)
    result = np.empty((frames, values.shape[1]))
    for f in range(frames):
        t = f * frame_time
        k = min(max(int(np.searchsorted(times, t, side="right")) - 1, 0), max(len(times) - 2, 0))
        a, b = values[k], values[min(k + 1, len(values) - 1)]
        part = 0.0 if len(times) == 1 else min(max((t - times[k]) / (times[k + 1] - times[k]), 0.0), 1.0)
        first, second = 1.0 - part, part
        if len(a) == 4:
            cosine = float(a @ b)
            side = 1.0 if cosine >= 0 else -1.0
            sine_squared = 1.0 - cosine * cosine
            if sine_squared > np.finfo(float).eps:
                sine = sqrt(sine_squared)
                arc = atan2(sine, cosine * side)
                first, second = sin(first * arc) / sine, sin(second * arc) / sine
            second *= side
        result[f] = first * a + second * b
    return result / np.linalg.norm(result, axis=1, keepdims=True) if values.shape[1] == 4 else result


def matrices(q: np.ndarray) -> np.ndarray:
    """(F, 3, 3) of quaternions (F, 4)."""
    w, x, y, z = q.T
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return np.array(rows).transpose(2, 0, 1)


def local_turns(clip: Motion) -> list[np.ndarray]:
    """Per joint the matrices (F, 3, 3) of its rotation, by a product over its channels."""
    turns, columns = [], iter(clip.values.T)
    for kinds in clip.skeleton.channels:
        turn = np.tile(np.eye(3), (clip.frames, 1, 1))
        for kind in kinds:
            column = np.radians(next(columns))
            if kind.endswith("rotation"):
                axis = "XYZ".index(kind[0])
                half = np.zeros((clip.frames, 4))
                half[:, 0], half[:, 1 + axis] = np.cos(column / 2), np.sin(column / 2)
                turn = turn @ matrices(half)
        turns.append(turn)
    return turns


def astray(clip: Motion, keys: JointTracks, places: Places, single: bool = False) -> tuple[np.ndarray, np.ndarray]:
    """How far every joint is from where it was, (F, J) file units, and how far it turned from its rotation, degrees."""
    skeleton, source = clip.skeleton, local_turns(clip)
    now = np.empty((clip.frames, len(skeleton.names), 3))
    angles = np.zeros((clip.frames, len(skeleton.names)))
    before = places(skeleton, clip.values)
    turns: list[np.ndarray] = []
    for j, parent in enumerate(skeleton.parents):
        at = np.tile(skeleton.offsets[j], (clip.frames, 1))
        if keys.positions[j] is not None:
            at = shown(keys.positions[j], clip.frames, clip.frame_time, single)
        turn = source[j]
        if keys.rotations[j] is not None:
            turn = matrices(shown(keys.rotations[j], clip.frames, clip.frame_time, single))
            apart = np.linalg.norm(turn - source[j], axis=(1, 2)) / sqrt(8.0)  # sine of half the angle
            angles[:, j] = np.degrees(2.0 * np.arcsin(np.minimum(apart, 1.0)))
        now[:, j] = at if parent < 0 else now[:, parent] + np.einsum("fab,fb->fa", turns[parent], at)
        turns.append(turn if parent < 0 else turns[parent] @ turn)
    return np.linalg.norm(now - before, axis=2), angles


def tracks_of(keys: JointTracks) -> list[Track]:
    return [track for track in (*keys.rotations, *keys.positions) if track is not None]


def count(keys: JointTracks) -> int:
    return sum(len(track.frames) for track in tracks_of(keys))


def one_joint(values: Sequence[Sequence[float]] | np.ndarray, channels: Sequence[str] = TURNS) -> Motion:
    """A bone of length 10."""
    skeleton = Skeleton(("Arm", "Arm_End"), [-1, 0], [[0, 0, 0], [0, 10, 0]], (tuple(channels), ()), [False, True])
    return Motion(skeleton, np.asarray(values, float).reshape(-1, len(channels)), 1 / 60)


@pytest.fixture(scope="session")
def cut(jump: Path) -> Motion:
    """Sixty frames of a jump, from the ground into the air."""
    return mc.read(jump)[100:160]


# -- the promise ---------------------------------------------------------------------------------------------------
@pytest.mark.parametrize("single", [False, True], ids=["double", "single"])
@pytest.mark.parametrize("percent", [0.05, 0.5])
def test_no_joint_leaves_its_limit(cut: Motion, places: Places, percent: float, single: bool) -> None:
    limit = percent / 100 * rest_height(cut)
    off, _ = astray(cut, joint_keys(cut, f"{percent}%height"), places, single)
    assert off.max() <= limit
    assert off[planted(cut).T].max() <= 0.25 * limit
    free, _ = astray(cut, joint_keys(cut, f"{percent}%height", feet=1.0), places, single)
    assert 0.25 * limit < free[planted(cut).T].max() <= limit
    assert np.median(free.max(axis=1)) > 0.5 * limit  # the room is used


@pytest.mark.parametrize("degrees", [0.05, 1.0])
def test_no_joint_turns_beyond_its_limit(cut: Motion, places: Places, degrees: float) -> None:
    keys = joint_keys(cut, f"{degrees}deg")
    _, angles = astray(cut, keys, places)
    assert 0.9 * degrees < angles.max() <= degrees
    moved = shown(keys.positions[0], cut.frames, cut.frame_time) - cut.values[:, :3]
    assert np.abs(moved).max() <= np.radians(degrees) * rest_height(cut)


def test_several_limits_hold_together_for_joints_and_times(cut: Motion, places: Places) -> None:
    rules = ["0.5%height", "0.6deg", "LeftHand=0.1%height", "LeftArm=0.2deg", "@0.1..0.2=0.05%height"]
    off, angles = astray(cut, joint_keys(cut, rules, feet=1.0), places)
    height, names = rest_height(cut), cut.skeleton
    times = np.arange(cut.frames) * cut.frame_time
    inside = (times >= 0.1 - 1e-9) & (times <= 0.2 + 1e-9)
    assert off.max() <= 0.005 * height
    assert off[inside].max() <= 0.0005 * height < off[~inside].max()
    assert off[~inside, names.joint("LeftHand")].max() <= 0.001 * height
    assert angles.max() <= 0.6
    assert angles[:, names.joint("LeftArm")].max() <= 0.2 < angles.max()


def test_reduced_keys_are_held_to_the_capture(cut: Motion, places: Places) -> None:
    reduced = mc.reduce(cut, tolerance=["0.3%height", "2deg"], feet=0.5)
    keys = joint_keys(reduced)
    off, angles = astray(cut, keys, places)
    limit = 0.003 * rest_height(cut)
    assert off.max() <= limit
    assert 0.25 * limit < off[planted(cut).T].max() <= 0.5 * limit
    assert angles.max() <= 2.0
    refined = joint_keys(mc.refine(reduced, cut))
    assert count(refined) == count(keys)  # the same capture, the same limits


def test_keys_without_their_capture_are_held_to_their_own_samples(cut: Motion, places: Places) -> None:
    reduced = mc.reduce(cut, tolerance="3%height")
    alone = replace(reduced, report=None)
    off, _ = astray(alone.sample(), joint_keys(alone), places)
    assert off.max() <= 0.001 * rest_height(cut)
    edited = replace(reduced, curves=tuple(reversed(reduced.curves)))  # its report tells of other curves
    off, _ = astray(edited.sample(), joint_keys(edited, "1%height"), places)
    assert off.max() <= 0.01 * rest_height(cut)


@given(data=st.data())
@settings(max_examples=40)
def test_hostile_clips_are_kept_within_every_kind_of_limit(
    data: st.DataObject, hostile: Callable[..., st.SearchStrategy[Motion]], places: Places
) -> None:
    clip = data.draw(hostile())
    rule = data.draw(st.sampled_from([["0.5u"], ["2deg"], ["0.05u", "10deg"], ["0u"], ["0deg"], ["5%range"]]))
    try:
        keys = joint_keys(clip, rule)
    except OptionError as refused:
        if "leaves it free" not in str(refused):
            raise
        return
    off, angles = astray(clip, keys, places)
    size = 1e-9 * (1.0 + np.abs(clip.values).max(initial=0.0))  # rounding of what is measured
    for text in rule if clip.frames else []:
        if text.endswith("u"):
            assert off.max(initial=0.0) <= float(text[:-1]) + size
        if text.endswith("deg"):
            assert angles.max(initial=0.0) <= float(text[:-3]) + 1e-5
    for track in tracks_of(keys):
        well_formed(track, clip.frames)


def well_formed(track: Track, frames: int) -> None:
    assert track.frames.dtype == np.int64
    assert len(track.frames) == len(track.values) <= max(frames, 0)
    assert np.isfinite(track.values).all()
    if frames:
        assert track.frames[0] == 0
        assert len(track.frames) == 1 or track.frames[-1] == frames - 1
    assert (np.diff(track.frames) > 0).all()
    if track.values.shape[1] == 4:
        np.testing.assert_allclose(np.linalg.norm(track.values, axis=1), 1.0, atol=1e-12)
        assert (np.sum(track.values[1:] * track.values[:-1], axis=1) >= 0.0).all()
    else:
        assert track.values.shape[1] == 3


# -- what the tracks are -------------------------------------------------------------------------------------------
def test_joints_without_channels_have_no_track(cut: Motion) -> None:
    keys = joint_keys(cut)
    for kinds, turn, place in zip(cut.skeleton.channels, keys.rotations, keys.positions, strict=True):
        assert (turn is not None) == any(kind.endswith("rotation") for kind in kinds)
        assert (place is not None) == any(kind.endswith("position") for kind in kinds)


@pytest.mark.parametrize("rule", ["0.1%height", "0.1deg"])
def test_a_joint_that_rests_has_one_key(rule: str) -> None:
    clip = one_joint(np.tile([10.0, 20.0, 30.0], (50, 1)))
    (track,) = tracks_of(joint_keys(clip, rule))
    assert track.frames.tolist() == [0]


@pytest.mark.parametrize("rule", ["0u", "0deg", "1e-9u", "1e-9deg"])
def test_no_tolerance_keeps_every_sample(rule: str, places: Places) -> None:
    clip = one_joint(np.random.default_rng(0).normal(0, 40, (30, 3)))
    (track,) = tracks_of(joint_keys(clip, rule))
    assert track.frames.tolist() == list(range(30))
    assert astray(clip, JointTracks((track, None), (None, None)), places)[1].max() < 1e-6


@pytest.mark.parametrize("frames", [0, 1, 2])
@pytest.mark.parametrize("rule", ["0.1u", "0.1deg"])
def test_short_clips(frames: int, rule: str) -> None:
    values = np.array([[0.0, 0.0, 0.0], [50.0, 10.0, 0.0]])[:frames]
    (track,) = tracks_of(joint_keys(one_joint(values), rule))
    assert track.frames.tolist() == list(range(frames))
    well_formed(track, frames)


@pytest.mark.parametrize("rule", ["0.05u", "0.5deg"])
def test_half_turns_between_frames_stay_on_their_side(rule: str, places: Places) -> None:
    angles = np.cumsum([0, 180, 180, 90, 179.999, -180, 120, 120, 120, 170, 170, 170, -175, 30] * 3)
    clip = one_joint(np.stack([angles, 0 * angles, 0 * angles], axis=1))
    keys = joint_keys(clip, rule)
    off, turned = astray(clip, keys, places, single=True)
    assert off.max() <= 0.05 if rule.endswith("u") else turned.max() <= 0.5
    well_formed(keys.rotations[0], clip.frames)


def test_the_result_is_the_same_each_time(cut: Motion) -> None:
    first, second = (joint_keys(cut, "0.2%height") for _ in range(2))
    for a, b in zip(tracks_of(first), tracks_of(second), strict=True):
        np.testing.assert_array_equal(a.frames, b.frames)
        np.testing.assert_array_equal(a.values, b.values)


def test_what_nothing_limits_is_refused() -> None:
    skeleton = Skeleton(("Dot",), [-1], [[0, 0, 0]], (TURNS,))
    clip = Motion(skeleton, np.random.default_rng(0).normal(size=(9, 3)), 1 / 30)
    with pytest.raises(OptionError, match=r"'Dot'.*leaves it free; add one like '0.5deg'"):
        joint_keys(clip, "1u")
    assert count(joint_keys(clip, ["1u", "0.5deg"])) > 1


# -- few keys ------------------------------------------------------------------------------------------------------
@pytest.mark.parametrize("degrees", [0.1, 0.5, 2.0])
def test_a_hinge_needs_no_more_keys_than_the_best_chain_on_samples(cut: Motion, degrees: float) -> None:
    for name in ("LeftLeg.Xrotation", "Hips.Yrotation", "RightForeArm.Yrotation"):
        angle = cut.values[:, cut.skeleton.channel_names.index(name)]
        best = linear.solve(angle[None], np.full((1, len(angle)), degrees)).frames
        found = joint_keys(one_joint(angle, ["Xrotation"]), f"{degrees}deg").rotations[0].frames
        assert len(found) <= len(best)


@pytest.mark.parametrize("degrees", [0.1, 0.5])
def test_free_ends_need_clearly_fewer_keys_than_samples(cut: Motion, degrees: float) -> None:
    ours, theirs = 0, 0
    turned = local_turns(cut)
    for joint, track in enumerate(joint_keys(cut, f"{degrees}deg").rotations):
        if track is not None and len(track.frames) > 2:
            ours += len(track.frames)
            theirs += len(greedy(turned[joint], degrees))
    assert ours < 0.85 * theirs


def greedy(turns: np.ndarray, degrees: float) -> list[int]:
    """Key frames on samples (F, 3, 3), each the furthest that a slerp from the one before reaches."""
    from scipy.spatial.transform import Rotation, Slerp

    samples = Rotation.from_matrix(turns)
    frames = [0]
    while frames[-1] < len(turns) - 1:
        i = j = frames[-1]
        while j + 1 < len(turns):
            between = Slerp([i, j + 1], samples[[i, j + 1]])(np.arange(i, j + 2))
            if np.degrees((between.inv() * samples[i : j + 2]).magnitude()).max() > degrees:
                break
            j += 1
        frames.append(max(j, i + 1))
    return frames


@pytest.mark.parametrize("frames", [40, 1500])
def test_a_turn_at_constant_speed_needs_two_keys(frames: int) -> None:
    angle = np.linspace(0, 100, frames)
    (track,) = tracks_of(joint_keys(one_joint(angle, ["Zrotation"]), "0.01deg"))
    assert track.frames.tolist() == [0, frames - 1]


def test_rounds_of_making_up_for_each_other_spare_keys(cut: Motion, monkeypatch: pytest.MonkeyPatch) -> None:
    found = count(joint_keys(cut, "0.2%height"))
    monkeypatch.setattr(slerp_search, "ROUNDS", ())
    alone = count(joint_keys(cut, "0.2%height"))
    assert found < 0.5 * alone
