"""Skeleton: order of joints, names of channels, refusals."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mocurve import Mismatch, OptionError, Skeleton, UnknownName
from mocurve.skeleton import CHANNEL_KINDS

BODY = Skeleton(
    ("Hips", "Leg", "Foot", "Foot_End", "Head"),
    [-1, 0, 1, 2, 0],
    np.zeros((5, 3)),
    [("Xposition", "Zrotation"), ("Yrotation",), (), (), ("Xrotation",)],
    [False, False, False, True, False],
)


@st.composite
def trees(draw: st.DrawFn) -> list[int]:
    """Parents of any forest, depth first."""
    parents: list[int] = []
    branch = [-1]
    for joint in range(draw(st.integers(0, 12))):
        parents.append(draw(st.sampled_from(branch)))
        branch = [*branch[: branch.index(parents[-1]) + 1], joint]
    return parents


def bare(parents: Sequence[int]) -> Skeleton:
    return Skeleton([f"J{j}" for j in range(len(parents))], parents, np.zeros((len(parents), 3)), [()] * len(parents))


@given(trees())
def test_any_forest_depth_first_is_a_skeleton(parents: list[int]) -> None:
    skeleton = bare(parents)
    for joint in range(len(parents)):
        above = {joint}
        while (joint := parents[joint]) >= 0:
            above.add(joint)
        lowest = max(above)
        assert {j for j in range(len(parents)) if skeleton.below(j)[lowest]} == above


@given(trees())
def test_all_below_a_joint_is_one_run(parents: list[int]) -> None:
    skeleton = bare(parents)
    for joint in range(len(parents)):
        inside = np.flatnonzero(skeleton.below(joint))
        assert inside.tolist() == list(range(joint, joint + len(inside)))


@pytest.mark.parametrize("parents", [[0], [1, -1], [-1, 0, 0, 1], [-1, -2], [-1, 5], [-1, -1, 0]])
def test_joints_out_of_depth_first_order_are_refused(parents: list[int]) -> None:
    with pytest.raises(Mismatch, match=r"joint 'J\d' is out of order: joints stand depth first, after their parent"):
        bare(parents)


def test_channels_are_named_and_numbered_in_file_order() -> None:
    assert BODY.channel_names == ("Hips.Xposition", "Hips.Zrotation", "Leg.Yrotation", "Head.Xrotation")
    assert BODY.channel_count == 4
    assert BODY.channel_joints.tolist() == [0, 0, 1, 4]
    assert BODY.channel_axes.tolist() == [0, 2, 1, 0]
    assert BODY.rotation_channels.tolist() == [False, True, True, True]


def test_every_name_finds_its_own_place() -> None:
    assert [BODY.joint(name) for name in BODY.names] == [0, 1, 2, 3, 4]
    assert [BODY.channel(name) for name in BODY.channel_names] == [0, 1, 2, 3]


def test_names_that_are_not_there_or_there_twice_are_refused() -> None:
    with pytest.raises(UnknownName, match=r"^no joint 'Fot'\. Did you mean 'Foot'\?$"):
        BODY.joint("Fot")
    with pytest.raises(UnknownName, match=r"^no channel 'Leg.Zrotation'\. Did you mean 'Leg.Yrotation'\?$"):
        BODY.channel("Leg.Zrotation")
    twins = Skeleton(("A", "A"), [-1, -1], np.zeros((2, 3)), [("Xrotation",)] * 2)
    with pytest.raises(Mismatch, match="2 joints are called 'A'"):
        twins.joint("A")
    with pytest.raises(Mismatch, match=r"2 channels are called 'A.Xrotation'"):
        twins.channel("A.Xrotation")


@pytest.mark.parametrize(
    ("parents", "offsets", "channels", "message"),
    [
        ([-1, 0], np.zeros((1, 3)), [()], "1 joint names but 2 parents"),
        ([-1], np.zeros((2, 3)), [()], "1 joint names but 2 offsets"),
        ([-1], np.zeros((1, 3)), [(), ()], "1 joint names but 2 channels"),
    ],
)
def test_lists_of_different_length_are_refused(
    parents: list, offsets: np.ndarray, channels: list, message: str
) -> None:
    with pytest.raises(Mismatch, match=message):
        Skeleton(("A",), parents, offsets, channels)
    with pytest.raises(Mismatch, match="1 joint names but 2 end_sites"):
        Skeleton(("A",), [-1], np.zeros((1, 3)), [()], [True, False])


def test_a_channel_of_an_unknown_kind_is_refused_with_the_nearest() -> None:
    with pytest.raises(UnknownName, match=r"no channel kind \(joint 'A'\) 'Xrotatoin'\. Did you mean 'Xrotation'\?"):
        Skeleton(("A",), [-1], np.zeros((1, 3)), [("Xrotatoin",)])
    assert Skeleton(("A",), [-1], np.zeros((1, 3)), [CHANNEL_KINDS]).channel_count == 6


@pytest.mark.parametrize("unit", [0.0, -1.0, np.nan, np.inf])
def test_a_unit_that_is_no_length_is_refused(unit: float) -> None:
    with pytest.raises(OptionError, match="unit must be a positive number of metres, not "):
        Skeleton(("A",), [-1], np.zeros((1, 3)), [()], unit=unit)


def test_what_a_skeleton_holds_cannot_be_written_and_is_its_own() -> None:
    parents, offsets = np.array([-1, 0]), np.zeros((2, 3))
    skeleton = Skeleton(("A", "B"), parents, offsets, [(), ()])
    parents[1], offsets[1, 1] = -1, 7.0
    assert skeleton.parents.tolist() == [-1, 0]
    assert not skeleton.offsets.any()
    for array in (skeleton.parents, skeleton.offsets, skeleton.end_sites):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 0


def test_the_representation_counts() -> None:
    assert repr(BODY) == "<Skeleton 4 joints, 1 end sites, 4 channels>"
