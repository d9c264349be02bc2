"""Numbers as an engineer writes them: as many digits as carry meaning, a power of ten only where it helps."""

from __future__ import annotations

import math
import re
from typing import Any

import numpy as np

from truing.units import difference_unit, from_si, unit_text
from truing.units.names import PURE

ABSENT = "–"
"""What stands where there is no number: an input that was not given, a search that did not arrive."""

CLOSE = frozenset({"°", "′", "″", "'"})
RESULT_DIGITS = 5
MOST_DECIMALS = 12
"""A probability in per cent has no more: what a double holds."""
STATED_DIGITS = 10
ROUNDING = 1e-11
"""Numbers that are less than this share of others beside them are what is left of a difference of doubles."""
_NUMBER = re.compile(r"(?P<minus>-?)(?P<digits>\d[\d.]*)(?:e(?P<sign>[+-]?)0*(?P<exponent>\d+))?", re.ASCII)
_RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def format_number(value: Any, digits: int = 4) -> str:
    """Write a number with so many significant digits: 0.7381, 12.5, 3137, 1.2e-05; none that is not finite (–).

    Digits before the decimal point are never dropped below ten million (31372.4 becomes 31372), zeros behind it are.
    Whole numbers (``int``) are written out. The minus is the ASCII one, so that the text can be read back.
    """
    if value is None:
        return ABSENT
    if _is_whole_type(value):
        return str(int(value))
    number = float(value)
    if not math.isfinite(number):
        return ABSENT
    if number == 0:
        return "0"
    rounded = float(f"{number:.{max(digits, 1) - 1}e}")
    if not 1e-4 <= abs(rounded) < 1e7:
        return _with_exponent(number, digits)
    before = math.floor(math.log10(abs(rounded))) + 1
    text = f"{number:.{max(digits - before, 0)}f}"
    return text.rstrip("0").rstrip(".") if "." in text else text


def counted(number: int, one: str = "row", many: str = "") -> str:
    """Return "1 row", "3 rows"."""
    return f"{number} {one if number == 1 else many or one + 's'}"


def format_chance(value: float, digits: int = 4) -> str:
    """Write a probability in per cent, with so many digits of its distance from 0 or 100 %: 99.705, 56.6, 99.99968."""
    share = 100.0 * value
    rest = min(abs(share), abs(100.0 - share))
    if not math.isfinite(share) or rest == 0:
        return format_number(share)
    decimals = min(max(digits - 1 - math.floor(math.log10(rest)), 0), MOST_DECIMALS)
    text = f"{share:.{decimals}f}"
    return text.rstrip("0").rstrip(".") if "." in text else text


def _is_whole_type(value: Any) -> bool:
    return isinstance(value, int) or getattr(getattr(value, "dtype", None), "kind", "") in {"i", "u"}


def _with_exponent(number: float, digits: int) -> str:
    mantissa, _, exponent = f"{number:.{max(digits, 1) - 1}e}".partition("e")
    short = mantissa.rstrip("0").rstrip(".") if "." in mantissa else mantissa
    return f"{short}e{exponent}"


def format_value(si: Any, unit: str, digits: int = RESULT_DIGITS) -> tuple[str, str]:
    """Write an SI number in a unit: the number and the unit as printed ("12.5", "µm"); raises UnitError."""
    if si is None:
        return ABSENT, unit_text(unit)
    return format_number(_plain(si) if _is_bare(unit, si) else from_si(_plain(si), unit), digits), unit_text(unit)


def digits_in(text: str) -> int:
    """Count the significant digits of a number as it is written: 3 of 0.0123, 2 of 12, 1 of 1200."""
    digits = text.lower().partition("e")[0].lstrip("+-").replace(".", "").lstrip("0")
    return max(len(digits if "." in text else digits.rstrip("0")), 1)


def format_stated(si: Any, unit: str, stated: str) -> tuple[str, str]:
    """Write a stated number (SI) in a unit; in another than it is ``stated`` in with a digit more than it has there."""
    if unit == stated or unit_text(unit) == unit_text(stated):
        return format_value(si, unit, STATED_DIGITS)
    written = format_value(si, stated, STATED_DIGITS)[0]
    return format_value(si, unit, min(max(digits_in(written) + 1, RESULT_DIGITS), STATED_DIGITS))


def format_ends(values: Any, unit: str) -> tuple[str, str, str]:
    """Write the least and the largest of numbers in SI, and the unit; empty texts where none is finite.

    Beside an end of the other sign one that is smaller by ``ROUNDING`` is the rounding of a difference, and 0.
    """
    numbers = np.asarray(values, dtype=float)
    finite = numbers[np.isfinite(numbers)]
    if not finite.size:
        return "", "", unit_text(unit)
    low, high = finite.min(), finite.max()
    if low < 0.0 < high:
        low, high = (0.0 if abs(end) < ROUNDING * max(-low, high) else end for end in (low, high))
    return format_value(low, unit)[0], *format_value(high, unit)


def format_difference(si: float, unit: str, digits: int = RESULT_DIGITS) -> tuple[str, str]:
    """Write an SI difference (a standard deviation, a width): levels of temperature differ by kelvins."""
    return format_value(si, difference_unit(unit), digits)


def with_unit(number: str, unit: str) -> str:
    """Join a number and its unit; degrees, minutes and seconds of arc follow closely."""
    if not unit:
        return number
    return f"{number}{'' if unit in CLOSE else ' '}{unit}"


def _plain(value: Any) -> Any:
    return value.item() if hasattr(value, "item") else value


def _is_bare(unit: str, value: Any) -> bool:
    """Tell whether a whole number stays one: counts have no unit."""
    return unit in PURE and _is_whole_type(value)


def pretty(text: str) -> str:
    """Make a number's text fit for print: a true minus, powers of ten written out (1.2 × 10⁻⁵); other texts stay."""
    match = _NUMBER.fullmatch(text)
    if match is None:
        return text
    digits = ("−" if match["minus"] else "") + match["digits"]
    if match["exponent"] is None:
        return digits
    exponent = ("-" if match["sign"] == "-" else "") + match["exponent"]
    return f"{digits} × 10{exponent.translate(_RAISED)}"
