"""Tolerances: the grammar, units, names, intervals; later rules win; what is odd is refused in words."""

from __future__ import annotations

import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from mocurve import MocurveError, Motion, OptionError, Skeleton, UnknownName, read
from mocurve.kinematics import rest_height
from mocurve.reduction.tolerance import CHANNEL_UNITS, METRES, WORLD_UNITS, Rule, parse, resolve

UNITS = (*WORLD_UNITS, *CHANNEL_UNITS)
AMOUNTS = st.floats(0.0, 1e30)
NAMES = st.text(min_size=1, max_size=12).filter(lambda text: text == text.strip() and not set(text) & set("@="))
TIMES = st.none() | st.floats(0.0, 1e6)
GRAMMAR = "a number and a unit are expected, like 2mm or LeftHand@1.2..2.0=0.5mm; units: mm, cm, m, in, inch, ft, u,"


def body(frames: int = 11, unit: float | None = 0.01) -> Motion:
    """A person of 170 units: hips that move and turn, a leg, a foot and its end; 0.1 s a frame."""
    skeleton = Skeleton(
        ("Hips", "Leg", "Foot", "Foot_End"),
        [-1, 0, 1, 2],
        [[0, 0, 0], [0, -80, 0], [0, -80, 0], [0, -10, 0]],
        [("Yposition", "Zrotation"), ("Xrotation", "Zrotation"), ("Xrotation",), ()],
        [False, False, False, True],
        unit,
    )
    return Motion(skeleton, np.outer(np.arange(frames), [1.0, 2.0, 3.0, 4.0, 5.0]), 0.1)


def joints(*texts: str, clip: Motion | None = None) -> np.ndarray:
    found = resolve(parse(texts), clip or body()).joints
    assert found is not None
    return found


def channels(*texts: str, clip: Motion | None = None) -> np.ndarray:
    return resolve(parse(texts), clip or body()).channels


# -- the grammar -------------------------------------------------------------------------------------
@given(
    AMOUNTS, st.sampled_from(UNITS), st.none() | NAMES, st.none() | st.tuples(TIMES, TIMES), st.sampled_from(["", " "])
)
def test_what_is_written_is_read(
    amount: float, unit: str, name: str | None, interval: tuple[float | None, float | None] | None, space: str
) -> None:
    start, end = interval or (None, None)
    assume(start is None or end is None or start <= end)
    text = f"{amount!r}{space}{unit}"
    if name is not None or interval is not None:
        seconds = "" if interval is None else "@" + "..".join("" if time is None else repr(time) for time in interval)
        text = f"{name or ''}{seconds}{space}={space}{text}"
    assert parse(text)[-1] == Rule(amount, unit, name, start, end)


@given(st.text(max_size=30) | st.text("0123456789.@=%mudegrnaf LH*+-e", max_size=20))
def test_any_other_text_is_refused_in_one_line(text: str) -> None:
    try:
        rule, said = parse(text)[-1], ""
    except OptionError as error:
        rule, said = None, str(error)
    assert "\n" not in said
    assert repr(text) in said if rule is None else rule.unit in UNITS and 0 <= rule.amount < np.inf


@pytest.mark.parametrize("text", ["", " ", "2", "mm", "2 2mm", "nanmm", "LeftHand=", "@1..2", "a@1=2mm", "2m²"])
def test_what_is_no_rule_is_refused_with_an_example(text: str) -> None:
    with pytest.raises(OptionError) as caught:
        parse(text)
    assert str(caught.value).startswith(f"tolerance {text!r}: {GRAMMAR}")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("2MM", "no unit 'MM'; units: mm, cm, m, in, inch, ft, u, %height, deg, %range"),
        ("2%", "a number and a unit are expected"),
        ("2 % width", "no unit '%width'; units: "),
        ("-1mm", "the amount must be a number from 0 up"),
        ("1e999mm", "the amount must be a number from 0 up"),
        ("@2..1=1mm", "the interval ends before it starts"),
        ("@-1..1=1mm", "a time is a number of seconds from 0 up"),
        ("@nan..1=1mm", "a time is a number of seconds from 0 up"),
        ("@inf..=1mm", "a time is a number of seconds from 0 up"),
        ("@1..2..3=1mm", "'2..3' is not a time in seconds"),
        ("@soon..2=1mm", "'soon' is not a time in seconds"),
    ],
)
def test_what_is_wrong_in_a_rule_is_said(text: str, message: str) -> None:
    with pytest.raises(OptionError) as caught:
        parse(text)
    assert str(caught.value).startswith(f"tolerance {text!r}: {message}")


@pytest.mark.parametrize("tolerance", [None, 2, 0.5, [], (), [2], ["2mm", None], {"2mm"}, b"2mm"])
def test_what_is_no_text_is_refused(tolerance: object) -> None:
    with pytest.raises(OptionError, match=r"a tolerance is a text with its unit, like '2mm' or '0\.5deg'") as caught:
        parse(tolerance)  # type: ignore[arg-type]
    assert str(caught.value).endswith(f"not {tolerance!r}")


@pytest.mark.parametrize("text", ["@1s..2s=1mm", "@1.0 .. 2.0=1mm", "@1.0s..2.0 s = 1 mm", " @1..2.=1mm "])
def test_seconds_may_be_written_with_their_letter_and_spaces(text: str) -> None:
    assert parse(text)[-1] == Rule(1.0, "mm", None, 1.0, 2.0)


def test_without_a_rule_for_the_whole_clip_the_default_stands_first() -> None:
    default = Rule(0.1, "%height")
    assert parse("Foot=1mm") == (default, Rule(1.0, "mm", "Foot"))
    assert parse(["@1..2=1mm"])[0] == default
    assert parse(["Foot=1mm", "2mm"]) == (Rule(1.0, "mm", "Foot"), Rule(2.0, "mm"))
    assert parse("0.5deg") == (Rule(0.5, "deg"),)
    assert parse("@..=1u") == (Rule(1.0, "u"),)


# -- units -------------------------------------------------------------------------------------------
@pytest.mark.parametrize(
    ("text", "metres"),
    [("2mm", 0.002), ("0.2cm", 0.002), ("0.002m", 0.002), ("0.5in", 0.0127), ("0.5inch", 0.0127), ("0.1ft", 0.03048)],
)
@pytest.mark.parametrize("unit", [0.001, 0.01, 1.0, 0.0254, 0.056444])
def test_lengths_are_converted_by_the_unit_that_was_said(text: str, metres: float, unit: float) -> None:
    np.testing.assert_allclose(joints(text, clip=body(unit=unit)), metres / unit, rtol=1e-12)


@pytest.mark.parametrize("unit", METRES)
def test_a_guessed_unit_is_told_once(unit: str) -> None:
    with pytest.warns(UserWarning, match="does not say its length unit; its rest height suggests cm") as told:
        found = joints(f"1{unit}", clip=body(unit=None))
    assert len(told) == 1
    np.testing.assert_allclose(found, METRES[unit] / 0.01)


@pytest.mark.parametrize("text", ["0.1%height", "0.17u", "1deg", "1%range"])
def test_a_unit_that_nobody_needs_is_not_guessed(text: str) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        resolve(parse(text), body(unit=None))


def test_percent_of_height_and_file_units() -> None:
    assert rest_height(body()) == 170.0
    np.testing.assert_allclose(joints("0.1%height"), 0.17)
    np.testing.assert_array_equal(joints("0.35u"), 0.35)


def test_degrees_are_a_length_on_positions_and_percent_is_of_each_range() -> None:
    length = np.radians(0.5) * 170.0
    np.testing.assert_allclose(channels("0.5deg"), np.tile([[length], [0.5], [0.5], [0.5], [0.5]], 11))
    np.testing.assert_allclose(channels("10%range"), np.tile([[1.0], [2.0], [3.0], [4.0], [5.0]], 11))


def test_a_body_without_height_takes_no_part_of_it_and_has_no_unit_to_guess() -> None:
    point = Motion(Skeleton(("A",), [-1], [[1, 2, 3]], [("Xposition",)]), np.zeros((3, 1)), 0.1)
    with pytest.raises(
        OptionError, match=r"the rest pose has no height to take a part of; give the tolerance in u, mm"
    ):
        joints("0.1%height", clip=point)
    with pytest.raises(OptionError, match="the rest pose has no height to guess the length unit from"):
        joints("1mm", clip=point)
    np.testing.assert_array_equal(joints("1u", clip=point), 1.0)
    np.testing.assert_allclose(channels("1deg", clip=point), np.radians(1.0))


# -- names and intervals -----------------------------------------------------------------------------
def test_world_and_channel_rules_hold_side_by_side() -> None:
    both = resolve(parse(["2u", "5deg"]), body())
    np.testing.assert_array_equal(both.joints, 2.0)
    np.testing.assert_allclose(both.channels[1:], 5.0)
    assert resolve(parse("5deg"), body()).joints is None
    assert np.isinf(channels("2u")).all()


def test_a_joint_rule_speaks_of_that_joint_and_a_pattern_of_all_that_fit() -> None:
    assert joints("1u", "Foot=2u")[:, 0].tolist() == [1, 1, 2, 1]
    assert joints("1u", "Foot*=2u")[:, 0].tolist() == [1, 1, 2, 2]
    assert joints("1u", "?e?=2u", "*_End=3u")[:, 0].tolist() == [1, 2, 1, 3]
    assert channels("1deg", "Leg=2deg")[1:, 0].tolist() == [1, 2, 2, 1]
    assert channels("1deg", "Leg.Zrotation=2deg")[1:, 0].tolist() == [1, 1, 2, 1]
    assert channels("1deg", "*.Xrotation=2deg")[1:, 0].tolist() == [1, 2, 1, 2]


def test_a_name_with_the_letters_of_a_pattern_is_found_as_it_is_written() -> None:
    clip = body()
    odd = replace(clip, skeleton=replace(clip.skeleton, names=("Hips", "Leg[1]", "Fuß *", "腕")))
    assert joints("1u", "Leg[1]=2u", "Fuß *=3u", "腕=4u", clip=odd)[:, 0].tolist() == [1, 2, 3, 4]


def test_joints_of_the_same_name_get_the_same_rule() -> None:
    clip = body()
    twins = replace(clip, skeleton=replace(clip.skeleton, names=("Hips", "Leg", "Leg", "End")))
    assert joints("1u", "Leg=2u", clip=twins)[:, 0].tolist() == [1, 2, 2, 1]


def test_an_interval_holds_at_its_frames_both_ends_included() -> None:
    assert joints("1u", "Foot@0.3..0.5=2u")[2].tolist() == [1, 1, 1, 2, 2, 2, 1, 1, 1, 1, 1]
    assert joints("1u", "Foot@0.8..=2u")[2].tolist() == [1, 1, 1, 1, 1, 1, 1, 1, 2, 2, 2]
    assert joints("1u", "@..0.1=2u")[0].tolist() == [2, 2, 1, 1, 1, 1, 1, 1, 1, 1, 1]
    assert channels("1deg", "Foot@0.3..0.3=2deg")[4].tolist() == [1, 1, 1, 2, 1, 1, 1, 1, 1, 1, 1]
    assert joints("1u", "Foot@0.3..0.5=2u")[0].tolist() == [1] * 11


def test_later_rules_win() -> None:
    assert joints("Foot=2u", "1u")[2, 0] == 1.0
    assert joints("1u", "Foot=2u", "F*=3u")[2, 0] == 3.0
    assert joints("1u", "@0.2..0.4=5u", "Foot@0.3..0.9=2u")[2].tolist() == [1, 1, 5, 2, 2, 2, 2, 2, 2, 2, 1]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("Fot=1u", "no joint 'Fot'. Did you mean 'Foot'?"),
        ("Foot.Xrotation=1u", "no joint 'Foot.Xrotation'. There is: Hips, Leg, Foot, Foot_End."),
        ("Foot.Zrotation=1deg", "no joint or channel 'Foot.Zrotation'. Did you mean 'Foot.Xrotation'?"),
        ("Foot_End=1deg", "no joint or channel 'Foot_End'. Did you mean 'Foot'?"),
        ("Q*=1u", "no joint 'Q*'. There is: Hips, Leg, Foot, Foot_End."),
    ],
)
def test_a_name_that_is_not_there_is_refused_with_the_nearest(text: str, message: str) -> None:
    with pytest.raises(UnknownName) as caught:
        resolve(parse(text), body())
    assert str(caught.value) == message


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("@5..6=1u", "no frame lies from 5 s to 6 s; the clip ends at 1 s"),
        ("@5..=1u", "no frame lies from 5 s on; the clip ends at 1 s"),
        ("@0.31..0.39=1u", "no frame lies from 0.31 s to 0.39 s; the clip ends at 1 s"),
    ],
)
def test_an_interval_without_frames_is_refused(text: str, message: str) -> None:
    with pytest.raises(OptionError) as caught:
        resolve(parse(text), body())
    assert str(caught.value) == message


def test_a_clip_without_frames_takes_any_rule() -> None:
    limits = resolve(parse(["1u", "Foot@5..6=2u", "1deg", "1%range"]), body(frames=0))
    assert limits.joints is not None
    assert limits.joints.shape == (4, 0)
    assert limits.channels.shape == (5, 0)


@given(st.lists(st.sampled_from(["1u", "Foot=2u", "@0.2..0.4=3u", "L*@0.3..=4u", "1deg", "Leg=2%range"]), max_size=5))
def test_each_later_rule_leaves_its_amount_where_it_speaks(texts: list[str]) -> None:
    limits = resolve(parse(["0.5u", *texts, "Foot@0.5..0.7=9u"]), body())
    assert limits.joints is not None
    assert (limits.joints[2, 5:8] == 9.0).all()
    assert set(np.unique(limits.joints)) <= {0.5, 1.0, 2.0, 3.0, 4.0, 9.0}


@given(st.text(max_size=15), st.sampled_from(["u", "deg", "%range", "%height"]))
def test_any_name_is_found_or_refused(name: str, unit: str) -> None:
    try:
        limits, said = resolve(parse(f"{name}=1{unit}"), body()), ""
    except MocurveError as error:
        limits, said = None, str(error)
    assert "\n" not in said
    assert said if limits is None else not np.isnan(limits.channels).any()


def test_rules_of_the_real_clip(jump: Path) -> None:
    clip = read(jump)
    limits = joints("Left*@1..2=0.01u", clip=clip)
    left = np.array([name.startswith("Left") for name in clip.skeleton.names])
    inside = np.abs(np.arange(clip.frames) * clip.frame_time - 1.5) <= 0.5 + 1e-9
    assert ((limits == 0.01) == left[:, None] & inside).all()
    np.testing.assert_allclose(limits[~left], 0.001 * rest_height(clip))
