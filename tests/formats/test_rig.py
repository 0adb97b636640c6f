"""What the writers for animation programs share: names, and times in frames."""

from __future__ import annotations

import re
import warnings

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mocurve.formats._rig import different, frame_numbers, identifier, identifiers

names = st.lists(
    st.one_of(st.sampled_from(["a", "a_2", "a_3", "A", "", "é", "top", "1"]), st.text(max_size=5)), max_size=12
)


def quietly(make, *args) -> list[str]:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return make(*args, "Maya")


@given(names)
def test_identifiers_are_valid_and_each_is_there_once(given_names):
    made = quietly(identifiers, given_names)
    assert len(set(made)) == len(made) == len(given_names)
    assert all(re.fullmatch("[A-Za-z_][A-Za-z0-9_]*", name) for name in made)
    assert [identifier(name) for name in made] == made
    assert quietly(identifiers, made) == made


@given(names)
def test_different_names_are_each_there_once_and_the_first_stays(given_names):
    made = quietly(different, given_names)
    assert len(set(made)) == len(made) == len(given_names)
    plain = [name for name in given_names if name and min(name) > "\x1f"]
    assert all(made[given_names.index(name)] == name for name in plain if name != "joint")


def test_reserved_names_are_not_given():
    with pytest.warns(UserWarning, match="joint names changed for Maya: 'top' is 'top_2', 'top' is 'top_3'$"):
        assert identifiers(["top", "side_2", "top"], "Maya", ("top", "side")) == ["top_2", "side_2", "top_3"]


def test_thousands_of_equal_names_are_no_long_search():
    made = quietly(different, ["a"] * 20_000)
    assert made[-1] == "a_20000"


@given(st.integers(0, 10**6), st.sampled_from([1 / 24, 1 / 30, 1001 / 30000, 1 / 120, 0.0123]))
def test_times_of_frames_are_whole_numbers(frame, frame_time):
    assert frame_numbers(np.array([frame * frame_time]), frame_time).tolist() == [frame]


def test_times_between_frames_stay_between():
    assert frame_numbers(np.array([0.5, 1.25]), 0.5).tolist() == [1.0, 2.5]
    assert frame_numbers(np.array([1.0 + 1e-9]), 1.0)[0] == 1.0 + 1e-9
