"""Numbers as an engineer writes them."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from truing.errors import UnitError
from truing.numbers import format_difference, format_number, format_value, pretty, with_unit


@pytest.mark.parametrize(
    ("value", "digits", "text"),
    [
        (0.73812, 4, "0.7381"),
        (12.5, 4, "12.5"),
        (3137.4, 4, "3137"),
        (31372.4, 4, "31372"),
        (1.2e-5, 4, "1.2e-05"),
        (1.23456e-5, 3, "1.23e-05"),
        (2.1e11, 4, "2.1e+11"),
        (0.00012346, 4, "0.0001235"),
        (0.99996, 4, "1"),
        (9999.96, 5, "10000"),
        (0.000099999, 3, "0.0001"),
        (100, 2, "100"),
        (123456789, 4, "123456789"),
        (np.int64(12345), 2, "12345"),
        (0.0, 4, "0"),
        (-0.0, 4, "0"),
        (-2.5, 4, "-2.5"),
        (-1e-9, 4, "-1e-09"),
        (math.nan, 4, "–"),
        (math.inf, 4, "–"),
        (None, 4, "–"),
    ],
)
def test_a_number_is_written_with_the_digits_that_matter(value: object, digits: int, text: str) -> None:
    assert format_number(value, digits) == text


@given(st.floats(allow_nan=False, allow_infinity=False, min_value=-1e300, max_value=1e300), st.integers(1, 12))
def test_what_is_written_is_the_number_to_its_digits_and_sign(value: float, digits: int) -> None:
    read = float(format_number(value, digits))
    assert read == pytest.approx(value, rel=0.51 * 10.0 ** (1 - digits), abs=0)
    assert math.copysign(1, read) == math.copysign(1, value) or value == 0


@pytest.mark.parametrize(
    ("si", "unit", "written"),
    [
        (0.0000125, "um", ("12.5", "µm")),
        (308.15, "degC", ("35", "°C")),
        (math.pi, "deg", ("180", "°")),
        (3136.0, "N*m", ("3136", "N·m")),
        (3, "", ("3", "")),
        (math.nan, "mm", ("–", "mm")),
        (None, "mm", ("–", "mm")),
    ],
)
def test_a_value_is_written_in_its_unit(si: float | None, unit: str, written: tuple[str, str]) -> None:
    assert format_value(si, unit) == written


def test_a_value_in_no_known_unit_is_refused() -> None:
    with pytest.raises(UnitError, match="mms"):
        format_value(1.0, "mms")


@pytest.mark.parametrize(
    ("si", "unit", "written"),
    [(2.0, "degC", ("2", "K")), (0.001, "mm", ("1", "mm")), (5.0, "degF", ("5", "K"))],
)
def test_a_difference_of_temperature_levels_is_written_in_kelvin(
    si: float, unit: str, written: tuple[str, str]
) -> None:
    assert format_difference(si, unit) == written


@pytest.mark.parametrize(
    ("text", "printed"),
    [
        ("1.2e-05", "1.2 × 10⁻⁵"),
        ("-3e+08", "−3 × 10⁸"),
        ("-12.5", "−12.5"),
        ("0.7381", "0.7381"),
        ("–", "–"),
        ("-abc", "-abc"),
        ("1e5 bolts", "1e5 bolts"),
        ("e-05", "e-05"),
    ],
)
def test_only_numbers_are_made_pretty(text: str, printed: str) -> None:
    assert pretty(text) == printed


def test_degrees_follow_closely_and_other_units_do_not() -> None:
    assert with_unit("12", "°") == "12°"
    assert with_unit("12", "°C") == "12 °C"
    assert with_unit("12", "") == "12"
