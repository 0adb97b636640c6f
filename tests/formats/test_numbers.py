"""Numbers read many at a time are those that float() reads, bit for bit, and belong to their lines."""

from __future__ import annotations

import sys

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mocurve.formats import _bvh_rows, _numbers, _numbers_kernel
from mocurve.formats._numbers import NotANumber

plain = st.from_regex(r"-?([0-9]{1,9}\.?[0-9]{0,9}|\.[0-9]{1,9})", fullmatch=True)
any_float = st.floats(allow_nan=False, allow_infinity=False)
odd = st.from_regex(r"[+-]?[0-9]{0,20}\.[0-9]{1,25}([eE][+-]?[0-9]{1,2})?", fullmatch=True)
decimals = st.tuples(st.integers(0, 9), st.lists(st.floats(-1e7, 1e7), min_size=1)).map(
    lambda p: [f"{x:.{p[0]}f}" for x in p[1]]
)
blanks = st.sampled_from([" ", "  ", "\n", "\t", " \r\n", "\n\n", "\f"])


@pytest.fixture(params=[_numbers, _numbers_kernel], ids=["plain", "compiled"], scope="module")
def parse(request):
    """Both ways to read numbers: what holds for one has to hold for the other."""
    return lambda text: request.param.parse(text, b"\n")


def check(parse, words: list[str], gaps: list[str]) -> None:
    text = "".join(word + gap for word, gap in zip(words, gaps, strict=True))
    numbers, counts = parse(text.encode())
    assert numbers.tobytes() == np.array([float(word) for word in words]).tobytes()
    assert counts.tolist() == [len(line.split()) for line in text.split("\n")]


@settings(max_examples=60, deadline=None)
@given(
    st.data(),
    st.one_of(decimals, st.lists(plain, min_size=1), st.lists(st.one_of(plain, odd, any_float.map(repr)), min_size=1)),
)
def test_words_are_read_as_float_reads_them(parse, data, words):
    check(parse, words, data.draw(st.lists(blanks, min_size=len(words), max_size=len(words))))


@settings(max_examples=400, deadline=None)
@given(st.lists(st.from_regex(r"[+-]?[0-9]{1,40}(\.[0-9]{0,40})?([eE][+-]?[0-9]{1,2})?", fullmatch=True), min_size=1))
def test_numbers_of_any_length_are_read_as_float_reads_them(parse, words):
    check(parse, words, [" "] * len(words))


@settings(max_examples=400, deadline=None)
@given(st.lists(st.tuples(st.integers(0, 10**19), st.integers(0, 23)), min_size=1))
def test_lossless_numbers_are_read_as_float_reads_them(parse, parts):
    words = [f"{digits:025}"[: 25 - places] + "." + f"{digits:025}"[25 - places :] for digits, places in parts]
    check(parse, words, [" "] * len(words))
    check(parse, [f"-{digits}e-{places}" for digits, places in parts], [" "] * len(words))


@pytest.mark.parametrize("places", range(24))
def test_numbers_at_the_middle_of_two_floats_and_beside_it_are_exact(parse, places):
    rng = np.random.default_rng(places)
    middles = [2 * int(x) + 1 for x in rng.integers(2**52, 2**53, 500)]  # times any power of two
    ties = [middle * 5**places for middle in middles if middle * 5**places < 10**18]  # over 10^places
    near = [middle * 10**places >> max((middle * 10**places).bit_length() - 59, 0) for middle in middles]
    check(parse, words := [f"{m + d}e-{places}" for m in ties + near for d in (-1, 0, 1, 2)], ["\n"] * len(words))


def test_every_number_of_decimals_and_digits_is_exact(parse):
    rng = np.random.default_rng(1)
    for places in range(12):
        for size in range(-4, 10):
            words = [f"{x:.{places}f}" for x in rng.normal(0, 10.0**size, 300)]
            check(parse, words, [" "] * 300)
            check(parse, [*words, "7", "-0", ".5"], [" "] * 303)


def test_the_largest_plain_numbers_are_exact(parse):
    words = ["99999999.9999999", "-99999999.9999999", "-9999999", "9999999.", "99999999"]
    words += ["123456789.5", ".12345678", "0.00000001"]
    check(parse, words, [" "] * len(words))
    for word in words:
        check(parse, [word], ["\n"])


def test_text_without_numbers_has_none(parse):
    numbers, counts = parse(b" \n\n \t\n")
    assert len(numbers) == 0
    assert counts.tolist() == [0, 0, 0, 0]


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
def test_the_first_word_that_is_no_number_is_told(parse, word, others):
    text = f"{others} {others}\n{word} {others} nan\n".encode()
    with pytest.raises(NotANumber) as caught:
        parse(text)
    assert caught.value.word == word.encode()
    assert caught.value.at == 2 * len(others) + 2


@pytest.mark.parametrize(
    ("size", "loaded", "module"),
    [
        (2 << 20, False, _numbers),
        (2 << 20, True, _numbers),
        (16 << 20, False, _numbers),
        (16 << 20, True, _numbers_kernel),
        (100 << 20, False, _numbers_kernel),
    ],
)
def test_compiled_code_is_for_files_that_pay_for_loading_it(monkeypatch, size, loaded, module):
    if not loaded:
        monkeypatch.delitem(sys.modules, "numba")
    assert _bvh_rows.parser(size) is module.parse
