"""Decimal numbers in text, many at a time: bit for bit what float() makes of them, and how many each line has.

Here without a compiler's start-up, for files that are soon read; `_numbers_kernel` has the same `parse` for large ones.
"""

from __future__ import annotations

import re
from typing import NamedTuple

import numpy as np

BLANKS = (b" ", b"\n", b"\r", b"\t", b"\f", b"\v")
_NUMBER = rb"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?"
_ONE_LINE = bytes.maketrans(b"\t\r\n\f\v", b"     ")
_CLEAN = b"0123456789.eE+- \t\r\n\f\v"
_DOT, _MINUS, _ZERO, _SPACE = b".-0 "
_EXACT = 15  # digits that a float holds whatever they are
_TENS = np.array([float(10**k) for k in range(_EXACT + 1)])


class Block(NamedTuple):
    values: np.ndarray  # (N,) float64
    counts: np.ndarray  # (line ends in the text + 1,) how many of the numbers each line has; the last one may go on


class NotANumber(ValueError):
    """A word of the text is no finite number; `word` is that, `at` its place in the text."""

    def __init__(self, word: bytes, at: int):
        self.word, self.at = word, at
        super().__init__(word)


def parse(text: bytes, newline: bytes) -> Block:
    """The numbers of a text that blanks keep apart, NotANumber for the first word that is none."""
    if text.translate(None, _CLEAN):  # nan, inf and 1_000 are numbers to Python, not to us
        raise first_wrong(text)
    chars = np.frombuffer(b" %b " % text, np.uint8)
    blanks = np.flatnonzero(chars <= _SPACE)
    lengths = np.diff(blanks) - 1
    real, ends = lengths > 0, blanks[1:]
    if not real.all():  # blanks that follow blanks
        ends, lengths = ends[real], lengths[real]
    lines = np.searchsorted(ends, blanks[chars[blanks] == ord(newline)], side="right")  # numbers before each line end
    values = _with_points(text, chars, ends, lengths) if len(ends) else np.empty(0)
    return Block(_any(text) if values is None else values, np.diff(lines, prepend=0, append=len(ends)))


def first_wrong(text: bytes) -> NotANumber:
    """What is to be raised for a text with a word in it that is no finite number."""
    for match in re.finditer(rb"[^ \t\r\n\f\v]+", text):
        if not re.fullmatch(_NUMBER, match[0]) or abs(float(match[0])) == float("inf"):
            return NotANumber(match[0], match.start())
    raise AssertionError("every word of the text is a finite number")


def _with_points(text: bytes, chars: np.ndarray, ends: np.ndarray, lengths: np.ndarray) -> np.ndarray | None:
    """The numbers, where each is [-]digits.digits of at most 15 digits, as in most files; None if not.

    Without the points they are integers < 2^53, which NumPy reads three times as fast, and that over 10^decimals <= 22
    is rounded once, so right (W. D. Clinger, "How to read floating point numbers accurately", 1990).
    """
    points = np.flatnonzero(chars == _DOT)
    if len(points) != len(ends) or lengths.max() > _EXACT + 1:
        return None
    decimals, minus = ends - points - 1, chars[ends - lengths] == _MINUS
    if (decimals < 0).any() or (decimals + minus >= lengths).any() or (lengths - minus < 2).any():
        return None  # not one point in each, behind the sign, or no digit
    digits = np.count_nonzero((chars - np.uint8(_ZERO)) < 10)
    if digits + np.count_nonzero(minus) + len(points) != lengths.sum():
        return None
    numbers = np.fromstring(text.translate(None, b"."), np.int64, sep=" ") / _TENS[decimals]
    return np.copysign(numbers, 0.5 - minus)  # for -0.0, which no integer says


def _any(text: bytes) -> np.ndarray:
    try:
        values = np.loadtxt([text.translate(_ONE_LINE).decode("ascii")], np.float64, comments=None, ndmin=1)
    except ValueError:
        raise first_wrong(text) from None
    if not np.isfinite(values).all():
        raise first_wrong(text)
    return values
