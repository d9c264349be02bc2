"""Values as a user gives them in Python, written as --set reads them, and results as quantities of pint."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
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
    return [f"{name}={text}" for name, value in values.items() for name, text in _each(model, name, value)]


def _each(model: Model[Any, Any], name: str, value: Any) -> Iterator[tuple[str, str]]:
    is_declared = name in model.input_fields or name in model.known_conditions
    if name == "draws" and not is_declared:
        drawing = [study.name for study in model.studies if hasattr(study, "draws")]
        if not drawing:
            raise UsageError(f"{model.name} has no study that draws; leave out draws")
        yield from ((f"studies.{study}.draws", str(value)) for study in drawing)
        return
    yield name, text_of(model, name, value)


def text_of(model: Model[Any, Any], name: str, value: Any) -> str:
    """Return the value of an input or condition as a file has it. Raises UsageError for what is no value."""
    return _text(name, value, _unit_of(model, name))


def _unit_of(model: Model[Any, Any], name: str) -> str:
    if name in model.input_fields:
        return model.input_fields[name].unit
    return model.known_conditions[name].unit if name in model.known_conditions else ""


def _text(name: str, value: Any, unit: str) -> str:
    if isinstance(value, str):
        return value
    if hasattr(value, "dimensionality"):
        return _number(float(from_si(_in_si(name, value, unit), unit)), unit)
    if isinstance(value, (bool, np.bool_)):
        return toml_value(bool(value))
    if isinstance(value, (Real, np.number)):
        return _number(value, unit)
    if isinstance(value, (Sequence, np.ndarray)):
        return "[" + ", ".join(toml_value(_text(name, each, unit)) for each in value) + "]"
    raise UsageError(f"{name}: {value!r:.60} is no text, number or quantity")


def _number(value: Any, unit: str) -> str:
    plain = value.item() if hasattr(value, "item") else value
    return f"{plain!r} {unit}".rstrip()


def _in_si(name: str, value: Any, unit: str) -> float:
    """Return a quantity of pint in SI. Raises UsageError where its dimension is another one."""
    if value.dimensionality != pint_quantity(1.0, unit).dimensionality:
        raise UsageError(f"{name}: {value} cannot be written in {unit or 'a number without a unit'}")
    return float(value.to_base_units().magnitude)


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
