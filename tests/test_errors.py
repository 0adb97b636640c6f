"""Errors: each is the builtin that a caller expects, and its text is one readable line."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mocurve import FileError, Mismatch, MocurveError, OptionError, UnknownName


@pytest.mark.parametrize(
    ("kind", "builtin"),
    [(FileError, ValueError), (OptionError, ValueError), (Mismatch, ValueError), (UnknownName, KeyError)],
)
def test_an_error_is_also_the_builtin_that_a_caller_expects(kind: type, builtin: type) -> None:
    assert issubclass(kind, MocurveError)
    assert issubclass(kind, builtin)


@pytest.mark.parametrize(
    ("error", "text"),
    [
        (FileError("96 numbers expected", "walk.bvh", 312), "walk.bvh:312: 96 numbers expected"),
        (FileError("is empty", Path("walk.bvh")), "walk.bvh: is empty"),
        (FileError("no MOTION", None, 3), "3: no MOTION"),
        (FileError("no MOTION"), "no MOTION"),
    ],
)
def test_a_file_error_says_where(error: FileError, text: str) -> None:
    assert str(error) == text
    assert error.message in text


@pytest.mark.parametrize(
    ("name", "known", "text"),
    [
        ("LeftFot", ["LeftFoot", "RightFoot"], "no joint 'LeftFot'. Did you mean 'LeftFoot'?"),
        ("HIPS", ["Hips"], "no joint 'HIPS'. Did you mean 'Hips'?"),
        ("Tail", ["Hips", "Head"], "no joint 'Tail'. There is: Hips, Head."),
        ("Tail", [], "no joint 'Tail'. There is none."),
        (
            "Tail",
            [f"J{k}" for k in range(13)],
            f"no joint 'Tail'. There is: {', '.join(f'J{k}' for k in range(12))} ….",
        ),
        ("Tail", ["Hips", "Hips"], "no joint 'Tail'. There is: Hips."),
    ],
)
def test_an_unknown_name_hints_at_the_nearest_or_at_what_there_is(name: str, known: list[str], text: str) -> None:
    assert str(UnknownName("joint", name, known)) == text


@given(st.text(), st.lists(st.text(), max_size=20))
def test_an_unknown_name_can_be_any_text_among_any_texts(name: str, known: list[str]) -> None:
    text = str(UnknownName("joint", name, known))
    assert text.startswith(f"no joint {name!r}. ")
    assert text.endswith(("?", "."))
