"""waveshape: rising, smooth in its slope, the identity inside, never beyond the limits, through the pairs."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from turning import spline

import mocurve as mc
from mocurve import OptionError, UnknownName
from mocurve.edit.waveshape import Soft, Through

ARM = "LeftArm.Zrotation"
PAIRS = [(-90.0, -60.0), (0.0, 0.0), (30.0, 45.0), (90.0, 60.0)]


@pytest.fixture(scope="module")
def motion(jump: Path) -> mc.Motion:
    return mc.read(jump)


def column(clip: mc.Motion, name: str = ARM) -> np.ndarray:
    return clip.values[:, clip.skeleton.channel(name)]


# -- laws of the curves --------------------------------------------------------------------------------
ENDS = st.tuples(st.floats(-200, 200), st.floats(0.1, 300), st.floats(0.01, 0.5)).map(
    lambda t: Soft(t[0], t[0] + t[1], t[1] * t[2])
)


@given(ENDS, st.lists(st.floats(-1e4, 1e4), min_size=2, max_size=50))
def test_soft_limits_rise_are_never_passed_and_leave_what_is_inside(curve: Soft, given_values: list[float]) -> None:
    values = np.sort(given_values)
    made = curve.at(values)
    assert (np.diff(made) >= 0).all()
    assert made.min() >= curve.low
    assert made.max() <= curve.high
    inside = (values >= curve.low + curve.margin) & (values <= curve.high - curve.margin)
    assert (made[inside] == values[inside]).all()


@pytest.mark.parametrize(
    "curve",
    [
        Soft(-60.0, 40.0, 8.0),
        Soft(-np.inf, 40.0, 8.0),
        Through(*np.array(PAIRS).T),
        Through(*np.array([(0, 1), (2, 5)]).T),
    ],
)
def test_the_slope_does_not_jump(curve: Soft | Through) -> None:
    for step in (1e-2, 1e-3):
        slopes = np.diff(curve.at(np.arange(-120, 120, step))) / step
        assert slopes.min() >= 0
        assert np.abs(np.diff(slopes)).max() < 0.4 * step  # a corner would jump by a fixed amount


def test_a_map_goes_through_its_pairs_and_straight_on() -> None:
    old, new = np.array(PAIRS).T
    curve = Through(old, new)
    np.testing.assert_allclose(curve.at(old), new, atol=1e-12)
    beyond = np.diff(curve.at(np.array([90.0, 100.0, 110.0, 130.0]))) / [10, 10, 20]
    np.testing.assert_allclose(beyond, beyond[0])
    assert beyond[0] > 0


# -- the verb --------------------------------------------------------------------------------------------
def test_only_the_named_channels_change_and_it_is_told(motion: mc.Motion) -> None:
    made = mc.waveshape(motion, {ARM: (-85, 10)}, {"Hips.Yposition": [(15, 15.5), (20, 18)]}, margin=3)
    others = ~np.isin(motion.skeleton.channel_names, [ARM, "Hips.Yposition"])
    assert made.values[:, others].tobytes() == motion.values[:, others].tobytes()
    assert column(made).min() >= -85
    told = {row["channel"]: row for row in made.history[-1]["measured"]}
    assert told[ARM]["changed"] == np.mean(column(motion) != column(made))
    assert 0 < told[ARM]["changed"] < 1
    assert told[ARM]["before"] == (column(motion).min(), column(motion).max())
    assert told[ARM]["after"] == (column(made).min(), column(made).max())


def test_values_that_stay_come_back_to_the_last_digit(motion: mc.Motion) -> None:
    wide = {"*.Zrotation": (-720.0, 720.0)}
    same = {ARM: [(-90, -90), (0, 0), (90, 90)]}
    for made in (mc.waveshape(motion), mc.waveshape(motion, wide, margin=1), mc.waveshape(motion, {}, same)):
        assert made.values.tobytes() == motion.values.tobytes()


def test_keys_and_splines_stay_where_their_values_do(motion: mc.Motion) -> None:
    keys = mc.reduce(motion[:120], tolerance="3deg")
    wide = {ARM: (-720.0, 720.0)}
    assert mc.waveshape(keys, wide).curves == keys.curves
    bent = spline(motion.skeleton, 20, 3, 1)
    assert mc.waveshape(bent, wide).values.tobytes() == bent.values.tobytes()
    low = column(keys.sample()).mean()
    with pytest.warns(UserWarning, match="keys become samples: their values are shaped frame by frame"):
        made = mc.waveshape(keys, {ARM: (None, low)})
    assert column(made).max() <= low


def test_keys_that_overshoot_between_frames_do_not_stay() -> None:
    body = mc.Skeleton(("A",), [-1], [[0, 0, 0]], (("Xrotation",),))
    curve = mc.HermiteCurve(np.array([0.0, 1.0]), np.zeros(2), np.array([40.0, -40.0]))  # 10 at its middle
    keys = mc.KeyedMotion(body, (curve,), 1.0, 2)
    assert mc.waveshape(keys, {"A.Xrotation": (-20, 12)}, margin=1).curves == keys.curves
    with pytest.warns(UserWarning, match="keys become samples"):
        mc.waveshape(keys, {"A.Xrotation": (-20, 10.5)}, margin=1)


def test_one_side_can_be_open_and_the_margin_has_a_default(motion: mc.Motion) -> None:
    top = column(motion).max()
    made = column(mc.waveshape(motion, {ARM: (None, top)}))
    bend = top - 0.1 * np.ptp(column(motion))
    assert (made[column(motion) <= bend] == column(motion)[column(motion) <= bend]).all()
    assert (made[column(motion) > bend] < column(motion)[column(motion) > bend]).all()


def test_the_step_can_be_run_again(motion: mc.Motion) -> None:
    made = mc.waveshape(motion, f"{ARM}=-80:", ["Hips.Yposition=15:15.5,20:18"], margin=2)
    step = {k: v for k, v in made.history[-1].items() if k not in ("verb", "measured")}
    assert mc.waveshape(motion, **step).values.tobytes() == made.values.tobytes()


@pytest.mark.parametrize("frames", [0, 1])
def test_clips_without_motion(motion: mc.Motion, frames: int) -> None:
    assert mc.waveshape(motion[:frames], {ARM: (-20, 20)}).frames == frames


@pytest.mark.parametrize(
    ("soft", "map", "margin", "text"),
    [
        ({ARM: (10, -10)}, {}, None, "LeftArm.Zrotation: a soft limit is LOW:HIGH, the lower first"),
        ({ARM: (None, None)}, {}, None, "one of them may be left out; not :"),
        ({ARM: (0, 5)}, {}, 3, "the limits are 5 apart, which has no room for two margins of 3"),
        (["0:5"], {}, None, "a soft limit is NAME=LOW:HIGH, like LeftArm.Zrotation=-90:45; not '0:5'"),
        (f"{ARM}=a:b", {}, None, "not a:b"),
        ({}, {ARM: [(0, 1)]}, None, "LeftArm.Zrotation: a map has two pairs or more, and new values rise"),
        ({}, {ARM: [(0, 1), (1, 0)]}, None, "new values rise with the old ones"),
        ({}, f"{ARM}=0:0,x", None, "pairs are old:new values, like -90:-60,90:60; not '0:0,x'"),
        ({}, "0:0,1:1", None, "a map is CHANNEL=OLD:NEW,OLD:NEW"),
        ({ARM: (0, 9)}, {ARM: [(0, 0), (1, 1)]}, None, "two curves are given for LeftArm.Zrotation"),
        ({ARM: (0, 9)}, {}, -1, "margin is a number above 0, not -1"),
    ],
)
def test_wrong_options_are_refused(motion: mc.Motion, soft: object, map: object, margin: object, text: str) -> None:
    with pytest.raises(OptionError, match=text):
        mc.waveshape(motion, soft, map, margin=margin)


def test_a_channel_that_is_not_there_is_named(motion: mc.Motion) -> None:
    with pytest.raises(UnknownName, match=r"no channel 'LeftArm.Zrotaton'. Did you mean 'LeftArm.Zrotation'"):
        mc.waveshape(motion, {"LeftArm.Zrotaton": (0, 9)})
