"""fit: the promise holds at every frame, whatever chooses the knots; few knots; refusals say what to do."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.interpolate import BSpline, make_lsq_spline, splev, splrep

import mocurve as mc
from mocurve import kinematics
from mocurve.feet.planted import planted
from mocurve.fitting import KNOTS

ALONE = mc.Skeleton(("A",), np.array([-1]), np.zeros((1, 3)), (("Zrotation",),))


@pytest.fixture(scope="module")
def jumping() -> mc.Motion:
    return mc.read(mc.data.example())[60:260]


def single(samples: np.ndarray) -> mc.Motion:
    return mc.Motion(ALONE, np.asarray(samples, float)[:, None], 1 / 60)


def wave(frames: int = 120) -> np.ndarray:
    at = np.arange(frames) / 60
    return 30 * np.sin(5 * at) + 20 * np.exp(-(((at - 1) / 0.1) ** 2))


# -- the promise -----------------------------------------------------------------------------------
@pytest.mark.parametrize("knots", KNOTS)
@pytest.mark.parametrize("degree", [1, 2, 3, 5])
def test_no_channel_is_further_off_than_the_tolerance(jumping: mc.Motion, knots: str, degree: int) -> None:
    made = mc.fit(jumping, tolerance="1deg", knots=knots, degree=degree)
    turning = jumping.skeleton.rotation_channels
    assert np.abs(made.sample().values - mc.unroll(jumping, triples=False).values)[:, turning].max() <= 1.0
    assert made.degree == degree


@pytest.mark.parametrize("knots", KNOTS)
def test_no_joint_moves_more_than_the_tolerance_and_planted_feet_a_part_of_it(jumping: mc.Motion, knots: str) -> None:
    made = mc.fit(jumping, tolerance="0.3u", knots=knots, feet=0.5)
    away = np.linalg.norm(kinematics.world(made.sample()) - kinematics.world(jumping), axis=2).T
    assert away.max() <= 0.3
    assert away[planted(mc.unroll(jumping, triples=False))].max() <= 0.15
    assert made.report.max_error_world == pytest.approx(away.max())


def test_a_joint_or_a_time_can_have_a_tolerance_of_its_own(jumping: mc.Motion) -> None:
    made = mc.fit(jumping, tolerance=["0.5u", "LeftHand=0.1u", "@0.5..0.7=0.05u"])
    away = np.linalg.norm(kinematics.world(made.sample()) - kinematics.world(jumping), axis=2)
    assert away.max() > 0.2
    assert away[:, jumping.skeleton.joint("LeftHand")].max() <= 0.1
    assert away[61:84].max() <= 0.05


@pytest.mark.parametrize("degree", [1, 2, 3, 4, 5])
def test_a_tiny_tolerance_gives_as_many_coefficients_as_frames(degree: int) -> None:
    noise = np.random.default_rng(degree).normal(size=60)
    made = mc.fit(single(noise), tolerance="1e-9deg", degree=degree)
    assert len(made.values) == 60
    np.testing.assert_allclose(made.sample().values[:, 0], noise, atol=1e-9)


def test_the_ends_are_kept_or_not(jumping: mc.Motion) -> None:
    kept = mc.fit(jumping, tolerance="2deg").sample().values
    free = mc.fit(jumping, tolerance="2deg", ends=False).sample().values
    wanted = mc.unroll(jumping, triples=False).values
    np.testing.assert_array_equal(kept[[0, -1]], wanted[[0, -1]])
    assert np.abs(free[0] - wanted[0]).max() > 1e-6


# -- few knots -------------------------------------------------------------------------------------
def test_fewest_takes_no_more_knots_than_the_other_ways(jumping: mc.Motion) -> None:
    counts = {name: len(mc.fit(jumping, tolerance="1%height", knots=name).values) for name in KNOTS}
    assert counts["fewest"] < 0.9 * min(counts["curvature"], counts["uniform"])


def test_a_cubic_takes_a_single_span() -> None:
    at = np.arange(90) / 30
    made = mc.fit(single((at - 1) ** 3 - at), tolerance="1e-6deg")
    assert len(made.values) == 4


@pytest.mark.parametrize("tolerance", ["3deg", "0.5u"])
def test_uniform_knots_are_and_one_span_fewer_does_not_hold(jumping: mc.Motion, tolerance: str) -> None:
    made = mc.fit(jumping, tolerance=tolerance, knots="uniform", feet=1.0)
    spans = len(made.knots) - 7
    np.testing.assert_allclose(np.diff(made.knots[3:-3]), jumping.duration / spans)
    told = mc.fit(jumping, knots="uniform", spans=spans - 1).report
    assert told.max_error_degrees > 3.0 if tolerance == "3deg" else told.max_error_world > 0.5


def test_knots_gather_where_the_curve_bends() -> None:
    made = mc.fit(single(wave()), tolerance="0.05deg")
    inner = made.knots[4:-4]
    assert ((inner > 0.7) & (inner < 1.3)).sum() > 0.5 * len(inner)


def test_fewer_coefficients_than_fitpack_at_the_same_largest_error(jumping: mc.Motion) -> None:
    at, counts = np.arange(jumping.frames) * jumping.frame_time, np.zeros(2, int)
    for name in ("LeftLeg.Xrotation", "RightArm.Zrotation", "LeftUpLeg.Xrotation"):
        samples = jumping.values[:, jumping.skeleton.channel(name)]
        made = mc.fit(mc.Motion(ALONE, samples[:, None], jumping.frame_time), tolerance="0.5deg")
        peers = [splrep(at, samples, s=squares) for squares in np.geomspace(0.1, 60, 60)]
        held = [len(peer[0]) - 4 for peer in peers if np.abs(splev(at, peer) - samples).max() <= 0.5]
        counts += [len(made.values), min(held)]
    assert counts[0] <= 0.8 * counts[1]


# -- a number of spans -----------------------------------------------------------------------------
def test_uniform_spans_are_the_fit_of_scipy(jumping: mc.Motion) -> None:
    made = mc.fit(jumping, knots="uniform", spans=25, ends=False)
    at = np.arange(jumping.frames) * jumping.frame_time
    np.testing.assert_allclose(np.diff(made.knots[3:-3]), at[-1] / 25)
    wanted = mc.unroll(jumping, triples=False).values
    peer = make_lsq_spline(at, wanted, made.knots, 3)
    np.testing.assert_allclose(made.values, peer.c, atol=1e-9)
    np.testing.assert_allclose(made.at(at), BSpline(made.knots, peer.c, 3)(at), atol=1e-9)


def test_spans_by_curvature_follow_a_sudden_move_better_than_uniform_ones() -> None:
    off = [mc.fit(single(wave()), knots=way, spans=24).report.max_error_degrees for way in ("curvature", "uniform")]
    assert off[0] < 0.7 * off[1]


def test_a_channel_with_a_long_lever_draws_the_knots() -> None:
    offsets = np.array([[0, 0, 0], [100.0, 0, 0], [0, 1.0, 0]])
    body = mc.Skeleton(("A", "B", "C"), [-1, 0, 1], offsets, [("Zrotation",), ("Zrotation",), ()], [False, False, True])
    bump = 20 * np.exp(-(((np.arange(200) - 50) / 6) ** 2))
    values = np.stack([bump, bump[::-1]], axis=1)
    made = mc.fit(mc.Motion(body, values, 0.01), tolerance="0.5u", feet=1.0)
    inner = made.knots[4:-4]
    assert (inner < 1.0).sum() > 2 * (inner > 1.0).sum()


# -- what is told ----------------------------------------------------------------------------------
def test_the_report_tells_knots_coefficients_and_errors(jumping: mc.Motion) -> None:
    made = mc.fit(jumping, tolerance="1%height")
    told = made.report.to_json()
    assert told["knots"] == len(made.knots)
    assert told["keys"] == made.values.size
    assert told["samples"] == jumping.values.size
    assert told["bytes"] == 8 * (made.values.size + len(made.knots))
    assert told["method"] == "fewest"
    assert len(told["channels"]) == 96
    assert all(row["rms"] <= row["max"] for row in told["channels"])
    assert f"{made.values.size:,} coefficients for {jumping.values.size:,} samples" in repr(made)
    assert f"knots      {len(made.knots)}, shared by all channels" in str(made.report)
    step = {"verb": "fit", "tolerance": ["1%height"], "knots": "fewest", "degree": 3, "ends": True, "feet": 0.25}
    assert made.history == (*jumping.history, step)
    assert mc.compare(jumping, made).tolerance == "1%height"


def test_keys_and_splines_can_be_fitted_again(jumping: mc.Motion) -> None:
    made = mc.fit(jumping, tolerance="0.5deg")
    again = mc.fit(made, tolerance="2deg")
    assert len(again.values) < len(made.values)
    assert [step["tolerance"] for step in again.history[-2:]] == [["0.5deg"], ["2deg"]]
    assert mc.fit(mc.reduce(jumping, tolerance="1deg"), tolerance="1deg").frames == jumping.frames


# -- refusals --------------------------------------------------------------------------------------
@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"knots": "fewst"}, "no way to choose knots 'fewst'. Did you mean 'fewest'"),
        ({"degree": 0}, "from 1 to 5, not 0"),
        ({"degree": True}, "not True"),
        ({"tolerance": "5"}, "a number and a unit are expected"),
        ({"spans": 10}, "a number of spans goes with knots 'curvature' or 'uniform'"),
        ({"spans": 10, "knots": "uniform", "tolerance": "1deg"}, "takes the tolerance's place"),
        ({"spans": 0, "knots": "uniform"}, "from 1 up, not 0"),
        ({"spans": 118, "knots": "uniform"}, "120 frames settle at most 117 spans of degree 3, not 118"),
        ({"feet": 0.0}, "feet is a part of the tolerance"),
        ({"tolerance": "0deg"}, "finer than the rounding of a spline of degree 3"),
    ],
)
def test_options_that_cannot_be_are_refused(options: dict[str, object], words: str) -> None:
    with pytest.raises(mc.MocurveError) as caught:
        mc.fit(single(wave()), **options)
    assert words in str(caught.value)


def test_more_spans_than_numbers_can_settle_are_refused() -> None:
    with pytest.raises(mc.OptionError, match="the 420 frames do not settle 417 spans of degree 3: take fewer"):
        mc.fit(mc.read(mc.data.example()), knots="uniform", spans=417)


def test_too_few_frames_and_gaps_are_refused() -> None:
    with pytest.raises(mc.Mismatch, match="takes 4 frames or more, the clip has 3"):
        mc.fit(single([1, 2, 3]), tolerance="1deg")
    with pytest.raises(mc.Mismatch, match="has no sample at frame 1: fill the gaps first"):
        mc.fit(single([1, np.nan, 3, 4, 5]), tolerance="1deg")


@pytest.mark.parametrize("frames", [4, 5, 6, 9])
@pytest.mark.parametrize("knots", KNOTS)
def test_short_clips_are_fitted(frames: int, knots: str) -> None:
    samples = np.random.default_rng(frames).normal(size=frames) * 10
    made = mc.fit(single(samples), tolerance="0.01deg", knots=knots)
    np.testing.assert_allclose(made.sample().values[:, 0], samples, atol=0.01)


def test_a_clip_that_stands_still_and_one_without_channels_are_fitted() -> None:
    assert len(mc.fit(single(np.full(50, 7.0)), tolerance="0.1deg").values) == 4
    bare = mc.Motion(replace(ALONE, channels=((),)), np.zeros((50, 0)), 0.1)
    assert mc.fit(bare, tolerance="1deg").values.shape == (4, 0)
