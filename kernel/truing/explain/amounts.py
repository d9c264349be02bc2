"""Numbers of an explanation: SI values as they are printed, and as data."""

from __future__ import annotations

from typing import Any

import numpy as np

from truing.formulas import symbol_text
from truing.numbers import ABSENT, format_difference, format_ends, format_value, pretty, with_unit
from truing.report.content import input_value
from truing.runs.documents import clean
from truing.setup import Setup
from truing.units import from_si


def amount(setup: Setup, name: str, value: Any) -> dict[str, Any]:
    """Return the value (SI) of an input, a condition or a result as data, with the text that is printed of it."""
    unit = setup.print_unit(name)
    shown = text_of(setup, name, value)
    if isinstance(value, (bool, str)) or value is None or not _is_number(value):
        return {"value": clean(value) if isinstance(value, (bool, str)) else None, "unit": unit, "text": shown}
    return {"value": clean(from_si(value, unit)), "unit": unit, "text": shown}


def _is_number(value: Any) -> bool:
    return isinstance(value, (int, float)) or hasattr(value, "dtype")


def text_of(setup: Setup, name: str, value: Any) -> str:
    """Write a value with its unit: a number, the range of a series, a choice, a file."""
    field = setup.model.input_fields.get(name)
    if field is not None:
        shown = input_value(setup, field, value)
        return with_unit(pretty(shown.text), shown.unit)
    unit = setup.print_unit(name)
    if getattr(value, "ndim", 0):
        low, high, word = format_ends(value, unit)
        return f"{with_unit(f'{pretty(low)} .. {pretty(high)}', word)} ({np.size(value)} values)" if low else ABSENT
    result = setup.model.result_fields.get(name)
    number, word = format_value(value, unit, result.digits if result is not None else 10)
    return with_unit(pretty(number), word)


def step_text(setup: Setup, name: str, step: float | None, digits: int = 3) -> str:
    """Write a difference (SI) of a result or an input, with its unit."""
    if step is None:
        return ABSENT
    number, unit = format_difference(step, setup.print_unit(name), digits)
    return with_unit(pretty(number), unit)


def item_of(setup: Setup, name: str, value: Any) -> dict[str, Any]:
    """Return a row about an input, a condition or a result: what it is called, its symbol, its value, its note."""
    model = setup.model
    field: Any = model.result_fields.get(name) or model.input_fields.get(name)
    kind = "result" if name in model.result_fields else "input" if field is not None else "condition"
    symbol = symbol_text(field.symbol) if field is not None and field.symbol else ""
    note = field.spec.note if field is not None else model.known_conditions[name].note
    return {"name": name, "kind": kind, "symbol": symbol, **amount(setup, name, value), "note": note}
