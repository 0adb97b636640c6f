"""Frame times become the rate that their digits are of, and no other."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mocurve.formats._frame_time import snapped, written

RATES = [24, 25, 30, 48, 50, 60, 72, 90, 100, 120, 144, 200, 240, 250, 300, 480, 500, 1000]


@pytest.mark.parametrize("rate", RATES)
@pytest.mark.parametrize("places", [6, 7, 8, 12])
def test_usual_rates_are_found_in_rounded_and_in_cut_digits(rate, places):
    assert snapped(f"{1 / rate:.{places}f}") == 1 / rate
    assert snapped(f"{1 / rate:.{places + 3}f}"[:-3]) == 1 / rate


@pytest.mark.parametrize(
    ("digits", "seconds"),
    [
        ("0.0333", 1 / 30),
        ("0.0083", 1 / 120),
        ("0.0167", 1 / 60),
        (".0083333", 1 / 120),
        ("8.3333e-3", 1 / 120),
        ("0.0333667", 1001 / 30000),
        ("0.041708", 1001 / 24000),
        ("0.016683", 1001 / 60000),
        ("0.027027", 1 / 37),
        ("1.0", 1.0),
        ("0.04", 0.04),
        ("2", 2.0),
    ],
)
def test_digits_of_a_rate_become_it(digits, seconds):
    assert snapped(digits) == seconds


@pytest.mark.parametrize(
    "digits",
    [
        "0.03",
        "0.033",
        "0.0333330",
        "0.03333300",
        "0.0333666999999999999",
        "0.0042",
        "0.008340",
        "0.0123",
        "0.7",
        "3.3",
        "1e-9",
    ],
)
def test_digits_of_no_rate_mean_themselves(digits):
    assert snapped(digits) == float(digits)


@given(
    st.one_of(
        st.floats(1e-12, 1e6), st.floats(1e-4, 1).map(lambda x: round(x, 6)), st.integers(1, 2000).map(lambda n: 1 / n)
    )
)
def test_written_digits_are_read_as_the_same_float(seconds):
    digits = written(seconds)
    assert snapped(digits) == seconds
    assert len(digits.partition(".")[2]) >= 8
