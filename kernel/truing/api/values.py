"""Values as a user gives them in Python, written as --set reads them, and results as quantities of pint."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from numbers import Real
from typing import Any

import numpy as np
import pint

from truing.declare.model import Model
from truing.errors import UsageError
from truing.inputs_file.assemble import toml_value
from truing.units import from_si, pint_quantity
from truing.units.names import CURRENCIES


def settings_of(model: Model[Any, Any], values: Mapping[str, Any]) -> list[str]:
    """Return "name=value" for every value: texts carry units, numbers are in the declared unit, quantities are pint's.

    ``draws`` is that of every study that draws. Other names are those of ``--set``: inputs, conditions, ``seed``, and
    dotted names such as "tolerances.load".
    """
    said = dict(values)
    if "draws" in values and "draws" not in {*model.input_fields, *model.known_conditions}:
        drawing = [study.name for study in model.studies if hasattr(study, "draws")]
        if not drawing:
            raise UsageError(f"{model.name} has no study that draws; leave out draws")
        said |= dict.fromkeys([f"studies.{study}.draws" for study in drawing], str(said.pop("draws")))
    return [f"{name}={text_of(model, name, value)}" for name, value in said.items()]


def text_of(model: Model[Any, Any], name: str, value: Any) -> str:
    """Return the value of an input or condition as a file has it. Raises UsageError for what is no value."""
    declared = model.input_fields.get(name) or model.known_conditions.get(name)
    unit = declared.unit if declared is not None else ""
    if isinstance(value, str):
        return value
    if hasattr(value, "dimensionality"):
        if value.dimensionality != pint_quantity(1.0, unit).dimensionality:
            raise UsageError(f"{name}: {value} cannot be written in {unit or 'a number without a unit'}")
        return _number(float(from_si(float(value.to_base_units().magnitude), unit)), unit)
    if isinstance(value, (bool, np.bool_)):
        return toml_value(bool(value))
    if isinstance(value, (Real, np.number)):
        return _number(value, unit)
    if isinstance(value, (Sequence, np.ndarray)):
        return "[" + ", ".join(toml_value(text_of(model, name, each)) for each in value) + "]"
    raise UsageError(f"{name}: {value!r:.60} is no text, number or quantity")


def _number(value: Any, unit: str) -> str:
    plain = value.item() if hasattr(value, "item") else value
    return f"{plain!r} {unit}".rstrip()


# Quantities of pint, as a user of pint has them: of the application's registry, in the unit that is printed


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
