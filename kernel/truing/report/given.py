"""What a calculation was given: inputs, tolerances in force, conditions and effects."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import PurePath
from typing import Any

from truing.declare.chain import acts_on, link_of
from truing.declare.fields import Given, InputField
from truing.evaluate import acting_inputs, taken_values
from truing.inputs_file.values import halving_in_words
from truing.numbers import (
    ABSENT,
    RESULT_DIGITS,
    format_difference,
    format_number,
    format_stated,
    format_value,
    pretty,
)
from truing.report.document import (
    BlockView,
    Column,
    Marked,
    Paragraph,
    Piece,
    TableView,
    Text,
    Value,
    joined,
    label_of,
    symbol_cell,
    with_source,
)
from truing.report.sheet_units import SheetUnits
from truing.setup import Setup, SwitchedOn
from truing.studies.sampling import scatter_of
from truing.units import unit_text
from truing.units.systems import in_system

PLACES = {"inputs": "on the inputs", "results": "on the results", "reading": "on the reading"}
LONGEST_SERIES = 8
NOT_GIVEN = "not given"
TAKEN_FROM = "taken from "
FEW = 6
"""So many inputs at a default of 0 still have rows of their own."""


def input_blocks(setup: Setup, detail: str) -> Iterator[BlockView]:
    """Say every input; of many that are not given or at a default of 0 only the names, but on a full sheet."""
    fields = setup.model.input_fields
    numbers = {**setup.model.read_inputs(setup.inputs), **taken_values(setup)}
    values = {name: input_value(setup, fields[name], value) for name, value in numbers.items()}
    idle = [
        name
        for name, value in values.items()
        if name not in setup.source.stated and value.text in {"0", NOT_GIVEN} and not fields[name].spec.source
    ]
    if detail == "full" or len(idle) <= FEW:
        idle = []
    shown = {name: value for name, value in values.items() if name not in idle}
    calibrated = any(name in setup.calibrated for name in shown)
    beside = {name: model_value(setup, fields[name], numbers[name]) for name in shown}
    in_model = any(beside.values())
    columns = (
        Column("Symbol", kind="symbol"), Column("Input", kind="name"), Column("Value", kind="number"),
        Column("Unit", kind="units"), *((Column("In the model", kind="number"),) if in_model else ()),
        *((Column("Calibrated", kind="number"),) if calibrated else ()),
        Column("Given", kind="given"), Column("Source"),
    )  # fmt: skip
    rows = []
    for name, value in shown.items():
        more = [*([beside[name] or ""] if in_model else []), *([_fitted(setup, name)] if calibrated else [])]
        rows.append(_input_row(setup, name, value, tuple(more)))
    title = "What the calculation starts from; 'stated' stands in the inputs file, 'default' is the model's own value"
    yield TableView(title, columns, tuple(rows), kind="inputs")
    if idle:
        called = joined(
            Marked("symbol", fields[name].symbol) if fields[name].symbol else Marked("code", name) for name in idle
        )
        words = "Not given, or left at their default of 0 (inputs.toml names them): "
        yield Paragraph((words, *called, "."), "aside")


def _input_row(setup: Setup, name: str, value: Value, more: tuple[Text, ...]) -> tuple[Text, ...]:
    field = setup.model.input_fields[name]
    note = "; ".join(part for part in (field.spec.note, halving_in_words(field)) if part)
    given = _given_how(setup, name)
    return (
        symbol_cell(field.symbol), label_of(note, name), value.text, value.unit, *more, given,
        "" if given.startswith(TAKEN_FROM) else field.spec.source,
    )  # fmt: skip


def _given_how(setup: Setup, name: str) -> str:
    """Say whether an input is stated, taken from another calculation, or at its default."""
    if name in setup.source.stated:
        return "stated"
    link = link_of(setup.model, name)
    return "default" if link is None else f"{TAKEN_FROM}{link.source}"


def _fitted(setup: Setup, name: str) -> Text:
    """Write an input as a diagnosis fitted it, in the unit beside its value; nothing where it did not."""
    fitted = setup.calibrated.get(name)
    unit = shown_unit(setup, name)
    return "" if fitted is None else format_stated(fitted, unit, setup.unit_of(name))[0]


def shown_unit(setup: Setup, name: str) -> str:
    """Return the unit in which an input or condition is shown: as it is stated.

    A unit that the inputs file states for its print wins, and a system to which the stated one does not belong.
    """
    stated, system = setup.source.units.get(name, ""), setup.sheet.units
    if not stated or (not system and name in setup.units):
        return setup.print_unit(name)
    return setup.print_unit(name) if system and in_system(stated, system) != stated else stated


def model_value(setup: Setup, field: InputField, value: Any) -> Value | None:
    """Write an input in the unit in which the model prints it, where it is shown in another one; else None."""
    if setup.source.units.get(field.name) is None:
        return None
    unit, shown = setup.print_unit(field.name), shown_unit(setup, field.name)
    return None if unit_text(unit) == unit_text(shown) else _number_value(field, value, unit, shown)


def input_with_model(setup: Setup, field: InputField, value: Any) -> Text:
    """Write an input as it is stated, and behind it in the unit of the model where that is another one."""
    beside = model_value(setup, field, value)
    shown = input_value(setup, field, value)
    return shown if beside is None else (shown, " ", Marked("aside", "= "), Marked("aside", beside))


def input_value(setup: Setup, field: InputField, value: Any) -> Value:
    """Write one input: a number as it is stated, a choice, a switch, a file, a series (a long one by its ends)."""
    if field.kind == "file":
        if field.name in setup.source.tables:
            return Value(PurePath(setup.source.tables[field.name]["file"]).name)
        return Value(NOT_GIVEN if value is None else "default")
    if isinstance(value, bool):
        return Value("yes" if value else "no")
    if isinstance(value, str) or (isinstance(field.spec, Given) and field.spec.unit is None):
        return Value(str(value))
    return _number_value(field, value, shown_unit(setup, field.name), setup.stated_unit(field.name))


def _number_value(field: InputField, value: Any, unit: str, stated: str) -> Value:
    if field.kind == "series":
        texts = [format_value(float(number), unit) for number in value] or [(ABSENT, "")]
        (first, shown_unit), (last, _) = texts[0], texts[-1]
        if len(texts) <= LONGEST_SERIES:
            return Value(", ".join(text for text, _ in texts), shown_unit)
        return Value(f"{first} … {last} ({len(texts)} values)", shown_unit)
    if value != value:
        return Value(NOT_GIVEN)
    return Value(*format_stated(value, unit, stated))


def tolerance_table(setup: Setup) -> TableView:
    """Say every tolerance that scatters: the standard deviation of what it is on, and how far the mean lies off."""
    columns = (
        Column("Tolerance", kind="name"), Column("On"), Column("Spread"), Column("Standard deviation", kind="number"),
        Column("Why"),
    )  # fmt: skip
    rows = []
    for name, distributions in setup.distributions().items():
        tolerance = setup.model.tolerances[name]
        sds, shifts = [], []
        for on, distribution in distributions.items():
            unit, shift = setup.print_unit(on), distribution.mean - float(setup.nominal(on))
            sds.append(Value(*format_difference(distribution.sd, unit, 4)))
            if abs(shift) > 1e-12 * max(abs(float(setup.nominal(on))), distribution.sd):
                number, printed = format_difference(shift, unit, 4)
                shifts.append(Value(number if number.startswith("-") else f"+{number}", printed))
        scatter: list[Piece] = [*joined(dict.fromkeys(sds))]
        for mean in dict.fromkeys(shifts):
            scatter += [Marked("break", ", "), "mean ", mean]
        targets = ", ".join(on.replace("_", " ") for on in distributions)
        units = SheetUnits(setup.sheet.units)
        why, spread = units.said(tolerance.why), units.said(setup.spread_of(name).text)
        rows.append((name.replace("_", " "), targets, spread, tuple(scatter), with_source(why, tolerance.source)))
    return TableView("How the inputs scatter about their nominal values", columns, tuple(rows), kind="tolerances")


def correlation_table(setup: Setup) -> TableView:
    """Say which inputs scatter together, with the correlation of their values where it is another than the stated one.

    Rows are the pairs whose inputs both scatter.
    """
    why = {each.pair: with_source(each.why, each.source) for each in setup.correlations}
    pairs = scatter_of(setup).pairs
    with_values = any(abs(pair.of_values - pair.coefficient) > 1e-12 for pair in pairs)
    heads = [Column("Correlation", kind="number")] + [Column("Of the values", kind="number")] * with_values
    rows: list[tuple[Text, ...]] = []
    for pair in pairs:
        numbers = [pair.coefficient, pair.of_values] if with_values else [pair.coefficient]
        names = f"{pair.first} and {pair.second}".replace("_", " ")
        printed = (Value(pretty(format_number(number, 4))) for number in numbers)
        rows.append((names, *printed, why[frozenset({pair.first, pair.second})]))
    title = "Inputs that scatter together: the correlation of their normal scores"
    return TableView(title, (Column("Inputs", kind="name"), *heads, Column("Why")), tuple(rows), kind="tolerances")


def effect_blocks(setup: Setup) -> Iterator[BlockView]:
    """Say every condition with its reference, and every effect that is on with its unknowns and what it changes."""
    if setup.conditions:
        title = "Conditions, and the references at which their effects vanish"
        columns = (Column("Condition", kind="name"), Column("Value", kind="number"), Column("Reference", kind="number"))
        rows: list[tuple[Text, ...]] = []
        for name, value in setup.conditions.items():
            condition, unit, stated = (
                setup.model.known_conditions[name],
                shown_unit(setup, name),
                setup.stated_unit(name),
            )
            values = (Value(*format_stated(number, unit, stated)) for number in (value, condition.zero))
            rows.append((label_of(condition.note, name), *values))
        yield TableView(title, columns, tuple(rows))
    if not setup.effects:
        yield Paragraph("No effect is on.")
        return
    heads = (Column("Effect", kind="name"), Column("Acts"), Column("Unknowns"), Column("Why"))
    on = tuple(_effect_row(active, setup) for active in setup.effects)
    yield TableView("Effects that are on", heads, on, kind="effects")
    changed = list(_changed_inputs(setup))
    if changed:
        yield Paragraph(("With them the calculation runs with ", *joined(changed, "; "), "."), "aside")


def _effect_row(active: SwitchedOn, setup: Setup) -> tuple[Text, ...]:
    effect = active.effect
    unknowns: list[Text] = []
    for unknown in active.unknowns:
        unit = setup.sheet.shown(unknown.unit)
        value = Value(*format_value(active.values[unknown.name], unit, RESULT_DIGITS))
        sd = active.sds.get(unknown.name)
        scatter = (" ± ", Value(*format_difference(sd, unit, 3)), " ", Marked("aside", "(sd)")) if sd else ()
        unknowns.append((unknown.name.replace("_", " ") + " = ", value, *scatter))
    why = with_source(effect.why or effect.looks_like, effect.source)
    place = PLACES[acts_on(setup.model, effect)]
    return (effect.name.replace("_", " "), place, joined(unknowns, Marked("break", ", ")), why)


def _changed_inputs(setup: Setup) -> Iterator[Text]:
    """Say which inputs the effects that are on change, and to what."""
    if not any(active.effect.place == "inputs" for active in setup.effects):
        return
    stated, acting = (setup.model.read_inputs(inputs) for inputs in (setup.inputs, acting_inputs(setup)))
    stated |= taken_values(setup)
    for name, field in setup.model.input_fields.items():
        before, after = stated[name], acting[name]
        if field.varies and before != after and not (before != before and after != after):
            unit = setup.print_unit(name)
            old, new = (Value(*format_value(value, unit, digits)) for value, digits in ((before, 10), (after, 7)))
            what = Marked("symbol", field.symbol) if field.symbol else name.replace("_", " ")
            yield what, " = ", new, " instead of ", old
