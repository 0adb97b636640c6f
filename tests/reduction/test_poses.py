"""Whole poses: each way to choose them against brute force and its own promise; so many keys, and keys that are pinned,
whatever the method."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from dataclasses import replace
from itertools import combinations, pairwise
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import mocurve as mc
from mocurve import KeyedMotion, Motion, OptionError, Skeleton, UnknownName
from mocurve.kinematics import rest_height
from mocurve.reduction import CHOOSERS, METHODS

Places = Callable[[Skeleton, np.ndarray], np.ndarray]
Astray = Callable[[Motion, KeyedMotion], np.ndarray]
WHOLE = ["optimal", *CHOOSERS]


@pytest.fixture(scope="session")
def hop(jump: Path) -> Motion:
    """Every other frame of 160 of a jump."""
    return replace(mc.read(jump)[180:340], values=mc.read(jump).values[180:340:2], frame_time=1 / 60)


@pytest.fixture(scope="session")
def brief(jump: Path) -> Motion:
    """Twelve frames of a jump, a fifteenth of a second apart."""
    return replace(mc.read(jump)[:12], values=mc.read(jump).values[150:246:8], frame_time=1 / 15)


def wandering(seed: int, frames: int = 12) -> Motion:
    """Two bones that turn at random."""
    skeleton = Skeleton(
        ("A", "B", "C"),
        [-1, 0, 1],
        [[0, 0, 0], [0, 3, 0], [2, 0, 0]],
        [("Xposition", "Yposition", "Zrotation"), ("Zrotation", "Xrotation"), ()],
    )
    steps = np.random.default_rng(seed).normal(size=(frames, 5)) * (1, 1, 20, 20, 20)
    return Motion(skeleton, np.cumsum(steps, axis=0), 0.1)


def standing(frames: int) -> Motion:
    """A clip in which nothing moves."""
    still = wandering(0, 1)
    return replace(still, values=np.repeat(still.values, frames, axis=0))


def key_frames(keys: KeyedMotion) -> list[int]:
    """Of every channel, the same."""
    frames = {tuple(np.rint(curve.times / keys.frame_time).astype(int)) for curve in keys.curves}
    assert len(frames) == 1
    return list(frames.pop())


def from_piece(point: np.ndarray, a: np.ndarray, b: np.ndarray) -> float:
    """How far a point is from the piece of a line between a and b."""
    length = (b - a) @ (b - a)
    part = np.clip((point - a) @ (b - a) / length, 0, 1) if length else 0.0
    return float(np.linalg.norm(point - a - part * (b - a)))


def least_of_all(frames: int, keys: int, cost: Callable[[int, int], float], pins: tuple[int, ...] = ()) -> float:
    """The least largest cost of a segment, over every choice of so many keys."""
    costs = {(a, b): cost(a, b) for a, b in combinations(range(frames), 2)}
    ways = ((0, *inner, frames - 1) for inner in combinations(range(1, frames - 1), keys - 2))
    return min(max(costs[step] for step in pairwise(way)) for way in ways if set(pins) <= set(way))


# -- salient and broken are the best there is --------------------------------------------------------------------------
@pytest.mark.parametrize("clip", ["brief", 1, 2, 3])
@pytest.mark.parametrize("pins", [(), (4,), (3, 4, 9)])
def test_salient_is_what_brute_force_finds(
    brief: Motion, places: Places, clip: str | int, pins: tuple[int, ...]
) -> None:
    motion = brief if clip == "brief" else wandering(int(clip))
    points = places(motion.skeleton, motion.values).reshape(12, -1)

    def cost(a: int, b: int) -> float:
        return max((from_piece(points[f], points[a], points[b]) for f in range(a + 1, b)), default=0.0)

    found = mc.poses(motion, pin=pins)
    assert (found.fewest, found.most) == (2 + len(pins), 12)
    for keys in range(found.fewest, 13):
        best = least_of_all(12, keys, cost, pins)
        frames = found.frames(keys)
        assert max(cost(a, b) for a, b in pairwise(frames)) == pytest.approx(best, rel=1e-9, abs=1e-9)
        assert found.error(keys) == pytest.approx(best, rel=1e-9, abs=1e-9)
        assert {0, 11, *pins} <= set(frames.tolist())


@pytest.mark.parametrize("clip", ["brief", 1])
def test_broken_is_the_best_for_its_curves(brief: Motion, places: Places, astray: Astray, clip: str | int) -> None:
    motion = brief if clip == "brief" else wandering(int(clip))
    values, there = motion.values, places(motion.skeleton, motion.values)

    def cost(a: int, b: int) -> float:
        """The error of the cubics through the ends with the slopes of least squares."""
        h, s = b - a, np.arange(1, b - a)[:, None] / (b - a)
        rise = (3 - 2 * s) * s * s
        rows = np.hstack([s * (1 - s) ** 2 * h, s * s * (s - 1) * h])
        pull = np.sqrt(1e-6 * h * max(h - 1, 1)) * np.eye(2)
        wanted = values[a + 1 : b] - (1 - rise) * values[a] - rise * values[b]
        chord = np.repeat((values[b] - values[a])[None] / h, 2, axis=0)
        slopes = np.linalg.lstsq(np.vstack([rows, pull]), np.vstack([wanted, pull @ chord]), rcond=None)[0]
        curve = (1 - rise) * values[a] + rise * values[b] + rows @ slopes
        off = np.linalg.norm(places(motion.skeleton, curve) - there[a + 1 : b], axis=2)
        return float(off.max(initial=0.0))

    for keys in (3, 5, 8):
        made = mc.reduce(motion, method="broken", keys=keys)
        assert astray(motion, made).max() == pytest.approx(least_of_all(12, keys, cost), rel=1e-6, abs=1e-9)
        np.testing.assert_array_equal(made.sample().values[key_frames(made)], values[key_frames(made)])


def test_where_segments_would_be_too_long_salient_poses_stand_in(hop: Motion, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("mocurve.reduction.broken.LONGEST", 10)
    found, salient = mc.poses(hop, method="broken"), mc.poses(hop)
    assert [len(way) for way in found.choices] == list(range(found.fewest, hop.frames + 1))
    assert found.fewest < 9
    for keys in range(found.fewest, 9):  # 80 frames take at least 9 keys with segments of 10
        np.testing.assert_array_equal(found.frames(keys), salient.frames(keys))
    assert np.diff(found.frames(20)).max() <= 10
    assert key_frames(mc.reduce(hop, method="broken", keys=3)) == salient.frames(3).tolist()


# -- every way to choose -----------------------------------------------------------------------------------------------
@pytest.mark.parametrize("pin", [(), (7, 40, 41), ("0.5s", "contacts")])
@pytest.mark.parametrize("method", CHOOSERS)
def test_a_range_has_one_key_more_each_time_and_the_pins(hop: Motion, method: str, pin: tuple) -> None:
    found = mc.poses(hop, method=method, pin=pin)
    assert found.most == hop.frames
    assert found.fewest >= 2 + (3 if 7 in pin else 0)
    wanted = {0, hop.frames - 1, *(p for p in pin if isinstance(p, int)), *([30] if "0.5s" in pin else [])}
    for keys in range(found.fewest, found.most + 1):
        frames = found.frames(keys)
        assert len(frames) == keys
        assert (np.diff(frames) > 0).all()
        assert wanted <= set(frames.tolist())
        assert found.error(keys) >= 0
    if method in ("salient", "broken"):  # of the best choices more are never worse
        assert (np.diff(found.errors) <= 1e-12).all()
    assert found.error(hop.frames) < 1e-12
    assert mc.poses(hop, method=method, pin=pin).frames(20).tolist() == found.frames(20).tolist()


@pytest.mark.parametrize("method", ["posture", "probe"])
def test_keys_that_are_added_one_by_one_stay(hop: Motion, method: str) -> None:
    found = mc.poses(hop, method=method)
    for keys in range(found.fewest, 60):
        assert set(found.frames(keys)) < set(found.frames(keys + 1))


def test_posture_splits_where_it_is_farthest_from_the_chord(hop: Motion, places: Places) -> None:
    points = places(hop.skeleton, hop.values).reshape(hop.frames, -1)
    found = mc.poses(hop, method="posture")
    for keys in range(2, 20):
        frames = found.frames(keys)
        off = [from_piece(points[f], points[a], points[b]) for a, b in pairwise(frames) for f in range(a, b)]
        (new,) = set(found.frames(keys + 1)) - set(frames)
        assert off[new] == pytest.approx(max(off))
        assert found.error(keys) == pytest.approx(max(off))


def missed(motion: Motion, keys: list[int], places: Places) -> np.ndarray:
    """(F,) the part of each posture, counted from the root, that no combination of the keys makes."""
    there = places(motion.skeleton, motion.values)
    rows = (there - there[:, :1]).reshape(motion.frames, -1)
    weights = np.linalg.lstsq(rows[keys].T, rows.T, rcond=1e-12)[0]
    return np.linalg.norm(rows.T - rows[keys].T @ weights, axis=0) / np.linalg.norm(rows, axis=1)


@pytest.mark.parametrize("epsilon", [0.02, 0.05])
@pytest.mark.parametrize("method", ["probe", "cluster"])
def test_every_posture_is_within_epsilon_of_the_span_of_the_keys(
    hop: Motion, places: Places, method: str, epsilon: float
) -> None:
    keys = key_frames(mc.reduce(hop, method=method, tolerance=f"{100 * epsilon:g}%span", quality="fast"))
    assert missed(hop, keys, places).max() <= epsilon
    assert len(keys) < hop.frames / 3
    found = mc.poses(hop, method=method)
    assert found.within(epsilon) == len(keys)
    assert found.error(len(keys)) == pytest.approx(missed(hop, keys, places).max(), rel=1e-6)
    assert found.error(len(keys) - 1) > epsilon


def test_the_weights_of_key_probe_make_the_postures_of_the_keys(hop: Motion, places: Places) -> None:
    found = mc.poses(hop, method="probe")
    weights, frames = found.weights(20), found.frames(20)
    assert weights.shape == (hop.frames, 20)
    np.testing.assert_array_equal(weights[frames], np.eye(20))
    there = places(hop.skeleton, hop.values)
    rows = (there - there[:, :1]).reshape(hop.frames, -1)
    off = np.linalg.norm(rows - weights @ rows[frames], axis=1) / np.linalg.norm(rows, axis=1)
    assert off.max() == pytest.approx(found.error(20), rel=1e-6)


# -- so many keys ------------------------------------------------------------------------------------------------------
@pytest.mark.parametrize("quality", ["fast", "default"])
@pytest.mark.parametrize("method", WHOLE)
def test_so_many_poses_and_the_pins(hop: Motion, astray: Astray, method: str, quality: str) -> None:
    made = mc.reduce(hop, keys=12, method=method, pin=[31, "0.5s"], quality=quality)
    frames = key_frames(made)
    assert len(frames) == 12
    assert {0, 30, 31, hop.frames - 1} <= set(frames)
    assert made.report is not None
    assert made.report.key_frames == tuple(frames)
    assert (made.report.method, made.report.align, made.report.tolerance) == (method, "pose", "12 keys")
    assert made.report.max_error_world == pytest.approx(astray(hop, made).max(), abs=1e-9)
    assert any(curve.broken for curve in made.curves) == (method == "broken")
    assert astray(hop, made).max() < 0.2 * rest_height(hop)


def test_where_every_key_is_pinned_only_the_curves_are_chosen(hop: Motion) -> None:
    pin = [3, 9, 22, 23, 40, 61]
    made = mc.reduce(hop, keys=8, pin=pin)
    assert key_frames(made) == [0, *pin, hop.frames - 1]
    assert len(key_frames(mc.reduce(hop, keys=9, pin=pin))) == 9


@pytest.mark.parametrize("keys", [4, 8, 16])
def test_optimal_leaves_less_than_all_others(hop: Motion, keys: int) -> None:
    left = {method: mc.reduce(hop, keys=keys, method=method).report.max_error_world for method in WHOLE}  # type: ignore[union-attr]
    del left["broken"]  # another kind of curves
    assert left["optimal"] == min(left.values())
    plain = mc.reduce(hop, keys=keys, method="salient", quality="fast").report
    assert plain is not None
    assert left["optimal"] < 0.9 * plain.max_error_world
    assert left["salient"] <= plain.max_error_world


def test_more_keys_leave_less(hop: Motion) -> None:
    left = [mc.reduce(hop, keys=keys).report.max_error_world for keys in (3, 6, 12, 24, 48)]  # type: ignore[union-attr]
    assert (np.diff(left) < 0).all()


@pytest.mark.parametrize("method", WHOLE)
def test_as_many_keys_as_frames_and_more_are_the_samples(brief: Motion, method: str) -> None:
    for keys in (12, 1000):
        made = mc.reduce(brief, keys=keys, method=method)
        assert key_frames(made) == list(range(12))
        np.testing.assert_array_equal(made.sample().values, mc.unroll(brief, triples=False).values)


@pytest.mark.parametrize("frames", [0, 1, 2, 3])
@pytest.mark.parametrize("method", WHOLE)
def test_clips_of_next_to_no_frames(method: str, frames: int) -> None:
    clip = wandering(5)[:frames]
    assert mc.reduce(clip, keys=3, method=method).keys == 5 * frames
    made = mc.reduce(clip, method=method, align="pose", tolerance="5%height")
    assert made.frames == frames
    if method != "optimal":
        found = mc.poses(clip, method=method)
        assert (found.fewest, found.most) == (min(frames, 2), frames)
        assert len(found.errors) == len(found.choices) == (0 if not frames else max(1, frames - 1))


@pytest.mark.parametrize("method", WHOLE)
def test_a_clip_that_stands_still(method: str) -> None:
    made = mc.reduce(standing(20), keys=5, method=method, pin=[13])
    assert len(key_frames(made)) == 5
    assert 13 in key_frames(made)
    np.testing.assert_allclose(made.sample().values, standing(20).values, atol=1e-12)


@pytest.mark.parametrize("method", [*METHODS, *CHOOSERS])
@pytest.mark.parametrize("tolerance", ["1%height", "3deg"])
def test_pins_are_kept_with_a_tolerance_by_every_method(
    hop: Motion, astray: Astray, method: str, tolerance: str
) -> None:
    made = mc.reduce(hop, tolerance=tolerance, method=method, pin=[17, 52])
    for curve in made.curves:
        assert {17, 52} <= set(np.rint(curve.times / hop.frame_time).astype(int))
    assert made.keys < 0.9 * hop.values.size
    if tolerance == "1%height":
        assert astray(hop, made).max() <= 0.01 * rest_height(hop)
    else:
        turning = hop.skeleton.rotation_channels
        assert np.abs(made.sample().values - mc.unroll(hop, triples=False).values)[:, turning].max() <= 3.0


def test_fewer_poses_than_the_curves_ask_for_alone(hop: Motion, astray: Astray) -> None:
    fast, best = (mc.reduce(hop, tolerance="1%height", align="pose", quality=q) for q in ("fast", "good"))
    assert len(key_frames(best)) <= len(key_frames(fast)) < hop.frames / 2
    assert astray(hop, best).max() <= 0.01 * rest_height(hop)


def test_poses_are_made_of_keys_and_of_clips_with_noise(hop: Motion) -> None:
    keys = mc.reduce(hop, tolerance="1deg")
    assert len(key_frames(mc.reduce(keys, keys=7))) == 7
    assert len(key_frames(mc.reduce(hop, keys=7, denoise=True, quality="fast"))) == 7


@pytest.mark.parametrize("method", ["optimal", "broken", "cluster"])
def test_awkward_files_have_poses_too(clips: Path, method: str) -> None:
    for path in sorted((clips / "awkward").glob("*.bvh")):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            clip = mc.read(path)
        made = mc.reduce(clip, keys=5, method=method, quality="fast")
        if clip.frames and made.curves:
            assert len(key_frames(made)) == min(5, clip.frames), path.name


# -- refusals ----------------------------------------------------------------------------------------------------------
@pytest.mark.parametrize(
    ("options", "kind", "message"),
    [
        ({"keys": 1}, OptionError, "keys stand on the first and the last frame: at least 2 are needed, not 1"),
        ({"keys": 3, "pin": [3, 4]}, OptionError, "keys stand on the first and the last frame and 2 pinned ones: at "),
        ({"keys": 0}, OptionError, "keys is a whole number of poses from 1 up, not 0"),
        ({"keys": 2.5}, OptionError, "keys is a whole number of poses from 1 up, not 2.5"),
        ({"keys": True}, OptionError, "keys is a whole number of poses from 1 up, not True"),
        ({"keys": 5, "tolerance": "2u"}, OptionError, "keys says how many, a tolerance how near: give one of them"),
        ({"keys": 5, "method": "split"}, OptionError, "a number of keys goes with the methods optimal, salient, "),
        ({"keys": 5, "align": "joint"}, OptionError, "a number of keys is for whole poses, align 'pose', not 'joint'"),
        ({"method": "probe", "align": "channel"}, OptionError, "method 'probe' is for whole poses, align 'pose', not"),
        ({"pin": [12]}, OptionError, "the pin 12 lies outside the clip, whose last frame is 11, which is at 1.1 s"),
        ({"pin": ["-1"]}, OptionError, "the pin '-1' lies outside the clip"),
        ({"pin": ["2s"]}, OptionError, "the pin '2s' lies outside the clip"),
        ({"pin": ["infs"]}, OptionError, "a pin is a frame (40), a time (1.2s) or contacts, not 'infs'"),
        ({"pin": ["nans"]}, OptionError, "a pin is a frame (40), a time (1.2s) or contacts, not 'nans'"),
        ({"pin": ["early"]}, OptionError, "a pin is a frame (40), a time (1.2s) or contacts, not 'early'"),
        ({"pin": [1.5]}, OptionError, "a pin is a frame (40), a time (1.2s) or contacts, not 1.5"),
        ({"pin": [None]}, OptionError, "a pin is a frame (40), a time (1.2s) or contacts, not None"),
        ({"pin": 5}, OptionError, "pin is a list of frames and times, like [40, '1.2s'], not 5"),
        ({"pin": "contacts"}, OptionError, "pin is a list of frames and times, like [40, '1.2s'], not 'contacts'"),
    ],
)
def test_what_cannot_be_is_refused_in_words(options: dict, kind: type[Exception], message: str) -> None:
    with pytest.raises(kind) as caught:
        mc.reduce(wandering(1), **options)
    assert str(caught.value).startswith(message)


def test_a_range_refuses_too() -> None:
    with pytest.raises(UnknownName, match=r"no method 'optimal'. There is: salient, broken, posture, probe, cluster"):
        mc.poses(wandering(1), method="optimal")
    with pytest.raises(OptionError, match="salient has a choice of 2 to 12 keys, not 13"):
        mc.poses(wandering(1)).frames(13)
    with pytest.raises(OptionError, match="the pin 0 lies outside the clip, whose last frame is none: it is empty"):
        mc.reduce(wandering(1)[:0], pin=[0])


@pytest.mark.parametrize("method", ["salient", "broken"])
def test_a_clip_too_long_for_all_pairs_is_told(method: str) -> None:
    with pytest.raises(
        OptionError, match=f"{method} compares all pairs of frames, of at most 4096 frames; the clip has"
    ):
        mc.reduce(wandering(1, 5000), keys=9, method=method)


@settings(max_examples=40)
@given(st.data())
def test_hostile_clips_have_so_many_poses(
    hostile: Callable[..., st.SearchStrategy[Motion]], data: st.DataObject
) -> None:
    clip = data.draw(hostile())
    method, quality = data.draw(st.sampled_from(WHOLE)), data.draw(st.sampled_from(["fast", "default"]))
    pin = sorted(data.draw(st.sets(st.integers(0, clip.frames - 1), max_size=5))) if clip.frames else []
    keys = len({0, *pin, max(clip.frames - 1, 0)}) + data.draw(st.integers(0, 6))
    made = mc.reduce(clip, keys=keys, method=method, pin=pin, quality=quality)
    assert all(np.isfinite(part).all() for curve in made.curves for part in (curve.values, curve.slopes))
    if made.curves and clip.frames:
        assert len(key_frames(made)) == min(keys, clip.frames)
        assert set(pin) <= set(key_frames(made))
