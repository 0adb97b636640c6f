"""The promise of reduce, measured by code of these tests: on a real cut and on hostile clips, whatever the options."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import mocurve as mc
from mocurve import KeyedMotion, Mismatch, MocurveError, Motion, OptionError, Skeleton, UnknownName
from mocurve.feet.planted import planted
from mocurve.kinematics import rest_height
from mocurve.reduction import ALIGNMENTS, METHODS, QUALITIES

Astray = Callable[[Motion, KeyedMotion], np.ndarray]
Samples = Callable[[KeyedMotion], np.ndarray]
Hostile = Callable[..., st.SearchStrategy[Motion]]
TOLERANCES = [["0.1%height"], ["0.4u", "1deg"], ["0.5deg"], ["2%range"]]


@pytest.fixture(scope="session")
def cut(jump: Path) -> Motion:
    """Sixty frames of a jump, from the ground into the air."""
    return mc.read(jump)[100:160]


def apart(clip: Motion, samples: np.ndarray) -> np.ndarray:
    """(F, C) how far samples are from the clip's values; rotations up to whole turns."""
    off = samples - clip.values
    turns = np.where(clip.skeleton.rotation_channels, np.rint(off / 360.0), 0.0)
    return np.abs(off - 360.0 * turns)


def channel_limits(clip: Motion, text: str) -> np.ndarray:
    """(C,) what a rule in deg or %range allows."""
    turning = clip.skeleton.rotation_channels
    if text.endswith("%range"):
        whole = np.where(turning, np.unwrap(clip.values, period=360.0, axis=0), clip.values)
        return float(text.removesuffix("%range")) / 100.0 * (np.ptp(whole, axis=0) if clip.frames else 0.0)
    degrees = float(text.removesuffix("deg"))
    return np.where(turning, degrees, np.radians(degrees) * (rest_height(clip) or 1.0))


def length(clip: Motion, text: str) -> float:
    if text.endswith("%height"):
        return float(text.removesuffix("%height")) / 100.0 * rest_height(clip)
    return float(text.removesuffix("u"))


def check_promise(
    clip: Motion, keys: KeyedMotion, tolerance: list[str], feet: float, samples: np.ndarray, off: np.ndarray
) -> None:
    """Every rule holds at every frame, but for the last digits of the clip's own numbers."""
    rounding = 1e-14 * max(1.0, np.abs(clip.values).max(initial=0.0), np.abs(clip.skeleton.offsets).max(initial=0.0))
    for text in tolerance:
        if text.endswith(("deg", "%range")):
            assert (apart(clip, samples) <= channel_limits(clip, text) + 10 * rounding).all(), text
        else:
            limits = length(clip, text) * np.where(planted(clip), feet, 1.0).T
            assert (off <= limits + 100 * rounding).all(), text


def check_keys(clip: Motion, keys: KeyedMotion, align: str) -> None:
    """Keys lie on frames, from the first to the last, shared as asked."""
    assert (keys.skeleton, keys.frames, keys.frame_time) == (clip.skeleton, clip.frames, clip.frame_time)
    owners = clip.skeleton.channel_joints
    for channel, curve in enumerate(keys.curves):
        frames = curve.times / clip.frame_time
        np.testing.assert_allclose(frames, np.rint(frames), atol=1e-6)
        assert all(np.isfinite(part).all() for part in (curve.values, curve.slopes, curve.in_slopes))
        assert len(curve) <= clip.frames
        assert (clip.frames == 0) == (len(curve) == 0)
        if len(curve) > 1:
            assert (curve.times[0], curve.times[-1]) == (0.0, pytest.approx(clip.duration))
        others = np.flatnonzero(owners == owners[channel]) if align == "joint" else range(len(keys.curves))
        for other in others if align != "channel" else ():
            np.testing.assert_array_equal(curve.times, keys.curves[other].times)


# -- the promise -------------------------------------------------------------------------------------
@pytest.mark.parametrize("align", ALIGNMENTS)
@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("tolerance", TOLERANCES, ids="+".join)
def test_the_promise_holds_on_a_jump(
    cut: Motion, samples: Samples, astray: Astray, method: str, align: str, tolerance: list[str]
) -> None:
    keys = mc.reduce(cut, tolerance=tolerance, method=method, align=align)
    check_promise(cut, keys, tolerance, 0.25, samples(keys), astray(cut, keys))
    check_keys(cut, keys, align)
    still = [len(keys.curves[k]) for k in np.flatnonzero(np.ptp(cut.values, axis=0) == 0)]
    assert still
    if align == "pose":
        assert keys.keys <= cut.values.size
    else:
        assert keys.keys < 0.9 * cut.values.size
        assert align == "joint" or set(still) == {1}
    assert keys.report is not None
    assert keys.report.lower_bound is not None
    assert keys.report.lower_bound <= keys.keys


@settings(max_examples=150, suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large])
@given(data=st.data())
def test_the_promise_holds_on_hostile_clips(
    hostile: Hostile, samples: Samples, astray: Astray, data: st.DataObject
) -> None:
    clip = data.draw(hostile())
    choices = {
        "tolerance": [*TOLERANCES, ["0u"], ["0deg"], ["1e-7u"], ["1e6u", "5deg"]],
        "method": METHODS,
        "align": ALIGNMENTS,
        "quality": QUALITIES,
        "feet": [0.25, 1.0, 0.01],
    }
    options = {name: data.draw(st.sampled_from(list(values)), name) for name, values in choices.items()}
    before = clip.values.copy()
    try:
        keys = mc.reduce(clip, **options)
    except OptionError as refusal:
        refused = str(refusal)
        assert refused.startswith(("the rest pose has no height to take a part of", "nothing hangs on channel "))
        return
    np.testing.assert_array_equal(clip.values, before)
    check_promise(clip, keys, options["tolerance"], options["feet"], samples(keys), astray(clip, keys))
    check_keys(clip, keys, options["align"])


@pytest.mark.parametrize("tolerance", ["0u", "0deg", "0%range"])
@pytest.mark.parametrize("method", METHODS)
def test_at_tolerance_0_the_curves_are_the_samples(cut: Motion, samples: Samples, method: str, tolerance: str) -> None:
    clip = cut[:20]
    keys = mc.reduce(clip, tolerance=tolerance, method=method)
    assert apart(clip, samples(keys)).max() < 1e-9
    assert apart(clip, keys.sample().values).max() < 1e-9


AWKWARD = "awkward"


def test_awkward_files_reduce_or_are_refused_in_one_line(clips: Path, samples: Samples, astray: Astray) -> None:
    refused = {}
    for path in sorted((clips / AWKWARD).glob("*.bvh")):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            clip = mc.read(path)
        try:
            keys = mc.reduce(clip)
        except MocurveError as error:
            refused[path.stem] = str(error)
            continue
        check_promise(clip, keys, ["0.1%height"], 0.25, samples(keys), astray(clip, keys))
        check_keys(clip, keys, "channel")
    assert set(refused) <= {"root_position_only"}
    assert not any("\n" in text for text in refused.values())


# -- how many keys -----------------------------------------------------------------------------------
def lines(frames: int = 50) -> Motion:
    """Two joints; a constant channel, one that rises evenly, one that swings."""
    skeleton = Skeleton(("A", "B"), [-1, 0], [[0, 0, 0], [0, 10, 0]], [("Xposition", "Zrotation", "Xrotation"), ()])
    at = np.arange(frames)
    return Motion(skeleton, np.stack([np.full(frames, 3.0), 0.5 * at, 30 * np.sin(0.2 * at)], axis=1), 0.02)


@pytest.mark.parametrize("tolerance", ["0.01u", "0.1deg"])
@pytest.mark.parametrize("method", METHODS)
def test_a_constant_has_one_key_and_a_line_two(method: str, tolerance: str) -> None:
    keys = mc.reduce(lines(), tolerance=tolerance, method=method)
    counts = [len(curve) for curve in keys.curves]
    assert counts[0] == 1
    assert counts[1] <= 3 if method == "dynamic" else counts[1] == 2
    assert counts[2] > 2


@pytest.mark.parametrize("tolerance", ["0.1%height", "0.5deg"])
def test_better_quality_has_no_more_keys(cut: Motion, tolerance: str) -> None:
    fast, best = (mc.reduce(cut, tolerance=tolerance, quality=quality).keys for quality in ("fast", "best"))
    assert best < fast


@pytest.mark.parametrize("unit", ["%height", "deg"])
def test_a_wider_tolerance_has_fewer_keys(cut: Motion, unit: str) -> None:
    counts = [mc.reduce(cut, tolerance=f"{amount}{unit}").keys for amount in (0.05, 0.2, 1.0)]
    assert counts[0] > counts[1] > counts[2]


def test_shared_times_cost_keys(cut: Motion) -> None:
    channel, joint, pose = (mc.reduce(cut, tolerance="0.5deg", align=align).keys for align in ALIGNMENTS)
    assert channel < joint < pose


# -- tolerances in part ------------------------------------------------------------------------------
def test_a_channel_with_more_room_has_fewer_keys_and_the_others_theirs(cut: Motion, samples: Samples) -> None:
    strict = mc.reduce(cut, tolerance="0.1deg")
    loose = mc.reduce(cut, tolerance=["0.1deg", "LeftUpLeg=2deg"])
    leg = cut.skeleton.channel_joints == cut.skeleton.joint("LeftUpLeg")
    off = apart(cut, samples(loose)).max(axis=0)
    assert (off[leg] <= 2.0).all()
    assert off[leg].max() > 0.1
    for channel, wide in enumerate(leg):
        mine, other = loose.curves[channel], strict.curves[channel]
        assert len(mine) < len(other) if wide else np.array_equal(mine.values, other.values)


def test_an_interval_with_more_room_is_smoother_and_the_rest_is_kept(cut: Motion, samples: Samples) -> None:
    times = np.arange(cut.frames) * cut.frame_time
    inside = (times >= 0.1) & (times <= 0.3)
    loose = mc.reduce(cut, tolerance=["0.1deg", "@0.1..0.3=3deg"])
    limit = channel_limits(cut, "0.1deg")
    off = apart(cut, samples(loose))
    assert (off[~inside] <= limit).all()
    assert (off[inside] <= 30 * limit).all()
    assert (off[inside] > limit).any()

    def within(keys: KeyedMotion) -> int:
        return sum(int(((curve.times > 0.1) & (curve.times < 0.3)).sum()) for curve in keys.curves)

    assert within(loose) < 0.5 * within(mc.reduce(cut, tolerance="0.1deg"))


# -- clips and keys as they come ---------------------------------------------------------------------
def test_keys_can_be_reduced_further(cut: Motion, samples: Samples) -> None:
    fine = mc.reduce(cut, tolerance="0.1deg")
    coarse = mc.reduce(fine, tolerance="1deg")
    assert coarse.keys < fine.keys
    turning = cut.skeleton.rotation_channels
    assert np.abs(samples(coarse) - samples(fine))[:, turning].max() <= 1.0
    assert apart(cut, samples(coarse))[:, turning].max() <= 1.1
    assert [step["tolerance"] for step in coarse.history[-2:]] == [["0.1deg"], ["1deg"]]


def test_a_wrap_at_the_half_turn_costs_no_key() -> None:
    clip = lines()
    turned = clip.values + np.array([0.0, 170.0, 0.0])
    turned[:, 1] = (turned[:, 1] + 180.0) % 360.0 - 180.0
    assert np.abs(np.diff(turned[:, 1])).max() > 300.0
    keys = mc.reduce(replace(clip, values=turned), tolerance="0.1deg")
    assert len(keys.curves[1]) == 2


@pytest.mark.parametrize("tolerance", ["0.1%height", "0.5deg"])
def test_two_runs_are_identical(cut: Motion, tolerance: str) -> None:
    first, second = (mc.reduce(cut, tolerance=tolerance) for _ in range(2))
    for mine, other in zip(first.curves, second.curves, strict=True):
        for part in ("times", "values", "slopes", "in_slopes"):
            np.testing.assert_array_equal(getattr(mine, part), getattr(other, part))


@pytest.mark.parametrize("tolerance", ["0.1%height", "0.5deg"])
def test_one_thread_finds_what_many_find(cut: Motion, tolerance: str, monkeypatch: pytest.MonkeyPatch) -> None:
    many = mc.reduce(cut, tolerance=tolerance)
    monkeypatch.setattr("mocurve.reduction.world.cores", lambda: 1)
    one = mc.reduce(cut, tolerance=tolerance)
    for mine, other in zip(many.curves, one.curves, strict=True):
        np.testing.assert_array_equal(mine.times, other.times)
        np.testing.assert_array_equal(mine.values, other.values)


# -- the report --------------------------------------------------------------------------------------
@pytest.mark.parametrize("tolerance", ["0.1%height", "0.5deg"])
def test_the_report_tells_what_is_measured(cut: Motion, samples: Samples, astray: Astray, tolerance: str) -> None:
    keys = mc.reduce(cut, tolerance=tolerance, align="joint", quality="fast")
    report, turning = keys.report, cut.skeleton.rotation_channels
    assert report is not None
    off, away = apart(cut, samples(keys)), astray(cut, keys)
    assert report.keys == sum(len(curve) for curve in keys.curves)
    assert report.samples == cut.values.size
    assert report.max_error_degrees == pytest.approx(off[:, turning].max(), abs=1e-9)
    assert report.max_error_length == pytest.approx(off[:, ~turning].max(), abs=1e-9)
    assert report.rms_error_degrees == pytest.approx(np.sqrt(np.mean(off[:, turning] ** 2)), abs=1e-9)
    assert report.max_error_world == pytest.approx(away.max(), abs=1e-9)
    assert report.rms_error_world == pytest.approx(np.sqrt(np.mean(away**2)), abs=1e-9)
    np.testing.assert_allclose([row.max for row in report.channels], off.max(axis=0), atol=1e-9)
    np.testing.assert_allclose([row.max for row in report.joints], away.max(axis=0), atol=1e-9)
    assert [row.keys for row in report.channels] == [len(curve) for curve in keys.curves]
    assert (report.tolerance, report.method, report.align, report.quality) == (tolerance, "optimal", "joint", "fast")
    assert report.lower_bound == sum(row.lower_bound or 0 for row in report.channels)
    assert all(1 <= (row.lower_bound or 0) <= row.keys for row in report.channels)
    assert report.seconds is not None
    assert report.seconds > 0


# -- refusals ----------------------------------------------------------------------------------------
@pytest.mark.parametrize(
    ("options", "kind", "message"),
    [
        ({"method": "optimul"}, UnknownName, "no method 'optimul'. Did you mean 'optimal'?"),
        (
            {"method": None},
            UnknownName,
            "no method 'None'. There is: optimal, split, dynamic, linear, salient, broken, ",
        ),
        ({"method": ["split"]}, UnknownName, "no method \"['split']\". "),
        ({"quality": "bst"}, UnknownName, "no quality 'bst'. Did you mean 'best'?"),
        ({"align": "joints"}, UnknownName, "no alignment 'joints'. Did you mean 'joint'?"),
        ({"feet": 0.0}, OptionError, "feet is a part of the tolerance, above 0 and at most 1, not 0.0"),
        ({"feet": 2}, OptionError, "feet is a part of the tolerance, above 0 and at most 1, not 2"),
        ({"feet": np.nan}, OptionError, "feet is a part of the tolerance, above 0 and at most 1, not nan"),
        ({"feet": "0.5"}, OptionError, "feet is a part of the tolerance, above 0 and at most 1, not '0.5'"),
        ({"tolerance": "2"}, OptionError, "tolerance '2': a number and a unit are expected"),
        ({"tolerance": 2}, OptionError, "a tolerance is a text with its unit"),
        ({"tolerance": "C=1u"}, UnknownName, "no joint 'C'. There is: A, B."),
        ({"tolerance": "0.01ratio"}, OptionError, "a tolerance in ratio goes with method split"),
        (
            {"tolerance": "3%span", "method": "salient"},
            OptionError,
            "a tolerance in %span goes with method probe or cl",
        ),
        (
            {"tolerance": "0.01ratio", "method": "split", "align": "pose"},
            OptionError,
            "a tolerance in ratio goes with ",
        ),
        ({"tolerance": ["0.01ratio", "2u"], "method": "split"}, OptionError, "a tolerance in ratio is for the whole "),
        ({"tolerance": "A=0.01ratio", "method": "split"}, OptionError, "a tolerance in ratio is for the whole clip"),
        ({"tolerance": "-1ratio", "method": "split"}, OptionError, "tolerance '-1ratio': the amount must be a number "),
    ],
)
def test_a_wrong_option_is_refused_in_words(options: dict, kind: type[MocurveError], message: str) -> None:
    with pytest.raises(kind) as caught:
        mc.reduce(lines(), **options)
    assert str(caught.value).startswith(message)


@pytest.mark.parametrize("value", [np.inf, -np.inf, 1e13])
@pytest.mark.parametrize("tolerance", ["0.1u", "1deg"])
def test_what_is_no_number_is_refused_with_its_place(value: float, tolerance: str) -> None:
    values = lines().values.copy()
    values[7, 1] = value
    with pytest.raises(Mismatch) as caught:
        mc.reduce(replace(lines(), values=values), tolerance=tolerance)
    place = f"channel 'A.Zrotation' has the value {value} at frame 7: only numbers up to 1e+12 can be reduced"
    assert str(caught.value) == place


def test_a_gap_is_refused_with_what_fills_it() -> None:
    values = lines().values.copy()
    values[7, 1] = np.nan
    with pytest.raises(Mismatch, match=r"^channel 'A.Zrotation' has no sample at frame 7: fill the gaps first"):
        mc.reduce(replace(lines(), values=values), tolerance="1deg")


def test_a_leaf_that_could_turn_and_does_not_has_one_key_without_a_warning() -> None:
    skeleton = Skeleton(("A", "Leaf"), [-1, 0], [[0, 0, 0], [0, 10, 0]], [("Zrotation",), ("Xrotation",)])
    keys = mc.reduce(Motion(skeleton, np.full((9, 2), 7.0), 0.1), tolerance="0.1u")
    assert [curve.values.tolist() for curve in keys.curves] == [[7.0], [7.0]]


def test_a_joint_on_which_nothing_hangs_needs_a_limit_in_degrees() -> None:
    one_point = Motion(Skeleton(("A",), [-1], np.zeros((1, 3)), [("Zrotation",)]), np.arange(9.0)[:, None], 0.1)
    with pytest.raises(OptionError, match=r"nothing hangs on channel 'A.Zrotation', .* add one like '0.5deg'"):
        mc.reduce(one_point, tolerance="0.1u")
    assert mc.reduce(one_point, tolerance=["0.1u", "0.5deg"]).keys == 2


def test_the_ratio_of_the_thesis_promises_nothing_and_is_told() -> None:
    keys = mc.reduce(lines(), method="split", tolerance="0.01ratio")
    assert keys.report is not None
    assert keys.report.lower_bound is None
    assert keys.report.tolerance == "0.01ratio"
    counts = [mc.reduce(lines(), method="split", tolerance=f"{ratio}ratio").keys for ratio in (0.001, 0.01, 0.1)]
    assert counts[0] >= counts[1] >= counts[2]
    assert counts[0] > counts[2]


# -- refine ------------------------------------------------------------------------------------------
@pytest.mark.parametrize("align", ALIGNMENTS)
@pytest.mark.parametrize("tolerance", ["0.1%height", "1deg"])
@pytest.mark.parametrize("method", METHODS)
def test_refined_keys_are_as_many_nearer_and_keep_the_promise(
    cut: Motion, samples: Samples, astray: Astray, method: str, tolerance: str, align: str
) -> None:
    keys = mc.reduce(cut, tolerance=tolerance, method=method, align=align, quality="fast")
    better = mc.refine(keys, cut)
    assert [len(curve) for curve in better.curves] == [len(curve) for curve in keys.curves]
    check_promise(cut, better, [tolerance], 0.25, samples(better), astray(cut, better))
    check_keys(cut, better, align)
    if tolerance == "1deg":
        owner = {"channel": range(len(keys.curves)), "joint": cut.skeleton.channel_joints, "pose": None}[align]
        group = np.zeros(len(keys.curves), int) if owner is None else np.array(owner)
        squares = [np.bincount(group, np.sum(apart(cut, samples(each)) ** 2, axis=0)) for each in (keys, better)]
        assert (squares[1] <= squares[0] * (1 + 1e-9) + 1e-12).all()
    else:
        assert np.mean(astray(cut, better) ** 2) <= np.mean(astray(cut, keys) ** 2) * (1 + 1e-9)
