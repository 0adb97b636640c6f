"""Decimal numbers in text, many at a time: bit for bit what float() makes of them, several times as fast.

Numbers such as -12.345678 are read by arithmetic on whole columns of text. The digits before and behind the point are
loaded as 8-byte words and turned into integers by three multiplications (D. Lemire, "Number parsing at a gigabyte per
second", 2021). With m = all digits as an integer < 2^53 and k <= 22 digits behind the point, m and 10^k are exact floats,
so that the one rounding of m / 10^k is the right one (W. D. Clinger, "How to read floating point numbers accurately",
1990).
Text that has anything else in it (exponents, more digits) goes through float() number by number.
"""

from __future__ import annotations

import re
from typing import NamedTuple

import numpy as np

PAD = 16  # blanks that a text begins with, so that words that end at its first number lie inside
_WIDE = 8  # digits in a word
_NUMBER = re.compile(rb"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?\Z")
_CLEAN = re.compile(rb"[0-9.eE+\- \t\r\n\f\v]*\Z")
_TENS = 10.0 ** np.arange(_WIDE + 1)
_KEEP = np.array([0] + [(0x0F0F0F0F0F0F0F0F << (8 * (_WIDE - n))) % 2**64 for n in range(1, _WIDE + 1)], np.uint64)
_SIGN = np.array([1.0, -1.0])
_STEPS = [(2561, 8, 0x00FF00FF00FF00FF), (6553601, 16, 0x0000FFFF0000FFFF), (42949672960001, 32, 0xFFFFFFFF)]
_MULTIPLY = [tuple(np.uint64(n) for n in step) for step in _STEPS]


class Block(NamedTuple):
    values: np.ndarray  # (N,) float64
    before: np.ndarray  # per line end in the text: how many of the numbers stand before it


class NotANumber(ValueError):
    """A word of the text is no finite number; `word` is that, `at` its place in the text."""

    def __init__(self, word: bytes, at: int):
        self.word, self.at = word, at
        super().__init__(word)


def parse(text: np.ndarray, newline: int) -> Block:
    """The numbers of a text: uint8 characters, PAD blanks first, a blank last. NotANumber tells the first that is none."""
    gaps = text <= 32
    marks = np.flatnonzero(gaps | (text == ord(".")))
    is_point = text[marks] == ord(".")
    blank = np.flatnonzero(~is_point)
    ends, starts, points = marks[blank[1:]], marks[blank[:-1]] + 1, np.diff(blank) - 1
    real = ends > starts
    before = np.cumsum(real)[text[ends] == newline]
    if not real.all():
        ends, starts, points, blank = ends[real], starts[real], points[real], blank[1:][real]
    else:
        blank = blank[1:]
    values = _plain(text, ends, starts, points, marks[blank - 1]) if len(ends) else np.empty(0)
    return Block(_any(text) if values is None else values, before)


def _plain(
    text: np.ndarray, ends: np.ndarray, starts: np.ndarray, points: np.ndarray, point: np.ndarray
) -> np.ndarray | None:
    """The numbers between starts and ends, None unless each is [-]digits[.digits], at most 8 digits on each side."""
    if points.max() > 1:
        return None
    minus = text[starts] == ord("-")
    point = np.where(points, point, ends)
    whole = point - starts - minus
    part = ends - point - points
    if whole.max() > _WIDE or part.max() > _WIDE or not (whole + part).all():
        return None
    digits = np.count_nonzero((text - np.uint8(ord("0"))) < 10)
    controls = np.count_nonzero((text < 9) | ((text > 13) & (text < 32)))
    if digits != whole.sum() + part.sum() or controls:
        return None
    scale = _TENS[part]
    values = _integers(text, point, whole)
    values *= scale
    values += _integers(text, ends, part)
    values /= scale
    values *= _SIGN[minus.view(np.int8)]
    return values


def _integers(text: np.ndarray, ends: np.ndarray, digits: np.ndarray) -> np.ndarray:
    """The integers of at most 8 digits each that end before `ends`, as floats."""
    words = np.ndarray(len(text) - 7, "<u8", text, 0, (1,))  # the 8 characters from each place on
    value = words[ends - _WIDE] & _KEEP[digits]
    for factor, shift, keep in _MULTIPLY:
        value *= factor
        value >>= shift
        value &= keep
    return value.view(np.int64).astype(np.float64)


def _any(text: np.ndarray) -> np.ndarray:
    """The numbers of a text through float(), which would take inf, nan and 1_000 too."""
    raw = text.tobytes()
    if _CLEAN.match(raw):
        try:
            values = np.array(list(map(float, raw.split())), np.float64)
        except ValueError:
            values = np.array([np.inf])
        if np.isfinite(values).all():
            return values
    for match in re.finditer(rb"[^ \t\r\n\f\v]+", raw):
        if not _NUMBER.match(match[0]) or abs(float(match[0])) == float("inf"):
            raise NotANumber(match[0], match.start())
    raise AssertionError("a text was refused although each of its words is a number")
