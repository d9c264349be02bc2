"""A unit in which a number is neither tiny nor huge: 2.3 um rather than 0.0023 mm."""

from __future__ import annotations

from truing.units import difference_unit, from_si, same_dimension

FAMILIES = (
    ("m", "mm", "um", "nm"),
    ("rad", "mrad", "urad"),
    ("deg", "arcmin", "arcsec"),
    ("kN", "N", "mN"),
    ("kN*m", "N*m", "mN*m"),
    ("GPa", "MPa", "kPa", "Pa"),
    ("h", "min", "s", "ms"),
    ("kW", "W", "mW"),
    ("kg", "g", "mg"),
)
KNOWN = {unit for family in FAMILIES for unit in family}
SMALLEST, LARGEST = 0.1, 1000.0


def readable_unit(unit: str, size: float) -> str:
    """Return a unit like ``unit`` in which ``size`` (SI, a difference) reads well; ``unit`` itself where it does."""
    own = difference_unit(unit)
    if SMALLEST <= abs(float(from_si(size, own))) < LARGEST or size == 0:
        return own
    for family in FAMILIES:
        if own in family or (same_dimension(own, family[0]) and own not in KNOWN):
            fitting = [each for each in family if SMALLEST <= abs(float(from_si(size, each))) < LARGEST]
            return fitting[0] if fitting else own
    return own
