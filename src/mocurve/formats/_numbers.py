"""Decimal numbers in text, many at a time: bit for bit what float() makes of them, several times as fast.

Numbers such as -12.345678 are read by arithmetic on whole columns of text: their digits are loaded as 8-byte words,
which three multiplications turn into integers (D. Lemire, "Number parsing at a gigabyte per second", 2021). With m =
all digits as an integer < 2^53 and k <= 22 digits behind the point, m and 10^k are exact floats, so that the one
rounding of m / 10^k is the right one (W. D. Clinger, "How to read floating point numbers accurately", 1990). Text that
has anything else in it (exponents, more digits) goes through NumPy's reader of text.
"""

from __future__ import annotations

import re
from typing import NamedTuple

import numpy as np

PAD = 16  # blanks that a text begins with, so that words that end at its first number lie inside
_WORD = 8  # digits in a word
_NUMBER = rb"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?"
_CLEAN = b"0123456789.eE+- \t\r\n\f\v"
_ONE_LINE = bytes.maketrans(b"\t\r\n\f\v", b"     ")
_TENS = 10.0 ** np.arange(_WORD + 1)
_SCALE = (_TENS[:, None] * [1.0, -1.0]).reshape(-1)  # by twice the decimals, plus one for a minus
# the last n characters of a word as digits 0 to 9, the others 0; words are little-endian: the last character is on top
_LAST = np.array([(0x0F0F0F0F0F0F0F0F << 8 * (_WORD - n)) % 2**64 for n in range(_WORD + 1)], np.uint64)
_TOP = np.array([(0xFFFFFFFFFFFFFFFF << 8 * (_WORD - n)) % 2**64 for n in range(_WORD + 1)], np.uint64)
_LAST_OF_LOW = _LAST[np.minimum(np.arange(2 * _WORD), _WORD)]
_LAST_OF_HIGH = _LAST[np.maximum(np.arange(2 * _WORD) - _WORD, 0)]
_STEPS = [(2561, 8, 0x00FF00FF00FF00FF), (6553601, 16, 0x0000FFFF0000FFFF), (42949672960001, 32, 0xFFFFFFFF)]
_MULTIPLY = [tuple(np.uint64(n) for n in step) for step in _STEPS]
_DOT, _MINUS, _ZERO, _SPACE = b".-0 "


class Block(NamedTuple):
    values: np.ndarray  # (N,) float64
    before: np.ndarray  # per line end in the text: how many of the numbers stand before it


class NotANumber(ValueError):
    """A word of the text is no finite number; `word` is that, `at` its place in the text."""

    def __init__(self, word: bytes, at: int):
        self.word, self.at = word, at
        super().__init__(word)


def parse(text: np.ndarray, newline: int) -> Block:
    """The numbers of a text: uint8 characters, PAD blanks first, one last. NotANumber tells the first that is none."""
    blanks = np.flatnonzero(text <= _SPACE)[PAD - 1 :]
    kinds = text[blanks]
    ends, lengths, closing = blanks[1:], blanks[1:] - blanks[:-1] - 1, kinds[1:]
    real = lengths > 0
    before = np.flatnonzero(closing == newline)
    empty = np.flatnonzero(~real)  # blanks that follow blanks
    before += 1 - np.searchsorted(empty, before, side="right")
    if len(empty):
        ends, lengths = ends[real], lengths[real]
    if len(ends) == 0:
        return Block(np.empty(0), before)
    controls = ((kinds - np.uint8(9)) > 4) & (kinds != _SPACE)
    values = None if controls.any() else _plain(text, ends, lengths)
    return Block(_any(text) if values is None else values, before)


def _plain(text: np.ndarray, ends: np.ndarray, lengths: np.ndarray) -> np.ndarray | None:
    """The numbers that end before `ends`; None unless each is [-]digits[.digits] and fits into two words.

    That is 8 digits before the point and 7 behind it, or 7 without a point: at most 15, which a float holds exactly.
    """
    pairs = np.ndarray(len(text) - 2 * _WORD + 1, "<c16", text, 0, (1,))  # the 16 characters from each place on
    words = pairs[ends - 2 * _WORD].view("<u8")
    minus = text[ends - lengths] == _MINUS
    digits = lengths - minus
    behind, moving = _points(text, ends, digits, words[1::2])
    whole = digits - behind
    most = whole.max()
    if whole.min() < 0 or digits.min() < 1 or most > _WORD or (most == _WORD and (moving == _WORD).any()):
        return None
    if np.count_nonzero((text - np.uint8(_ZERO)) < 10) != digits.sum():
        return None
    numbers = _digits(words[0::2], words[1::2], digits, _LAST[moving])
    numbers /= _SCALE[2 * behind + minus]
    return numbers


def _points(text: np.ndarray, ends: np.ndarray, digits: np.ndarray, low: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """How many digits stand behind the point, one count for all where they agree; the same with 8 where there is none.

    The points are taken out of `digits`; one that is not among the last 8 characters, `low`, stays in as a false digit.
    """
    points = np.count_nonzero(text == _DOT)
    first = text[ends[0] - digits[0] : ends[0]].tobytes()[::-1].find(b".")
    if points == len(ends) and 0 <= first < _WORD and (text[ends - (first + 1)] == _DOT).all():
        digits -= 1
        return np.array(first), np.array(first)
    unlike = low ^ np.uint64(0x2E2E2E2E2E2E2E2E)
    dots = unlike - np.uint64(0x0101010101010101)  # the top bit of a character is set below where it is a point
    dots &= ~unlike
    dots &= np.uint64(0x8080808080808080) & _TOP[np.minimum(digits, _WORD)]
    dots >>= np.uint64(7)
    exponent = dots.view(np.int64).astype(np.float64).view(np.int64) >> 52  # of the highest bit, that of the last point
    moving = np.minimum((1023 + 56 - exponent) >> 3, _WORD)
    digits -= moving < _WORD
    return moving & (_WORD - 1), moving


def _digits(high: np.ndarray, low: np.ndarray, digits: np.ndarray, behind: np.ndarray) -> np.ndarray:
    """All digits of each number as an integer in a float; `behind` masks those of `low` that stand behind the point."""
    last = low << np.uint64(8)  # the digits before the point move up to those behind it
    last &= ~behind
    last |= low & behind
    if digits.max() < _WORD:
        last &= _LAST_OF_LOW[digits]
        return _integers(last)
    last |= high >> np.uint64(56)
    last &= _LAST_OF_LOW[digits]
    first = high << np.uint64(8)
    first &= _LAST_OF_HIGH[digits]
    numbers = _integers(first)
    numbers *= _TENS[_WORD]
    numbers += _integers(last)
    return numbers


def _integers(words: np.ndarray) -> np.ndarray:
    """The integers that words of 8 digits (0 to 9, not characters) stand for, as floats; the words are overwritten."""
    for factor, shift, keep in _MULTIPLY:
        words *= factor
        words >>= shift
        words &= keep
    return words.view(np.int64).astype(np.float64)


def _any(text: np.ndarray) -> np.ndarray:
    """The numbers of a text, exponents and any number of digits included."""
    raw = text.tobytes()
    if not raw.translate(None, _CLEAN):  # nan, inf and 1_000 are numbers to Python, not to us
        try:
            line = raw.translate(_ONE_LINE).decode("ascii")
            values = np.loadtxt([line], np.float64, comments=None, ndmin=1)
            if np.isfinite(values).all():
                return values
        except ValueError:
            pass  # the word that is no number is looked for below
    for match in re.finditer(rb"[^ \t\r\n\f\v]+", raw):
        if not re.fullmatch(_NUMBER, match[0]) or abs(float(match[0])) == float("inf"):
            raise NotANumber(match[0], match.start())
    return np.array(list(map(float, raw.split())))
