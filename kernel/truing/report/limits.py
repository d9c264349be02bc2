"""The limits of a calculation, and what is left of them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

from truing.calculation import Calculation
from truing.declare.goals import Require
from truing.numbers import ABSENT, RESULT_DIGITS, STATED_DIGITS, format_chance, format_number, format_stated
from truing.report.document import Column, Marked, TableView, Text, Value, label_of
from truing.report.given import shown_unit
from truing.setup import Setup
from truing.studies.checks import Check, check_name, requirements
from truing.studies.verdicts import NO_RESULT, NO_STUDY
from truing.units import split_quantity, to_si, unit_text

MOST_CHECKS = 8
"""So many limits stand on page one; of more those of which least is left, and all in a chapter of their own."""


@dataclass(frozen=True)
class CheckRow:
    """A limit and how far it is kept: the check, symbol and note of what it is on, and its numbers as printed.

    A limit that is an input is shown as it is stated, and ``in_model`` in the unit of the value where that is another
    one. ``proposed`` is the value of the design that a study proposes, ``remark`` says which study would decide the
    limit, or what its bound is called.
    """

    check: Check
    symbol: str
    note: str
    value: Value
    limit: Value
    margin: Value
    proposed: Value | None
    remark: str
    in_model: Value | None = None


def check_table(calculation: Calculation, most: int | None = None) -> TableView:
    """Say every limit, and what is left of it; of more than ``most`` those of which least is left."""
    has_proposal = calculation.decided.proposal is not None
    columns = (
        Column("Check", kind="name"), Column("As stated" if has_proposal else "Value", kind="number"),
        *((Column("As proposed", kind="number"),) if has_proposal else ()), Column("must be", kind="relation"),
        Column("Limit", kind="number"), Column("Margin", kind="number"), Column("Verdict", kind="verdict-cell"),
    )  # fmt: skip
    rows: list[tuple[Text, ...]] = []
    shown = list(check_rows(calculation))
    left = 0 if most is None else max(len(shown) - most, 0)
    if left:
        shown = sorted(shown, key=lambda row: (row.check.state == "passes", row.check.margin))[:most]
    for row in shown:
        check = row.check
        remark = "; ".join(filter(None, (row.remark, check.method)))
        label = label_of(row.note, check.name, row.symbol)[:-1]
        about = (*label, Marked("bracketed code", check.compared or check.name))
        about += (Marked("break", ", "), Marked("aside", remark)) if remark else ()
        proposed = (row.proposed or "",) if has_proposal else ()
        in_model = () if row.in_model is None else (" ", Marked("aside", "= "), Marked("aside", row.in_model))
        numbers = (row.value, *proposed, check.relation, (row.limit, *in_model), row.margin)
        rows.append((about, *numbers, Marked("state", check.state)))
    margin = "in per cent of the limit" if relative_margins(calculation.checks) else "the distance to the limit"
    title = f"Limits, and what is left of them. A margin is {margin}; above zero is safe"
    note = f"Of {len(shown) + left} limits those of which least is left; all are in their own chapter." if left else ""
    states = tuple(row.check.state for row in shown)
    return TableView(title, columns, tuple(rows), note, states=states, kind="checks")


def check_rows(calculation: Calculation) -> Iterator[CheckRow]:
    """Say every limit with what is left of it."""
    setup = calculation.setup
    fields = setup.model.result_fields
    requires = requirements(setup)
    named = {check_name(require, requires): require for require in requires}
    relative = relative_margins(calculation.checks)
    for check in calculation.checks:
        require = named.get(check.name)
        field = fields.get(check.name if require is None else require.result)
        yield CheckRow(
            check=check,
            symbol=field.symbol if field is not None and field.name == check.compared else "",
            note=field.spec.note if field is not None else check.note,
            value=check_value(check, check.value),
            limit=_limit_value(check, require, setup),
            in_model=_limit_in_model(check, require, setup),
            margin=margin_value(check, relative=relative),
            proposed=None if check.proposed is None else check_value(check, check.proposed.value),
            remark=_remark(check, require, setup),
        )


def _limit_value(check: Check, require: Require | None, setup: Setup) -> Value:
    """Write a limit: one that is an input as that is stated, one that is calculated as results are."""
    if check.chance or check.flag or check.limit != check.limit or require is None:
        return check_value(check, check.limit, STATED_DIGITS)
    if require.limit in setup.model.result_fields:
        return check_value(check, check.limit)
    unit = _input_unit(check, require, setup)
    return Value(*format_stated(to_si(check.limit, check.unit), unit, _stated_unit(check, require, setup)))


def _limit_in_model(check: Check, require: Require | None, setup: Setup) -> Value | None:
    """Write a limit that is an input in the unit of the value, where it is stated in another one; else None."""
    if check.chance or check.flag or check.limit != check.limit or require is None:
        return None
    if unit_text(_input_unit(check, require, setup)) == unit_text(check.unit):
        return None
    return Value(*format_stated(to_si(check.limit, check.unit), check.unit, _stated_unit(check, require, setup)))


def _input_unit(check: Check, require: Require, setup: Setup) -> str:
    """Return the unit in which a limit is shown: that of an input that is stated in another one, else the value's."""
    is_stated = require.limit in setup.model.input_fields and require.limit in setup.source.units
    return shown_unit(setup, require.limit) if is_stated else check.unit


def _stated_unit(check: Check, require: Require, setup: Setup) -> str:
    """Return the unit in which the number of a limit was written."""
    if require.limit in setup.model.input_fields:
        return setup.stated_unit(require.limit)
    unit = split_quantity(require.limit).unit
    return unit or setup.model.result_fields[require.result].unit


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
