"""Rows of the sheet that say what was asked: inputs, tolerances, conditions, effects, checks."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import PurePath
from typing import Any

from truing.calculation import Calculation
from truing.declare.fields import Given, InputField
from truing.declare.goals import Require
from truing.declare.spreads import Distribution
from truing.evaluate import acting_inputs
from truing.inputs_file.values import halving_in_words
from truing.numbers import (
    ABSENT,
    RESULT_DIGITS,
    STATED_DIGITS,
    format_chance,
    format_difference,
    format_number,
    format_value,
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
from truing.studies.checks import Check, check_name, requirements
from truing.studies.verdicts import NO_RESULT, NO_STUDY
from truing.units import unit_text

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
            note="; ".join(part for part in (item.spec.note, halving_in_words(item)) if part),
            source=item.spec.source,
            stated=name in setup.source.stated,
            calibrated=None if fitted is None else Value(*format_value(fitted, unit, STATED_DIGITS)),
        )


def input_value(setup: Setup, item: InputField, value: Any) -> Value:
    """Write one input: a number in its printed unit, a choice, a switch, a file."""
    if item.kind == "file":
        if item.name in setup.source.tables:
            return Value(PurePath(setup.source.tables[item.name]["file"]).name)
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
    setup = calculation.setup
    fields = setup.model.result_fields
    requires = requirements(setup)
    named = {check_name(item, requires): item for item in requires}
    relative = relative_margins(calculation.checks)
    for check in calculation.checks:
        require = named.get(check.name)
        item = fields.get(check.name if require is None else require.result)
        calculated = require is not None and not check.chance and require.limit in fields
        yield CheckRow(
            name=check.name,
            symbol=item.symbol if item is not None and item.name == check.compared else "",
            note=item.spec.note if item is not None else check.note,
            compared=check.compared or check.name,
            relation=check.relation,
            value=check_value(check, check.value),
            limit=check_value(check, check.limit, RESULT_DIGITS if calculated else STATED_DIGITS),
            margin=margin_value(check, relative=relative),
            state=check.state,
            proposed=None if check.proposed is None else check_value(check, check.proposed.value),
            remark=_remark(check, require, setup),
            method=check.method,
        )


def check_value(check: Check, number: float, digits: int = RESULT_DIGITS) -> Value:
    """Write a value or a limit of a check: a probability in per cent, a flag as yes or no."""
    if number != number:
        return Value(ABSENT)
    if check.flag:
        return Value("yes" if number >= 1 else "no")
    if check.chance:
        return Value(format_chance(number), "%")
    return Value(format_number(number, digits), unit_text(check.unit))


def relative_margins(checks: Iterable[Check]) -> bool:
    """Tell whether the margins of a sheet are shares of their limits: where no limit is 0, else all are distances."""
    return all(check.limit for check in checks if not check.flag)


def margins_words(checks: Iterable[Check]) -> str:
    """Say what the margins of a sheet are."""
    return "in per cent of the limit" if relative_margins(checks) else "the distance to the limit"


def margin_value(check: Check, *, relative: bool) -> Value:
    """Write a margin, with per cent or its unit; a flag has none, and a value on its limit says so."""
    if check.flag or check.margin != check.margin:
        return Value(ABSENT)
    if check.margin == 0:
        return Value("on the limit")
    if relative:
        return Value(format_number(100 * check.margin, 3), "%")
    distance = abs(check.value - check.limit) * (1 if check.margin > 0 else -1)
    return (
        Value(format_number(100 * distance, 3), "%")
        if check.chance
        else Value(format_number(distance, 3), unit_text(check.unit))
    )


def least_margin(checks: Sequence[Check]) -> Value:
    """Write the smallest margin of the checks that are decided, as ``margin_value`` does."""
    decided = [check for check in checks if not check.undecided]
    if not decided:
        return Value(ABSENT)
    return margin_value(min(decided, key=lambda check: check.margin), relative=relative_margins(checks))


def _remark(check: Check, require: Require | None, setup: Setup) -> str:
    """Say which study would decide a limit; else what the bound of a probability is called."""
    if check.undecided == NO_RESULT:
        return "not decided: the result does not exist"
    if check.undecided == NO_STUDY:
        return f"{NO_STUDY} decides it"
    if check.undecided:
        return f"not decided: {check.undecided} would"
    if require is None or not check.chance:
        return check.note if check.note and check.compared else ""
    known = require.limit in {*setup.model.input_fields, *setup.model.result_fields}
    return f"bound: {require.limit.replace('_', ' ')}" if known else ""
