"""Numbers read in whole columns are those that float() reads, bit for bit."""

from __future__ import annotations

import re

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mocurve.formats._numbers import PAD, NotANumber, parse

plain = st.from_regex(r"-?([0-9]{1,9}\.?[0-9]{0,9}|\.[0-9]{1,9})", fullmatch=True)
any_float = st.floats(allow_nan=False, allow_infinity=False)
odd = st.from_regex(r"[+-]?[0-9]{0,20}\.[0-9]{1,25}([eE][+-]?[0-9]{1,2})?", fullmatch=True)
decimals = st.tuples(st.integers(0, 9), st.lists(st.floats(-1e7, 1e7), min_size=1)).map(
    lambda p: [f"{x:.{p[0]}f}" for x in p[1]]
)
blanks = st.sampled_from([" ", "  ", "\n", "\t", " \r\n", "\n\n", "\f"])


def block(text: bytes):
    return parse(np.frombuffer(b" " * PAD + text, np.uint8), ord("\n"))


def check(words: list[str], gaps: list[str]) -> None:
    text = "".join(word + gap for word, gap in zip(words, gaps, strict=True))
    numbers, before = block(text.encode())
    assert numbers.tobytes() == np.array([float(word) for word in words]).tobytes()
    assert before.tolist() == [len(text[: match.start()].split()) for match in re.finditer("\n", text)]


@settings(max_examples=60, deadline=None)
@given(
    st.data(),
    st.one_of(decimals, st.lists(plain, min_size=1), st.lists(st.one_of(plain, odd, any_float.map(repr)), min_size=1)),
)
def test_words_are_read_as_float_reads_them(data, words):
    check(words, data.draw(st.lists(blanks, min_size=len(words), max_size=len(words))))


def test_every_number_of_decimals_and_digits_is_exact():
    rng = np.random.default_rng(1)
    for places in range(12):
        for size in range(-4, 10):
            words = [f"{x:.{places}f}" for x in rng.normal(0, 10.0**size, 300)]
            check(words, [" "] * 300)
            check([*words, "7", "-0", ".5"], [" "] * 303)


def test_the_largest_plain_numbers_are_exact():
    words = ["99999999.9999999", "-99999999.9999999", "-9999999", "9999999.", "99999999"]
    words += ["123456789.5", ".12345678", "0.00000001"]
    check(words, [" "] * len(words))
    for word in words:
        check([word], ["\n"])


def test_text_without_numbers_has_none():
    numbers, before = block(b" \n\n \t\n")
    assert len(numbers) == 0
    assert before.tolist() == [0, 0, 0]


@pytest.mark.parametrize(
    "word",
    [
        "1-2",
        "1.2.3",
        "--1",
        "-",
        ".",
        "-.",
        "+-1",
        "1e",
        "1e+",
        "nan",
        "inf",
        "1_0",
        "0x1",
        "1e400",
        "1/2",
        "1,5",
        "1\x00",
        "\x7f",
    ],
)
@pytest.mark.parametrize("others", ["1.25", "1", "1e5"])
def test_the_first_word_that_is_no_number_is_told(word, others):
    text = f"{others} {others}\n{word} {others} nan\n".encode()
    with pytest.raises(NotANumber) as caught:
        block(text)
    assert caught.value.word == word.encode()
    assert caught.value.at - PAD == 2 * len(others) + 2
