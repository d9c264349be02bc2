"""Rows of the sheet that say what was asked: inputs, tolerances, conditions, effects, checks."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import PurePath
from typing import Any

from truing.calculation import Calculation
from truing.declare.fields import Given, InputField
from truing.declare.goals import Require
from truing.declare.spreads import Distribution
from truing.evaluate import acting_inputs
from truing.numbers import (
    ABSENT,
    RESULT_DIGITS,
    STATED_DIGITS,
    format_difference,
    format_number,
    format_value,
    with_unit,
)
from truing.report.context import (
    ChangedInput,
    CheckRow,
    ConditionRow,
    EffectRow,
    InputRow,
    ToleranceRow,
    UnknownRow,
    Value,
)
from truing.setup import Setup
from truing.studies.bench import Check
from truing.studies.checks import check_name

PLACES = {"inputs": "on the inputs", "results": "on the results", "reading": "on the reading"}
LONGEST_SERIES = 8
NOT_GIVEN = "not given"


def input_rows(setup: Setup) -> Iterator[InputRow]:
    """Say every input with its value as it is printed."""
    for name, value in setup.model.read_inputs(setup.inputs).items():
        item = setup.model.input_fields[name]
        fitted = setup.calibrated.get(name)
        unit = setup.print_unit(name)
        yield InputRow(
            name=name,
            symbol=item.symbol,
            value=input_value(setup, item, value),
            note=item.spec.note,
            source=item.spec.source,
            stated=name in setup.stated,
            calibrated=None if fitted is None else Value(*format_value(fitted, unit, STATED_DIGITS)),
        )


def input_value(setup: Setup, item: InputField, value: Any) -> Value:
    """Write one input: a number in its printed unit, a choice, a switch, a file."""
    if item.kind == "file":
        if item.name in setup.tables:
            return Value(PurePath(setup.tables[item.name]["file"]).name)
        return Value(NOT_GIVEN if value is None else "default")
    if isinstance(value, bool):
        return Value("yes" if value else "no")
    if isinstance(value, str) or (isinstance(item.spec, Given) and item.spec.unit is None):
        return Value(str(value))
    unit = setup.print_unit(item.name)
    if item.kind == "series":
        return series_value(value, unit)
    if value != value:
        return Value(NOT_GIVEN)
    return Value(*format_value(value, unit, STATED_DIGITS))


def series_value(value: Any, unit: str) -> Value:
    """Write a series: all of it if it is short, otherwise its ends and its length."""
    texts = [format_value(float(number), unit) for number in value]
    if not texts:
        return Value(ABSENT)
    if len(texts) <= LONGEST_SERIES:
        return Value(", ".join(text for text, _ in texts), texts[0][1])
    return Value(f"{texts[0][0]} … {texts[-1][0]} ({len(texts)} values)", texts[0][1])


def tolerance_rows(setup: Setup) -> Iterator[ToleranceRow]:
    """Say every tolerance that scatters, with the standard deviation of what it is on."""
    for name, distributions in setup.distributions().items():
        tolerance = setup.model.tolerances[name]
        sds = {Value(*format_difference(item.sd, setup.print_unit(on), 4)): None for on, item in distributions.items()}
        yield ToleranceRow(
            name=name,
            on=tuple((on, _symbol(setup, on)) for on in distributions),
            spread=setup.spread_of(name).text,
            sds=tuple(sds),
            shift=tuple(dict.fromkeys(_shifts(setup, distributions))),
            why=tolerance.why,
            source=tolerance.source,
        )


def _symbol(setup: Setup, name: str) -> str:
    item = setup.model.input_fields.get(name)
    return item.symbol if item is not None else ""


def _shifts(setup: Setup, distributions: Mapping[str, Distribution]) -> Iterator[Value]:
    """Say how far the mean lies from the nominal, where it does."""
    for name, item in distributions.items():
        nominal = float(setup.nominal(name))
        if abs(item.mean - nominal) > 1e-12 * max(abs(nominal), item.sd):
            number, unit = format_difference(item.mean - nominal, setup.print_unit(name), 4)
            yield Value(number if number.startswith("-") else f"+{number}", unit)


def condition_rows(setup: Setup) -> Iterator[ConditionRow]:
    """Say every condition with its reference."""
    for name, value in setup.conditions.items():
        condition = setup.model.known_conditions[name]
        unit = setup.print_unit(name)
        reference = Value(*format_value(condition.zero, unit, STATED_DIGITS))
        yield ConditionRow(name, Value(*format_value(value, unit, STATED_DIGITS)), reference, condition.note)


def effect_rows(setup: Setup) -> Iterator[EffectRow]:
    """Say every effect that is on, with its unknowns."""
    for item in setup.effects:
        unknowns = []
        for unknown in item.unknowns:
            sd = item.sds.get(unknown.name)
            scatter = Value(*format_difference(sd, unknown.unit, 3)) if sd else None
            value = Value(*format_value(item.values[unknown.name], unknown.unit, RESULT_DIGITS))
            unknowns.append(UnknownRow(unknown.name, value, scatter, unknown.note))
        effect = item.effect
        why = effect.why or effect.looks_like
        yield EffectRow(effect.name, PLACES[effect.place], tuple(unknowns), why, effect.source)


def changed_inputs(setup: Setup) -> Iterator[ChangedInput]:
    """Say which inputs the effects that are on change, and to what."""
    if not any(item.effect.place == "inputs" for item in setup.effects):
        return
    stated, acting = (setup.model.read_inputs(inputs) for inputs in (setup.inputs, acting_inputs(setup)))
    for name, item in setup.model.input_fields.items():
        before, after = stated[name], acting[name]
        if item.varies and before != after and not (before != before and after != after):
            unit = setup.print_unit(name)
            values = (Value(*format_value(value, unit, digits)) for value, digits in ((before, 10), (after, 7)))
            yield ChangedInput(name, item.symbol, *values)


def check_rows(calculation: Calculation) -> Iterator[CheckRow]:
    """Say every limit with what is left of it."""
    from truing.units import unit_text

    setup = calculation.setup
    fields = setup.model.result_fields
    requires = _requires(setup)
    named = {check_name(item, requires): item for item in requires}
    for check in calculation.checks:
        item = fields.get(check.name) or fields.get(check.name.partition(" ")[0])
        require = named.get(check.name)
        chance = require if require is not None and _is_chance(require) else None
        calculated = require is not None and chance is None and require.limit in fields
        unit = unit_text(check.unit)
        number = format_number(check.margin, 3)
        yield CheckRow(
            name=check.name,
            symbol=item.symbol if item is not None and item.name == check.name else "",
            note=item.spec.note if item is not None else check.note,
            relation=_relation(check, setup),
            value=Value(format_number(check.value, RESULT_DIGITS), unit),
            limit=Value(format_number(check.limit, RESULT_DIGITS if calculated else STATED_DIGITS), unit),
            margin=_margin(check, number),
            passed=bool(check.passed),
            chance=_chance_words(chance, check.note, calculation) if chance is not None else "",
            method=check.method,
        )


def _requires(setup: Setup) -> list[Require]:
    return [item for item in setup.model.objectives if isinstance(item, Require)]


def _is_chance(require: Require) -> bool:
    return require.reliability is not None


def _chance_words(require: Require, note: str, calculation: Calculation) -> str:
    """Say what a probability is one of: the limit in numbers where it is an input or a result."""
    setup = calculation.setup
    limit = require.limit
    if limit in setup.model.input_fields or limit in calculation.answers:
        limit = _named_limit(calculation, limit)
    words = {"at_most": "at or below {}", "at_least": "at or above {}", "within": "within {} of its nominal"}
    return f"probability of staying {words[require.kind].format(limit)}" + (f", {note}" if note else "")


def _named_limit(calculation: Calculation, name: str) -> str:
    """Write a limit that an input or a result gives: its name, and its number where it is one."""
    setup = calculation.setup
    value = {**setup.model.read_inputs(setup.inputs), **calculation.answers}[name]
    words = name.replace("_", " ")
    if getattr(value, "ndim", 0) or value != value:
        return words
    return f"{words} ({with_unit(*format_value(value, setup.print_unit(name)))})"


def _margin(check: Check, number: str) -> str:
    """Write a margin as a share of the limit; where the limit is 0, as it is."""
    if not check.limit or number == ABSENT:
        return number
    return f"{format_number(100 * check.margin, 3)} %"


def _relation(check: Check, setup: Setup) -> str:
    """Return which side is safe: the sign of the margin tells, and where it is 0 the requirement does."""
    distance = check.limit - check.value
    if distance * check.margin:
        return "≤" if distance * check.margin > 0 else "≥"
    stated = [item for item in _requires(setup) if check.name.startswith(item.result)]
    return "≥" if any(item.kind == "at_least" or _is_chance(item) for item in stated) else "≤"
