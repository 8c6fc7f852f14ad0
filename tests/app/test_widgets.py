"""How numbers are written in the page."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.widgets import equation, figure, number


@pytest.mark.parametrize(
    ("value", "digits", "text"),
    [
        (0.0, 3, "0"),
        (1e-4, 3, "≈ 0"),
        (-1e-4, 3, "≈ 0"),
        (0.0123456, 3, "0.0123"),
        (-2.5, 3, "−2.5"),
        (99.6, 2, "100"),
        (8.74, 2, "8.7"),
        (456.4, 3, "456"),
        (1234.5, 3, "1234"),
        (-123456.7, 3, "−123457"),
        (1.5e7, 3, "1.5e+07"),
    ],
)
def test_numbers_are_written_for_reading(value: float, digits: int, text: str) -> None:
    assert number(value, digits) == text


@given(st.floats(-9e5, 9e5))
def test_what_is_written_is_the_number_to_its_digits_without_a_power_of_ten(value: float) -> None:
    text = number(value)
    if text == "≈ 0":
        assert abs(value) < 5e-4
        return
    assert "e" not in text
    assert float(text.replace("−", "-")) == pytest.approx(value, rel=5.1e-3)


def test_figures_that_are_no_numbers_are_words() -> None:
    assert (figure(math.nan), figure(math.inf)) == ("–", "never")
    assert figure(0.00123) == "0.0012"
    assert equation("T", 0.0002) == "T ≈ 0"
    assert equation("T", -3.0) == "T = −3"
