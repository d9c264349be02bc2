"""What the options of a study say: ranges such as "-180..180 deg", and the units in which studies print."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from truing.declare.near_miss import near_miss
from truing.errors import UnitError, UsageError
from truing.setup import Setup
from truing.studies.checks import as_number
from truing.units import difference_unit, from_si, read_quantity, split_quantity, unit_factor
from truing.units.names import PURE


def read_range(text: str, unit: str, points: int) -> NDArray[np.float64]:
    """Read "low..high unit" (evenly spaced, ``points`` of them) or "a, b, c unit" and return SI values.

    Raises UsageError with one sentence for anything else.
    """
    is_range = ".." in text
    words = [word.strip() for word in (text.split("..") if is_range else text.split(","))]
    if not text.strip() or (is_range and len(words) != 2) or not all(words):
        raise UsageError(f'\'{text}\' is no range; write "-180..180 deg" or "0, 10, 20 deg"')
    values = _with_common_unit(words, unit, text)
    return np.linspace(values[0], values[1], points) if is_range else np.array(values)


def _with_common_unit(words: list[str], unit: str, text: str) -> list[float]:
    try:
        common = split_quantity(words[-1]).unit
        quantities = [split_quantity(word) for word in words]
        return [read_quantity(f"{quantity.value!r} {quantity.unit or common}".strip(), unit) for quantity in quantities]
    except UnitError as error:
        raise UsageError(f"the range '{text}': {error}") from error


def scattering_name(setup: Setup, name: str, study: str) -> str:
    """Return the name of an input or condition that a study varies; raises UsageError where it cannot vary."""
    field = setup.model.input_fields.get(name)
    if field is None and name not in setup.conditions:
        known = [*setup.model.input_fields, *setup.conditions]
        raise UsageError(f"study '{study}': '{name}' is no input of {setup.model.name}.{near_miss(name, known)}")
    if field is not None and not (field.varies or field.kind == "integer"):
        raise UsageError(f"study '{study}': '{name}' cannot be swept; only a number can")
    return name


def single_numbers(setup: Setup, of: str | tuple[str, ...], study: str) -> tuple[str, ...]:
    """Return the results that a study names, each once; raises UsageError for one that the function does not have.

    Likewise for one that runs along an axis.
    """
    named = (of,) if isinstance(of, str) else tuple(dict.fromkeys(of))
    known = setup.model.own_result_fields
    for name in named:
        if name not in known:
            raise UsageError(f"study '{study}': {setup.model.name} has no result '{name}'.{near_miss(name, known)}")
        if known[name].along:
            raise UsageError(f"study '{study}': '{name}' runs along an axis; name a result that is one number")
    return named


def scalar_results(setup: Setup) -> tuple[str, ...]:
    """Return the results of the function that are one number each."""
    return tuple(name for name, field in setup.model.own_result_fields.items() if not field.along)


def spoken(name: str) -> str:
    """Return a name as words: "slider position"."""
    return name.replace("_", " ")


def per(unit: str, source: str) -> str:
    """Return the unit of a derivative: "mm/deg"."""
    above, below = difference_unit(unit), difference_unit(source)
    if below in PURE:
        return above
    if any(sign in below for sign in "*/·- "):
        below = f"({below})"
    if any(sign in above for sign in "/-"):
        above = f"({above})"
    return f"{above or '1'}/{below}"


def printed(value: Any, unit: str) -> Any:
    """Bring a value from SI to a unit; a number or a list, None where it is not finite, for results.json."""
    return as_number(from_si(np.asarray(value, dtype=float), unit))


def printed_step(value: Any, unit: str) -> Any:
    """Bring a difference or standard deviation from SI to a unit, for results.json."""
    return as_number(np.asarray(value, dtype=float) / unit_factor(difference_unit(unit)))
