"""The limits of a calculation, and what is left of them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

from truing.calculation import Calculation
from truing.declare.goals import Require
from truing.numbers import ABSENT, RESULT_DIGITS, STATED_DIGITS, format_chance, format_number
from truing.report.document import Column, Marked, TableView, Text, Value, label_of
from truing.setup import Setup
from truing.studies.checks import Check, check_name, requirements
from truing.studies.verdicts import NO_RESULT, NO_STUDY
from truing.units import unit_text

MOST_CHECKS = 8
"""So many limits stand on page one; of more those of which least is left, and all in a chapter of their own."""


@dataclass(frozen=True)
class CheckRow:
    """A limit and how far it is kept: the check, symbol and note of what it is on, and its numbers as printed.

    ``proposed`` is the value of the design that a study proposes, ``remark`` says which study would decide the limit,
    or what its bound is called.
    """

    check: Check
    symbol: str
    note: str
    value: Value
    limit: Value
    margin: Value
    proposed: Value | None
    remark: str


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
        rows.append((about, row.value, *proposed, check.relation, row.limit, row.margin, Marked("state", check.state)))
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
        calculated = require is not None and not check.chance and require.limit in fields
        yield CheckRow(
            check=check,
            symbol=field.symbol if field is not None and field.name == check.compared else "",
            note=field.spec.note if field is not None else check.note,
            value=check_value(check, check.value),
            limit=check_value(check, check.limit, RESULT_DIGITS if calculated else STATED_DIGITS),
            margin=margin_value(check, relative=relative),
            proposed=None if check.proposed is None else check_value(check, check.proposed.value),
            remark=_remark(check, require, setup),
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
