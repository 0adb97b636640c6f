"""Decimal numbers in text, read by one compiled walk over its characters: what `_numbers.parse` gives, much faster."""

from __future__ import annotations

import numpy as np

from .._jit import kernel
from ._numbers import BLANKS, Block, first_wrong

_TAB, _RETURN, _SPACE = b"\t\r "
_PLUS, _MINUS, _DOT, _ZERO, _E = b"+-.0e"
_TENS = np.array([float(10**k) for k in range(23)])  # all powers of ten that are floats
_MOST = len(_TENS) - 1
_WHOLE = 1 << 53  # integers up to here are floats
_ONE = np.uint64(1)  # places are unsigned: to allow for negative indices takes half as long again
_ROOM = 10**17  # integers below may have one more digit
_TOO_LONG = 1 << 62
_SPLITTER = 2.0**27 + 1


def parse(text: bytes, newline: bytes) -> Block:
    """The numbers of a text that blanks keep apart, NotANumber for the first word that is none."""
    if not text.endswith(BLANKS):
        text += b" "
    values = np.empty(len(text) // 2)
    counts = np.empty(len(text) + 1, np.int64)
    hard = np.empty((len(text) // 5, 3), np.int64)  # 1e23 and a blank are 5 characters
    numbers, lines, left = walk(np.frombuffer(text, np.uint8), newline[0], values, counts, hard)
    if numbers < 0:
        raise first_wrong(text)
    for number, start, end in hard[:left].tolist():
        values[number] = float(text[start:end])
    if left and not np.isfinite(values[:numbers]).all():
        raise first_wrong(text)
    return Block(values[:numbers], counts[:lines])


@kernel
def walk(
    text: np.ndarray, newline: int, values: np.ndarray, counts: np.ndarray, hard: np.ndarray
) -> tuple[int, int, int]:
    """Fill values and counts; say how many of both there are, -1 if a word is no number, and how many are left to do.

    text (B,) uint8 ends with a blank. hard (H, 3): number, start and end of each word that is left to float().
    """
    at, size = np.uint64(0), np.uint64(len(text))
    numbers = before = line = left = 0
    while True:
        while at < size and _blank(text[at]):
            if text[at] == newline:
                counts[line] = numbers - before
                before, line = numbers, line + 1
            at += _ONE
        if at == size:
            counts[line] = numbers - before
            return numbers, line + 1, left
        start = at
        at += _sign(text[at])
        mantissa, end = _digits(text, at, 0)
        digits, scale, at = np.int64(end - at), np.int64(0), end
        if text[at] == _DOT:
            mantissa, end = _digits(text, at + _ONE, mantissa)
            scale = np.int64(at + _ONE - end)
            digits, at = digits - scale, end
        if text[at] | 32 == _E and digits:
            minus = text[at + _ONE] == _MINUS
            at += _ONE + _sign(text[at + _ONE])
            exponent, end = _digits(text, at, 0)
            scale += -exponent if minus else exponent
            digits, at = np.int64(end - at), end
        if not digits or not _blank(text[at]):
            return -1, 0, 0
        value = 0.0
        if mantissa <= _WHOLE and -_MOST <= scale <= _MOST:  # rounded once, so right (Clinger 1990)
            value = mantissa / _TENS[-scale] if scale < 0 else mantissa * _TENS[scale]
        elif mantissa < _TOO_LONG and -_MOST <= scale <= 0:
            value = _quotient(mantissa, _TENS[-scale])
        else:
            hard[left, 0], hard[left, 1], hard[left, 2] = numbers, start, at
            left += 1
        values[numbers] = -value if text[start] == _MINUS else value
        numbers += 1


@kernel
def _blank(char: int) -> bool:
    return char == _SPACE or _TAB <= char <= _RETURN


@kernel
def _sign(char: int) -> np.uint64:
    """How many characters a sign takes here: 1 or 0."""
    return np.uint64(char in (_MINUS, _PLUS))


@kernel
def _digits(text: np.ndarray, at: np.uint64, number: int) -> tuple[int, np.uint64]:
    """The number with all digits from `at` on behind its own, _TOO_LONG if more than 18; and the place behind them."""
    while True:
        digit = text[at] - _ZERO
        if digit < 0 or digit > 9:
            return number, at
        number = number * 10 + digit if number < _ROOM else _TOO_LONG
        at += _ONE


@kernel
def _quotient(number: int, ten: float) -> float:
    """number / ten, rounded once: 0 <= number < 10^18, ten = 10^k, k <= 22.

    The remainder of the first guess is exact, since the product guess * ten is had in two floats (T. J. Dekker, "A
    floating-point technique for extending the available precision", 1971). remainder / ten then lacks at most 2^-53 of
    the guess's last place, and no quotient but a tie, for which it is exact, is that near to the middle of two floats:
    it is a multiple of 1 / (2 * 5^k) last places away.
    """
    rounded = float(number)
    guess = rounded / ten
    a = _SPLITTER * guess
    a = a - (a - guess)
    b = _SPLITTER * ten
    b = b - (b - ten)
    c, d = guess - a, ten - b
    product = guess * ten
    error = ((a * b - product) + a * d + c * b) + c * d
    remainder = (rounded - product) + (float(number - int(rounded)) - error)
    return guess + remainder / ten
