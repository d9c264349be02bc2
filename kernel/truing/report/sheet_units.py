"""A sheet in SI or in inches and pounds: what was calculated as it is printed there.

The calculation keeps its numbers. It gets a setup that prints every name in the unit of the system, its studies print
what they hold in SI likewise, and limits are brought over. Blocks of plugins, whose numbers stand in units already, are
brought over column by column, sentences quantity by quantity.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields, is_dataclass, replace
from typing import Any

from truing.calculation import Calculation
from truing.cases import CaseResult, CasesTable
from truing.declare.blocks import Block, Cell, Drawing, Table, Words
from truing.errors import UnitError
from truing.numbers import digits_in, format_number, pretty, with_unit
from truing.report.figure_units import brought_over
from truing.report.wording import READ_ELSEWHERE
from truing.setup import Setup
from truing.studies.bench import OutcomeT, printed_in
from truing.studies.checks import Check, Proposal, check_name, margin_of, requirements
from truing.studies.verdicts import Decided
from truing.units import difference_unit, from_si, same_dimension, to_si, unit_factor, unit_text
from truing.units.grammar import parse
from truing.units.meaning import meaning, without_prefix
from truing.units.names import COUNTS, LEVELS, SYMBOLS
from truing.units.systems import UnitSystem, in_system

FEWEST_DIGITS = 4
"""A number in a sentence keeps its digits, and has so many at the least: 2 mm is 0.07874 in."""
_NUMBER = r"(?:(?:(?<!\d)[-−+])?\d+(?:\.\d+)?(?:e[-+]?\d+|\s×\s10[⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+)?)"
_RANGE = r"(?:\s*(?:…|\.\.|–|±|×)\s*|\sto\s|(?<=\d)-(?=\d))"
_NUMBERS = (
    rf"\({_NUMBER}(?:(?:{_RANGE}|,\s){_NUMBER})*\)"  # (12 ± 3), (12, 3)
    rf"|{_NUMBER}(?:,\s{_NUMBER})*\s(?:and|or)\s{_NUMBER}"  # 10, 12 and 15
    rf"|{_NUMBER}(?:{_RANGE}{_NUMBER})*"  # 10 to 12
)
_UNIT = r"[A-Za-zµΔ°Ω][\wµΔ°Ω·⁻²³⁴^./()*]*(?:\s(?:mm|m|s)(?![\w·/]))?"
"""Names of units; "N m" is one of them, too."""
_QUANTITY = re.compile(
    rf"(?<![\w.,^/-])(?P<sign>±\s?)?(?P<numbers>{_NUMBERS})[ \u00a0\u202f]?"
    rf"(?P<unit>(?:10[⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+[·/])?{_UNIT})(?:\sper\s(?P<below>{_UNIT}))?"
)
_SINGLE = re.compile(_NUMBER)
_TEN = re.compile(r"\s×\s10(?P<exponent>[⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+)")
_PLAIN = str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹−", "-0123456789-")
_WORDS = frozenset({"in", "a", "to", "at"})
"""Names of units that are words, too: "4 in all" is no length."""


@dataclass(frozen=True)
class SheetUnits:
    """The system of units of a sheet, and the units that the inputs file states by hand, which stay as they are.

    ``kept`` holds these as they are printed.
    """

    system: UnitSystem = ""
    kept: frozenset[str] = frozenset()

    def unit(self, unit: str) -> str:
        """Return the unit in which a quantity stands on the sheet; what is no unit stays."""
        try:
            return unit if not unit or unit_text(unit) in self.kept else in_system(unit, self.system)
        except UnitError:
            return unit

    def said(self, text: str) -> str:
        """Bring the quantities in a sentence over, ranges and tolerances with them; all other words stay."""
        return _QUANTITY.sub(self._quantity, text) if self.system else text

    name = said

    def at(self, place: str) -> SheetUnits:
        """Return the units of the sentences of a place: what was read elsewhere stays as it stands there."""
        return AS_DECLARED if place in READ_ELSEWHERE else self

    def _quantity(self, match: re.Match[str]) -> str:
        """Return what stands for a number, or several, with a unit: the same where the unit has no counterpart."""
        read = _read_unit(match)
        parts = [self.unit(part) for part in read.parts]
        follows = match.string[match.end() : match.end() + 2]
        is_word = read.parts[0] in _WORDS and not read.trailing and follows[:1].isspace() and follows[1:].isalpha()
        if tuple(parts) == read.parts or is_word:
            return match[0]
        units = _quotient(read.parts), _quotient(parts)
        numbers, begin, said = match["numbers"], 0, ""
        for single in _SINGLE.finditer(numbers):
            between = numbers[begin : single.start()]
            said += between + _converted(single[0], units, step="±" in (match["sign"] or between))
            begin = single.end()
        if match["sign"]:
            parts = [difference_unit(parts[0]), *parts[1:]]
        shown = " per ".join(map(unit_text, parts))
        return (match["sign"] or "") + with_unit(said + numbers[begin:], shown) + read.trailing

    def block(self, block: Block) -> Block:
        """Bring over what a plugin or a study says: its sentences, and its tables column by column."""
        if not self.system:
            return block
        if isinstance(block, Words):
            return replace(block, text=self.said(block.text))
        if isinstance(block, Drawing):
            return replace(block, caption=self.said(block.caption))
        return self._table(block)

    def _table(self, table: Table) -> Table:
        units = [*table.units, *[""] * (len(table.columns) - len(table.units))]
        shown = [self.unit(unit) for unit in units]

        def cell(index: int, value: Cell) -> Cell:
            if isinstance(value, str):
                return self.said(value)
            changed = index < len(units) and shown[index] != units[index]
            return _number(value, units[index], shown[index]) if changed else value

        rows = [[cell(index, value) for index, value in enumerate(row)] for row in table.rows]
        return replace(table, rows=rows, units=shown, note=self.said(table.note))

    def drawn(self, make: Callable[[], Any]) -> Any:
        """Draw a figure and bring its axes over."""
        figure = make()
        return brought_over(figure, self.unit, self.said) if self.system else figure


AS_DECLARED = SheetUnits()


def sheet_units(setup: Setup) -> SheetUnits:
    """Return the units of the sheet of a setup."""
    return SheetUnits(setup.sheet.units, frozenset(unit_text(unit) for unit in setup.units.values()))


def as_printed(calculation: Calculation) -> Calculation:
    """Return a calculation as its sheet prints it; itself where the sheet has the declared units."""
    if not calculation.setup.sheet.units:
        return calculation
    units, setup = sheet_units(calculation.setup), printing(calculation.setup)
    return replace(
        calculation,
        setup=setup,
        outcomes={name: outcome_as_printed(each, setup) for name, each in calculation.outcomes.items()},
        decided=_decided(calculation.decided, setup, units),
        warnings=tuple(map(units.said, calculation.warnings)),
        failed=tuple((row, units.said(reason)) for row, reason in calculation.failed),
        absent={name: units.said(reason) for name, reason in calculation.absent.items()},
    )


def cases_as_printed(cases: CasesTable | None, setup: Setup) -> CasesTable | None:
    """Return cases as the sheet of a setup prints them."""
    if cases is None or not setup.sheet.units:
        return cases
    units, shown = sheet_units(setup), printing(setup)

    def printed(case: CaseResult) -> CaseResult:
        reason = None if case.reason is None else units.said(case.reason)
        return replace(case, decided=_decided(case.decided, shown, units), reason=reason)

    return replace(cases, cases=tuple(map(printed, cases.cases)))


def printing(setup: Setup) -> Setup:
    """Return a setup that prints every input, condition and result in the units of its sheet.

    What the inputs file states by hand wins.
    """
    if not setup.sheet.units:
        return setup
    names = [*setup.model.input_fields, *setup.model.known_conditions, *setup.model.result_fields]
    shown = {name: in_system(setup.print_unit(name), setup.sheet.units) for name in names}
    return replace(setup, units={**shown, **setup.units})


def outcome_as_printed(outcome: OutcomeT, setup: Setup) -> OutcomeT:
    """Return what a study found as the sheet of a setup prints it."""
    shown = printing(setup)

    def unit_of(name: str, unit: str) -> str:
        own = shown.units.get(name)
        return own if own is not None and same_dimension(own, unit) else shown.sheet.shown(unit)

    return printed_in(outcome, unit_of) if setup.sheet.units else outcome


# Limits


def _decided(decided: Decided, shown: Setup, units: SheetUnits) -> Decided:
    results = {check_name(each, requirements(shown)): each.result for each in requirements(shown)}

    def printed(check: Check) -> Check:
        return _check(check, shown.units.get(results.get(check.name, check.name), ""), units)

    proposal = decided.proposal
    return replace(
        decided,
        checks=tuple(map(printed, decided.checks)),
        proposal=None if proposal is None else _proposal(proposal, printed, units),
    )


def _proposal(proposal: Proposal, printed: Callable[[Check], Check], units: SheetUnits) -> Proposal:
    changes = tuple((name, units.said(stated), units.said(new)) for name, stated, new in proposal.changes)
    return replace(proposal, changes=changes, checks=tuple(map(printed, proposal.checks)))


def _check(check: Check, by_hand: str, units: SheetUnits) -> Check:
    """Bring a limit over. A margin is a share of the limit, or a distance: of a level of temperature it is new."""
    if check.flag or check.chance:
        return replace(check, compared=units.said(check.compared), note=units.said(check.note))
    unit = by_hand or units.unit(check.unit)
    if not meaning(check.unit).level:  # the distance from a level is a difference
        unit = difference_unit(unit)
    if unit == check.unit:
        return check
    value, limit = (_number(number, check.unit, unit) for number in (check.value, check.limit))
    margin = check.margin
    if meaning(unit).level:
        margin = margin_of(value, limit, at_least=check.relation == "≥") if margin else margin
    elif not check.limit:
        margin *= unit_factor(check.unit) / unit_factor(unit)
    proposed = None if check.proposed is None else _check(check.proposed, by_hand, units)
    said = replace(check, compared=units.said(check.compared), note=units.said(check.note))
    return replace(said, value=value, limit=limit, unit=unit, margin=margin, proposed=proposed)


def _number(value: Any, unit: str, new: str) -> Any:
    """Bring a number from one unit to another; what is no number stays."""
    if value is None or isinstance(value, (str, bool)):
        return value
    return float(from_si(to_si(float(value), unit), new))


# Quantities in a text


def _converted(number: str, units: tuple[str, str], *, step: bool) -> str:
    """Bring a number of a text over with the digits that it has; a ``step`` is a difference."""
    unit, new = (difference_unit(each) for each in units) if step else units
    plain = _TEN.sub(lambda match: f"e{match['exponent'].translate(_PLAIN)}", number).translate(_PLAIN)
    value = _number(float(plain), unit, new)
    text = pretty(format_number(value, max(digits_in(plain), FEWEST_DIGITS)))
    return f"+{text}" if number.startswith("+") else text


@dataclass(frozen=True)
class _ReadUnit:
    """A unit in a sentence: above and below a "per", and what stands behind it."""

    parts: tuple[str, ...]
    trailing: str


def _read_unit(match: re.Match[str]) -> _ReadUnit:
    """Take the unit of a quantity; a word that is none is a part as it stands, and has no counterpart."""
    unit, trailing = _without_trailing(match["unit"])
    if match["below"] is None or trailing:
        behind = match.string[match.end("unit") : match.end()]
        return _ReadUnit((unit if _is_known(unit) else "",), trailing + behind)
    below, trailing = _without_trailing(match["below"])
    if _is_known(unit) and _is_known(below):
        return _ReadUnit((unit, below), trailing)
    return _ReadUnit((unit if _is_known(unit) else "",), match.string[match.end("unit") : match.end()])


def _quotient(parts: Sequence[str]) -> str:
    return parts[0] if len(parts) == 1 else f"({parts[0]})/({parts[1]})"


def _without_trailing(text: str) -> tuple[str, str]:
    """Part a unit from what closes the words behind it: a full stop, a bracket that it did not open."""
    unit = text.rstrip("./*·^")
    while unit.endswith(")") and unit.count(")") > unit.count("("):
        unit = unit[:-1].rstrip("./*·^")
    return unit, text[len(unit) :]


def _is_known(text: str) -> bool:
    """Tell whether a text is a unit made of symbols; words such as "machines" or "feet" are none here."""
    try:
        factors = parse(text).factors
        meaning(text)
    except UnitError:
        return False
    symbols = ({name, without_prefix(name)} for name, _ in factors)
    return bool(factors) and all(each & ({*SYMBOLS, *LEVELS} - COUNTS) or "delta_degF" in each for each in symbols)


# What holds its numbers in SI and says beside them in which unit they are printed


def relabelled(value: Any, units: SheetUnits, kinds: tuple[type, ...]) -> Any:
    """Return a structure with the unit of the sheet in every ``unit`` of dataclasses of these kinds, ``units`` too.

    Their numbers are in SI and stay. Dataclasses of other kinds stay as they are, with all that they hold.
    """
    if isinstance(value, Mapping):
        return {key: relabelled(each, units, kinds) for key, each in value.items()}
    if isinstance(value, (list, tuple)) and type(value) in {list, tuple}:
        return type(value)(relabelled(each, units, kinds) for each in value)
    if not (is_dataclass(value) and isinstance(value, kinds)):
        return value
    held = {each.name: getattr(value, each.name) for each in fields(value) if each.init}
    new = {name: _label(name, each, units, kinds) for name, each in held.items()}
    changed = {name: each for name, each in new.items() if each is not held[name]}
    return replace(value, **changed) if changed else value  # type: ignore[type-var]


def _label(name: str, value: Any, units: SheetUnits, kinds: tuple[type, ...]) -> Any:
    if name == "unit" and isinstance(value, str):
        return units.unit(value)
    if name == "units" and isinstance(value, Mapping):
        return {key: units.unit(unit) for key, unit in value.items()}
    if isinstance(value, str):
        return units.said(value)
    return relabelled(value, units, kinds)
