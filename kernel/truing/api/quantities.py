"""Quantities of pint, as a user of pint has them: of the application's registry, in the unit that is printed."""

from __future__ import annotations

from typing import Any

import pint

from truing.units import from_si, pint_quantity
from truing.units.names import CURRENCIES


def quantity_of(si: Any, unit: str) -> Any:
    """Return a number or array in SI as a quantity in a unit; in base units where pint does not know its name."""
    registry: Any = pint.get_application_registry()  # type: ignore[no-untyped-call]
    for currency in CURRENCIES:
        if currency not in registry:
            registry.define(f"{currency} = [currency_{currency}]")
    try:
        return registry.Quantity(from_si(si, unit), registry.parse_units(unit))
    except (pint.UndefinedUnitError, pint.DefinitionSyntaxError, ValueError):
        return registry.Quantity(si, str(pint_quantity(1.0, unit).units))
