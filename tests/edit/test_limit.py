"""limit, of channels: nothing beyond, nothing else touched, no corner, and keys stay keys."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from turning import spline

import mocurve as mc
from mocurve import OptionError, UnknownName
from mocurve.edit import _envelope
from mocurve.edit._extremes import extremes

ARM, HIPS = "LeftArm.Zrotation", "Hips.Yposition"
ONE = mc.Skeleton(("A",), [-1], [[0, 0, 0]], (("Xrotation",),))
CHANNEL = "A.Xrotation"


@pytest.fixture(scope="module")
def motion(jump: Path) -> mc.Motion:
    return mc.read(jump)


def column(clip: mc.Clip, name: str = ARM) -> np.ndarray:
    return clip.sample().values[:, clip.skeleton.channel(name)]


def signal(values: np.ndarray, step: float = 0.01) -> mc.Motion:
    return mc.Motion(ONE, np.asarray(values, float)[:, None], step)


def keyed(values: list[float], slopes: list[float] | None = None) -> mc.KeyedMotion:
    """Keys half a second apart, sampled at 100 frames a second."""
    times = 0.5 * np.arange(len(values))
    curve = mc.HermiteCurve(times, values, np.zeros(len(values)) if slopes is None else slopes)
    return mc.KeyedMotion(ONE, (curve,), 0.01, round(times[-1] / 0.01) + 1)


# -- samples -----------------------------------------------------------------------------------------
def test_a_clip_within_its_limits_comes_back_to_the_last_bit(motion: mc.Motion) -> None:
    low, high = column(motion).min(), column(motion).max()
    made = mc.limit(motion, {ARM: (low, high)})
    assert made.values is motion.values
    assert made.history[-1]["measured"]["runs"] == 0


FRACTIONS = st.floats(0.0, 1.0)


@pytest.mark.filterwarnings("ignore:.* a spike")
@given(st.integers(0, 1000), FRACTIONS, FRACTIONS, st.floats(0.005, 3.0))
def test_no_sample_is_beyond_and_a_second_time_changes_nothing(seed: int, a: float, b: float, support: float) -> None:
    dice = np.random.default_rng(seed)
    values = 100 * np.cumsum(dice.normal(size=120)) * dice.choice([1, 0.01, 30])
    low, high = sorted(values.min() + np.ptp(values) * np.array([a, b]))
    made = mc.limit(signal(values), {CHANNEL: (low, high)}, support=support)
    assert (np.maximum(made.values - high, low - made.values)).max() <= 1e-6
    again = mc.limit(made, {CHANNEL: (low, high)}, support=support)
    assert again.values.tobytes() == made.values.tobytes()


def test_a_joint_without_room_is_held() -> None:
    made = mc.limit(signal(30 * np.sin(np.arange(200) / 7)), {CHANNEL: (5, 5)})
    assert (made.values == 5).all()


def test_each_run_gets_one_displacement_as_large_as_its_violation_and_gone_within_the_support() -> None:
    times = np.arange(400) * 0.01
    values = 30 * np.sin(2 * np.pi * times)  # over 25 around 0.25 s, 1.25 s ...
    made = mc.limit(signal(values), {CHANNEL: (None, 25)}, support=0.1)
    by = values - made.values[:, 0]
    beyond = values > 25
    assert _envelope.runs(beyond) == made.history[-1]["measured"]["runs"] == 4
    near = np.convolve(beyond, np.ones(21), "same") > 0
    assert (made.values[~near, 0] == values[~near]).all()
    for first in range(0, 400, 100):
        own = slice(first, first + 100)
        worst = first + int(np.argmax(values[own]))
        assert by[own].max() == by[worst] == pytest.approx(values[worst] - 25, abs=1e-12)
        rises, falls = np.diff(by[first : worst + 1]), np.diff(by[worst : first + 100])
        assert (rises >= -1e-12).all()
        assert (falls <= 1e-12).all()
    assert made.values.max() == pytest.approx(25, abs=1e-12)


def test_the_displacement_has_no_corner_and_a_clip_of_one_does() -> None:
    def turns(step: float, cut: bool) -> float:
        """Largest change of the displacement's slope from one frame to the next, per second."""
        values = 30 * np.sin(2 * np.pi * np.arange(0, 1, step))
        made = np.minimum(values, 20) if cut else mc.limit(signal(values, step), {CHANNEL: (None, 20)}).values[:, 0]
        return float(np.abs(np.diff(values - made, 2)).max() / step)

    assert turns(0.0005, True) > 0.7 * turns(0.002, True)
    assert turns(0.0005, False) < 0.3 * turns(0.002, False)


def test_other_channels_and_far_frames_stay(motion: mc.Motion) -> None:
    made = mc.limit(motion, {ARM: (-80, 30), HIPS: (16, None)}, support=0.15)
    named = np.isin(motion.skeleton.channel_names, [ARM, HIPS])
    assert made.values[:, ~named].tobytes() == motion.values[:, ~named].tobytes()
    for name, low, high in ((ARM, -80, 30), (HIPS, 16, np.inf)):
        was, now = column(motion, name), column(made, name)
        near = np.convolve((was < low) | (was > high), np.ones(2 * 18 + 1), "same") > 0
        assert near.any()
        assert not near.all()
        assert (was[~near] == now[~near]).all()


def test_limits_can_be_written_as_texts_and_patterns(motion: mc.Motion) -> None:
    made = mc.limit(motion, [f"{ARM}=-80:30", "Hips.Y*=16:"])
    same = mc.limit(motion, {ARM: (-80, 30), "Hips.Yposition": (16, None)})
    assert column(made, HIPS).min() >= 16 - 1e-6
    assert column(made).tobytes() == column(same).tobytes()
    step = {k: v for k, v in made.history[-1].items() if k not in ("verb", "measured")}
    assert mc.limit(motion, **step).values.tobytes() == made.values.tobytes()


def test_a_spike_is_told_as_what_it_is() -> None:
    values = 20 * np.sin(np.arange(200) / 20)
    values[100:103] += 80
    with pytest.warns(UserWarning, match=r"A.Xrotation is beyond its limits by 3[01]\.\d at 1.00 s: a spike"):
        made = mc.limit(signal(values), {CHANNEL: (None, 30)})
    assert made.values.max() <= 30 + 1e-6


def test_it_is_told_what_was_done(motion: mc.Motion) -> None:
    made = mc.limit(motion, {ARM: (-80, 30)})
    told = made.history[-1]["measured"]
    (row,) = told["angles"]
    was, now = column(motion), column(made)
    assert (row["angle"], row["low"], row["high"], told["source"]) == (ARM, -80.0, 30.0, "given")
    assert row["before"] == np.maximum(was - 30, -80 - was).max()
    assert row["after"] <= 1e-6
    assert row["frames"] == told["frames"] == int((was != now).sum())
    changed = was != now
    near = changed[:-2] | changed[1:-1] | changed[2:]
    expected = [np.abs(np.diff(values, 2))[near].max() * 120**2 for values in (was, now)]
    np.testing.assert_allclose(row["acceleration"], expected, rtol=1e-6)


# -- keys and splines ----------------------------------------------------------------------------------
@given(st.integers(0, 500), FRACTIONS, FRACTIONS)
def test_keys_stay_keys_and_are_within_limits_between_frames_too(seed: int, a: float, b: float) -> None:
    dice = np.random.default_rng(seed)
    clip = keyed(dice.uniform(-50, 50, 6).tolist(), dice.uniform(-300, 300, 6).tolist())
    reach = extremes(clip.curves[0])[1]
    low, high = sorted(reach.min() + np.ptp(reach) * np.array([0.3 * a, 1 - 0.3 * b]))
    made = mc.limit(clip, {CHANNEL: (low, high)}, support=0.1)
    assert isinstance(made, mc.KeyedMotion)
    values = extremes(made.curves[0])[1]
    assert np.maximum(values - high, low - values).max() <= 1e-6
    again = mc.limit(made, {CHANNEL: (low, high)}, support=0.1)
    assert again.curves[0] is made.curves[0]


def test_the_extremes_of_keys_are_those_of_the_curve() -> None:
    for seed in range(40):
        dice = np.random.default_rng(seed)
        curve = keyed(dice.normal(0, 20, 5).tolist(), dice.normal(0, 200, 5).tolist()).curves[0]
        fine = curve.at(np.linspace(0, 2, 200_001))
        found = extremes(curve)[1]
        np.testing.assert_allclose([found.min(), found.max()], [fine.min(), fine.max()], atol=1e-6)
    line = mc.HermiteCurve(np.array([0.0, 1.0, 2.0]), np.array([0.0, 1.0, 2.0]), np.ones(3))
    assert extremes(line)[0].tolist() == [0, 1, 2]


def test_keys_away_from_a_run_stay_and_few_are_added() -> None:
    clip = keyed([0, 10, 0, 60, 0, 10, 0])
    made = mc.limit(clip, {CHANNEL: (None, 40)}, support=0.2)
    assert len(made.curves[0]) <= len(clip.curves[0]) + 8
    fine = np.linspace(0, 3, 3001)
    beyond = fine[clip.curves[0].at(fine) > 40]
    away = (fine < beyond[0] - 0.201) | (fine > beyond[-1] + 0.201)
    np.testing.assert_allclose(made.curves[0].at(fine)[away], clip.curves[0].at(fine)[away], atol=1e-12)
    assert made.curves[0].at(fine).max() == pytest.approx(40, abs=1e-6)


def test_keys_beyond_at_both_ends_of_the_clip() -> None:
    clip = keyed([60, 0, 60])
    made = mc.limit(clip, {CHANNEL: (None, 50)})
    assert extremes(made.curves[0])[1].max() <= 50 + 1e-6
    still = mc.KeyedMotion(ONE, (mc.HermiteCurve([0.5], [70.0], [0.0]),), 0.01, 101)  # constant
    assert column(mc.limit(still, {CHANNEL: (None, 50)}), CHANNEL).max() <= 50 + 1e-6


@pytest.mark.parametrize("degree", [1, 2, 3])
def test_splines_stay_splines(degree: int) -> None:
    clip = spline(ONE, 24, degree, degree)
    made = mc.limit(clip, {CHANNEL: (-15, 15)})
    assert type(made) is type(clip)
    fine = np.linspace(0, clip.duration, 20_001)
    assert np.abs(made.at(fine)).max() <= 15 + 1e-6
    assert np.abs(clip.at(fine)).max() > 20


def test_splines_of_a_higher_degree_become_samples() -> None:
    clip = spline(ONE, 24, 5, 2)
    with pytest.warns(UserWarning, match="splines become samples: they are kept within limits frame by frame"):
        made = mc.limit(clip, {CHANNEL: (-10, 10)})
    assert np.abs(made.sample().values).max() <= 10 + 1e-6


# -- refusals --------------------------------------------------------------------------------------------
@pytest.mark.parametrize("frames", [0, 1, 2])
def test_short_clips(motion: mc.Motion, frames: int) -> None:
    made = mc.limit(motion[:frames], {ARM: (-10, 10)})
    assert made.frames == frames
    assert (np.abs(column(made)) <= 10 + 1e-6).all()


@pytest.mark.parametrize(
    ("limits", "options", "text"),
    [
        ({ARM: (10, -10)}, {}, "LeftArm.Zrotation: a limit is LOW:HIGH, the lower first, one of them may be left out"),
        ({ARM: (float("nan"), 1)}, {}, "not nan:1"),
        ({ARM: (1, 2, 3)}, {}, "not 1:2:3"),
        ({ARM: 5}, {}, "not 5"),
        ("-90:45", {}, "a limit is NAME=LOW:HIGH, like LeftArm.Zrotation=-90:45; not '-90:45'"),
        ([f"{ARM}=low:45"], {}, "not low:45"),
        ({ARM: (0, 1)}, {"support": 0}, "support is a number of seconds above 0, not 0"),
        ({ARM: (0, 1)}, {"support": float("inf")}, "support is a number of seconds above 0"),
        ({ARM: (0, 1)}, {"only": "Hips"}, "none of the joints that Hips names has limits here"),
    ],
)
def test_wrong_options_are_refused(motion: mc.Motion, limits: object, options: dict, text: str) -> None:
    with pytest.raises(OptionError, match=text):
        mc.limit(motion, limits, **options)


def test_names_that_are_not_there_are_answered(motion: mc.Motion) -> None:
    with pytest.raises(UnknownName, match=r"no channel or angle 'LeftArm.Zrotaton'. Did you mean 'LeftArm.Zrotation'"):
        mc.limit(motion, {"LeftArm.Zrotaton": (0, 1)})
    with pytest.raises(UnknownName, match=r"no channel or angle 'LeftLeg.flexon'. Did you mean 'LeftLeg.flexion'"):
        mc.limit(motion, {"LeftLeg.flexon": (0, 1)})
    nobody = signal(np.zeros(5))
    with pytest.raises(
        OptionError, match=r"no knee, elbow, hip or shoulder is recognised.*--limit LeftArm.Zrotation=-90"
    ):
        mc.limit(nobody)
