"""Frame times in decimal digits: the rate that is meant, and digits that are read back as the same number."""

from __future__ import annotations

import numpy as np

_RATES = (
    24,
    25,
    30,
    48,
    50,
    60,
    72,
    75,
    90,
    96,
    100,
    120,
    144,
    150,
    180,
    200,
    240,
    250,
    300,
    360,
    400,
    480,
    500,
    600,
    1000,
)
USUAL = [(1, rate) for rate in _RATES] + [(1001, rate * 1000) for rate in (24, 30, 60, 120)]  # seconds as (k, fps)
_NEAR = 0.01  # frames a second


def snapped(digits: str) -> float:
    """Seconds for a frame time as a file has it: "0.0083333" is 1/120, since that is what these digits are of.

    A usual rate (also the NTSC ones, k = 1001) that lies within the digits given, at most half a percent off, is taken;
    any other whole rate only where the digits all but say it. Else they mean themselves.
    """
    given = float(digits)
    top, bottom = _fraction(digits)
    if not 1e-6 < given < 1e3:
        return given
    rate = round(1 / given)
    if rate and 1 / rate == given:
        return given
    fits = [pair for pair in USUAL if _within(pair, top, bottom)]
    if not fits:
        fits = [(1, rate)] if rate and abs(1 / given - rate) < _NEAR and _within((1, rate), top, bottom) else []
    return fits[0][0] / fits[0][1] if fits else given


def written(frame_time: float) -> str:
    """At least 8 decimals, and as many as it takes for `snapped` to give back the same float."""
    digits = np.format_float_positional(frame_time, unique=True, min_digits=8)
    while snapped(digits) != frame_time:
        digits += "0"
    return digits


def _fraction(digits: str) -> tuple[int, int]:
    """The digits as a fraction; its lower part is the power of ten that a unit of the last digit is one of."""
    mantissa, _, exponent = digits.lower().partition("e")
    whole, _, part = mantissa.partition(".")
    places = len(part) - int(exponent or 0)
    top = int(whole + part)
    return (top, 10**places) if places >= 0 else (top * 10**-places, 1)


def _within(pair: tuple[int, int], top: int, bottom: int) -> bool:
    """Whether k/fps, rounded or cut to the digits of top/bottom, is top/bottom; and is within half a percent of it."""
    k, fps = pair
    off = k * bottom - top * fps  # in units of the last digit, times fps
    return -fps <= 2 * off <= 2 * fps and 200 * abs(off) <= top * fps
