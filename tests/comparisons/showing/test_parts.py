"""Numbers written for reading."""

import math

import pytest

from comparisons.showing.parts import number, percent


@pytest.mark.parametrize(
    "given, shown",
    [
        (None, "–"),
        (math.nan, "–"),
        (0.0, "0"),
        (0.21234, "0.212"),
        (-1.5, "−1.50"),
        (12345.6, "12346"),
        (0.001, "0.00100"),
        (0.000999, "9.99·10⁻⁴"),
        (-1.25e-17, "−1.25·10⁻¹⁷"),
        (123456.0, "1.23·10⁵"),
    ],
)
def test_numbers_are_written_for_reading(given, shown):
    assert number(given) == shown


def test_fractions_in_per_cent():
    assert percent(0.0213) == "2.1 %"
    assert percent(None) == "–"
