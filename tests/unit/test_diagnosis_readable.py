"""Units in which numbers of a diagnosis read well: another size of the same kind of unit, never another kind."""

from __future__ import annotations

from math import pi

import pytest

from truing.diagnosis.result import readable_unit

MINUTE = pi / 10_800


@pytest.mark.parametrize(
    ("unit", "size", "expected"),
    [
        ("mm", 0.5e-3, "mm"),
        ("mm", 2.3e-6, "um"),
        ("m", 2.3e-6, "um"),
        ("urad", 5e-3, "mrad"),
        ("arcmin", 0.5 * MINUTE, "arcmin"),
        ("arcmin", 0.01 * MINUTE, "arcsec"),
        ("deg", 3 * MINUTE, "arcmin"),
        ("mm", 0.0, "mm"),
        ("degC", 1e-3, "K"),
        ("inch", 1e-6, "um"),
    ],
)
def test_a_unit_keeps_its_kind(unit: str, size: float, expected: str) -> None:
    """Arc minutes become arc seconds and not radians; a unit of no family becomes one that engineers read."""
    assert readable_unit(unit, size) == expected
